/* SPDX-License-Identifier: MIT
 *
 * Tests of the reconstruction against its CPU reference, and of its choice of rays and its box. The
 * history is tested in check_history.c.
 */
#include "renderer/realtime/reconstruction/check_reconstruct.h"

static const int sizes_px[][2] = {{1, 1}, {2, 3}, {5, 4}, {64, 36}, {127, 33}, {641, 363}};

/* --- against the CPU reference --------------------------------------------------------------
 */

static double pick(uint64_t *seed, double a, double b, double c)
{
    const uint64_t i = neph_test_random(seed) % 3;
    return i == 0 ? a : i == 1 ? b : c;
}

/* A random choice for every setting of the reconstruction. */
static struct neph_settings random_settings(uint64_t *seed)
{
    static const struct {
        int setting, choices;
    } choices[] = {
        {RT_SLOT_ORDER, 4},
        {RT_CLAMP_PIXEL_DEPTH, 2},
        {RT_TARGET_FORMAT, 2},
        {RT_EDGE_TILES, 2},
        {RT_GATHER, 2},
        {RT_FAR, 2},
        {RT_BOX, 3},
        {RT_BOX_SPACE, 4},
        {RT_BOX_CENTRE, 2},
        {RT_REPROJECT_DEPTH, 2},
        {RT_WIND, 2},
        {RT_REPROJECT_MEASURE, 2},
        {RT_VALIDITY, 2},
        {RT_CUT_RESET, 2},
        {RT_FRESH_SPACE, 4},
        {RT_FALLBACK, 5},
        {RT_FALLBACK_REJECTED, 5},
        {RT_CONTRAST, 2},
        {RT_BOX_SAME_KIND, 2},
        {RT_BOX_HOLD, 2},
        {RT_JITTERED_DEPTH, 2},
        {RT_REPROJECT_JITTER, 2},
        {RT_REJECT_AROUND, 3},
    };
    struct neph_settings settings = test_settings("");
    for (size_t i = 0; i < COUNT(choices); i++)
        settings.values[choices[i].setting] = (double)(neph_test_random(seed) %
                                                       (uint64_t)choices[i].choices);
    settings.values[RT_SKY_M] = pick(seed, 20000, 20000, 1e15);
    settings.values[RT_RAY_DEPTH_MAX_M] = pick(seed, 10000, 10000, 1e15);
    settings.values[RT_BOX_DEPTH] = pick(seed, 0.1, 0.3, 0);
    settings.values[RT_BOX_TRANSMITTANCE] = pick(seed, 0, 0.2, 0);
    settings.values[RT_FRESH_WEIGHT] = pick(seed, 1, 0, 0.2);
    settings.values[RT_HISTORY_WEIGHT] = pick(seed, 1, 1, 0.7);
    settings.values[RT_HISTORY_AGE_MAX] = pick(seed, 0, 5, 20);
    settings.values[RT_HISTORY_FADE] = pick(seed, 1, 0.95, 0);
    settings.values[RT_BOX_AGE] = pick(seed, 1, 0.5, 0);
    settings.values[RT_UPSCALE_TOLERANCE_M] = pick(seed, 1, 1, 100);
    settings.values[RT_BOX_MOTION_PX] = pick(seed, 0, 0.5, 20);
    settings.values[RT_BOX_CHANGE] = pick(seed, 0, 0.05, 0.4);
    settings.values[RT_REJECT_DEPTH] = pick(seed, 0, 0, 0.3);
    settings.values[RT_GRADIENT] = neph_test_random(seed) % 2 == 0;
    settings.values[RT_RELIGHT] = pick(seed, 0, 0.1, 0.3);
    return settings;
}

/* Different enough for any rejection; some are ties between two rays. */
static float random_depth_m(uint64_t *seed)
{
    static const float depths_m[] = {10, 10, 100, 160, 125, 1000, 15000, 30000, NEPH_GPU_FAR_M};
    return depths_m[neph_test_random(seed) % (COUNT(depths_m))];
}

