/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/cycle_tableau.h"

#include "metrics/vector_math.h"

#include <math.h>
#include <stdlib.h>

/* A 2x2 block, row by row. */
struct block {
    double v[4];
};

static size_t column_count(const struct neph_cycle_tableau *tableau)
{
    return 2 * (size_t)tableau->wave_count;
}

static struct block copy_wave_block(const struct neph_cycle_tableau *tableau, const double *matrix,
                                    int wave)
{
    const size_t n = column_count(tableau), i = 2 * (size_t)wave;
    const double *row = matrix + i * n + i;
    return (struct block){{row[0], row[1], row[n], row[n + 1]}};
}

/* The inverse of a block; a wave without a sine has a 1x1 block. */
static struct block inverse(struct block b)
{
    if (b.v[3] == 0.0)
        return (struct block){{1.0 / b.v[0], 0.0, 0.0, 0.0}};
    const double determinant = b.v[0] * b.v[3] - b.v[1] * b.v[2];
    return (struct block){
        {b.v[3] / determinant, -b.v[1] / determinant, -b.v[2] / determinant, b.v[0] / determinant}};
}

/* ---- set-up ---------------------------------------------------------------------------------- */

static void fill_waves(const double *per_frame, int count, int window_count, int frame_count,
                       double *waves)
{
    const size_t n = (size_t)frame_count;
    for (size_t t = 0; t < n; t++) {
        waves[t] = 1.0;
        waves[n + t] = (2.0 * (double)t + 1.0) / (double)frame_count - 1.0;
    }
    for (int i = 0; i < count; i++)
        for (size_t t = 0; t < n; t++) {
            double *wave = waves + 2 * ((size_t)i + 1) * n;
            const double turns = fmod(per_frame[i] * (double)t, 1.0);
            const double hann = 1.0 - cos(2.0 * M_PI * (double)t / (double)n);
            const double window = i < count - window_count ? 1.0 : hann;
            wave[t] = window * cos(2.0 * M_PI * turns);
            wave[n + t] = per_frame[i] < 0.5 ? window * sin(2.0 * M_PI * turns) : 0.0;
        }
}

NEPH_VECTOR
static double dot(const double *restrict a, const double *restrict b, size_t count)
{
    enum { LANES = 8 };
    double lanes[LANES] = {0.0}, sum = 0.0;
    size_t i = 0;
    for (; i + LANES <= count; i += LANES)
        for (size_t l = 0; l < LANES; l++)
            lanes[l] += a[i + l] * b[i + l];
    for (; i < count; i++)
        lanes[0] += a[i] * b[i];
    for (size_t l = 0; l < LANES; l++)
        sum += lanes[l];
    return sum;
}

/* Symmetric matrix of the dot products of `left` and `right`, `n` rows of `length` values each. */
static void multiply(const double *left, const double *right, size_t n, size_t length,
                     double *products)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j <= i; j++)
            products[i * n + j] = products[j * n + i] = dot(left + i * length, right + j * length,
                                                            length);
}

enum neph_status neph_cycle_tableau_begin(struct neph_cycle_tableau *tableau, int frame_count,
                                          const double *moments, const double *per_frame, int count,
                                          int window_count, struct neph_arena *memory,
                                          struct neph_diag *diag)
{
    *tableau = (struct neph_cycle_tableau){.wave_count = count + 1, .frame_count = frame_count};
    const size_t n = column_count(tableau), length = (size_t)frame_count;
    double *waves = malloc(n * length * sizeof(*waves));
    double *moved = malloc(n * length * sizeof(*moved));
    tableau->inside = neph_arena_allocate(memory, (size_t)tableau->wave_count, sizeof(bool));
    tableau->wanted = neph_arena_allocate(memory, (size_t)tableau->wave_count, sizeof(bool));
    tableau->products = neph_arena_allocate(memory, n * n, sizeof(*tableau->products));
    tableau->moments = neph_arena_allocate(memory, n * n, sizeof(*tableau->moments));
    tableau->origin = neph_arena_allocate(memory, 2 * n * n, sizeof(*tableau->origin));
    tableau->scratch = neph_arena_allocate(memory, 8 * n, sizeof(*tableau->scratch));
    const bool made = waves && moved && !memory->is_short;
    if (made) {
        fill_waves(per_frame, count, window_count, frame_count, waves);
        for (size_t i = 0; i < n; i++)
            for (size_t t = 0; t < length; t++)
                moved[i * length + t] = dot(waves + i * length, moments + t * length, length);
        multiply(waves, waves, n, length, tableau->origin);
        multiply(moved, waves, n, length, tableau->origin + n * n);
        tableau->inside[0] = true;
        neph_cycle_tableau_refresh(tableau);
    }
    free(moved);
    free(waves);
    return made ? NEPH_OK : neph_fail_memory(diag);
}

