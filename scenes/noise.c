/* SPDX-License-Identifier: MIT */
#include "scenes/noise.h"

#include <math.h>
#include <stdbool.h>

/* D. Stafford's "Mix13", the finaliser of splitmix64 (Steele, Lea, Flood, OOPSLA 2014). */
static uint64_t mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static int wrap(int cell, int period)
{
    const int remainder = cell % period;
    return remainder < 0 ? remainder + period : remainder;
}

/* Streams of random numbers; each use has its own. */
enum stream { STREAM_GRADIENT = 1, STREAM_POINT, STREAM_CALLER };

/* The hashes of a cube of cells (in 2 dimensions of a square), `side` cells along each axis from
 * `first` on; the last axis fastest. Cells with equal first coordinates share work. */
static void hash_cells(const struct neph_noise *noise, const int *first, int side, uint32_t stream,
                       uint64_t *hashes)
{
    int count = 1;
    hashes[0] = mix(noise->seed + 0x9e3779b97f4a7c15u * stream);
    for (int axis = 0; axis < noise->dimensions; axis++, count *= side)
        for (int i = count - 1; i >= 0; i--) /* in place, so backwards */
            for (int step = side - 1; step >= 0; step--)
                hashes[i * side + step] = mix(hashes[i] ^
                                              (uint64_t)wrap(first[axis] + step, noise->period));
}

double neph_noise_cell_random(const struct neph_noise *noise, const int *cell, uint32_t stream)
{
    uint64_t hash;
    hash_cells(noise, cell, 1, STREAM_CALLER + stream, &hash);
    return (double)(hash >> 32) * 0x1p-32;
}

/* --- rows ------------------------------------------------------------------------------------ */

enum { RUN = 16 };

/* Neighbouring points of a row in the same cell, which need the same hashes. */
struct run {
    int count; /* at most RUN */
    int cell[3];
    double along[RUN]; /* places within the cell, 0..1, along the row */
    double across[2];  /* place within the cell along the other axes; [1] is 0 in the plane */
};

/* The cell of a coordinate; `*inside` receives the place in it, 0..1. */
static int locate(double at, double *inside)
{
    const double low = floor(at);
    *inside = at - low;
    return (int)low;
}

/* The longest run that begins with point `first` of a row. The coordinates of the row are
 * multiplied by `scale`. */
static void find_run(const struct neph_noise *noise, const struct neph_noise_row *row, int first,
                     double scale, struct run *run)
{
    run->across[1] = 0.0;
    for (int axis = 1; axis < noise->dimensions; axis++)
        run->cell[axis] = locate(row->across[axis - 1] * scale, &run->across[axis - 1]);
    run->cell[0] = locate(row->along[first] * scale, &run->along[0]);
    const int left = row->count - first;
    for (run->count = 1; run->count < left && run->count < RUN; run->count++)
        if (locate(row->along[first + run->count] * scale, &run->along[run->count]) != run->cell[0])
            return;
}

/* --- Perlin ---------------------------------------------------------------------------------- */

/* Directions towards the edges of a cube; four of them twice, so that a hash selects one by
 * masking. */
static const double edges[16][3] = {
    {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1},
    {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}, {1, 1, 0}, {0, -1, 1}, {-1, 1, 0}, {0, -1, -1},
};

/* In 2 dimensions: eight directions, none along an axis or a diagonal, where patterns are visible.
 * All have length sqrt 2, so that the noise has the range -1..1: sqrt 2 cos and sin of 22.5
 * degrees. */
#define LONG 1.30656296487637652
#define SHORT 0.541196100146196985
static const double plane_gradients[8][3] = {{LONG, SHORT},   {-LONG, SHORT}, {LONG, -SHORT},
                                             {-LONG, -SHORT}, {SHORT, LONG},  {-SHORT, LONG},
                                             {SHORT, -LONG},  {-SHORT, -LONG}};
#undef LONG
#undef SHORT

