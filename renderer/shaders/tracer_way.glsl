// SPDX-License-Identifier: MIT
//
// View rays through voxel grids, walked once for all samples of a pixel: the integral of the
// density up to evenly spaced edges. A first collision is then searched in one segment of a few
// cells, not from the grid's border on. The result is the same.
#ifndef NEPH_TRACER_WAY_GLSL
#define NEPH_TRACER_WAY_GLSL

#include "tracer.glsl"

const uint WAY_STRETCHES = NEPH_GPU_WAY_STRETCHES;

// Per pixel and medium.
struct Way {
    float t0_m, t1_m; // the ray's part in the medium's box
    float integral_m[WAY_STRETCHES + 1u];
};

layout(std430, binding = 14) buffer Ways {
    Way ways[];
};

uint way_index(uint pixel, uint m) { return pixel * frame.medium_count + m; }

bool has_way(uint m)
{
    return !OPEN && !ENDLESS && !is_fog(m) && is_a(MEDIUM_GRID, frame.media[m].kind);
}

float way_edge_m(uint way, uint i)
{
    float t0_m = ways[way].t0_m, t1_m = ways[way].t1_m;
    return i == WAY_STRETCHES ? t1_m : t0_m + float(i) * ((t1_m - t0_m) / float(WAY_STRETCHES));
}

// Walks a view ray; returns its whole optical depth.
float way_walk(uint pixel, uint m, ViewRay ray, float length_m)
{
    uint way = way_index(pixel, m);
    float t0_m = 0.0, t1_m = length_m;
    if (!clip_medium(m, ray.origin_m, ray.direction, t0_m, t1_m))
        return 0.0; // there are no collisions to search
    ways[way].t0_m = t0_m;
    ways[way].t1_m = t1_m;
    Sum sum = sum_zero();
    for (uint i = 0; i < WAY_STRETCHES; i++) {
        ways[way].integral_m[i] = sum.value.x;
        sum_add(sum, vec4(grid_integral_m(frame.media[m].shape.grid, ray.origin_m, ray.direction,
                                          way_edge_m(way, i), way_edge_m(way, i + 1u))));
    }
    ways[way].integral_m[WAY_STRETCHES] = sum.value.x;
    return frame.media[m].extinction_per_m * sum.value.x;
}

float way_free_path_m(uint pixel, uint m, ViewRay ray, float depth)
{
    uint way = way_index(pixel, m);
    float target_m = depth / frame.media[m].extinction_per_m;
    uint low = 0, high = WAY_STRETCHES;
    while (high - low > 1u) {
        uint middle = (low + high) / 2u;
        if (ways[way].integral_m[middle] <= target_m)
            low = middle;
        else
            high = middle;
    }
    return grid_free_path_m(frame.media[m].shape.grid, ray.origin_m, ray.direction,
                            way_edge_m(way, low), way_edge_m(way, high),
                            target_m - ways[way].integral_m[low]);
}

// layer_free_path_m() (media.glsl) for a pixel's ray.
float view_free_path_m(uint pixel, uint m, uint l, ViewRay ray, float t0_m, float t1_m,
                       float depth)
{
    if (has_way(m))
        return clamp(way_free_path_m(pixel, m, ray, depth), t0_m, t1_m);
    return layer_free_path_m(m, l, ray, t0_m, t1_m, depth);
}

#endif
