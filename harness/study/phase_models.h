/* SPDX-License-Identifier: MIT
 *
 * The phase functions that renderers draw instead of that of droplets, each with its parameters
 * chosen for given droplets.
 */
#ifndef NEPH_HARNESS_STUDY_PHASE_MODELS_H
#define NEPH_HARNESS_STUDY_PHASE_MODELS_H

#include "scenes/phase.h"

enum { NEPH_PHASE_MODELS_MAX = 8 };

struct neph_phase_model {
    const char *name;
    struct neph_phase phase;
    double
        log_error; /* root of the mean square of ln(model / droplets) over angles, even degrees */
};

/* Fills the models of the droplets, whose phase function is a table; `radius_um` is their effective
 * radius. Returns the number of models:
 * - Henyey-Greenstein of the same mean cosine;
 * - double Henyey-Greenstein and Draine of the same mean cosine, and of the least log_error on a
 *   lattice of the remaining parameters (g in steps of 0.005, second g of 0.05);
 * - Jendersie and d'Eon's for twice the radius, if that is in its range. */
int neph_phase_models(const struct neph_phase *droplets, double radius_um,
                      struct neph_phase_model models[NEPH_PHASE_MODELS_MAX]);

/* Fills `at` with the models for droplets of another radius: parameters stay, but for a droplet
 * diameter. Models whose range does not have it are left out. Returns their number. `log_error`
 * stays that of the fit. */
int neph_phase_models_at(const struct neph_phase_model *models, int count, double radius_um,
                         struct neph_phase_model at[NEPH_PHASE_MODELS_MAX]);

#endif
