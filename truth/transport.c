/* SPDX-License-Identifier: MIT
 *
 * Single scattering along a ray o + t d:
 *   L = integral of sum_m sigma_s,m(t) p_m(cos) E exp(-tau_view(t) - tau_sun(t)) V(t) dt,
 * with V the sun's visibility, 0 or 1. V is exact (the shadow of each solid is one interval), so
 * the lit part of the ray is a set of intervals. Each is cut further where a sun ray changes the
 * face by which it leaves a medium; between cuts the integrand is analytic. Where the exponent is
 * affine in the optical depth from the camera (homogeneous media; one height fog without sides) the
 * integral is a phi, in closed form. Else it is quadrature; cuts at chosen optical depths of each
 * layer keep a thin fog far away from falling between the nodes.
 */
#include "truth/transport.h"

#include "scenes/media.h"
#include "scenes/quadrature.h"
#include "scenes/solids.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846264338328;

/* Beyond this optical depth less than 1e-19 of the light is left: nothing in double. */
static const double opaque_optical_depth = 45.0;

/* The two ends of the ray; per medium its two ends, the 21 crossings of at most 7 affine bounds of
 * its sun path (6 faces and the start) and the ladders of its layers; two ends per shadow. */
enum {
    LADDER_COUNT = 9,
    CUTS_MAX = 2 + NEPH_SCENE_MEDIA_MAX * (2 + 21 + 2 * LADDER_COUNT * NEPH_FOG_LAYERS_MAX) +
               2 * NEPH_SCENE_SOLIDS_MAX,
};

struct ray {
    const struct neph_scene *scene;
    struct neph_vec3 origin_m, direction;
    double end_m;                              /* first solid, or +inf */
    double phase_per_sr[NEPH_SCENE_MEDIA_MAX]; /* towards the camera */
};

static struct neph_vec3 ray_point(const struct ray *ray, double t_m)
{
    return neph_vec3_along(ray->origin_m, ray->direction, t_m);
}

static double view_optical_depth(const struct ray *ray, double t0_m, double t1_m)
{
    return neph_scene_optical_depth(ray->scene, ray->origin_m, ray->direction, t0_m, t1_m).r;
}

static double sun_optical_depth(const struct neph_scene *scene, struct neph_vec3 point_m)
{
    return neph_scene_optical_depth(scene, point_m, scene->sun.direction, 0.0, INFINITY).r;
}

