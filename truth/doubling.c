/* SPDX-License-Identifier: MIT
 *
 * At quadrature nodes the transfer equation of one mode is linear with constant coefficients:
 *   d up / d tau = G up - B down,  d down / d tau = B up - G down,
 *   G = (1 - albedo/2 P_same W) / mu,  B = albedo/2 P_other W / mu.
 * Reflection and transmission of a thin layer follow from the exponential of that matrix. With s =
 * up + down, d = up - down the system becomes s' = X d, d' = Y s, X = G + B, Y = G - B, and the
 * exponential becomes power series of X Y and Y X. The thick layer is doubled from the thin one
 * (van de Hulst 1963; Hansen 1971; de Haan, Bosma, Hovenier 1987, section 4).
 *
 * Why an exponential and not single scattering in an extremely thin layer: each doubling doubles
 * the rounding error of the thinner layer's direct light, 1e-16. A layer with half the smallest
 * cosine as its depth needs few doublings.
 */
#include "truth/doubling.h"

#include "scenes/media.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The thin layer's optical depth over the smallest cosine. The norm of X Y is then below 1 per
 * square of the depth, and POWER_COUNT terms leave 1 / 20! = 4e-19. */
static const double thin_per_cosine = 0.5;

enum { POWER_COUNT = 10 };

/* Storage of operators; some are reused. */
enum {
    X,
    Y,
    PRODUCT,
    COSH_XY,
    COSH_YX,
    ODD,
    SINH_XY,
    SINH_YX,
    SCRATCH,
    SCRATCH_2,
    REFLECTION,
    TRANSMISSION,
    OPERATOR_COUNT,
    DIVISOR = PRODUCT,
    AGAIN = X,
    DOWN = COSH_XY,
    UP = COSH_YX,
    NEXT = ODD,
};

/* out_i = diagonal_i in_i + sum_j kernel_ij w_j in_j: direct light, and scattered light. They are
 * separate, because directions of weight 0 have no column in a matrix that includes the weights.
 * The diagonal is stored twice, for the directions of rows and of columns. */
struct transfer {
    double *row_diagonal, *column_diagonal, *kernel;
};

struct solver {
    const struct neph_doubling *layer;
    size_t nodes, rows, columns;
    double *memory;                            /* owned; contains all of the following */
    double *row_legendre, *column_legendre;    /* [direction][l - mode]; rows times (2l+1) moment */
    double *matrix;                            /* nodes * nodes, for solve() */
    struct transfer operators[OPERATOR_COUNT]; /* each: consecutive diagonals and kernel */
};

static size_t operator_size(const struct solver *solver)
{
    return solver->rows + solver->columns + solver->rows * solver->columns;
}

static enum neph_status solver_init(struct solver *solver, const struct neph_doubling *layer,
                                    struct neph_diag *diag)
{
    *solver = (struct solver){.layer = layer,
                              .nodes = (size_t)layer->node_count,
                              .rows = (size_t)(layer->node_count + layer->view_count),
                              .columns = (size_t)layer->node_count + 1};
    const size_t moments = (size_t)layer->moment_count, size = operator_size(solver);
    const size_t legendre_size = (solver->rows + solver->columns) * moments;
    solver->memory = calloc(legendre_size + solver->nodes * solver->nodes + OPERATOR_COUNT * size,
                            sizeof(double));
    if (!solver->memory)
        return neph_fail_memory(diag);
    solver->row_legendre = solver->memory;
    solver->column_legendre = solver->row_legendre + solver->rows * moments;
    solver->matrix = solver->memory + legendre_size;
    double *next = solver->matrix + solver->nodes * solver->nodes;
    for (int i = 0; i < OPERATOR_COUNT; i++, next += size)
        solver->operators[i] = (struct transfer){next, next + solver->rows,
                                                 next + solver->rows + solver->columns};
    return NEPH_OK;
}

/* ---- the algebra ---- */

