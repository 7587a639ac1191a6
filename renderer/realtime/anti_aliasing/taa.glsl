// SPDX-License-Identifier: MIT
//
// What temporal anti-aliasing and upsampling have in common: a pixel of the picture and the
// rendered pixels around its source, of which it is made; the same pixel at 100 %. What is
// different from Unreal Engine is said in rt_taa.comp.
#ifndef NEPH_REALTIME_TAA_GLSL
#define NEPH_REALTIME_TAA_GLSL

#include "renderer/shaders/random.glsl"
#include "axes.glsl"
#include "renderer/realtime/gradient/change.glsl"
#include "film.glsl"
#include "renderer/realtime/tile_index/slots.glsl"

// --- motion of the camera -------------------------------------------------------------------

// The place at eye depth 1 of what a pixel's centre sees, without jitter.
vec3 ray_through(vec2 centre_px)
{
    precise float x = (2.0 * centre_px.x / float(picture_px.x) - 1.0) * view_now.half_width;
    precise float y = (1.0 - 2.0 * centre_px.y / float(picture_px.y)) * view_now.half_height;
    precise vec3 ray = view_now.forward + x * view_now.right + y * view_now.up;
    return ray;
}

// Where a camera sees something at `from`, in pixels from the middle of the picture.
vec2 place_from_middle(ViewCamera camera, vec3 from, float depth)
{
    precise vec2 place;
    place.x = 0.5 * float(picture_px.x) *
              (dot_in_order(from, camera.right) /
               (view_spread(camera, depth) * camera.half_width));
    place.y = -0.5 * float(picture_px.y) *
              (dot_in_order(from, camera.up) /
               (view_spread(camera, depth) * camera.half_height));
    return place;
}

bool follows_solids() { return choice(RT_SOLID_MOTION) != 0; }

const ivec2 SQUARE_RING[8] = {ivec2(-1, -1), ivec2(0, -1), ivec2(1, -1), ivec2(-1, 0),
                              ivec2(1, 0),   ivec2(-1, 1), ivec2(0, 1),  ivec2(1, 1)};

// The nearest of the pixel's depth and four or eight around, so that the rim of an object goes
// with it, and how far what is there has moved by itself. As in Unreal the motion is that of the
// pixel's own place at this depth, not of the neighbour's.
float depth_of_motion(ivec2 pixel, out vec3 moved_m)
{
    moved_m = vec3(0.0);
    ivec2 nearest = pixel;
    float nearest_m = fetch_full(RT_DEPTH, pixel).x;
    int others = choice(RT_TAA_MOTION) == RT_MOTION_CROSS    ? 4
                 : choice(RT_TAA_MOTION) == RT_MOTION_SQUARE ? 8
                                                             : 0;
    for (int i = 0; i < others; i++) {
        ivec2 other = pixel + (choice(RT_TAA_MOTION) == RT_MOTION_CROSS
                                   ? 4 * ivec2(i & 1, i >> 1) - 2
                                   : SQUARE_RING[i]);
        float depth_m = fetch_full(RT_DEPTH, other).x;
        if (depth_m < nearest_m) {
            nearest_m = depth_m;
            nearest = other;
        }
    }
    if (follows_solids())
        moved_m = fetch_full(RT_MOVED, nearest).xyz;
    return nearest_m;
}

Change of_medium, of_behind; // around the column of this thread

bool asks_for_change() { return choice(RT_GRADIENT) != 0 && is_set(RT_TAA_AGE_MAX); }

void find_change(ivec2 tile)
{
    of_medium = change_of(RT_CHANGE, tile);
    of_behind = change_of(RT_CHANGE_BEHIND, tile);
}

float change() { return max(of_medium.residue, of_behind.residue); }

// What the wind carries is followed. What stands still has its distance, but that is a mean over
// all that a ray sees, by which a camera that moves finds no better history than by the scene's.
// What does not change does not move, whatever the wind: a veil that looks the same everywhere.
bool follows_medium()
{
    return choice(RT_TAA_MEDIUM) != 0 && !air_rests() &&
           (!asks_for_change() || beyond(change(), setting(RT_TAA_CHANGE)) > 0.0);
}

// Where the medium stood for the camera of the frame before, off from where it is now.
vec3 medium_from_m()
{
    precise vec3 from_m = view_before.position_m + wind_m();
    return from_m;
}

// What it sees stays where it is: motions would come out as 0.
bool rests()
{
    return (ON_GPU || ALL_REST) && !follows_solids() && camera_rests() &&
           (!follows_medium() || medium_from_m() == vec3(0.0));
}

