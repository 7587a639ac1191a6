/* SPDX-License-Identifier: MIT */
#include "harness/fit/fit.h"

#include "base/sort.h"
#include "harness/fit/intervals.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_FIT_UNKNOWN_COUNT == 4, "a new unknown");
_Static_assert(NEPH_FIT_QUANTITY_COUNT == 2, "a new quantity");

enum { VALUES = NEPH_FIT_VALUES, UNKNOWNS = NEPH_FIT_UNKNOWN_COUNT };

/* ---- weights --------------------------------------------------------------------------------- */

static void find_floors(struct neph_fit *fit)
{
    const double rounding = 1e-7; /* of floats */
    double sums[NEPH_FIT_QUANTITY_COUNT] = {0.0};
    for (int i = 0; i < neph_fit_count_values(fit); i++) {
        const struct neph_fit_pixel *pixel = &fit->pixels->list[i / VALUES];
        const double error = pixel->weights[i % VALUES] *
                             neph_fit_sensitivity(pixel->values[i % VALUES],
                                                  neph_fit_quantity_at(i));
        sums[neph_fit_quantity_at(i)] += error * error;
    }
    for (int q = 0; q < NEPH_FIT_QUANTITY_COUNT; q++)
        fit->floors[q] = fmax(NEPH_FIT_MODEL_ERROR * sqrt(sums[q] / (3 * fit->pixels->count)),
                              rounding);
}

/* Divide the weights of the pixels by the scales of their quantities, which are their residuals'
 * rms; outliers keep 0. */
static void scale_weights(struct neph_fit *fit)
{
    for (int i = 0; i < neph_fit_count_values(fit); i++)
        if (fit->weights[i] != 0.0)
            fit->weights[i] = fit->pixels->list[i / VALUES].weights[i % VALUES] /
                              fmax(fit->rms[neph_fit_quantity_at(i)],
                                   fit->floors[neph_fit_quantity_at(i)]);
}

static void start_weights(struct neph_fit *fit)
{
    for (int i = 0; i < neph_fit_count_values(fit); i++)
        fit->weights[i] = i / VALUES % fit->stride == 0
                              ? fit->pixels->list[i / VALUES].weights[i % VALUES]
                              : 0.0;
}

/* The residuals of a point, and per quantity their relative rms (0: it has no value). */
static enum neph_status measure(struct neph_fit *fit, const struct neph_fit_point *point,
                                double *residuals, double *rms, struct neph_diag *diag)
{
    const struct neph_fit_base base = neph_fit_scene_base();
    struct neph_fit_problem problem = {.fit = fit, .base = &base, .point = *point};
    const enum neph_status status = neph_fit_find_residuals(&problem, NULL, residuals, diag);
    int counts[NEPH_FIT_QUANTITY_COUNT] = {0};
    double sums[NEPH_FIT_QUANTITY_COUNT] = {0.0};
    for (int i = 0; i < neph_fit_count_values(fit) && !status; i++) {
        const double scale = fit->weights[i] == 0.0
                                 ? 0.0
                                 : fit->pixels->list[i / VALUES].weights[i % VALUES] /
                                       fit->weights[i];
        counts[neph_fit_quantity_at(i)] += fit->weights[i] != 0.0;
        sums[neph_fit_quantity_at(i)] += scale * scale * residuals[i] * residuals[i];
    }
    for (int q = 0; q < NEPH_FIT_QUANTITY_COUNT; q++)
        rms[q] = counts[q] ? sqrt(sums[q] / counts[q]) : 0.0;
    return status;
}

/* ---- starts ---------------------------------------------------------------------------------- */

/* Extinctions of the search for a start: factors of 10^0.4 over eight decades. */
enum { SCAN_HALF = 10, SCAN = 2 * SCAN_HALF + 1, SCAN_ASYMMETRIES = 8 };
static const double scan_asymmetries[SCAN_ASYMMETRIES] = {-0.6, -0.3, 0.0,  0.3,
                                                          0.5,  0.7,  0.85, 0.93};

