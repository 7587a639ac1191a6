/* SPDX-License-Identifier: MIT
 *
 * Meshes with alpha as coverage on the device: the part alpha of rays meets a triangle. Means equal
 * closed forms and the oracle; alpha 1 is opaque and alpha 0 is a hole, to the last bit; an edge
 * counts once; and the mean over frames converges faster than with independent numbers.
 */
#include "tests/mesh_builders.h"
#include "tests/renderer/frames.h"

enum { SIDE = 64, PIXELS = SIDE * SIDE };

static const double alpha = 0.25, sun = 3.0, sky = 0.5;

static const struct neph_vec3 out_of_view_m = {0, 0, 100};

struct quads {
    struct test_scene test;
    struct neph_mesh *meshes[2]; /* owned; the quads', and that of a quad behind the camera */
};

/* Two quads, one behind the other; the view is within both, and so are the points of the front quad
 * from which the rear one gets its sunlight. The fog and a third quad with alpha as coverage are
 * out of view: so all tests of the march use one kernel. */
static void set_quads(struct quads *quads, float value)
{
    struct test_scene *test = &quads->test;
    struct neph_solid *solids = test->solids;
    test_scene_init(test);
    test->key.position_m = (struct neph_vec3){0.5, 0.5, 4};
    test->key.look_at_m = (struct neph_vec3){0.5, 0.5, 0};
    test->scene.vertical_fov_rad = 0.15;
    test->scene.frame_count = 32;
    test->scene.sun.direction = (struct neph_vec3){0.6, 0, 0.8};
    test->scene.sun.irradiance_w_per_m2 = make_grey(sun);
    test->scene.background_w_per_m2_sr = make_grey(sky);
    test_add_medium(test, 0.3, 0.0, 0.0)->bounds = (struct neph_bounds){{-60, 0, -80},
                                                                        {-50, 1, -60}};
    for (int i = 0; i < 2; i++)
        quads->meshes[i] = make_quad(1.0, make_half_texture(value, value), NEPH_ALPHA_COVERAGE);
    test->scene.solid_count = 3;
    solids[0] = solids[1] = put_mesh(quads->meshes[0]);
    solids[2] = put_mesh(quads->meshes[1]);
    solids[1].center_m.z = -0.2;
    solids[2].center_m = out_of_view_m;
    test->scene.meshes = quads->meshes;
    test->scene.mesh_count = 2;
}

static void finish_quads(struct quads *quads)
{
    neph_mesh_destroy(quads->meshes[0]);
    neph_mesh_destroy(quads->meshes[1]);
}

/* A part `a` of the rays meets the front quad, and of the others the same part meets the rear one,
 * where the part 1 - a of the sunlight arrives. Green: the albedo is 1/4. */
static double find_light(double a)
{
    const double lit = 0.25 * sun * 0.8 / M_PI;
    return a * lit + (1.0 - a) * (a * lit * (1.0 - a) + (1.0 - a) * sky);
}

static struct neph_image *march(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                double frame)
{
    const struct neph_march_params params = {
        .width_px = SIDE, .height_px = SIDE, .steps = 16, .frame = frame};
    return test_march(vulkan, scene, &params, NULL);
}

/* Pixels draw independent numbers, so the standard error of their mean is that of their spread. 4.5
 * of them: one wrong alarm in 150,000 runs, and the numbers are the same in each run. */
static void assert_mean(const struct neph_image *frame, double expected, const char *name)
{
    const float *values = neph_image_channel(frame, "G");
    double sum = 0.0, squares = 0.0;
    for (int p = 0; p < PIXELS; p++) {
        sum += (double)values[p];
        squares += (double)values[p] * (double)values[p];
    }
    const double mean = sum / PIXELS, variance = squares / PIXELS - mean * mean;
    const double error = sqrt(variance / (PIXELS - 1));
    print_message("%s: %.5f +- %.5f, expected %.5f\n", name, mean, error, expected);
    neph_assert_close(mean, expected, 0.0, 4.5 * error);
    assert_true(error < 0.01 * expected);
}

