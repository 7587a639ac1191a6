/* SPDX-License-Identifier: MIT
 *
 * Surfaces of solids for Cycles: their description for scripts/blender_render.py, and the layers
 * with their light.
 */
#ifndef NEPH_HARNESS_ENGINES_CYCLES_SURFACE_H
#define NEPH_HARNESS_ENGINES_CYCLES_SURFACE_H

#include "base/image.h"
#include "harness/json.h"
#include "scenes/scene.h"

/* The unsupported property of the surfaces, as text; NULL: all are supported. */
const char *neph_cycles_surface_obstacle(const struct neph_scene *scene);

/* A surface as a new JSON reference: null for a plain Lambertian surface; NULL: an error. A texture
 * is given as image pixels. */
json_t *neph_cycles_surface(const struct neph_surface *surface);

/* Copy the layers of engine `surfaces` from Blender's image: direct and indirect light, colours,
 * and ao. At pixels whose centre sees the sky, ao is 1 and the others are 0. NEPH_ERR_ENGINE: a
 * layer is missing or not finite. */
enum neph_status neph_cycles_surface_layers(const struct neph_image *picture,
                                            struct neph_image *frame, struct neph_diag *diag);

#endif
