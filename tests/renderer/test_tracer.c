/* SPDX-License-Identifier: MIT
 *
 * The path tracer on the device compared with references without noise: exact single scattering, a
 * half-space, the white furnace.
 */
#include "tests/base/scratch.h"
#include "tests/renderer/fog_scenes.h"
#include "tests/renderer/verdict.h"

#include "base/interrupt.h"
#include "scenes/grid.h"
#include "scenes/horizon.h"
#include "scenes/media.h"
#include "scenes/solids.h"

#include <signal.h>

static const uint64_t seed = 20240611;

static struct neph_tracer_params make_params(int width_px, int height_px, int samples)
{
    return (struct neph_tracer_params){.width_px = width_px,
                                       .height_px = height_px,
                                       .seed = seed,
                                       .sun_nodes = 4096, /* the default is for large frames */
                                       .samples = samples,
                                       .time_limit_s = INFINITY};
}

static struct neph_image *render(struct neph_vulkan *vulkan, const struct test_scene *test,
                                 const struct neph_tracer_params *params,
                                 struct neph_tracer_stats *stats)
{
    struct neph_image *frame = test_trace(vulkan, &test->scene, params, stats);
    assert_int_equal(frame->channel_count, 16);
    for (int c = 0; c < frame->channel_count; c++)
        for (size_t i = 0; i < neph_image_pixel_count(frame); i++) {
            const float value = frame->channels[c].samples[i];
            if (!(value >= 0.0f) || (isinf(value) && strcmp(frame->channels[c].name, "Z") != 0))
                fail_msg("%s of pixel %zu is %g", frame->channels[c].name, i, (double)value);
        }
    return frame;
}

/* --- single scattering -------------------------------------------------------------------- */

static void scene_solids_in_fog(struct test_scene *test)
{
    scene_fog(test);
    test_add_box(test, (struct neph_vec3){-1e3, -1.0, -1e3}, (struct neph_vec3){1e3, 0.0, 1e3});
    test_add_sphere(test, (struct neph_vec3){2.0, 3.0, -20.0}, 4.0);
}

/* Slack of the variance: 2 / n for n pairs in the one stratum that may have most of it. Where a
 * solid shadows one thousandth of a ray, thousands of samples are needed before their variance
 * includes it. A shadow on 7 / n of a ray is missed by all n samples once in e^7 = 1100 pixels, and
 * the variance then does not include it: `unseen`. */
static const struct {
    const char *name;
    void (*build)(struct test_scene *);
    int width_px, height_px, samples;
    double unseen;
} single_scenes[] = {
    {"box", scene_cube, 32, 18, 512, 0.0},
    {"fog", scene_fog, 32, 18, 512, 0.0},
    {"fog, down", scene_fog_down, 32, 18, 512, 0.0},
    {"two layers, up", scene_two_layers_up, 32, 18, 512, 0.0},
    {"overlapping media", scene_overlapping_media, 32, 18, 512, 0.0},
    {"solids in fog", scene_solids_in_fog, 24, 14, 4096, 7.0 / 4096},
};

static void test_single_scattering_is_exact_transport(void **state)
{
    for (size_t s = 0; s < COUNT(single_scenes); s += (size_t)neph_test_by_day(2, 1)) {
        struct test_scene test;
        test_scene_build(&test, single_scenes[s].build);
        const struct neph_tracer_params params = make_params(
            single_scenes[s].width_px, single_scenes[s].height_px, single_scenes[s].samples);
        OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
        struct verdict verdict = compare(&test, frame, exact_single, NULL);
        verdict.exact_error = fmax(0.0, verdict.exact_error - single_scenes[s].unseen);
        judge(single_scenes[s].name, verdict,
              2.0 / (single_scenes[s].samples / NEPH_TRACER_BATCH_SAMPLES));
    }
}

/* --- clouds -------------------------------------------------------------------------------- */

/* Smooth and lumpy, zero in places; 2.2 x 1.4 x 2.2 m in front of the camera. */
static void scene_grid(struct test_scene *test)
{
    uint64_t random = seed;
    test_add_cloud(test, NEPH_MEDIUM_GRID, 6.0)->grid = random_lattice(
        (const int[3]){12, 8, 12}, (struct neph_vec3){-1.0, 1.0, -4.0},
        (struct neph_vec3){0.18, 0.18, 0.18}, -0.3, &random);
}

static void scene_gaussian(struct test_scene *test)
{
    struct neph_medium *medium = test_add_cloud(test, NEPH_MEDIUM_GAUSSIAN, 2.0);
    medium->gaussian = (struct neph_gaussian){{0.3, 1.8, -5.0}, 0.6};
}

/* A planet of 50 m with an atmosphere, seen from the side. */
static void scene_shell(struct test_scene *test)
{
    struct neph_medium *medium = test_add_cloud(test, NEPH_MEDIUM_SHELL, 0.1);
    medium->shell = (struct neph_shell){{0.0, -20.0, -100.0}, 50.0, 6.0};
    medium->bounds = (struct neph_bounds){{-150.0, -170.0, -250.0}, {150.0, 130.0, 50.0}};
    test_add_sphere(test, (struct neph_vec3){0.0, -20.0, -100.0}, 50.0);
    test->scene.solids[0].albedo = (struct neph_rgb){0.0, 0.0, 0.0};
}

static void scene_coloured_grid(struct test_scene *test)
{
    scene_grid(test);
    test->scene.media[0].extinction_color = (struct neph_rgb){0.3, 1.0, 2.5};
}

static void scene_two_coloured(struct test_scene *test)
{
    scene_coloured_grid(test);
    struct neph_medium *blob = test_add_cloud(test, NEPH_MEDIUM_GAUSSIAN, 3.0);
    blob->gaussian = (struct neph_gaussian){{0.2, 1.7, -3.2}, 0.4};
    blob->extinction_color = (struct neph_rgb){2.0, 0.5, 1.0};
}

