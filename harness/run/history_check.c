/* SPDX-License-Identifier: MIT
 *
 * Compares the documents of nightly runs and acceptances with their copies and rows; repairs them.
 */
#include "harness/run/history_check.h"

#include "base/path.h"
#include "harness/run/history.h"
#include "harness/run/history_documents.h"

#include <stdlib.h>
#include <string.h>

/* ---- nightly runs ---------------------------------------------------------------------------- */

/* Compares a run's rows with its document. A missing or unreadable document is an error: only the
 * rows are left of the run. `mends`: a damaged document is written again from the rows. A document
 * that differs from the rows is correct, and so is one whose rows cannot be read: no error then. */
static enum neph_status check_night(struct neph_database *index, const char *store_folder,
                                    int64_t night, bool mends, struct neph_diag *diag)
{
    json_t *rows = NULL, *document = NULL;
    const struct neph_path path = neph_document_path(store_folder, NEPH_DOCUMENT_NIGHT, night);
    enum neph_status status = neph_history_document(index, night, &rows, diag);
    if (!status)
        status = neph_document_read(path.text, NEPH_DOCUMENT_NIGHT, &document, diag);
    const bool torn = rows && status == NEPH_ERR_INPUT;
    if (rows && status && !torn)
        neph_hint(diag, "restore it from a copy of the store; its content is still in the "
                        "database: `neph store export`");
    if (torn || (!status && !json_equal(rows, document)))
        status = neph_fail(diag, NEPH_ERR_INPUT, "night %lld differs from its document '%s'",
                           (long long)night, path.text);
    if (torn && mends)
        status = neph_document_write(store_folder, NEPH_DOCUMENT_NIGHT, night, rows, diag);
    json_decref(rows);
    json_decref(document);
    return mends && status == NEPH_ERR_INPUT ? NEPH_OK : status;
}

static enum neph_status check_nights(struct neph_database *index, const char *store_folder,
                                     bool mends, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    struct neph_query *query = neph_query(
        index, diag, "SELECT id FROM nights WHERE ended_utc != '' ORDER BY id", "");
    while (!status && neph_query_next(query))
        status = check_night(index, store_folder, neph_query_integer(query, 0), mends, diag);
    return neph_query_end(query, status);
}

enum neph_status neph_history_check(struct neph_database *index, const char *store_folder,
                                    struct neph_diag *diag)
{
    return check_nights(index, store_folder, false, diag);
}

enum neph_status neph_history_repair(struct neph_database *index, const char *store_folder,
                                     struct neph_diag *diag)
{
    const enum neph_status status = check_nights(index, store_folder, true, diag);
    return status == NEPH_ERR_INPUT ? NEPH_OK : status;
}

/* ---- acceptances ----------------------------------------------------------------------------- */

/* An acceptance in its three versions; NULL: missing. All owned. */
struct versions {
    json_t *document, *copy, *row;
    bool document_is_torn, copy_is_torn;
};

struct check {
    struct neph_database *index;
    const char *store_folder;
    bool mends;
    neph_history_report *tell;
    void *context;
};

/* Whether document and row are equal, without the digest, which the row does not have. */
static bool equals_row(const json_t *document, const json_t *row)
{
    json_t *bare = json_copy((json_t *)document);
    if (bare)
        json_object_del(bare, "night_blake2b");
    const bool same = bare && json_equal(bare, row);
    json_decref(bare);
    return same;
}

static enum neph_status read_version(const char *store_folder, enum neph_document kind,
                                     int64_t number, json_t **version, bool *torn,
                                     struct neph_diag *diag)
{
    struct neph_diag why = {.line = 0};
    const enum neph_status status = neph_document_read(
        neph_document_path(store_folder, kind, number).text, kind, version, &why);
    *torn = status == NEPH_ERR_INPUT;
    if (*torn || status == NEPH_ERR_NOT_FOUND)
        return NEPH_OK;
    if (status && diag)
        *diag = why;
    return status;
}

/* `rows` lists all acceptances. */
static json_t *find_row(const json_t *rows, int64_t number)
{
    size_t i;
    json_t *row;
    json_array_foreach(rows, i, row) if (json_integer_value(json_object_get(row, "acceptance")) ==
                                         number) return json_incref(row);
    return NULL;
}

static const json_t *choose_version(const struct versions *v)
{
    if (!v->document)
        return v->copy ? v->copy : v->row;
    const bool is_edited = v->copy && v->row && equals_row(v->copy, v->row) &&
                           !equals_row(v->document, v->row);
    return is_edited ? v->copy : v->document;
}

