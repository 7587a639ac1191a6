/* SPDX-License-Identifier: MIT
 *
 * Reflection by the facets of a rough metal: D G / (4 cos_in cos_out) of scenes/surface.h. Facets
 * are drawn as they are seen (E. Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT
 * 7(4), 2018), so that a drawn direction is worth the shadowing G1 on its way out, 0..1.
 */
#ifndef NEPH_TRUTH_METAL_H
#define NEPH_TRUTH_METAL_H

#include "base/vec3.h"
#include "truth/random.h"

/* The reflectance of a white metal times the cosine of `to` [1/sr]; 0 below the surface. Directions
 * are unit and lead away from the surface. The roughness is above 0. */
double neph_metal_per_sr(double roughness, struct neph_vec3 normal, struct neph_vec3 from,
                         struct neph_vec3 to);

/* A direction `*to` into which a white metal reflects light from `from`, and the weight of that
 * direction; 0: it ends among the facets, or comes from below. Roughness 0: a mirror, weight 1. */
double neph_metal_sample(double roughness, struct neph_vec3 normal, struct neph_vec3 from,
                         struct neph_random *random, struct neph_vec3 *to);

/* The mirror image of a direction at a plane; both lead away from it. */
struct neph_vec3 neph_mirrored(struct neph_vec3 direction, struct neph_vec3 normal);

#endif