static void scene_all(struct test_scene *test)
{
    scene_coloured_grid(test);
    scene_gaussian(test);
    test->scene.media[1].phase = (struct neph_phase){.kind = NEPH_PHASE_RAYLEIGH};
    test_add_medium(test, 0.05, 0.3, 0.0);
    test->scene.media[2].extinction_color = (struct neph_rgb){2.0, 1.0, 0.5};
    test->scene.media[2].bounds.min_m.y = 0.0;
    test_add_box(test, (struct neph_vec3){-30.0, 0.0, -30.0}, (struct neph_vec3){30.0, 0.5, 30.0});
    test_add_sphere(test, (struct neph_vec3){0.8, 1.5, -3.2}, 0.4);
}

/* A cloud layer above the floor and behind thin fog, without a closed form of its optical depth. */
static void scene_horizon(struct test_scene *test)
{
    struct neph_medium *medium = test_add_cloud(test, NEPH_MEDIUM_HORIZON, 0.02);
    struct neph_horizon_params params = neph_horizon_defaults();
    struct neph_diag diag = {0};
    neph_assert_ok(neph_horizon_create(&params, &medium->horizon, &diag), &diag);
    medium->bounds = (struct neph_bounds){{-600.0, 50.0, -1200.0}, {600.0, 400.0, 0.0}};
    medium->extinction_color = (struct neph_rgb){1.0, 1.0, 0.6};
    test_add_medium(test, 1e-4, 0.0, 0.0)->bounds = medium->bounds;
    test_add_box(test, (struct neph_vec3){-1e3, -1.0, -1300.0},
                 (struct neph_vec3){1e3, 150.0, -900.0});
    test->key.look_at_m = (struct neph_vec3){0.0, 6.0, -10.0};
}

static void scene_fogs_and_ball(struct test_scene *test)
{
    scene_overlapping_media(test);
    test_add_sphere(test, (struct neph_vec3){-1.0, 3.0, -14.0}, 2.0);
}

/* All orders of a scene's light, including the environment's. */
static void build_lit(struct test_scene *test, void (*build)(struct test_scene *))
{
    test_scene_init(test);
    build(test);
    test->scene.scattering = NEPH_SCATTERING_MULTIPLE;
    test->scene.environment_light = true;
}

/* Around scene_grid() and scene_gaussian(), with air in front and behind. */
static void add_bank(struct test_scene *test, double falloff_per_m)
{
    struct neph_medium *bank = test_add_medium(test, 0.3, falloff_per_m, 0.5);
    bank->bounds = (struct neph_bounds){{-3.0, -1.0, -7.0}, {3.0, 4.0, -0.5}};
}

static const struct {
    const char *name;
    void (*build)(struct test_scene *);
} clouds[] = {
    {"grid", scene_grid},     {"Gaussian", scene_gaussian},
    {"shell", scene_shell},   {"two coloured", scene_two_coloured},
    {"all media", scene_all}, {"Horizon", scene_horizon},
};
/* From these on weights are random in the furnace, and the oracle is slow. */
enum { FIRST_OF_CHANCE = 3, FIRST_SLOW = 4 };

/* The sun behind an opaque medium: free flights would reach the far side, which is as bright as the
 * near one, once in e^(optical depth) paths. */
static void test_against_the_light(void **state)
{
    static const double faint = 1e-6; /* of its kind, to share kernels */
    const struct {
        const char *name;
        double slab_depth, ball_depth;
        bool is_coloured;
    } cases[] = {
        {"slab of 12", 12.0, faint, false},   {"slab of 16", 16.0, faint, false},
        {"slab of 20", 20.0, faint, false},   {"ball of 16", faint, 16.0, false},
        {"coloured slab", 16.0, faint, true}, {"slab and ball", 8.0, 8.0, false},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct test_scene test;
        test_scene_init(&test);
        test.scene.sun.direction = neph_vec3_normalize((struct neph_vec3){0.02, 0.05, -1.0});
        test.scene.background_w_per_m2_sr = (struct neph_rgb){0, 0, 0};
        struct neph_medium *slab = test_add_medium(&test, cases[i].slab_depth / 10.0, 0.0, 0.0);
        slab->bounds = (struct neph_bounds){{-200, -200, -30}, {200, 200, -20}};
        if (cases[i].is_coloured)
            slab->extinction_color = (struct neph_rgb){0.8, 1.0, 1.1};
        struct neph_medium *ball = test_add_cloud(&test, NEPH_MEDIUM_GAUSSIAN,
                                                  cases[i].ball_depth / (2.5066282746310002 * 4.0));
        ball->gaussian = (struct neph_gaussian){{0.0, 1.6, -24.0}, 4.0};
        const struct neph_tracer_params params = make_params(16, 9, 1024);
        OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
        judge(cases[i].name, compare(&test, frame, exact_single, NULL), 2.0 / 128.0);
    }
}

/* All orders in a grid below fog with a transmittance of e^-16 for sunlight. Without a sun table,
 * paths sample the sunlight of first collisions. Second orders are 1e-6 of the first. Where the sun
 * ray crosses an optical depth of 7 / n or less, possibly none of n samples collides, and the
 * pixel's variance does not include the noise. */
