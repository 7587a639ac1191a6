/* SPDX-License-Identifier: MIT */
#include "tests/renderer/twins/slots.h"
#include "tests/renderer/twins/twin.h"

#include <math.h>

static float kept(float value)
{
    return value > 0.0f ? neph_rt_from_half(neph_rt_to_half(fminf(value, TWIN_HALF_MAX))) : 0.0f;
}

static float luminance(const float color[4])
{
    return 0.2126f * color[0] + 0.7152f * color[1] + 0.0722f * color[2];
}

static float relative_change(float now, float then)
{
    const float most = fmaxf(now, then);
    return most > 0.0f ? fabsf(now - then) / most : 0.0f;
}

static float change_of_ray(const struct twin *twin, int x, int y)
{
    const struct neph_gpu_view *view = twin->view;
    float ray[4], then[4];
    const int half_x = 2 * x + (int)(view->frame % 2), half_y = 2 * y + (int)(view->frame / 2 % 2);
    if (half_x >= (int)view->half_size_px[0] || half_y >= (int)view->half_size_px[1])
        return -1.0f;
    twin_fetch_tile(twin, RT_RAY, x, y, ray);
    twin_fetch_half(twin, RT_KEPT_RAY, half_x, half_y, then);
    const float now[4] = {kept(luminance(ray)), kept(ray[3])};
    twin_put_half(twin, RT_KEPT_RAY, half_x, half_y, now);
    if (!twin_repeats_ray(view, x, y))
        return -1.0f;
    return fmaxf(relative_change(now[0], then[0]), fabsf(now[1] - then[1]));
}

static float change_behind(const struct twin *twin, int x, int y)
{
    const struct neph_gpu_view *view = twin->view;
    const uint32_t length = (uint32_t)view->settings[RT_TAA_JITTER_LENGTH];
    float most = 0.0f;
    for (uint32_t i = 0; i < 16; i++) {
        const int pixel_x = 4 * x + (int)i % 4, pixel_y = 4 * y + (int)i / 4;
        if (i % length != view->frame % length || pixel_x >= (int)view->size_px[0] ||
            pixel_y >= (int)view->size_px[1])
            continue;
        float behind[4], then[4];
        twin_fetch_full(twin, RT_BEHIND, pixel_x, pixel_y, behind);
        twin_fetch_full(twin, RT_KEPT_BEHIND, pixel_x, pixel_y, then);
        const float now[4] = {kept(luminance(behind))};
        twin_put_full(twin, RT_KEPT_BEHIND, pixel_x, pixel_y, now);
        most = fmaxf(most, relative_change(now[0], then[0]));
    }
    return most;
}

void twin_gradient(const struct twin *twin)
{
    for (int y = 0; y < (int)twin->view->tile_count[1]; y++)
        for (int x = 0; x < (int)twin->view->tile_count[0]; x++) {
            const float change[4] = {change_of_ray(twin, x, y), change_behind(twin, x, y)};
            twin_put_tile(twin, RT_CHANGE, x, y, change);
        }
}

void twin_change_around(const struct twin *twin, int tile_x, int tile_y, double change[2])
{
    change[0] = change[1] = -1.0;
    for (int i = 0; i < 9; i++) {
        float value[4];
        twin_fetch_tile(twin, RT_CHANGE, tile_x + i % 3 - 1, tile_y + i / 3 - 1, value);
        for (int c = 0; c < 2; c++)
            change[c] = fmax(change[c], value[c]);
    }
    if (change[0] < 0.0)
        change[0] = 1.0;
}
