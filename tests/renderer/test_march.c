/* SPDX-License-Identifier: MIT
 *
 * The ray marcher compared with exact transport in double precision: transmittance in closed form,
 * order of convergence of in-scattered radiance, solids and their shadows, exact counters,
 * reproducible bits, and finite results for extreme inputs.
 */
#include "tests/renderer/fog_scenes.h"
#include "tests/renderer/frames.h"

#include "base/interrupt.h"
#include "renderer/shaders/constants.h"
#include "scenes/media.h"
#include "scenes/solids.h"

#include <signal.h>

static const uint64_t seed = 20240607;

static const struct neph_march_params exact_48 = {.width_px = 48,
                                                  .height_px = 36,
                                                  .steps = 64,
                                                  .transmittance = NEPH_MARCH_EXACT,
                                                  .sun = NEPH_MARCH_EXACT};

/* A frame with few rays. */
static struct neph_march_params tiny(int steps)
{
    struct neph_march_params params = exact_48;
    params.width_px = 8;
    params.height_px = 6;
    params.steps = steps;
    return params;
}

/* The media of every scene here, in this order; additional media of a scene come after them. */
static const struct {
    enum neph_medium_kind kind;
    int layers;
} sorts[] = {{NEPH_MEDIUM_HOMOGENEOUS, 1},
             {NEPH_MEDIUM_HEIGHT_FOG, 1},
             {NEPH_MEDIUM_HEIGHT_FOG, 2},
             {NEPH_MEDIUM_HEIGHT_FOG, 2}};

/* Layers with extinction, as the device counts them. */
static int count_layers(const struct neph_medium *medium)
{
    int count = 0;
    for (int i = 0; i < medium->layer_count; i++)
        count += medium->layers[i].extinction_per_m > 0.0;
    return count;
}

/* A place that no ray reaches: behind the camera and below. */
static struct neph_vec3 stand_in_place_m(const struct test_scene *test)
{
    return neph_vec3_add(test->key.position_m, (struct neph_vec3){0.0, -500.0, 500.0});
}

static struct neph_medium stand_in(const struct test_scene *test, size_t sort)
{
    const struct neph_vec3 at_m = stand_in_place_m(test), half_m = {1.0, 1.0, 1.0};
    struct neph_medium medium = test->scene.media[0];
    medium.kind = sorts[sort].kind;
    medium.layer_count = sorts[sort].layers;
    medium.bounds = (struct neph_bounds){neph_vec3_sub(at_m, half_m), neph_vec3_add(at_m, half_m)};
    for (int i = 0; i < medium.layer_count; i++)
        medium.layers[i] = (struct neph_fog_layer){
            0.1, medium.kind == NEPH_MEDIUM_HOMOGENEOUS ? 0.0 : 0.1, at_m.y};
    return medium;
}

/* A scene with invisible media for the kinds that it lacks, and with a sphere that might shadow a
 * medium: all scenes then share one kernel, and compiling it is most of a test's time. */
static void add_shared_kernel_media(const struct test_scene *test, struct test_scene *with)
{
    bool is_placed[NEPH_SCENE_MEDIA_MAX] = {false};
    *with = *test;
    with->scene.medium_count = 0;
    for (size_t s = 0; s < COUNT(sorts); s++) {
        int m = 0;
        while (m < test->scene.medium_count &&
               (is_placed[m] || test->scene.media[m].kind != sorts[s].kind ||
                count_layers(&test->scene.media[m]) != sorts[s].layers))
            m++;
        is_placed[m] = true;
        test_add(with, m < test->scene.medium_count ? test->scene.media[m] : stand_in(test, s));
    }
    for (int m = 0; m < test->scene.medium_count; m++)
        if (!is_placed[m])
            test_add(with, test->scene.media[m]);
    if (test->scene.solids == test->solids) {
        with->scene.solids = with->solids;
        test_add_sphere(with, stand_in_place_m(test), 0.1);
    }
}

static struct neph_image *render(struct neph_vulkan *vulkan, const struct test_scene *test,
                                 const struct neph_march_params *params,
                                 struct neph_march_stats *stats)
{
    struct test_scene with;
    add_shared_kernel_media(test, &with);
    struct neph_image *frame = test_march(vulkan, &with.scene, params, stats);
    assert_int_equal(frame->channel_count, neph_image_channel(frame, "volume.distance") ? 11 : 10);
    return frame;
}

/* --- transmittance ------------------------------------------------------------------------ */

