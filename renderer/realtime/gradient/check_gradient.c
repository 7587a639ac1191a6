/* SPDX-License-Identifier: MIT
 *
 * Tests of the temporal gradient: its passes against their CPU references, and its result for rays
 * that are marched twice: 0 in constant light, 1 where everything has changed, and the gain of
 * light that changes uniformly.
 */
#include "renderer/realtime/light_history.h"
#include "renderer/realtime/tile_index/check_reference_slots.h"
#include "tests/renderer/sequence_test.h"

static float random_light(uint64_t *seed)
{
    static const float odd[] = {0.0f, 1e-9f, 65504.0f, 1e9f, NAN, INFINITY, -1.0f};
    const uint64_t i = neph_test_random(seed) % 20;
    return i < 7 ? odd[i] : (float)test_uniform(seed);
}

static void fill(struct test_passes *test, int target, uint64_t *seed)
{
    for (size_t i = 0; i < test_elements(test, target); i++) {
        float value[4];
        for (int c = 0; c < 4; c++)
            value[c] = random_light(seed);
        test_set(test, target, i, value);
    }
}

/* Stored samples as the pass writes them: halves that are numbers and not below 0. Some equal the
 * present rays. */
static void fill_kept(struct test_passes *test, int target, uint64_t *seed)
{
    for (size_t i = 0; i < test_elements(test, target); i++) {
        float value[4];
        for (int c = 0; c < 4; c++)
            value[c] = (float)test_uniform(seed);
        test_set(test, target, i, value);
    }
}

/* Depths that differ by a tenth or more, or do not, in both frames. */
static void fill_depths(struct test_passes *test, int target, uint64_t *seed)
{
    static const float depths_m[] = {10.0f, 10.0f, 10.0f, 10.5f, 11.0f, 100.0f, NEPH_GPU_FAR_M};
    for (size_t i = 0; i < test_elements(test, target); i++)
        test_set(test, target, i, (float[4]){depths_m[neph_test_random(seed) % 7]});
}

/* Gradient samples, some without an earlier sample. */
static void fill_samples(struct test_passes *test, int now, int then, uint64_t *seed)
{
    fill_kept(test, now, seed);
    fill_kept(test, then, seed);
    for (size_t i = 0; i < test_elements(test, then); i++) {
        float value[4];
        test_get(test, then, i, value);
        value[3] = (float)(neph_test_random(seed) % 3 == 0);
        test_set(test, then, i, value);
        test_get(test, now, i, value);
        value[3] *= (float)(neph_test_random(seed) % 2);
        test_set(test, now, i, value);
    }
}

static void test_the_passes_equal_their_cpu_reference(void **state)
{
    static const int sizes_px[][2] = {{1, 1}, {2, 3}, {5, 4}, {64, 36}, {127, 33}};
    static const char *const settings_texts[] = {
        "gradient=on", "gradient=on taa_jitter_length=1 target_format=float relight=0.5",
        "gradient=on taa_jitter_length=8 reject_depth=0.1",
        "gradient=on taa_jitter_length=20 relight=0.1 change_hold=0.8"};
    uint64_t seed = 5;
    for (int round = 0; round < 80; round++) {
        const uint64_t start = seed;
        const struct neph_settings settings = test_settings(settings_texts[round / 2 % 4]);
        OWNED(passes) struct test_passes test;
        test_passes_open(*state, &settings, sizes_px[round / 2 % 5],
                         (int[2]){round % 3 * 4, round % 2 * 8}, start, &test);
        test.view.frame = (uint32_t)neph_test_random(&seed);
        fill(&test, RT_RAY, &seed);
        fill(&test, RT_BEHIND, &seed);
        fill_kept(&test, RT_KEPT_RAY, &seed);
        fill_kept(&test, RT_KEPT_BEHIND, &seed);
        fill_depths(&test, RT_HALF_DEPTH, &seed);
        fill_depths(&test, RT_HALF_DEPTH_BEFORE, &seed);
        fill_samples(&test, RT_SAMPLE_NOW, RT_SAMPLE_THEN, &seed);
        fill_samples(&test, RT_SAMPLE_BEHIND_NOW, RT_SAMPLE_BEHIND_THEN, &seed);
        fill(&test, RT_CHANGE, &seed);
        fill_kept(&test, RT_CHANGE_BEHIND, &seed);
        test.view.has_history = round % 7 != 0;
        test.view.is_cut = round % 11 == 3;
        test.view.strobes_medium = round % 13 == 5;
        test.view.strobes_behind = round % 13 == 7;
        if (round % 2) {
            test_passes_run(&test, "change");
            cpu_change(&test.cpu);
        } else {
            test_passes_run(&test, "gradient");
            cpu_gradient(&test.cpu);
        }
        const uint32_t writes = (round % 2 ? &neph_rt_change : &neph_rt_gradient)->writes;
        for (int target = 0; target < RT_TARGET_COUNT; target++)
            if (writes & NEPH_RT_BIT(target))
                test_same_words(&test, target, start);
    }
}

