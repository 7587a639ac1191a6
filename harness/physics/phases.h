/* SPDX-License-Identifier: MIT
 *
 * Checks of the phase functions against their definition: the integral over the sphere is 1, and
 * the mean cosine is g, both of the function and of the directions that the oracle samples from it.
 */
#ifndef NEPH_HARNESS_PHYSICS_PHASES_H
#define NEPH_HARNESS_PHYSICS_PHASES_H

#include "scenes/phase.h"

/* Gauss-Kronrod quadrature on smooth pieces is accurate to 1e-12. A cosine in double precision
 * resolves the peak of g = 0.999 to 1e-10 of its width. */
#define NEPH_PHASE_TOLERANCE 1e-9

struct neph_phase_finding {
    struct neph_phase phase;
    double integral;            /* of the phase function over the sphere */
    double mean_cosine;         /* of the phase function */
    double sampled_mean_cosine; /* of the inverse CDF used for sampling */
    bool agrees;                /* all three are within NEPH_PHASE_TOLERANCE */
};

struct neph_phase_finding neph_phase_check(const struct neph_phase *phase);

/* Check all kinds with the trials in their rows, kinds without g first. Returns the number of
 * findings, which stop at NEPH_PHASES_MAX; a test checks that there are fewer. */
enum { NEPH_PHASES_MAX = 64 };
int neph_phases_check(struct neph_phase_finding found[NEPH_PHASES_MAX]);

#endif
