/* SPDX-License-Identifier: MIT
 *
 * Periodic gradient noise (K. Perlin, "Improving Noise", SIGGRAPH 2002) and cellular noise
 * (S. Worley, "A Cellular Texture Basis Function", SIGGRAPH 1996) on lattices of unit cells.
 *
 * Deterministic in the seed and the same bits on every machine: randomness comes from integer
 * hashes, numbers from + - * / sqrt and floor alone, all of which IEEE 754 rounds correctly. Moving
 * a point by the period along an axis changes no bit, as far as the sum itself is exact.
 */
#ifndef NEPH_SCENES_NOISE_H
#define NEPH_SCENES_NOISE_H

#include <stdint.h>

/* A pattern of 2 or 3 dimensions that repeats after `period` cells, >= 1, along each. Points have
 * as many coordinates [cells]; any finite value within 2^31 cells. */
struct neph_noise {
    uint64_t seed;
    int dimensions; /* 2 or 3 */
    int period;
};

/* Points that differ only in their first coordinate. A row costs a fraction of its points one by
 * one, because neighbours in a cell share its hashes, and gives the same bits. */
struct neph_noise_row {
    int count;
    const double *along; /* the first coordinates, in any order */
    double across[2];    /* the other coordinates; [1] is not read in 2 dimensions */
};

/* -1.04..1.04, mean 0, 0 at the lattice points; twice differentiable. */
double neph_noise_perlin(const struct neph_noise *noise, const double *at);

/* A sum of `octaves` of Perlin noise, each of twice the frequency and half the height of the one
 * before, divided by the sum of the heights. The period is that of the first. */
double neph_noise_perlin_sum(const struct neph_noise *noise, int octaves, const double *at);

/* neph_noise_perlin_sum() at each point of a row; `values` has room for as many. */
void neph_noise_perlin_row(const struct neph_noise *noise, int octaves,
                           const struct neph_noise_row *row, double *values);

/* One random point per cell: 1 - distance to the nearest one [cells], at least 0. So 1 at the
 * points, with round hills about them. Exact in that no nearer point is overlooked. */
double neph_noise_worley(const struct neph_noise *noise, const double *at);

/* neph_noise_worley() at each point of a row; `values` has room for as many. */
void neph_noise_worley_row(const struct neph_noise *noise, const struct neph_noise_row *row,
                           double *values);

/* A hash of a lattice cell, uniform in 0..1 (2^-32 apart), periodic; `stream` makes another one. */
double neph_noise_cell_random(const struct neph_noise *noise, const int *cell, uint32_t stream);

/* Perlin noise `perlin` (0..1) raised by Worley noise `worley` (0..1): its low values are lifted,
 * so that wisps become billows. (Schneider 2015, the red channel of the base noise.) */
double neph_noise_perlin_worley(double perlin, double worley);

#endif
