/* SPDX-License-Identifier: MIT */
#include "scenes/load_density.h"

#include <stddef.h>
#include <string.h>

/* A new unit does not compile before this file was looked through for it. */
_Static_assert(NEPH_DENSITY_UNIT_COUNT == 6, "a new unit");

#define VALUE(unit) offsetof(struct neph_written_density, values[unit])
#define DENSITY(member) offsetof(struct neph_written_density, member)

/* The default comes first. */
static const char *const axes[] = {"y", "x", "z", NULL};

static const struct neph_field fields[] = {
    {"water_g_per_m3", NEPH_NUMBER, VALUE(NEPH_DENSITY_WATER), "g/m3", 0, 1e5,
     .note = "liquid water in droplets of effective_radius_um", .standard = "none",
     .hashing = NEPH_HASHED_AS_MADE},
    {"droplets_per_cm3", NEPH_NUMBER, VALUE(NEPH_DENSITY_DROPLETS), "1/cm3", 0, 1e9,
     .note = "number of droplets of effective_radius_um", .standard = "none",
     .hashing = NEPH_HASHED_AS_MADE},
    {"visibility_2_percent_m", NEPH_NUMBER, VALUE(NEPH_DENSITY_VISIBILITY_2), "m", 1e-3, 1e9,
     .note = "Koschmieder's: extinction 3.912 / visibility", .standard = "none",
     .hashing = NEPH_HASHED_AS_MADE},
    {"visibility_5_percent_m", NEPH_NUMBER, VALUE(NEPH_DENSITY_VISIBILITY_5), "m", 1e-3, 1e9,
     .note = "meteorological optical range: extinction 2.996 / visibility", .standard = "none",
     .hashing = NEPH_HASHED_AS_MADE},
    {"optical_depth", NEPH_NUMBER, VALUE(NEPH_DENSITY_OPTICAL_DEPTH), "", 0, 1e6,
     .note = "along a line through the densest place; unbounded fog counts from `height_m` up, "
             "`shell` and `tent` from the ground",
     .standard = "none", .hashing = NEPH_HASHED_AS_MADE},
    {"optical_depth_along", NEPH_WORD, DENSITY(along), .words = axes,
     .note = "direction of that line", .standard = "`y`", .hashing = NEPH_HASHED_AS_MADE},
    {"effective_radius_um", NEPH_NUMBER, DENSITY(radii.effective_radius_um), "um",
     NEPH_DROPLET_RADIUS_MIN_UM, NEPH_DROPLET_RADIUS_MAX_UM,
     .note = "mean of r^3 over mean of r^2; with any unit, for `neph scenes NAME`",
     .standard = "needed by water and droplets", .hashing = NEPH_HASHED_AS_MADE},
    {"effective_variance", NEPH_NUMBER, DENSITY(radii.effective_variance), "",
     NEPH_DROPLET_VARIANCE_MIN, NEPH_DROPLET_VARIANCE_MAX, .note = "of a gamma distribution",
     .standard = "`0.1`", .hashing = NEPH_HASHED_AS_MADE},
    {0},
};

#define ALL_KEYS                                                                                   \
    "extinction_per_m water_g_per_m3 droplets_per_cm3 visibility_2_percent_m "                     \
    "visibility_5_percent_m optical_depth optical_depth_along effective_radius_um "                \
    "effective_variance"

const struct neph_record neph_density_record = {.size = sizeof(struct neph_written_density),
                                                .fields = fields};

int neph_gather_fields(const struct neph_field *own, size_t at, struct neph_field *gathered)
{
    int count = 0;
    bool has_extinction = false;
    for (; own->key; own++) {
        has_extinction |= !strcmp(own->key, "extinction_per_m");
        gathered[count++] = *own;
    }
    for (const struct neph_field *field = fields; field->key && has_extinction; field++) {
        gathered[count] = *field;
        gathered[count++].at += at;
    }
    return count;
}

/* --- which unit --- */

static bool has_unit(const struct neph_reader *reader, const yaml_node_t *node,
                     enum neph_density_unit unit)
{
    return neph_reader_has(reader, node, neph_density_unit_row(unit)->key);
}

enum neph_density_unit neph_find_density(const struct neph_reader *reader, const yaml_node_t *node)
{
    int unit = 0;
    while (unit < NEPH_DENSITY_UNIT_COUNT && !has_unit(reader, node, (enum neph_density_unit)unit))
        unit++;
    return (enum neph_density_unit)unit;
}

static enum neph_status refuse_none(const struct neph_reader *reader)
{
    char keys[256] = "";
    for (int unit = 0; unit < NEPH_DENSITY_UNIT_COUNT; unit++)
        snprintf(keys + strlen(keys), sizeof(keys) - strlen(keys), "%s%s", unit ? ", " : "",
                 neph_density_unit_row((enum neph_density_unit)unit)->key);
    return neph_refuse(reader, "", "missing key: a medium has exactly one of %s", keys);
}

static enum neph_status refuse_two(const struct neph_reader *reader, const char *first,
                                   const char *second)
{
    neph_refuse(reader, second, "%s is given, too, and each of the two is the density", first);
    neph_hint(reader->diag, "leave one of them out");
    return NEPH_ERR_INPUT;
}

/* Refuses keys without the key that they belong to, and the other way round. */
static enum neph_status check_droplets(const struct neph_reader *reader, const yaml_node_t *node,
                                       const struct neph_written_density *density)
{
    const struct neph_density_unit_row *row = neph_density_unit_row(density->unit);
    const bool has_radius = density->radius_in_voxels ||
                            neph_reader_has(reader, node, "effective_radius_um");
    if (row->needs_radius && !has_radius) {
        neph_refuse(reader, row->key, "it needs the key effective_radius_um");
        neph_hint(reader->diag, "cumulus and stratus have about 10, fog 5 to 15");
        return NEPH_ERR_INPUT;
    }
    if (neph_reader_has(reader, node, "effective_variance") && !has_radius)
        return neph_refuse(reader, "effective_variance", "it needs the key effective_radius_um");
    if (neph_reader_has(reader, node, "optical_depth_along") &&
        density->unit != NEPH_DENSITY_OPTICAL_DEPTH)
        return neph_refuse(reader, "optical_depth_along", "it needs the key optical_depth");
    return NEPH_OK;
}

enum neph_status neph_choose_density(const struct neph_reader *reader, const yaml_node_t *node,
                                     struct neph_written_density *density)
{
    if (!neph_were_keys_read(reader, ALL_KEYS))
        return NEPH_OK;
    density->unit = neph_find_density(reader, node);
    if (density->unit == NEPH_DENSITY_UNIT_COUNT)
        return refuse_none(reader);
    for (int other = (int)density->unit + 1; other < NEPH_DENSITY_UNIT_COUNT; other++)
        if (has_unit(reader, node, (enum neph_density_unit)other))
            return refuse_two(reader, neph_density_unit_row(density->unit)->key,
                              neph_density_unit_row((enum neph_density_unit)other)->key);
    return check_droplets(reader, node, density);
}

int neph_density_axis(const struct neph_written_density *density)
{
    static const int numbers[] = {1, 0, 2};
    return numbers[density->along];
}
