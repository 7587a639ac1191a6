/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/shared/check_reference.h"
#include "renderer/realtime/tile_index/check_reference_slots.h"

#include <math.h>

enum { COLOURS = 4 };

static int choice(const struct reference *cpu, int setting)
{
    return (int)cpu->view->settings[setting];
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

static float slot_depth_m(const struct reference *cpu, int x, int y, int slot,
                          const uint32_t origin_px[2])
{
    const struct neph_gpu_view *view = cpu->view;
    const struct neph_gpu_target *half = &view->targets[RT_HALF_DEPTH];
    const int *place = cpu_slot_place(view, slot);
    int half_x = 2 * x + place[0], half_y = 2 * y + place[1];
    if (choice(cpu, RT_GATHER) == RT_GATHER_TEXEL) {
        half_x = least(half_x, (int)view->half_size_px[0] - 1);
        half_y = least(half_y, (int)view->half_size_px[1] - 1);
    }
    half_x = least((int)origin_px[0] / 2 + half_x, (int)half->width - 1);
    half_y = least((int)origin_px[1] / 2 + half_y, (int)half->height - 1);
    float depth[4];
    cpu_fetch(cpu, RT_HALF_DEPTH, half_x, half_y, depth);
    return depth[0];
}

static float compared_depth_m(const struct reference *cpu, float depth_m)
{
    if (depth_m < NEPH_GPU_FAR_M)
        return depth_m;
    return choice(cpu, RT_FAR) == RT_FAR_INFINITE ? INFINITY : 1e6f;
}

static void tile_depths_m(const struct reference *cpu, int x, int y, float depths_m[4])
{
    static const uint32_t corner[2] = {0, 0};
    const bool forgets = choice(cpu, RT_TILE_ORIGIN) == RT_TILE_ORIGIN_BUFFER;
    for (int slot = 0; slot < 4; slot++)
        depths_m[slot] = slot_depth_m(cpu, x, y, slot, forgets ? corner : cpu->view->origin_px);
}

/* The slot of a tile near the tile (x, y) at this point of the algorithm. */
static int believed_slot(const struct reference *cpu, int x, int y)
{
    if (choice(cpu, RT_OVERRIDE) == RT_OVERRIDE_PARALLEL)
        return cpu_default_slot(cpu->view, x, y);
    float tile[4];
    cpu_fetch_tile(cpu, RT_TILE, x, y, tile);
    return (int)tile[0];
}

/* Number of the eight rays around that cover a depth. */
static int count_covering(const struct reference *cpu, int x, int y, float depth_m)
{
    const struct neph_gpu_view *view = cpu->view;
    const float compared_m = compared_depth_m(cpu, depth_m);
    int count = 0;
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++) {
            if (dx == 0 && dy == 0)
                continue;
            int nx = least(x + dx, (int)view->tile_count[0] - 1);
            int ny = least(y + dy, (int)view->tile_count[1] - 1);
            nx = nx < 0 ? 0 : nx;
            ny = ny < 0 ? 0 : ny;
            const int slot = believed_slot(cpu, nx, ny);
            const float ray_m = compared_depth_m(cpu,
                                                 slot_depth_m(cpu, nx, ny, slot, view->origin_px));
            count += fabsf(compared_m - ray_m) < 0.25f * ray_m;
        }
    return count;
}

static int decide(const struct reference *cpu, int x, int y)
{
    float depths_m[4];
    tile_depths_m(cpu, x, y, depths_m);
    int nearest = 0, farthest = 0;
    for (int slot = 1; slot < 4; slot++) {
        nearest = depths_m[slot] < depths_m[nearest] ? slot : nearest;
        farthest = depths_m[slot] > depths_m[farthest] ? slot : farthest;
    }
    if (count_covering(cpu, x, y, depths_m[nearest]) == 0)
        return nearest;
    if (count_covering(cpu, x, y, depths_m[farthest]) == 0)
        return farthest;
    return cpu_default_slot(cpu->view, x, y);
}

static void put_slot(const struct reference *cpu, int x, int y, int slot)
{
    float depths_m[4];
    tile_depths_m(cpu, x, y, depths_m);
    const float units = cpu_stored_depth_m(cpu->view, depths_m[slot]) * 1e-4f;
    cpu_put_tile(cpu, RT_TILE, x, y, (float[4]){(float)slot, units});
}

/* Sets all tiles to their scheduled slots, then applies overrides. In parallel the order does not
 * matter, because only scheduled slots are read. */
void cpu_tile_index(const struct reference *cpu)
{
    const struct neph_gpu_view *view = cpu->view;
    const int width = (int)view->tile_count[0], height = (int)view->tile_count[1];
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            put_slot(cpu, x, y, cpu_default_slot(view, x, y));
    if (choice(cpu, RT_OVERRIDE) == RT_OVERRIDE_NONE || view->resting)
        return;
    for (int colour = 0; colour < COLOURS; colour++)
        for (int y = colour / 2; y < height; y += 2)
            for (int x = colour % 2; x < width; x += 2)
                put_slot(cpu, x, y, decide(cpu, x, y));
}