/* In every frame one half of the tiles repeats, so one of any 2x1 tiles does; each tile repeats in
 * four frames of eight. */
static void test_tiles_repeat_by_turns(void **state)
{
    struct neph_gpu_view view = {.frame = 0};
    for (int x = 0; x < 4; x++)
        for (int y = 0; y < 4; y++) {
            int repeated = 0;
            for (view.frame = 40; view.frame < 48; view.frame++) {
                repeated += cpu_repeats_ray(&view, x, y);
                assert_true(cpu_repeats_ray(&view, x, y) != cpu_repeats_ray(&view, x + 1, y));
                assert_true(cpu_repeats_ray(&view, x, y) != cpu_repeats_ray(&view, x, y + 1));
            }
            assert_int_equal(repeated, 4);
        }
}

/* Without tiles no ray is marched twice, and nothing is treated as unchanged. */
static void test_it_needs_the_split(void **state)
{
    static const char *const texts[] = {"gradient=on", "gradient=on split=none"};
    for (int i = 0; i < 2; i++) {
        const struct neph_settings settings = test_settings(texts[i]);
        struct neph_gpu_view view;
        neph_rt_view_init(&view, &settings, (int[2]){8, 8}, (int[2]){0, 0}, (int[2]){8, 8});
        assert_int_equal((neph_rt_targets_used(&view) & NEPH_RT_BIT(RT_CHANGE)) != 0, i == 0);
    }
}

/* --- lights that flash ----------------------------------------------------------------------- */

static struct neph_sun make_sun(double irradiance, double angle_rad)
{
    return (struct neph_sun){
        .present = irradiance > 0.0,
        .direction = {cos(angle_rad), sin(angle_rad), 0.0},
        .irradiance_w_per_m2 = {irradiance, irradiance, irradiance},
    };
}

static void add_sun(struct neph_rt_light_history *history, uint32_t number,
                    const struct neph_sun *sun)
{
    const struct neph_scene scene = {.sun = *sun};
    neph_rt_light_history_add(history, number, &scene);
}

