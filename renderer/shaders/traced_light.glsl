// SPDX-License-Identifier: MIT
//
// Traced light: light that media have scattered more than once, by paths that start on the rays of
// a coarse grid of texels over the picture. A path's first collision stands for what the view sees
// of the media there; what it brings home from its later ones is counted in the texel, and so is
// the collision. Their quotient is the light of higher orders per unit of opacity. It varies slowly
// over the picture, where the opacity does not, and the march knows the opacity of its own ray:
//
//   L_higher = (1 - T) sum of light / sum of collisions
//
// Both sums fade from picture to picture alike, so that the quotient is a mean over the last
// pictures, and where a texel knows little its neighbours count more.
#ifndef NEPH_TRACED_LIGHT_GLSL
#define NEPH_TRACED_LIGHT_GLSL

#include "numbers.glsl"

struct LightTexel {
    vec3 light; // sum over paths [W m^-2 sr^-1]
    float collisions; // how many of the view's rays had one
    float distance_m; // sum of the distances along the view at which
    float padding[3];
};

// How many there are of a picture.
uvec2 light_size(uvec2 size_px, uint texel_px) { return (size_px + texel_px - 1u) / texel_px; }

#endif