static void test_a_grid_beneath_dark_fog(void **state)
{
    enum { SAMPLES = 512 };
    OWNED(media) struct test_scene test;
    test_scene_build(&test, scene_grid);
    test.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    test.scene.background_w_per_m2_sr = (struct neph_rgb){0, 0, 0};
    test.scene.media[0].albedo = make_grey(1e-6);
    struct neph_medium *fog = test_add_medium(&test, 16.0 * test.scene.sun.direction.y, 0.0, 0.0);
    fog->albedo = make_grey(0.0);
    fog->bounds = (struct neph_bounds){{-200, 5, -200}, {200, 6, 200}};
    struct neph_tracer_params params = make_params(16, 9, SAMPLES);
    params.sun_nodes = 0;
    OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
    struct verdict verdict = compare(&test, frame, exact_single, NULL);
    verdict.exact_error = fmax(0.0, verdict.exact_error - 7.0 / SAMPLES);
    judge("grid beneath dark fog", verdict, 2.0 * NEPH_TRACER_BATCH_SAMPLES / SAMPLES);
}

/* Fog 2^30 m below a grid, where float32 positions on a ray have a resolution of 128 m: 13 mean
 * free paths of the majorant. Sun rays cross the grid where its density is a fiftieth of that, and
 * must not meet one tentative collision after the other at the same place. Second orders are 1e-6
 * of the first. */
static void test_a_grid_far_from_the_fog_below(void **state)
{
    enum { SAMPLES = 512 };
    const double far_m = 0x1p30, width_m = 1e8, thick_m = 1e6;
    OWNED(media) struct test_scene test;
    test_scene_init(&test);
    test.key.look_at_m = (struct neph_vec3){0.0, -1e3, 0.0};
    test.scene.camera_up = (struct neph_vec3){0.0, 0.0, -1.0};
    test.scene.vertical_fov_rad = 5e-4;
    test.scene.sun.direction = (struct neph_vec3){0.0, 1.0, 0.0};
    test.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    test.scene.background_w_per_m2_sr = (struct neph_rgb){0, 0, 0};
    uint64_t random = seed;
    test_add_cloud(&test, NEPH_MEDIUM_GRID, 0.1)->grid = random_lattice(
        (const int[3]){1, 4, 1}, (struct neph_vec3){-0.98 * width_m, 200.0, 0.0},
        (struct neph_vec3){width_m, 150.0, width_m}, 1.0, &random);
    struct neph_medium *fog = test_add_medium(&test, 0.1 / thick_m, 0.0, 0.0);
    fog->albedo = make_grey(1e-6);
    fog->bounds = (struct neph_bounds){{-1e6, -far_m - 2.0 * thick_m, -1e6},
                                       {1e6, -far_m - thick_m, 1e6}};
    struct neph_tracer_params params = make_params(16, 9, SAMPLES);
    params.sun_nodes = 0;
    OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
    judge("grid far from fog", compare(&test, frame, exact_single, NULL),
          2.0 * NEPH_TRACER_BATCH_SAMPLES / SAMPLES);
}

/* Single scattering with the sun straight ahead in closed form: all points of the ray have the same
 * whole path, so L = E albedo p tau e^-tau. `context`: tau. */
static double lit_from_behind(const struct test_scene *test, const struct neph_pixel_ray *ray,
                              int i, int channel, const void *context)
{
    const double tau = *(const double *)context;
    const struct neph_rgb light = test->scene.sun.irradiance_w_per_m2;
    const struct neph_rgb albedo = test->scene.media[0].albedo;
    const double per_sr = neph_phase_per_sr(&test->scene.media[0].phase, 1.0);
    const double scattered[3] = {light.r * albedo.r, light.g * albedo.g, light.b * albedo.b};
    return scattered[channel] * per_sr * tau * exp(-tau);
}

/* Against the light in a cloud without closed form, and fog: the optical depth along the view is
 * given by the extinction, and all pixels have the same view to a centimetre. */
static void test_procedural_clouds_against_the_light(void **state)
{
    neph_test_waits_for_the_night();
    const double optical_depth = 16.0,
                 skewness = 9.0; /* of a path, at most; of free flights: hundreds */
    OWNED(media) struct test_scene test;
    test_scene_build(&test, scene_horizon);
    struct neph_medium *media = test.scene.media;
    media[0].extinction_color = (struct neph_rgb){1, 1, 1};
    media[1].albedo = media[0].albedo;
    media[1].phase = media[0].phase;
    test.scene.solid_count = 0;
    test.scene.background_w_per_m2_sr = (struct neph_rgb){0, 0, 0};
    test.scene.vertical_fov_rad = 1e-5;
    const struct neph_camera camera = neph_scene_camera(&test.scene, 0.0);
    const struct neph_vec3 ahead = neph_camera_ray(&camera, 1, 1, 0, 0).direction;
    test.scene.sun.direction = ahead;
    double thin = 0.0;
    for (int m = 0; m < test.scene.medium_count; m++)
        thin += neph_medium_optical_depth(&media[m], test.key.position_m, ahead, 0.0, INFINITY);
    media[0].extinction_per_m *= optical_depth / thin;
    media[1].layers[0].extinction_per_m *= optical_depth / thin;
    const struct neph_tracer_params params = make_params(7, 4, 256);
    OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
    judge_skewed("Horizon in fog, 16", compare(&test, frame, lit_from_behind, &optical_depth),
                 skewness, params.samples);
}

/* A sun in the plane of a box's face: whether a point of the face is in the box depends on the last
 * bit, and so on the device, and must not matter. Sun rays that lean to either side by one bit
 * stand for two devices. Bounds and the fraction of outliers as in
 * harness/run/conform_compare.c. */
