/* SPDX-License-Identifier: MIT
 *
 * The history of nightly runs: documents, rows, and how one is made of the other.
 */
#include "harness/run/history.h"

#include "base/clock.h"
#include "base/files.h"
#include "base/lock.h"
#include "base/path.h"
#include "harness/json_file.h"
#include "harness/progress.h"
#include "harness/run/history_documents.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Fails to compile when a kind is added, as the table `documents` needs a row for it. */
_Static_assert(NEPH_DOCUMENT_COUNT == 3, "a new kind");

static const size_t document_limit_bytes = 256 << 20;

/* ---- documents ------------------------------------------------------------------------------- */

static const struct {
    const char *prefix, *format, *known;
} documents[] = {
    [NEPH_DOCUMENT_NIGHT] = {"night-", "neph-night-1",
                             "SELECT count(*) FROM nights WHERE id = ? AND ended_utc != ''"},
    [NEPH_DOCUMENT_ACCEPTANCE] = {"accept-", "neph-accept-1",
                                  "SELECT count(*) FROM acceptances WHERE id = ?"},
    [NEPH_DOCUMENT_COPY] = {"copy-of-accept-", "neph-accept-1",
                            "SELECT count(*) FROM acceptances WHERE id = ?"},
};

struct neph_path neph_document_path(const char *store_folder, enum neph_document kind,
                                    int64_t number)
{
    return neph_path_format("%s/history/%s%06lld.json", store_folder, documents[kind].prefix,
                            (long long)number);
}

enum neph_status neph_history_has(struct neph_database *index, int64_t night, bool *has,
                                  struct neph_diag *diag)
{
    int64_t count = 0;
    const enum neph_status status = neph_database_count(
        index, &count, diag, documents[NEPH_DOCUMENT_NIGHT].known, "i", night);
    *has = count > 0;
    return status;
}

bool neph_history_is_over(const char *store_folder, int64_t night)
{
    return neph_path_exists(neph_document_path(store_folder, NEPH_DOCUMENT_NIGHT, night).text);
}

/* -1: the file is not of this kind. */
int64_t neph_document_number(const char *name, enum neph_document kind)
{
    const size_t length = strlen(documents[kind].prefix);
    char *end;
    if (strncmp(name, documents[kind].prefix, length) != 0 || !isdigit(name[length]))
        return -1;
    const long long number = strtoll(name + length, &end, 10);
    return strcmp(end, ".json") == 0 && number > 0 ? number : -1;
}

enum neph_status neph_document_write(const char *store_folder, enum neph_document kind,
                                     int64_t number, const json_t *document, struct neph_diag *diag)
{
    const enum neph_status status = neph_dir_create(neph_path_in(store_folder, "history").text,
                                                    diag);
    return status ? status
                  : neph_json_write(document, JSON_INDENT(1),
                                    neph_document_path(store_folder, kind, number).text, diag);
}

/* A document takes its number, even a damaged document without rows. */
static bool has_document_file(const char *store_folder, enum neph_document kind, int64_t number)
{
    return neph_path_exists(neph_document_path(store_folder, kind, number).text);
}

/* The first free number, from `number` on. */
static int64_t next_number(const char *store_folder, enum neph_document kind, int64_t number)
{
    while (has_document_file(store_folder, kind, number))
        number++;
    return number;
}

/* Refuses to replace an existing document. */
static enum neph_status write_new_document(const char *store_folder, enum neph_document kind,
                                           int64_t number, const json_t *document,
                                           struct neph_diag *diag)
{
    return has_document_file(store_folder, kind, number)
               ? neph_fail(diag, NEPH_ERR_IO, "'%s' exists",
                           neph_document_path(store_folder, kind, number).text)
               : neph_document_write(store_folder, kind, number, document, diag);
}

