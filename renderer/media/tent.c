/* SPDX-License-Identifier: MIT
 *
 * The device data of layers around a sphere with a tent profile.
 */
#include "renderer/media/kind.h"
#include "renderer/relative.h"

static void pack(const struct neph_medium *medium, struct neph_vec3 camera_m, uint32_t first,
                 struct neph_gpu_medium *gpu)
{
    (void)first;
    const struct neph_tent *tent = &medium->tent;
    gpu->shape.tent = (struct neph_gpu_tent){
        .globe = neph_gpu_globe_from(tent->center_m, tent->radius_m, camera_m),
        .altitude_m = (float)tent->altitude_m,
        .half_width_m = (float)tent->half_width_m,
    };
}

const struct neph_gpu_kind neph_gpu_tent = {.pack = pack};
