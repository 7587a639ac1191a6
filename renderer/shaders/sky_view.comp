#version 450
// SPDX-License-Identifier: MIT
//
// The table of views: a thread is the part of a layer in a node, or all that is not of one layer.
#extension GL_GOOGLE_include_directive : require

#include "sky_view.glsl"

layout(local_size_x = 64) in;

// [half][elevation][azimuth][slice]
layout(std430, binding = 5) writeonly buffer ViewNodes {
    vec4 view_nodes[];
};

void main()
{
    uint parts = air.layer_count + 1u, node = gl_GlobalInvocationID.x / parts;
    uint layer = gl_GlobalInvocationID.x % parts;
    if (node >= 2u * view.elevations * view.azimuths)
        return;
    uint row = node / view.azimuths;
    bool is_below = row >= view.elevations, is_layer = layer < air.layer_count;
    float horizon = horizon_rad();
    float part = float(row % view.elevations) / float(view.elevations - 1u);
    float off_rad = HORIZON_GAP_RAD + range_rad(horizon, is_below) * part * part;
    float elevation = is_below ? horizon - off_rad : horizon + off_rad;
    float turn = float(node % view.azimuths) / float(view.azimuths - 1u);
    SkyRay ray = view_ray(sin(elevation), 0.0);
    float sun_sine = sqrt(max(0.0, 1.0 - ray.sun_cosine * ray.sun_cosine));
    ray.toward_sun = ray.cosine * ray.sun_cosine +
                     cos(elevation) * sun_sine * cos(PI * turn * turn);
    for (uint n = 0u; n < air.layer_count; n++)
        ray.phases[n] = n == layer ? 1.0 : 0.0;
    SkyLight light = sky_walk(ray, view.steps, view.scatters != 0u,
                              !is_layer && view.has_field != 0u);
    uint first = node * slice_count();
    if (is_layer) {
        view_nodes[first + layer] = vec4(light.volume, 0.0);
    } else {
        first += air.layer_count;
        view_nodes[first + SLICE_HIGHER] = vec4(light.volume, 0.0);
        view_nodes[first + SLICE_GROUND] = vec4(light.radiance - light.volume, 0.0);
        view_nodes[first + SLICE_THROUGH] = vec4(light.transmittance, 0.0);
    }
}