static float random_distance_m(uint64_t *seed)
{
    switch (neph_test_random(seed) % 16) {
    case 0:
        return NEPH_GPU_FAR_M;
    case 1:
        return 0.0f;
    case 2:
        return NAN;
    default:
        return (float)(5.0 * exp(9.0 * test_uniform(seed)));
    }
}

/* Nearly grey, so that corners of a box in Reinhard's space stay away from its end, where the
 * inverse increases rounding errors without limit. */
static void random_light(uint64_t *seed, bool may_be_bad, float value[4])
{
    const double grey = 2.0 * test_uniform(seed);
    for (int c = 0; c < 3; c++)
        value[c] = (float)(grey * (0.9 + 0.2 * test_uniform(seed)));
    value[3] = (float)test_uniform(seed);
    static const float bad[] = {NAN, INFINITY, -1.0f, -INFINITY};
    if (may_be_bad && neph_test_random(seed) % 12 == 0)
        value[neph_test_random(seed) % 4] = bad[neph_test_random(seed) % 4];
}

/* Includes bad rays and histories, which validity = on has to detect. */
static void fill_at_random(struct test_passes *test, uint64_t *seed)
{
    const bool may_be_bad = test->view.settings[RT_VALIDITY] != 0.0f;
    float value[4];
    for (size_t i = 0; i < test_elements(test, RT_TILE); i++) {
        const float units = cpu_stored_depth_m(&test->view, random_depth_m(seed)) * 1e-4f;
        test_set(test, RT_TILE, i, (float[4]){(float)(neph_test_random(seed) % 4), units});
        random_light(seed, may_be_bad, value);
        test_set(test, RT_RAY, i, value);
        test_set(test, RT_RAY_DISTANCE, i, (float[4]){random_distance_m(seed)});
    }
    for (size_t i = 0; i < test_elements(test, RT_CHANGE); i++) {
        float change[4];
        for (int c = 0; c < 3; c++)
            change[c] = (float)(0.9 + 0.2 * test_uniform(seed));
        change[3] = neph_test_random(seed) % 4 ? 0.0f : (float)(0.2 * test_uniform(seed));
        test_set(test, RT_CHANGE, i, change);
    }
    for (size_t i = 0; i < test_elements(test, RT_HISTORY); i++) {
        static const float ages[] = {1, 1, 7, 254, 255};
        test_set(test, RT_HALF_DEPTH, i, (float[4]){random_depth_m(seed)});
        test_set(test, RT_HALF_DEPTH_BEFORE, i, (float[4]){random_depth_m(seed)});
        random_light(seed, may_be_bad, value);
        test_set(test, RT_HISTORY_BEFORE, i, value);
        const bool has_age = !may_be_bad || neph_test_random(seed) % 12 != 0;
        test_set(test, RT_HISTORY_STATE_BEFORE, i,
                 (float[4]){has_age ? ages[neph_test_random(seed) % 5] : 0.0f, 100.0f});
    }
}

/* A wind too weak to move anything: a CPU takes seconds to compile the kernel for static air, which
 * is tested in the nightly run. */
static void blow_by_nothing(struct neph_gpu_view *view)
{
    view->settings[RT_WIND] = 1;
    view->wind_m[0] = 1e-30f;
}

static void open_at_random(struct neph_vulkan *vulkan, const struct neph_settings *settings,
                           const int size_px[2], uint64_t seed, struct test_passes *test)
{
    const int origin_px[2] = {seed % 2 ? 8 : 0, seed % 2 ? 4 : 0};
    test_passes_open(vulkan, settings, size_px, origin_px, seed, test);
    test->view.has_history = 1;
    test->view.frame = (uint32_t)(seed >> 8);
    for (int axis = 0; axis < 2; axis++) { /* different along both axes, to avoid ties */
        test->view.jitter_px[axis] = (float)(seed % (5 + axis)) / 7.0f - 0.4f;
        test->view.jitter_before_px[axis] = (float)(seed % (7 + axis)) / 11.0f - 0.3f;
    }
    reconstruct_phase(&test->view.now, 0.4, -0.3, 0.2); /* not along the axes */
    test->view.before = test->view.now;
    if (!neph_test_is_night() && test->device.kind == NEPH_RT_CPU &&
        test->view.settings[RT_SOLID_MOTION] != 0)
        blow_by_nothing(&test->view);
    fill_at_random(test, &seed);
}

