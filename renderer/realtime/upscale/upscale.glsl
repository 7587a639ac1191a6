// SPDX-License-Identifier: MIT
//
// The upscale of one pixel (upscale.comp).
#ifndef NEPH_REALTIME_UPSCALE_GLSL
#define NEPH_REALTIME_UPSCALE_GLSL

#extension GL_EXT_control_flow_attributes : require

#include "renderer/realtime/gradient/change.glsl"
#include "renderer/realtime/shared/dither.glsl"
#include "renderer/realtime/tile_index/slots.glsl"

const float LAW_PER_M = 0.00025;          // the shift ends at 4 km (upscale_law)
const uint SHARED_FRAMES = 16u;           // period of the article's shift (upscale_pair = shared)
const float FLOAT_MAX = 3.40282347e38;

struct Tap {
    vec4 volume;
    float age, distance_m;
    float depth_m;
    float difference_m; // of the tap's depth from the pixel's
    float place;        // weight, bilinear or Gaussian
    bool is_used;
    bool is_foreign; // of the other kind, sky or solid
};

const int TAPS_MAX = 9;

struct Taps {
    Tap of[TAPS_MAX];
};

struct Upscaled {
    vec4 volume;
    float distance_m;
};

const Upscaled NOTHING = Upscaled(vec4(0.0, 0.0, 0.0, 1.0), 0.0);

// The output of the reconstruction, or of the a-trous filter.
vec4 fetch_volume(ivec2 half_pixel)
{
    if (choice(RT_ATROUS) != 0)
        return fetch_half(RT_HISTORY_BEFORE, half_pixel);
    return fetch_half(RT_HISTORY, half_pixel);
}

// Whether history may be used; always with validity = off.
bool is_usable(vec4 volume, float age)
{
    return choice(RT_VALIDITY) == 0 || all(bvec3(is_finite(age), age > 0.0, is_sound(volume)));
}

// --- the place --------------------------------------------------------------------------------

vec2 find_place(ivec2 pixel)
{
    bool is_jittered = choice(RT_JITTERED_DEPTH) == 0;
    vec2 shift_px = is_jittered ? jitter_px : vec2(0.0);
    precise vec2 place = 0.5 * vec2(pixel) - 0.25 + 0.5 * shift_px;
    return place;
}

// Clamped to 0 .. 1; a NaN becomes 0.
float unit(float value)
{
    if (!is_finite(value) || value < 0.0)
        return 0.0;
    return value > 1.0 ? 1.0 : value;
}

float shift_amount_px(ivec2 pixel)
{
    float most_px = setting(RT_UPSCALE_AMOUNT_PX);
    if (choice(RT_UPSCALE_LAW) == RT_LAW_CONSTANT)
        return most_px;
    vec4 volume = fetch_volume(pixel / 2);
    vec4 state = fetch_half(RT_HISTORY_STATE, pixel / 2);
    if (!is_usable(volume, state.x))
        return 0.0;
    precise float opacity = 1.0 - volume.w;
    precise float reach = state.y * LAW_PER_M;
    precise float nearness = 1.0 - reach;
    precise float amount_px = most_px * unit(opacity) * unit(nearness);
    return amount_px;
}

vec2 shift_px(ivec2 pixel)
{
    int kind = choice(RT_UPSCALE_DITHER);
    if (kind == RT_DITHER_NONE)
        return vec2(0.0);
    vec2 number;
    if (choice(RT_UPSCALE_PAIR) == RT_PAIR_SHARED)
        number = vec2(dither(kind, pixel, view_frame % SHARED_FRAMES, 0u),
                      dither(kind, pixel.yx, view_frame % SHARED_FRAMES, 0u));
    else
        number = vec2(dither(kind, pixel, view_frame, 0u), dither(kind, pixel, view_frame, 1u));
    precise vec2 shift = shift_amount_px(pixel) * (2.0 * number - 1.0);
    return shift;
}

// --- the taps -----------------------------------------------------------------------------------

const float UPSCALE_SKY_M = 1e6; // depth of the sky in the upscale

float compared_depth_m(float eye_m)
{
    if (choice(RT_CLAMP_PIXEL_DEPTH) != 0)
        return limited_depth_m(eye_m, UPSCALE_SKY_M);
    return is_sky(eye_m) ? UPSCALE_SKY_M : eye_m;
}

bool is_square() { return choice(RT_UPSCALE) == RT_UPSCALE_SQUARE; }

bool has_shared_taps() { return choice(RT_UPSCALE_DITHER) == RT_DITHER_NONE; }

// The first pixel of a thread; it may lie one pixel before the view.
ivec2 first_pixel(ivec2 quad) { return 2 * quad - (is_square() ? 0 : 1); }

// The half-resolution texel of a pixel's first tap; taps are numbered row by row.
ivec2 find_first_tap(ivec2 pixel, vec2 place)
{
    if (has_shared_taps())
        return (is_square() ? pixel : pixel + 1) / 2 - 1;
    return ivec2(is_square() ? floor(place + 0.5) - 1.0 : floor(place));
}

