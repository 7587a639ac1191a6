/* SPDX-License-Identifier: MIT */
#include "truth/lamp_draw.h"

#include "scenes/bounds.h"
#include "scenes/lights.h"
#include "scenes/media.h"
#include "truth/directions.h"

#include <math.h>

/* Relative distance below which a ray counts as passing through the light: rounding in double
 * precision. It only limits divisions; the density stays exact. */
static const double nearest = 1e-15;
static const double nearest_m = 1e-150;

/* The part of a segment in a medium's bounds. */
struct stretch {
    double t0_m, t1_m; /* may be +inf */
};

/* A light relative to the segment; s is the distance along the ray from the foot of the light's
 * perpendicular. */
struct pass {
    double foot_m, height_m;
    struct neph_vec3 across_m;                  /* from the foot to the light */
    double squares_per_m[NEPH_SCENE_MEDIA_MAX]; /* integral of 1 / d^2 over each stretch */
    double squares_sum_per_m;
    double octaves[NEPH_SCENE_MEDIA_MAX]; /* integral of 1 / d over each stretch */
    double octaves_sum;
};

/* Everything for one sample: parts in media, lights, and the sums that normalise both densities. */
struct segment {
    const struct neph_scene *scene;
    struct neph_vec3 origin_m, direction;
    int stretch_count;
    struct stretch stretches[NEPH_SCENE_MEDIA_MAX];
    struct pass passes[NEPH_SCENE_LIGHTS_MAX];
    double weights[NEPH_SCENE_LIGHTS_MAX], weight_sum; /* by 1 / d^2 and intensity */
    double even_weights[NEPH_SCENE_LIGHTS_MAX], even_sum;
};

/* ---- integrals over a part ------------------------------------------------------------------- */

/* The integral of 1 / d^2: the angle between the ends of a part, as seen from the light, divided by
 * the height. Without cancellation; 1 / s0 - 1 / s1 at height 0. */
static double squares_between(double height_m, double s0_m, double s1_m)
{
    if (isinf(s1_m))
        return atan2(height_m, s0_m) / height_m;
    return atan2(height_m * (s1_m - s0_m), height_m * height_m + s0_m * s1_m) / height_m;
}

/* Finite end for 1 / d, whose integral over an infinite part diverges: this many times the distance
 * of its start from the light. Points beyond are sampled only by 1 / d^2. */
static double octaves_end_m(double height_m, double s0_m, double s1_m)
{
    return isinf(s1_m) ? 1e12 * fmax(height_m, fabs(s0_m)) : s1_m;
}

/* asinh(s1 / h) - asinh(s0 / h), the integral of 1 / d, without cancellation. */
static double octaves_between(double height_m, double s0_m, double s1_m)
{
    if (s1_m <= 0.0)
        return octaves_between(height_m, -s1_m, -s0_m);
    const double d0_m = hypot(height_m, s0_m), d1_m = hypot(height_m, s1_m);
    if (s0_m < 0.0)
        return log((s1_m + d1_m) / height_m) + log((d0_m - s0_m) / height_m);
    const double farther_m = (s1_m - s0_m) * (1.0 + (s1_m + s0_m) / (d0_m + d1_m));
    return log1p(farther_m / (s0_m + d0_m));
}

/* ---- the segment ---- */

static double brightness(struct neph_rgb c)
{
    return c.r + c.g + c.b;
}

static void find_stretches(struct segment *segment, double end_m)
{
    for (int m = 0; m < segment->scene->medium_count; m++) {
        const struct neph_bounds support = neph_medium_support(&segment->scene->media[m]);
        struct stretch stretch = {0.0, end_m};
        if (neph_bounds_clip(&support, segment->origin_m, segment->direction, &stretch.t0_m,
                             &stretch.t1_m) &&
            stretch.t0_m < stretch.t1_m)
            segment->stretches[segment->stretch_count++] = stretch;
    }
}

