/* SPDX-License-Identifier: MIT
 *
 * Maintenance of the store: check, repair, eviction, export.
 */
#include "harness/run/store_keep.h"

#include "base/files.h"
#include "base/interrupt.h"
#include "base/path.h"
#include "harness/run/history.h"
#include "harness/run/history_check.h"
#include "harness/run/index.h"
#include "harness/run/store_entry.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

/* Counts the accepted runs that use a frame. Runs of older acceptances count as well: an acceptance
 * can be used again. */
static const char is_of_baseline[] =
    "SELECT count(*) FROM night_frames WHERE key = ? AND night IN (SELECT night FROM acceptances)";

int64_t neph_store_used_s(const struct neph_store *store, const char *key)
{
    struct stat info;
    const struct neph_path path = neph_path_format("%s/frames/%s/job.json",
                                                   neph_store_folder(store), key);
    return stat(path.text, &info) == 0 ? (int64_t)info.st_mtime : 0;
}

/* ---- checking -------------------------------------------------------------------------------- */

struct check {
    struct neph_store *store;
    struct neph_database *index;
    bool repairs;
    neph_store_report *tell;
    void *context;
    struct neph_store_sums *sums;
    int differing_rows; /* rows that differ from the frame's record */
};

static enum neph_status report_fault(struct check *check, const char *key, const char *why,
                                     bool may_go, struct neph_diag *diag)
{
    int64_t of_baseline = 0;
    const enum neph_status status = neph_database_count(check->index, &of_baseline, diag,
                                                        is_of_baseline, "s", key);
    if (status)
        return status;
    struct neph_store_fault fault = {key, why, of_baseline > 0, false, false};
    fault.removed = check->repairs && may_go && neph_store_remove(check->store, key, 0, NULL);
    check->sums->bad++;
    check->tell(&fault, check->context);
    return NEPH_OK;
}

static enum neph_status check_frame(struct check *check, const char *key, struct neph_diag *diag)
{
    char why[NEPH_ENTRY_WHY_BYTES];
    json_t *record = NULL;
    bool agrees = true;
    const struct neph_path folder = neph_path_format("%s/frames/%s",
                                                     neph_store_folder(check->store), key);
    const enum neph_entry_state state = neph_entry_check(folder.text, key, &record, why);
    enum neph_status status = NEPH_OK;
    check->sums->frames++;
    if (state == NEPH_ENTRY_BAD || state == NEPH_ENTRY_UNREADABLE)
        status = report_fault(check, key, why, state == NEPH_ENTRY_BAD, diag);
    else if (state == NEPH_ENTRY_GOOD)
        status = neph_index_agrees(check->index, key, record, &agrees, diag);
    check->differing_rows += !agrees;
    json_decref(record);
    return status;
}

static enum neph_status check_frames(struct check *check, struct neph_diag *diag)
{
    struct neph_arena arena = {NULL};
    struct neph_names names;
    enum neph_status status = neph_dir_list(
        neph_path_in(neph_store_folder(check->store), "frames").text, &arena, &names, diag);
    for (int i = 0; i < names.count && !status; i++)
        if (neph_interrupted())
            status = neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted");
        else if (names.list[i][0] != '.')
            status = check_frame(check, names.list[i], diag);
    neph_arena_finish(&arena);
    return status;
}

static enum neph_status count_rows(struct neph_database *index, struct neph_store_sums *sums,
                                   struct neph_diag *diag)
{
    const struct {
        int64_t *sum;
        const char *question;
    } sums_of[] = {
        {&sums->bytes, "SELECT coalesce(sum(bytes), 0) FROM jobs"},
        {&sums->nights, "SELECT count(*) FROM nights WHERE ended_utc != ''"},
        {&sums->acceptances, "SELECT count(*) FROM acceptances"},
    };
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; !status && i < sizeof(sums_of) / sizeof(sums_of[0]); i++)
        status = neph_database_count(index, sums_of[i].sum, diag, sums_of[i].question, "");
    return status;
}

