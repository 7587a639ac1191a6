/* SPDX-License-Identifier: MIT
 *
 * Clouds in the manner of Horizon Zero Dawn (A. Schneider, "The Real-time Volumetric Cloudscapes of
 * Horizon: Zero Dawn", SIGGRAPH 2015; shape functions after F. Haggstrom, "Real-time rendering of
 * volumetric clouds", 2018): a spherical shell whose density is base noise, carved by a weather
 * map, a height profile and detail noise. Noise and weather are made here from a seed.
 *
 * With R(v, a, b, c, d) = c + (v - a) (d - c) / (b - a), sat() a clamp to 0..1, p the height within
 * the layer 0..1, gc and gd coverage and density of the whole sky, and from the weather map low and
 * high coverage w0 w1, peak height wh, density wd:
 *
 *   coverage      w = gc max(w0, 2 w1 sat(gc - 0.5))
 *   height shape  SA = sat(R(p, 0, .07, 0, 1)) sat(R(p, .2 wh, wh, 1, .1))
 *   height mass   DA = 2 gd wd p sat(R(p, 0, .15, 0, 1)) sat(R(p, .9, 1, 1, .2))
 *   base noise    B = R(red, .625 green + .25 blue + .125 alpha - 1, 1, 0, 1)
 *   shape         S = sat(R(B SA, 1 - w, 1, 0, 1)); 0 where w = 0
 *   detail noise  D = sat(R(red, 1 - (.625 red + .25 green + .125 blue), 1, 0, 1))
 *   erosion       E = .8 e^(-.75 gc) lerp(D, 1 - D, sat(1.8 p))
 *   density       sat(R(S, E, 1, 0, 1)) DA; without detail S DA
 */
#ifndef NEPH_SCENES_HORIZON_H
#define NEPH_SCENES_HORIZON_H

#include "base/arena.h"
#include "scenes/horizon_textures.h"
#include "scenes/scene.h"

#include <stdint.h>

/* Increase when the same parameters produce another density: it is part of the keys of stored
 * frames. */
#define NEPH_HORIZON_VERSION 1

#define NEPH_HORIZON_BLOCK 2 /* texels along a side of a block of the bounds' tables */

/* Parameters in a scene file. */
struct neph_horizon_params {
    uint64_t seed;
    double planet_radius_m;  /* of the bottom of the cloud layer; > 0 */
    double bottom_m;         /* world height of the bottom at x = z = 0 */
    double thickness_m;      /* of the layer; > 0 */
    double coverage;         /* gc, 0..1 */
    double density;          /* gd, >= 0 */
    double texture_scale_m;  /* world metres of one repeat of the weather map; > 0 */
    double base_repeats;     /* of the base noise within texture_scale_m; > 0 */
    double detail_repeats;   /* of the detail noise within texture_scale_m; > 0 */
    struct neph_vec3 wind_m; /* the textures' displacement: clouds that were at x are at x + wind */
};

/* Textures are float32 on both sides: the shader reads the same numbers. Texel (i, j, k) is at
 * (i + 0.5) / side; lookups are (bi/tri)linear and wrap around. */
struct neph_horizon {
    struct neph_arena arena; /* of what follows */
    struct neph_horizon_params params;
    float *base;    /* [z][y][x][4]: Perlin-Worley, three octaves of Worley; 0..1 */
    float *detail;  /* [z][y][x][3]: three octaves of Worley; 0..1 */
    float *weather; /* [z][x][4]: low coverage, high coverage, peak height, density; 0..1 */
    /* For the bound: extremes of lookups per block of texels and its far neighbours. */
    float *base_blocks;    /* [z][y][x]: the largest B */
    float *detail_blocks;  /* [z][y][x][2]: the smallest and the largest D */
    float *weather_blocks; /* [z][x][4]: the largest of each channel */
};

/* Generate the textures: deterministic in the seed, the same bits on every machine. Takes less
 * than a tenth of a second of processor time. NEPH_ERR_INPUT: a parameter outside its range. */
enum neph_status neph_horizon_create(const struct neph_horizon_params *params,
                                     struct neph_horizon **horizon, struct neph_diag *diag);

/* NULL is fine. */
void neph_horizon_destroy(struct neph_horizon *horizon);

/* The article's values: planet 2e5 m, layer from 80 m to 360 m, coverage 0.58, density 1.5, weather
 * over 6 km, 40 and 60 repeats. Seed 1, no wind. */
struct neph_horizon_params neph_horizon_defaults(void);

/* Density (dimensionless, >= 0) at a point. `*without_detail` receives the density before erosion
 * by detail noise (the article's SN), which its lighting model uses; NULL is fine. */
double neph_horizon_density(const struct neph_horizon *horizon, struct neph_vec3 point_m,
                            double *without_detail);

/* An upper bound of the density in the box (sides may be infinite); 0 where the box lies outside
 * the layer or under clear sky. */
double neph_horizon_bound(const struct neph_horizon *horizon, const struct neph_bounds *box);

/* The part of the bounds in which the layer may lie: the sphere around it; without the space that
 * is below the layer everywhere, when the bounds are within the upper half of the planet. */
struct neph_bounds neph_horizon_support(const struct neph_horizon *horizon,
                                        const struct neph_bounds *bounds);

/* The integral of the density along origin + t direction over [t0_m, t1_m] [m]; t1 may be +inf,
 * `direction` is unit. The ray is split at the surfaces of the shell and at the faces of all
 * texels, between which the density is smooth except for its clamps; each part is integrated by
 * Gauss-Kronrod quadrature with bisection. `*error_m` receives the sum of the differences between
 * the two rules and of the largest effect of a clamp between their points; the true error is below
 * it, except for rounding (NULL is fine). */
double neph_horizon_integral_m(const struct neph_horizon *horizon, struct neph_vec3 origin_m,
                               struct neph_vec3 direction, double t0_m, double t1_m,
                               double *error_m);

#endif
