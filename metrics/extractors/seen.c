/* SPDX-License-Identifier: MIT
 *
 * Visible flicker for a static camera: how far the change of the test beyond that of the reference
 * is above the eye's threshold (metrics/eye.h), for the luminance, frame rate and viewing distance
 * of the display.
 *
 * Two mechanisms are modelled, and the larger result counts:
 * - A pixel is the centre of a disk of one degree, independent of its neighbours' phases, weighted
 *   by its spatial frequencies (seen_spatial.h).
 * - Change that is common to 1, 5 or 20 degrees is seen as such a disk (seen_disks.h).
 * Both sum the squares of all temporal frequencies up to half of the frame rate, without those
 * below 0.5 Hz, which are drift and lag. Pops, such as the reset of a history, which a spectrum
 * dilutes, are found by an edge filter in time.
 *
 * All frames are stored: 4 N bytes per pixel for N frames, and 40 more. The sequence is analysed as
 * a whole, so the numbers do not depend on a division into parts.
 */
#include "base/threads.h"
#include "metrics/extractors/extractors.h"
#include "metrics/extractors/seen_contrast.h"
#include "metrics/extractors/seen_disks.h"
#include "metrics/extractors/seen_spatial.h"
#include "metrics/eye.h"
#include "metrics/gaussian.h"
#include "metrics/interval.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { LANES = NEPH_SEEN_LANES, FRAME_COUNT_MIN = NEPH_SEEN_FRAMES_MIN, CONDITIONS = 3 };

/* Black level of the display, relative to white (a contrast of 1000:1, as of desktop monitors); it
 * limits the contrast of flicker in dark regions. */
static const double black = 1e-3;

/* The absolute sensitivity of the eye is a choice (eye.h): shares are also reported for an eye
 * twice and half as sensitive. */
static const double levels[CONDITIONS] = {1.0, 2.0, 0.5};

static const char too_short[] = "visible flicker needs at least 16 frames after the warm-up";
static const char unknown_length[] = "the number of frames is not known beforehand";
static const char ended_early[] = "the sequence ended before the announced number of frames";
static const char still[] = "nothing moves that the reference does not";

/* ---- maps and metrics ------------------------------------------------------------------------ */

enum map {
    CONTRAST,
    FOURTH_POWER,
    SEEN, /* CONDITIONS maps */
    POP = SEEN + CONDITIONS,
    HERTZ,
    MAP_COUNT,
};

static const struct neph_map maps[MAP_COUNT] = {
    [CONTRAST] = {"seen_contrast", "1", 1, false, 10.0, ended_early, 0},
    [FOURTH_POWER] = {NULL, "1", 1, false, 0.0, ended_early, 0},
    [SEEN] = {"seen_p", "1", 1, false, 1.0, ended_early, 0},
    [SEEN + 1] = {NULL, "1", 1, false, 0.0, ended_early, 0},
    [SEEN + 2] = {NULL, "1", 1, false, 0.0, ended_early, 0},
    [POP] = {"pop_p", "1", 1, false, 1.0, ended_early, 0},
    [HERTZ] = {"seen_hz", "Hz", 1, false, 30.0, still, 0},
};

enum scalar {
    SEEN_HZ,
    SEEN_PERIOD,
    COHERENT_CONTRAST,
    COHERENT_HZ,
    COHERENT_RADIUS,
    WORST_CONTRAST,
    WORST_X,
    WORST_Y,
    WORST_PERIOD,
    FRAMES,
    SCALAR_COUNT,
};

#define SCALAR(name, unit, high, which, help)                                                      \
    {                                                                                              \
        name, unit, 0.0, high, NEPH_POOL_SCALAR, 0.0, which, 0, help                               \
    }

