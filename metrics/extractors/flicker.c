/* SPDX-License-Identifier: MIT
 *
 * Flicker for a static camera: one pass over the frames (flicker_watch.h), then all maps at once,
 * because they share most of the work.
 */
#include "base/threads.h"
#include "metrics/extractors/extractors.h"
#include "metrics/extractors/flicker_spectrum.h"
#include "metrics/extractors/flicker_verdict.h"
#include "metrics/extractors/flicker_watch.h"
#include "metrics/extractors/phase_age.h"
#include "metrics/statistics.h"

#include <math.h>
#include <string.h>

enum { CYCLE = NEPH_FLICKER_CYCLE, FRAME_COUNT_MIN = 16 };

/* Detrended standard deviation in luma below which a pixel counts as static: half a unit in the
 * last place of the 24 bits of a sample of 1. Shares of smaller variances would be shares of
 * rounding errors. */
static const double still_std = 0x1p-24;

static const char too_short[] =
    "flicker needs at least 16 frames: 4 whole cycles of 4, after the warm-up";
static const char unknown_length[] = "the number of frames is not known beforehand";
static const char ended_early[] = "the sequence ended before the announced number of frames";
static const char no_such_phase[] = "the image has no pixel of this phase";

/* ---- options --------------------------------------------------------------------------------- */

enum { WARM_UP, TREND, NOISE_FLOOR, SLOT_ORDER, FIRST_SLOT, SLOT_PX, CHECKERBOARD };

static const char *const trend_choices[] = {"remove", "keep", NULL};
static const char *const noise_choices[] = {"subtract", "keep", NULL};
static const char *const order_choices[] = {"clockwise", "z", "diagonal", NULL};
static const char *const checkerboard_choices[] = {"off", "on", NULL};

static const struct neph_option options[] = {
    [WARM_UP] = {"warm_up", NEPH_OPTION_INTEGER, 0.0, 0.0, 1e6, NULL,
                 "frames at the start that are left out; of the others whole cycles of 4 count"},
    [TREND] = {"trend", NEPH_OPTION_CHOICE, 0.0, 0.0, 0.0, trend_choices,
               "the line in each pixel, fitted together with a cycle of 4, before a4, a2 and "
               "cycle_share"},
    [NOISE_FLOOR] =
        {"noise_floor", NEPH_OPTION_CHOICE, 0.0, 0.0, 0.0, noise_choices,
         "the mean power of the 4 bins beside N/4 and of the 2 below N/2, in a4 and a2"},
    [SLOT_ORDER] = {"slot_order", NEPH_OPTION_CHOICE, 0.0, 0.0, 0.0, order_choices,
                    "in which the 2x2 slots of a cycle are traced: (0,0)(1,0)(1,1)(0,1), "
                    "(0,0)(1,0)(0,1)(1,1), (0,0)(1,1)(1,0)(0,1)"},
    [FIRST_SLOT] = {"first_slot", NEPH_OPTION_INTEGER, 0.0, 0.0, 3.0, NULL,
                    "place in that order of the slot that is fresh in frame 0"},
    [SLOT_PX] = {"slot_px", NEPH_OPTION_INTEGER, 1.0, 1.0, 16.0, NULL,
                 "side of a slot [px]: 2 when tracing has half the resolution"},
    [CHECKERBOARD] =
        {"checkerboard", NEPH_OPTION_CHOICE, 0.0, 0.0, 0.0, checkerboard_choices,
         "the 2x2 of slots with column and row both even (as the first) or both odd are one "
         "place ahead in the order"},
    {0},
};

/* ---- maps and metrics ------------------------------------------------------------------------ */

enum map {
    STD,
    P2P,
    MAD,
    A4,
    A2,
    BLOCK_A4,
    BLOCK_A2,
    CYCLE_SHARE,
    CYCLIC,
    UNREST,
    AGE, /* NEPH_AGE_COUNT maps */
    AGE_SLOPE = AGE + NEPH_AGE_COUNT,
    REFERENCE_STD,
    REFERENCE_A4,
    REFERENCE_A2,
    MAP_COUNT,
};

_Static_assert(MAP_COUNT <= NEPH_MAPS_MAX, "an extractor's maps");

/* Colour scale: black at 0, top at four times the share limit of 4/255, clearly visible flicker. */
#define LUMA_SCALE (16.0 / 255.0)

#define MAP(name, is_signed, scale)                                                                \
    {                                                                                              \
        name, "1", 1, is_signed, scale, ended_early, 0                                             \
    }

