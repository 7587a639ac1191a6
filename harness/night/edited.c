/* SPDX-License-Identifier: MIT
 *
 * Renders the accepted versions of edited scenes with the current program, from the store's copies
 * (scene_copy.h), so that an edit does not hide a regression.
 */
#include "harness/night/work.h"

#include "base/clock.h"
#include "base/files.h"
#include "base/path.h"
#include "harness/data.h"
#include "harness/night/scene_copy.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The text of a finding after the accepted version was rendered. */
static const char *format_render_note(struct neph_night_work *work, const char *copy)
{
    return neph_arena_format(&work->night->arena,
                             "this run's program rendered the accepted version again, from '%s', "
                             "and its numbers are compared with the accepted numbers",
                             copy);
}

/* ---- a data folder with another version of a scene ------------------------------------------- */

/* Make the folder `to` with a link to each entry of `from` except the entry `but`. */
static enum neph_status link_entries(const char *from, const char *to, const char *but,
                                     struct neph_arena *arena, struct neph_diag *diag)
{
    struct neph_names names = {NULL, 0};
    enum neph_status status = neph_dir_create(to, diag);
    if (!status)
        status = neph_dir_list(from, arena, &names, diag);
    for (int i = 0; i < names.count && !status; i++) {
        const char *name = names.list[i];
        const struct neph_path link = neph_path_in(to, name);
        if (name[0] != '.' && strcmp(name, but) != 0 &&
            symlink(neph_path_in(from, name).text, link.text) != 0)
            status = neph_fail(diag, NEPH_ERR_IO, "cannot make '%s': %s", link.text,
                               strerror(errno));
    }
    return status;
}

/* The subfolder of scenes/ that contains a scene. */
static const char *find_scene_subfolder(const char *data, const char *scene,
                                        struct neph_arena *arena)
{
    static const char *const names[] = {"stress", "failure"}; /* the current name and the previous
                                                                 release's */
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        const char *path = neph_arena_format(arena, "%s/scenes/%s/%s.yaml", data, names[i], scene);
        if (path && neph_path_exists(path))
            return names[i];
    }
    return "catalog";
}

/* Make `folder` a data folder for NEPH_DATA_DIR: links to the project's files, and the copy in
 * place of the scene's current file. `*path` is the path of the copy. */
static enum neph_status make_data(const char *folder, const struct neph_history_scene *scene,
                                  const char *copy, struct neph_arena *arena, const char **path,
                                  struct neph_diag *diag)
{
    char *named = neph_data_directory();
    char *data = named ? realpath(named, NULL) : NULL;
    free(named);
    if (!data)
        return neph_fail(diag, NEPH_ERR_IO, "the project's files cannot be found: %s",
                         strerror(errno));
    const char *within = find_scene_subfolder(data, scene->scene, arena);
    const char *file = neph_arena_format(arena, "%s.yaml", scene->scene);
    const char *const parts[][2] = {{"", "scenes"}, {"/scenes", within}};
    enum neph_status status = neph_dir_remove(folder, diag);
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]) && !status; i++)
        status = link_entries(neph_arena_format(arena, "%s%s", data, parts[i][0]),
                              neph_arena_format(arena, "%s%s", folder, parts[i][0]), parts[i][1],
                              arena, diag);
    if (!status)
        status = link_entries(neph_arena_format(arena, "%s/scenes/%s", data, within),
                              neph_arena_format(arena, "%s/scenes/%s", folder, within), file, arena,
                              diag);
    *path = neph_arena_format(arena, "%s/scenes/%s/%s", folder, within, file);
    if (!status)
        status = neph_file_copy(copy, *path, diag);
    free(data);
    return status;
}

/* The scene must still have its recorded hash: the copy may have been edited, or a volume file that
 * it refers to may have been replaced. */
static enum neph_status check_version(const char *path, const struct neph_history_scene *scene,
                                      struct neph_diag *diag)
{
    char terms[NEPH_HASH_HEX_SIZE] = "";
    struct neph_scene *loaded = NULL;
    enum neph_status status = neph_data_load_scene(path, &loaded, diag);
    if (!status)
        status = neph_scene_terms(loaded, terms, diag);
    if (!status && (strcmp(loaded->hash, scene->hash) != 0 || strcmp(terms, scene->terms) != 0))
        status = neph_fail(diag, NEPH_ERR_INPUT,
                           "its copy, or a file that it names, has changed since");
    neph_scene_destroy(loaded);
    return status;
}