static const struct neph_metric metrics[] = {
    {"seen_contrast", "1", 0.0, INFINITY, NEPH_POOL_ROOT_OF_MEAN, 4.0, FOURTH_POWER, 0,
     "flicker in units of the eye's threshold: (mean R^4)^(1/4)"},
    {"seen_contrast_p95", "1", 0.0, INFINITY, NEPH_POOL_PERCENTILE, 0.95, CONTRAST, 0,
     "95th percentile of R, flicker in units of the eye's threshold"},
    {"seen_share", "1", 0.0, 1.0, NEPH_POOL_SHARE_ABOVE, 0.5, SEEN, 0,
     "share of pixels where flicker is seen by most: P > 0.5"},
    {"seen_share_6db_more", "1", 0.0, 1.0, NEPH_POOL_SHARE_ABOVE, 0.5, SEEN + 1, 0,
     "seen_share for an eye that is 6 dB more sensitive"},
    {"seen_share_6db_less", "1", 0.0, 1.0, NEPH_POOL_SHARE_ABOVE, 0.5, SEEN + 2, 0,
     "seen_share for an eye that is 6 dB less sensitive"},
    {"seen_p", "1", 0.0, 1.0, NEPH_POOL_MEAN, 0.0, SEEN, 0,
     "mean of P, the probability that a person sees flicker at a pixel"},
    {"pop_p95", "1", 0.0, 1.0, NEPH_POOL_PERCENTILE, 0.95, POP, 0,
     "95th percentile of the probability that a pop is seen, an edge in time"},
    {"pop_share", "1", 0.0, 1.0, NEPH_POOL_SHARE_ABOVE, 0.5, POP, 0,
     "share of pixels where most people see a pop"},
    SCALAR("seen_hz", "Hz", INFINITY, SEEN_HZ, "frequency of most of the visible flicker"),
    SCALAR("seen_period", "frame", INFINITY, SEEN_PERIOD, "period of that frequency"),
    SCALAR("coherent_contrast", "1", INFINITY, COHERENT_CONTRAST,
           "largest R of common change over disks of 1, 5 and 20 degrees"),
    SCALAR("coherent_hz", "Hz", INFINITY, COHERENT_HZ, "its frequency"),
    SCALAR("coherent_radius", "deg", 20.0, COHERENT_RADIUS, "radius of its disk"),
    SCALAR("worst_tile_contrast", "1", INFINITY, WORST_CONTRAST,
           "largest seen_contrast of a tile of the image"),
    SCALAR("worst_tile_x", "px", INFINITY, WORST_X, "its centre from the left"),
    SCALAR("worst_tile_y", "px", INFINITY, WORST_Y, "its centre from the top"),
    SCALAR("worst_tile_period", "frame", INFINITY, WORST_PERIOD,
           "period of the flicker at its pixel with the largest R"),
    SCALAR("seen_frames", "frame", INFINITY, FRAMES, "number of analysed frames"),
    {0},
};

static const struct neph_option options[] = {
    {"warm_up", NEPH_OPTION_INTEGER, 0.0, 0.0, 1e6, NULL,
     "frames at the start that are not looked at"},
    {0},
};

/* ---- state ----------------------------------------------------------------------------------- */

struct seen {
    struct neph_viewing viewing;
    int warm_up, frame_count, frames_seen;
    int width_px, height_px, padded_width_px;
    struct neph_seen_window window;
    struct neph_seen_filter filter;
    struct neph_seen_disks disks;
    int padded_disk_count;
    struct neph_seen_gains gains;

    struct neph_arena frames; /* memory that is freed once the maps are done: */
    float *series;            /* index: row, frame, pixel; test - reference, filtered [cd/m2] */
    float *disk_series;       /* index: frame, disk; mean of the same, not filtered */
    float *plane;             /* the current frame */
    double *sums;             /* prefix sums of each row: width + 1 per row */
    float *luminance;         /* of the test, summed over the frames; later the adaptation
                               * luminance */
    float *disk_luminance, *disk_contrast, *disk_hertz;
    float *row_energies; /* index: row, bin; visible energy */

    struct neph_arena *memory; /* memory of the maps */
    float *values[MAP_COUNT];
    atomic_bool out_of_memory;

    bool complete; /* the following members are set */
    double scalars[SCALAR_COUNT];
};

static int frames_used(const struct neph_frame_pair *first, const struct neph_settings *settings)
{
    return first->frame_count - (int)settings->values[0];
}

static const char *seen_obstacle(const struct neph_frame_pair *first,
                                 const struct neph_settings *settings)
{
    if (first->frame_count <= 0)
        return unknown_length;
    return frames_used(first, settings) < FRAME_COUNT_MIN ? too_short : NULL;
}

static int padded(int count)
{
    return (count + LANES - 1) / LANES * LANES;
}

static size_t pixel_count(const struct seen *seen)
{
    return (size_t)seen->width_px * (size_t)seen->height_px;
}