static const struct neph_map maps[MAP_COUNT] = {
    [STD] = MAP("std", false, LUMA_SCALE),
    [P2P] = MAP("p2p", false, 2.0 * LUMA_SCALE),
    [MAD] = MAP("mad", false, LUMA_SCALE),
    [A4] = MAP("a4", false, LUMA_SCALE),
    [A2] = MAP("a2", false, LUMA_SCALE),
    [BLOCK_A4] = MAP("block_a4", false, LUMA_SCALE),
    [BLOCK_A2] = MAP("block_a2", false, LUMA_SCALE),
    [CYCLE_SHARE] = MAP("cycle_share", false, 1.0),
    [CYCLIC] = MAP("cyclic", false, 1.0),
    [UNREST] = MAP("unrest", false, LUMA_SCALE),
    [AGE] = MAP("age_0", true, LUMA_SCALE),
    [AGE + 1] = MAP("age_1", true, LUMA_SCALE),
    [AGE + 2] = MAP("age_2", true, LUMA_SCALE),
    [AGE + 3] = MAP("age_3", true, LUMA_SCALE),
    [AGE_SLOPE] = MAP("age_slope", true, 0.25 * LUMA_SCALE),
    [REFERENCE_STD] = MAP("reference_std", false, LUMA_SCALE),
    [REFERENCE_A4] = MAP("reference_a4", false, LUMA_SCALE),
    [REFERENCE_A2] = MAP("reference_a2", false, LUMA_SCALE),
};

/* Scalars: the phase-age table at index 4 phase + age, then the number of frames. */
enum { FRAMES = NEPH_PHASE_COUNT * NEPH_AGE_COUNT };

#define POOLED(name, low, high, pool, parameter, map, help)                                        \
    {                                                                                              \
        name, "1", low, high, NEPH_POOL_##pool, parameter, map, 0, help                            \
    }

#define SUMMARY(name, high, map, what)                                                             \
    POOLED(name "_mean", 0.0, high, MEAN, 0.0, map, "mean of " what),                              \
        POOLED(name "_p95", 0.0, high, PERCENTILE, 0.95, map, "95th percentile of " what),         \
        POOLED(name "_p99", 0.0, high, PERCENTILE, 0.99, map, "99th percentile of " what)

#define SUMMARY_AND_SHARES(name, map, what)                                                        \
    SUMMARY(name, 2.0, map, what),                                                                 \
        POOLED(name "_share_1", 0.0, 1.0, SHARE_ABOVE, 1.0 / 255.0, map,                           \
               "share of pixels above 1/255 of " what),                                            \
        POOLED(name "_share_4", 0.0, 1.0, SHARE_ABOVE, 4.0 / 255.0, map,                           \
               "share of pixels above 4/255 of " what)

#define AGE_METRIC(digit, age)                                                                     \
    POOLED("age_" digit "_bias", -1.0, 1.0, MEAN, 0.0, AGE + age,                                  \
           "mean d where the pixel was traced " digit " frames ago")

#define PHASE_AGE(phase, age)                                                                      \
    POOLED("phase_age_" #phase "_" #age, -1.0, 1.0, SCALAR, 0.0, NEPH_AGE_COUNT *phase + age,      \
           "mean d over the frame, slots of phase (x&1)+2(y&1) = " #phase " traced " #age          \
           " frames ago")

#define PHASE_AGES(phase)                                                                          \
    PHASE_AGE(phase, 0), PHASE_AGE(phase, 1), PHASE_AGE(phase, 2), PHASE_AGE(phase, 3)

