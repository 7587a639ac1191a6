/* SPDX-License-Identifier: MIT
 *
 * How a renderer follows periodically changing light: its gain and its delay.
 *
 * Radiance is linear in the light of the scene. So for each pixel, the luminance Y of linear data
 * is fitted by least squares with a mean, a line and one sine for each known period, jointly, for
 * the test and for the reference: Y(t) = m + b t + sum_k A_k cos(2 pi t / P_k - phi_k).
 *   gain       A_k of the test over A_k of the reference
 *   phase lag  (phi_k of the test - phi_k of the reference) P_k / 2 pi [frame], in -P_k/2 .. P_k/2
 * An exponential average with the weight a, w = 2 pi / P: gain = a / |1 - (1 - a) exp(-i w)|, lag =
 * atan2((1 - a) sin w, 1 - (1 - a) cos w) / w. A delay of d frames: gain 1, lag d.
 */
#include "metrics/extractors/extractors.h"

#include "base/threads.h"
#include "metrics/extractors/visible_step.h"
#include "metrics/vector_math.h"

#include <math.h>

enum { PERIODS_MAX = 3, BASIS_MAX = 2 + 2 * PERIODS_MAX };

/* Smallest amplitude of a sine over its standard error: pure white noise exceeds it in 1e-7 of the
 * pixels (exp(-4^2)). */
static const double least_signal = 4.0;

/* Variance of rounding to float, relative to the squared value: errors up to 2^-24, uniformly
 * distributed. It keeps the noise of a constant pixel above 0, which any amplitude would exceed. */
static const double rounding = 0x1p-48 / 3.0;

static const double shortest_period = 3.0; /* at 2 a sine has no phase */

enum map { GAIN, PHASE_LAG, FOLLOWED, LOST, MAPS_PER_PERIOD };

static const char still[] =
    "the reference of no pixel of the mask moves by 1/255 of display luma and 4 standard errors at "
    "this period, or the period was not given";
static const char no_phase[] =
    "no pixel of the mask moves at this period in both sequences, or the period was not given";
static const char not_given[] = "this period was not given";

/* Four maps for each period. */
/* clang-format off */
#define MAPS_OF(n) \
    {"follow_gain_" n, "1", 1, false, 1.0, still, 0}, \
    {"follow_lag_" n, "frame", 1, true, 16.0, no_phase, 0}, \
    {NULL, "1", 1, false, 0.0, not_given, 0}, \
    {NULL, "1", 1, false, 0.0, still, 0}
static const struct neph_map maps[] = {MAPS_OF("1"), MAPS_OF("2"), MAPS_OF("3")};

#define METRICS_OF(n, k) \
    {"follow_period_" n, "frame", 0, INFINITY, NEPH_POOL_SCALAR, 0, k, 0, \
     "period " n " of the light"}, \
    {"follow_gain_" n "_p05", "1", 0, INFINITY, NEPH_POOL_PERCENTILE, 0.05, \
     k * MAPS_PER_PERIOD + GAIN, 0, \
     "5th percentile of test amplitude / reference amplitude at period " n}, \
    {"follow_gain_" n "_p50", "1", 0, INFINITY, NEPH_POOL_PERCENTILE, 0.50, \
     k * MAPS_PER_PERIOD + GAIN, 0, \
     "median of test amplitude / reference amplitude at period " n}, \
    {"follow_gain_" n "_p95", "1", 0, INFINITY, NEPH_POOL_PERCENTILE, 0.95, \
     k * MAPS_PER_PERIOD + GAIN, 0, \
     "95th percentile of test amplitude / reference amplitude at period " n}, \
    {"follow_lag_" n "_p50", "frame", -INFINITY, INFINITY, NEPH_POOL_PERCENTILE, 0.50, \
     k * MAPS_PER_PERIOD + PHASE_LAG, 0, \
     "median of the frames that the test is late at period " n}, \
    {"follow_lag_" n "_p95", "frame", -INFINITY, INFINITY, NEPH_POOL_PERCENTILE, 0.95, \
     k * MAPS_PER_PERIOD + PHASE_LAG, 0, \
     "95th percentile of the frames that the test is late at period " n}, \
    {"follow_share_" n, "1", 0, 1, NEPH_POOL_MEAN, 0, k * MAPS_PER_PERIOD + FOLLOWED, 0, \
     "share of pixels with a moving reference at period " n ": gain and lag are of these"}, \
    {"follow_lost_share_" n, "1", 0, 1, NEPH_POOL_MEAN, 0, k * MAPS_PER_PERIOD + LOST, 0, \
     "share of those with no motion of the test at period " n " above its noise: no lag"}
