/* SPDX-License-Identifier: MIT */
#include "renderer/light_projection.h"

#include <math.h>

static const double widest_tangent = 20.0;
static const double farthest_px = 1e9; /* within the range of int32_t */

struct neph_gpu_lamp_sight neph_project_light(const struct neph_camera *camera, int width_px,
                                              int height_px, struct neph_vec3 position_m)
{
    const bool is_parallel = camera->orthographic_height_m > 0.0;
    const double away_m = neph_vec3_length(neph_vec3_sub(position_m, camera->position_m));
    struct neph_point_in_frame found;
    if (!neph_camera_find_pixel(camera, width_px, height_px, position_m, &found) ||
        (!is_parallel && found.depth_m * widest_tangent < away_m) ||
        !(fabs(found.i) < farthest_px && fabs(found.j) < farthest_px))
        return (struct neph_gpu_lamp_sight){.depth_m = 0.0f};
    const double column = round(found.i), row = round(found.j);
    return (struct neph_gpu_lamp_sight){
        .pixel = {(int32_t)column, (int32_t)row},
        .beside_px = {(float)(found.i - column), (float)(found.j - row)},
        .depth_m = is_parallel ? 1.0f : (float)found.depth_m,
    };
}
