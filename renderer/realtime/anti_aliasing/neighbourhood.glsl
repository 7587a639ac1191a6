// SPDX-License-Identifier: MIT
//
// The frame's input to the anti-aliasing: nine samples around a pixel, their filtered colour, and
// the box that history is clamped to.
//
//     +-------+-------+-------+
//     |    s  |    s  |    s  |     x  the centre of the pixel
//     |       |       |       |     s  this frame's rays: the jitter shifts all of them by the same
//     +-------+-------+-------+        offset from the centres of their pixels
//     |    s  |   xs  |    s  |     d  the distance from x to an s; its weight in the filtered
//     |       |       |       |        colour is exp(-2.29 d^2)
//     +-------+-------+-------+
//     |    s  |    s  |    s  |     Samples have the numbers 0 .. 8, row by row; 1, 3, 4, 5 and 7
//     |       |       |       |     are the plus.
//     +-------+-------+-------+
#ifndef NEPH_REALTIME_NEIGHBOURHOOD_GLSL
#define NEPH_REALTIME_NEIGHBOURHOOD_GLSL

#include "renderer/realtime/shared/clamp.glsl"
#include "renderer/realtime/shared/color_space.glsl"
#include "renderer/realtime/shared/pass.glsl"

const int CENTRE = 4;
const uint SQUARE = 0x1ffu, PLUS = 0x0bau; // bits of the samples

// --- numbers that may be bad ---------------------------------------------------------------------

bool is_guarded() { return choice(RT_TAA_GUARD) != 0; }

// Clamps to the range of the target's format; with the guard also to radiance >= 0.
vec3 limit_colour(vec3 colour)
{
    vec3 least = vec3(is_guarded() ? 0.0 : -HALF_MAX);
    return clamp_between(colour, least, vec3(HALF_MAX));
}

vec3 guard(vec3 colour) { return is_guarded() ? limit_colour(colour) : colour; }

bool is_valid_colour(vec3 colour)
{
    return !is_guarded() || (is_finite(colour.r) && is_finite(colour.g) && is_finite(colour.b));
}

// --- samples -------------------------------------------------------------------------------------

struct Sample {
    vec3 colour; // exposed
    float hdr_weight;
    bool is_valid; // invalid samples have no weight
};

// Karis 2014: bright samples have less weight; a single one would remain visible for many frames.
float hdr_weight(vec3 colour)
{
    return choice(RT_TAA_HDR_WEIGHT) != 0 ? 1.0 / (luma_4(colour) + 4.0) : 1.0;
}

// Composes the volume with the background where no earlier pass does (composition/compose.comp).
vec3 fetch_colour(ivec2 pixel)
{
    if (choice(RT_COMPOSITION) != RT_COMPOSITION_TAA)
        return exposure * fetch_full(RT_COLOR, pixel).rgb;
    return exposure * over(fetch_full(RT_VOLUME, pixel), fetch_full(RT_BEHIND, pixel).rgb);
}

Sample sample_from(vec3 colour)
{
    bool is_valid = is_valid_colour(colour);
    colour = guard(colour);
    return Sample(colour, hdr_weight(colour), is_valid);
}

struct Neighbourhood {
    vec3 colours[9]; // 0 where invalid, like the weights
    float hdr_weights[9];
    uint valid; // bit i: sample i
};

ivec2 get_neighbour_offset(int i) { return ivec2(i % 3, i / 3) - 1; }

bool has_bit(uint bits, int i) { return (bits >> i & 1u) != 0u; }

void set_sample(inout Neighbourhood around, int i, Sample from)
{
    if (from.is_valid)
        around.valid |= 1u << i;
    around.colours[i] = from.is_valid ? from.colour : vec3(0.0);
    around.hdr_weights[i] = from.is_valid ? from.hdr_weight : 0.0;
}

Neighbourhood fetch_neighbourhood(ivec2 pixel)
{
    Neighbourhood around;
    around.valid = 0u;
    for (int i = 0; i < 9; i++)
        set_sample(around, i, sample_from(fetch_colour(pixel + get_neighbour_offset(i))));
    return around;
}

// --- the filter ----------------------------------------------------------------------------------

// Unreal's Gaussian of 0.47 px, a fit to the Blackman-Harris window of 3.3 px. (Its
// r.TemporalAACatmullRom, off by default, selects another filter here and not for the history.)
const float SHARPNESS = 2.29;

// From the pixel's centre to the central sample, in rendered pixels.
vec2 shift_px = jitter_px;

float filter_weights[9];
float coverage = 1.0; // of the pixel by samples: sum of the weights, with upsampling

