/* SPDX-License-Identifier: MIT */
#include "harness/run/history.h"

#include "base/clock.h"
#include "base/files.h"
#include "base/hash.h"
#include "base/lock.h"
#include "harness/progress.h"
#include "harness/run/history_documents.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A new kind does not compile before this file was looked through for it. */
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

char *neph_document_path(const char *store_folder, enum neph_document kind, int64_t number)
{
    return neph_format("%s/history/%s%06lld.json", store_folder, documents[kind].prefix,
                       (long long)number);
}

char *neph_history_document_path(const char *store_folder, int64_t night)
{
    return neph_document_path(store_folder, NEPH_DOCUMENT_NIGHT, night);
}

/* -1: it is none of this kind. */
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
    char *path = neph_document_path(store_folder, kind, number);
    char *text = document ? json_dumps(document, JSON_INDENT(1)) : NULL;
    char *folder = neph_path_join(store_folder, "history");
    enum neph_status status = path && text && folder ? neph_dir_create(folder, diag)
                                                     : neph_fail_memory(diag);
    if (!status)
        status = neph_file_write(path, text, strlen(text), diag);
    free(folder);
    free(text);
    free(path);
    return status;
}

/* A number is taken by its document, also by one that is torn and so has no rows. */
static enum neph_status is_taken(const char *store_folder, enum neph_document kind, int64_t number,
                                 bool *taken, struct neph_diag *diag)
{
    char *path = neph_document_path(store_folder, kind, number);
    const enum neph_status status = path ? NEPH_OK : neph_fail_memory(diag);
    *taken = path && neph_path_exists(path);
    free(path);
    return status;
}

/* The first number from `*number` on that no document has. */
static enum neph_status next_number(const char *store_folder, enum neph_document kind,
                                    int64_t *number, struct neph_diag *diag)
{
    bool taken = true;
    enum neph_status status = is_taken(store_folder, kind, *number, &taken, diag);
    while (!status && taken)
        status = is_taken(store_folder, kind, ++*number, &taken, diag);
    return status;
}

/* What is there is never written over. */
static enum neph_status write_new_document(const char *store_folder, enum neph_document kind,
                                           int64_t number, const json_t *document,
                                           struct neph_diag *diag)
{
    bool taken = false;
    const enum neph_status status = is_taken(store_folder, kind, number, &taken, diag);
    if (!status && taken)
        return neph_fail(diag, NEPH_ERR_IO, "'%s/history/%s%06lld.json' is there already",
                         store_folder, documents[kind].prefix, (long long)number);
    return status ? status : neph_document_write(store_folder, kind, number, document, diag);
}

/* What its rows cannot be without. */
static bool is_whole(const json_t *document, enum neph_document kind)
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
    char *text = NULL;
    size_t size;
    const enum neph_status status = neph_file_read(path, document_limit_bytes, &text, &size, diag);
    if (status)
        return status;
    json_t *read = json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL);
    free(text);
    if (!is_whole(read, kind)) {
        json_decref(read);
        return neph_fail(diag, NEPH_ERR_INPUT, "it is no whole %s", documents[kind].format);
    }
    *document = read;
    return NEPH_OK;
}

enum neph_status neph_document_digest(const json_t *document, char digest[NEPH_HASH_HEX_SIZE],
                                      struct neph_diag *diag)
{
    char *text = json_dumps(document, JSON_COMPACT | JSON_SORT_KEYS);
    const enum neph_status status = text ? neph_hash(text, strlen(text), digest, diag)
                                         : neph_fail_memory(diag);
    free(text);
    return status;
}

enum neph_status neph_document_digest_night(const char *store_folder, int64_t night,
                                            char digest[NEPH_HASH_HEX_SIZE], struct neph_diag *diag)
{
    json_t *document = NULL;
    char *path = neph_document_path(store_folder, NEPH_DOCUMENT_NIGHT, night);
    enum neph_status status = path ? neph_document_read(path, NEPH_DOCUMENT_NIGHT, &document, NULL)
                                   : neph_fail_memory(diag);
    digest[0] = '\0';
    if (!status)
        status = neph_document_digest(document, digest, diag);
    else if (path)
        status = NEPH_OK;
    json_decref(document);
    free(path);
    return status;
}