static void test_the_last_bit_decides_little(void **state)
{
    struct test_scene test;
    test_scene_init(&test);
    test_add_medium(&test, 0.05, 0.0, 0.0)->bounds = (struct neph_bounds){{-8, -4, -9}, {8, 8, -1}};
    struct neph_image *frames[2];
    for (int i = 0; i < 2; i++) {
        test.scene.sun.direction = (struct neph_vec3){0.6, 0.8, i == 0 ? 6e-8 : -6e-8};
        const struct neph_tracer_params params = make_params(48, 27, 16);
        frames[i] = render(*state, &test, &params, NULL);
    }
    const float *a = neph_image_channel(frames[0], "order1.G");
    const float *b = neph_image_channel(frames[1], "order1.G");
    size_t beyond = 0, count = neph_image_pixel_count(frames[0]);
    for (size_t i = 0; i < count; i++)
        beyond += fabsf(a[i] - b[i]) > 2e-4f * fmaxf(a[i], b[i]);
    print_message("the last bit: %zu of %zu pixels\n", beyond, count);
    assert_true((double)beyond <= 0.05 * (double)count);
    neph_image_destroy(frames[0]);
    neph_image_destroy(frames[1]);
}

/* Two independent estimates: z-scores of their difference, and the number of scores. */
static int judge_pair(const char *name, const struct neph_image *a, const struct neph_image *b,
                      double variance_slack)
{
    struct verdict v = {0};
    double square_sum = 0.0, sum = 0.0, difference = 0.0, variance_sum = 0.0;
    const struct test_rgb of_a = test_layer(a, NULL), of_b = test_layer(b, NULL);
    const struct test_rgb variance_a = test_layer(a, "variance"),
                          variance_b = test_layer(b, "variance");
    for (size_t i = 0; i < neph_image_pixel_count(a); i++) {
        const int c = (int)(i % 3);
        const double variance = (double)variance_a.of[c][i] + (double)variance_b.of[c][i];
        const double off = (double)of_a.of[c][i] - (double)of_b.of[c][i];
        sum += (double)of_b.of[c][i];
        difference += off;
        variance_sum += variance;
        if (sqrt(variance) < noisy * rounding * (double)of_b.of[c][i])
            continue;
        v.z_mean += off / sqrt(variance);
        square_sum += off * off / variance;
        v.count++;
    }
    v.z_mean /= v.count;
    v.z_variance = square_sum / v.count - v.z_mean * v.z_mean;
    v.bias = difference / sum;
    v.bias_error = sqrt(variance_sum) / sum;
    judge(name, v, variance_slack);
    return v.count;
}

/* Media that only attenuate. */
static void test_attenuation_only_is_exact(void **state)
{
    OWNED(media) struct test_scene test;
    test_scene_build(&test, scene_gaussian);
    test.scene.media[0].extinction_color = (struct neph_rgb){0.3, 1.0, 2.0};
    test_add_box(&test, (struct neph_vec3){-9.0, -1.0, -9.0}, (struct neph_vec3){9.0, 0.5, 9.0});
    test.scene.scattering = NEPH_SCATTERING_NONE;
    const struct neph_tracer_params params = make_params(32, 18, 8);
    OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
    const struct verdict v = compare(&test, frame, exact_single, NULL);
    judge("no scattering", v, 0.0);
    assert_int_equal(v.count, 0);
}

/* Kernels are specialized for the kinds of media in the scene: each shape by itself in each kind of
 * fog, thin enough for an exact transmittance in float32. */
static void test_shapes_in_fog_attenuate_exactly(void **state)
{
    static void (*const shapes[])(struct test_scene *) = {scene_grid, scene_gaussian, scene_shell};
    static const double falloffs_per_m[] = {0.0, 0.3};
    for (size_t s = 0; s < (size_t)neph_test_by_day(1, COUNT(shapes)); s++)
        for (size_t f = 0; f < COUNT(falloffs_per_m); f++) {
            OWNED(media) struct test_scene test;
            char name[64];
            test_scene_build(&test, shapes[s]);
            test.scene.media[0].extinction_per_m *= 0.1;
            add_bank(&test, falloffs_per_m[f]);
            test.scene.scattering = NEPH_SCATTERING_NONE;
            const struct neph_tracer_params params = make_params(32, 18, 8);
            OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
            snprintf(name, sizeof(name), "shape %zu in fog %zu", s, f);
            judge(name, compare(&test, frame, exact_single, NULL), 0.0);
        }
}

/* Compares with the oracle, which has noise of its own. */
static void judge_by_oracle(struct neph_vulkan *vulkan, const char *name,
                            const struct test_scene *test, int samples)
{
    const struct neph_tracer_params params = make_params(16, 9, samples);
    OWNED(image) struct neph_image *frame = render(vulkan, test, &params, NULL);
    OWNED(image) struct neph_image *truth = test_oracle(&test->scene, 16, 9, 5, samples);
    judge_pair(name, frame, truth, 0.3);
}

/* With the environment's light, as in the furnace, which shares the kernels. */
static void test_clouds_are_those_of_the_oracle(void **state)
{
    const bool is_night = neph_test_is_night(); /* by day the spikes stand for other grids */
    for (size_t s = is_night ? 0 : 2; s < COUNT(clouds); s += is_night ? 1 : 2) {
        OWNED(media) struct test_scene test;
        build_lit(&test, clouds[s].build);
        judge_by_oracle(*state, clouds[s].name, &test, s >= FIRST_SLOW ? 128 : 256);
    }
}

static void test_a_grid_in_fog_is_that_of_the_oracle(void **state)
{
    OWNED(media) struct test_scene test;
    test_scene_build(&test, scene_grid);
    add_bank(&test, 0.3);
    test.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    judge_by_oracle(*state, "grid in fog", &test, 128);
}

/* Single scattering with guessed collisions and everything that affects them: colour, fog, a
 * shadowing solid, environment light. */
static void test_guessed_clouds_are_those_of_the_oracle(void **state)
{
    neph_test_waits_for_the_night();
    OWNED(media) struct test_scene test;
    test_scene_build(&test, scene_horizon);
    test.scene.media[0].extinction_per_m *= 3.0;
    test.scene.sun.direction = neph_vec3_normalize((struct neph_vec3){0.05, 0.5, -1.0});
    test.scene.environment_light = true;
    judge_by_oracle(*state, "Horizon, single", &test, 128);
}

