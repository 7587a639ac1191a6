/* SPDX-License-Identifier: MIT
 *
 * The page of the stress tests: selection of evidence within a size limit, data, publication.
 */
#include "harness/stress/page.h"

#include "base/clock.h"
#include "base/files.h"
#include "base/path.h"
#include "harness/report/page.h"
#include "harness/report/report_folder.h"
#include "harness/stress/output.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when a state is added, as the table of names needs a row for it. */
_Static_assert(NEPH_STRESS_STATE_COUNT == 3, "a new kind");

static const struct neph_page_parts parts = {.title = "Nephelometer stress tests",
                                             .files = {"stress.html", "stress.js"}};

/* ---- evidence -------------------------------------------------------------------------------- */

/* Evidence of a column of a scene, at its worst point. */
struct page_evidence {
    const struct neph_stress_cell_id *spot;
    const char *evidence; /* folder of the store entry */
    const char *folder;   /* folder within the page, named after the entry, so its content never
                             changes */
    json_t *entry;        /* entry of the page's data: the record of the images and their folder;
                             owned */
    size_t bytes;
    bool fits;
};

/* Evidence of a run, worst first. */
struct evidence_list {
    struct neph_arena arena;
    struct neph_stress_cell_id *spots; /* owned */
    int spot_count;
    struct page_evidence *page_evidence; /* in the arena */
    int shown_count, left_out;
    size_t bytes;
};

static bool is_shown(const struct evidence_list *list, const struct neph_stress_cell_id *spot)
{
    for (int i = 0; i < list->shown_count; i++)
        if (list->page_evidence[i].spot->column == spot->column &&
            list->page_evidence[i].spot->row->scene == spot->row->scene)
            return true;
    return false;
}

static void finish_list(struct evidence_list *list)
{
    for (int i = 0; i < list->shown_count; i++)
        json_decref(list->page_evidence[i].entry);
    free(list->spots);
    neph_arena_finish(&list->arena);
}

/* Copies the images of an entry to `work` unless they are there. */
static enum neph_status copy_images(const struct page_evidence *page_evidence, const char *work,
                                    struct neph_diag *diag)
{
    const json_t *names = json_object_get(page_evidence->entry, "pictures");
    const struct neph_path folder = neph_path_in(work, page_evidence->folder);
    if (!page_evidence->fits || neph_path_is_dir(folder.text))
        return NEPH_OK;
    enum neph_status status = neph_dir_create(folder.text, diag);
    for (size_t i = 0; i < json_array_size(names) && !status; i++) {
        const char *name = json_string_value(json_array_get(names, i));
        status = neph_page_copy(page_evidence->evidence, name, folder.text, name, diag);
    }
    return status;
}

static bool is_wanted(const struct evidence_list *list, const char *name)
{
    for (int i = 0; i < list->shown_count; i++)
        if (list->page_evidence[i].fits &&
            strcmp(list->page_evidence[i].folder + strlen("images/"), name) == 0)
            return true;
    return false;
}

/* Removes images of entries that are no longer selected. */
static enum neph_status remove_unwanted(const struct evidence_list *list, const char *images,
                                        struct neph_diag *diag)
{
    DIR *directory = opendir(images);
    enum neph_status status = NEPH_OK;
    for (const struct dirent *entry; directory && !status && (entry = readdir(directory));) {
        if (entry->d_name[0] == '.' || is_wanted(list, entry->d_name))
            continue;
        status = neph_dir_remove(neph_path_in(images, entry->d_name).text, diag);
    }
    if (directory)
        closedir(directory);
    return status;
}

static enum neph_status update_images(struct evidence_list *list, const char *work,
                                      struct neph_diag *diag)
{
    enum neph_status status = remove_unwanted(list, neph_path_in(work, "images").text, diag);
    for (int i = 0; i < list->shown_count && !status; i++)
        status = copy_images(&list->page_evidence[i], work, diag);
    return status;
}

/* ---- data ------------------------------------------------------------------------------------ */

static const char *const state_names[] = {
    [NEPH_STRESS_RUNNING] = "running",
    [NEPH_STRESS_FINISHED] = "finished",
    [NEPH_STRESS_INTERRUPTED] = "interrupted",
};

/* Merges the members of `more` into `object`, taking ownership of both. NULL when either is NULL or
 * memory is short. */
static json_t *merge_objects(json_t *object, json_t *more)
{
    const bool is_whole = json_object_update(object, more) == 0;
    json_decref(more);
    if (!is_whole)
        json_decref(object);
    return is_whole ? object : NULL;
}

/* The command of each column of each scenario, at its worst point. */
static json_t *commands_json(const struct neph_stress_suite *suite,
                             const struct evidence_list *list)
{
    json_t *all = json_object();
    for (int i = 0; i < list->spot_count; i++) {
        const struct neph_stress_cell_id *spot = &list->spots[i];
        const char *scene = spot->row->scene->name, *column = suite->columns[spot->column].name;
        json_t *of_scene = json_object_get(all, scene);
        if (!of_scene) {
            neph_json_set(&all, scene, json_object());
            of_scene = json_object_get(all, scene);
        }
        if (!of_scene || json_object_get(of_scene, column))
            continue;
        char *command = neph_stress_command(suite, spot->row, spot->column);
        if (json_object_set_new(of_scene, column, command ? json_string(command) : NULL) < 0) {
            json_decref(all);
            all = NULL;
        }
        free(command);
    }
    return all;
}