static void scene_homogeneous(struct test_scene *test)
{
    test_add_medium(test, 0.02, 0.0, 0.0);
    test_add_box(test, (struct neph_vec3){-1e4, -10.0, -1e4}, (struct neph_vec3){1e4, 0.0, 1e4});
    test_add_sphere(test, (struct neph_vec3){2.0, 3.0, -40.0}, 6.0);
}

static void scene_fog_up(struct test_scene *test)
{
    scene_fog(test);
    test->key.look_at_m = (struct neph_vec3){3.0, 9.0, -5.0};
}

static void scene_fog_two_layers(struct test_scene *test)
{
    struct neph_medium *fog = test_add_medium(test, 0.01, 0.02, 0.0);
    test_add_layer(fog, 0.08, 0.4, 1.0);
    test_add_box(test, (struct neph_vec3){-1e3, -1.0, -1e3}, (struct neph_vec3){1e3, 0.0, 1e3});
}

static const struct {
    const char *name;
    void (*build)(struct test_scene *);
} transmittance_scenes[] = {
    {"homogeneous", scene_homogeneous},
    {"cube", scene_cube},
    {"fog, level", scene_fog},
    {"fog, up", scene_fog_up},
    {"fog, down", scene_fog_down},
    {"fog, two layers", scene_fog_two_layers},
    {"overlapping media", scene_overlapping_media},
    {"far from the origin", scene_far_from_the_origin},
};

struct worst {
    double relative, absolute; /* of pixels with a transmittance above 0.01; of all */
};

static struct worst compare_transmittance(const struct test_scene *test,
                                          const struct neph_image *frame, double relative,
                                          double absolute)
{
    const float *actual = neph_image_channel(frame, "transmittance.G");
    struct worst worst = {0.0, 0.0};
    for (int p = 0; p < frame->width_px * frame->height_px; p++) {
        const struct neph_pixel_ray ray = test_ray(&test->scene, frame->width_px, frame->height_px,
                                                   p);
        const double end_m = neph_scene_hit(&test->scene, ray.origin_m, ray.direction).t_m;
        const double expected = exp(
            -neph_scene_optical_depth(&test->scene, ray.origin_m, ray.direction, 0.0, end_m).r);
        const double error = fabs((double)actual[p] - expected);
        worst.absolute = fmax(worst.absolute, error);
        if (expected > 0.01)
            worst.relative = fmax(worst.relative, error / expected);
        if (error > relative * expected && error > absolute)
            fail_msg("pixel %d: transmittance %.9g, expected %.9g", p, (double)actual[p], expected);
    }
    return worst;
}

/* 1e-5 relative or 1e-6 absolute: an optical depth of 10 with the relative error 1e-6, the rounding
 * error of a height 10 scale heights away in float32. */
static void test_transmittance_is_the_closed_form(void **state)
{
    const size_t count = sizeof(transmittance_scenes) / sizeof(transmittance_scenes[0]);
    for (size_t s = 0; s < count; s++) {
        struct test_scene test;
        test_scene_build(&test, transmittance_scenes[s].build);
        OWNED(image) struct neph_image *frame = render(*state, &test, &exact_48, NULL);
        const struct worst worst = compare_transmittance(&test, frame, 1e-5, 1e-6);
        print_message("%-20s T off by %.1e of itself (T > 0.01), %.1e absolute\n",
                      transmittance_scenes[s].name, worst.relative, worst.absolute);
    }
}

/* Two steps suffice for a homogeneous medium; fog converges with the square of the step. */
static void test_marched_transmittance(void **state)
{
    struct neph_march_params params = exact_48;
    params.transmittance = NEPH_MARCH_MARCHED;
    struct test_scene test;

    test_scene_build(&test, scene_cube);
    params.steps = 2;
    struct neph_image *frame = render(*state, &test, &params, NULL);
    compare_transmittance(&test, frame, 1e-5, 1e-6);
    neph_image_destroy(frame);

    test_scene_build(&test, scene_fog_two_layers);
    params = tiny(8192);
    params.transmittance = NEPH_MARCH_MARCHED;
    frame = render(*state, &test, &params, NULL);
    const struct worst worst = compare_transmittance(&test, frame, 1e-4, 2e-6);
    print_message("8192 marched steps: T off by %.1e of itself, %.1e absolute\n", worst.relative,
                  worst.absolute);
    neph_image_destroy(frame);
}

/* --- in-scattering ------------------------------------------------------------------------ */

/* Mean over pixels and channels of |volume - reference|, over the mean of the reference. Silhouette
 * pixels, in which only one side hits the solid, are left out. */
