/* SPDX-License-Identifier: MIT */
#include "scenes/load_extinction.h"

#include "scenes/column.h"
#include "scenes/media.h"

#include <math.h>

static enum neph_status refuse_column(const struct neph_reader *reader, const char *path,
                                      const struct neph_medium *medium, double column_m, int axis)
{
    const char *name = neph_medium_facts(medium->kind)->name;
    if (isnan(column_m))
        neph_refuse(reader, path, "a %s has no densest column", name);
    else if (isinf(column_m))
        neph_refuse(reader, path, "it is infinite along %c for any extinction", "xyz"[axis]);
    else
        neph_refuse(reader, path, "the line along %c through the densest place has no medium",
                    "xyz"[axis]);
    neph_hint(reader->diag, "give another density, such as extinction_per_m, other bounds, or "
                            "optical_depth_along");
    return NEPH_ERR_INPUT;
}

enum neph_status neph_apply_density(const struct neph_reader *reader, const char *owner,
                                    const struct neph_written_density *density,
                                    const struct neph_medium *medium, double *extinction_per_m)
{
    const enum neph_density_unit unit = density->unit;
    const struct neph_density_unit_row *row = neph_density_unit_row(unit);
    const struct neph_path path = neph_format_path("%s%s%s", owner, *owner ? "." : "", row->key);
    const int axis = neph_density_axis(density);
    double column_m = NAN;
    if (unit == NEPH_DENSITY_EXTINCTION)
        return NEPH_OK;
    if (unit == NEPH_DENSITY_OPTICAL_DEPTH) {
        *extinction_per_m = 1.0;
        column_m = neph_medium_column_optical_depth(medium, axis);
        if (!(column_m > 0.0 && column_m < INFINITY))
            return refuse_column(reader, path.text, medium, column_m, axis);
    }
    if (density->radius_in_voxels) {
        *extinction_per_m = density->values[unit];
        return NEPH_OK;
    }
    *extinction_per_m = neph_density_to_extinction_per_m(
        unit, density->values[unit], neph_droplet_radii_assume(density->radii), column_m);
    if (*extinction_per_m <= NEPH_EXTINCTION_MAX_PER_M)
        return NEPH_OK;
    return neph_refuse(reader, path.text, "%g %s is an extinction of %g /m, outside 0 to %g /m",
                       density->values[unit], row->unit, *extinction_per_m,
                       NEPH_EXTINCTION_MAX_PER_M);
}