/* Single nodes in empty space: nearly every node is far above the density around it. 16 nodes have
 * 17 cells with their ramps and 16 majorants with faces inside cells. */
static void scene_spikes(struct test_scene *test)
{
    struct neph_medium *medium = test_add_cloud(test, NEPH_MEDIUM_GRID, 30.0);
    struct neph_diag diag = {0};
    const int size[3] = {16, 16, 16};
    neph_assert_ok(neph_grid_create(size, (struct neph_vec3){-1.0, 0.6, -4.0},
                                    (struct neph_vec3){0.13, 0.13, 0.13}, &medium->grid, &diag),
                   &diag);
    uint64_t random = seed;
    for (int i = 0; i < 16 * 16 * 16; i++)
        medium->grid->values[i] = neph_test_uniform(&random, 0.0, 1.0) < 0.1 ? 1.0f : 0.0f;
    neph_assert_ok(neph_grid_seal(medium->grid, &diag), &diag);
}

/* Majorants bound the nodes that the device draws, not only their mean: else light would leak
 * through. */
static void test_spikes_are_those_of_the_oracle(void **state)
{
    OWNED(media) struct test_scene test;
    build_lit(&test, scene_spikes);
    judge_by_oracle(*state, "spikes", &test, 1024);
}

/* A very thin cloud without light so far does not count as an error of 0. */
static void test_no_light_is_no_target_reached(void **state)
{
    struct test_scene test;
    test_scene_init(&test);
    struct neph_medium *breath = test_add_medium(&test, 1e-9, 0.0, 0.0);
    breath->bounds = (struct neph_bounds){{-1.0, 0.6, -4.0}, {1.0, 2.6, -2.0}};
    test.scene.scattering = NEPH_SCATTERING_SINGLE;
    test.scene.sun.irradiance_w_per_m2 = (struct neph_rgb){0.0, 0.0, 0.0};
    struct neph_tracer_params params = make_params(4, 4, 64);
    params.target_error = 0.1;
    struct neph_tracer_stats stats;
    struct neph_image *frame = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_tracer_render(*state, &test.scene, &params, &frame, &stats, &diag), &diag);
    assert_true(stats.samples >= 64 && isinf(stats.error));
    neph_image_destroy(frame);
    test.scene.scattering = NEPH_SCATTERING_NONE;
    neph_assert_ok(neph_tracer_render(*state, &test.scene, &params, &frame, &stats, &diag), &diag);
    assert_true(stats.error == 0.0);
    neph_image_destroy(frame);
}

/* -cos 90 degrees is -6e-17 in double: the sun is at the zenith nevertheless. */
static void test_level_rays_stay_in_their_cells(void **state)
{
    static const double leanings[] = {0.0, 1e-23, -1e-23, -6.123e-17};
    double sums[4] = {0.0};
    for (int i = 0; i < 4; i++) {
        OWNED(media) struct test_scene test;
        build_lit(&test, scene_spikes);
        test.scene.sun.direction = (struct neph_vec3){leanings[i], 1.0, 0.0};
        const struct neph_tracer_params params = make_params(16, 9, 64);
        OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
        const float *green = neph_image_channel(frame, "G");
        for (size_t p = 0; p < neph_image_pixel_count(frame); p++)
            sums[i] += (double)green[p];
        neph_assert_close(sums[i], sums[0], 1e-5, 0.0);
    }
}

static double one(const struct test_scene *test, const struct neph_pixel_ray *ray, int i,
                  int channel, const void *context)
{
    return 1.0;
}

/* White media and solids in uniform light. */
static void heat(struct test_scene *test)
{
    for (int m = 0; m < test->scene.medium_count; m++)
        test->scene.media[m].albedo = white;
    for (int i = 0; i < test->scene.solid_count; i++)
        test->scene.solids[i].albedo = white;
    test->scene.sun.present = false;
    test->scene.environment_light = true;
    test->scene.background_w_per_m2_sr = white;
    test->scene.scattering = NEPH_SCATTERING_MULTIPLE;
}

/* Every medium and every channel. Where paths serve all channels at once their weights are random;
 * else each path finds 1. */
static void test_clouds_in_the_white_furnace(void **state)
{
    for (size_t s = 0; s < COUNT(clouds); s++) {
        if (s > 0 && s < FIRST_SLOW && !neph_test_is_night())
            continue; /* need kernels of their own, and are part of "all media" */
        OWNED(media) struct test_scene test;
        test_scene_build(&test, clouds[s].build);
        heat(&test);
        const struct neph_tracer_params params = make_params(16, 9, 128);
        struct neph_tracer_stats stats;
        OWNED(image) struct neph_image *frame = render(*state, &test, &params, &stats);
        const struct verdict v = compare(&test, frame, one, NULL);
        judge(clouds[s].name, v, 0.3);
        assert_true(neph_doubt_of_frame(&stats.doubt) < NEPH_DOUBTFUL);
        assert_true(v.count == 0 || s >= FIRST_OF_CHANCE);
    }
}

/* --- multiple scattering: a half-space ----------------------------------------------------- */

/* Chandrasekhar's half-space, and the depth of a slab that stands for it: with albedo 0.9 an
 * optical depth of 40 transmits e^-(0.5 * 40). */
static double half_space(const struct test_scene *test, const struct neph_pixel_ray *ray, int i,
                         int channel, const void *context)
{
    const double mu0 = test->scene.sun.direction.y, mu = -ray->direction.y;
    return 0.9 / (4.0 * M_PI) * mu0 / (mu + mu0) * neph_chandrasekhar_h(0.9, mu) *
           neph_chandrasekhar_h(0.9, mu0);
}