static const struct neph_metric metrics[] = {
    SUMMARY_AND_SHARES("std", STD, "the population standard deviation of d"),
    SUMMARY_AND_SHARES("p2p", P2P, "the largest minus the smallest d"),
    SUMMARY_AND_SHARES("mad", MAD, "the mean of |d_t - d_(t-1)|"),
    SUMMARY_AND_SHARES("a4", A4,
                       "four-frame flicker, the amplitude of d at the period of 4 frames"),
    SUMMARY_AND_SHARES("a2", A2, "two-frame flicker, the amplitude of d at the period of 2 frames"),
    SUMMARY_AND_SHARES("block_a4", BLOCK_A4,
                       "four-frame flicker of the mean of d over aligned 2x2 slots"),
    SUMMARY_AND_SHARES("block_a2", BLOCK_A2,
                       "two-frame flicker of the mean of d over aligned 2x2 slots"),
    SUMMARY("cycle_share", 1.0, CYCLE_SHARE,
            "(a4^2 / 2 + a2^2) / variance of the detrended d: 1 cycle of 4, 0 noise or drift"),
    POOLED("cyclic_share", 0.0, 1.0, SHARE_ABOVE, 0.5, CYCLIC,
           "share of pixels with a4 or a2 above 1/255 that also stands out of noise (p < 1e-5)"),
    POOLED("restless_share", 0.0, 1.0, SHARE_ABOVE, 1.0 / 255.0, UNREST,
           "share of pixels with mad - 2 p2p / (N - 1) above 1/255: more than any fade"),
    AGE_METRIC("0", 0),
    AGE_METRIC("1", 1),
    AGE_METRIC("2", 2),
    AGE_METRIC("3", 3),
    POOLED("age_slope", -1.0, 1.0, MEAN, 0.0, AGE_SLOPE,
           "slope of mean d over the ages 0..3 [per frame]: 0 is right reprojection, else lag"),
    SUMMARY("reference_std", 2.0, REFERENCE_STD, "standard deviation of the reference"),
    SUMMARY("reference_a4", 2.0, REFERENCE_A4, "four-frame flicker of the reference"),
    SUMMARY("reference_a2", 2.0, REFERENCE_A2, "two-frame flicker of the reference"),
    PHASE_AGES(0),
    PHASE_AGES(1),
    PHASE_AGES(2),
    PHASE_AGES(3),
    POOLED("flicker_frames", 0.0, INFINITY, SCALAR, 0.0, FRAMES,
           "frames that flicker is taken of: whole cycles of 4, after the warm-up"),
    {0},
};

/* ---- state ----------------------------------------------------------------------------------- */

struct flicker {
    struct neph_phase_age scheme;
    struct neph_flicker_window window;
    int warm_up;
    int width_px, height_px;
    struct neph_flicker_watch watch; /* finished after the last frame */

    struct neph_arena *memory; /* memory of the maps */
    bool complete;             /* the following members are set */
    double *values[MAP_COUNT];
    double phase_age[NEPH_PHASE_COUNT * NEPH_AGE_COUNT];
    double phase_pixel_count[NEPH_PHASE_COUNT];
};

/* Number of frames after the warm-up, in whole cycles. */
static int frames_used(const struct neph_frame_pair *first, const struct neph_settings *settings)
{
    return (first->frame_count - (int)settings->values[WARM_UP]) / CYCLE * CYCLE;
}

static const char *flicker_obstacle(const struct neph_frame_pair *first,
                                    const struct neph_settings *settings)
{
    if (first->frame_count <= 0)
        return unknown_length;
    return frames_used(first, settings) < FRAME_COUNT_MIN ? too_short : NULL;
}

static enum neph_status flicker_init(void *state, const struct neph_frame_pair *first,
                                     const struct neph_settings *settings, struct neph_diag *diag)
{
    struct flicker *flicker = state;
    *flicker = (struct flicker){
        .scheme = {.order = (enum neph_slot_order)settings->values[SLOT_ORDER],
                   .first_slot = (int)settings->values[FIRST_SLOT],
                   .slot_px = (int)settings->values[SLOT_PX],
                   .checkerboard = settings->values[CHECKERBOARD] != 0.0},
        .window = neph_flicker_window_of(frames_used(first, settings),
                                         settings->values[TREND] == 0.0,
                                         settings->values[NOISE_FLOOR] != 0.0),
        .warm_up = (int)settings->values[WARM_UP],
        .width_px = first->width_px,
        .height_px = first->height_px,
        .memory = first->memory,
    };
    return neph_flicker_watch_begin(&flicker->watch, first, flicker->window.frame_count, diag);
}

static enum neph_status flicker_extract(void *state, const struct neph_frame_pair *pair,
                                        struct neph_diag *diag)
{
    struct flicker *flicker = state;
    const int t = pair->frame - flicker->warm_up;
    if (t < 0 || t >= flicker->window.frame_count)
        return NEPH_OK;
    return neph_flicker_watch_frame(&flicker->watch, pair, t, diag);
}

static void flicker_close(void *state)
{
    struct flicker *flicker = state;
    neph_flicker_watch_end(&flicker->watch);
}

/* ---- after the last frame -------------------------------------------------------------------- */

static int lesser(int a, int b)
{
    return a < b ? a : b;
}

