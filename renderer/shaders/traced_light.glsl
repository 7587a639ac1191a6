// SPDX-License-Identifier: MIT
//
// Traced light: multiple scattering from paths on a coarse grid of texels over the image. This file
// has the texel; light_walk.comp traces the paths, light_settle.comp accumulates over time,
// light_smooth.comp filters, and the ray marcher reads the result (higher_light() in march.glsl).
//
// A path starts on a camera ray of its texel. Its first collision represents the visible medium.
// The light that it finds at later collisions is added to the texel, and the first collision is
// counted. The quotient is the multiple scattering per unit of opacity. It varies slowly over the
// image; opacity does not, but the ray marcher knows the opacity of each ray:
//
//   L_higher = (1 - T) (sum of light) / (sum of collisions)
//
// Both sums fade at the same rate from frame to frame, so the quotient is a mean over the last
// frames, and a texel with few collisions takes more from its neighbours.
#ifndef NEPH_TRACED_LIGHT_GLSL
#define NEPH_TRACED_LIGHT_GLSL

#include "numbers.glsl"

struct LightTexel {
    vec3 light; // sum over paths [W m^-2 sr^-1]
    float collisions; // number of paths with a first collision
    float distance_m; // sum of the distances to the first collisions
    float padding[3];
};

// Number of texels of an image.
uvec2 light_size(uvec2 size_px, uint texel_px) { return (size_px + texel_px - 1u) / texel_px; }

#endif
