/* SPDX-License-Identifier: MIT */
#include "renderer/sky/walk.h"

#include "scenes/media.h"

#include <math.h>
#include <string.h>

/* --- the path of a ray ------------------------------------------------------------------------ */

/* A monotonic part of a ray, described from its lower end. */
struct leg {
    bool falls;
    double low_m, climb_m; /* altitude of the lower end, and the height difference to the upper end
                            */
    double radius_m;       /* of the lower end */
    double rise_m;         /* radius times |cosine| there */
    double low_t_m;        /* ray parameter of the lower end */
};

struct path {
    int leg_count;
    struct leg legs[2];
    bool grounded;
    double length_m; /* to the ground; +inf: none */
};

static void add_leg(struct path *path, const struct neph_sky_air *air, struct leg leg,
                    double high_m)
{
    leg.radius_m = air->radius_m + leg.low_m;
    leg.climb_m = high_m - leg.low_m;
    if (leg.climb_m > 0.0 || leg.falls)
        path->legs[path->leg_count++] = leg;
}

/* The path of a ray that starts downwards: to the ground, or past its lowest point. */
static struct path falling_path(const struct neph_sky_air *air, const struct neph_sky_ray *ray,
                                double rise_m)
{
    const double r_m = air->radius_m + ray->altitude_m;
    const double above_m2 = ray->altitude_m * (2.0 * air->radius_m + ray->altitude_m);
    const double slant_m2 = rise_m * rise_m - above_m2; /* of the intersection with the ground */
    const double high_m = fmin(ray->altitude_m, air->top_m);
    struct path path = {.length_m = INFINITY};
    if (slant_m2 >= 0.0) {
        path.grounded = true;
        path.length_m = above_m2 / (sqrt(slant_m2) - rise_m);
        add_leg(&path, air,
                (struct leg){.falls = true, .rise_m = sqrt(slant_m2), .low_t_m = path.length_m},
                high_m);
        return path;
    }
    const double low_radius_m = sqrt((r_m - rise_m) * (r_m + rise_m));
    const struct leg turn = {.low_m = ray->altitude_m - rise_m * rise_m / (r_m + low_radius_m),
                             .low_t_m = -rise_m};
    if (turn.low_m >= air->top_m)
        return path;
    struct leg fall = turn;
    fall.falls = true;
    add_leg(&path, air, fall, high_m);
    add_leg(&path, air, turn, air->top_m);
    return path;
}

/* End a path at a solid, in its falling part (the solid is then the lower end) or in its rising
 * part. */
static void stop_path(struct path *path, const struct neph_sky_air *air,
                      const struct neph_sky_ray *ray, double rise_m)
{
    const double r_m = air->radius_m + ray->altitude_m;
    const double growth_m2 = ray->stop_m * (2.0 * rise_m + ray->stop_m);
    const double altitude_m = ray->altitude_m + growth_m2 / (r_m + sqrt(r_m * r_m + growth_m2));
    const double high_m = fmin(ray->altitude_m, air->top_m);
    path->grounded = false;
    path->length_m = ray->stop_m;
    if (rise_m < 0.0 && rise_m + ray->stop_m <= 0.0) {
        path->leg_count = 0;
        if (altitude_m < air->top_m)
            add_leg(path, air,
                    (struct leg){.falls = true,
                                 .low_m = altitude_m,
                                 .rise_m = -(rise_m + ray->stop_m),
                                 .low_t_m = ray->stop_m},
                    high_m);
        return;
    }
    struct leg *rise = &path->legs[path->leg_count - 1];
    if (path->leg_count > 0)
        rise->climb_m = fmax(0.0, fmin(altitude_m, air->top_m) - rise->low_m);
}

static struct path compute_path(const struct neph_sky_air *air, const struct neph_sky_ray *ray)
{
    const double rise_m = (air->radius_m + ray->altitude_m) * ray->cosine;
    struct path path = {.length_m = INFINITY};
    if (rise_m < 0.0)
        path = falling_path(air, ray, rise_m);
    else
        add_leg(&path, air, (struct leg){.low_m = ray->altitude_m, .rise_m = rise_m}, air->top_m);
    if (ray->stop_m > 0.0)
        stop_path(&path, air, ray, rise_m);
    return path;
}

/* Distance from the lower end of a leg at which the ray has climbed by `climb_m`. */
static double distance_m(const struct leg *leg, double climb_m)
{
    const double growth_m2 = climb_m * (2.0 * leg->radius_m + climb_m);
    const double rise_m = leg->rise_m;
    return growth_m2 > 0.0 ? growth_m2 / (rise_m + sqrt(rise_m * rise_m + growth_m2)) : 0.0;
}

