/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/anti_aliasing/check_reference.h"

#include <math.h>

static float setting(const struct reference *cpu, int index)
{
    return cpu->view->settings[index];
}

/* --- the frame ----------------------------------------------------------------------------- */

/* AMD's polynomial of FSR 1 for a window of two texels to either side. */
static double lanczos(double x)
{
    if (fabs(x) >= 2.0)
        return 0.0;
    return (25.0 / 16.0 * pow(2.0 / 5.0 * x * x - 1.0, 2.0) - 9.0 / 16.0) *
           pow(x * x / 4.0 - 1.0, 2.0);
}

/* The pixel's centre relative to the frame's rays, in rendered pixels. */
static float centre_in_frame_px(const struct reference *cpu, int pixel, int axis)
{
    return ((float)pixel + 0.5f) * cpu->view->rendered_per_px[axis] - cpu->view->jitter_px[axis];
}

/* The sum over 4x4 if all are valid; else the Gaussian's. */
static bool upsample(const struct reference *cpu, struct place at,
                     const struct neighbourhood *around, struct colour *colour)
{
    const float way[2] = {centre_in_frame_px(cpu, at.x, 0) - 0.5f,
                          centre_in_frame_px(cpu, at.y, 1) - 0.5f};
    const int corner[2] = {(int)floorf(way[0]), (int)floorf(way[1])};
    double sum[3] = {0.0}, low[3] = {3e38, 3e38, 3e38}, high[3] = {-3e38, -3e38, -3e38};
    double weights = 0.0;
    for (int y = -1; y < 3; y++)
        for (int x = -1; x < 3; x++) {
            struct colour seen = taa_fetch_colour(cpu, RT_COLOR, corner[0] + x, corner[1] + y);
            if (setting(cpu, RT_TAA_GUARD) != 0.0f && !taa_is_finite(seen))
                return taa_filter_samples(cpu, around, colour);
            seen = taa_guard(cpu, seen);
            const double weight = lanczos(corner[0] + x - (double)way[0]) *
                                  lanczos(corner[1] + y - (double)way[1]);
            weights += weight;
            for (int c = 0; c < 3; c++) {
                sum[c] += weight * seen.c[c];
                if (x >= 0 && x < 2 && y >= 0 && y < 2) {
                    low[c] = fmin(low[c], seen.c[c]);
                    high[c] = fmax(high[c], seen.c[c]);
                }
            }
        }
    for (int c = 0; c < 3; c++)
        colour->c[c] = taa_clamp(sum[c] / weights, low[c], high[c]);
    return true;
}

/* --- disocclusion: float32 ----------------------------------------------------------------- */

static float nearest_depth_m(const struct reference *cpu, struct place at, int reach)
{
    float nearest_m = NEPH_GPU_FAR_M, depth_m[4];
    for (int y = -reach; y <= reach; y++)
        for (int x = -reach; x <= reach; x++) {
            cpu_fetch_full(cpu, RT_DEPTH, at.source_x + x, at.source_y + y, depth_m);
            if (depth_m[0] < nearest_m)
                nearest_m = depth_m[0];
        }
    return nearest_m;
}

/* Whether every depth seen there before was nearer than every depth around now. */
static bool is_disoccluded(const struct reference *cpu, struct place at, const float before_px[2])
{
    const struct neph_gpu_view *view = cpu->view;
    const int corner[2] = {(int)floorf(before_px[0] - 0.5f), (int)floorf(before_px[1] - 0.5f)};
    float farthest_before_m = -NEPH_GPU_FAR_M, ray[3];
    for (int i = 0; i < 4; i++) {
        float state[4];
        cpu_fetch_output(cpu, RT_TAA_STATE_BEFORE, corner[0] + i % 2, corner[1] + i / 2, state);
        farthest_before_m = state[2] > farthest_before_m ? state[2] : farthest_before_m;
    }
    taa_ray_through(view, at.x, at.y, ray);
    const float slant = view->now.is_parallel ? 1.0f : taa_dot(ray, view->before.forward);
    const float here_m = nearest_depth_m(cpu, at, 2) * slant -
                         taa_dot(view->before.position_m, view->before.forward);
    return farthest_before_m < (1.0f - 0.02f) * here_m;
}

/* --- locks: float32 ------------------------------------------------------------------------- */

struct lock {
    float left, luma;
};

static float compute_luma(const struct neighbourhood *around, int i)
{
    const double *c = around->colours[i].c;
    return (float)c[0] + 2.0f * (float)c[1] + (float)c[2];
}