static const struct neph_metric metrics[] = {
    METRICS_OF("1", 0),
    METRICS_OF("2", 1),
    METRICS_OF("3", 2),
    {.name = NULL},
};

#define PERIOD_OPTION(n) \
    {"period_" n, NEPH_OPTION_REAL, 0, 0, 1e5, NULL, \
     "a period of the light, in frames; 0: none"}
static const struct neph_option options[] = {
    PERIOD_OPTION("1"), PERIOD_OPTION("2"), PERIOD_OPTION("3"),
    {.name = NULL},
};
/* clang-format on */

/* The fitted functions: 1, t, then cosine and sine of each given period. */
struct basis {
    int period_count, count;
    double periods[PERIODS_MAX]; /* the given periods [frame] */
    int slots[PERIODS_MAX];      /* index of their options */
};

static struct basis basis_of(const struct neph_settings *settings)
{
    struct basis basis = {.count = 2};
    for (int k = 0; k < PERIODS_MAX; k++) {
        if (settings->values[k] == 0.0)
            continue;
        basis.slots[basis.period_count] = k;
        basis.periods[basis.period_count++] = settings->values[k];
        basis.count += 2;
    }
    return basis;
}

static void take_basis(const struct basis *basis, int frame, double values[BASIS_MAX])
{
    values[0] = 1.0;
    values[1] = frame;
    for (int k = 0; k < basis->period_count; k++) {
        const double turns = fmod(frame, basis->periods[k]) / basis->periods[k];
        values[2 + 2 * k] = cos(2.0 * M_PI * turns);
        values[3 + 2 * k] = sin(2.0 * M_PI * turns);
    }
}

/* The reason why this number of frames cannot separate these functions; NULL: it can. */
static const char *too_short_for(const struct basis *basis, int frame_count)
{
    if (frame_count <= basis->count)
        return "fewer frames than a fit of mean, line and sines needs";
    for (int k = 0; k < basis->period_count; k++) {
        if (frame_count < basis->periods[k])
            return "the sequence is shorter than a period";
        for (int j = 0; j < k; j++)
            if (fabs(1.0 / basis->periods[k] - 1.0 / basis->periods[j]) * frame_count < 1.0 - 1e-9)
                return "two periods are too close: the sequence must be long enough for the one "
                       "to swing once more than the other";
    }
    return NULL;
}

static const char *obstacle(const struct neph_frame_pair *first,
                            const struct neph_settings *settings)
{
    const struct basis basis = basis_of(settings);
    if (basis.period_count == 0)
        return "no period of the light: give -s follow:period_1=FRAMES";
    for (int k = 0; k < basis.period_count; k++)
        if (basis.periods[k] < shortest_period)
            return "a period must be at least 3 frames";
    return first->frame_count > 0 ? too_short_for(&basis, first->frame_count) : NULL;
}

/* ---- sums over the frames -------------------------------------------------------------------- */

enum picture { TEST, REFERENCE, PICTURE_COUNT };

/* The state of each pixel: the sums of Y with each function, and of Y^2. After the last frame the
 * maps replace the first of these planes. */
struct state {
    int width_px, height_px;
    int frame_count;
    double gain; /* display value of the radiance 1 */
    struct basis basis;
    double gram[BASIS_MAX][BASIS_MAX]; /* sums of products of the functions; later its inverse */
    double *sums[PICTURE_COUNT][BASIS_MAX], *squares[PICTURE_COUNT]; /* allocated in: */
    double *block;
};

static enum neph_status init(void *state_, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag)
{
    struct state *state = state_;
    const size_t pixel_count = (size_t)first->width_px * (size_t)first->height_px;
    *state = (struct state){.width_px = first->width_px,
                            .height_px = first->height_px,
                            .gain = exp2(first->viewing->exposure_ev),
                            .basis = basis_of(settings)};
    const size_t plane_count = (size_t)(PICTURE_COUNT * (state->basis.count + 1));
    double *next = neph_arena_zeroed(first->memory, pixel_count, plane_count * sizeof(*next));
    state->block = next;
    if (!next)
        return neph_fail_memory(diag);
    for (int p = 0; p < PICTURE_COUNT; p++) {
        for (int j = 0; j < state->basis.count; j++, next += pixel_count)
            state->sums[p][j] = next;
        state->squares[p] = next;
        next += pixel_count;
    }
    return NEPH_OK;
}

