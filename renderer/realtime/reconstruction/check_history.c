/* SPDX-License-Identifier: MIT
 *
 * Tests of the reconstruction's history: its place, its filter, and the cases without history; and
 * of sequences of frames.
 */
#include "renderer/realtime/reconstruction/check_reconstruct.h"

/* A history whose R and G are its own place in half-resolution texels. Settings without clamp and
 * fresh rays, which would change it. */
static const char ramp_settings[] = "box=none fresh_weight=0 target_format=float wind=off ";

static void open_ramp(struct neph_vulkan *vulkan, const char *assignments, int width, int height,
                      struct test_passes *test)
{
    reconstruct_open(vulkan, width, height, test, "%s%s", ramp_settings, assignments);
    const uint32_t half_width = test->view.targets[RT_HISTORY].width;
    for (size_t i = 0; i < test_elements(test, RT_HISTORY); i++)
        test_set(test, RT_HISTORY_BEFORE, i,
                 (float[4]){(float)(i % half_width), (float)(i / half_width), 0, 1});
}

/* The place at which a texel of the frame found its history [px]; false where it found none, or at
 * the sides, where the ramp ends. */
static bool find_history_place(const struct test_passes *test, int x, int y, double place_px[2])
{
    float value[4];
    cpu_fetch_half(&test->cpu, RT_HISTORY, x, y, value);
    for (int axis = 0; axis < 2; axis++)
        place_px[axis] = 2.0 * value[axis] + 1.0;
    return value[0] > 0.0f && value[0] < (float)test->view.half_size_px[0] - 1.0f &&
           value[1] > 0.0f && value[1] < (float)test->view.half_size_px[1] - 1.0f;
}

/* --- places ------------------------------------------------------------------------------------
 */

enum motion { YAW, ROLL, STRAFE, DOLLY, WIND };

struct motion_case {
    enum motion motion;
    double amount; /* rad or m */
    const char *assignments;
};

/* Slopes of the line of sight through a place of this frame: x / z and y / z. */
static void slopes_at(const struct neph_gpu_view *view, double x_px, double y_px, double slope[2])
{
    slope[0] = (2.0 * x_px / view->size_px[0] - 1.0) * view->now.half_width;
    slope[1] = (1.0 - 2.0 * y_px / view->size_px[1]) * view->now.half_height;
}

/* Slopes in the frame before of a medium at `distance_m`, by the closed form of each motion: a
 * rotation by a maps tan(u) to tan(u - a), forward motion scales about the centre by z / (z + s),
 * sideways motion shifts by s / z. */
static void slopes_before(const struct motion_case *c, double distance_m, bool is_radial,
                          double slope[2])
{
    const double x = slope[0], y = slope[1], a = c->amount;
    const double z_m = is_radial ? distance_m / sqrt(1.0 + x * x + y * y) : distance_m;
    switch (c->motion) {
    case YAW:
        slope[0] = (x - tan(a)) / (1.0 + x * tan(a));
        slope[1] = y / (cos(a) + x * sin(a));
        break;
    case ROLL:
        slope[0] = x * cos(a) - y * sin(a);
        slope[1] = x * sin(a) + y * cos(a);
        break;
    case STRAFE:
    case WIND:
        slope[0] = x - a / z_m;
        break;
    case DOLLY:
        slope[0] = x * z_m / (z_m - a);
        slope[1] = y * z_m / (z_m - a);
        break;
    }
}

static void apply_motion(struct neph_gpu_view *view, const struct motion_case *c)
{
    switch (c->motion) {
    case YAW:
        reconstruct_phase(&view->before, c->amount, 0, 0);
        break;
    case ROLL:
        reconstruct_phase(&view->before, 0, 0, c->amount);
        break;
    case STRAFE: /* the camera was to the right */
        view->before.position_m[0] = (float)c->amount;
        break;
    case DOLLY: /* ahead, towards -Z */
        view->before.position_m[2] = (float)-c->amount;
        break;
    case WIND: /* the medium was to the left */
        view->wind_m[0] = (float)c->amount;
        break;
    }
}

