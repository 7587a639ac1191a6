// SPDX-License-Identifier: MIT
//
// Reprojection: the place in the frame before of the medium that a half-resolution texel shows, and
// the history at that place. Where the scene behind has changed (disocclusion) history is invalid.
//
//     t0 - - - - t1     p   the point of the medium on the texel's ray
//     :     b     :     b   its place in the frame before, from p minus the wind:
//     :           :             b = texel + P_before(p - wind) - P_now(p) - jitter
//     :           :         with the projections P of the two cameras
//     t2 - - - - t3     t   the four texels with centres around b; for b at (x, y) from t0,
//                           0 .. 1, history is their bilinear mean,
//                               sum w_i t_i / sum w_i   over the valid taps,
//                               w = (1 - x) (1 - y), x (1 - y), (1 - x) y, x y
#ifndef NEPH_REALTIME_HISTORY_GLSL
#define NEPH_REALTIME_HISTORY_GLSL

#include "box.glsl"
#include "renderer/realtime/tile_index/slots.glsl"

struct History {
    vec4 value;
    float age; // in rays
    bool is_invalid;
    bool is_rejected; // invalid because the scene behind it has changed
    float motion_px; // since the frame before
};

const History NO_HISTORY = History(vec4(0.0), 0.0, true, false, 0.0);
const History REJECTED = History(vec4(0.0), 0.0, true, true, 0.0);

bool checks_validity() { return choice(RT_VALIDITY) != 0; }

// With a static camera and static air history is in the texel's own place, and reprojection is
// skipped. This is a constant of the kernel; kernels without it always reproject.
bool is_static()
{
    bool has_jitter = choice(RT_REPROJECT_JITTER) != 0 && choice(RT_JITTERED_DEPTH) != 0;
    return IS_VIEW_STATIC && !has_jitter;
}

// --- value of the history ------------------------------------------------------------------------

// Whether a depth of the frame before is about the expected one.
bool is_same_depth(float expected_m, float before_m, float tolerance)
{
    return !(abs(expected_m - before_m) >= tolerance * expected_m);
}

// With an oracle taps that ended at another depth are invalid; else every depth is accepted.
const float ANY_DEPTH = 0.0;
const float ORACLE_TOLERANCE = 0.1; // as reject_depth of `ours`

bool ended_elsewhere(ivec2 half_pixel, float expected_m)
{
    if (expected_m == ANY_DEPTH)
        return false;
    float before_m = fetch_half(RT_HALF_DEPTH_BEFORE, half_pixel).x;
    return !is_same_depth(expected_m, is_sky(before_m) ? setting(RT_SKY_M) : before_m,
                          ORACLE_TOLERANCE);
}

History fetch_history_texel(ivec2 half_pixel, float expected_m)
{
    vec4 value = fetch_half(RT_HISTORY_BEFORE, half_pixel);
    float age = fetch_half(RT_HISTORY_STATE_BEFORE, half_pixel).x;
    bool has_age = is_finite(age) && age > 0.0;
    bool is_invalid = (checks_validity() && !(has_age && is_sound(value))) ||
                      ended_elsewhere(half_pixel, expected_m);
    return History(value, has_age ? age : 0.0, is_invalid, false, 0.0);
}

struct Mean {
    History history; // its age is the age of the tap with the largest weight
    vec4 sum;
    float weights, heaviest;
    Box range; // of the taps
};

void add(History tap, float weight, inout Mean mean)
{
    if (tap.is_invalid || weight == 0.0)
        return;
    mean.history.is_invalid = false;
    mean.sum += weight * tap.value;
    mean.weights += weight;
    if (weight > mean.heaviest) {
        mean.heaviest = weight;
        mean.history.age = tap.age;
    }
    extend(mean.range, tap.value);
}

// The bilinear mean of the valid taps, with the age of the tap with the largest weight; invalid
// without valid taps. It is clamped to the range of the taps, so equal taps give exactly their
// value. All four taps are fetched before the first is added: after a branch a GPU would wait for
// one tap after the other, and a loop on lavapipe would keep the whole mean in memory.
History interpolate_history(vec2 place_px, float expected_m)
{
    if (is_static())
        return fetch_history_texel(ivec2(floor(0.5 * place_px)), expected_m);
    vec2 place = 0.5 * place_px - 0.5; // in texels from the centre of the first
    ivec2 base = ivec2(floor(place));
    vec2 part = place - vec2(base);
    vec2 weights_x = vec2(1.0 - part.x, part.x), weights_y = vec2(1.0 - part.y, part.y);
    Mean mean = Mean(NO_HISTORY, vec4(0.0), 0.0, 0.0, Box(vec4(FAR_M), vec4(-FAR_M)));
    History taps[4];
    [[unroll]] for (int i = 0; i < 4; i++)
        taps[i] = fetch_history_texel(base + ivec2(i & 1, i >> 1), expected_m);
    [[unroll]] for (int i = 0; i < 4; i++)
        add(taps[i], weights_x[i & 1] * weights_y[i >> 1], mean);
    History history = mean.history;
    if (!history.is_invalid)
        history.value = clamp_to(mean.range, mean.sum / mean.weights);
    return history;
}

