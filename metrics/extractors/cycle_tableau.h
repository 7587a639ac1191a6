/* SPDX-License-Identifier: MIT
 *
 * Least squares of many time series on a set of waves that can grow and shrink: the gain of each
 * further wave, and the contribution of each wave of the set that the others cannot replace. Uses
 * the sweep operator (J. H. Goodnight, The American Statistician 33, 1979) in blocks of two, with
 * the second moments of the series: the series themselves are not needed.
 */
#ifndef NEPH_METRICS_EXTRACTORS_CYCLE_TABLEAU_H
#define NEPH_METRICS_EXTRACTORS_CYCLE_TABLEAU_H

#include "base/arena.h"

#include <stdbool.h>

/* Wave i has the columns 2 i and 2 i + 1: cosine and sine; a wave without a sine (1/2 per frame)
 * has zeros there. Wave 0 is mean and line, always in the set. The last waves have a Hann window:
 * five bins of 1 / N apart they are orthogonal, and noise with a steep spectrum does not leak
 * between them. */
struct neph_cycle_tableau {
    int wave_count, frame_count;
    bool *inside;     /* wave is in the set */
    bool *wanted;     /* scratch of the same size */
    double *products; /* products of the residual waves; inside the set: of the dual waves */
    double *moments;  /* the same, with the second moments in between */
    double *origin;   /* initial values of both */
    double *scratch;
};

/* Set up waves 1, 2 .. with these frequencies [cycles per frame], each in (0, 1/2]; the last
 * `window_count` are windowed. `moments`: symmetric frame_count^2 matrix, the sum over the series
 * of d_s d_t. Arrays are allocated in the arena. NEPH_ERR_MEMORY. */
enum neph_status neph_cycle_tableau_begin(struct neph_cycle_tableau *tableau, int frame_count,
                                          const double *moments, const double *per_frame, int count,
                                          int window_count, struct neph_arena *memory,
                                          struct neph_diag *diag);

/* Move a wave into the set, or out of it. */
void neph_cycle_tableau_toggle(struct neph_cycle_tableau *tableau, int wave);

/* Recompute the tableau of the current set, to remove accumulated rounding errors. */
void neph_cycle_tableau_refresh(struct neph_cycle_tableau *tableau);

/* The part of the total square sum that the wave explains in addition to the set without it. */
double neph_cycle_gain(const struct neph_cycle_tableau *tableau, int wave);

/* The part of the wave that the set (without it) cannot represent, 0..1, for its best represented
 * phase.
 */
double neph_cycle_separation(const struct neph_cycle_tableau *tableau, int wave);

/* Correlation over the series of the residual coefficients of waves a and b, both outside of the
 * set, for cosine and sine: 2x2. */
void neph_cycle_coherence(const struct neph_cycle_tableau *tableau, int a, int b,
                          double coherence[4]);

/* Degrees of freedom: 2, or 1 for the wave without a sine. */
int neph_cycle_dof(const struct neph_cycle_tableau *tableau, int wave);

#endif
