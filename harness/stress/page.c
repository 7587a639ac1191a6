/* SPDX-License-Identifier: MIT */
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

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_STRESS_STATE_COUNT == 3, "a new kind");

static const struct neph_page_parts parts = {.title = "Nephelometer stress tests",
                                              .files = {"stress.html", "stress.js"}};

/* ---- evidence -------------------------------------------------------------------------------- */

/* Evidence of a column of a scene at its worst point. */
struct shown {
    const struct neph_stress_spot *spot;
    const char *evidence; /* the folder of the entry */
    const char *folder;   /* of its images in the page: known by the entry, so never out of date */
    json_t *entry;        /* of the page's data: the record of the images and their place; owned */
    size_t bytes;
    bool fits;
};

/* All evidence of a run, the worst first. */
struct gallery {
    struct neph_arena arena;
    struct neph_stress_spot *spots; /* owned */
    int spot_count;
    struct shown *shown; /* of the arena */
    int shown_count, left_out;
    size_t bytes;
};

static bool is_shown(const struct gallery *gallery, const struct neph_stress_spot *spot)
{
    for (int i = 0; i < gallery->shown_count; i++)
        if (gallery->shown[i].spot->column == spot->column &&
            gallery->shown[i].spot->row->scene == spot->row->scene)
            return true;
    return false;
}

static void finish_gallery(struct gallery *gallery)
{
    for (int i = 0; i < gallery->shown_count; i++)
        json_decref(gallery->shown[i].entry);
    free(gallery->spots);
    neph_arena_finish(&gallery->arena);
}

/* Under `work`, where an entry's images are not yet. */
static enum neph_status copy_images(const struct shown *shown, const char *work,
                                    struct neph_diag *diag)
{
    const json_t *names = json_object_get(shown->entry, "pictures");
    const struct neph_path folder = neph_path_in(work, shown->folder);
    if (!shown->fits || neph_path_is_dir(folder.text))
        return NEPH_OK;
    enum neph_status status = neph_dir_create(folder.text, diag);
    for (size_t i = 0; i < json_array_size(names) && !status; i++) {
        const char *name = json_string_value(json_array_get(names, i));
        status = neph_page_copy(shown->evidence, name, folder.text, name, diag);
    }
    return status;
}

static bool is_wanted(const struct gallery *gallery, const char *name)
{
    for (int i = 0; i < gallery->shown_count; i++)
        if (gallery->shown[i].fits &&
            strcmp(gallery->shown[i].folder + strlen("images/"), name) == 0)
            return true;
    return false;
}

/* Remove the images whose place worse cells took. */
static enum neph_status remove_unwanted(const struct gallery *gallery, const char *images,
                                        struct neph_diag *diag)
{
    DIR *directory = opendir(images);
    enum neph_status status = NEPH_OK;
    for (const struct dirent *entry; directory && !status && (entry = readdir(directory));) {
        if (entry->d_name[0] == '.' || is_wanted(gallery, entry->d_name))
            continue;
        status = neph_dir_remove(neph_path_in(images, entry->d_name).text, diag);
    }
    if (directory)
        closedir(directory);
    return status;
}

static enum neph_status update_images(struct gallery *gallery, const char *work,
                                      struct neph_diag *diag)
{
    enum neph_status status = remove_unwanted(gallery, neph_path_in(work, "images").text, diag);
    for (int i = 0; i < gallery->shown_count && !status; i++)
        status = copy_images(&gallery->shown[i], work, diag);
    return status;
}

/* ---- data ------------------------------------------------------------------------------------ */

static const char *const state_names[] = {
    [NEPH_STRESS_RUNNING] = "running",
    [NEPH_STRESS_FINISHED] = "finished",
    [NEPH_STRESS_INTERRUPTED] = "interrupted",
};

/* `object` with what is in `more`, both of which are taken over; NULL: one is, or no memory. */
static json_t *joined(json_t *object, json_t *more)
{
    const bool is_whole = json_object_update(object, more) == 0;
    json_decref(more);
    if (!is_whole)
        json_decref(object);
    return is_whole ? object : NULL;
}

