/* SPDX-License-Identifier: MIT */
#include "renderer/relative.h"

#include <math.h>

static double clamp_double(double low, double high, double value)
{
    return fmin(fmax(value, low), high);
}

float neph_relative_m(double position_m, double camera_m)
{
    const double far_m = NEPH_GPU_FAR_M;
    return (float)fmax(-far_m, fmin(far_m, position_m - camera_m));
}

void neph_relative_position(float out[3], struct neph_vec3 position_m, struct neph_vec3 camera_m)
{
    out[0] = neph_relative_m(position_m.x, camera_m.x);
    out[1] = neph_relative_m(position_m.y, camera_m.y);
    out[2] = neph_relative_m(position_m.z, camera_m.z);
}

void neph_gpu_direction(float out[3], struct neph_vec3 direction)
{
    out[0] = (float)direction.x;
    out[1] = (float)direction.y;
    out[2] = (float)direction.z;
}

struct neph_gpu_globe neph_gpu_globe_from(struct neph_vec3 center_m, double radius_m,
                                          struct neph_vec3 camera_position_m)
{
    const struct neph_vec3 from_center_m = neph_vec3_sub(camera_position_m, center_m);
    const double distance_m = neph_vec3_length(from_center_m);
    struct neph_gpu_globe globe = {
        .up = {0.0f, 1.0f, 0.0f}, /* arbitrary at the centre */
        .camera_radius_m = (float)fmin(distance_m, NEPH_GPU_FAR_M),
        .camera_altitude_m = neph_relative_m(distance_m, radius_m),
        .radius_m = (float)radius_m,
    };
    if (distance_m > 0.0)
        neph_gpu_direction(globe.up, neph_vec3_scale(from_center_m, 1.0 / distance_m));
    return globe;
}

double neph_box_distance_m(const struct neph_bounds *box, struct neph_vec3 point_m)
{
    const struct neph_vec3 nearest_m = {clamp_double(box->min_m.x, box->max_m.x, point_m.x),
                                        clamp_double(box->min_m.y, box->max_m.y, point_m.y),
                                        clamp_double(box->min_m.z, box->max_m.z, point_m.z)};
    return neph_vec3_length(neph_vec3_sub(nearest_m, point_m));
}