static void test_the_half_space_is_chandrasekhars(void **state)
{
    const struct neph_slab_params slab = {40.0, 0.9, {NEPH_PHASE_ISOTROPIC, 0.0}, 0.6, 0, NULL, 0};
    const struct neph_tracer_params params = make_params(32, 18, 256);
    struct test_scene test;
    slab_scene(&test, &slab, false, 0.04);
    OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
    judge("half-space", compare(&test, frame, half_space, NULL), 0.1);
}

/* --- emission ----------------------------------------------------------------------------- */

/* Visible emission, with single scattering of sunlight and in darkness without scattering:
 * overlapping fogs, with forced first collisions, and a blob. Single scattering is the sun's
 * only. */
static void test_emission_that_is_seen(void **state)
{
    for (int is_dark = 0; is_dark < 2; is_dark++) {
        struct test_scene test;
        test_scene_build(&test, scene_overlapping_media);
        test_add(&test, make_blob(0.2, (struct neph_vec3){1.0, 2.0, -12.0}, 2.0));
        test.scene.media[test.scene.medium_count - 1].albedo = make_grey(0.3);
        make_glow(&test);
        if (is_dark) {
            test.scene.sun.present = false;
            test.scene.scattering = NEPH_SCATTERING_NONE;
        }
        const struct neph_tracer_params params = make_params(32, 18, 256);
        OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
        const struct verdict v = compare(&test, frame, exact_single, NULL);
        print_message("emission: sum off by %+.1e +- %.1e\n", v.bias, v.bias_error);
        assert_true(fabs(v.bias) < 4.0 * v.bias_error && v.bias_error < 5e-3);
        for (size_t i = 0; is_dark && i < neph_image_pixel_count(frame); i++)
            assert_true(neph_image_channel(frame, "order1.G")[i] == 0.0f);
    }
}

/* --- dark media --------------------------------------------------------------------------- */

/* Every pixel within 4.5 standard errors and rounding, and the error below a third of the value:
 * 256 samples, half of them shared out to the media, a few with more weight. */
static void check_pixel_errors(const char *name, const struct neph_image *frame,
                               const struct test_scene *test)
{
    const struct test_rgb radiance = test_layer(frame, NULL),
                          variance = test_layer(frame, "variance");
    for (int i = 0; i < frame->width_px * frame->height_px; i++) {
        const struct neph_rgb light =
            test_exact_ray(&test->scene, frame->width_px, frame->height_px, i).volume;
        const double expected[3] = {light.r, light.g, light.b};
        for (int c = 0; c < 3; c++) {
            const double found = (double)radiance.of[c][i], error = sqrt((double)variance.of[c][i]);
            if (!(fabs(found - expected[c]) <= 4.5 * error + 4.0 * rounding * expected[c] &&
                  error < expected[c] / 3.0))
                fail_msg("%s, pixel %d, channel %d: %g +- %g, expected %g", name, i, c, found,
                         error, expected[c]);
        }
    }
}

/* A bright medium of optical depth 1e-6 in a dark one that takes all collisions: by emission, by
 * sunlight, and with all orders, of which there is one. */
static void test_bright_media_in_dark_ones(void **state)
{
    for (int kind = 0; kind < 3; kind++) {
        struct test_scene test;
        test_scene_init(&test);
        test.scene.background_w_per_m2_sr = make_grey(0);
        test_add_medium(&test, 0.05, 0.0, 0.0)->albedo = make_grey(0);
        struct neph_medium *blob = test_add(
            &test, make_blob(1e-7, (struct neph_vec3){0.0, 2.0, -12.0}, 4.0));
        blob->albedo = make_grey(0.5);
        test.scene.media[0].bounds = (struct neph_bounds){{-90, -90, -90}, {90, 90, 90}};
        if (kind == 0) {
            test.scene.scattering = NEPH_SCATTERING_NONE;
            blob->emission_w_per_m2_sr = (struct neph_rgb){1, 20, 400};
        }
        const struct neph_tracer_params params = make_params(6, 4, 256);
        if (kind == 2)
            test.scene.scattering = NEPH_SCATTERING_MULTIPLE;
        OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
        test.scene.scattering = kind == 0 ? NEPH_SCATTERING_NONE : NEPH_SCATTERING_SINGLE;
        check_pixel_errors("dark", frame, &test);
    }
}

/* A frame of 4 x 3 pixels; at least `seen_least` of its 36 values must be above 0. */
static void compare_with_oracle(struct neph_vulkan *vulkan, const struct test_scene *test,
                                int seen_least)
{
    const struct neph_tracer_params params = make_params(4, 3, 256);
    OWNED(image) struct neph_image *frame = render(vulkan, test, &params, NULL);
    OWNED(image) struct neph_image *truth = test_oracle(&test->scene, 4, 3, 5, 256);
    const struct test_rgb found_in = test_layer(frame, NULL), truth_in = test_layer(truth, NULL);
    const struct test_rgb found_variance = test_layer(frame, "variance"),
                          truth_variance = test_layer(truth, "variance");
    int seen = 0; /* values above 0 */
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < 12; i++) {
            const double found = (double)found_in.of[c][i], expected = (double)truth_in.of[c][i];
            const double error = sqrt((double)found_variance.of[c][i] +
                                      (double)truth_variance.of[c][i]);
            seen += expected > 0.0;
            if (!(fabs(found - expected) <= 4.5 * error + 4.0 * rounding * expected &&
                  error <= 0.5 * expected))
                fail_msg("pixel %d, channel %d: %g +- %g, the oracle %g", i, c, found, error,
                         expected);
        }
    assert_true(seen >= seen_least);
}

