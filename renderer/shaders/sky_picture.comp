#version 450
// SPDX-License-Identifier: MIT
//
// What a camera sees of a planet and its sky: a thread is a pixel.
#extension GL_GOOGLE_include_directive : require

#include "sky_tables.glsl"

layout(local_size_x = 64) in;

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
};

layout(std430, binding = 3) readonly buffer SkyEye {
    SkyView view;
};

struct SkyPixel {
    vec4 radiance; // w: eye depth [m], FAR_M: sky
    vec4 volume;
    vec4 transmittance;
};

layout(std430, binding = 4) writeonly buffer SkyPixels {
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
    float i = float(pixel % view.width_px) + 0.5, j = float(pixel / view.width_px) + 0.5;
    float x = (2.0 * i / float(view.width_px) - 1.0) * view.half_width;
    float y = (1.0 - 2.0 * j / float(view.height_px)) * view.half_height;
    vec3 direction = normalize(view.forward + x * view.right + y * view.up);
    SkyRay ray;
    ray.altitude_m = view.altitude_m;
    ray.cosine = dot(direction, view.vertical);
    ray.sun_cosine = dot(view.sun_direction, view.vertical);
    ray.toward_sun = dot(direction, view.sun_direction);
    sky_find_phases(ray, direction, view.sun_direction);
    SkyLight light = sky_walk(ray, view.steps, view.scatters != 0u, view.has_field != 0u);
    float depth_m = light.length_m < FAR_M ? light.length_m * dot(direction, view.forward) : FAR_M;
    sky_pixels[gl_GlobalInvocationID.x] = SkyPixel(vec4(view.sun_irradiance * light.radiance,
                                                        depth_m),
                                                   vec4(view.sun_irradiance * light.volume, 0.0),
                                                   vec4(light.transmittance, 0.0));
}
