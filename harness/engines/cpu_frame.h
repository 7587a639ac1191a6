/* SPDX-License-Identifier: MIT
 *
 * Renders a frame on all CPU cores, with one ray through the centre of each pixel.
 */
#ifndef NEPH_HARNESS_ENGINES_CPU_FRAME_H
#define NEPH_HARNESS_ENGINES_CPU_FRAME_H

#include "harness/engines/engine.h"
#include "truth/transport.h"

/* Compute the light of a ray. */
typedef struct neph_ray_light neph_compute_ray_light(const void *context, struct neph_vec3 origin_m,
                                                     struct neph_vec3 direction);

/* Render the layers of a shot. `*error`: the largest quadrature error of all rays. */
enum neph_status neph_cpu_frame(const struct neph_shot *shot, neph_compute_ray_light *see_ray,
                                const void *context, struct neph_image **frame, double *error,
                                struct neph_diag *diag);

#endif
