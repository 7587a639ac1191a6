// SPDX-License-Identifier: MIT
//
// One texel of the reconstruction (reconstruct.comp), from the rays around and its history.
#ifndef NEPH_REALTIME_RECONSTRUCT_GLSL
#define NEPH_REALTIME_RECONSTRUCT_GLSL

#include "renderer/realtime/gradient/change.glsl"
#include "renderer/realtime/gradient/gradient_samples.glsl"
#include "clamp_history.glsl"

const float AGE_MAX = 255.0;

// Rays that compute only transmittance have no noise: a new ray replaces the mean.
layout(constant_id = RT_DARK_CONSTANT) const bool IS_DARK = false;

// The change around a tile; each shader defines its own access.
Change change_around_tile(ivec2 tile);

// --- change -----------------------------------------------------------------------------------

// The relative difference of luminance L, or the difference of transmittance T, 0 .. 1:
//
//     max(|L_now - L_then| / max(L_now, L_then), |T_now - T_then|)
float measure_change(vec4 now, vec4 then)
{
    float now_luminance = luminance(now.rgb);
    float then_luminance = luminance(then.rgb);
    float most = max(now_luminance, then_luminance);
    float change = most > 0.0 ? abs(now_luminance - then_luminance) / most : 0.0;
    return max(change, abs(now.a - then.a));
}

// The change from the history of the nearest ray's own texel to that ray: a gradient as in
// C. Schied, C. Peters, C. Dachsbacher, "Gradient Estimation for Real-Time Adaptive Temporal
// Filtering", HPG 2018; each tile has it without an additional ray.
float change_at_ray(ivec2 tile, int ray)
{
    ivec2 find_tile = ray_tile(tile, ray);
    ivec2 place = ray_half_pixel(find_tile);
    History then = find_history(place, fetch_half(RT_HALF_DEPTH, place).x,
                                fetch_tile(RT_RAY_DISTANCE, find_tile).x, false);
    return then.is_invalid ? 1.0 : measure_change(ray_value(ray), then.value);
}

// The temporal gradient gives the change without noise (realtime/gradient/gradient.comp).
float change_at(ivec2 tile, int nearest)
{
    return choice(RT_GRADIENT) != 0 ? change_around_tile(tile).residue
                                    : change_at_ray(tile, nearest);
}

// A history whose light has changed by box_change gets the age of this frame. With slow change the
// age is limited to the time in which the light changes by that much.
float age_after_change(ivec2 tile, bool is_fresh, float age)
{
    if (choice(RT_GRADIENT) == 0)
        return age;
    float change = change_around_tile(tile).residue;
    float unchanged = 1.0 - beyond(change, setting(RT_BOX_CHANGE));
    age = min(unchanged * age, compute_change_time(change, setting(RT_BOX_CHANGE)));
    return max(age, is_fresh ? 0.0 : 1.0);
}

// Multiplies static history by the gain of the light since the frame before.
vec3 relight(vec3 radiance, ivec2 tile, float motion_px)
{
    if (choice(RT_GRADIENT) == 0 || !is_set(RT_RELIGHT))
        return radiance;
    vec3 gain = change_around_tile(tile).gain;
    return mix(gain, vec3(1.0), beyond(motion_px, setting(RT_BOX_MOTION_PX))) * radiance;
}

// The share of the neighbourhood clamp, 0..1: 1 for moving texels, 0 for static ones in constant
// light. There the depths of each frame's rays would make the clamp flicker.
float clamp_share(float motion_px, ivec2 tile, int nearest)
{
    if (is_static() && is_unchanged() && is_set(RT_BOX_MOTION_PX) && is_set(RT_BOX_CHANGE))
        return 0.0;
    float share = beyond(motion_px, setting(RT_BOX_MOTION_PX));
    if (share < 1.0)
        share = max(share, beyond(change_at(tile, nearest), setting(RT_BOX_CHANGE)));
    return share;
}

// --- blending ---------------------------------------------------------------------------------

// Weights of 0 and 1 return one value unchanged, also when the other one is NaN.
vec4 blend(vec4 a, vec4 b, float weight_of_b)
{
    if (weight_of_b == 0.0 || weight_of_b == 1.0)
        return weight_of_b == 0.0 ? a : b;
    return a + weight_of_b * (b - a);
}

// Weight of a fresh ray. `part`: share of the history's age that counts (box_age).
//
//     weight = 1 - part history_fade (1 - 1 / n),   n = min(age, history_age_max)
//
// With history_fade = 1 and part = 1 this is 1 / n: the history is the mean of its rays until it
// has history_age_max of them, and an exponential average from then on.
float fresh_weight(float age, float part)
{
    if (!is_set(RT_HISTORY_AGE_MAX))
        return setting(RT_FRESH_WEIGHT);
    float history_part = 1.0 - 1.0 / min(age, setting(RT_HISTORY_AGE_MAX));
    return 1.0 - part * setting(RT_HISTORY_FADE) * history_part;
}

