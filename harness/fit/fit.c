/* SPDX-License-Identifier: MIT */
#include "harness/fit/fit.h"

#include "base/least_squares.h"
#include "base/sort.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { VALUES = NEPH_FIT_QUANTITY_COUNT * 3, UNKNOWNS = NEPH_FIT_UNKNOWN_COUNT };

/* What the data do not tell stays near the scene's value: a standard deviation of 10 in g and in the
 * logarithms of factors. Extinction is free: of a pair that is not determined, it takes the
 * difference from the scene. */
static const double prior_deviation = 10.0;

/* The unknowns in a simple order of magnitude: logarithms of factors, and g. */
static const double widest[UNKNOWNS] = {
    [NEPH_FIT_EXTINCTION] = 11.5, [NEPH_FIT_ALBEDO] = 11.5, [NEPH_FIT_FALLOFF] = 9.2};
static const double asymmetry_max = 0.98;

/* Quantiles of the normal distribution, and of chi squared of 1 and 2 degrees of freedom. */
static const double normal_95 = 1.959964, chi_squared_95[] = {3.841, 5.991};

static int count_values(const struct neph_fit *fit)
{
    return fit->pixels->count * VALUES;
}

/* Values, and one of the prior for each unknown. */
static int count_residuals(const struct neph_fit *fit)
{
    return count_values(fit) + UNKNOWNS;
}

static int quantity_of(int value)
{
    return value % VALUES / 3;
}

/* ---- least squares --------------------------------------------------------------------------- */

struct problem {
    struct neph_fit *fit;
    const struct neph_fit_base *base;
    struct neph_fit_point point; /* with the values of those that are held fixed */
    int unknowns[UNKNOWNS], count;
};

static enum neph_status find_residuals(void *context, const double *x, double *residuals,
                                       struct neph_diag *diag)
{
    struct problem *problem = context;
    struct neph_fit *fit = problem->fit;
    struct neph_fit_point point = problem->point;
    for (int k = 0; k < problem->count; k++)
        point.x[problem->unknowns[k]] = x[k];
    const enum neph_status status = neph_fit_predict(fit->model, problem->base, &point,
                                                     fit->transfer, fit->predicted, diag);
    for (int i = 0; i < count_values(fit) && !status; i++) {
        const double *values = &fit->pixels->list[i / VALUES].values[0][0];
        residuals[i] = fit->weights[i] == 0.0
                           ? 0.0
                           : fit->weights[i] * (fit->predicted[i] - values[i % VALUES]);
    }
    const struct neph_fit_point own = neph_fit_scene_point(fit->scene);
    for (int k = 0; k < UNKNOWNS; k++)
        residuals[count_values(fit) + k] = k == NEPH_FIT_EXTINCTION
                                               ? 0.0
                                               : (point.x[k] - own.x[k]) / prior_deviation;
    return status;
}

/* Central differences: a step of 1e-3 has a relative error of 1e-6, in logarithms and in g. */
static enum neph_status find_slopes(void *context, const double *x, const double *residuals,
                                    double *const *slopes, struct neph_diag *diag)
{
    const double step = 1e-3;
    const struct problem *problem = context;
    const int count = count_residuals(problem->fit);
    double *low = malloc((size_t)count * sizeof(*low));
    enum neph_status status = low ? NEPH_OK : neph_fail_memory(diag);
    (void)residuals;
    for (int k = 0; k < problem->count && !status; k++) {
        double moved[UNKNOWNS];
        memcpy(moved, x, (size_t)problem->count * sizeof(*x));
        moved[k] = x[k] - step;
        status = find_residuals(context, moved, low, diag);
        moved[k] = x[k] + step;
        if (!status)
            status = find_residuals(context, moved, slopes[k], diag);
        for (int i = 0; i < count && !status; i++)
            slopes[k][i] = (slopes[k][i] - low[i]) / (2.0 * step);
    }
    free(low);
    return status;
}

struct neph_fit_range neph_fit_whole_range(const struct neph_fit *fit)
{
    const struct neph_fit_point own = neph_fit_scene_point(fit->scene);
    struct neph_fit_range range = {own, own};
    for (int k = 0; k < UNKNOWNS; k++) {
        const double high = k == NEPH_FIT_ASYMMETRY ? asymmetry_max : widest[k];
        range.low.x[k] = fit->is_free[k] ? -high : own.x[k];
        range.high.x[k] = fit->is_free[k] ? high : own.x[k];
    }
    return range;
}

