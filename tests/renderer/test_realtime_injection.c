/* SPDX-License-Identifier: MIT
 *
 * Values that a scene injects into a running renderer (scenes/injection.h): they arrive, are
 * counted, and vanish where the renderer is meant to recover; and moving solids.
 */
#include "tests/renderer/sequence_test.h"

#include "renderer/realtime/watch.h"
#include "scenes/injection.h"
#include "scenes/motion.h"
#include "scenes/solids.h"

enum { WIDTH_PX = 32, HEIGHT_PX = 20, FRAMES = 6 };

static struct neph_realtime *open_realtime(struct neph_vulkan *vulkan,
                                           const struct neph_scene *scene,
                                           const struct neph_settings *settings)
{
    return test_sequence(vulkan, scene, settings, WIDTH_PX, HEIGHT_PX);
}

static size_t bad_values(const struct neph_image *image)
{
    size_t bad = 0;
    for (int c = 0; c < image->channel_count; c++)
        for (size_t p = 0; p < neph_image_pixel_count(image); p++) {
            const float value = image->channels[c].samples[p];
            bad += isnan(value) || value < 0.0f;
        }
    return bad;
}

/* Number of frames that differ between two sets of injections. */
static int differing(struct neph_vulkan *vulkan, struct neph_scene *scene,
                     const struct neph_settings *settings, const struct neph_injections *one,
                     const struct neph_injections *other)
{
    int differ = 0;
    scene->injections = one;
    OWNED(realtime) struct neph_realtime *first = open_realtime(vulkan, scene, settings);
    scene->injections = other;
    OWNED(realtime) struct neph_realtime *second = open_realtime(vulkan, scene, settings);
    for (int frame = 0; frame < FRAMES; frame++) {
        scene->injections = one;
        OWNED(image) struct neph_image *a = test_next(first, scene, frame, NULL);
        scene->injections = other;
        OWNED(image) struct neph_image *b = test_next(second, scene, frame, NULL);
        differ += !test_same_bits(a, b);
    }
    scene->injections = NULL;
    return differ;
}

static const struct neph_injections nothing = {.history_count = 0};

/* --- histories and rays ----------------------------------------------------------------------- */

/* Garbage in memory before the first frame has no effect. With validity off it has. */
static void test_garbage_before_the_first_frame(void **state)
{
    struct test_scene test;
    struct neph_injected_history dirty = {3, NEPH_INJECTED_GARBAGE, true};
    struct neph_injected_history clean = {3, NEPH_INJECTED_BLACK, true};
    const struct neph_injections one = {.history_count = 1, .histories = &dirty};
    const struct neph_injections other = {.history_count = 1, .histories = &clean};
    test_scene_fence(&test);
    static const enum neph_injected_value values[] = {NEPH_INJECTED_GARBAGE, NEPH_INJECTED_NAN,
                                                      NEPH_INJECTED_HUGE};
    const struct neph_settings sound = test_preset("ours", ""), seed = test_preset("seed", "");
    for (int i = 0; i < neph_test_by_day(1, 3); i++) {
        dirty.value = values[i];
        assert_int_equal(differing(*state, &test.scene, &sound, &one, &other), 0);
    }
    dirty.value = NEPH_INJECTED_GARBAGE;
    assert_true(differing(*state, &test.scene, &seed, &one, &other) > 0);
}

/* Every element and channel of every history is counted, and nothing else. */
static void test_injected_values_are_counted(void **state)
{
    struct test_scene test;
    struct neph_injected_history history = {1, NEPH_INJECTED_NAN, false};
    struct neph_injected_rays rays = {2, 5, NEPH_INJECTED_NEGATIVE};
    struct neph_injected_rays all = {3, 1000, NEPH_INJECTED_INFINITE};
    const struct neph_settings settings = test_preset("fixed", "");
    test_scene_fence(&test);
    struct neph_injected_rays lists[] = {rays, all};
    test.scene.injections = &(struct neph_injections){
        .history_count = 1, .histories = &history, .ray_count = 2, .rays = lists};
    OWNED(realtime) struct neph_realtime *realtime = open_realtime(*state, &test.scene, &settings);
    const uint64_t pixels = WIDTH_PX * HEIGHT_PX;
    /* Half depth has 1 channel, history 4 and its state 2, at a quarter of the pixels;
     * anti-aliasing 4 at all pixels; a ray 4. */
    const uint64_t expected[] = {0, pixels / 4 * (1 + 4 + 2) + pixels * 4, 5 * 4, pixels / 16 * 4,
                                 0};
    for (int frame = 0; frame < 5; frame++) {
        struct neph_realtime_stats stats;
        OWNED(image) struct neph_image *image = test_next(realtime, &test.scene, frame, &stats);
        assert_int_equal(stats.injected_values, expected[frame]);
        assert_int_equal(bad_values(image), 0);
    }
}

