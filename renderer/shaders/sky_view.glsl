// SPDX-License-Identifier: MIT
//
// Tables of views: the sky and ground visible from a place, by direction
// (renderer/sky/view_table.h). A node has one slice per layer, with the single scattering over the
// layer's phase function, which is smooth, and the slices below.
//
//    elevation ^    upper half      the two halves are interpolated separately,
//              |  --------------    because the radiance is discontinuous
//              |  -- horizon ---    at the horizon
//              |    lower half
//              +------------------> azimuth from the sun, half a turn
#ifndef NEPH_SKY_VIEW_GLSL
#define NEPH_SKY_VIEW_GLSL

#include "sky.glsl"

// enum neph_sky_slice, behind the layers' slices
const uint SLICE_HIGHER = 0, SLICE_GROUND = 1, SLICE_THROUGH = 2, SLICES = 3;

const float HORIZON_GAP_RAD = 1e-5;

uint sky_slice_count() { return sky_layers() + SLICES; }

// Elevation of the horizon.
float sky_horizon_rad(SkyPlace place)
{
    return -sky_asin(sqrt(sky_growth_m2(place.altitude_m)) / (air.radius_m + place.altitude_m));
}

float sky_range_rad(float horizon_rad, bool is_below)
{
    return (is_below ? 0.5 * PI + horizon_rad : 0.5 * PI - horizon_rad) - HORIZON_GAP_RAD;
}

// A ray by its cosines to the vertical and to the sun; its phase functions are not set.
SkyRay sky_ray_from(SkyPlace place, float cosine, float toward_sun)
{
    SkyRay ray;
    ray.altitude_m = place.altitude_m;
    ray.cosine = cosine;
    ray.sun_cosine = dot(eye.sun_direction, place.vertical);
    ray.toward_sun = toward_sun;
    return ray;
}

// The ray along a unit vector, with phase functions.
SkyRay sky_ray_along(SkyPlace place, vec3 direction)
{
    SkyRay ray = sky_ray_from(place, dot(direction, place.vertical),
                              dot(direction, eye.sun_direction));
    sky_find_phases(ray, direction, eye.sun_direction);
    return ray;
}

// --- lookup -------------------------------------------------------------------------------------

float sky_among_azimuths(SkyRay ray, out uint low)
{
    float across2 = (1.0 - ray.cosine * ray.cosine) * (1.0 - ray.sun_cosine * ray.sun_cosine);
    float x = (ray.toward_sun - ray.cosine * ray.sun_cosine) / sqrt(max(across2, 1e-12));
    return sky_among(sqrt(sky_acos(x) / PI), eye.azimuths, low);
}

// Below the horizon the nodes store scattered light per metre of the way to the ground, because
// that length changes most between nodes.
float sky_way_m(float length_m)
{
    const float LEAST_M = 1e-3; // for a place on the ground
    return length_m < FAR_M ? max(length_m, LEAST_M) : 1.0;
}

void sky_add_view(SkyRay ray, uint first, float weight, inout SkyLight light)
{
    uint others = first + sky_layers();
    vec3 volume = sky_nodes[others + SLICE_HIGHER].rgb;
    SKY_UNROLL for (uint n = 0u; n < sky_layers(); n++)
        volume += ray.phases[n] * sky_nodes[first + n].rgb;
    volume *= sky_way_m(light.length_m);
    light.volume += weight * volume;
    light.radiance += weight * (volume + sky_nodes[others + SLICE_GROUND].rgb);
    light.transmittance += weight * sky_nodes[others + SLICE_THROUGH].rgb;
}

// Light along a ray from a place that has a table.
SkyLight sky_look_up(SkyPlace place, SkyRay ray)
{
    SkyLight light = SkyLight(vec3(0.0), vec3(0.0), vec3(0.0), sky_length_m(ray));
    bool is_below = light.length_m < FAR_M;
    float horizon_rad = sky_horizon_rad(place);
    float off_rad = abs(sky_asin(ray.cosine) - horizon_rad);
    uint i, j;
    float x = sky_among_azimuths(ray, i);
    float part = max(0.0, off_rad - HORIZON_GAP_RAD) / sky_range_rad(horizon_rad, is_below);
    float y = sky_among(sqrt(part), eye.elevations, j);
    uint slices = sky_slice_count(), row = slices * eye.azimuths;
    uint first = place.first + ((is_below ? eye.elevations : 0u) + j) * row + i * slices;
    sky_add_view(ray, first, (1.0 - x) * (1.0 - y), light);
    sky_add_view(ray, first + slices, x * (1.0 - y), light);
    sky_add_view(ray, first + row, (1.0 - x) * y, light);
    sky_add_view(ray, first + row + slices, x * y, light);
    return light;
}

#endif
