#version 450
// SPDX-License-Identifier: MIT
//
// The reconstruction: the medium at half resolution, from this frame's rays, one for every four
// texels, and the frame before.
//
// A half-resolution texel (half_pixel) that has a ray in this frame takes it, all of it
// (fresh_weight = 1) or blended with its history. The others take their history, looked up where
// the medium was in the frame before, and held in the box of those rays of the 3x3 tiles around
// that are as deep as they: the neighbourhood clamp. Without history they take the ray that is
// nearest in depth.
//
// What the settings keep of the article's faults:
// - box_centre = off: the tile's own ray is left out of the clamping box.
// - box_least = 0: a box of one ray erases the history.
// - edge_tiles = dropped: neighbours end one tile early in sizes that are no multiple of 4.
// - gather = normalised: the depths of six neighbours are found by normalised coordinates, which in
//   such sizes come to the next tile after two thirds of the image.
// - clamp_pixel_depth = off: the texel's own depth is not limited as the rays' are; from halfway
//   between ray_depth_max_m and sky_m on geometry takes the sky's clouds.
// - reproject_depth = tile, reproject_measure = eye: the distance of the tile's ray stands for that
//   of the texel's cloud, and for an eye depth.
// - wind = off, validity = off: history does not follow the wind, and nothing is ever void.
// The article's weight of 0.5 for a fresh ray stands behind its return and is never reached. The
// sky's depth is sky_m here with `far` = infinite too: the article says 20 km at this place.
//
// Void is what validity = on does not use: rays that are not finite or negative, history of age 0,
// history that is not sound; disocclusion (reject_depth) is in realtime_history.glsl. Off the
// screen, behind the camera and after a cut (cut_reset) there is no history with validity = off
// either; in the first frame there is then what the memory holds. The age counts the rays that went
// into a texel; one that borrowed its first value from a neighbour's ray is 1 old.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

#include "realtime_change.glsl"
#include "realtime_pass.glsl"
#include "realtime_history.glsl"

const float AGE_MAX = 255.0;

struct Ray {
    vec4 value;    // radiance of the medium in W/(m2 sr), transmittance
    float depth_m; // of the scene, where the ray ends
    bool is_usable;
    bool is_sky; // known where somebody asks
    bool is_in_box;
};

Ray rays[9]; // of the tiles around, in the order in which ties are decided

const ivec2 AROUND[9] = ivec2[9](ivec2(0, 0), ivec2(1, 0), ivec2(-1, 0), ivec2(0, 1), ivec2(0, -1),
                                 ivec2(1, 1), ivec2(-1, 1), ivec2(1, -1), ivec2(-1, -1));

ivec2 ray_tile(ivec2 tile, int ray)
{
    ivec2 last = choice(RT_EDGE_TILES) == RT_EDGE_TILES_KEPT ? tile_count() - 1
                                                             : max(view_size() / 4 - 1, ivec2(0));
    return ray == 0 ? tile : clamp(tile + AROUND[ray], ivec2(0), last);
}

// Where the article finds the depth of the six neighbours whose offsets do not sum to 0: by two
// gathers of 2x2 texels, about the upper left and the lower right corner of the tile, at
// (4 * corner + origin) / buffer size of a buffer of a quarter of that size, rounded up. In whole
// numbers; the last bit of a coordinate is the device's own.
ivec2 gathered_texel(ivec2 tile, ivec2 offset)
{
    int corner = offset.x + offset.y > 0 ? 1 : 0;
    ivec2 size = target_size(RT_DEPTH), size_quarter = target_size(RT_TILE);
    ivec2 found = (2 * (4 * (tile + corner) + view_origin()) * size_quarter + size) / (2 * size);
    return clamp(found - corner + offset, ivec2(0), size_quarter - 1);
}

// The half-resolution texel that a tile's ray goes through.
ivec2 ray_half_pixel(ivec2 tile)
{
    return min(2 * tile + slot_place(int(fetch_tile(RT_TILE, tile).x)), half_size() - 1);
}

bool asks_for_kinds()
{
    return choice(RT_BOX_SAME_KIND) != 0 || choice(RT_FALLBACK) == RT_FALLBACK_BILATERAL ||
           choice(RT_FALLBACK_REJECTED) == RT_FALLBACK_BILATERAL;
}

float ray_depth_m(ivec2 tile, int ray)
{
    ivec2 offset = AROUND[ray];
    bool is_gathered = choice(RT_GATHER) == RT_GATHER_NORMALISED && offset.x + offset.y != 0;
    precise float depth_m = TILE_UNIT_M * (is_gathered
                                               ? fetch(RT_TILE, gathered_texel(tile, offset)).y
                                               : fetch_tile(RT_TILE, ray_tile(tile, ray)).y);
    return depth_m;
}