static enum neph_status allocate(struct seen *seen, struct neph_diag *diag)
{
    const size_t rows = (size_t)seen->height_px, frames = (size_t)seen->frame_count;
    const size_t disks = (size_t)seen->padded_disk_count;
    const struct {
        float **plane;
        size_t count;
    } planes[] = {
        {&seen->series, rows * frames * (size_t)seen->padded_width_px},
        {&seen->disk_series, frames * disks},
        {&seen->plane, pixel_count(seen)},
        {&seen->luminance, pixel_count(seen)},
        {&seen->disk_luminance, disks},
        {&seen->disk_contrast, disks},
        {&seen->disk_hertz, disks},
        {&seen->row_energies, rows * (size_t)seen->window.bin_count},
    };
    for (size_t i = 0; i < sizeof(planes) / sizeof(planes[0]); i++)
        *planes[i].plane = neph_arena_zeroed(&seen->frames, planes[i].count, sizeof(float));
    seen->sums = neph_arena_zeroed(&seen->frames, rows * ((size_t)seen->width_px + 1),
                                   sizeof(*seen->sums));
    return neph_arena_check(&seen->frames, diag);
}

static enum neph_status seen_init(void *state, const struct neph_frame_pair *first,
                                  const struct neph_settings *settings, struct neph_diag *diag)
{
    struct seen *seen = state;
    const double ppd = first->viewing->pixels_per_degree;
    *seen = (struct seen){
        .viewing = *first->viewing,
        .memory = first->memory,
        .warm_up = (int)settings->values[0],
        .frame_count = frames_used(first, settings),
        .width_px = first->width_px,
        .height_px = first->height_px,
        .padded_width_px = padded(first->width_px),
        .filter = neph_seen_filter_of(ppd),
        .disks = neph_seen_disks_of(first->width_px, first->height_px, ppd),
    };
    seen->padded_disk_count = padded(seen->disks.disk_count);
    const enum neph_status status = neph_seen_window_create(seen->frame_count, &seen->frames,
                                                            &seen->window, diag);
    return status ? status : allocate(seen, diag);
}

static void seen_close(void *state)
{
    struct seen *seen = state;
    neph_arena_finish(&seen->frames);
}

/* ---- a frame --------------------------------------------------------------------------------- */

struct frame_work {
    struct seen *seen;
    const struct neph_frame_pair *pair;
    int t; /* frame index after the warm-up */
};

static inline __attribute__((always_inline)) float shown(float channel, float gain)
{
    const float scaled = gain * channel;
    const float positive = scaled > 0.0f ? scaled : 0.0f;
    return positive < 1.0f ? positive : 1.0f;
}

/* Luminance of the display [cd/m2]. */
NEPH_VECTOR
static void show(const float *restrict r, const float *restrict g, const float *restrict b,
                 int count, float gain, float white, float *restrict luminance)
{
    const float least = (float)black;
    for (int i = 0; i < count; i++) {
        const float y = 0.2126f * shown(r[i], gain) + 0.7152f * shown(g[i], gain) +
                        0.0722f * shown(b[i], gain);
        luminance[i] = white * (y > least ? y : least);
    }
}

NEPH_VECTOR
static void subtract(float *restrict test, const float *restrict reference, int count,
                     float *restrict luminance)
{
    for (int i = 0; i < count; i++) {
        luminance[i] += test[i];
        test[i] -= reference[i];
    }
}

static void sum_up(const float *values, int count, double *sums)
{
    sums[0] = 0.0;
    for (int i = 0; i < count; i++)
        sums[i + 1] = sums[i] + (double)values[i];
}

static size_t row_begin(const struct seen *seen, int row)
{
    return (size_t)row * (size_t)seen->width_px;
}

static double *sums_of(const struct seen *seen, int row)
{
    return seen->sums + (size_t)row * ((size_t)seen->width_px + 1);
}

static float *series_of(const struct seen *seen, int row, int t)
{
    return seen->series +
           ((size_t)row * (size_t)seen->frame_count + (size_t)t) * (size_t)seen->padded_width_px;
}