/* ---- rows of documents ----------------------------------------------------------------------- */

static enum neph_status insert_measurement(struct neph_database *index, int64_t night,
                                           const char *step, const struct neph_measurement *m,
                                           const char *judgement, struct neph_diag *diag)
{
    const enum neph_status status = neph_database_do(
        index, diag, "INSERT OR IGNORE INTO series (name) VALUES (?)", "s", m->series);
    return status ? status
                  : neph_database_do(index, diag,
                                     "INSERT OR REPLACE INTO measurements VALUES (?, (SELECT id "
                                     "FROM series WHERE name = ?), ?, ?, ?, ?, ?, ?, ?)",
                                     "isssddsss", night, m->series, step, m->kind, m->value,
                                     m->standard_error, m->environment, judgement, m->frame);
}

static enum neph_status insert_step(struct neph_database *index, int64_t night,
                                    const struct neph_history_step *step, struct neph_diag *diag)
{
    return neph_database_do(
        index, diag, "INSERT OR REPLACE INTO steps VALUES (?, ?, ?, ?, ?, ?, ?)", "issssdd", night,
        step->name, step->outcome, step->reason, step->size, step->wall_s, step->calibration_s);
}

enum neph_status neph_history_add_scene(struct neph_database *index, int64_t night,
                                        const struct neph_history_scene *scene,
                                        struct neph_diag *diag)
{
    return neph_database_do(index, diag,
                            "INSERT OR REPLACE INTO night_scenes VALUES (?, ?, ?, ?, ?)", "issss",
                            night, scene->step, scene->scene, scene->hash, scene->terms);
}

static enum neph_status insert_lists(struct neph_database *index, int64_t night,
                                     const json_t *document, struct neph_diag *diag)
{
    const json_t *steps = json_object_get(document, "steps"),
                 *measurements = json_object_get(document, "measurements"),
                 *scenes = json_object_get(document, "scenes"),
                 *frames = json_object_get(document, "frames");
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; !status && i < json_array_size(steps); i++) {
        const json_t *s = json_array_get(steps, i);
        const struct neph_history_step step = {
            neph_json_text(s, "name"),   neph_json_text(s, "outcome"),
            neph_json_text(s, "reason"), neph_json_text(s, "size"),
            neph_json_real(s, "wall_s"), neph_json_real(s, "calibration_s")};
        status = insert_step(index, night, &step, diag);
    }
    for (size_t i = 0; !status && i < json_array_size(measurements); i++) {
        const json_t *m = json_array_get(measurements, i);
        const struct neph_measurement measurement = {
            neph_json_text(m, "series"),      neph_json_text(m, "kind"),
            neph_json_real(m, "value"),       neph_json_real(m, "standard_error"),
            neph_json_text(m, "environment"), neph_json_text(m, "frame")};
        status = insert_measurement(index, night, neph_json_text(m, "step"), &measurement,
                                    neph_json_text(m, "judgement"), diag);
    }
    for (size_t i = 0; !status && i < json_array_size(scenes); i++) {
        const json_t *s = json_array_get(scenes, i);
        const struct neph_history_scene scene = {
            neph_json_text(s, "step"), neph_json_text(s, "scene"), neph_json_text(s, "hash"),
            neph_json_text(s, "terms")};
        status = neph_history_add_scene(index, night, &scene, diag);
    }
    for (size_t i = 0; !status && i < json_array_size(frames); i++)
        status = neph_database_do(index, diag, "INSERT OR IGNORE INTO night_frames VALUES (?, ?)",
                                  "is", night, json_string_value(json_array_get(frames, i)));
    return status;
}

