/* SPDX-License-Identifier: MIT
 *
 * The real-time renderer as a whole: properties of its frames that do not depend on single
 * passes.
 */
#include "tests/renderer/sequence_test.h"

enum { WIDTH_PX = 64, HEIGHT_PX = 36 };

static struct neph_realtime *open_realtime(struct neph_vulkan *vulkan,
                                           const struct neph_scene *scene,
                                           const struct neph_settings *settings)
{
    return test_sequence(vulkan, scene, settings, WIDTH_PX, HEIGHT_PX);
}

static struct neph_image *marched(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                  struct neph_march_stats *stats)
{
    const struct neph_march_params params = {
        .width_px = WIDTH_PX, .height_px = HEIGHT_PX, .steps = 64, .sun_steps = 16};
    return test_march(vulkan, scene, &params, stats);
}

/* --- equal frames --------------------------------------------------------------------------- */

static void test_off_is_the_march(void **state)
{
    struct test_scene test;
    test_scene_fence(&test);
    const struct neph_settings settings = test_preset("off", "");
    OWNED(realtime) struct neph_realtime *realtime = open_realtime(*state, &test.scene, &settings);
    OWNED(image) struct neph_image *truth = marched(*state, &test.scene, NULL);
    for (int frame = 0; frame < 3; frame++) {
        OWNED(image) struct neph_image *image = test_next(realtime, &test.scene, 0, NULL);
        assert_same_bits(image, truth);
    }
}

/* Exact values, without anything that varies them. */
static struct neph_settings plain(void)
{
    return test_preset("fixed", "taa=off ray_dither=none box=none upscale_dither=none "
                                "override=none target_format=float");
}

/* In a march at half resolution each ray goes through the middle of a half-resolution texel, so the
 * rays of tiles are among them, bit by bit. */
struct ray_check {
    const struct neph_image *half;
    int checked;
};