static void compare_words(struct test_passes *test, uint64_t seed)
{
    test_passes_run(test, "reconstruction");
    cpu_reconstruct(&test->cpu);
    test_same_words(test, RT_HISTORY, seed);
    test_same_words(test, RT_HISTORY_STATE, seed);
}

static int find_cases(size_t size)
{
    return sizes_px[size][0] > 200 ? neph_test_by_day(1, 2) : neph_test_by_day(8, 16);
}

/* Restricts fallbacks to those that take one ray, without a mean. */
static void choose_single_rays(struct neph_settings *settings)
{
    static const int fallbacks[] = {RT_FALLBACK, RT_FALLBACK_REJECTED};
    for (int i = 0; i < 2; i++)
        if (settings->values[fallbacks[i]] > RT_FALLBACK_TILE)
            settings->values[fallbacks[i]] = RT_FALLBACK_NEAREST;
}

/* After a cut only rays are left: each half-resolution texel shows its chosen ray. */
static void test_chosen_rays_equal_the_cpu_reference(void **state)
{
    uint64_t seed = 11;
    for (size_t s = 0; s < COUNT(sizes_px); s++)
        for (int i = 0; i < find_cases(s); i++) {
            struct neph_settings settings = random_settings(&seed);
            settings.values[RT_CUT_RESET] = 1;
            choose_single_rays(&settings);
            const uint64_t start = neph_test_random(&seed);
            OWNED(passes) struct test_passes test;
            open_at_random(*state, &settings, sizes_px[s], start, &test);
            test.view.is_cut = 1;
            compare_words(&test, start);
        }
}

/* A history that is brighter or darker than every ray becomes a limit of the box: bit by bit a
 * ray's channel, and the same one as in the CPU reference if both accept the same rays. */
static void test_boxes_hold_the_cpu_reference_s_rays(void **state)
{
    uint64_t seed = 12;
    for (size_t s = 0; s < COUNT(sizes_px); s++)
        for (int i = 0; i < find_cases(s); i++) {
            struct neph_settings settings = random_settings(&seed);
            settings.values[RT_BOX] = RT_BOX_MIN_MAX;
            settings.values[RT_BOX_SPACE] = RT_SPACE_LINEAR;
            settings.values[RT_FRESH_SPACE] = RT_SPACE_LINEAR;
            settings.values[RT_BOX_HOLD] = RT_HOLD_CLAMP;
            choose_single_rays(&settings);
            settings.values[RT_FRESH_WEIGHT] = i % 4 == 0; /* blends are compared elsewhere */
            settings.values[RT_HISTORY_WEIGHT] = 1;
            settings.values[RT_HISTORY_AGE_MAX] = 0;
            settings.values[RT_GRADIENT] = 0; /* which would find a change of 1 */
            const uint64_t start = neph_test_random(&seed);
            const float bright = i % 2 ? 10000.0f : 0.0f;
            OWNED(passes) struct test_passes test;
            open_at_random(*state, &settings, sizes_px[s], start, &test);
            test_fill(&test, RT_HISTORY_BEFORE, bright, bright, bright, bright);
            compare_words(&test, start);
        }
}

/* Allowed errors of places in pixels: rounding errors of a few 2^-24 of the image's width,
 * 641 * 4 * 6e-8 = 1.5e-4 px at most, and as much again for a GPU's divisions. And of points about
 * 10 m away, which may come close to the camera of the frame before. */
static const double place_error_px = 1e-3, point_error_m = 1e-5;

/* Turns the camera of the frame before by place_error_px (0 to 3; with parallel rays moves it), or
 * moves it by point_error_m (4 to 9). */
