/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/shared/check_reference.h"
#include "base/half.h"
#include "renderer/realtime/tile_index/check_reference_slots.h"

#include <math.h>

enum { TILE_PX = 16 };

/* --- two samples ----------------------------------------------------------------------------- */

static float as_half(float value)
{
    return value > 0.0f ? neph_half_to_float(neph_rt_to_half(fminf(value, CPU_HALF_MAX))) : 0.0f;
}

static void as_halves(float value[4])
{
    for (int c = 0; c < 4; c++)
        value[c] = as_half(value[c]);
}

static void gain_between(const struct reference *cpu, const float now[3], const float then[3],
                         float gain[3])
{
    const float relight = cpu->view->settings[RT_RELIGHT];
    for (int c = 0; c < 3; c++)
        gain[c] = fminf(fmaxf(then[c] > 0.0f ? now[c] / then[c] : 1.0f, 1.0f - relight),
                        1.0f + relight);
}

static float residue_between(const float now[3], const float then[3], const float gain[3])
{
    float difference = 0.0f, most = 0.0f;
    for (int c = 0; c < 3; c++) {
        const float expected = gain[c] * then[c];
        difference = fmaxf(difference, fabsf(now[c] - expected));
        most = fmaxf(most, fmaxf(now[c], expected));
    }
    return most > 0.0f ? difference / most : 0.0f;
}

static void add(float sum[3], const float value[3])
{
    for (int c = 0; c < 3; c++)
        sum[c] += value[c];
}

/* --- the gradient ---------------------------------------------------------------------------- */

static bool is_other_scene(const struct reference *cpu, int x, int y)
{
    const float part = cpu->view->settings[RT_REJECT_DEPTH];
    if (!(part > 0.0f) || !cpu->view->has_history)
        return part > 0.0f;
    for (int i = 0; i < 4; i++) {
        float now[4], before[4];
        cpu_fetch_half(cpu, RT_HALF_DEPTH, 2 * x + i % 2, 2 * y + i / 2, now);
        cpu_fetch_half(cpu, RT_HALF_DEPTH_BEFORE, 2 * x + i % 2, 2 * y + i / 2, before);
        if (now[0] != before[0] && !(fabsf(now[0] - before[0]) < part * now[0]))
            return true;
    }
    return false;
}

/* The place in its row where a pixel is stored. */
static int kept_x(const struct neph_gpu_view *view, int x)
{
    int at = x / 4;
    for (int before = 0; before < x % 4; before++)
        at += ((int)view->size_px[0] - before + 3) / 4;
    return at;
}

static void clear_samples(const struct reference *cpu, int x, int y)
{
    const struct neph_gpu_view *view = cpu->view;
    const float nothing[4] = {0.0f};
    for (int i = 0; i < 4; i++)
        if (2 * x + i % 2 < (int)view->half_size_px[0] &&
            2 * y + i / 2 < (int)view->half_size_px[1])
            cpu_put_half(cpu, RT_KEPT_RAY, 2 * x + i % 2, 2 * y + i / 2, nothing);
    for (int i = 0; i < TILE_PX; i++)
        if (4 * x + i % 4 < (int)view->size_px[0] && 4 * y + i / 4 < (int)view->size_px[1])
            cpu_put_full(cpu, RT_KEPT_BEHIND, kept_x(view, 4 * x + i % 4), 4 * y + i / 4, nothing);
}

static void sample_medium(const struct reference *cpu, int x, int y)
{
    const struct neph_gpu_view *view = cpu->view;
    const int half_x = 2 * x + (int)(view->frame % 2), half_y = 2 * y + (int)(view->frame / 2 % 2);
    float now[4] = {0.0f}, then[4] = {0.0f};
    bool is_known = half_x < (int)view->half_size_px[0] && half_y < (int)view->half_size_px[1];
    if (is_known) {
        cpu_fetch_tile(cpu, RT_RAY, x, y, now);
        cpu_fetch_half(cpu, RT_KEPT_RAY, half_x, half_y, then);
        as_halves(now);
        as_halves(then);
        cpu_put_half(cpu, RT_KEPT_RAY, half_x, half_y, now);
    }
    is_known = is_known && cpu_repeats_ray(view, x, y);
    now[3] = is_other_scene(cpu, x, y) ? 1.0f : is_known ? fabsf(now[3] - then[3]) : 0.0f;
    then[3] = is_known;
    cpu_put_tile(cpu, RT_SAMPLE_NOW, x, y, now);
    cpu_put_tile(cpu, RT_SAMPLE_THEN, x, y, then);
}