/* Rotation, roll, sideways and forward motion: the history is at the geometric place, to 1e-4
 * px. */
static void test_history_is_where_geometry_says(void **state)
{
    static const struct motion_case cases[] = {
        {YAW, 0.05, ""},
        {YAW, -0.2, "reproject_measure=eye"},
        {ROLL, 0.1, ""},
        {STRAFE, 3.0, "reproject_measure=radial"},
        {STRAFE, -3.0, "reproject_measure=eye"},
        {STRAFE, -3.0, "reproject_measure=eye reproject_depth=tile"},
        {DOLLY, 10.0, "reproject_measure=radial"},
        {DOLLY, -25.0, "reproject_measure=eye"},
        {WIND, 4.0, "wind=on"},
        {WIND, 0.0, "wind=off"},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        OWNED(passes) struct test_passes test;
        open_ramp(*state, cases[i].assignments, 127, 33, &test);
        apply_motion(&test.view, &cases[i]);
        const bool is_radial = test.view.settings[RT_REPROJECT_MEASURE] == RT_MEASURE_RADIAL;
        reconstruct_run(&test);
        int found = 0;
        for (int y = 0; y < 17; y++)
            for (int x = 0; x < 64; x++) {
                double slope[2], place_px[2];
                slopes_at(&test.view, 2 * x + 1, 2 * y + 1, slope);
                slopes_before(&cases[i], 100.0, is_radial, slope);
                const double expected_px[2] = {
                    (0.5 + 0.5 * slope[0] / test.view.now.half_width) * 127,
                    (0.5 - 0.5 * slope[1] / test.view.now.half_height) * 33};
                if (expected_px[0] < 4 || expected_px[0] > 122 || expected_px[1] < 4 ||
                    expected_px[1] > 28)
                    continue;
                assert_true(find_history_place(&test, x, y, place_px));
                neph_assert_close(place_px[0], expected_px[0], 0, 1e-4);
                neph_assert_close(place_px[1], expected_px[1], 0, 1e-4);
                found++;
            }
        assert_true(found > 200);
    }
}

/* In an orthographic frame sideways motion is the same at any distance; forward motion is 0. */
static void test_parallel_history_is_where_geometry_says(void **state)
{
    static const struct motion_case cases[] = {
        {STRAFE, 3.0, "reproject_measure=radial"}, {STRAFE, -3.0, "reproject_measure=eye"},
        {DOLLY, 10.0, "reproject_measure=radial"}, {DOLLY, -25.0, "reproject_measure=eye"},
        {WIND, 4.0, "wind=on reject_depth=0.01"},  {WIND, 0.0, "wind=off"},
    };
    static const float distances_m[] = {3.0f, 40000.0f, NEPH_GPU_FAR_M};
    for (int i = 0; i < 18; i++) {
        OWNED(passes) struct test_passes test;
        const struct motion_case *c = &cases[i / 3];
        open_ramp(*state, c->assignments, 127, 33, &test);
        test_make_parallel(&test.view, 33.0f); /* 1 px is 2 m */
        apply_motion(&test.view, c);
        test_fill(&test, RT_RAY_DISTANCE, distances_m[i % 3], 0, 0, 0);
        reconstruct_run(&test);
        for (int y = 3; y < 14; y++)
            for (int x = 5; x < 58; x++) {
                double place_px[2];
                const double shift_px = c->motion == DOLLY ? 0.0 : 0.5 * c->amount;
                assert_true(find_history_place(&test, x, y, place_px));
                neph_assert_close(place_px[0], 2 * x + 1 - shift_px, 0, 1e-4);
                neph_assert_close(place_px[1], 2 * y + 1, 0, 1e-4);
            }
    }
}

/* Without wind in the reprojection the history of a drifting medium is read at its present place. A
 * medium without effect is at infinity: sideways motion does not move it. */