/* ---- moving a wave into or out of the set
 * ------------------------------------------------------ */

/* row += x0 * a + x1 * b */
NEPH_VECTOR
static void add_two(double *restrict row, double x0, const double *restrict a, double x1,
                    const double *restrict b, size_t count)
{
    for (size_t i = 0; i < count; i++)
        row[i] += x0 * a[i] + x1 * b[i];
}

/* The vectors of one such step, `n` values each. */
struct turn {
    size_t n, at; /* number of columns, and first column of the wave */
    struct block d;
    double *a[2], *signed_a[2]; /* products with the wave, and the same with the sign of a pair */
    double *b[2];               /* the wave's coefficient in the change of each vector */
    double *t[2], *g[2];        /* moments with the wave, before and after */
};

static struct turn prepare_turn(struct neph_cycle_tableau *tableau, int wave)
{
    struct turn turn = {.n = column_count(tableau), .at = 2 * (size_t)wave};
    turn.d = inverse(copy_wave_block(tableau, tableau->products, wave));
    double *scratch = tableau->scratch;
    for (int c = 0; c < 2; c++, scratch += 4 * turn.n) {
        turn.signed_a[c] = scratch;
        turn.b[c] = scratch + turn.n;
        turn.t[c] = scratch + 2 * turn.n;
        turn.g[c] = scratch + 3 * turn.n;
        turn.a[c] = tableau->products + (turn.at + (size_t)c) * turn.n;
    }
    return turn;
}

/* Let v be the wave's residual and D the inverse of its block. Every other vector becomes v_j - a_j
 * D v; if the wave leaves the set, vectors outside become v_j + a_j D v. */
static void find_changes(const struct neph_cycle_tableau *tableau, int wave, struct turn *turn)
{
    const bool leaves = tableau->inside[wave];
    const double *d = turn->d.v;
    const struct block m = copy_wave_block(tableau, tableau->moments, wave);
    for (size_t k = 0; k < turn->n; k++) {
        const bool inside = tableau->inside[k / 2];
        const double sign = leaves && !inside ? 1.0 : -1.0, pair = inside != leaves ? 1.0 : -1.0;
        const double a0 = turn->a[0][k], a1 = turn->a[1][k];
        turn->b[0][k] = sign * (a0 * d[0] + a1 * d[2]);
        turn->b[1][k] = sign * (a0 * d[1] + a1 * d[3]);
        turn->signed_a[0][k] = pair * a0;
        turn->signed_a[1][k] = pair * a1;
        for (size_t c = 0; c < 2; c++) {
            turn->t[c][k] = tableau->moments[(turn->at + c) * turn->n + k];
            turn->g[c][k] = turn->t[c][k] + m.v[2 * c] * turn->b[0][k] +
                            m.v[2 * c + 1] * turn->b[1][k];
        }
    }
}

static void turn_others(struct neph_cycle_tableau *tableau, int wave, const struct turn *turn)
{
    const bool leaves = tableau->inside[wave];
    const double *d = turn->d.v;
    for (size_t j = 0; j < turn->n; j++) {
        if (j / 2 == (size_t)wave)
            continue;
        /* The change of two vectors on the other side of the step has the opposite sign. */
        const bool other = tableau->inside[j / 2] != leaves;
        double *const *a = other ? (double *const *)turn->signed_a : (double *const *)turn->a;
        const double sign = other ? 1.0 : -1.0;
        const double x0 = turn->a[0][j], x1 = turn->a[1][j];
        add_two(tableau->products + j * turn->n, sign * (x0 * d[0] + x1 * d[2]), a[0],
                sign * (x0 * d[1] + x1 * d[3]), a[1], turn->n);
        double *moments = tableau->moments + j * turn->n;
        add_two(moments, turn->b[0][j], turn->g[0], turn->b[1][j], turn->g[1], turn->n);
        add_two(moments, turn->t[0][j], turn->b[0], turn->t[1][j], turn->b[1], turn->n);
    }
}

static void set_pair(double *matrix, size_t n, size_t at, size_t k, const double *d, double x0,
                     double x1)
{
    matrix[at * n + k] = matrix[k * n + at] = d[0] * x0 + d[1] * x1;
    matrix[(at + 1) * n + k] = matrix[k * n + at + 1] = d[2] * x0 + d[3] * x1;
}

