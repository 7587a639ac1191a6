/* SPDX-License-Identifier: MIT
 *
 * The fog of game engines by their formulas, in double precision: the CPU reference of the shader
 * fog_look.glsl, and the subject of a study that compares it with transport.h. Every pixel is a
 * closed form of camera, direction and distance, without samples.
 *
 * Unreal (HeightFogCommon.ush; density and falloff per metre, base 2):
 *   density(y) = d 2^-e, e = max(-127, f (y - h))
 *   I = sum over layers of density(y0) L(f dy) l,  L(F) = (1 - 2^-F) / F, F = max(-127, f dy)
 *       and ln2 - ln2^2 F / 2 for |F| <= 0.01
 *   T = max(2^-I, 1 - max_opacity)
 *   light = inscattering (1 - T) + directional cos^e (1 - 2^-(I max(l - start, 0) / l))
 * l is the part of the ray between the start and the end of the fog, where the end is a horizontal
 * distance; dy is the rise over that part, y0 the height at its start. L is ln 2 times the mean
 * over the part, and base 2 adds another ln 2: the extinction is (ln 2)^2 d (scenes/media.h).
 *
 * Filament (surface_fog.fs; natural base): one layer, the mean of the whole ray from the camera,
 *   I = sigma(y0) (1 - e^-F) / F max(l - start, 0), F = b dy; sigma(y0) for |F| <= 0.00125
 *   opacity = min(1 - e^-I, max_opacity)
 * and light as above, with e^-, from the camera on.
 */
#ifndef NEPH_TRUTH_FOG_LOOK_H
#define NEPH_TRUTH_FOG_LOOK_H

#include "scenes/scene.h"

/* Lower limit of Unreal's exponents: 2^127 is the largest power of two in float32. */
#define NEPH_FOG_EXPONENT_MIN (-127.0)

/* Below these the series replaces the closed form, in base 2 and in base e. */
#define NEPH_FOG_UNREAL_LEVEL 0.01
#define NEPH_FOG_FILAMENT_LEVEL 0.00125

/* A layer in Unreal's base: density 2^-(falloff (y - height)). */
struct neph_unreal_layer {
    double density_per_m, falloff_per_m, height_m;
};
struct neph_unreal_layer neph_unreal_layer_from_fog(const struct neph_fog_layer *layer);

/* Parts of the formulas: Unreal's density at a height, and L; Filament's I of a whole ray. */
double neph_unreal_density_per_m(const struct neph_unreal_layer *layer, double y_m);
double neph_unreal_mean(double exponent);
double neph_filament_depth(const struct neph_fog_layer *layer, double y_m, double k_y,
                           double length_m);

/* cos^exponent towards the light, else 0: the engines' pow(0, 0) is NaN on some devices. */
double neph_fog_lobe(double cosine, double exponent);

struct neph_fog_look_light {
    double transmittance;
    double opacity;         /* 1 - transmittance, with full precision */
    struct neph_rgb volume; /* added by the fog [W m^-2 sr^-1] */
};

/* The light along a ray of a length, which may be infinite, or 0 for no fog. `look` replaces the
 * scene's own. The scene must satisfy neph_fog_look_can_model(), or have no media. */
struct neph_fog_look_light neph_fog_look_ray(const struct neph_scene *scene,
                                             const struct neph_fog_look *look,
                                             enum neph_fog_model model, struct neph_vec3 origin_m,
                                             struct neph_vec3 direction, double length_m);

#endif