static enum neph_status forget_night(struct neph_database *index, int64_t night,
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

static enum neph_status insert_night(struct neph_database *index, int64_t night, const json_t *d,
                                     struct neph_diag *diag)
{
    enum neph_status status = forget_night(index, night, diag);
    if (!status)
        status = neph_database_do(index, diag, "INSERT INTO nights VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
                                  "isssssss", night, neph_json_text(d, "started_utc"),
                                  neph_json_text(d, "ended_utc"), neph_json_text(d, "plan"),
                                  neph_json_text(d, "revision"), neph_json_text(d, "program"),
                                  neph_json_text(d, "host"), neph_json_text(d, "verdict"));
    return status ? status : insert_lists(index, night, d, diag);
}

/* Whoever opens the store while it is accepted may have found its document first. */
static enum neph_status insert_acceptance(struct neph_database *index, int64_t number,
                                          const json_t *d, struct neph_diag *diag)
{
    return neph_database_do(
        index, diag, "INSERT OR IGNORE INTO acceptances VALUES (?, ?, ?, ?, ?, ?)", "isisss",
        number, neph_json_text(d, "series"),
        (int64_t)json_integer_value(json_object_get(d, "night")), neph_json_text(d, "who"),
        neph_json_text(d, "when_utc"), neph_json_text(d, "why"));
}

/* All of a document's rows or none. */
enum neph_status neph_document_insert(struct neph_database *index, enum neph_document kind,
                                      int64_t number, const json_t *document,
                                      struct neph_diag *diag)
{
    enum neph_status status = neph_database_begin(index, diag);
    if (!status)
        status = kind == NEPH_DOCUMENT_NIGHT ? insert_night(index, number, document, diag)
                                             : insert_acceptance(index, number, document, diag);
    if (!status)
        return neph_database_commit(index, diag);
    neph_database_rollback(index);
    return status;
}

/* ---- taking over ----------------------------------------------------------------------------- */

static enum neph_status take_document(struct neph_database *index, const char *store_folder,
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
    char *path = neph_document_path(store_folder, kind, number);
    status = path ? neph_document_read(path, kind, &document, &why) : neph_fail_memory(&why);
    if (status && status != NEPH_ERR_MEMORY) {
        neph_progress_warn("'%s' is left out of the history: %s", path, why.message);
        status = NEPH_OK;
    } else if (!status) {
        status = neph_document_insert(index, kind, number, document, diag);
    } else if (diag) {
        *diag = why;
    }
    json_decref(document);
    free(path);
    return status;
}

static enum neph_status take_documents(struct neph_database *index, const char *store_folder,
                                       enum neph_document kind, struct dirent **names, int count,
                                       struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && !status; i++) {
        const int64_t number = neph_document_number(names[i]->d_name, kind);
        if (number > 0)
            status = take_document(index, store_folder, kind, number, diag);
    }
    return status;
}

enum neph_status neph_history_refresh(struct neph_database *index, const char *store_folder,
                                      struct neph_diag *diag)
{
    struct dirent **names = NULL;
    char *folder = neph_path_join(store_folder, "history");
    const int count = folder ? scandir(folder, &names, NULL, alphasort) : -1;
    enum neph_status status = folder ? NEPH_OK : neph_fail_memory(diag);
    if (folder && count < 0 && errno != ENOENT)
        status = neph_fail(diag, NEPH_ERR_IO, "cannot open '%s': %s", folder, strerror(errno));
    if (!status) /* acceptances are of nights */
        status = take_documents(index, store_folder, NEPH_DOCUMENT_NIGHT, names, count, diag);
    if (!status)
        status = take_documents(index, store_folder, NEPH_DOCUMENT_ACCEPTANCE, names, count, diag);
    for (int i = 0; i < count; i++)
        free(names[i]);
    free(names);
    free(folder);
    return status;
}

/* ---- a night that goes on -------------------------------------------------------------------- */

