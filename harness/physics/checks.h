/* SPDX-License-Identifier: MIT
 *
 * The checks of the physics suite as data: the views of each check, and the weighted sum over their
 * pixels that must agree with the reference.
 */
#ifndef NEPH_HARNESS_PHYSICS_CHECKS_H
#define NEPH_HARNESS_PHYSICS_CHECKS_H

#include "harness/physics/stage.h"

enum { NEPH_CHECK_VIEWS_MAX = 8 };

/* The weight of the pixels of a view in its sum. */
enum neph_check_weight {
    NEPH_CHECK_MEAN, /* the mean over the pixels [W m^-2 sr^-1] */
    NEPH_CHECK_FLUX, /* the flux through the horizontal plane [1], per vertical sunlight: sum of L
                        |cos| d(solid angle) / (sun_cosine E) over the hemisphere towards the
                        slab */
    NEPH_CHECK_WEIGHT_COUNT,
};

struct neph_check_view {
    struct neph_stage_params stage;
    enum neph_check_weight weight;
    double factor; /* of this view in the sum over the views */
    int width_px, height_px;
};

/* deviation = sum over views of factor * weighted sum of (L - reference), as a fraction of the sum
 * over views of |factor| * weighted sum of the reference. */
struct neph_check {
    char name[64];
    const char *rung; /* name of the kind of reference */
    char what[320];   /* description of medium, light and views */
    struct neph_check_view views[NEPH_CHECK_VIEWS_MAX];
    int view_count;
    bool uneven;     /* the medium is not homogeneous: renderers march through it in steps */
    bool deep;       /* light scatters a thousand times and more before it leaves */
    bool truth_only; /* needs many frames: only for built-in path tracers */
};

/* The kinds of reference, in the order of the checks. */
struct neph_check_rung {
    const char *name, *title;
};
enum { NEPH_CHECK_RUNGS = 8 };
extern const struct neph_check_rung neph_check_rungs[NEPH_CHECK_RUNGS];

int neph_check_count(void);

/* Fill `check` by its index. The names of its stages point into `check`, so it must not be
 * copied. */
void neph_check_get(int index, struct neph_check *check);

/* The views of all light that leaves a slab on one side, 1: below, -1: above, by the faces of a
 * cube. The sum over the views is the flux. Their stages equal `stage` except for the view
 * direction. */
enum { NEPH_CHECK_FACES = 4 };
void neph_check_hemisphere(const struct neph_stage_params *stage, double side,
                           struct neph_check_view views[NEPH_CHECK_FACES]);

/* The ray of a pixel, counted row by row from the top; and the weight of a pixel with the ray
 * direction `direction`, without the view's factor. */
struct neph_pixel_ray neph_check_ray(const struct neph_check_view *view,
                                     const struct neph_camera *camera, int pixel);
double neph_check_pixel_weight(const struct neph_check_view *view, const struct neph_camera *camera,
                               struct neph_vec3 direction);

#endif
