/* SPDX-License-Identifier: MIT
 *
 * Clouds in the manner of Horizon Zero Dawn (A. Schneider, "The Real-time Volumetric Cloudscapes of
 * Horizon: Zero Dawn", SIGGRAPH 2015; shape functions after F. Haggstrom, "Real-time rendering of
 * volumetric clouds", 2018): a spherical shell whose density is base noise, carved by a weather
 * map, a height profile and detail noise. Noise and weather are made here from a seed.
 */
#ifndef NEPH_SCENES_HORIZON_H
#define NEPH_SCENES_HORIZON_H

#include "scenes/scene.h"

#include <stdint.h>

#define NEPH_HORIZON_BASE_SIDE 64     /* base noise: side^3 texels of 4 channels, periodic */
#define NEPH_HORIZON_DETAIL_SIDE 32   /* detail noise: side^3 texels of 3 channels, periodic */
#define NEPH_HORIZON_WEATHER_SIDE 256 /* weather map: side^2 texels of 4 channels, periodic */

/* What a scene may choose. */
struct neph_horizon_params {
    uint64_t seed;
    double planet_radius_m;  /* of the bottom of the cloud layer; 2e5 in the article */
    double bottom_m;         /* world height of the bottom at x = z = 0 */
    double thickness_m;      /* of the layer; 280 */
    double coverage;         /* gc, 0..1 */
    double density;          /* gd, >= 0 */
    double texture_scale_m;  /* world metres of one repeat of the weather map; 6e3 */
    double base_repeats;     /* of the base noise within texture_scale_m; 40 */
    double detail_repeats;   /* of the detail noise within texture_scale_m; 60 */
    struct neph_vec3 wind_m; /* the textures' displacement */
};

/* Textures are float32 on both sides: the shader reads the same numbers. Texel (i, j, k) is at
 * (i + 0.5) / side; lookups are (bi/tri)linear and wrap around. */
struct neph_horizon {
    struct neph_horizon_params params;
    float *base;    /* owned; [z][y][x][4]: Perlin-Worley, three octaves of Worley; 0..1 */
    float *detail;  /* owned; [z][y][x][3]: three octaves of Worley; 0..1 */
    float *weather; /* owned; [z][x][4]: low coverage, high coverage, peak height, density; 0..1 */
};

/* Generate the textures: deterministic in the seed, the same bits on every machine. */
enum neph_status neph_horizon_create(const struct neph_horizon_params *params,
                                     struct neph_horizon **horizon, struct neph_diag *diag);

/* NULL is fine. */
void neph_horizon_destroy(struct neph_horizon *horizon);

/* The article's values where it gives them. */
struct neph_horizon_params neph_horizon_defaults(void);

/* Density (dimensionless, >= 0) at a point. `*without_detail` receives the density before the
 * detail noise is taken off (the article's SN), which its lighting model uses; NULL is fine. */
double neph_horizon_density(const struct neph_horizon *horizon, struct neph_vec3 point_m,
                            double *without_detail);

/* Height within the layer, 0 at the bottom, 1 at the top, clamped; the article's ph. */
double neph_horizon_height(const struct neph_horizon *horizon, struct neph_vec3 point_m);

/* No smaller than the density anywhere in the box. */
double neph_horizon_bound(const struct neph_horizon *horizon, const struct neph_bounds *box);

/* The integral of the density along origin + t direction over [t0_m, t1_m] [m], by adaptive
 * quadrature between the surfaces of the shell. `*error_m` receives the estimated absolute error
 * (NULL is fine). */
double neph_horizon_integral_m(const struct neph_horizon *horizon, struct neph_vec3 origin_m,
                               struct neph_vec3 direction, double t0_m, double t1_m,
                               double *error_m);

#endif
