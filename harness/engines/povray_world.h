/* SPDX-License-Identifier: MIT
 *
 * A frame of a scene in POV-Ray's units: the boxes around the media, the position of their faces,
 * and the cuts of pixels' rays near point lights (povray_lamps.h).
 */
#ifndef NEPH_HARNESS_ENGINES_POVRAY_WORLD_H
#define NEPH_HARNESS_ENGINES_POVRAY_WORLD_H

#include "scenes/scene.h"

#include <stdbool.h>

/* The box of one medium. */
struct neph_povray_container {
    bool used; /* false: the medium has no extinction */
    bool uniform;
    struct neph_bounds bounds; /* finite; of a turned container the box around it */
    /* For each axis, lower and upper face: a pixel's ray starts so near to this face that POV-Ray's
     * float bounding box could put its origin on the wrong side.
     */
    bool is_near_an_eye[3][2];
    /* For extinction_color 1. Uniform: everywhere; fog: at the bottom of the box; else the
     * maximum. */
    double extinction_per_m;
};

/* Radiosity settings: light between solids, from sample points that share their light with their
 * surroundings. */
struct neph_povray_radiosity {
    int rays;           /* rays per sample point; 0: no light between solids */
    double error_bound; /* allowed difference of shared light, in POV-Ray's measure */
    int photons;        /* photons of sunlight that mirrors reflect */
};

/* Cubes around a point light that cut the rays of pixels: each piece gets all intervals of the
 * medium. */
enum { NEPH_POVRAY_CUBES_MAX = 16 };

/* Objects around a point light or spot, set by povray_lamps.h. */
struct neph_povray_point_light {
    bool is_masked; /* a spot: a point light in a cube whose transparency has the spot's falloff */
    int cube_count;
    double half_sides_m[NEPH_POVRAY_CUBES_MAX]; /* ascending */
};

/* A frame of a scene, prepared for POV-Ray. */
struct neph_povray_world {
    const struct neph_scene *scene; /* borrowed */
    struct neph_camera camera;
    int width_px, height_px;
    int intervals;
    struct neph_povray_radiosity radiosity; /* set by the caller; else 0 */
    /* POV-Ray's tolerances are fixed lengths (1e-4 and 1e-3 units); a container face that near to a
     * lit solid breaks its shadow. The world is scaled until these lengths are small: position in
     * units = units_per_m * (position - origin). */
    double units_per_m;
    double radius_units; /* of the world */
    struct neph_vec3 origin_m;
    struct neph_povray_container containers[NEPH_SCENE_MEDIA_MAX];
    double cut_error; /* error bound, in transmittance, of cutting unbounded media */
    /* Optical depth across the largest displacement of a container's face, away from other faces
     * and eyes. */
    double shift_error;
    /* one for each light of the scene */
    struct neph_povray_point_light lamps[NEPH_SCENE_LIGHTS_MAX];
    double depth_range_m; /* exceeds the depth of all solids; 0: no solid in front of the camera */
};

/* Prepare a frame. NEPH_ERR_UNSUPPORTED, with the reason: its sizes exceed POV-Ray's range. Nothing
 * to free; `scene` must outlive the world. Only scenes of fogs and grids (baked_scene.h) can be
 * written as text. */
enum neph_status neph_povray_world(const struct neph_scene *scene, int frame, int width_px,
                                   int height_px, int intervals, struct neph_povray_world *world,
                                   struct neph_diag *diag);

/* Whether a mirror reflects sunlight onto other solids. Such an image has the same value in all
 * three channels.
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