static void disturb(struct neph_gpu_view *view, int way)
{
    struct neph_gpu_view_camera *camera = &view->before;
    const double sign = way % 2 ? -1.0 : 1.0;
    const float *along[] = {camera->right, camera->up, camera->forward};
    if (way >= 4) {
        for (int k = 0; k < 3; k++)
            camera->position_m[k] += (float)(sign * point_error_m * along[way / 2 - 2][k]);
        return;
    }
    float *axis = way < 2 ? camera->right : camera->up;
    const float tangent = way < 2 ? camera->half_width : camera->half_height;
    const double shift = sign * 2.0 * place_error_px * tangent / view->size_px[way / 2];
    for (int k = 0; k < 3; k++)
        if (camera->is_parallel)
            camera->position_m[k] += (float)(shift * axis[k]);
        else
            axis[k] += (float)(shift * camera->forward[k]);
}

/* The CPU reference's result for a target, and its change when the camera of the frame before is
 * disturbed by the allowed error of places: a slope in smooth places, the whole value near a
 * decision. Places are exact in static frames. */
struct expected {
    int target;
    float (*value)[4];
    double (*doubt)[4];
};

static void find_expected(struct test_passes *test, struct expected expected[2])
{
    const size_t count = test_elements(test, RT_HISTORY);
    const struct neph_gpu_view_camera camera = test->view.before;
    const bool follows_jitter = test->view.settings[RT_REPROJECT_JITTER] != 0.0f &&
                                test->view.settings[RT_JITTERED_DEPTH] != 0.0f;
    const bool is_still = memcmp(&camera, &test->view.now, sizeof(camera)) == 0 && !follows_jitter;
    for (int way = -1; way < (is_still ? 0 : 10); way++) {
        if (way >= 0)
            disturb(&test->view, way);
        cpu_reconstruct(&test->cpu);
        test->view.before = camera;
        for (int t = 0; t < 2; t++)
            for (size_t i = 0; i < count; i++) {
                float *value = expected[t].value[i], disturbed[4];
                test_get(test, expected[t].target, i, way < 0 ? value : disturbed);
                for (int c = 0; c < 4; c++)
                    expected[t].doubt[i][c] += way < 0 ? 0.0
                                                       : fabs((double)disturbed[c] - value[c]);
            }
    }
}

/* Values are up to 2.2. Float32 sums of at most 16 taps or 9 rays, each rounded a few times: 3e-6.
 * Reinhard's conversion and its inverse increase that by (1 + Y)^2 < 11; the rounding of a half may
 * differ by one step, 2^-10 of the value. Distances are copied. Ages are, too, unless the box
 * removes a part of them: an age of at most 20 times a change, rounded to 2^-22, over the least
 * box_change. */
static double rounding_error(const struct neph_gpu_view *view, int target, int channel,
                             double value)
{
    const bool is_half = view->settings[RT_TARGET_FORMAT] == RT_FORMAT_HALF;
    if (target == RT_HISTORY_STATE) {
        const bool is_copied = channel != 0 || view->settings[RT_BOX_AGE] == 1.0f ||
                               view->settings[RT_HISTORY_AGE_MAX] == 0.0f;
        return is_copied ? 0.0 : 20 * 0x1p-22 / 0.05 + (is_half ? 0x1p-10 * fabs(value) : 0.0);
    }
    const bool is_reinhard = view->settings[RT_BOX_SPACE] == RT_SPACE_REINHARD;
    return (is_reinhard ? 4e-5 : 3e-6) + (is_half ? 0x1p-10 * fabs(value) : 0.0);
}

static void compare_value(struct test_passes *test, const struct expected *expected, size_t i,
                          uint64_t seed)
{
    float actual[4];
    test_get(test, expected->target, i, actual);
    for (int c = 0; c < 4; c++) {
        const double value = expected->value[i][c];
        const double allowed = expected->doubt[i][c] +
                               rounding_error(&test->view, expected->target, c, value);
        if (!(actual[c] == value || fabs(actual[c] - value) <= allowed))
            fail_msg("seed %llu: channel %d of element %zu of target %d is %.9g, %.9g in the "
                     "CPU reference, allowed %.3g",
                     (unsigned long long)seed, c, i, expected->target, (double)actual[c], value,
                     allowed);
    }
}