// --- place of the history ------------------------------------------------------------------------

// A medium without effect on the ray has an infinite distance.
float known_distance_m(float distance_m)
{
    return is_finite(distance_m) && distance_m > 0.0 ? min(distance_m, FAR_M) : FAR_M;
}

// A frame's rays pass through places shifted by its jitter. The article's reprojection includes the
// jitter, through Unreal's matrices; other settings leave it out.
vec2 ray_jitter_px(vec2 of_frame_px)
{
    bool is_followed = choice(RT_REPROJECT_JITTER) != 0 && choice(RT_JITTERED_DEPTH) != 0;
    return is_followed ? of_frame_px : vec2(0.0);
}

// The place in the frame before of the medium at `distance_m`; false if it was not on the screen.
// The motion is a difference of two projections and is added to the place: with a static camera
// both are rounded in the same way (if no product is fused in only one of them), so history does
// not drift. With parallel rays of a camera that does not turn, the distance has no effect and is
// left out for precision.
bool find_before(vec2 place_px, float distance_m, out vec2 before_px)
{
    before_px = place_px;
    if (is_static())
        return true;
    ViewLine line = view_line_at(view_now, place_px);
    bool is_parallel = view_now.is_parallel != 0u;
    float length_m = is_parallel ? 0.0
                     : choice(RT_REPROJECT_MEASURE) == RT_MEASURE_EYE
                         ? distance_m / dot(line.direction, view_now.forward)
                         : distance_m;
    precise vec3 point_m = line.origin_m + length_m * line.direction;
    precise vec3 moved_m = choice(RT_WIND) != 0 ? point_m - wind_m() : point_m;
    vec3 earlier = project(view_before, moved_m);
    precise vec2 motion_px = earlier.xy - project(view_now, point_m).xy;
    before_px = place_px + motion_px - ray_jitter_px(jitter_before_px);
    return (is_parallel || earlier.z > 0.0) && all(greaterThanEqual(before_px, vec2(0.0))) &&
           all(lessThanEqual(before_px, vec2(view_size())));
}

const float MOVED_PX = 0.125; // from this motion on history comes partly from another texel

// The eye depth that this texel's scene had in the frame before. The sky has a fixed depth, sky_m,
// independent of camera rotation.
float find_expected_depth_m(vec2 place_px, float depth_m)
{
    float expected_m = setting(RT_SKY_M);
    if (is_static() && !is_sky(depth_m)) {
        expected_m = depth_m;
    } else if (!is_sky(depth_m)) {
        ViewLine line = view_line_at(view_now, place_px);
        float length_m = depth_m / dot(line.direction, view_now.forward);
        expected_m = project(view_before, line.origin_m + length_m * line.direction).z;
    }
    return expected_m;
}

// Whether the scene behind the history had the depth that this texel's scene had in the frame
// before. One matching texel of 3x3 is enough (reject_around): in the depth map nearest and
// farthest alternate from one texel to the next, so the texel itself may be of the other kind when
// the image moves by an odd number of texels.
bool is_same_scene(vec2 place_px, vec2 before_px, float depth_m)
{
    float expected_m = find_expected_depth_m(place_px, depth_m);
    if (!(expected_m > 0.0))
        return false;
    ivec2 nearest = ivec2(floor(0.5 * before_px));
    bool is_around = choice(RT_REJECT_AROUND) == RT_AROUND_ON ||
                     (choice(RT_REJECT_AROUND) == RT_AROUND_MOVED &&
                      distance(before_px, place_px) >= MOVED_PX);
    int count = is_around ? 9 : 1;
    for (int i = 0; i < count; i++) {
        int tap = (i + 4) % 9; // the central one first, which nearly always decides
        float before_m = fetch_half(RT_HALF_DEPTH_BEFORE, nearest + ivec2(tap % 3, tap / 3) - 1).x;
        if (is_same_depth(expected_m, is_sky(before_m) ? setting(RT_SKY_M) : before_m,
                          setting(RT_REJECT_DEPTH)))
            return true;
    }
    return false;
}

// --- place and value -----------------------------------------------------------------------------

// The history of a half-resolution texel, given its scene's eye depth and its medium's distance.
// With `is_exact`, of the oracle, history has only taps with the expected depth.
History find_history(ivec2 half_pixel, float depth_m, float distance_m, bool is_exact)
{
    bool is_new = (checks_validity() && !has_past) ||
                  (choice(RT_CUT_RESET) != 0 && is_cut);
    vec2 centre_px = vec2(2 * half_pixel + 1), before_px;
    vec2 place_px = centre_px + ray_jitter_px(jitter_px);
    if (is_new || !find_before(place_px, known_distance_m(distance_m), before_px))
        return NO_HISTORY;
    if (is_set(RT_REJECT_DEPTH) && !is_same_scene(place_px, before_px, depth_m))
        return REJECTED;
    float expected_m = is_exact ? find_expected_depth_m(place_px, depth_m) : ANY_DEPTH;
    History history = interpolate_history(before_px, expected_m);
    history.motion_px = distance(before_px, centre_px);
    return history;
}

#endif
