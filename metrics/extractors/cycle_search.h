/* SPDX-License-Identifier: MIT
 *
 * Which cycles are in many time series at once: of the candidate frequencies, those that the series
 * need beside each other, above noise of any colour. Frequencies may be much closer than 1 / N: the
 * candidates are few and known, and the series are many.
 */
#ifndef NEPH_METRICS_EXTRACTORS_CYCLE_SEARCH_H
#define NEPH_METRICS_EXTRACTORS_CYCLE_SEARCH_H

#include "metrics/extractors/cycle_frequency.h"

/* The level at which one cycle too many is found in frames that have none (all looks together). */
#define NEPH_CYCLE_ALPHA 1e-3

/* The least share of the movement of the series that a cycle is told at. */
#define NEPH_CYCLE_SHARE_MIN 1e-5

struct neph_cycle_found {
    struct neph_cycle_frequency frequency;
    double noise;    /* the noise at it over that of white noise of the same variance */
    int also_period; /* frames; a period that explains these series as well; 0: there is none */
};

struct neph_cycle_findings {
    struct neph_cycle_found *items; /* ascending by frequency */
    int count;
    double scatter;   /* relative, of the mean noise power of all series at one frequency */
    double ratio_min; /* the power at one frequency over that of the noise that is found */
};

/* `moments`: frame_count^2, the sum over the series of d_s d_t. The arena has the findings.
 * NEPH_ERR_MEMORY. */
enum neph_status neph_cycle_search(int frame_count, const double *moments,
                                   const struct neph_cycle_frequencies *candidates,
                                   struct neph_arena *memory, struct neph_cycle_findings *findings,
                                   struct neph_diag *diag);

#endif