static enum neph_status forget_unfinished(struct neph_database *index, int64_t but,
                                          struct neph_diag *diag)
{
    int64_t night = 0;
    enum neph_status status;
    do {
        night = 0;
        status = neph_database_count(index, &night, diag,
                                     "SELECT id FROM nights WHERE ended_utc = '' AND id != ?", "i",
                                     but);
        if (!status && night > 0)
            status = forget_night(index, night, diag);
    } while (!status && night > 0);
    return status;
}

static enum neph_status insert_beginning(struct neph_database *index,
                                         const struct neph_history_night *night, int64_t id,
                                         const char *started_utc, struct neph_diag *diag)
{
    return neph_database_do(index, diag, "INSERT INTO nights VALUES (?, ?, '', ?, ?, ?, ?, '')",
                            "isssss", id, started_utc, night->plan, night->revision, night->program,
                            night->host);
}

/* One of its own: acceptances know nights that have no rows. */
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
    if (!status)
        status = next_number(store_folder, NEPH_DOCUMENT_NIGHT, id, diag);
    return status ? status : insert_beginning(index, night, *id, now, diag);
}

static enum neph_status find_or_insert_night(struct neph_database *index, const char *store_folder,
                                             const struct neph_history_night *night, int64_t *id,
                                             bool *resumed, struct neph_diag *diag)
{
    bool taken = false;
    *id = 0;
    enum neph_status status = neph_database_count(
        index, id, diag,
        "SELECT id FROM nights WHERE ended_utc = '' AND plan = ? AND revision = ? AND program = ? "
        "AND host = ? ORDER BY id DESC",
        "ssss", night->plan, night->revision, night->program, night->host);
    if (!status && *id > 0)
        status = is_taken(store_folder, NEPH_DOCUMENT_NIGHT, *id, &taken, diag);
    *id = taken ? 0 : *id; /* it could not end */
    *resumed = *id > 0;
    if (!status)
        status = forget_unfinished(index, *id, diag);
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
    if (status) {
        neph_database_rollback(index);
        return status;
    }
    status = neph_database_commit(index, diag);
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
    bool taken = false;
    enum neph_status status = is_taken(store_folder, NEPH_DOCUMENT_NIGHT, id, &taken, diag);
    if (!status && taken)
        status = neph_fail(diag, NEPH_ERR_IO, "night %lld is over: its document is in '%s/history'",
                           (long long)id, store_folder);
    if (!status)
        status = neph_database_begin(index, diag);
    if (status)
        return status;
    status = forget_unfinished(index, 0, diag);
    if (!status)
        status = insert_beginning(index, night, id, started_utc, diag);
    if (!status)
        return neph_database_commit(index, diag);
    neph_database_rollback(index);
    return status;
}

enum neph_status neph_history_add(struct neph_database *index, int64_t night,
                                  const struct neph_history_step *step,
                                  const struct neph_measurement *measurements, int count,
                                  struct neph_diag *diag)
{
    enum neph_status status = neph_database_begin(index, diag);
    if (!status)
        status = insert_step(index, night, step, diag);
    for (int i = 0; i < count && !status; i++)
        status = insert_measurement(index, night, step->name, &measurements[i], "", diag);
    if (!status)
        return neph_database_commit(index, diag);
    neph_database_rollback(index);
    return status;
}

enum neph_status neph_history_judge(struct neph_database *index, int64_t night, const char *series,
                                    const char *judgement, struct neph_diag *diag)
{
    return neph_database_do(index, diag,
                            "UPDATE measurements SET judgement = ? WHERE night = ? AND series = "
                            "(SELECT id FROM series WHERE name = ?)",
                            "sis", judgement, night, series);
}

/* ---- documents of rows ----------------------------------------------------------------------- */

typedef json_t *neph_row(struct neph_query *query);

static json_t *step_json(struct neph_query *q)
{
    return json_pack("{s:s, s:s, s:s, s:s, s:f, s:o}", "name", neph_query_text(q, 0), "outcome",
                     neph_query_text(q, 1), "reason", neph_query_text(q, 2), "size",
                     neph_query_text(q, 3), "wall_s", neph_query_real(q, 4), "calibration_s",
                     neph_json_number(neph_query_real(q, 5)));
}

