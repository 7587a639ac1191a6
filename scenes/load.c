/* SPDX-License-Identifier: MIT
 *
 * Loads a scene file: reads and parses it, fills the structs from the tables, runs the checks that
 * need the whole scene, and hashes it.
 */
#include "scenes/load.h"

#include "base/files.h"
#include "scenes/errors.h"
#include "scenes/media.h"
#include "scenes/mesh.h"
#include "scenes/volume_scene.h"

#include <ctype.h>
#include <locale.h>
#include <stdlib.h>
#include <string.h>

/* A scene without a name has the name of its file. */
static enum neph_status finish_name(struct neph_reader *reader, struct neph_written_scene *written)
{
    struct neph_scene *scene = &written->scene;
    char quote[NEPH_QUOTE_SIZE], stem_quote[NEPH_QUOTE_SIZE];
    char *stem = neph_scene_name_from_path(scene->path);
    if (!stem)
        return neph_fail_memory(reader->diag);
    const bool is_fit = *stem && strlen(stem) <= NEPH_NAME_MAX_BYTES && neph_is_identifier(stem);
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
                             stem_quote, NEPH_NAME_MAX_BYTES);
    else if (!scene->name)
        scene->name = neph_arena_copy_text(reader->arena, stem);
    free(stem);
    return status;
}

/* The key's older name is accepted, with a warning. */
static enum neph_status finish_texts(struct neph_reader *reader, struct neph_written_scene *written)
{
    struct neph_scene *scene = &written->scene;
    enum neph_status status = NEPH_OK;
    if (neph_has_control(scene->title, ""))
        status = neph_refuse(reader, "title", "a title is one line without control characters");
    if (written->old_description && scene->description)
        return neph_keep_error(
            reader, status,
            neph_refuse(
                reader, "physics",
                "physics is the older name of description, and both are given; leave physics out"));
    if (written->old_description) {
        const yaml_node_t *node = neph_document_find(reader->document, "physics");
        scene->description = written->old_description;
        scene->warning = neph_arena_format(reader->arena,
                                           "%s:%zu: the key `physics` is now called `description`",
                                           reader->errors->file, node->start_mark.line + 1);
    }
    if (!scene->description)
        scene->description = "";
    return neph_has_control(scene->description, "\n")
               ? neph_keep_error(
                     reader, status,
                     neph_refuse(reader, "description", "control characters in the text"))
               : status;
}

/* --- The file --- */

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

/* Checks that need several keys of the scene, in this order. A step is skipped when one of its keys
 * has an error, because an error of the step could be a consequence. */
static const struct {
    const char *keys; /* separated by spaces */
    enum neph_status (*run)(struct neph_reader *reader, struct neph_written_scene *written);
} finish_steps[] = {
    {"name", finish_name},
    {"title description physics", finish_texts},
    {"display", neph_finish_chain},
    {"solids scattering", neph_finish_solids},
    {"solids lights frames", finish_lights},
    {"camera frames solids", finish_views},
    {"wind frames media", finish_wind},
    {"inject camera media", finish_injections},
    {"fog_look media", finish_fog_look},
    {"gates", neph_finish_gates},
};

static enum neph_status finish(struct neph_reader *reader, enum neph_status so_far, void *written_)
{
    struct neph_written_scene *written = written_;
    struct neph_scene *scene = &written->scene;
    scene->gates = &written->gates;
    scene->display = &written->display;
    scene->failing = &written->failing;
    scene->injections = &written->injections;
    if (neph_were_keys_read(reader, "sun"))
        neph_finish_sun(written);
    enum neph_status status = neph_arena_check(reader->arena, reader->diag);
    for (size_t i = 0; i < sizeof(finish_steps) / sizeof(finish_steps[0]); i++)
        if (neph_were_keys_read(reader, finish_steps[i].keys))
            status = neph_keep_error(reader, status, finish_steps[i].run(reader, written));
    if (!status)
        status = neph_arena_check(reader->arena, reader->diag);
    return so_far || status ? status : neph_scene_hash(scene, reader->diag);
}

/* Options of reading a file. */
struct reading {
    const struct neph_failing *failing; /* the sweep of `point`; NULL: the file as it is */
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
    written->scene.path = neph_arena_copy_text(arena, path);
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
    /* Numbers have a decimal point in any locale of the caller. */
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

char *neph_scene_name_from_path(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *start = slash ? slash + 1 : path;
    const char *dot = strrchr(start, '.');
    char *name = dot ? strndup(start, (size_t)(dot - start)) : strdup(start);
    for (char *at = name; at && *at && neph_is_volume_scene(path); at++)
        *at = (char)(strchr(NEPH_NAME_CHARACTERS, tolower((unsigned char)*at))
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
    for (int i = 0; i < scene->mesh_count && !scene->borrows; i++)
        neph_mesh_destroy(scene->meshes[i]);
    if (!scene->borrows)
        neph_arena_finish(&scene->arena);
    free(scene);
}
