/* SPDX-License-Identifier: MIT */
#include "scenes/droplet_voxels.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A new unit does not compile before this file was looked through for it. */
_Static_assert(NEPH_DENSITY_UNIT_COUNT == 6, "a new unit");

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

double neph_radius_band_weight(const struct neph_radius_band *band, double radius_um)
{
    const double low = band->low_um, peak = band->peak_um, high = band->high_um;
    if (radius_um < peak)
        return low < peak ? fmax(0.0, (radius_um - low) / (peak - low)) : 1.0;
    return peak < high ? fmax(0.0, (high - radius_um) / (high - peak)) : 1.0;
}

static void add_note(const struct neph_radius_band *band, double share,
                     char note[NEPH_GRID_NOTE_SIZE])
{
    const size_t used = strlen(note);
    snprintf(note + used, NEPH_GRID_NOTE_SIZE - used,
             "%sradius band %g, %g, %g um: it has %.6g %% of the extinction", used ? "; " : "",
             band->low_um, band->peak_um, band->high_um, 100.0 * share);
}

enum neph_status neph_droplet_voxels_convert(const struct neph_droplet_voxels *droplets,
                                             const int size[3], float *values, const float *radii,
                                             char note[NEPH_GRID_NOTE_SIZE], struct neph_diag *diag)
{
    const size_t count = (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
    const double unit_um = droplets->radius_unit_um > 0.0 ? droplets->radius_unit_um : 1.0;
    double all = 0.0, own = 0.0;
    for (size_t node = 0; node < count; node++) {
        const double value = (double)values[node];
        if (!(value > 0.0)) /* bad values are refused by neph_grid_seal() */
            continue;
        const struct neph_droplet_radii one = neph_droplet_radii_assume((struct neph_droplet_radii){
            (double)radii[node] * unit_um, droplets->effective_variance});
        if (!(radii[node] > 0.0F && one.effective_radius_um >= NEPH_DROPLET_RADIUS_MIN_UM &&
              one.effective_radius_um <= NEPH_DROPLET_RADIUS_MAX_UM))
            return refuse_radius(droplets, size, node, value, (double)radii[node] * unit_um, diag);
        const double extinction = neph_density_to_extinction_per_m(droplets->unit, value, one, 1.0);
        const double weight = droplets->band
                                  ? neph_radius_band_weight(droplets->band, one.effective_radius_um)
                                  : 1.0;
        all += extinction;
        own += weight * extinction;
        values[node] = (float)(weight * extinction);
    }
    if (droplets->band)
        add_note(droplets->band, all > 0.0 ? own / all : 0.0, note);
    return NEPH_OK;
}
