/* SPDX-License-Identifier: MIT
 *
 * A scene file's way into memory: read, parse, fill the structs along the tables, check what needs
 * the whole scene, hash.
 */
#include "scenes/load.h"

#include "base/files.h"
#include "base/text.h"
#include "scenes/bake.h"
#include "scenes/hash_text.h"
#include "scenes/media.h"
#include "scenes/words.h"

#include <locale.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define SCENE(member) offsetof(struct neph_scene, member)
#define GATE(member) offsetof(struct neph_gate, member)
#define OCTAVES(member) offsetof(struct neph_octaves, member)

#define BRIGHT 1e9 /* one float32 pixel still holds the sum of 1e29 of them */

enum { TITLE_MAX = 120, GATES_MAX = 64, PATH_TEXT_MAX = 1000 };

/* --- Texts --- */

bool neph_is_identifier(const char *text)
{
    return strspn(text, "abcdefghijklmnopqrstuvwxyz0123456789_") == strlen(text);
}

/* Shorter directions are refused: their normalised form would be noise. */
#define DIRECTION_MIN 1e-9

enum neph_status neph_check_direction(const struct neph_reader *reader, const char *path,
                                      struct neph_vec3 direction)
{
    return neph_vec3_length(direction) < DIRECTION_MIN
               ? neph_refuse(reader, path, "a direction of length 0")
               : NEPH_OK;
}

static bool has_control(const char *text, const char *except)
{
    const size_t length = strlen(text);
    const bool has_line = strchr(text, '\n') && !strchr(except, '\n');
    return has_line || strchr(text, '\t') || neph_text_first_unfit(text, length) < length;
}

static enum neph_status check_names(const struct neph_reader *reader,
                                    const struct neph_scene *scene, const char *stem)
{
    char quote[NEPH_QUOTE_SIZE], stem_quote[NEPH_QUOTE_SIZE];
    neph_document_quote(scene->name, quote);
    if (!neph_is_identifier(scene->name))
        return neph_refuse(reader, "name", "'%s' is not a name; use a-z, 0-9 and _ alone", quote);
    if (strcmp(scene->name, stem))
        return neph_refuse(reader, "name", "'%s' differs from the name of the file, '%s.yaml'",
                           quote, neph_document_quote(stem, stem_quote));
    if (has_control(scene->title, ""))
        return neph_refuse(reader, "title", "a title is one line without control characters");
    if (has_control(scene->physics, "\n"))
        return neph_refuse(reader, "physics", "control characters in the text");
    return NEPH_OK;
}

/* --- Gates --- */

static const char *const mask_words[] = {"all", "sky", "solid", "medium", "depth_edge", NULL};

static const struct neph_field gate_fields[] = {
    {"engine", NEPH_TEXT, GATE(engine), .least = 1, .most = 64},
    {"quantity", NEPH_WORD, GATE(quantity), .words = neph_gate_quantity_words},
    {"metric", NEPH_TEXT, GATE(metric), .least = 1, .most = 64,
     .note = "one that `neph metrics` lists for single pictures"},
    {"mask", NEPH_TEXT, GATE(mask), .words = mask_words, .standard = "`all`"},
    {"maximum", NEPH_NUMBER, GATE(maximum), "", 0, BRIGHT, .note = "of the absolute value"},
    {"reason", NEPH_TEXT, GATE(reason), .least = 1, .most = 1000},
    {0},
};

static enum neph_status read_gate(struct neph_reader *reader, const yaml_node_t *node,
                                  const struct neph_record *record, void *target)
{
    struct neph_gate *gate = target;
    char quote[NEPH_QUOTE_SIZE];
    const enum neph_status status = neph_read_fields(reader, node, record->fields, target);
    if (status)
        return status;
    if (!neph_is_identifier(gate->engine))
        return neph_refuse(reader, "engine", "'%s' is not the name of an engine",
                           neph_document_quote(gate->engine, quote));
    if (has_control(gate->reason, "\n"))
        return neph_refuse(reader, "reason", "control characters in the text");
    gate->line = (int)node->start_mark.line + 1;
    if (!gate->mask)
        gate->mask = mask_words[0];
    return NEPH_OK;
}

static const struct neph_record gate_record = {
    .size = sizeof(struct neph_gate), .fields = gate_fields, .read = read_gate};

/* --- The file --- */

_Static_assert(NEPH_BAKE_RESOLUTION_DEFAULT == 64, "as the table says");

