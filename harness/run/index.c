/* SPDX-License-Identifier: MIT
 *
 * The store's database: schema, refresh from frames and documents, checks.
 */
#include "harness/run/index.h"

#include "base/clock.h"
#include "base/files.h"
#include "base/hash.h"
#include "base/path.h"
#include "harness/progress.h"
#include "harness/run/history.h"
#include "harness/run/history_check.h"
#include "harness/run/store_entry.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Migration steps. A released step is never edited: a change is one more step. */
static const char *const steps[] = {
    /* An engine on one machine. `version` includes the driver and its compiler, `device` the vector
     * width, `host` the processor and the number of processors. */
    "CREATE TABLE environments ("
    "  id INTEGER PRIMARY KEY, engine TEXT NOT NULL, version TEXT NOT NULL, build TEXT NOT NULL,"
    "  device TEXT NOT NULL, host TEXT NOT NULL,"
    "  UNIQUE (engine, version, build, device, host)) STRICT;"
    /* Finished frames and sequences. Sizes and times are 0 where their record has none. */
    "CREATE TABLE jobs ("
    "  key TEXT PRIMARY KEY, format TEXT NOT NULL, scene TEXT NOT NULL, scene_hash TEXT NOT NULL,"
    "  environment INTEGER NOT NULL REFERENCES environments (id), settings TEXT NOT NULL,"
    "  width_px INTEGER NOT NULL, height_px INTEGER NOT NULL, frame INTEGER NOT NULL,"
    "  seed INTEGER NOT NULL, render_s REAL NOT NULL, wall_s REAL NOT NULL, cpu_s REAL NOT NULL,"
    "  peak_memory_bytes INTEGER NOT NULL, frame_blake2b TEXT NOT NULL, bytes INTEGER NOT NULL,"
    "  made_utc TEXT NOT NULL) STRICT, WITHOUT ROWID;"
    /* `ended_utc` is '' for an unfinished run. */
    "CREATE TABLE nights ("
    "  id INTEGER PRIMARY KEY, started_utc TEXT NOT NULL, ended_utc TEXT NOT NULL,"
    "  plan TEXT NOT NULL, revision TEXT NOT NULL, program TEXT NOT NULL, host TEXT NOT NULL,"
    "  verdict TEXT NOT NULL) STRICT;"
    "CREATE TABLE steps ("
    "  night INTEGER NOT NULL REFERENCES nights (id), name TEXT NOT NULL, outcome TEXT NOT NULL,"
    "  reason TEXT NOT NULL, size TEXT NOT NULL, wall_s REAL NOT NULL, calibration_s REAL,"
    "  PRIMARY KEY (night, name)) STRICT, WITHOUT ROWID;"
    "CREATE TABLE series (id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE) STRICT;"
    "CREATE TABLE measurements ("
    "  night INTEGER NOT NULL REFERENCES nights (id),"
    "  series INTEGER NOT NULL REFERENCES series (id), step TEXT NOT NULL, kind TEXT NOT NULL,"
    "  value REAL, standard_error REAL, environment TEXT NOT NULL, judgement TEXT NOT NULL,"
    "  PRIMARY KEY (series, night)) STRICT, WITHOUT ROWID;"
    "CREATE INDEX measurements_of_night ON measurements (night);"
    "CREATE TABLE night_frames ("
    "  night INTEGER NOT NULL REFERENCES nights (id), key TEXT NOT NULL,"
    "  PRIMARY KEY (night, key)) STRICT, WITHOUT ROWID;"
    /* `series` is '*' for all. Rows are never changed nor removed, even when a run's document is
     * lost. */
    "CREATE TABLE acceptances ("
    "  id INTEGER PRIMARY KEY, series TEXT NOT NULL, night INTEGER NOT NULL,"
    "  who TEXT NOT NULL, when_utc TEXT NOT NULL, why TEXT NOT NULL) STRICT;",
    /* Key of the measured frame, or of the last frame of a sequence; '' for none. */
    "ALTER TABLE measurements ADD COLUMN frame TEXT NOT NULL DEFAULT '';",
    /* The scene of a step, and the store's copy of the scene file (night/scene_copy.h). */
    "CREATE TABLE night_scenes ("
    "  night INTEGER NOT NULL REFERENCES nights (id), step TEXT NOT NULL, scene TEXT NOT NULL,"
    "  hash TEXT NOT NULL, terms TEXT NOT NULL, PRIMARY KEY (night, step)) STRICT, WITHOUT ROWID;",
    NULL};

/* ---- a frame's record as rows ---------------------------------------------------------------- */

