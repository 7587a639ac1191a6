/* SPDX-License-Identifier: MIT
 *
 * The surfaces of a scene's solids, defined in scenes/surface.h.
 */
#ifndef NEPH_SCENES_SURFACES_H
#define NEPH_SCENES_SURFACES_H

#include "scenes/solids.h"

/* The base colour where a ray meets a solid. */
struct neph_rgb neph_surface_color(const struct neph_hit *hit, struct neph_vec3 point_m);

/* Whether any solid has a pattern on its faces, or is metallic. */
bool neph_scene_is_textured(const struct neph_scene *scene);
bool neph_scene_has_metal(const struct neph_scene *scene);

/* The reason for which an engine with only Lambertian solids refuses a scene, and the way out, in
 * words; NULL: no reason. */
const char *neph_surfaces_obstacle(const struct neph_scene *scene);

/* Why an engine without meshes cannot render the scene; NULL: it has none. */
const char *neph_mesh_obstacle(const struct neph_scene *scene);

/* Why an engine without random coverage cannot render the scene; NULL: it can. */
const char *neph_coverage_obstacle(const struct neph_scene *scene);

/* The looks of a scene's meshes, as bits. */
enum {
    NEPH_LOOK_SMOOTH = 1,
    NEPH_LOOK_TEXTURE = 2,
    NEPH_LOOK_CUTOUT = 4, /* holes by the alpha of a texture */
    NEPH_LOOK_COVERAGE = 8,
};
unsigned neph_scene_mesh_looks(const struct neph_scene *scene);

/* neph_surfaces_obstacle() for an engine that supports patterns. */
const char *neph_metal_obstacle(const struct neph_scene *scene);

#endif
