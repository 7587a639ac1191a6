/* SPDX-License-Identifier: MIT */
#include "harness/failure/page.h"

#include "base/clock.h"
#include "base/files.h"
#include "harness/failure/exhibit.h"
#include "harness/failure/output.h"
#include "harness/report/page.h"
#include "harness/report/report_folder.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_FAILURE_STATE_COUNT == 3, "a new kind");

static const struct neph_page_parts parts = {.files = {"failure.html", "failure.js"}};

struct neph_failure_page {
    struct neph_report_folder *folder;
    size_t limit_bytes;
};

/* ---- what is shown --------------------------------------------------------------------------- */

/* Evidence of a column of a scenario at its worst point. */
struct shown {
    const struct neph_failure_spot *spot;
    json_t *record; /* owned */
    size_t bytes;
    bool fits;
};

/* All of a run, the worst first. */
struct gallery {
    struct neph_failure_spot *spots; /* owned */
    int spot_count;
    struct shown *shown; /* owned */
    int shown_count, left_out;
    size_t bytes;
};

static size_t pictures_size(const char *folder, const json_t *record)
{
    const json_t *names = json_object_get(record, "pictures");
    size_t sum = 0;
    for (size_t i = 0; i < json_array_size(names); i++)
        sum += neph_page_file_size(folder, json_string_value(json_array_get(names, i)));
    return sum;
}

static bool is_shown(const struct gallery *gallery, const struct neph_failure_spot *spot)
{
    for (int i = 0; i < gallery->shown_count; i++)
        if (gallery->shown[i].spot->column == spot->column &&
            gallery->shown[i].spot->row->scene == spot->row->scene)
            return true;
    return false;
}

static const char *exhibit_of(const struct neph_failure_spot *spot)
{
    return spot->row->cells[spot->column].exhibit;
}

static void finish_gallery(struct gallery *gallery)
{
    for (int i = 0; i < gallery->shown_count; i++)
        json_decref(gallery->shown[i].record);
    free(gallery->shown);
    free(gallery->spots);
}

/* ---- pictures -------------------------------------------------------------------------------- */

/* Pictures are known by the entry that they are of, so that what is there is right. */
static char *picture_folder(const struct shown *shown)
{
    const char *exhibit = exhibit_of(shown->spot);
    return neph_format("images/%.24s", strrchr(exhibit, '/') + 1);
}

static enum neph_status copy_pictures(const struct shown *shown, const char *folder,
                                      struct neph_diag *diag)
{
    const json_t *names = json_object_get(shown->record, "pictures");
    enum neph_status status = neph_dir_create(folder, diag);
    for (size_t i = 0; i < json_array_size(names) && !status; i++) {
        const char *name = json_string_value(json_array_get(names, i));
        status = neph_page_copy(exhibit_of(shown->spot), name, folder, name, diag);
    }
    return status;
}

static bool is_wanted(const struct gallery *gallery, const char *name)
{
    for (int i = 0; i < gallery->shown_count; i++) {
        char *own = picture_folder(&gallery->shown[i]);
        const bool same = own && gallery->shown[i].fits &&
                          strcmp(own + strlen("images/"), name) == 0;
        free(own);
        if (same)
            return true;
    }
    return false;
}

/* What worse cells took the place of. */
static enum neph_status remove_unwanted(const struct gallery *gallery, const char *images,
                                        struct neph_diag *diag)
{
    DIR *directory = opendir(images);
    enum neph_status status = NEPH_OK;
    for (const struct dirent *entry; directory && !status && (entry = readdir(directory));) {
        if (entry->d_name[0] == '.' || is_wanted(gallery, entry->d_name))
            continue;
        char *path = neph_path_join(images, entry->d_name);
        status = path ? neph_dir_remove(path, diag) : neph_fail_memory(diag);
        free(path);
    }
    if (directory)
        closedir(directory);
    return status;
}

