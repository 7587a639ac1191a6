/* SPDX-License-Identifier: MIT
 *
 * The device data of exponential shells around a sphere.
 */
#include "renderer/media/kind.h"
#include "renderer/relative.h"

#include <math.h>

static void pack(const struct neph_medium *medium, struct neph_vec3 camera_m, uint32_t first,
                 struct neph_gpu_medium *gpu)
{
    (void)first;
    const struct neph_shell *shell = &medium->shell;
    /* The optical depth of a whole horizontal line, by Chapman's sqrt(2 pi r H), bounds the depth
     * above its height. r is taken a few scale heights up; the additional fold below covers the
     * rest of the error. */
    const double level_m = sqrt(2.0 * M_PI * (shell->radius_m + 40.0 * shell->scale_height_m) *
                                shell->scale_height_m);
    const double folds = log(fmax(1.0, medium->extinction_per_m * level_m / NEPH_GPU_THIN));
    gpu->shape.shell = (struct neph_gpu_shell){
        .globe = neph_gpu_globe_from(shell->center_m, shell->radius_m, camera_m),
        .scale_height_m = (float)shell->scale_height_m,
        .reach_m = neph_relative_m((folds + 1.0) * shell->scale_height_m, 0.0),
    };
}

static double surface_extinction_per_m(const struct neph_medium *medium, double largest_per_m)
{
    (void)largest_per_m;
    return 1.0 / medium->shell.scale_height_m;
}

const struct neph_gpu_kind neph_gpu_shell = {.pack = pack,
                                             .surface_extinction_per_m = surface_extinction_per_m};
