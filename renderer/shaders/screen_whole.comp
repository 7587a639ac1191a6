#version 450
// SPDX-License-Identifier: MIT
//
// Upsampling from one pixel per cell to all pixels: bilinear weights over four cells, times the
// similarity of their surfaces (J. Kopf et al., "Joint Bilateral Upsampling", SIGGRAPH 2007).
#extension GL_GOOGLE_include_directive : require

#include "screen.glsl"

const uint OF_AO = 0u, OF_GI = 1u, OF_SSR = 2u; // values of run.turn: the signal that is upsampled

bool has_signal(ivec2 pixel)
{
    return run.turn == OF_AO ? !is_sky(depth_at_m(pixel)) : has_light(pixel, run.turn == OF_SSR);
}

// Value where no cell around has the signal or a similar orientation: unoccluded, and for indirect
// light the sky's unoccluded fraction, as without rays.
vec4 fallback_value(ivec2 pixel)
{
    float open = view.open_at != SCREEN_NONE ? load(int(view.open_at), pixel).x : 1.0;
    return run.turn == OF_AO ? vec4(1.0) : vec4(0.0, 0.0, 0.0, open);
}

// The value of a cell and the surface that it belongs to.
struct Cell {
    bool has_signal;
    vec3 point_m, normal;
    vec4 value;
};

Cell cell_at(ivec2 cell)
{
    ivec2 pixel = pixel_in(cell);
    if (!is_cell(cell) || !has_signal(pixel))
        return Cell(false, vec3(0.0), vec3(0.0), vec4(0.0));
    return Cell(true, surface_m(pixel), normal_at(pixel), load(int(run.from), cell));
}

// Similarity of a cell's surface: 1 in the pixel's plane, and LEAST off the plane, so that cells
// off the plane count only where there are no others. A cell facing sideways has none. Without that
// bound the eighth power of a cosine that is 0 up to rounding would select by rounding errors.
float surface_similarity(vec3 point_m, vec3 normal, Cell cell)
{
    const float LEAST = 1e-4, LEAST_FACING = 0.1; // a cosine
    float facing = min(dot(cell.normal, normal), 1.0);
    if (facing < LEAST_FACING)
        return 0.0;
    float squared = facing * facing, fourth = squared * squared;
    return max(LEAST, in_plane(point_m, normal, cell.point_m)) * fourth * fourth;
}

// Value of a pixel; `way` is its position between the first and the last of four cells.
vec4 upsample_cells(ivec2 pixel, vec2 way, Cell around[4])
{
    vec3 point_m = surface_m(pixel), normal = normal_at(pixel);
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int i = 0; i < 4; i++) {
        vec2 share = mix(1.0 - way, way, equal(ivec2(i & 1, i >> 1), ivec2(1)));
        float weight = share.x * share.y * surface_similarity(point_m, normal, around[i]);
        weight = around[i].has_signal ? weight : 0.0;
        sum += weight * around[i].value;
        weights += weight;
    }
    return weights > 0.0 ? sum / weights : fallback_value(pixel);
}

// A thread has four cells, and the up to four pixels from the first cell's pixel on, before the
// pixels of the others.
//
//     0 . 1      0..3: pixels of the cells
//     . .        .: pixels between them, written by this thread together with 0
//     2   3
void main()
{
    ivec2 place;
    if (!get_thread_place(cells() + used_px(), place))
        return;
    ivec2 corner = place - used_px();
    Cell around[4];
    for (int i = 0; i < 4; i++)
        around[i] = cell_at(corner + ivec2(i & 1, i >> 1));
    for (int i = 0; i < 4; i++) {
        ivec2 step_px = ivec2(i & 1, i >> 1), pixel = (corner << 1) + used_px() + step_px;
        if (!is_inside(pixel))
            continue;
        vec4 none = vec4(run.turn == OF_AO ? 1.0 : 0.0);
        vec2 way = vec2(step_px) / float(run.cell_px);
        store(int(run.to), pixel, has_signal(pixel) ? upsample_cells(pixel, way, around) : none);
    }
}
