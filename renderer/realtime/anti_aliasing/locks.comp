#version 450
// SPDX-License-Identifier: MIT
//
// Temporal upsampling with locks, after the description of AMD's FidelityFX Super Resolution 2
// (MIT, version 2.2), with its parts in one pass:
//
//     1. frame           16 samples, filtered by a Lanczos kernel about the pixel's centre
//     2. disocclusion    the history is invalid where the frame before showed only points nearer
//                        than this frame's surface
//     3. lock            a thin feature, a ridge of lumas, keeps its history out of the clamp for
//                        one period of the jitter, so that wires which no single frame shows as a
//                        whole are completed
//     4. clamp, blend    as in taa.comp; the weight of the history is the accumulated weight of its
//                        frames
//
// Like the original: dilated depths and their motion (3x3, taa_motion=square), disocclusion by
// depth, locks by ridges of 3x3 lumas that last one period of the jitter and end with the luma,
// accumulation by weights, less accumulation where a mask is reactive.
// Different:
// - The kernel is EASU's polynomial of 4x4 texels, along x and along y, on linear light (not
//   tone-mapped), clamped between the nearest 2x2; the history has taa_history. A frame's weight is
//   the sum of taau.comp's Gaussian.
// - Depths of the frame before are read at output pixels; the original scatters depths forwards.
//   History is valid where the depth before was at least 1 - SEPARATION of the nearest depth of 5x5
//   now, whatever the jitter has shifted.
// - A lock ends when its luma leaves the range of the 3x3 of the frame by 5 %; the original has a
//   pyramid of lumas, and four frames of luma to detect flicker, which is left out.
// - The variance clamp is three times as wide for a static pixel as at FAST_PX, and the
//   history's maximum weight at FAST_PX is a quarter: numbers of ours.
// - The reactive mask is the medium's opacity (taa_responsive), at most 0.9. There is no automatic
//   exposure and no built-in sharpening (sharpen=on).
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "history.glsl"
#include "rounding.glsl"
#include "taa.glsl"
#include "upsampling.glsl"

// --- the frame -----------------------------------------------------------------------------------

// 1 at 0; 0 at 1, at 2 and beyond.
float lanczos(float x)
{
    float squared = min(x * x, 4.0);
    float hump = 0.4 * squared - 1.0, window = 0.25 * squared - 1.0;
    return (1.5625 * hump * hump - 0.5625) * window * window;
}

// False when no sample is valid. Where some of 4x4 are not, the valid ones of 3x3 are filtered by
// the Gaussian, whose weights are all above 0.
bool upsample(Neighbourhood around, out vec3 colour)
{
    precise vec2 corner = floor(centre_in_frame_px - 0.5);
    vec2 way = centre_in_frame_px - 0.5 - corner;
    vec3 sum = vec3(0.0);
    Box nearest = EMPTY_BOX;
    float weights = 0.0;
    bool is_whole = true;
    for (int i = 0; i < 16; i++) {
        ivec2 at = ivec2(i & 3, i >> 2) - 1;
        Sample from = sample_from(fetch_colour(ivec2(corner) + at));
        float weight = lanczos(float(at.x) - way.x) * lanczos(float(at.y) - way.y);
        is_whole = is_whole && from.is_valid;
        sum += weight * from.colour;
        weights += weight;
        if ((at.x == 0 || at.x == 1) && (at.y == 0 || at.y == 1))
            extend(nearest, vec4(from.colour, 0.0));
    }
    bool is_any = filter_samples(around, colour);
    if (is_whole)
        colour = clamp_to(nearest, vec4(sum / weights, 0.0)).rgb;
    return is_whole || is_any;
}

// --- disocclusion --------------------------------------------------------------------------------

// Part of the depth by which all points seen at a place must have been nearer for the history there
// to be invalid.
const float SEPARATION = 0.02;

// The nearest depth within a distance; nearest_depth() of motion.glsl depends on taa_motion.
float nearest_depth_m(ivec2 source, int distance_px)
{
    float nearest_m = FAR_M;
    for (int y = -distance_px; y <= distance_px; y++)
        for (int x = -distance_px; x <= distance_px; x++) {
            float depth_m = fetch_full(RT_DEPTH, source + ivec2(x, y)).x;
            if (depth_m < nearest_m)
                nearest_m = depth_m;
        }
    return nearest_m;
}

// The eye depth of a static point at this depth for the camera of the frame before.
float depth_before_m(ivec2 pixel, float depth_m)
{
    vec3 ray = ray_through(vec2(pixel) + 0.5);
    float slant = view_now.is_parallel != 0u ? 1.0 : dot_in_order(ray, view_before.forward);
    precise float before_m = depth_m * slant -
                             dot_in_order(view_before.position_m, view_before.forward);
    return before_m;
}

// Whether all four texels around the place in the frame before showed a nearer surface.
bool is_disoccluded(ivec2 pixel, ivec2 source, vec2 before_px)
{
    ivec2 corner = ivec2(floor(before_px - 0.5));
    float farthest_before_m = -FAR_M;
    for (int i = 0; i < 4; i++)
        farthest_before_m = max(
            farthest_before_m, fetch_output(RT_TAA_STATE_BEFORE, corner + ivec2(i & 1, i >> 1)).b);
    float here_m = depth_before_m(pixel, nearest_depth_m(source, 2));
    precise float limit_m = (1.0 - SEPARATION) * here_m;
    return farthest_before_m < limit_m;
}