/* --- scattering ------------------------------------------------------------------------------- */

struct place {
    double altitude_m, cosine, sun_cosine; /* of the ray and of the sun to the vertical */
};

void neph_sky_find_phases(const struct neph_sky_air *air, struct neph_sky_ray *ray)
{
    for (int i = 0; i < air->layer_count; i++)
        ray->phases[i] = neph_phase_per_sr(&air->layers[i].phase, ray->toward_sun);
}

/* Radiance scattered into the ray per metre, from sunlight. */
static void scatter_sun(const struct neph_sky_air *air, const struct neph_sky_sources *sources,
                        const struct neph_sky_ray *ray, const struct place *place,
                        const struct neph_sky_coefficients *mix, double source[3])
{
    double sun[3];
    neph_sky_sun_transmittance(air, sources->sun, place->altitude_m, place->sun_cosine, sun);
    for (int i = 0; i < air->layer_count; i++)
        for (int c = 0; c < 3; c++)
            source[c] += mix->scattering_per_m[i][c] * ray->phases[i] * sun[c];
}

/* A phase function multiplies moments of degree l by its Legendre coefficient of degree l. */
static void scatter_field(const struct neph_sky_air *air, const struct neph_sky_field *field,
                          const struct neph_sky_ray *ray, const struct place *place,
                          const struct neph_sky_coefficients *mix, double source[3])
{
    double moments[NEPH_SKY_MOMENTS_MAX][3], values[NEPH_SKY_MOMENTS_MAX];
    const double sun_sine = sqrt(fmax(1e-12, 1.0 - place->sun_cosine * place->sun_cosine));
    const double x = (ray->toward_sun - place->cosine * place->sun_cosine) / sun_sine;
    const double across = sqrt(fmax(0.0, 1.0 - place->cosine * place->cosine));
    neph_sky_field_at(air, field, place->altitude_m, place->sun_cosine, moments);
    neph_sky_harmonics(field->degree, fmin(across, fmax(-across, x)), place->cosine, values);
    for (int l = 0; l <= field->degree; l++) {
        double scattering_per_m[3] = {0, 0, 0};
        for (int i = 0; i < air->layer_count; i++)
            for (int c = 0; c < 3; c++)
                scattering_per_m[c] += mix->scattering_per_m[i][c] * air->layers[i].legendre[l];
        for (int k = neph_sky_moments(l - 1); k < neph_sky_moments(l); k++)
            for (int c = 0; c < 3; c++)
                source[c] += scattering_per_m[c] * moments[k][c] * values[k];
    }
}

static void source_at(const struct neph_sky_air *air, const struct neph_sky_sources *sources,
                      const struct neph_sky_ray *ray, const struct place *place,
                      const struct neph_sky_coefficients *mix, double source[3])
{
    source[0] = source[1] = source[2] = 0.0;
    if (sources->alight)
        for (int i = 0; i < air->layer_count; i++)
            for (int c = 0; c < 3; c++)
                source[c] += mix->scattering_per_m[i][c];
    else if (sources->media_scatter)
        scatter_sun(air, sources, ray, place, mix, source);
    if (sources->field)
        scatter_field(air, sources->field, ray, place, mix, source);
}

/* --- integration along the ray ---------------------------------------------------------------- */

/* Add the light of one step with a constant source. */
static void add_step(struct neph_sky_light *light, const double source[3],
                     const double extinction_per_m[3], double length_m)
{
    for (int c = 0; c < 3; c++) {
        const double depth = extinction_per_m[c] * length_m;
        const double reached_m = depth > 1e-9 ? -expm1(-depth) / extinction_per_m[c] : length_m;
        light->volume[c] += light->transmittance[c] * source[c] * reached_m;
        light->transmittance[c] *= exp(-depth);
    }
}

