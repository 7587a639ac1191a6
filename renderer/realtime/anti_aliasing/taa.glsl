// SPDX-License-Identifier: MIT
//
// A pixel of temporal anti-aliasing and upsampling, once its frame (neighbourhood.glsl) is known:
// motion, history, clamp, blend, output. taa.comp has the overview, and the differences from Unreal
// Engine.
#ifndef NEPH_REALTIME_TAA_GLSL
#define NEPH_REALTIME_TAA_GLSL

#include "motion.glsl"
#include "neighbourhood.glsl"

// --- the history ---------------------------------------------------------------------------------

bool is_reset() { return !has_past || (is_cut && choice(RT_CUT_RESET) != 0); }

// The number of frames in the mean of the history; 0 where it is not stored.
float limit_age(float age)
{
    if (!keeps_age())
        return 0.0;
    return age >= 1.0 ? min(age, setting(RT_TAA_AGE_MAX)) : 1.0;
}

// Where the point that a pixel shows now was in the frame before.
struct Past {
    vec2 place_px;
    float speed_px; // per frame
    bool is_there;
};

Past find_past(ivec2 pixel, ivec2 source)
{
    Past past;
    past.is_there = !is_reset() && find_before(pixel, source, past.place_px, past.speed_px);
    return past;
}

// RGB: the colour, A: the age. False when the guard finds the colour invalid.
bool fetch_history(vec2 place_px, out vec4 history)
{
    history = filter_history(place_px);
    history.a = limit_age(history.a);
    if (choice(RT_TAA_PRE_EXPOSURE) != 0)
        history.rgb *= exposure / exposure_before;
    bool is_valid = is_valid_colour(history.rgb);
    history.rgb = guard(history.rgb);
    return is_valid;
}

// Motion per frame up to which a pixel is static; from twice this on it moves.
const float STATIC_PX = 0.02;

// The history gain (setting relight, gradient/settings.toml): a static pixel's history is
// multiplied by the ratio of this frame's light to the light of the frame before. The medium and
// the scene behind it have gains of their own; they are weighted by their shares in the pixel.
vec3 relight(vec3 history, ivec2 source, Frame frame, float speed_px)
{
    if (beyond(speed_px, STATIC_PX) == 1.0) // it moves
        return history;
    bool is_same = medium_change.gain == vec3(1.0) && behind_change.gain == vec3(1.0);
    if (!uses_gradient() || !is_set(RT_RELIGHT) || !frame.is_centre_valid || is_same)
        return history;
    vec3 colour = frame.centre;
    vec3 medium = exposure * fetch_full(RT_VOLUME, source).rgb;
    medium = clamp_between(medium, vec3(0.0), colour);
    vec3 before = medium / medium_change.gain + (colour - medium) / behind_change.gain;
    vec3 gain = mix(vec3(1.0), colour / before, greaterThan(before, vec3(0.0)));
    return mix(gain, vec3(1.0), beyond(speed_px, STATIC_PX)) * history;
}

// --- share of the clamp --------------------------------------------------------------------------

// 0: the pixel is static and in the same light, so that its history is the mean of its frames; 1:
// the pixel moves or its light changes.
float find_change_share(float speed_px)
{
    if (!uses_gradient())
        return 1.0;
    return max(beyond(speed_px, STATIC_PX), light_change());
}

// No clamp where the share is known to be 0 when the kernel is compiled: a static view without
// changes for many frames (is_unchanged()). Without the guard the clamp stays, because it may turn
// a NaN into a number.
bool is_unclamped = is_static && uses_gradient() && is_unchanged() && is_guarded() &&
                    (is_set(RT_TAA_CHANGE) || is_set(RT_TAA_CHANGE_FULL));

// --- the blend -----------------------------------------------------------------------------------

const float ALPHA_MOVING = 0.2; // weight of the frame at FAST_PX and above
const float FAST_PX = 20.0;     // per frame; Unreal counts halves of pixels: its 40

// Weight of the frame: it grows with the pixel's speed, and by Unreal's contrast law it is large
// enough for a step of taa_contrast times the history's luma (before the clamp). A smaller
// difference is applied in full, so that a history in half floats does not stall before the frame
// (check_film.c).
float frame_weight(float luma, float history_luma, float speed_px)
{
    float way = speed_px / FAST_PX;
    float alpha = mix(coverage * setting(RT_TAA_ALPHA), ALPHA_MOVING, way < 1.0 ? way : 1.0);
    if (setting(RT_TAA_CONTRAST) == 0.0 || (is_guarded() && !(history_luma > 0.0)))
        return alpha;
    precise float least = setting(RT_TAA_CONTRAST) * history_luma / abs(luma - history_luma);
    if (least <= alpha)
        return alpha;
    return least > 1.0 ? 1.0 : least; // without the guard NaN, for black over black
}

