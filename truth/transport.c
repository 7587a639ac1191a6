/* SPDX-License-Identifier: MIT
 *
 * Single scattering along a ray o + t d:
 *   L = integral of sum_m sigma_s,m(t) p_m(cos) E exp(-tau_view(t) - tau_sun(t)) V(t) dt,
 * with V the sun's visibility, 0 or 1, per colour channel. V is exact (the shadow of each solid is
 * one interval), so the lit part of the ray is a set of pieces (truth/cuts.h). If the exponent is
 * affine in the optical depth from the camera (homogeneous media; one height fog without sides),
 * the integral over a piece is a phi function, in closed form. Otherwise it is computed by
 * quadrature. Point lights are in truth/airlight.h.
 *
 * Light that media emit (scenes/emission.h) is
 *   integral of sum_m sigma_t,m(t) glow_m exp(-tau_view(t)) dt,
 * which is glow * (1 - exp(-tau)) if all media have the same glow, and else computed by quadrature.
 */
#include "truth/transport.h"

#include "scenes/emission.h"
#include "scenes/media.h"
#include "scenes/medium_bounds.h"
#include "scenes/phase_colour.h"
#include "scenes/solids.h"
#include "scenes/surfaces.h"
#include "truth/airlight.h"
#include "truth/cuts.h"
#include "truth/pieces.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

/* Beyond this optical depth less than 1e-19 of the light remains: negligible in double precision
 * beside light from nearer. */
static const double opaque_optical_depth = 45.0;

/* No light arrives from behind this optical depth in double precision, however bright it is
 * there. */
static const double dark_optical_depth = 760.0;

/* Quadrature tolerance, relative to the total, per piece, for media with kinks inside the
 * pieces: grids, where sun rays pass the edges of their cells, and shells, where sun rays graze
 * the ground. */
static const double rough_tolerance = 1e-10;

struct ray {
    const struct neph_scene *scene;
    struct neph_vec3 origin_m, direction;
    double end_m;                                       /* first solid, or +inf */
    struct neph_rgb phase_per_sr[NEPH_SCENE_MEDIA_MAX]; /* towards the camera */
};

static struct neph_vec3 ray_point(const struct ray *ray, double t_m)
{
    return neph_vec3_along(ray->origin_m, ray->direction, t_m);
}

static struct neph_rgb view_optical_depth(const struct ray *ray, double t0_m, double t1_m)
{
    return neph_scene_optical_depth(ray->scene, ray->origin_m, ray->direction, t0_m, t1_m);
}

static struct neph_rgb sun_optical_depth(const struct neph_scene *scene, struct neph_vec3 point_m)
{
    return neph_scene_optical_depth(scene, point_m, scene->sun.direction, 0.0, INFINITY);
}

static bool is_grey(struct neph_rgb a)
{
    return a.r == a.g && a.g == a.b;
}

static struct neph_rgb transmittance(struct neph_rgb optical_depth)
{
    const double r = exp(-optical_depth.r);
    if (is_grey(optical_depth)) /* as in most scenes */
        return (struct neph_rgb){r, r, r};
    return (struct neph_rgb){r, exp(-optical_depth.g), exp(-optical_depth.b)};
}

/* ---- quadrature ---- */

/* A ray and its pieces. */
struct work {
    const struct ray *ray;
    struct neph_pieces pieces;
};

static void start_work(struct work *work, const struct ray *ray)
{
    work->ray = ray;
    work->pieces.scene = ray->scene;
    work->pieces.origin_m = ray->origin_m;
    work->pieces.direction = ray->direction;
}

/* Radiance per metre scattered towards the camera, for sunlight of irradiance 1. */
static struct neph_rgb scattered_per_m(const struct ray *ray, struct neph_vec3 point_m)
{
    struct neph_rgb sum = {0, 0, 0};
    for (int m = 0; m < ray->scene->medium_count; m++) {
        const struct neph_medium *medium = &ray->scene->media[m];
        const double extinction_per_m = neph_medium_extinction_per_m(medium, point_m);
        sum = neph_rgb_add(sum,
                           neph_rgb_mul(neph_rgb_mul(medium->albedo, medium->extinction_color),
                                        neph_rgb_scale(ray->phase_per_sr[m], extinction_per_m)));
    }
    return sum;
}

