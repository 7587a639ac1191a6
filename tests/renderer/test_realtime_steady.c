/* SPDX-License-Identifier: MIT
 *
 * Static sequences (renderer/realtime/stillness.h): when nothing has changed for long, the gradient
 * pass does not run, and no bit of this or later frames differs.
 */
#include "renderer/realtime/anti_aliasing/check_taa.h"
#include "tests/renderer/sequence_test.h"

#include "renderer/realtime/stillness.h"

/* --- frames --------------------------------------------------------------------------------- */

/* A fence in front of a cloud that ends in view: edges, sky, thin and thick media. */
static void fence_scene(struct test_scene *test)
{
    test_scene_init(test);
    test_add(test, make_blob(3.0, (struct neph_vec3){0.5, 2.0, -12.0}, 1.0));
    for (int i = 0; i < 5; i++)
        test_add_box(test, (struct neph_vec3){-3.0 + 1.4 * i, 0.0, -8.0},
                     (struct neph_vec3){-2.6 + 1.4 * i, 4.0, -7.8});
    test_add_box(test, (struct neph_vec3){-1e3, -1.0, -1e3}, (struct neph_vec3){1e3, 0.0, 1e3});
}

/* Preset `ours`, with its kernels, and short memories, so that it becomes static after few
 * frames. */
static struct neph_settings steady_settings(void)
{
    return test_preset("ours", "steps=4 override_wake=1 change_hold=0.1");
}

static struct neph_realtime *open_realtime(struct neph_vulkan *vulkan,
                                           const struct neph_scene *scene, bool always_asks)
{
    const struct neph_settings settings = steady_settings();
    struct neph_realtime *realtime = test_sequence(vulkan, scene, &settings, 36, 20);
    neph_realtime_set_test_hooks(
        realtime, (struct neph_realtime_test_hooks){.always_asks_gradient = always_asks});
    return realtime;
}

/* Whether passes have run for a frame. */
struct ran {
    bool scene, gradient;
};

static bool has_run(const struct neph_realtime_stats *stats, const char *pass)
{
    return stats->pass_traffic_bytes[neph_rt_pass_index(pass)] > 0;
}

static struct ran render(struct neph_realtime *realtime, const struct neph_scene *scene, int frame,
                         struct neph_image **image)
{
    struct neph_realtime_stats stats;
    struct neph_diag diag = {0};
    const struct neph_realtime_frame picture = {scene, frame, NULL};
    neph_assert_ok(neph_realtime_render(realtime, &picture, image, &stats, &diag), &diag);
    assert_int_equal(has_run(&stats, "scene"), has_run(&stats, "depth map"));
    assert_int_equal(has_run(&stats, "scene"), has_run(&stats, "tile index"));
    return (struct ran){has_run(&stats, "scene"), has_run(&stats, "gradient")};
}

/* The sequence counts as static after 9 gradients and 6 frames of decay. Then the sun moves, a
 * cloud, a solid and the camera, each of which is detected at once. The scene pass runs until each
 * of the jitter's 7 positions has been rendered; the first 7 frames are not cached. */
static void test_no_bit_is_another(void **state)
{
    enum { PICTURES = 88, KNOWN_AFTER = 15, PLACES = 7 };
    struct test_scene test;
    int changed = 0, spared = 0;
    fence_scene(&test);
    OWNED(realtime) struct neph_realtime *asked = open_realtime(*state, &test.scene, true);
    OWNED(realtime) struct neph_realtime *known = open_realtime(*state, &test.scene, false);
    for (int frame = 0; frame < PICTURES; frame++) {
        OWNED(image) struct neph_image *a = NULL, *b = NULL;
        if (frame == 24)
            test.scene.sun.direction = (struct neph_vec3){0.6, 0.8, 0.0};
        if (frame == 44)
            test.scene.media[0].gaussian.center_m.x += 0.5;
        if (frame == 64)
            test.scene.solids[1].box.max_m.y -= 0.5;
        if (frame == 84)
            test.key.look_at_m.x += 0.1;
        if (frame == 24 || frame == 44 || frame == 64 || frame == 84)
            changed = frame;
        const struct ran by_asked = render(asked, &test.scene, frame, &a);
        const struct ran by_known = render(known, &test.scene, frame, &b);
        assert_true(by_asked.scene && by_asked.gradient);
        assert_int_equal(by_known.gradient, frame - changed < KNOWN_AFTER);
        assert_int_equal(by_known.scene, frame - changed < (changed > 0 ? PLACES : 2 * PLACES));
        spared += !by_known.gradient;
        assert_same_bits(a, b);
    }
    assert_true(spared >= 14);
}

