/* SPDX-License-Identifier: MIT */
#include "scenes/lights.h"

const char neph_lights_reason[] = "lights (only the sun)";
const char neph_wide_spot_reason[] = "a light whose cone is wider than 90 degrees from its axis";

bool neph_scene_has_wide_spot(const struct neph_scene *scene)
{
    for (int i = 0; i < scene->light_count; i++)
        if (scene->lights[i].is_spot && scene->lights[i].outer_cosine < 0.0)
            return true;
    return false;
}

double neph_light_falloff(const struct neph_light *light, struct neph_vec3 direction)
{
    if (!light->is_spot)
        return 1.0;
    const double cosine = neph_vec3_dot(light->axis, direction);
    const double x = (cosine - light->outer_cosine) / (light->inner_cosine - light->outer_cosine);
    if (x <= 0.0 || x >= 1.0)
        return x > 0.0;
    return x * x * (3.0 - 2.0 * x);
}

struct neph_lit neph_light_at(const struct neph_light *light, struct neph_vec3 point_m)
{
    const struct neph_vec3 offset_m = neph_vec3_sub(light->position_m, point_m);
    struct neph_lit lit = {.distance_m = neph_vec3_length(offset_m)};
    if (lit.distance_m == 0.0)
        return lit;
    lit.direction = neph_vec3_scale(offset_m, 1.0 / lit.distance_m);
    const double part = neph_light_falloff(light, neph_vec3_scale(lit.direction, -1.0));
    lit.irradiance_w_per_m2 = neph_rgb_scale(light->intensity_w_per_sr,
                                             part / (lit.distance_m * lit.distance_m));
    return lit;
}