void load_rays(ivec2 tile)
{
    [[unroll]] for (int i = 0; i < 9; i++) {
        rays[i].value = fetch_tile(RT_RAY, ray_tile(tile, i));
        rays[i].depth_m = ray_depth_m(tile, i);
        rays[i].is_usable = !checks_validity() || is_sound(rays[i].value);
        rays[i].is_sky = asks_for_kinds() &&
                         is_sky(fetch_half(RT_HALF_DEPTH, ray_half_pixel(ray_tile(tile, i))).x);
    }
}

// A choice among known rays is cheaper than an index into memory.
vec4 value_of(int ray)
{
    vec4 value = rays[0].value;
    [[unroll]] for (int i = 1; i < 9; i++)
        if (i == ray)
            value = rays[i].value;
    return value;
}

float depth_difference_m(float own_m, int ray)
{
    precise float difference_m = abs(own_m - rays[ray].depth_m);
    return difference_m;
}

// The ray nearest in depth of those from `first` on, of equal ones the first; -1 if none can be
// used. The article looks no farther than 20 km, which is as far apart as limited depths can be,
// and there keeps to the first.
int nearest_ray(float own_m, int first)
{
    float least_m = choice(RT_CLAMP_PIXEL_DEPTH) != 0 ? FAR_M : setting(RT_SKY_M);
    int nearest = -1;
    [[unroll]] for (int i = 0; i < 9; i++) {
        if (i < first || !rays[i].is_usable)
            continue;
        float difference_m = depth_difference_m(own_m, i);
        if (difference_m < least_m || nearest < 0)
            nearest = i;
        if (difference_m < least_m)
            least_m = difference_m;
    }
    return nearest;
}

const float OPACITY_LEAST = 1e-6; // c52e's, against 0 / 0

bool is_alike(float transmittance, float other)
{
    precise float difference = abs(transmittance - other);
    precise float opacity = 1.0 - (transmittance > other ? transmittance : other);
    precise float allowed = setting(RT_BOX_TRANSMITTANCE) *
                            (choice(RT_CONTRAST) == RT_CONTRAST_TRANSMITTANCE ? 1.0
                             : opacity > OPACITY_LEAST                        ? opacity
                                                                              : OPACITY_LEAST);
    return difference < allowed;
}

bool is_accepted(int ray, int nearest, float nearest_through, float own_m, bool own_is_sky)
{
    precise float allowed_m = setting(RT_BOX_DEPTH) * rays[ray].depth_m;
    bool is_candidate = rays[ray].is_usable && (ray != 0 || choice(RT_BOX_CENTRE) != 0) &&
                        (choice(RT_BOX_SAME_KIND) == 0 || rays[ray].is_sky == own_is_sky);
    return ray == nearest ||
           (is_candidate && (depth_difference_m(own_m, ray) < allowed_m ||
                             is_alike(rays[ray].value.a, nearest_through)));
}

void choose_rays(int nearest, float nearest_through, float own_m, bool own_is_sky)
{
    int count = 0;
    [[unroll]] for (int i = 0; i < 9; i++) {
        rays[i].is_in_box = is_accepted(i, nearest, nearest_through, own_m, own_is_sky);
        count += int(rays[i].is_in_box);
    }
    if (count < int(setting(RT_BOX_LEAST)))
        [[unroll]] for (int i = 0; i < 9; i++)
            rays[i].is_in_box = rays[i].is_usable;
}

void extend_by_rays(inout Box box, int space)
{
    [[unroll]] for (int i = 0; i < 9; i++)
        if (rays[i].is_in_box)
            extend(box, to_space(space, rays[i].value));
}

void extend_by_variance(inout Box box, int space)
{
    float count = 0.0;
    vec4 mean = vec4(0.0), variance = vec4(0.0);
    [[unroll]] for (int i = 0; i < 9; i++)
        if (rays[i].is_in_box) {
            count += 1.0;
            mean += to_space(space, rays[i].value);
        }
    mean /= count;
    [[unroll]] for (int i = 0; i < 9; i++)
        if (rays[i].is_in_box) {
            vec4 difference = to_space(space, rays[i].value) - mean;
            variance += difference * difference;
        }
    vec4 half_width = setting(RT_BOX_SIGMA) * sqrt(variance / count);
    extend(box, mean - half_width);
    extend(box, mean + half_width);
}

vec4 held_among_rays(vec4 value, int nearest, float own_m, bool own_is_sky)
{
    if (choice(RT_BOX) == RT_BOX_NONE)
        return value;
    int space = choice(RT_BOX_SPACE);
    vec4 nearest_value = value_of(nearest), first = to_space(space, nearest_value);
    Box box = Box(first, first);
    choose_rays(nearest, nearest_value.a, own_m, own_is_sky);
    if (choice(RT_BOX) == RT_BOX_MIN_MAX)
        extend_by_rays(box, space);
    else
        extend_by_variance(box, space);
    return held_in_space(space, value, nearest_value, box);
}