/* 6t^5 - 15t^4 + 10t^3 */
static double fade(double t)
{
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

static void perlin_run(const struct neph_noise *noise, const struct run *run, double sums[RUN])
{
    uint64_t hashes[8];
    hash_cells(noise, run->cell, 2, STREAM_GRADIENT, hashes);
    double weights_x[2][RUN];
    for (int i = 0; i < run->count; i++) {
        weights_x[1][i] = fade(run->along[i]);
        weights_x[0][i] = 1.0 - weights_x[1][i];
        sums[i] = 0.0;
    }
    const double faded_y = fade(run->across[0]), faded_z = fade(run->across[1]);
    for (int corner = 0; corner < 1 << noise->dimensions; corner++) {
        const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
        const double weight_y = y ? faded_y : 1.0 - faded_y, weight_z = z ? faded_z : 1.0 - faded_z;
        const double *g = noise->dimensions == 2 ? plane_gradients[hashes[2 * x + y] & 7]
                                                 : edges[hashes[4 * x + 2 * y + z] & 15];
        const double part_y = g[1] * (run->across[0] - y), part_z = g[2] * (run->across[1] - z);
        for (int i = 0; i < run->count; i++)
            sums[i] += weights_x[x][i] * weight_y * weight_z *
                       (g[0] * (run->along[i] - x) + part_y + part_z);
    }
}

void neph_noise_perlin_row(const struct neph_noise *noise, int octaves,
                           const struct neph_noise_row *row, double *values)
{
    struct neph_noise octave = *noise;
    double height = 1.0, heights = 0.0, scale = 1.0;
    for (int i = 0; i < row->count; i++)
        values[i] = 0.0;
    for (int o = 0; o < octaves; o++) {
        octave.seed = noise->seed + (uint64_t)o;
        struct run run;
        for (int first = 0; first < row->count; first += run.count) {
            double noises[RUN];
            find_run(&octave, row, first, scale, &run);
            perlin_run(&octave, &run, noises);
            for (int i = 0; i < run.count; i++)
                values[first + i] += height * noises[i];
        }
        heights += height;
        height *= 0.5;
        scale *= 2.0;
        octave.period *= 2;
    }
    for (int i = 0; i < row->count; i++)
        values[i] /= heights;
}

/* A row of one point. */
static struct neph_noise_row point_row(const struct neph_noise *noise, const double *at)
{
    return (struct neph_noise_row){1, at, {at[1], noise->dimensions == 3 ? at[2] : 0.0}};
}

double neph_noise_perlin_sum(const struct neph_noise *noise, int octaves, const double *at)
{
    const struct neph_noise_row row = point_row(noise, at);
    double value;
    neph_noise_perlin_row(noise, octaves, &row, &value);
    return value;
}

double neph_noise_perlin(const struct neph_noise *noise, const double *at)
{
    return neph_noise_perlin_sum(noise, 1, at);
}

/* --- Worley ---------------------------------------------------------------------------------- */

/* The squared distances to the nearest point of the cell and its neighbours, at most 1: points of
 * farther cells are at least 1 away, where the noise is 0. */
static void worley_run(const struct neph_noise *noise, const struct run *run,
                       double nearest_squared[RUN])
{
    const bool is_plane = noise->dimensions == 2;
    const int first[3] = {run->cell[0] - 1, run->cell[1] - 1, is_plane ? 0 : run->cell[2] - 1};
    uint64_t hashes[27];
    hash_cells(noise, first, 3, STREAM_POINT, hashes);
    for (int i = 0; i < run->count; i++)
        nearest_squared[i] = 1.0;
    for (int n = 0; n < (is_plane ? 9 : 27); n++) {
        const int column = is_plane ? n : n / 3;
        double point[3];
        for (int axis = 0; axis < 3; axis++)
            point[axis] = (double)(hashes[n] >> 21 * axis & 0x1fffff) * 0x1p-21;
        const double x = column / 3 - 1 + point[0];
        const double y = column % 3 - 1 + point[1] - run->across[0];
        const double z = is_plane ? 0.0 : n % 3 - 1 + point[2] - run->across[1];
        const double y_squared = y * y, z_squared = z * z;
        for (int i = 0; i < run->count; i++) {
            const double offset = x - run->along[i];
            const double squared = offset * offset + y_squared + z_squared;
            nearest_squared[i] = squared < nearest_squared[i] ? squared : nearest_squared[i];
        }
    }
}

void neph_noise_worley_row(const struct neph_noise *noise, const struct neph_noise_row *row,
                           double *values)
{
    struct run run;
    for (int first = 0; first < row->count; first += run.count) {
        double nearest_squared[RUN];
        find_run(noise, row, first, 1.0, &run);
        worley_run(noise, &run, nearest_squared);
        for (int i = 0; i < run.count; i++)
            values[first + i] = 1.0 - sqrt(nearest_squared[i]);
    }
}

double neph_noise_worley(const struct neph_noise *noise, const double *at)
{
    const struct neph_noise_row row = point_row(noise, at);
    double value;
    neph_noise_worley_row(noise, &row, &value);
    return value;
}

double neph_noise_perlin_worley(double perlin, double worley)
{
    return worley + perlin * (1.0 - worley);
}