enum neph_status neph_fit_minimise(struct neph_fit *fit, const struct neph_fit_base *base,
                                   const struct neph_fit_range *range, double enough,
                                   struct neph_fit_point *point, double *squares,
                                   struct neph_diag *diag)
{
    struct problem problem = {.fit = fit, .base = base, .point = *point};
    double x[UNKNOWNS], low[UNKNOWNS], high[UNKNOWNS];
    for (int k = 0; k < UNKNOWNS; k++) {
        problem.point.x[k] = fmin(fmax(point->x[k], range->low.x[k]), range->high.x[k]);
        if (range->low.x[k] < range->high.x[k]) {
            x[problem.count] = problem.point.x[k];
            low[problem.count] = range->low.x[k];
            high[problem.count] = range->high.x[k];
            problem.unknowns[problem.count++] = k;
        }
    }
    const struct neph_least_squares solver = {.unknown_count = problem.count,
                                              .residual_count = count_residuals(fit),
                                              .find_residuals = find_residuals,
                                              .find_slopes = find_slopes,
                                              .context = &problem,
                                              .low = low,
                                              .high = high,
                                              .tolerance = 1e-5,
                                              .smallest_step = 1e-5,
                                              .enough = enough,
                                              .iterations_max = 30};
    const enum neph_status status = neph_least_squares_solve(&solver, x, squares, diag);
    for (int k = 0; k < problem.count && !status; k++)
        problem.point.x[problem.unknowns[k]] = x[k];
    if (!status)
        *point = problem.point;
    return status;
}

double neph_fit_limit(const struct neph_fit *fit, int restricted)
{
    return fit->best.squares + chi_squared_95[restricted - 1] * fmax(fit->best.noise, 1.0);
}

/* ---- weights --------------------------------------------------------------------------------- */

/* What a relative error of radiance, or of the optical depth of a transmittance, is multiplied by. */
static double find_sensitivity(double value, int quantity)
{
    if (quantity == NEPH_FIT_RADIANCE)
        return value;
    const double transmittance = fmin(fmax(value, 1e-9), 1.0);
    return -transmittance * log(transmittance);
}

static void find_floors(struct neph_fit *fit)
{
    const double rounding = 1e-7; /* of floats */
    double sums[NEPH_FIT_QUANTITY_COUNT] = {0.0};
    for (int i = 0; i < count_values(fit); i++) {
        const struct neph_fit_pixel *pixel = &fit->pixels->list[i / VALUES];
        const double error = pixel->weights[0][i % VALUES] *
                             find_sensitivity(pixel->values[0][i % VALUES], quantity_of(i));
        sums[quantity_of(i)] += error * error;
    }
    for (int q = 0; q < NEPH_FIT_QUANTITY_COUNT; q++)
        fit->floors[q] = fmax(NEPH_FIT_MODEL_ERROR * sqrt(sums[q] / (3 * fit->pixels->count)),
                              rounding);
}

/* Divide the weights of the pixels by the scales of their quantities, which are their residuals'
 * rms; outliers keep 0. */
static void scale_weights(struct neph_fit *fit)
{
    for (int i = 0; i < count_values(fit); i++)
        if (fit->weights[i] != 0.0)
            fit->weights[i] = fit->pixels->list[i / VALUES].weights[0][i % VALUES] /
                              fmax(fit->rms[quantity_of(i)], fit->floors[quantity_of(i)]);
}

static void start_weights(struct neph_fit *fit)
{
    for (int i = 0; i < count_values(fit); i++)
        fit->weights[i] = i / VALUES % fit->stride == 0
                              ? fit->pixels->list[i / VALUES].weights[0][i % VALUES]
                              : 0.0;
}