/* Irradiances of consecutive frames, ended by -1; whether they flash with a period of four. */
static void test_periodic_flashes(void **state)
{
    static const struct {
        double irradiance[17];
        bool flashes;
    } cases[] = {
        {{4, 4, 1, 1, 4, 4, 1, 1, -1}, true},
        {{4, 1, 4, 1, 4, 1, 4, 1, -1}, true},
        {{4, 4, 4, 4, 4, 4, 4, 0, 4, 4, 4, 0, -1}, true}, /* no sun at all */
        {{4, 3.9, 1, 1, 4, 4, 1.05, 1, -1}, true},        /* alike, not equal */
        {{4, 4, 1, 1, 4, 4, 1, -1}, false},               /* less than two periods */
        {{4, 4, 4, 4, 4, 4, 4, 4, 4, -1}, false},
        {{4, 4, 4, 4, 1, 1, 1, 1, 4, 4, 4, 4, -1}, false}, /* period 8: the samples differ */
        {{4, 4, 4, 4, 4, 4, 9, 4, 4, 4, 4, -1}, false},    /* a single one */
        {{4, 4, 4, 4, 1, 1, 1, 1, -1}, false},             /* a step */
        {{4, 3.6, 3.2, 2.8, 2.4, 2.8, 3.2, 3.6, -1}, false},
        {{4, 3.2, 2.4, 1.6, 0.8, 1.6, 2.4, 3.2, 4, 3.2, 2.4, -1}, false},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_rt_light_history history = {.count = 0};
        for (uint32_t n = 0; cases[i].irradiance[n] >= 0.0; n++) {
            const struct neph_sun sun = make_sun(cases[i].irradiance[n], 1.0);
            add_sun(&history, 60 + n, &sun); /* past the end of the ring */
            add_sun(&history, 60 + n, &sun); /* again, as for a mirrored view */
        }
        assert_int_equal(neph_rt_light_history_is_periodic(&history, 4), cases[i].flashes);
    }
}

/* Each period is tested by itself; a direction that jumps is a flash, too, and a gap in the frames
 * restarts the history. */
static void test_flashes_of_other_periods(void **state)
{
    struct neph_rt_light_history history = {.count = 0};
    for (uint32_t n = 0; n < 80; n++) {
        const struct neph_sun sun = make_sun(4.0, n % 7 < 3 ? 1.0 : 1.2);
        add_sun(&history, n, &sun);
    }
    for (uint32_t period = 1; period < 40; period++)
        assert_int_equal(neph_rt_light_history_is_periodic(&history, period),
                         period % 7 == 0 && period <= NEPH_RT_LIGHT_HISTORY_MAX / 2);
    const struct neph_sun sun = make_sun(4.0, 1.0);
    add_sun(&history, 100, &sun);
    assert_false(neph_rt_light_history_is_periodic(&history, 7));
}

/* Jumps within the given number of frames, limited by the length of the history. */
static void test_a_sun_that_jumps(void **state)
{
    struct neph_rt_light_history history = {.count = 0};
    assert_false(neph_rt_light_history_has_jump(&history, 8));
    for (uint32_t n = 0; n < 100; n++) {
        const struct neph_sun sun = make_sun(n < 20 ? 4.0 : 5.0, 0.09 * n);
        add_sun(&history, n, &sun);
        for (uint32_t pictures = 0; pictures < 40; pictures += 8)
            assert_int_equal(neph_rt_light_history_has_jump(&history, pictures),
                             n >= 20 && n - 20 < pictures);
    }
}

/* The second of two lights: a flash or a step of its intensity or axis counts, its place and the
 * axis of a point light do not. */
static void test_lights_flash_and_jump(void **state)
{
    static const struct {
        double intensity[2], angle_rad[2], x_m[2];
        bool is_spot, differs;
    } cases[] = {
        {{4, 1}, {0, 0}, {0, 0}, false, true},    {{4, 0}, {0, 0}, {0, 0}, true, true},
        {{4, 3.7}, {0, 0}, {0, 0}, true, false},  {{4, 4}, {0, 0.2}, {0, 0}, true, true},
        {{4, 4}, {0, 0.2}, {0, 0}, false, false}, {{4, 4}, {0, 0.05}, {0, 0}, true, false},
        {{4, 4}, {0, 0}, {0, 9}, true, false},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_rt_light_history flash = {.count = 0}, step = {.count = 0};
        struct neph_scene scene = {.light_count = 2};
        struct neph_light *light = &scene.lights[1];
        for (uint32_t n = 0; n < 20; n++) {
            for (int is_step = 0; is_step < 2; is_step++) {
                const int at = is_step ? n >= 10 : n % 4 == 0;
                *light = (struct neph_light){.is_spot = cases[i].is_spot};
                light->position_m.x = cases[i].x_m[at];
                light->intensity_w_per_sr.g = cases[i].intensity[at];
                light->axis = (struct neph_vec3){cos(cases[i].angle_rad[at]),
                                                 sin(cases[i].angle_rad[at]), 0};
                neph_rt_light_history_add(is_step ? &step : &flash, n, &scene);
            }
            assert_int_equal(neph_rt_light_history_has_jump(&step, 8),
                             cases[i].differs && n >= 10 && n < 18);
        }
        assert_int_equal(neph_rt_light_history_is_periodic(&flash, 4), cases[i].differs);
        assert_false(neph_rt_light_history_is_periodic(&flash, 3));
    }
}

