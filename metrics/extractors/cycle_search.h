/* SPDX-License-Identifier: MIT
 *
 * Finds the cycles in many time series at once: the candidate frequencies that the series need
 * beside each other, above noise of any colour. Frequencies may be much closer than 1 / N, because
 * the candidates are few and known and the series are many.
 */
#ifndef NEPH_METRICS_EXTRACTORS_CYCLE_SEARCH_H
#define NEPH_METRICS_EXTRACTORS_CYCLE_SEARCH_H

#include "metrics/extractors/cycle_frequency.h"

/* Probability of one false cycle in frames without any (all candidates together). */
#define NEPH_CYCLE_ALPHA 1e-3

/* Smallest reported share of a cycle in the movement of the series. */
#define NEPH_CYCLE_SHARE_MIN 1e-5

struct neph_cycle_found {
    struct neph_cycle_frequency frequency;
    double noise;    /* noise at this frequency, relative to white noise of the same variance */
    int also_period; /* period [frames] that explains these series as well; 0: none */
};

struct neph_cycle_findings {
    struct neph_cycle_found *items; /* ascending by frequency */
    int count;
    double scatter;   /* relative scatter of the mean noise power of all series at one frequency */
    double ratio_min; /* smallest detectable power at one frequency, relative to the noise */
};

/* `moments`: frame_count^2 values, the sum over the series of d_s d_t. The findings are allocated
 * in the arena. NEPH_ERR_MEMORY. */
enum neph_status neph_cycle_search(int frame_count, const double *moments,
                                   const struct neph_cycle_frequencies *candidates,
                                   struct neph_arena *memory, struct neph_cycle_findings *findings,
                                   struct neph_diag *diag);

#endif