/* ---- one scene ------------------------------------------------------------------------------- */

/* Read the state of an edit from the store: `*done` when this run has rendered the accepted
 * version; `*scene` is the scene of the baseline run, without a name when the store has no record
 * of it. */
static enum neph_status read_edit_state(struct neph_night_work *work,
                                        const struct neph_night_edit *edit, bool *done,
                                        struct neph_history_scene *scene, struct neph_diag *diag)
{
    int64_t count = 0;
    struct neph_database *index = NULL;
    struct neph_records scenes = {NULL, 0};
    const char *name = neph_arena_format(&work->night->arena, "%s%s", edit->step, neph_as_accepted);
    enum neph_status status = neph_store_index(work->store, &index, diag);
    if (!status)
        status = neph_database_count(index, &count, diag,
                                     "SELECT count(*) FROM steps WHERE night = ? AND name = ?",
                                     "is", work->night->id, name);
    if (!status)
        status = neph_record_select(
            index, &work->night->arena, &neph_history_scene_form, &scenes, diag,
            "SELECT step, scene, hash, terms FROM night_scenes WHERE night = ? AND step = ?", "is",
            edit->accepted, edit->step);
    neph_database_close(index);
    *done = count > 0;
    *scene = scenes.count > 0 ? *(const struct neph_history_scene *)scenes.list
                              : (struct neph_history_scene){.step = edit->step};
    return status;
}

/* A copy of the run's environment in which NEPH_DATA_DIR names the folder `data`. */
static enum neph_status place_with_data(const struct neph_night_work *work, const char *data,
                                        struct neph_step_place *place, struct neph_diag *diag)
{
    static const char name[] = "NEPH_DATA_DIR=";
    int count = 0;
    *place = (struct neph_step_place){.arena = work->place.arena,
                                      .program_path = work->place.program_path,
                                      .host = work->place.host};
    place->variables[count++] = neph_arena_format(place->arena, "%s%s", name, data);
    for (int i = 0; work->place.variables[i]; i++) {
        if (count == NEPH_STEP_VARIABLES - 1)
            return neph_fail(diag, NEPH_ERR_USAGE, "the environment has too many variables");
        if (strncmp(work->place.variables[i], name, sizeof(name) - 1) != 0)
            place->variables[count++] = work->place.variables[i];
    }
    return neph_arena_check(place->arena, diag);
}

static enum neph_status measure(struct neph_night_work *work, int index, const char *data,
                                struct neph_night_numbers *numbers, struct neph_diag *diag)
{
    struct neph_step_place *place = calloc(1, sizeof(*place));
    enum neph_status status = place ? place_with_data(work, data, place, diag)
                                    : neph_fail_memory(diag);
    if (!status)
        status = neph_step_measure(place, &work->night->plan.steps[index], work->params->output,
                                   neph_night_log(work, index, "_as_accepted.log"),
                                   neph_night_limit_s(work, index), numbers, diag);
    free(place);
    return status;
}

/* Put the hash of the accepted version into the names of the numbers. Results of stress tests
 * contain no hash, so they were named after the scene's current file. Numbers of other versions are
 * removed. */
static void name_accepted(const struct neph_night_edit *edit,
                          const struct neph_history_scene *scene, struct neph_arena *arena,
                          struct neph_night_numbers *numbers)
{
    const char *accepted = neph_arena_format(arena, "@%.8s/", scene->hash);
    const char *edited = neph_arena_format(arena, "%s/", strchr(edit->after, '@'));
    int count = 0;
    for (int i = 0; i < numbers->count && accepted && edited; i++) {
        struct neph_measurement *number = &numbers->list[i];
        const char *at = strstr(number->series, edited);
        if (at)
            number->series = neph_arena_format(arena, "%.*s%s%s", (int)(at - number->series),
                                               number->series, accepted, at + strlen(edited));
        if (number->series && strstr(number->series, accepted))
            numbers->list[count++] = *number;
    }
    numbers->count = count;
}