// Blends history and ray in fresh_space.
vec4 blend_fresh(vec4 history, vec4 ray, float weight)
{
    int space = choice(RT_FRESH_SPACE);
    if (space == RT_SPACE_LINEAR || weight == 0.0 || weight == 1.0)
        return blend(history, ray, weight);
    float brightest = max(luminance(history.rgb), luminance(ray.rgb));
    return from_space(space, blend(to_space(space, history), to_space(space, ray), weight),
                      brightest);
}

// --- without history ----------------------------------------------------------------------------

// Weights of the tile before, the texel's own tile and the tile after along one axis. A texel's
// centre x is a quarter of a tile before its tile's centre; for the other texel the weights are
// mirrored:
//
//     |     o     |  x  o     |     o     |     o  centres of tiles: 0.75, 0.25 and 1.25 tiles away
const vec3 LINEAR_WEIGHTS = vec3(0.25, 0.75, 0.0);
const vec3 GAUSSIAN_WEIGHTS = vec3(0.569782825, 0.939413063, 0.209611387); // exp(-d^2)

vec4 average_rays(int kind, ivec2 half_pixel, int nearest, float center_depth_m, bool is_center_sky)
{
    bool by_depth = kind == RT_FALLBACK_BILATERAL;
    vec4 sum = vec4(0.0);
    float total = 0.0;
    [[unroll]] for (int i = 0; i < 9; i++) {
        ivec2 at = 1 + AROUND[i] * (1 - 2 * (half_pixel & 1));
        float weight = by_depth ? GAUSSIAN_WEIGHTS[at.x] * GAUSSIAN_WEIGHTS[at.y] /
                                      (depth_difference_m(center_depth_m, i) +
                                       setting(RT_UPSCALE_TOLERANCE_M))
                                : LINEAR_WEIGHTS[at.x] * LINEAR_WEIGHTS[at.y];
        if (!ray_at(i).is_usable || weight == 0.0 ||
            (by_depth && ray_at(i).is_sky != is_center_sky))
            continue;
        sum += weight * ray_at(i).value;
        total += weight;
    }
    return total > 0.0 ? sum / total : ray_value(nearest);
}

vec4 fallback(int kind, ivec2 half_pixel, int nearest, float center_depth_m, bool is_center_sky)
{
    int around = kind == RT_FALLBACK_AROUND ? nearest_ray(center_depth_m, 1) : -1;
    if (kind == RT_FALLBACK_BILINEAR || kind == RT_FALLBACK_BILATERAL)
        return average_rays(kind, half_pixel, nearest, center_depth_m, is_center_sky);
    if (kind == RT_FALLBACK_TILE && ray_at(0).is_usable)
        return ray_at(0).value;
    return ray_value(around < 0 ? nearest : around);
}

// --- the result ---------------------------------------------------------------------------------

// Valid values stay valid as halves.
float limit_to_format(float value)
{
    bool is_too_large = choice(RT_TARGET_FORMAT) == RT_FORMAT_HALF && checks_validity() &&
                        value > HALF_MAX;
    return is_too_large ? HALF_MAX : value;
}

void put_result(ivec2 half_pixel, vec4 value, float age, float distance_m)
{
    for (int c = 0; c < 4; c++)
        value[c] = limit_to_format(value[c]);
    put_half(RT_HISTORY, half_pixel, value);
    put_half(RT_HISTORY_STATE, half_pixel, vec4(age, limit_to_format(distance_m), 0.0, 0.0));
}

// --- a texel ------------------------------------------------------------------------------------

struct Texel {
    ivec2 half_pixel, tile;
    float depth_m;    // of the scene
    float compared_m; // as depths of rays are stored
    int nearest;      // of the rays around in depth; -1: none is usable
    bool is_fresh;    // this frame's ray passes through it
};

Texel texel_at(ivec2 half_pixel)
{
    Texel texel;
    texel.half_pixel = half_pixel;
    texel.tile = half_pixel / 2;
    texel.depth_m = fetch_half(RT_HALF_DEPTH, half_pixel).x;
    texel.compared_m = choice(RT_CLAMP_PIXEL_DEPTH) != 0 ? stored_depth_m(texel.depth_m)
                       : is_sky(texel.depth_m)           ? setting(RT_SKY_M)
                                                         : texel.depth_m;
    texel.nearest = nearest_ray(texel.compared_m, 0);
    texel.is_fresh = ray_at(0).is_usable &&
                     int(fetch_tile(RT_TILE, texel.tile).x) == find_slot(half_pixel);
    return texel;
}

// Where the gradient pass is skipped its samples are stored here.
void keep_ray(ivec2 half_pixel)
{
    ivec2 kept_texel = 2 * (half_pixel / 2) + kept_place();
    if (is_unchanged() && (is_output_elided() || half_pixel == kept_texel))
        put_half(RT_KEPT_RAY, kept_texel, as_halves(ray_at(0).value));
}