/* Checks the values that rows of the document cannot do without. */
static bool is_complete_document(const json_t *document, enum neph_document kind)
{
    size_t i;
    const json_t *step;
    bool whole = strcmp(neph_json_text(document, "format"), documents[kind].format) == 0;
    if (kind != NEPH_DOCUMENT_NIGHT)
        return whole && neph_json_text(document, "series")[0] &&
               json_integer_value(json_object_get(document, "night")) > 0;
    json_array_foreach(json_object_get(document, "steps"), i, step)
        whole = whole && json_is_number(json_object_get(step, "wall_s"));
    return whole;
}

enum neph_status neph_document_read(const char *path, enum neph_document kind, json_t **document,
                                    struct neph_diag *diag)
{
    json_t *read = NULL;
    const enum neph_status status = neph_json_read(path, document_limit_bytes, &read, diag);
    if (status)
        return status;
    if (!is_complete_document(read, kind)) {
        json_decref(read);
        return neph_fail(diag, NEPH_ERR_INPUT, "it is no complete %s", documents[kind].format);
    }
    *document = read;
    return NEPH_OK;
}

enum neph_status neph_document_digest_night(const char *store_folder, int64_t night,
                                            char digest[NEPH_HASH_HEX_SIZE], struct neph_diag *diag)
{
    json_t *document = NULL;
    const struct neph_path path = neph_document_path(store_folder, NEPH_DOCUMENT_NIGHT, night);
    digest[0] = '\0';
    if (neph_document_read(path.text, NEPH_DOCUMENT_NIGHT, &document, NULL))
        return NEPH_OK;
    const enum neph_status status = neph_json_digest(document, digest, diag);
    json_decref(document);
    return status;
}

/* ---- rows of documents ----------------------------------------------------------------------- */

#define STEP(member) NEPH_RECORD_FIELD(struct neph_history_step, member)
const struct neph_record_form neph_history_step_form = {
    sizeof(struct neph_history_step),
    {STEP(name), STEP(outcome), STEP(reason), STEP(size), STEP(wall_s),
     NEPH_RECORD_OPTIONAL(struct neph_history_step, calibration_s)}};

/* A measurement as a row. "frame" is optional: older documents do not have it. */
struct measured {
    const char *series, *step, *kind;
    double value, standard_error;
    const char *environment, *judgement, *frame;
};
#define MEASURED(member) NEPH_RECORD_FIELD(struct measured, member)
#define MAYBE_MEASURED(member) NEPH_RECORD_OPTIONAL(struct measured, member)
static const struct neph_record_form measured_form = {
    sizeof(struct measured),
    {MEASURED(series), MEASURED(step), MEASURED(kind), MAYBE_MEASURED(value),
     MAYBE_MEASURED(standard_error), MEASURED(environment), MEASURED(judgement),
     MAYBE_MEASURED(frame)}};

#define SCENE(member) NEPH_RECORD_FIELD(struct neph_history_scene, member)
const struct neph_record_form neph_history_scene_form = {
    sizeof(struct neph_history_scene), {SCENE(step), SCENE(scene), SCENE(hash), SCENE(terms)}};

/* The heads of documents; a row has no "format". */
struct head {
    const char *format;
    int64_t night;
    const char *started_utc, *ended_utc, *plan, *revision, *program, *host, *verdict;
};
#define HEAD(member) NEPH_RECORD_FIELD(struct head, member)
static const struct neph_record_form head_form = {sizeof(struct head),
                                                  {HEAD(format), HEAD(night), HEAD(started_utc),
                                                   HEAD(ended_utc), HEAD(plan), HEAD(revision),
                                                   HEAD(program), HEAD(host), HEAD(verdict)}};

struct acceptance {
    const char *format;
    int64_t acceptance;
    const char *series;
    int64_t night;
    const char *who, *when_utc, *why;
};
#define ACCEPTANCE(member) NEPH_RECORD_FIELD(struct acceptance, member)
static const struct neph_record_form acceptance_form = {
    sizeof(struct acceptance),
    {ACCEPTANCE(format), ACCEPTANCE(acceptance), ACCEPTANCE(series), ACCEPTANCE(night),
     ACCEPTANCE(who), ACCEPTANCE(when_utc), ACCEPTANCE(why)}};

