/* SPDX-License-Identifier: MIT
 *
 * Least squares of many time series at once on a set of waves that can grow and shrink: what each
 * further wave would explain, and what each wave of the set does that the others cannot. The sweep
 * operator (J. H. Goodnight, The American Statistician 33, 1979) in blocks of two, with the second
 * moments of the series carried along: of the series themselves only these are needed.
 */
#ifndef NEPH_METRICS_EXTRACTORS_CYCLE_TABLEAU_H
#define NEPH_METRICS_EXTRACTORS_CYCLE_TABLEAU_H

#include "base/arena.h"

#include <stdbool.h>

/* Wave i has the columns 2 i and 2 i + 1: cosine and sine. One that has no sine (1/2 a frame) has
 * zeros there. Wave 0 is the mean and the line, and always in the set. The last ones are seen
 * through a Hann window: five bins of 1 / N apart they share nothing, and noise of a steep spectrum
 * does not leak from one into another. */
struct neph_cycle_tableau {
    int wave_count, frame_count;
    bool *inside;     /* whether a wave is in the set */
    bool *wanted;     /* room for as many */
    double *products; /* of what is left of the waves; inside: of the dual waves */
    double *moments;  /* the same with the second moments of the series between */
    double *origin;   /* both of the waves themselves */
    double *scratch;
};

/* The waves 1, 2 ... have the frequencies [cycles per frame], each in (0, 1/2], of which the last
 * `window_count` are windowed. `moments` is the
 * frame_count^2 matrix sum over the series of d_s d_t, symmetric. The arena has the arrays of the
 * tableau. NEPH_ERR_MEMORY. */
enum neph_status neph_cycle_tableau_begin(struct neph_cycle_tableau *tableau, int frame_count,
                                          const double *moments, const double *per_frame, int count,
                                          int window_count, struct neph_arena *memory,
                                          struct neph_diag *diag);

/* Take a wave into the set, or out of it. */
void neph_cycle_tableau_turn(struct neph_cycle_tableau *tableau, int wave);

/* Make the tableau of the set anew, without what rounding has added up in many turns. */
void neph_cycle_tableau_refresh(struct neph_cycle_tableau *tableau);

/* What of the sum of squares of all series the wave explains beside the set without it. */
double neph_cycle_gain(const struct neph_cycle_tableau *tableau, int wave);

/* How much of the wave the set (without it) cannot follow, 0..1: of the phase that it follows best.
 */
double neph_cycle_separation(const struct neph_cycle_tableau *tableau, int wave);

/* Correlation over the series of the coefficients of what the set leaves of the waves a and b, both
 * outside of it, for cosine and sine: 2x2. */
void neph_cycle_coherence(const struct neph_cycle_tableau *tableau, int a, int b,
                          double coherence[4]);

/* 2, but 1 for the wave without a sine. */
int neph_cycle_dof(const struct neph_cycle_tableau *tableau, int wave);

#endif
