/* SPDX-License-Identifier: MIT
 *
 * Slab light: multiple scattering at a point, approximated by a column along the sunlight with the
 * same optical depths in front of and behind the point (after A. Bouthors, F. Neyret, N. Max, E.
 * Bruneton, C. Crassin, "Interactive multiple anisotropic scattering in clouds", I3D 2008, whose
 * slabs are placed on the cloud's surface). The column is as wide as it is long; light that leaves
 * through its sides is lost. It consists of the similar isotropic medium: (1 - g) of the scattering
 * and the same absorption. A small table of the mean radiance by both optical depths is computed at
 * the start from Milne's integral equation, in a quarter of a second for each albedo. A
 * non-physical model: the horizontal extent of a cloud has no effect.
 */
#ifndef NEPH_RENDERER_SLAB_LIGHT_H
#define NEPH_RENDERER_SLAB_LIGHT_H

#include "renderer/compute.h"
#include "renderer/march_params.h"
#include "renderer/shaders/constants.h"
#include "scenes/scene.h"

struct neph_slab_light {
    struct neph_vulkan *vulkan; /* borrowed; NULL: not used */
    struct neph_buffer table;   /* at binding 8 of a march */
};

/* Optical depth of a node of the table, 0..NEPH_GPU_SLAB_NODES-1. */
double neph_slab_light_depth(int node);

/* The exponential integral E2(x), x >= 0. */
double neph_slab_light_e2(double x);

/* Mean diffuse radiance [1/sr] at a depth in an infinite isotropic slab with a sun of irradiance 1
 * at normal incidence. `above` and `below` are optical depths >= 0; albedo 0..1. */
double neph_slab_light_infinite_per_sr(double above, double below, double albedo);

/* As neph_slab_light_infinite_per_sr(), for a column that is as wide as it is long. */
double neph_slab_light_per_sr(double above, double below, double albedo);

/* Create the table for a march with these parameters; nothing unless its lighting is
 * NEPH_MARCH_SLAB. Zero-initialise `light`; free with _destroy, also after an error. */
enum neph_status neph_slab_light_create(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                        const struct neph_march_params *params,
                                        struct neph_slab_light *light, struct neph_diag *diag);

/* A zero-initialised struct is fine. */
void neph_slab_light_destroy(struct neph_slab_light *light);

#endif