static struct pass find_pass(const struct segment *segment, const struct neph_light *light)
{
    const struct neph_vec3 way_m = neph_vec3_sub(light->position_m, segment->origin_m);
    struct pass pass = {.foot_m = neph_vec3_dot(way_m, segment->direction)};
    pass.across_m = neph_vec3_along(way_m, segment->direction, -pass.foot_m);
    pass.height_m = fmax(neph_vec3_length(pass.across_m),
                         nearest * neph_vec3_length(way_m) + nearest_m);
    for (int i = 0; i < segment->stretch_count; i++) {
        const double s0_m = segment->stretches[i].t0_m - pass.foot_m;
        const double s1_m = segment->stretches[i].t1_m - pass.foot_m;
        pass.squares_per_m[i] = squares_between(pass.height_m, s0_m, s1_m);
        pass.octaves[i] = octaves_between(pass.height_m, s0_m,
                                          octaves_end_m(pass.height_m, s0_m, s1_m));
        pass.squares_sum_per_m += pass.squares_per_m[i];
        pass.octaves_sum += pass.octaves[i];
    }
    return pass;
}

static void init_segment(struct segment *segment, const struct neph_scene *scene,
                         struct neph_vec3 origin_m, struct neph_vec3 direction, double end_m)
{
    segment->scene = scene;
    segment->origin_m = origin_m;
    segment->direction = direction;
    segment->stretch_count = 0;
    segment->weight_sum = segment->even_sum = 0.0;
    find_stretches(segment, end_m);
    for (int l = 0; segment->stretch_count > 0 && l < scene->light_count; l++) {
        const double intensity = brightness(scene->lights[l].intensity_w_per_sr);
        segment->passes[l] = find_pass(segment, &scene->lights[l]);
        segment->weights[l] = intensity * segment->passes[l].squares_sum_per_m;
        segment->even_weights[l] = segment->weights[l] > 0.0;
        segment->weight_sum += segment->weights[l];
        segment->even_sum += segment->even_weights[l];
    }
}

/* Density of a point: each part that contains it adds the same 1 / d^2 and 1 / d, normalised over
 * all. */
static double place_per_m(const struct segment *segment, int l, double s_m)
{
    const struct pass *pass = &segment->passes[l];
    const double d_m = hypot(pass->height_m, s_m);
    const double intensity = brightness(segment->scene->lights[l].intensity_w_per_sr);
    const double by_squares = intensity / (segment->weight_sum * d_m * d_m);
    const double by_octaves = 1.0 / (segment->even_sum * pass->octaves_sum * d_m);
    double per_m = 0.0;
    for (int i = 0; i < segment->stretch_count; i++) {
        const double s0_m = segment->stretches[i].t0_m - pass->foot_m;
        const double s1_m = segment->stretches[i].t1_m - pass->foot_m;
        if (!(s_m >= s0_m && s_m <= s1_m))
            continue;
        per_m += (1.0 - NEPH_LIGHT_POINTS_BY_OCTAVE) * by_squares;
        if (s_m <= octaves_end_m(pass->height_m, s0_m, s1_m))
            per_m += NEPH_LIGHT_POINTS_BY_OCTAVE * by_octaves;
    }
    return per_m;
}

/* ---- sampling -------------------------------------------------------------------------------- */

/* The point at the part u of the integral of 1 / d^2: an angle between the angles of the ends,
 * measured from the side of the ray on which they are small. */
static double draw_by_squares_m(double height_m, double s0_m, double s1_m, double u)
{
    if (s0_m + s1_m < 0.0)
        return -draw_by_squares_m(height_m, -s1_m, -s0_m, 1.0 - u);
    const double rad0 = atan2(height_m, s0_m), rad1 = isinf(s1_m) ? 0.0 : atan2(height_m, s1_m);
    return height_m / tan((1.0 - u) * rad0 + u * rad1);
}

/* The point at the part u of the integral of 1 / d. */
static double draw_by_octaves_m(double height_m, double s0_m, double s1_m, double u)
{
    if (s1_m <= 0.0)
        return -draw_by_octaves_m(height_m, -s1_m, -s0_m, 1.0 - u);
    const double d0_m = hypot(height_m, s0_m), more = u * octaves_between(height_m, s0_m, s1_m);
    if (s0_m < 0.0)
        return height_m * sinh(more - log((d0_m - s0_m) / height_m));
    const double far_m = d0_m + s0_m; /* far_m e^more - h^2 / far_m e^-more is 2 s */
    return 0.5 * (far_m * exp(more) - height_m * height_m / far_m * exp(-more));
}

/* Choose one of several by their weights; `sum` is their total; -1: all weights are 0. `u` is
 * uniform in 0..1 before and after. */
