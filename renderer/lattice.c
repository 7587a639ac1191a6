/* SPDX-License-Identifier: MIT */
#include "renderer/lattice.h"

#include <math.h>

void neph_lattice_sides_m(const struct neph_bounds *box, double sides_m[3])
{
    const struct neph_vec3 extent_m = neph_vec3_sub(box->max_m, box->min_m);
    sides_m[0] = extent_m.x;
    sides_m[1] = extent_m.y;
    sides_m[2] = extent_m.z;
}

void neph_lattice_nodes(const struct neph_bounds *box, int most, uint32_t size[3])
{
    double sides_m[3];
    neph_lattice_sides_m(box, sides_m);
    const double longest_m = fmax(sides_m[0], fmax(sides_m[1], sides_m[2]));
    for (int axis = 0; axis < 3; axis++)
        size[axis] = 1 + (uint32_t)fmax(1.0, ceil((most - 1) * sides_m[axis] / longest_m - 1e-9));
}

enum neph_status neph_lattice_check(const struct neph_bounds *box, const char *wants,
                                    const char *without, struct neph_diag *diag)
{
    double sides_m[3];
    neph_lattice_sides_m(box, sides_m);
    const double volume_m3 = sides_m[0] * sides_m[1] * sides_m[2];
    if (isfinite(volume_m3) && volume_m3 > 0.0)
        return NEPH_OK;
    return neph_fail(
        diag, NEPH_ERR_UNSUPPORTED,
        "%s: a medium of the scene has no finite bounds for a grid; give it bounds, or set %s",
        wants, without);
}

void neph_lattice_place(const struct neph_bounds *box, struct neph_vec3 camera_m,
                        const uint32_t size[3], uint32_t ends, struct neph_gpu_lattice *lattice)
{
    double sides_m[3];
    neph_lattice_sides_m(box, sides_m);
    neph_relative_position(lattice->origin_m, box->min_m, camera_m);
    for (int axis = 0; axis < 3; axis++) {
        lattice->size[axis] = size[axis];
        lattice->per_m[axis] = (float)((size[axis] - ends) / sides_m[axis]);
    }
}
