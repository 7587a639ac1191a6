/* SPDX-License-Identifier: MIT
 *
 * The device data of Gaussian blobs.
 */
#include "renderer/media/kind.h"
#include "renderer/relative.h"

#include <math.h>

static void pack(const struct neph_medium *medium, struct neph_vec3 camera_m, uint32_t first,
                 struct neph_gpu_medium *gpu)
{
    (void)first;
    const double width_m = medium->gaussian.width_m;
    /* Outside a sphere of radius r, a ray's optical depth is at most the depth of a whole line with
     * impact parameter r. */
    const double central = medium->extinction_per_m * width_m * sqrt(2.0 * M_PI);
    const double widths = sqrt(2.0 * log(fmax(1.0, central / NEPH_GPU_THIN)));
    struct neph_gpu_gaussian *blob = &gpu->shape.gaussian;
    blob->width_m = (float)width_m;
    blob->reach_m = neph_relative_m(widths * width_m, 0.0);
    neph_relative_position(blob->center_m, medium->gaussian.center_m, camera_m);
}

/* The relative slope r / w^2 of the density at the distance r, at least w, where extinction times w
 * is 1. */
static double surface_extinction_per_m(const struct neph_medium *medium, double largest_per_m)
{
    const double width_m = medium->gaussian.width_m;
    const double depth = fmax(largest_per_m * width_m, exp(0.5));
    return sqrt(2.0 * log(depth)) / width_m;
}

const struct neph_gpu_kind neph_gpu_gaussian = {
    .pack = pack, .surface_extinction_per_m = surface_extinction_per_m};