static int pick(const double *weights, int count, double sum, double *u)
{
    int picked = -1;
    double left = *u * sum;
    for (int i = 0; i < count; i++) {
        if (!(weights[i] > 0.0))
            continue;
        picked = i;
        *u = fmin(left / weights[i], 1.0);
        if (left < weights[i])
            break;
        left -= weights[i];
    }
    return picked;
}

struct neph_light_point neph_light_point_sample(const struct neph_scene *scene,
                                                struct neph_vec3 origin_m,
                                                struct neph_vec3 direction, double end_m,
                                                struct neph_random *random)
{
    struct segment segment; /* not zero-initialised: it is large */
    struct neph_light_point place = {.light = NULL};
    init_segment(&segment, scene, origin_m, direction, end_m);
    double choice = neph_random_uniform(random);
    const double u = neph_random_uniform(random);
    const bool by_octaves = choice < NEPH_LIGHT_POINTS_BY_OCTAVE;
    choice = by_octaves
                 ? choice / NEPH_LIGHT_POINTS_BY_OCTAVE
                 : (choice - NEPH_LIGHT_POINTS_BY_OCTAVE) / (1.0 - NEPH_LIGHT_POINTS_BY_OCTAVE);
    if (!(segment.weight_sum > 0.0))
        return place;
    const int l = by_octaves
                      ? pick(segment.even_weights, scene->light_count, segment.even_sum, &choice)
                      : pick(segment.weights, scene->light_count, segment.weight_sum, &choice);
    const struct pass *pass = &segment.passes[l];
    const int i = by_octaves
                      ? pick(pass->octaves, segment.stretch_count, pass->octaves_sum, &choice)
                      : pick(pass->squares_per_m, segment.stretch_count, pass->squares_sum_per_m,
                             &choice);
    const struct stretch *stretch = &segment.stretches[i];
    const double s0_m = stretch->t0_m - pass->foot_m, s1_m = stretch->t1_m - pass->foot_m;
    double s_m = by_octaves ? draw_by_octaves_m(pass->height_m, s0_m,
                                                octaves_end_m(pass->height_m, s0_m, s1_m), u)
                            : draw_by_squares_m(pass->height_m, s0_m, s1_m, u);
    s_m = fmin(fmax(s_m, s0_m), s1_m);
    place.light = &scene->lights[l];
    place.t_m = fmin(fmax(pass->foot_m + s_m, stretch->t0_m), stretch->t1_m);
    place.distance_m = hypot(pass->height_m, s_m);
    place.to_light = neph_vec3_scale(neph_vec3_along(pass->across_m, direction, -s_m),
                                     1.0 / place.distance_m);
    place.density_per_m = place_per_m(&segment, l, s_m);
    return place;
}

const struct neph_light *neph_light_choose(const struct neph_scene *scene, struct neph_vec3 point_m,
                                           double *probability, struct neph_random *random)
{
    double weights[NEPH_SCENE_LIGHTS_MAX], sum = 0.0;
    for (int i = 0; i < scene->light_count; i++) {
        weights[i] = brightness(neph_light_at(&scene->lights[i], point_m).irradiance_w_per_m2);
        sum += weights[i];
    }
    double u = neph_random_uniform(random);
    const int picked = pick(weights, scene->light_count, sum, &u);
    if (picked < 0)
        return NULL;
    *probability = weights[picked] / sum;
    return &scene->lights[picked];
}

struct neph_vec3 neph_light_direction_sample(const struct neph_scene *scene,
                                             struct neph_vec3 point_m, struct neph_random *random)
{
    const int last = scene->light_count - 1;
    const int picked = (int)fmin(last, scene->light_count * neph_random_uniform(random));
    const struct neph_lit lit = neph_light_at(&scene->lights[picked], point_m);
    if (lit.distance_m == 0.0)
        return (struct neph_vec3){0, 1, 0};
    return neph_direction_around(lit.direction, M_PI * neph_random_uniform(random), random);
}

double neph_light_direction_per_sr(const struct neph_scene *scene, struct neph_vec3 point_m,
                                   struct neph_vec3 direction)
{
    double sum_per_sr = 0.0;
    for (int i = 0; i < scene->light_count; i++) {
        const struct neph_vec3 towards = neph_light_at(&scene->lights[i], point_m).direction;
        const double sine = neph_vec3_length(neph_vec3_cross(towards, direction));
        sum_per_sr += 1.0 / (2.0 * M_PI * M_PI * fmax(sine, nearest));
    }
    return sum_per_sr / scene->light_count;
}
