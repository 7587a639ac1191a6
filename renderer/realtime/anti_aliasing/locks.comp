#version 450
// SPDX-License-Identifier: MIT
//
// A rival: temporal upsampling after the description that comes with AMD's FidelityFX Super
// Resolution 2 (MIT, version 2.2), with its parts in one pass. The frame is filtered by a Lanczos
// kernel about the pixel's centre; the history counts by how much of the frames before has gone
// into it; it does not where what was seen there stood before what is there now (disocclusion);
// and it is held in a box, but where a thin feature is locked: so wires that no frame has as a
// whole come together.
//
// Like the original: dilated depths and their motion (3x3, taa_motion=square), the mask of
// disocclusion by depth, locks by ridges of 3x3 lumas that last as long as the jitter and end with
// the luma, accumulation by weights, less of it where a mask says reactive.
// Not like it:
// - The kernel is EASU's polynomial of 4x4 texels, along x and along y, of light as it is and not
//   tone-mapped, held between the nearest 2x2; the history has taa_history. A frame's weight is
//   the sum of taau.comp's Gaussian.
// - Depths of the frame before are those that the picture's pixels had, looked up, where the
//   original scatters depths forwards; nothing is uncovered that was nearer than
//   1 - SEPARATION of all depths of 5x5 now, whatever the jitter has moved.
// - A lock ends when its luma leaves the range of the 3x3 of the frame by 5 %; the original has a
//   pyramid of lumas, and four frames of luma to tell flicker, which is left out.
// - The box reaches three times as far at rest as at VELOCITY_PX, and the history counts by a
//   quarter there: numbers of ours.
// - The reactive mask is the medium's opacity (taa_responsive), at most 0.9. No exposure of its
//   own, no sharpening (sharpen=on).
#extension GL_GOOGLE_include_directive : require

#include "taa.glsl"

// --- the frame ----------------------------------------------------------------------------------

vec2 place_px; // of the pixel's centre among the rays of the frame, in rendered pixels

ivec2 find_source(ivec2 pixel)
{
    precise vec2 way_px = (vec2(pixel) + 0.5) * rendered_per_px - jitter_px;
    precise vec2 nearest = floor(way_px);
    precise vec2 shift = nearest + 0.5 - way_px;
    place_px = way_px;
    shift_px = shift;
    return ivec2(nearest);
}

// 1 at 0; 0 at 1, at 2 and beyond.
float lanczos(float x)
{
    float squared = min(x * x, 4.0);
    float hump = 0.4 * squared - 1.0, window = 0.25 * squared - 1.0;
    return (1.5625 * hump * hump - 0.5625) * window * window;
}

void find_weights()
{
    coverage = 0.0;
    for (int i = 0; i < 9; i++) {
        vec2 way = (vec2(offset_of(i)) + shift_px) / rendered_per_px;
        nearness[i] = exp(-SHARPNESS * dot(way, way));
        coverage += nearness[i];
    }
    coverage = min(coverage, 1.0);
}

// False when no colour counts. Where some of 4x4 do not, those of 3x3 that do are filtered by the
// Gaussian, whose weights are all above 0.
bool upsample(Surroundings around, out vec3 colour)
{
    precise vec2 corner = floor(place_px - 0.5);
    vec2 way = place_px - 0.5 - corner;
    vec3 sum = vec3(0.0), low = vec3(3e38), high = vec3(-3e38);
    float weights = 0.0;
    bool is_whole = true;
    for (int i = 0; i < 16; i++) {
        ivec2 at = ivec2(i & 3, i >> 2) - 1;
        Sample seen = sample_of(composed(ivec2(corner) + at));
        float weight = lanczos(float(at.x) - way.x) * lanczos(float(at.y) - way.y);
        is_whole = is_whole && seen.is_counted;
        sum += weight * seen.colour;
        weights += weight;
        if ((at.x == 0 || at.x == 1) && (at.y == 0 || at.y == 1)) {
            low = mix(low, seen.colour, lessThan(seen.colour, low));
            high = mix(high, seen.colour, greaterThan(seen.colour, high));
        }
    }
    bool is_any = filter_frame(around, colour);
    if (is_whole)
        colour = hold(sum / weights, low, high);
    return is_whole || is_any;
}

// --- disocclusion -------------------------------------------------------------------------------

float nearest_depth_m(ivec2 source, int reach)
{
    float nearest_m = FAR_M;
    for (int y = -reach; y <= reach; y++)
        for (int x = -reach; x <= reach; x++) {
            float depth_m = fetch_full(RT_DEPTH, source + ivec2(x, y)).x;
            if (depth_m < nearest_m)
                nearest_m = depth_m;
        }
    return nearest_m;
}

// How deep what stands still at this depth was for the camera before.
float depth_then_m(ivec2 pixel, float depth_m)
{
    vec3 ray = ray_through(vec2(pixel) + 0.5);
    float slant = view_now.is_parallel != 0u ? 1.0 : dot_in_order(ray, view_before.forward);
    precise float then_m = depth_m * slant -
                           dot_in_order(view_before.position_m, view_before.forward);
    return then_m;
}

// Part of the depth by which what was seen at a place must have been nearer for its history to be
// void.
const float SEPARATION = 0.02;

