/* SPDX-License-Identifier: MIT */
#include "scenes/file_units.h"

#include <stddef.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_UNIT_KIND_COUNT == 7, "a new kind");

enum { UNIT_SIZE = 40 };

static const struct {
    const char *names; /* separated by spaces */
    enum neph_unit_kind kind;
    double factor;
} units[] = {
    {"1", NEPH_UNIT_ONE, 1.0},
    {"m meter meters metre metres", NEPH_UNIT_LENGTH, 1.0},
    {"km kilometer kilometers kilometre kilometres", NEPH_UNIT_LENGTH, 1e3},
    {"cm centimeter centimeters centimetre centimetres", NEPH_UNIT_LENGTH, 1e-2},
    {"mm millimeter millimeters millimetre millimetres", NEPH_UNIT_LENGTH, 1e-3},
    {"um \xc2\xb5m \xce\xbcm micron microns micrometer micrometers micrometre micrometres",
     NEPH_UNIT_LENGTH, 1e-6},
    {"nm nanometer nanometers nanometre nanometres", NEPH_UNIT_LENGTH, 1e-9},
    {"gm-3 g/m3", NEPH_UNIT_WATER, 1.0},
    {"kgm-3 kg/m3", NEPH_UNIT_WATER, 1e3},
    {"mgm-3 mg/m3", NEPH_UNIT_WATER, 1e-3},
    {"cm-3 1/cm3 /cm3 #/cm3", NEPH_UNIT_NUMBER, 1.0},
    {"m-3 1/m3 /m3 #/m3", NEPH_UNIT_NUMBER, 1e-6},
    {"m-1 1/m /m", NEPH_UNIT_EXTINCTION, 1.0},
    {"km-1 1/km /km", NEPH_UNIT_EXTINCTION, 1e-3},
    {"kgkg-1 kg/kg gkg-1 g/kg gg-1 g/g", NEPH_UNIT_MIXING_RATIO, 1.0},
};

/* Without spaces, `^` and `**`; "" if it is too long to be known. */
static void normalize(const char *unit, char text[UNIT_SIZE])
{
    size_t used = 0;
    for (; *unit && used < UNIT_SIZE - 1; unit++)
        if (!strchr(" ^*", *unit))
            text[used++] = *unit;
    text[*unit ? 0 : used] = '\0';
}

static int has_name(const char *names, const char *name)
{
    const size_t length = strlen(name);
    for (const char *at = names; *at; at += strcspn(at, " "), at += *at == ' ')
        if (length > 0 && strcspn(at, " ") == length && memcmp(at, name, length) == 0)
            return 1;
    return 0;
}

enum neph_unit_kind neph_unit_find(const char *unit, double *factor)
{
    char text[UNIT_SIZE];
    normalize(unit, text);
    for (size_t i = 0; i < sizeof(units) / sizeof(units[0]); i++)
        if (has_name(units[i].names, text)) {
            *factor = units[i].factor;
            return units[i].kind;
        }
    *factor = 1.0;
    return NEPH_UNIT_UNKNOWN;
}