/* --- in the pipeline ------------------------------------------------------------------------- */

enum { WIDTH_PX = 64, HEIGHT_PX = 36, TILES = (WIDTH_PX / 4) * (HEIGHT_PX / 4) };

/* Results of one frame over all tiles. */
struct changes {
    int medium, behind; /* tiles with a change */
    int void_tiles;     /* ... of 1 */
    double least, most; /* change of the medium */
    double gain[2];     /* the least and the largest, of the medium */
    bool resting;       /* without override */
};

static void copy_changes(struct neph_rt_device *device, const struct neph_rt_pass *pass,
                         void *context)
{
    struct changes *changes = context;
    if (strcmp(pass->name, "change") != 0)
        return;
    *changes = (struct changes){.least = 2.0, .gain = {2.0, 0.0}, .resting = device->view->resting};
    for (int t = 0; t < 2; t++) {
        const int target = t ? RT_CHANGE_BEHIND : RT_CHANGE;
        OWNED(memory) uint32_t *words = test_words(device, target);
        for (size_t i = 0; i < TILES; i++) {
            float change[4];
            neph_rt_load(&device->view->targets[target], words, i, change);
            *(t ? &changes->behind : &changes->medium) += change[3] > 0.0f;
            changes->void_tiles += change[3] == 1.0f && t == 0;
            for (int c = 0; c < 3 && t == 0; c++) {
                changes->gain[0] = fmin(changes->gain[0], change[c]);
                changes->gain[1] = fmax(changes->gain[1], change[c]);
            }
            if (t == 0) {
                changes->least = fmin(changes->least, change[3]);
                changes->most = fmax(changes->most, change[3]);
            }
        }
    }
}

/* Preset `ours`: as its choices are unchanged, all tests share its kernels. Numbers that shall have
 * no effect are too small for halves, and for whole frames. */
static struct neph_realtime *open_watched(struct neph_vulkan *vulkan, const struct test_scene *test,
                                          const char *assignments, struct changes *changes)
{
    struct neph_settings settings = test_preset("ours", "steps=4 relight=1e-9 change_hold=1e-9");
    settings.values[RT_OVERRIDE_WAKE] = 1e-9;
    test_assign(neph_rt_options, assignments, &settings);
    struct neph_realtime *realtime = test_sequence(vulkan, &test->scene, &settings, WIDTH_PX,
                                                   HEIGHT_PX);
    *changes = (struct changes){0};
    neph_realtime_observe(realtime, copy_changes, changes);
    return realtime;
}

static void dim_the_sun(struct test_scene *test, double part)
{
    struct neph_sun *sun = &test->scene.sun;
    sun->irradiance_w_per_m2 = neph_rgb_scale(sun->irradiance_w_per_m2, part);
}

/* Noise on the rays, jitter, and a slot that is overridden give no change. From the frame on in
 * which the sun is half as bright, all tiles find exactly that change for four frames; behind the
 * media it is found for as many frames as the jitter has places. */