static void test_static_content(void **state)
{
    static const float distances_m[] = {100.0f, INFINITY, NAN, 0.0f, NEPH_GPU_FAR_M};
    for (int i = 0; i < 5; i++) {
        OWNED(passes) struct test_passes test;
        open_ramp(*state, "wind=off", 64, 36, &test);
        if (i == 0)
            test.view.wind_m[0] = 5.0f;
        else
            test.view.before.position_m[0] = 5.0f;
        test_fill(&test, RT_RAY_DISTANCE, distances_m[i], 0, 0, 0);
        reconstruct_run(&test);
        for (int y = 1; y < 17; y++)
            for (int x = 1; x < 31; x++) {
                double place_px[2];
                assert_true(find_history_place(&test, x, y, place_px));
                neph_assert_close(place_px[0], 2 * x + 1, 0, 1e-4);
                neph_assert_close(place_px[1], 2 * y + 1, 0, 1e-4);
            }
    }
}

/* --- filters -----------------------------------------------------------------------------------
 */

/* A shift by a third of a texel. */
static void test_the_filter_is_exact_on_lines(void **state)
{
    for (int degree = 0; degree <= 1; degree++) {
        OWNED(passes) struct test_passes test;
        open_ramp(*state, "", 127, 33, &test);
        for (size_t i = 0; i < test_elements(&test, RT_HISTORY); i++) {
            const double x = (double)(i % 64) / 64, y = (double)(i / 64) / 64;
            const double value = degree == 0 ? 0.25 : x + y;
            test_set(&test, RT_HISTORY_BEFORE, i, (float[4]){(float)value, 0, 0, 1});
        }
        /* 2/3 px to the right and up of the present place, at any depth */
        const double shift_px = 2.0 / 3.0;
        for (int k = 0; k < 3; k++) {
            struct neph_gpu_view_camera *before = &test.view.before;
            before->right[k] += (float)(shift_px * 2 / 127 * before->half_width *
                                        test.view.now.forward[k]);
            before->up[k] += (float)(shift_px * 2 / 33 * before->half_height *
                                     test.view.now.forward[k]);
        }
        reconstruct_run(&test);
        for (int y = 4; y < 13; y++)
            for (int x = 4; x < 60; x++) {
                const double u = (x + shift_px / 2) / 64, v = (y - shift_px / 2) / 64;
                const double expected = degree == 0 ? 0.25 : u + v;
                /* 1e-4 px of place, and rounding */
                neph_assert_close(half_value(&test, RT_HISTORY, x, y, 0), expected, 1e-6,
                                  degree * 2e-6);
            }
    }
}

/* Invalid taps have no weight. The age is the age of the tap with the largest weight. */
static void test_void_taps_have_no_weight(void **state)
{
    {
        OWNED(passes) struct test_passes test;
        open_ramp(*state, "", 64, 36, &test);
        const float shift = 2.0f * 0.5f / 64 * test.view.before.half_width;
        test.view.before.right[2] -= shift; /* a quarter of a texel to the right */
        for (int y = 0; y < 18; y++)
            for (int x = 0; x < 32; x++) {
                cpu_put_half(&test.cpu, RT_HISTORY_STATE_BEFORE, x, y,
                             (float[4]){x < 16 ? (float)x : 0.0f, 100});
                if (x == 5 && y == 5) /* invalid in spite of its age */
                    cpu_put_half(&test.cpu, RT_HISTORY_BEFORE, x, y,
                                 (float[4]){NAN, 1e30f, -1, INFINITY});
            }
        reconstruct_run(&test);
        for (int x = 1; x < 30; x++) {
            float value[4], history[4];
            cpu_fetch_half(&test.cpu, RT_HISTORY, x, 5, value);
            cpu_fetch_half(&test.cpu, RT_HISTORY_STATE, x, 5, history);
            const double expected = x == 4 ? 4 : x == 5 ? 6 : x == 15 ? 15 : x + 0.25;
            const double age = x == 5 ? 6 : x < 16 ? x : 1;
            if (x < 16)
                neph_assert_close(value[0], expected, 0, 1e-4);
            else
                neph_assert_close(value[0], 0, 0, 0); /* the nearest ray */
            neph_assert_close(history[0], age + (reconstruct_is_marched(&test, x, 5) && x < 16), 0,
                              0);
        }
    }
}

