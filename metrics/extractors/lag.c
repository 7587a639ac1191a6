/* SPDX-License-Identifier: MIT
 *
 * The time that a renderer needs to follow a step of the scene: sun switched, card removed, camera
 * cut. The reference steps between two frames, at `step_frame`.
 *
 * On the luminance Y of linear data, with n = 1, 2, ... the frames from the step on and Y_old the
 * reference without the step:
 *   s(n) = (test(n) - reference(n)) / (Y_old - reference),  q = |s|
 * Y_old is the reference in the frame before the step, with the step at n = 1. If the reference
 * also moves by itself, Y_old(n) is the second reference, the same sequence without the step, in
 * the same frame. For the frame before the step, s(0) = 1 + (test(0) - reference(0)) / step(1); it
 * is 1 if the test had settled. An exponential average with the weight alpha has q(n) = (1 -
 * alpha)^n.
 *
 * A time is the time of the last crossing: after it, q stays at or below the limit until the end of
 * the sequence. Between frames log q is interpolated linearly, which is exact for an exponential
 * average (s is interpolated linearly where it changes its sign). A pixel that has not settled by
 * the end counts with all its frames, which is too few; the shares of such pixels are reported,
 * too.
 *
 * A pixel has a ghost if more than a tenth of the step remains. The ghost area is a share of the
 * whole mask, including pixels without a step, which have no ghost. Permanent errors count as well,
 * so the area at the end is reported, too.
 */
#include "metrics/extractors/extractors.h"

#include "base/threads.h"
#include "metrics/extractors/visible_step.h"
#include "metrics/statistics.h"

#include <math.h>
#include <stdint.h>

enum { RESIDUAL_FRAME = 16, PHASE_COUNT = 4, LIMIT_COUNT = 3 };
/* The index of the ghost limit, and the frames over which ghosts are summed. */
enum { GHOST_LIMIT = 1, GHOST_FRAMES = 32 };

static const double limits[LIMIT_COUNT] = {0.5, 0.1, 0.01};

enum map {
    HALF_LIFE,
    TO_10,
    TO_1,
    OVERSHOOT,
    RESIDUAL,
    UNSETTLED,
    STEPS,
    GHOST_SUM,
    NEVER,
    GHOST_END,
    GHOST_1,
    GHOST_4,
    GHOST_8,
    GHOST_16,
    MAP_COUNT
};

static const int ghost_ages[] = {1, 4, 8, 16}; /* ages of the last four maps */

static const char no_step[] =
    "no pixel of the mask steps by 1/255 of display luma in the reference at step_frame";
static const char too_short[] =
    "fewer than 16 frames since the step, or no pixel of the mask steps at step_frame";

static const char too_short_for_ghosts[] =
    "the sequence ends earlier after step_frame, or no pixel of the image steps there";

static const struct neph_map maps[MAP_COUNT] = {
    [HALF_LIFE] = {"half_life", "frame", 1, false, 16.0, no_step},
    [TO_10] = {"frames_to_10", "frame", 1, false, 64.0, no_step},
    [TO_1] = {"frames_to_1", "frame", 1, false, 128.0, no_step},
    [OVERSHOOT] = {"overshoot", "1", 1, false, 1.0, no_step},
    [RESIDUAL] = {"residual_16", "1", 1, false, 1.0, too_short},
    [UNSETTLED] = {NULL, "1", 1, false, 0.0, no_step},
    [STEPS] = {NULL, "1", 1, false, 0.0, NULL},
    [GHOST_SUM] = {"ghost_frames", "frame", 1, false, GHOST_FRAMES, too_short_for_ghosts},
    [NEVER] = {NULL, "1", 1, false, 0.0, too_short_for_ghosts},
    [GHOST_END] = {NULL, "1", 1, false, 0.0, too_short_for_ghosts},
    [GHOST_1] = {NULL, "1", 1, false, 0.0, too_short_for_ghosts},
    [GHOST_4] = {NULL, "1", 1, false, 0.0, too_short_for_ghosts},
    [GHOST_8] = {NULL, "1", 1, false, 0.0, too_short_for_ghosts},
    [GHOST_16] = {NULL, "1", 1, false, 0.0, too_short_for_ghosts},
};