/* The reference is first written to the row of the series. */
static void show_row(int row, void *context)
{
    const struct frame_work *work = context;
    const struct seen *seen = work->seen;
    const size_t begin = row_begin(seen, row);
    const float gain = (float)exp2(seen->viewing.exposure_ev);
    const float white = (float)seen->viewing.white_cd_per_m2;
    const float *const *r = work->pair->reference, *const *x = work->pair->test;
    float *reference = series_of(seen, row, work->t), *test = seen->plane + begin;
    show(r[0] + begin, r[1] + begin, r[2] + begin, seen->width_px, gain, white, reference);
    show(x[0] + begin, x[1] + begin, x[2] + begin, seen->width_px, gain, white, test);
    subtract(test, reference, seen->width_px, seen->luminance + begin);
    sum_up(test, seen->width_px, sums_of(seen, row));
}

static void filter_row(int row, void *context)
{
    const struct frame_work *work = context;
    struct seen *seen = work->seen;
    float *wide = malloc((size_t)(seen->width_px + 2 * seen->filter.radius_px) * sizeof(*wide));
    if (wide)
        neph_seen_filter_row(&seen->filter, seen->plane, seen->width_px, seen->height_px, row, wide,
                             series_of(seen, row, work->t));
    else
        atomic_store(&seen->out_of_memory, true);
    free(wide);
}

static enum neph_status over_rows(struct seen *seen, neph_row_body *body, void *context,
                                  struct neph_diag *diag)
{
    const enum neph_status status = neph_parallel_rows(seen->height_px, body, context, diag);
    return !status && atomic_load(&seen->out_of_memory) ? neph_fail_memory(diag) : status;
}

static enum neph_status seen_extract(void *state, const struct neph_frame_pair *pair,
                                     struct neph_diag *diag)
{
    struct seen *seen = state;
    struct frame_work work = {seen, pair, pair->frame - seen->warm_up};
    if (work.t < 0 || work.t >= seen->frame_count)
        return NEPH_OK;
    seen->frames_seen++;
    enum neph_status status = over_rows(seen, show_row, &work, diag);
    if (!status)
        status = over_rows(seen, filter_row, &work, diag);
    if (!status)
        status = neph_seen_disk_means(
            &seen->disks, seen->sums,
            seen->disk_series + (size_t)work.t * (size_t)seen->padded_disk_count, diag);
    return status;
}

/* ---- after the last frame -------------------------------------------------------------------- */

static double bin_hz(const struct seen *seen)
{
    return seen->viewing.frame_rate_hz / seen->window.padded_count;
}

static double blur_px(const struct seen *seen)
{
    return NEPH_EYE_BLUR_DEG * seen->viewing.pixels_per_degree;
}

static void average_row(int row, void *context)
{
    const struct seen *seen = context;
    float *luminance = seen->luminance + row_begin(seen, row);
    for (int x = 0; x < seen->width_px; x++)
        luminance[x] /= (float)seen->frame_count;
    sum_up(luminance, seen->width_px, sums_of(seen, row));
}

/* The adaptation luminance of the eye: the mean of a pixel's surroundings. */
static enum neph_status find_luminance(struct seen *seen, struct neph_diag *diag)
{
    enum neph_status status = over_rows(seen, average_row, seen, diag);
    if (!status)
        status = neph_seen_disk_means(&seen->disks, seen->sums, seen->disk_luminance, diag);
    if (!status)
        status = neph_gaussian_blur(seen->luminance, seen->width_px, seen->height_px, blur_px(seen),
                                    diag);
    return status;
}

/* Analyse LANES pixels of a row, in `room`; their energies, in units of the threshold's, are added
 * to `energies`. */
static void find_lanes(const struct seen *seen, int row, int first, float *room, float *energies)
{
    const int count = seen->width_px - first < LANES ? seen->width_px - first : LANES;
    const float *series = series_of(seen, row, 0) + first;
    const size_t stride = (size_t)seen->padded_width_px, at = row_begin(seen, row) + (size_t)first;
    const double fade = exp(-1.0 / (seen->viewing.frame_rate_hz * NEPH_EYE_EDGE_S));
    float luminances[LANES], lane_levels[LANES], pops[LANES];
    struct neph_seen_lanes found;
    for (int l = 0; l < LANES; l++) {
        luminances[l] = seen->luminance[at + (size_t)(l < count ? l : 0)];
        lane_levels[l] = neph_seen_level(&seen->gains, (double)luminances[l]);
    }
    neph_seen_pops(series, stride, seen->frame_count, fade, room, pops);
    neph_seen_spectrum(&seen->window, series, stride, room, energies);
    neph_seen_weigh(&seen->gains, lane_levels, luminances, bin_hz(seen), energies, &found);
    memcpy(seen->values[CONTRAST] + at, found.contrast, (size_t)count * sizeof(float));
    memcpy(seen->values[HERTZ] + at, found.hertz, (size_t)count * sizeof(float));
    memcpy(seen->values[POP] + at, pops, (size_t)count * sizeof(float));
}