/* With validity off an injected value shows in the frame. */
static void test_a_bad_ray_shows_without_validity(void **state)
{
    struct test_scene test;
    struct neph_injected_rays rays = {1, 1, NEPH_INJECTED_NAN};
    const struct neph_settings settings = test_preset("seed", "");
    test_scene_fence(&test);
    test.scene.injections = &(struct neph_injections){.ray_count = 1, .rays = &rays};
    OWNED(realtime) struct neph_realtime *realtime = open_realtime(*state, &test.scene, &settings);
    for (int frame = 0; frame < 2; frame++) {
        OWNED(image) struct neph_image *image = test_next(realtime, &test.scene, frame, NULL);
        assert_true((bad_values(image) > 0) == (frame == 1));
    }
}

/* Random words: one in 512 is invalid in half precision, one in 256 in float32, and half are
 * negative. In each target the device counts the same number as the C code, inside the view
 * only. */
static void test_the_device_counts_bad_values(void **state)
{
    uint64_t seed = 5;
    OWNED(passes) struct test_passes test;
    struct neph_diag diag = {0};
    uint64_t all = 0;
    const struct neph_settings settings = test_preset("ours", "");
    test_passes_open(*state, &settings, (int[2]){29, 15}, (int[2]){8, 4}, 2, &test);
    for (int t = 0; t < RT_TARGET_COUNT; t++) {
        const struct neph_gpu_target *shape = &test.view.targets[t];
        const struct neph_rt_rectangle own = neph_rt_view_texels(&test.view, t);
        uint64_t expected = 0, found = 0;
        for (size_t i = 0; i < neph_rt_device_words(&test.device, t); i++)
            test.cpu.targets[t][i] = (uint32_t)neph_test_random(&seed);
        for (size_t i = 0; i < test_elements(&test, t); i++) {
            const uint32_t x = (uint32_t)i % shape->width - own.left; /* large outside the view */
            const uint32_t y = (uint32_t)i / shape->width - own.top;
            float value[4];
            test_get(&test, t, i, value);
            for (int c = 0; c < 4 && x < own.width && y < own.height; c++)
                expected += !isfinite(value[c]) || (value[c] < 0.0f && t != RT_MOVED);
        }
        neph_assert_ok(neph_rt_device_upload(&test.device, t, test.cpu.targets[t], &diag), &diag);
        neph_assert_ok(neph_rt_watch(&test.device, NEPH_RT_BIT(t), &found, &diag), &diag);
        assert_int_equal(found, expected);
        all += found;
    }
    assert_true(all > 1000);
}

/* A sound renderer has no bad value in any image; one with an invalid history has some. An injected
 * ray does not count itself. */
static void test_a_sequence_is_watched(void **state)
{
    struct test_scene test;
    struct neph_injected_rays rays = {1, 3, NEPH_INJECTED_NAN};
    struct neph_diag diag = {0};
    test_scene_fence(&test);
    test.scene.injections = &(struct neph_injections){.ray_count = 1, .rays = &rays};
    for (int is_sound = 0; is_sound < 2; is_sound++) {
        const struct neph_settings settings = test_preset(is_sound ? "fixed" : "seed", "");
        OWNED(realtime)
        struct neph_realtime *realtime = open_realtime(*state, &test.scene, &settings);
        for (int frame = 0; frame < 3; frame++) {
            uint64_t bad = 0;
            const struct neph_realtime_frame picture = {&test.scene, frame, NULL};
            neph_assert_ok(neph_realtime_render(realtime, &picture, NULL, NULL, &diag), &diag);
            neph_assert_ok(neph_realtime_watch(realtime, &bad, &diag), &diag);
            assert_true((bad > 0) == (!is_sound && frame >= 1));
        }
    }
}

/* --- views ------------------------------------------------------------------------------------ */

/* A view in buffers filled with NaN equals the single view, bit by bit; a renderer that counts
 * tiles from the corner of the buffer differs. */
