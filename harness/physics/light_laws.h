/* SPDX-License-Identifier: MIT
 *
 * Conservation laws and symmetries that every lighting model must obey, for any cloud, as closed
 * forms. The sun is the only light, because the models support no other.
 *
 * - furnace: a white Gaussian ball in uniform light from all sides, which is the sum over suns in
 *   all directions. The radiance scattered to the camera must equal the attenuated part of the
 *   view, 1 - transmittance. By symmetry the same sum is the total energy that leaves the ball over
 *   the energy that it takes from a single sun.
 * - reflected, transmitted: fluxes of a slab, by the faces of two half cubes, over the sun's flux.
 *   The reference is adding-doubling (truth/slab.h).
 * - balance: R + T + unscattered sunlight + absorption of the reference slab = 1.
 * - reciprocity: radiance over the sun's cosine, divided by the same with the directions of camera
 *   and sun exchanged: 1 (S. Chandrasekhar, "Radiative Transfer", 1960, section 52).
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

/* A law and the medium that it is applied to. */
struct neph_light_law_case {
    enum neph_light_law law;
    double optical_depth, g, albedo;
};

enum { NEPH_LIGHT_LAWS = 15 };
extern const struct neph_light_law_case neph_light_law_cases[NEPH_LIGHT_LAWS];

enum { NEPH_LIGHT_LAW_VIEWS_MAX = 12 };

/* The views of a case; their stages borrow `name`. Returns the number of views. */
int neph_light_law_views(const struct neph_light_law_case *of, const char *name,
                         struct neph_check_view views[NEPH_LIGHT_LAW_VIEWS_MAX]);

/* The value of a case and its expected value, `*truth`. `sums` has for each view the sum over its
 * pixels of weight times radiance. NEPH_ERR_MEMORY. */
enum neph_status neph_light_law_value(const struct neph_light_law_case *of,
                                      const struct neph_check_view *views, const double *sums,
                                      double *value, double *truth, struct neph_diag *diag);

struct neph_light_laws {
    const char *const *models; /* borrowed */
    int model_count;
    bool looks[NEPH_LIGHT_MODELS_MAX];
    double truths[NEPH_LIGHT_LAWS];                        /* NaN: no model supports the case */
    double values[NEPH_LIGHT_LAWS][NEPH_LIGHT_MODELS_MAX]; /* NaN: unsupported */
    bool once[NEPH_LIGHT_MODELS_MAX]; /* the model was evaluated with single scattering only */
};

/* Measure all cases with all models; the store keeps the frames. Errors: unknown names of models,
 * errors of the store, NEPH_ERR_ENGINE and others when a frame fails. `device`: as
 * neph_shot.device. */
enum neph_status neph_light_laws_run(const char *const *models, int model_count, int steps,
                                     struct neph_shared_device *device, struct neph_store *store,
                                     struct neph_light_laws *laws, struct neph_diag *diag);

/* A Markdown table, to be freed by the caller. NEPH_ERR_MEMORY. */
enum neph_status neph_light_laws_text(const struct neph_light_laws *laws, char **text,
                                      struct neph_diag *diag);

/* A list of the cases; NULL when memory is short. */
json_t *neph_light_laws_json(const struct neph_light_laws *laws);

#endif