/* Add the energies of the lanes. Lanes beyond the image are constant and add nothing. */
static void add_energies(const float *energies, int bin_count, float *sums)
{
    for (int bin = 0; bin < bin_count; bin++) {
        float sum = 0.0f;
        for (int l = 0; l < LANES; l++)
            sum += energies[(size_t)bin * LANES + (size_t)l];
        sums[bin] += sum;
    }
}

/* Allocate memory for a transform and its energies; NULL: out of memory, which is recorded. */
static float *take_room(struct seen *seen)
{
    const size_t energies = (size_t)seen->window.bin_count * LANES;
    float *room = malloc((neph_seen_room(&seen->window) + energies) * sizeof(*room));
    if (!room)
        atomic_store(&seen->out_of_memory, true);
    return room;
}

static void find_row(int row, void *context)
{
    struct seen *seen = context;
    const int bin_count = seen->window.bin_count;
    float *room = take_room(seen);
    if (!room)
        return;
    float *energies = room + neph_seen_room(&seen->window);
    for (int first = 0; first < seen->width_px; first += LANES) {
        find_lanes(seen, row, first, room, energies);
        add_energies(energies, bin_count, seen->row_energies + (size_t)row * (size_t)bin_count);
    }
    free(room);
}

/* Analyse a disk, with its own sensitivity. */
static void find_disk(struct seen *seen, int disk, float *energies)
{
    const double radius_deg = neph_seen_cut_radius_deg(&seen->disks, disk);
    const double luminance = (double)seen->disk_luminance[disk];
    double square = 0.0;
    for (int bin = 0; bin < seen->window.bin_count; bin++) {
        float *energy = energies + (size_t)bin * LANES;
        const double gain = neph_seen_gain(bin * bin_hz(seen), seen->viewing.frame_rate_hz,
                                           luminance, radius_deg);
        *energy = (float)(gain * (double)*energy / (luminance * luminance));
        square += (double)*energy;
    }
    seen->disk_contrast[disk] = (float)sqrt(square);
    seen->disk_hertz[disk] = neph_seen_peak_hz(energies, LANES, seen->window.bin_count,
                                               bin_hz(seen));
}

/* Analyse LANES disks. */
static void find_disks(int block, void *context)
{
    struct seen *seen = context;
    const int first = block * LANES;
    float *room = take_room(seen);
    if (!room)
        return;
    float *energies = room + neph_seen_room(&seen->window);
    neph_seen_spectrum(&seen->window, seen->disk_series + first, (size_t)seen->padded_disk_count,
                       room, energies);
    for (int disk = first; disk < first + LANES && disk < seen->disks.disk_count; disk++)
        find_disk(seen, disk, energies + disk - first);
    free(room);
}

/* For each pixel, take the mechanism with the largest contrast. */
static void combine_row(int row, void *context)
{
    const struct seen *seen = context;
    float *contrast = seen->values[CONTRAST] + row_begin(seen, row);
    float *hertz = seen->values[HERTZ] + row_begin(seen, row);
    for (int x = 0; x < seen->width_px; x++)
        for (int g = 0; g < NEPH_SEEN_RADII; g++) {
            const double together = neph_seen_between(&seen->disks, g, seen->disk_contrast, x, row);
            if (together <= (double)contrast[x])
                continue;
            contrast[x] = (float)together;
            hertz[x] = seen->disk_hertz[neph_seen_nearest(&seen->disks, g, x, row)];
        }
    for (int x = 0; x < seen->width_px; x++)
        for (int c = 0; c < CONDITIONS; c++)
            seen->values[SEEN + c][row_begin(seen, row) + (size_t)x] = (float)neph_eye_seen(
                levels[c] * (double)contrast[x]);
}