static void sample_behind(const struct reference *cpu, int x, int y)
{
    const struct neph_gpu_view *view = cpu->view;
    const uint32_t length = (uint32_t)view->settings[RT_TAA_JITTER_LENGTH];
    float now[TILE_PX][4], then[TILE_PX][4], sum_now[4] = {0.0f}, sum_then[4] = {0.0f}, gain[3];
    int count = 0;
    for (uint32_t i = 0; i < TILE_PX; i++) {
        const int pixel_x = 4 * x + (int)i % 4, pixel_y = 4 * y + (int)i / 4;
        if (i % length != view->frame % length || pixel_x >= (int)view->size_px[0] ||
            pixel_y >= (int)view->size_px[1])
            continue;
        cpu_fetch_full(cpu, RT_BEHIND, pixel_x, pixel_y, now[count]);
        cpu_fetch_full(cpu, RT_KEPT_BEHIND, kept_x(view, pixel_x), pixel_y, then[count]);
        as_halves(now[count]);
        as_halves(then[count]);
        now[count][3] = 0.0f;
        cpu_put_full(cpu, RT_KEPT_BEHIND, kept_x(view, pixel_x), pixel_y, now[count]);
        add(sum_now, now[count]);
        add(sum_then, then[count++]);
    }
    gain_between(cpu, sum_now, sum_then, gain);
    for (int i = 0; i < count; i++)
        sum_now[3] = fmaxf(sum_now[3], residue_between(now[i], then[i], gain));
    sum_then[3] = (float)count;
    cpu_put_tile(cpu, RT_SAMPLE_BEHIND_NOW, x, y, sum_now);
    cpu_put_tile(cpu, RT_SAMPLE_BEHIND_THEN, x, y, sum_then);
}

void cpu_gradient(const struct reference *cpu)
{
    for (int y = 0; y < (int)cpu->view->tile_count[1]; y++)
        for (int x = 0; x < (int)cpu->view->tile_count[0]; x++) {
            if (!cpu->view->has_history)
                clear_samples(cpu, x, y);
            sample_medium(cpu, x, y);
            sample_behind(cpu, x, y);
        }
}

/* --- the change ------------------------------------------------------------------------------ */

static void change_around(const struct reference *cpu, int x, int y, const int targets[2],
                          float frames, float unknown, uint32_t cannot_tell, float change[4])
{
    float now[9][4], then[9][4], sum_now[3] = {0.0f}, sum_then[3] = {0.0f}, gain[3];
    bool is_known = false;
    for (int i = 0; i < 9; i++) {
        cpu_fetch_tile(cpu, targets[0], x + i % 3 - 1, y + i / 3 - 1, now[i]);
        cpu_fetch_tile(cpu, targets[1], x + i % 3 - 1, y + i / 3 - 1, then[i]);
        if (!(then[i][3] > 0.0f))
            continue;
        add(sum_now, now[i]);
        add(sum_then, then[i]);
        is_known = true;
    }
    gain_between(cpu, sum_now, sum_then, gain);
    change[3] = cannot_tell ? 1.0f : is_known ? 0.0f : unknown;
    for (int i = 0; i < 9; i++) {
        const float residue = then[i][3] > 0.0f ? residue_between(now[i], then[i], gain) : 0.0f;
        change[3] = fmaxf(change[3], fmaxf(residue, now[i][3]));
    }
    for (int c = 0; c < 3; c++)
        change[c] = 1.0f + (gain[c] - 1.0f) / frames;
}

static void put_change(const struct reference *cpu, int target, int x, int y, float change[4])
{
    const struct neph_gpu_view *view = cpu->view;
    float before[4];
    cpu_fetch_tile(cpu, target, x, y, before);
    const float held = view->settings[RT_CHANGE_HOLD] * before[3];
    if (view->has_history && !view->is_cut && held >= 0x1p-14f && held < 1.0f)
        change[3] = fmaxf(change[3], held);
    cpu_put_tile(cpu, target, x, y, change);
}

void cpu_change(const struct reference *cpu)
{
    static const int medium[] = {RT_SAMPLE_NOW, RT_SAMPLE_THEN};
    static const int behind[] = {RT_SAMPLE_BEHIND_NOW, RT_SAMPLE_BEHIND_THEN};
    const float length = cpu->view->settings[RT_TAA_JITTER_LENGTH];
    for (int y = 0; y < (int)cpu->view->tile_count[1]; y++)
        for (int x = 0; x < (int)cpu->view->tile_count[0]; x++) {
            float change[4];
            change_around(cpu, x, y, medium, 4.0f, 1.0f, cpu->view->strobes_medium, change);
            put_change(cpu, RT_CHANGE, x, y, change);
            change_around(cpu, x, y, behind, length, 0.0f, cpu->view->strobes_behind, change);
            put_change(cpu, RT_CHANGE_BEHIND, x, y, change);
        }
}
