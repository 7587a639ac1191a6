#version 450
// SPDX-License-Identifier: MIT
//
// The tables of views: a thread is the part of a layer in a node, or all that is not of one layer.
#extension GL_GOOGLE_include_directive : require

#define SKY_IS_FILLED
#include "sky_view.glsl"

layout(local_size_x = 64) in;

// A node is [half][elevation][azimuth], of slices.
void main()
{
    uint parts = air.layer_count + 1u, nodes = 2u * eye.elevations * eye.azimuths;
    uint node = gl_GlobalInvocationID.x / parts, layer = gl_GlobalInvocationID.x % parts;
    if (node >= eye.place_count * nodes)
        return;
    SkyPlace place = eye.places[node / nodes];
    node %= nodes;
    uint row = node / eye.azimuths;
    bool is_below = row >= eye.elevations, is_layer = layer < air.layer_count;
    float horizon_rad = sky_horizon_rad(place);
    float part = float(row % eye.elevations) / float(eye.elevations - 1u);
    float off_rad = HORIZON_GAP_RAD + sky_range_rad(horizon_rad, is_below) * part * part;
    float elevation = is_below ? horizon_rad - off_rad : horizon_rad + off_rad;
    float turn = float(node % eye.azimuths) / float(eye.azimuths - 1u);
    SkyRay ray = sky_ray_from(place, sin(elevation), 0.0);
    float sun_sine = sqrt(max(0.0, 1.0 - ray.sun_cosine * ray.sun_cosine));
    ray.toward_sun = ray.cosine * ray.sun_cosine +
                     cos(elevation) * sun_sine * cos(PI * turn * turn);
    for (uint n = 0u; n < air.layer_count; n++)
        ray.phases[n] = n == layer ? 1.0 : 0.0;
    SkyLight light = sky_walk(ray, eye.steps, eye.scatters != 0u, !is_layer && eye.has_field != 0u);
    uint first = place.first + node * sky_slice_count();
    vec3 per_m = light.volume / sky_way_m(light.length_m);
    if (is_layer) {
        sky_nodes[first + layer] = vec4(per_m, 0.0);
    } else {
        first += air.layer_count;
        sky_nodes[first + SLICE_HIGHER] = vec4(per_m, 0.0);
        sky_nodes[first + SLICE_GROUND] = vec4(light.radiance - light.volume, 0.0);
        sky_nodes[first + SLICE_THROUGH] = vec4(light.transmittance, 0.0);
    }
}