/* --- no history --------------------------------------------------------------------------------
 */

/* Texels that took this frame's ray (0.5) and not the history (0.25). */
static int count_without_history(const struct test_passes *test)
{
    int count = 0;
    for (int i = 0; i < (int)reconstruct_threads(test); i++) {
        float value[4], history[4];
        const int x = i % (int)test->view.half_size_px[0], y = i / (int)test->view.half_size_px[0];
        cpu_fetch_half(&test->cpu, RT_HISTORY, x, y, value);
        cpu_fetch_half(&test->cpu, RT_HISTORY_STATE, x, y, history);
        count += value[0] == 0.5f;
        assert_true(value[0] == 0.5f ? history[0] == 1.0f : value[0] == 0.25f);
    }
    return count;
}

static void open_two_lights(struct neph_vulkan *vulkan, const char *assignments, int width,
                            int height, struct test_passes *test)
{
    reconstruct_open(vulkan, width, height, test, "box=none fresh_weight=0 %s", assignments);
    test_fill(test, RT_RAY, 0.5f, 0, 0, 1);
    test_fill(test, RT_HISTORY_BEFORE, 0.25f, 0, 0, 1);
}

static void test_cuts_and_first_frames(void **state)
{
    static const struct {
        const char *assignments;
        bool is_cut, has_history, uses_history;
    } cases[] = {
        {"", false, true, true},
        {"cut_reset=on", true, true, false},
        {"cut_reset=off", true, true, true},
        {"validity=on", false, false, false},
        {"validity=off", false, false, true}, /* arbitrary memory is used */
        {"validity=off cut_reset=on", true, false, false},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        OWNED(passes) struct test_passes test;
        open_two_lights(*state, cases[i].assignments, 21, 10, &test);
        test.view.is_cut = cases[i].is_cut;
        test.view.has_history = cases[i].has_history;
        reconstruct_run(&test);
        assert_int_equal(count_without_history(&test), cases[i].uses_history ? 0 : 11 * 5);
    }
}

/* Texels at the side that comes into view have no history: of 32 columns those whose centres were
 * off the screen. Texels that were behind the camera have none, either. */
static void test_the_screen_ends(void **state)
{
    for (int columns = 0; columns < 32; columns += 5) {
        OWNED(passes) struct test_passes test;
        open_two_lights(*state, "", 64, 36, &test);
        /* by 2 px per column less half a pixel, so that no centre is at the side */
        test.view.before.right[2] -= (2.0f * (float)columns - 0.5f) * 2.0f / 64 *
                                     test.view.before.half_width;
        reconstruct_run(&test);
        assert_int_equal(count_without_history(&test), columns * 18);
    }
    OWNED(passes) struct test_passes test;
    open_two_lights(*state, "", 64, 36, &test);
    reconstruct_phase(&test.view.before, 3.14159265, 0, 0);
    reconstruct_run(&test);
    assert_int_equal(count_without_history(&test), 32 * 18);
}

/* A post 10 m away, 8 texels wide, before a wall at 100 m, steps aside by 4: the wall appears
 * behind it in 4 columns, and it covers 4 columns of wall. */
static void test_disoccluded_history_is_rejected(void **state)
{
    static const struct {
        const char *assignments;
        int columns;
    } cases[] = {
        {"reject_depth=0", 0},
        {"reject_depth=0.2", 6},  /* 8 less one column at each end, whose neighbours agree */
        {"reject_depth=0.95", 3}, /* of the near depth */
        {"reject_depth=10", 0},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        OWNED(passes) struct test_passes test;
        open_two_lights(*state, cases[i].assignments, 64, 36, &test);
        for (int y = 0; y < 18; y++)
            for (int x = 0; x < 32; x++) {
                const bool is_post = x >= 12 && x < 20, was_post = x >= 8 && x < 16;
                cpu_put_half(&test.cpu, RT_HALF_DEPTH, x, y, (float[4]){is_post ? 10 : 100});
                cpu_put_half(&test.cpu, RT_HALF_DEPTH_BEFORE, x, y,
                             (float[4]){was_post ? 10 : 100});
            }
        reconstruct_run(&test);
        assert_int_equal(count_without_history(&test), cases[i].columns * 18);
    }
}