/* out = a W b, of kernels only. */
static void fold(const struct solver *solver, const double *a, const double *b, double *out)
{
    const size_t columns = solver->columns;
    memset(out, 0, solver->rows * columns * sizeof(*out));
    for (size_t i = 0; i < solver->rows; i++) {
        double *restrict out_row = out + i * columns;
        for (size_t j = 0; j < solver->nodes; j++) {
            const double factor = a[i * columns + j] * solver->layer->node_weights[j];
            const double *restrict b_row = b + j * columns;
            for (size_t k = 0; k < columns; k++)
                out_row[k] += factor * b_row[k];
        }
    }
}

/* out = a b. */
static void multiply(const struct solver *solver, const struct transfer *a,
                     const struct transfer *b, struct transfer *out)
{
    const size_t columns = solver->columns;
    fold(solver, a->kernel, b->kernel, out->kernel);
    for (size_t i = 0; i < solver->rows; i++)
        for (size_t k = 0; k < columns; k++)
            out->kernel[i * columns + k] += a->row_diagonal[i] * b->kernel[i * columns + k] +
                                            a->kernel[i * columns + k] * b->column_diagonal[k];
    for (size_t i = 0; i < solver->rows; i++)
        out->row_diagonal[i] = a->row_diagonal[i] * b->row_diagonal[i];
    for (size_t k = 0; k < columns; k++)
        out->column_diagonal[k] = a->column_diagonal[k] * b->column_diagonal[k];
}

/* out += factor a. Diagonals and kernel are consecutive. */
static void accumulate(const struct solver *solver, double factor, const struct transfer *a,
                       struct transfer *out)
{
    for (size_t i = 0; i < operator_size(solver); i++)
        out->row_diagonal[i] += factor * a->row_diagonal[i];
}

static void set_zero(const struct solver *solver, struct transfer *out)
{
    memset(out->row_diagonal, 0, operator_size(solver) * sizeof(double));
}

static void set_identity(const struct solver *solver, struct transfer *out)
{
    set_zero(solver, out);
    for (size_t i = 0; i < solver->rows + solver->columns; i++)
        out->row_diagonal[i] = 1.0;
}

/* cosh(sqrt(z) t) and sinh(sqrt(z) t) / sqrt(z), as power series. */
static void hyperbolic(const struct solver *solver, const struct transfer *z, double t,
                       struct transfer *even, struct transfer *odd, struct transfer *power,
                       struct transfer *next)
{
    set_zero(solver, even);
    set_zero(solver, odd);
    set_identity(solver, power);
    double term = 1.0; /* t^2k / (2k)! */
    for (int k = 0; k < POWER_COUNT; k++) {
        accumulate(solver, term, power, even);
        accumulate(solver, term * t / (2 * k + 1), power, odd);
        term *= t * t / ((2 * k + 1) * (2 * k + 2));
        multiply(solver, power, z, next);
        struct transfer *swap = power;
        power = next;
        next = swap;
    }
}

static void swap_rows(double *a, double *b, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        const double swap = a[k];
        a[k] = b[k];
        b[k] = swap;
    }
}

/* row -= factor * other */
static void eliminate(double *restrict row, const double *restrict other, double factor,
                      size_t count)
{
    for (size_t k = 0; k < count; k++)
        row[k] -= factor * other[k];
}

/* Solve matrix x = right in place, n x n and n x m: Gaussian elimination with partial pivoting. The
 * matrix is destroyed. */
static void solve(double *matrix, double *right, size_t n, size_t m)
{
    for (size_t p = 0; p < n; p++) {
        size_t best = p;
        for (size_t i = p + 1; i < n; i++)
            if (fabs(matrix[i * n + p]) > fabs(matrix[best * n + p]))
                best = i;
        if (best != p) {
            swap_rows(matrix + p * n, matrix + best * n, n);
            swap_rows(right + p * m, right + best * m, m);
        }
        for (size_t i = p + 1; i < n; i++) {
            const double factor = matrix[i * n + p] / matrix[p * n + p];
            eliminate(matrix + i * n + p, matrix + p * n + p, factor, n - p);
            eliminate(right + i * m, right + p * m, factor, m);
        }
    }
    for (size_t p = n; p-- > 0;) {
        for (size_t j = p + 1; j < n; j++)
            eliminate(right + p * m, right + j * m, matrix[p * n + j], m);
        for (size_t k = 0; k < m; k++)
            right[p * m + k] /= matrix[p * n + p];
    }
}