static double volume_error(const struct neph_image *frame, const struct neph_ray_light *light)
{
    const struct test_rgb volume = test_layer(frame, "volume");
    const float *depth_m = neph_image_channel(frame, "Z");
    double error = 0.0, total = 0.0;
    for (size_t i = 0; i < neph_image_pixel_count(frame); i++) {
        if (!isinf(depth_m[i]) != !isinf(light[i].hit_m))
            continue;
        for (int c = 0; c < 3; c++) {
            error += fabs((double)volume.of[c][i] - (&light[i].volume.r)[c]);
            total += (&light[i].volume.r)[c];
        }
    }
    return error / total;
}

static const struct {
    const char *name;
    void (*build)(struct test_scene *);
} smooth_scenes[] = {
    {"cube", scene_cube},
    {"fog, up", scene_fog_up},
    {"fog, down", scene_fog_down},
    {"two layers, up", scene_two_layers_up},
};

/* Order of convergence between two step counts in the asymptotic range, above the float32 error of
 * a few 1e-7. */
static void check_order(struct neph_vulkan *vulkan, const char *name, const struct test_scene *test,
                        enum neph_march_mode transmittance, enum neph_march_mode sun)
{
    static const int counts[] = {64, 256};
    struct neph_march_params params = tiny(64);
    OWNED(memory)
    struct neph_ray_light *light = test_exact(&test->scene, params.width_px, params.height_px);
    double errors[2];
    params.transmittance = transmittance;
    params.sun = sun;
    for (int c = 0; c < 2; c++) {
        params.steps = params.sun_steps = counts[c];
        OWNED(image) struct neph_image *frame = render(vulkan, test, &params, NULL);
        errors[c] = volume_error(frame, light);
    }
    const double order = log2(errors[0] / errors[1]) / 2.0;
    print_message("%-16s T %d, sun %d: %.1e %.1e  order %.2f\n", name, (int)transmittance, (int)sun,
                  errors[0], errors[1], order);
    assert_true(errors[1] < 5e-7 || order > 1.8);
    assert_true(errors[1] < 5e-3);
}

/* Solids (the ground) are lit but do not shadow the medium here. */
static void test_volume_converges_at_second_order(void **state)
{
    for (size_t s = 0; s < COUNT(smooth_scenes); s++) {
        struct test_scene test;
        test_scene_build(&test, smooth_scenes[s].build);
        for (int modes = 0; modes < 4; modes += neph_test_by_day(3, 1))
            check_order(*state, smooth_scenes[s].name, &test, (enum neph_march_mode)(modes & 1),
                        (enum neph_march_mode)(modes >> 1));
    }
}

/* With many steps only the float32 error remains. */
static void test_volume_has_no_floor_but_float32(void **state)
{
    struct test_scene test;
    test_scene_build(&test, scene_fog_up);
    const struct neph_march_params params = tiny(20000);
    OWNED(memory)
    struct neph_ray_light *light = test_exact(&test.scene, params.width_px, params.height_px);
    struct neph_march_stats stats;
    OWNED(image) struct neph_image *frame = render(*state, &test, &params, &stats);
    const double error = volume_error(frame, light);
    print_message("20000 steps in %d dispatches: volume off by %.1e\n", stats.dispatches, error);
    assert_true(stats.dispatches > 1);
    assert_true(error < 2e-6);
}

/* --- emission ----------------------------------------------------------------------------- */

static void scene_two_fogs_up(struct test_scene *test)
{
    test_add_medium(test, 0.02, 0.05, 0.0);
    test_add_medium(test, 0.05, 0.2, 1.0);
    test->key.look_at_m = (struct neph_vec3){3.0, 9.0, -5.0};
}

/* As for scattered sunlight: second order, down to the float32 error. */
static void test_emission_converges_at_second_order(void **state)
{
    static void (*const builders[])(struct test_scene *) = {scene_cube, scene_fog_up,
                                                            scene_fog_down, scene_two_fogs_up};
    for (size_t s = 0; s < COUNT(builders); s++) {
        struct test_scene test;
        test_scene_build(&test, builders[s]);
        make_glow(&test);
        check_order(*state, "emission", &test, NEPH_MARCH_EXACT, NEPH_MARCH_EXACT);
        check_order(*state, "emission", &test, NEPH_MARCH_MARCHED, NEPH_MARCH_MARCHED);
    }
}