static const struct neph_metric metrics[] = {
    {"half_life_p50", "frame", 0, INFINITY, NEPH_POOL_PERCENTILE, 0.50, HALF_LIFE, 0,
     "median of the frames until at most half of the step is left"},
    {"half_life_p95", "frame", 0, INFINITY, NEPH_POOL_PERCENTILE, 0.95, HALF_LIFE, 0,
     "95th percentile of the frames until at most half of the step is left"},
    {"half_life_mean", "frame", 0, INFINITY, NEPH_POOL_MEAN, 0, HALF_LIFE, 0,
     "mean of the frames until at most half of the step is left"},
    {"frames_to_10_p95", "frame", 0, INFINITY, NEPH_POOL_PERCENTILE, 0.95, TO_10, 0,
     "95th percentile of the frames until at most 10 % of the step is left"},
    {"frames_to_1_p95", "frame", 0, INFINITY, NEPH_POOL_PERCENTILE, 0.95, TO_1, 0,
     "95th percentile of the frames until at most 1 % of the step is left"},
    {"overshoot_max", "1", 0, INFINITY, NEPH_POOL_MAX, 0, OVERSHOOT, 0,
     "farthest that the test goes beyond the reference, in steps"},
    {"residual_16_mean", "1", 0, INFINITY, NEPH_POOL_MEAN, 0, RESIDUAL, 0,
     "mean remaining part of the step in its 16th frame"},
    {"share_unsettled", "1", 0, 1, NEPH_POOL_SHARE_ABOVE, 2.5, UNSETTLED, 0,
     "share of pixels with more than half of the step left at the end: their half-life is too low"},
    {"share_unsettled_10", "1", 0, 1, NEPH_POOL_SHARE_ABOVE, 1.5, UNSETTLED, 0,
     "share of pixels with more than 10 % of the step left at the end"},
    {"share_unsettled_1", "1", 0, 1, NEPH_POOL_SHARE_ABOVE, 0.5, UNSETTLED, 0,
     "share of pixels with more than 1 % of the step left at the end"},
    {"step_share", "1", 0, 1, NEPH_POOL_MEAN, 0, STEPS, 0,
     "share of pixels that step by 1/255 of display luma: the times are of these"},
    {"share_never_settled", "1", 0, 1, NEPH_POOL_MEAN, 0, NEVER, 0,
     "share of all pixels that have not once come within 10 % of the step since it"},
    {"ghost_area_1", "1", 0, 1, NEPH_POOL_MEAN, 0, GHOST_1, 0,
     "share of all pixels with more than 10 % of the step left in its 1st frame"},
    {"ghost_area_4", "1", 0, 1, NEPH_POOL_MEAN, 0, GHOST_4, 0,
     "share of all pixels with more than 10 % of the step left in its 4th frame"},
    {"ghost_area_8", "1", 0, 1, NEPH_POOL_MEAN, 0, GHOST_8, 0,
     "share of all pixels with more than 10 % of the step left in its 8th frame"},
    {"ghost_area_16", "1", 0, 1, NEPH_POOL_MEAN, 0, GHOST_16, 0,
     "share of all pixels with more than 10 % of the step left in its 16th frame"},
    {"ghost_area_end", "1", 0, 1, NEPH_POOL_MEAN, 0, GHOST_END, 0,
     "the same in the last frame: if it is late enough, the error from other causes than lag"},
    {"ghost_area_frames", "frame", 0, GHOST_FRAMES, NEPH_POOL_MEAN, 0, GHOST_SUM, 0,
     "sum over the first 32 frames of the share with more than 10 % of the step left"},
    {"half_life_phase_0", "frame", 0, INFINITY, NEPH_POOL_SCALAR, 0, 0, 0,
     "mean half-life where x / slot_px is even and y / slot_px is even"},
    {"half_life_phase_1", "frame", 0, INFINITY, NEPH_POOL_SCALAR, 0, 1, 0,
     "mean half-life where x / slot_px is odd and y / slot_px is even"},
    {"half_life_phase_2", "frame", 0, INFINITY, NEPH_POOL_SCALAR, 0, 2, 0,
     "mean half-life where x / slot_px is even and y / slot_px is odd"},
    {"half_life_phase_3", "frame", 0, INFINITY, NEPH_POOL_SCALAR, 0, 3, 0,
     "mean half-life where x / slot_px is odd and y / slot_px is odd"},
    {.name = NULL},
};

