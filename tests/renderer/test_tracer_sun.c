/* SPDX-License-Identifier: MIT
 *
 * The tracer's sunlight from a table (shaders/tracer_sun.glsl) compared with a shadow ray at each
 * event, which test_tracer.c compares with the oracle. For every table, however coarse, the light
 * is the same up to noise, the noise estimate is correct, and no value is negative.
 */
#include "tests/renderer/fog_scenes.h"
#include "tests/renderer/frames.h"

#include "scenes/grid.h"

enum { WIDTH_PX = 32, HEIGHT_PX = 18, PIXELS = WIDTH_PX * HEIGHT_PX };

static void add_grid(struct test_scene *test, double extinction_per_m)
{
    uint64_t random = 20240611;
    test_add_cloud(test, NEPH_MEDIUM_GRID, extinction_per_m)->grid = random_lattice(
        (const int[3]){12, 8, 12}, (struct neph_vec3){-1.0, 1.0, -4.0},
        (struct neph_vec3){0.18, 0.18, 0.18}, -0.3, &random);
}

/* A cloud with coloured higher orders, in the shadow of a sphere, in front of a reflecting wall; in
 * thin fog, with a blob in it; under a bright sky. */
static void scene_of_all(struct test_scene *test)
{
    add_grid(test, 8.0);
    test->scene.media[0].albedo = (struct neph_rgb){0.99, 0.9, 0.6};
    struct neph_medium *blob = test_add_cloud(test, NEPH_MEDIUM_GAUSSIAN, 2.0);
    blob->gaussian = (struct neph_gaussian){{0.3, 1.8, -3.0}, 0.4};
    blob->albedo = (struct neph_rgb){0.5, 0.8, 0.95};
    test_add_medium(test, 0.05, 0.3, 0.0);
    test_add_box(test, (struct neph_vec3){-30.0, 0.0, -9.0}, (struct neph_vec3){30.0, 20.0, -8.0});
    test_add_sphere(test, (struct neph_vec3){0.8, 2.6, -2.6}, 0.4);
    test->scene.environment_light = true;
}

/* Single nodes in empty space, which a coarse table misses. */
static void scene_of_spikes(struct test_scene *test)
{
    add_grid(test, 30.0);
    struct neph_grid *grid = test->scene.media[0].grid;
    uint64_t random = 7;
    for (int i = 0; i < grid->size[0] * grid->size[1] * grid->size[2]; i++)
        grid->values[i] = neph_test_uniform(&random, 0.0, 1.0) < 0.1 ? 1.0f : 0.0f;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_grid_seal(grid, &diag), &diag);
}

static void build(struct test_scene *test, void (*build_scene)(struct test_scene *))
{
    test_scene_init(test);
    build_scene(test);
    test->scene.scattering = NEPH_SCATTERING_MULTIPLE;
}

static struct neph_image *render(struct neph_vulkan *vulkan, const struct test_scene *test,
                                 int sun_nodes, uint64_t seed, int samples)
{
    struct neph_tracer_params params = test_samples(WIDTH_PX, HEIGHT_PX, seed, samples);
    params.sun_nodes = sun_nodes;
    struct neph_image *frame = test_trace(vulkan, &test->scene, &params, NULL);
    for (int c = 0; c < frame->channel_count; c++)
        for (int i = 0; i < PIXELS; i++)
            if (!(frame->channels[c].samples[i] >= 0.0f))
                fail_msg("%d nodes: %s of pixel %d is %g", sun_nodes, frame->channels[c].name, i,
                         (double)frame->channels[c].samples[i]);
    return frame;
}

/* The differences of independent pixels add up to 0 within four standard errors. */
static void judge_sum(const char *name, int nodes, float *const a[3], float *const b[3])
{
    for (int c = 0; c < 3; c++) {
        double sum = 0.0, squares = 0.0, light = 0.0;
        for (int i = 0; i < PIXELS; i++) {
            const double off = (double)a[c][i] - (double)b[c][i];
            sum += off;
            squares += off * off;
            light += (double)b[c][i];
        }
        print_message("%s, %d nodes, channel %d: off by %+.2e +- %.1e\n", name, nodes, c,
                      sum / light, sqrt(squares) / light);
        if (fabs(sum) > 4.0 * sqrt(squares))
            fail_msg("%s of %d nodes is biased", name, nodes);
    }
}

