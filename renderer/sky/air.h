/* SPDX-License-Identifier: MIT
 *
 * An atmosphere that is the same all around a ball: what a scene's shells and tents make up, by
 * altitude alone. The sun's irradiance is 1 in every channel wherever the sky is computed; who
 * shows it multiplies.
 */
#ifndef NEPH_RENDERER_SKY_AIR_H
#define NEPH_RENDERER_SKY_AIR_H

#include "renderer/shaders/constants.h"
#include "scenes/scene.h"

/* The highest degree of spherical harmonics of the light that is scattered more than once. */
enum { NEPH_SKY_DEGREE_MAX = NEPH_GPU_SKY_DEGREE_MAX };

struct neph_sky_layer {
    bool is_tent;                                    /* else exponential */
    double middle_m;                                 /* of a tent: the altitude of its peak */
    double scale_m;                                  /* scale height, or half the width of a tent */
    double extinction_per_m[3], scattering_per_m[3]; /* where the density is 1 */
    struct neph_phase phase;
    double legendre[NEPH_SKY_DEGREE_MAX + 1]; /* of the phase function: 1, mean cosine, ... */
};

struct neph_sky_air {
    double radius_m; /* of the ground */
    double top_m;    /* altitude above which nothing is */
    double ground_albedo[3];
    int layer_count;
    struct neph_sky_layer layers[NEPH_SCENE_MEDIA_MAX];
    struct neph_vec3 center_m;
};

/* At an altitude. */
struct neph_sky_mix {
    double extinction_per_m[3];
    double scattering_per_m[NEPH_SCENE_MEDIA_MAX][3]; /* of each layer */
};

/* The atmosphere of a scene; false, with the reason in words, where it has none or is more than
 * that: other media, a first solid that is not the ground, bounds that cut it, light from elsewhere
 * than the sun. */
bool neph_sky_air_of(const struct neph_scene *scene, struct neph_sky_air *air, char *reason,
                     size_t reason_size);

struct neph_sky_mix neph_sky_mix_at(const struct neph_sky_air *air, double altitude_m);

/* Optical depth of each channel from an altitude on, upwards at a cosine to the vertical, out of
 * the atmosphere: closed forms, in double. The ground stops nothing. */
void neph_sky_depth_to_space(const struct neph_sky_air *air, double altitude_m, double cosine,
                             double depth[3]);

#endif