enum { STEP_FRAME, SLOT_PX, OLD };

static const char *const olds[] = {"before", "second", NULL};

static const struct neph_option options[] = {
    {"step_frame", NEPH_OPTION_INTEGER, -1, -1, 1e6, NULL,
     "first frame of the reference after its step, counted from 0; -1: there is none"},
    {"slot_px", NEPH_OPTION_INTEGER, 1, 1, 16, NULL,
     "side of the squares of pixels that are traced together [px], for half_life_phase_*"},
    {"old", NEPH_OPTION_CHOICE, 0, 0, 0, olds,
     "the reference without the step: the frame before it, or in each frame the second reference, "
     "for moving scenes"},
    {.name = NULL},
};

/* The state of a pixel: planes of doubles. */
enum plane {
    OLD_REFERENCE,
    OLD_TEST,
    STEP,     /* old - new reference; NaN if it is too small */
    LAST_S,   /* s of the last frame */
    CROSSING, /* one plane per limit: time when q fell to it; negative: q is above it */
    BEYOND = CROSSING + LIMIT_COUNT, /* largest -s */
    LEFT,                            /* q(16); NaN until then */
    GHOSTS,                          /* an integer of bits: see ghost_bit() */
    PLANE_COUNT,
};

struct state {
    int width_px, height_px;
    int step_frame, slot_px;
    bool old_is_second; /* else the frame before the step */
    int frame_count;    /* frames from the step on */
    double gain;        /* display value of the radiance 1 */
    double *planes[PLANE_COUNT];
    bool any_step;
    double phase_means[PHASE_COUNT];
    bool phase_defined[PHASE_COUNT];
};

static const char *obstacle(const struct neph_frame_pair *first,
                            const struct neph_settings *settings)
{
    if (settings->values[STEP_FRAME] < 0.0)
        return "no step: give -s lag:step_frame=N";
    if (settings->values[OLD] > 0.0 && !first->reference_second[0])
        return "lag:old=second needs the scene without its step as the second reference";
    if (settings->values[STEP_FRAME] < 1.0)
        return "step_frame must be at least 1: the frame before the step is needed";
    return NULL;
}

static enum neph_status init(void *state_, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag)
{
    struct state *state = state_;
    const size_t pixel_count = (size_t)first->width_px * (size_t)first->height_px;
    *state = (struct state){.width_px = first->width_px,
                            .height_px = first->height_px,
                            .step_frame = (int)settings->values[STEP_FRAME],
                            .slot_px = (int)settings->values[SLOT_PX],
                            .old_is_second = settings->values[OLD] > 0.0,
                            .gain = exp2(first->viewing->exposure_ev)};
    for (int p = 0; p < PLANE_COUNT; p++)
        state->planes[p] = neph_arena_allocate(first->memory, pixel_count, sizeof(double));
    return neph_arena_check(first->memory, diag);
}

struct work {
    struct state *state;
    const struct neph_frame_pair *pair;
};

static void keep_row(int row, void *context)
{
    const struct work *work = context;
    const struct state *state = work->state;
    const size_t width = (size_t)state->width_px, first = (size_t)row * width;
    for (size_t i = first; i < first + width; i++) {
        state->planes[OLD_REFERENCE][i] = neph_luminance_at(work->pair->reference, i);
        state->planes[OLD_TEST][i] = neph_luminance_at(work->pair->test, i);
    }
}

static double old_at(const struct work *work, size_t i)
{
    return work->state->old_is_second ? neph_luminance_at(work->pair->reference_second, i)
                                      : work->state->planes[OLD_REFERENCE][i];
}

/* The step of a pixel; NaN if it is too small. */
static double step_at(const struct work *work, double reference, size_t i)
{
    const double old = old_at(work, i);
    return neph_is_visible_step(old, reference, work->state->gain) ? old - reference : (double)NAN;
}

static void begin_pixel(const struct work *work, double reference, size_t i)
{
    const struct state *state = work->state;
    const double step = step_at(work, reference, i);
    const double s = 1.0 + (state->planes[OLD_TEST][i] - state->planes[OLD_REFERENCE][i]) / step;
    state->planes[STEP][i] = step;
    state->planes[LAST_S][i] = s;
    for (int k = 0; k < LIMIT_COUNT; k++)
        state->planes[CROSSING + k][i] = fabs(s) > limits[k] ? -1.0 : 0.0;
    state->planes[LEFT][i] = NAN;
}

