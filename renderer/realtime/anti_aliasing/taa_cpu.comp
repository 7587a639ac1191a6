#version 450
// SPDX-License-Identifier: MIT
//
// taa.comp for a CPU (lavapipe), with the same bits. A thread processes a column of pixels from top
// to bottom: two of the three rows of samples around a pixel come from the pixel above, and the
// weights of the filter are computed once.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "history.glsl"
#include "rounding.glsl"
#include "taa.glsl"

const int TILE_PX = 4, COLUMN_PX = RT_TAA_COLUMN;

// Moves the neighbourhood one row down.
void fetch_next_row(ivec2 pixel, inout Neighbourhood around)
{
    around.valid >>= 3;
    for (int i = 0; i < 6; i++) {
        around.colours[i] = around.colours[i + 3];
        around.hdr_weights[i] = around.hdr_weights[i + 3];
    }
    for (int i = 6; i < 9; i++)
        set_sample(around, i, sample_from(fetch_colour(pixel + get_neighbour_offset(i))));
}

void resolve_pixel(ivec2 pixel, bool is_inside, inout Neighbourhood around)
{
    fetch_next_row(pixel, around);
    Past past = find_past(pixel, pixel);
    vec4 resolved = resolve(pixel, pixel, past, frame_from(around, !is_unclamped));
    if (is_inside)
        put_pixel(pixel, resolved);
}

// lavapipe keeps a thread's variables in memory across the iterations of a loop. Where the loop has
// little other work the four pixels of a tile are unrolled.
bool unrolls() { return is_static && is_unchanged(); }

void main()
{
    ivec2 pixel, size = view_size();
    if (!find_element(ivec2(size.x, (size.y - 1) / COLUMN_PX + 1), pixel))
        return;
    pixel.y *= COLUMN_PX;
    int end = min(pixel.y + COLUMN_PX, size.y);
    find_filter_weights();
    Neighbourhood around;
    around.valid = 0u;
    fetch_next_row(pixel - ivec2(0, 2), around);
    fetch_next_row(pixel - ivec2(0, 1), around);
    while (pixel.y < end) {
        find_change(pixel / TILE_PX);
        int tile_end = min(pixel.y + TILE_PX, end);
        if (unrolls()) {
            [[unroll]] for (int k = 0; k < TILE_PX; k++) {
                resolve_pixel(pixel, pixel.y < tile_end, around);
                pixel.y++;
            }
        } else {
            for (; pixel.y < tile_end; pixel.y++)
                resolve_pixel(pixel, true, around);
        }
    }
}