// By how much the nearest ray differs from the history of its own texel: luminance relative to the
// larger, or transmittance. This is the temporal gradient of C. Schied, C. Peters, C. Dachsbacher,
// "Gradient Estimation for Real-Time Adaptive Temporal Filtering", HPG 2018. The split of the frame
// has one for free in each tile.
float change_at_ray(ivec2 tile, int ray)
{
    ivec2 own_tile = ray_tile(tile, ray);
    ivec2 place = ray_half_pixel(own_tile);
    History then = history_of(place, fetch_half(RT_HALF_DEPTH, place).x,
                              fetch_tile(RT_RAY_DISTANCE, own_tile).x);
    vec4 now = value_of(ray);
    float now_luminance = luminance(now.rgb);
    float then_luminance = luminance(then.value.rgb);
    float most = max(now_luminance, then_luminance);
    float change = most > 0.0 ? abs(now_luminance - then_luminance) / most : 0.0;
    return then.is_void ? 1.0 : max(change, abs(now.a - then.value.a));
}

// With gradient = on it is had without noise (rt_gradient.comp).
float change_at(ivec2 tile, int nearest)
{
    return choice(RT_GRADIENT) != 0 ? change_of(RT_CHANGE, tile).residue
                                    : change_at_ray(tile, nearest);
}

// What has changed by box_change is no older than this frame, and of what changes slowly no more
// rays count than see it change by that.
float age_after_change(ivec2 tile, bool is_fresh, float age)
{
    if (choice(RT_GRADIENT) == 0)
        return age;
    float change = change_of(RT_CHANGE, tile).residue;
    float unchanged = 1.0 - beyond(change, setting(RT_BOX_CHANGE));
    age = min(unchanged * age, lasting(change, setting(RT_BOX_CHANGE)));
    return max(age, is_fresh ? 0.0 : 1.0);
}

// Where it rests history has the light of this frame: what that has been multiplied with since the
// frame before.
vec3 relit(vec3 radiance, ivec2 tile, float motion_px)
{
    if (choice(RT_GRADIENT) == 0 || !is_set(RT_RELIGHT))
        return radiance;
    vec3 gain = change_of(RT_CHANGE, tile).gain;
    return mix(gain, vec3(1.0), beyond(motion_px, setting(RT_BOX_MOTION_PX))) * radiance;
}

// How much of the neighbourhood clamp applies, 0..1. What is at rest and in unchanged light needs
// none: it would only let the depths that this frame's rays happen to have flicker through it.
float box_share(float motion_px, ivec2 tile, int nearest)
{
    float share = beyond(motion_px, setting(RT_BOX_MOTION_PX));
    if (share < 1.0)
        share = max(share, beyond(change_at(tile, nearest), setting(RT_BOX_CHANGE)));
    return share;
}

// At a weight of 0 or 1 the value itself, whatever the other one is (a NaN, say).
vec4 blend(vec4 a, vec4 b, float weight_of_b)
{
    if (weight_of_b == 0.0 || weight_of_b == 1.0)
        return weight_of_b == 0.0 ? a : b;
    return a + weight_of_b * (b - a);
}

// Weight of a fresh ray; `part` of the history's age counts (box_age).
float fresh_weight(float age, float part)
{
    if (!is_set(RT_HISTORY_AGE_MAX))
        return setting(RT_FRESH_WEIGHT);
    float of_history = 1.0 - 1.0 / min(age, setting(RT_HISTORY_AGE_MAX));
    return 1.0 - part * setting(RT_HISTORY_FADE) * of_history;
}

// History and ray are blended in fresh_space.
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

// Weights of the tile before, of the texel's own and of the one after along one axis. A texel lies
// a quarter of a tile from its tile's centre towards the one before; the other kind is mirrored.
const vec3 LINEAR_WEIGHTS = vec3(0.25, 0.75, 0.0);
const vec3 GAUSSIAN_WEIGHTS = vec3(0.569782825, 0.939413063, 0.209611387); // exp(-d^2)