/* In-scattered radiance per metre at distance t, lit. */
static void source(double t_m, void *context, double value[3])
{
    const struct work *work = context;
    const struct neph_scene *scene = work->ray->scene;
    const struct neph_vec3 point_m = ray_point(work->ray, t_m);
    const struct neph_rgb scattered = neph_rgb_mul(scattered_per_m(work->ray, point_m),
                                                   scene->sun.irradiance_w_per_m2);
    value[0] = value[1] = value[2] = 0.0;
    if (scattered.r == 0.0 && scattered.g == 0.0 && scattered.b == 0.0)
        return; /* the sun is irrelevant */
    const struct neph_rgb light = transmittance(
        neph_rgb_add(neph_pieces_depth_to(&work->pieces, t_m), sun_optical_depth(scene, point_m)));
    value[0] = light.r > 0.0 ? scattered.r * light.r : 0.0; /* avoids 0 * inf in opaque media */
    value[1] = light.g > 0.0 ? scattered.g * light.g : 0.0;
    value[2] = light.b > 0.0 ? scattered.b * light.b : 0.0;
}

static double integrate_pieces(neph_integrand *integrand, struct work *work,
                               struct neph_rgb *volume)
{
    double result[3];
    struct neph_pieces *pieces = &work->pieces;
    neph_pieces_sum_depths(pieces);
    const double error = neph_pieces_integrate(work->ray->scene, integrand, work, pieces->at_m,
                                               pieces->count, rough_tolerance, result);
    *volume = (struct neph_rgb){result[0], result[1], result[2]};
    return error;
}

/* ---- end of the useful range ----------------------------------------------------------------- */

/* The smallest depth over the channels with any extinction. */
static double least_depth(const struct ray *ray, struct neph_rgb depth)
{
    double least = INFINITY;
    bool any[3] = {false, false, false};
    for (int m = 0; m < ray->scene->medium_count; m++) {
        const struct neph_rgb color = ray->scene->media[m].extinction_color;
        any[0] = any[0] || color.r > 0.0;
        any[1] = any[1] || color.g > 0.0;
        any[2] = any[2] || color.b > 0.0;
    }
    least = any[0] ? fmin(least, depth.r) : least;
    least = any[1] ? fmin(least, depth.g) : least;
    return any[2] ? fmin(least, depth.b) : least;
}

static double view_least_depth(const struct ray *ray, double t_m)
{
    return least_depth(ray, view_optical_depth(ray, 0.0, t_m));
}

/* The distance at which every channel's optical depth from the camera has reached `target`, by
 * bisection. */
static double distance_at_optical_depth(const struct ray *ray, double target, double t0_m,
                                        double t1_m)
{
    /* Nearer than any surface to the camera; ends the search in an infinite density. */
    const double nearest_m = 1e-12;
    while (t1_m - t0_m > 1e-7 * t1_m && t1_m > nearest_m) {
        const double middle_m = 0.5 * (t0_m + t1_m);
        if (view_least_depth(ray, middle_m) < target)
            t0_m = middle_m;
        else
            t1_m = middle_m;
    }
    return t1_m;
}

/* Whether the remainder of the ray is significant beside the whole, in any channel. An infinite
 * remainder always is, even beside an infinite whole. */
static bool counts(struct neph_rgb rest, struct neph_rgb whole)
{
    return rest.r > 1e-16 * fmin(whole.r, 1e300) || rest.g > 1e-16 * fmin(whole.g, 1e300) ||
           rest.b > 1e-16 * fmin(whole.b, 1e300);
}

/* The logarithm of the sunlight that arrives from a distance, in the brightest channel. */
static double log_light(const struct ray *ray, double t_m)
{
    const struct neph_vec3 point_m = ray_point(ray, t_m);
    if (!neph_scene_is_sun_visible(ray->scene, point_m))
        return -INFINITY;
    return -least_depth(ray, neph_rgb_add(view_optical_depth(ray, 0.0, t_m),
                                          sun_optical_depth(ray->scene, point_m)));
}