union row {
    struct neph_history_step step;
    struct measured measured;
    struct neph_history_scene scene;
    const char *frame;
};

/* The lists of a nightly run's document. */
static const struct list {
    const char *name, *question, *insert;
    const struct neph_record_form *form;
    bool may_lack; /* older documents do not have the list */
} step_list = {"steps",
               "SELECT name, outcome, reason, size, wall_s, calibration_s FROM steps WHERE night = "
               "? ORDER BY name",
               "INSERT OR REPLACE INTO steps VALUES (?, ?, ?, ?, ?, ?, ?)", &neph_history_step_form,
               false},
  measurement_list =
      {"measurements",
       "SELECT name, step, kind, value, standard_error, environment, judgement, frame FROM "
       "measurements JOIN series ON series.id = measurements.series WHERE night = ? ORDER BY "
       "name",
       "INSERT OR REPLACE INTO measurements VALUES (?, (SELECT id FROM series WHERE name = ?), ?, "
       "?, ?, ?, ?, ?, ?)",
       &measured_form, false},
  scene_list = {"scenes",
                "SELECT step, scene, hash, terms FROM night_scenes WHERE night = ? ORDER BY step",
                "INSERT OR REPLACE INTO night_scenes VALUES (?, ?, ?, ?, ?)",
                &neph_history_scene_form, true},
  frame_list = {"frames", "SELECT key FROM night_frames WHERE night = ? ORDER BY key",
                "INSERT OR IGNORE INTO night_frames VALUES (?, ?)", &neph_record_text_form, false};
static const struct list *const lists[] = {&step_list, &measurement_list, &scene_list, &frame_list};
enum { LISTS = sizeof(lists) / sizeof(lists[0]) };

/* `row` points to a union row, or to the member that the list uses. */
static enum neph_status insert(struct neph_database *index, const struct list *list, int64_t night,
                               const void *row, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (list == &measurement_list)
        status = neph_database_do(index, diag, "INSERT OR IGNORE INTO series (name) VALUES (?)",
                                  "s", ((const struct measured *)row)->series);
    return status ? status : neph_record_put(index, diag, list->insert, night, list->form, row);
}

enum neph_status neph_history_add_scene(struct neph_database *index, int64_t night,
                                        const struct neph_history_scene *scene,
                                        struct neph_diag *diag)
{
    return insert(index, &scene_list, night, scene, diag);
}

static enum neph_status insert_lists(struct neph_database *index, int64_t night,
                                     const json_t *document, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < LISTS; i++) {
        const json_t *of_document = json_object_get(document, lists[i]->name);
        for (size_t k = 0; !status && k < json_array_size(of_document); k++) {
            union row row;
            neph_record_read(lists[i]->form, json_array_get(of_document, k), NULL, &row);
            status = insert(index, lists[i], night, &row, diag);
        }
    }
    return status;
}

static enum neph_status insert_head(struct neph_database *index, int64_t night,
                                    const struct head *head, struct neph_diag *diag)
{
    return neph_record_put(index, diag,
                           "INSERT INTO nights VALUES (?1, ?4, ?5, ?6, ?7, ?8, ?9, ?10)", night,
                           &head_form, head);
}

static enum neph_status delete_run_rows(struct neph_database *index, int64_t night,
                                        struct neph_diag *diag)
{
    static const char *const statements[] = {
        "DELETE FROM measurements WHERE night = ?", "DELETE FROM steps WHERE night = ?",
        "DELETE FROM night_scenes WHERE night = ?", "DELETE FROM night_frames WHERE night = ?",
        "DELETE FROM nights WHERE id = ?"};
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; !status && i < sizeof(statements) / sizeof(statements[0]); i++)
        status = neph_database_do(index, diag, statements[i], "i", night);
    return status;
}

