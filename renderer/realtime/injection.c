/* SPDX-License-Identifier: MIT */
#include "renderer/realtime/injection.h"

#include "renderer/realtime/passes.h"

#include <math.h>
#include <stdlib.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_INJECTED_VALUES == 6, "a new kind");

static const float values[NEPH_INJECTED_VALUES] = {
    [NEPH_INJECTED_NAN] = NAN,        [NEPH_INJECTED_INFINITE] = INFINITY,
    [NEPH_INJECTED_NEGATIVE] = -1.0f, [NEPH_INJECTED_HUGE] = 1e30f,
    [NEPH_INJECTED_BLACK] = 0.0f,
};

static const float half_max = 65504.0f;

static bool is_half(const struct neph_gpu_target *target)
{
    return target->format == RT_R16F || target->format == RT_RG16F || target->format == RT_RGBA16F;
}

/* D. E. Knuth's multiplicative hash: arbitrary bits, the same in each run. */
static uint32_t hash_word(size_t word)
{
    return (uint32_t)word * 2654435761u;
}

static void put(const struct neph_gpu_target *target, uint32_t *words, size_t element,
                enum neph_injected_value value)
{
    const uint32_t own = neph_rt_format_words(target->format);
    float of_channels[4];
    for (uint32_t w = 0; w < own && value == NEPH_INJECTED_GARBAGE; w++)
        words[element * own + w] = hash_word(element * own + w);
    for (int c = 0; c < 4; c++)
        of_channels[c] = is_half(target) && value == NEPH_INJECTED_HUGE ? half_max : values[value];
    if (value != NEPH_INJECTED_GARBAGE)
        neph_rt_store(target, words, element, of_channels);
}

static uint64_t find_channels(const struct neph_gpu_target *target)
{
    return neph_rt_format_bytes(target->format) / (is_half(target) ? 2 : 4);
}

/* Selects elements (x, y) of a target. */
typedef bool choice(const struct neph_rt_device *device, int target, uint32_t x, uint32_t y,
                    const void *context);

static enum neph_status fill_texels_where(struct neph_rt_device *device, int target,
                                          choice *chooses, const void *context,
                                          enum neph_injected_value value, uint64_t *count,
                                          struct neph_diag *diag)
{
    const struct neph_gpu_target *shape = &device->view->targets[target];
    const size_t size = neph_rt_device_words(device, target);
    if (size == 0)
        return NEPH_OK;
    uint32_t *words = malloc(size * sizeof(*words));
    if (!words)
        return neph_fail_memory(diag);
    enum neph_status status = neph_rt_device_download(device, target, words, diag);
    for (uint32_t y = 0; y < shape->height && !status; y++)
        for (uint32_t x = 0; x < shape->width; x++) {
            if (!chooses(device, target, x, y, context))
                continue;
            put(shape, words, (size_t)y * shape->width + x, value);
            *count += find_channels(shape);
        }
    if (!status)
        status = neph_rt_device_upload(device, target, words, diag);
    free(words);
    return status;
}

/* --- the view and what is around it ----------------------------------------------------------- */

/* x and y are texels of the target. */
static bool is_in_view(const struct neph_rt_device *device, int target, uint32_t x, uint32_t y)
{
    const struct neph_rt_rectangle own = neph_rt_view_texels(device->view, target);
    return x >= own.left && x < own.left + own.width && y >= own.top && y < own.top + own.height;
}

static bool is_inside(const struct neph_rt_device *device, int target, uint32_t x, uint32_t y,
                      const void *context)
{
    (void)context;
    return is_in_view(device, target, x, y);
}

static bool is_outside_view(const struct neph_rt_device *device, int target, uint32_t x, uint32_t y,
                            const void *context)
{
    return !is_inside(device, target, x, y, context);
}

enum neph_status neph_rt_inject_outside_view(struct neph_rt_device *device,
                                             enum neph_injected_value value, uint64_t *count,
                                             struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int t = 0; t < RT_TARGET_COUNT && !status; t++)
        status = fill_texels_where(device, t, is_outside_view, NULL, value, count, diag);
    return status;
}

/* --- histories -------------------------------------------------------------------------------- */

enum neph_status neph_rt_inject_history(struct neph_rt_device *device,
                                        enum neph_injected_value value, uint64_t *count,
                                        struct neph_diag *diag)
{
    uint32_t before = NEPH_RT_BIT(RT_KEPT_RAY) | NEPH_RT_BIT(RT_KEPT_BEHIND); /* updated in place */
    enum neph_status status = NEPH_OK;
    for (int p = 0; neph_rt_passes[p]; p++) {
        const struct neph_rt_pass *pass = neph_rt_passes[p];
        if (neph_rt_is_condition_met(device->view, pass->condition))
            before |= neph_rt_targets_before(pass);
    }
    for (int t = 0; t < RT_TARGET_COUNT && !status; t++)
        if (before & NEPH_RT_BIT(t))
            status = fill_texels_where(device, t, is_inside, NULL, value, count, diag);
    return status;
}

/* --- rays ------------------------------------------------------------------------------------- */

/* All tiles, in rows, are divided into `count` equal parts; the middle tile of each is chosen. */
static bool is_chosen_ray(const struct neph_rt_device *device, int target, uint32_t x, uint32_t y,
                          const void *context)
{
    const struct neph_injected_rays *rays = context;
    const struct neph_gpu_view *view = device->view;
    const uint64_t all = (uint64_t)view->tile_count[0] * view->tile_count[1];
    const uint64_t count = (uint64_t)rays->count < all ? (uint64_t)rays->count : all;
    if (!is_in_view(device, target, x, y))
        return false;
    const uint64_t own = (uint64_t)(y - view->origin_px[1] / RT_QUARTER) * view->tile_count[0] + x -
                         view->origin_px[0] / RT_QUARTER;
    const uint64_t share = own * count / all;
    return own == ((2 * share + 1) * all / count) / 2;
}

enum neph_status neph_rt_inject_rays(struct neph_rt_device *device,
                                     const struct neph_injected_rays *rays, uint64_t *count,
                                     struct neph_diag *diag)
{
    return fill_texels_where(device, RT_RAY, is_chosen_ray, rays, rays->value, count, diag);
}