struct start {
    struct neph_fit_point point;
    double squares;
};

struct scan {
    struct neph_fit *fit;
    double *dark, *lit, *residuals; /* predictions without and with scattered light */
};

/* The factor of albedo that is best in linear light, where the predictions are linear in it. */
static double find_albedo(const struct scan *scan)
{
    const struct neph_fit *fit = scan->fit;
    double above = 0.0, below = 0.0;
    for (int i = 0; i < neph_fit_count_values(fit); i++) {
        const double frame = fit->pixels->list[i / VALUES].values[i % VALUES];
        const double slope = fit->weights[i] * (scan->lit[i] - scan->dark[i]);
        const double value = neph_fit_quantity_at(i) == NEPH_FIT_RADIANCE
                                 ? neph_fit_transfer_invert(fit->transfer, frame)
                                 : frame;
        above += slope * fit->weights[i] * (value - scan->dark[i]);
        below += slope * slope;
    }
    return below > 0.0 ? fmin(fmax(above / below, 1e-4), 1e4) : 1.0;
}

static enum neph_status try_start(const struct scan *scan, struct neph_fit_point point,
                                  struct start *best, struct neph_diag *diag)
{
    struct neph_fit *fit = scan->fit;
    const struct neph_fit_base base = neph_fit_scene_base();
    struct neph_fit_point dark = point;
    struct neph_fit_problem problem = {.fit = fit, .base = &base};
    double squares = 0.0;
    dark.x[NEPH_FIT_ALBEDO] = -INFINITY;
    enum neph_status status = neph_fit_predict(fit->model, &base, &dark, NEPH_FIT_LINEAR,
                                               scan->dark, diag);
    if (!status)
        status = neph_fit_predict(fit->model, &base, &point, NEPH_FIT_LINEAR, scan->lit, diag);
    if (!status && fit->is_free[NEPH_FIT_ALBEDO])
        point.x[NEPH_FIT_ALBEDO] = log(find_albedo(scan));
    problem.point = point;
    if (!status)
        status = neph_fit_find_residuals(&problem, NULL, scan->residuals, diag);
    for (int i = 0; i < neph_fit_count_values(fit); i++)
        squares += scan->residuals[i] * scan->residuals[i];
    if (!status && squares < best->squares)
        *best = (struct start){point, squares};
    return status;
}

/* For each extinction the best of all albedos and of some asymmetries. */
static enum neph_status scan_extinctions(const struct scan *scan, struct start starts[SCAN],
                                         struct neph_diag *diag)
{
    const struct neph_fit_point own = neph_fit_scene_point(scan->fit->scene);
    enum neph_status status = NEPH_OK;
    for (int e = 0; e < SCAN && !status; e++) {
        struct neph_fit_point point = own;
        starts[e] = (struct start){own, INFINITY};
        point.x[NEPH_FIT_EXTINCTION] = 0.4 * log(10.0) * (e - SCAN_HALF);
        if (!scan->fit->is_free[NEPH_FIT_EXTINCTION] && e != SCAN_HALF)
            continue;
        status = try_start(scan, point, &starts[e], diag);
        for (int g = 0; g < SCAN_ASYMMETRIES && !status; g++) {
            point.x[NEPH_FIT_ASYMMETRY] = scan_asymmetries[g];
            if (scan->fit->is_free[NEPH_FIT_ASYMMETRY])
                status = try_start(scan, point, &starts[e], diag);
        }
    }
    return status;
}

/* The two best local minima of the scan, the best first; the second is INFINITY if there is one. */
static void choose_starts(const struct start starts[SCAN], struct start chosen[2])
{
    chosen[0].squares = chosen[1].squares = INFINITY;
    for (int e = 0; e < SCAN; e++) {
        if ((e > 0 && starts[e - 1].squares < starts[e].squares) ||
            (e + 1 < SCAN && starts[e + 1].squares < starts[e].squares))
            continue;
        if (starts[e].squares < chosen[0].squares) {
            chosen[1] = chosen[0];
            chosen[0] = starts[e];
        } else if (starts[e].squares < chosen[1].squares) {
            chosen[1] = starts[e];
        }
    }
}