static bool is_thin(const struct neighbourhood *around)
{
    static const int corners[4][3] = {{0, 1, 3}, {1, 2, 5}, {3, 6, 7}, {5, 7, 8}};
    const float own = compute_luma(around, 4), ratio = 1.05f;
    bool is_similar[9], brighter = true, darker = true, is_valid = true;
    for (int i = 0; i < 9; i++) {
        const float other = compute_luma(around, i);
        is_similar[i] = fmaxf(own, other) <= ratio * fminf(own, other);
        brighter &= is_similar[i] || own > other;
        darker &= is_similar[i] || own < other;
        is_valid &= around->is_valid[i];
    }
    for (int k = 0; k < 4; k++)
        if (is_similar[corners[k][0]] && is_similar[corners[k][1]] && is_similar[corners[k][2]])
            return false;
    return is_valid && (brighter || darker);
}

static bool is_trusted(const struct neighbourhood *around, float luma)
{
    float low = 3e38f, high = -3e38f;
    for (int i = 0; i < 9; i++) {
        low = around->is_valid[i] ? fminf(low, compute_luma(around, i)) : low;
        high = around->is_valid[i] ? fmaxf(high, compute_luma(around, i)) : high;
    }
    return luma >= 0.95f * low && luma <= 1.05f * high;
}

static struct lock update_lock(const struct reference *cpu, struct place at, const float *before_px,
                               const struct neighbourhood *around)
{
    float before[4] = {0.0f}, squared = 0.0f;
    if (before_px)
        cpu_fetch_output(cpu, RT_TAA_STATE_BEFORE, (int)floorf(before_px[0]),
                         (int)floorf(before_px[1]), before);
    const float left = before[0] - 1.0f / setting(cpu, RT_TAA_JITTER_LENGTH);
    struct lock lock = {left, before[1]};
    if (!(left > 0.0f && left <= 1.0f && is_trusted(around, lock.luma)))
        lock.left = 0.0f;
    const float shift_px[2] = {taa_shift_px(cpu, at.x, at.source_x, 0),
                               taa_shift_px(cpu, at.y, at.source_y, 1)};
    const float x = shift_px[0] / cpu->view->rendered_per_px[0];
    const float y = shift_px[1] / cpu->view->rendered_per_px[1];
    squared = x * x + y * y;
    if (squared <= 0.5f && is_thin(around))
        lock = (struct lock){1.0f, compute_luma(around, 4)};
    return lock;
}

/* --- the pixel ------------------------------------------------------------------------------ */

static double history_weight(const struct reference *cpu, struct place at, const float before_px[2],
                             double quickness)
{
    float value[4], volume[4];
    cpu_fetch_output(cpu, RT_TAA_BEFORE, (int)floorf(before_px[0]), (int)floorf(before_px[1]),
                     value);
    cpu_fetch_full(cpu, RT_VOLUME, at.source_x, at.source_y, volume);
    double most = setting(cpu, RT_TAA_AGE_MAX) * (1.0 - 0.75 * quickness);
    if (setting(cpu, RT_TAA_RESPONSIVE) != 0.0f)
        most *= 1.0 - taa_clamp(1.0 - (double)volume[3], 0.0, 0.9);
    return value[3] > 0.0f ? fmin(value[3], most) : 0.0;
}

static void pixel(const struct reference *cpu, struct place at)
{
    const struct neph_gpu_view *view = cpu->view;
    const struct neighbourhood around = taa_fetch_neighbourhood(cpu, at);
    const bool is_reset = !view->has_history ||
                          (view->is_cut && setting(cpu, RT_CUT_RESET) != 0.0f);
    float before_px[2];
    double speed_px = 0.0, weight = 0.0, seen = taa_coverage(cpu, &around);
    struct colour history, colour;
    const bool has_history = !is_reset && taa_find_before(cpu, at, before_px, &speed_px) &&
                             !is_disoccluded(cpu, at, before_px) &&
                             taa_fetch_history(cpu, before_px, &history);
    const struct lock lock = update_lock(cpu, at, has_history ? before_px : NULL, &around);
    if (!upsample(cpu, at, &around, &colour)) {
        colour = has_history ? history : (struct colour){{0.0}};
        seen = 0.0;
    } else if (has_history) {
        const double quickness = fmin(speed_px / 20.0, 1.0);
        weight = history_weight(cpu, at, before_px, quickness);
        struct colour limited = taa_clamp_history(cpu, history, around, colour,
                                                  3.0 - 2.0 * quickness);
        for (int c = 0; c < 3; c++)
            limited.c[c] += (double)lock.left * (history.c[c] - limited.c[c]);
        colour = taa_blend(cpu, colour, limited, seen / (weight + seen));
    }
    taa_put_pixel(cpu, at.x, at.y, colour, fmin(weight + seen, setting(cpu, RT_TAA_AGE_MAX)));
    cpu_put_output(cpu, RT_TAA_STATE, at.x, at.y,
                   (float[4]){lock.left, lock.luma, nearest_depth_m(cpu, at, 1)});
}

void cpu_locks(const struct reference *cpu)
{
    for (int y = 0; y < (int)cpu->view->picture_px[1]; y++)
        for (int x = 0; x < (int)cpu->view->picture_px[0]; x++)
            pixel(cpu, taa_find_source(cpu, x, y));
}
