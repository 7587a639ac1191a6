/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/shared/check_reference.h"
#include "renderer/realtime/shared/check_reference_dither.h"
#include "renderer/realtime/tile_index/check_reference_slots.h"

#include <math.h>

enum { TAPS_MAX = 9, SHARED_FRAMES = 16 };

static const float law_per_m = 0.00025f;

struct tap {
    float volume[4];
    float distance_m;
    float difference_m;
    double place; /* weight, bilinear or Gaussian */
    bool is_used, is_foreign;
};

static float setting(const struct reference *cpu, int index)
{
    return cpu->view->settings[index];
}

static int choice(const struct reference *cpu, int index)
{
    return (int)cpu->view->settings[index];
}

/* The output of the reconstruction, or of the a-trous filter. */
static int volume_target(const struct reference *cpu)
{
    return choice(cpu, RT_ATROUS) ? RT_HISTORY_BEFORE : RT_HISTORY;
}

static bool is_square(const struct reference *cpu)
{
    return choice(cpu, RT_UPSCALE) == RT_UPSCALE_SQUARE;
}

static int tap_count(const struct reference *cpu)
{
    return is_square(cpu) ? 9 : 4;
}

static bool is_usable(const struct reference *cpu, const float volume[4], float age)
{
    if (setting(cpu, RT_VALIDITY) == 0)
        return true;
    return isfinite(age) && age > 0.0f && cpu_is_valid(volume);
}

/* ---- the place ------------------------------------------------------------------------------- */

static float find_place(const struct reference *cpu, int axis, int pixel)
{
    const bool is_jittered = setting(cpu, RT_JITTERED_DEPTH) == 0;
    const float jitter_px = is_jittered ? cpu->view->jitter_px[axis] : 0.0f;
    return 0.5f * (float)pixel - 0.25f + 0.5f * jitter_px;
}

static float unit(float value)
{
    return !isfinite(value) || value < 0.0f ? 0.0f : value > 1.0f ? 1.0f : value;
}

static float shift_amount_px(const struct reference *cpu, int x, int y)
{
    const float most_px = setting(cpu, RT_UPSCALE_AMOUNT_PX);
    if (setting(cpu, RT_UPSCALE_LAW) == RT_LAW_CONSTANT)
        return most_px;
    float volume[4], state[4];
    cpu_fetch_half(cpu, volume_target(cpu), x / 2, y / 2, volume);
    cpu_fetch_half(cpu, RT_HISTORY_STATE, x / 2, y / 2, state);
    if (!is_usable(cpu, volume, state[0]))
        return 0.0f;
    return most_px * unit(1.0f - volume[3]) * unit(1.0f - state[1] * law_per_m);
}

static float number(const struct reference *cpu, int x, int y, uint32_t frame, uint32_t channel)
{
    const struct cpu_dither dither = {cpu->view->seed, cpu->noise_ranks};
    return cpu_dither(&dither, (int)setting(cpu, RT_UPSCALE_DITHER), x, y, frame, channel);
}

static void shift_px(const struct reference *cpu, int x, int y, float shift[2])
{
    const uint32_t frame = cpu->view->frame;
    const float amount_px = shift_amount_px(cpu, x, y);
    const bool is_shared = setting(cpu, RT_UPSCALE_PAIR) == RT_PAIR_SHARED;
    const float numbers[2] = {
        number(cpu, x, y, is_shared ? frame % SHARED_FRAMES : frame, 0),
        is_shared ? number(cpu, y, x, frame % SHARED_FRAMES, 0) : number(cpu, x, y, frame, 1),
    };
    for (int axis = 0; axis < 2; axis++)
        shift[axis] = amount_px * (2.0f * numbers[axis] - 1.0f);
}

/* ---- the taps -------------------------------------------------------------------------------- */

static float compared_depth_m(const struct reference *cpu, float eye_m)
{
    if (setting(cpu, RT_CLAMP_PIXEL_DEPTH) != 0)
        return cpu_limited_depth_m(cpu->view, eye_m, 1e6f);
    return eye_m >= NEPH_GPU_FAR_M ? 1e6f : eye_m;
}

static struct tap tap_at(const struct reference *cpu, const int corner[2], int i,
                         const float fraction[2], float scene_m)
{
    const int side = is_square(cpu) ? 3 : 2;
    const int x = corner[0] + i % side, y = corner[1] + i / side;
    float state[4], depth[4];
    struct tap tap;
    cpu_fetch_half(cpu, volume_target(cpu), x, y, tap.volume);
    cpu_fetch_half(cpu, RT_HISTORY_STATE, x, y, state);
    cpu_fetch_half(cpu, RT_HALF_DEPTH, x, y, depth);
    tap.distance_m = state[1];
    tap.difference_m = fabsf(compared_depth_m(cpu, scene_m) - compared_depth_m(cpu, depth[0]));
    tap.place = (double)(i % 2 ? fraction[0] : 1.0f - fraction[0]) *
                (double)(i / 2 ? fraction[1] : 1.0f - fraction[1]);
    if (is_square(cpu))
        tap.place = exp(-pow(fraction[0] - i % 3, 2.0) - pow(fraction[1] - i / 3, 2.0));
    tap.is_used = is_usable(cpu, tap.volume, state[0]);
    tap.is_foreign = choice(cpu, RT_UPSCALE_SAME_KIND) &&
                     (depth[0] >= NEPH_GPU_FAR_M) != (scene_m >= NEPH_GPU_FAR_M);
    return tap;
}

