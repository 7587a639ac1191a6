/* SPDX-License-Identifier: MIT
 *
 * The JSON input of scripts/blender_render.py for one shot. Lengths in metres, world axes.
 */
#ifndef NEPH_HARNESS_ENGINES_CYCLES_SPEC_H
#define NEPH_HARNESS_ENGINES_CYCLES_SPEC_H

#include "harness/engines/engine.h"
#include "harness/json.h"
#include "scenes/grid.h"

/* The transmittance pass takes one sample per pixel, with steps finer by this factor. The noise of
 * a random step offset falls with the step, and one sample is exactly centred in the pixel. */
#define NEPH_CYCLES_FINE_STEPS 160
/* The same factor for steps measured in grid cells: an error of 2e-5 in transmittance through a few
 * large cells of optical depth 3. */
#define NEPH_CYCLES_FINE_GRID_STEPS 40

/* How the scene was adapted; written to the attributes of the frame. */
struct neph_cycles_world {
    struct neph_bounds containers[NEPH_SCENE_MEDIA_MAX];
    bool used[NEPH_SCENE_MEDIA_MAX]; /* false: a medium without extinction */
    /* The unit of the option `step`: the shortest scale height of a fog; for a grid its node
     * spacing, or the mean free path at its densest point if that is shorter; +inf: uniform. */
    double feature_m[NEPH_SCENE_MEDIA_MAX];
    double unit_m;    /* length of one Blender unit */
    double cut_error; /* error bound, in transmittance, of cutting unbounded fogs */
};

/* Adapt the scene. NEPH_ERR_UNSUPPORTED: the message names the unsupported part. For media that are
 * neither fog nor grid (baked_scene.h makes grids of them) all members but `feature_m` are set. */
enum neph_status neph_cycles_world(const struct neph_scene *scene, struct neph_cycles_world *world,
                                   struct neph_diag *diag);

/* The quality settings of a shot. */
struct neph_cycles_quality {
    int samples;
    double step; /* step of the radiance pass, in units of feature_m */
    int threads;
    bool is_unbiased;     /* radiance without volume steps, if the Blender supports it */
    bool surface_layers;  /* also render the light of solids in parts (cycles_surface.h) */
    double ao_distance_m; /* distance limit of layer ao; 0: none */
};

/* Make the spec, for json_decref() by the caller. `*sphere_error_px`: the largest distance between
 * the silhouettes of a sphere and of its mesh (0: no spheres). */
enum neph_status neph_cycles_spec(const struct neph_shot *shot,
                                  const struct neph_cycles_world *world,
                                  const struct neph_cycles_quality *quality, json_t **spec,
                                  double *sphere_error_px, struct neph_diag *diag);

/* Whether any extinction is coloured. Then radiance is rendered as three images, radiance0 to
 * radiance2, each valid in one channel (reason: blender_render.py). */
bool neph_cycles_is_coloured(const struct neph_scene *scene);

/* Whether the emission of media is rendered as separate images, emission or emission0 to emission2,
 * to be added to radiance and volume. With all orders of scattering it is part of the radiance; its
 * directly visible part is in layer Emit. */
bool neph_cycles_has_emission_pictures(const struct neph_scene *scene);

/* The name of the OpenVDB file of a grid medium, beside the spec; `index`: the medium's index in
 * the scene. */
enum { NEPH_CYCLES_FILE_NAME_MAX = 32 };
void neph_cycles_grid_name(int index, char name[NEPH_CYCLES_FILE_NAME_MAX]);

/* The grid in Blender's units relative to the camera, where single precision is finest; to be
 * written as NEPH_VDB_BLENDER. The result shares the values of `grid`. */
struct neph_grid neph_cycles_grid(const struct neph_grid *grid, const struct neph_camera *camera,
                                  double unit_m);

#endif