static void test_light_change_differs_from_noise(void **state)
{
    enum { BEFORE = 24, AFTER = 12 };
    struct test_scene test;
    test_scene_fence(&test);
    struct changes changes;
    OWNED(realtime) struct neph_realtime *realtime = open_watched(*state, &test, "", &changes);
    for (int frame = 0; frame < BEFORE + AFTER; frame++) {
        if (frame == BEFORE)
            dim_the_sun(&test, 0.5);
        neph_image_destroy(test_next(realtime, &test.scene, frame, NULL));
        const int since = frame - BEFORE;
        if (frame >= 8 && (since < 0 || since >= 4))
            assert_int_equal(changes.medium, 0);
        if (frame >= 8 && (since < 0 || since >= 7))
            assert_int_equal(changes.behind, 0);
        if (since >= 0 && since < 4) {
            assert_int_equal(changes.medium, TILES);
            neph_assert_close(changes.least, 0.5, 0.0, 2e-3); /* rounding of halves */
            neph_assert_close(changes.most, 0.5, 0.0, 2e-3);
        }
        if (since >= 0 && since < 7)
            assert_true(changes.behind > TILES / 4); /* the ground, not the sky */
    }
}

/* A sun that loses a hundredth in each frame has a gain of 0.96 between two samples, which is 0.99
 * per frame except for (0.96 - 1) / 4 + 0.01 of them, and leaves only the rounding of halves: 1 in
 * 2048 of each sample. A gain below the range of relight is a change. */
static void test_slow_light_is_a_gain(void **state)
{
    enum { BEFORE = 12, AFTER = 8 };
    struct test_scene test;
    test_scene_fence(&test);
    struct changes changes;
    OWNED(realtime)
    struct neph_realtime *realtime = open_watched(*state, &test, "relight=0.1", &changes);
    for (int frame = 0; frame < BEFORE + AFTER; frame++) {
        if (frame >= BEFORE)
            dim_the_sun(&test, frame < BEFORE + AFTER - 1 ? 0.99 : 0.5);
        neph_image_destroy(test_next(realtime, &test.scene, frame, NULL));
        if (frame >= BEFORE + 4 && frame < BEFORE + AFTER - 1) {
            const double expected = 1.0 + (pow(0.99, 4) - 1.0) / 4.0;
            neph_assert_close(changes.gain[0], expected, 0.0, 1e-3 / 4.0);
            neph_assert_close(changes.gain[1], expected, 0.0, 1e-3 / 4.0);
            assert_true(changes.most < 2e-3);
        }
    }
    neph_assert_close(changes.gain[0], 1.0 - 0.1 / 4.0, 0.0, 1e-6);
    assert_true(changes.least > 0.4); /* 1 - 0.99^3 0.5 / 0.9 */
}

/* Half of the light in every other frame: both samples of a ray are equal. With change_strobe all
 * tiles have a change from the eighth frame on; before that and without it none has. */
static void test_unsampled_flash_is_a_change(void **state)
{
    static const char *const strobes[] = {"change_strobe=off", "change_strobe=on"};
    for (int on = 0; on < 2; on++) {
        struct test_scene test;
        test_scene_fence(&test);
        struct changes changes;
        OWNED(realtime)
        struct neph_realtime *realtime = open_watched(*state, &test, strobes[on], &changes);
        for (int frame = 0; frame < 14; frame++) {
            dim_the_sun(&test, frame % 2 ? 0.5 : 2.0);
            neph_image_destroy(test_next(realtime, &test.scene, frame, NULL));
            if (frame == 6)
                assert_int_equal(changes.medium, 0);
        }
        assert_int_equal(changes.void_tiles, on ? TILES : 0);
        assert_true(changes.behind > TILES / 4); /* seven frames apart: one light, one dark */
    }
}

/* For 16 frames after a jump of the sun every second cycle of four frames has no override; a sun
 * that sinks by a hundredth does not jump. */
static void test_override_pauses_after_a_jump(void **state)
{
    struct test_scene test;
    test_scene_fence(&test);
    struct changes changes;
    OWNED(realtime)
    struct neph_realtime *realtime = open_watched(*state, &test, "override_wake=16", &changes);
    for (int frame = 0; frame < 32; frame++) {
        dim_the_sun(&test, frame == 10 ? 0.5 : 0.99);
        neph_image_destroy(test_next(realtime, &test.scene, frame, NULL));
        assert_int_equal(changes.resting, frame >= 10 && frame < 26 && frame / 4 % 2 == 1);
    }
}