static enum neph_status find_starts(struct neph_fit *fit, struct start chosen[2],
                                    struct neph_diag *diag)
{
    const size_t count = (size_t)neph_fit_count_residuals(fit);
    struct start starts[SCAN];
    double *room = malloc(3 * count * sizeof(*room));
    const struct scan scan = {fit, room, room + count, room + 2 * count};
    if (!room)
        return neph_fail_memory(diag);
    const enum neph_status status = scan_extinctions(&scan, starts, diag);
    if (!status)
        choose_starts(starts, chosen);
    free(room);
    return status;
}

/* ---- one transfer ---------------------------------------------------------------------------- */

static enum neph_status minimise_whole(struct neph_fit *fit, struct neph_fit_point *point,
                                       double *squares, struct neph_diag *diag)
{
    const struct neph_fit_base base = neph_fit_scene_base();
    const struct neph_fit_range range = neph_fit_whole_range(fit);
    return neph_fit_minimise(fit, &base, &range, 0.0, point, squares, diag);
}

/* Scale each quantity by its rms, and fit again where there are two. */
static enum neph_status rescale(struct neph_fit *fit, double *residuals, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    const int rounds = fit->pixels->has[0] && fit->pixels->has[1] ? 3 : 2;
    for (int round = 0; round < rounds && !status; round++) {
        status = measure(fit, &fit->best.point, residuals, fit->rms, diag);
        scale_weights(fit);
        if (!status)
            status = minimise_whole(fit, &fit->best.point, &fit->best.squares, diag);
    }
    return status ? status : measure(fit, &fit->best.point, residuals, fit->rms, diag);
}

/* Fit with the scene's falloff first: it may not be determined. */
static enum neph_status fit_from(struct neph_fit *fit, struct neph_fit_point *point,
                                 double *squares, struct neph_diag *diag)
{
    const struct neph_fit_base base = neph_fit_scene_base();
    struct neph_fit_range range = neph_fit_whole_range(fit);
    range.low.x[NEPH_FIT_FALLOFF] = range.high.x[NEPH_FIT_FALLOFF] = point->x[NEPH_FIT_FALLOFF];
    enum neph_status status = neph_fit_minimise(fit, &base, &range, 0.0, point, squares, diag);
    if (!status && fit->is_free[NEPH_FIT_FALLOFF])
        status = minimise_whole(fit, point, squares, diag);
    return status;
}

static enum neph_status fit_transfer(struct neph_fit *fit, double *residuals,
                                     struct neph_diag *diag)
{
    struct start starts[2];
    fit->best.squares = INFINITY;
    start_weights(fit);
    enum neph_status status = find_starts(fit, starts, diag);
    for (int s = 0; s < 2 && !status; s++) {
        double squares = INFINITY;
        if (isinf(starts[s].squares))
            continue;
        status = fit_from(fit, &starts[s].point, &squares, diag);
        if (!status && squares < fit->best.squares) {
            fit->best.squares = squares;
            fit->best.point = starts[s].point;
        }
    }
    return status ? status : rescale(fit, residuals, diag);
}

/* Minus twice the logarithm of the likelihood, for errors of unknown variances and one independent
 * error a pixel. */
static double find_misfit(const struct neph_fit *fit)
{
    const int count = (fit->pixels->count + fit->stride - 1) / fit->stride;
    double sum = 0.0;
    for (int q = 0; q < NEPH_FIT_QUANTITY_COUNT; q++)
        sum += fit->pixels->has[q] ? 2.0 * count * log(fmax(fit->rms[q], 1e-6)) : 0.0;
    return sum;
}

/* The transfer of the least misfit, or linear light if that is hardly worse; and whether all others
 * are clearly worse. */