/* Divide from the left: solve (diagonal + kernel W) out = right, with kernels `right` and `out`
 * without a diagonal. The rows of the views follow from the rows of the nodes. */
static void divide(const struct solver *solver, const struct transfer *divisor, double *right)
{
    const size_t nodes = solver->nodes, columns = solver->columns;
    for (size_t i = 0; i < nodes; i++)
        for (size_t j = 0; j < nodes; j++)
            solver->matrix[i * nodes + j] = divisor->kernel[i * columns + j] *
                                                solver->layer->node_weights[j] +
                                            (i == j ? divisor->row_diagonal[i] : 0.0);
    solve(solver->matrix, right, nodes, columns);
    for (size_t i = nodes; i < solver->rows; i++) {
        double *row = right + i * columns;
        for (size_t j = 0; j < nodes; j++)
            eliminate(row, right + j * columns,
                      divisor->kernel[i * columns + j] * solver->layer->node_weights[j], columns);
        for (size_t k = 0; k < columns; k++)
            row[k] /= divisor->row_diagonal[i];
    }
}

/* ---- the phase function ---- */

/* Normalised associated Legendre functions sqrt((l-m)!/(l+m)!) P_l^m(x) into values[l - m]. */
static void legendre(int mode, int count, double x, double *values)
{
    const double sine = sqrt((1.0 - x) * (1.0 + x)), m2 = (double)mode * mode;
    double before = 0.0, now = 1.0;
    for (int k = 1; k <= mode; k++)
        now *= sine * sqrt((2.0 * k - 1.0) / (2.0 * k));
    for (int l = mode; l < count; l++) {
        values[l - mode] = now;
        const double next = ((2.0 * l + 1.0) * x * now - sqrt((double)l * l - m2) * before) /
                            sqrt((l + 1.0) * (l + 1.0) - m2);
        before = now;
        now = next;
    }
}

static void make_legendre(const struct solver *solver, int mode)
{
    const struct neph_doubling *layer = solver->layer;
    const size_t count = (size_t)layer->moment_count;
    for (size_t i = 0; i < solver->rows; i++) {
        double *values = solver->row_legendre + i * count;
        legendre(mode, layer->moment_count, layer->row_cosines[i], values);
        for (int l = mode; l < layer->moment_count; l++)
            values[l - mode] *= (2.0 * l + 1.0) * layer->moments[l];
    }
    for (size_t k = 0; k < solver->columns; k++)
        legendre(mode, layer->moment_count, layer->column_cosines[k],
                 solver->column_legendre + k * count);
}

/* The terms of the phase function with even and with odd l - m. Within a hemisphere the phase
 * function is their sum, between the hemispheres their difference. */
static void phase_parts(const struct solver *solver, int mode, size_t row, size_t column,
                        double *even, double *odd)
{
    const size_t count = (size_t)solver->layer->moment_count;
    const double *a = solver->row_legendre + row * count;
    const double *b = solver->column_legendre + column * count;
    double sum[2] = {0.0, 0.0};
    for (int l = 0; l < solver->layer->moment_count - mode; l++)
        sum[l % 2] += a[l] * b[l];
    *even = sum[0];
    *odd = sum[1];
}

/* X and Y of this file's first comment. */
static void make_generator(const struct solver *solver, int mode, struct transfer *x,
                           struct transfer *y)
{
    const struct neph_doubling *layer = solver->layer;
    for (size_t i = 0; i < solver->rows; i++) {
        x->row_diagonal[i] = y->row_diagonal[i] = 1.0 / layer->row_cosines[i];
        for (size_t k = 0; k < solver->columns; k++) {
            double even, odd;
            phase_parts(solver, mode, i, k, &even, &odd);
            const double scale = -layer->albedo / layer->row_cosines[i];
            x->kernel[i * solver->columns + k] = scale * odd;
            y->kernel[i * solver->columns + k] = scale * even;
        }
    }
    for (size_t k = 0; k < solver->columns; k++)
        x->column_diagonal[k] = y->column_diagonal[k] = 1.0 / layer->column_cosines[k];
}

/* ---- the thin layer ---- */