/* The maximum of that, at sample points between two optical depths. */
static double most_log_light(const struct ray *ray, double depth0, double depth1, double end_m)
{
    enum { POINTS = 16 };
    double most = -INFINITY;
    for (int i = 0; i < POINTS; i++) {
        const double depth = depth0 + (depth1 - depth0) * (i + 0.5) / POINTS;
        most = fmax(most, log_light(ray, distance_at_optical_depth(ray, depth, 0.0, end_m)));
    }
    return most;
}

/* Whether sunlight from behind the opaque part is significant beside light from nearer. On an
 * infinite ray none comes from behind. */
static bool is_lit_from_behind(const struct ray *ray, double whole, double end_m)
{
    const double opaque = opaque_optical_depth;
    if (isinf(whole) || !ray->scene->sun.present)
        return false;
    const double here = most_log_light(ray, 0.0, opaque, end_m);
    const double there = fmax(most_log_light(ray, opaque, whole, end_m),
                              most_log_light(ray, fmax(opaque, whole - opaque), whole, end_m));
    return there > here - opaque;
}

/* A finite distance behind which there is no medium; for an unbounded medium, behind an optical
 * depth of `opaque`. */
static double finite_end_m(const struct ray *ray, struct neph_rgb whole, double opaque)
{
    const bool is_endless = isinf(least_depth(ray, whole));
    double end_m = 1.0;
    if (isfinite(ray->end_m))
        return ray->end_m;
    while (end_m < 1e300 && !(is_endless && view_least_depth(ray, end_m) >= opaque) &&
           counts(view_optical_depth(ray, end_m, INFINITY), whole))
        end_m *= 2.0;
    return end_m;
}

/* A finite distance behind which nothing is visible: opaque, or no medium. */
static double useful_end_m(const struct ray *ray)
{
    const struct neph_rgb whole = view_optical_depth(ray, 0.0, ray->end_m);
    double end_m = finite_end_m(ray, whole, opaque_optical_depth);
    if (least_depth(ray, whole) > opaque_optical_depth &&
        !is_lit_from_behind(ray, least_depth(ray, whole), end_m))
        end_m = distance_at_optical_depth(ray, opaque_optical_depth, 0.0, end_m);
    return end_m;
}

/* ---- closed forms ---- */

static bool all_homogeneous(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++) {
        if (!neph_medium_is_fog(&scene->media[m]))
            return false;
        for (int l = 0; l < scene->media[m].layer_count; l++)
            if (scene->media[m].layers[l].falloff_per_m != 0.0)
                return false;
    }
    return true;
}

/* Whether the only medium is a height fog with one falloff that sun rays leave through its top or
 * bottom, or never. Then on a straight ray both optical depths are affine in the density, so one is
 * affine in the other. */
static bool one_fog_without_sides(const struct neph_scene *scene)
{
    const struct neph_medium *fog = &scene->media[0];
    if (scene->medium_count != 1 || !neph_medium_is_fog(fog))
        return false;
    for (int l = 1; l < fog->layer_count; l++)
        if (fog->layers[l].falloff_per_m != fog->layers[0].falloff_per_m)
            return false;
    return isinf(fog->bounds.min_m.x) && isinf(fog->bounds.max_m.x) && isinf(fog->bounds.min_m.z) &&
           isinf(fog->bounds.max_m.z);
}

/* The total optical depth of the light that is scattered at distance t. */
static struct neph_rgb way_optical_depth(const struct ray *ray, double t_m)
{
    return neph_rgb_add(view_optical_depth(ray, 0.0, t_m),
                        sun_optical_depth(ray->scene, ray_point(ray, t_m)));
}