static void report_document(const struct neph_history_fault *found, void *context)
{
    struct check *check = context;
    const struct neph_store_fault fault = {
        .key = found->document, .why = found->why, .removed = found->mended, .is_document = true};
    check->sums->bad++;
    check->tell(&fault, check->context);
}

static enum neph_status check_documents(struct check *check, struct neph_diag *diag)
{
    const char *folder = neph_store_folder(check->store);
    const enum neph_status status = neph_history_check_acceptances(
        check->index, folder, check->repairs, report_document, check, diag);
    return status ? status
                  : neph_history_check_torn(check->index, folder, report_document, check, diag);
}

static enum neph_status check_index_content(struct check *check, bool *whole, struct neph_diag *why,
                                            struct neph_diag *diag)
{
    if (check->differing_rows > 0) {
        *whole = false;
        neph_fail(why, NEPH_ERR_INPUT, "%d rows differ from the records of the frames",
                  check->differing_rows);
        return NEPH_OK;
    }
    return neph_index_check(check->index, neph_store_folder(check->store), whole, why, diag);
}

static enum neph_status check_index(struct check *check, struct neph_diag *diag)
{
    bool whole = true;
    struct neph_diag why = {.line = 0};
    enum neph_status status = check_index_content(check, &whole, &why, diag);
    if (status || whole)
        return status;
    struct neph_store_fault fault = {.key = "", .why = why.message};
    if (check->repairs)
        status = neph_history_repair(check->index, neph_store_folder(check->store), diag);
    if (check->repairs && !status) {
        neph_database_close(check->index);
        check->index = NULL;
        status = neph_store_rebuild_index(check->store, why.message, &check->index, diag);
        fault.removed = status == NEPH_OK;
    }
    check->sums->bad++;
    check->tell(&fault, check->context);
    return status;
}

enum neph_status neph_store_check(struct neph_store *store, bool repairs, neph_store_report *tell,
                                  void *context, struct neph_store_sums *sums,
                                  struct neph_diag *diag)
{
    struct check check = {store, NULL, repairs, tell, context, sums, 0};
    *sums = (struct neph_store_sums){0};
    enum neph_status status = neph_store_index(store, &check.index, diag);
    if (!status)
        status = check_frames(&check, diag);
    if (!status)
        status = check_documents(&check, diag);
    if (!status)
        status = check_index(&check, diag);
    if (!status)
        status = count_rows(check.index, sums, diag);
    neph_database_close(check.index);
    return status;
}

/* ---- eviction -------------------------------------------------------------------------------- */

struct candidate {
    const char *key;
    int64_t bytes, is_of_baseline, used_s;
};
#define CANDIDATE(member) NEPH_RECORD_FIELD(struct candidate, member)
static const struct neph_record_form candidate_form = {
    sizeof(struct candidate), {CANDIDATE(key), CANDIDATE(bytes), CANDIDATE(is_of_baseline)}};

/* The least recently used first; within a second, the smaller key. */
static int compare_use_times(const void *a_, const void *b_)
{
    const struct candidate *a = a_, *b = b_;
    return a->used_s != b->used_s ? (a->used_s < b->used_s ? -1 : 1) : strcmp(a->key, b->key);
}

/* Lists the frames without a baseline, in the arena, sorted by use. */
static enum neph_status list_candidates(struct neph_store *store, struct neph_arena *arena,
                                        struct candidate **list, int *count,
                                        struct neph_store_gc *result, struct neph_diag *diag)
{
    struct neph_database *index = NULL;
    struct neph_records rows = {NULL, 0};
    enum neph_status status = neph_store_index(store, &index, diag);
    if (!status)
        status = neph_record_select(index, arena, &candidate_form, &rows, diag,
                                    "SELECT key, bytes, key IN (SELECT key FROM night_frames WHERE "
                                    "night IN (SELECT night FROM acceptances)) FROM jobs",
                                    "");
    neph_database_close(index);
    *list = rows.list;
    *count = 0;
    for (int i = 0; i < rows.count; i++) {
        struct candidate *c = &(*list)[i];
        result->frames_before++;
        result->bytes_before += c->bytes;
        result->bytes_of_baselines += c->is_of_baseline ? c->bytes : 0;
        c->used_s = neph_store_used_s(store, c->key);
        if (!c->is_of_baseline)
            (*list)[(*count)++] = *c;
    }
    if (*count > 0)
        qsort(*list, (size_t)*count, sizeof(**list), compare_use_times);
    return status;
}

