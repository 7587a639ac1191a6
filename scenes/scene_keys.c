/* SPDX-License-Identifier: MIT
 *
 * All keys of a scene file as one table; the records are in the files of their subjects.
 */
#include "scenes/bake.h"
#include "scenes/load.h"
#include "scenes/words.h"

#include <stddef.h>

#define SCENE(member) offsetof(struct neph_scene, member)
#define WRITTEN(member) offsetof(struct neph_written_scene, member)
#define OCTAVES(member) offsetof(struct neph_octaves, member)

#define BRIGHT 1e9 /* a float32 pixel can represent the sum of 1e29 of them */

enum { TITLE_MAX = 120, DESCRIPTION_MAX = 4000, GATES_MAX = 64 };

_Static_assert(NEPH_BAKE_RESOLUTION_DEFAULT == 64, "as the table says");

static const struct neph_field octaves_fields[] = {
    {"count", NEPH_WHOLE, OCTAVES(count), "", 1, 16, .standard = "8", .hash_name = "octaves"},
    {"contribution", NEPH_NUMBER, OCTAVES(contribution), "", 0, 1, .standard = "0.5",
     .hashing = NEPH_HASHED_AS_THREE, .hash_name = "contribution attenuation eccentricity"},
    {"attenuation", NEPH_NUMBER, OCTAVES(attenuation), "", 0, 1, .standard = "0.5"},
    {"eccentricity", NEPH_NUMBER, OCTAVES(eccentricity), "", 0, 1, .standard = "0.5"},
    {0},
};
static const struct neph_record octaves_record = {.size = sizeof(struct neph_octaves),
                                                  .fields = octaves_fields};

const struct neph_field neph_scene_fields[] = {
    {"name", NEPH_TEXT, SCENE(name), .note = "a-z, 0-9 and _; the name of the file without .yaml",
     .least = 1, .most = NEPH_NAME_MAX_BYTES, .standard = "the name of the file",
     .hashing = NEPH_NOT_HASHED},
    {"title", NEPH_TEXT, SCENE(title), .note = "one line", .least = 1, .most = TITLE_MAX,
     .hashing = NEPH_NOT_HASHED},
    {"description", NEPH_TEXT, SCENE(description),
     .note = "what the scene isolates, and its reference", .least = 1, .most = DESCRIPTION_MAX,
     .standard = "none", .hashing = NEPH_NOT_HASHED},
    {"physics", NEPH_TEXT, WRITTEN(old_description),
     .note = "the older name of `description`; warns", .least = 1, .most = DESCRIPTION_MAX,
     .standard = "none", .hashing = NEPH_NOT_HASHED},
    {"camera", NEPH_RECORD, .record = &neph_camera_record},
    {"frames", NEPH_RECORD, .record = &neph_frames_record, .standard = ""},
    {"sun", NEPH_RECORD, .record = &neph_sun_record, .standard = "no sun"},
    {"lights", NEPH_ENTRIES, SCENE(lights), .most = NEPH_SCENE_LIGHTS_MAX,
     .count_at = SCENE(light_count), .record = &neph_light_record, .standard = "none"},
    {"wind", NEPH_RECORD, .record = &neph_wind_record, .standard = "no wind"},
    {"background_w_per_m2_sr", NEPH_THREE, SCENE(background_w_per_m2_sr), "W/m2/sr", 0, BRIGHT,
     .note = "uniform radiance of the sky", .standard = "[0, 0, 0]"},
    {"environment_light", NEPH_FLAG, SCENE(environment_light),
     .note = "the background lights media and solids; else it is only visible",
     .standard = "`false`"},
    {"scattering", NEPH_WORD, SCENE(scattering),
     .note = "`none`: media attenuate; `single`: plus light of sun and `lights` scattered once; "
             "`multiple`: all orders, surface bounces included",
     .words = neph_scattering_words, .hashing = NEPH_HASHED_AS_MADE},
    {"octaves", NEPH_RECORD, SCENE(octaves),
     .note = "of the ray marcher's lighting model of that name", .record = &octaves_record,
     .standard = ""},
    {"bake_resolution", NEPH_WHOLE, SCENE(bake_resolution), "nodes", NEPH_BAKE_RESOLUTION_MIN,
     NEPH_GRID_SIDE_MAX,
     .note = "of the grid that engines without formulas get, along its longest side",
     .standard = "64"},
    {"display", NEPH_RECORD, WRITTEN(display), .record = &neph_display_record,
     .standard = "an exposure of 0", .hashing = NEPH_NOT_HASHED},
    {"gates", NEPH_LIST, WRITTEN(gates.list), .most = GATES_MAX, .count_at = WRITTEN(gates.count),
     .record = &neph_gate_record, .standard = "none", .hashing = NEPH_NOT_HASHED},
    {"failure", NEPH_RECORD, WRITTEN(failing),
     .note = "failures of methods over time, see Failures", .record = &neph_failing_record,
     .standard = "none", .hashing = NEPH_NOT_HASHED},
    {"inject", NEPH_RECORD, WRITTEN(injections),
     .note = "fault injection into a running renderer, see Injections",
     .record = &neph_injection_record, .standard = "none", .hashing = NEPH_NOT_HASHED},
    {"solids", NEPH_LIST, WRITTEN(solids), .most = NEPH_SCENE_SOLIDS_MAX,
     .count_at = WRITTEN(solid_count), .record = &neph_solid_record, .standard = "none",
     .hashing = NEPH_HASHED_AS_MADE},
    {"media", NEPH_ENTRIES, SCENE(media), .most = NEPH_SCENE_MEDIA_MAX,
     .count_at = SCENE(medium_count), .record = &neph_medium_record, .standard = "none"},
    {"fog_look", NEPH_RECORD, SCENE(fog_look),
     .note = "non-physical controls of height fog in game engines, see Looks of fog",
     .record = &neph_fog_look_record, .standard = "none"},
    {0},
};

void neph_scene_print_keys(FILE *file)
{
    fputs("| key | value | default | |\n| --- | --- | --- | --- |\n", file);
    neph_fields_print(neph_scene_fields, "", file);
    neph_forms_print(file);
}
