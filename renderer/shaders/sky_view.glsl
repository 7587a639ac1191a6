// SPDX-License-Identifier: MIT
//
// The table of what is seen from one place under one sun (renderer/sky/view_table.h).
#ifndef NEPH_SKY_VIEW_GLSL
#define NEPH_SKY_VIEW_GLSL

#include "sky_tables.glsl"

struct SkyView {
    vec3 right;
    float half_width; // of the picture in its plane at distance 1, or in metres
    vec3 up;
    float half_height;
    vec3 forward;
    uint width_px;
    vec3 vertical; // at the camera
    uint height_px;
    vec3 sun_direction;
    float altitude_m;
    vec3 sun_irradiance;
    uint steps;
    uint scatters, has_field;
    uint elevations, azimuths; // nodes of the table, of each half; 0: there is none
};

layout(std430, binding = 3) readonly buffer SkyEye {
    SkyView view;
};

// enum neph_sky_slice, behind those of the layers
const uint SLICE_HIGHER = 0, SLICE_GROUND = 1, SLICE_THROUGH = 2, SLICES = 3;

const float HORIZON_GAP_RAD = 1e-5;

uint slice_count() { return air.layer_count + SLICES; }

float horizon_rad()
{
    return -sky_asin(sqrt(sky_growth_m2(view.altitude_m)) / (air.radius_m + view.altitude_m));
}

float range_rad(float horizon, bool is_below)
{
    return (is_below ? 0.5 * PI + horizon : 0.5 * PI - horizon) - HORIZON_GAP_RAD;
}

SkyRay view_ray(float cosine, float toward_sun)
{
    SkyRay ray;
    ray.altitude_m = view.altitude_m;
    ray.cosine = cosine;
    ray.sun_cosine = dot(view.sun_direction, view.vertical);
    ray.toward_sun = toward_sun;
    return ray;
}

#endif