static enum neph_status insert_night(struct neph_database *index, int64_t night,
                                     const json_t *document, struct neph_diag *diag)
{
    struct head head;
    neph_record_read(&head_form, document, NULL, &head);
    enum neph_status status = delete_run_rows(index, night, diag);
    if (!status)
        status = insert_head(index, night, &head, diag);
    return status ? status : insert_lists(index, night, document, diag);
}

/* IGNORE: another process may have found the new document and inserted it first. */
static enum neph_status insert_acceptance(struct neph_database *index, int64_t number,
                                          const json_t *document, struct neph_diag *diag)
{
    struct acceptance acceptance;
    neph_record_read(&acceptance_form, document, NULL, &acceptance);
    return neph_record_put(index, diag,
                           "INSERT OR IGNORE INTO acceptances VALUES (?1, ?4, ?5, ?6, ?7, ?8)",
                           number, &acceptance_form, &acceptance);
}

enum neph_status neph_document_insert(struct neph_database *index, enum neph_document kind,
                                      int64_t number, const json_t *document,
                                      struct neph_diag *diag)
{
    enum neph_status status = neph_database_begin(index, diag);
    if (!status)
        status = kind == NEPH_DOCUMENT_NIGHT ? insert_night(index, number, document, diag)
                                             : insert_acceptance(index, number, document, diag);
    return neph_database_end(index, status, diag);
}

/* ---- new documents --------------------------------------------------------------------------- */

static enum neph_status index_document(struct neph_database *index, const char *store_folder,
                                       enum neph_document kind, int64_t number,
                                       struct neph_diag *diag)
{
    int64_t known = 0;
    json_t *document = NULL;
    enum neph_status status = neph_database_count(index, &known, diag, documents[kind].known, "i",
                                                  number);
    if (status || known > 0)
        return status;
    struct neph_diag why = {.line = 0};
    const struct neph_path path = neph_document_path(store_folder, kind, number);
    status = neph_document_read(path.text, kind, &document, &why);
    if (!status)
        status = neph_document_insert(index, kind, number, document, diag);
    else if (status == NEPH_ERR_MEMORY)
        return neph_fail_memory(diag);
    else
        neph_progress_warn("'%s' is left out of the history: %s", path.text, why.message);
    json_decref(document);
    return document ? status : NEPH_OK;
}

enum neph_status neph_history_list(const char *store_folder, struct neph_arena *arena,
                                   struct neph_names *names, struct neph_diag *diag)
{
    const struct neph_path folder = neph_path_in(store_folder, "history");
    *names = (struct neph_names){NULL, 0};
    return neph_path_exists(folder.text) ? neph_dir_list(folder.text, arena, names, diag) : NEPH_OK;
}

enum neph_status neph_history_refresh(struct neph_database *index, const char *store_folder,
                                      struct neph_diag *diag)
{
    static const enum neph_document kinds[] = {NEPH_DOCUMENT_NIGHT, NEPH_DOCUMENT_ACCEPTANCE};
    struct neph_arena arena = {NULL};
    struct neph_names names;
    enum neph_status status = neph_history_list(store_folder, &arena, &names, diag);
    for (size_t k = 0; k < 2; k++) /* nightly runs first: acceptances refer to them */
        for (int i = 0; i < names.count && !status; i++) {
            const int64_t number = neph_document_number(names.list[i], kinds[k]);
            if (number > 0)
                status = index_document(index, store_folder, kinds[k], number, diag);
        }
    neph_arena_finish(&arena);
    return status;
}

/* ---- an unfinished run ----------------------------------------------------------------------- */

static enum neph_status delete_unfinished_runs(struct neph_database *index, int64_t but,
                                               struct neph_diag *diag)
{
    int64_t night;
    enum neph_status status;
    do {
        night = 0;
        status = neph_database_count(index, &night, diag,
                                     "SELECT id FROM nights WHERE ended_utc = '' AND id != ?", "i",
                                     but);
        if (!status && night > 0)
            status = delete_run_rows(index, night, diag);
    } while (!status && night > 0);
    return status;
}