/* Returns the number of elements near a decision, whose comparison means little. */
static size_t compare_values(struct test_passes *test, uint64_t seed)
{
    const size_t count = test_elements(test, RT_HISTORY);
    struct expected expected[2] = {{.target = RT_HISTORY}, {.target = RT_HISTORY_STATE}};
    for (int t = 0; t < 2; t++) {
        expected[t].value = calloc(count, sizeof(*expected[t].value));
        expected[t].doubt = calloc(count, sizeof(*expected[t].doubt));
    }
    find_expected(test, expected);
    size_t doubtful = 0;
    for (int t = 0; t < 2; t++) {
        test_take(test, expected[t].target);
        for (size_t i = 0; i < count; i++)
            compare_value(test, &expected[t], i, seed);
    }
    for (size_t i = 0; i < count; i++)
        doubtful += expected[0].doubt[i][0] > 0.05;
    for (int t = 0; t < 2; t++) {
        free(expected[t].value);
        free(expected[t].doubt);
    }
    return doubtful;
}

static void move_at_random(struct neph_gpu_view *view, double much, uint64_t *seed)
{
    double numbers[9];
    for (int i = 0; i < 9; i++)
        numbers[i] = much * (test_uniform(seed) - 0.5);
    if (!view->now.is_parallel)
        reconstruct_phase(&view->before, numbers[0], numbers[1], numbers[2]);
    for (int k = 0; k < 3; k++) {
        view->before.position_m[k] = (float)(10.0 * numbers[3 + k]);
        view->wind_m[k] = (float)(10.0 * numbers[6 + k]);
    }
}

/* Any camera, any settings. Static frames are compared exactly. */
static void test_values_equal_the_cpu_reference(void **state)
{
    uint64_t seed = 13;
    size_t doubtful = 0, total = 0;
    int resting = 0; /* with a GPU's kernel for static frames */
    for (size_t s = 0; s < COUNT(sizes_px); s++)
        for (int i = sizes_px[s][0] > 200 ? 39 : neph_test_by_day(20, 0); i < 40; i++) {
            struct neph_settings settings = random_settings(&seed);
            if (i % 4 == 0)
                settings.values[RT_SOLID_MOTION] = settings.values[RT_WIND] = 0;
            uint64_t start = neph_test_random(&seed);
            OWNED(passes) struct test_passes test;
            open_at_random(*state, &settings, sizes_px[s], start, &test);
            uint64_t random = start;
            if (i % 8 == 4 || i % 8 == 6)
                test_make_parallel(&test.view, 20.0f);
            if (i % 4 != 0)
                move_at_random(&test.view, i % 4 == 1 ? 1.0 : 0.03, &random);
            test.view.is_cut = neph_test_random(&random) % 16 == 0;
            test_passes_run(&test, "reconstruction");
            doubtful += compare_values(&test, start);
            total += reconstruct_threads(&test);
            resting += neph_rt_is_view_static(&test.view) && test.device.kind == NEPH_RT_GPU;
        }
    assert_true(resting >= 4);
    if (doubtful * 1000 > total)
        fail_msg("%zu of %zu elements are in doubt", doubtful, total);
}

/* --- the rays and the box ----------------------------------------------------------------------
 */

/* Sets the ray of a tile: its depth [m], its light in all colours, its transmittance. */
static void put_ray(struct test_passes *test, int x, int y, double depth_m, double light,
                    double transmittance)
{
    float tile[4];
    cpu_fetch_tile(&test->cpu, RT_TILE, x, y, tile);
    tile[1] = (float)(depth_m * 1e-4);
    cpu_put_tile(&test->cpu, RT_TILE, x, y, tile);
    const float value[4] = {(float)light, (float)light, (float)light, (float)transmittance};
    cpu_put_tile(&test->cpu, RT_RAY, x, y, value);
}

static double light_at(const struct test_passes *test, int x, int y)
{
    return half_value(test, RT_HISTORY, x, y, 0);
}