static void judge_pops(int row, void *context)
{
    const struct seen *seen = context;
    float *pops = seen->values[POP] + row_begin(seen, row);
    for (int x = 0; x < seen->width_px; x++)
        pops[x] = (float)neph_eye_pop_seen((double)pops[x]);
}

static enum neph_status find_contrast(struct seen *seen, struct neph_diag *diag)
{
    enum neph_status status = neph_seen_gains_create(
        seen->window.bin_count, bin_hz(seen), seen->viewing.frame_rate_hz,
        black * seen->viewing.white_cd_per_m2, seen->viewing.white_cd_per_m2, &seen->frames,
        &seen->gains, diag);
    if (!status)
        status = over_rows(seen, find_row, seen, diag);
    if (!status)
        status = neph_parallel_rows(seen->padded_disk_count / LANES, find_disks, seen, diag);
    if (!status) /* find_disks() may also run out of memory */
        status = over_rows(seen, combine_row, seen, diag);
    return status;
}

static enum neph_status blur(struct seen *seen, int map, struct neph_diag *diag)
{
    return neph_gaussian_blur(seen->values[map], seen->width_px, seen->height_px, blur_px(seen),
                              diag);
}

static enum neph_status blur_all(struct seen *seen, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int c = 0; c < CONDITIONS && !status; c++)
        status = blur(seen, SEEN + c, diag);
    if (!status)
        status = blur(seen, POP, diag);
    return status ? status : over_rows(seen, judge_pops, seen, diag);
}

/* ---- numbers of the whole image
 * --------------------------------------------------------------- */

static double fourth_power(const struct seen *seen, size_t pixel)
{
    const double contrast = (double)seen->values[CONTRAST][pixel];
    return contrast * contrast * contrast * contrast;
}

static double tile_contrast(const struct seen *seen, int left, int top, int right, int bottom)
{
    double sum = 0.0;
    for (int y = top; y < bottom; y++)
        for (int x = left; x < right; x++)
            sum += fourth_power(seen, row_begin(seen, y) + (size_t)x);
    return pow(sum / ((right - left) * (bottom - top)), 0.25);
}

static int lesser(int a, int b)
{
    return a < b ? a : b;
}

/* The period of a tile; NaN: nothing moves there. */
static double tile_period(const struct seen *seen, int left, int top, int right, int bottom)
{
    size_t most = row_begin(seen, top) + (size_t)left;
    for (int y = top; y < bottom; y++)
        for (int x = left; x < right; x++) {
            const size_t at = row_begin(seen, y) + (size_t)x;
            if (seen->values[CONTRAST][at] > seen->values[CONTRAST][most])
                most = at;
        }
    return seen->viewing.frame_rate_hz / (double)seen->values[HERTZ][most];
}

static void find_worst_tile(struct seen *seen)
{
    const struct neph_tiling tiling = neph_tiling_of(seen->width_px, seen->height_px);
    const int side = tiling.side_px;
    seen->scalars[WORST_CONTRAST] = -1.0;
    for (int top = 0; top < seen->height_px; top += side)
        for (int left = 0; left < seen->width_px; left += side) {
            const int right = lesser(left + side, seen->width_px);
            const int bottom = lesser(top + side, seen->height_px);
            const double contrast = tile_contrast(seen, left, top, right, bottom);
            if (contrast <= seen->scalars[WORST_CONTRAST])
                continue;
            seen->scalars[WORST_CONTRAST] = contrast;
            seen->scalars[WORST_X] = 0.5 * (left + right);
            seen->scalars[WORST_Y] = 0.5 * (top + bottom);
            seen->scalars[WORST_PERIOD] = tile_period(seen, left, top, right, bottom);
        }
}

static void find_most_coherent(struct seen *seen)
{
    int most = 0;
    for (int disk = 1; disk < seen->disks.disk_count; disk++)
        if (seen->disk_contrast[disk] > seen->disk_contrast[most])
            most = disk;
    seen->scalars[COHERENT_CONTRAST] = (double)seen->disk_contrast[most];
    seen->scalars[COHERENT_HZ] = (double)seen->disk_hertz[most];
    seen->scalars[COHERENT_RADIUS] = neph_seen_grid_of(&seen->disks, most)->radius_px /
                                     seen->viewing.pixels_per_degree;
}

