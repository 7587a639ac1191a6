/* SPDX-License-Identifier: MIT */
#include "harness/engines/scene_json.h"

#include "scenes/motion.h"

json_t *neph_vector_json(struct neph_vec3 v)
{
    return json_pack("[fff]", v.x, v.y, v.z);
}

json_t *neph_colour_json(struct neph_rgb c)
{
    return json_pack("[fff]", c.r, c.g, c.b);
}

json_t *neph_sun_json(const struct neph_sun *sun)
{
    return sun->present
               ? json_pack("{s:o, s:o}", "direction", neph_vector_json(sun->direction),
                           "irradiance_w_per_m2", neph_colour_json(sun->irradiance_w_per_m2))
               : json_null();
}

static json_t *light_json(const struct neph_light *light)
{
    return json_pack("{s:o, s:o, s:o}", "position_m", neph_vector_json(light->position_m),
                     "intensity_w_per_sr", neph_colour_json(light->intensity_w_per_sr), "cone",
                     light->is_spot
                         ? json_pack("{s:o, s:f, s:f}", "axis", neph_vector_json(light->axis),
                                     "outer_cosine", light->outer_cosine, "inner_cosine",
                                     light->inner_cosine)
                         : json_null());
}

json_t *neph_lights_json(const struct neph_scene *scene, double frame)
{
    json_t *lights = json_array();
    for (int i = 0; i < scene->light_count; i++) {
        const struct neph_light light = neph_scene_light(scene, i, frame);
        neph_json_add(&lights, light_json(&light));
    }
    return lights;
}
