/* SPDX-License-Identifier: MIT */
#include "truth/lamp_draw.h"

#include "scenes/lights.h"
#include "truth/directions.h"

#include <math.h>

/* Nearer than this part of its distance a ray is taken to pass no light: a bound for divisions,
 * which leaves the density what it says. */
static const double nearest = 1e-12;

/* A light as a segment passes it. */
struct pass {
    double foot_m, height_m;
    double from_rad, to_rad; /* the angles of the segment's ends, seen from the light */
};

static struct pass pass_of(const struct neph_light *light, struct neph_vec3 origin_m,
                           struct neph_vec3 direction, double t0_m, double t1_m)
{
    const struct neph_vec3 way_m = neph_vec3_sub(light->position_m, origin_m);
    struct pass pass = {.foot_m = neph_vec3_dot(way_m, direction)};
    const struct neph_vec3 across_m = neph_vec3_along(way_m, direction, -pass.foot_m);
    pass.height_m = fmax(neph_vec3_length(across_m), nearest * (1.0 + fabs(pass.foot_m)));
    pass.from_rad = atan((t0_m - pass.foot_m) / pass.height_m);
    pass.to_rad = atan((t1_m - pass.foot_m) / pass.height_m);
    return pass;
}

static double brightness(struct neph_rgb c)
{
    return c.r + c.g + c.b;
}

/* One of several by their weights, whose sum is given; -1: none weighs anything. */
static int pick(const double *weights, int count, double sum, struct neph_random *random)
{
    int picked = -1;
    double left = neph_random_uniform(random) * sum;
    for (int i = 0; i < count && !(picked >= 0 && left < 0.0); i++) {
        if (!(weights[i] > 0.0))
            continue;
        picked = i;
        left -= weights[i];
    }
    return picked;
}

struct neph_lamp_place neph_lamp_place_draw(const struct neph_scene *scene,
                                            struct neph_vec3 origin_m, struct neph_vec3 direction,
                                            double t0_m, double t1_m, struct neph_random *random)
{
    struct pass passes[NEPH_SCENE_LIGHTS_MAX];
    double weights[NEPH_SCENE_LIGHTS_MAX], sum = 0.0;
    struct neph_lamp_place place = {.t_m = t0_m};
    for (int i = 0; i < scene->light_count; i++) {
        passes[i] = pass_of(&scene->lights[i], origin_m, direction, t0_m, t1_m);
        weights[i] = brightness(scene->lights[i].intensity_w_per_sr) *
                     (passes[i].to_rad - passes[i].from_rad) / passes[i].height_m;
        sum += weights[i];
    }
    const int picked = pick(weights, scene->light_count, sum, random);
    if (picked < 0)
        return place;
    const struct pass *pass = &passes[picked];
    const double width_rad = pass->to_rad - pass->from_rad;
    const double s_m = pass->height_m *
                       tan(pass->from_rad + width_rad * neph_random_uniform(random));
    place.light = &scene->lights[picked];
    place.t_m = fmin(fmax(pass->foot_m + s_m, t0_m), t1_m);
    place.density_per_m = weights[picked] / sum * pass->height_m /
                          (width_rad * (pass->height_m * pass->height_m + s_m * s_m));
    return place;
}

const struct neph_light *neph_lamp_pick(const struct neph_scene *scene, struct neph_vec3 point_m,
                                        double *probability, struct neph_random *random)
{
    double weights[NEPH_SCENE_LIGHTS_MAX], sum = 0.0;
    for (int i = 0; i < scene->light_count; i++) {
        weights[i] = brightness(neph_light_at(&scene->lights[i], point_m).irradiance_w_per_m2);
        sum += weights[i];
    }
    const int picked = pick(weights, scene->light_count, sum, random);
    if (picked < 0)
        return NULL;
    *probability = weights[picked] / sum;
    return &scene->lights[picked];
}

struct neph_vec3 neph_lamp_direction_draw(const struct neph_scene *scene, struct neph_vec3 point_m,
                                          struct neph_random *random)
{
    const int last = scene->light_count - 1;
    const int picked = (int)fmin(last, scene->light_count * neph_random_uniform(random));
    const struct neph_lit lit = neph_light_at(&scene->lights[picked], point_m);
    if (lit.distance_m == 0.0)
        return (struct neph_vec3){0, 1, 0};
    return neph_direction_around(lit.direction, M_PI * neph_random_uniform(random), random);
}

double neph_lamp_direction_per_sr(const struct neph_scene *scene, struct neph_vec3 point_m,
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
