/* SPDX-License-Identifier: MIT */
#include "scenes/noise.h"

#include <math.h>

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

/* Streams of random numbers that no two uses share. */
enum stream { STREAM_GRADIENT = 1, STREAM_POINT, STREAM_CALLER };

static uint64_t cell_hash(const struct neph_noise *noise, const int *cell, uint32_t stream)
{
    uint64_t hash = mix(noise->seed + 0x9e3779b97f4a7c15u * stream);
    for (int axis = 0; axis < noise->dimensions; axis++)
        hash = mix(hash ^ (uint64_t)wrap(cell[axis], noise->period));
    return hash;
}

double neph_noise_cell_random(const struct neph_noise *noise, const int *cell, uint32_t stream)
{
    return (double)(cell_hash(noise, cell, STREAM_CALLER + stream) >> 32) * 0x1p-32;
}

/* The cell of a point, and its place in it, 0..1. */
static void locate(const struct neph_noise *noise, const double *at, int cell[3], double inside[3])
{
    for (int axis = 0; axis < noise->dimensions; axis++) {
        const double low = floor(at[axis]);
        cell[axis] = (int)low;
        inside[axis] = at[axis] - low;
    }
}

/* --- Perlin ---------------------------------------------------------------------------------- */

/* Towards the edges of a cube, four of them twice so that a hash picks one by masking. */
static const signed char edges[16][3] = {
    {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1},
    {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}, {1, 1, 0}, {0, -1, 1}, {-1, 1, 0}, {0, -1, -1},
};

/* In the plane: eight directions, none along an axis or a diagonal, which the eye would find. All
 * of length sqrt 2, so that the noise reaches from -1 to 1: sqrt 2 cos and sin of 22.5 degrees. */
#define LONG 1.30656296487637652
#define SHORT 0.541196100146196985
static const double plane_gradients[8][2] = {{LONG, SHORT},   {-LONG, SHORT}, {LONG, -SHORT},
                                             {-LONG, -SHORT}, {SHORT, LONG},  {-SHORT, LONG},
                                             {SHORT, -LONG},  {-SHORT, -LONG}};
#undef LONG
#undef SHORT

static double gradient(int dimensions, uint64_t hash, const double offset[3])
{
    if (dimensions == 2) {
        const double *g = plane_gradients[hash & 7];
        return g[0] * offset[0] + g[1] * offset[1];
    }
    const signed char *g = edges[hash & 15];
    return g[0] * offset[0] + g[1] * offset[1] + g[2] * offset[2];
}

/* 6t^5 - 15t^4 + 10t^3 */
static double fade(double t)
{
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

double neph_noise_perlin(const struct neph_noise *noise, const double *at)
{
    int cell[3];
    double inside[3], faded[3];
    locate(noise, at, cell, inside);
    for (int axis = 0; axis < noise->dimensions; axis++)
        faded[axis] = fade(inside[axis]);
    double sum = 0.0;
    for (int corner = 0; corner < 1 << noise->dimensions; corner++) {
        int node[3];
        double offset[3], weight = 1.0;
        for (int axis = 0; axis < noise->dimensions; axis++) {
            const int high = corner >> axis & 1;
            node[axis] = cell[axis] + high;
            offset[axis] = inside[axis] - high;
            weight *= high ? faded[axis] : 1.0 - faded[axis];
        }
        sum += weight *
               gradient(noise->dimensions, cell_hash(noise, node, STREAM_GRADIENT), offset);
    }
    return sum;
}

double neph_noise_perlin_sum(const struct neph_noise *noise, int octaves, const double *at)
{
    struct neph_noise octave = *noise;
    double point[3], height = 1.0, heights = 0.0, sum = 0.0;
    for (int axis = 0; axis < noise->dimensions; axis++)
        point[axis] = at[axis];
    for (int i = 0; i < octaves; i++) {
        octave.seed = noise->seed + (uint64_t)i;
        sum += height * neph_noise_perlin(&octave, point);
        heights += height;
        height *= 0.5;
        octave.period *= 2;
        for (int axis = 0; axis < noise->dimensions; axis++)
            point[axis] *= 2.0;
    }
    return sum / heights;
}

/* --- Worley ---------------------------------------------------------------------------------- */

/* Squared distance from a place in a cell to the point of a neighbouring cell. */
static double point_distance_squared(const struct neph_noise *noise, const int cell[3],
                                     const double inside[3], const int step[3])
{
    int neighbour[3];
    for (int axis = 0; axis < noise->dimensions; axis++)
        neighbour[axis] = cell[axis] + step[axis];
    uint64_t hash = cell_hash(noise, neighbour, STREAM_POINT);
    double sum = 0.0;
    for (int axis = 0; axis < noise->dimensions; axis++, hash >>= 21) {
        const double point = (double)(hash & 0x1fffff) * 0x1p-21;
        const double offset = step[axis] + point - inside[axis];
        sum += offset * offset;
    }
    return sum;
}

/* From a place in a cell to the next cell one step away. */
static double gap_squared(double inside, int step)
{
    const double gap = step < 0 ? inside : step > 0 ? 1.0 - inside : 0.0;
    return gap * gap;
}

/* The steps to a cell and its neighbours: near ones first, which spare the others. */
static const int outwards[3] = {0, -1, 1};

double neph_noise_worley(const struct neph_noise *noise, const double *at)
{
    int cell[3];
    double inside[3];
    locate(noise, at, cell, inside);
    const int layers = noise->dimensions == 3 ? 3 : 1;
    /* What lies beyond the nearest neighbours is at least 1 away, where the noise is 0. */
    double nearest_squared = 1.0;
    for (int k = 0; k < layers; k++)
        for (int j = 0; j < 3; j++)
            for (int i = 0; i < 3; i++) {
                const int step[3] = {outwards[i], outwards[j], outwards[k]};
                double gap = 0.0;
                for (int axis = 0; axis < noise->dimensions; axis++)
                    gap += gap_squared(inside[axis], step[axis]);
                if (gap < nearest_squared)
                    nearest_squared = fmin(nearest_squared,
                                           point_distance_squared(noise, cell, inside, step));
            }
    return 1.0 - sqrt(nearest_squared);
}

double neph_noise_perlin_worley(double perlin, double worley)
{
    return worley + perlin * (1.0 - worley);
}