/* out = the sum of the four hyperbolic functions with these factors. */
static void combine(struct solver *solver, double cosh_xy, double cosh_yx, double sinh_xy,
                    double sinh_yx, struct transfer *out)
{
    set_zero(solver, out);
    accumulate(solver, cosh_xy, &solver->operators[COSH_XY], out);
    accumulate(solver, cosh_yx, &solver->operators[COSH_YX], out);
    accumulate(solver, sinh_xy, &solver->operators[SINH_XY], out);
    accumulate(solver, sinh_yx, &solver->operators[SINH_YX], out);
}

/* Without light from below, s(0) = R + 1, d(0) = R - 1, s(t) = T = -d(t):
 *   (C + D + S + S') R = D + S - C - S',   T = (C - S) + (C + S) R,
 * C = cosh of X Y, D of Y X, S = sinh / sqrt of X Y, times X; S' is the same of Y X, times Y. */
static void thin_layer(struct solver *solver, int mode, double t)
{
    struct transfer *o = solver->operators;
    make_generator(solver, mode, &o[X], &o[Y]);
    multiply(solver, &o[X], &o[Y], &o[PRODUCT]);
    hyperbolic(solver, &o[PRODUCT], t, &o[COSH_XY], &o[ODD], &o[SCRATCH], &o[SCRATCH_2]);
    multiply(solver, &o[ODD], &o[X], &o[SINH_XY]);
    multiply(solver, &o[Y], &o[X], &o[PRODUCT]);
    hyperbolic(solver, &o[PRODUCT], t, &o[COSH_YX], &o[ODD], &o[SCRATCH], &o[SCRATCH_2]);
    multiply(solver, &o[ODD], &o[Y], &o[SINH_YX]);

    combine(solver, 1, 1, 1, 1, &o[DIVISOR]);
    combine(solver, -1, 1, 1, -1, &o[REFLECTION]);
    divide(solver, &o[DIVISOR], o[REFLECTION].kernel);
    /* The diagonal, cosh - cosh + sinh - sinh, is 0. */
    for (size_t i = 0; i < solver->rows + solver->columns; i++)
        o[REFLECTION].row_diagonal[i] = 0.0;
    combine(solver, 1, 0, 1, 0, &o[SCRATCH]);
    multiply(solver, &o[SCRATCH], &o[REFLECTION], &o[TRANSMISSION]);
    combine(solver, 1, 0, -1, 0, &o[SCRATCH]);
    accumulate(solver, 1.0, &o[SCRATCH], &o[TRANSMISSION]);
}

/* ---- doubling ---- */

/* Set the exact direct transmission of an optical depth t: the diagonal of the transmission. */
static void set_direct(struct solver *solver, double t)
{
    const struct transfer *transmission = &solver->operators[TRANSMISSION];
    for (size_t i = 0; i < solver->rows; i++)
        transmission->row_diagonal[i] = exp(-t / solver->layer->row_cosines[i]);
    for (size_t k = 0; k < solver->columns; k++)
        transmission->column_diagonal[k] = exp(-t / solver->layer->column_cosines[k]);
}

static void negate(const struct solver *solver, const double *kernel, double *out)
{
    for (size_t at = 0; at < solver->rows * solver->columns; at++)
        out[at] = -kernel[at];
}

/* Two equal layers: DOWN is the light onto the lower one, after any number of reflections between
 * them; UP is its reflection there. With AGAIN = (1 - R R)^-1,
 *   DOWN = AGAIN T,  UP = R DOWN,  R' = R + T UP,  T' = T DOWN. */
static void double_layer(struct solver *solver)
{
    struct transfer *o = solver->operators;
    fold(solver, o[REFLECTION].kernel, o[REFLECTION].kernel, o[NEXT].kernel);
    set_identity(solver, &o[DIVISOR]);
    negate(solver, o[NEXT].kernel, o[DIVISOR].kernel);
    set_identity(solver, &o[AGAIN]);
    memcpy(o[AGAIN].kernel, o[NEXT].kernel, solver->rows * solver->columns * sizeof(double));
    divide(solver, &o[DIVISOR], o[AGAIN].kernel); /* (1 - RR)^-1 = 1 + (1 - RR)^-1 RR */

    multiply(solver, &o[AGAIN], &o[TRANSMISSION], &o[DOWN]);
    multiply(solver, &o[REFLECTION], &o[DOWN], &o[UP]);
    multiply(solver, &o[TRANSMISSION], &o[UP], &o[NEXT]);
    accumulate(solver, 1.0, &o[NEXT], &o[REFLECTION]);
    multiply(solver, &o[TRANSMISSION], &o[DOWN], &o[NEXT]);
    const struct transfer transmission = o[TRANSMISSION];
    o[TRANSMISSION] = o[NEXT];
    o[NEXT] = transmission;
}