struct environment {
    int64_t id;
    const char *engine, *version, *build, *device, *host;
};
enum { ENVIRONMENT_COLUMNS = 6 };
#define ENVIRONMENT(member) NEPH_RECORD_FIELD(struct environment, member)
const struct neph_record_form neph_index_environment_form = {
    sizeof(struct environment),
    {ENVIRONMENT(id), ENVIRONMENT(engine), ENVIRONMENT(version), ENVIRONMENT(build),
     ENVIRONMENT(device), ENVIRONMENT(host)}};

struct job {
    const char *key, *format, *scene, *scene_hash;
    int64_t environment;
    const char *settings;
    int64_t size_px[2], frame, seed;
    double render_s, wall_s, cpu_s;
    int64_t peak_memory_bytes;
    const char *frame_blake2b;
    int64_t bytes;
    const char *made_utc;
};
#define JOB(member) NEPH_RECORD_FIELD(struct job, member)
const struct neph_record_form neph_index_job_form = {
    sizeof(struct job),
    {JOB(key), JOB(format), JOB(scene), JOB(scene_hash), JOB(environment), JOB(settings),
     JOB(size_px), JOB(frame), JOB(seed), JOB(render_s), JOB(wall_s), JOB(cpu_s),
     JOB(peak_memory_bytes), JOB(frame_blake2b), JOB(bytes), JOB(made_utc)}};

/* Reads a frame's record; leaves the environment's number and the size in bytes at 0. */
static void read_record(const char *key, const json_t *record, struct job *job,
                        struct environment *environment)
{
    neph_record_read(&neph_index_environment_form, record, NULL, environment);
    neph_record_read(&neph_index_job_form, record, NULL, job);
    job->key = key;
    job->made_utc = neph_json_text(record, "created_utc");
    job->environment = job->bytes = environment->id = 0;
}

static enum neph_status find_environment(struct neph_database *index, const struct environment *e,
                                         int64_t *id, struct neph_diag *diag)
{
    const enum neph_status status = neph_database_do(
        index, diag,
        "INSERT OR IGNORE INTO environments (engine, version, build, device, host)"
        " VALUES (?, ?, ?, ?, ?)",
        "sssss", e->engine, e->version, e->build, e->device, e->host);
    return status
               ? status
               : neph_database_count(index, id, diag,
                                     "SELECT id FROM environments WHERE engine = ? AND version "
                                     "= ? AND build = ? AND device = ? AND host = ?",
                                     "sssss", e->engine, e->version, e->build, e->device, e->host);
}

static int64_t sum_file_sizes(const char *folder)
{
    int64_t sum = 0;
    DIR *directory = opendir(folder);
    for (const struct dirent *entry; directory && (entry = readdir(directory));) {
        struct stat info;
        if (fstatat(dirfd(directory), entry->d_name, &info, 0) == 0 && S_ISREG(info.st_mode))
            sum += (int64_t)info.st_size;
    }
    if (directory)
        closedir(directory);
    return sum;
}

static enum neph_status insert_job(struct neph_database *index, const char *folder, const char *key,
                                   const json_t *record, struct neph_diag *diag)
{
    struct environment environment;
    struct job job;
    read_record(key, record, &job, &environment);
    job.bytes = sum_file_sizes(folder);
    const enum neph_status status = find_environment(index, &environment, &environment.id, diag);
    return status ? status
                  : neph_record_put(index, diag,
                                    "INSERT OR REPLACE INTO jobs VALUES (?2, ?3, ?4, ?5, ?1, ?7, "
                                    "?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18)",
                                    environment.id, &neph_index_job_form, &job);
}

/* Skips an entry with a bad record: the next request for its key removes it. */
static enum neph_status index_frame(struct neph_database *index, const char *frames,
                                    const char *key, struct neph_diag *diag)
{
    char why[NEPH_ENTRY_WHY_BYTES];
    json_t *record = NULL;
    const struct neph_path folder = neph_path_in(frames, key);
    enum neph_status status = NEPH_OK;
    if (neph_entry_read(folder.text, key, &record, why) == NEPH_ENTRY_GOOD)
        status = insert_job(index, folder.text, key, record, diag);
    json_decref(record);
    return status;
}

/* ---- comparing rows with frames -------------------------------------------------------------- */

static enum neph_status delete_frame_row(struct neph_database *index, const char *key,
                                         struct neph_diag *diag)
{
    if (!neph_entry_is_key(key))
        return neph_fail(diag, NEPH_ERR_INPUT, "a row has an invalid key");
    return neph_database_do(index, diag, "DELETE FROM jobs WHERE key = ?", "s", key);
}

static bool are_equal(const struct neph_names *a, const struct neph_names *b)
{
    bool equal = a->count == b->count;
    for (int i = 0; equal && i < a->count; i++)
        equal = strcmp(a->list[i], b->list[i]) == 0;
    return equal;
}

/* Walks names and rows, both sorted: inserts frames without a row and deletes rows without a frame.
 */