// The number of frames within which the light changes by taa_change: a mean of more frames would
// lag. The residue is a change in four frames for media, and in one period of the jitter for the
// scene behind them.
float frames_alike()
{
    float limit = setting(RT_TAA_CHANGE);
    return min(4.0 * compute_change_time(medium_change.residue, limit),
               setting(RT_TAA_JITTER_LENGTH) * compute_change_time(behind_change.residue, limit));
}

// The age of the mean while the pixel moves or its light changes fully: at most taa_age_least
// frames. After an age of 1 the next static frame weighs 1/2, and edges blink. Where another scene
// has come into view, or all light has changed (a residue of 1), a mean starts anew.
float limit_changed_age(float age)
{
    bool is_other = uses_gradient() && largest_residue() >= 1.0;
    return is_set(RT_TAA_AGE_LEAST) && !is_other ? min(age, setting(RT_TAA_AGE_LEAST)) : 1.0;
}

// A new mean begins with frames of a half resolution that has not converged: of these a changed
// one counts a quarter, so that the static frames after them weigh more.
const float NEW_BELOW = 2.0, COUNT_IN_NEW = 0.25;

// The age after a frame in which the pixel moves or its light changes fully.
float age_after_change(float age)
{
    return limit_changed_age(age + (age < NEW_BELOW ? COUNT_IN_NEW : 1.0));
}

// A static pixel is the mean of its frames since its last change: one more frame weighs
// 1 / (age + 1).
float weight_with_age(float alpha, float change_share, inout float age)
{
    if (!keeps_age())
        return alpha;
    if (choice(RT_GRADIENT) != 0)
        age = max(min(age, frames_alike()), limit_changed_age(age));
    alpha = mix(1.0 / (age + 1.0), alpha, change_share);
    age = min(mix(age + 1.0, age_after_change(age), change_share), setting(RT_TAA_AGE_MAX));
    return alpha;
}

const float RESPONSIVE_ALPHA = 0.25, RESPONSIVE_BELOW = 0.5; // transmittance

// A medium that hides most of the background has no motion vectors: the frame gets more weight.
bool is_responsive(ivec2 source)
{
    return choice(RT_TAA_RESPONSIVE) == RT_RESPONSIVE_MEDIUM &&
           fetch_full(RT_VOLUME, source).a < RESPONSIVE_BELOW;
}

// With weights w = hdr_weight() of the two colours
//
//     weight = alpha w_frame / (alpha w_frame + (1 - alpha) w_history)
//     result = history + weight (frame - history)
//
// A weight of 1 returns the frame bit by bit.
vec3 blend(vec3 frame, vec3 history, float alpha)
{
    float frame_part = alpha * hdr_weight(frame);
    float history_part = (1.0 - alpha) * hdr_weight(history);
    float weight = frame_part / (frame_part + history_part);
    return weight == 1.0 ? frame : history + weight * (frame - history);
}

// RGB: the colour of a pixel, A: its age. `source`: the rendered pixel at the pixel's centre, which
// is the pixel itself except with upsampling. Without samples: the history. Without history: the
// frame.
vec4 resolve(ivec2 pixel, ivec2 source, Past past, Frame frame)
{
    vec4 found;
    bool has_history = past.is_there && fetch_history(past.place_px, found);
    float speed_px = past.speed_px;
    vec3 colour = frame.colour, history = found.rgb;
    float age = has_history ? found.a : keeps_age() ? 1.0 : 0.0;
    if (!frame.is_valid) {
        colour = has_history ? history : vec3(0.0);
    } else if (has_history) {
        history = relight(history, source, frame, speed_px);
        float alpha = 0.0, change_share = 0.0;
        vec3 clamped = history;
        if (!is_unclamped) {
            alpha = frame_weight(luma_4(colour), luma_4(history), speed_px);
            change_share = find_change_share(speed_px);
            clamped = clamp_history(history, frame.box);
        }
        alpha = weight_with_age(alpha, change_share, age);
        if (is_responsive(source))
            alpha = max(alpha, RESPONSIVE_ALPHA);
        history = change_share == 1.0 ? clamped : mix(history, clamped, change_share);
        colour = blend(colour, history, alpha);
    }
    return vec4(limit_colour(colour), age);
}

// --- the output ----------------------------------------------------------------------------------

vec3 round_to_format(vec3 colour, ivec2 pixel)
{
    if (choice(RT_TARGET_FORMAT) != RT_FORMAT_HALF ||
        choice(RT_TAA_ROUNDING) != RT_ROUNDING_STOCHASTIC)
        return colour;
    // The hash's first number is the white dither's (renderer/dither.h).
    uvec3 bits = pcg4d(uvec4(pixel, view_frame, view_seed)).yzw;
    return vec3(round_by_chance(colour.r, bits.x), round_by_chance(colour.g, bits.y),
                round_by_chance(colour.b, bits.z));
}

void put_pixel(ivec2 pixel, vec4 resolved)
{
    put_output(RT_TAA_OUT, pixel, vec4(round_to_format(resolved.rgb, pixel), resolved.a));
}

#endif
