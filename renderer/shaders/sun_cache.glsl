// SPDX-License-Identifier: MIT
//
// The sun cache: optical depth of all shapes towards the sun, at the nodes of a grid over their
// bounds. A trilinear lookup replaces the sun ray of a sample. The interpolation error is of second
// order in the node distance where the depth is smooth, and of first order behind an edge of the
// medium. Filled by sun_cache.comp.
#ifndef NEPH_SUN_CACHE_GLSL
#define NEPH_SUN_CACHE_GLSL

#include "shortcuts.glsl"

const uint SUN_CHANNELS = COLOURED ? 3 : 1; // values per node, stored together

layout(std430, binding = 7) readonly buffer SunCache {
    float sun_depths[];
};

uint sun_node(uvec3 node)
{
    uvec3 size = frame.sun_lattice.size;
    return SUN_CHANNELS * (node.x + size.x * (node.y + size.y * node.z));
}

// One channel at a place in the cell; `at` is the index of the cell's lowest node.
float sun_depth_in(uint at, vec3 in_cell)
{
    uint x = SUN_CHANNELS, y = x * frame.sun_lattice.size.x, z = y * frame.sun_lattice.size.y;
    return cell_density(Cell(vec4(sun_depths[at], sun_depths[at + x], sun_depths[at + y],
                                  sun_depths[at + x + y]),
                             vec4(sun_depths[at + z], sun_depths[at + x + z],
                                  sun_depths[at + y + z], sun_depths[at + x + y + z])),
                        in_cell);
}

// Lookup at a point inside the grid.
vec3 sun_lattice_depth(vec3 point_m)
{
    vec3 last = vec3(frame.sun_lattice.size - 1);
    vec3 place = (point_m - frame.sun_lattice.origin_m) * frame.sun_lattice.per_m;
    place = clamp(place, vec3(0.0), last);
    vec3 cell = min(floor(place), last - 1.0);
    uint at = sun_node(uvec3(cell));
    vec3 depth;
    depth.x = sun_depth_in(at, place - cell);
    if (!COLOURED)
        return depth.xxx;
    depth.y = sun_depth_in(at + 1, place - cell);
    depth.z = sun_depth_in(at + 2, place - cell);
    return depth;
}

// Lookup at any point. From outside the bounds the depth is the one at which the sun ray enters
// them.
vec3 cached_sun_depth(vec3 point_m)
{
    vec3 low_m = frame.sun_lattice.origin_m;
    vec3 high_m = low_m + vec3(frame.sun_lattice.size - 1) / frame.sun_lattice.per_m;
    float t0_m = 0.0, t1_m = FAR_M;
    if (!clip_box(low_m, high_m, point_m, to_sun(), t0_m, t1_m))
        return vec3(0.0);
    return sun_lattice_depth(point_m + t0_m * to_sun());
}

#endif