/* The mean squared difference equals the variance that both frames report. The mean of as many
 * squares of a normal number is within four standard errors, sqrt(2 / count) each, of 1; for light
 * of single paths half as far again. */
static void judge_variance(int nodes, const struct neph_image *a, const struct neph_image *b)
{
    float *of_a[3], *of_b[3], *variance_a[3], *variance_b[3];
    double square_sum = 0.0;
    int count = 0;
    assert_true(neph_image_rgb(a, NULL, of_a) && neph_image_rgb(b, NULL, of_b));
    assert_true(neph_image_rgb(a, "variance", variance_a) &&
                neph_image_rgb(b, "variance", variance_b));
    for (int i = 0; i < PIXELS; i++) {
        const int c = i % 3;
        const double variance = (double)variance_a[c][i] + (double)variance_b[c][i];
        const double off = (double)of_a[c][i] - (double)of_b[c][i];
        if (variance <= 1e-10 * (double)of_b[c][i] * (double)of_b[c][i])
            continue;
        square_sum += off * off / variance;
        count++;
    }
    print_message("%d nodes: %d z-scores, mean square %.3f\n", nodes, count, square_sum / count);
    assert_true(count > PIXELS / 3);
    if (fabs(square_sum / count - 1.0) > 1.5 * 4.0 * sqrt(2.0 / count))
        fail_msg("%d nodes: the noise is not what the frame says", nodes);
}

/* Whether the table is used: a table that is too coarse is not, and would test nothing. */
static bool has_table(struct neph_vulkan *vulkan, const struct test_scene *test, int nodes)
{
    OWNED(image) struct neph_image *rays = render(vulkan, test, 0, 1, 8);
    OWNED(image) struct neph_image *table = render(vulkan, test, nodes, 1, 8);
    return memcmp(rays->channels[0].samples, table->channels[0].samples, PIXELS * sizeof(float)) !=
           0;
}

static void judge_tables(struct neph_vulkan *vulkan, void (*build_scene)(struct test_scene *),
                         const int *nodes, size_t count)
{
    OWNED(media) struct test_scene test;
    build(&test, build_scene);
    const int samples = neph_test_by_day(64, 4096);
    OWNED(image) struct neph_image *rays = render(vulkan, &test, 0, 1, samples);
    assert_true(has_table(vulkan, &test, nodes[count - 1]));
    float *of_rays[3], *of_table[3];
    for (size_t i = 0; i < count; i++) {
        OWNED(image)
        struct neph_image *table = render(vulkan, &test, nodes[i], 2 + (uint64_t)i, samples);
        assert_true(neph_image_rgb(rays, "order1", of_rays) &&
                    neph_image_rgb(table, "order1", of_table));
        judge_sum("order 1", nodes[i], of_table, of_rays);
        assert_true(neph_image_rgb(rays, NULL, of_rays) && neph_image_rgb(table, NULL, of_table));
        judge_sum("all light", nodes[i], of_table, of_rays);
        judge_variance(nodes[i], table, rays);
    }
}

static void test_any_table_is_right(void **state)
{
    static const int nodes[] = {NEPH_TRACER_SUN_NODES, 4096, 512};
    judge_tables(*state, scene_of_all, nodes, COUNT(nodes));
}

static void test_a_table_that_misses_it_all_is_right(void **state)
{
    static const int nodes[] = {NEPH_TRACER_SUN_NODES, 2000};
    judge_tables(*state, scene_of_spikes, nodes, COUNT(nodes));
}

/* The worst case: a batch that is represented by one event, and a coarse table. render() asserts
 * that no value is negative. */
static void test_no_light_is_negative(void **state)
{
    OWNED(media) struct test_scene test;
    build(&test, scene_of_spikes);
    for (uint64_t seed = 1; seed <= (uint64_t)neph_test_by_day(4, 16); seed++)
        neph_image_destroy(render(*state, &test, 1000 << (seed % 4), seed, 8));
}

#include "tests/renderer/main.h"
