/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/shared/check_reference.h"

#include <math.h>

static int held(int value, uint32_t count)
{
    return value < 0 ? 0 : value >= (int)count ? (int)count - 1 : value;
}

void cpu_fetch(const struct reference *cpu, int target, int x, int y, float value[4])
{
    const struct neph_gpu_target *shape = &cpu->view->targets[target];
    neph_rt_load(shape, cpu->targets[target], (size_t)y * shape->width + (size_t)x, value);
}

static void put(const struct reference *cpu, int target, int x, int y, const float value[4])
{
    const struct neph_gpu_target *shape = &cpu->view->targets[target];
    neph_rt_store(shape, cpu->targets[target], (size_t)y * shape->width + (size_t)x, value);
}

void cpu_fetch_full(const struct reference *cpu, int target, int x, int y, float value[4])
{
    const struct neph_gpu_view *view = cpu->view;
    cpu_fetch(cpu, target, (int)view->origin_px[0] + held(x, view->size_px[0]),
              (int)view->origin_px[1] + held(y, view->size_px[1]), value);
}

void cpu_fetch_output(const struct reference *cpu, int target, int x, int y, float value[4])
{
    const struct neph_gpu_view *view = cpu->view;
    cpu_fetch(cpu, target, (int)view->origin_px[0] + held(x, view->picture_px[0]),
              (int)view->origin_px[1] + held(y, view->picture_px[1]), value);
}

void cpu_fetch_half(const struct reference *cpu, int target, int x, int y, float value[4])
{
    const struct neph_gpu_view *view = cpu->view;
    cpu_fetch(cpu, target, (int)view->origin_px[0] / 2 + held(x, view->half_size_px[0]),
              (int)view->origin_px[1] / 2 + held(y, view->half_size_px[1]), value);
}

void cpu_fetch_tile(const struct reference *cpu, int target, int x, int y, float value[4])
{
    const struct neph_gpu_view *view = cpu->view;
    cpu_fetch(cpu, target, (int)view->origin_px[0] / 4 + held(x, view->tile_count[0]),
              (int)view->origin_px[1] / 4 + held(y, view->tile_count[1]), value);
}

void cpu_put_full(const struct reference *cpu, int target, int x, int y, const float value[4])
{
    const struct neph_gpu_view *view = cpu->view;
    put(cpu, target, (int)view->origin_px[0] + x, (int)view->origin_px[1] + y, value);
}

void cpu_put_output(const struct reference *cpu, int target, int x, int y, const float value[4])
{
    cpu_put_full(cpu, target, x, y, value); /* both have the same origin */
}

void cpu_put_half(const struct reference *cpu, int target, int x, int y, const float value[4])
{
    const struct neph_gpu_view *view = cpu->view;
    put(cpu, target, (int)view->origin_px[0] / 2 + x, (int)view->origin_px[1] / 2 + y, value);
}

void cpu_put_tile(const struct reference *cpu, int target, int x, int y, const float value[4])
{
    const struct neph_gpu_view *view = cpu->view;
    put(cpu, target, (int)view->origin_px[0] / 4 + x, (int)view->origin_px[1] / 4 + y, value);
}

bool cpu_is_valid(const float value[4])
{
    for (int c = 0; c < 4; c++)
        if (!isfinite(value[c]) || !(value[c] >= 0.0f))
            return false;
    return true;
}