/* The bit of frame n, for the first 32 frames from the step on: it has a ghost. `settled_bit` is
 * set once there is no ghost. */
static uint64_t ghost_bit(int n)
{
    return (uint64_t)1 << (n - 1);
}

static const uint64_t settled_bit = (uint64_t)1 << GHOST_FRAMES;

static void follow_ghost(const struct state *state, bool is_ghost, size_t i)
{
    uint64_t bits = (uint64_t)state->planes[GHOSTS][i];
    if (!is_ghost)
        bits |= settled_bit;
    else if (state->frame_count <= GHOST_FRAMES)
        bits |= ghost_bit(state->frame_count);
    state->planes[GHOSTS][i] = (double)bits;
}

/* The part of the interval between two frames, 0..1, at which q falls to the limit. */
static double fraction(double before, double now, double limit)
{
    const double q_before = fabs(before), q = fabs(now);
    if (before * now < 0.0)
        return (q_before - limit) / (q_before + q);
    return (log(q_before) - log(limit)) / (log(q_before) - log(q)); /* q = 0: immediately */
}

static void follow_pixel(const struct state *state, double residual, size_t i)
{
    const double before = state->planes[LAST_S][i], now = residual / state->planes[STEP][i];
    for (int k = 0; k < LIMIT_COUNT; k++) {
        double *crossing = &state->planes[CROSSING + k][i];
        if (fabs(now) > limits[k])
            *crossing = -1.0;
        else if (*crossing < 0.0)
            *crossing = state->frame_count - 1 + fraction(before, now, limits[k]);
    }
    follow_ghost(state, fabs(now) > limits[GHOST_LIMIT], i);
    state->planes[BEYOND][i] = fmax(state->planes[BEYOND][i], -now);
    if (state->frame_count == RESIDUAL_FRAME)
        state->planes[LEFT][i] = fabs(now);
    state->planes[LAST_S][i] = now;
}

static void follow_row(int row, void *context)
{
    const struct work *work = context;
    const struct state *state = work->state;
    const size_t width = (size_t)state->width_px, first = (size_t)row * width;
    for (size_t i = first; i < first + width; i++) {
        const double reference = neph_luminance_at(work->pair->reference, i);
        if (state->frame_count == 1)
            begin_pixel(work, reference, i);
        else if (state->old_is_second && !isnan(state->planes[STEP][i]))
            state->planes[STEP][i] = step_at(work, reference, i);
        if (!isnan(state->planes[STEP][i]))
            follow_pixel(state, neph_luminance_at(work->pair->test, i) - reference, i);
    }
}

static enum neph_status extract(void *state_, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    struct state *state = state_;
    struct work work = {state, pair};
    if (pair->frame < state->step_frame - 1)
        return NEPH_OK;
    if (pair->frame == state->step_frame - 1)
        return neph_parallel_rows(state->height_px, keep_row, &work, diag);
    state->frame_count++;
    return neph_parallel_rows(state->height_px, follow_row, &work, diag);
}

/* A time; all frames if it has not been reached; NaN without a step. */
static double compute_crossing_time(const struct state *state, int limit, size_t i)
{
    const double crossing = state->planes[CROSSING + limit][i];
    if (isnan(state->planes[STEP][i]))
        return NAN;
    return crossing < 0.0 ? state->frame_count : crossing;
}

static void take_phases(struct state *state)
{
    struct neph_sum sums[PHASE_COUNT] = {{0.0, 0.0}};
    size_t counts[PHASE_COUNT] = {0};
    for (int y = 0; y < state->height_px; y++) {
        for (int x = 0; x < state->width_px; x++) {
            const int phase = (x / state->slot_px & 1) + 2 * (y / state->slot_px & 1);
            const double time = compute_crossing_time(
                state, 0, (size_t)y * (size_t)state->width_px + (size_t)x);
            if (isnan(time))
                continue;
            neph_sum_add(&sums[phase], time);
            counts[phase]++;
        }
    }
    for (int phase = 0; phase < PHASE_COUNT; phase++) {
        state->phase_defined[phase] = counts[phase] > 0;
        state->phase_means[phase] = counts[phase] > 0
                                        ? neph_sum_value(&sums[phase]) / (double)counts[phase]
                                        : 0.0;
    }
}