/* Sum over the rows in order, so that the result does not depend on the threads. */
static void find_most_seen(struct seen *seen)
{
    const int bin_count = seen->window.bin_count;
    float *total = seen->row_energies;
    for (int row = 1; row < seen->height_px; row++)
        for (int bin = 0; bin < bin_count; bin++)
            total[bin] += seen->row_energies[(size_t)row * (size_t)bin_count + (size_t)bin];
    seen->scalars[SEEN_HZ] = (double)neph_seen_peak_hz(total, 1, bin_count, bin_hz(seen));
    seen->scalars[SEEN_PERIOD] = seen->viewing.frame_rate_hz / seen->scalars[SEEN_HZ];
}

static enum neph_status allocate_maps(struct seen *seen, struct neph_diag *diag)
{
    for (int map = 0; map < MAP_COUNT; map++)
        if (map != FOURTH_POWER) /* derived from another map */
            seen->values[map] = neph_arena_zeroed(seen->memory, pixel_count(seen), sizeof(float));
    return neph_arena_check(seen->memory, diag);
}

static enum neph_status seen_flush(void *state, struct neph_diag *diag)
{
    struct seen *seen = state;
    if (seen->frames_seen < seen->frame_count)
        return NEPH_OK;
    enum neph_status status = allocate_maps(seen, diag);
    if (!status)
        status = find_luminance(seen, diag);
    if (!status)
        status = find_contrast(seen, diag);
    if (!status)
        status = blur_all(seen, diag);
    if (status)
        return status;
    find_worst_tile(seen);
    find_most_coherent(seen);
    find_most_seen(seen);
    seen->scalars[FRAMES] = seen->frame_count;
    neph_arena_finish(&seen->frames);
    seen->complete = true;
    return NEPH_OK;
}

static double value_of(const struct seen *seen, int map, size_t pixel)
{
    if (!seen->complete)
        return NAN;
    return map == FOURTH_POWER ? fourth_power(seen, pixel) : (double)seen->values[map][pixel];
}

static void seen_rows(const void *state, int map, int first_row, int row_count,
                      double *const values[3])
{
    const struct seen *seen = state;
    const size_t begin = row_begin(seen, first_row), count = row_begin(seen, row_count);
    for (size_t i = 0; i < count; i++)
        values[0][i] = value_of(seen, map, begin + i);
}

static const char *seen_scalar(const void *state, int which, double *value)
{
    const struct seen *seen = state;
    if (!seen->complete)
        return ended_early;
    if (!isfinite(seen->scalars[which]))
        return still;
    *value = seen->scalars[which];
    return NULL;
}

const struct neph_extractor neph_extractor_seen = {
    .name = "seen",
    .help = "visible flicker for a static camera (a model of the eye)",
    .source = "elaTCSF (Cai et al., SIGGRAPH Asia 2024) at the level of De Lange (JOSA 48, 1958); "
              "Denes and Mantiuk, HVEI 2020; Ebelin et al., ACM TAP 2024",
    .details =
        "D = displayed luminance of the test - of the reference [cd/m2]: channels clamped\n"
        "to 0..1 times white, at least 0.001 of it; L the temporal mean of the test's\n"
        "luminance, over 0.36 degrees; frequencies below 0.5 Hz are drift and lag, not flicker\n"
        "R^2 = sum over frequencies of (S |D| / L)^2, the larger of two: of each pixel, with\n"
        "the sensitivity S to a disk of 1 degree times exp(-0.0242 (cpd - 1)); of the mean\n"
        "over disks of 1, 5 and 20 degrees, with S of the part inside the image\n"
        "P = 1 - 0.5^(R^2), through a Gaussian of 0.36 degrees\n"
        "pops: largest response to the filtered D of -sign(t) exp(-|t| / 16 ms) in cd/m2, the\n"
        "same Gaussian, P = 1 - exp(-0.1008 x^0.9061)\n"
        "the level is a choice: experiments differ by up to 18 dB; seen_share_6db_more and\n"
        "_less say what 6 dB change, which double and halve R\n"
        "needs 4 bytes per pixel and frame",
    .quantities = NEPH_RADIANCE,
    .temporal = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = MAP_COUNT,
    .state_size = sizeof(struct seen),
    .obstacle = seen_obstacle,
    .bound = neph_bound_is_white,
    .init = seen_init,
    .extract = seen_extract,
    .flush = seen_flush,
    .rows = seen_rows,
    .scalar = seen_scalar,
    .close = seen_close,
};