/* In darkness and without scattering: glow (1 - T) for every number of steps, and a distance. */
static void test_an_even_medium_that_glows(void **state)
{
    struct test_scene test;
    test_scene_build(&test, scene_homogeneous);
    make_glow(&test);
    test.scene.sun.present = false;
    test.scene.scattering = NEPH_SCATTERING_NONE;
    test.scene.media[0].extinction_color = (struct neph_rgb){0.5, 1, 3};
    struct neph_march_params params = exact_48;
    params.steps = 7;
    OWNED(memory)
    struct neph_ray_light *light = test_exact(&test.scene, params.width_px, params.height_px);
    OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
    assert_non_null(neph_image_channel(frame, "volume.distance"));
    const float *volume = neph_image_channel(frame, "volume.B");
    for (size_t i = 0; i < neph_image_pixel_count(frame); i++) /* a few roundings per step */
        neph_assert_close((double)volume[i], light[i].volume.b, 7 * 4 * 0x1p-24 + 1e-6, 0.0);
}

/* A fog of optical depth 0.8 that ends after 4 m (without its end it would be opaque after 80 m),
 * in front of an emitting box at 200 m. A step across a face of the box has an error of at most
 * half a step: 1e-2 of the box. */
static void test_a_fog_that_ends_hides_nothing(void **state)
{
    struct test_scene test;
    test_scene_init(&test);
    test.key.position_m = (struct neph_vec3){0, 0, 0};
    test.key.look_at_m = (struct neph_vec3){0, 0, -1};
    test.scene.sun.present = false;
    test_add(&test, make_homogeneous(0.2, (struct neph_bounds){{-9, -9, -9}, {9, 9, -5}}));
    struct neph_medium *box = test_add(
        &test, make_homogeneous(0.1, (struct neph_bounds){{-300, -300, -206}, {300, 300, -200}}));
    box->albedo = make_grey(0.0);
    box->emission_w_per_m2_sr = make_grey(1.0);
    const struct neph_march_params params = tiny(4000);
    OWNED(memory)
    struct neph_ray_light *light = test_exact(&test.scene, params.width_px, params.height_px);
    OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
    const float *volume = neph_image_channel(frame, "volume.G");
    for (size_t i = 0; i < neph_image_pixel_count(frame); i++) {
        assert_true(light[i].volume.g > 0.1);
        neph_assert_close((double)volume[i], light[i].volume.g, 1e-2, 0.0);
    }
}

/* --- solids ------------------------------------------------------------------------------- */

static void scene_fenced_yard(struct test_scene *test)
{
    scene_yard(test);
    for (int i = 0; i < 6; i++) /* a fence of thin bars */
        test_add_box(test, (struct neph_vec3){-3.0 + i, 0.0, -9.0},
                     (struct neph_vec3){-2.98 + i, 1.5, -8.98});
}

/* Fraction of pixels that agree with the exact light in radiance and depth. Rays that graze a solid
 * or a shadow edge may be on either side of it. */
static double agreeing_fraction(const struct neph_image *frame, const struct test_scene *test,
                                double relative, double absolute)
{
    OWNED(memory)
    struct neph_ray_light *light = test_exact(&test->scene, frame->width_px, frame->height_px);
    const struct neph_camera camera = neph_scene_camera(&test->scene, 0.0);
    const float *green = neph_image_channel(frame, "G");
    const float *depth_m = neph_image_channel(frame, "Z");
    size_t agreeing = 0;
    for (int i = 0; i < frame->width_px * frame->height_px; i++) {
        const struct neph_vec3 ray =
            test_ray(&test->scene, frame->width_px, frame->height_px, i).direction;
        const double z_m = light[i].hit_m * neph_vec3_dot(ray, camera.forward);
        const bool same_depth = isinf(z_m) ? isinf(depth_m[i])
                                           : fabs(depth_m[i] - z_m) <= 1e-5 * z_m;
        const double error = fabs(green[i] - light[i].radiance.g);
        agreeing += same_depth && error <= relative * light[i].radiance.g + absolute;
    }
    return (double)agreeing / (double)neph_image_pixel_count(frame);
}