// All four texels around a place in the frame before were of something nearer than what is here.
bool is_uncovered(ivec2 pixel, ivec2 source, vec2 before_px)
{
    ivec2 corner = ivec2(floor(before_px - 0.5));
    float then_m = -FAR_M;
    for (int i = 0; i < 4; i++)
        then_m = max(then_m, fetch_picture(RT_TAA_STATE_BEFORE, corner + ivec2(i & 1, i >> 1)).b);
    float here_m = depth_then_m(pixel, nearest_depth_m(source, 2));
    precise float limit_m = (1.0 - SEPARATION) * here_m;
    return then_m < limit_m;
}

// --- locks --------------------------------------------------------------------------------------

float luma_of(Surroundings around, int i)
{
    precise float sum = around.colours[i].r + 2.0 * around.colours[i].g + around.colours[i].b;
    return sum;
}

const float ALIKE_RATIO = 1.05; // of lumas up to which neighbours are alike

// A ridge of lumas: no three neighbours at a corner are like the middle, and all that are unlike
// are brighter, or all darker.
bool is_thin(Surroundings around)
{
    const uint corners[4] = {0x00bu, 0x026u, 0x0c8u, 0x1a0u};
    float own = luma_of(around, CENTRE), low = 3e38, high = -3e38;
    uint alike = 0u;
    for (int i = 0; i < 9; i++) {
        float other = luma_of(around, i);
        precise float most = ALIKE_RATIO * min(own, other);
        if (max(own, other) <= most) {
            alike |= 1u << i;
        } else {
            low = min(low, other);
            high = max(high, other);
        }
    }
    for (int k = 0; k < 4; k++)
        if ((alike & corners[k]) == corners[k])
            return false;
    return around.counted == SQUARE && (own > high || own < low);
}

// Whether the luma of a lock is still about.
bool is_trusted(Surroundings around, float luma)
{
    float low = 3e38, high = -3e38;
    for (int i = 0; i < 9; i++)
        if (is_counted(around.counted, i)) {
            low = min(low, luma_of(around, i));
            high = max(high, luma_of(around, i));
        }
    precise float least = 0.95 * low, most = 1.05 * high;
    return luma >= least && luma <= most;
}

// What is left of a lock, and its luma.
vec2 lock_of(bool has_history, vec2 before_px, Surroundings around)
{
    vec2 lock = vec2(0.0);
    if (has_history)
        lock = fetch_picture(RT_TAA_STATE_BEFORE, ivec2(floor(before_px))).rg;
    precise float left = lock.x - 1.0 / setting(RT_TAA_JITTER_LENGTH);
    lock.x = left > 0.0 && left <= 1.0 && is_trusted(around, lock.y) ? left : 0.0;
    precise vec2 way = shift_px / rendered_per_px;
    precise float squared = way.x * way.x + way.y * way.y;
    return squared <= 0.5 && is_thin(around) ? vec2(1.0, luma_of(around, CENTRE)) : lock;
}

// --- the pixel ----------------------------------------------------------------------------------

// How much of frames is in the history, at most so much as it may have.
float weight_before(vec2 before_px, ivec2 source, float quickness)
{
    float weight = fetch_picture(RT_TAA_BEFORE, ivec2(floor(before_px))).a;
    float most = setting(RT_TAA_AGE_MAX) * (1.0 - 0.75 * quickness);
    if (choice(RT_TAA_RESPONSIVE) == RT_RESPONSIVE_MEDIUM)
        most *= 1.0 - clamp(1.0 - fetch_full(RT_VOLUME, source).a, 0.0, 0.9);
    return weight > 0.0 ? min(weight, most) : 0.0;
}

void main()
{
    ivec2 pixel;
    if (!own_element(picture_size(), pixel))
        return;
    ivec2 source = find_source(pixel);
    find_weights();
    if (asks_for_change())
        find_change(clamp(source, ivec2(0), view_size() - 1) / 4);
    is_at_rest = rests();
    Surroundings around = look_around(source);

    bool is_reset = !has_past || (is_cut && choice(RT_CUT_RESET) != 0);
    vec2 before_px;
    float speed_px;
    vec4 found; // RGB, age
    vec3 colour;
    bool has_history = !is_reset && find_before(pixel, source, before_px, speed_px) &&
                       !is_uncovered(pixel, source, before_px) && fetch_history(before_px, found);
    vec3 history = found.rgb;
    vec2 lock = lock_of(has_history, before_px, around);
    float weight = 0.0, seen = coverage;
    if (!upsample(around, colour)) {
        colour = has_history ? history : vec3(0.0);
        seen = 0.0;
    } else if (has_history) {
        float quickness = min(speed_px / VELOCITY_PX, 1.0);
        box_scale = 3.0 - 2.0 * quickness;
        weight = weight_before(before_px, source, quickness);
        vec3 held = mix(hold_history(history, box_of(around, colour)), history, lock.x);
        colour = blend(colour, held, seen / (weight + seen));
    }
    colour = guard(hold(colour, vec3(-HALF_MAX), vec3(HALF_MAX)));
    float sum = min(weight + seen, setting(RT_TAA_AGE_MAX));
    put_picture(RT_TAA_OUT, pixel, vec4(round_to_format(colour, pixel), sum));
    put_picture(RT_TAA_STATE, pixel, vec4(lock, nearest_depth_m(source, 1), 0.0));
}