// From the pixel's centre to a sample, squared, in rendered pixels.
float distance_squared(int i)
{
    precise float x = float(get_neighbour_offset(i).x) + shift_px.x;
    precise float y = float(get_neighbour_offset(i).y) + shift_px.y;
    precise float sum = x * x + y * y;
    return sum;
}

void find_filter_weights()
{
    for (int i = 0; i < 9; i++)
        filter_weights[i] = exp(-SHARPNESS * distance_squared(i));
}

// False when no sample is valid; without the filter, when the central one is not.
bool filter_samples(Neighbourhood around, out vec3 colour)
{
    colour = around.colours[CENTRE];
    if (choice(RT_TAA_FILTER) == 0)
        return has_bit(around.valid, CENTRE);
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (int i = 0; i < 9; i++) {
        float weight = filter_weights[i] * around.hdr_weights[i];
        sum += weight * around.colours[i];
        weights += weight;
    }
    colour = sum / weights;
    return around.valid != 0u;
}

// --- the clamp box -------------------------------------------------------------------------------

float box_distance_squared = 2.2801; // of RT_BOX_DISTANCE: 1.51 px

// The space of the box and of the clamp. Unreal's Reinhard compresses each channel; the
// reconstruction's, RT_SPACE_REINHARD, compresses the luminance.
int clamp_space()
{
    return choice(RT_TAA_SPACE) == RT_SPACE_REINHARD ? RT_SPACE_CHANNELS : choice(RT_TAA_SPACE);
}

Box extremes(Neighbourhood around, uint among)
{
    Box box = EMPTY_BOX;
    for (int i = 0; i < 9; i++)
        if (has_bit(around.valid & among, i))
            extend(box, vec4(around.colours[i], 0.0));
    return box;
}

// The mean of the extremes of the plus and of the square: less wide at the corners than the square.
Box rounded_box(Neighbourhood around)
{
    Box square = extremes(around, SQUARE), plus = extremes(around, PLUS);
    if ((around.valid & PLUS) == 0u)
        return square;
    return Box(0.5 * (square.low + plus.low), 0.5 * (square.high + plus.high));
}

// Variance as the mean of squared deviations. (Unreal subtracts the squared mean from the mean of
// squares, which cancels: in float32 a flat colour then has a deviation of up to 3e-4 of itself.)
Box sample_variance_box(Neighbourhood around, float sigma)
{
    vec3 mean = vec3(0.0), variance = vec3(0.0);
    float count = float(bitCount(around.valid));
    for (int i = 0; i < 9; i++)
        if (has_bit(around.valid, i))
            mean += around.colours[i] / count;
    for (int i = 0; i < 9; i++)
        if (has_bit(around.valid, i))
            variance += (around.colours[i] - mean) * (around.colours[i] - mean) / count;
    return variance_box(vec4(mean, 0.0), vec4(variance, 0.0), sigma);
}

Box near_box(Neighbourhood around)
{
    uint near = 0u;
    for (int i = 0; i < 9; i++)
        if (distance_squared(i) < box_distance_squared)
            near |= 1u << i;
    return extremes(around, near);
}

// In clamp_space(). The variance box may miss the filtered colour and is extended to it. Boxes of
// shared/clamp.glsl have four channels; the last one is unused here.
Box find_box(Neighbourhood around, vec3 filtered, float sigma)
{
    for (int i = 0; i < 9; i++)
        around.colours[i] = to_space(clamp_space(), around.colours[i]);
    if (choice(RT_TAA_BOX) == RT_BOX_MIN_MAX)
        return rounded_box(around);
    if (choice(RT_TAA_BOX) == RT_BOX_DISTANCE)
        return near_box(around);
    Box box = sample_variance_box(around, sigma);
    extend(box, vec4(to_space(clamp_space(), filtered), 0.0));
    return box;
}

// A history inside the box is returned bit by bit.
vec3 clamp_history(vec3 history, Box box)
{
    if (choice(RT_TAA_BOX) == RT_BOX_NONE)
        return history;
    vec3 value = to_space(clamp_space(), history);
    vec3 clamped = clamp_to(box, vec4(value, 0.0)).rgb;
    return clamped == value ? history : from_space(clamp_space(), clamped, 0.0);
}

// --- the frame -----------------------------------------------------------------------------------

struct Frame {
    vec3 colour; // filtered
    bool is_valid;
    Box box;
    vec3 centre; // the central sample
    bool is_centre_valid;
};

Frame frame_from(Neighbourhood around, bool needs_box)
{
    Frame frame;
    frame.is_valid = filter_samples(around, frame.colour);
    frame.centre = around.colours[CENTRE];
    frame.is_centre_valid = has_bit(around.valid, CENTRE);
    if (needs_box)
        frame.box = find_box(around, frame.colour, setting(RT_TAA_SIGMA));
    return frame;
}

#endif
