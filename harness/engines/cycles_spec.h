/* SPDX-License-Identifier: MIT
 *
 * What scripts/blender_render.py is told: one shot as JSON. Lengths in metres, world axes.
 */
#ifndef NEPH_HARNESS_ENGINES_CYCLES_SPEC_H
#define NEPH_HARNESS_ENGINES_CYCLES_SPEC_H

#include "harness/engine.h"

#include <jansson.h>

/* The transmittance pass is one sample per pixel with steps this many times finer: the noise of a
 * single random step offset falls with the step itself, and one sample is exactly centred. */
#define NEPH_CYCLES_FINE_STEPS 160

/* How the scene was adapted; goes into the attributes of the frame. */
struct neph_cycles_world {
    struct neph_bounds containers[NEPH_SCENE_MEDIA_MAX];
    bool used[NEPH_SCENE_MEDIA_MAX];             /* false: a medium without extinction */
    double scale_height_m[NEPH_SCENE_MEDIA_MAX]; /* the shortest of a fog; +inf: homogeneous */
    double unit_m;                               /* length of one Blender unit */
    double cut_error; /* bound on the error in transmittance from cutting unbounded fogs */
};

/* NEPH_ERR_UNSUPPORTED, with what cannot be modelled as the message, or NEPH_OK. */
enum neph_status neph_cycles_world(const struct neph_scene *scene, struct neph_cycles_world *world,
                                   struct neph_diag *diag);

/* The settings of one shot, as numbers. */
struct neph_cycles_quality {
    int samples;
    double step; /* of the radiance pass, as a fraction of the scale height */
    int threads;
};

/* The spec, for the caller to json_decref(). `*sphere_error_px` receives the largest distance
 * between the silhouette of a sphere and that of the mesh that stands for it (0: no spheres). */
enum neph_status neph_cycles_spec(const struct neph_shot *shot,
                                  const struct neph_cycles_world *world,
                                  const struct neph_cycles_quality *quality, json_t **spec,
                                  double *sphere_error_px, struct neph_diag *diag);

#endif