/* Radiance per optical depth along the ray, before attenuation. */
static struct neph_rgb scattered_per_depth(const struct ray *ray, double t_m)
{
    struct neph_rgb scattered = {0, 0, 0}, extinction = {0, 0, 0};
    for (int m = 0; m < ray->scene->medium_count; m++) {
        const struct neph_medium *medium = &ray->scene->media[m];
        /* A single medium has the full part, even where its density underflows. */
        const double part_per_m = ray->scene->medium_count == 1
                                      ? 1.0
                                      : neph_medium_extinction_per_m(medium, ray_point(ray, t_m));
        const struct neph_rgb part = neph_rgb_scale(medium->extinction_color, part_per_m);
        extinction = neph_rgb_add(extinction, part);
        scattered = neph_rgb_add(
            scattered, neph_rgb_mul(neph_rgb_mul(medium->albedo, part), ray->phase_per_sr[m]));
    }
    const struct neph_rgb sun = ray->scene->sun.irradiance_w_per_m2;
    return (struct neph_rgb){extinction.r > 0.0 ? scattered.r / extinction.r * sun.r : 0.0,
                             extinction.g > 0.0 ? scattered.g / extinction.g * sun.g : 0.0,
                             extinction.b > 0.0 ? scattered.b / extinction.b * sun.b : 0.0};
}

/* One channel of a piece on which the total depth (way0 to way1) is affine in the optical depth
 * from the camera: the value at the brighter end, times phi of the difference. */
static double closed_channel(double way0, double way1, double depth)
{
    const double light = exp(-fmin(way0, way1));
    return light == 0.0 || depth == 0.0 ? 0.0 : depth * light * neph_phi(fabs(way1 - way0));
}

/* Extrapolate a line to both ends of a piece, from two points at a part `inset` from the ends. */
static void extend(double a, double b, double inset, double *end0, double *end1)
{
    const double slope = isinf(a) || isinf(b) ? 0.0 : (b - a) / (1.0 - 2.0 * inset);
    *end0 = a - inset * slope;
    *end1 = b + inset * slope;
}

static void add_closed_piece(const struct ray *ray, double t0_m, double t1_m, bool homogeneous,
                             struct neph_rgb *volume)
{
    const double length_m = t1_m - t0_m, middle_m = t0_m + 0.5 * length_m;
    if (isinf(least_depth(ray, way_optical_depth(ray, middle_m))))
        return;
    struct neph_rgb way0, way1;
    if (homogeneous) {
        /* A sun ray along a face may or may not be inside the medium: evaluate just inside the
         * piece and extrapolate linearly. Height fog without sides has no such faces. */
        const double inset = 1e-3;
        const struct neph_rgb a = way_optical_depth(ray, t0_m + inset * length_m);
        const struct neph_rgb b = way_optical_depth(ray, t1_m - inset * length_m);
        extend(a.r, b.r, inset, &way0.r, &way1.r);
        extend(a.g, b.g, inset, &way0.g, &way1.g);
        extend(a.b, b.b, inset, &way0.b, &way1.b);
    } else {
        way0 = way_optical_depth(ray, t0_m);
        way1 = way_optical_depth(ray, t1_m);
    }
    const struct neph_rgb depth = view_optical_depth(ray, t0_m, t1_m);
    struct neph_rgb light;
    light.r = light.g = light.b = closed_channel(way0.r, way1.r, depth.r);
    if (!is_grey(depth) || !is_grey(way0)) {
        light.g = closed_channel(way0.g, way1.g, depth.g);
        light.b = closed_channel(way0.b, way1.b, depth.b);
    }
    *volume = neph_rgb_add(*volume, neph_rgb_mul(scattered_per_depth(ray, middle_m), light));
}

/* ---- the ray ---- */

/* The range of [0, end] inside media: nothing else scatters or emits. */
static bool scattering_range(const struct ray *ray, double end_m, double *t0_m, double *t1_m)
{
    *t0_m = INFINITY;
    *t1_m = -INFINITY;
    for (int m = 0; m < ray->scene->medium_count; m++) {
        double near_m = 0.0, far_m = end_m;
        if (neph_medium_clip(&ray->scene->media[m], ray->origin_m, ray->direction, &near_m,
                             &far_m)) {
            *t0_m = fmin(*t0_m, near_m);
            *t1_m = fmax(*t1_m, far_m);
        }
    }
    return *t0_m < *t1_m;
}