/* Renders a frame in flight and returns the bytes of a pass. The upscale writes no volume that is
 * not read. */
static uint64_t fly(struct neph_realtime *realtime, const struct neph_scene *scene, int frame,
                    const char *pass)
{
    struct neph_realtime_stats stats;
    struct neph_diag diag = {0};
    const struct neph_realtime_frame picture = {scene, frame, NULL};
    neph_assert_ok(neph_realtime_render(realtime, &picture, NULL, NULL, &diag), &diag);
    neph_assert_ok(neph_realtime_collect(realtime, &stats, &diag), &diag);
    return stats.pass_traffic_bytes[neph_rt_pass_index(pass)];
}

/* Frames in flight, some of them read back, compared with frames that are all read back. The sun
 * moves; the transition from static to moving is the same, too. */
static void test_unread_frames_keep_the_bits(void **state)
{
    enum { PICTURES = 52, SUN_MOVES = 34, KNOWN_AFTER = 15 };
    struct test_scene test;
    int unread = 0;
    uint64_t most_bytes = 0;
    fence_scene(&test);
    OWNED(realtime) struct neph_realtime *read = open_realtime(*state, &test.scene, false);
    OWNED(realtime) struct neph_realtime *sent = open_realtime(*state, &test.scene, false);
    for (int frame = 0; frame < PICTURES; frame++) {
        OWNED(image) struct neph_image *a = NULL, *b = NULL;
        if (frame == SUN_MOVES)
            test.scene.sun.direction = (struct neph_vec3){0.6, 0.8, 0.0};
        render(read, &test.scene, frame, &a);
        if (frame % 7 == 5 || frame >= SUN_MOVES) {
            render(sent, &test.scene, frame, &b);
            assert_same_bits(a, b);
        } else {
            const uint64_t bytes = fly(sent, &test.scene, frame, "upscale");
            most_bytes = bytes > most_bytes ? bytes : most_bytes;
            assert_int_equal(bytes < most_bytes, frame >= KNOWN_AFTER);
            unread += bytes < most_bytes;
        }
    }
    assert_true(unread >= 14);
}

/* With absorbing media only, anti-aliased frames are computed once per jitter position, and no ray
 * is marched again until something moves. */
static void test_absorbing_frames_are_computed_once(void **state)
{
    enum { PICTURES = 56, SUN_MOVES = 42, KEPT_AFTER = 22 };
    struct test_scene test;
    int kept = 0;
    fence_scene(&test);
    test.scene.media[0].albedo = (struct neph_rgb){0.0, 0.0, 0.0};
    OWNED(realtime) struct neph_realtime *unasked = open_realtime(*state, &test.scene, true);
    OWNED(realtime) struct neph_realtime *sent = open_realtime(*state, &test.scene, false);
    for (int frame = 0; frame < PICTURES; frame++) {
        OWNED(image) struct neph_image *a = NULL, *b = NULL;
        if (frame == SUN_MOVES)
            test.scene.sun.direction = (struct neph_vec3){0.6, 0.8, 0.0};
        render(unasked, &test.scene, frame, &a);
        if (frame % 7 == 5 || frame >= SUN_MOVES) {
            render(sent, &test.scene, frame, &b);
            assert_same_bits(a, b);
        } else {
            const bool is_kept = fly(sent, &test.scene, frame, "march") == 0;
            assert_int_equal(is_kept && frame >= KEPT_AFTER, is_kept);
            kept += is_kept;
        }
    }
    print_message("%d pictures were kept\n", kept);
    assert_true(kept >= 10);
}

/* --- passes ---------------------------------------------------------------------------------- */

static void fill(struct test_passes *test, int target, double most, double w, uint64_t *seed)
{
    for (size_t i = 0; i < test_elements(test, target); i++) {
        float value[4];
        for (int c = 0; c < 3; c++)
            value[c] = (float)neph_test_uniform(seed, 0.0, most);
        value[3] = (float)neph_test_uniform(seed, 0.0, w);
        test_set(test, target, i, value);
    }
}