/* In Horizon layers, where the device guesses optical depths: thin emission, compared with the
 * oracle. The frame's corners do not meet it. */
static void test_a_glow_in_dark_clouds(void **state)
{
    OWNED(media) struct test_scene test;
    test_scene_build(&test, scene_horizon);
    test.scene.scattering = NEPH_SCATTERING_NONE;
    test.scene.background_w_per_m2_sr = make_grey(0);
    test.scene.solid_count = 0;
    test_add(&test, make_blob(1e-7, (struct neph_vec3){0.0, 200.0, -600.0}, 80.0));
    for (int m = 0; m < test.scene.medium_count; m++)
        test.scene.media[m].albedo = make_grey(0);
    test.scene.media[test.scene.medium_count - 1].emission_w_per_m2_sr = (struct neph_rgb){1, 20,
                                                                                           400};
    compare_with_oracle(*state, &test, 18);
}

/* The sun below a fog without ground: no sunlight arrives, the tables of the guess are dark, and
 * only the fog's emission remains. The wall ends the rays, and so the guesses. */
static void test_a_guess_without_sunlight(void **state)
{
    OWNED(media) struct test_scene test;
    test_scene_build(&test, scene_horizon);
    test.key.look_at_m = (struct neph_vec3){0.0, 2.4, -10.0};
    test.scene.sun.direction = neph_vec3_normalize((struct neph_vec3){0.1, -1.0, 0.2});
    struct neph_medium *fog = test_add_medium(&test, 2e-3, 0.02, 0.0);
    fog->albedo = make_grey(0.5);
    fog->emission_w_per_m2_sr = (struct neph_rgb){4, 2, 1};
    compare_with_oracle(*state, &test, 36);
}

/* --- same bits ---------------------------------------------------------------------------- */

/* Splitting paths between dispatches does not change the result, in the middle of a grid either. */
static void dispatches_change_no_bit(void **state, void (*build)(struct test_scene *))
{
    static const struct {
        uint32_t turns, part_pixels;
    } cuts[] = {{1, 0}, {7, 50}, {100, 9}};
    OWNED(media) struct test_scene test;
    build_lit(&test, build);
    struct neph_tracer_params params = make_params(9, 7, 16);
    struct neph_tracer_stats of_first, stats;
    OWNED(image) struct neph_image *first = render(*state, &test, &params, &of_first);
    for (size_t i = 0; i < COUNT(cuts); i++) {
        params.dispatch_turns = cuts[i].turns;
        params.part_pixels = cuts[i].part_pixels;
        OWNED(image) struct neph_image *frame = render(*state, &test, &params, &stats);
        assert_same_bits(first, frame);
        assert_int_equal(of_first.collisions, stats.collisions);
        assert_int_equal(of_first.lookups, stats.lookups);
        assert_int_equal(of_first.closed_forms, stats.closed_forms);
    }
}

static void test_dispatches_change_no_bit(void **state)
{
    dispatches_change_no_bit(state, scene_fogs_and_ball);
    dispatches_change_no_bit(state, scene_all);
    dispatches_change_no_bit(state, scene_horizon);
}

/* Two seeds: the z-scores of their difference are those for independent frames. */
static void test_seeds_are_independent(void **state)
{
    struct test_scene test;
    build_lit(&test, scene_fogs_and_ball);
    struct neph_tracer_params params = make_params(24, 14, 128);
    OWNED(image) struct neph_image *a = render(*state, &test, &params, NULL);
    params.seed++;
    OWNED(image) struct neph_image *b = render(*state, &test, &params, NULL);
    assert_true(judge_pair("two seeds", a, b, 0.1) > 300);
}

/* The doubt from the squares of squared differences is that of normal noise, 2 by the number of
 * pairs of all pixels, where the light of all paths is alike, and does not depend on the unit of
 * light, in which the fourth powers would leave float32. */
static void test_doubt_of_the_variance(void **state)
{
    struct test_scene test;
    double doubts[3];
    for (int i = 0; i < 3; i++) {
        build_lit(&test, scene_fogs_and_ball);
        const float unit = i == 0 ? 1.0f : i == 1 ? 0x1p-40f : 0x1p40f;
        test.scene.sun.irradiance_w_per_m2 = neph_rgb_scale(test.scene.sun.irradiance_w_per_m2,
                                                            (double)unit);
        test.scene.background_w_per_m2_sr = neph_rgb_scale(test.scene.background_w_per_m2_sr,
                                                           (double)unit);
        const struct neph_tracer_params params = make_params(24, 14, 64);
        struct neph_tracer_stats stats;
        neph_image_destroy(render(*state, &test, &params, &stats));
        doubts[i] = neph_doubt_of_frame(&stats.doubt);
    }
    print_message("doubt %g, %g, %g; of normal noise %g\n", doubts[0], doubts[1], doubts[2],
                  2.0 / (32 * 24 * 14));
    assert_true(doubts[0] > 2.0 / (32 * 24 * 14) && doubts[0] < NEPH_DOUBTFUL);
    neph_assert_close(doubts[1], doubts[0], 1e-6, 0.0);
    neph_assert_close(doubts[2], doubts[0], 1e-6, 0.0);
}

/* --- checkpoints, targets, limits --------------------------------------------------------- */

static void refuses(struct neph_vulkan *vulkan, const struct test_scene *test,
                    const struct neph_tracer_params *params, enum neph_status status,
                    const char *words)
{
    struct neph_image *frame = NULL;
    struct neph_diag diag = {0};
    assert_int_equal(neph_tracer_render(vulkan, &test->scene, params, &frame, NULL, &diag), status);
    assert_non_null(strstr(diag.message, words));
    assert_null(frame);
}