bool is_at_rest; // for all of a column; on lavapipe where that is known before (ALL_REST) alone

// Nothing moves and, by the gradient, nothing changes: what is_held goes by. Without guard the box
// may make something of what is no number.
bool is_steady()
{
    bool is_known = is_unchanged() && is_set(RT_TAA_CHANGE) && guarded();
    bool is_seen = ON_GPU && beyond(change(), setting(RT_TAA_CHANGE)) == 0.0;
    return is_at_rest && asks_for_change() && (is_known || is_seen);
}

bool find_motion_by_axes(vec2 centre_px, float depth_m, vec3 from_m, out vec2 motion_px)
{
    vec2 half_px = 0.5 * vec2(picture_px), from_middle = centre_px / half_px - 1.0;
    vec3 seen = seen_at(from_middle, depth_m, from_m);
    precise vec2 moved_px = half_px * (from_middle - 1.0 / seen.z * seen.xy);
    motion_px = moved_px;
    return seen.z > 0.0;
}

// How far what is `depth_m` deep has come in the picture since the frame before, when it stood
// `from_m` off from where it is now, as seen by the camera; false when it was behind that. Lengths
// are divided by the depth: the sky needs no rule of its own and loses no digits. The motion is a
// difference of two places found alike: it is exactly 0 for a camera at rest. In an orthographic
// picture all depths move alike, since its camera never turns (scenes/load_motion.c).
bool find_motion(vec2 centre_px, vec3 ray, float depth_m, vec3 from_m, out vec2 motion_px)
{
    if (goes_by_axes())
        return find_motion_by_axes(centre_px, depth_m, from_m, motion_px);
    precise vec3 ray_before = ray - from_m / view_spread(view_now, depth_m);
    float depth_before = view_spread(view_before, dot_in_order(ray_before, view_before.forward));
    precise vec2 moved_px =
        place_from_middle(view_now, ray, dot_in_order(ray, view_now.forward)) -
        place_from_middle(view_before, ray_before, depth_before);
    motion_px = moved_px;
    return depth_before > 0.0;
}

const float HARDLY_SEEN = 0.0625; // what moves by itself, behind a medium that lets less through

// A pixel goes with the medium where that hides more than half of what is behind, nearly all of
// what moves by itself, and before the sky, which has nothing that could smear; not at the rim of
// what is before the medium. A mix of both motions is that of neither: it drags solids along in the
// haze before them. False, too, where the medium was behind the camera.
bool goes_with_medium(ivec2 pixel, vec2 centre_px, vec3 ray, float scene_m, bool has_moved,
                      out vec2 motion_px)
{
    float through = fetch_full(RT_VOLUME, pixel).a;
    float distance_m = fetch_full(RT_VOLUME_DISTANCE, pixel).x;
    float most = has_moved ? HARDLY_SEEN : is_sky(scene_m) ? 1.0 : 0.5;
    bool is_seen = through >= 0.0 && through < most && distance_m > 0.0 && distance_m < FAR_M;
    precise float depth_m = distance_m / sqrt(dot_in_order(ray, ray));
    return is_seen && depth_m < scene_m &&
           find_motion(centre_px, ray, depth_m, medium_from_m(), motion_px);
}

// The place in the frame before of what a pixel shows, by the depths about its source; false when
// that was out of the picture.
bool find_before(ivec2 pixel, ivec2 source, out vec2 place_px, out float speed_px)
{
    precise vec2 centre_px = vec2(pixel) + 0.5;
    if (is_at_rest) {
        place_px = centre_px;
        speed_px = 0.0;
        return true;
    }
    vec3 ray = ray_through(centre_px), moved_m = vec3(0.0);
    vec2 motion_px;
    // Else all depths move alike.
    bool has_moved = view_before.position_m != vec3(0.0) || follows_solids();
    float scene_m = has_moved || follows_medium() ? depth_of_motion(source, moved_m) : FAR_M;
    precise vec3 from_m = view_before.position_m + moved_m;
    bool is_mover = moved_m != vec3(0.0);
    bool is_before = (follows_medium() &&
                      goes_with_medium(source, centre_px, ray, scene_m, is_mover, motion_px)) ||
                     find_motion(centre_px, ray, has_moved ? scene_m : FAR_M, from_m, motion_px);
    precise vec2 before_px = centre_px - motion_px;
    place_px = before_px;
    speed_px = length(motion_px);
    return is_before && before_px.x > 0.0 && before_px.x < float(picture_px.x) &&
           before_px.y > 0.0 && before_px.y < float(picture_px.y);
}