/* A texel of the tile that is not marched in this frame. */
static void skipped_half_pixel(const struct test_passes *test, int tile_x, int tile_y,
                               int half_pixel[2])
{
    reconstruct_marched(test, tile_x, tile_y, half_pixel);
    half_pixel[0] ^= 1;
}

/* The tile's own ray ends on a ridge, at 10 km at most; one ray beside it is the sky's. Rays are
 * stored at 10 km at most and the sky at 20 km, so a ridge beyond 15 km, whose own depth is
 * unlimited, is nearer to the sky. Beyond 40 km it is farther than 20 km from both, the article's
 * initial distance of the search: the first ray, its own, is kept. */
static void test_far_ridges_take_the_sky_s_light(void **state)
{
    static const double ridges_m[] = {9000, 14900, 15100, 39000, 41000};
    static const double unlimited[] = {1, 1, 2, 2, 1};
    for (int limited = 0; limited < 2; limited++) {
        OWNED(passes) struct test_passes test;
        reconstruct_open(*state, 20, 4, &test,
                         "sky_m=20000 ray_depth_max_m=10000 clamp_pixel_depth=%s",
                         limited ? "on" : "off");
        test.view.has_history = 0;
        for (int i = 0; i < 5; i++) {
            int skipped[2];
            skipped_half_pixel(&test, 1, 0, skipped);
            for (int x = 0; x < 5; x++)
                put_ray(&test, x, 0, 50, 0, 1);
            put_ray(&test, 1, 0, fmin(ridges_m[i], 10000), 1, 1);
            put_ray(&test, 2, 0, 20000, 2, 1);
            cpu_put_half(&test.cpu, RT_HALF_DEPTH, skipped[0], skipped[1],
                         (float[4]){(float)ridges_m[i]});
            reconstruct_run(&test);
            neph_assert_close(light_at(&test, skipped[0], skipped[1]), limited ? 1.0 : unlimited[i],
                              0, 0);
        }
    }
}

/* A texel at an edge of depths: of the nine rays only its own tile's has its depth, or only one
 * neighbour's; all others belong to another layer. How much of a correct history remains? */
static void test_a_box_of_one_ray_erases_history(void **state)
{
    static const struct {
        const char *assignments;
        double own_m, expected;
    } cases[] = {
        /* the neighbours are as deep as the pixel: their rays, 2 to 9, and the history between */
        {"box_centre=on", 1000, 5.5},
        {"box_centre=off", 1000, 5.5},
        /* only the own ray has: history becomes that ray */
        {"box_centre=on", 100, 1},
        {"box_centre=off", 100, 1},
        /* or the transmittance decides, which rays 2 to 4 share */
        {"box_centre=on box_transmittance=0.1", 100, 4},
        {"box=none", 100, 5.5},
        {"history_weight=0", 1000, 2}, /* the nearest, the first neighbour's */
        {"history_weight=0.5", 1000, 3.75},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        OWNED(passes) struct test_passes test;
        reconstruct_open(*state, 12, 12, &test, "%s", cases[i].assignments);
        static const int order[9][2] = {{1, 1}, {2, 1}, {0, 1}, {1, 2}, {1, 0},
                                        {2, 2}, {0, 2}, {2, 0}, {0, 0}};
        for (int ray = 0; ray < 9; ray++)
            put_ray(&test, order[ray][0], order[ray][1], ray == 0 ? 100 : 1000, 1 + ray,
                    ray < 4 ? 0.5 : 0.9);
        test_fill(&test, RT_HISTORY_BEFORE, 5.5f, 5.5f, 5.5f, 0.7f);
        test_fill(&test, RT_HALF_DEPTH, (float)cases[i].own_m, 0, 0, 0);
        reconstruct_run(&test);
        int skipped[2];
        skipped_half_pixel(&test, 1, 1, skipped);
        neph_assert_close(light_at(&test, skipped[0], skipped[1]), cases[i].expected, 0, 0);
    }
}

/* Nine rays 1 to 9: mean 5, standard deviation sqrt(60 / 9). The box is extended to the nearest
 * ray, here the own one, 1. */
