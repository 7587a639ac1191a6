/* SPDX-License-Identifier: MIT
 *
 * CPU reference: the temporal mean of a static scene. Surface points do not move, but a cell may
 * have sampled another of its pixels.
 */
#include "renderer/screen/check_reference.h"

#include <math.h>

struct mean {
    int raw, before, count_before, history;
};

static struct mean get_mean_targets(int resolution)
{
    return resolution == SCREEN_GI_RESOLUTION
               ? (struct mean){SCREEN_GI_RAW, SCREEN_GI_BEFORE, SCREEN_GI_COUNT_BEFORE,
                               SCREEN_GI_HISTORY}
               : (struct mean){SCREEN_SSR_RAW, SCREEN_SSR_BEFORE, SCREEN_SSR_COUNT_BEFORE,
                               SCREEN_SSR_HISTORY};
}

/* Whether a pixel was on the plane of another pixel in the previous frame. */
static bool was_on_plane(const struct reference *ref, struct reference_pixel at,
                         struct reference_pixel then)
{
    const double depth_m = reference_load(ref, SCREEN_DEPTH_BEFORE, then.x, then.y).v[0];
    const struct texel was = reference_load(ref, SCREEN_NORMAL_BEFORE, then.x, then.y);
    const struct neph_vec3 point_m = reference_surface_m(ref, at.x, at.y);
    const struct neph_vec3 normal = reference_normal(ref, at.x, at.y);
    if (depth_m >= NEPH_GPU_FAR_M)
        return false;
    const struct neph_vec3 seen_m = reference_place_m(
        ref, (struct vec2){then.x + 0.5, then.y + 0.5}, depth_m);
    const struct neph_vec3 its_normal = neph_vec3_normalize(
        (struct neph_vec3){was.v[0], was.v[1], was.v[2]});
    return fabs(neph_vec3_dot(neph_vec3_sub(seen_m, point_m), normal)) <= 0.01 * point_m.z &&
           neph_vec3_dot(its_normal, normal) >= 0.9;
}

/* Interpolate the previous frame's cells; returns their number of frames. */
static double history(const struct reference *ref, int resolution, struct reference_pixel at,
                      struct texel *sum)
{
    const struct mean mean = get_mean_targets(resolution);
    const int side = reference_cell_px(ref, resolution);
    struct reference then = *ref;
    then.frame = ref->frame - 1;
    const struct reference_pixel first = reference_sampled_pixel(&then, resolution, 0, 0);
    const double across = (double)(at.x - first.x) / side, down = (double)(at.y - first.y) / side;
    double weights = 0.0, count = 0.0;
    for (int i = 0; i < 4; i++) {
        const int x = (int)floor(across) + i % 2, y = (int)floor(down) + i / 2;
        if (x < 0 || y < 0 || side * x >= ref->width_px || side * y >= ref->height_px ||
            !was_on_plane(ref, at, reference_sampled_pixel(&then, resolution, x, y)))
            continue;
        const double share = (1.0 - fabs(across - x)) * (1.0 - fabs(down - y));
        const struct texel texel = reference_load(ref, mean.before, x, y);
        for (int c = 0; c < 4; c++)
            sum->v[c] += share * texel.v[c];
        count += share * reference_load(ref, mean.count_before, x, y).v[0];
        weights += share;
    }
    for (int c = 0; c < 4; c++)
        sum->v[c] = weights > 1e-3 ? sum->v[c] / weights : 0.0;
    return weights > 1e-3 ? floor(count / weights + 0.5) : 0.0;
}

struct texel reference_mean(const struct reference *ref, int resolution, int x, int y)
{
    const struct mean mean = get_mean_targets(resolution);
    const struct reference_pixel at = reference_sampled_pixel(ref, resolution, x, y);
    struct texel sum = {{0.0}};
    const bool is_half = reference_cell_px(ref, resolution) > 1;
    if (reference_is_sky(ref, at.x, at.y) ||
        (is_half && !reference_has_light(ref, resolution, at.x, at.y)))
        return sum;
    const double known = ref->frame > 0 ? history(ref, resolution, at, &sum) : 0.0;
    const double count = fmin(known, ref->values[mean.history]) + 1.0;
    const struct texel now = reference_load(ref, mean.raw, x, y);
    for (int c = 0; c < 4; c++)
        sum.v[c] += (now.v[c] - sum.v[c]) / count;
    return sum;
}