/* More solids than a driver allows for a march of 64 steps in one dispatch. */
static void test_many_solids(void **state)
{
    struct test_scene test;
    test_scene_build(&test, scene_fog_up);
    struct neph_march_params params = exact_48; /* the limit is per pixel */
    params.width_px = 12;
    params.height_px = 9;
    OWNED(image) struct neph_image *without = render(*state, &test, &params, NULL);
    OWNED(memory) struct neph_solid *behind = calloc(NEPH_SCENE_SOLIDS_MAX, sizeof(*behind));
    assert_non_null(behind);
    for (int i = 0; i < NEPH_SCENE_SOLIDS_MAX; i++) /* in the camera's view, not in the sun's */
        behind[i] = (struct neph_solid){
            .kind = NEPH_SOLID_SPHERE, .center_m = {0.0, -10.0, 50.0 + i}, .radius_m = 0.4};
    test.scene.solids = behind;
    test.scene.solid_count = NEPH_SCENE_SOLIDS_MAX;
    struct neph_march_stats stats;
    OWNED(image) struct neph_image *with = render(*state, &test, &params, &stats);
    assert_true(stats.dispatches > 1);
    for (int c = 0; c < with->channel_count; c++)
        assert_memory_equal(with->channels[c].samples, without->channels[c].samples,
                            neph_image_pixel_count(with) * sizeof(float));
    /* The last of them shadows the sun rays of the last step. */
    behind[NEPH_SCENE_SOLIDS_MAX - 1].center_m = neph_vec3_scale(test.scene.sun.direction, 1e4);
    behind[NEPH_SCENE_SOLIDS_MAX - 1].radius_m = 3e3;
    OWNED(image) struct neph_image *shaded = render(*state, &test, &params, NULL);
    const float *volume = neph_image_channel(shaded, "volume.G");
    for (size_t i = 0; i < neph_image_pixel_count(shaded); i++)
        assert_true(volume[i] == 0.0f);
}

static void test_solids_are_lit_through_the_media(void **state)
{
    struct test_scene test;
    test_scene_build(&test, scene_fenced_yard);
    test.scene.scattering = NEPH_SCATTERING_NONE;
    struct neph_march_params params = exact_48;
    params.width_px = 96;
    params.height_px = 72;
    OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
    const double agreeing = agreeing_fraction(frame, &test, 2e-5, 1e-6);
    print_message("no scattering: %.2f %% of the pixels agree\n", 100.0 * agreeing);
    assert_true(agreeing > 0.998);
}

/* A shadow edge falls anywhere within a step: first order, but only there. */
static void test_shadows_in_the_air(void **state)
{
    struct test_scene test;
    test_scene_build(&test, scene_fenced_yard);
    struct neph_march_params params = exact_48;
    params.width_px = 24;
    params.height_px = 18;
    OWNED(memory)
    struct neph_ray_light *light = test_exact(&test.scene, params.width_px, params.height_px);
    double errors[2];
    for (int c = 0; c < 2; c++) {
        params.steps = c ? 2048 : 128;
        OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
        errors[c] = volume_error(frame, light);
        const double agreeing = agreeing_fraction(frame, &test, 2e-3, 0.0);
        print_message("%d steps: volume off by %.1e, %.2f %% of the pixels agree\n", params.steps,
                      errors[c], 100.0 * agreeing);
        assert_true(c == 0 || agreeing > 0.95);
    }
    const double order = log2(errors[0] / errors[1]) / 4.0;
    print_message("order %.2f\n", order);
    assert_true(order > 0.8);
}

/* --- counts and bits ---------------------------------------------------------------------- */

static void assert_counts(struct neph_vulkan *vulkan, const struct test_scene *test,
                          const struct neph_march_params *params, uint64_t density,
                          uint64_t closed_forms)
{
    struct neph_march_stats stats;
    neph_image_destroy(render(vulkan, test, params, &stats));
    assert_int_equal(stats.density_evaluations, density);
    assert_int_equal(stats.closed_forms, closed_forms);
    assert_true(stats.gpu_s > 0.0 && stats.wall_s >= stats.gpu_s);
}

static void test_evaluations_are_counted(void **state)
{
    struct test_scene test;
    test_scene_init(&test);
    test_add_medium(&test, 0.1, 0.0, 0.0); /* unbounded: every ray takes all its steps */
    struct neph_march_params params = {.width_px = 9, .height_px = 7, .steps = 10, .sun_steps = 5};
    const uint64_t pixels = 63;
    assert_counts(*state, &test, &params, pixels * 10, pixels * (10 + 10 + 1));
    params.transmittance = NEPH_MARCH_MARCHED;
    assert_counts(*state, &test, &params, pixels * 10, pixels * 10);
    params.sun = NEPH_MARCH_MARCHED;
    assert_counts(*state, &test, &params, pixels * (10 + 10 * 5), 0);
    params.steps = 3000; /* in several dispatches */
    params.sun_steps = 40;
    assert_counts(*state, &test, &params, pixels * (3000 + 3000 * 40), 0);
    params.transmittance = NEPH_MARCH_EXACT;
    params.steps = 10;
    params.sun_steps = 5;
    assert_counts(*state, &test, &params, pixels * (10 + 10 * 5), pixels * 11);
    /* Nothing to march. */
    test.scene.scattering = NEPH_SCATTERING_NONE;
    assert_counts(*state, &test, &params, 0, pixels);
    test.scene.scattering = NEPH_SCATTERING_SINGLE;
    test.scene.sun.present = false;
    assert_counts(*state, &test, &params, 0, pixels);
    test.scene.sun.present = true;
    test.scene.medium_count = 0;
    params.transmittance = params.sun = NEPH_MARCH_MARCHED;
    assert_counts(*state, &test, &params, 0, 0);
}

