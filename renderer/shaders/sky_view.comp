#version 450
// SPDX-License-Identifier: MIT
//
// The tables of views: each node is a ray, and of each ray what every layer scatters by itself, and
// all that is not of one layer. Eight threads share one of these, for there are fewer of them than
// a GPU has room for: each walks its part of the steps as if it began there, and the first puts the
// parts one behind the other.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#define SKY_IS_KNOWN
#define SKY_IS_FILLED
#include "sky_view.glsl"

layout(local_size_x = 64) in;

const uint WALKERS = NEPH_GPU_SKY_WALKERS;

shared vec3 volumes[gl_WorkGroupSize.x], throughs[gl_WorkGroupSize.x];

// A node is [half][elevation][azimuth], of slices.
SkyRay ray_of(SkyPlace place, uint node)
{
    uint row = node / eye.azimuths;
    bool is_below = row >= eye.elevations;
    float horizon_rad = sky_horizon_rad(place);
    float part = float(row % eye.elevations) / float(eye.elevations - 1u);
    float off_rad = HORIZON_GAP_RAD + sky_range_rad(horizon_rad, is_below) * part * part;
    float elevation = is_below ? horizon_rad - off_rad : horizon_rad + off_rad;
    float turn = float(node % eye.azimuths) / float(eye.azimuths - 1u);
    SkyRay ray = sky_ray_from(place, sin(elevation), 0.0);
    float sun_sine = sqrt(max(0.0, 1.0 - ray.sun_cosine * ray.sun_cosine));
    ray.toward_sun = ray.cosine * ray.sun_cosine +
                     cos(elevation) * sun_sine * cos(PI * turn * turn);
    return ray;
}

// What the walkers from `first` on have found, the part nearest to the camera first.
SkyLight together(uint first, float length_m)
{
    SkyLight light = SkyLight(vec3(0.0), vec3(0.0), vec3(1.0), length_m);
    for (uint k = first; k < first + WALKERS; k++) {
        light.volume += light.transmittance * volumes[k];
        light.transmittance *= throughs[k];
    }
    return light;
}

void keep(uint first, uint layer, SkyRay ray, SkyLight light)
{
    vec3 per_m = light.volume / sky_way_m(light.length_m);
    if (layer < sky_layers()) {
        sky_nodes[first + layer] = vec4(per_m, 0.0);
        return;
    }
    first += sky_layers();
    if (light.length_m < FAR_M)
        sky_add_ground(ray, eye.has_field != 0u, light); // to a radiance of 0
    sky_nodes[first + SLICE_HIGHER] = vec4(per_m, 0.0);
    sky_nodes[first + SLICE_GROUND] = vec4(light.radiance, 0.0);
    sky_nodes[first + SLICE_THROUGH] = vec4(light.transmittance, 0.0);
}

// All rays of a layer come before those of the next: threads side by side do the same.
void main()
{
    uint thread = gl_LocalInvocationIndex, walker = thread % WALKERS;
    uint nodes = 2u * eye.elevations * eye.azimuths, rays = eye.place_count * nodes;
    uint task = gl_GlobalInvocationID.x / WALKERS, layer = task / rays;
    SkyPlace place = eye.places[task % rays / nodes];
    uint node = task % nodes;
    SkyRay ray = ray_of(place, node);
    SKY_UNROLL for (uint n = 0u; n < sky_layers(); n++)
        ray.phases[n] = n == layer ? 1.0 : 0.0;
    SkyPath path = sky_path(ray, eye.steps);
    SkyLight part = SkyLight(vec3(0.0), vec3(0.0), vec3(1.0), path.length_m);
    uint steps = path.falls + path.climbs;
    sky_walk_steps(ray, path, steps * walker / WALKERS, steps * (walker + 1u) / WALKERS,
                   eye.scatters != 0u, layer == sky_layers() && eye.has_field != 0u, part);
    volumes[thread] = part.volume;
    throughs[thread] = part.transmittance;
    barrier();
    if (walker == 0u && layer <= sky_layers())
        keep(place.first + node * sky_slice_count(), layer, ray,
             together(thread, path.length_m));
}
