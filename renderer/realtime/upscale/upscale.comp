#version 450
// SPDX-License-Identifier: MIT
//
// The upscale from half to full resolution. A pixel's place in the half-resolution image, shifted
// by dither, lies between four half-resolution texels; of these taps it takes what belongs to its
// own depth.
//
// Place: the centre of pixel x lies at (x + 1/2) / 2 - 1/2 texels, which are counted from the
// centre of the first. The jitter of the scene's rays is added where the volume's have none, so
// that TAA, which takes it out again, finds both in the same place.
//
// Shift: up to upscale_amount_px to either side along x and y, by two dither numbers. `shared` is
// the article's way: the second number is that of the pixel (y, x), and both advance by one step a
// frame, for 16 frames. Their difference never changes, so that a pixel's 16 places lie on a line,
// and on the picture's diagonal all on the diagonal. `independent` has two channels and no period.
// A place that stays between the same four texels gives `mean` and `nearest` the same taps: below
// 1/4 texel a shift changes nothing there.
//
// Law of the shift: the article has "more in near dense fog, less on far clouds" and no formula.
// Ours:
//
//   shift = amount (1 - T) max(0, 1 - distance / 4 km)
//
// with transmittance T and cloud distance of the texel that the pixel lies in. It has no division,
// so that every device finds the same taps.
//
// Choice of taps, by the differences |scene - tap| of eye depths:
//
//   nearest    the tap of the least difference; of equal ones that which is nearest in place
//   bilinear   weights of place alone: what leaks over edges
//   mean       the mean of the four if all differences are below upscale_depth * scene, else as
//              nearest
//   bilateral  weights of place times max(0, upscale_depth * scene - difference); if all are 0, as
//              nearest
//   inverse    bilinear if all differences are below upscale_depth * scene, else weights
//              1 / (difference + upscale_tolerance_m) (Unreal Engine 5, upsampling mode 4)
//   square     3x3 texels about the place with weights exp(-d^2) / (difference +
//              upscale_tolerance_m), d the distance in place (Unity HDRP's BilUpColor3x3)
//
// Depths are compared as in the reconstruction, but with a sky at 1000 km: solids end at
// ray_depth_max_m if clamp_pixel_depth is on. Pixel and taps have the same limits, so that no ridge
// is taken for sky because only one of both was limited. Without the limit a ridge within
// upscale_depth of that is. With upscale_same_kind no tap of the sky counts on a solid,
// nor the other way round, as long as there are others.
//
// With upscale_contrast > 0 depth matters only where the transmittances of the taps differ by more
// than this part of the largest (or of the largest opacity: contrast); elsewhere nearest and mean
// take the mean, bilateral and inverse are bilinear, and square goes by place alone.
//
// With validity on, taps that are void or unsound do not count; a pixel without any tap is void.
//
// A thread makes 2x2 pixels. Without dither they lie between the same texels, since the jitter is
// at most half a pixel, and one fetch of taps serves all four: pixels 2 k - 1 and 2 k, or 2 k and
// 2 k + 1 about one texel (square).
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "renderer/realtime/gradient/change.glsl"
#include "renderer/realtime/shared/dither.glsl"
#include "renderer/realtime/shared/pass.glsl"
#include "renderer/realtime/tile_index/slots.glsl"

const float LAW_PER_M = 0.00025; // 1 / 4 km
const uint SHARED_FRAMES = 16u;
const float FLOAT_MAX = 3.40282347e38;