static void test_a_split_view_equals_a_single_view(void **state)
{
    struct test_scene test;
    const struct neph_injections split = {.view = {36, 4, 8, 4, NEPH_INJECTED_NAN}};
    static const char *const presets[] = {"ours", "fixed", "c52e", "unity", "ue"};
    test_scene_fence(&test);
    for (int p = 0; p < neph_test_by_day(1, 5); p++) {
        const struct neph_settings settings = test_preset(presets[p], "");
        assert_int_equal(differing(*state, &test.scene, &settings, &split, &nothing), 0);
    }
    if (!neph_test_is_night())
        return; /* test_views_are_independent in test_realtime_tile.c tests this for the pass */
    const struct neph_settings faulty = test_preset("fixed", "tile_origin=buffer");
    assert_true(differing(*state, &test.scene, &faulty, &split, &nothing) > 0);
}

/* The first frame has no history, even after another view; later frames have a wrong one. Without
 * history a second view only costs time. */
static void test_a_mirrored_view_leaves_its_history(void **state)
{
    struct test_scene test;
    const struct neph_injections mirror = {.mirror = {0, 100, -3.0}};
    const struct neph_settings settings = test_preset("fixed", ""), whole = test_preset("off", "");
    test_scene_fence(&test);
    assert_int_equal(differing(*state, &test.scene, &settings, &mirror, &nothing), FRAMES - 1);
    assert_int_equal(differing(*state, &test.scene, &whole, &mirror, &nothing), 0);
}

/* Equals a resize by the caller. */
static void test_another_size_and_back(void **state)
{
    struct test_scene test;
    struct neph_injected_size size = {2, 0.5};
    struct neph_diag diag = {0};
    const struct neph_settings settings = test_preset("fixed", "");
    test_scene_fence(&test);
    OWNED(realtime) struct neph_realtime *by_hand = open_realtime(*state, &test.scene, &settings);
    OWNED(realtime) struct neph_realtime *injected = open_realtime(*state, &test.scene, &settings);
    for (int frame = 0; frame < 4; frame++) {
        test.scene.injections = &nothing;
        if (frame == 2) {
            neph_assert_ok(neph_realtime_resize(by_hand, &test.scene, 16, 10, &diag), &diag);
            neph_image_destroy(test_next(by_hand, &test.scene, frame, NULL));
            neph_assert_ok(neph_realtime_resize(by_hand, &test.scene, 32, 20, &diag), &diag);
        }
        OWNED(image) struct neph_image *expected = test_next(by_hand, &test.scene, frame, NULL);
        test.scene.injections = &(struct neph_injections){.size_count = 1, .sizes = &size};
        OWNED(image) struct neph_image *image = test_next(injected, &test.scene, frame, NULL);
        assert_same_bits(image, expected);
    }
}

/* Injections that need the frame before are refused in flight. */
static void test_injection_is_refused_in_flight(void **state)
{
    struct test_scene test;
    struct neph_diag diag = {0};
    const struct neph_settings settings = test_preset("fixed", "");
    test_scene_fence(&test);
    test.scene.injections = &(struct neph_injections){.mirror = {0, 100, -3.0}};
    OWNED(realtime) struct neph_realtime *realtime = open_realtime(*state, &test.scene, &settings);
    const struct neph_realtime_frame picture = {&test.scene, 0, NULL};
    assert_int_equal(neph_realtime_render(realtime, &picture, NULL, NULL, &diag),
                     NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "inject.mirror"));
}

/* --- the origin ------------------------------------------------------------------------------- */

/* A shift of the origin by a power of two has no rounding: the same bits with a reprojected
 * history; else the camera seems to have moved far, and the history is invalid. */
static void test_frames_do_not_depend_on_the_origin(void **state)
{
    struct test_scene test;
    struct neph_injected_origin shift = {2, {1048576.0, 0.0, -65536.0}};
    const struct neph_injections shifted = {.origin_count = 1, .origins = &shift};
    const struct neph_settings settings = test_preset("ours", "");
    const struct neph_settings usual = test_preset("fixed", "");
    const struct neph_settings lost = test_preset("fixed", "origin_shift=off");
    test_scene_fence(&test);
    OWNED(realtime) struct neph_realtime *at_home = open_realtime(*state, &test.scene, &settings);
    OWNED(realtime) struct neph_realtime *away = open_realtime(*state, &test.scene, &settings);
    OWNED(realtime) struct neph_realtime *usually = open_realtime(*state, &test.scene, &usual);
    OWNED(realtime) struct neph_realtime *forgotten = open_realtime(*state, &test.scene, &lost);
    for (int frame = 0; frame < 4; frame++) {
        test.scene.injections = &nothing;
        OWNED(image) struct neph_image *a = test_next(at_home, &test.scene, frame, NULL);
        OWNED(image) struct neph_image *c = test_next(usually, &test.scene, frame, NULL);
        test.scene.injections = &shifted;
        OWNED(image) struct neph_image *b = test_next(away, &test.scene, frame, NULL);
        OWNED(image) struct neph_image *d = test_next(forgotten, &test.scene, frame, NULL);
        /* a bar's face, rounded once in double */
        assert_true(test_largest_difference(a, b, NULL) < 1e-6);
        assert_true((test_largest_difference(c, d, NULL) > 1e-3) == (frame >= 2));
    }
}