/* Spectrum of the mean over the 2x2 slots around a pixel, cut at the border of the image. */
static struct neph_flicker_spectrum block_spectrum(const struct flicker *flicker, int x, int y)
{
    const struct neph_flicker_watch *watch = &flicker->watch;
    const int side_px = 2 * flicker->scheme.slot_px;
    const int left = x / side_px * side_px, right = lesser(left + side_px, flicker->width_px);
    const int top = y / side_px * side_px, bottom = lesser(top + side_px, flicker->height_px);
    double total[NEPH_FLICKER_LINEAR_COUNT] = {0};
    for (int v = top; v < bottom; v++) {
        for (int u = left; u < right; u++) {
            double sums[NEPH_FLICKER_SUM_COUNT];
            neph_flicker_sums_of(&watch->test.sums, u, v, sums);
            for (int s = 0; s < NEPH_FLICKER_LINEAR_COUNT; s++)
                total[s] += sums[s];
        }
    }
    for (int s = 0; s < NEPH_FLICKER_LINEAR_COUNT; s++)
        total[s] /= (double)((right - left) * (bottom - top));
    return neph_flicker_spectrum_of(&flicker->window, total);
}

static double cycle_share_of(const struct flicker *flicker, const double *sums,
                             const struct neph_flicker_spectrum *spectrum)
{
    const double variance = neph_flicker_variance(&flicker->window, sums, flicker->window.detrend);
    const double cycle = 0.5 * spectrum->a4 * spectrum->a4 + spectrum->a2 * spectrum->a2;
    return variance > still_std * still_std ? fmin(1.0, cycle / variance) : 0.0;
}

/* Mean d by age, over the frames in which the pixel has that age. */
static void find_ages(const struct flicker *flicker, int x, int y, const double *sums,
                      double ages[NEPH_AGE_COUNT])
{
    const struct neph_flicker_watch *watch = &flicker->watch;
    const double first = neph_flicker_first(watch, &watch->test, x, y) -
                         neph_flicker_first(watch, &watch->reference, x, y);
    const double cycle_count = (double)(flicker->window.frame_count / CYCLE);
    for (int age = 0; age < NEPH_AGE_COUNT; age++) {
        const int frame = neph_frame_of_age(&flicker->scheme, x, y, age);
        const int t = (frame + CYCLE - flicker->warm_up % CYCLE) % CYCLE;
        ages[age] = first + sums[NEPH_FLICKER_PHASE_0 + t] / cycle_count;
    }
}

/* All maps of a pixel that depend only on its own d. */
static void find_pixel(const struct flicker *flicker, int x, int y, double values[MAP_COUNT])
{
    double sums[NEPH_FLICKER_SUM_COUNT];
    neph_flicker_sums_of(&flicker->watch.test.sums, x, y, sums);
    const struct neph_flicker_spectrum spectrum = neph_flicker_spectrum_of(&flicker->window, sums);
    const int frame_count = flicker->window.frame_count;
    values[STD] = sqrt(neph_flicker_variance(&flicker->window, sums, false));
    values[P2P] = sums[NEPH_FLICKER_MOST] - sums[NEPH_FLICKER_LEAST];
    values[MAD] = sums[NEPH_FLICKER_TRAVEL] / (double)(frame_count - 1);
    values[A4] = spectrum.a4;
    values[A2] = spectrum.a2;
    values[CYCLE_SHARE] = cycle_share_of(flicker, sums, &spectrum);
    values[CYCLIC] = neph_flicker_is_cyclic(&spectrum) ? 1.0 : 0.0;
    values[UNREST] = neph_flicker_unrest(values[MAD], values[P2P], frame_count);
    find_ages(flicker, x, y, sums, values + AGE);
    values[AGE_SLOPE] = neph_age_slope(values + AGE);
}

static void find_reference(const struct flicker *flicker, int x, int y, double values[MAP_COUNT])
{
    double sums[NEPH_FLICKER_SUM_COUNT];
    neph_flicker_sums_of(&flicker->watch.reference.sums, x, y, sums);
    const struct neph_flicker_spectrum spectrum = neph_flicker_spectrum_of(&flicker->window, sums);
    values[REFERENCE_STD] = sqrt(neph_flicker_variance(&flicker->window, sums, false));
    values[REFERENCE_A4] = spectrum.a4;
    values[REFERENCE_A2] = spectrum.a2;
}

static size_t row_begin(const struct flicker *flicker, int row)
{
    return (size_t)row * (size_t)flicker->width_px;
}