/* In-scattered radiance per metre at distance t, lit. */
static void source(double t_m, void *context, double value[3])
{
    const struct ray *ray = context;
    const struct neph_scene *scene = ray->scene;
    const struct neph_vec3 point_m = ray_point(ray, t_m);
    const double optical_depth = view_optical_depth(ray, 0.0, t_m) +
                                 sun_optical_depth(scene, point_m);
    const double light = exp(-optical_depth);
    struct neph_rgb scattered = {0, 0, 0};
    for (int m = 0; m < scene->medium_count; m++) {
        const double extinction_per_m = neph_medium_extinction_per_m(&scene->media[m], point_m);
        scattered = neph_rgb_add(
            scattered,
            neph_rgb_scale(scene->media[m].albedo, extinction_per_m * ray->phase_per_sr[m]));
    }
    scattered = neph_rgb_mul(scattered, scene->sun.irradiance_w_per_m2);
    value[0] = light > 0.0 ? scattered.r * light : 0.0; /* 0 * inf: opaque, however dense */
    value[1] = light > 0.0 ? scattered.g * light : 0.0;
    value[2] = light > 0.0 ? scattered.b * light : 0.0;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

struct cuts {
    double t0_m, t1_m; /* only cuts strictly inside are kept */
    int count;
    double at_m[CUTS_MAX];
};

static void cut(struct cuts *cuts, double t_m)
{
    if (t_m > cuts->t0_m && t_m < cuts->t1_m && cuts->count < CUTS_MAX)
        cuts->at_m[cuts->count++] = t_m;
}

/* Where the sun ray from o + t d changes the face by which it enters or leaves the bounds: the
 * distances to the faces are affine in t, and the kinks lie where two of them cross, or one
 * crosses zero. */
static void cut_sun_kinks(struct cuts *cuts, const struct ray *ray,
                          const struct neph_bounds *bounds)
{
    const struct neph_vec3 s = ray->scene->sun.direction, o = ray->origin_m, d = ray->direction;
    const double face_m[6] = {bounds->min_m.x, bounds->max_m.x, bounds->min_m.y,
                              bounds->max_m.y, bounds->min_m.z, bounds->max_m.z};
    const double sun[3] = {s.x, s.y, s.z}, origin[3] = {o.x, o.y, o.z}, view[3] = {d.x, d.y, d.z};
    double constant[7] = {0.0}, slope[7] = {0.0}; /* the first is the start of the sun ray */
    int count = 1;
    for (int face = 0; face < 6; face++) {
        const int axis = face / 2;
        if (isinf(face_m[face]) || sun[axis] == 0.0)
            continue;
        constant[count] = (face_m[face] - origin[axis]) / sun[axis];
        slope[count++] = -view[axis] / sun[axis];
    }
    for (int i = 0; i < count; i++)
        for (int j = i + 1; j < count; j++)
            if (slope[i] != slope[j])
                cut(cuts, (constant[j] - constant[i]) / (slope[i] - slope[j]));
}

/* The distance at which the optical depth from the camera reaches `target`, by bisection. */
static double distance_at_optical_depth(const struct ray *ray, double target, double t0_m,
                                        double t1_m)
{
    /* Nearer than any renderer's surface is at the camera: ends the search in an infinite density.
     */
    const double nearest_m = 1e-12;
    while (t1_m - t0_m > 1e-7 * t1_m && t1_m > nearest_m) {
        const double middle_m = 0.5 * (t0_m + t1_m);
        if (view_optical_depth(ray, 0.0, middle_m) < target)
            t0_m = middle_m;
        else
            t1_m = middle_m;
    }
    return t1_m;
}

/* A finite end of the ray behind which nothing can be seen: opaque, or no medium left. */
static double useful_end_m(const struct ray *ray)
{
    const double whole = view_optical_depth(ray, 0.0, ray->end_m);
    double end_m = ray->end_m;
    if (isinf(end_m)) {
        end_m = 1.0;
        /* An infinite rest is never negligible, not even beside an infinite whole. */
        while (end_m < 1e300 && view_optical_depth(ray, 0.0, end_m) < opaque_optical_depth &&
               view_optical_depth(ray, end_m, INFINITY) > 1e-16 * fmin(whole, 1e300))
            end_m *= 2.0;
    }
    if (whole > opaque_optical_depth)
        end_m = distance_at_optical_depth(ray, opaque_optical_depth, 0.0, end_m);
    return end_m;
}

/* How far from height y along k_y until a layer has given an optical depth: the inverse of its
 * closed form, in logarithms, for the density at y may underflow. NaN or +inf when it never has. */
static double layer_distance_m(const struct neph_fog_layer *layer, double y_m, double k_y,
                               double optical_depth)
{
    const double rate_per_m = layer->falloff_per_m * fabs(k_y);
    const double exponent = log(optical_depth * rate_per_m / layer->extinction_per_m) +
                            layer->falloff_per_m * (y_m - layer->height_m);
    if (k_y > 0.0)
        return -log1p(-exp(exponent)) / rate_per_m;
    return (exponent > 36.0 ? exponent : log1p(exp(exponent))) / rate_per_m;
}

/* Cuts where a layer has given its whole / 2 * 64^-k from either end: between two of them its
 * density changes 64-fold at most, or it gives less than 1e-14 of its whole. However far away or
 * thin a layer is, some piece has its scale. */
static void cut_ladder(struct cuts *cuts, const struct ray *ray, const struct neph_medium *medium)
{
    double near_m = cuts->t0_m, far_m = cuts->t1_m;
    if (!neph_bounds_clip(&medium->bounds, ray->origin_m, ray->direction, &near_m, &far_m))
        return;
    const double k_y = ray->direction.y;
    const double near_y_m = ray_point(ray, near_m).y, far_y_m = ray_point(ray, far_m).y;
    for (int l = 0; l < medium->layer_count; l++) {
        const struct neph_fog_layer *layer = &medium->layers[l];
        double step = 0.5 * neph_fog_layer_optical_depth(layer, near_y_m, k_y, far_m - near_m);
        if (layer->falloff_per_m * k_y == 0.0)
            continue; /* even along the ray */
        for (int k = 0; k < LADDER_COUNT && step > 0.0; k++, step /= 64.0) {
            cut(cuts, near_m + layer_distance_m(layer, near_y_m, k_y, step));
            cut(cuts, far_m - layer_distance_m(layer, far_y_m, -k_y, step));
        }
    }
}

static bool all_homogeneous(const struct neph_scene *scene)
{
    for (int m = 0; m < scene->medium_count; m++)
        for (int l = 0; l < scene->media[m].layer_count; l++)
            if (scene->media[m].layers[l].falloff_per_m != 0.0)
                return false;
    return true;
}

/* One height fog of one falloff that sun rays leave by its top or bottom, or never: on a straight
 * ray both optical depths are affine in the density, so the one is affine in the other. */
static bool one_fog_without_sides(const struct neph_scene *scene)
{
    const struct neph_medium *fog = &scene->media[0];
    if (scene->medium_count != 1)
        return false;
    for (int l = 1; l < fog->layer_count; l++)
        if (fog->layers[l].falloff_per_m != fog->layers[0].falloff_per_m)
            return false;
    return isinf(fog->bounds.min_m.x) && isinf(fog->bounds.max_m.x) && isinf(fog->bounds.min_m.z) &&
           isinf(fog->bounds.max_m.z);
}

/* The optical depth of the whole way of light that is scattered at distance t. */
static double way_optical_depth(const struct ray *ray, double t_m)
{
    return view_optical_depth(ray, 0.0, t_m) + sun_optical_depth(ray->scene, ray_point(ray, t_m));
}

/* Radiance per optical depth along the ray, before any of it is lost on the way. */
static struct neph_rgb scattered_per_depth(const struct ray *ray, double t_m)
{
    struct neph_rgb scattered = {0, 0, 0};
    double extinction_per_m = 0.0;
    for (int m = 0; m < ray->scene->medium_count; m++) {
        const struct neph_medium *medium = &ray->scene->media[m];
        /* One medium is the whole of itself, even where its density underflows. */
        const double part_per_m = ray->scene->medium_count == 1
                                      ? 1.0
                                      : neph_medium_extinction_per_m(medium, ray_point(ray, t_m));
        extinction_per_m += part_per_m;
        scattered = neph_rgb_add(scattered,
                                 neph_rgb_scale(medium->albedo, part_per_m * ray->phase_per_sr[m]));
    }
    if (extinction_per_m == 0.0)
        return (struct neph_rgb){0, 0, 0};
    return neph_rgb_mul(neph_rgb_scale(scattered, 1.0 / extinction_per_m),
                        ray->scene->sun.irradiance_w_per_m2);
}

/* The integral of e^-x over [t0, t1] where x, the depth of the way, is affine in the optical depth
 * from the camera: the value at the brighter end, times phi of the difference. */
static void add_closed_piece(const struct ray *ray, double t0_m, double t1_m, bool homogeneous,
                             struct neph_rgb *volume)
{
    const double length_m = t1_m - t0_m, middle_m = t0_m + 0.5 * length_m;
    if (isinf(way_optical_depth(ray, middle_m)))
        return;
    double way0 = way_optical_depth(ray, t0_m), way1 = way_optical_depth(ray, t1_m);
    if (homogeneous) {
        /* A sun ray along a face may be inside the medium or not: look from just inside the piece
         * and continue linearly. Height fog without sides has no such faces. */
        const double a_m = t0_m + 1e-3 * length_m, b_m = t1_m - 1e-3 * length_m;
        const double way_a = way_optical_depth(ray, a_m), way_b = way_optical_depth(ray, b_m);
        const double slope_per_m = (way_b - way_a) / (b_m - a_m);
        way0 = way_a - slope_per_m * (a_m - t0_m);
        way1 = way_b + slope_per_m * (t1_m - b_m);
    }
    const double light = exp(-fmin(way0, way1));
    if (light == 0.0)
        return;
    const double depth = view_optical_depth(ray, t0_m, t1_m);
    *volume = neph_rgb_add(*volume, neph_rgb_scale(scattered_per_depth(ray, middle_m),
                                                   depth * light * neph_phi(fabs(way1 - way0))));
}

/* The part of [0, end] that lies in any medium at all: nothing else can scatter. */
static bool scattering_range(const struct ray *ray, double end_m, double *t0_m, double *t1_m)
{
    *t0_m = INFINITY;
    *t1_m = -INFINITY;
    for (int m = 0; m < ray->scene->medium_count; m++) {
        double near_m = 0.0, far_m = end_m;
        if (neph_bounds_clip(&ray->scene->media[m].bounds, ray->origin_m, ray->direction, &near_m,
                             &far_m)) {
            *t0_m = fmin(*t0_m, near_m);
            *t1_m = fmax(*t1_m, far_m);
        }
    }
    return *t0_m < *t1_m;
}

/* The shadows of all solids on the range of the cuts, by ascending start. */
static int shadows_on_ray(const struct ray *ray, const struct cuts *cuts,
                          struct neph_interval shadows[NEPH_SCENE_SOLIDS_MAX])
{
    int count = 0;
    for (int i = 0; i < ray->scene->solid_count; i++) {
        struct neph_interval *shadow = &shadows[count];
        if (neph_solid_shadow(&ray->scene->solids[i], ray->scene->sun.direction, ray->origin_m,
                              ray->direction, cuts->t0_m, cuts->t1_m, &shadow->low, &shadow->high))
            count++;
    }
    /* compare_doubles sees the first member, low. */
    qsort(shadows, (size_t)count, sizeof(shadows[0]), compare_doubles);
    return count;
}

/* All places where the integrand is not analytic, and the ladder; sorted, ends included. */
static void make_cuts(struct cuts *cuts, const struct ray *ray, const struct neph_interval *shadows,
                      int shadow_count, bool closed)
{
    const struct neph_scene *scene = ray->scene;
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_bounds *bounds = &scene->media[m].bounds;
        double near_m = 0.0, far_m = ray->end_m;
        if (neph_bounds_clip(bounds, ray->origin_m, ray->direction, &near_m, &far_m)) {
            cut(cuts, near_m);
            cut(cuts, far_m);
        }
        cut_sun_kinks(cuts, ray, bounds);
        if (!closed)
            cut_ladder(cuts, ray, &scene->media[m]);
    }
    for (int i = 0; i < shadow_count; i++) {
        cut(cuts, shadows[i].low);
        cut(cuts, shadows[i].high);
    }
    cuts->at_m[cuts->count++] = cuts->t0_m;
    cuts->at_m[cuts->count++] = cuts->t1_m;
    qsort(cuts->at_m, (size_t)cuts->count, sizeof(cuts->at_m[0]), compare_doubles);
}

