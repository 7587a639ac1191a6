/* SPDX-License-Identifier: MIT
 *
 * The model of a fit: the light of a scene's rays (truth/transport.h) as a function of a few
 * unknowns of its media, which are the same for all media.
 */
#ifndef NEPH_HARNESS_FIT_MODEL_H
#define NEPH_HARNESS_FIT_MODEL_H

#include "harness/fit/pixels.h"

enum neph_fit_unknown {
    NEPH_FIT_EXTINCTION, /* factor */
    NEPH_FIT_ALBEDO,     /* factor of the scattered light; beyond 1 / albedo it is no albedo */
    NEPH_FIT_ASYMMETRY,  /* g of the phase function */
    NEPH_FIT_FALLOFF,    /* factor, of height fog */
    NEPH_FIT_UNKNOWN_COUNT,
};

/* Values of the unknowns: the logarithms of the factors, and g. */
struct neph_fit_point {
    double x[NEPH_FIT_UNKNOWN_COUNT];
};

/* What was done with the light on its way into R, G and B. */
enum neph_fit_transfer {
    NEPH_FIT_LINEAR,
    NEPH_FIT_ENCODED, /* R, G and B are sRGB codes */
    NEPH_FIT_DECODED, /* R, G and B were decoded as if they were sRGB codes */
    NEPH_FIT_TRANSFER_COUNT,
};

/* Changes of the scene's media, those of a mistake (harness/fit/mistakes.h), per channel. */
struct neph_fit_base {
    int id; /* equal ids have equal changes */
    struct neph_rgb extinction[NEPH_SCENE_MEDIA_MAX], albedo[NEPH_SCENE_MEDIA_MAX];
    bool is_opacity_twice; /* scattered light is multiplied by 1 - transmittance of the ray */
};

struct neph_fit_model;

/* A model of these pixels. `scene` and `pixels` must outlive it. Free with _destroy. */
enum neph_status neph_fit_model_create(const struct neph_scene *scene,
                                       const struct neph_fit_pixels *pixels,
                                       struct neph_fit_model **model, struct neph_diag *diag);
void neph_fit_model_destroy(struct neph_fit_model *model);

/* Predict one of `stride` pixels only; 0 is the prediction of the others. 1 at first. */
void neph_fit_model_thin(struct neph_fit_model *model, int stride);

/* Whether the scene can be fitted: NEPH_ERR_UNSUPPORTED, with the reason and the way out. */
enum neph_status neph_fit_check_scene(const struct neph_scene *scene, struct neph_diag *diag);

/* The reason why an unknown cannot be fitted in this scene; NULL: it can. */
const char *neph_fit_obstacle(const struct neph_scene *scene, enum neph_fit_unknown unknown);

/* The scene's own values, and no factors. */
struct neph_fit_point neph_fit_scene_point(const struct neph_scene *scene);
struct neph_fit_base neph_fit_scene_base(void);

/* Predict the values of all pixels, as in struct neph_fit_pixel, `predicted` of pixels->count x
 * NEPH_FIT_QUANTITY_COUNT x 3. Light is kept for points that differ only in albedo and asymmetry.
 * NEPH_ERR_INTERRUPTED. */
enum neph_status neph_fit_predict(struct neph_fit_model *model, const struct neph_fit_base *base,
                                  const struct neph_fit_point *point,
                                  enum neph_fit_transfer transfer, double *predicted,
                                  struct neph_diag *diag);

/* sRGB codes of linear light, or the reverse, beyond 1 as well; no change if linear. */
double neph_fit_transfer_apply(enum neph_fit_transfer transfer, double value);
double neph_fit_transfer_invert(enum neph_fit_transfer transfer, double value);

#endif