static double smallest_cosine(const struct neph_doubling *layer)
{
    double smallest = 1.0;
    for (int i = 0; i < layer->node_count + layer->view_count; i++)
        smallest = fmin(smallest, layer->row_cosines[i]);
    return fmin(smallest, layer->column_cosines[layer->node_count]);
}

/* ---- the mode ---- */

double neph_once_up(double optical_depth, double view_cosine, double sun_cosine)
{
    return sun_cosine / (view_cosine + sun_cosine) *
           -expm1(-optical_depth * (1.0 / view_cosine + 1.0 / sun_cosine));
}

double neph_once_down(double optical_depth, double view_cosine, double sun_cosine)
{
    /* The larger exponential is factored out, so that phi stays in (0, 1]. */
    const double difference = optical_depth * fabs(1.0 / view_cosine - 1.0 / sun_cosine);
    return optical_depth / view_cosine * exp(-optical_depth / fmax(view_cosine, sun_cosine)) *
           neph_phi(difference);
}

static void first_order(const struct solver *solver, int mode,
                        const struct neph_doubling_light *light)
{
    const struct neph_doubling *layer = solver->layer;
    const double sun_cosine = layer->column_cosines[solver->nodes];
    for (size_t i = 0; i < solver->rows; i++) {
        const double cosine = layer->row_cosines[i], factor = 0.5 * layer->albedo;
        double even, odd;
        phase_parts(solver, mode, i, solver->nodes, &even, &odd);
        light->once_up[i] = factor * (even - odd) *
                            neph_once_up(layer->optical_depth, cosine, sun_cosine);
        light->once_down[i] = factor * (even + odd) *
                              neph_once_down(layer->optical_depth, cosine, sun_cosine);
    }
}

enum neph_status neph_doubling_mode(const struct neph_doubling *layer, int mode,
                                    const struct neph_doubling_light *light, struct neph_diag *diag)
{
    struct solver solver;
    const enum neph_status status = solver_init(&solver, layer, diag);
    if (status)
        return status;
    make_legendre(&solver, mode);
    const double thin = thin_per_cosine * smallest_cosine(layer);
    const int doublings = layer->optical_depth > thin ? (int)ceil(log2(layer->optical_depth / thin))
                                                      : 0;
    thin_layer(&solver, mode, ldexp(layer->optical_depth, -doublings));
    for (int i = doublings; i > 0; i--) {
        set_direct(&solver, ldexp(layer->optical_depth, -i));
        double_layer(&solver);
    }
    for (size_t i = 0; i < solver.rows; i++) {
        const size_t sun = i * solver.columns + solver.nodes;
        light->up[i] = solver.operators[REFLECTION].kernel[sun];
        light->down[i] = solver.operators[TRANSMISSION].kernel[sun];
    }
    first_order(&solver, mode, light);
    free(solver.memory);
    return NEPH_OK;
}

/* ---- nodes ---- */

void neph_gauss_legendre(int count, double *nodes, double *weights)
{
    for (int i = 0; i < count; i++) {
        double x = cos(M_PI * (count - i - 0.25) / (count + 0.5)), slope = 1.0;
        for (int step = 0; step < 100; step++) { /* Newton; 4 to 6 steps do */
            double before = 1.0, now = x;
            for (int l = 1; l < count; l++) {
                const double next = ((2 * l + 1) * x * now - l * before) / (l + 1);
                before = now;
                now = next;
            }
            slope = count * (x * now - before) / (x * x - 1.0);
            x -= now / slope;
            if (fabs(now / slope) < 1e-16)
                break;
        }
        nodes[i] = 0.5 * (1.0 + x);
        weights[i] = 1.0 / ((1.0 - x) * (1.0 + x) * slope * slope);
    }
}
