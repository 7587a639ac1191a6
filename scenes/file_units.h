/* SPDX-License-Identifier: MIT
 *
 * Units as files of simulations write them ("kg m-3", "g/m3", "kg m**-3"). Private to scenes/.
 */
#ifndef NEPH_SCENES_FILE_UNITS_H
#define NEPH_SCENES_FILE_UNITS_H

enum neph_unit_kind {
    NEPH_UNIT_UNKNOWN,
    NEPH_UNIT_ONE,          /* "1" */
    NEPH_UNIT_LENGTH,       /* in m */
    NEPH_UNIT_WATER,        /* in g/m3 */
    NEPH_UNIT_NUMBER,       /* in 1/cm3 */
    NEPH_UNIT_EXTINCTION,   /* in 1/m */
    NEPH_UNIT_MIXING_RATIO, /* water over air: the density of air is missing */
    NEPH_UNIT_KIND_COUNT,
};

/* The kind of a unit, and the factor of its values to the unit of its kind. Spaces, `^` and `**` do
 * not matter. */
enum neph_unit_kind neph_unit_find(const char *unit, double *factor);

#endif