static enum neph_status insert_beginning(struct neph_database *index,
                                         const struct neph_history_night *night, int64_t id,
                                         const char *started_utc, struct neph_diag *diag)
{
    const struct head head = {.format = "",
                              .started_utc = started_utc,
                              .ended_utc = "",
                              .plan = night->plan,
                              .revision = night->revision,
                              .program = night->program,
                              .host = night->host,
                              .verdict = ""};
    return insert_head(index, id, &head, diag);
}

/* A new number, also above the numbers in acceptances: one may refer to a run without rows. */
static enum neph_status insert_new_night(struct neph_database *index, const char *store_folder,
                                         const struct neph_history_night *night, int64_t *id,
                                         struct neph_diag *diag)
{
    char now[32];
    neph_utc_now(now);
    enum neph_status status = neph_database_count(
        index, id, diag,
        "SELECT coalesce(max(id), 0) + 1 FROM (SELECT id FROM nights UNION SELECT night FROM "
        "acceptances)",
        "");
    if (status)
        return status;
    *id = next_number(store_folder, NEPH_DOCUMENT_NIGHT, *id);
    return insert_beginning(index, night, *id, now, diag);
}

static enum neph_status find_or_insert_night(struct neph_database *index, const char *store_folder,
                                             const struct neph_history_night *night, int64_t *id,
                                             bool *resumed, struct neph_diag *diag)
{
    *id = 0;
    enum neph_status status = neph_database_count(
        index, id, diag,
        "SELECT id FROM nights WHERE ended_utc = '' AND plan = ? AND revision = ? AND program = ? "
        "AND host = ? ORDER BY id DESC",
        "ssss", night->plan, night->revision, night->program, night->host);
    if (has_document_file(store_folder, NEPH_DOCUMENT_NIGHT, *id))
        *id = 0; /* its document exists, so it could not be finished */
    *resumed = *id > 0;
    if (!status)
        status = delete_unfinished_runs(index, *id, diag);
    return status || *resumed ? status : insert_new_night(index, store_folder, night, id, diag);
}

enum neph_status neph_history_begin(struct neph_database *index, const char *store_folder,
                                    const struct neph_history_night *night, int64_t *id,
                                    bool *resumed, struct neph_diag *diag)
{
    int64_t found = 0;
    bool is_old = false;
    enum neph_status status = neph_database_begin(index, diag);
    if (!status)
        status = find_or_insert_night(index, store_folder, night, &found, &is_old, diag);
    status = neph_database_end(index, status, diag);
    if (!status) {
        *id = found;
        *resumed = is_old;
    }
    return status;
}

enum neph_status neph_history_adopt(struct neph_database *index, const char *store_folder,
                                    const struct neph_history_night *night, int64_t id,
                                    const char *started_utc, struct neph_diag *diag)
{
    if (neph_history_is_over(store_folder, id))
        return neph_fail(diag, NEPH_ERR_IO, "night %lld is over: its document is in '%s/history'",
                         (long long)id, store_folder);
    enum neph_status status = neph_database_begin(index, diag);
    if (!status)
        status = delete_unfinished_runs(index, 0, diag);
    if (!status)
        status = insert_beginning(index, night, id, started_utc, diag);
    return neph_database_end(index, status, diag);
}

enum neph_status neph_history_add(struct neph_database *index, int64_t night,
                                  const struct neph_history_step *step,
                                  const struct neph_measurement *measured, int count,
                                  struct neph_diag *diag)
{
    enum neph_status status = neph_database_begin(index, diag);
    if (!status)
        status = insert(index, &step_list, night, step, diag);
    for (int i = 0; i < count && !status; i++) {
        const struct neph_measurement *m = &measured[i];
        const struct measured row = {m->series,         step->name,     m->kind, m->value,
                                     m->standard_error, m->environment, "",      m->frame};
        status = insert(index, &measurement_list, night, &row, diag);
    }
    return neph_database_end(index, status, diag);
}