// --- history ------------------------------------------------------------------------------------

// Weights of four texels in a row for a place `x` of the way from the second to the third.
vec4 filter_weights(float x)
{
    switch (choice(RT_TAA_HISTORY)) {
    case RT_FILTER_NEAREST:
        return x < 0.5 ? vec4(0.0, 1.0, 0.0, 0.0) : vec4(0.0, 0.0, 1.0, 0.0);
    case RT_FILTER_BILINEAR:
        return vec4(0.0, 1.0 - x, x, 0.0);
    default:
        return vec4(x * (-0.5 + x * (1.0 - 0.5 * x)), 1.0 + x * x * (-2.5 + 1.5 * x),
                    x * (0.5 + x * (2.0 - 1.5 * x)), x * x * (-0.5 + 0.5 * x));
    }
}

// That of a pixel at rest, which a GPU has had on its way since the pixel above (taa.comp).
bool is_ahead = false;
vec4 history_ahead;

vec4 history_at_rest(ivec2 pixel)
{
    if (is_ahead)
        return history_ahead;
    return fetch_picture(RT_TAA_BEFORE, pixel);
}

bool takes_at_once() { return ON_GPU && choice(RT_TAA_HISTORY) != RT_FILTER_NEAREST; }

// Texels side by side, by the number of the first. A: that of the one asked for.
vec4 history_row(int index, vec4 columns, int first, bool is_second)
{
    vec4 texels[4], sum = vec4(0.0);
    [[unroll]] for (int x = first; x <= 3 - first; x++)
        texels[x] = fetch(RT_TAA_BEFORE, ivec2(index + x, 0));
    [[unroll]] for (int x = first; x <= 3 - first; x++)
        sum.rgb += columns[x] * texels[x].rgb;
    sum.a = is_second ? texels[2].a : texels[1].a;
    return sum;
}

// Whether all of a place's 4x4 texels have a weight and are in the picture.
bool has_all(ivec2 corner, vec2 way)
{
    return all(notEqual(way, vec2(0.0))) && all(greaterThan(corner, ivec2(0))) &&
           all(lessThan(corner, picture_size() - 2));
}

// Without a branch, behind which a GPU would wait for one texel after the other. With the age of
// the nearest.
vec4 history_at_once(ivec2 corner, vec2 way)
{
    vec4 columns = filter_weights(way.x), rows = filter_weights(way.y), sum = vec4(0.0);
    ivec2 from = view_origin() + corner - 1;
    int index = from.y * picture_row + from.x;
    int first = choice(RT_TAA_HISTORY) == RT_FILTER_CATMULL_ROM ? 0 : 1;
    [[unroll]] for (int y = first; y <= 3 - first; y++) {
        vec4 row = history_row(index + y * picture_row, columns, first, way.x >= 0.5);
        sum.rgb += rows[y] * row.rgb;
        sum.a = y == (way.y >= 0.5 ? 2 : 1) ? row.a : sum.a;
    }
    return sum;
}

// Those that have a weight.
vec3 history_one_by_one(ivec2 corner, vec2 way)
{
    vec4 columns = filter_weights(way.x), rows = filter_weights(way.y);
    vec3 sum = vec3(0.0);
    for (int y = first_tap(rows); y <= last_tap(rows); y++)
        [[unroll]] for (int x = 0; x < 4; x++) {
            float weight = columns[x] * rows[y];
            vec3 tap = fetch_picture(RT_TAA_BEFORE, corner + ivec2(x, y) - 1).rgb;
            sum = weight != 0.0 ? sum + weight * tap : sum;
        }
    return sum;
}

bool asks_for_age() { return is_set(RT_TAA_AGE_MAX); }

// RGB: filtered, A: of the nearest texel, where somebody asks.
vec4 filtered_history(vec2 place_px)
{
    precise vec2 corner = floor(place_px - 0.5);
    precise vec2 way = place_px - 0.5 - corner;
    if (is_at_rest || (takes_at_once() && way == vec2(0.0)))
        return history_at_rest(ivec2(corner));
    if (takes_at_once() && has_all(ivec2(corner), way))
        return history_at_once(ivec2(corner), way);
    float age = asks_for_age() ? fetch_picture(RT_TAA_BEFORE, ivec2(floor(place_px))).a : 0.0;
    return vec4(history_one_by_one(ivec2(corner), way), age);
}