static const struct neph_field octaves_fields[] = {
    {"count", NEPH_WHOLE, OCTAVES(count), "", 1, 16, .standard = "8"},
    {"contribution", NEPH_NUMBER, OCTAVES(contribution), "", 0, 1, .standard = "0.5"},
    {"attenuation", NEPH_NUMBER, OCTAVES(attenuation), "", 0, 1, .standard = "0.5"},
    {"eccentricity", NEPH_NUMBER, OCTAVES(eccentricity), "", 0, 1, .standard = "0.5"},
    {0},
};
static void hash_octaves(const void *target, FILE *text)
{
    const struct neph_octaves *octaves = target;
    neph_put_number(text, "octaves", octaves->count);
    neph_put_three(text, "contribution attenuation eccentricity", octaves->contribution,
                   octaves->attenuation, octaves->eccentricity);
}

static const struct neph_record octaves_record = {
    .size = sizeof(struct neph_octaves), .fields = octaves_fields, .hash = hash_octaves};

static const struct neph_field display_fields[] = {
    {"exposure_ev", NEPH_NUMBER, SCENE(exposure_ev), "EV", -40, 40,
     .note = "pictures show radiance times 2^ev; numbers do not", .standard = "0"},
    {"chain", NEPH_TEXT, SCENE(chain),
     .note = "a file, from the scene's folder on: what `neph render` shows its frames by, "
             "docs/post.md; no frame depends on it",
     .least = 1, .most = PATH_TEXT_MAX, .standard = "none"},
    {0},
};
static const struct neph_record display_record = {.size = sizeof(struct neph_scene),
                                                  .fields = display_fields};

const struct neph_field neph_scene_fields[] = {
    {"name", NEPH_TEXT, SCENE(name), .note = "a-z, 0-9 and _; the file's stem", .least = 1,
     .most = 64, .hashing = NEPH_NOT_HASHED},
    {"title", NEPH_TEXT, SCENE(title), .note = "one line", .least = 1, .most = TITLE_MAX,
     .hashing = NEPH_NOT_HASHED},
    {"physics", NEPH_TEXT, SCENE(physics),
     .note = "what the scene isolates and which truth applies", .least = 1, .most = 4000,
     .hashing = NEPH_NOT_HASHED},
    {"camera", NEPH_RECORD, .record = &neph_camera_record},
    {"frames", NEPH_RECORD, .record = &neph_frames_record, .standard = ""},
    {"sun", NEPH_RECORD, .record = &neph_sun_record, .standard = "no sun"},
    {"lights", NEPH_ENTRIES, SCENE(lights), .most = NEPH_SCENE_LIGHTS_MAX,
     .count_at = SCENE(light_count), .record = &neph_light_record, .standard = "none"},
    {"wind", NEPH_RECORD, .record = &neph_wind_record, .standard = "no wind"},
    {"background_w_per_m2_sr", NEPH_THREE, SCENE(background_w_per_m2_sr), "W/m2/sr", 0, BRIGHT,
     .note = "uniform radiance of the sky", .standard = "[0, 0, 0]"},
    {"environment_light", NEPH_FLAG, SCENE(environment_light),
     .note = "the background lights media and solids; else it is only seen", .standard = "`false`"},
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
    {"display", NEPH_RECORD, .record = &display_record, .standard = "an exposure of 0",
     .hashing = NEPH_NOT_HASHED},
    {"gates", NEPH_LIST, SCENE(gates), .most = GATES_MAX, .count_at = SCENE(gate_count),
     .record = &gate_record, .standard = "none", .hashing = NEPH_NOT_HASHED},
    {"failure", NEPH_RECORD, offsetof(struct neph_written_scene, failing),
     .note = "how methods fail over time, see Failures", .record = &neph_failing_record,
     .standard = "none", .hashing = NEPH_NOT_HASHED},
    {"inject", NEPH_RECORD, offsetof(struct neph_written_scene, injections),
     .note = "what is put into a running renderer, see Injections",
     .record = &neph_injection_record, .standard = "none", .hashing = NEPH_NOT_HASHED},
    {"solids", NEPH_LIST, offsetof(struct neph_written_scene, solids),
     .most = NEPH_SCENE_SOLIDS_MAX, .count_at = offsetof(struct neph_written_scene, solid_count),
     .record = &neph_solid_record, .standard = "none", .hashing = NEPH_HASHED_AS_MADE},
    {"media", NEPH_ENTRIES, SCENE(media), .most = NEPH_SCENE_MEDIA_MAX,
     .count_at = SCENE(medium_count), .record = &neph_medium_record, .standard = "none"},
    {"fog_look", NEPH_RECORD, SCENE(fog_look),
     .note = "what game engines add to a height fog, see Looks of fog",
     .record = &neph_fog_look_record, .standard = "none"},
    {0},
};

void neph_scene_print_keys(FILE *file)
{
    fputs("| key | value | default | |\n| --- | --- | --- | --- |\n", file);
    neph_fields_print(neph_scene_fields, "", file);
    neph_forms_print(file);
}

