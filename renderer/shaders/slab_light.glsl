// SPDX-License-Identifier: MIT
//
// Slab light (renderer/slab_light.h) in the ray marcher: multiple scattering from a table of slabs,
// after A. Bouthors et al., "Interactive multiple anisotropic scattering in clouds", I3D 2008. A
// point sends to the camera
// - single scattering of the original medium,
// - single scattering of the similar isotropic medium, minus the original's: light that is
//   scattered forward in the original before or after its one deflection,
// - from the table: multiple scattering of the similar medium.
#ifndef NEPH_SLAB_LIGHT_GLSL
#define NEPH_SLAB_LIGHT_GLSL

#include "march_light.glsl"

const uint SLAB_NODES = NEPH_GPU_SLAB_NODES;

// Optical depth from a point away from the sun, to the next solid.
float depth_behind(vec3 point_m)
{
    vec3 away = -to_sun();
    float length_m = scene_hit(point_m, away).t_m, depth = 0.0;
    if (CACHES_SUN) {
        vec3 low_m = frame.sun_lattice.origin_m;
        vec3 high_m = low_m + vec3(frame.sun_lattice.size - 1) / frame.sun_lattice.per_m;
        float t0_m = 0.0, t1_m = length_m;
        if ((KINDS & FOG_KINDS) != 0u)
            depth = exact_optical_depth_by_kind(KINDS & FOG_KINDS, point_m, away, length_m).x;
        if (clip_box(low_m, high_m, point_m, away, t0_m, t1_m))
            depth += max(sun_lattice_depth(point_m + t1_m * away).x -
                             cached_sun_depth(point_m).x, 0.0);
        return depth;
    }
    if (SUN == EXACT)
        depth = exact_optical_depth(point_m, away, length_m).x;
    if (SUN_MARCHED != 0u)
        depth += marched_optical_depth(SUN_MARCHED, point_m, away, FAR_M,
                                       make_nonuniform(frame.sun_steps))
                     .x;
    return depth;
}

// Position in the table, in nodes.
vec2 slab_place(vec2 depths)
{
    vec2 octaves = log2(1.0 + NEPH_GPU_SLAB_PER_DEPTH * depths);
    return min(octaves / NEPH_GPU_SLAB_OCTAVES, 1.0) * float(SLAB_NODES - 1u);
}

// Mean diffuse radiance in a slab, by the optical depths above and below, per 1 W/m^2 of sun
// [1/sr].
vec3 slab_radiance(float above, float below)
{
    vec2 place = slab_place(vec2(above, below));
    uvec2 low = min(uvec2(place), uvec2(SLAB_NODES - 2u));
    vec2 part = place - vec2(low);
    uint at = low.x + SLAB_NODES * low.y;
    return mix(mix(higher_orders[at], higher_orders[at + 1u], part.x),
               mix(higher_orders[at + SLAB_NODES], higher_orders[at + SLAB_NODES + 1u], part.x),
               part.y)
        .rgb;
}

// Radiance that a step of optical depth `step_depth` behind `seen_depth` sends to the camera.
vec3 slab_light(Mixture mixture, vec3 point_m, float seen_depth, float step_depth)
{
    if (mixture.scattering == vec3(0.0) || !medium_sees_sun(point_m))
        return vec3(0.0);
    float scale = 1.0 - make_similar_medium(mixture).onward_per_m / mixture.extinction_per_m.x;
    float sun_depth = sample_sun_depth(point_m).x, behind = depth_behind(point_m);
    float through = transmittance(sun_depth + seen_depth) * phi(step_depth);
    float through_similar = transmittance(scale * seen_depth) * phi(scale * step_depth);
    vec3 more = slab_radiance(scale * sun_depth, scale * behind) * through_similar;
    more += (transmittance(scale * sun_depth) * through_similar - through) / (4.0 * PI);
    vec3 sum = mixture.scattering * through;
    [[unroll]] for (uint m = 0; m < media_count(); m++)
        sum += scattering_per_m[m] * (1.0 - medium_mean_cosine(m)) * more;
    return sun_at(point_m) * sum / mixture.extinction_per_m.x * step_depth;
}

#endif
