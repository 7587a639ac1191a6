/* SPDX-License-Identifier: MIT
 *
 * Microfacet reflection of a rough metal: D G / (4 cos_in cos_out) of scenes/surface.h. Visible
 * facets are sampled (E. Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 7(4),
 * 2018), so the weight of a sampled direction is its shadowing G1, 0..1.
 */
#ifndef NEPH_TRUTH_METAL_H
#define NEPH_TRUTH_METAL_H

#include "base/vec3.h"
#include "truth/random.h"

/* The BRDF of a white metal times the cosine of `to` [1/sr]; 0 below the surface. Directions are
 * unit vectors away from the surface. The roughness is above 0. */
double neph_metal_per_sr(double roughness, struct neph_vec3 normal, struct neph_vec3 from,
                         struct neph_vec3 to);

/* Sample a direction `*to` into which a white metal reflects light from `from`; returns its weight.
 * 0: it ends among the facets, or `from` is below the surface. Roughness 0: a mirror, weight 1. */
double neph_metal_sample(double roughness, struct neph_vec3 normal, struct neph_vec3 from,
                         struct neph_random *random, struct neph_vec3 *to);

/* Mirror a direction at a plane; both point away from it. */
struct neph_vec3 neph_mirrored(struct neph_vec3 direction, struct neph_vec3 normal);

#endif