/* The pieces between neighbouring cuts that the sun reaches. */
static int lit_pieces(const struct cuts *cuts, const struct neph_interval *shadows,
                      int shadow_count, struct neph_interval pieces[CUTS_MAX])
{
    int count = 0, shadow = 0;
    double dark_until_m = -INFINITY;
    for (int i = 0; i + 1 < cuts->count; i++) {
        const double low_m = cuts->at_m[i], high_m = cuts->at_m[i + 1];
        const double middle_m = 0.5 * (low_m + high_m);
        while (shadow < shadow_count && shadows[shadow].low < middle_m)
            dark_until_m = fmax(dark_until_m, shadows[shadow++].high);
        if (middle_m > dark_until_m && high_m > low_m)
            pieces[count++] = (struct neph_interval){low_m, high_m};
    }
    return count;
}

/* In-scattered radiance of the whole ray; returns the estimated error. */
static double integrate_volume(const struct ray *ray, struct neph_rgb *volume)
{
    struct cuts cuts = {.count = 0};
    if (!scattering_range(ray, useful_end_m(ray), &cuts.t0_m, &cuts.t1_m))
        return 0.0;
    const bool homogeneous = all_homogeneous(ray->scene);
    const bool closed = homogeneous || one_fog_without_sides(ray->scene);
    struct neph_interval shadows[NEPH_SCENE_SOLIDS_MAX], pieces[CUTS_MAX];
    const int shadow_count = shadows_on_ray(ray, &cuts, shadows);
    make_cuts(&cuts, ray, shadows, shadow_count, closed);
    const int piece_count = lit_pieces(&cuts, shadows, shadow_count, pieces);
    if (closed) {
        for (int i = 0; i < piece_count; i++)
            add_closed_piece(ray, pieces[i].low, pieces[i].high, homogeneous, volume);
        return 0.0;
    }
    double result[3];
    const double error = neph_integrate(source, (void *)ray, pieces, piece_count, result);
    *volume = (struct neph_rgb){result[0], result[1], result[2]};
    return error;
}