static void check_rays(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                       void *context)
{
    struct ray_check *check = context;
    if (strcmp(pass->name, "march") != 0)
        return;
    OWNED(memory) uint32_t *tiles = test_words(device, RT_TILE), *rays = test_words(device, RT_RAY);
    float *volume[3], *transmittance[3];
    neph_image_rgb(check->half, "volume", volume);
    neph_image_rgb(check->half, "transmittance", transmittance);
    for (int tile = 0; tile < (WIDTH_PX / 4) * (HEIGHT_PX / 4); tile++) {
        static const int places[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        float slot[4], ray[4];
        neph_rt_load(&device->view->targets[RT_TILE], tiles, (size_t)tile, slot);
        neph_rt_load(&device->view->targets[RT_RAY], rays, (size_t)tile, ray);
        const int *place = places[(int)slot[0]];
        const int x = 2 * (tile % (WIDTH_PX / 4)) + place[0];
        const int y = 2 * (tile / (WIDTH_PX / 4)) + place[1];
        const size_t i = (size_t)(y * (WIDTH_PX / 2) + x);
        for (int c = 0; c < 3; c++)
            assert_true(ray[c] == volume[c][i]);
        assert_true(ray[3] == transmittance[0][i]);
        check->checked++;
    }
}

static void test_a_tile_marches_as_march_does(void **state)
{
    struct test_scene test;
    test_scene_fence(&test);
    test.scene.solid_count = 0; /* else depths of the map would end some rays elsewhere */
    const struct neph_settings settings = plain();
    const struct neph_march_params params = {
        .width_px = WIDTH_PX / 2, .height_px = HEIGHT_PX / 2, .steps = 64, .sun_steps = 16};
    OWNED(image) struct neph_image *half = test_march(*state, &test.scene, &params, NULL);
    struct ray_check check = {.half = half};
    OWNED(realtime) struct neph_realtime *realtime = open_realtime(*state, &test.scene, &settings);
    neph_realtime_observe(realtime, check_rays, &check);
    for (int frame = 0; frame < 4; frame++)
        neph_image_destroy(test_next(realtime, &test.scene, 0, NULL));
    assert_int_equal(check.checked, 4 * (WIDTH_PX / 4) * (HEIGHT_PX / 4));
}

/* Presets of the day come first; most of each one's time is compiling its kernels. Moving frames of
 * every preset of the day are in tests/harness/e2e_realtime.py. */
static const char *const presets[] = {"off",   "seed",  "fixed", "ours", "ours1",
                                      "ours2", "unity", "ue",    "c52e"};
/* Presets with validity=on, for the day and the night. */
static const char *const sound[] = {"fixed", "ours", "ue", "c52e", "unity"};

static int preset_count(void)
{
    return neph_test_by_day(4, COUNT(presets));
}

static int sound_count(void)
{
    return neph_test_by_day(2, COUNT(sound));
}

static const char *const channels[] = {"R", "G", "B", "Z"};

static void check_nothing(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                          const struct neph_image *truth, struct neph_settings settings)
{
    OWNED(realtime) struct neph_realtime *realtime = open_realtime(vulkan, scene, &settings);
    for (int frame = 0; frame < 5; frame++) {
        OWNED(image) struct neph_image *image = test_next(realtime, scene, 0, NULL);
        for (int c = 0; c < 3; c++)
            assert_same_channel(image, truth, channels[c]);
    }
}

/* Without media every preset without anti-aliasing shows the scene, bit by bit. One medium below
 * the ground keeps the kernels of other tests; test_few_and_many_solids_agree has none. */
static void test_zero_density_changes_nothing(void **state)
{
    struct test_scene test;
    test_scene_fence(&test);
    test.scene.media[0].bounds = (struct neph_bounds){{-1.0, -9.0, -9.0}, {1.0, -8.0, -8.0}};
    OWNED(image) struct neph_image *truth = marched(*state, &test.scene, NULL);
    check_nothing(*state, &test.scene, truth, plain());
    for (int p = 0; p < neph_test_by_day(1, COUNT(presets)); p++)
        check_nothing(*state, &test.scene, truth, test_preset(presets[p], "taa=off"));
}

static void generalise(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                       void *context)
{
    (void)pass, (void)context;
    device->specialises = false;
}

/* Settings as constants of the shaders and settings read at run time give the same bits. So the
 * results of tests of single passes apply to the renderer; and two renderers give the same
 * frames. */
static void test_specialised_shaders_make_the_same_bits(void **state)
{
    for (int p = 1; p < neph_test_by_day(3, COUNT(presets)); p++) {
        struct test_scene test;
        test_scene_fence(&test);
        const struct neph_settings settings = test_preset(presets[p], "");
        OWNED(realtime) struct neph_realtime *one = open_realtime(*state, &test.scene, &settings);
        OWNED(realtime) struct neph_realtime *two = open_realtime(*state, &test.scene, &settings);
        neph_realtime_observe(two, generalise, NULL);
        for (int frame = 0; frame < 6; frame++) {
            OWNED(image) struct neph_image *a = test_next(one, &test.scene, frame, NULL);
            OWNED(image) struct neph_image *b = test_next(two, &test.scene, frame, NULL);
            assert_same_bits(a, b);
        }
    }
}

/* --- convergence ---------------------------------------------------------------------------- */

/* Static scene and camera: the error against the march decreases while the four slots are filled,
 * and then stays at the upscale's error. No dither, so nothing else varies. */
static void test_error_against_the_number_of_frames(void **state)
{
    struct test_scene test;
    test_scene_fence(&test);
    OWNED(image) struct neph_image *truth = marched(*state, &test.scene, NULL);
    const struct neph_settings settings = plain();
    OWNED(realtime) struct neph_realtime *realtime = open_realtime(*state, &test.scene, &settings);
    double errors[12];
    for (int frame = 0; frame < 12; frame++) {
        OWNED(image) struct neph_image *image = test_next(realtime, &test.scene, 0, NULL);
        errors[frame] = test_rmse(image, truth);
        print_message("frame %2d: RMSE %.3e\n", frame, errors[frame]);
    }
    for (int frame = 1; frame < 4; frame++)
        assert_true(errors[frame] < errors[frame - 1]);
    for (int frame = 4; frame < 12; frame++) /* all four slots are filled: static */
        assert_true(errors[frame] == errors[3]);
}

/* --- bad numbers ---------------------------------------------------------------------------- */

static size_t count_bad(struct neph_rt_device *device)
{
    size_t bad = 0;
    const uint32_t used = neph_rt_targets_used(device->view); /* the others have no buffer */
    for (int t = 0; t < RT_TARGET_COUNT; t++) {
        if (!(used & NEPH_RT_BIT(t)))
            continue;
        const struct neph_gpu_target *shape = &device->view->targets[t];
        const size_t elements = (size_t)shape->width * shape->height;
        OWNED(memory) uint32_t *copy = test_words(device, t);
        for (size_t i = 0; i < elements; i++) {
            float value[4];
            neph_rt_load(shape, copy, i, value);
            for (int c = 0; c < 4; c++)
                bad += !isfinite(value[c]);
        }
    }
    return bad;
}

struct injection {
    int first, count; /* values to inject one by one, in every other frame from this one on */
    const float (*values)[4];
    int seen;       /* frames so far */
    size_t bad[16]; /* per frame, after its last pass */
};

/* The value to inject in a frame; NULL: none. */
static const float *injected(const struct injection *injection, int frame)
{
    const int after = frame - injection->first;
    const bool is_one = after >= 0 && after % 2 == 0 && after / 2 < injection->count;
    return is_one ? injection->values[after / 2] : NULL;
}

static void inject(struct neph_rt_device *device, const struct neph_rt_pass *pass, void *context)
{
    struct injection *injection = context;
    const float *value = injected(injection, injection->seen);
    if (strcmp(pass->name, "march") == 0 && value) {
        struct neph_diag diag = {0};
        OWNED(memory) uint32_t *copy = test_words(device, RT_RAY);
        neph_rt_store(&device->view->targets[RT_RAY], copy, 37, value);
        neph_assert_ok(neph_rt_device_upload(device, RT_RAY, copy, &diag), &diag);
    }
    if (strcmp(pass->name, "anti-aliasing") == 0)
        injection->bad[injection->seen++] = count_bad(device);
}

/* One bad ray in one frame: with validity on, it has no effect a frame later, and no other value
 * was ever bad. */
static void test_a_bad_ray_is_gone_one_frame_later(void **state)
{
    static const float values[][4] = {
        {NAN, 0, 0, 1}, {0, INFINITY, 0, 1}, {0, 0, -1, 1}, {0, 0, 0, NAN}, {NAN, NAN, NAN, NAN}};
    struct test_scene test;
    test_scene_fence(&test);
    for (int p = 0; p < sound_count(); p++) {
        enum { FRAMES = 15 };
        const struct neph_settings settings = test_preset(sound[p], "");
        OWNED(realtime)
        struct neph_realtime *realtime = open_realtime(*state, &test.scene, &settings);
        struct injection injection = {.first = 5, .count = COUNT(values), .values = values};
        neph_realtime_observe(realtime, inject, &injection);
        for (int frame = 0; frame < FRAMES; frame++)
            neph_image_destroy(test_next(realtime, &test.scene, 0, NULL));
        for (int frame = 0; frame < FRAMES; frame++)
            assert_true(injection.bad[frame] <= (injected(&injection, frame) ? 4u : 0u));
    }
}

/* Fills the targets that the first frame could mistake for its history. */
static void fill_past(struct neph_rt_device *device, const struct neph_rt_pass *pass, void *context)
{
    static const int past[] = {RT_HISTORY_BEFORE, RT_HISTORY_STATE_BEFORE, RT_HALF_DEPTH_BEFORE,
                               RT_TAA_BEFORE};
    uint32_t *pattern = context;
    if (strcmp(pass->name, "scene") != 0 || !pattern[1])
        return;
    pattern[1] = 0; /* only in the first frame */
    for (size_t t = 0; t < COUNT(past); t++) {
        const size_t words = neph_rt_device_words(device, past[t]);
        OWNED(memory) uint32_t *garbage = malloc(words * sizeof(*garbage));
        for (size_t i = 0; i < words; i++)
            garbage[i] = pattern[0] ? pattern[0] : (uint32_t)(i * 2654435761u);
        struct neph_diag diag = {0};
        neph_assert_ok(neph_rt_device_upload(device, past[t], garbage, &diag), &diag);
    }
}

/* NaN in float32 and half precision, 1e30, and arbitrary bits. */
static void test_garbage_in_the_history_never_shows(void **state)
{
    static const uint32_t patterns[] = {0x7fc00000u, 0x7e007e00u, 0x7149f2cau, 0};
    struct test_scene test;
    test_scene_fence(&test);
    for (int p = 0; p < sound_count(); p++) {
        const struct neph_settings settings = test_preset(sound[p], "");
        OWNED(realtime) struct neph_realtime *clean = open_realtime(*state, &test.scene, &settings);
        struct neph_image *expected[2];
        for (int frame = 0; frame < 2; frame++)
            expected[frame] = test_next(clean, &test.scene, 0, NULL);
        for (int i = 0; i < 4; i++) {
            uint32_t pattern[2] = {patterns[i], 1};
            OWNED(realtime)
            struct neph_realtime *dirty = open_realtime(*state, &test.scene, &settings);
            neph_realtime_observe(dirty, fill_past, pattern);
            for (int frame = 0; frame < 2; frame++) {
                OWNED(image) struct neph_image *image = test_next(dirty, &test.scene, 0, NULL);
                assert_same_bits(image, expected[frame]);
            }
        }
        neph_image_destroy(expected[0]);
        neph_image_destroy(expected[1]);
    }
}

/* --- motion, sizes, cost -------------------------------------------------------------------- */

/* A dolly with a cut in the middle; the keys must live as long as the scene. */
static void set_dolly(struct test_scene *test, struct neph_camera_key keys[4])
{
    for (int i = 0; i < 4; i++)
        keys[i] = (struct neph_camera_key){
            .frame = 4.0 * i,
            .position_m = {0.3 * i + (i > 1 ? 4.0 : 0.0), 1.6, -0.5 * i},
            .look_at_m = {0.5 * i, 1.4, -10.0},
            .cut = i == 2,
        };
    test->scene.camera_keys = keys;
    test->scene.camera_key_count = 4;
}

static void test_no_bad_number_in_motion(void **state)
{
    struct test_scene test;
    test_scene_fence(&test);
    struct neph_camera_key keys[4];
    set_dolly(&test, keys);
    for (int p = 1; p < preset_count(); p++) {
        const struct neph_settings settings = test_preset(presets[p], "");
        OWNED(realtime)
        struct neph_realtime *realtime = open_realtime(*state, &test.scene, &settings);
        struct injection watch = {.count = 0};
        neph_realtime_observe(realtime, inject, &watch);
        for (int frame = 0; frame < 13; frame++)
            neph_image_destroy(test_next(realtime, &test.scene, frame, NULL));
        for (int frame = 0; frame < 13; frame++)
            assert_int_equal(watch.bad[frame], 0);
    }
}

/* Resizes: each frame has its size, and the first frame of a size equals a new renderer's, except
 * for the phase of slots, dithers and jitter, which continues. */
static void test_sizes(void **state)
{
    static const int sizes_px[][2] = {{1, 1},   {2, 3},   {5, 4}, {37, 21},
                                      {64, 36}, {63, 35}, {3, 90}};
    struct test_scene test;
    test_scene_fence(&test);
    const struct neph_settings settings = test_preset("fixed", "");
    OWNED(realtime) struct neph_realtime *realtime = open_realtime(*state, &test.scene, &settings);
    for (size_t s = 0; s < COUNT(sizes_px); s++) {
        struct neph_diag diag = {0};
        neph_assert_ok(
            neph_realtime_resize(realtime, &test.scene, sizes_px[s][0], sizes_px[s][1], &diag),
            &diag);
        for (int frame = 0; frame < 5; frame++) {
            OWNED(image) struct neph_image *image = test_next(realtime, &test.scene, 0, NULL);
            assert_int_equal(image->width_px, sizes_px[s][0]);
            assert_int_equal(image->height_px, sizes_px[s][1]);
            float *rgb[3];
            neph_image_rgb(image, NULL, rgb);
            for (size_t i = 0; i < neph_image_pixel_count(image); i++)
                assert_true(isfinite(rgb[0][i]) && rgb[0][i] >= 0.0f);
        }
    }
}

/* A ray per 4x4 pixels: at most 1/14 of the march's density evaluations per frame. */
static void test_a_fourteenth_of_the_evaluations(void **state)
{
    struct test_scene test;
    test_scene_fence(&test);
    struct neph_march_stats whole;
    neph_image_destroy(marched(*state, &test.scene, &whole));
    for (int p = 1; p < preset_count(); p++) {
        const struct neph_settings settings = test_preset(presets[p], "");
        OWNED(realtime)
        struct neph_realtime *realtime = open_realtime(*state, &test.scene, &settings);
        for (int frame = 0; frame < 4; frame++) {
            struct neph_realtime_stats stats;
            neph_image_destroy(test_next(realtime, &test.scene, 0, &stats));
            assert_int_equal(stats.rays, (WIDTH_PX / 4) * (HEIGHT_PX / 4));
            assert_true(stats.density_evaluations > 0);
            assert_true(stats.density_evaluations <= whole.density_evaluations / 14);
            assert_int_equal(stats.density_evaluations, stats.view_steps);
        }
    }
}

/* --- refusals ------------------------------------------------------------------------------- */

static void test_coloured_extinction_is_refused(void **state)
{
    struct test_scene test;
    test_scene_fence(&test);
    test.scene.media[0].extinction_color = (struct neph_rgb){1.0, 0.5, 1.0};
    const struct neph_settings settings = test_preset("fixed", "");
    const struct neph_realtime_params params = {
        .width_px = 8, .height_px = 8, .settings = &settings};
    struct neph_realtime *realtime = NULL;
    struct neph_diag diag = {0};
    assert_int_equal(neph_realtime_create(*state, &test.scene, &params, &realtime, &diag),
                     NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "one transmittance"));
}