static json_t *make_page_data(const struct neph_stress_suite *suite,
                              const struct evidence_list *list, size_t limit_bytes)
{
    char created[32];
    json_t *evidence = json_array();
    for (int i = 0; i < list->shown_count; i++)
        if (list->page_evidence[i].fits)
            neph_json_add(&evidence, json_incref(list->page_evidence[i].entry));
    neph_utc_now(created);
    return merge_objects(
        neph_stress_json(suite),
        json_pack("{s:s, s:s, s:s, s:{s:i, s:i, s:f}, s:{s:I, s:I, s:i}, s:o, s:o, s:o}", "state",
                  state_names[suite->state], "created_utc", created, "neph_version", NEPH_VERSION,
                  "progress", "done", suite->steps_done, "total", suite->steps_total, "left_s",
                  suite->left_s > 0.0 ? suite->left_s : 0.0, "pictures", "limit_bytes",
                  (json_int_t)limit_bytes, "bytes", (json_int_t)list->bytes, "left_out",
                  list->left_out, "difference_colours", neph_page_difference_colours(), "evidence",
                  evidence, "commands", commands_json(suite, list)));
}

/* ---- size limit ------------------------------------------------------------------------------ */

/* Size of a JSON value in data.json and data.js, with a reserve for escaped "<". */
static size_t data_size(const json_t *json)
{
    return 2 * json_dumpb(json, NULL, 0, JSON_INDENT(1)) + 200;
}

static enum neph_status add_shown(const struct neph_stress_suite *suite, struct evidence_list *list,
                                  const struct neph_stress_cell_id *spot, size_t *room_bytes,
                                  struct neph_diag *diag)
{
    const struct neph_scene *scene = spot->row->scene;
    const char *evidence = spot->row->cells[spot->column].evidence;
    const char *path = neph_arena_format(&list->arena, "%s/job.json", evidence);
    const char *folder = neph_arena_format(&list->arena, "images/%.24s",
                                           strrchr(evidence, '/') + 1);
    if (neph_arena_check(&list->arena, diag))
        return NEPH_ERR_MEMORY;
    const bool has_size = suite->width_px > 0;
    json_t *record = json_load_file(path, 0, NULL);
    if (!record) /* the store has removed the entry: there is nothing to show */
        return NEPH_OK;
    struct page_evidence *page_evidence = &list->page_evidence[list->shown_count++];
    *page_evidence = (struct page_evidence){.spot = spot, .evidence = evidence, .folder = folder};
    page_evidence->entry = merge_objects(
        record,
        json_pack("{s:s, s:s, s:s, s:[i, i], s:s}", "scene", scene->name, "column",
                  suite->columns[spot->column].name, "point", spot->row->point, "size_px",
                  has_size ? suite->width_px : scene->failing->width_px,
                  has_size ? suite->height_px : scene->failing->height_px, "folder", folder));
    const json_t *names = json_object_get(page_evidence->entry, "pictures");
    for (size_t i = 0; i < json_array_size(names); i++)
        page_evidence->bytes += neph_page_file_size(evidence,
                                                    json_string_value(json_array_get(names, i)));
    const size_t bytes = page_evidence->bytes + data_size(page_evidence->entry);
    page_evidence->fits = bytes <= *room_bytes;
    *room_bytes -= page_evidence->fits ? bytes : 0;
    list->bytes += page_evidence->fits ? page_evidence->bytes : 0;
    list->left_out += !page_evidence->fits;
    return NEPH_OK;
}

/* Bytes that remain for evidence after the page and its data. */
static size_t room_for_evidence(const struct neph_stress_page *page,
                                const struct neph_stress_suite *suite,
                                const struct evidence_list *list)
{
    const char *work = neph_report_folder_work(page->folder);
    json_t *document = make_page_data(suite, list, page->limit_bytes);
    const size_t taken = data_size(document) + neph_page_size(work, &parts);
    json_decref(document);
    return page->limit_bytes > taken ? page->limit_bytes - taken : 0;
}

static enum neph_status make_list(const struct neph_stress_page *page,
                                  const struct neph_stress_suite *suite, struct evidence_list *list,
                                  struct neph_diag *diag)
{
    list->spots = neph_stress_worst(suite, &list->spot_count);
    list->page_evidence = neph_arena_allocate(&list->arena, (size_t)list->spot_count + 1,
                                              sizeof(*list->page_evidence));
    enum neph_status status = list->spots && list->page_evidence ? NEPH_OK : neph_fail_memory(diag);
    size_t room_bytes = status ? 0 : room_for_evidence(page, suite, list);
    for (int i = 0; i < list->spot_count && !status; i++) {
        const struct neph_stress_cell_id *spot = &list->spots[i];
        if (spot->row->cells[spot->column].evidence && !is_shown(list, spot))
            status = add_shown(suite, list, spot, &room_bytes, diag);
    }
    return status;
}

/* ---- the page -------------------------------------------------------------------------------- */

enum neph_status neph_stress_page_open(const char *folder, struct neph_stress_page *page,
                                       struct neph_diag *diag)
{
    const enum neph_status status = neph_report_folder_open(folder, &page->folder, diag);
    return status ? status
                  : neph_page_start(neph_report_folder_work(page->folder), &parts, NULL, diag);
}

enum neph_status neph_stress_page_publish(const struct neph_stress_suite *suite,
                                          const struct neph_stress_page *page,
                                          struct neph_diag *diag)
{
    struct evidence_list list = {.spots = NULL};
    json_t *document = NULL;
    enum neph_status status = make_list(page, suite, &list, diag);
    if (!status)
        status = update_images(&list, neph_report_folder_work(page->folder), diag);
    if (!status) {
        document = make_page_data(suite, &list, page->limit_bytes);
        status = neph_json_check(document, diag);
    }
    if (!status)
        status = neph_page_publish(page->folder, "NEPH_STRESS", document, diag);
    json_decref(document);
    finish_list(&list);
    return status;
}