static enum neph_fit_transfer choose_transfer(const double misfits[NEPH_FIT_TRANSFER_COUNT],
                                              bool *is_sure)
{
    const double clear = 10.0; /* odds of 150 to 1 */
    int best = NEPH_FIT_LINEAR;
    for (int t = 0; t < NEPH_FIT_TRANSFER_COUNT; t++)
        if (misfits[t] < misfits[best] && misfits[t] < misfits[NEPH_FIT_LINEAR] - clear)
            best = t;
    *is_sure = true;
    for (int t = 0; t < NEPH_FIT_TRANSFER_COUNT; t++)
        *is_sure &= t == best || misfits[t] > misfits[best] + clear;
    return (enum neph_fit_transfer)best;
}

/* Fit all transfers, unless linear light explains the frame already. The result is that of the best
 * one. */
static enum neph_status fit_transfers(struct neph_fit *fit, double *residuals,
                                      struct neph_diag *diag)
{
    const double enough = 3.0 * NEPH_FIT_MODEL_ERROR;
    double misfits[NEPH_FIT_TRANSFER_COUNT];
    enum neph_status status = NEPH_OK;
    int last = 0;
    for (int t = 0; t < NEPH_FIT_TRANSFER_COUNT && !status; t++) {
        fit->transfer_rms[t] = NAN;
        misfits[t] = INFINITY;
        if (t > 0 && (!fit->pixels->has[NEPH_FIT_RADIANCE] || fit->transfer_rms[0] < enough))
            continue;
        fit->transfer = (enum neph_fit_transfer)t;
        status = fit_transfer(fit, residuals, diag);
        fit->transfer_rms[t] = fit->rms[NEPH_FIT_RADIANCE];
        misfits[t] = find_misfit(fit);
        last = t;
    }
    fit->transfer = choose_transfer(misfits, &fit->is_transfer_sure);
    return status || last == (int)fit->transfer ? status : fit_transfer(fit, residuals, diag);
}

/* ---- outliers -------------------------------------------------------------------------------- */

/* The spread of the residuals of a quantity: 1.4826 times the median of their absolute values. */
static double find_spread(const struct neph_fit *fit, const double *residuals, int quantity,
                          double *room)
{
    size_t count = 0;
    for (int i = 0; i < neph_fit_count_values(fit); i++)
        if (neph_fit_quantity_at(i) == quantity && fit->weights[i] != 0.0)
            room[count++] = fabs(residuals[i]);
    neph_sort_doubles(room, count);
    return count ? 1.4826 * room[count / 2] : INFINITY;
}

/* How far each pixel is from the others: the largest of its residuals, in spreads. */
static enum neph_status find_scores(const struct neph_fit *fit, const double *residuals,
                                    double *scores, struct neph_diag *diag)
{
    double spreads[NEPH_FIT_QUANTITY_COUNT];
    double *room = malloc((size_t)neph_fit_count_values(fit) * sizeof(*room));
    if (!room)
        return neph_fail_memory(diag);
    for (int q = 0; q < NEPH_FIT_QUANTITY_COUNT; q++)
        spreads[q] = fmax(find_spread(fit, residuals, q, room), fit->floors[q]);
    free(room);
    for (int p = 0; p < fit->pixels->count; p++) {
        scores[p] = 0.0;
        for (int v = 0; v < VALUES; v++)
            scores[p] = fmax(scores[p], fabs(residuals[p * VALUES + v]) / spreads[v / 3]);
    }
    return NEPH_OK;
}

/* Give pixels beyond `far` spreads no weight. Returns their number. */
static int remove_pixels(struct neph_fit *fit, const double *scores, double far)
{
    int count = 0;
    for (int p = 0; p < fit->pixels->count; p++)
        if (scores[p] > far) {
            count++;
            memset(&fit->weights[p * VALUES], 0, VALUES * sizeof(*fit->weights));
        }
    return count;
}

