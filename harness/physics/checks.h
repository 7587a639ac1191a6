/* SPDX-License-Identifier: MIT
 *
 * The checks of the physics suite, as data: what is looked at, and which sum over its pixels must
 * agree with the truth.
 */
#ifndef NEPH_HARNESS_PHYSICS_CHECKS_H
#define NEPH_HARNESS_PHYSICS_CHECKS_H

#include "harness/physics/stage.h"

enum { NEPH_CHECK_VIEWS_MAX = 8 };

/* How the pixels of a view are added up. */
enum neph_check_weight {
    NEPH_CHECK_MEAN, /* the mean over the pixels [W m^-2 sr^-1] */
    NEPH_CHECK_FLUX, /* the flux through the level [1], per vertical sunlight: sum of
                       L |cos| d(solid angle) / (sun_cosine E) over the half on the slab's side */
    NEPH_CHECK_WEIGHT_COUNT,
};

struct neph_check_view {
    struct neph_stage_params stage;
    enum neph_check_weight weight;
    double factor; /* of this view in the sum over the views */
    int width_px, height_px;
};

/* deviation = sum over views of factor * weighted sum of (L - truth), as a fraction of the sum over
 * views of |factor| * weighted sum of truth. */
struct neph_check {
    char name[64];
    const char *rung; /* what kind of truth, in a word */
    char what[320];   /* what is on the stage, in words */
    struct neph_check_view views[NEPH_CHECK_VIEWS_MAX];
    int view_count;
    bool uneven; /* the medium is not homogeneous: renderers that march through it have a step */
    bool deep;   /* light is scattered a thousand times and more on its way out */
    bool truth_only; /* many frames: for our tracers alone */
};

/* What kinds of truth there are, in the order of the checks. */
struct neph_check_rung {
    const char *name, *title;
};
enum { NEPH_CHECK_RUNGS = 8 };
extern const struct neph_check_rung neph_check_rungs[NEPH_CHECK_RUNGS];

int neph_check_count(void);

/* By index; the names of its stages point into `check`. */
void neph_check_get(int index, struct neph_check *check);

/* All light that leaves a slab on one side, 1: below, -1: above, by the faces of a cube: `views`,
 * whose sum is the flux, with stages like `stage` but for where the camera looks. */
enum { NEPH_CHECK_FACES = 4 };
void neph_check_hemisphere(const struct neph_stage_params *stage, double side,
                           struct neph_check_view views[NEPH_CHECK_FACES]);

/* The ray of a pixel, row by row from the top, and the weight of a pixel whose ray has this
 * direction, factor left out. */
struct neph_pixel_ray neph_check_ray(const struct neph_check_view *view,
                                     const struct neph_camera *camera, int pixel);
double neph_check_pixel_weight(const struct neph_check_view *view, const struct neph_camera *camera,
                               struct neph_vec3 direction);

#endif