/* The mean distance of the visible homogeneous medium is 1 / extinction, the integral of t sigma
 * e^(-sigma t). 512 steps over 16 optical depths sample at their middles, which is too far by the
 * fraction (optical depth of a step)^2 / 12 = 8e-5; the omitted end is 16 e^-16 = 2e-6. */
static void test_distance_of_the_visible_medium(void **state)
{
    struct test_scene test;
    test_scene_init(&test);
    test_add_medium(&test, 0.1, 0.0, 0.0);
    const struct neph_march_params params = {.width_px = 9, .height_px = 7, .steps = 512};
    struct neph_image *frame = render(*state, &test, &params, NULL);
    const float *distance_m = neph_image_channel(frame, "volume.distance");
    assert_non_null(distance_m);
    for (int i = 0; i < 63; i++)
        neph_assert_close(distance_m[i], 10.0, 1e-4, 0.0);
    neph_image_destroy(frame);
    test.scene.scattering = NEPH_SCATTERING_NONE; /* nothing is marched, so there is no distance */
    frame = render(*state, &test, &params, NULL);
    assert_null(neph_image_channel(frame, "volume.distance"));
    neph_image_destroy(frame);
}

static void test_same_inputs_give_the_same_bits(void **state)
{
    struct test_scene test;
    test_scene_build(&test, scene_fenced_yard);
    OWNED(image) struct neph_image *first = render(*state, &test, &exact_48, NULL);
    struct neph_image *again = render(*state, &test, &exact_48, NULL);
    assert_true(test_same_bits(first, again));
    neph_image_destroy(again);

    struct neph_vulkan *other = NULL; /* another device object, without validation */
    struct neph_diag diag = {0};
    neph_assert_ok(neph_vulkan_create(NULL, &other, &diag), &diag);
    again = render(other, &test, &exact_48, NULL);
    assert_true(test_same_bits(first, again));
    neph_image_destroy(again);
    neph_vulkan_destroy(other);
}

/* --- sizes -------------------------------------------------------------------------------- */

static void test_all_sizes(void **state)
{
    static const int sizes[][2] = {{1, 1}, {1, 9}, {7, 1}, {63, 1}, {65, 3}, {4096, 2}, {3, 4096}};
    for (size_t s = 0; s < sizeof(sizes) / sizeof(sizes[0]); s++) {
        struct test_scene test;
        test_scene_build(&test, scene_fog_up);
        struct neph_march_params params = exact_48;
        params.width_px = sizes[s][0];
        params.height_px = sizes[s][1];
        params.steps = 4;
        OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
        assert_int_equal(frame->width_px, sizes[s][0]);
        compare_transmittance(&test, frame, 1e-5, 1e-6);
    }
}

/* A frame of many dispatches: each pixel is in its place. */
static void test_a_frame_of_many_dispatches(void **state)
{
    struct test_scene test;
    test_scene_build(&test, scene_fog_down);
    test.scene.scattering = NEPH_SCATTERING_NONE;
    struct neph_march_params params = exact_48;
    params.width_px = 1021;
    params.height_px = 1033;
    struct neph_march_stats stats;
    OWNED(image) struct neph_image *frame = render(*state, &test, &params, &stats);
    assert_true(stats.dispatches > 1);
    compare_transmittance(&test, frame, 1e-5, 1e-6);
}

static void test_parameters_out_of_range_are_refused(void **state)
{
    static const struct neph_march_params wrong[] = {
        {.width_px = 0, .height_px = 1, .steps = 1},
        {.width_px = 1, .height_px = 4097, .steps = 1},
        {.width_px = 1, .height_px = 1, .steps = 0},
        {.width_px = 1, .height_px = 1, .steps = 65537},
        {.width_px = 1, .height_px = 1, .steps = 1, .sun = NEPH_MARCH_MARCHED},
        {.width_px = 1,
         .height_px = 1,
         .steps = 65536,
         .sun = NEPH_MARCH_MARCHED,
         .sun_steps = 65536},
    };
    struct test_scene test;
    test_scene_build(&test, scene_fog);
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        struct neph_image *frame = NULL;
        struct neph_diag diag = {0};
        assert_int_equal(test_march_frame(*state, &test.scene, &wrong[i], &frame, NULL, &diag),
                         NEPH_ERR_USAGE);
        assert_null(frame);
    }
    /* In range, but more than the driver allows: refused with a message, not truncated. */
    struct neph_march_params many = wrong[5];
    many.steps = 1;
    struct neph_image *frame = NULL;
    struct neph_diag diag = {0};
    assert_int_equal(test_march_frame(*state, &test.scene, &many, &frame, NULL, &diag),
                     NEPH_ERR_UNSUPPORTED);
    print_message("%s\n", diag.message);
}