static struct block product(struct block a, struct block b)
{
    return (struct block){{a.v[0] * b.v[0] + a.v[1] * b.v[2], a.v[0] * b.v[1] + a.v[1] * b.v[3],
                           a.v[2] * b.v[0] + a.v[3] * b.v[2], a.v[2] * b.v[1] + a.v[3] * b.v[3]}};
}

static void set_block(double *matrix, size_t n, size_t at, struct block block)
{
    for (size_t c = 0; c < 4; c++)
        matrix[(at + c / 2) * n + at + c % 2] = block.v[c];
}

/* Update the rows and columns of the wave itself, last, because the others are computed from
 * them. */
static void turn_wave(struct neph_cycle_tableau *tableau, int wave, const struct turn *turn)
{
    const struct block moments = copy_wave_block(tableau, tableau->moments, wave);
    for (size_t k = 0; k < turn->n; k++) {
        if (k / 2 == (size_t)wave)
            continue;
        const double sign = tableau->inside[k / 2] ? -1.0 : 1.0;
        set_pair(tableau->products, turn->n, turn->at, k, turn->d.v, sign * turn->a[0][k],
                 sign * turn->a[1][k]);
        set_pair(tableau->moments, turn->n, turn->at, k, turn->d.v, turn->g[0][k], turn->g[1][k]);
    }
    set_block(tableau->products, turn->n, turn->at, turn->d);
    set_block(tableau->moments, turn->n, turn->at, product(product(turn->d, moments), turn->d));
}

void neph_cycle_tableau_toggle(struct neph_cycle_tableau *tableau, int wave)
{
    struct turn turn = prepare_turn(tableau, wave);
    find_changes(tableau, wave, &turn);
    turn_others(tableau, wave, &turn);
    turn_wave(tableau, wave, &turn);
    tableau->inside[wave] = !tableau->inside[wave];
}

void neph_cycle_tableau_refresh(struct neph_cycle_tableau *tableau)
{
    const size_t n = column_count(tableau);
    memcpy(tableau->products, tableau->origin, n * n * sizeof(*tableau->products));
    memcpy(tableau->moments, tableau->origin + n * n, n * n * sizeof(*tableau->moments));
    bool *wanted = tableau->wanted;
    memcpy(wanted, tableau->inside, (size_t)tableau->wave_count * sizeof(*wanted));
    memset(tableau->inside, 0, (size_t)tableau->wave_count * sizeof(*tableau->inside));
    for (int w = 0; w < tableau->wave_count; w++)
        if (wanted[w])
            neph_cycle_tableau_toggle(tableau, w);
}

/* ---- results
 * ----------------------------------------------------------------------------------- */

double neph_cycle_gain(const struct neph_cycle_tableau *tableau, int wave)
{
    const struct block d = inverse(copy_wave_block(tableau, tableau->products, wave));
    const struct block explained = product(d, copy_wave_block(tableau, tableau->moments, wave));
    return explained.v[0] + explained.v[3];
}

double neph_cycle_separation(const struct neph_cycle_tableau *tableau, int wave)
{
    const struct block own = copy_wave_block(tableau, tableau->products, wave);
    const struct block left = tableau->inside[wave] ? inverse(own) : own;
    if (left.v[3] == 0.0)
        return left.v[0] / (double)tableau->frame_count;
    const double half_trace = 0.5 * (left.v[0] + left.v[3]);
    const double half_gap = hypot(0.5 * (left.v[0] - left.v[3]), left.v[1]);
    return (half_trace - half_gap) / (0.5 * (double)tableau->frame_count);
}

void neph_cycle_coherence(const struct neph_cycle_tableau *tableau, int a, int b,
                          double coherence[4])
{
    const size_t n = column_count(tableau);
    for (size_t c = 0; c < 4; c++) {
        const size_t i = 2 * (size_t)a + c / 2, j = 2 * (size_t)b + c % 2;
        const double squares = tableau->moments[i * n + i] * tableau->moments[j * n + j];
        coherence[c] = squares > 0.0 ? tableau->moments[i * n + j] / sqrt(squares) : 0.0;
    }
}

int neph_cycle_dof(const struct neph_cycle_tableau *tableau, int wave)
{
    return copy_wave_block(tableau, tableau->products, wave).v[3] == 0.0 ? 1 : 2;
}