static void test_variance_box(void **state)
{
    static const struct {
        double history, expected;
    } cases[] = {{100, 5.0 + 2.581988897471611}, {6, 6}, {0, 1}};
    for (int i = 0; i < 3; i++) {
        OWNED(passes) struct test_passes test;
        reconstruct_open(*state, 12, 12, &test, "box=variance target_format=float");
        for (int ray = 0; ray < 9; ray++)
            put_ray(&test, ray % 3, ray / 3, 100, ray == 4 ? 1 : ray < 4 ? ray + 2 : ray + 1, 1);
        const float history = (float)cases[i].history;
        test_fill(&test, RT_HISTORY_BEFORE, history, history, history, 1);
        reconstruct_run(&test);
        int skipped[2];
        skipped_half_pixel(&test, 1, 1, skipped);
        neph_assert_close(light_at(&test, skipped[0], skipped[1]), cases[i].expected, 1e-6, 0);
    }
}

static const char *const spaces[] = {"box_space=linear fresh_weight=0 target_format=float",
                                     "box_space=reinhard fresh_weight=0 target_format=float",
                                     "box_space=ycocg fresh_weight=0 target_format=float"};

/* Radiance stays valid, also where primaries of different rays meet in a corner of the box. */
static void test_spaces_keep_light_sound(void **state)
{
    uint64_t seed = 21;
    for (int i = 0; i < 3; i++) {
        OWNED(passes) struct test_passes test;
        reconstruct_open(*state, 64, 36, &test, "%s", spaces[i]);
        for (size_t t = 0; t < test_elements(&test, RT_RAY); t++) {
            float value[4] = {0, 0, 0, 0.5f};
            value[neph_test_random(&seed) % 3] = (float)exp(20.0 * test_uniform(&seed) - 10.0);
            test_set(&test, RT_RAY, t, value);
        }
        for (size_t t = 0; t < test_elements(&test, RT_HISTORY); t++) {
            float value[4] = {0, 0, 0, 0.5f};
            for (int c = 0; c < 3; c++)
                value[c] = (float)exp(20.0 * test_uniform(&seed) - 10.0);
            test_set(&test, RT_HISTORY_BEFORE, t, value);
        }
        reconstruct_run(&test);
        for (size_t t = 0; t < test_elements(&test, RT_HISTORY); t++) {
            float value[4];
            test_get(&test, RT_HISTORY, t, value);
            assert_true(cpu_is_valid(value));
        }
    }
}

/* A cyan history among yellow and magenta rays: all rays are redder, so its red rises until, in
 * Reinhard's space, the three luminances add up to 1.2. The result is as bright as the history
 * was. */
static void test_no_corner_of_the_box_is_a_firefly(void **state)
{
    static const float rays[2][4] = {{3.48f, 2.436f, 0, 1}, {3.458f, 0, 23.86f, 1}};
    OWNED(passes) struct test_passes test;
    reconstruct_open(*state, 64, 36, &test,
                     "box_space=reinhard fresh_weight=0 target_format=float");
    for (size_t t = 0; t < test_elements(&test, RT_RAY); t++)
        test_set(&test, RT_RAY, t, rays[t % 2]);
    test_fill(&test, RT_HISTORY_BEFORE, 0, 70, 690, 1);
    reconstruct_run(&test);
    const double brightest = 0.7152 * 70 + 0.0722 * 690;
    for (int x = 2; x < 30; x++) {
        float value[4];
        cpu_fetch_half(&test.cpu, RT_HISTORY, x, 9, value);
        const double luminance = 0.2126 * value[0] + 0.7152 * value[1] + 0.0722 * value[2];
        assert_true(value[0] > 50.0f);
        assert_true(luminance < 1.3 * (1.0 + brightest));
    }
}