static void test_unsupported_scenes_are_named(void **state)
{
    struct test_scene test;
    test_scene_build(&test, scene_fog);
    char reason[256] = "";
    assert_true(neph_march_can_render(&test.scene, NEPH_MARCH_SINGLE, reason, sizeof(reason)));
    test.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    assert_false(neph_march_can_render(&test.scene, NEPH_MARCH_SINGLE, reason, sizeof(reason)));
    assert_string_equal(reason, "multiple scattering");
    struct neph_image *frame = NULL;
    struct neph_diag diag = {0};
    assert_int_equal(test_march_frame(*state, &test.scene, &exact_48, &frame, NULL, &diag),
                     NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "cannot: multiple scattering"));

    test.scene.media[0].emission_w_per_m2_sr = white; /* included, but not scattered */
    assert_false(neph_march_can_render(&test.scene, NEPH_MARCH_OCTAVES, reason, sizeof(reason)));
    assert_non_null(strstr(reason, "emit"));
    test.scene.scattering = NEPH_SCATTERING_NONE;
    assert_true(neph_march_can_render(&test.scene, NEPH_MARCH_OCTAVES, reason, sizeof(reason)));
    test.scene.media[0].emission_w_per_m2_sr = make_grey(0);

    test.scene.scattering = NEPH_SCATTERING_SINGLE;
    test.scene.environment_light = true;
    assert_false(neph_march_can_render(&test.scene, NEPH_MARCH_SINGLE, reason, sizeof(reason)));
    test.scene.scattering = NEPH_SCATTERING_NONE; /* nothing remains that it could light */
    assert_true(neph_march_can_render(&test.scene, NEPH_MARCH_SINGLE, reason, sizeof(reason)));
    test_add_sphere(&test, (struct neph_vec3){0.0, 0.0, -5.0}, 1.0);
    assert_false(neph_march_can_render(&test.scene, NEPH_MARCH_SINGLE, reason, sizeof(reason)));
    test.scene.background_w_per_m2_sr = (struct neph_rgb){0.0, 0.0, 0.0};
    assert_true(neph_march_can_render(&test.scene, NEPH_MARCH_SINGLE, reason, sizeof(reason)));
}

/* --- extremes ----------------------------------------------------------------------------- */

static double pick(uint64_t *random, const double *values, size_t count)
{
    return values[neph_test_random(random) % count];
}
#define PICK(random, values) pick((random), (values), sizeof(values) / sizeof((values)[0]))

static void build_extreme_scene(uint64_t *random, struct test_scene *test)
{
    static const double heights[] = {0.0, 1.6, -1e3, 1e3, 1e6, -1e6, 1e9};
    static const double extinctions[] = {0.0, 1e-40, 1e-12, 1e-3, 0.1, 1e3, 1e20, 1e30};
    static const double falloffs[] = {0.0, 1e-12, 1e-3, 0.1, 10.0, 1e4};
    static const double components[] = {0.0, 1e-30, 1e-9, 1.0, -1.0, 0.3};
    static const double sides[] = {INFINITY, 1e9, 100.0, 0.0, 1e-6};
    static const double gs[] = {0.0, 0.999, -0.999, 0.9};
    test_scene_init(test);
    test->key.position_m.y = PICK(random, heights);
    test->key.look_at_m = neph_vec3_add(
        test->key.position_m,
        (struct neph_vec3){PICK(random, components), PICK(random, components), -1.0});
    test->scene.sun.direction = neph_vec3_normalize((struct neph_vec3){
        PICK(random, components), PICK(random, components) + 1e-3, PICK(random, components)});
    const bool is_simple = neph_test_random(random) % 8 == 0;
    for (int i = 0; i < (is_simple ? 1 : 3); i++) {
        struct neph_medium *medium = test_add_medium(test, PICK(random, extinctions),
                                                     PICK(random, falloffs), PICK(random, heights));
        if (i > 0) {
            medium->kind = NEPH_MEDIUM_HEIGHT_FOG;
            test_add_layer(medium, PICK(random, extinctions), PICK(random, falloffs),
                           PICK(random, heights));
        }
        medium->phase.g = PICK(random, gs);
        medium->bounds.min_m.y = -PICK(random, sides);
        medium->bounds.max_m.y = PICK(random, sides);
        medium->bounds.min_m.x = -PICK(random, sides);
        medium->bounds.max_m.z = PICK(random, sides);
    }
    if (neph_test_random(random) % 2)
        test_add_box(test, (struct neph_vec3){-1e6, -1e6, -1e6}, (struct neph_vec3){1e6, 0.0, 1e6});
    if (neph_test_random(random) % 2)
        test_add_sphere(test, (struct neph_vec3){0.0, PICK(random, heights), -1e4}, 1e3);
}