/* Removes a frame, unless another process has used it since it was listed. */
static void remove_unused_frame(struct neph_store *store, const struct candidate *c,
                                int64_t before_s, struct neph_store_gc *result)
{
    if (neph_store_remove(store, c->key, before_s, NULL)) {
        result->frames_removed++;
        result->bytes_removed += c->bytes;
    } else if (neph_store_used_s(store, c->key) > before_s) {
        result->bytes_in_use += c->bytes;
    } else {
        result->frames_that_stayed++;
    }
}

enum neph_status neph_store_gc(struct neph_store *store, int64_t limit_bytes, double spare_s,
                               struct neph_store_gc *result, struct neph_diag *diag)
{
    struct neph_arena arena = {NULL};
    struct candidate *list = NULL;
    int count = 0;
    const int64_t before_s = (int64_t)time(NULL) - (int64_t)spare_s;
    *result = (struct neph_store_gc){0};
    const enum neph_status status = list_candidates(store, &arena, &list, &count, result, diag);
    for (int i = 0; !status && i < count; i++) {
        if (list[i].used_s > before_s)
            result->bytes_in_use += list[i].bytes;
        else if (result->bytes_before - result->bytes_removed > limit_bytes)
            remove_unused_frame(store, &list[i], before_s, result);
    }
    result->fits = result->bytes_before - result->bytes_removed <= limit_bytes;
    neph_arena_finish(&arena);
    return status;
}

/* ---- export ---------------------------------------------------------------------------------- */

static enum neph_status list_all(struct neph_database *index, const char *question,
                                 const struct neph_record_form *form, json_t *document,
                                 const char *name, struct neph_diag *diag)
{
    json_t *list = NULL;
    const enum neph_status status = neph_record_list(index, form, &list, diag, question, "");
    if (!status && !list) {
        neph_fail(diag, NEPH_ERR_INPUT, "a row of '%s' in the store's database is damaged", name);
        neph_hint(diag, "rebuild it with `neph store check --repair`");
        return NEPH_ERR_INPUT;
    }
    return status ? status : neph_json_put(document, name, list, diag);
}

static enum neph_status list_nights(struct neph_database *index, json_t *document,
                                    struct neph_diag *diag)
{
    json_t *list = json_array();
    enum neph_status status = NEPH_OK;
    struct neph_query *query = neph_query(
        index, diag, "SELECT id FROM nights WHERE ended_utc != '' ORDER BY id", "");
    while (!status && neph_query_next(query)) {
        json_t *night = NULL;
        status = neph_history_document(index, neph_query_integer(query, 0), &night, diag);
        if (!status)
            neph_json_add(&list, night);
    }
    status = neph_query_end(query, status);
    if (status)
        json_decref(list);
    return status ? status : neph_json_put(document, "nights", list, diag);
}

enum neph_status neph_store_export(struct neph_store *store, json_t **document,
                                   struct neph_diag *diag)
{
    struct neph_database *index = NULL;
    json_t *made = json_pack("{s:s}", "format", "neph-store-1"), *acceptances = NULL;
    enum neph_status status = made ? neph_store_index(store, &index, diag) : neph_fail_memory(diag);
    if (!status)
        status = list_all(index, "SELECT * FROM environments ORDER BY id",
                          &neph_index_environment_form, made, "environments", diag);
    if (!status)
        status = list_all(index, "SELECT * FROM jobs ORDER BY key", &neph_index_job_form, made,
                          "jobs", diag);
    if (!status)
        status = list_nights(index, made, diag);
    if (!status)
        status = neph_history_acceptances(index, &acceptances, diag);
    if (!status)
        status = neph_json_put(made, "acceptances", acceptances, diag);
    neph_database_close(index);
    if (status)
        json_decref(made);
    else
        *document = made;
    return status;
}
