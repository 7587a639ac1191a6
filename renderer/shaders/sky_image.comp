#version 450
// SPDX-License-Identifier: MIT
//
// Renders a planet and its sky without other media: each thread is a pixel, which marches its ray
// or reads the table of views.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#define SKY_IS_KNOWN
#include "sky_view.glsl"

layout(local_size_x = 64) in;

struct SkyPixel {
    vec4 radiance; // w: eye depth [m]; FAR_M: sky
    vec4 volume;
    vec4 transmittance;
};

layout(std430, binding = 2) writeonly buffer SkyPixels {
    SkyPixel sky_pixels[];
};

layout(push_constant) uniform SkyPart {
    uint first_pixel, pixel_count;
} part;

void main()
{
    if (gl_GlobalInvocationID.x >= part.pixel_count)
        return;
    uint pixel = part.first_pixel + gl_GlobalInvocationID.x;
    float i = float(pixel % eye.width_px) + 0.5, j = float(pixel / eye.width_px) + 0.5;
    float x = (2.0 * i / float(eye.width_px) - 1.0) * eye.half_width;
    float y = (1.0 - 2.0 * j / float(eye.height_px)) * eye.half_height;
    vec3 direction = normalize(eye.forward + x * eye.right + y * eye.up);
    SkyRay ray = sky_ray_along(eye.places[0], direction);
    SkyLight light;
    if (eye.elevations > 0u)
        light = sky_look_up(eye.places[0], ray);
    else
        light = sky_walk(ray, eye.steps, eye.scatters != 0u, eye.has_field != 0u);
    float depth_m = light.length_m < FAR_M ? light.length_m * dot(direction, eye.forward) : FAR_M;
    sky_pixels[gl_GlobalInvocationID.x] = SkyPixel(vec4(eye.sun_irradiance * light.radiance,
                                                        depth_m),
                                                   vec4(eye.sun_irradiance * light.volume, 0.0),
                                                   vec4(light.transmittance, 0.0));
}