/* Lambertian, lit by the sun through the media: albedo / pi * E cos(theta) T V. */
static struct neph_rgb surface_radiance(const struct neph_scene *scene, const struct neph_hit *hit,
                                        struct neph_vec3 point_m)
{
    const double cosine = neph_vec3_dot(hit->normal, scene->sun.direction);
    if (!scene->sun.present || cosine <= 0.0)
        return (struct neph_rgb){0, 0, 0};
    /* Leave the surface by more than the rounding of the hit point, whatever the world's scale. */
    const double scale_m = fmax(1.0, neph_vec3_length(point_m) + hit->t_m);
    const struct neph_vec3 outside_m = neph_vec3_along(point_m, hit->normal, 1e-12 * scale_m);
    if (!neph_scene_sees_sun(scene, outside_m))
        return (struct neph_rgb){0, 0, 0};
    const double light = cosine / pi * exp(-sun_optical_depth(scene, outside_m));
    return neph_rgb_scale(neph_rgb_mul(hit->solid->albedo, scene->sun.irradiance_w_per_m2), light);
}

static bool is_white(struct neph_rgb albedo)
{
    return albedo.r == 1.0 && albedo.g == 1.0 && albedo.b == 1.0;
}

static bool is_black(struct neph_rgb albedo)
{
    return albedo.r == 0.0 && albedo.g == 0.0 && albedo.b == 0.0;
}