/* A static scene of checkerboards of near and far depths, with the sky among the far ones, under
 * rotation or sideways motion of the camera, is never rejected: neither where near and far exchange
 * places with every texel of motion, nor where the sky's eye depth would turn with the camera. */
static void test_a_steady_scene_is_not_rejected(void **state)
{
    for (int i = 0; i < 12; i++) {
        OWNED(passes) struct test_passes test;
        open_two_lights(*state, "reject_depth=0.01", 64, 36, &test);
        const float far_m = i / 6 ? NEPH_GPU_FAR_M : 20.0f;
        for (int y = 0; y < 18; y++)
            for (int x = 0; x < 32; x++) {
                const float depth[4] = {x % 2 == y % 2 ? 10.0f : far_m};
                cpu_put_half(&test.cpu, RT_HALF_DEPTH, x, y, depth);
                cpu_put_half(&test.cpu, RT_HALF_DEPTH_BEFORE, x, y, depth);
            }
        /* by 0 to 5 texels; eye depths of solids stay as they are */
        test.view.before.right[2] -= (float)(i % 6) * 2.0f * 2.0f / 64 *
                                     test.view.before.half_width;
        reconstruct_run(&test);
        assert_int_equal(count_without_history(&test), i % 6 * 18); /* off the screen */
    }
}

/* --- sequences ---------------------------------------------------------------------------------
 */

/* A different ray value for every texel. */
static void store_distinct_rays(struct test_passes *test)
{
    for (int y = 0; y < (int)test->view.tile_count[1]; y++)
        for (int x = 0; x < (int)test->view.tile_count[0]; x++) {
            int own[2];
            reconstruct_marched(test, x, y, own);
            const float value[4] = {(float)own[0], (float)own[1], (float)((own[0] ^ own[1]) % 8),
                                    (float)(own[0] % 5) / 4.0f};
            cpu_put_tile(&test->cpu, RT_RAY, x, y, value);
        }
}

static void assert_distinct_rays(const struct test_passes *test)
{
    for (int y = 0; y < (int)test->view.half_size_px[1]; y++)
        for (int x = 0; x < (int)test->view.half_size_px[0]; x++) {
            float value[4];
            cpu_fetch_half(&test->cpu, RT_HISTORY, x, y, value);
            assert_true(value[0] == (float)x && value[1] == (float)y &&
                        value[2] == (float)((x ^ y) % 8) && value[3] == (float)(x % 5) / 4.0f);
        }
}

/* A static scene is complete after four frames: every texel has its own ray, bit by bit, for all
 * sizes, orders and filters. Without further rays it does not change: rounding of places causes no
 * drift. If the bits are equal after four more frames, one for each slot, they stay equal. */
static void test_four_frames_make_a_whole(void **state)
{
    static const char *const assignments[] = {
        "override=none box=none",
        "override=none box=none slot_order=raster",
        "override=none box=none slot_order=diagonal slot_checkerboard=off",
        "override=none box=none validity=off",
    };
    static const int sizes_px[][2] = {{1, 1}, {2, 3}, {5, 4}, {64, 36}, {127, 33}};
    for (int i = 0; i < 4 * 5; i++) {
        OWNED(passes) struct test_passes test;
        reconstruct_open(*state, sizes_px[i % 5][0], sizes_px[i % 5][1], &test, "%s",
                         assignments[i / 5]);
        reconstruct_phase(&test.view.now, 0.4, -0.3, 0.2);
        test.view.before = test.view.now;
        test.view.has_history = 0;
        for (int frame = 0; frame < 4; frame++) {
            store_distinct_rays(&test);
            reconstruct_run(&test);
            reconstruct_next_frame(&test);
        }
        test_fill(&test, RT_RAY, 9, 9, 9, 1);
        test.view.settings[RT_FRESH_WEIGHT] = 0;
        for (int frame = 0; frame < 4; frame++) {
            reconstruct_run(&test);
            reconstruct_next_frame(&test);
        }
        test_swap(&test, RT_HISTORY, RT_HISTORY_BEFORE);
        assert_distinct_rays(&test);
    }
}