/* How each column of a scenario is made by hand, at its worst point. */
static json_t *commands_json(const struct neph_stress_suite *suite, const struct gallery *gallery)
{
    json_t *all = json_object();
    for (int i = 0; i < gallery->spot_count; i++) {
        const struct neph_stress_spot *spot = &gallery->spots[i];
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

static json_t *document_of(const struct neph_stress_suite *suite, const struct gallery *gallery,
                           size_t limit_bytes)
{
    char created[32];
    json_t *evidence = json_array();
    for (int i = 0; i < gallery->shown_count; i++)
        if (gallery->shown[i].fits)
            neph_json_add(&evidence, json_incref(gallery->shown[i].entry));
    neph_utc_now(created);
    return joined(
        neph_stress_json(suite),
        json_pack("{s:s, s:s, s:s, s:{s:i, s:i, s:f}, s:{s:I, s:I, s:i}, s:o, s:o, s:o}", "state",
                  state_names[suite->state], "created_utc", created, "neph_version", NEPH_VERSION,
                  "progress", "done", suite->steps_done, "total", suite->steps_total, "left_s",
                  suite->left_s > 0.0 ? suite->left_s : 0.0, "pictures", "limit_bytes",
                  (json_int_t)limit_bytes, "bytes", (json_int_t)gallery->bytes, "left_out",
                  gallery->left_out, "difference_colours", neph_page_difference_colours(),
                  "evidence", evidence, "commands", commands_json(suite, gallery)));
}

/* ---- what fits ------------------------------------------------------------------------------- */

/* In data.json and in data.js, where a "<" takes five bytes more. */
static size_t data_size(const json_t *json)
{
    return 2 * json_dumpb(json, NULL, 0, JSON_INDENT(1)) + 200;
}

static enum neph_status add_shown(const struct neph_stress_suite *suite, struct gallery *gallery,
                                  const struct neph_stress_spot *spot, size_t *room_bytes,
                                  struct neph_diag *diag)
{
    const struct neph_scene *scene = spot->row->scene;
    const char *evidence = spot->row->cells[spot->column].evidence;
    const char *path = neph_arena_format(&gallery->arena, "%s/job.json", evidence);
    const char *folder = neph_arena_format(&gallery->arena, "images/%.24s",
                                           strrchr(evidence, '/') + 1);
    if (neph_arena_check(&gallery->arena, diag))
        return NEPH_ERR_MEMORY;
    const bool has_size = suite->width_px > 0;
    json_t *record = json_load_file(path, 0, NULL);
    if (!record) /* the store is being cleaned: there is nothing to show */
        return NEPH_OK;
    struct shown *shown = &gallery->shown[gallery->shown_count++];
    *shown = (struct shown){.spot = spot, .evidence = evidence, .folder = folder};
    shown->entry = joined(record, json_pack("{s:s, s:s, s:s, s:[i, i], s:s}", "scene", scene->name,
                                            "column", suite->columns[spot->column].name, "point",
                                            spot->row->point, "size_px",
                                            has_size ? suite->width_px : scene->failing.width_px,
                                            has_size ? suite->height_px : scene->failing.height_px,
                                            "folder", folder));
    const json_t *names = json_object_get(shown->entry, "pictures");
    for (size_t i = 0; i < json_array_size(names); i++)
        shown->bytes += neph_page_file_size(evidence, json_string_value(json_array_get(names, i)));
    const size_t bytes = shown->bytes + data_size(shown->entry);
    shown->fits = bytes <= *room_bytes;
    *room_bytes -= shown->fits ? bytes : 0;
    gallery->bytes += shown->fits ? shown->bytes : 0;
    gallery->left_out += !shown->fits;
    return NEPH_OK;
}

/* What is left of the limit beside all that is no evidence. */
static size_t room_for_evidence(const struct neph_stress_page *page,
                                const struct neph_stress_suite *suite,
                                const struct gallery *gallery)
{
    const char *work = neph_report_folder_work(page->folder);
    json_t *document = document_of(suite, gallery, page->limit_bytes);
    const size_t taken = data_size(document) + neph_page_size(work, &parts);
    json_decref(document);
    return page->limit_bytes > taken ? page->limit_bytes - taken : 0;
}

static enum neph_status make_gallery(const struct neph_stress_page *page,
                                     const struct neph_stress_suite *suite, struct gallery *gallery,
                                     struct neph_diag *diag)
{
    gallery->spots = neph_stress_worst(suite, &gallery->spot_count);
    gallery->shown = neph_arena_zeroed(&gallery->arena, (size_t)gallery->spot_count + 1,
                                       sizeof(*gallery->shown));
    enum neph_status status = gallery->spots && gallery->shown ? NEPH_OK : neph_fail_memory(diag);
    size_t room_bytes = status ? 0 : room_for_evidence(page, suite, gallery);
    for (int i = 0; i < gallery->spot_count && !status; i++) {
        const struct neph_stress_spot *spot = &gallery->spots[i];
        if (spot->row->cells[spot->column].evidence && !is_shown(gallery, spot))
            status = add_shown(suite, gallery, spot, &room_bytes, diag);
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
    struct gallery gallery = {.spots = NULL};
    json_t *document = NULL;
    enum neph_status status = make_gallery(page, suite, &gallery, diag);
    if (!status)
        status = update_images(&gallery, neph_report_folder_work(page->folder), diag);
    if (!status) {
        document = document_of(suite, &gallery, page->limit_bytes);
        status = neph_json_check(document, diag);
    }
    if (!status)
        status = neph_page_publish(page->folder, "NEPH_STRESS", document, diag);
    json_decref(document);
    finish_gallery(&gallery);
    return status;
}
