/* SPDX-License-Identifier: MIT */
#include "truth/lamp_peak.h"

#include "scenes/lights.h"
#include "scenes/media.h"
#include "scenes/solids.h"

#include <float.h>
#include <math.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_SCATTERING_COUNT == 3, "a new kind");

/* Rounding errors of a point on a ray, in units of the last place: positions and direction. */
static const double roundings = 16.0;

/* Whether media next to the light, on one side of it, scatter its light into the view ray. */
static bool scatters_beside(const struct neph_scene *scene, const struct neph_light *light,
                            struct neph_vec3 direction, double beside_m)
{
    const double side = beside_m > 0.0 ? 1.0
                                       : -1.0; /* +1: behind the light, where it shines along the
                                                * ray */
    const struct neph_vec3 point_m = neph_vec3_along(light->position_m, direction, beside_m);
    if (neph_light_falloff(light, neph_vec3_scale(direction, side)) == 0.0)
        return false;
    for (int m = 0; m < scene->medium_count; m++) {
        const struct neph_medium *medium = &scene->media[m];
        const struct neph_rgb scattered = neph_rgb_mul(
            neph_rgb_mul(medium->albedo, medium->extinction_color), light->intensity_w_per_sr);
        if ((scattered.r > 0.0 || scattered.g > 0.0 || scattered.b > 0.0) &&
            neph_medium_extinction_per_m(medium, point_m) > 0.0 &&
            neph_phase_per_sr(&medium->phase, -side) > 0.0)
            return true;
    }
    return false;
}

bool neph_is_light_peak(const struct neph_scene *still, const struct neph_light *light,
                        struct neph_vec3 origin_m, struct neph_vec3 direction)
{
    const struct neph_vec3 way_m = neph_vec3_sub(light->position_m, origin_m);
    const double foot_m = neph_vec3_dot(way_m, direction);
    const double rounding_m = roundings * DBL_EPSILON *
                              (neph_vec3_length(light->position_m) + neph_vec3_length(way_m));
    if (neph_vec3_length(neph_vec3_along(way_m, direction, -foot_m)) > rounding_m ||
        foot_m < -rounding_m || neph_scene_hit(still, origin_m, direction).t_m < foot_m)
        return false;
    const double beside_m = fmax(1e3 * rounding_m, 1e-12);
    return scatters_beside(still, light, direction, beside_m) ||
           (foot_m > beside_m && scatters_beside(still, light, direction, -beside_m));
}

bool neph_find_light_peak(const struct neph_scene *still, const struct neph_camera *camera,
                          int width_px, int height_px, struct neph_light_peak *peak)
{
    if (still->scattering == NEPH_SCATTERING_NONE || still->medium_count == 0)
        return false;
    for (int l = 0; l < still->light_count; l++) {
        const struct neph_light *light = &still->lights[l];
        const double away_m = neph_vec3_length(
            neph_vec3_sub(light->position_m, camera->position_m));
        const bool is_at_the_eye = camera->orthographic_height_m == 0.0 &&
                                   away_m <= roundings * DBL_EPSILON *
                                                 neph_vec3_length(light->position_m);
        int first_column = 0, first_row = 0, columns = width_px, rows = height_px;
        struct neph_point_in_frame found;
        if (!is_at_the_eye) {
            if (!neph_camera_find_pixel(camera, width_px, height_px, light->position_m, &found) ||
                !(found.i > -1.0 && found.i < width_px && found.j > -1.0 && found.j < height_px))
                continue;
            first_column = (int)lround(found.i);
            first_row = (int)lround(found.j);
            columns = rows = 1;
        }
        for (int row = first_row; row < first_row + rows && row < height_px; row++)
            for (int column = first_column; column < first_column + columns && column < width_px;
                 column++) {
                const struct neph_pixel_ray ray = neph_camera_ray(camera, width_px, height_px,
                                                                  column, row);
                if (row < 0 || column < 0 ||
                    !neph_is_light_peak(still, light, ray.origin_m, ray.direction))
                    continue;
                *peak = (struct neph_light_peak){l, column, row, is_at_the_eye};
                return true;
            }
    }
    return false;
}