NEPH_VECTOR static void take_luminance(const float *restrict r, const float *restrict g,
                                       const float *restrict b, size_t count,
                                       double *restrict luminance, double *restrict squares)
{
    for (size_t i = 0; i < count; i++) {
        luminance[i] = neph_luminance((double)r[i], (double)g[i], (double)b[i]);
        squares[i] += luminance[i] * luminance[i];
    }
}

NEPH_VECTOR static void add_product(const double *restrict luminance, double weight, size_t count,
                                    double *restrict sum)
{
    for (size_t i = 0; i < count; i++)
        sum[i] += weight * luminance[i];
}

struct work {
    struct state *state;
    const struct neph_frame_pair *pair;
    double values[BASIS_MAX]; /* values of the functions in this frame */
};

/* Pixels per step, so that the luminance stays in the cache. */
enum { PIECE_PX = 256 };

static void add_row(int row, void *context)
{
    const struct work *work = context;
    const struct state *state = work->state;
    const float *const *pictures[PICTURE_COUNT] = {work->pair->test, work->pair->reference};
    const size_t width = (size_t)state->width_px, first = (size_t)row * width;
    double luminance[PIECE_PX];
    for (int p = 0; p < PICTURE_COUNT; p++)
        for (size_t done = 0; done < width; done += PIECE_PX) {
            const float *const *planes = pictures[p];
            const size_t at = first + done;
            const size_t count = width - done < PIECE_PX ? width - done : PIECE_PX;
            take_luminance(planes[0] + at, planes[1] + at, planes[2] + at, count, luminance,
                           state->squares[p] + at);
            for (int j = 0; j < state->basis.count; j++)
                add_product(luminance, work->values[j], count, state->sums[p][j] + at);
        }
}

static enum neph_status extract(void *state_, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    struct state *state = state_;
    struct work work = {.state = state, .pair = pair};
    take_basis(&state->basis, pair->frame, work.values);
    for (int j = 0; j < state->basis.count; j++)
        for (int k = 0; k < state->basis.count; k++)
            state->gram[j][k] += work.values[j] * work.values[k];
    state->frame_count++;
    return neph_parallel_rows(state->height_px, add_row, &work, diag);
}

/* ---- the fit --------------------------------------------------------------------------------- */

/* Invert a symmetric positive definite matrix in place: Gauss-Jordan without pivoting, which such a
 * matrix does not need. */
static void invert(double matrix[BASIS_MAX][BASIS_MAX], int count)
{
    for (int p = 0; p < count; p++) {
        const double pivot = matrix[p][p];
        matrix[p][p] = 1.0;
        for (int k = 0; k < count; k++)
            matrix[p][k] /= pivot;
        for (int j = 0; j < count; j++) {
            const double factor = matrix[j][p];
            if (j == p)
                continue;
            matrix[j][p] = 0.0;
            for (int k = 0; k < count; k++)
                matrix[j][k] -= factor * matrix[p][k];
        }
    }
}

/* The fit of one image's pixel. */
struct fit {
    double coefficients[BASIS_MAX];
    double noise; /* variance around the fit */
};

static struct fit fit_pixel(const struct state *state, enum picture picture, size_t i)
{
    const int count = state->basis.count;
    struct fit fit = {.noise = 0.0};
    double explained = 0.0;
    for (int j = 0; j < count; j++) {
        for (int k = 0; k < count; k++)
            fit.coefficients[j] += state->gram[j][k] * state->sums[picture][k][i];
        explained += fit.coefficients[j] * state->sums[picture][j][i];
    }
    const double squares = state->squares[picture][i];
    fit.noise = fmax((squares - explained) / (state->frame_count - count),
                     rounding * squares / state->frame_count);
    return fit;
}

struct sine {
    double amplitude, phase_rad;
    bool above_noise;
};

static struct sine sine_of(const struct state *state, const struct fit *fit, int k)
{
    const int c = 2 + 2 * k, s = c + 1;
    const double variance = fit->noise * (state->gram[c][c] + state->gram[s][s]);
    struct sine sine = {.amplitude = hypot(fit->coefficients[c], fit->coefficients[s]),
                        .phase_rad = atan2(fit->coefficients[s], fit->coefficients[c])};
    sine.above_noise = sine.amplitude > least_signal * sqrt(variance);
    return sine;
}