/* From the folder of the scene on. */
static enum neph_status find_chain(const struct neph_reader *reader, const char *path,
                                   struct neph_scene *scene)
{
    const char *slash = strrchr(path, '/');
    if (!scene->chain)
        return NEPH_OK;
    if (has_control(scene->chain, ""))
        return neph_refuse(reader, "display.chain", "control characters in the name of a file");
    if (!slash || scene->chain[0] == '/')
        return NEPH_OK;
    scene->chain = neph_arena_format(reader->arena, "%.*s/%s", (int)(slash - path), path,
                                     scene->chain);
    return neph_arena_check(reader->arena, reader->diag);
}

static enum neph_status finish(struct neph_reader *reader, const char *path,
                               struct neph_written_scene *written)
{
    struct neph_scene *scene = &written->scene;
    char *stem = neph_scene_name_of(path);
    scene->path = neph_arena_text(reader->arena, path);
    scene->failing = &written->failing;
    scene->injections = &written->injections;
    enum neph_status status = stem && !reader->arena->is_short ? check_names(reader, scene, stem)
                                                               : neph_fail_memory(reader->diag);
    free(stem);
    neph_finish_sun(written);
    if (!status)
        status = find_chain(reader, path, scene);
    if (!status)
        status = neph_finish_solids(reader, written);
    if (!status)
        status = neph_check_lights(reader, scene);
    if (!status)
        status = neph_check_motion(reader, scene);
    if (!status)
        status = neph_check_injections(reader, scene);
    if (!status)
        status = neph_check_fog_look(reader, scene);
    return status ? status : neph_scene_hash(scene, reader->diag);
}

/* Whose sweep the file is read at a point of; NULL: as it is. */
struct swept {
    const struct neph_failing *failing;
    int point;
};

static enum neph_status load_document(struct neph_document *document, const char *path,
                                      struct neph_scene **scene, struct neph_diag *diag)
{
    struct neph_written_scene *written = calloc(1, sizeof(*written));
    if (!written)
        return neph_fail_memory(diag);
    struct neph_reader reader = {
        .document = document, .arena = &written->scene.arena, .diag = diag};
    enum neph_status status = neph_read_fields(&reader, neph_document_root(document),
                                               neph_scene_fields, written);
    if (!status)
        status = finish(&reader, path, written);
    if (status)
        neph_scene_destroy(&written->scene);
    else
        *scene = &written->scene;
    return status;
}

static enum neph_status load_text(const char *path, const char *text, size_t size,
                                  const struct swept *swept, struct neph_scene **scene,
                                  struct neph_diag *diag)
{
    struct neph_document document;
    enum neph_status status = neph_document_init(&document, path, text, size,
                                                 NEPH_DOCUMENT_DEPTH_MAX, diag);
    if (status)
        return status;
    if (swept)
        status = neph_failing_put_point(&document, swept->failing, swept->point, diag);
    if (!status)
        status = load_document(&document, path, scene, diag);
    neph_document_finish(&document);
    return status;
}

static enum neph_status load_file(const char *path, const struct swept *swept,
                                  struct neph_scene **scene, struct neph_diag *diag)
{
    char *text = NULL;
    size_t size = 0;
    enum neph_status status = neph_file_read(path, NEPH_DOCUMENT_MAX_BYTES, &text, &size, diag);
    if (status)
        return status;
    /* Numbers have a decimal point, whatever the locale of whoever called. */
    locale_t c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    if (c_locale) {
        locale_t before = uselocale(c_locale);
        status = load_text(path, text, size, swept, scene, diag);
        uselocale(before);
        freelocale(c_locale);
    } else {
        status = neph_fail_memory(diag);
    }
    free(text);
    return status;
}

enum neph_status neph_scene_load(const char *path, struct neph_scene **scene,
                                 struct neph_diag *diag)
{
    return load_file(path, NULL, scene, diag);
}

enum neph_status neph_scene_load_point(const struct neph_scene *scene, int point,
                                       struct neph_scene **made, struct neph_diag *diag)
{
    const struct swept swept = {scene->failing, point};
    return load_file(scene->path, &swept, made, diag);
}

/* --- Names and end --- */

char *neph_scene_name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *start = slash ? slash + 1 : path;
    const char *dot = strrchr(start, '.');
    return dot ? strndup(start, (size_t)(dot - start)) : strdup(start);
}

void neph_scene_destroy(struct neph_scene *scene)
{
    if (!scene)
        return;
    for (int i = 0; i < scene->medium_count && !scene->borrows; i++)
        neph_medium_finish(&scene->media[i]);
    if (!scene->borrows)
        neph_arena_finish(&scene->arena);
    free(scene);
}