static void test_given_depth(void **state)
{
    struct test_scene test;
    test_scene_fence(&test);
    const struct neph_settings settings = plain();
    OWNED(image) struct neph_image *given = marched(*state, &test.scene, NULL);
    OWNED(realtime)
    struct neph_realtime *from_scene = open_realtime(*state, &test.scene, &settings);
    OWNED(realtime) struct neph_realtime *from_file = open_realtime(*state, &test.scene, &settings);
    struct neph_diag diag = {0};
    for (int frame = 0; frame < 5; frame++) {
        OWNED(image) struct neph_image *a = test_next(from_scene, &test.scene, 0, NULL), *b = NULL;
        const struct neph_realtime_frame picture = {&test.scene, 0, given};
        neph_assert_ok(neph_realtime_render(from_file, &picture, &b, NULL, &diag), &diag);
        assert_same_channel(a, b, "Z");
        assert_same_channel(a, b, "volume.R");
        assert_same_channel(a, b, "volume.G");
        assert_same_channel(a, b, "volume.B");
    }
    neph_image_channel(given, "Z")[5] = -1.0f;
    const struct neph_realtime_frame bad = {&test.scene, 0, given};
    struct neph_image *image = NULL;
    assert_int_equal(neph_realtime_render(from_file, &bad, &image, NULL, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "pixel 5,0"));
}