static enum neph_status hang_pictures(const struct gallery *gallery, const char *work,
                                      struct neph_diag *diag)
{
    char *images = neph_path_join(work, "images");
    enum neph_status status = images ? remove_unwanted(gallery, images, diag)
                                     : neph_fail_memory(diag);
    for (int i = 0; i < gallery->shown_count && !status; i++) {
        char *name = picture_folder(&gallery->shown[i]);
        char *folder = name ? neph_path_join(work, name) : NULL;
        if (!folder)
            status = neph_fail_memory(diag);
        else if (gallery->shown[i].fits && !neph_path_is_dir(folder))
            status = copy_pictures(&gallery->shown[i], folder, diag);
        free(name);
        free(folder);
    }
    free(images);
    return status;
}

/* ---- data ------------------------------------------------------------------------------------ */

static const char *const state_names[] = {
    [NEPH_FAILURE_RUNNING] = "running",
    [NEPH_FAILURE_FINISHED] = "finished",
    [NEPH_FAILURE_INTERRUPTED] = "interrupted",
};

static json_t *size_json(const struct neph_failure_suite *suite, const struct neph_scene *scene)
{
    return suite->width_px > 0
               ? json_pack("[i, i]", suite->width_px, suite->height_px)
               : json_pack("[i, i]", scene->failing.width_px, scene->failing.height_px);
}

static json_t *shown_json(const struct neph_failure_suite *suite, const struct shown *shown)
{
    char *folder = picture_folder(shown);
    json_t *item = json_deep_copy(shown->record);
    neph_json_set(&item, "scene", json_string(shown->spot->row->scene->name));
    neph_json_set(&item, "column", json_string(suite->columns[shown->spot->column].name));
    neph_json_set(&item, "point", json_string(shown->spot->row->point));
    neph_json_set(&item, "size_px", size_json(suite, shown->spot->row->scene));
    neph_json_set(&item, "folder", folder ? json_string(folder) : NULL);
    free(folder);
    return item;
}

static json_t *evidence_json(const struct neph_failure_suite *suite, const struct gallery *gallery)
{
    json_t *list = json_array();
    for (int i = 0; i < gallery->shown_count; i++)
        if (gallery->shown[i].fits)
            neph_json_add(&list, shown_json(suite, &gallery->shown[i]));
    return list;
}

/* How each column of a scenario is made by hand, at its worst point. */
static json_t *commands_json(const struct neph_failure_suite *suite, const struct gallery *gallery)
{
    json_t *all = json_object();
    for (int i = 0; i < gallery->spot_count; i++) {
        const struct neph_failure_spot *spot = &gallery->spots[i];
        const char *scene = spot->row->scene->name, *column = suite->columns[spot->column].name;
        json_t *of_scene = json_object_get(all, scene);
        if (!of_scene) {
            neph_json_set(&all, scene, json_object());
            of_scene = json_object_get(all, scene);
        }
        if (!of_scene || json_object_get(of_scene, column))
            continue;
        char *command = neph_failure_command(suite, spot->row, spot->column);
        if (json_object_set_new(of_scene, column, command ? json_string(command) : NULL) < 0) {
            json_decref(all);
            all = NULL;
        }
        free(command);
    }
    return all;
}

static json_t *document_of(const struct neph_failure_suite *suite, const struct gallery *gallery,
                           size_t limit_bytes)
{
    char created[32];
    json_t *document = neph_failure_json(suite);
    neph_utc_now(created);
    neph_json_set(&document, "state", json_string(state_names[suite->state]));
    neph_json_set(&document, "created_utc", json_string(created));
    neph_json_set(&document, "neph_version", json_string(NEPH_VERSION));
    neph_json_set(&document, "progress",
                  json_pack("{s:i, s:i, s:f}", "done", suite->steps_done, "total",
                            suite->steps_total, "left_s",
                            suite->left_s > 0.0 ? suite->left_s : 0.0));
    neph_json_set(&document, "pictures",
                  json_pack("{s:I, s:I, s:i}", "limit_bytes", (json_int_t)limit_bytes, "bytes",
                            (json_int_t)gallery->bytes, "left_out", gallery->left_out));
    neph_json_set(&document, "difference_colours", neph_page_difference_colours());
    neph_json_set(&document, "evidence", evidence_json(suite, gallery));
    neph_json_set(&document, "commands", commands_json(suite, gallery));
    return document;
}

/* ---- what fits ------------------------------------------------------------------------------- */

/* In data.json and in data.js, where a "<" takes five bytes more. */
static size_t data_size(const json_t *json)
{
    return 2 * json_dumpb(json, NULL, 0, JSON_INDENT(1)) + 200;
}

