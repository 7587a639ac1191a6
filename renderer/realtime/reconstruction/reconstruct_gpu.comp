#version 450
// SPDX-License-Identifier: MIT
//
// The reconstruction (reconstruct.comp) for a GPU: work groups of 16x4 texels.
//
// - The rays of a group's tiles and of the tiles around them are loaded once, into shared memory.
// - The group computes the changes around its tiles, in place of the pass "change": one half of its
//   threads, a subgroup or two, computes changes of the medium, the other half those behind it.
#extension GL_GOOGLE_include_directive : require

#include "reconstruct.glsl"
#include "renderer/realtime/gradient/change_around_gpu.glsl"
#include "renderer/realtime/shared/pass.glsl"

const ivec2 BLOCK = ivec2(RT_TEXEL_BLOCK_WIDTH, RT_TEXEL_BLOCK_HEIGHT);
const ivec2 BLOCK_TILES = BLOCK / 2, AREA = BLOCK_TILES + 2; // with the tiles around
const int BLOCK_TILE_COUNT = BLOCK_TILES.x * BLOCK_TILES.y, AREA_COUNT = AREA.x * AREA.y;

// --- rays around ------------------------------------------------------------------------------

shared vec4 area_values[AREA_COUNT];
shared vec2 area_rays[AREA_COUNT]; // depth [m]; 1: usable, 2: usable and of the sky
ivec2 place_in_area;               // of this thread's tile

// Run by all threads of a group.
void load_area(ivec2 first_tile)
{
    for (int i = int(gl_LocalInvocationID.x); i < AREA_COUNT; i += GROUP_THREADS) {
        ivec2 tile = first_tile - 1 + ivec2(i % AREA.x, i / AREA.x);
        Ray ray = load_ray(clamp(tile, ivec2(0), tile_count() - 1), 0);
        area_values[i] = ray.value;
        area_rays[i] = vec2(ray.depth_m, !ray.is_usable ? 0.0 : ray.is_sky ? 2.0 : 1.0);
    }
}

int area_index(int ray)
{
    ivec2 at = place_in_area + AROUND[ray];
    return at.x + AREA.x * at.y;
}

Ray ray_at(int i)
{
    vec2 known = area_rays[area_index(i)];
    return Ray(area_values[area_index(i)], known.x, known.y > 0.0, known.y > 1.0);
}

vec4 ray_value(int ray) { return area_values[area_index(ray)]; }

// --- changes around ---------------------------------------------------------------------------

shared vec4 area_changes[BLOCK_TILE_COUNT];
shared vec4 area_samples[4 * AREA_COUNT]; // RT_SAMPLE_NOW and the three targets after it
ivec2 area_corner;                        // the first tile of the area

bool finds_change()
{
    return choice(RT_CHANGE_PASS) == RT_CHANGE_PASS_RECONSTRUCTION && !is_unchanged();
}

// Run by all threads of a group, before find_changes().
void load_samples()
{
    for (int i = int(gl_LocalInvocationID.x); i < AREA_COUNT; i += GROUP_THREADS) {
        ivec2 tile = area_corner + ivec2(i % AREA.x, i / AREA.x);
        area_samples[i] = fetch_tile(RT_SAMPLE_NOW, tile);
        area_samples[i + AREA_COUNT] = fetch_tile(RT_SAMPLE_THEN, tile);
        area_samples[i + 2 * AREA_COUNT] = fetch_tile(RT_SAMPLE_BEHIND_NOW, tile);
        area_samples[i + 3 * AREA_COUNT] = fetch_tile(RT_SAMPLE_BEHIND_THEN, tile);
    }
}

vec4 load_sample(int target, ivec2 tile)
{
    ivec2 at = tile - area_corner;
    return area_samples[(target - RT_SAMPLE_NOW) * AREA_COUNT + at.x + AREA.x * at.y];
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
        vec4 change = compute_medium_change(tile);
        area_changes[i] = change;
        if (is_there)
            put_tile(RT_CHANGE, tile, change);
    } else if (is_there) {
        put_tile(RT_CHANGE_BEHIND, tile, change_behind(tile));
    }
}

Change change_around_tile(ivec2 tile)
{
    if (!finds_change())
        return load_change(RT_CHANGE, tile);
    ivec2 at = place_in_area - 1;
    vec4 change = area_changes[at.x + BLOCK_TILES.x * at.y];
    return Change(change.rgb, change.a);
}

// --- the group --------------------------------------------------------------------------------

void main()
{
    ivec2 block = find_block(half_size(), BLOCK);
    int thread = int(gl_LocalInvocationID.x);
    ivec2 half_pixel = block + ivec2(thread % BLOCK.x, thread / BLOCK.x);
    place_in_area = half_pixel / 2 - block / 2 + 1;
    area_corner = block / 2 - 1;
    load_area(block / 2);
    if (finds_change())
        load_samples();
    barrier();
    if (finds_change())
        find_changes(block / 2);
    barrier();
    if (all(lessThan(half_pixel, half_size())))
        reconstruct(half_pixel);
}
