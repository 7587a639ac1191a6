/* SPDX-License-Identifier: MIT
 *
 * The controls of non-physical fog (scenes/fog_look.h), from a scene file.
 */
#include "scenes/load.h"

#include <math.h>
#include <stddef.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");

#define LOOK(member) offsetof(struct neph_fog_look, member)

_Static_assert((int)NEPH_FOG_NO_OBSERVER_M == (int)NEPH_FAR_M, "as the table says");

static const struct neph_field fields[] = {
    {"inscattering_w_per_m2_sr", NEPH_THREE, LOOK(inscattering_w_per_m2_sr), "W/m2/sr", 0, 1e9,
     .note = "Fog Inscattering Color: the radiance of opaque fog"},
    {"sky_light", NEPH_THREE, LOOK(sky_light), "", 0, 100,
     .note = "factor of the background's radiance that is added to it", .standard = "[0, 0, 0]"},
    {"start_distance_m", NEPH_NUMBER, LOOK(start_distance_m), "m", 0, NEPH_FAR_M,
     .note = "nearer fog is left out", .standard = "0"},
    {"end_distance_m", NEPH_NUMBER, LOOK(end_distance_m), "m", 0, NEPH_FAR_M,
     .note = "fog beyond this horizontal distance is left out; 0: none is", .standard = "0"},
    {"cutoff_distance_m", NEPH_NUMBER, LOOK(cutoff_distance_m), "m", 0, NEPH_FAR_M,
     .note = "objects beyond are seen without fog; 0: none are", .standard = "0"},
    {"max_opacity", NEPH_NUMBER, LOOK(max_opacity), "", 0, 1, .standard = "1"},
    {"volumetric_fog_distance_m", NEPH_NUMBER, LOOK(volumetric_fog_distance_m), "m", 0, NEPH_FAR_M,
     .note = "nearer fog is left to froxels, by depth", .standard = "0"},
    {"observer_height_max_m", NEPH_NUMBER, LOOK(observer_height_max_m), "m", -1e5, NEPH_FAR_M,
     .note =
         "a camera above is treated as at this height; Unreal has 655.36 m above the fog's height",
     .standard = "1e6"},
    {"directional_w_per_m2_sr", NEPH_THREE, LOOK(directional_w_per_m2_sr), "W/m2/sr", 0, 1e9,
     .note = "Directional Inscattering Color: added in the direction of the sun",
     .standard = "[0, 0, 0]"},
    {"directional_exponent", NEPH_NUMBER, LOOK(directional_exponent), "", 0, NEPH_FOG_EXPONENT_MAX,
     .note = "of the cosine between view and sun", .standard = "4"},
    {"directional_start_m", NEPH_NUMBER, LOOK(directional_start_m), "m", 0, NEPH_FAR_M,
     .note = "start of the glow, from the start of the fog", .standard = "0"},
    {0},
};

/* No line for a scene without controls, so that hashes from before this key existed stay valid. */
static void hash_look(const void *target, FILE *text)
{
    const struct neph_fog_look *look = target;
    if (look->present)
        neph_fields_hash(fields, look, text);
}

static enum neph_status read_look(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_record *record, void *target)
{
    struct neph_fog_look *look = target;
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    if (status)
        return status;
    look->present = true;
    const double start_m = fmax(look->start_distance_m, look->volumetric_fog_distance_m);
    if (look->end_distance_m > 0.0 && look->end_distance_m <= start_m)
        return neph_refuse(reader, "end_distance_m",
                           "%g is not beyond the start of the fog, %g; 0: it does not end",
                           look->end_distance_m, start_m);
    return NEPH_OK;
}

const struct neph_record neph_fog_look_record = {
    .size = sizeof(struct neph_fog_look), .fields = fields, .read = read_look, .hash = hash_look};

enum neph_status neph_check_fog_look(const struct neph_reader *reader,
                                     const struct neph_scene *scene)
{
    int fogs = 0;
    for (int i = 0; i < scene->medium_count; i++)
        fogs += scene->media[i].kind == NEPH_MEDIUM_HEIGHT_FOG;
    if (!scene->fog_look.present || fogs == 1)
        return NEPH_OK;
    return neph_refuse(reader, "fog_look",
                       "it controls a height fog, and the scene has %d; give it one", fogs);
}