static enum neph_status add_shown(const struct neph_failure_suite *suite, struct gallery *gallery,
                                  const struct neph_failure_spot *spot, size_t *room_bytes,
                                  struct neph_diag *diag)
{
    json_t *record = NULL;
    char *path = neph_path_join(exhibit_of(spot), "job.json");
    if (!path)
        return neph_fail_memory(diag);
    record = json_load_file(path, 0, NULL);
    free(path);
    if (!record) /* somebody cleans the store: there is nothing to show */
        return NEPH_OK;
    struct shown *shown = &gallery->shown[gallery->shown_count++];
    *shown = (struct shown){
        .spot = spot, .record = record, .bytes = pictures_size(exhibit_of(spot), record)};
    json_t *entry = shown_json(suite, shown);
    const size_t bytes = shown->bytes + data_size(entry);
    json_decref(entry);
    shown->fits = bytes <= *room_bytes;
    *room_bytes -= shown->fits ? bytes : 0;
    gallery->bytes += shown->fits ? shown->bytes : 0;
    gallery->left_out += !shown->fits;
    return NEPH_OK;
}

/* What is left of the limit beside all that is no evidence. */
static size_t room_for_evidence(const struct neph_failure_page *page,
                                const struct neph_failure_suite *suite,
                                const struct gallery *gallery)
{
    const char *work = neph_report_folder_work(page->folder);
    json_t *document = document_of(suite, gallery, page->limit_bytes);
    const size_t taken = data_size(document) + neph_page_size(work, &parts);
    json_decref(document);
    return page->limit_bytes > taken ? page->limit_bytes - taken : 0;
}

static enum neph_status make_gallery(const struct neph_failure_page *page,
                                     const struct neph_failure_suite *suite,
                                     struct gallery *gallery, struct neph_diag *diag)
{
    *gallery = (struct gallery){.spots = NULL};
    gallery->spots = neph_failure_worst(suite, &gallery->spot_count);
    gallery->shown = calloc((size_t)gallery->spot_count + 1, sizeof(*gallery->shown));
    enum neph_status status = gallery->spots && gallery->shown ? NEPH_OK : neph_fail_memory(diag);
    size_t room_bytes = status ? 0 : room_for_evidence(page, suite, gallery);
    for (int i = 0; i < gallery->spot_count && !status; i++)
        if (exhibit_of(&gallery->spots[i]) && !is_shown(gallery, &gallery->spots[i]))
            status = add_shown(suite, gallery, &gallery->spots[i], &room_bytes, diag);
    return status;
}

/* ---- the page -------------------------------------------------------------------------------- */

enum neph_status neph_failure_page_open(const char *folder, size_t limit_bytes,
                                        struct neph_failure_page **page, struct neph_diag *diag)
{
    struct neph_failure_page *opened = calloc(1, sizeof(*opened));
    if (!opened)
        return neph_fail_memory(diag);
    opened->limit_bytes = limit_bytes;
    enum neph_status status = neph_report_folder_open(folder, &opened->folder, diag);
    if (!status)
        status = neph_page_start(neph_report_folder_work(opened->folder), &parts, NULL, diag);
    if (status) {
        neph_failure_page_close(opened);
        return status;
    }
    *page = opened;
    return NEPH_OK;
}

void neph_failure_page_close(struct neph_failure_page *page)
{
    if (!page)
        return;
    neph_report_folder_close(page->folder);
    free(page);
}

enum neph_status neph_failure_page_publish(const struct neph_failure_suite *suite, void *page_,
                                           struct neph_diag *diag)
{
    const struct neph_failure_page *page = page_;
    struct gallery gallery;
    json_t *document = NULL;
    enum neph_status status = make_gallery(page, suite, &gallery, diag);
    if (!status)
        status = hang_pictures(&gallery, neph_report_folder_work(page->folder), diag);
    if (!status) {
        document = document_of(suite, &gallery, page->limit_bytes);
        status = neph_json_check(document, diag);
    }
    if (!status)
        status = neph_page_publish(page->folder, "NEPH_FAILURE", document, diag);
    json_decref(document);
    finish_gallery(&gallery);
    return status;
}
