#version 450
// SPDX-License-Identifier: MIT
//
// A13, A14: from half to full resolution. A pixel's place in the half-resolution image, shifted by
// dither, lies between four half-pixels; of these taps it takes what belongs to its own depth.
//
// Place: the centre of pixel x lies at (x + 1/2) / 2 - 1/2 half-pixels, which are counted from the
// centre of the first. The jitter of the scene's rays is added where the volume's have none, so that
// TAA, which takes it out again, finds both in the same place.
//
// Shift (A13): up to upscale_amount_px to either side along x and y, by two dither numbers. `shared`
// is the article's way: the second number is that of the pixel (y, x), and both go round the circle
// by the same step, 16 frames long. Their difference never changes, so that a pixel's 16 places lie
// on a line, and on the picture's diagonal all on the diagonal (X13). `independent` has two channels
// and no period. A place that stays between the same four half-pixels gives `mean` and `nearest` the
// same taps: below 1/4 half-pixel a shift changes nothing there.
//
// Law (A13): the article has "more in near dense fog, less on far clouds" and no formula. Ours:
//
//   shift = amount (1 - T) max(0, 1 - distance / 4 km)
//
// with transmittance T and cloud distance of the half-pixel that the pixel lies in. It has no
// division, so that every device finds the same taps.
//
// Choice (A14), by the differences |scene - tap| of eye depths:
//
//   nearest    the tap of the least difference; of equal ones that which is nearest in place
//   bilinear   weights of place alone: what leaks over edges
//   mean       the mean of the four if all differences are below upscale_depth * scene, else as
//              nearest
//   bilateral  weights of place times max(0, upscale_depth * scene - difference); if all are 0, as
//              nearest
//
// Depths are compared as in the reconstruction: the sky is at sky_m, solids end at ray_depth_max_m
// if clamp_pixel_depth is on. Pixel and taps have the same limits, so that no ridge is taken for sky
// because only one of both was limited (X8). Without the limit a ridge within upscale_depth of sky_m
// is.
//
// With upscale_contrast > 0 depth matters only where the transmittances of the taps differ by more
// than this part of the largest; elsewhere nearest and mean take the mean, bilateral is bilinear.
//
// With validity on, taps that are void or unsound do not count; a pixel without any tap is void.
#extension GL_GOOGLE_include_directive : require

#include "realtime_dither.glsl"
#include "realtime_pass.glsl"
#include "realtime_slots.glsl"

const float LAW_PER_M = 0.00025; // 1 / 4 km
const uint SHARED_FRAMES = 16u;
const float FLOAT_MAX = 3.40282347e38;

struct Tap {
    vec4 volume;
    float distance_m;
    float difference_m; // of its depth from the pixel's
    float place; // bilinear weight
    bool is_used;
};

// History that may be used; all may be when nobody looks.
bool is_usable(vec4 volume, float age)
{
    return choice(RT_VALIDITY) == 0 || (is_finite(age) && age > 0.0 && is_sound(volume));
}

// --- the place --------------------------------------------------------------------------------

vec2 place_of(ivec2 pixel)
{
    bool is_jittered = choice(RT_JITTERED_DEPTH) == 0;
    vec2 jitter_px = is_jittered ? vec2(view.jitter_px[0], view.jitter_px[1]) : vec2(0.0);
    precise vec2 place = 0.5 * vec2(pixel) - 0.25 + 0.5 * jitter_px;
    return place;
}

// Held in 0 .. 1; 0 for what is no number.
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
    vec4 volume = fetch_half(RT_HISTORY, pixel / 2);
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
    vec2 number;
    if (choice(RT_UPSCALE_PAIR) == RT_PAIR_SHARED)
        number = vec2(dither(kind, pixel, view.frame % SHARED_FRAMES, 0u),
                      dither(kind, pixel.yx, view.frame % SHARED_FRAMES, 0u));
    else
        number = vec2(dither(kind, pixel, view.frame, 0u), dither(kind, pixel, view.frame, 1u));
    precise vec2 shift = shift_amount_px(pixel) * (2.0 * number - 1.0);
    return shift;
}

// --- the taps -----------------------------------------------------------------------------------

float compared_depth_m(float eye_m)
{
    if (choice(RT_CLAMP_PIXEL_DEPTH) != 0)
        return stored_depth_m(eye_m);
    return is_sky(eye_m) ? setting(RT_SKY_M) : eye_m;
}