static void find_row(int row, void *context)
{
    struct flicker *flicker = context;
    double values[MAP_COUNT] = {0};
    for (int x = 0; x < flicker->width_px; x++) {
        if (x % (2 * flicker->scheme.slot_px) == 0) {
            const struct neph_flicker_spectrum block = block_spectrum(flicker, x, row);
            values[BLOCK_A4] = block.a4;
            values[BLOCK_A2] = block.a2;
        }
        find_pixel(flicker, x, row, values);
        if (flicker->watch.reference_moves)
            find_reference(flicker, x, row, values);
        for (int map = 0; map < MAP_COUNT; map++)
            flicker->values[map][row_begin(flicker, row) + (size_t)x] = values[map];
    }
}

static void find_phase_age(struct flicker *flicker)
{
    struct neph_sum totals[NEPH_PHASE_COUNT * NEPH_AGE_COUNT] = {{0.0, 0.0}};
    for (int y = 0; y < flicker->height_px; y++) {
        for (int x = 0; x < flicker->width_px; x++) {
            const int phase = neph_phase_of(&flicker->scheme, x, y);
            flicker->phase_pixel_count[phase] += 1.0;
            for (int age = 0; age < NEPH_AGE_COUNT; age++)
                neph_sum_add(&totals[NEPH_AGE_COUNT * phase + age],
                             flicker->values[AGE + age][row_begin(flicker, y) + (size_t)x]);
        }
    }
    for (int k = 0; k < NEPH_PHASE_COUNT * NEPH_AGE_COUNT; k++)
        flicker->phase_age[k] = neph_sum_value(&totals[k]) /
                                flicker->phase_pixel_count[k / NEPH_AGE_COUNT];
}

static enum neph_status allocate_maps(struct flicker *flicker, struct neph_diag *diag)
{
    const size_t pixel_count = (size_t)flicker->width_px * (size_t)flicker->height_px;
    for (int map = 0; map < MAP_COUNT; map++)
        flicker->values[map] = neph_arena_zeroed(flicker->memory, pixel_count, sizeof(double));
    return neph_arena_check(flicker->memory, diag);
}

static enum neph_status flicker_flush(void *state, struct neph_diag *diag)
{
    struct flicker *flicker = state;
    neph_flicker_watch_stop(&flicker->watch);
    if (flicker->watch.frames_seen < flicker->window.frame_count)
        return NEPH_OK;
    enum neph_status status = allocate_maps(flicker, diag);
    if (!status)
        status = neph_parallel_rows(flicker->height_px, find_row, flicker, diag);
    if (status)
        return status;
    find_phase_age(flicker);
    neph_flicker_watch_end(&flicker->watch);
    flicker->complete = true;
    return NEPH_OK;
}

static void flicker_rows(const void *state, int map, int first_row, int row_count,
                         double *const values[3])
{
    const struct flicker *flicker = state;
    const size_t count = row_begin(flicker, row_count);
    if (flicker->complete)
        memcpy(values[0], flicker->values[map] + row_begin(flicker, first_row),
               count * sizeof(double));
    else
        for (size_t i = 0; i < count; i++)
            values[0][i] = NAN;
}

static const char *flicker_scalar(const void *state, int which, double *value)
{
    const struct flicker *flicker = state;
    if (!flicker->complete)
        return ended_early;
    if (which == FRAMES) {
        *value = (double)flicker->window.frame_count;
        return NULL;
    }
    if (flicker->phase_pixel_count[which / NEPH_AGE_COUNT] == 0.0)
        return no_such_phase;
    *value = flicker->phase_age[which];
    return NULL;
}

const struct neph_extractor neph_extractor_flicker = {
    .name = "flicker",
    .help = "amplitude and cause of flicker for a static camera",
    .source = "discrete Fourier transform of display luma per pixel at the periods of 4 and 2 "
              "frames",
    .details = "d: luma of encoded display values, test - reference of the same frame\n"
               "a4 = (2 / N) |sum d e^(-i pi t / 2)|, a2 = (1 / N) |sum d (-1)^t|, N frames\n"
               "cyclic_share: p is for normal noise; up to 6e-4 of fireflies clamped to one value\n"
               "pass",
    .quantities = NEPH_RADIANCE | NEPH_VOLUME,
    .temporal = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = MAP_COUNT,
    .state_size = sizeof(struct flicker),
    .obstacle = flicker_obstacle,
    .bound = neph_bound_is_white,
    .init = flicker_init,
    .extract = flicker_extract,
    .flush = flicker_flush,
    .rows = flicker_rows,
    .scalar = flicker_scalar,
    .close = flicker_close,
};
