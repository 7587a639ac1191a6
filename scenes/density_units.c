/* SPDX-License-Identifier: MIT */
#include "scenes/density_units.h"

#include <math.h>

/* A new unit does not compile before this file was looked through for it. */
_Static_assert(NEPH_DENSITY_UNIT_COUNT == 6, "a new unit");

#define WAVELENGTH_M 550e-9
#define EDGE_TERM 1.9923861

static const struct neph_density_unit_row rows[NEPH_DENSITY_UNIT_COUNT] = {
    [NEPH_DENSITY_EXTINCTION] = {"extinction_per_m", "/m", false},
    [NEPH_DENSITY_WATER] = {"water_g_per_m3", "g/m3", true},
    [NEPH_DENSITY_DROPLETS] = {"droplets_per_cm3", "/cm3", true},
    [NEPH_DENSITY_VISIBILITY_2] = {"visibility_2_percent_m", "m", false},
    [NEPH_DENSITY_VISIBILITY_5] = {"visibility_5_percent_m", "m", false},
    [NEPH_DENSITY_OPTICAL_DEPTH] = {"optical_depth", "", false},
};

const struct neph_density_unit_row *neph_density_unit_row(enum neph_density_unit unit)
{
    return &rows[unit];
}

struct neph_droplet_radii neph_droplet_radii_assume(struct neph_droplet_radii radii)
{
    if (radii.effective_radius_um == 0.0)
        radii.effective_radius_um = NEPH_DROPLET_RADIUS_ASSUMED_UM;
    if (radii.effective_variance == 0.0)
        radii.effective_variance = NEPH_DROPLET_VARIANCE_ASSUMED;
    return radii;
}

/* n(r) ~ r^(k - 1) exp(-r / (v r_e)) with k = (1 - 2 v) / v, so <r^p> is (v r_e)^p Gamma(k + p) /
 * Gamma(k), and <r^(4/3)> / <r^2> has these logarithms. */
double neph_droplet_extinction_efficiency(struct neph_droplet_radii radii)
{
    const double v = radii.effective_variance, k = (1.0 - 2.0 * v) / v;
    const double scale = 2.0 * M_PI / WAVELENGTH_M * v * 1e-6 * radii.effective_radius_um;
    return 2.0 + EDGE_TERM * exp(lgamma(k + 4.0 / 3.0) - lgamma(k + 2.0) - 2.0 / 3.0 * log(scale));
}

/* Extinction of 1 g/m3, of 1 droplet per cm3. */
static double per_water(struct neph_droplet_radii radii)
{
    return 1e-3 * 3.0 * neph_droplet_extinction_efficiency(radii) /
           (4.0 * NEPH_WATER_DENSITY_KG_PER_M3 * 1e-6 * radii.effective_radius_um);
}

static double per_droplet(struct neph_droplet_radii radii)
{
    const double radius_m = 1e-6 * radii.effective_radius_um, v = radii.effective_variance;
    return 1e6 * neph_droplet_extinction_efficiency(radii) * M_PI * radius_m * radius_m *
           (1.0 - v) * (1.0 - 2.0 * v);
}

static double koschmieder(double contrast, double value)
{
    return -log(contrast) / value;
}

double neph_density_to_extinction_per_m(enum neph_density_unit unit, double value,
                                        struct neph_droplet_radii radii, double column_m)
{
    switch (unit) {
    case NEPH_DENSITY_EXTINCTION:
        return value;
    case NEPH_DENSITY_WATER:
        return value * per_water(radii);
    case NEPH_DENSITY_DROPLETS:
        return value * per_droplet(radii);
    case NEPH_DENSITY_VISIBILITY_2:
        return koschmieder(0.02, value);
    case NEPH_DENSITY_VISIBILITY_5:
        return koschmieder(0.05, value);
    case NEPH_DENSITY_OPTICAL_DEPTH:
        return value / column_m;
    case NEPH_DENSITY_UNIT_COUNT:
        break;
    }
    return NAN;
}

double neph_density_from_extinction(enum neph_density_unit unit, double extinction_per_m,
                                    struct neph_droplet_radii radii, double column_m)
{
    switch (unit) {
    case NEPH_DENSITY_EXTINCTION:
        return extinction_per_m;
    case NEPH_DENSITY_WATER:
        return extinction_per_m / per_water(radii);
    case NEPH_DENSITY_DROPLETS:
        return extinction_per_m / per_droplet(radii);
    case NEPH_DENSITY_VISIBILITY_2:
        return koschmieder(0.02, extinction_per_m); /* its own inverse */
    case NEPH_DENSITY_VISIBILITY_5:
        return koschmieder(0.05, extinction_per_m);
    case NEPH_DENSITY_OPTICAL_DEPTH:
        return extinction_per_m == 0.0 ? 0.0 : extinction_per_m * column_m;
    case NEPH_DENSITY_UNIT_COUNT:
        break;
    }
    return NAN;
}