static enum neph_status flush(void *state_, struct neph_diag *diag)
{
    struct state *state = state_;
    if (state->frame_count == 0) {
        neph_fail(diag, NEPH_ERR_USAGE, "lag: the sequence ends before step_frame=%d",
                  state->step_frame);
        neph_hint(diag, "frames are counted from 0, without those that are left out as warm-up");
        return NEPH_ERR_USAGE;
    }
    const size_t pixel_count = (size_t)state->width_px * (size_t)state->height_px;
    for (size_t i = 0; i < pixel_count && !state->any_step; i++)
        state->any_step = !isnan(state->planes[STEP][i]);
    take_phases(state);
    return NEPH_OK;
}

/* Pixels without a step have no ghost. */
static double compute_ghost_map_value(const struct state *state, int map, size_t i)
{
    const uint64_t bits = (uint64_t)state->planes[GHOSTS][i];
    const bool steps = !isnan(state->planes[STEP][i]);
    if (!state->any_step)
        return NAN;
    if (map == NEVER)
        return steps && !(bits & settled_bit);
    if (map == GHOST_END)
        return steps && state->planes[CROSSING + GHOST_LIMIT][i] < 0.0;
    const int frames_needed = map == GHOST_SUM ? GHOST_FRAMES : ghost_ages[map - GHOST_1];
    if (state->frame_count < frames_needed)
        return NAN;
    if (map != GHOST_SUM)
        return steps && (bits & ghost_bit(frames_needed));
    int count = 0;
    for (int n = 1; n <= GHOST_FRAMES; n++)
        count += steps && (bits & ghost_bit(n));
    return count;
}

static double compute_lag_value(const struct state *state, int map, size_t i)
{
    double above = 0.0;
    switch (map) {
    case STEPS:
        return !isnan(state->planes[STEP][i]);
    case HALF_LIFE:
    case TO_10:
    case TO_1:
        return compute_crossing_time(state, map - HALF_LIFE, i);
    case OVERSHOOT:
        return isnan(state->planes[STEP][i]) ? (double)NAN : state->planes[BEYOND][i];
    case RESIDUAL:
        return isnan(state->planes[STEP][i]) ? (double)NAN : state->planes[LEFT][i];
    case UNSETTLED:
        for (int k = 0; k < LIMIT_COUNT; k++)
            above += state->planes[CROSSING + k][i] < 0.0;
        return isnan(state->planes[STEP][i]) ? (double)NAN : above;
    default:
        return compute_ghost_map_value(state, map, i);
    }
}

static void rows(const void *state_, int map, int first_row, int row_count, double *const values[3])
{
    const struct state *state = state_;
    const size_t width = (size_t)state->width_px, first = (size_t)first_row * width;
    for (size_t i = 0; i < (size_t)row_count * width; i++)
        values[0][i] = compute_lag_value(state, map, first + i);
}

static const char *scalar(const void *state_, int which, double *value)
{
    const struct state *state = state_;
    if (!state->phase_defined[which])
        return "no pixel of this phase steps in the reference at step_frame";
    *value = state->phase_means[which];
    return NULL;
}

const struct neph_extractor neph_extractor_lag = {
    .name = "lag",
    .help = "frames that the test needs to follow a step or a cut of the reference, and its ghosts",
    .source = "step response; an exponential average of weight a has the half-life "
              "ln(1/2) / ln(1 - a): Yang, Liu, Salvi, A Survey of Temporal Antialiasing "
              "Techniques, Computer Graphics Forum 39, 2020",
    .details =
        "remainder: |test - reference| / |step| of linear luminance; for a moving reference:\n"
        "lag:old=second, with the scene without its step as the second reference; a pixel\n"
        "is then left out if its step is too small in any frame\n"
        "a time is the last crossing, in frames, 1 being the first after the step;\n"
        "between frames the logarithm of the remainder is linear\n"
        "a pixel that never settles counts with all frames since the step\n"
        "pixels with a step below 1/255 of the encoded display value are left out",
    .quantities = NEPH_RADIANCE | NEPH_VOLUME,
    .temporal = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = MAP_COUNT,
    .state_size = sizeof(struct state),
    .obstacle = obstacle,
    .init = init,
    .extract = extract,
    .flush = flush,
    .rows = rows,
    .scalar = scalar,
};