enum neph_status neph_history_judge(struct neph_database *index, int64_t night, const char *series,
                                    const char *judgement, struct neph_diag *diag)
{
    return neph_database_do(index, diag,
                            "UPDATE measurements SET judgement = ? WHERE night = ? AND series = "
                            "(SELECT id FROM series WHERE name = ?)",
                            "sis", judgement, night, series);
}

/* ---- documents from rows --------------------------------------------------------------------- */

/* The rows of a query about a nightly run as a JSON list. */
static enum neph_status list_rows(struct neph_database *index, const char *question, int64_t night,
                                  const struct neph_record_form *form, json_t **list,
                                  struct neph_diag *diag)
{
    enum neph_status status = neph_record_list(index, form, list, diag, question, "i", night);
    if (!status && !*list) {
        status = neph_fail(diag, NEPH_ERR_INPUT,
                           "a row of night %lld in the store's database is damaged",
                           (long long)night);
        neph_hint(diag, "rebuild it with `neph store check --repair`");
    }
    return status;
}

enum neph_status neph_history_document(struct neph_database *index, int64_t night,
                                       json_t **document, struct neph_diag *diag)
{
    json_t *heads = NULL;
    enum neph_status status = list_rows(
        index,
        "SELECT 'neph-night-1', id, started_utc, ended_utc, plan, revision, "
        "program, host, verdict FROM nights WHERE id = ?",
        night, &head_form, &heads, diag);
    if (!status && json_array_size(heads) == 0)
        status = neph_fail(diag, NEPH_ERR_NOT_FOUND, "there is no night %lld", (long long)night);
    json_t *made = status ? NULL : json_incref(json_array_get(heads, 0));
    json_decref(heads);
    for (int i = 0; !status && i < LISTS; i++) {
        json_t *list = NULL;
        status = list_rows(index, lists[i]->question, night, lists[i]->form, &list, diag);
        if (!status && lists[i]->may_lack && json_array_size(list) == 0)
            json_decref(list);
        else if (!status)
            status = neph_json_put(made, lists[i]->name, list, diag);
    }
    if (status)
        json_decref(made);
    else
        *document = made;
    return status;
}

enum neph_status neph_history_acceptances(struct neph_database *index, json_t **list,
                                          struct neph_diag *diag)
{
    return list_rows(index,
                     "SELECT 'neph-accept-1', id, series, night, who, when_utc, why FROM "
                     "acceptances WHERE id > ? "
                     "ORDER BY id",
                     0, &acceptance_form, list, diag);
}

/* ---- finished runs and acceptances ----------------------------------------------------------- */

enum neph_status neph_history_end(struct neph_database *index, const char *store_folder,
                                  int64_t night, const char *verdict, const json_t *frames,
                                  struct neph_diag *diag)
{
    char now[32];
    json_t *document = NULL;
    neph_utc_now(now);
    enum neph_status status = neph_history_document(index, night, &document, diag);
    if (!status)
        status = neph_json_put(document, "ended_utc", json_string(now), diag);
    if (!status)
        status = neph_json_put(document, "verdict", json_string(verdict), diag);
    if (!status)
        status = neph_json_put(document, "frames", json_copy((json_t *)frames), diag);
    if (!status)
        status = write_new_document(store_folder, NEPH_DOCUMENT_NIGHT, night, document, diag);
    if (!status)
        status = neph_document_insert(index, NEPH_DOCUMENT_NIGHT, night, document, diag);
    json_decref(document);
    return status;
}

enum neph_status neph_history_last(struct neph_database *index, int64_t *night,
                                   struct neph_diag *diag)
{
    return neph_database_count(index, night, diag,
                               "SELECT coalesce(max(id), 0) FROM nights WHERE ended_utc != ''", "");
}