/* Conversion and its inverse round no value inside the box of black, white and three colours. */
static void test_spaces_keep_colours_in_the_box(void **state)
{
    static const float corners[5][4] = {
        {0, 0, 0, 0}, {50, 0, 0, 0}, {0, 50, 0, 0}, {0, 0, 50, 0}, {50, 50, 50, 1}};
    for (int i = 0; i < 3; i++) {
        OWNED(passes) struct test_passes test;
        reconstruct_open(*state, 64, 36, &test, "%s", spaces[i]);
        for (size_t t = 0; t < test_elements(&test, RT_RAY); t++)
            test_set(&test, RT_RAY, t, corners[t % 5]); /* all five among 3x3 of 16 in a row */
        test_fill(&test, RT_HISTORY_BEFORE, 6.1f, 7.3f, 6.7f, 0.3f);
        reconstruct_run(&test);
        for (int x = 2; x < 30; x++) {
            float before[4], value[4];
            cpu_fetch_half(&test.cpu, RT_HISTORY_BEFORE, x, 9, before);
            cpu_fetch_half(&test.cpu, RT_HISTORY, x, 9, value);
            assert_memory_equal(value, before, sizeof(value));
        }
    }
}

/* In a size that is not a multiple of 4 the article's neighbours end one tile early. The last tile
 * but one then lacks the ray that has its texel's depth. */
static void test_the_last_cut_tiles(void **state)
{
    for (int dropped = 0; dropped < 2; dropped++) {
        OWNED(passes) struct test_passes test;
        reconstruct_open(*state, 41, 23, &test, "edge_tiles=%s", dropped ? "dropped" : "kept");
        test.view.has_history = 0;
        for (int i = 0; i < 11 * 6; i++)
            put_ray(&test, i % 11, i / 11, i % 11 == 10 || i / 11 == 5 ? 1000 : 10, i / 11 + 0.5,
                    1);
        test_fill(&test, RT_HALF_DEPTH, 1000, 0, 0, 0);
        reconstruct_run(&test);
        int skipped[2];
        skipped_half_pixel(&test, 9, 2, skipped);
        neph_assert_close(light_at(&test, skipped[0], skipped[1]), 2.5, 0, 0);
        skipped_half_pixel(&test, 4, 4, skipped);
        neph_assert_close(light_at(&test, skipped[0], skipped[1]), dropped ? 4.5 : 5.5, 0, 0);
    }
}

/* Every tile has a depth of its own, and every texel without a ray has the depth of the tile to its
 * right, whose ray it should find. In 641 pixels, 161 tiles, normalised coordinates run ahead by
 * corner * (644 / 641 - 1), half a tile from corner 107 on, the lower right one of tile 106. From
 * there on the tile below appears to have the depth of the tile to the right, and further on the
 * tile above (the buffer's end saves tile 159). In 642 and 643 pixels half a tile is not
 * reached. */
static void test_where_gathered_depths_drift(void **state)
{
    static const struct {
        const char *assignments;
        int width_px, first_wrong;
    } cases[] = {
        {"gather=texel target_format=float", 641, 159},
        {"gather=normalised target_format=float", 641, 106},
        {"gather=normalised target_format=float", 642, 159},
        {"gather=normalised target_format=float", 643, 159},
        {"gather=normalised target_format=float", 644, 159},
    };
    for (int i = 0; i < 5; i++) {
        OWNED(passes) struct test_passes test;
        reconstruct_open(*state, cases[i].width_px, 4, &test, "%s", cases[i].assignments);
        test.view.has_history = 0;
        for (int x = 0; x < 161; x++)
            put_ray(&test, x, 0, 100 + x, x, 1);
        for (int x = 0; x < 160; x++)
            for (int k = 0; k < 4; k++)
                cpu_put_half(&test.cpu, RT_HALF_DEPTH, 2 * x + k % 2, k / 2,
                             (float[4]){101.0f + (float)x});
        reconstruct_run(&test);
        for (int x = 0; x < 159; x++) {
            int skipped[2];
            skipped_half_pixel(&test, x, 0, skipped);
            const double expected = x < cases[i].first_wrong ? x + 1 : x;
            neph_assert_close(light_at(&test, skipped[0], skipped[1]), expected, 0, 0);
        }
    }
}

#include "tests/renderer/main.h"