static int nearest_tap(const struct reference *cpu, const struct tap taps[TAPS_MAX],
                       const float fraction[2])
{
    static const int square_order[9] = {4, 0, 1, 2, 3, 5, 6, 7, 8};
    const int first = (fraction[0] < 0.5f ? 0 : 1) + (fraction[1] < 0.5f ? 0 : 2);
    int nearest = -1;
    for (int i = 0; i < tap_count(cpu); i++) {
        const int asked = is_square(cpu) ? square_order[i] : i ^ first;
        if (taps[asked].is_used &&
            (nearest < 0 || taps[asked].difference_m < taps[nearest].difference_m))
            nearest = asked;
    }
    return nearest;
}

static bool depth_matters(const struct reference *cpu, const struct tap taps[TAPS_MAX])
{
    const float contrast = setting(cpu, RT_UPSCALE_CONTRAST);
    float least = INFINITY, largest = -INFINITY;
    for (int i = 0; i < tap_count(cpu); i++) {
        if (taps[i].is_used && taps[i].volume[3] < least)
            least = taps[i].volume[3];
        if (taps[i].is_used && taps[i].volume[3] > largest)
            largest = taps[i].volume[3];
    }
    const bool is_by_opacity = choice(cpu, RT_CONTRAST) == RT_CONTRAST_OPACITY;
    const float unit = is_by_opacity ? 1.0f - least : largest;
    return contrast == 0.0f || largest - least > contrast * unit;
}

static bool all_within(const struct reference *cpu, const struct tap taps[TAPS_MAX], float limit_m)
{
    for (int i = 0; i < tap_count(cpu); i++)
        if (taps[i].is_used && !(taps[i].difference_m < limit_m))
            return false;
    return true;
}

/* ---- the choice ------------------------------------------------------------------------------ */

static double tap_weight(const struct reference *cpu, const struct tap *tap, bool is_nearest,
                         bool regardless, float limit_m)
{
    const float margin_m = limit_m - tap->difference_m;
    const double depth_m = (double)tap->difference_m + setting(cpu, RT_UPSCALE_TOLERANCE_M);
    if (!tap->is_used || tap->is_foreign)
        return 0.0;
    switch (choice(cpu, RT_UPSCALE)) {
    case RT_UPSCALE_BILINEAR:
        return tap->place;
    case RT_UPSCALE_BILATERAL:
        return regardless ? tap->place : margin_m > 0.0f ? tap->place * (double)margin_m : 0.0;
    case RT_UPSCALE_INVERSE:
        return regardless ? tap->place : 1.0 / depth_m;
    case RT_UPSCALE_SQUARE:
        return regardless ? tap->place : tap->place / depth_m;
    default:
        return regardless || is_nearest ? 1.0 : 0.0;
    }
}

/* The mean of floats, rounded once, so that it lies between them. */
static void blend(const struct tap taps[], const double weights[], int count, int nearest,
                  float volume[4])
{
    double total = 0.0;
    for (int i = 0; i < count; i++)
        total += weights[i];
    for (int c = 0; c < 4; c++) {
        double sum = 0.0;
        for (int i = 0; i < count; i++)
            if (weights[i] > 0.0)
                sum += weights[i] * (double)taps[i].volume[c];
        volume[c] = total > 0.0 ? (float)(sum / total) : taps[nearest].volume[c];
    }
}

static void upscale_pixel(const struct reference *cpu, int x, int y)
{
    float depth[4], shift[2], fraction[2];
    int corner[2];
    cpu_fetch_full(cpu, RT_DEPTH, x, y, depth);
    shift_px(cpu, x, y, shift);
    for (int axis = 0; axis < 2; axis++) {
        const float place = find_place(cpu, axis, axis ? y : x) + shift[axis];
        const float first = is_square(cpu) ? floorf(place + 0.5f) - 1.0f : floorf(place);
        corner[axis] = (int)first;
        fraction[axis] = place - first;
    }
    const float limit_m = setting(cpu, RT_UPSCALE_DEPTH) * compared_depth_m(cpu, depth[0]);

    struct tap taps[TAPS_MAX];
    for (int i = 0; i < tap_count(cpu); i++)
        taps[i] = tap_at(cpu, corner, i, fraction, depth[0]);
    const int nearest = nearest_tap(cpu, taps, fraction);
    if (nearest < 0) {
        cpu_put_full(cpu, RT_VOLUME, x, y, (float[4]){0, 0, 0, 1});
        cpu_put_full(cpu, RT_VOLUME_DISTANCE, x, y, (float[4]){0});
        return;
    }
    const int upscale = choice(cpu, RT_UPSCALE);
    const bool allows = upscale == RT_UPSCALE_MEAN || upscale == RT_UPSCALE_INVERSE;
    const bool regardless = !depth_matters(cpu, taps) || (allows && all_within(cpu, taps, limit_m));
    double weights[TAPS_MAX];
    for (int i = 0; i < tap_count(cpu); i++)
        weights[i] = tap_weight(cpu, &taps[i], i == nearest, regardless, limit_m);
    float volume[4];
    blend(taps, weights, tap_count(cpu), nearest, volume);
    cpu_put_full(cpu, RT_VOLUME, x, y, volume);
    cpu_put_full(cpu, RT_VOLUME_DISTANCE, x, y, (float[4]){taps[nearest].distance_m});
}

void cpu_upscale(const struct reference *cpu)
{
    for (int y = 0; y < (int)cpu->view->size_px[1]; y++)
        for (int x = 0; x < (int)cpu->view->size_px[0]; x++)
            upscale_pixel(cpu, x, y);
}