/* In-scattered radiance of the ray; returns the estimated error. */
static double integrate_volume(const struct ray *ray, struct neph_rgb *volume)
{
    double t0_m, t1_m;
    if (!scattering_range(ray, useful_end_m(ray), &t0_m, &t1_m))
        return 0.0;
    const bool homogeneous = all_homogeneous(ray->scene);
    const bool closed = homogeneous || one_fog_without_sides(ray->scene);
    struct work work; /* not zero-initialised: it is large */
    start_work(&work, ray);
    struct neph_pieces *pieces = &work.pieces;
    pieces->count = neph_lit_pieces(ray->scene, ray->origin_m, ray->direction, t0_m, t1_m, !closed,
                                    pieces->at_m);
    if (!closed)
        return integrate_pieces(source, &work, volume);
    for (int i = 0; i < pieces->count; i++)
        add_closed_piece(ray, pieces->at_m[i].low, pieces->at_m[i].high, homogeneous, volume);
    return 0.0;
}

/* ---- emission ---- */

/* Emitted radiance per metre at distance t, attenuated to the camera. */
static void emitted(double t_m, void *context, double value[3])
{
    const struct work *work = context;
    const struct neph_scene *scene = work->ray->scene;
    const struct neph_vec3 point_m = ray_point(work->ray, t_m);
    struct neph_rgb sum = {0, 0, 0};
    for (int m = 0; m < scene->medium_count; m++)
        sum = neph_rgb_add(sum,
                           neph_rgb_scale(neph_rgb_mul(neph_medium_glow(&scene->media[m]),
                                                       scene->media[m].extinction_color),
                                          neph_medium_extinction_per_m(&scene->media[m], point_m)));
    value[0] = value[1] = value[2] = 0.0;
    if (sum.r == 0.0 && sum.g == 0.0 && sum.b == 0.0)
        return;
    const struct neph_rgb light = transmittance(neph_pieces_depth_to(&work->pieces, t_m));
    value[0] = light.r > 0.0 ? sum.r * light.r : 0.0; /* avoids 0 * inf in opaque media */
    value[1] = light.g > 0.0 ? sum.g * light.g : 0.0;
    value[2] = light.b > 0.0 ? sum.b * light.b : 0.0;
}

/* Whether two media emit equally per optical depth, in all channels that both attenuate. */
static bool glow_alike(const struct neph_medium *a, const struct neph_medium *b)
{
    const struct neph_rgb c = a->extinction_color, d = b->extinction_color;
    const struct neph_rgb x = neph_medium_glow(a), y = neph_medium_glow(b);
    return (x.r == y.r || c.r == 0.0 || d.r == 0.0) && (x.g == y.g || c.g == 0.0 || d.g == 0.0) &&
           (x.b == y.b || c.b == 0.0 || d.b == 0.0);
}

/* Whether all media emit equally per optical depth; `*glow` receives the value. */
static bool all_glow_alike(const struct neph_scene *scene, struct neph_rgb *glow)
{
    *glow = (struct neph_rgb){0, 0, 0};
    for (int i = 0; i < scene->medium_count; i++) {
        const struct neph_rgb own = neph_medium_glow(&scene->media[i]);
        for (int j = 0; j < i; j++)
            if (!glow_alike(&scene->media[i], &scene->media[j]))
                return false;
        *glow = (struct neph_rgb){fmax(glow->r, own.r), fmax(glow->g, own.g), fmax(glow->b, own.b)};
    }
    return true;
}

static struct neph_rgb absorbed(struct neph_rgb depth)
{
    return (struct neph_rgb){-expm1(-depth.r), -expm1(-depth.g), -expm1(-depth.b)};
}

static double faint_end_m(const struct ray *ray)
{
    const struct neph_rgb whole = view_optical_depth(ray, 0.0, ray->end_m);
    const double end_m = finite_end_m(ray, whole, dark_optical_depth);
    return least_depth(ray, whole) > dark_optical_depth
               ? distance_at_optical_depth(ray, dark_optical_depth, 0.0, end_m)
               : end_m;
}

