#version 450
// SPDX-License-Identifier: MIT
//
// Fills the tables of views (sky_view.glsl). A node is a ray; its slices are the single scattering
// of each layer, and one task more for everything else. There are fewer tasks than a GPU can run in
// parallel, so eight threads share one: each marches a part of the steps as if the ray started
// there, and the first one composes the parts.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#define SKY_IS_KNOWN
#define SKY_IS_FILLED
#include "sky_view.glsl"

layout(local_size_x = 64) in;

const uint WALKERS = NEPH_GPU_SKY_WALKERS;

shared vec3 volumes[gl_WorkGroupSize.x], throughs[gl_WorkGroupSize.x];

// The ray of a node, [half][elevation][azimuth]. Nodes are dense at the horizon and towards the
// sun.
SkyRay node_ray(SkyPlace place, uint node)
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

// Composes the parts of the threads from `first` on, the nearest part first.
SkyLight compose_parts(uint first, float length_m)
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
        sky_add_ground(ray, eye.has_field != 0u, light); // adds to a radiance of 0
    sky_nodes[first + SLICE_HIGHER] = vec4(per_m, 0.0);
    sky_nodes[first + SLICE_GROUND] = vec4(light.radiance, 0.0);
    sky_nodes[first + SLICE_THROUGH] = vec4(light.transmittance, 0.0);
}

// All rays of a layer come before the next layer's, so neighbouring threads do the same work.
void main()
{
    uint thread = gl_LocalInvocationIndex, walker = thread % WALKERS;
    uint nodes = 2u * eye.elevations * eye.azimuths, rays = eye.place_count * nodes;
    uint task = gl_GlobalInvocationID.x / WALKERS, layer = task / rays;
    SkyPlace place = eye.places[task % rays / nodes];
    uint node = task % nodes;
    SkyRay ray = node_ray(place, node);
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
             compose_parts(thread, path.length_m));
}
