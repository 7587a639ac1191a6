#version 450
// SPDX-License-Identifier: MIT
//
// Fast approximate anti-aliasing: FXAA 3.11 (T. Lottes, NVIDIA, 2009-2011), on encoded values. It
// acts where the luma range of a pixel's neighbourhood is large.
//
//   quality  finds the edge's direction and the steeper side, then samples luma on the border
//            between the two rows, in both directions, until it differs from the edge's mean:
//
//              . . . . . P . . .      P: the pixel
//              <-----------+---->     samples on the border
//              . . . . . N . . .      N: the neighbour across the edge
//
//            The distance to the nearer end gives the coverage of the pixel by the other side: the
//            image is read at that offset across the edge. A pixel that differs from all eight
//            neighbours (sub-pixel aliasing) is blurred across the edge, too.
//   console  averages two near and two far samples along the edge. The far samples are dropped when
//            their luma is outside the neighbourhood's range.
//
// The image is sampled bilinearly in float32.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "post_sampling.glsl"

float luma_at(vec2 place) { return luma(bilinear(place)); }
float luma_at(ivec2 pixel) { return luma(fetch(pixel)); }

// --- quality -------------------------------------------------------------------------------------

// Length of each step along the edge, by preset [px]. Nothing is sampled after the last one.
const int STEPS_MAX = 12;
const float STEPS_12[STEPS_MAX] =
    float[](1.0, 1.5, 2.0, 4.0, 12.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
const float STEPS_29[STEPS_MAX] =
    float[](1.0, 1.5, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 4.0, 8.0);
const float STEPS_39[STEPS_MAX] =
    float[](1.0, 1.0, 1.0, 1.0, 1.0, 1.5, 2.0, 2.0, 2.0, 2.0, 4.0, 8.0);

int step_count() { return choice(POST_FXAA) == POST_FXAA_12 ? 5 : STEPS_MAX; }

float step_px(int i)
{
    return choice(POST_FXAA) == POST_FXAA_12   ? STEPS_12[i]
           : choice(POST_FXAA) == POST_FXAA_29 ? STEPS_29[i]
                                               : STEPS_39[i];
}

// The edge between a pixel and one of its neighbours.
struct Edge {
    vec2 along, across; // unit vectors; `across` points to the neighbour
    float contrast;     // difference of luma
    float mean;         // mean luma of both
    bool is_below;      // the pixel's luma is below the mean
};

// One end of the edge: its distance, and on which side of the mean the luma is there.
struct End {
    float distance_px;
    float beyond; // luma there minus the edge's mean
};

// Follows the edge in one direction until the luma differs from the mean by a quarter of the
// contrast.
End walk(Edge edge, vec2 border, float way)
{
    End end = End(step_px(0), 0.0);
    for (int i = 1; i < step_count(); i++) {
        end.beyond = luma_at(border + way * end.distance_px * edge.along) - edge.mean;
        if (abs(end.beyond) >= 0.25 * edge.contrast)
            break;
        end.distance_px += step_px(i);
    }
    return end;
}

// Offset across the edge at which the image is read: 1/2 minus the relative distance of the nearer
// end, if luma at that end is on the other side of the mean than the pixel; else 0.
float across_px(Edge edge, vec2 centre)
{
    vec2 border = centre + 0.5 * edge.across;
    End before = walk(edge, border, -1.0), after = walk(edge, border, 1.0);
    bool is_before_nearer = before.distance_px < after.distance_px;
    float beyond = is_before_nearer ? before.beyond : after.beyond;
    float nearer_px = min(before.distance_px, after.distance_px);
    bool crosses = (beyond < 0.0) != edge.is_below;
    return crosses ? 0.5 - nearer_px / (before.distance_px + after.distance_px) : 0.0;
}

vec3 quality(ivec2 pixel)
{
    float lumas[9]; // 3x3, row by row
    [[unroll]] for (int i = 0; i < 9; i++)
        lumas[i] = luma_at(pixel + ivec2(i % 3, i / 3) - 1);
    float middle = lumas[4], north = lumas[1], south = lumas[7], west = lumas[3], east = lumas[5];
    float most = max(max(max(north, south), max(west, east)), middle);
    float least = min(min(min(north, south), min(west, east)), middle);
    float range = most - least;
    if (range < max(setting(POST_FXAA_THRESHOLD_MIN), most * setting(POST_FXAA_THRESHOLD)))
        return fetch(pixel);

    float bend_rows = abs(lumas[0] + lumas[6] - 2.0 * west) +
                      2.0 * abs(north + south - 2.0 * middle) +
                      abs(lumas[2] + lumas[8] - 2.0 * east);
    float bend_columns = abs(lumas[0] + lumas[2] - 2.0 * north) +
                         2.0 * abs(west + east - 2.0 * middle) +
                         abs(lumas[6] + lumas[8] - 2.0 * south);
    bool is_horizontal = bend_rows >= bend_columns;
    float one = is_horizontal ? north : west, other = is_horizontal ? south : east;
    bool is_one = abs(one - middle) >= abs(other - middle);

    Edge edge;
    edge.along = is_horizontal ? vec2(1.0, 0.0) : vec2(0.0, 1.0);
    edge.across = (is_one ? -1.0 : 1.0) * edge.along.yx;
    edge.contrast = max(abs(one - middle), abs(other - middle));
    edge.mean = 0.5 * (middle + (is_one ? one : other));
    edge.is_below = middle < edge.mean;

    float around = (2.0 * (north + south + west + east) + lumas[0] + lumas[2] + lumas[6] +
                    lumas[8]) / 12.0;
    float standing_out = clamp(abs(around - middle) / range, 0.0, 1.0);
    float smoothed = standing_out * standing_out * (3.0 - 2.0 * standing_out);
    float sub_pixel_px = smoothed * smoothed * setting(POST_FXAA_SUBPIXEL);

    vec2 centre = vec2(pixel) + 0.5;
    return bilinear(centre + max(across_px(edge, centre), sub_pixel_px) * edge.across);
}

// --- console -------------------------------------------------------------------------------------

vec3 console(ivec2 pixel)
{
    const float THRESHOLD = 0.125, THRESHOLD_MIN = 0.05, SHARPNESS = 8.0, NEAR_PX = 0.5,
                FAR_PX = 2.0;
    const float NEVER_FLAT = 1.0 / 384.0; // avoids 0 / 0 for the direction in a flat area
    const float LEAST_SIDE = 1e-6;        // the same for an edge along an axis
    vec2 centre = vec2(pixel) + 0.5;
    vec3 colour = fetch(pixel);
    float middle = luma(colour);
    float upper_left = luma_at(centre + vec2(-0.5, -0.5));
    float upper_right = luma_at(centre + vec2(0.5, -0.5)) + NEVER_FLAT;
    float lower_left = luma_at(centre + vec2(-0.5, 0.5));
    float lower_right = luma_at(centre + vec2(0.5, 0.5));
    float most = max(max(upper_left, upper_right), max(lower_left, lower_right));
    float least = min(min(upper_left, upper_right), min(lower_left, lower_right));
    if (max(most, middle) - min(least, middle) < max(THRESHOLD_MIN, most * THRESHOLD))
        return colour;
    float rising = lower_left - upper_right, falling = lower_right - upper_left;
    vec2 along = vec2(rising + falling, rising - falling);
    if (along == vec2(0.0))
        return colour; // a saddle has no direction
    along = normalize(along);
    vec3 near = bilinear(centre - NEAR_PX * along) + bilinear(centre + NEAR_PX * along);
    float least_side = max(min(abs(along.x), abs(along.y)), LEAST_SIDE);
    vec2 far_along = clamp(along / (SHARPNESS * least_side), -2.0, 2.0);
    vec3 far = bilinear(centre - FAR_PX * far_along) + bilinear(centre + FAR_PX * far_along);
    vec3 all_four = 0.25 * (near + far);
    bool is_foreign = luma(all_four) < least || luma(all_four) > most;
    return is_foreign ? 0.5 * near : all_four;
}

void main()
{
    ivec2 pixel;
    if (!get_thread_pixel(pixel))
        return;
    put(pixel, choice(POST_FXAA) == POST_FXAA_CONSOLE ? console(pixel) : quality(pixel));
}