static void test_a_checkpoint_pause_keeps_the_bits(void **state)
{
    struct test_scene test;
    build_lit(&test, scene_fogs_and_ball);
    char folder[] = "/tmp/neph-test-XXXXXX";
    assert_non_null(mkdtemp(folder));
    OWNED(memory) char *path = neph_path_join(folder, "sums");
    struct neph_tracer_params params = make_params(24, 16, 32);
    struct neph_tracer_stats straight_stats, rested_stats;
    OWNED(image) struct neph_image *straight = render(*state, &test, &params, &straight_stats);
    params.checkpoint = path;
    params.samples = 8;
    neph_image_destroy(render(*state, &test, &params, NULL));
    params.samples = 32;
    OWNED(image) struct neph_image *rested = render(*state, &test, &params, &rested_stats);
    assert_true(test_same_bits(straight, rested));
    assert_int_equal(straight_stats.collisions, rested_stats.collisions);
    const double doubt = neph_doubt_of_frame(&straight_stats.doubt);
    assert_true(doubt > 0.0 && doubt < NEPH_DOUBTFUL);
    assert_true(doubt == neph_doubt_of_frame(&rested_stats.doubt));
    assert_int_equal(rested_stats.samples, 32);
    OWNED(image)
    struct neph_image *again = render(*state, &test, &params, NULL); /* nothing remains to do */
    assert_true(test_same_bits(straight, again));

    struct neph_diag diag = {0};
    params.seed++;
    refuses(*state, &test, &params, NEPH_ERR_INPUT, "");
    params.seed--;
    neph_assert_ok(neph_file_write(path, "neph-checkpoint 1 ", 18, &diag), &diag);
    refuses(*state, &test, &params, NEPH_ERR_INPUT, "");
    neph_assert_ok(neph_dir_remove(folder, &diag), &diag);
}

static void test_targets_and_time_limits_stop(void **state)
{
    struct test_scene test;
    build_lit(&test, scene_fogs_and_ball);
    struct neph_tracer_params params = make_params(24, 16, 1 << 20);
    struct neph_tracer_stats stats;
    params.target_error = 0.1;
    neph_image_destroy(render(*state, &test, &params, &stats));
    assert_true(stats.error <= 0.1 && stats.samples < 1024);
    struct neph_tracer_stats again; /* the clock does not affect where it stops */
    neph_image_destroy(render(*state, &test, &params, &again));
    assert_int_equal(stats.samples, again.samples);
    params.target_error = 0.0;
    params.time_limit_s = 0.3;
    neph_image_destroy(render(*state, &test, &params, &stats));
    assert_true(stats.wall_s < 3.0 && stats.samples >= NEPH_TRACER_BATCH_SAMPLES);
}

static void test_all_sizes(void **state)
{
    static const int sizes[][2] = {{1, 1}, {1, 9}, {7, 1}, {13, 11}, {65, 3}};
    struct test_scene test;
    build_lit(&test, scene_fogs_and_ball);
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
        const struct neph_tracer_params params = make_params(sizes[i][0], sizes[i][1], 2);
        struct neph_tracer_stats stats;
        OWNED(image) struct neph_image *frame = render(*state, &test, &params, &stats);
        assert_int_equal(frame->width_px, sizes[i][0]);
        assert_int_equal(frame->height_px, sizes[i][1]);
        assert_int_equal(stats.samples, NEPH_TRACER_BATCH_SAMPLES);
    }
}

static void test_refusals(void **state)
{
    OWNED(media) struct test_scene test;
    build_lit(&test, scene_fogs_and_ball);
    const struct neph_tracer_params good = make_params(4, 4, 8);
    struct neph_tracer_params bad[] = {good, good, good, good, good};
    bad[0].width_px = 0;
    bad[1].height_px = NEPH_TRACER_SIDE_MAX_PX + 1;
    bad[2].samples = 1;
    bad[3].target_error = NAN;
    bad[4].time_limit_s = 0.0;
    for (size_t i = 0; i < COUNT(bad); i++)
        refuses(*state, &test, &bad[i], NEPH_ERR_USAGE, "");
    test_scene_init(&test);
    test_add_medium(&test, 0.1, 0.0, 0.0)->albedo = (struct neph_rgb){1.0, 1.0, 1.0};
    test.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    refuses(*state, &test, &good, NEPH_ERR_UNSUPPORTED, "no end");
    /* A small sphere in it is no ground; a fog that ends below but not above has no top. */
    test_add_sphere(&test, (struct neph_vec3){5.0, 0.0, -9.0}, 1.0);
    refuses(*state, &test, &good, NEPH_ERR_UNSUPPORTED, "");
    test.scene.media[0].bounds.min_m.y = -10.0;
    refuses(*state, &test, &good, NEPH_ERR_UNSUPPORTED, "");
    test_scene_build(&test, scene_two_coloured);
    test_add_medium(&test, 0.1, 0.1, 0.0)->extinction_color.r = 2.0;
    test.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    refuses(*state, &test, &good, NEPH_ERR_UNSUPPORTED, "coloured");
}

/* Must be the last test: the interrupt flag stays set. */
static void test_interrupt_stops_the_render(void **state)
{
    struct test_scene test;
    build_lit(&test, scene_fogs_and_ball);
    const struct neph_tracer_params params = make_params(8, 8, 1 << 20);
    signal(SIGINT, SIG_DFL); /* a background shell ignores it */
    neph_interrupt_install();
    raise(SIGINT);
    refuses(*state, &test, &params, NEPH_ERR_INTERRUPTED, "");
}

int main(void)
{
    print_message("seed %llu\n", (unsigned long long)seed);
    const struct CMUnitTest tests[] = {
#include "cases/test_tracer.inc"
    };
    return cmocka_run_group_tests(tests, test_vulkan_setup, test_vulkan_teardown);
}
