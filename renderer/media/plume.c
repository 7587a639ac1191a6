/* SPDX-License-Identifier: MIT
 *
 * The device data of plumes.
 */
#include "renderer/media/kind.h"
#include "renderer/relative.h"

#include <math.h>

/* Upper bound of a ray's optical depth: 1.5 times the larger of the integrals of density along and
 * across the axis. */
static double largest_depth(const struct neph_medium *medium)
{
    const double across_m = sqrt(2.0 * M_PI) * medium->plume.width_m;
    return 1.5 * medium->extinction_per_m * fmax(medium->plume.scale_height_m, across_m);
}

static void pack(const struct neph_medium *medium, struct neph_vec3 camera_m, uint32_t first,
                 struct neph_gpu_medium *gpu)
{
    (void)first;
    const struct neph_plume *from = &medium->plume;
    const double folds = log(fmax(1.0, largest_depth(medium) / NEPH_GPU_THIN));
    struct neph_gpu_plume *plume = &gpu->shape.plume;
    plume->width_m = (float)from->width_m;
    plume->scale_height_m = (float)from->scale_height_m;
    plume->reach_m = neph_relative_m(folds * from->scale_height_m, 0.0);
    neph_relative_position(plume->foot_m, from->foot_m, camera_m);
    neph_gpu_direction(plume->axis, from->axis);
}

const struct neph_gpu_kind neph_gpu_plume = {.pack = pack};