/* Documents of before numbers knew their pictures have no "frame". */
static json_t *measurement_json(struct neph_query *q)
{
    json_t *json = json_pack("{s:s, s:s, s:s, s:o, s:o, s:s, s:s}", "series", neph_query_text(q, 0),
                             "step", neph_query_text(q, 1), "kind", neph_query_text(q, 2), "value",
                             neph_json_number(neph_query_real(q, 3)), "standard_error",
                             neph_json_number(neph_query_real(q, 4)), "environment",
                             neph_query_text(q, 5), "judgement", neph_query_text(q, 6));
    if (neph_query_text(q, 7)[0])
        neph_json_set(&json, "frame", json_string(neph_query_text(q, 7)));
    return json;
}

static json_t *scene_json(struct neph_query *q)
{
    return json_pack("{s:s, s:s, s:s, s:s}", "step", neph_query_text(q, 0), "scene",
                     neph_query_text(q, 1), "hash", neph_query_text(q, 2), "terms",
                     neph_query_text(q, 3));
}

static json_t *frame_json(struct neph_query *q)
{
    return json_string(neph_query_text(q, 0));
}

static json_t *head_json(struct neph_query *q)
{
    return json_pack("{s:s, s:I, s:s, s:s, s:s, s:s, s:s, s:s, s:s}", "format",
                     documents[NEPH_DOCUMENT_NIGHT].format, "night",
                     (json_int_t)neph_query_integer(q, 0), "started_utc", neph_query_text(q, 1),
                     "ended_utc", neph_query_text(q, 2), "plan", neph_query_text(q, 3), "revision",
                     neph_query_text(q, 4), "program", neph_query_text(q, 5), "host",
                     neph_query_text(q, 6), "verdict", neph_query_text(q, 7));
}

static json_t *acceptance_json(struct neph_query *q)
{
    return json_pack("{s:s, s:I, s:s, s:I, s:s, s:s, s:s}", "format",
                     documents[NEPH_DOCUMENT_ACCEPTANCE].format, "acceptance",
                     (json_int_t)neph_query_integer(q, 0), "series", neph_query_text(q, 1), "night",
                     (json_int_t)neph_query_integer(q, 2), "who", neph_query_text(q, 3), "when_utc",
                     neph_query_text(q, 4), "why", neph_query_text(q, 5));
}

/* The rows of a question about a night as a list. */
static enum neph_status list_rows(struct neph_database *index, const char *question, int64_t night,
                                  neph_row *row, json_t **list, struct neph_diag *diag)
{
    struct neph_query *query = NULL;
    json_t *rows = json_array();
    enum neph_status status = neph_query_begin(index, &query, diag, question, "i", night);
    while (!status && neph_query_next(query, &status, diag))
        neph_json_add(&rows, row(query));
    neph_query_end(query);
    if (!status && !rows) {
        status = neph_fail(diag, NEPH_ERR_INPUT,
                           "a row of night %lld in the store's database is damaged",
                           (long long)night);
        neph_hint(diag, "`neph store check --repair` makes it again");
    }
    if (status)
        json_decref(rows);
    else
        *list = rows;
    return status;
}

