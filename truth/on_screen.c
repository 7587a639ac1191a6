/* SPDX-License-Identifier: MIT */
#include "truth/on_screen.h"

#include "scenes/solids.h"

#include <math.h>

bool neph_is_on_screen(const struct neph_scene *scene, const struct neph_screen *screen,
                       struct neph_vec3 point_m)
{
    const struct neph_camera *camera = &screen->camera;
    const bool is_parallel = camera->orthographic_height_m > 0.0;
    const struct neph_vec3 offset_m = neph_vec3_sub(point_m, camera->position_m);
    const double depth_m = neph_vec3_dot(offset_m, camera->forward);
    const double half_m = neph_camera_half_height(camera) * (is_parallel ? 1.0 : depth_m);
    if (depth_m <= 0.0 || fabs(neph_vec3_dot(offset_m, camera->up)) > half_m ||
        fabs(neph_vec3_dot(offset_m, camera->right)) > half_m * screen->aspect)
        return false;
    const struct neph_vec3 eye_m = is_parallel ? neph_vec3_along(point_m, camera->forward, -depth_m)
                                               : camera->position_m;
    return neph_scene_is_visible(scene, point_m, eye_m);
}