enum neph_status neph_history_check_acceptable(struct neph_database *index, const char *series,
                                               int64_t night, struct neph_diag *diag)
{
    int64_t count = 1;
    bool has = false;
    enum neph_status status = neph_history_has(index, night, &has, diag);
    if (!status && !has)
        return neph_fail(diag, NEPH_ERR_NOT_FOUND, "there is no night %lld that is over",
                         (long long)night);
    if (!status && strcmp(series, "*") != 0)
        status = neph_database_count(index, &count, diag,
                                     "SELECT count(*) FROM measurements JOIN series ON series.id = "
                                     "measurements.series WHERE name = ?1 AND (night = ?2 OR night "
                                     "IN (SELECT night FROM acceptances WHERE night < ?2))",
                                     "si", series, night);
    if (!status && count == 0) {
        status = neph_fail(diag, NEPH_ERR_NOT_FOUND,
                           "neither night %lld nor an accepted one has measured '%s'",
                           (long long)night, series);
        neph_hint(diag, "list their measurements with `neph store export`");
    }
    return status;
}

/* Runs in a transaction: number, document and row belong together, and two acceptances at the same
 * time get different numbers. */
static enum neph_status number_acceptance(struct neph_database *index, const char *store_folder,
                                          json_t *document, struct neph_diag *diag)
{
    int64_t number = 0;
    struct neph_diag why = {.line = 0};
    enum neph_status status = neph_database_count(
        index, &number, diag, "SELECT coalesce(max(id), 0) + 1 FROM acceptances", "");
    number = next_number(store_folder, NEPH_DOCUMENT_ACCEPTANCE, number);
    if (!status)
        status = neph_json_put(document, "acceptance", json_integer(number), diag);
    if (!status)
        status = write_new_document(store_folder, NEPH_DOCUMENT_ACCEPTANCE, number, document, diag);
    /* The acceptance is valid without the copy. */
    if (!status && neph_document_write(store_folder, NEPH_DOCUMENT_COPY, number, document, &why))
        neph_progress_warn("acceptance %lld has no copy: %s", (long long)number, why.message);
    return status ? status : insert_acceptance(index, number, document, diag);
}

/* Each host may have its own database; the store's lock file is common to all hosts. */
static enum neph_status insert_accepted(struct neph_database *index, const char *store_folder,
                                        json_t *document, struct neph_diag *diag)
{
    int lock = -1;
    enum neph_status status = neph_lock_wait(neph_path_in(store_folder, ".neph-lock").text, &lock,
                                             diag);
    if (status)
        return status;
    status = neph_database_begin(index, diag);
    if (!status)
        status = neph_database_end(index, number_acceptance(index, store_folder, document, diag),
                                   diag);
    close(lock);
    return status;
}

enum neph_status neph_history_accept(struct neph_database *index, const char *store_folder,
                                     const char *series, int64_t night, const char *who,
                                     const char *why, struct neph_diag *diag)
{
    char now[32], digest[NEPH_HASH_HEX_SIZE] = "";
    neph_utc_now(now);
    enum neph_status status = neph_history_check_acceptable(index, series, night, diag);
    if (!status)
        status = neph_document_digest_night(store_folder, night, digest, diag);
    if (status)
        return status;
    json_t *document = json_pack("{s:s, s:n, s:s, s:I, s:s, s:s, s:s}", "format",
                                 documents[NEPH_DOCUMENT_ACCEPTANCE].format, "acceptance", "series",
                                 series, "night", (json_int_t)night, "who", who, "when_utc", now,
                                 "why", why);
    status = neph_json_check(document, diag);
    if (!status && digest[0])
        status = neph_json_put(document, "night_blake2b", json_string(digest), diag);
    if (!status)
        status = insert_accepted(index, store_folder, document, diag);
    json_decref(document);
    return status;
}
