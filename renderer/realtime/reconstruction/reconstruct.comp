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
// - a box of one ray erases the history.
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

#include "renderer/realtime/gradient/change.glsl"
#include "renderer/realtime/gradient/change_around.glsl"
#include "renderer/realtime/shared/pass.glsl"
#include "history.glsl"

const float AGE_MAX = 255.0;

// A ray that sees transmittance alone has no noise: it is worth as much as all that went before it.
layout(constant_id = RT_DARK_CONSTANT) const bool IS_DARK = false;

struct Ray {
    vec4 value;    // radiance of the medium in W/(m2 sr), transmittance
    float depth_m; // of the scene, where the ray ends
    bool is_usable;
    bool is_sky; // known where somebody asks
};

Ray rays[9]; // of the tiles around, in the order in which ties are decided; elsewhere in the area
bool in_box[9];

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
ivec2 ray_half_pixel(ivec2 tile, float slot)
{
    return min(2 * tile + slot_place(int(slot)), half_size() - 1);
}

ivec2 ray_half_pixel(ivec2 tile) { return ray_half_pixel(tile, fetch_tile(RT_TILE, tile).x); }

bool asks_for_kinds()
{
    return choice(RT_BOX_SAME_KIND) != 0 || choice(RT_FALLBACK) == RT_FALLBACK_BILATERAL ||
           choice(RT_FALLBACK_REJECTED) == RT_FALLBACK_BILATERAL;
}

// `found`: what the tile index has of it.
float ray_depth_m(ivec2 tile, int ray, vec4 found)
{
    ivec2 offset = AROUND[ray];
    bool is_gathered = choice(RT_GATHER) == RT_GATHER_NORMALISED && offset.x + offset.y != 0;
    precise float depth_m = TILE_UNIT_M * (is_gathered
                                               ? fetch(RT_TILE, gathered_texel(tile, offset)).y
                                               : found.y);
    return depth_m;
}

Ray load_ray(ivec2 tile, int i)
{
    ivec2 from = ray_tile(tile, i);
    vec4 found = fetch_tile(RT_TILE, from);
    Ray ray;
    ray.value = fetch_tile(RT_RAY, from);
    ray.depth_m = ray_depth_m(tile, i, found);
    ray.is_usable = !checks_validity() || is_sound(ray.value);
    ray.is_sky = asks_for_kinds() &&
                 is_sky(fetch_half(RT_HALF_DEPTH, ray_half_pixel(from, found.x)).x);
    return ray;
}

void load_rays(ivec2 tile)
{
    [[unroll]] for (int i = 0; i < 9; i++)
        rays[i] = load_ray(tile, i);
}

// On a GPU a work group makes a block of texels. Its rays and those around are fetched once, into
// shared memory, where a ray can be picked by its number, too.
const ivec2 BLOCK = ivec2(RT_TEXEL_BLOCK_WIDTH, RT_TEXEL_BLOCK_HEIGHT);
const ivec2 BLOCK_TILES = BLOCK / 2, AREA = BLOCK_TILES + 2;
shared vec4 area_values[AREA.x * AREA.y];
shared vec2 area_rays[AREA.x * AREA.y]; // depth [m]; 1: usable, 2: that and of the sky
ivec2 own_place; // of this thread's tile in the area

// Not by who looks for neighbours where there are none.
bool shares_rays()
{
    return ON_GPU && choice(RT_EDGE_TILES) == RT_EDGE_TILES_KEPT &&
           choice(RT_GATHER) == RT_GATHER_TEXEL;
}

// By all threads of a group.
void fetch_area(ivec2 first_tile)
{
    for (int i = int(gl_LocalInvocationID.x); i < AREA.x * AREA.y; i += GROUP_THREADS) {
        ivec2 tile = first_tile - 1 + ivec2(i % AREA.x, i / AREA.x);
        Ray ray = load_ray(clamp(tile, ivec2(0), tile_count() - 1), 0);
        area_values[i] = ray.value;
        area_rays[i] = vec2(ray.depth_m, !ray.is_usable ? 0.0 : ray.is_sky ? 2.0 : 1.0);
    }
}