/* The fault of an acceptance; NULL: none. */
static const char *find_fault(const struct versions *v, const json_t *right, bool *of_copy)
{
    *of_copy = false;
    if (v->document_is_torn)
        return right ? "it is no complete neph-accept-1"
                     : "it is no complete neph-accept-1, and neither its copy nor the database has "
                       "it: restore it from a copy of the store, or remove it and accept again";
    if (!v->document)
        return "it is missing";
    if (v->document != right)
        return "it differs from its copy and the database";
    if (v->row && !equals_row(right, v->row))
        return "it differs from the database";
    *of_copy = true;
    if (v->copy_is_torn)
        return "it is no complete neph-accept-1";
    return v->copy && !json_equal(v->copy, right) ? "it differs from its document" : NULL;
}

static enum neph_status write_versions(const struct check *check, int64_t number,
                                       const struct versions *v, const json_t *right,
                                       struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (!v->copy || !json_equal(v->copy, right))
        status = neph_document_write(check->store_folder, NEPH_DOCUMENT_COPY, number, right, diag);
    if (!status && v->document != right)
        status = neph_document_write(check->store_folder, NEPH_DOCUMENT_ACCEPTANCE, number, right,
                                     diag);
    if (!status && !(v->row && equals_row(right, v->row))) {
        status = neph_database_do(check->index, diag, "DELETE FROM acceptances WHERE id = ?", "i",
                                  number);
        if (!status)
            status = neph_document_insert(check->index, NEPH_DOCUMENT_ACCEPTANCE, number, right,
                                          diag);
    }
    return status;
}

static void report_document_fault(const struct check *check, enum neph_document kind,
                                  int64_t number, const char *why, bool mended)
{
    const struct neph_path path = neph_document_path(check->store_folder, kind, number);
    const struct neph_history_fault fault = {strrchr(path.text, '/') + 1, why, mended};
    check->tell(&fault, check->context);
}

static enum neph_status check_versions(const struct check *check, int64_t number,
                                       const struct versions *v, struct neph_diag *diag)
{
    bool of_copy = false;
    const json_t *right = choose_version(v);
    const char *why = find_fault(v, right, &of_copy);
    const bool mends = why && right && check->mends;
    const enum neph_status status = mends ? write_versions(check, number, v, right, diag) : NEPH_OK;
    if (!status && why)
        report_document_fault(check, of_copy ? NEPH_DOCUMENT_COPY : NEPH_DOCUMENT_ACCEPTANCE,
                              number, why, mends);
    return status;
}

static enum neph_status check_acceptance(const struct check *check, const json_t *rows,
                                         int64_t number, struct neph_diag *diag)
{
    struct versions v = {.row = find_row(rows, number)};
    enum neph_status status = read_version(check->store_folder, NEPH_DOCUMENT_ACCEPTANCE, number,
                                           &v.document, &v.document_is_torn, diag);
    if (!status)
        status = read_version(check->store_folder, NEPH_DOCUMENT_COPY, number, &v.copy,
                              &v.copy_is_torn, diag);
    if (!status && (v.document || v.copy || v.row || v.document_is_torn))
        status = check_versions(check, number, &v, diag);
    json_decref(v.document);
    json_decref(v.copy);
    json_decref(v.row);
    return status;
}

/* The highest number of all rows, documents and copies. */
static enum neph_status find_last_acceptance(const struct check *check, int64_t *last,
                                             struct neph_diag *diag)
{
    struct neph_arena arena = {NULL};
    struct neph_names names;
    enum neph_status status = neph_history_list(check->store_folder, &arena, &names, diag);
    if (!status)
        status = neph_database_count(check->index, last, diag,
                                     "SELECT coalesce(max(id), 0) FROM acceptances", "");
    for (int i = 0; i < names.count && !status; i++) {
        const int64_t a = neph_document_number(names.list[i], NEPH_DOCUMENT_ACCEPTANCE),
                      b = neph_document_number(names.list[i], NEPH_DOCUMENT_COPY);
        *last = a > *last ? a : b > *last ? b : *last;
    }
    neph_arena_finish(&arena);
    return status;
}

enum neph_status neph_history_check_acceptances(struct neph_database *index,
                                                const char *store_folder, bool mends,
                                                neph_history_report *tell, void *context,
                                                struct neph_diag *diag)
{
    const struct check check = {index, store_folder, mends, tell, context};
    json_t *rows = NULL;
    int64_t last = 0;
    enum neph_status status = neph_history_acceptances(index, &rows, diag);
    if (!status)
        status = find_last_acceptance(&check, &last, diag);
    for (int64_t number = 1; number <= last && !status; number++)
        status = check_acceptance(&check, rows, number, diag);
    json_decref(rows);
    return status;
}