static enum neph_status store_numbers(struct neph_night_work *work,
                                      const struct neph_night_edit *edit,
                                      const struct neph_night_numbers *numbers, double wall_s,
                                      struct neph_diag *diag)
{
    struct neph_database *index = NULL;
    const struct neph_history_step record = {
        .name = neph_arena_format(&work->night->arena, "%s%s", edit->step, neph_as_accepted),
        .outcome = neph_step_done,
        .reason = "",
        .size = numbers->size,
        .wall_s = wall_s,
        .calibration_s = NAN};
    enum neph_status status = neph_store_index(work->store, &index, diag);
    if (!status)
        status = neph_history_add(index, work->night->id, &record, numbers->list, numbers->count,
                                  diag);
    neph_database_close(index);
    return status;
}

static enum neph_status render(struct neph_night_work *work, const struct neph_history_scene *scene,
                               const char *copy, int index, struct neph_night_numbers *numbers,
                               struct neph_diag *diag)
{
    struct neph_arena *arena = &work->night->arena;
    const char *path = NULL;
    char *output = realpath(work->folder, NULL);
    const char *folder = neph_arena_format(arena, "%s/as_accepted", output ? output : "");
    enum neph_status status = output ? make_data(folder, scene, copy, arena, &path, diag)
                                     : neph_fail(diag, NEPH_ERR_IO, "cannot find '%s': %s",
                                                 work->folder, strerror(errno));
    if (!status)
        status = check_version(path, scene, diag);
    if (!status)
        status = measure(work, index, folder, numbers, diag);
    if (output)
        neph_dir_remove(folder, NULL);
    free(output);
    return status;
}

/* ---- all edits ------------------------------------------------------------------------------- */

static enum neph_status render_edit(struct neph_night_work *work, struct neph_night_edit *edit,
                                    struct neph_diag *diag)
{
    struct neph_night_numbers numbers = {.count = 0, .size = ""};
    struct neph_diag why = {.line = 0};
    struct neph_history_scene scene;
    const char *copy = "";
    bool done = false;
    const struct neph_night_step *step = neph_night_plan_find(&work->night->plan, edit->step);
    const int index = step ? (int)(step - work->night->plan.steps) : -1;
    const double start_s = neph_wall_s(),
                 left_s = work->params->budget_s - (start_s - work->start_s);
    enum neph_status status = read_edit_state(work, edit, &done, &scene, diag);
    if (status || index < 0)
        return status;
    if (!scene.scene)
        status = neph_fail(&why, NEPH_ERR_NOT_FOUND, "the store has no copy of it");
    else
        copy = neph_scene_copy_path(neph_store_folder(work->store), &scene, &work->night->arena);
    if (!done && neph_night_step_cost(step, &work->history[index]) > left_s) {
        edit->words = "no time was left to render the accepted version once more";
        return NEPH_OK;
    }
    if (!status && !done)
        status = render(work, &scene, copy, index, &numbers, &why);
    if (!status) {
        name_accepted(edit, &scene, &work->night->arena, &numbers);
        edit->words = format_render_note(work, copy);
        return done ? NEPH_OK : store_numbers(work, edit, &numbers, neph_wall_s() - start_s, diag);
    }
    if (neph_step_ends_night(status, &why, diag))
        return status;
    edit->words = neph_arena_format(&work->night->arena,
                                    "the accepted version could not be rendered once more: %s",
                                    why.message);
    return NEPH_OK;
}

enum neph_status neph_night_render_accepted(struct neph_night_work *work,
                                            struct neph_night_scope *scope, struct neph_diag *diag)
{
    struct neph_database *index = NULL;
    struct neph_night_edit *edits = NULL;
    int count = 0;
    enum neph_status status = neph_store_index(work->store, &index, diag);
    if (!status)
        status = neph_lost_edits(index, work->night->id, work->params->against, &work->night->arena,
                                 &edits, &count, diag);
    neph_database_close(index);
    for (int i = 0; i < count && !status; i++)
        status = render_edit(work, &edits[i], diag);
    if (!status) {
        scope->edits = edits;
        scope->edit_count = count;
    }
    return status;
}
