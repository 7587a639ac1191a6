/* SPDX-License-Identifier: MIT
 *
 * Reflection at the surface of a solid. Its reflectance is
 *
 *   f = colour * ((1 - metalness) / pi + metalness * D G / (4 cos_in cos_out))   [1/sr]
 *
 * the sum of a Lambertian part and a metallic part, both of the base colour (`albedo`, or a pattern
 * of two). D and G are the distribution of Trowbridge and Reitz ("GGX") with alpha = roughness^2
 * and its shadowing, G = G1(in) G1(out): B. Walter et al., "Microfacet Models for Refraction
 * through Rough Surfaces", EGSR 2007, equations 20, 23, 33 and 34. Roughness 0 is a mirror. A metal
 * has its colour at all angles (there is no Fresnel term), and light between its facets is lost.
 */
#ifndef NEPH_SCENES_SURFACE_H
#define NEPH_SCENES_SURFACE_H

#include "base/vec3.h"

#include <stdbool.h>

#define NEPH_NOISE_CELLS 32 /* period of the noise */

enum neph_pattern {
    NEPH_PATTERN_CHECKER,
    NEPH_PATTERN_NOISE,
    NEPH_PATTERN_COUNT,
};

/* A pattern on the faces of a box, which moves and turns with the box. The coordinates u and v of a
 * place are those two of (x, y, z), in this order, that lie in its face, relative to the centre of
 * the box and in cells. The colour is albedo + value * (other - albedo). The value of a checker is
 * 1 where floor(u) + floor(v) is odd, else 0; the value of noise is bilinear between
 * neph_noise_value() at whole u and v. */
struct neph_paint {
    double cell_m; /* 0: no pattern */
    enum neph_pattern pattern;
    struct neph_rgb other;
    int seed; /* of noise */
};

struct neph_surface {
    double metalness; /* 0..1 */
    double roughness; /* 0..1; of the metal */
    struct neph_paint texture;
};

/* Uniform in 0..1 (2^-24 apart) and the same bits everywhere: the first number of pcg3d (M.
 * Jarzynski, M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020) of i and j modulo
 * NEPH_NOISE_CELLS and the seed, without its lowest 8 bits. */
double neph_noise_value(int seed, int i, int j);

/* 0..1, at a place of the pattern [cells]. */
double neph_paint_value(const struct neph_paint *texture, double u, double v);

static inline bool neph_is_textured(const struct neph_surface *surface)
{
    return surface->texture.cell_m > 0.0;
}

static inline bool neph_is_mirror(const struct neph_surface *surface)
{
    return surface->metalness > 0.0 && surface->roughness == 0.0;
}

#endif
