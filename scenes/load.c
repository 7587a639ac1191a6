/* SPDX-License-Identifier: MIT
 *
 * A scene file's way into memory: read, parse, fill the structs along the tables, check what needs
 * the whole scene, hash.
 */
#include "scenes/load.h"

#include "base/files.h"
#include "base/text.h"
#include "scenes/bake.h"
#include "scenes/errors.h"
#include "scenes/hash_text.h"
#include "scenes/media.h"
#include "scenes/volume_scene.h"
#include "scenes/words.h"

#include <ctype.h>
#include <locale.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define SCENE(member) offsetof(struct neph_scene, member)
#define GATE(member) offsetof(struct neph_gate, member)
#define OCTAVES(member) offsetof(struct neph_octaves, member)

#define BRIGHT 1e9 /* one float32 pixel still holds the sum of 1e29 of them */

enum {
    NAME_MAX_BYTES = 64,
    TITLE_MAX = 120,
    DESCRIPTION_MAX = 4000,
    GATES_MAX = 64,
    PATH_TEXT_MAX = 1000
};

/* --- Texts --- */

static const char name_characters[] = "abcdefghijklmnopqrstuvwxyz0123456789_";

bool neph_is_identifier(const char *text)
{
    return strspn(text, name_characters) == strlen(text);
}

/* Shorter directions are refused: their normalised form would be noise. */
#define DIRECTION_MIN 1e-9

enum neph_status neph_check_direction(const struct neph_reader *reader, const char *path,
                                      struct neph_vec3 direction)
{
    return neph_vec3_length(direction) < DIRECTION_MIN
               ? neph_refuse(reader, path, "a direction of length 0; give one such as [0, 1, 0]")
               : NEPH_OK;
}

static bool has_control(const char *text, const char *except)
{
    const size_t length = strlen(text);
    const bool has_line = strchr(text, '\n') && !strchr(except, '\n');
    return has_line || strchr(text, '\t') || neph_text_first_unfit(text, length) < length;
}

/* A scene without a name is called like its file. */
static enum neph_status finish_name(struct neph_reader *reader, struct neph_written_scene *written)
{
    struct neph_scene *scene = &written->scene;
    char quote[NEPH_QUOTE_SIZE], stem_quote[NEPH_QUOTE_SIZE];
    char *stem = neph_scene_name_of(scene->path);
    if (!stem)
        return neph_fail_memory(reader->diag);
    const bool is_fit = *stem && strlen(stem) <= NAME_MAX_BYTES && neph_is_identifier(stem);
    enum neph_status status = NEPH_OK;
    neph_document_quote(stem, stem_quote);
    neph_document_quote(scene->name ? scene->name : stem, quote);
    if (scene->name && !neph_is_identifier(scene->name))
        status = neph_refuse(reader, "name", "'%s' is not a name; use only a-z, 0-9 and _", quote);
    else if (scene->name && strcmp(scene->name, stem))
        status = neph_refuse(reader, "name", "'%s' differs from the name of the file, '%s.yaml'",
                             quote, stem_quote);
    else if (!is_fit)
        status = neph_refuse(reader, "",
                             "the name of the file, '%s', names the scene, and it is not a name; "
                             "rename the file: 1 to %d of a-z, 0-9 and _, and .yaml",
                             stem_quote, NAME_MAX_BYTES);
    else if (!scene->name)
        scene->name = neph_arena_text(reader->arena, stem);
    free(stem);
    return status;
}

