// SPDX-License-Identifier: MIT
//
// Where a ray has met a given optical depth of one medium: exact inversion of the closed forms.
#ifndef NEPH_FREE_PATH_GLSL
#define NEPH_FREE_PATH_GLSL

#include "tracer.glsl"

// The place within a stretch over which the density is a cubic, given by its values at 0, 1/3, 2/3
// and 1, where the integral reaches `fraction` of that over all of it. Newton's method, held
// between bounds that bisection narrows.
float cubic_quantile(vec4 f, float fraction)
{
    float c1 = 0.5 * (-11.0 * f.x + 18.0 * f.y - 9.0 * f.z + 2.0 * f.w);
    float c2 = 4.5 * (2.0 * f.x - 5.0 * f.y + 4.0 * f.z - f.w);
    float c3 = 4.5 * (-f.x + 3.0 * f.y - 3.0 * f.z + f.w);
    float target = fraction * (f.x + c1 / 2.0 + c2 / 3.0 + c3 / 4.0);
    float low = 0.0, high = 1.0, s = fraction;
    for (int i = 0; i < 12; i++) {
        float integral = s * (f.x + s * (c1 / 2.0 + s * (c2 / 3.0 + s * (c3 / 4.0))));
        float density = f.x + s * (c1 + s * (c2 + s * c3));
        if (integral < target)
            low = s;
        else
            high = s;
        float newton = s - (integral - target) / max(density, 1e-30);
        s = newton > low && newton < high ? newton : 0.5 * (low + high);
    }
    return s;
}

// The walk of grid_integral_m (grid.glsl), stopped in the cell where the integral passes `target`.
float grid_free_path_m(Grid grid, vec3 origin_m, vec3 direction, float t0_m, float t1_m,
                       float target)
{
    const float gauss = 0.288675134594813; // 1 / sqrt(12)
    vec3 slope = direction * grid.nodes_per_m;
    vec3 start = (origin_m - grid.origin_m) * grid.nodes_per_m;
    vec3 last = vec3(grid.size - 2);
    vec3 side = vec3(greaterThanEqual(slope, vec3(0.0)));
    bvec3 level = lessThan(abs(slope), vec3(1e-20));
    vec3 per_slope = mix(1.0 / slope, vec3(0.0), level);
    vec3 cell = clamp(floor(start + t0_m * slope), vec3(0.0), last), corner = cell;
    float t_m = t0_m, end_m = t0_m, sum = 0.0, term = 0.0;
    Cell nodes = Cell(vec4(0.0), vec4(0.0));
    while (end_m < t1_m && sum + term < target && all(greaterThanEqual(cell, vec3(0.0))) &&
           all(lessThanEqual(cell, last))) {
        sum += term;
        t_m = end_m;
        vec3 faces_m = mix((cell + side - start) * per_slope, vec3(FAR_M), level);
        float exit_m = min(faces_m.x, min(faces_m.y, faces_m.z));
        end_m = max(t_m, min(exit_m, t1_m));
        corner = cell;
        nodes = grid_cell(grid, uvec3(cell));
        float middle_m = 0.5 * (t_m + end_m), offset_m = gauss * (end_m - t_m);
        vec3 a = clamp(start + (middle_m - offset_m) * slope - cell, vec3(0.0), vec3(1.0));
        vec3 b = clamp(start + (middle_m + offset_m) * slope - cell, vec3(0.0), vec3(1.0));
        term = 0.5 * (end_m - t_m) * (cell_density(nodes, a) + cell_density(nodes, b));
        cell += mix(vec3(0.0), 2.0 * side - 1.0, lessThanEqual(faces_m, vec3(exit_m)));
    }
    if (sum + term < target)
        return end_m;
    vec4 densities;
    for (int i = 0; i < 4; i++)
        densities[i] = cell_density(nodes, clamp(start + mix(t_m, end_m, float(i) / 3.0) * slope -
                                                     corner, vec3(0.0), vec3(1.0)));
    return mix(t_m, end_m,
               cubic_quantile(densities, clamp((target - sum) / max(term, 1e-30), 0.0, 1.0)));
}

// Any closed form, by bisection to the last bit of a float32.
float bisected_free_path_m(uint m, vec3 direction, float t0_m, float t1_m, float depth)
{
    float low_m = t0_m, high_m = t1_m;
    for (int i = 0; i < 26; i++) {
        float middle_m = 0.5 * (low_m + high_m);
        if (medium_optical_depth(m, vec3(0.0), direction, middle_m) < depth)
            low_m = middle_m;
        else
            high_m = middle_m;
    }
    return 0.5 * (low_m + high_m);
}

// Along a ray from the camera, within [t0, t1] (the medium's box) where the medium, of a fog the
// layer alone, has a scalar optical depth.
float medium_free_path(uint m, uint layer, vec3 direction, float t0_m, float t1_m, float depth)
{
    uint kind = frame.media[m].kind;
    float t_m = t1_m;
    if (is_fog(m))
        t_m = t0_m + fog_free_path(frame.media[m].layers[layer], t0_m * direction.y, direction.y,
                                   depth);
    else if (has_kind(MEDIUM_GRID) && kind == MEDIUM_GRID)
        t_m = grid_free_path_m(frame.media[m].grid, vec3(0.0), direction, t0_m, t1_m,
                               depth / frame.media[m].extinction_per_m);
    else if (has_kind(MEDIUM_GAUSSIAN) || has_kind(MEDIUM_SHELL))
        t_m = bisected_free_path_m(m, direction, t0_m, t1_m, depth);
    return clamp(t_m, t0_m, t1_m);
}

#endif
