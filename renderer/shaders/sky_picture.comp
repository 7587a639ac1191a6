#version 450
// SPDX-License-Identifier: MIT
//
// What a camera sees of a planet and its sky: a thread is a pixel, which walks its ray or looks
// into the table of views.
#extension GL_GOOGLE_include_directive : require

#include "sky_view.glsl"

layout(local_size_x = 64) in;

struct SkyPixel {
    vec4 radiance; // w: eye depth [m], FAR_M: sky
    vec4 volume;
    vec4 transmittance;
};

layout(std430, binding = 4) writeonly buffer SkyPixels {
    SkyPixel sky_pixels[];
};

layout(std430, binding = 5) readonly buffer ViewNodes {
    vec4 view_nodes[];
};

layout(push_constant) uniform SkyPart {
    uint first_pixel, pixel_count;
} part;

float among_azimuths(SkyRay ray, out uint low)
{
    float across2 = (1.0 - ray.cosine * ray.cosine) * (1.0 - ray.sun_cosine * ray.sun_cosine);
    float x = (ray.toward_sun - ray.cosine * ray.sun_cosine) / sqrt(max(across2, 1e-12));
    return sky_among(sqrt(sky_acos(x) / PI), view.azimuths, low);
}

void add_node(SkyRay ray, uint node, float weight, inout SkyLight light)
{
    uint first = node * slice_count(), others = first + air.layer_count;
    vec3 volume = view_nodes[others + SLICE_HIGHER].rgb;
    for (uint n = 0u; n < air.layer_count; n++)
        volume += ray.phases[n] * view_nodes[first + n].rgb;
    light.volume += weight * volume;
    light.radiance += weight * (volume + view_nodes[others + SLICE_GROUND].rgb);
    light.transmittance += weight * view_nodes[others + SLICE_THROUGH].rgb;
}

SkyLight look_up(SkyRay ray)
{
    SkyLight light = SkyLight(vec3(0.0), vec3(0.0), vec3(0.0), sky_length_m(ray));
    bool is_below = light.length_m < FAR_M;
    float horizon = horizon_rad();
    float off_rad = abs(sky_asin(ray.cosine) - horizon);
    uint i, j;
    float x = among_azimuths(ray, i);
    float y = sky_among(sqrt(max(0.0, off_rad - HORIZON_GAP_RAD) / range_rad(horizon, is_below)),
                        view.elevations, j);
    uint first = ((is_below ? view.elevations : 0u) + j) * view.azimuths + i;
    add_node(ray, first, (1.0 - x) * (1.0 - y), light);
    add_node(ray, first + 1u, x * (1.0 - y), light);
    add_node(ray, first + view.azimuths, (1.0 - x) * y, light);
    add_node(ray, first + view.azimuths + 1u, x * y, light);
    return light;
}

void main()
{
    if (gl_GlobalInvocationID.x >= part.pixel_count)
        return;
    uint pixel = part.first_pixel + gl_GlobalInvocationID.x;
    float i = float(pixel % view.width_px) + 0.5, j = float(pixel / view.width_px) + 0.5;
    float x = (2.0 * i / float(view.width_px) - 1.0) * view.half_width;
    float y = (1.0 - 2.0 * j / float(view.height_px)) * view.half_height;
    vec3 direction = normalize(view.forward + x * view.right + y * view.up);
    SkyRay ray = view_ray(dot(direction, view.vertical), dot(direction, view.sun_direction));
    sky_find_phases(ray, direction, view.sun_direction);
    SkyLight light;
    if (view.elevations > 0u)
        light = look_up(ray);
    else
        light = sky_walk(ray, view.steps, view.scatters != 0u, view.has_field != 0u);
    float depth_m = light.length_m < FAR_M ? light.length_m * dot(direction, view.forward) : FAR_M;
    sky_pixels[gl_GlobalInvocationID.x] = SkyPixel(vec4(view.sun_irradiance * light.radiance,
                                                        depth_m),
                                                   vec4(view.sun_irradiance * light.volume, 0.0),
                                                   vec4(light.transmittance, 0.0));
}