/* Shaders are specialized for a few solids and read many one by one: in both cases the background
 * equals the march's. */
static void test_few_and_many_solids_agree(void **state)
{
    static const int counts[] = {0, RT_SOLIDS_UNKNOWN - 1, RT_SOLIDS_UNKNOWN};
    struct test_scene test;
    test_scene_init(&test);
    struct neph_solid solids[RT_SOLIDS_UNKNOWN];
    for (int i = 0; i < RT_SOLIDS_UNKNOWN; i++) {
        solids[i] = i % 2 ? make_sphere(-8.0 + 0.5 * i, 1.0, -12.0 - i % 5, 0.6)
                          : make_box(-8.0 + 0.5 * i, 0.0, -15.0, -7.8 + 0.5 * i, 4.0, -14.0);
        if (i % 4 == 2)
            solids[i].turn = (struct neph_turn){i / 4 % 3, cos(0.1 * i), sin(0.1 * i)};
    }
    test.scene.solids = solids;
    const struct neph_settings settings = plain();
    for (size_t n = 0; n < COUNT(counts); n++) {
        test.scene.solid_count = counts[n];
        OWNED(realtime)
        struct neph_realtime *realtime = open_realtime(*state, &test.scene, &settings);
        OWNED(image) struct neph_image *frame = test_next(realtime, &test.scene, 0, NULL);
        OWNED(image) struct neph_image *march = marched(*state, &test.scene, NULL);
        for (int c = 0; c < 4; c++)
            assert_same_channel(frame, march, channels[c]);
    }
}