int tap_count() { return is_square() ? 9 : 4; }

ivec2 tap_offset(int i) { return is_square() ? ivec2(i % 3, i / 3) : ivec2(i & 1, i >> 1); }

float place_weight(ivec2 at, vec2 fraction)
{
    if (is_square()) {
        vec2 way = fraction - vec2(at);
        return exp(-dot(way, way));
    }
    precise vec2 side = vec2(at.x == 0 ? 1.0 - fraction.x : fraction.x,
                             at.y == 0 ? 1.0 - fraction.y : fraction.y);
    return side.x * side.y;
}

Tap fetch_tap(ivec2 texel)
{
    Tap tap;
    tap.volume = fetch_volume(texel);
    vec4 state = fetch_half(RT_HISTORY_STATE, texel);
    tap.age = state.x;
    tap.distance_m = state.y;
    tap.depth_m = fetch_half(RT_HALF_DEPTH, texel).x;
    tap.is_used = is_usable(tap.volume, tap.age);
    if (!tap.is_used)
        tap.volume = vec4(0.0); // removes a NaN, which would survive a weight of 0
    return tap;
}

// All taps are fetched before the first is used.
Taps fetch_taps(ivec2 corner)
{
    Taps taps;
    [[unroll]] for (int i = 0; i < tap_count(); i++)
        taps.of[i] = fetch_tap(corner + tap_offset(i));
    return taps;
}

// `fraction`: place relative to the corner, in texels; `scene_m`: the pixel's eye depth.
void weigh_tap(inout Tap tap, int i, vec2 fraction, float scene_m)
{
    precise float difference_m = abs(compared_depth_m(scene_m) - compared_depth_m(tap.depth_m));
    tap.difference_m = difference_m;
    tap.place = place_weight(tap_offset(i), fraction);
    tap.is_foreign = choice(RT_UPSCALE_SAME_KIND) != 0 && is_sky(tap.depth_m) != is_sky(scene_m);
}

// The order in which ties are decided: the nearest in place first. For the pixels of a quad with
// shared taps it follows from the pixel's corner of the quad.
int get_tap_in_tie_order(int i, int in_quad, vec2 fraction)
{
    if (is_square())
        return i == 0 ? 4 : i <= 4 ? i - 1 : i;
    if (has_shared_taps())
        return i ^ in_quad;
    return i ^ ((fraction.x < 0.5 ? 0 : 1) + (fraction.y < 0.5 ? 0 : 2));
}

// A selection among registers is cheaper than an index into memory.
Tap select_tap(Tap taps[TAPS_MAX], int index)
{
    Tap tap = taps[0];
    [[unroll]] for (int i = 1; i < tap_count(); i++)
        if (i == index)
            tap = taps[i];
    return tap;
}

// The tap nearest in depth; -1: no tap is usable.
int nearest_tap(Tap taps[TAPS_MAX], int in_quad, vec2 fraction)
{
    int nearest = -1;
    float least_m = 0.0;
    [[unroll]] for (int i = 0; i < tap_count(); i++) {
        int asked = get_tap_in_tie_order(i, in_quad, fraction);
        Tap tap = select_tap(taps, asked);
        if (tap.is_used && (nearest < 0 || tap.difference_m < least_m)) {
            nearest = asked;
            least_m = tap.difference_m;
        }
    }
    return nearest;
}

bool depth_matters(Tap taps[TAPS_MAX], Tap nearest)
{
    if (!is_set(RT_UPSCALE_CONTRAST))
        return true;
    float contrast = setting(RT_UPSCALE_CONTRAST);
    float least = nearest.volume.w, largest = least;
    [[unroll]] for (int i = 0; i < tap_count(); i++) {
        if (taps[i].is_used && taps[i].volume.w < least)
            least = taps[i].volume.w;
        if (taps[i].is_used && taps[i].volume.w > largest)
            largest = taps[i].volume.w;
    }
    precise float range = largest - least;
    precise float unit = choice(RT_CONTRAST) == RT_CONTRAST_OPACITY ? 1.0 - least : largest;
    precise float allowed = contrast * unit;
    return range > allowed;
}

bool all_within(Tap taps[TAPS_MAX], float limit_m)
{
    bool are_within = true; // no early exit, which would prevent unrolling
    [[unroll]] for (int i = 0; i < tap_count(); i++)
        if (taps[i].is_used && !(taps[i].difference_m < limit_m))
            are_within = false;
    return are_within;
}

// --- the choice ---------------------------------------------------------------------------------

