/* SPDX-License-Identifier: MIT
 *
 * The mean over frames, where nothing moves: a place is where it was, but cells may have looked at
 * another pixel of theirs.
 */
#include "tests/renderer/twins/screen.h"

#include <math.h>

struct mean {
    int raw, before, count_before, history;
};

static struct mean mean_of(int resolution)
{
    return resolution == SCREEN_GI_RESOLUTION
               ? (struct mean){SCREEN_GI_RAW, SCREEN_GI_BEFORE, SCREEN_GI_COUNT_BEFORE,
                               SCREEN_GI_HISTORY}
               : (struct mean){SCREEN_SSR_RAW, SCREEN_SSR_BEFORE, SCREEN_SSR_COUNT_BEFORE,
                               SCREEN_SSR_HISTORY};
}

/* Whether a pixel had the plane of another in the frame before. */
static bool had_plane(const struct twin_screen *twin, struct twin_pixel at, struct twin_pixel then)
{
    const double depth_m = twin_screen_load(twin, SCREEN_DEPTH_BEFORE, then.x, then.y).v[0];
    const struct texel was = twin_screen_load(twin, SCREEN_NORMAL_BEFORE, then.x, then.y);
    const struct neph_vec3 point_m = twin_screen_surface_m(twin, at.x, at.y);
    const struct neph_vec3 normal = twin_screen_normal(twin, at.x, at.y);
    if (depth_m >= NEPH_GPU_FAR_M)
        return false;
    const struct neph_vec3 seen_m = twin_screen_place_m(
        twin, (struct vec2){then.x + 0.5, then.y + 0.5}, depth_m);
    const struct neph_vec3 its_normal = neph_vec3_normalize(
        (struct neph_vec3){was.v[0], was.v[1], was.v[2]});
    return fabs(neph_vec3_dot(neph_vec3_sub(seen_m, point_m), normal)) <= 0.01 * point_m.z &&
           neph_vec3_dot(its_normal, normal) >= 0.9;
}

/* Between the cells of the frame before; returns how many frames they have. */
static double history(const struct twin_screen *twin, int resolution, struct twin_pixel at,
                      struct texel *sum)
{
    const struct mean mean = mean_of(resolution);
    const int side = twin_screen_cell_px(twin, resolution);
    struct twin_screen then = *twin;
    then.frame = twin->frame - 1;
    const struct twin_pixel first = twin_screen_pixel_in(&then, resolution, 0, 0);
    const double across = (double)(at.x - first.x) / side, down = (double)(at.y - first.y) / side;
    double weights = 0.0, count = 0.0;
    for (int i = 0; i < 4; i++) {
        const int x = (int)floor(across) + i % 2, y = (int)floor(down) + i / 2;
        if (x < 0 || y < 0 || side * x >= twin->width_px || side * y >= twin->height_px ||
            !had_plane(twin, at, twin_screen_pixel_in(&then, resolution, x, y)))
            continue;
        const double share = (1.0 - fabs(across - x)) * (1.0 - fabs(down - y));
        const struct texel texel = twin_screen_load(twin, mean.before, x, y);
        for (int c = 0; c < 4; c++)
            sum->v[c] += share * texel.v[c];
        count += share * twin_screen_load(twin, mean.count_before, x, y).v[0];
        weights += share;
    }
    for (int c = 0; c < 4; c++)
        sum->v[c] = weights > 1e-3 ? sum->v[c] / weights : 0.0;
    return weights > 1e-3 ? floor(count / weights + 0.5) : 0.0;
}

struct texel twin_screen_mean(const struct twin_screen *twin, int resolution, int x, int y)
{
    const struct mean mean = mean_of(resolution);
    const struct twin_pixel at = twin_screen_pixel_in(twin, resolution, x, y);
    struct texel sum = {{0.0}};
    const bool is_half = twin_screen_cell_px(twin, resolution) > 1;
    if (twin_screen_is_sky(twin, at.x, at.y) ||
        (is_half && !twin_screen_has_light(twin, resolution, at.x, at.y)))
        return sum;
    const double known = twin->frame > 0 ? history(twin, resolution, at, &sum) : 0.0;
    const double count = fmin(known, twin->values[mean.history]) + 1.0;
    const struct texel now = twin_screen_load(twin, mean.raw, x, y);
    for (int c = 0; c < 4; c++)
        sum.v[c] += (now.v[c] - sum.v[c]) / count;
    return sum;
}
