/* SPDX-License-Identifier: MIT */
#include "truth/airlight.h"

#include "scenes/lights.h"
#include "scenes/media.h"
#include "scenes/phase_colour.h"
#include "truth/cuts.h"
#include "truth/lamp_peak.h"
#include "truth/pieces.h"

#include <math.h>

/* For media with kinks inside of pieces, as in truth/transport.c. */
static const double rough_tolerance = 1e-11;

/* Parametrisation of the ray around the foot of the light's perpendicular: within h of the foot by
 * the angle theta, beyond by psi = atan(h / s) / h, which is 1 / s for a ray that passes close.
 * Both dtheta / h and dpsi equal dt / d^2. */
enum zone { BEFORE, NEAR, BEHIND, ZONE_COUNT };

struct airlight {
    const struct neph_pieces *pieces;
    const struct neph_light *light;
    double foot_m, height_m; /* light's position along the ray, and distance from the ray */
    enum zone zone;
};

static double zone_sign(enum zone zone)
{
    return zone == BEFORE ? -1.0 : 1.0;
}

static double distance_at_variable(const struct airlight *a, double x)
{
    if (a->zone == NEAR)
        return a->foot_m + a->height_m * tan(x);
    const double angle = a->height_m * x;
    /* h / tan(h x), without 0 / 0 */
    const double s_m = angle < 1e-8 ? 1.0 / x : a->height_m / tan(angle);
    return a->foot_m + zone_sign(a->zone) * s_m;
}

static double variable_at_distance(const struct airlight *a, double t_m)
{
    const double s_m = t_m - a->foot_m;
    if (a->zone == NEAR)
        return atan(s_m / a->height_m);
    const double slope = a->height_m / fabs(s_m);
    return slope < 1e-8 ? 1.0 / fabs(s_m) : atan(slope) / a->height_m;
}

static struct neph_rgb scattered_per_m_sr(const struct neph_scene *scene, struct neph_vec3 point_m,
                                          double cosine)
{
    struct neph_rgb sum = {0, 0, 0};
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_medium *medium = &scene->media[m];
        const struct neph_rgb per_m = neph_rgb_scale(neph_phase_rgb_per_sr(&medium->phase, cosine),
                                                     neph_medium_extinction_per_m(medium, point_m));
        sum = neph_rgb_add(
            sum, neph_rgb_mul(neph_rgb_mul(medium->albedo, medium->extinction_color), per_m));
    }
    return sum;
}

static double through(double source, double depth)
{
    const double light = exp(-depth);
    return light > 0.0 ? source * light : 0.0; /* avoids 0 * inf in opaque media */
}

/* Integrand: radiance per unit of the zone's variable of integration. */
static void source(double x, void *context, double value[3])
{
    const struct airlight *a = context;
    const struct neph_pieces *pieces = a->pieces;
    const double t_m = distance_at_variable(a, x);
    const struct neph_vec3 point_m = neph_vec3_along(pieces->origin_m, pieces->direction, t_m);
    const struct neph_lit lit = neph_light_at(a->light, point_m);
    const double part = neph_light_falloff(a->light, neph_vec3_scale(lit.direction, -1.0));
    const struct neph_rgb scattered = neph_rgb_scale(
        neph_rgb_mul(scattered_per_m_sr(pieces->scene, point_m,
                                        neph_vec3_dot(pieces->direction, lit.direction)),
                     a->light->intensity_w_per_sr),
        part);
    value[0] = value[1] = value[2] = 0.0;
    if (scattered.r == 0.0 && scattered.g == 0.0 && scattered.b == 0.0)
        return;
    const struct neph_rgb depth = neph_rgb_add(
        neph_pieces_depth_to(pieces, t_m),
        neph_scene_optical_depth(pieces->scene, point_m, lit.direction, 0.0, lit.distance_m));
    value[0] = through(scattered.r, depth.r);
    value[1] = through(scattered.g, depth.g);
    value[2] = through(scattered.b, depth.b);
}

