// SPDX-License-Identifier: MIT
//
// history.glsl for a GPU: all 4x4 texels are fetched before the first is used, while the frame's
// samples are filtered; the texel of a static pixel is fetched while the pixel above is resolved.
// After a branch a GPU would wait for one texel after the other.
#ifndef NEPH_REALTIME_TAA_HISTORY_GPU_GLSL
#define NEPH_REALTIME_TAA_HISTORY_GPU_GLSL

#include "filters.glsl"
#include "motion.glsl"

vec4 static_history, next_static_history;

void fetch_static_history(ivec2 pixel)
{
    if (is_static)
        next_static_history = fetch_output(RT_TAA_BEFORE, pixel);
}

void take_static_history(ivec2 next_pixel)
{
    static_history = next_static_history;
    fetch_static_history(next_pixel);
}

vec4 texels[16]; // around the place of a pixel in the frame before

int first_texel() { return choice(RT_TAA_HISTORY) == RT_FILTER_CATMULL_ROM ? 0 : 1; }

// For filter_history(). The place may be outside the frame or undefined: it is clamped.
void fetch_texels(vec2 place_px)
{
    ivec2 corner = ivec2(floor(place_px - 0.5));
    [[unroll]] for (int y = first_texel(); y <= 3 - first_texel(); y++)
        [[unroll]] for (int x = first_texel(); x <= 3 - first_texel(); x++)
            texels[4 * y + x] = fetch_output(RT_TAA_BEFORE, corner + ivec2(x, y) - 1);
}

// RGB: filtered, A: the age of the nearest texel.
vec4 filter_history(vec2 place_px)
{
    if (is_static)
        return static_history;
    precise vec2 corner = floor(place_px - 0.5);
    precise vec2 way = place_px - 0.5 - corner;
    vec4 columns = tap_weights(choice(RT_TAA_HISTORY), way.x);
    vec4 rows = tap_weights(choice(RT_TAA_HISTORY), way.y);
    vec3 sum = vec3(0.0);
    [[unroll]] for (int y = first_texel(); y <= 3 - first_texel(); y++)
        [[unroll]] for (int x = first_texel(); x <= 3 - first_texel(); x++) {
            float weight = columns[x] * rows[y];
            sum = weight != 0.0 ? sum + weight * texels[4 * y + x].rgb : sum;
        }
    vec2 ages = way.y >= 0.5 ? vec2(texels[9].a, texels[10].a) : vec2(texels[5].a, texels[6].a);
    return vec4(sum, way.x >= 0.5 ? ages.y : ages.x);
}

#endif