/* Without density the result is exactly empty, for any camera, clamp and colour space. */
static void test_no_density_is_exactly_nothing(void **state)
{
    static const char *const assignments[] = {"", "box=variance box_space=reinhard", "box=none",
                                              "box_space=ycocg fresh_weight=0.3 history_weight=0.6",
                                              "history_age_max=20 validity=off cut_reset=off"};
    for (int i = 0; i < 5; i++) {
        OWNED(passes) struct test_passes test;
        uint64_t seed = 41;
        reconstruct_open(*state, 61, 35, &test, "%s", assignments[i]);
        for (int frame = 0; frame < 8; frame++) {
            test.view.before = test.view.now;
            reconstruct_phase(&test.view.before, 0.1 * test_uniform(&seed),
                              0.1 * test_uniform(&seed), 0.1 * test_uniform(&seed));
            test.view.before.position_m[0] = (float)test_uniform(&seed);
            reconstruct_run(&test);
            for (size_t e = 0; e < test_elements(&test, RT_HISTORY); e++) {
                float value[4];
                test_get(&test, RT_HISTORY, e, value);
                assert_true(value[0] == 0.0f && value[1] == 0.0f && value[2] == 0.0f &&
                            value[3] == 1.0f);
            }
            reconstruct_next_frame(&test);
        }
    }
}

static int count_unsound(const struct test_passes *test)
{
    int count = 0;
    for (size_t i = 0; i < test_elements(test, RT_HISTORY); i++) {
        float value[4];
        test_get(test, RT_HISTORY, i, value);
        count += !cpu_is_valid(value);
    }
    return count;
}

/* One bad ray for one frame, with the camera turning by 0.3 texels a frame. With validity it never
 * enters a history. Without, no clamp changes a NaN, because every comparison with it is false, and
 * filtering spreads it over more texels than the rays replace; infinity and -1 are clamped as soon
 * as the ray is gone. */
static void test_a_bad_ray_is_not_used(void **state)
{
    static const float bad[] = {NAN, INFINITY, -1.0f};
    for (int i = 0; i < 6; i++) {
        OWNED(passes) struct test_passes test;
        reconstruct_open(*state, 64, 36, &test, "override=none validity=%s", i / 3 ? "off" : "on");
        test_fill(&test, RT_RAY, 0.5f, 0.5f, 0.5f, 0.5f);
        test_fill(&test, RT_HISTORY_BEFORE, 0.5f, 0.5f, 0.5f, 0.5f);
        test.view.before.right[2] -= 0.6f * 2 / 64 * test.view.before.half_width;
        test.view.before.up[2] -= 0.6f * 2 / 36 * test.view.before.half_height;
        cpu_put_tile(&test.cpu, RT_RAY, 8, 5, (float[4]){0.5f, bad[i % 3], 0.5f, 0.5f});
        int unsound[8];
        for (int frame = 0; frame < 8; frame++) {
            reconstruct_run(&test);
            unsound[frame] = count_unsound(&test);
            reconstruct_next_frame(&test);
            cpu_put_tile(&test.cpu, RT_RAY, 8, 5, (float[4]){0.5f, 0.5f, 0.5f, 0.5f});
        }
        for (int frame = 0; frame < 8 && i < 3; frame++)
            assert_int_equal(unsound[frame], 0);
        if (i == 3)
            assert_true(unsound[0] > 0 && unsound[7] > 2 * unsound[0]);
        if (i > 3)
            assert_true(unsound[0] > 0 && unsound[7] == 0);
    }
}