// Half-pixel `corner` + (0, 0), (1, 0), (0, 1), (1, 1) for i = 0, 1, 2, 3.
Tap tap_at(ivec2 corner, int i, vec2 fraction, float scene_m)
{
    ivec2 at = ivec2(i & 1, i >> 1);
    vec4 state = fetch_half(RT_HISTORY_STATE, corner + at);
    Tap tap;
    tap.volume = fetch_half(RT_HISTORY, corner + at);
    tap.distance_m = state.y;
    precise float difference_m =
        abs(scene_m - compared_depth_m(fetch_half(RT_HALF_DEPTH, corner + at).x));
    tap.difference_m = difference_m;
    precise vec2 side = vec2(at.x == 0 ? 1.0 - fraction.x : fraction.x,
                             at.y == 0 ? 1.0 - fraction.y : fraction.y);
    tap.place = side.x * side.y;
    tap.is_used = is_usable(tap.volume, state.x);
    return tap;
}

// By depth; the first that is asked is the nearest in place. -1: none is used.
int nearest_tap(Tap taps[4], vec2 fraction)
{
    int first = (fraction.x < 0.5 ? 0 : 1) + (fraction.y < 0.5 ? 0 : 2), nearest = -1;
    for (int i = 0; i < 4; i++) {
        int asked = i ^ first;
        if (taps[asked].is_used &&
            (nearest < 0 || taps[asked].difference_m < taps[nearest].difference_m))
            nearest = asked;
    }
    return nearest;
}

bool depth_matters(Tap taps[4], int nearest)
{
    float contrast = setting(RT_UPSCALE_CONTRAST);
    float least = taps[nearest].volume.w, largest = least;
    for (int i = 0; i < 4; i++) {
        if (taps[i].is_used && taps[i].volume.w < least)
            least = taps[i].volume.w;
        if (taps[i].is_used && taps[i].volume.w > largest)
            largest = taps[i].volume.w;
    }
    precise float range = largest - least;
    precise float allowed = contrast * largest;
    return contrast == 0.0 || range > allowed;
}

bool all_within(Tap taps[4], float limit_m)
{
    for (int i = 0; i < 4; i++)
        if (taps[i].is_used && !(taps[i].difference_m < limit_m))
            return false;
    return true;
}

// --- the choice -----------------------------------------------------------------------------------

// `regardless`: of depth.
float tap_weight(Tap tap, bool is_nearest, bool regardless, float limit_m)
{
    if (!tap.is_used)
        return 0.0;
    int upscale = choice(RT_UPSCALE);
    if (upscale == RT_UPSCALE_BILINEAR || (upscale == RT_UPSCALE_BILATERAL && regardless))
        return tap.place;
    if (upscale == RT_UPSCALE_BILATERAL) {
        precise float margin_m = limit_m - tap.difference_m;
        return margin_m > 0.0 ? tap.place * margin_m : 0.0;
    }
    return regardless || is_nearest ? 1.0 : 0.0;
}

// Held between the values that it is made of: a constant stays what it is, and no rounding makes a
// radiance negative.
vec4 blend(Tap taps[4], float weights[4], int nearest)
{
    float total = weights[0] + weights[1] + weights[2] + weights[3];
    if (!(total > 0.0))
        return taps[nearest].volume;
    vec4 sum = vec4(0.0), least = vec4(FLOAT_MAX), largest = vec4(-FLOAT_MAX);
    for (int i = 0; i < 4; i++)
        if (weights[i] > 0.0) {
            vec4 value = taps[i].volume;
            sum += weights[i] / total * value;
            least = mix(least, value, lessThan(value, least));
            largest = mix(largest, value, greaterThan(value, largest));
        }
    sum = mix(sum, least, lessThan(sum, least));
    return mix(sum, largest, greaterThan(sum, largest));
}

void main()
{
    ivec2 pixel;
    if (!own_element(view_size(), pixel))
        return;
    precise vec2 place = place_of(pixel) + shift_px(pixel);
    vec2 corner = floor(place);
    precise vec2 fraction = place - corner;
    float scene_m = compared_depth_m(fetch_full(RT_DEPTH, pixel).x);
    precise float limit_m = setting(RT_UPSCALE_DEPTH) * scene_m;

    Tap taps[4];
    for (int i = 0; i < 4; i++)
        taps[i] = tap_at(ivec2(corner), i, fraction, scene_m);
    int nearest = nearest_tap(taps, fraction);
    if (nearest < 0) {
        put_full(RT_VOLUME, pixel, vec4(0.0, 0.0, 0.0, 1.0));
        put_full(RT_VOLUME_DISTANCE, pixel, vec4(0.0));
        return;
    }
    bool regardless = !depth_matters(taps, nearest) ||
                      (choice(RT_UPSCALE) == RT_UPSCALE_MEAN && all_within(taps, limit_m));
    float weights[4];
    for (int i = 0; i < 4; i++)
        weights[i] = tap_weight(taps[i], i == nearest, regardless, limit_m);
    put_full(RT_VOLUME, pixel, blend(taps, weights, nearest));
    put_full(RT_VOLUME_DISTANCE, pixel, vec4(taps[nearest].distance_m));
}
