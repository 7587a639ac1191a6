/* SPDX-License-Identifier: MIT
 *
 * What a lighting model owes whatever the cloud, by closed forms. All are of a sun alone, which is
 * what models know:
 *
 * furnace      a white Gaussian ball in light from all sides, which is the sum over suns all around
 *              it: what it scatters to the camera is what it takes of the view, 1 - transmittance.
 *              By symmetry the same sum is the energy that leaves the ball to all sides, over what
 *              it takes from a sun.
 * reflected,   fluxes of a slab, by the faces of two half cubes, over the sun's; the truth is by
 * transmitted  adding-doubling (truth/slab.h).
 * balance      R + T + what comes straight through + what the true slab absorbs: 1.
 * reciprocity  radiance over the sun's cosine, over the same with the directions of eye and sun
 *              exchanged: 1 (S. Chandrasekhar, "Radiative Transfer", 1960, section 52).
 */
#ifndef NEPH_HARNESS_PHYSICS_LIGHT_LAWS_H
#define NEPH_HARNESS_PHYSICS_LIGHT_LAWS_H

#include "harness/json.h"
#include "harness/physics/checks.h"
#include "harness/run/store.h"
#include "harness/study/light_models.h"

enum neph_light_law {
    NEPH_LAW_FURNACE,
    NEPH_LAW_REFLECTED,
    NEPH_LAW_TRANSMITTED,
    NEPH_LAW_BALANCE,
    NEPH_LAW_RECIPROCITY,
    NEPH_LIGHT_LAW_COUNT,
};

/* A medium under a law. */
struct neph_light_law_case {
    enum neph_light_law law;
    double optical_depth, g, albedo;
};

enum { NEPH_LIGHT_LAWS = 15 };
extern const struct neph_light_law_case neph_light_law_cases[NEPH_LIGHT_LAWS];

enum { NEPH_LIGHT_LAW_VIEWS_MAX = 12 };

/* The views of a case; their stages borrow `name`. Returns how many. */
int neph_light_law_views(const struct neph_light_law_case *of, const char *name,
                         struct neph_check_view views[NEPH_LIGHT_LAW_VIEWS_MAX]);

/* What a case comes to when its views are seen as `sums`: of each, the sum over pixels of weight
 * times radiance. `*truth` is what it should be. NEPH_ERR_MEMORY. */
enum neph_status neph_light_law_value(const struct neph_light_law_case *of,
                                      const struct neph_check_view *views, const double *sums,
                                      double *value, double *truth, struct neph_diag *diag);

struct neph_light_laws {
    const char *const *models; /* borrowed */
    int model_count;
    bool looks[NEPH_LIGHT_MODELS_MAX];
    double truths[NEPH_LIGHT_LAWS];                        /* NaN: no model can */
    double values[NEPH_LIGHT_LAWS][NEPH_LIGHT_MODELS_MAX]; /* NaN: it cannot */
    bool once[NEPH_LIGHT_MODELS_MAX]; /* it was given slabs and balls with light scattered once */
};

/* Measure all cases with all models, in pictures that the store keeps. Errors of models' names and
 * of the store; NEPH_ERR_ENGINE and others where a picture broke. `device`: as neph_shot.device. */
enum neph_status neph_light_laws_run(const char *const *models, int model_count, int steps,
                                     struct neph_shared_device *device, struct neph_store *store,
                                     struct neph_light_laws *laws, struct neph_diag *diag);

/* A Markdown table; for the caller to free. NEPH_ERR_MEMORY. */
enum neph_status neph_light_laws_text(const struct neph_light_laws *laws, char **text,
                                      struct neph_diag *diag);

/* A list of cases; NULL when memory is short. */
json_t *neph_light_laws_json(const struct neph_light_laws *laws);

#endif