static void test_mean_of_two_quads(void **state)
{
    struct quads quads;
    set_quads(&quads, 0.25f);
    OWNED(image) struct neph_image *frame = march(*state, &quads.test.scene, 0.0);
    assert_mean(frame, find_light(alpha), "march");
    finish_quads(&quads);
}

/* The root of the mean square over pixels of the mean of some frames minus the expected light. */
static double find_spread(struct neph_vulkan *vulkan, const struct neph_scene *scene, int frames)
{
    double sums[PIXELS] = {0}, squares = 0.0;
    for (int f = 0; f < frames; f++) {
        OWNED(image) struct neph_image *frame = march(vulkan, scene, f);
        for (int p = 0; p < PIXELS; p++)
            sums[p] += (double)neph_image_channel(frame, "G")[p];
    }
    for (int p = 0; p < PIXELS; p++)
        squares += pow(sums[p] / frames - find_light(alpha), 2.0);
    return sqrt(squares / PIXELS);
}

/* With independent frames the spread of the mean of 8 is 1 / sqrt(8) of that of one. */
static void test_means_over_frames_converge_faster_than_chance(void **state)
{
    struct quads quads;
    set_quads(&quads, 0.25f);
    const double one = find_spread(*state, &quads.test.scene, 1);
    const double eight = find_spread(*state, &quads.test.scene, 8);
    print_message("spread of a frame %.4f, of the mean of eight %.4f\n", one, eight);
    assert_true(eight > 0.0 && eight < 0.7 * one / sqrt(8.0));
    finish_quads(&quads);
}

static void assert_same_frames(const struct neph_image *a, const struct neph_image *b)
{
    static const char *const channels[] = {"R", "G", "B", "Z", "transmittance.R", "volume.G"};
    for (size_t c = 0; c < COUNT(channels); c++)
        assert_memory_equal(neph_image_channel(a, channels[c]), neph_image_channel(b, channels[c]),
                            PIXELS * sizeof(float));
}

/* In fog that scatters, so that shadows in it count, too. */
static void test_alpha_of_one_is_opaque_and_of_zero_a_hole(void **state)
{
    for (int value = 0; value < 2; value++) {
        struct quads quads;
        struct neph_scene *scene = &quads.test.scene;
        set_quads(&quads, (float)value);
        scene->media[0].bounds = (struct neph_bounds){{-1, -1, -1}, {2, 2, 2}};
        OWNED(image) struct neph_image *covered = march(*state, scene, 0.0);
        quads.meshes[0]->material.alpha = NEPH_ALPHA_IGNORED;
        for (int i = 0; i < 2 && value == 0; i++)
            quads.test.solids[i].center_m = out_of_view_m;
        OWNED(image) struct neph_image *other = march(*state, scene, 0.0);
        assert_same_frames(covered, other);
        finish_quads(&quads);
    }
}

/* The camera looks along the normal at the middle of the quad, so pixels in the diagonal are on the
 * edge between its triangles. */
static void test_an_edge_counts_once(void **state)
{
    enum { FRAMES = 32 };
    struct quads quads;
    int hits = 0, count = SIDE * FRAMES;
    set_quads(&quads, 0.5f);
    quads.test.solids[1].center_m = out_of_view_m;
    for (int f = 0; f < FRAMES; f++) {
        OWNED(image) struct neph_image *frame = march(*state, &quads.test.scene, f);
        for (int i = 0; i < SIDE; i++)
            hits += isfinite(neph_image_channel(frame, "Z")[i * SIDE + SIDE - 1 - i]);
    }
    /* The binomial error; if both triangles were drawn, 3/4 would be hit. */
    print_message("%d of %d rays through an edge hit\n", hits, count);
    neph_assert_close((double)hits / count, 0.5, 0.0, 4.5 * sqrt(0.25 / count));
    finish_quads(&quads);
}

