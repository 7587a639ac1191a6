/* SPDX-License-Identifier: MIT */
#include "scenes/droplet_voxels.h"

static enum neph_status refuse_radius(const struct neph_droplet_voxels *droplets, const int size[3],
                                      size_t node, double value, double radius_um,
                                      struct neph_diag *diag)
{
    const size_t x = (size_t)size[0], y = (size_t)size[1];
    neph_fail(diag, NEPH_ERR_INPUT,
              "voxel (%zu, %zu, %zu) has %g %s and an effective radius of %g um; %g to %g um are "
              "possible",
              node % x, node / x % y, node / x / y, value,
              neph_density_unit_row(droplets->unit)->unit, radius_um, NEPH_DROPLET_RADIUS_MIN_UM,
              NEPH_DROPLET_RADIUS_MAX_UM);
    neph_hint(diag, "radius_unit_um is the unit of the radii in the file, 1e6 for metres");
    return NEPH_ERR_INPUT;
}

enum neph_status neph_droplet_voxels_convert(const struct neph_droplet_voxels *droplets,
                                             const int size[3], float *values, const float *radii,
                                             struct neph_diag *diag)
{
    const size_t count = (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
    const double unit_um = droplets->radius_unit_um > 0.0 ? droplets->radius_unit_um : 1.0;
    for (size_t node = 0; node < count; node++) {
        const double value = (double)values[node];
        if (!(value > 0.0)) /* bad values are refused by neph_grid_seal() */
            continue;
        const struct neph_droplet_radii one = neph_droplet_radii_assume((struct neph_droplet_radii){
            (double)radii[node] * unit_um, droplets->effective_variance});
        if (!(radii[node] > 0.0F && one.effective_radius_um >= NEPH_DROPLET_RADIUS_MIN_UM &&
              one.effective_radius_um <= NEPH_DROPLET_RADIUS_MAX_UM))
            return refuse_radius(droplets, size, node, value, (double)radii[node] * unit_um, diag);
        values[node] = (float)neph_density_to_extinction_per_m(droplets->unit, value, one, 1.0);
    }
    return NEPH_OK;
}
