/* SPDX-License-Identifier: MIT
 *
 * Reads suites of scenes from JSON files.
 */
#include "harness/study/suites.h"

#include "harness/data.h"

#include <stdlib.h>
#include <string.h>

static enum neph_status load(const char *file, const char *format, json_t **content,
                             struct neph_diag *diag)
{
    json_error_t error;
    char *path = neph_data_path(file);
    if (!path)
        return neph_fail_memory(diag);
    json_t *loaded = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
    enum neph_status status = NEPH_OK;
    if (!loaded || strcmp(neph_json_text(loaded, "format"), format) != 0) {
        status = neph_fail(diag, NEPH_ERR_INPUT, "%s",
                           loaded ? "this is no file of suites for this kind of study"
                                  : error.text);
        neph_locate(diag, path, loaded ? 1 : error.line, loaded ? 1 : error.column);
        json_decref(loaded);
    } else {
        *content = loaded;
    }
    free(path);
    return status;
}

/* Checks that each scene is in one suite only, once, and has a reason. */
static enum neph_status check(const json_t *suites, struct neph_diag *diag)
{
    json_t *seen = json_object();
    enum neph_status status = seen ? NEPH_OK : neph_fail_memory(diag);
    const char *suite;
    json_t *scenes;
    json_object_foreach((json_t *)suites, suite, scenes)
    {
        for (size_t i = 0; i < json_array_size(scenes) && !status; i++) {
            const json_t *entry = json_array_get(scenes, i);
            const char *name = neph_json_text(entry, "scene");
            if (!*name || !*neph_json_text(entry, "reason"))
                status = neph_fail(diag, NEPH_ERR_INPUT,
                                   "entry %zu of the suite %s lacks a scene or a reason", i, suite);
            else if (json_object_get(seen, name))
                status = neph_fail(diag, NEPH_ERR_INPUT, "the scene %s is in the suites twice",
                                   name);
            else
                status = neph_json_put(seen, name, json_true(), diag);
        }
    }
    json_decref(seen);
    return status;
}

static enum neph_status refuse_shut(const char *name, const char *reason, struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_USAGE, "the suite %s is shut: %s", name, reason);
    neph_hint(diag, "choose by another suite; then `neph study flicker --open-shut-suite` measures "
                    "this one");
    return NEPH_ERR_USAGE;
}

static enum neph_status refuse(const char *name, const json_t *suites, struct neph_diag *diag)
{
    char names[256] = "";
    const char *suite;
    json_t *scenes;
    neph_fail(diag, NEPH_ERR_USAGE, "there is no suite '%s'", name);
    json_object_foreach((json_t *)suites, suite, scenes)
    {
        strncat(names, " ", sizeof(names) - strlen(names) - 1);
        strncat(names, suite, sizeof(names) - strlen(names) - 1);
    }
    neph_hint(diag, "suites are:%s", names);
    return NEPH_ERR_USAGE;
}

enum neph_status neph_suite_find(const char *file, const char *format, const char *name,
                                 bool opens_shut, json_t **entries, struct neph_diag *diag)
{
    json_t *content = NULL;
    enum neph_status status = load(file, format, &content, diag);
    const json_t *suites = json_object_get(content, "suites");
    if (!status)
        status = check(suites, diag);
    if (!status && !json_object_get(suites, name))
        status = refuse(name, suites, diag);
    const char *shut = neph_json_text(json_object_get(content, "shut"), name);
    if (!status && *shut && !opens_shut)
        status = refuse_shut(name, shut, diag);
    if (!status)
        *entries = json_incref(json_object_get(suites, name));
    json_decref(content);
    return status;
}

const char *neph_suite_scene(const json_t *entry, struct neph_arena *arena)
{
    const char *scene = neph_json_text(entry, "scene");
    char *path = strchr(scene, '/') ? neph_data_path(scene) : strdup(scene);
    arena->is_short |= !path;
    scene = neph_arena_copy_text(arena, path);
    free(path);
    return scene;
}

enum neph_status neph_flicker_suite_find(const char *name, bool opens_shut,
                                         struct neph_arena *arena, const char *const **scenes,
                                         int *count, struct neph_diag *diag)
{
    json_t *entries = NULL;
    const enum neph_status status = neph_suite_find(
        "scenes/studies/flicker.json", "neph-flicker-suites-1", name, opens_shut, &entries, diag);
    if (status)
        return status;
    *count = (int)json_array_size(entries);
    const char **names = neph_arena_allocate(arena, (size_t)*count + 1, sizeof(*names));
    for (int i = 0; i < *count && names; i++)
        names[i] = neph_suite_scene(json_array_get(entries, (size_t)i), arena);
    *scenes = names;
    json_decref(entries);
    return neph_arena_check(arena, diag);
}