/* The residuals of a point, and per quantity their relative rms (0: it has no value). */
static enum neph_status measure(struct neph_fit *fit, const struct neph_fit_point *point,
                                double *residuals, double *rms, struct neph_diag *diag)
{
    const struct neph_fit_base base = neph_fit_scene_base();
    struct problem problem = {.fit = fit, .base = &base, .point = *point};
    const enum neph_status status = find_residuals(&problem, NULL, residuals, diag);
    int counts[NEPH_FIT_QUANTITY_COUNT] = {0};
    double sums[NEPH_FIT_QUANTITY_COUNT] = {0.0};
    for (int i = 0; i < count_values(fit) && !status; i++) {
        const double scale = fit->weights[i] == 0.0
                                 ? 0.0
                                 : fit->pixels->list[i / VALUES].weights[0][i % VALUES] /
                                       fit->weights[i];
        counts[quantity_of(i)] += fit->weights[i] != 0.0;
        sums[quantity_of(i)] += scale * scale * residuals[i] * residuals[i];
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
    for (int i = 0; i < count_values(fit); i++) {
        const double frame = fit->pixels->list[i / VALUES].values[0][i % VALUES];
        const double slope = fit->weights[i] * (scan->lit[i] - scan->dark[i]);
        const double value = quantity_of(i) == NEPH_FIT_RADIANCE
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
    struct problem problem = {.fit = fit, .base = &base};
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
        status = find_residuals(&problem, NULL, scan->residuals, diag);
    for (int i = 0; i < count_values(fit); i++)
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
    const size_t count = (size_t)count_residuals(fit);
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

/* Minus twice the logarithm of the likelihood, per value, for errors of unknown variances. */
static double find_misfit(const struct neph_fit *fit)
{
    double sum = 0.0;
    for (int q = 0; q < NEPH_FIT_QUANTITY_COUNT; q++)
        sum += fit->pixels->has[q] ? 2.0 * log(fmax(fit->rms[q], 1e-6)) : 0.0;
    return sum;
}

/* Fit all transfers, unless linear light explains the frame already. The result is that of the best
 * one. */
static enum neph_status fit_transfers(struct neph_fit *fit, double *residuals,
                                      struct neph_diag *diag)
{
    const double enough = 3.0 * NEPH_FIT_MODEL_ERROR;
    double least = INFINITY;
    enum neph_fit_transfer best = NEPH_FIT_LINEAR;
    enum neph_status status = NEPH_OK;
    int last = 0;
    for (int t = 0; t < NEPH_FIT_TRANSFER_COUNT && !status; t++) {
        fit->transfer_rms[t] = NAN;
        if (t > 0 && (!fit->pixels->has[NEPH_FIT_RADIANCE] || fit->transfer_rms[0] < enough))
            continue;
        fit->transfer = (enum neph_fit_transfer)t;
        status = fit_transfer(fit, residuals, diag);
        fit->transfer_rms[t] = fit->rms[NEPH_FIT_RADIANCE];
        last = t;
        if (find_misfit(fit) < least) {
            least = find_misfit(fit);
            best = fit->transfer;
        }
    }
    if (status || last == (int)best)
        return status;
    fit->transfer = best;
    return fit_transfer(fit, residuals, diag);
}

/* ---- outliers -------------------------------------------------------------------------------- */

/* The spread of the residuals of a quantity: 1.4826 times the median of their absolute values. */
static double find_spread(const struct neph_fit *fit, const double *residuals, int quantity,
                          double *room)
{
    size_t count = 0;
    for (int i = 0; i < count_values(fit); i++)
        if (quantity_of(i) == quantity && fit->weights[i] != 0.0)
            room[count++] = fabs(residuals[i]);
    neph_sort_doubles(room, count);
    return count ? 1.4826 * room[count / 2] : INFINITY;
}

/* How far each pixel is from the others: the largest of its residuals, in spreads. */
static enum neph_status find_scores(const struct neph_fit *fit, const double *residuals,
                                    double *scores, struct neph_diag *diag)
{
    double spreads[NEPH_FIT_QUANTITY_COUNT];
    double *room = malloc((size_t)count_values(fit) * sizeof(*room));
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

/* ---- intervals ------------------------------------------------------------------------------- */

struct errors {
    /* Without what the data do not determine, and for residuals of variance 1; 0 of what is fixed. */
    double inverse[UNKNOWNS][UNKNOWNS];
    double undetermined[UNKNOWNS][UNKNOWNS];     /* covariance of directions without influence */
    double tiles[NEPH_FIT_TILE_COUNT][UNKNOWNS]; /* by how much the residuals of a tile move it */
    double *shifts[UNKNOWNS];                    /* by how much each value moves an unknown */
    double variance;                             /* of a residual */
};

/* Add v v^T / value, and the prior's variance along v of a value that is 0 by the precision of the
 * slopes. */
static void add_direction(const struct problem *problem, const double *vector, double value,
                          struct errors *errors)
{
    const double least = 1e-9;
    double length = 0.0;
    for (int k = 0; k < problem->count; k++)
        length += vector[k] * vector[k];
    for (int k = 0; k < problem->count; k++)
        for (int l = 0; l < problem->count; l++) {
            const int row = problem->unknowns[k], column = problem->unknowns[l];
            if (value > least)
                errors->inverse[row][column] += vector[k] * vector[l] / value;
            else
                errors->undetermined[row][column] += vector[k] * vector[l] / length *
                                                     prior_deviation * prior_deviation;
        }
}

/* The inverse of the normal matrix by its eigenvectors, after scaling to a diagonal of 1. */
static void invert(const struct neph_fit *fit, double *const *slopes, const struct problem *problem,
                   struct errors *errors)
{
    double matrix[NEPH_UNKNOWNS_MAX][NEPH_UNKNOWNS_MAX], scale[UNKNOWNS];
    double values[NEPH_UNKNOWNS_MAX], vectors[NEPH_UNKNOWNS_MAX][NEPH_UNKNOWNS_MAX];
    for (int k = 0; k < problem->count; k++)
        for (int l = 0; l < problem->count; l++) {
            matrix[k][l] = 0.0;
            for (int i = 0; i < count_values(fit); i++)
                matrix[k][l] += slopes[k][i] * slopes[l][i];
        }
    for (int k = 0; k < problem->count; k++)
        scale[k] = matrix[k][k] > 0.0 ? 1.0 / sqrt(matrix[k][k]) : 1.0;
    for (int k = 0; k < problem->count; k++)
        for (int l = 0; l < problem->count; l++)
            matrix[k][l] *= scale[k] * scale[l];
    neph_symmetric_eigen(problem->count, matrix, values, vectors);
    for (int i = 0; i < problem->count; i++) {
        for (int k = 0; k < problem->count; k++)
            vectors[i][k] *= scale[k];
        add_direction(problem, vectors[i], values[i], errors);
    }
}

static void find_shifts(const struct neph_fit *fit, double *const *slopes,
                        const struct problem *problem, const double *residuals,
                        struct errors *errors)
{
    for (int i = 0; i < count_values(fit); i++)
        for (int k = 0; k < problem->count; k++) {
            const int unknown = problem->unknowns[k];
            double shift = 0.0;
            for (int l = 0; l < problem->count; l++)
                shift += errors->inverse[unknown][problem->unknowns[l]] * slopes[l][i];
            errors->shifts[unknown][i] = shift;
            errors->tiles[fit->pixels->list[i / VALUES].tile][unknown] += shift * residuals[i];
        }
}

/* The variance of a sum of unknowns by two relative errors up to NEPH_FIT_MODEL_ERROR of a quantity:
 * one of all values, and one of all in a tile. */
static double find_model_variance(const struct neph_fit *fit, const struct errors *errors,
                                  const double factors[UNKNOWNS])
{
    double moved[NEPH_FIT_TILE_COUNT][NEPH_FIT_QUANTITY_COUNT] = {{0.0}}, sum = 0.0;
    for (int i = 0; i < count_values(fit); i++) {
        const struct neph_fit_pixel *pixel = &fit->pixels->list[i / VALUES];
        double shift = 0.0;
        for (int k = 0; k < UNKNOWNS; k++)
            shift += factors[k] * errors->shifts[k][i];
        moved[pixel->tile][quantity_of(i)] += shift * fit->weights[i] *
                                              find_sensitivity(pixel->values[0][i % VALUES],
                                                               quantity_of(i));
    }
    for (int q = 0; q < NEPH_FIT_QUANTITY_COUNT; q++) {
        double all = 0.0;
        for (int t = 0; t < NEPH_FIT_TILE_COUNT; t++) {
            all += moved[t][q];
            sum += moved[t][q] * moved[t][q];
        }
        sum += all * all;
    }
    return sum * NEPH_FIT_MODEL_ERROR * NEPH_FIT_MODEL_ERROR / 3.0;
}

/* The estimate of a sum of unknowns. The variance by residuals is the larger of two: of independent
 * residuals, and of residuals that are correlated within tiles. */
static struct neph_fit_estimate estimate(const struct neph_fit *fit, const struct errors *errors,
                                         const struct neph_fit_point *point,
                                         const double factors[UNKNOWNS], bool is_factor)
{
    double value = 0.0, variance = 0.0, tiles = 0.0, undetermined = 0.0;
    for (int k = 0; k < UNKNOWNS; k++) {
        value += factors[k] * point->x[k];
        for (int l = 0; l < UNKNOWNS; l++) {
            variance += factors[k] * factors[l] * errors->inverse[k][l] * errors->variance;
            undetermined += factors[k] * factors[l] * errors->undetermined[k][l];
        }
    }
    for (int t = 0; t < NEPH_FIT_TILE_COUNT; t++) {
        double shift = 0.0;
        for (int k = 0; k < UNKNOWNS; k++)
            shift += factors[k] * errors->tiles[t][k];
        tiles += shift * shift;
    }
    variance = fmax(variance, tiles) + find_model_variance(fit, errors, factors) + undetermined;
    const double half = normal_95 * sqrt(variance);
    if (!is_factor)
        return (struct neph_fit_estimate){value, value - half, value + half, true,
                                          2.0 * half <= NEPH_FIT_WIDEST_ASYMMETRY};
    return (struct neph_fit_estimate){exp(value), exp(value - half), exp(value + half), true,
                                      2.0 * half <= log(NEPH_FIT_WIDEST_FACTOR)};
}

/* By how much more the residuals move the unknowns than independent ones would. */
static double find_inflation(const struct errors *errors)
{
    double inflation = 1.0;
    for (int k = 0; k < UNKNOWNS; k++) {
        double tiles = 0.0;
        for (int t = 0; t < NEPH_FIT_TILE_COUNT; t++)
            tiles += errors->tiles[t][k] * errors->tiles[t][k];
        if (errors->inverse[k][k] > 0.0)
            inflation = fmax(inflation, tiles / (errors->inverse[k][k] * errors->variance));
    }
    return fmin(inflation, 100.0);
}

static void fill_estimates(const struct neph_fit *fit, const struct problem *problem,
                           const struct errors *errors, struct neph_fit_estimates *estimates)
{
    static const double product[UNKNOWNS] = {[NEPH_FIT_EXTINCTION] = 1.0, [NEPH_FIT_ALBEDO] = 1.0};
    for (int k = 0; k < UNKNOWNS; k++) {
        const double x = estimates->point.x[k], own = k == NEPH_FIT_ASYMMETRY ? x : exp(x);
        estimates->list[k] = (struct neph_fit_estimate){own, own, own, false, true};
    }
    for (int i = 0; i < problem->count; i++) {
        const int k = problem->unknowns[i];
        double one[UNKNOWNS] = {0.0};
        one[k] = 1.0;
        estimates->list[k] = estimate(fit, errors, &estimates->point, one, k != NEPH_FIT_ASYMMETRY);
    }
    estimates->scattering = estimate(fit, errors, &estimates->point, product, true);
    estimates->noise = find_inflation(errors) * errors->variance;
}

/* The variance of a residual; at least that by the rounding of floats. */
static double find_variance(const struct neph_fit *fit, const struct problem *problem,
                            double squares)
{
    int count = 0;
    for (int i = 0; i < count_values(fit); i++)
        count += fit->weights[i] != 0.0;
    return fmax(squares / fmax(count - problem->count, 1.0), 1e-8);
}

/* Intervals of the unknowns that are free within the range, for the point and the squares of
 * `estimates`. */
static enum neph_status find_intervals(struct neph_fit *fit, const struct neph_fit_range *range,
                                       struct neph_fit_estimates *estimates, struct neph_diag *diag)
{
    const struct neph_fit_base base = neph_fit_scene_base();
    struct problem problem = {.fit = fit, .base = &base, .point = estimates->point};
    struct neph_arena arena = {.last = NULL};
    struct errors *errors = neph_arena_allocate(&arena, 1, sizeof(*errors));
    const size_t count = (size_t)count_residuals(fit);
    double *residuals = neph_arena_allocate(&arena, count, sizeof(double)), x[UNKNOWNS];
    double *slopes[UNKNOWNS];
    for (int k = 0; k < UNKNOWNS; k++) {
        slopes[k] = neph_arena_allocate(&arena, count, sizeof(double));
        if (errors)
            errors->shifts[k] = neph_arena_allocate(&arena, count, sizeof(double));
        if (range->low.x[k] < range->high.x[k]) {
            x[problem.count] = estimates->point.x[k];
            problem.unknowns[problem.count++] = k;
        }
    }
    enum neph_status status = neph_arena_check(&arena, diag);
    if (!status)
        status = find_residuals(&problem, x, residuals, diag);
    if (!status)
        status = find_slopes(&problem, x, residuals, slopes, diag);
    if (!status) {
        errors->variance = find_variance(fit, &problem, estimates->squares);
        invert(fit, slopes, &problem, errors);
        find_shifts(fit, slopes, &problem, residuals, errors);
        fill_estimates(fit, &problem, errors, estimates);
    }
    neph_arena_finish(&arena);
    return status;
}

/* ---- what is not determined ------------------------------------------------------------------ */

/* Hold an unknown that is not determined at the scene's value, if that explains the frame as well. */
static enum neph_status hold(struct neph_fit *fit, int unknown, struct neph_fit_range *range,
                             struct neph_diag *diag)
{
    const struct neph_fit_base base = neph_fit_scene_base();
    const double own = neph_fit_scene_point(fit->scene).x[unknown];
    struct neph_fit_range narrow = *range;
    struct neph_fit_estimates held = fit->held;
    if (!held.list[unknown].is_free || held.list[unknown].is_determined)
        return NEPH_OK;
    narrow.low.x[unknown] = narrow.high.x[unknown] = own;
    enum neph_status status = neph_fit_minimise(fit, &base, &narrow, 0.0, &held.point,
                                                &held.squares, diag);
    if (status || held.squares > neph_fit_limit(fit, 1))
        return status;
    status = find_intervals(fit, &narrow, &held, diag);
    fit->held = held;
    fit->is_held[unknown] = true;
    *range = narrow;
    return status;
}

/* The largest (smallest, if `step` < 0) extinction that explains the frame as well: by steps of a
 * factor, then by bisection. */
static enum neph_status find_extinction_end(struct neph_fit *fit,
                                            const struct neph_fit_range *range, double step,
                                            double *end, struct neph_diag *diag)
{
    enum { STEPS = 6, BISECTIONS = 3 };
    const struct neph_fit_base base = neph_fit_scene_base();
    const double limit = neph_fit_limit(fit, 1);
    struct neph_fit_point point = fit->held.point;
    double good = point.x[NEPH_FIT_EXTINCTION];
    for (int i = 0; i < STEPS + BISECTIONS; i++) {
        struct neph_fit_range at = *range;
        struct neph_fit_point other = point;
        double squares;
        at.low.x[NEPH_FIT_EXTINCTION] = at.high.x[NEPH_FIT_EXTINCTION] = good + step;
        const enum neph_status status = neph_fit_minimise(fit, &base, &at, limit, &other, &squares,
                                                          diag);
        if (status)
            return status;
        if (squares > limit) {
            i = i < STEPS ? STEPS - 1 : i; /* from here on bisect */
            step *= 0.5;
            continue;
        }
        good += step;
        point = other;
        if (i == STEPS - 1) {
            *end = step > 0.0 ? INFINITY : 0.0;
            return NEPH_OK;
        }
    }
    *end = exp(good);
    return NEPH_OK;
}

static enum neph_status find_held(struct neph_fit *fit, struct neph_diag *diag)
{
    static const int order[] = {NEPH_FIT_FALLOFF, NEPH_FIT_ASYMMETRY, NEPH_FIT_ALBEDO};
    struct neph_fit_range range = neph_fit_whole_range(fit);
    enum neph_status status = NEPH_OK;
    fit->held = fit->best;
    for (size_t i = 0; i < sizeof(order) / sizeof(order[0]) && !status; i++)
        status = hold(fit, order[i], &range, diag);
    const struct neph_fit_estimate *extinction = &fit->held.list[NEPH_FIT_EXTINCTION];
    fit->extinction_min = extinction->low;
    fit->extinction_max = extinction->high;
    if (status || extinction->is_determined)
        return status;
    status = find_extinction_end(fit, &range, 1.5, &fit->extinction_max, diag);
    return status ? status : find_extinction_end(fit, &range, -1.5, &fit->extinction_min, diag);
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
        status = find_intervals(fit, &range, &fit->best, diag);
    return status ? status : find_held(fit, diag);
}

enum neph_status neph_fit_solve(struct neph_fit *fit, struct neph_diag *diag)
{
    const size_t count = (size_t)count_residuals(fit);
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