/* Without usable rays around a texel the result is invalid and marked so. */
static void test_tile_without_rays(void **state)
{
    OWNED(passes) struct test_passes test;
    reconstruct_open(*state, 64, 36, &test, "%s", "");
    for (int i = 0; i < 9; i++)
        cpu_put_tile(&test.cpu, RT_RAY, 7 + i % 3, 3 + i / 3, (float[4]){NAN, 0, 0, 1});
    test_fill(&test, RT_HISTORY_BEFORE, 0.5f, 0.5f, 0.5f, 0.5f);
    reconstruct_run(&test);
    int void_count = 0;
    for (int i = 0; i < 32 * 18; i++) {
        float value[4], history[4];
        cpu_fetch_half(&test.cpu, RT_HISTORY, i % 32, i / 32, value);
        cpu_fetch_half(&test.cpu, RT_HISTORY_STATE, i % 32, i / 32, history);
        void_count += history[0] == 0.0f;
        if (history[0] == 0.0f)
            assert_true(value[0] == 0.0f && value[3] == 1.0f && i % 32 / 2 == 8 && i / 64 == 4);
    }
    assert_int_equal(void_count, 4);
}

/* The first frame with arbitrary memory: no effect, neither then nor later. */
static void test_garbage_is_no_history(void **state)
{
    static const float bad[] = {NAN, INFINITY, 1e30f, -1.0f, 12345.0f};
    for (int i = 0; i < 2; i++) {
        OWNED(passes) struct test_passes test;
        uint64_t seed = 51;
        reconstruct_open(*state, 127, 33, &test, "%s", i ? "target_format=float" : "");
        test_fill(&test, RT_RAY, 0.5f, 0.5f, 0.5f, 0.5f);
        const int targets[] = {RT_HISTORY_BEFORE, RT_HISTORY_STATE_BEFORE, RT_HISTORY,
                               RT_HISTORY_STATE, RT_HALF_DEPTH_BEFORE};
        for (int t = 0; t < 5; t++)
            for (size_t e = 0; e < test_elements(&test, targets[t]); e++) {
                float value[4];
                for (int c = 0; c < 4; c++)
                    value[c] = bad[neph_test_random(&seed) % 5];
                test_set(&test, targets[t], e, value);
            }
        test.view.has_history = 0;
        for (int frame = 0; frame < 3; frame++) {
            reconstruct_run(&test);
            for (size_t e = 0; e < test_elements(&test, RT_HISTORY); e++) {
                float value[4];
                test_get(&test, RT_HISTORY, e, value);
                assert_true(value[0] == 0.5f && value[1] == 0.5f && value[2] == 0.5f &&
                            value[3] == 0.5f);
            }
            reconstruct_next_frame(&test);
        }
    }
}

/* history_age_max = n: a texel of a static scene is the mean of its rays, from the nth on with
 * weight 1 / n for the newest. With fresh_weight only, the mean is exponential from the first ray
 * on, as the article's 0.5 would be if it had an effect. */
static void test_ages_average_rays(void **state)
{
    static const struct {
        const char *assignments;
        double weights[6]; /* of the newest ray, the first to the sixth time */
    } cases[] = {
        {"history_age_max=255", {1, 1 / 2.0, 1 / 3.0, 1 / 4.0, 1 / 5.0, 1 / 6.0}},
        {"history_age_max=3", {1, 1 / 2.0, 1 / 3.0, 1 / 3.0, 1 / 3.0, 1 / 3.0}},
        {"fresh_weight=0.5", {1, 0.5, 0.5, 0.5, 0.5, 0.5}},
        {"fresh_weight=1", {1, 1, 1, 1, 1, 1}},
    };
    for (int i = 0; i < 4; i++) {
        OWNED(passes) struct test_passes test;
        uint64_t seed = 61;
        reconstruct_open(*state, 12, 12, &test, "override=none box=none target_format=float %s",
                         cases[i].assignments);
        test.view.has_history = 0;
        double expected = 0.0;
        for (int frame = 0; frame < 24; frame++) {
            const double ray = test_uniform(&seed);
            test_fill(&test, RT_RAY, (float)ray, 0, 0, 1);
            reconstruct_run(&test);
            if (frame % 4 == 0) { /* the slot of frame 0 */
                const double weight = cases[i].weights[frame / 4];
                expected += weight * (ray - expected);
                int own[2];
                reconstruct_marched(&test, 1, 1, own);
                float value[4], history[4];
                cpu_fetch_half(&test.cpu, RT_HISTORY, own[0], own[1], value);
                cpu_fetch_half(&test.cpu, RT_HISTORY_STATE, own[0], own[1], history);
                neph_assert_close(value[0], expected, 1e-6, 0);
                neph_assert_close(history[0], frame / 4 + 1, 0, 0);
            }
            reconstruct_next_frame(&test);
        }
    }
}