/* ---- damaged runs, accepted runs ------------------------------------------------------------- */

static enum neph_status check_torn(const struct check *check, int64_t night, struct neph_diag *diag)
{
    json_t *document = NULL;
    bool has = false, torn = false;
    enum neph_status status = neph_history_has(check->index, night, &has, diag);
    if (!status && !has)
        status = read_version(check->store_folder, NEPH_DOCUMENT_NIGHT, night, &document, &torn,
                              diag);
    json_decref(document);
    if (!status && torn)
        report_document_fault(
            check, NEPH_DOCUMENT_NIGHT, night,
            "it is no complete neph-night-1, and the database does not have the night: "
            "restore it from a copy of the store, or remove it",
            false);
    return status;
}

enum neph_status neph_history_check_torn(struct neph_database *index, const char *store_folder,
                                         neph_history_report *tell, void *context,
                                         struct neph_diag *diag)
{
    const struct check check = {index, store_folder, false, tell, context};
    struct neph_arena arena = {NULL};
    struct neph_names names;
    enum neph_status status = neph_history_list(store_folder, &arena, &names, diag);
    for (int i = 0; i < names.count && !status; i++) {
        const int64_t night = neph_document_number(names.list[i], NEPH_DOCUMENT_NIGHT);
        if (night > 0)
            status = check_torn(&check, night, diag);
    }
    neph_arena_finish(&arena);
    return status;
}

/* Checks that a run exists and equals its document. A fault is reported and is no error. */
static enum neph_status check_accepted_night(const struct check *check, int64_t night,
                                             struct neph_diag *diag)
{
    bool has = false;
    struct neph_diag why = {.line = 0};
    enum neph_status status = neph_history_has(check->index, night, &has, diag);
    if (status)
        return status;
    const char *fault = "the night was accepted, and the history does not have it: restore its "
                        "document from a copy of the store, or accept another night";
    if (has) {
        status = check_night(check->index, check->store_folder, night, false, &why);
        if (status == NEPH_OK)
            return NEPH_OK;
        fault = why.message;
        if (status != NEPH_ERR_INPUT && status != NEPH_ERR_NOT_FOUND && status != NEPH_ERR_IO) {
            if (diag)
                *diag = why;
            return status;
        }
    }
    report_document_fault(check, NEPH_DOCUMENT_NIGHT, night, fault, false);
    return NEPH_OK;
}

/* Checks that the run's document is unchanged since it was accepted. Older acceptances have no
 * digest. */
static enum neph_status check_digest(const struct check *check, int64_t number, int64_t night,
                                     struct neph_diag *diag)
{
    char digest[NEPH_HASH_HEX_SIZE] = "";
    json_t *document = NULL;
    bool torn = false;
    enum neph_status status = read_version(check->store_folder, NEPH_DOCUMENT_ACCEPTANCE, number,
                                           &document, &torn, diag);
    if (!status)
        status = neph_document_digest_night(check->store_folder, night, digest, diag);
    const char *accepted = neph_json_text(document, "night_blake2b");
    const bool differs = digest[0] && accepted[0] && strcmp(digest, accepted) != 0;
    json_decref(document);
    if (!status && differs)
        report_document_fault(
            check, NEPH_DOCUMENT_NIGHT, night,
            "it was changed after it was accepted: restore it from a copy of the store, or "
            "accept another night",
            false);
    return status;
}

enum neph_status neph_history_check_baseline(struct neph_database *index, const char *store_folder,
                                             neph_history_report *tell, void *context,
                                             struct neph_diag *diag)
{
    const struct check check = {index, store_folder, false, tell, context};
    enum neph_status status = NEPH_OK;
    struct neph_query *query = neph_query(
        index, diag,
        "SELECT max(id), night FROM acceptances WHERE id >= coalesce((SELECT max(id) FROM "
        "acceptances WHERE series = '*'), 0) GROUP BY night ORDER BY night",
        "");
    while (!status && neph_query_next(query)) {
        const int64_t night = neph_query_integer(query, 1);
        status = check_accepted_night(&check, night, diag);
        if (!status)
            status = check_digest(&check, neph_query_integer(query, 0), night, diag);
    }
    return neph_query_end(query, status);
}
