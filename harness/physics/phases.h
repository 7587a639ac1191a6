/* SPDX-License-Identifier: MIT
 *
 * Phase functions against what defines them: they integrate to 1 over the sphere, and their mean
 * cosine is g; so is that of the directions that the oracle draws from them.
 */
#ifndef NEPH_HARNESS_PHYSICS_PHASES_H
#define NEPH_HARNESS_PHYSICS_PHASES_H

#include "scenes/phase.h"

/* Gauss-Kronrod quadrature of functions that are smooth between its pieces is good to 1e-12; the
 * cosine, a double, resolves the peak of g = 0.999 to 1e-10 of its width. */
#define NEPH_PHASE_TOLERANCE 1e-9

struct neph_phase_finding {
    struct neph_phase phase;
    double integral;            /* of the phase function over the sphere */
    double mean_cosine;         /* of the phase function */
    double sampled_mean_cosine; /* of the inverse that directions are drawn with */
    bool agrees;                /* all three are as they should be, within NEPH_PHASE_TOLERANCE */
};

struct neph_phase_finding neph_phase_check(const struct neph_phase *phase);

/* All kinds, each with the values of g that its row gives; those without g first. Returns how
 * many. */
enum { NEPH_PHASES_MAX = NEPH_PHASE_TRIALS_MAX * NEPH_PHASE_KIND_COUNT };
int neph_phases_check(struct neph_phase_finding found[NEPH_PHASES_MAX]);

#endif