/* The pieces of the ray in a zone, in its variable of integration. */
static int clip_pieces_to_zone(const struct airlight *a, struct neph_interval *places)
{
    const double low_m[ZONE_COUNT] = {-INFINITY, a->foot_m - a->height_m, a->foot_m + a->height_m};
    const double high_m[ZONE_COUNT] = {low_m[NEAR], low_m[BEHIND], INFINITY};
    int count = 0;
    for (int i = 0; i < a->pieces->count; i++) {
        const double t0_m = fmax(a->pieces->at_m[i].low, low_m[a->zone]);
        const double t1_m = fmin(a->pieces->at_m[i].high, high_m[a->zone]);
        if (!(t0_m < t1_m))
            continue;
        const double x0 = variable_at_distance(a, t0_m), x1 = variable_at_distance(a, t1_m);
        if (x0 != x1)
            places[count++] = (struct neph_interval){fmin(x0, x1), fmax(x0, x1)};
    }
    return count;
}

static double add_zone(struct airlight *a, struct neph_rgb *radiance)
{
    struct neph_interval places[NEPH_CUTS_MAX];
    double result[3];
    const int count = clip_pieces_to_zone(a, places);
    if (count == 0)
        return 0.0;
    const double error = neph_pieces_integrate(a->pieces->scene, source, a, places, count,
                                               rough_tolerance, result);
    const double per = a->zone == NEAR ? 1.0 / a->height_m : 1.0;
    *radiance = neph_rgb_add(
        *radiance, neph_rgb_scale((struct neph_rgb){result[0], result[1], result[2]}, per));
    return error * per;
}

static void add_infinity(struct neph_rgb intensity, struct neph_rgb *radiance)
{
    radiance->r += intensity.r > 0.0 ? INFINITY : 0.0;
    radiance->g += intensity.g > 0.0 ? INFINITY : 0.0;
    radiance->b += intensity.b > 0.0 ? INFINITY : 0.0;
}

double neph_airlight(const struct neph_scene *scene, struct neph_vec3 origin_m,
                     struct neph_vec3 direction, double t0_m, double t1_m,
                     struct neph_rgb *radiance)
{
    double error = 0.0;
    struct neph_pieces pieces; /* not zero-initialised: it is large */
    pieces.scene = scene;
    pieces.origin_m = origin_m;
    pieces.direction = direction;
    for (int i = 0; i < scene->light_count; i++) {
        const struct neph_light *light = &scene->lights[i];
        const struct neph_vec3 way_m = neph_vec3_sub(light->position_m, origin_m);
        struct airlight airlight = {.pieces = &pieces, .light = light};
        airlight.foot_m = neph_vec3_dot(way_m, direction);
        airlight.height_m = neph_vec3_length(neph_vec3_along(way_m, direction, -airlight.foot_m));
        pieces.count = neph_light_lit_pieces(scene, light, origin_m, direction, t0_m, t1_m,
                                             pieces.at_m);
        if (pieces.count == 0)
            continue;
        if (neph_is_light_peak(scene, light, origin_m, direction))
            add_infinity(light->intensity_w_per_sr, radiance);
        neph_pieces_sum_depths(&pieces);
        for (airlight.zone = BEFORE; airlight.zone < ZONE_COUNT; airlight.zone++)
            error += add_zone(&airlight, radiance);
    }
    return error;
}

struct neph_rgb neph_reflect_lights(const struct neph_scene *scene, struct neph_vec3 point_m,
                                    const struct neph_hit *hit)
{
    struct neph_rgb sum = {0, 0, 0};
    for (int i = 0; i < scene->light_count; i++) {
        const struct neph_lit lit = neph_light_at(&scene->lights[i], point_m);
        const double cosine = neph_hit_cosine(hit, lit.direction);
        if (cosine <= 0.0 || !neph_scene_is_visible(scene, point_m, scene->lights[i].position_m))
            continue;
        const struct neph_rgb depth = neph_scene_optical_depth(scene, point_m, lit.direction, 0.0,
                                                               lit.distance_m);
        const struct neph_rgb light = {exp(-depth.r), exp(-depth.g), exp(-depth.b)};
        sum = neph_rgb_add(
            sum, neph_rgb_scale(neph_rgb_mul(lit.irradiance_w_per_m2, light), cosine / M_PI));
    }
    return sum;
}
