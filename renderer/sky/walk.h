/* SPDX-License-Identifier: MIT
 *
 * Radiance along a ray through the atmosphere, to the ground or to space. Steps of a rising part
 * are uniform in the square root of the climb, so they are short where the air is dense, for
 * horizontal and vertical rays; a falling part is the same in reverse. The light at the middle of a
 * step is scattered all along it (energy-conserving integration).
 */
#ifndef NEPH_RENDERER_SKY_WALK_H
#define NEPH_RENDERER_SKY_WALK_H

#include "renderer/sky/field.h"
#include "renderer/sky/sun_table.h"

/* Sources of light. */
struct neph_sky_sources {
    const struct neph_sky_sun_table *sun;
    const struct neph_sky_field *field; /* NULL: single scattering */
    bool media_scatter;                 /* media scatter sunlight */
    bool alight; /* radiance 1 from everywhere, instead of sun, field and ground */
};

struct neph_sky_ray {
    double altitude_m, cosine;           /* of the start, relative to the vertical there */
    double sun_cosine;                   /* of the sun, relative to that vertical */
    double toward_sun;                   /* cosine between ray and sun, constant along the ray */
    double phases[NEPH_SCENE_MEDIA_MAX]; /* phase functions of the layers at that angle [1/sr] */
    double stop_m;                       /* distance of a solid before the ground; 0: none */
    bool shaded;                         /* that solid shadows the ground point of the ray */
};

/* Set the phase values of a ray; its other fields are inputs. */
void neph_sky_find_phases(const struct neph_sky_air *air, struct neph_sky_ray *ray);

struct neph_sky_light {
    double radiance[3], volume[3]; /* in total, and from media; for a solar irradiance of 1 */
    double transmittance[3];
    double length_m; /* to the ground; +inf: none */
};

/* Irradiance of a surface at an altitude by a sun of irradiance 1 and by the field. `normal` is in
 * the local frame: x the horizontal direction towards the sun, z up. Moments of the field become
 * irradiance by the harmonic coefficients of the clamped cosine (R. Ramamoorthi, P. Hanrahan, "An
 * efficient representation for irradiance environment maps", SIGGRAPH 2001). */
void neph_sky_irradiance(const struct neph_sky_air *air, const struct neph_sky_sources *sources,
                         double altitude_m, double sun_cosine, struct neph_vec3 normal,
                         bool sees_sun, double irradiance[3]);

/* Distance to the ground; +inf: none. */
double neph_sky_length_m(const struct neph_sky_air *air, const struct neph_sky_ray *ray);

struct neph_sky_light neph_sky_walk(const struct neph_sky_air *air,
                                    const struct neph_sky_sources *sources,
                                    const struct neph_sky_ray *ray, int steps);

#endif