int area_index(int i)
{
    ivec2 at = own_place + AROUND[i];
    return at.x + AREA.x * at.y;
}

Ray ray_at(int i)
{
    if (!shares_rays())
        return rays[i];
    vec2 known = area_rays[area_index(i)];
    return Ray(area_values[area_index(i)], known.x, known.y > 0.0, known.y > 1.0);
}

// A choice among known rays is cheaper than an index into memory.
vec4 value_of(int ray)
{
    if (shares_rays())
        return area_values[area_index(ray)];
    vec4 value = rays[0].value;
    [[unroll]] for (int i = 1; i < 9; i++)
        if (i == ray)
            value = rays[i].value;
    return value;
}

float depth_difference_m(float own_m, int ray)
{
    precise float difference_m = abs(own_m - ray_at(ray).depth_m);
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
        if (i < first || !ray_at(i).is_usable)
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
    precise float allowed_m = setting(RT_BOX_DEPTH) * ray_at(ray).depth_m;
    bool is_candidate = ray_at(ray).is_usable && (ray != 0 || choice(RT_BOX_CENTRE) != 0) &&
                        (choice(RT_BOX_SAME_KIND) == 0 || ray_at(ray).is_sky == own_is_sky);
    return ray == nearest ||
           (is_candidate && (depth_difference_m(own_m, ray) < allowed_m ||
                             is_alike(ray_at(ray).value.a, nearest_through)));
}

void choose_rays(int nearest, float nearest_through, float own_m, bool own_is_sky)
{
    [[unroll]] for (int i = 0; i < 9; i++)
        in_box[i] = is_accepted(i, nearest, nearest_through, own_m, own_is_sky);
}

void extend_by_rays(inout Box box, int space)
{
    [[unroll]] for (int i = 0; i < 9; i++)
        if (in_box[i])
            extend(box, to_space(space, ray_at(i).value));
}

