/* SPDX-License-Identifier: MIT
 *
 * Light along a ray through the atmosphere: to the ground or out into space. The steps of a part of
 * the ray that rises are even in the square root of the climb, so that they are short where the air
 * is dense, whether the ray is level or straight; a part that falls is the same backwards. In each
 * step the light of its middle is scattered all along it (energy-conserving).
 */
#ifndef NEPH_RENDERER_SKY_WALK_H
#define NEPH_RENDERER_SKY_WALK_H

#include "renderer/sky/field.h"
#include "renderer/sky/sun_table.h"

/* What is scattered. */
struct neph_sky_sources {
    const struct neph_sky_sun_table *sun;
    const struct neph_sky_field *field; /* NULL: light is scattered once */
    bool media_scatter;                 /* sunlight */
    bool alight; /* radiance 1 from everywhere in place of sun, field and ground */
};

struct neph_sky_ray {
    double altitude_m, cosine; /* of its start, to the vertical there */
    double sun_cosine;         /* of the sun to that vertical */
    double toward_sun;         /* cosine between ray and sun, the same all along the ray */
    double phases[NEPH_SCENE_MEDIA_MAX]; /* of the layers, at that angle [1/sr] */
    double stop_m;                       /* where something is before the ground; 0: nothing */
    bool shaded;                         /* that hides the sun from the ground, where it is met */
};

/* The phases of a ray, which has all else. */
void neph_sky_find_phases(const struct neph_sky_air *air, struct neph_sky_ray *ray);

struct neph_sky_light {
    double radiance[3], volume[3]; /* all, and that of media; of a sun of irradiance 1 */
    double transmittance[3];
    double length_m; /* to the ground; +inf: there is none */
};

/* Light of the sun, at irradiance 1, and of the field onto a surface at an altitude; `normal` is in
 * the frame of the place: x towards the sun over the ground, z up. Moments of the field become
 * irradiance by the coefficients of the cosine (R. Ramamoorthi, P. Hanrahan, "An efficient
 * representation for irradiance environment maps", SIGGRAPH 2001). */
void neph_sky_irradiance(const struct neph_sky_air *air, const struct neph_sky_sources *sources,
                         double altitude_m, double sun_cosine, struct neph_vec3 normal,
                         bool sees_sun, double irradiance[3]);

/* To the ground; +inf: it meets none. */
double neph_sky_length_m(const struct neph_sky_air *air, const struct neph_sky_ray *ray);

struct neph_sky_light neph_sky_walk(const struct neph_sky_air *air,
                                    const struct neph_sky_sources *sources,
                                    const struct neph_sky_ray *ray, int steps);

#endif
