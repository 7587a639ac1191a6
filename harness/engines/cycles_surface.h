/* SPDX-License-Identifier: MIT
 *
 * Surfaces of solids for Cycles: what scripts/blender_render.py is told of them, and the layers in
 * which it gives their light back.
 */
#ifndef NEPH_HARNESS_ENGINES_CYCLES_SURFACE_H
#define NEPH_HARNESS_ENGINES_CYCLES_SURFACE_H

#include "base/image.h"
#include "harness/json.h"
#include "scenes/scene.h"

/* What of them Cycles does not do, in words; NULL: nothing. */
const char *neph_cycles_surface_obstacle(const struct neph_scene *scene);

/* A new reference: null for a plain Lambertian; NULL when it cannot be made. A texture is told as
 * the pixels of a picture. */
json_t *neph_cycles_surface(const struct neph_surface *surface);

/* Add the layers of engine `surfaces` that Blender's picture has: of direct and indirect light, of
 * colours, and ao. At a pixel whose middle is of the sky ao is 1 and the others are 0.
 * NEPH_ERR_ENGINE: one is missing or not finite. */
enum neph_status neph_cycles_surface_layers(const struct neph_image *picture,
                                            struct neph_image *frame, struct neph_diag *diag);

#endif