// Distance of the medium that a texel shows [m].
float medium_distance_m(Texel texel)
{
    bool uses_tile_ray = choice(RT_REPROJECT_DEPTH) == RT_REPROJECT_TILE && ray_at(0).is_usable;
    return fetch_tile(RT_RAY_DISTANCE, ray_tile(texel.tile, uses_tile_ray ? 0 : texel.nearest)).x;
}

// Applies the gain of the light to history and clamps it, as far as motion or change requires.
// Returns the share of its age that counts.
float adapt_history(Texel texel, inout History history)
{
    float part = 1.0;
    history.value.rgb = relight(history.value.rgb, texel.tile, history.motion_px);
    float share = clamp_share(history.motion_px, texel.tile, texel.nearest);
    if (share > 0.0) {
        vec4 clamped = clamp_to_rays(history.value, texel.nearest, texel.compared_m,
                                     is_sky(texel.depth_m));
        if (clamped.rgb != history.value.rgb)
            part = 1.0 - share * (1.0 - setting(RT_BOX_AGE));
        if (clamped != history.value)
            history.value = blend(history.value, clamped, share);
    }
    history.age = age_after_change(texel.tile, texel.is_fresh, history.age);
    return part;
}

// --- the oracle -------------------------------------------------------------------------------

// The texel's own ray (ray_march/ray_march.comp), in place of which its result is written.
vec4 fetch_own_ray(ivec2 half_pixel) { return fetch_half(RT_HISTORY, half_pixel); }

void put_own_ray(ivec2 half_pixel)
{
    put_result(half_pixel, fetch_own_ray(half_pixel), 1.0,
               fetch_half(RT_HISTORY_STATE, half_pixel).y);
}

const int ORACLE_DISTANCES = 64;
const float ORACLE_NEAREST_M = 1.0, ORACLE_RATIO = 1.2; // up to 97 km; the last is infinite

// The distance at which valid history differs least from the texel's own ray; the medium's distance
// if no other is better.
float find_best_distance_m(Texel texel, float distance_m, bool is_exact)
{
    vec4 own = fetch_own_ray(texel.half_pixel);
    History history = find_history(texel.half_pixel, texel.depth_m, distance_m, is_exact);
    if (is_static() || history.is_invalid)
        return distance_m;
    float best_m = distance_m, least = measure_change(own, history.value);
    float asked_m = ORACLE_NEAREST_M;
    for (int i = 0; i < ORACLE_DISTANCES; i++, asked_m *= ORACLE_RATIO) {
        float candidate_m = i < ORACLE_DISTANCES - 1 ? asked_m : FAR_M;
        history = find_history(texel.half_pixel, texel.depth_m, candidate_m, is_exact);
        float change = measure_change(own, history.value);
        if (!history.is_invalid && change < least) {
            best_m = candidate_m;
            least = change;
        }
    }
    return best_m;
}

// Reconstructs a texel; the rays around are loaded.
void reconstruct(ivec2 half_pixel)
{
    keep_ray(half_pixel);
    Texel texel = texel_at(half_pixel);
    if (texel.nearest < 0) {
        put_result(half_pixel, vec4(0.0, 0.0, 0.0, 1.0), 0.0, FAR_M);
        return;
    }
    bool is_exact = choice(RT_ORACLE_DEPTH) != 0;
    float distance_m = medium_distance_m(texel), before_m = distance_m;
    if (choice(RT_ORACLE_MOTION) != 0)
        before_m = find_best_distance_m(texel, distance_m, is_exact);
    History history = find_history(half_pixel, texel.depth_m, before_m, is_exact);
    if (choice(RT_ORACLE_RAYS) != 0 || (is_exact && history.is_invalid && !texel.is_fresh)) {
        put_own_ray(half_pixel);
        return;
    }
    float part = history.is_invalid ? 1.0 : adapt_history(texel, history);
    float age = history.is_invalid ? 1.0 : history.age;
    vec4 value = ray_value(texel.is_fresh ? 0 : texel.nearest);
    if (texel.is_fresh && !history.is_invalid) {
        age = IS_DARK ? AGE_MAX : min(history.age + 1.0, AGE_MAX);
        value = blend_fresh(history.value, value, IS_DARK ? 1.0 : fresh_weight(age, part));
    } else if (!history.is_invalid) {
        if (is_set(RT_HISTORY_AGE_MAX) && part < 1.0)
            age = max(part * min(age, setting(RT_HISTORY_AGE_MAX)), 1.0);
        value = blend(value, history.value, setting(RT_HISTORY_WEIGHT));
    } else if (!texel.is_fresh) {
        int kind = history.is_rejected ? choice(RT_FALLBACK_REJECTED) : choice(RT_FALLBACK);
        value = fallback(kind, half_pixel, texel.nearest, texel.compared_m, is_sky(texel.depth_m));
    }
    put_result(half_pixel, value, age, known_distance_m(distance_m));
}

#endif