/* Where a solid uncovers or hides the background all tiles there find it in the same frame, and no
 * others do. */
static void test_disoccluded_pixels_have_changed(void **state)
{
    struct test_scene test;
    test_scene_fence(&test);
    struct changes changes;
    OWNED(realtime) struct neph_realtime *realtime = open_watched(*state, &test, "", &changes);
    for (int frame = 0; frame < 12; frame++) {
        struct neph_solid *box = &test.scene.solids[2];
        if (frame == 10)
            box->box.min_m.x += 1.0, box->box.max_m.x += 1.0;
        neph_image_destroy(test_next(realtime, &test.scene, frame, NULL));
        if (frame == 9)
            assert_int_equal(changes.void_tiles, 0);
        if (frame == 10) /* a strip at each side, and the tiles around */
            neph_assert_in_range(changes.void_tiles, 8, TILES / 2);
        if (frame == 11)
            assert_int_equal(changes.void_tiles, 0);
    }
}

/* --- the preset ------------------------------------------------------------------------------ */

static double difference(const struct neph_image *a, const struct neph_image *b)
{
    float *one[3], *other[3];
    neph_image_rgb(a, NULL, one);
    neph_image_rgb(b, NULL, other);
    double sum = 0.0;
    for (int i = 0; i < WIDTH_PX * HEIGHT_PX; i++)
        sum += fabs((double)one[1][i] - other[1][i]);
    return sum / (WIDTH_PX * HEIGHT_PX);
}

/* Mean change of a static frame of a preset from frame to frame, and the share of the old light
 * that remains ten frames after the sun is half as bright: 1 is all. */
static void watch(struct neph_vulkan *vulkan, const char *preset, double *unrest, double *left)
{
    enum { BEFORE = 40, WATCHED = 8, AFTER = 10, SETTLED = 60 };
    struct test_scene test;
    test_scene_fence(&test);
    const struct neph_settings settings = test_preset(preset, "steps=4");
    OWNED(realtime)
    struct neph_realtime *realtime = test_sequence(vulkan, &test.scene, &settings, WIDTH_PX,
                                                   HEIGHT_PX);
    struct neph_image *before = NULL, *after = NULL;
    *unrest = 0.0;
    for (int frame = 0; frame < BEFORE; frame++) {
        struct neph_image *image = test_next(realtime, &test.scene, frame, NULL);
        if (frame >= BEFORE - WATCHED)
            *unrest += difference(image, before) / WATCHED;
        neph_image_destroy(before);
        before = image;
    }
    dim_the_sun(&test, 0.5);
    for (int frame = BEFORE; frame < BEFORE + SETTLED; frame++) {
        struct neph_image *image = test_next(realtime, &test.scene, frame, NULL);
        if (frame == BEFORE + AFTER)
            after = image;
        else if (frame == BEFORE + SETTLED - 1)
            *left = difference(after, image) / difference(before, image);
        if (frame != BEFORE + AFTER)
            neph_image_destroy(image);
    }
    neph_image_destroy(after);
    neph_image_destroy(before);
}

/* Less flicker and less lag at once, which no single weight of the anti-aliasing achieves. */
static void test_second_generation_follows_changes(void **state)
{
    double unrest[2], left[2];
    watch(*state, "ours1", &unrest[0], &left[0]);
    watch(*state, "ours", &unrest[1], &left[1]);
    print_message("change per frame %.3g, %.3g; old light left %.3g, %.3g\n", unrest[0], unrest[1],
                  left[0], left[1]);
    assert_true(unrest[1] < 0.25 * unrest[0]);
    assert_true(left[1] < 0.1);
}

#include "tests/renderer/main.h"