/* One round of remove_outliers(). `*is_done`: the next round would be the same. */
static enum neph_status remove_farthest(struct neph_fit *fit, bool is_last, double *residuals,
                                        double *scores, bool *is_done, struct neph_diag *diag)
{
    const double far = 6.0;
    const int count = fit->pixels->count, before = fit->outlier_count;
    double *sorted = scores + count, rms[NEPH_FIT_QUANTITY_COUNT];
    start_weights(fit);
    enum neph_status status = measure(fit, &fit->best.point, residuals, rms, diag);
    if (!status)
        status = find_scores(fit, residuals, scores, diag);
    if (status)
        return status;
    memcpy(sorted, scores, (size_t)count * sizeof(*scores));
    neph_sort_doubles(sorted, (size_t)count);
    const double limit = fmax(far, sorted[count - 1 - count / 20]);
    fit->outlier_count = is_last && limit > far ? 0 : remove_pixels(fit, scores, limit);
    *is_done = fit->outlier_count == before && limit == far;
    scale_weights(fit);
    return fit->outlier_count == 0 && before == 0 ? NEPH_OK : rescale(fit, residuals, diag);
}

/* Leave out pixels beyond 6 spreads, such as edges and fireflies, which bias the first fit: in
 * rounds, the farthest 5 % at most. If more are far in the end, the model is at fault, and none is
 * left out. */
static enum neph_status remove_outliers(struct neph_fit *fit, double *residuals,
                                        struct neph_diag *diag)
{
    enum { ROUNDS = 4 };
    enum neph_status status = NEPH_OK;
    bool is_done = false;
    double *scores = malloc(2 * (size_t)fit->pixels->count * sizeof(*scores));
    if (!scores)
        return neph_fail_memory(diag);
    for (int round = 0; round < ROUNDS && !is_done && !status; round++)
        status = remove_farthest(fit, round == ROUNDS - 1, residuals, scores, &is_done, diag);
    free(scores);
    return status;
}

/* ---- all ------------------------------------------------------------------------------------- */

/* Find the transfer and a start with some of the pixels. */
static enum neph_status solve_coarsely(struct neph_fit *fit, double *residuals,
                                       struct neph_diag *diag)
{
    enum { PIXELS = 150 };
    fit->stride = 1 + (fit->pixels->count - 1) / PIXELS;
    neph_fit_model_thin(fit->model, fit->stride);
    const enum neph_status status = fit_transfers(fit, residuals, diag);
    fit->stride = 1;
    neph_fit_model_thin(fit->model, 1);
    return status;
}

static enum neph_status solve(struct neph_fit *fit, double *residuals, struct neph_diag *diag)
{
    const struct neph_fit_range range = neph_fit_whole_range(fit);
    find_floors(fit);
    enum neph_status status = solve_coarsely(fit, residuals, diag);
    start_weights(fit);
    if (!status)
        status = rescale(fit, residuals, diag);
    if (!status)
        status = remove_outliers(fit, residuals, diag);
    if (!status)
        status = neph_fit_find_intervals(fit, &range, &fit->best, diag);
    return status ? status : neph_fit_find_held(fit, diag);
}

enum neph_status neph_fit_solve(struct neph_fit *fit, struct neph_diag *diag)
{
    const size_t count = (size_t)neph_fit_count_residuals(fit);
    double *residuals = calloc(count, sizeof(*residuals));
    for (int k = 0; k < UNKNOWNS; k++)
        fit->is_free[k] = fit->is_free[k] &&
                          !neph_fit_obstacle(fit->scene, (enum neph_fit_unknown)k);
    fit->weights = calloc(count, sizeof(*fit->weights));
    fit->predicted = calloc(count, sizeof(*fit->predicted));
    enum neph_status status = residuals && fit->weights && fit->predicted ? NEPH_OK
                                                                          : neph_fail_memory(diag);
    if (!status)
        status = neph_fit_model_create(fit->scene, fit->pixels, &fit->model, diag);
    if (!status)
        status = solve(fit, residuals, diag);
    free(residuals);
    return status;
}

void neph_fit_finish(struct neph_fit *fit)
{
    free(fit->weights);
    free(fit->predicted);
    neph_fit_model_destroy(fit->model);
    fit->weights = fit->predicted = NULL;
    fit->model = NULL;
}