static void compare_sines(const struct state *state, const struct fit fits[PICTURE_COUNT], int k,
                          double values[MAPS_PER_PERIOD])
{
    const struct sine test = sine_of(state, &fits[TEST], k);
    const struct sine reference = sine_of(state, &fits[REFERENCE], k);
    const double *line = fits[REFERENCE].coefficients;
    const double middle = line[0] + 0.5 * (state->frame_count - 1) * line[1];
    const bool moves = reference.above_noise &&
                       neph_is_visible_step(middle - reference.amplitude,
                                            middle + reference.amplitude, state->gain);
    const double late_rad = remainder(test.phase_rad - reference.phase_rad, 2.0 * M_PI);
    values[FOLLOWED] = moves;
    values[GAIN] = moves ? test.amplitude / reference.amplitude : (double)NAN;
    values[LOST] = moves ? !test.above_noise : (double)NAN;
    values[PHASE_LAG] = moves && test.above_noise
                            ? late_rad / (2.0 * M_PI) * state->basis.periods[k]
                            : (double)NAN;
}

/* The plane of a map of a given period; the maps replace the planes of the sums. */
static double *plane_of(const struct state *state, int k, int map)
{
    const size_t pixel_count = (size_t)state->width_px * (size_t)state->height_px;
    return state->block + (size_t)(k * MAPS_PER_PERIOD + map) * pixel_count;
}

static void fit_row(int row, void *context)
{
    const struct state *state = context;
    const size_t width = (size_t)state->width_px, first = (size_t)row * width;
    for (size_t i = first; i < first + width; i++) {
        const struct fit fits[PICTURE_COUNT] = {fit_pixel(state, TEST, i),
                                                fit_pixel(state, REFERENCE, i)};
        for (int k = 0; k < state->basis.period_count; k++) {
            double values[MAPS_PER_PERIOD];
            compare_sines(state, fits, k, values);
            for (int map = 0; map < MAPS_PER_PERIOD; map++)
                plane_of(state, k, map)[i] = values[map];
        }
    }
}

static enum neph_status flush(void *state_, struct neph_diag *diag)
{
    struct state *state = state_;
    const char *reason = too_short_for(&state->basis, state->frame_count);
    if (reason)
        return neph_fail(diag, NEPH_ERR_USAGE, "follow: %s (%d frames)", reason,
                         state->frame_count);
    invert(state->gram, state->basis.count);
    return neph_parallel_rows(state->height_px, fit_row, state, diag);
}

/* ---- the numbers ----------------------------------------------------------------------------- */

/* The index of an option among the given periods; -1: not given. */
static int given_as(const struct basis *basis, int slot)
{
    for (int k = 0; k < basis->period_count; k++)
        if (basis->slots[k] == slot)
            return k;
    return -1;
}

static void rows(const void *state_, int map, int first_row, int row_count, double *const values[3])
{
    const struct state *state = state_;
    const size_t width = (size_t)state->width_px, count = (size_t)row_count * width;
    const int k = given_as(&state->basis, map / MAPS_PER_PERIOD);
    const double *plane = k < 0 ? NULL : plane_of(state, k, map % MAPS_PER_PERIOD);
    for (size_t i = 0; i < count; i++)
        values[0][i] = plane ? plane[(size_t)first_row * width + i] : (double)NAN;
}

static const char *scalar(const void *state_, int which, double *value)
{
    const struct state *state = state_;
    const int k = given_as(&state->basis, which);
    if (k < 0)
        return not_given;
    *value = state->basis.periods[k];
    return NULL;
}

const struct neph_extractor neph_extractor_follow = {
    .name = "follow",
    .help = "how much of a sine of the light the test follows, and how many frames late",
    .source = "frequency response; an exponential average of weight a has the gain "
              "a / |1 - (1 - a) exp(-i w)|: Oppenheim, Schafer, Discrete-Time Signal Processing, "
              "2010, section 5.1",
    .details = "the periods of the light must be given: -s follow:period_1=16 and so on;\n"
               "linear luminance; mean, line and all sines are fitted jointly, per pixel\n"
               "gain: amplitude of the test / amplitude of the reference; lag: phase difference\n"
               "in frames, late is positive, within half a period\n"
               "pixels with a reference that moves by less than 1/255 of the encoded display\n"
               "value, or by less than 4 standard errors of its own noise, are left out",
    .quantities = NEPH_RADIANCE | NEPH_VOLUME,
    .temporal = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = PERIODS_MAX * MAPS_PER_PERIOD,
    .state_size = sizeof(struct state),
    .obstacle = obstacle,
    .init = init,
    .extract = extract,
    .flush = flush,
    .rows = rows,
    .scalar = scalar,
};