vec4 mean_of_rays(int kind, ivec2 half_pixel, int nearest, float own_m, bool own_is_sky)
{
    bool by_depth = kind == RT_FALLBACK_BILATERAL;
    vec4 sum = vec4(0.0);
    float total = 0.0;
    [[unroll]] for (int i = 0; i < 9; i++) {
        ivec2 at = 1 + AROUND[i] * (1 - 2 * (half_pixel & 1));
        float weight = by_depth ? GAUSSIAN_WEIGHTS[at.x] * GAUSSIAN_WEIGHTS[at.y] /
                                      (depth_difference_m(own_m, i) +
                                       setting(RT_UPSCALE_TOLERANCE_M))
                                : LINEAR_WEIGHTS[at.x] * LINEAR_WEIGHTS[at.y];
        if (!rays[i].is_usable || weight == 0.0 || (by_depth && rays[i].is_sky != own_is_sky))
            continue;
        sum += weight * rays[i].value;
        total += weight;
    }
    return total > 0.0 ? sum / total : value_of(nearest);
}

vec4 stand_in(int kind, ivec2 half_pixel, int nearest, float own_m, bool own_is_sky)
{
    int around = kind == RT_FALLBACK_AROUND ? nearest_ray(own_m, 1) : -1;
    if (kind == RT_FALLBACK_BILINEAR || kind == RT_FALLBACK_BILATERAL)
        return mean_of_rays(kind, half_pixel, nearest, own_m, own_is_sky);
    if (kind == RT_FALLBACK_TILE && rays[0].is_usable)
        return rays[0].value;
    return value_of(around < 0 ? nearest : around);
}

// --- the result ---------------------------------------------------------------------------------

// Sound values stay sound when they are kept in halves.
float kept(int format_setting, float value)
{
    bool is_too_large = choice(format_setting) == RT_FORMAT_HALF && checks_validity() &&
                        value > HALF_MAX;
    return is_too_large ? HALF_MAX : value;
}

void put_result(ivec2 half_pixel, vec4 value, float age, float distance_m)
{
    for (int c = 0; c < 4; c++)
        value[c] = kept(RT_COLOR_FORMAT, value[c]);
    put_half(RT_HISTORY, half_pixel, value);
    put_half(RT_HISTORY_STATE, half_pixel, vec4(age, kept(RT_DEPTH_FORMAT, distance_m), 0.0, 0.0));
}

void main()
{
    ivec2 half_pixel;
    if (!own_element(half_size(), half_pixel))
        return;
    ivec2 tile = half_pixel / 2;
    is_at_rest = history_rests();
    load_rays(tile);
    float depth_m = fetch_half(RT_HALF_DEPTH, half_pixel).x;
    float own_m = choice(RT_CLAMP_PIXEL_DEPTH) != 0 ? stored_depth_m(depth_m)
                  : is_sky(depth_m)                 ? setting(RT_SKY_M)
                                                    : depth_m;
    int nearest = nearest_ray(own_m, 0);
    if (nearest < 0) {
        put_result(half_pixel, vec4(0.0, 0.0, 0.0, 1.0), 0.0, FAR_M);
        return;
    }
    bool of_tile = choice(RT_REPROJECT_DEPTH) == RT_REPROJECT_TILE && rays[0].is_usable;
    float distance_m = fetch_tile(RT_RAY_DISTANCE, ray_tile(tile, of_tile ? 0 : nearest)).x;
    bool is_fresh = rays[0].is_usable && int(fetch_tile(RT_TILE, tile).x) == slot_of(half_pixel);
    History history = history_of(half_pixel, depth_m, distance_m);
    float part = 1.0; // of its age that counts
    if (!history.is_void) {
        history.value.rgb = relit(history.value.rgb, tile, history.motion_px);
        vec4 boxed = held_among_rays(history.value, nearest, own_m, is_sky(depth_m));
        if (boxed != history.value) {
            float share = box_share(history.motion_px, tile, nearest);
            if (boxed.rgb != history.value.rgb)
                part = 1.0 - share * (1.0 - setting(RT_BOX_AGE));
            history.value = blend(history.value, boxed, share);
        }
        history.age = age_after_change(tile, is_fresh, history.age);
    }

    float age = history.is_void ? 1.0 : history.age;
    vec4 value = value_of(is_fresh ? 0 : nearest);
    if (is_fresh && !history.is_void) {
        age = min(history.age + 1.0, AGE_MAX);
        value = blend_fresh(history.value, value, fresh_weight(age, part));
    } else if (!history.is_void) {
        if (is_set(RT_HISTORY_AGE_MAX) && part < 1.0)
            age = max(part * min(age, setting(RT_HISTORY_AGE_MAX)), 1.0);
        value = blend(value, history.value, setting(RT_HISTORY_WEIGHT));
    } else if (!is_fresh) {
        int kind = history.is_rejected ? choice(RT_FALLBACK_REJECTED) : choice(RT_FALLBACK);
        value = stand_in(kind, half_pixel, nearest, own_m, is_sky(depth_m));
    }
    put_result(half_pixel, value, age, known_distance_m(distance_m));
}
