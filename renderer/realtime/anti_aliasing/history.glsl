// SPDX-License-Identifier: MIT
//
// The history: the output of the frame before, at the place where that frame showed the point that
// the pixel shows now. The place lies between texels, so these are filtered:
//
//     t     t     t     t     t  texels of the history, the centres of its pixels
//                             c  the texel up and left of the place
//     t     c     t     t     x  the place, `way` from c, 0 .. 1 along both axes
//              x
//     t     t     t     t     nearest: 1 texel; bilinear: the inner 2x2; Catmull-Rom: all 4x4.
//                             (Unreal leaves out the corners of 4x4, whose weights sum to up to
//     t     t     t     t     1/64, and normalises the remaining weights.)
#ifndef NEPH_REALTIME_TAA_HISTORY_GLSL
#define NEPH_REALTIME_TAA_HISTORY_GLSL

#include "filters.glsl"
#include "motion.glsl"

// RGB: filtered, A: the age of the nearest texel. A CPU skips rows at the ends without weight.
// Other texels without weight are read but not added, because they may not be finite.
vec4 filter_history(vec2 place_px)
{
    precise vec2 corner = floor(place_px - 0.5);
    precise vec2 way = place_px - 0.5 - corner;
    if (is_static)
        return fetch_output(RT_TAA_BEFORE, ivec2(corner));
    vec4 columns = tap_weights(choice(RT_TAA_HISTORY), way.x);
    vec4 rows = tap_weights(choice(RT_TAA_HISTORY), way.y);
    vec3 sum = vec3(0.0);
    for (int y = first_tap(rows); y <= last_tap(rows); y++)
        [[unroll]] for (int x = 0; x < 4; x++) {
            float weight = columns[x] * rows[y];
            vec3 texel = fetch_output(RT_TAA_BEFORE, ivec2(corner) + ivec2(x, y) - 1).rgb;
            sum = weight != 0.0 ? sum + weight * texel : sum;
        }
    float age = keeps_age() ? fetch_output(RT_TAA_BEFORE, ivec2(floor(place_px))).a : 0.0;
    return vec4(sum, age);
}

#endif