/* A quad with holes and shades of alpha, in fog over a ground, with all orders of scattering. */
static void test_tracer_against_oracle(void **state)
{
    enum { WIDTH = 12, HEIGHT = 9, COUNT_PX = WIDTH * HEIGHT };
    const float rgba[4 * 4] = {1, 0.5f, 0.2f, 0,    0.3f, 1, 0.2f, 0.3f,
                               1, 0.5f, 0.9f, 0.7f, 0.1f, 1, 0.6f, 1};
    struct quads quads;
    struct neph_scene *scene = &quads.test.scene;
    set_quads(&quads, 1.0f);
    neph_albedo_texture_destroy(quads.meshes[0]->material.texture);
    quads.meshes[0]->material.texture = make_texture(2, 2, rgba);
    scene->scattering = NEPH_SCATTERING_MULTIPLE;
    quads.test.key.position_m = (struct neph_vec3){0.7, 0.9, 3};
    scene->vertical_fov_rad = 0.6;
    scene->sun.direction = (struct neph_vec3){0.48, 0.6, 0.64};
    quads.test.solids[2] = (struct neph_solid){
        .kind = NEPH_SOLID_BOX, .box = {{-9, -1, -9}, {9, 0, 9}}, .albedo = make_grey(0.5)};
    scene->media[0].bounds = (struct neph_bounds){{-3, 0, -3}, {4, 2, 2}};
    const struct neph_tracer_params params = test_samples(WIDTH, HEIGHT, 6, 512);
    OWNED(image) struct neph_image *traced = test_trace(*state, scene, &params, NULL);
    OWNED(image) struct neph_image *truth = test_oracle(scene, WIDTH, HEIGHT, 7, 128);
    double squares = 0.0, sum = 0.0, variance = 0.0;
    int other_depths = 0;
    for (int p = 0; p < COUNT_PX; p++) {
        const double difference = (double)neph_image_channel(traced, "G")[p] -
                                  (double)neph_image_channel(truth, "G")[p];
        const double own = (double)neph_image_channel(traced, "variance.G")[p] +
                           (double)neph_image_channel(truth, "variance.G")[p];
        const double z_m = (double)neph_image_channel(truth, "Z")[p];
        const double own_z_m = (double)neph_image_channel(traced, "Z")[p];
        other_depths += z_m != own_z_m && !(fabs(z_m - own_z_m) < 1e-5 * z_m);
        sum += difference;
        variance += own;
        squares += difference * difference / own;
    }
    print_message("mean: %.2f standard errors; mean square of pixels %.3f\n", sum / sqrt(variance),
                  squares / COUNT_PX);
    assert_true(fabs(sum) < 4.5 * sqrt(variance));
    /* A mean of the squares of 108 numbers of variance 1: within 4.5 of its standard errors. */
    neph_assert_close(squares / COUNT_PX, 1.0, 0.0, 4.5 * sqrt(2.0 / COUNT_PX));
    assert_int_equal(other_depths, 0); /* of the parts of 1/2 and more */
    finish_quads(&quads);
}

/* In a static scene history takes the noise away; a frame of the march has the first spread of
 * test_means_over_frames_converge_faster_than_chance(). */
static void test_history_of_the_realtime_renderer(void **state)
{
    neph_test_waits_for_the_night();
    struct quads quads;
    set_quads(&quads, 0.25f);
    const struct neph_settings settings = test_preset("ours", "warm_up=0");
    const struct neph_realtime_params params = {.width_px = SIDE,
                                                .height_px = SIDE,
                                                .settings = &settings,
                                                .blue_noise_path = NEPH_SOURCE_DIR
                                                "/renderer/blue_noise.png"};
    OWNED(image) struct neph_image *last = test_film(*state, &quads.test.scene, &params, 16, NULL);
    double squares = 0.0;
    for (int p = 0; p < PIXELS; p++)
        squares += pow((double)neph_image_channel(last, "G")[p] - find_light(alpha), 2.0);
    print_message("spread of the sixteenth frame %.4f\n", sqrt(squares / PIXELS));
    assert_true(sqrt(squares / PIXELS) < 0.3 * find_spread(*state, &quads.test.scene, 1));
    finish_quads(&quads);
}

#include "tests/renderer/main.h"