enum neph_status neph_history_document(struct neph_database *index, int64_t night,
                                       json_t **document, struct neph_diag *diag)
{
    static const struct {
        const char *name, *question;
        neph_row *row;
        bool may_lack; /* nights of before it was kept have none */
    } lists[] = {
        {"steps",
         "SELECT name, outcome, reason, size, wall_s, calibration_s FROM steps WHERE night = ? "
         "ORDER BY name",
         step_json, false},
        {"measurements",
         "SELECT name, step, kind, value, standard_error, environment, judgement, frame FROM "
         "measurements JOIN series ON series.id = measurements.series WHERE night = ? ORDER BY "
         "name",
         measurement_json, false},
        {"scenes",
         "SELECT step, scene, hash, terms FROM night_scenes WHERE night = ? ORDER BY step",
         scene_json, true},
        {"frames", "SELECT key FROM night_frames WHERE night = ? ORDER BY key", frame_json, false},
    };
    json_t *heads = NULL;
    enum neph_status status = list_rows(index,
                                        "SELECT id, started_utc, ended_utc, plan, revision, "
                                        "program, host, verdict FROM nights WHERE id = ?",
                                        night, head_json, &heads, diag);
    if (!status && json_array_size(heads) == 0)
        status = neph_fail(diag, NEPH_ERR_NOT_FOUND, "there is no night %lld", (long long)night);
    json_t *made = status ? NULL : json_incref(json_array_get(heads, 0));
    json_decref(heads);
    for (size_t i = 0; !status && i < sizeof(lists) / sizeof(lists[0]); i++) {
        json_t *list = NULL;
        status = list_rows(index, lists[i].question, night, lists[i].row, &list, diag);
        if (!status && lists[i].may_lack && json_array_size(list) == 0)
            json_decref(list);
        else if (!status)
            status = neph_json_put(made, lists[i].name, list, diag);
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
                     "SELECT id, series, night, who, when_utc, why FROM acceptances WHERE id > ? "
                     "ORDER BY id",
                     0, acceptance_json, list, diag);
}

/* ---- for good -------------------------------------------------------------------------------- */

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

static enum neph_status check_acceptable(struct neph_database *index, const char *series,
                                         int64_t night, struct neph_diag *diag)
{
    int64_t count = 0;
    enum neph_status status = neph_database_count(index, &count, diag,
                                                  documents[NEPH_DOCUMENT_NIGHT].known, "i", night);
    if (!status && count == 0)
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
        neph_hint(diag, "`neph store export` lists what they have");
    }
    return status;
}

/* It is accepted without its copy, too. */
static void write_copy(const char *store_folder, int64_t number, const json_t *document)
{
    struct neph_diag why = {.line = 0};
    if (neph_document_write(store_folder, NEPH_DOCUMENT_COPY, number, document, &why))
        neph_progress_warn("acceptance %lld has no copy: %s", (long long)number, why.message);
}

/* Number, document and rows while nobody else writes: of two at once, each has its own. */
static enum neph_status number_acceptance(struct neph_database *index, const char *store_folder,
                                          json_t *document, struct neph_diag *diag)
{
    int64_t number = 0;
    enum neph_status status = neph_database_count(
        index, &number, diag, "SELECT coalesce(max(id), 0) + 1 FROM acceptances", "");
    if (!status)
        status = next_number(store_folder, NEPH_DOCUMENT_ACCEPTANCE, &number, diag);
    if (!status)
        status = neph_json_put(document, "acceptance", json_integer(number), diag);
    if (!status)
        status = write_new_document(store_folder, NEPH_DOCUMENT_ACCEPTANCE, number, document, diag);
    if (!status)
        write_copy(store_folder, number, document);
    return status ? status : insert_acceptance(index, number, document, diag);
}

/* Hosts have databases of their own, and one lock on the store. */
static enum neph_status insert_accepted(struct neph_database *index, const char *store_folder,
                                        json_t *document, struct neph_diag *diag)
{
    int lock = -1;
    char *path = neph_path_join(store_folder, ".neph-lock");
    enum neph_status status = path ? neph_lock_wait(path, &lock, diag) : neph_fail_memory(diag);
    free(path);
    if (status)
        return status;
    status = neph_database_begin(index, diag);
    if (!status) {
        status = number_acceptance(index, store_folder, document, diag);
        if (!status)
            status = neph_database_commit(index, diag);
        else
            neph_database_rollback(index);
    }
    close(lock);
    return status;
}

enum neph_status neph_history_accept(struct neph_database *index, const char *store_folder,
                                     const char *series, int64_t night, const char *who,
                                     const char *why, struct neph_diag *diag)
{
    char now[32], digest[NEPH_HASH_HEX_SIZE] = "";
    neph_utc_now(now);
    enum neph_status status = check_acceptable(index, series, night, diag);
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