static enum neph_status sync_rows_with_frames(struct neph_database *index, const char *frames,
                                              const struct neph_names *names,
                                              const struct neph_names *rows, struct neph_diag *diag)
{
    enum neph_status status = neph_database_begin(index, diag);
    for (int n = 0, r = 0; !status && (n < names->count || r < rows->count);) {
        const int order = n == names->count  ? 1
                          : r == rows->count ? -1
                                             : strcmp(names->list[n], rows->list[r]);
        if (order < 0)
            status = index_frame(index, frames, names->list[n], diag);
        else if (order > 0)
            status = delete_frame_row(index, rows->list[r], diag);
        n += order <= 0;
        r += order >= 0;
    }
    return neph_database_end(index, status, diag);
}

/* Lists the keys of the frames and of the rows. */
static enum neph_status list_keys(struct neph_database *index, const char *frames,
                                  struct neph_arena *arena, struct neph_names *names,
                                  struct neph_names *rows, struct neph_diag *diag)
{
    struct neph_records records;
    enum neph_status status = neph_dir_list(frames, arena, names, diag);
    if (!status)
        status = neph_record_select(index, arena, &neph_record_text_form, &records, diag,
                                    "SELECT key FROM jobs ORDER BY key", "");
    if (status)
        return status;
    const int count = names->count;
    names->count = 0;
    for (int i = 0; i < count; i++)
        if (neph_entry_is_key(names->list[i]))
            names->list[names->count++] = names->list[i];
    *rows = (struct neph_names){records.list, records.count};
    return NEPH_OK;
}

static enum neph_status refresh(struct neph_database *index, const char *frames,
                                struct neph_diag *diag)
{
    struct neph_arena arena = {NULL};
    struct neph_names names, rows;
    enum neph_status status = list_keys(index, frames, &arena, &names, &rows, diag);
    if (!status && !are_equal(&names, &rows))
        status = sync_rows_with_frames(index, frames, &names, &rows, diag);
    neph_arena_finish(&arena);
    return status;
}

/* ---- place of the database ------------------------------------------------------------------- */

enum neph_index_place neph_index_place(void)
{
    const char *named = getenv("NEPH_STORE_INDEX");
    if (!named || !named[0])
        return NEPH_INDEX_IN_STORE;
    return strcmp(named, "none") == 0 ? NEPH_INDEX_NONE : NEPH_INDEX_ON_HOST;
}

/* The marker file's inode and time tell a store from a later one at the same path. */
static enum neph_status hash_store_identity(const char *store_folder, char name[NEPH_HASH_HEX_SIZE],
                                            struct neph_diag *diag)
{
    struct stat info;
    char *real = realpath(store_folder, NULL);
    char *text = real && stat(neph_path_in(real, ".neph-owned").text, &info) == 0
                     ? neph_format("%s %llu %lld.%09ld", real, (unsigned long long)info.st_ino,
                                   (long long)info.st_mtim.tv_sec, info.st_mtim.tv_nsec)
                     : NULL;
    const enum neph_status status = text ? neph_hash(text, strlen(text), name, diag)
                                         : neph_fail(diag, NEPH_ERR_IO,
                                                     "cannot identify the store '%s': %s",
                                                     store_folder, strerror(errno));
    free(text);
    free(real);
    return status;
}

/* The folder that the database is in. */
static enum neph_status find_folder(const char *store_folder, struct neph_path *folder,
                                    struct neph_diag *diag)
{
    char name[NEPH_HASH_HEX_SIZE];
    *folder = neph_path_in(store_folder, "index");
    if (neph_index_place() != NEPH_INDEX_ON_HOST)
        return NEPH_OK;
    const enum neph_status status = hash_store_identity(store_folder, name, diag);
    if (!status)
        *folder = neph_path_format("%s/%.16s", getenv("NEPH_STORE_INDEX"), name);
    return status;
}

/* ---- opening --------------------------------------------------------------------------------- */

/* Renames a folder's database, with SQLite's files beside it, to an unused name. */
static enum neph_status set_aside(const char *folder, const char *why, struct neph_diag *diag)
{
    static const char *const endings[] = {"", "-wal", "-shm"};
    struct neph_path aside;
    char now[32];
    int number = 1;
    neph_utc_now(now);
    do
        aside = neph_path_format("%s/damaged-%s-%d.sqlite", folder, now, number++);
    while (neph_path_exists(aside.text));
    for (size_t i = 0; i < sizeof(endings) / sizeof(endings[0]); i++) {
        const struct neph_path from = neph_path_format("%s/neph.sqlite%s", folder, endings[i]);
        const struct neph_path to = neph_path_format("%s%s", aside.text, endings[i]);
        if (rename(from.text, to.text) != 0 && errno != ENOENT)
            return neph_fail(diag, NEPH_ERR_IO, "cannot set '%s' aside: %s", from.text,
                             strerror(errno));
    }
    neph_progress_warn(
        "the store's database is damaged (%s): it is kept as '%s', and a new one is built from the "
        "frames and the finished nights, which are intact; an unfinished night starts again",
        why, aside.text);
    return NEPH_OK;
}