/* An absorbing wall across the view. */
static void scene_dark(struct test_scene *test)
{
    test_scene_init(test);
    struct neph_medium *wall = test_add(
        test, make_homogeneous(0.4, (struct neph_bounds){{-50, -50, -11}, {50, 50, -8}}));
    wall->albedo = (struct neph_rgb){0.0, 0.0, 0.0};
}

/* For every ray the distance to the wall over the length through it is 8 / 3, and T gives that
 * length L. The mean of t, weighted with the absorbed light, is t0 + L (1 / tau - 1 / (e^tau -
 * 1)). */
static void check_dark(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                       void *context)
{
    int *checked = context;
    if (strcmp(pass->name, "march") != 0)
        return;
    OWNED(memory)
    uint32_t *rays = test_words(device, RT_RAY), *distances = test_words(device, RT_RAY_DISTANCE);
    const struct neph_gpu_target *shape = &device->view->targets[RT_RAY];
    for (size_t i = 0; i < (size_t)shape->width * shape->height; i++) {
        float ray[4], distance[4];
        neph_rt_load(shape, rays, i, ray);
        neph_rt_load(&device->view->targets[RT_RAY_DISTANCE], distances, i, distance);
        const double tau = -log((double)ray[3]), way_m = tau / 0.4;
        const double expected_m = way_m * (8.0 / 3.0 + 1.0 / tau - 1.0 / expm1(tau));
        assert_true(ray[0] == 0.0f && ray[1] == 0.0f && ray[2] == 0.0f);
        assert_true(way_m > 2.999);
        assert_true(fabs(distance[0] - expected_m) < 1e-5 * expected_m);
        ++*checked;
    }
}

/* Without light nothing is marched, here as in `march`, and T is as accurate as there. */
static void test_dark_media_are_not_marched(void **state)
{
    struct test_scene test;
    struct neph_realtime_stats stats;
    int checked = 0;
    scene_dark(&test);
    const struct neph_settings settings = test_preset("ours", "target_format=float taa=off");
    OWNED(realtime) struct neph_realtime *realtime = open_realtime(*state, &test.scene, &settings);
    neph_realtime_observe(realtime, check_dark, &checked);
    neph_image_destroy(test_next(realtime, &test.scene, 0, &stats));
    assert_int_equal(checked, ((WIDTH_PX + 3) / 4) * ((HEIGHT_PX + 3) / 4));
    assert_int_equal(stats.view_steps, 0);
    assert_int_equal(stats.rays, checked);
}

#include "tests/renderer/main.h"