// --- locks ---------------------------------------------------------------------------------------

const float ALIKE_RATIO = 1.05;  // largest ratio of two lumas that count as alike
const float LUMA_SLACK = 0.05;   // tolerance of a lock's luma around the range of the frame
const float NEAR_SQUARED = 0.5;  // largest squared distance of a sample that makes a lock [px^2]

float compute_luma(Neighbourhood around, int i)
{
    vec3 colour = around.colours[i];
    precise float sum = colour.r + 2.0 * colour.g + colour.b;
    return sum;
}

// A ridge of lumas: no corner has three neighbours like the centre, and all neighbours that are
// unlike it are brighter, or all are darker.
bool is_thin(Neighbourhood around)
{
    // Samples 0, 1, 3; 1, 2, 5; 3, 6, 7; 5, 7, 8: the neighbours at each corner.
    const uint corners[4] = {0x00bu, 0x026u, 0x0c8u, 0x1a0u};
    float centre = compute_luma(around, CENTRE), low = 3e38, high = -3e38;
    uint alike = 0u;
    for (int i = 0; i < 9; i++) {
        float other = compute_luma(around, i);
        precise float most = ALIKE_RATIO * min(centre, other);
        if (max(centre, other) <= most) {
            alike |= 1u << i;
        } else {
            low = min(low, other);
            high = max(high, other);
        }
    }
    for (int k = 0; k < 4; k++)
        if ((alike & corners[k]) == corners[k])
            return false;
    return around.valid == SQUARE && (centre > high || centre < low);
}

// Whether the luma of a lock is within the range of the frame's lumas.
bool is_trusted(Neighbourhood around, float luma)
{
    float low = 3e38, high = -3e38;
    for (int i = 0; i < 9; i++)
        if (has_bit(around.valid, i)) {
            low = min(low, compute_luma(around, i));
            high = max(high, compute_luma(around, i));
        }
    precise float least = (1.0 - LUMA_SLACK) * low, most = (1.0 + LUMA_SLACK) * high;
    return luma >= least && luma <= most;
}

// X: the remaining strength of a lock, Y: its luma.
vec2 update_lock(bool has_history, vec2 before_px, Neighbourhood around)
{
    vec2 lock = vec2(0.0);
    if (has_history)
        lock = fetch_output(RT_TAA_STATE_BEFORE, ivec2(floor(before_px))).rg;
    precise float left = lock.x - 1.0 / setting(RT_TAA_JITTER_LENGTH);
    lock.x = left > 0.0 && left <= 1.0 && is_trusted(around, lock.y) ? left : 0.0;
    precise vec2 way = shift_px / rendered_per_px;
    precise float squared = way.x * way.x + way.y * way.y;
    bool is_new = squared <= NEAR_SQUARED && is_thin(around);
    return is_new ? vec2(1.0, compute_luma(around, CENTRE)) : lock;
}

// --- the pixel -----------------------------------------------------------------------------------

// The accumulated weight of the history, limited by the pixel's speed and the reactive mask.
float history_weight(vec2 before_px, ivec2 source, float quickness)
{
    float weight = fetch_output(RT_TAA_BEFORE, ivec2(floor(before_px))).a;
    float most = setting(RT_TAA_AGE_MAX) * (1.0 - 0.75 * quickness);
    if (choice(RT_TAA_RESPONSIVE) == RT_RESPONSIVE_MEDIUM)
        most *= 1.0 - clamp(1.0 - fetch_full(RT_VOLUME, source).a, 0.0, 0.9);
    return weight > 0.0 ? min(weight, most) : 0.0;
}

void main()
{
    ivec2 pixel;
    if (!find_element(get_output_size(), pixel))
        return;
    ivec2 source = find_source(pixel);
    find_change(source_tile(source));
    find_filter_weights_and_coverage();
    Neighbourhood around = fetch_neighbourhood(source);

    vec2 before_px;
    float speed_px, weight = 0.0, frame_weight = coverage;
    vec4 found;
    vec3 colour;
    bool has_history = !is_reset() && find_before(pixel, source, before_px, speed_px) &&
                       !is_disoccluded(pixel, source, before_px) && fetch_history(before_px, found);
    vec3 history = found.rgb;
    vec2 lock = update_lock(has_history, before_px, around);
    if (!upsample(around, colour)) {
        colour = has_history ? history : vec3(0.0);
        frame_weight = 0.0;
    } else if (has_history) {
        float quickness = min(speed_px / FAST_PX, 1.0);
        float sigma = (3.0 - 2.0 * quickness) * setting(RT_TAA_SIGMA);
        weight = history_weight(before_px, source, quickness);
        vec3 clamped = clamp_history(history, find_box(around, colour, sigma));
        colour = blend(colour, mix(clamped, history, lock.x),
                       frame_weight / (weight + frame_weight));
    }
    float sum = min(weight + frame_weight, setting(RT_TAA_AGE_MAX));
    put_pixel(pixel, vec4(limit_colour(colour), sum));
    put_output(RT_TAA_STATE, pixel, vec4(lock, nearest_depth_m(source, 1), 0.0));
}
