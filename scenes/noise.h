/* SPDX-License-Identifier: MIT
 *
 * Periodic gradient noise (K. Perlin, "Improving Noise", SIGGRAPH 2002) and cellular noise
 * (S. Worley, "A Cellular Texture Basis Function", SIGGRAPH 1996) on lattices of unit cells.
 *
 * Deterministic in the seed, with the same bits on every machine: random numbers are integer
 * hashes, and arithmetic is + - * / sqrt and floor only, which IEEE 754 rounds correctly. Moving a
 * point by the period along an axis changes no bit, if the sum itself is exact.
 */
#ifndef NEPH_SCENES_NOISE_H
#define NEPH_SCENES_NOISE_H

#include <stdint.h>

/* A pattern in 2 or 3 dimensions that repeats after `period` >= 1 cells along each. Points have as
 * many coordinates [cells]; any finite value within 2^31 cells. */
struct neph_noise {
    uint64_t seed;
    int dimensions; /* 2 or 3 */
    int period;
};

/* Points that differ only in their first coordinate. A row is faster than single points, because
 * neighbours in a cell share its hashes, and gives the same bits. */
struct neph_noise_row {
    int count;
    const double *along; /* the first coordinates, in any order */
    double across[2];    /* the other coordinates; [1] is not read in 2 dimensions */
};

/* -1.04..1.04, mean 0, 0 at the lattice points; twice differentiable. */
double neph_noise_perlin(const struct neph_noise *noise, const double *at);

/* A sum of `octaves` of Perlin noise, each with twice the frequency and half the amplitude of the
 * one before, divided by the sum of the amplitudes. The period is the first octave's. */
double neph_noise_perlin_sum(const struct neph_noise *noise, int octaves, const double *at);

/* neph_noise_perlin_sum() at each point of a row; `values` has room for as many. */
void neph_noise_perlin_row(const struct neph_noise *noise, int octaves,
                           const struct neph_noise_row *row, double *values);

/* One random point per cell: 1 - distance to the nearest one [cells], at least 0. So 1 at the
 * points, with round hills around them. Exact: all cells that may have the nearest point are
 * searched. */
double neph_noise_worley(const struct neph_noise *noise, const double *at);

/* neph_noise_worley() at each point of a row; `values` has room for as many. */
void neph_noise_worley_row(const struct neph_noise *noise, const struct neph_noise_row *row,
                           double *values);

/* A hash of a lattice cell, uniform in 0..1 (2^-32 apart), periodic; each `stream` is
 * independent. */
double neph_noise_cell_random(const struct neph_noise *noise, const int *cell, uint32_t stream);

/* Perlin noise `perlin` (0..1) raised by Worley noise `worley` (0..1): low values are lifted, so
 * that wisps become billows. (Schneider 2015, the red channel of the base noise.) */
double neph_noise_perlin_worley(double perlin, double worley);

#endif