/* The age ends at 255; a texel without history that takes a neighbour's ray has age 1. */
static void test_ages_have_limits(void **state)
{
    OWNED(passes) struct test_passes test;
    reconstruct_open(*state, 12, 12, &test, "override=none");
    test_fill(&test, RT_HISTORY_STATE_BEFORE, 255, 100, 0, 0);
    for (int has_history = 0; has_history < 2; has_history++) {
        test.view.has_history = (uint32_t)has_history;
        reconstruct_run(&test);
        for (size_t i = 0; i < test_elements(&test, RT_HISTORY_STATE); i++) {
            float history[4];
            test_get(&test, RT_HISTORY_STATE, i, history);
            assert_true(history[0] == (has_history ? 255.0f : 1.0f) && history[1] == 100.0f);
        }
    }
}

/* A view in the corner of a buffer full of bad numbers equals the same view in a buffer of its
 * own. */
static void test_view_in_larger_buffer_is_same(void **state)
{
    static const char *const assignments[] = {"", "box=variance",
                                              "reject_depth=0.1 edge_tiles=dropped"};
    static const int inputs[] = {
        RT_HALF_DEPTH,     RT_HALF_DEPTH_BEFORE,   RT_TILE, RT_RAY, RT_RAY_DISTANCE,
        RT_HISTORY_BEFORE, RT_HISTORY_STATE_BEFORE};
    for (int i = 0; i < 3; i++) {
        const struct neph_settings settings = test_settings(assignments[i]);
        OWNED(passes) struct test_passes alone, beside;
        reconstruct_open(*state, 61, 35, &alone, "%s", assignments[i]);
        test_passes_open(*state, &settings, (int[2]){61, 35}, (int[2]){64, 36}, 7, &beside);
        beside.view.has_history = 1;
        reconstruct_phase(&alone.view.before, 0.02, 0.03, 0.01);
        beside.view.before = alone.view.before;
        uint64_t seed = 71;
        for (int t = 0; t < 7; t++) {
            const bool is_tile = inputs[t] == RT_TILE || inputs[t] == RT_RAY ||
                                 inputs[t] == RT_RAY_DISTANCE;
            test_fill(&beside, inputs[t], NAN, -1, INFINITY, NAN);
            const int width = is_tile ? 16 : 31, height = is_tile ? 9 : 18;
            for (int e = 0; e < width * height; e++) {
                float value[4];
                for (int c = 0; c < 4; c++)
                    value[c] = (float)test_uniform(&seed);
                if (inputs[t] == RT_TILE)
                    value[0] = (float)(neph_test_random(&seed) % 4);
                const int x = e % width, y = e / width;
                if (is_tile) {
                    cpu_put_tile(&alone.cpu, inputs[t], x, y, value);
                    cpu_put_tile(&beside.cpu, inputs[t], x, y, value);
                } else {
                    cpu_put_half(&alone.cpu, inputs[t], x, y, value);
                    cpu_put_half(&beside.cpu, inputs[t], x, y, value);
                }
            }
        }
        reconstruct_run(&alone);
        reconstruct_run(&beside);
        for (int e = 0; e < 31 * 18; e++) {
            float a[4], b[4];
            cpu_fetch_half(&alone.cpu, RT_HISTORY, e % 31, e / 31, a);
            cpu_fetch_half(&beside.cpu, RT_HISTORY, e % 31, e / 31, b);
            assert_memory_equal(a, b, sizeof(a));
        }
    }
}

#include "tests/renderer/main.h"
