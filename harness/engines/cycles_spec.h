/* SPDX-License-Identifier: MIT
 *
 * What scripts/blender_render.py is told: one shot as JSON. Lengths in metres, world axes.
 */
#ifndef NEPH_HARNESS_ENGINES_CYCLES_SPEC_H
#define NEPH_HARNESS_ENGINES_CYCLES_SPEC_H

#include "harness/engines/engine.h"
#include "harness/json.h"
#include "scenes/grid.h"

/* The transmittance pass is one sample per pixel with steps this many times finer: the noise of a
 * single random step offset falls with the step itself, and one sample is exactly centred. */
#define NEPH_CYCLES_FINE_STEPS 160
/* Where steps count in cells of a grid, so many times finer: 2e-5 of transmittance through a few
 * large cells of optical depth 3. */
#define NEPH_CYCLES_FINE_GRID_STEPS 40

/* How the scene was adapted; goes into the attributes of the frame. */
struct neph_cycles_world {
    struct neph_bounds containers[NEPH_SCENE_MEDIA_MAX];
    bool used[NEPH_SCENE_MEDIA_MAX]; /* false: a medium without extinction */
    /* What the option `step` counts in: the shortest scale height of a fog; of a grid the spacing
     * of its nodes, or the mean free path where it is densest if that is shorter; +inf: uniform. */
    double feature_m[NEPH_SCENE_MEDIA_MAX];
    double unit_m;    /* length of one Blender unit */
    double cut_error; /* bound on the error in transmittance from cutting unbounded fogs */
};

/* NEPH_ERR_UNSUPPORTED, with what cannot be modelled as the message, or NEPH_OK. Of media that are
 * neither fog nor grid (baked_scene.h makes grids of them) everything is known but `feature_m`. */
enum neph_status neph_cycles_world(const struct neph_scene *scene, struct neph_cycles_world *world,
                                   struct neph_diag *diag);

/* The settings of one shot, as numbers. */
struct neph_cycles_quality {
    int samples;
    double step; /* of the radiance pass, as a fraction of feature_m */
    int threads;
    bool is_unbiased;     /* volumes of the radiance without steps; of Blenders that can */
    bool surface_layers;  /* the light of solids in parts (cycles_surface.h), too */
    double ao_distance_m; /* of their layer ao; 0: no limit */
};

/* The spec, for the caller to json_decref(). `*sphere_error_px` receives the largest distance
 * between the silhouette of a sphere and that of the mesh that stands for it (0: no spheres). */
enum neph_status neph_cycles_spec(const struct neph_shot *shot,
                                  const struct neph_cycles_world *world,
                                  const struct neph_cycles_quality *quality, json_t **spec,
                                  double *sphere_error_px, struct neph_diag *diag);

/* Whether media need a phase function that Blender has from 4.3 on. */
bool neph_cycles_needs_rayleigh(const struct neph_scene *scene);

/* Whether any extinction has colour: then radiance comes in three pictures, radiance0 to radiance2,
 * of which each is right in one channel (blender_render.py says why). */
bool neph_cycles_is_coloured(const struct neph_scene *scene);

/* Whether light that media emit comes in pictures of its own, emission or emission0 to emission2,
 * to be added to the radiance and to what media scatter. With all orders it is in the radiance, and
 * what is seen of it in the layer Emit. */
bool neph_cycles_has_emission_pictures(const struct neph_scene *scene);

/* The name of the OpenVDB file, beside the spec, of a grid medium, by its index in the scene. */
enum { NEPH_CYCLES_FILE_NAME_MAX = 32 };
void neph_cycles_grid_name(int index, char name[NEPH_CYCLES_FILE_NAME_MAX]);

/* The grid in Blender's units, counted from the camera, where single precision is finest; to be
 * written as NEPH_VDB_BLENDER. It shares the values of `grid`. */
struct neph_grid neph_cycles_grid(const struct neph_grid *grid, const struct neph_camera *camera,
                                  double unit_m);

#endif