struct Tap {
    vec4 volume;
    float age, distance_m;
    float depth_m;
    float difference_m; // of that from the pixel's
    float place; // weight, bilinear or Gaussian
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


// From the reconstruction, filtered or not.
vec4 fetch_volume(ivec2 half_pixel)
{
    if (choice(RT_ATROUS) != 0)
        return fetch_half(RT_HISTORY_BEFORE, half_pixel);
    return fetch_half(RT_HISTORY, half_pixel);
}

// History that may be used; all may be when nobody looks.
bool is_usable(vec4 volume, float age)
{
    return choice(RT_VALIDITY) == 0 || all(bvec3(is_finite(age), age > 0.0, is_sound(volume)));
}

// --- the place --------------------------------------------------------------------------------

vec2 place_of(ivec2 pixel)
{
    bool is_jittered = choice(RT_JITTERED_DEPTH) == 0;
    vec2 shift_px = is_jittered ? jitter_px : vec2(0.0);
    precise vec2 place = 0.5 * vec2(pixel) - 0.25 + 0.5 * shift_px;
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

bool shares_taps() { return choice(RT_UPSCALE_DITHER) == RT_DITHER_NONE; }

// The first pixel of a thread; it may be one before the view.
ivec2 first_pixel(ivec2 quad) { return 2 * quad - (is_square() ? 0 : 1); }

// The half-resolution texel that a pixel's taps are counted from, row by row.
ivec2 corner_of(ivec2 pixel, vec2 place)
{
    if (shares_taps())
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

// What is rounded to halves needs no hold: what a sum in float32 is off by is less than half a step
// of theirs. Taps that are not used are 0.
bool rounds_to_halves() { return ON_GPU && choice(RT_TARGET_FORMAT) == RT_FORMAT_HALF; }

Tap fetch_tap(ivec2 texel)
{
    Tap tap;
    tap.volume = fetch_volume(texel);
    vec4 state = fetch_half(RT_HISTORY_STATE, texel);
    tap.age = state.x;
    tap.distance_m = state.y;
    tap.depth_m = fetch_half(RT_HALF_DEPTH, texel).x;
    tap.is_used = is_usable(tap.volume, tap.age);
    if (rounds_to_halves() && !tap.is_used)
        tap.volume = vec4(0.0);
    return tap;
}

// All on their way before the first is looked at.
Taps fetch_taps(ivec2 corner)
{
    Taps taps;
    [[unroll]] for (int i = 0; i < tap_count(); i++)
        taps.of[i] = fetch_tap(corner + tap_offset(i));
    return taps;
}

// `fraction` of the place from the corner, in texels; `scene_m` the pixel's eye depth.
void judge(inout Tap tap, int i, vec2 fraction, float scene_m)
{
    precise float difference_m = abs(compared_depth_m(scene_m) - compared_depth_m(tap.depth_m));
    tap.difference_m = difference_m;
    tap.place = place_weight(tap_offset(i), fraction);
    tap.is_foreign = choice(RT_UPSCALE_SAME_KIND) != 0 && is_sky(tap.depth_m) != is_sky(scene_m);
}

// The order in which ties are decided: first the nearest in place. That of a quad's pixels is in
// the corner that they are in.
int asked_tap(int i, int in_quad, vec2 fraction)
{
    if (is_square())
        return i == 0 ? 4 : i <= 4 ? i - 1 : i;
    if (shares_taps())
        return i ^ in_quad;
    return i ^ ((fraction.x < 0.5 ? 0 : 1) + (fraction.y < 0.5 ? 0 : 2));
}

// A choice among known taps is cheaper than an index into memory.
Tap picked(Tap taps[TAPS_MAX], int index)
{
    Tap tap = taps[0];
    [[unroll]] for (int i = 1; i < tap_count(); i++)
        if (i == index)
            tap = taps[i];
    return tap;
}

// The tap nearest in depth; -1: none is used.
int nearest_tap(Tap taps[TAPS_MAX], int in_quad, vec2 fraction)
{
    int nearest = -1;
    float least_m = 0.0;
    [[unroll]] for (int i = 0; i < tap_count(); i++) {
        int asked = asked_tap(i, in_quad, fraction);
        Tap tap = picked(taps, asked);
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
    bool are_within = true; // a loop with a way out would not be unrolled
    [[unroll]] for (int i = 0; i < tap_count(); i++)
        if (taps[i].is_used && !(taps[i].difference_m < limit_m))
            are_within = false;
    return are_within;
}

// --- the choice ---------------------------------------------------------------------------------

// `regardless` of depth.
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

vec4 mean_of(Tap taps[TAPS_MAX], float weights[TAPS_MAX], float total)
{
    vec4 sum = vec4(0.0);
    [[unroll]] for (int i = 0; i < tap_count(); i++)
        sum += weights[i] * taps[i].volume;
    return sum / total;
}

// Held between the values that it is made of: a constant stays what it is, and no rounding makes a
// radiance negative.
vec4 held_mean_of(Tap taps[TAPS_MAX], float weights[TAPS_MAX], float total)
{
    vec4 sum = vec4(0.0), least = vec4(FLOAT_MAX), largest = vec4(-FLOAT_MAX);
    [[unroll]] for (int i = 0; i < tap_count(); i++)
        if (weights[i] > 0.0) {
            vec4 value = taps[i].volume;
            sum += weights[i] / total * value;
            least = mix(least, value, lessThan(value, least));
            largest = mix(largest, value, greaterThan(value, largest));
        }
    sum = mix(sum, least, lessThan(sum, least));
    return mix(sum, largest, greaterThan(sum, largest));
}

vec4 blend(Tap taps[TAPS_MAX], float weights[TAPS_MAX], int nearest)
{
    float total = 0.0;
    [[unroll]] for (int i = 0; i < tap_count(); i++)
        total += weights[i];
    if (!(total > 0.0))
        return picked(taps, nearest).volume;
    return rounds_to_halves() ? mean_of(taps, weights, total)
                              : held_mean_of(taps, weights, total);
}

Upscaled upscaled(Taps taps, int in_quad, vec2 fraction, float scene_m)
{
    precise float limit_m = setting(RT_UPSCALE_DEPTH) * compared_depth_m(scene_m);
    [[unroll]] for (int i = 0; i < tap_count(); i++)
        judge(taps.of[i], i, fraction, scene_m);
    int nearest = nearest_tap(taps.of, in_quad, fraction);
    Tap chosen = picked(taps.of, nearest);
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

// --- both over what is behind -----------------------------------------------------------------

// As a volume is read again.
vec4 as_kept(vec4 volume)
{
    return format_of(RT_VOLUME) == RT_RGBA16F
               ? from_words(uvec2(pack(volume.xy), pack(volume.zw)))
               : volume;
}

// Where no other pass changes the volume before it is laid over what is behind
// (composition/compose.comp).
bool composes() { return choice(RT_COMPOSITION) == RT_COMPOSITION_UPSCALE; }

void put_composed(ivec2 pixel, vec4 volume)
{
    vec3 radiance = over(as_kept(volume), fetch_full(RT_BEHIND, pixel).xyz);
    put_full(RT_COLOR, pixel, vec4(radiance, 1.0));
}

void main()
{
    ivec2 quad;
    if (!own_element(view_size() / 2 + 1, quad))
        return;
    Taps taps;
    [[unroll]] for (int i = 0; i < 4; i++) {
        ivec2 pixel = first_pixel(quad) + ivec2(i & 1, i >> 1);
        precise vec2 place = place_of(pixel) + shift_px(pixel);
        ivec2 corner = corner_of(pixel, place);
        if (i == 0 || !shares_taps())
            taps = fetch_taps(corner);
        precise vec2 fraction = place - vec2(corner);
        Upscaled made = upscaled(taps, i, fraction, fetch_full(RT_DEPTH, pixel).x);
        if (all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, view_size()))) {
            if (!is_unread()) {
                put_full(RT_VOLUME, pixel, made.volume);
                put_full(RT_VOLUME_DISTANCE, pixel, vec4(made.distance_m));
            }
            if (composes())
                put_composed(pixel, made.volume);
        }
    }
}