void extend_by_variance(inout Box box, int space)
{
    float count = 0.0;
    vec4 mean = vec4(0.0), variance = vec4(0.0);
    [[unroll]] for (int i = 0; i < 9; i++)
        if (in_box[i]) {
            count += 1.0;
            mean += to_space(space, ray_at(i).value);
        }
    mean /= count;
    [[unroll]] for (int i = 0; i < 9; i++)
        if (in_box[i]) {
            vec4 difference = to_space(space, ray_at(i).value) - mean;
            variance += difference * difference;
        }
    vec4 half_width = sqrt(variance / count);
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

// What has changed around a tile is found here where there is no pass for it: by a thread for each
// tile of the block, and for what is behind by one of the group's other half, which is another
// subgroup.
const int BLOCK_TILE_COUNT = BLOCK_TILES.x * BLOCK_TILES.y;
shared vec4 area_changes[BLOCK_TILE_COUNT];
shared vec4 area_looks[4 * AREA.x * AREA.y];
ivec2 area_corner; // its first tile

bool finds_change()
{
    return choice(RT_CHANGE_PASS) == RT_CHANGE_PASS_RECONSTRUCTION && !is_unchanged();
}

vec4 look_of(int target, ivec2 tile)
{
    ivec2 at = tile - area_corner;
    return area_looks[(target - RT_LOOK_NOW) * AREA.x * AREA.y + at.x + AREA.x * at.y];
}

// By all threads of a group, before the changes are found.
void fetch_looks()
{
    for (int i = int(gl_LocalInvocationID.x); i < AREA.x * AREA.y; i += GROUP_THREADS) {
        ivec2 tile = area_corner + ivec2(i % AREA.x, i / AREA.x);
        area_looks[i] = fetch_tile(RT_LOOK_NOW, tile);
        area_looks[i + AREA.x * AREA.y] = fetch_tile(RT_LOOK_THEN, tile);
        area_looks[i + 2 * AREA.x * AREA.y] = fetch_tile(RT_LOOK_BEHIND_NOW, tile);
        area_looks[i + 3 * AREA.x * AREA.y] = fetch_tile(RT_LOOK_BEHIND_THEN, tile);
    }
}

void find_changes(ivec2 first_tile)
{
    const int half_group = GROUP_THREADS / 2;
    int thread = int(gl_LocalInvocationID.x), i = thread % half_group;
    ivec2 tile = first_tile + ivec2(i % BLOCK_TILES.x, i / BLOCK_TILES.x);
    bool is_there = all(lessThan(tile, tile_count()));
    if (i >= BLOCK_TILE_COUNT)
        return;
    if (thread < half_group) {
        vec4 change = change_of_medium(tile);
        area_changes[i] = change;
        if (is_there)
            put_tile(RT_CHANGE, tile, change);
    } else if (is_there) {
        put_tile(RT_CHANGE_BEHIND, tile, change_behind(tile));
    }
}

Change known_change(ivec2 tile)
{
    if (!finds_change())
        return change_of(RT_CHANGE, tile);
    ivec2 at = own_place - 1;
    vec4 change = area_changes[at.x + BLOCK_TILES.x * at.y];
    return Change(change.rgb, change.a);
}

// With gradient = on it is had without noise (realtime/gradient/gradient.comp).
float change_at(ivec2 tile, int nearest)
{
    return choice(RT_GRADIENT) != 0 ? known_change(tile).residue
                                    : change_at_ray(tile, nearest);
}

// What has changed by box_change is no older than this frame, and of what changes slowly no more
// rays count than see it change by that.
float age_after_change(ivec2 tile, bool is_fresh, float age)
{
    if (choice(RT_GRADIENT) == 0)
        return age;
    float change = known_change(tile).residue;
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
    vec3 gain = known_change(tile).gain;
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

// Where no share of the box applies there is none, if that is known before: by a GPU from what has
// changed, elsewhere where nothing has. Else it is made anyhow, and the change asked for where the
// box has moved something alone.
bool may_be_boxed(float motion_px, ivec2 tile, int nearest)
{
    if (is_at_rest && is_unchanged() && is_set(RT_BOX_MOTION_PX) && is_set(RT_BOX_CHANGE))
        return false;
    return !ON_GPU || choice(RT_GRADIENT) == 0 || box_share(motion_px, tile, nearest) > 0.0;
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
        if (!ray_at(i).is_usable || weight == 0.0 || (by_depth && ray_at(i).is_sky != own_is_sky))
            continue;
        sum += weight * ray_at(i).value;
        total += weight;
    }
    return total > 0.0 ? sum / total : value_of(nearest);
}

vec4 stand_in(int kind, ivec2 half_pixel, int nearest, float own_m, bool own_is_sky)
{
    int around = kind == RT_FALLBACK_AROUND ? nearest_ray(own_m, 1) : -1;
    if (kind == RT_FALLBACK_BILINEAR || kind == RT_FALLBACK_BILATERAL)
        return mean_of_rays(kind, half_pixel, nearest, own_m, own_is_sky);
    if (kind == RT_FALLBACK_TILE && ray_at(0).is_usable)
        return ray_at(0).value;
    return value_of(around < 0 ? nearest : around);
}

// --- the result ---------------------------------------------------------------------------------

// Sound values stay sound when they are kept in halves.
float kept(float value)
{
    bool is_too_large = choice(RT_TARGET_FORMAT) == RT_FORMAT_HALF && checks_validity() &&
                        value > HALF_MAX;
    return is_too_large ? HALF_MAX : value;
}

void put_result(ivec2 half_pixel, vec4 value, float age, float distance_m)
{
    for (int c = 0; c < 4; c++)
        value[c] = kept(value[c]);
    put_half(RT_HISTORY, half_pixel, value);
    put_half(RT_HISTORY_STATE, half_pixel, vec4(age, kept(distance_m), 0.0, 0.0));
}

// That of a tile which has a ray in this frame. Where nothing changes the others stay as they are,
// in their place (renderer/realtime/unread.h).
bool own_fresh_texel(out ivec2 half_pixel)
{
    ivec2 tile;
    bool is_left = own_element(tile_count(), tile);
    half_pixel = ray_half_pixel(tile);
    return is_left;
}

// The texel of this thread; false when there is none left.
bool own_texel(out ivec2 half_pixel)
{
    if (is_unread())
        return own_fresh_texel(half_pixel);
    if (!ON_GPU)
        return own_element(half_size(), half_pixel);
    ivec2 block = own_block(half_size(), BLOCK);
    int thread = int(gl_LocalInvocationID.x);
    half_pixel = block + ivec2(thread % BLOCK.x, thread / BLOCK.x);
    own_place = half_pixel / 2 - block / 2 + 1;
    area_corner = block / 2 - 1;
    if (shares_rays())
        fetch_area(block / 2);
    if (finds_change())
        fetch_looks();
    barrier();
    if (finds_change())
        find_changes(block / 2);
    barrier();
    return all(lessThan(half_pixel, half_size()));
}

void main()
{
    ivec2 half_pixel;
    if (!own_texel(half_pixel))
        return;
    ivec2 tile = half_pixel / 2;
    is_at_rest = history_rests();
    if (!shares_rays())
        load_rays(tile);
    ivec2 kept_pixel = 2 * tile + kept_place();
    if (is_unchanged() && (is_unread() || half_pixel == kept_pixel))
        put_half(RT_KEPT_RAY, kept_pixel, kept(ray_at(0).value));
    float depth_m = fetch_half(RT_HALF_DEPTH, half_pixel).x;
    float own_m = choice(RT_CLAMP_PIXEL_DEPTH) != 0 ? stored_depth_m(depth_m)
                  : is_sky(depth_m)                 ? setting(RT_SKY_M)
                                                    : depth_m;
    int nearest = nearest_ray(own_m, 0);
    if (nearest < 0) {
        put_result(half_pixel, vec4(0.0, 0.0, 0.0, 1.0), 0.0, FAR_M);
        return;
    }
    bool of_tile = choice(RT_REPROJECT_DEPTH) == RT_REPROJECT_TILE && ray_at(0).is_usable;
    float distance_m = fetch_tile(RT_RAY_DISTANCE, ray_tile(tile, of_tile ? 0 : nearest)).x;
    bool is_fresh = ray_at(0).is_usable && int(fetch_tile(RT_TILE, tile).x) == slot_of(half_pixel);
    History history = history_of(half_pixel, depth_m, distance_m);
    float part = 1.0; // of its age that counts
    if (!history.is_void) {
        history.value.rgb = relit(history.value.rgb, tile, history.motion_px);
        if (may_be_boxed(history.motion_px, tile, nearest)) {
            vec4 boxed = held_among_rays(history.value, nearest, own_m, is_sky(depth_m));
            if (boxed != history.value) {
                float share = box_share(history.motion_px, tile, nearest);
                if (boxed.rgb != history.value.rgb)
                    part = 1.0 - share * (1.0 - setting(RT_BOX_AGE));
                history.value = blend(history.value, boxed, share);
            }
        }
        history.age = age_after_change(tile, is_fresh, history.age);
    }

    float age = history.is_void ? 1.0 : history.age;
    vec4 value = value_of(is_fresh ? 0 : nearest);
    if (is_fresh && !history.is_void) {
        age = IS_DARK ? AGE_MAX : min(history.age + 1.0, AGE_MAX);
        value = blend_fresh(history.value, value, IS_DARK ? 1.0 : fresh_weight(age, part));
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