/* The older name of the key is accepted, with a warning. */
static enum neph_status finish_texts(struct neph_reader *reader, struct neph_written_scene *written)
{
    struct neph_scene *scene = &written->scene;
    enum neph_status status = NEPH_OK;
    if (has_control(scene->title, ""))
        status = neph_refuse(reader, "title", "a title is one line without control characters");
    if (written->old_description && scene->description)
        return neph_also(reader, status,
                         neph_refuse(reader, "physics",
                                     "physics is the older name of description, which is given, "
                                     "too; leave physics out"));
    if (written->old_description) {
        const yaml_node_t *node = neph_document_find(reader->document, "physics");
        scene->description = written->old_description;
        scene->warning = neph_arena_format(reader->arena,
                                           "%s:%zu: the key `physics` is now called `description`",
                                           reader->errors->file, node->start_mark.line + 1);
    }
    if (!scene->description)
        scene->description = "";
    return has_control(scene->description, "\n")
               ? neph_also(reader, status,
                           neph_refuse(reader, "description", "control characters in the text"))
               : status;
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
    {"name", NEPH_TEXT, SCENE(name), .note = "a-z, 0-9 and _; the name of the file without .yaml",
     .least = 1, .most = NAME_MAX_BYTES, .standard = "the name of the file",
     .hashing = NEPH_NOT_HASHED},
    {"title", NEPH_TEXT, SCENE(title), .note = "one line", .least = 1, .most = TITLE_MAX,
     .hashing = NEPH_NOT_HASHED},
    {"description", NEPH_TEXT, SCENE(description),
     .note = "what the scene isolates and which truth applies", .least = 1, .most = DESCRIPTION_MAX,
     .standard = "none", .hashing = NEPH_NOT_HASHED},
    {"physics", NEPH_TEXT, offsetof(struct neph_written_scene, old_description),
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
static enum neph_status finish_chain(struct neph_reader *reader, struct neph_written_scene *written)
{
    struct neph_scene *scene = &written->scene;
    const char *path = scene->path, *slash = strrchr(path, '/');
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

static enum neph_status finish_lights(struct neph_reader *reader,
                                      struct neph_written_scene *written)
{
    return neph_check_lights(reader, &written->scene);
}

static enum neph_status finish_views(struct neph_reader *reader, struct neph_written_scene *written)
{
    return neph_check_views(reader, &written->scene);
}

static enum neph_status finish_wind(struct neph_reader *reader, struct neph_written_scene *written)
{
    return neph_check_wind(reader, &written->scene);
}

static enum neph_status finish_injections(struct neph_reader *reader,
                                          struct neph_written_scene *written)
{
    return neph_check_injections(reader, &written->scene);
}

static enum neph_status finish_fog_look(struct neph_reader *reader,
                                        struct neph_written_scene *written)
{
    return neph_check_fog_look(reader, &written->scene);
}

static enum neph_status finish_gates(struct neph_reader *reader, struct neph_written_scene *written)
{
    const struct neph_scene *scene = &written->scene;
    enum neph_status status = NEPH_OK;
    char why[128], quote[NEPH_QUOTE_SIZE];
    for (int g = 0; g < scene->gate_count && written->check; g++) {
        if (written->check(scene->gates[g].metric, why, sizeof(why)))
            continue;
        neph_refuse(reader, neph_at("gates[%d].metric", g).text, "'%s' %s",
                    neph_document_quote(scene->gates[g].metric, quote), why);
        neph_hint(reader->diag, "`neph metrics` lists them");
        status = neph_also(reader, status, NEPH_ERR_INPUT);
    }
    return status;
}

/* What needs several keys of the scene, in this order. A step is left out where one of its keys has
 * an error: its own error could follow from that. */
static const struct {
    const char *keys; /* separated by spaces */
    enum neph_status (*run)(struct neph_reader *reader, struct neph_written_scene *written);
} finish_steps[] = {
    {"name", finish_name},
    {"title description physics", finish_texts},
    {"display", finish_chain},
    {"solids scattering", neph_finish_solids},
    {"solids lights", finish_lights},
    {"camera frames solids", finish_views},
    {"wind frames media", finish_wind},
    {"inject camera media", finish_injections},
    {"fog_look media", finish_fog_look},
    {"gates", finish_gates},
};

static enum neph_status finish(struct neph_reader *reader, enum neph_status so_far, void *written_)
{
    struct neph_written_scene *written = written_;
    struct neph_scene *scene = &written->scene;
    scene->failing = &written->failing;
    scene->injections = &written->injections;
    if (neph_is_sound(reader, "sun"))
        neph_finish_sun(written);
    enum neph_status status = neph_arena_check(reader->arena, reader->diag);
    for (size_t i = 0; i < sizeof(finish_steps) / sizeof(finish_steps[0]); i++)
        if (neph_is_sound(reader, finish_steps[i].keys))
            status = neph_also(reader, status, finish_steps[i].run(reader, written));
    return so_far || status ? status : neph_scene_hash(scene, reader->diag);
}

/* How a file is read. */
struct reading {
    const struct neph_failing *failing; /* whose sweep it is read at a point of; NULL: as it is */
    int point;
    neph_gate_metric_check *check;
};

static enum neph_status load_document(struct neph_document *document, const char *path,
                                      neph_gate_metric_check *check, struct neph_scene **scene,
                                      struct neph_diag *diag)
{
    struct neph_written_scene *written = calloc(1, sizeof(*written));
    if (!written)
        return neph_fail_memory(diag);
    struct neph_arena *arena = &written->scene.arena;
    written->check = check;
    written->scene.path = neph_arena_text(arena, path);
    const enum neph_status status = neph_read_document(document, arena, neph_scene_fields, finish,
                                                       written, diag);
    if (status)
        neph_scene_destroy(&written->scene);
    else
        *scene = &written->scene;
    return status;
}

static enum neph_status load_text(const char *path, const char *text, size_t size,
                                  const struct reading *reading, struct neph_scene **scene,
                                  struct neph_diag *diag)
{
    struct neph_document document;
    enum neph_status status = neph_document_init(&document, path, text, size,
                                                 NEPH_DOCUMENT_DEPTH_MAX, diag);
    if (status)
        return status;
    if (reading->failing)
        status = neph_failing_put_point(&document, reading->failing, reading->point, diag);
    if (!status)
        status = load_document(&document, path, reading->check, scene, diag);
    neph_document_finish(&document);
    return status;
}

static enum neph_status read_text(const char *path, char **text, size_t *size,
                                  struct neph_diag *diag)
{
    if (!neph_is_volume_scene(path))
        return neph_file_read(path, NEPH_DOCUMENT_MAX_BYTES, text, size, diag);
    const char *slash = strrchr(path, '/');
    const enum neph_status status = neph_volume_scene_text(path, slash ? slash + 1 : path, text,
                                                           diag);
    if (!status)
        *size = strlen(*text);
    return status;
}

static enum neph_status load_file(const char *path, const struct reading *reading,
                                  struct neph_scene **scene, struct neph_diag *diag)
{
    /* Numbers have a decimal point, whatever the locale of the caller. */
    locale_t c_locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    if (!c_locale)
        return neph_fail_memory(diag);
    locale_t before = uselocale(c_locale);
    char *text = NULL;
    size_t size = 0;
    enum neph_status status = read_text(path, &text, &size, diag);
    if (!status)
        status = load_text(path, text, size, reading, scene, diag);
    uselocale(before);
    freelocale(c_locale);
    free(text);
    return status;
}

enum neph_status neph_scene_load(const char *path, struct neph_scene **scene,
                                 struct neph_diag *diag)
{
    return neph_scene_load_checked(path, NULL, scene, diag);
}

enum neph_status neph_scene_load_checked(const char *path, neph_gate_metric_check *check,
                                         struct neph_scene **scene, struct neph_diag *diag)
{
    const struct reading reading = {.check = check};
    return load_file(path, &reading, scene, diag);
}

enum neph_status neph_scene_load_point(const struct neph_scene *scene, int point,
                                       struct neph_scene **made, struct neph_diag *diag)
{
    const struct reading reading = {.failing = scene->failing, .point = point};
    return load_file(scene->path, &reading, made, diag);
}

/* --- Names and end --- */

char *neph_scene_name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *start = slash ? slash + 1 : path;
    const char *dot = strrchr(start, '.');
    char *name = dot ? strndup(start, (size_t)(dot - start)) : strdup(start);
    for (char *at = name; at && *at && neph_is_volume_scene(path); at++)
        *at = (char)(strchr(name_characters, tolower((unsigned char)*at))
                         ? tolower((unsigned char)*at)
                         : '_');
    return name;
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