/* --- solids that move ------------------------------------------------------------------------ */

/* A box that rotates about its centre and moves to the right, and a sphere that orbits it. */
struct movers {
    struct test_scene test;
    struct neph_solid_key keys[2][2];
    struct neph_mover movers[2];
};

static void scene_movers(struct movers *stage)
{
    struct neph_scene *scene = &stage->test.scene;
    test_scene_init(&stage->test);
    struct neph_medium *fog = test_add_medium(&stage->test, 0.02, 0.0, 0.0);
    fog->bounds = (struct neph_bounds){{-30, -1, -30}, {30, 20, 2}}; /* open to the sun */
    test_add_box(&stage->test, (struct neph_vec3){-1.5, 0.5, -9.0},
                 (struct neph_vec3){1.5, 2.5, -8.0});
    test_add_sphere(&stage->test, (struct neph_vec3){3.0, 1.5, -8.5}, 0.6);
    for (int i = 0; i < 2; i++) {
        stage->keys[i][0] = (struct neph_solid_key){.frame = 0};
        stage->keys[i][1] = (struct neph_solid_key){8, {i ? 0.0 : 2.0, 0, 0}, i ? 3.0 : 1.0};
        stage->movers[i] = (struct neph_mover){i, 1, 1, {0, 0, -8.5}, 2, stage->keys[i]};
    }
    scene->movers = stage->movers;
    scene->mover_count = 2;
}

struct watch {
    const struct neph_scene *scene;
    int frame, pictures, checked, moving;
};

/* Compares the motion target with positions computed in C, hit by hit; rays that graze an edge may
 * differ. */
static void check_motion(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                         void *context)
{
    struct watch *watch = context;
    if (strcmp(pass->name, "motion") != 0)
        return;
    watch->pictures++;
    OWNED(memory) uint32_t *words = test_words(device, RT_MOVED);
    OWNED(scene) struct neph_scene *still = test_still(watch->scene, watch->frame);
    const struct neph_camera camera = neph_scene_camera(still, watch->frame);
    for (int y = 0; y < HEIGHT_PX; y++)
        for (int x = 0; x < WIDTH_PX; x++) {
            float moved[4];
            neph_rt_load(&device->view->targets[RT_MOVED], words, (size_t)(y * WIDTH_PX + x),
                         moved);
            const struct neph_pixel_ray ray = neph_camera_ray(
                &camera, WIDTH_PX, HEIGHT_PX, x + (double)device->view->jitter_px[0],
                y + (double)device->view->jitter_px[1]);
            const struct neph_hit hit = neph_scene_hit(still, ray.origin_m, ray.direction);
            struct neph_vec3 expected = {0, 0, 0};
            if (hit.solid) {
                const struct neph_mover *mover = &watch->scene->movers[hit.solid - still->solids];
                const struct neph_placing here = neph_mover_placing(watch->scene, mover,
                                                                    watch->frame);
                const struct neph_placing there = neph_mover_placing(
                    watch->scene, mover, watch->frame > 0 ? watch->frame - 1 : 0);
                const struct neph_vec3 point_m = neph_vec3_along(ray.origin_m, ray.direction,
                                                                 hit.t_m);
                expected = neph_vec3_sub(point_m,
                                         neph_find_earlier_place_m(&here, &there, point_m));
                watch->moving++;
            }
            watch->checked += fabs(moved[0] - expected.x) < 1e-4 &&
                              fabs(moved[1] - expected.y) < 1e-4 &&
                              fabs(moved[2] - expected.z) < 1e-4;
        }
}

/* In a first frame nothing has moved, and the pass does not run. */
static void test_motion_is_that_of_the_solids(void **state)
{
    struct movers stage;
    const struct neph_settings settings = test_preset("ours", "");
    scene_movers(&stage);
    OWNED(realtime)
    struct neph_realtime *realtime = open_realtime(*state, &stage.test.scene, &settings);
    struct watch watch = {.scene = &stage.test.scene};
    neph_realtime_observe(realtime, check_motion, &watch);
    for (watch.frame = 0; watch.frame < 4; watch.frame++)
        neph_image_destroy(test_next(realtime, &stage.test.scene, watch.frame, NULL));
    print_message("%d of %d pixels agree, %d of them of solids\n", watch.checked,
                  3 * WIDTH_PX * HEIGHT_PX, watch.moving);
    assert_int_equal(watch.pictures, 3);
    assert_true(watch.checked >= 3 * WIDTH_PX * HEIGHT_PX - 6);
    assert_true(watch.moving > 3 * WIDTH_PX * HEIGHT_PX / 20);
}