/* Radiance emitted by the media along the ray; returns the estimated error. */
static double integrate_emission(const struct ray *ray, struct neph_rgb depth,
                                 struct neph_rgb *light)
{
    double t0_m, t1_m;
    struct neph_rgb glow;
    if (all_glow_alike(ray->scene, &glow)) {
        *light = neph_rgb_mul(glow, absorbed(depth));
        return 0.0;
    }
    if (!scattering_range(ray, faint_end_m(ray), &t0_m, &t1_m))
        return 0.0;
    struct work work; /* not zero-initialised: it is large */
    start_work(&work, ray);
    work.pieces.count = neph_ray_pieces(ray->scene, ray->origin_m, ray->direction, t0_m, t1_m,
                                        work.pieces.at_m);
    return integrate_pieces(emitted, &work, light);
}

/* In-scattered radiance of the point lights along the ray; returns the estimated error. */
static double integrate_point_lights(const struct ray *ray, struct neph_rgb *volume)
{
    double t0_m, t1_m;
    if (!scattering_range(ray, faint_end_m(ray), &t0_m, &t1_m))
        return 0.0;
    return neph_airlight(ray->scene, ray->origin_m, ray->direction, t0_m, t1_m, volume);
}

/* ---- complete rays --------------------------------------------------------------------------- */

/* Lambertian, lit by the sun through the media: albedo / pi * E cos(theta) T V; and by lights. */
static struct neph_rgb sunlit_radiance(const struct neph_scene *scene, const struct neph_hit *hit,
                                       struct neph_vec3 point_m)
{
    const double cosine = neph_hit_cosine(hit, scene->sun.direction);
    if (!scene->sun.present || cosine <= 0.0)
        return (struct neph_rgb){0, 0, 0};
    const struct neph_vec3 outside_m = neph_hit_outside_m(hit, point_m);
    if (!neph_scene_is_sun_visible(scene, outside_m))
        return (struct neph_rgb){0, 0, 0};
    const struct neph_rgb light = neph_rgb_scale(transmittance(sun_optical_depth(scene, outside_m)),
                                                 cosine / M_PI);
    return neph_rgb_mul(
        neph_rgb_mul(neph_surface_color(hit, point_m), scene->sun.irradiance_w_per_m2), light);
}

static struct neph_rgb surface_radiance(const struct neph_scene *scene, const struct neph_hit *hit,
                                        struct neph_vec3 point_m)
{
    const struct neph_rgb sunlit = sunlit_radiance(scene, hit, point_m);
    if (scene->light_count == 0)
        return sunlit;
    const struct neph_rgb lamplit = neph_reflect_lights(scene, neph_hit_outside_m(hit, point_m),
                                                        hit);
    return neph_rgb_add(sunlit, neph_rgb_mul(neph_surface_color(hit, point_m), lamplit));
}

static bool is_white(struct neph_rgb albedo)
{
    return albedo.r == 1.0 && albedo.g == 1.0 && albedo.b == 1.0;
}

static bool is_black(struct neph_rgb albedo)
{
    return albedo.r == 0.0 && albedo.g == 0.0 && albedo.b == 0.0;
}

/* Whether the medium emits what it absorbs, in surroundings of this radiance. */
static bool is_balanced(const struct neph_medium *medium, struct neph_rgb surround)
{
    const struct neph_rgb albedo = medium->albedo, emission = medium->emission_w_per_m2_sr;
    return (albedo.r == 1.0 || emission.r == surround.r) &&
           (albedo.g == 1.0 || emission.g == surround.g) &&
           (albedo.b == 1.0 || emission.b == surround.b);
}

/* Whether the scene is a furnace: everything reflects or scatters all light, or emits what it
 * absorbs, and all other light comes from the uniform surroundings. Then the radiance equals that
 * of the surroundings everywhere. */
