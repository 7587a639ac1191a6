// SPDX-License-Identifier: MIT
//
// Upsampling: the history has output resolution, the frame has fewer pixels. The source of a pixel
// is the rendered pixel whose jittered ray is nearest to the pixel's centre.
//
//     +-----------+-----------+     large cells: rendered pixels, with their rays s
//     | .  s  .   | .  s  .   |     .  centres of output pixels, here at 50 %
//     |           |           |
//     | .     .   | .     .   |     The nine samples about a source are filtered by their distance
//     +-----------+-----------+     to the pixel's centre, in output pixels.
#ifndef NEPH_REALTIME_UPSAMPLING_GLSL
#define NEPH_REALTIME_UPSAMPLING_GLSL

#include "neighbourhood.glsl"

vec2 centre_in_frame_px; // the pixel's centre relative to the rays of the frame, in rendered pixels

ivec2 find_source(ivec2 pixel)
{
    precise vec2 centre = (vec2(pixel) + 0.5) * rendered_per_px - jitter_px;
    precise vec2 nearest = floor(centre);
    precise vec2 shift = nearest + 0.5 - centre;
    centre_in_frame_px = centre;
    shift_px = shift;
    return ivec2(nearest);
}

// Where no ray is near the centre the frame has less weight: the sum of the weights.
void find_filter_weights_and_coverage()
{
    coverage = 0.0;
    for (int i = 0; i < 9; i++) {
        vec2 way = (vec2(get_neighbour_offset(i)) + shift_px) / rendered_per_px;
        filter_weights[i] = exp(-SHARPNESS * dot(way, way));
        coverage += filter_weights[i];
    }
    coverage = min(coverage, 1.0);
}

ivec2 source_tile(ivec2 source) { return clamp(source, ivec2(0), view_size() - 1) / 4; }

#endif
