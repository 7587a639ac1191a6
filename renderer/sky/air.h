/* SPDX-License-Identifier: MIT
 *
 * A spherically symmetric atmosphere, made of a scene's shells and tents; properties depend only on
 * altitude. All results of renderer/sky/ are for a solar irradiance of 1 in every channel; callers
 * multiply by the actual irradiance.
 */
#ifndef NEPH_RENDERER_SKY_AIR_H
#define NEPH_RENDERER_SKY_AIR_H

#include "renderer/shaders/constants.h"
#include "scenes/scene.h"

/* Maximum degree of the spherical harmonics of multiply scattered light. */
enum { NEPH_SKY_DEGREE_MAX = NEPH_GPU_SKY_DEGREE_MAX };

struct neph_sky_layer {
    bool is_tent;                                    /* tent profile; false: exponential */
    double middle_m;                                 /* of a tent: altitude of the peak */
    double scale_m;                                  /* scale height, or half the width of a tent */
    double extinction_per_m[3], scattering_per_m[3]; /* at density 1 */
    struct neph_phase phase;
    double legendre[NEPH_SKY_DEGREE_MAX + 1]; /* Legendre coefficients of the phase function: 1,
                                                 mean cosine, ... */
};

struct neph_sky_air {
    double radius_m; /* of the ground */
    double top_m;    /* altitude of the top: no air above it */
    double ground_albedo[3];
    int layer_count;
    struct neph_sky_layer layers[NEPH_SCENE_MEDIA_MAX];
    struct neph_vec3 center_m;
};

/* Coefficients at one altitude. */
struct neph_sky_coefficients {
    double extinction_per_m[3];
    double scattering_per_m[NEPH_SCENE_MEDIA_MAX][3]; /* per layer */
};

/* The atmosphere of a scene. False, with the reason as text, when the scene has none, or has other
 * media, a first solid that is not the ground, bounds that cut the atmosphere, or light sources
 * other than the sun. */
bool neph_sky_read_air(const struct neph_scene *scene, struct neph_sky_air *air, char *reason,
                       size_t reason_size);

struct neph_sky_coefficients neph_sky_coefficients_at(const struct neph_sky_air *air,
                                                      double altitude_m);

/* Optical depth of each channel from an altitude to the top of the atmosphere, at a cosine to the
 * vertical: closed forms, in double. The ground does not end the ray. */
void neph_sky_depth_to_space(const struct neph_sky_air *air, double altitude_m, double cosine,
                             double depth[3]);

#endif