// How many frames a pixel of the history is the mean of.
float age_of(float kept)
{
    if (!asks_for_age())
        return 0.0;
    return kept >= 1.0 ? min(kept, setting(RT_TAA_AGE_MAX)) : 1.0;
}

// A: its age. False when the guard finds the history void.
bool fetch_history(vec2 place_px, out vec4 history)
{
    history = filtered_history(place_px);
    history.a = age_of(history.a);
    if (choice(RT_TAA_PRE_EXPOSURE) != 0)
        history.rgb *= exposure / exposure_before;
    bool is_sound = !guarded() || is_finite(history.rgb);
    history.rgb = guard(history.rgb);
    return is_sound;
}

// --- the blend ----------------------------------------------------------------------------------

vec3 hold_history(vec3 history, Box box)
{
    if (choice(RT_TAA_BOX) == RT_BOX_NONE)
        return history;
    vec3 value = to_space(history);
    bool is_plain = goes_by_rows() && guarded(); // limits that never cross
    vec3 held = is_plain ? clamp(value, box.low, box.high) : hold(value, box.low, box.high);
    return held == value ? history : from_space(held);
}

float coverage = 1.0; // of the pixel by rays about its centre

const float ALPHA_MOVING = 0.2; // weight of the frame at VELOCITY_PX and above
const float VELOCITY_PX = 20.0; // per frame; Unreal counts halves of pixels: its 40

// Weight of the frame: more when the picture moves, and enough for a step of taa_contrast of the
// history's luma (before it was held). So a pixel whose noise is below that is not averaged.
float frame_weight(float luma, float history_luma, float speed_px)
{
    float way = speed_px / VELOCITY_PX;
    float alpha = mix(coverage * setting(RT_TAA_ALPHA), ALPHA_MOVING,
                      way < 1.0 ? way : 1.0);
    if (setting(RT_TAA_CONTRAST) == 0.0 || (guarded() && !(history_luma > 0.0)))
        return alpha;
    precise float least = setting(RT_TAA_CONTRAST) * history_luma / abs(luma - history_luma);
    if (least <= alpha)
        return alpha;
    return least > 1.0 ? 1.0 : least; // or NaN
}

// It does not change by taa_change in so many. Rays look again after four frames, and at what is
// behind all media after those of the jitter.
float frames_alike()
{
    float limit = setting(RT_TAA_CHANGE);
    return min(4.0 * lasting(of_medium.residue, limit),
               setting(RT_TAA_JITTER_LENGTH) * lasting(of_behind.residue, limit));
}

// Motion per frame up to which a pixel is at rest; it moves from twice this on.
const float REST_PX = 0.02;

// Where it rests history has the light of this frame, by the shares that both have in the pixel.
vec3 relit(vec3 history, ivec2 source, Film film, float speed_px)
{
    float motion = beyond(speed_px, REST_PX);
    bool is_same = of_medium.gain == vec3(1.0) && of_behind.gain == vec3(1.0);
    bool is_idle = is_same || (ON_GPU && motion == 1.0);
    if (!asks_for_change() || !is_set(RT_RELIGHT) || !film.has_own || is_idle)
        return history;
    vec3 colour = film.own;
    vec3 medium = hold(exposure * fetch_full(RT_VOLUME, source).rgb, vec3(0.0), colour);
    vec3 then = medium / of_medium.gain + (colour - medium) / of_behind.gain;
    vec3 gain = mix(vec3(1.0), colour / then, greaterThan(then, vec3(0.0)));
    return mix(gain, vec3(1.0), motion) * history;
}

// How far a pixel is from being at rest, 0..1.
float unrest(float speed_px)
{
    if (!asks_for_change())
        return 1.0;
    return max(beyond(speed_px, REST_PX),
               beyond(change(), setting(RT_TAA_CHANGE)));
}

// At rest the weight of one frame more. The age counts frames since the last change, so that what
// came before goes as soon as the light stands still, and no more of them than are alike.
float weight_with_age(float alpha, float unrest, inout float age)
{
    if (!is_set(RT_TAA_AGE_MAX))
        return alpha;
    if (choice(RT_GRADIENT) != 0)
        age = max(min(age, frames_alike()), 1.0);
    alpha = mix(1.0 / (age + 1.0), alpha, unrest);
    age = min(mix(age + 1.0, 1.0, unrest), setting(RT_TAA_AGE_MAX));
    return alpha;
}