/* Opens the database, checks it and refreshes it. */
static enum neph_status open_checked(const char *path, const char *store_folder, bool reads,
                                     struct neph_database **index, struct neph_diag *diag)
{
    struct neph_database *opened = NULL;
    enum neph_status status = neph_database_open(path, steps, &opened, diag);
    if (!status && reads)
        status = neph_database_check(opened, false, diag);
    if (!status)
        status = refresh(opened, neph_path_in(store_folder, "frames").text, diag);
    if (!status)
        status = neph_history_refresh(opened, store_folder, diag);
    if (status)
        neph_database_close(opened);
    else
        *index = opened;
    return status;
}

/* Warns of a store with frames but no database: the store may be older than databases, or its
 * database was removed. */
static void warn_of_new_database(struct neph_database *index, const char *store_folder)
{
    int64_t frames = 0;
    if (neph_database_count(index, &frames, NULL, "SELECT count(*) FROM jobs", "") == NEPH_OK &&
        frames > 0)
        neph_progress_warn(
            "the store '%s' had no database (it was removed, or the store is older than "
            "databases): a new one is built from its %lld frames and its finished nights",
            store_folder, (long long)frames);
}

enum neph_status neph_index_open(const char *store_folder, bool reads, struct neph_database **index,
                                 struct neph_diag *diag)
{
    if (neph_index_place() == NEPH_INDEX_NONE)
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "NEPH_STORE_INDEX is none: the database of '%s' is not opened here",
                         store_folder);
    struct neph_path folder;
    struct neph_diag why = {.line = 0};
    enum neph_status status = find_folder(store_folder, &folder, &why);
    const struct neph_path path = neph_path_in(folder.text, "neph.sqlite");
    const bool is_new = !neph_path_exists(path.text);
    if (!status)
        status = neph_dir_create(folder.text, &why);
    if (!status)
        status = open_checked(path.text, store_folder, reads, index, &why);
    if (!status && is_new && neph_index_place() == NEPH_INDEX_IN_STORE)
        warn_of_new_database(*index, store_folder);
    /* Damage inside rows, which SQLite does not detect, shows when a refresh with these rows is
     * refused. */
    if (status == NEPH_ERR_INPUT || status == NEPH_ERR_INTERNAL) {
        status = set_aside(folder.text, why.message, &why);
        if (!status)
            status = open_checked(path.text, store_folder, reads, index, &why);
    }
    if (status && diag)
        *diag = why;
    return status;
}

/* ---- a full check ---------------------------------------------------------------------------- */

enum neph_status neph_index_check(struct neph_database *index, const char *store_folder,
                                  bool *whole, struct neph_diag *why, struct neph_diag *diag)
{
    enum neph_status status = neph_database_check(index, true, why);
    if (!status)
        status = neph_history_check(index, store_folder, why);
    *whole = status == NEPH_OK;
    if (status && status != NEPH_ERR_INPUT && diag)
        *diag = *why;
    return status == NEPH_ERR_INPUT ? NEPH_OK : status;
}

enum neph_status neph_index_agrees(struct neph_database *index, const char *key,
                                   const json_t *record, bool *agrees, struct neph_diag *diag)
{
    struct job said, job;
    struct environment said_of, environment;
    read_record(key, record, &said, &said_of);
    struct neph_query *query = neph_query(
        index, diag,
        "SELECT e.*, jobs.* FROM jobs JOIN environments AS e ON e.id = environment WHERE key = ?",
        "s", key);
    bool same = false;
    if (neph_query_next(query)) {
        neph_record_row(&neph_index_environment_form, query, 0, NULL, &environment);
        neph_record_row(&neph_index_job_form, query, ENVIRONMENT_COLUMNS, NULL, &job);
        job.environment = job.bytes = environment.id = 0;
        same = neph_record_is_equal(&neph_index_job_form, &said, &job) &&
               neph_record_is_equal(&neph_index_environment_form, &said_of, &environment);
    }
    const enum neph_status status = neph_query_end(query, NEPH_OK);
    if (!status)
        *agrees = same;
    return status;
}

enum neph_status neph_index_set_aside(const char *store_folder, const char *why,
                                      struct neph_diag *diag)
{
    struct neph_path folder;
    const enum neph_status status = find_folder(store_folder, &folder, diag);
    return status ? status : set_aside(folder.text, why, diag);
}
