/* SPDX-License-Identifier: MIT
 *
 * The surfaces of a scene's solids: scenes/surface.h says what they are.
 */
#ifndef NEPH_SCENES_SURFACES_H
#define NEPH_SCENES_SURFACES_H

#include "scenes/solids.h"

/* The base colour where a ray meets a solid. */
struct neph_rgb neph_surface_color(const struct neph_hit *hit, struct neph_vec3 point_m);

/* Whether any solid has a pattern, is of metal. */
bool neph_scene_is_textured(const struct neph_scene *scene);
bool neph_scene_has_metal(const struct neph_scene *scene);

/* Why an engine of plain Lambertian solids refuses a scene, and the way out, in words; NULL: its
 * solids are plain. */
const char *neph_surfaces_obstacle(const struct neph_scene *scene);

/* As neph_surfaces_obstacle(), for an engine that knows patterns. */
const char *neph_metal_obstacle(const struct neph_scene *scene);

#endif
