/* SPDX-License-Identifier: MIT
 *
 * Flicker of every period for a static camera, as a budget: the frames are stored, the periods are
 * found in all pixels together, then each pixel's variance is divided among them.
 */
#include "base/threads.h"
#include "metrics/extractors/cycle_fit.h"
#include "metrics/extractors/extractors.h"
#include "metrics/extractors/pair_codes.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

enum {
    FRAME_COUNT_MIN = 16,
    FRAME_COUNT_MAX = 2048,
    LONG_COUNT = NEPH_CYCLE_LONG_COUNT
};

static const char too_short[] = "cycles need at least 16 frames after the warm-up";
static const char unknown_length[] = "the number of frames is not known beforehand";
static const char ended_early[] = "the sequence ended before the announced number of frames";
static const char bad_declaration[] = "the attribute " NEPH_CYCLE_ATTRIBUTE
                                      " of the first frame is no list of 'NAME FRAMES', 2 to 65536 "
                                      "frames each";
static const char below_floor[] = "not above the noise floor, cycle_floor, in the whole image";
static const char period_too_long[] =
    "the period is longer than an eighth of the frames: give more frames";
static const char not_so_many[] = "no further period longer than 32 frames was found";

/* ---- options --------------------------------------------------------------------------------- */

enum { WARM_UP };

static const struct neph_option options[] = {
    [WARM_UP] = {"warm_up", NEPH_OPTION_INTEGER, 0.0, 0.0, 1e6, NULL,
                 "frames at the start that are not looked at"},
    {0},
};

/* ---- maps and metrics ------------------------------------------------------------------------ */

#define PERIODS(of)                                                                                \
    of(2) of(3) of(4) of(5) of(6) of(7) of(8) of(9) of(10) of(11) of(12) of(13) of(14) of(15)      \
        of(16) of(17) of(18) of(19) of(20) of(21) of(22) of(23) of(24) of(25) of(26) of(27) of(28) \
            of(29) of(30) of(31) of(32)

#define LONGS(of) of(1) of(2) of(3) of(4)

enum { PERIOD_COUNT = NEPH_CYCLE_PERIOD_MAX - NEPH_CYCLE_PERIOD_MIN + 1 };

/* Squares, then their noise floors, FLOORS later. */
enum map {
    CYCLE, /* one for each period */
    REPEATS = CYCLE + PERIOD_COUNT,
    LONG = REPEATS + PERIOD_COUNT,
    DRIFT = LONG + LONG_COUNT,
    FLOORS,
    FOUND_FLOOR = 2 * FLOORS,
    NOISE,
    OVERLAP,
    VARIANCE,
    MAP_COUNT,
};

_Static_assert(MAP_COUNT <= NEPH_MAPS_MAX, "an extractor's maps");

#define SCALE (1e-3) /* of squares: the square of a sine of 8/255 */

