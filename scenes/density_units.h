/* SPDX-License-Identifier: MIT
 *
 * Quantities that give the extinction of a medium, and the extinction that each means. All are
 * proportional to the extinction or to its inverse.
 *
 *   water         extinction = 3 Q W / (4 rho r_e)
 *   droplets      extinction = N Q pi r_e^2 (1 - v) (1 - 2 v)
 *   visibility    extinction = -ln(contrast) / V
 *   optical depth extinction = tau / column
 *
 * with effective radius r_e and effective variance v of a gamma distribution (J. E. Hansen, L. D.
 * Travis, Space Sci. Rev. 16, 1974), liquid water of density rho = 998.2 kg/m3, and the visibility
 * of H. Koschmieder (1924): the distance at which a black object against the horizon keeps that
 * contrast. WMO-No. 8 defines the meteorological optical range by 5 %.
 *
 * Q is the extinction efficiency of water droplets at 550 nm: twice the geometric cross section,
 * and the edge term of H. M. Nussenzveig, W. J. Wiscombe, Phys. Rev. Lett. 45, 1490 (1980),
 * averaged over the distribution: Q = 2 + 1.9923861 <x^(4/3)> / <x^2>, with x = 2 pi r /
 * wavelength. Compared with truth/droplets.h for v = 0.01..0.4 it is within 2.5 % at r_e = 2 um,
 * 0.7 % from 4 um and 0.15 % from 10 um on.
 */
#ifndef NEPH_SCENES_DENSITY_UNITS_H
#define NEPH_SCENES_DENSITY_UNITS_H

#include "scenes/scene.h"

enum neph_density_unit {
    NEPH_DENSITY_EXTINCTION,
    NEPH_DENSITY_WATER,
    NEPH_DENSITY_DROPLETS,
    NEPH_DENSITY_VISIBILITY_2, /* contrast 2 % */
    NEPH_DENSITY_VISIBILITY_5,
    NEPH_DENSITY_OPTICAL_DEPTH,
    NEPH_DENSITY_UNIT_COUNT,
};

#define NEPH_WATER_DENSITY_KG_PER_M3 998.2 /* at 20 degrees Celsius */

/* Range of effective radii, where Q is a good approximation, and of effective variances. */
#define NEPH_DROPLET_RADIUS_MIN_UM 2.0
#define NEPH_DROPLET_RADIUS_MAX_UM 1000.0
#define NEPH_DROPLET_VARIANCE_MIN 0.01
#define NEPH_DROPLET_VARIANCE_MAX 0.4

/* Radii that are assumed where a scene has none: of a cumulus or a stratus. */
#define NEPH_DROPLET_RADIUS_ASSUMED_UM 10.0
#define NEPH_DROPLET_VARIANCE_ASSUMED 0.1

/* The key of a scene file, the unit for tables, and whether the value depends on the radii. */
struct neph_density_unit_row {
    const char *key, *unit;
    bool needs_radius;
};
const struct neph_density_unit_row *neph_density_unit_row(enum neph_density_unit unit);

/* The radii in a medium, with assumed values in place of those that it has not. */
struct neph_droplet_radii neph_droplet_radii_assume(struct neph_droplet_radii radii);

/* Q of these radii. */
double neph_droplet_extinction_efficiency(struct neph_droplet_radii radii);

/* The extinction [1/m] of a value in the unit of its key (g/m3, 1/cm3, m). `column_m` is the
 * optical depth along a direction for an extinction of 1/m; only for NEPH_DENSITY_OPTICAL_DEPTH. */
double neph_density_to_extinction_per_m(enum neph_density_unit unit, double value,
                                        struct neph_droplet_radii radii, double column_m);

/* The inverse. The visibility without extinction is infinite. */
double neph_density_from_extinction(enum neph_density_unit unit, double extinction_per_m,
                                    struct neph_droplet_radii radii, double column_m);

#endif