/* Everything reflects or scatters all light and all light comes from the uniform surround: the
 * radiance is the surround's everywhere, whatever the geometry. */
static bool is_white_furnace(const struct neph_scene *scene)
{
    if (scene->scattering != NEPH_SCATTERING_MULTIPLE || !scene->environment_light ||
        scene->sun.present)
        return false;
    for (int m = 0; m < scene->medium_count; m++)
        if (!is_white(scene->media[m].albedo))
            return false;
    for (int i = 0; i < scene->solid_count; i++)
        if (!is_white(scene->solids[i].albedo))
            return false;
    return true;
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
        if (!is_black(scene->solids[i].albedo))
            return true;
    return false;
}

bool neph_transport_is_exact(const struct neph_scene *scene, char *reason, size_t reason_size)
{
    if (is_white_furnace(scene))
        return true;
    const char *cannot = NULL;
    const bool scatters = media_scatter(scene) && scene->scattering != NEPH_SCATTERING_NONE;
    if (scene->scattering == NEPH_SCATTERING_MULTIPLE && (scatters || solids_reflect(scene)))
        cannot = "multiple scattering (outside the white furnace)";
    else if (scene->environment_light && (scatters || solids_reflect(scene)))
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
    const double optical_depth = view_optical_depth(&ray, 0.0, hit.t_m);
    light.transmittance = (struct neph_rgb){exp(-optical_depth), exp(-optical_depth),
                                            exp(-optical_depth)};

    if (is_white_furnace(scene)) {
        light.radiance = scene->background_w_per_m2_sr;
        light.volume = neph_rgb_scale(light.radiance, -expm1(-optical_depth));
        return light;
    }
    if (scene->sun.present && scene->scattering != NEPH_SCATTERING_NONE && media_scatter(scene)) {
        /* The turn from (-sun) to (-view) has the cosine of the angle between view and sun. */
        const double cosine = neph_vec3_dot(direction, scene->sun.direction);
        for (int m = 0; m < scene->medium_count; m++)
            ray.phase_per_sr[m] = neph_phase_per_sr(&scene->media[m].phase, cosine);
        light.quadrature_error = integrate_volume(&ray, &light.volume);
    }
    const struct neph_rgb behind = hit.solid
                                       ? surface_radiance(scene, &hit, ray_point(&ray, hit.t_m))
                                       : scene->background_w_per_m2_sr;
    light.radiance = neph_rgb_add(light.volume, neph_rgb_mul(behind, light.transmittance));
    return light;
}