/* Whether a scene has more media than a kernel can be specialized for. */
static bool is_crowd(const struct test_scene *test)
{
    struct test_scene with;
    add_shared_kernel_media(test, &with);
    int count = 0;
    for (int m = 0; m < with.scene.medium_count; m++)
        count += count_layers(&with.scene.media[m]) > 0;
    return count > NEPH_GPU_KNOWN_MEDIA_MAX;
}

/* Number of samples of a layer that are NaN, infinite, negative or above a maximum. */
static size_t count_nonsense(const struct neph_image *frame, const char *layer, double maximum)
{
    const struct test_rgb samples = test_layer(frame, layer);
    size_t count = 0;
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < neph_image_pixel_count(frame); i++)
            count += !(samples.of[c][i] >= 0.0f && samples.of[c][i] <= maximum);
    return count;
}

static void test_extreme_inputs_are_finite(void **state)
{
    const int rounds = neph_test_by_day(200, 400);
    uint64_t random = seed;
    size_t nonsense = 0, samples = 0;
    int crowds = 0;
    for (int round = 0; round < rounds; round++) {
        struct test_scene test;
        char too_far[256];
        do
            build_extreme_scene(&random, &test);
        while (!neph_march_can_render(&test.scene, NEPH_MARCH_SINGLE, too_far, sizeof(too_far)));
        struct neph_march_params params = {
            .width_px = 9,
            .height_px = 7,
            .steps = 1 + (int)(neph_test_random(&random) % 40),
            .transmittance = (enum neph_march_mode)(neph_test_random(&random) % 2),
            .sun = (enum neph_march_mode)(neph_test_random(&random) % 2),
            .sun_steps = 1 + (int)(neph_test_random(&random) % 10),
        };
        if (is_crowd(&test)) { /* needs other kernels; two of the four suffice */
            params.sun = params.transmittance;
            crowds++;
        }
        OWNED(image) struct neph_image *frame = render(*state, &test, &params, NULL);
        /* A source function is at most p E <= 10 W/m^2 times the peak of g = 0.999, 1.6e5 / sr. */
        const size_t bad = count_nonsense(frame, NULL, 2e6) + count_nonsense(frame, "volume", 2e6) +
                           count_nonsense(frame, "transmittance", 1.0);
        const float *depth_m = neph_image_channel(frame, "Z");
        for (size_t i = 0; i < neph_image_pixel_count(frame); i++)
            nonsense += !(depth_m[i] > 0.0f);
        if (bad > 0)
            print_error("round %d of seed %llu: %zu samples\n", round, (unsigned long long)seed,
                        bad);
        nonsense += bad;
        samples += 10 * neph_image_pixel_count(frame);
    }
    print_message("%zu of %zu samples are nonsense, %d rounds of many media\n", nonsense, samples,
                  crowds);
    neph_assert_in_range(crowds, rounds / 8, rounds / 2);
    assert_int_equal(nonsense, 0);
}

/* Must be the last test: the interrupt flag stays set. */
static void test_interrupt_stops_the_render(void **state)
{
    struct test_scene test;
    test_scene_build(&test, scene_fog);
    struct test_scene with;
    add_shared_kernel_media(&test, &with);
    signal(SIGINT, SIG_DFL); /* a background shell ignores it */
    neph_interrupt_install();
    raise(SIGINT);
    struct neph_image *frame = NULL;
    struct neph_diag diag = {0};
    assert_int_equal(test_march_frame(*state, &with.scene, &exact_48, &frame, NULL, &diag),
                     NEPH_ERR_INTERRUPTED);
    assert_null(frame);
}

int main(void)
{
    print_message("seed %llu\n", (unsigned long long)seed);
    const struct CMUnitTest tests[] = {
#include "cases/test_march.inc"
    };
    return cmocka_run_group_tests(tests, test_vulkan_setup, test_vulkan_teardown);
}