vec3 blend(vec3 frame, vec3 history, float alpha)
{
    bool is_short = ON_GPU && !ALL_REST && choice(RT_TAA_HDR_WEIGHT) != 0; // each times the other's
    float of_frame = alpha * (is_short ? luma_4(history) + 4.0 : hdr_weight(frame));
    float of_history = (1.0 - alpha) * (is_short ? luma_4(frame) + 4.0 : hdr_weight(history));
    float weight = of_frame / (of_frame + of_history);
    return weight == 1.0 ? frame : history + weight * (frame - history);
}

// --- the output ---------------------------------------------------------------------------------

// One of the two halves next to a value, by a number from 0 to 1: the value is their mean.
float round_by_chance(float value, float number)
{
    uint magnitude = floatBitsToUint(value) & 0x7fffffffu;
    if (magnitude >= 0x477fe000u) // from 65504 on
        return value;
    uint exponent = max(magnitude >> 23, 113u); // the least of normal halves is 2^-14
    float halves_per_unit = uintBitsToFloat((264u - exponent) << 23); // 2^10 of them in an octave
    float half_step = uintBitsToFloat((exponent - 10u) << 23);
    precise float halves = value * halves_per_unit;
    precise float below = floor(halves);
    precise float above_it = halves - below;
    return (number < above_it ? below + 1.0 : below) * half_step;
}

// One of them by whole numbers, for what is from 0 to 65504: a number of 13 bits is added to those
// that a half has no room for, which chooses alike. What is below 2^-14 is rounded as if it were as
// much above that.
float round_by_bits(float value, uint number)
{
    bool is_below_normal = value < 6.103515625e-5;
    precise float above = value + 6.103515625e-5;
    uint bits = floatBitsToUint(is_below_normal ? above : value) + (~number >> 19);
    float rounded = uintBitsToFloat(bits & ~0x1fffu);
    return is_below_normal ? rounded - 6.103515625e-5 : rounded;
}

vec3 round_to_format(vec3 colour, ivec2 pixel)
{
    if (choice(RT_TARGET_FORMAT) != RT_FORMAT_HALF ||
        choice(RT_TAA_ROUNDING) != RT_ROUNDING_STOCHASTIC)
        return colour;
    // The hash's first number is the white dither's (renderer/dither.h).
    uvec3 bits = pcg4d(uvec4(pixel, view_frame, view_seed)).yzw;
    if (ON_GPU && guarded())
        return vec3(round_by_bits(colour.r, bits.x), round_by_bits(colour.g, bits.y),
                    round_by_bits(colour.b, bits.z));
    vec3 numbers = uniform_from(bits);
    return vec3(round_by_chance(colour.r, numbers.x), round_by_chance(colour.g, numbers.y),
                round_by_chance(colour.b, numbers.z));
}

// --- the responsive mask ------------------------------------------------------------------------

// What hides more than half of what is behind it, and has no motion vectors.
bool is_responsive(ivec2 source)
{
    return choice(RT_TAA_RESPONSIVE) == RT_RESPONSIVE_MEDIUM &&
           fetch_full(RT_VOLUME, source).a < 0.5;
}

// The colour of a pixel of the picture, which is made of the rendered ones around `source`, and its
// age.
vec4 resolved(ivec2 pixel, ivec2 source, Film film)
{
    bool is_reset = !has_past || (is_cut && choice(RT_CUT_RESET) != 0);
    vec2 before_px;
    float speed_px;
    vec4 found; // RGB, age
    vec3 colour = film.colour;
    bool has_history = !is_reset && find_before(pixel, source, before_px, speed_px) &&
                       fetch_history(before_px, found);
    vec3 history = found.rgb;
    float age = has_history ? found.a : asks_for_age() ? 1.0 : 0.0;
    if (!film.is_any) {
        colour = has_history ? history : vec3(0.0);
    } else if (has_history) {
        history = relit(history, source, film, speed_px);
        float alpha = 0.0, part = 0.0;
        vec3 held = history;
        if (is_held) {
            alpha = frame_weight(luma_4(colour), luma_4(history), speed_px);
            part = unrest(speed_px);
            held = hold_history(history, film.box);
        }
        alpha = weight_with_age(alpha, part, age);
        if (is_responsive(source))
            alpha = max(alpha, 0.25);
        colour = blend(colour, part == 1.0 ? held : mix(history, held, part), alpha);
    }
    if (!(ON_GPU && guarded()))
        colour = hold(colour, vec3(-HALF_MAX), vec3(HALF_MAX));
    return vec4(guard(colour), age);
}

#endif