static void walk_leg(const struct neph_sky_air *air, const struct neph_sky_sources *sources,
                     const struct neph_sky_ray *ray, const struct leg *leg, int steps,
                     struct neph_sky_light *light)
{
    const double sun_m = (air->radius_m + ray->altitude_m) * ray->sun_cosine;
    for (int i = 0; i < steps; i++) {
        const int k = leg->falls ? steps - 1 - i : i;
        const double x0 = (double)k / steps, x1 = (k + 1.0) / steps, x = 0.5 * (x0 + x1);
        const double length_m = distance_m(leg, leg->climb_m * x1 * x1) -
                                distance_m(leg, leg->climb_m * x0 * x0);
        const double climb_m = leg->climb_m * x * x, from_low_m = distance_m(leg, climb_m);
        const double r_m = leg->radius_m + climb_m;
        const double t_m = leg->low_t_m + (leg->falls ? -from_low_m : from_low_m);
        const double cosine = (leg->rise_m + from_low_m) / r_m;
        const struct place place = {leg->low_m + climb_m, leg->falls ? -cosine : cosine,
                                    (sun_m + t_m * ray->toward_sun) / r_m};
        const struct neph_sky_coefficients mix = neph_sky_coefficients_at(air, place.altitude_m);
        double source[3];
        source_at(air, sources, ray, &place, &mix, source);
        add_step(light, source, mix.extinction_per_m, length_m);
    }
}

/* Add the light reflected by the ground, attenuated by the air before it. */
static void add_ground(const struct neph_sky_air *air, const struct neph_sky_sources *sources,
                       const struct neph_sky_ray *ray, struct neph_sky_light *light)
{
    double sun[3], sky[3] = {0, 0, 0};
    const double sun_m = (air->radius_m + ray->altitude_m) * ray->sun_cosine;
    const double sun_cosine = (sun_m + light->length_m * ray->toward_sun) / air->radius_m;
    const double lit = ray->shaded ? 0.0 : fmax(0.0, sun_cosine);
    neph_sky_sun_transmittance(air, sources->sun, 0.0, sun_cosine, sun);
    if (sources->field)
        neph_sky_field_ground(sources->field, sun_cosine, sky);
    for (int c = 0; c < 3; c++)
        light->radiance[c] += light->transmittance[c] * air->ground_albedo[c] / M_PI *
                              (lit * sun[c] + sky[c]);
}

/* The clamped cosine has the coefficients pi, 2 pi / 3, pi / 4, 0, -pi / 24; higher ones are below
 * 1 %. */
void neph_sky_irradiance(const struct neph_sky_air *air, const struct neph_sky_sources *sources,
                         double altitude_m, double sun_cosine, struct neph_vec3 normal,
                         bool sees_sun, double irradiance[3])
{
    static const double cosine_parts[5] = {M_PI, 2.0 * M_PI / 3.0, M_PI / 4.0, 0.0, -M_PI / 24.0};
    const double sun_sine = sqrt(fmax(0.0, 1.0 - sun_cosine * sun_cosine));
    const double lit = sees_sun ? fmax(0.0, normal.x * sun_sine + normal.z * sun_cosine) : 0.0;
    double moments[NEPH_SKY_MOMENTS_MAX][3], values[NEPH_SKY_MOMENTS_MAX], sky[3] = {0, 0, 0};
    neph_sky_sun_transmittance(air, sources->sun, altitude_m, sun_cosine, irradiance);
    if (sources->field) {
        const int degree = sources->field->degree < 4 ? sources->field->degree : 4;
        neph_sky_field_at(air, sources->field, altitude_m, sun_cosine, moments);
        neph_sky_harmonics(degree, normal.x, normal.z, values);
        for (int l = 0; l <= degree; l++)
            for (int k = neph_sky_moments(l - 1); k < neph_sky_moments(l); k++)
                for (int c = 0; c < 3; c++)
                    sky[c] += cosine_parts[l] * moments[k][c] * values[k];
    }
    for (int c = 0; c < 3; c++)
        irradiance[c] = lit * irradiance[c] + fmax(0.0, sky[c]);
}

double neph_sky_length_m(const struct neph_sky_air *air, const struct neph_sky_ray *ray)
{
    return compute_path(air, ray).length_m;
}

struct neph_sky_light neph_sky_walk(const struct neph_sky_air *air,
                                    const struct neph_sky_sources *sources,
                                    const struct neph_sky_ray *ray, int steps)
{
    const struct path path = compute_path(air, ray);
    struct neph_sky_light light = {.transmittance = {1, 1, 1}, .length_m = path.length_m};
    const int steps_of_leg = path.leg_count > 1 ? (steps + 1) / 2 : steps;
    for (int i = 0; i < path.leg_count; i++)
        walk_leg(air, sources, ray, &path.legs[i], steps_of_leg, &light);
    memcpy(light.radiance, light.volume, sizeof(light.radiance));
    if (path.grounded && !sources->alight)
        add_ground(air, sources, ray, &light);
    return light;
}
