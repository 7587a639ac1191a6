/* SPDX-License-Identifier: MIT
 *
 * Frames in flight: a frame after others that were not read back equals, bit for bit, the frame
 * after others that were.
 */
#include "tests/renderer/sequence_test.h"

/* Scene camera_dolly: a camera that moves past solids in fog. All data of a frame differ from the
 * frame before. */
enum { WIDTH_PX = 48, HEIGHT_PX = 28, FRAMES = 8 /* each lane and slot is used more than once */ };

/* With dithers that need no masks. */
static struct neph_settings few_steps(const char *preset)
{
    return test_preset(preset, "steps=4 ray_dither=none upscale_dither=none");
}

static void send(struct neph_realtime *realtime, const struct neph_scene *scene, int frame)
{
    const struct neph_realtime_frame picture = {scene, frame, NULL};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_realtime_render(realtime, &picture, NULL, NULL, &diag), &diag);
}

static void check_after_flight(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                               const struct neph_settings *settings)
{
    OWNED(realtime)
    struct neph_realtime *read = test_sequence(vulkan, scene, settings, WIDTH_PX, HEIGHT_PX);
    OWNED(realtime)
    struct neph_realtime *sent = test_sequence(vulkan, scene, settings, WIDTH_PX, HEIGHT_PX);
    struct neph_realtime_stats read_stats, sent_stats;
    struct neph_image *expected = NULL;
    for (int frame = 0; frame < FRAMES; frame++) {
        neph_image_destroy(expected);
        expected = test_next(read, scene, frame, &read_stats);
        if (frame < FRAMES - 1)
            send(sent, scene, frame);
    }
    OWNED(image) struct neph_image *image = test_next(sent, scene, FRAMES - 1, &sent_stats);
    assert_true(test_same_bits(image, expected));
    assert_true(sent_stats.density_evaluations > 0);
    assert_int_equal(sent_stats.density_evaluations, read_stats.density_evaluations);
    assert_int_equal(sent_stats.rays, read_stats.rays);
    neph_image_destroy(expected);
}

static void test_the_frame_after_frames_in_flight(void **state)
{
    OWNED(scene) struct neph_scene *scene = test_load("catalog/camera_dolly");
    const struct neph_settings settings = few_steps("ours");
    check_after_flight(*state, scene, &settings);
}

/* Clouds drift: each frame refills nodes that earlier frames may still read. Of the work in flight
 * only the fill is counted. */
static void test_the_cache_fills_in_flight(void **state)
{
    OWNED(scene) struct neph_scene *scene = test_load("stress/wind_cloud");
    const struct neph_settings settings = test_preset(
        "off", "steps=4 ray_dither=none upscale_dither=none split=four sun=marched "
               "sun_cache=grid sun_cache_voxels=16");
    check_after_flight(*state, scene, &settings);
    OWNED(realtime)
    struct neph_realtime *realtime = test_sequence(*state, scene, &settings, WIDTH_PX, HEIGHT_PX);
    struct neph_realtime_stats home;
    struct neph_diag diag = {0};
    send(realtime, scene, 0);
    send(realtime, scene, 1);
    for (int frame = 0; frame < 2; frame++) {
        neph_assert_ok(neph_realtime_collect(realtime, &home, &diag), &diag);
        assert_true(home.density_evaluations > 0);
    }
}

/* The bytes that passes move are known in advance; counters are not available in flight. */
static void test_costs_are_collected_in_order(void **state)
{
    OWNED(scene) struct neph_scene *scene = test_load("catalog/camera_dolly");
    const struct neph_settings settings = few_steps("ours");
    OWNED(realtime)
    struct neph_realtime *realtime = test_sequence(*state, scene, &settings, WIDTH_PX, HEIGHT_PX);
    struct neph_realtime_stats read, home;
    struct neph_diag diag = {0};
    neph_image_destroy(test_next(realtime, scene, 0, &read));
    assert_int_equal(neph_realtime_collect(realtime, &home, &diag), NEPH_ERR_USAGE);
    for (int frame = 1; frame <= NEPH_IN_FLIGHT_FRAMES; frame++)
        send(realtime, scene, frame);
    for (int frame = 1; frame <= NEPH_IN_FLIGHT_FRAMES; frame++) {
        uint64_t traffic_bytes = 0;
        neph_assert_ok(neph_realtime_collect(realtime, &home, &diag), &diag);
        assert_int_equal(home.traffic_bytes, read.traffic_bytes);
        assert_int_equal(home.density_evaluations, 0);
        for (int i = 0; neph_rt_passes[i]; i++) {
            assert_int_equal(home.pass_gpu_s[i] > 0.0, read.pass_gpu_s[i] > 0.0);
            traffic_bytes += home.pass_traffic_bytes[i];
        }
        assert_int_equal(traffic_bytes, home.traffic_bytes);
    }
    assert_int_equal(neph_realtime_collect(realtime, &home, &diag), NEPH_ERR_USAGE);
}

/* Without a split the march of every pixel goes through the CPU to the next passes, so it cannot be
 * in flight. */
static void test_no_split_cannot_be_in_flight(void **state)
{
    OWNED(scene) struct neph_scene *scene = test_load("catalog/camera_dolly");
    struct neph_settings settings = few_steps("off");
    const struct neph_realtime_frame picture = {scene, 0, NULL};
    struct neph_realtime *realtime = test_sequence(*state, scene, &settings, WIDTH_PX, HEIGHT_PX);
    struct neph_realtime_stats home;
    struct neph_diag diag = {0};
    send(realtime, scene, 0);
    neph_assert_ok(neph_realtime_collect(realtime, &home, &diag), &diag);
    assert_true(home.gpu_s > 0.0);
    neph_realtime_destroy(realtime);
    settings.values[RT_TAA] = 1.0;
    realtime = test_sequence(*state, scene, &settings, WIDTH_PX, HEIGHT_PX);
    assert_int_equal(neph_realtime_render(realtime, &picture, NULL, NULL, &diag),
                     NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "split=four"));
    neph_realtime_destroy(realtime);
}

static void test_the_march_in_flight(void **state)
{
    const struct neph_march_params params = {
        .width_px = WIDTH_PX, .height_px = HEIGHT_PX, .steps = 4, .sun_steps = 1};
    OWNED(scene) struct neph_scene *scene = test_load("catalog/camera_dolly");
    OWNED(image) struct neph_image *alone = NULL, *after = NULL;
    struct neph_diag diag = {0};
    double gpu_s;
    OWNED(march) struct neph_march *march = test_march_open(*state, scene, &params);
    neph_assert_ok(neph_march_frame(march, scene, FRAMES, NULL, &alone, NULL, &diag), &diag);
    for (int frame = 0; frame < FRAMES; frame++)
        neph_assert_ok(neph_march_frame(march, scene, frame, NULL, NULL, NULL, &diag), &diag);
    for (int i = 0; i < NEPH_IN_FLIGHT_FRAMES; i++) {
        neph_assert_ok(neph_march_collect(march, &gpu_s, &diag), &diag);
        assert_true(gpu_s > 0.0);
    }
    assert_int_equal(neph_march_collect(march, &gpu_s, &diag), NEPH_ERR_USAGE);
    neph_assert_ok(neph_march_frame(march, scene, 0, NULL, NULL, NULL, &diag), &diag);
    neph_assert_ok(neph_march_frame(march, scene, FRAMES, NULL, &after, NULL, &diag), &diag);
    assert_true(test_same_bits(alone, after));
}

#include "tests/renderer/main.h"