/* A movable solid without motion costs the same and gives the same frames as a fixed one: behind
 * its last key. */
static void test_static_movers_equal_fixed_solids(void **state)
{
    enum { RESTING = 8, PICTURES = 12 };
    struct movers stage;
    const struct neph_settings settings = test_preset("ours", "");
    const int motion = neph_rt_pass_index("motion");
    scene_movers(&stage);
    OWNED(scene) struct neph_scene *still = test_still(&stage.test.scene, RESTING);
    OWNED(realtime)
    struct neph_realtime *resting = open_realtime(*state, &stage.test.scene, &settings);
    OWNED(realtime) struct neph_realtime *bare = open_realtime(*state, still, &settings);
    for (int i = 0; i < PICTURES; i++) {
        struct neph_realtime_stats stats;
        const int frame = RESTING + i; /* the last of the keys, and later */
        OWNED(image) struct neph_image *a = test_next(resting, &stage.test.scene, frame, &stats);
        OWNED(image) struct neph_image *b = test_next(bare, still, frame, NULL);
        assert_int_equal(stats.pass_traffic_bytes[motion], 0);
        assert_same_bits(a, b);
    }
}

static struct neph_image *eighth_frame(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                       const char *assignments)
{
    const struct neph_settings settings = test_preset("fixed", assignments);
    OWNED(realtime) struct neph_realtime *realtime = open_realtime(vulkan, scene, &settings);
    struct neph_image *image = NULL;
    for (int frame = 0; frame < 8; frame++) {
        neph_image_destroy(image);
        image = test_next(realtime, scene, frame, NULL);
    }
    return image;
}

/* Error over the pixels of solids. */
static double error_of_solids(const struct neph_image *image, const struct neph_image *truth)
{
    const float *a = neph_image_channel(image, "G"), *b = neph_image_channel(truth, "G");
    const float *depth_m = neph_image_channel(truth, "Z");
    double sum = 0.0;
    for (int p = 0; p < WIDTH_PX * HEIGHT_PX; p++)
        sum += depth_m[p] < 20.0f ? pow((double)a[p] - (double)b[p], 2.0) : 0.0;
    return sqrt(sum);
}

/* Without a neighbourhood clamp a history without reprojection shows the earlier frame. */
static void test_anti_aliasing_follows_solids(void **state)
{
    static const char *const words[] = {"taa_box=none solid_motion=off",
                                        "taa_box=none solid_motion=on"};
    struct movers stage;
    double errors[2];
    scene_movers(&stage);
    for (int i = 0; i < 2; i++)
        stage.keys[i][1].turn_rad = 0.0; /* a rotating solid changes its lighting */
    OWNED(scene) struct neph_scene *still = test_still(&stage.test.scene, 7.0);
    OWNED(image) struct neph_image *truth = eighth_frame(*state, still, words[1]);
    for (int follows = 0; follows < 2; follows++) {
        OWNED(image)
        struct neph_image *image = eighth_frame(*state, &stage.test.scene, words[follows]);
        errors[follows] = error_of_solids(image, truth);
    }
    print_message("error %g, following %g\n", errors[0], errors[1]);
    assert_true(errors[1] < 0.7 * errors[0]);
}

/* In a scene without moving solids the setting costs no pass and no memory, and changes no bit. */
static void test_static_solids_cost_nothing(void **state)
{
    struct test_scene test;
    const struct neph_settings on = test_preset("ours", "solid_motion=on");
    const struct neph_settings off = test_preset("ours", "solid_motion=off");
    test_scene_fence(&test);
    OWNED(realtime) struct neph_realtime *a = open_realtime(*state, &test.scene, &on);
    OWNED(realtime) struct neph_realtime *b = open_realtime(*state, &test.scene, &off);
    struct neph_realtime_stats of_a, of_b;
    OWNED(image) struct neph_image *one = test_next(a, &test.scene, 0, &of_a);
    OWNED(image) struct neph_image *other = test_next(b, &test.scene, 0, &of_b);
    assert_same_bits(one, other);
    assert_int_equal(of_a.target_bytes, of_b.target_bytes);
    assert_int_equal(of_a.traffic_bytes, of_b.traffic_bytes);
}

#include "tests/renderer/main.h"
