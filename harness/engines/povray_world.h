/* SPDX-License-Identifier: MIT
 *
 * A frame of a scene in POV-Ray's units: the boxes that hold the media, where their faces stand,
 * and how the rays of pixels are cut near point lights (povray_lamps.h).
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_WORLD_H
#define NEPH_HARNESS_ENGINES_POVRAY_WORLD_H

#include "scenes/scene.h"

#include <stdbool.h>

/* The box that holds one medium. */
struct neph_povray_container {
    bool used; /* false: the medium is empty */
    bool uniform;
    struct neph_bounds bounds; /* finite */
    /* By axis, the lower face and the upper one: a pixel's ray begins so near to this face that
     * POV-Ray's bounding box, whose numbers are floats, could leave the origin on its other side.
     */
    bool is_near_an_eye[3][2];
    /* For extinction_color 1. Uniform: everywhere; fog: at the lowest height of the box; else the
     * largest. */
    double extinction_per_m;
};

/* Light between solids: rays from places whose light those around them share. */
struct neph_povray_radiosity {
    int rays;           /* from a place; 0: there is no such light */
    double error_bound; /* how different light may be that is shared, in POV-Ray's measure */
    int photons;        /* that a mirror throws of the sun's light */
};

/* Cubes around a point light that cut the rays of pixels: each piece has all the intervals of the
 * medium. */
enum { NEPH_POVRAY_CUBES_MAX = 16 };

/* What a point light or spot needs beside its source, for povray_lamps.h to fill in. */
struct neph_povray_lamp {
    bool is_masked; /* a spot: a point light in a cube that lets through what its cone does */
    int cube_count;
    double half_sides_m[NEPH_POVRAY_CUBES_MAX]; /* rising */
};

/* A frame of a scene, prepared for POV-Ray. */
struct neph_povray_world {
    const struct neph_scene *scene; /* borrowed */
    struct neph_camera camera;
    int width_px, height_px;
    int intervals;
    struct neph_povray_radiosity radiosity; /* for the caller to set; else 0 */
    /* POV-Ray's tolerances are fixed lengths (1e-4 and 1e-3 units), and a container's face that
     * near to a lit solid breaks its shadow. The world is blown up until they are small: position
     * in units = units_per_m * (position - origin). */
    double units_per_m;
    double radius_units; /* of the world */
    struct neph_vec3 origin_m;
    struct neph_povray_container containers[NEPH_SCENE_MEDIA_MAX];
    double cut_error; /* bound on the error in transmittance of cutting open media */
    /* Optical depth across the largest move of a container's face off other faces and eyes. */
    double shift_error;
    struct neph_povray_lamp lamps[NEPH_SCENE_LIGHTS_MAX]; /* of the scene's lights */
    double depth_range_m; /* above the depth of all solids; 0: no solid in front of the camera */
};

/* Prepare a frame. NEPH_ERR_UNSUPPORTED, with the reason in words, when its sizes are beyond
 * POV-Ray. Nothing to free; `scene` must outlive the world. Only scenes of fogs and grids
 * (baked_scene.h) can be written as text. */
enum neph_status neph_povray_world(const struct neph_scene *scene, int frame, int width_px,
                                   int height_px, int intervals, struct neph_povray_world *world,
                                   struct neph_diag *diag);

/* Does a mirror throw sunlight on others? Such a picture has the same value in all three channels.
 */
bool neph_povray_has_photons(const struct neph_scene *scene);

/* Component 0, 1 or 2 of a vector. */
static inline double neph_povray_axis(struct neph_vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static inline void neph_povray_set_axis(struct neph_vec3 *v, int axis, double value)
{
    *(axis == 0 ? &v->x : axis == 1 ? &v->y : &v->z) = value;
}

#endif