// `regardless`: depth is ignored.
float tap_weight(Tap tap, bool is_nearest, bool regardless, float limit_m)
{
    if (!tap.is_used || tap.is_foreign)
        return 0.0;
    int upscale = choice(RT_UPSCALE);
    if (upscale == RT_UPSCALE_BILINEAR || (upscale >= RT_UPSCALE_BILATERAL && regardless))
        return tap.place;
    if (upscale == RT_UPSCALE_INVERSE)
        return 1.0 / (tap.difference_m + setting(RT_UPSCALE_TOLERANCE_M));
    if (upscale == RT_UPSCALE_SQUARE)
        return tap.place / (tap.difference_m + setting(RT_UPSCALE_TOLERANCE_M));
    if (upscale == RT_UPSCALE_BILATERAL) {
        precise float margin_m = limit_m - tap.difference_m;
        return margin_m > 0.0 ? tap.place * margin_m : 0.0;
    }
    return regardless || is_nearest ? 1.0 : 0.0;
}

// The mean of the taps with weights that add up to `total` > 0.
vec4 weighted_mean(Tap taps[TAPS_MAX], float weights[TAPS_MAX], float total);

vec4 blend(Tap taps[TAPS_MAX], float weights[TAPS_MAX], int nearest)
{
    float total = 0.0;
    [[unroll]] for (int i = 0; i < tap_count(); i++)
        total += weights[i];
    if (!(total > 0.0))
        return select_tap(taps, nearest).volume;
    return weighted_mean(taps, weights, total);
}

Upscaled upscaled(Taps taps, int in_quad, vec2 fraction, float scene_m)
{
    precise float limit_m = setting(RT_UPSCALE_DEPTH) * compared_depth_m(scene_m);
    [[unroll]] for (int i = 0; i < tap_count(); i++)
        weigh_tap(taps.of[i], i, fraction, scene_m);
    int nearest = nearest_tap(taps.of, in_quad, fraction);
    Tap chosen = select_tap(taps.of, nearest);
    bool allows = choice(RT_UPSCALE) == RT_UPSCALE_MEAN ||
                  choice(RT_UPSCALE) == RT_UPSCALE_INVERSE;
    bool regardless = !depth_matters(taps.of, chosen) || (allows && all_within(taps.of, limit_m));
    float weights[TAPS_MAX];
    [[unroll]] for (int i = 0; i < tap_count(); i++)
        weights[i] = tap_weight(taps.of[i], i == nearest, regardless, limit_m);
    if (nearest < 0)
        return NOTHING;
    return Upscaled(blend(taps.of, weights, nearest), chosen.distance_m);
}

// --- the output --------------------------------------------------------------------------------

// The volume as a later pass would read it from its target.
vec4 as_kept(vec4 volume)
{
    return get_format(RT_VOLUME) == RT_RGBA16F
               ? from_words(uvec2(pack(volume.xy), pack(volume.zw)))
               : volume;
}

// Whether the volume is composed with the background here, because no later pass changes it
// (composition/compose.comp).
bool composes() { return choice(RT_COMPOSITION) == RT_COMPOSITION_UPSCALE; }

void put_composed(ivec2 pixel, vec4 volume)
{
    vec3 radiance = over(as_kept(volume), fetch_full(RT_BEHIND, pixel).xyz);
    put_full(RT_COLOR, pixel, vec4(radiance, 1.0));
}

// Adds the oracle, the error of the upscale of error-free texels (ray_march/ray_march.comp). Where
// the texels have errors of their own a sum may be negative, which no volume is.
vec4 correct_volume(ivec2 pixel, vec4 volume)
{
    if (choice(RT_ORACLE_UPSCALE) == 0)
        return volume;
    return max(volume + fetch_full(RT_VOLUME, pixel), vec4(0.0));
}

layout(constant_id = RT_ROLE_CONSTANT) const int ROLE = RT_ROLE_ORDINARY;

void put_upscaled(ivec2 pixel, Upscaled made)
{
    if (ROLE == RT_ROLE_ORACLE) {
        put_full(RT_VOLUME, pixel, made.volume);
        return;
    }
    vec4 volume = correct_volume(pixel, made.volume);
    if (!is_output_elided()) {
        put_full(RT_VOLUME, pixel, volume);
        put_full(RT_VOLUME_DISTANCE, pixel, vec4(made.distance_m));
    }
    if (composes())
        put_composed(pixel, volume);
}

// Four neighbouring pixels.
void upscale(ivec2 quad)
{
    Taps taps;
    [[unroll]] for (int i = 0; i < 4; i++) {
        ivec2 pixel = first_pixel(quad) + ivec2(i & 1, i >> 1);
        precise vec2 place = find_place(pixel) + shift_px(pixel);
        ivec2 corner = find_first_tap(pixel, place);
        if (i == 0 || !has_shared_taps())
            taps = fetch_taps(corner);
        precise vec2 fraction = place - vec2(corner);
        Upscaled made = upscaled(taps, i, fraction, fetch_full(RT_DEPTH, pixel).x);
        if (all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, view_size())))
            put_upscaled(pixel, made);
    }
}

#endif