static bool is_furnace(const struct neph_scene *scene)
{
    if (scene->scattering != NEPH_SCATTERING_MULTIPLE || !scene->environment_light ||
        scene->sun.present || scene->light_count > 0)
        return false;
    for (int m = 0; m < scene->medium_count; m++)
        if (!is_balanced(&scene->media[m], scene->background_w_per_m2_sr))
            return false;
    for (int i = 0; i < scene->solid_count; i++)
        if (!is_white(scene->solids[i].albedo) || neph_is_textured(&scene->solids[i].surface))
            return false;
    return neph_scene_mesh_looks(scene) == 0;
}

static bool media_scatter(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (!is_black(scene->media[m].albedo))
            return true;
    return false;
}

static bool solids_reflect(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->solid_count; i++)
        if (!is_black(scene->solids[i].albedo) || neph_is_textured(&scene->solids[i].surface))
            return true;
    return false;
}

static bool has_closed_forms(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        if (!neph_medium_has_closed_form(&scene->media[m]))
            return false;
    return true;
}

bool neph_transport_is_exact(const struct neph_scene *scene, char *reason, size_t reason_size)
{
    if (!has_closed_forms(scene)) {
        snprintf(reason, reason_size, "clouds with an optical depth that needs quadrature itself");
        return false;
    }
    const char *cannot = neph_metal_obstacle(scene);
    if (!cannot && is_furnace(scene))
        return true;
    const bool scatters = media_scatter(scene) && scene->scattering != NEPH_SCATTERING_NONE;
    if (!cannot)
        cannot = neph_coverage_obstacle(scene);
    if (!cannot && scatters && (scene->sun.present || scene->light_count > 0) &&
        (neph_scene_mesh_looks(scene) & NEPH_LOOK_CUTOUT))
        cannot = "shadows of meshes with alpha on lit media, which have no closed form: engine "
                 "oracle has them";
    if (!cannot && scene->scattering == NEPH_SCATTERING_MULTIPLE &&
        (scatters || solids_reflect(scene)))
        cannot = "multiple scattering (outside a furnace)";
    else if (!cannot && scene->environment_light && (scatters || solids_reflect(scene)))
        cannot = "light of the surroundings on media or solids";
    if (cannot)
        snprintf(reason, reason_size, "%s", cannot);
    return !cannot;
}

struct neph_ray_light neph_transport_ray(const struct neph_scene *scene, struct neph_vec3 origin_m,
                                         struct neph_vec3 direction)
{
    const struct neph_hit hit = neph_scene_hit(scene, origin_m, direction);
    struct ray ray = {
        .scene = scene, .origin_m = origin_m, .direction = direction, .end_m = hit.t_m};
    struct neph_ray_light light = {.hit_m = hit.t_m};
    const struct neph_rgb depth = view_optical_depth(&ray, 0.0, hit.t_m);
    light.transmittance = transmittance(depth);

    if (is_furnace(scene)) {
        light.radiance = scene->background_w_per_m2_sr;
        light.volume = neph_rgb_mul(light.radiance, absorbed(depth));
        return light;
    }
    const bool scatters = scene->scattering != NEPH_SCATTERING_NONE && media_scatter(scene);
    if (scene->sun.present && scatters) {
        /* The angle from (-sun) to (-view) is the angle between view and sun. */
        const double cosine = neph_vec3_dot(direction, scene->sun.direction);
        for (int m = 0; m < scene->medium_count; m++)
            ray.phase_per_sr[m] = neph_phase_rgb_per_sr(&scene->media[m].phase, cosine);
        light.quadrature_error = integrate_volume(&ray, &light.volume);
    }
    if (scene->light_count > 0 && scatters)
        light.quadrature_error += integrate_point_lights(&ray, &light.volume);
    if (neph_scene_emits(scene)) {
        struct neph_rgb own = {0, 0, 0};
        light.quadrature_error += integrate_emission(&ray, depth, &own);
        light.volume = neph_rgb_add(light.volume, own);
    }
    const struct neph_rgb behind = hit.solid
                                       ? surface_radiance(scene, &hit, ray_point(&ray, hit.t_m))
                                       : scene->background_w_per_m2_sr;
    light.radiance = neph_rgb_add(light.volume, neph_rgb_mul(behind, light.transmittance));
    return light;
}