/* A static frame for which the gradient has found no change. */
static void open_steady(struct neph_vulkan *vulkan, int round, struct test_passes *test)
{
    static const int sizes_px[][2] = {{64, 36}, {35, 18}};
    const struct neph_settings settings = steady_settings();
    uint64_t seed = (uint64_t)round + 1;
    test_passes_open(vulkan, &settings, sizes_px[round % 2], (int[2]){round % 3 * 4, 0}, seed,
                     test);
    test->device.specialises = true;
    test->view.settings[RT_SOLID_MOTION] = 0.0f;
    test->view.settings[RT_COMPOSITION] = RT_COMPOSITION_PASS;
    test->view.has_history = 1;
    test->view.frame = (uint32_t)neph_test_random(&seed);
    test->view.exposure = test->view.exposure_before = 1.0f;
    for (int target = 0; target < RT_TARGET_COUNT; target++)
        fill(test, target, 2.0, 1.0, &seed);
    for (size_t i = 0; i < test_elements(test, RT_HALF_DEPTH); i++) {
        const float depth_m = i % 5 ? 10.0f + (float)(i % 7) : NEPH_GPU_FAR_M;
        test_set(test, RT_HALF_DEPTH, i, (float[4]){depth_m});
        test_set(test, RT_HALF_DEPTH_BEFORE, i, (float[4]){depth_m});
        test_set(test, RT_HISTORY_STATE_BEFORE, i, (float[4]){(float)(i % 9), 12.0f});
    }
    test_fill(test, RT_CHANGE, 1, 1, 1, 0);
    test_fill(test, RT_CHANGE_BEHIND, 1, 1, 1, 0);
    test_set(test, RT_RAY, 1, (float[4]){NAN, 0.0f, 0.0f, 1.0f});
    cpu_tile_index(&test->cpu);
}

/* With the kernels of lavapipe and, in odd rounds, of a GPU. The ray that a tile keeps is the one
 * that the gradient would keep. */
static void test_static_passes_equal_full_passes(void **state)
{
    static const struct {
        const char *pass;
        int targets[2], count;
    } rows[] = {{"reconstruction", {RT_HISTORY, RT_HISTORY_STATE}, 2},
                {"anti-aliasing", {RT_TAA_OUT}, 1}};
    for (int round = 0; round < 4; round++) {
        OWNED(passes) struct test_passes test;
        open_steady(*state, round, &test);
        test_passes_run(&test, "gradient");
        uint32_t *kept = test_download(&test, RT_KEPT_RAY);
        for (size_t r = 0; r < COUNT(rows); r++) {
            test.view.settings[RT_STEADY] = RT_STEADY_ASKED;
            test_passes_run(&test, rows[r].pass);
            uint32_t *made[2] = {NULL};
            for (int t = 0; t < rows[r].count; t++)
                made[t] = test_download(&test, rows[r].targets[t]);
            test.view.settings[RT_STEADY] = RT_STEADY_KNOWN;
            test_passes_run(&test, rows[r].pass);
            for (int t = 0; t < rows[r].count; t++) {
                free(test.cpu.targets[rows[r].targets[t]]);
                test.cpu.targets[rows[r].targets[t]] = made[t];
                test_same_words(&test, rows[r].targets[t], (uint64_t)round);
            }
            if (r == 0) {
                free(test.cpu.targets[RT_KEPT_RAY]);
                test.cpu.targets[RT_KEPT_RAY] = kept;
                test_same_words(&test, RT_KEPT_RAY, (uint64_t)round);
            }
        }
    }
}

/* --- when a sequence is not static ---------------------------------------------------------- */

static bool is_known(const int size_px[2], const char *words, uint32_t pictures)
{
    const struct neph_settings settings = test_settings(words);
    const struct neph_rt_static_content stillness = {.pictures = pictures};
    struct neph_gpu_view view;
    neph_rt_view_init(&view, &settings, size_px, (int[2]){0, 0}, size_px);
    return neph_rt_is_gradient_known_zero(&stillness, &view);
}

static void test_sequences_that_are_not_static(void **state)
{
    static const int whole_px[2] = {64, 36}, cut_px[2] = {64, 38}, cut_twice_px[2] = {61, 38},
                     row_px[2] = {64, 4};
    const char *words = "gradient=on taa_jitter_length=16 change_hold=0.75";
    assert_true(is_known(whole_px, words, 16 + 35)); /* .75^34 < 2^-14 */
    assert_false(is_known(whole_px, words, 16 + 34));
    assert_true(is_known(cut_px, words, 99));
    assert_false(is_known(cut_twice_px, words, 9999));
    assert_false(is_known(row_px, words, 9999));
    assert_false(is_known(whole_px, "gradient=on override_rest=2", 9999));
    assert_true(is_known(whole_px, "gradient=on taa_jitter_length=4", 8));
    assert_false(is_known(whole_px, "gradient=on taa_jitter_length=4 override_wake=32", 39));
}

#include "tests/renderer/main.h"