#define MAP_OF_PERIOD(p)                                                                           \
    [CYCLE + p - 2] = {"cycle_" #p "_squared", "1", 1, true, SCALE, ended_early, 0},               \
                 [REPEATS + p -                                                                    \
                     2] = {"repeats_" #p "_squared", "1", 1, true, SCALE, ended_early, 0},         \
                 [FLOORS + CYCLE + p - 2] = {NULL, "1", 1, false, SCALE, ended_early, 0},          \
                 [FLOORS + REPEATS + p - 2] = {NULL, "1", 1, false, SCALE, ended_early, 0},
#define MAP_OF_LONG(k)                                                                             \
    [LONG + k - 1] = {"cycle_long_" #k "_squared", "1", 1, true, SCALE, ended_early, 0},           \
                [FLOORS + LONG + k - 1] = {NULL, "1", 1, false, SCALE, ended_early, 0},

static const struct neph_map maps[MAP_COUNT] = {
    /* clang-format off */
    PERIODS(MAP_OF_PERIOD)
    LONGS(MAP_OF_LONG)
        /* clang-format on */
        [DRIFT] = {"cycle_drift_squared", "1", 1, true, SCALE, ended_early, 0},
    [FLOORS + DRIFT] = {NULL, "1", 1, false, SCALE, ended_early, 0},
    [FOUND_FLOOR] = {NULL, "1", 1, false, SCALE, ended_early, 0},
    [NOISE] = {"cycle_noise_squared", "1", 1, false, SCALE, ended_early, 0},
    [OVERLAP] = {"cycle_overlap", "1", 1, true, SCALE, ended_early, 0},
    [VARIANCE] = {"cycle_variance", "1", 1, false, SCALE, ended_early, 0},
};

/* Scalars. */
enum { FRAMES, FOUND, UNSEPARATED, LONG_FRAMES };

#define ROOT(name, map, help)                                                                      \
    {                                                                                              \
        name, "1", 0.0, 1.0, NEPH_POOL_ROOT_MEAN, 0.0, map, 0, help                                \
    }
#define ROOT_ABOVE(name, map, help)                                                                \
    {                                                                                              \
        name, "1", 0.0, 1.0, NEPH_POOL_ROOT_MEAN_ABOVE, 0.0, map, FLOORS + map, help               \
    }
#define SCALAR(name, which, help)                                                                  \
    {                                                                                              \
        name, "1", 0.0, INFINITY, NEPH_POOL_SCALAR, 0.0, which, 0, help                            \
    }
#define CYCLE_METRIC(p)                                                                            \
    ROOT_ABOVE("cycle_" #p, CYCLE + p - 2,                                                         \
               "RMS of d at the frequencies m/" #p " in lowest terms: of period " #p " alone"),
#define REPEATS_METRIC(p)                                                                          \
    ROOT_ABOVE("repeats_" #p, REPEATS + p - 2,                                                     \
               "RMS of all of d that repeats every " #p " frames: of " #p " and its divisors"),
#define LONG_METRIC(k)                                                                             \
    ROOT_ABOVE("cycle_long_" #k, LONG + k - 1, "RMS of the period of cycle_long_" #k "_frames"),   \
        SCALAR("cycle_long_" #k "_frames", LONG_FRAMES + k - 1,                                    \
               "period number " #k " of those beyond 32 frames that were found"),

static const struct neph_metric metrics[] = {
    /* clang-format off */
    PERIODS(CYCLE_METRIC)
    LONGS(LONG_METRIC)
    PERIODS(REPEATS_METRIC)
    /* clang-format on */
    ROOT_ABOVE("cycle_drift", DRIFT, "RMS of the line in d, fitted together with the cycles"),
    ROOT("cycle_noise", NOISE, "RMS of the residual of cycles and line"),
    {"cycle_overlap", "1", -1.0, 1.0, NEPH_POOL_MEAN, 0.0, OVERLAP, 0,
     "mean square that periods and drift share, because they are not orthogonal in these frames"},
    ROOT("cycle_std", VARIANCE,
         "RMS of d about its mean; its square is the sum of the squares of all cycle_P, drift and "
         "noise, + overlap"),
    ROOT("cycle_floor", FOUND_FLOOR,
         "smallest RMS at one frequency that the search in the whole image finds, for this mask's "
         "noise"),
    SCALAR("cycle_frames", FRAMES,
           "frames that cycles are taken of: those after the warm-up, at most 2048"),
    SCALAR("cycle_count", FOUND, "periods that were found"),
    SCALAR("cycle_unseparated", UNSEPARATED,
           "frequencies that were found and could as well be of another period"),
    {0},
};

/* ---- state ----------------------------------------------------------------------------------- */

struct cycles {
    struct neph_cycle_declared declared;
    int warm_up;
    struct neph_cycle_frames frames; /* the signal d */
    int frames_seen;
    struct neph_arena seen; /* memory of the frames, until the parts are known */

    struct neph_arena *memory; /* memory of everything else */

    bool complete; /* the following members are set */
    struct neph_cycle_findings findings;
    struct neph_cycle_model model;
    double **parts; /* by enum neph_cycle_part */
};

/* Limited, because the second moments grow with the square of the number of frames. */
static int frames_used(const struct neph_frame_pair *first, const struct neph_settings *settings)
{
    const int count = first->frame_count - (int)settings->values[WARM_UP];
    return count < FRAME_COUNT_MAX ? count : FRAME_COUNT_MAX;
}

static enum neph_status read_declared(const struct neph_frame_pair *first,
                                      struct neph_cycle_declared *declared)
{
    const char *text = first->test_image
                           ? neph_image_attribute(first->test_image, NEPH_CYCLE_ATTRIBUTE)
                           : NULL;
    return neph_cycle_parse(text ? text : "", declared, NULL);
}

static const char *cycles_obstacle(const struct neph_frame_pair *first,
                                   const struct neph_settings *settings)
{
    struct neph_cycle_declared declared;
    if (first->frame_count <= 0)
        return unknown_length;
    if (frames_used(first, settings) < FRAME_COUNT_MIN)
        return too_short;
    return read_declared(first, &declared) ? bad_declaration : NULL;
}

static enum neph_status cycles_init(void *state, const struct neph_frame_pair *first,
                                    const struct neph_settings *settings, struct neph_diag *diag)
{
    struct cycles *cycles = state;
    *cycles = (struct cycles){.warm_up = (int)settings->values[WARM_UP], .memory = first->memory};
    read_declared(first, &cycles->declared);
    return neph_cycle_frames_begin(&cycles->frames, first->width_px, first->height_px,
                                   frames_used(first, settings), &cycles->seen, diag);
}

static void cycles_close(void *state)
{
    struct cycles *cycles = state;
    neph_arena_finish(&cycles->seen);
}

/* ---- a frame --------------------------------------------------------------------------------- */

struct frame_work {
    struct cycles *cycles;
    const struct neph_luma_planes *luma;
    int t; /* frame index after the warm-up */
};

static void store_signal_row(int row, void *context)
{
    const struct frame_work *work = context;
    const size_t width = (size_t)work->cycles->frames.width_px, begin = (size_t)row * width;
    const double *test = work->luma->test + begin, *reference = work->luma->reference + begin;
    float *d = neph_cycle_frames_row(&work->cycles->frames, row, work->t);
    for (size_t x = 0; x < width; x++)
        d[x] = (float)(test[x] - reference[x]);
}

static enum neph_status cycles_extract(void *state, const struct neph_frame_pair *pair,
                                       struct neph_diag *diag)
{
    struct cycles *cycles = state;
    struct frame_work work = {cycles, NULL, pair->frame - cycles->warm_up};
    if (work.t < 0 || work.t >= cycles->frames.frame_count)
        return NEPH_OK;
    cycles->frames_seen++;
    const enum neph_status status = neph_pair_luma_get(pair, &work.luma, diag);
    return status ? status : neph_parallel_rows(pair->height_px, store_signal_row, &work, diag);
}

/* ---- after the last frame -------------------------------------------------------------------- */

static enum neph_status find_periods(struct cycles *cycles, struct neph_diag *diag)
{
    const int frame_count = cycles->frames.frame_count;
    struct neph_arena search = {0};
    struct neph_cycle_frequencies candidates = {.items = NULL};
    double *moments = NULL;
    enum neph_status status = neph_cycle_candidates(frame_count, &cycles->declared, &search,
                                                    &candidates, diag);
    if (!status)
        status = neph_cycle_moments(&cycles->frames, &search, &moments, diag);
    if (!status)
        status = neph_cycle_search(frame_count, moments, &candidates, cycles->memory,
                                   &cycles->findings, diag);
    if (!status)
        status = neph_cycle_model_begin(&cycles->model, frame_count, &cycles->findings,
                                        cycles->memory, diag);
    neph_arena_finish(&search);
    return status;
}

static enum neph_status allocate_parts(struct cycles *cycles, struct neph_diag *diag)
{
    const size_t pixels = (size_t)cycles->frames.width_px * (size_t)cycles->frames.height_px;
    const int count = NEPH_CYCLE_SQUARES + cycles->model.period_count;
    cycles->parts = neph_arena_allocate(cycles->memory, (size_t)count, sizeof(*cycles->parts));
    for (int i = 0; cycles->parts && i < count; i++)
        cycles->parts[i] = neph_arena_allocate(cycles->memory, pixels, sizeof(**cycles->parts));
    return neph_arena_check(cycles->memory, diag);
}

struct fit_work {
    struct cycles *cycles;
    atomic_bool out_of_memory;
};

static void fit_row(int row, void *context)
{
    struct fit_work *work = context;
    struct cycles *cycles = work->cycles;
    const size_t begin = (size_t)row * (size_t)cycles->frames.width_px;
    const int count = NEPH_CYCLE_SQUARES + cycles->model.period_count;
    double *scratch = malloc(neph_cycle_scratch_count(&cycles->model) * sizeof(*scratch));
    double **parts = malloc((size_t)count * sizeof(*parts));
    for (int i = 0; parts && i < count; i++)
        parts[i] = cycles->parts[i] + begin;
    if (scratch && parts)
        neph_cycle_fit_row(&cycles->model, &cycles->frames, row, scratch, parts);
    else
        atomic_store(&work->out_of_memory, true);
    free(parts);
    free(scratch);
}

static enum neph_status cycles_flush(void *state, struct neph_diag *diag)
{
    struct cycles *cycles = state;
    struct fit_work work = {.cycles = cycles};
    if (cycles->frames_seen < cycles->frames.frame_count)
        return NEPH_OK;
    enum neph_status status = find_periods(cycles, diag);
    if (!status)
        status = allocate_parts(cycles, diag);
    if (!status)
        status = neph_parallel_rows(cycles->frames.height_px, fit_row, &work, diag);
    if (!status && atomic_load(&work.out_of_memory))
        status = neph_fail_memory(diag);
    if (status)
        return status;
    neph_arena_finish(&cycles->seen);
    cycles->complete = true;
    return NEPH_OK;
}

/* ---- results --------------------------------------------------------------------------------- */

/* The periods that a map adds up; `divisors`: also all divisors of `period`. */
struct periods_of_map {
    int period;
    bool divisors;
};

/* The periods of a map of squares; period 0: none found. */
static struct periods_of_map find_map_periods(const struct cycles *cycles, int map)
{
    const struct neph_cycle_model *model = &cycles->model;
    if (map < REPEATS)
        return (struct periods_of_map){map - CYCLE + NEPH_CYCLE_PERIOD_MIN, false};
    if (map < LONG)
        return (struct periods_of_map){map - REPEATS + NEPH_CYCLE_PERIOD_MIN, true};
    int which = map - LONG;
    for (int i = 0; i < model->period_count; i++)
        if (model->periods[i] > NEPH_CYCLE_PERIOD_MAX && which-- == 0)
            return (struct periods_of_map){model->periods[i], false};
    return (struct periods_of_map){0, false};
}

static bool counts(struct periods_of_map wanted, int period)
{
    return period == wanted.period || (wanted.divisors && wanted.period % period == 0);
}

static bool has_any(const struct cycles *cycles, struct periods_of_map wanted)
{
    for (int i = 0; i < cycles->model.period_count; i++)
        if (counts(wanted, cycles->model.periods[i]))
            return true;
    return false;
}

/* The part of white noise of variance 1 that a pixel's budget shows as noise. */
static double noise_per_variance(const struct neph_cycle_model *model)
{
    const double n = (double)model->frame_count;
    double sum = (n - 1.0 - (double)model->column_count) / n;
    for (int c = 0; c < model->column_count; c++)
        sum += model->noise_share[c];
    return sum;
}

/* The number of standard deviations that a mean over a mask must be above 0: 3, one-sided 0.1 %.
 * The periods are known to exist; the test decides whether this mask contains them. */
static const double mask_z = 3.0;

/* Factor of a pixel's noise for NEPH_POOL_ROOT_MEAN_ABOVE. The number of independent series in a
 * mask follows from the scatter of the whole image, in proportion to its pixels. */
static double floor_factor(const struct cycles *cycles, int map)
{
    const struct neph_cycle_model *model = &cycles->model;
    const double pixels = (double)cycles->frames.width_px * (double)cycles->frames.height_px;
    double squares = 0.0;
    for (int i = 0; map != DRIFT && i < model->period_count; i++)
        if (counts(find_map_periods(cycles, map), model->periods[i]))
            squares += model->period_scatter[i] * model->period_scatter[i];
    if (map == DRIFT)
        squares = 2.0 * model->noise_share[0] * model->noise_share[0];
    return mask_z * sqrt(squares) * cycles->findings.scatter * sqrt(pixels) /
           noise_per_variance(model);
}

static double found_factor(const struct cycles *cycles)
{
    const double n = (double)cycles->model.frame_count;
    return (cycles->findings.ratio_min - 1.0) * 2.0 / n / noise_per_variance(&cycles->model);
}

static void add_squares(const struct cycles *cycles, int map, size_t begin, size_t count,
                        double *values)
{
    const struct periods_of_map wanted = find_map_periods(cycles, map);
    const bool any = has_any(cycles, wanted);
    for (size_t i = 0; i < count; i++)
        values[i] = any ? 0.0 : NAN;
    for (int p = 0; p < cycles->model.period_count; p++)
        for (size_t i = 0; counts(wanted, cycles->model.periods[p]) && i < count; i++)
            values[i] += cycles->parts[NEPH_CYCLE_SQUARES + p][begin + i];
}

/* The part of a pixel's budget for a map that is not a sum of periods. */
static enum neph_cycle_part find_map_part(int map)
{
    switch (map) {
    case DRIFT:
        return NEPH_CYCLE_DRIFT;
    case OVERLAP:
        return NEPH_CYCLE_OVERLAP;
    case VARIANCE:
        return NEPH_CYCLE_VARIANCE;
    default: /* and all floors */
        return NEPH_CYCLE_NOISE;
    }
}

static double map_noise_factor(const struct cycles *cycles, int map)
{
    if (map == FOUND_FLOOR)
        return found_factor(cycles);
    return map >= FLOORS && map < FOUND_FLOOR ? floor_factor(cycles, map - FLOORS) : 1.0;
}

static void cycles_rows(const void *state, int map, int first_row, int row_count,
                        double *const values[3])
{
    const struct cycles *cycles = state;
    const size_t width = (size_t)cycles->frames.width_px;
    const size_t begin = (size_t)first_row * width, count = (size_t)row_count * width;
    if (!cycles->complete) {
        for (size_t i = 0; i < count; i++)
            values[0][i] = NAN;
        return;
    }
    if (map < DRIFT) {
        add_squares(cycles, map, begin, count, values[0]);
        return;
    }
    const double *part = cycles->parts[find_map_part(map)] + begin,
                 factor = map_noise_factor(cycles, map);
    for (size_t i = 0; i < count; i++)
        values[0][i] = factor * part[i];
}

static bool is_ambiguous(const struct cycles *cycles, int period)
{
    for (int i = 0; i < cycles->findings.count; i++)
        if (cycles->findings.items[i].also_period == period)
            return true;
    return false;
}

/* The reason why a map of squares has no value. */
static const char *cycles_empty(const void *state, int map)
{
    const struct cycles *cycles = state;
    if (!cycles->complete || map >= DRIFT)
        return ended_early;
    const int period = find_map_periods(cycles, map).period;
    if (period == 0)
        return not_so_many;
    if (period > neph_cycle_longest(cycles->frames.frame_count))
        return period_too_long;
    return is_ambiguous(cycles, period) ? neph_cycle_not_apart : below_floor;
}

static const char *cycles_scalar(const void *state, int which, double *value)
{
    const struct cycles *cycles = state;
    if (!cycles->complete)
        return ended_early;
    *value = 0.0;
    if (which == FRAMES)
        *value = (double)cycles->frames.frame_count;
    else if (which == FOUND)
        *value = (double)cycles->model.period_count;
    else if (which == UNSEPARATED)
        for (int i = 0; i < cycles->findings.count; i++)
            *value += cycles->findings.items[i].also_period > 0;
    else
        *value = (double)find_map_periods(cycles, LONG + which - LONG_FRAMES).period;
    return which >= LONG_FRAMES && *value == 0.0 ? not_so_many : NULL;
}

const struct neph_extractor neph_extractor_cycles = {
    .name = "cycles",
    .help = "flicker of every period 2..32 and of declared ones, as a budget of the variance",
    .source = "least squares at the frequencies m / P, each of which belongs to one primitive "
              "period (Vaidyanathan 2014), over a robust noise floor",
    .details =
        "d: luma of encoded display values, test - reference of the same frame, the first 2048 "
        "after the warm-up, which are kept: 4 bytes a pixel and frame\n"
        "looked for: periods up to an eighth of the frames and to 32, those that the "
        "attribute " NEPH_CYCLE_ATTRIBUTE " of\n"
        "the first frame declares ('TAA jitter 7, slot 4'), and their beats up to a quarter of the "
        "frames\n"
        "found: in the whole image, one vote per pixel, at a level of 0.1 % for all frequencies "
        "together, for noise of any colour\n"
        "sum of cycle_P^2 + cycle_drift^2 + cycle_noise^2 + cycle_overlap = cycle_std^2 over any "
        "mask; cycle_P and cycle_drift have the noise's share taken out",
    .quantities = NEPH_RADIANCE | NEPH_VOLUME,
    .temporal = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = MAP_COUNT,
    .state_size = sizeof(struct cycles),
    .obstacle = cycles_obstacle,
    .bound = neph_bound_is_white,
    .init = cycles_init,
    .extract = cycles_extract,
    .flush = cycles_flush,
    .rows = cycles_rows,
    .empty = cycles_empty,
    .scalar = cycles_scalar,
    .close = cycles_close,
};
