/* SPDX-License-Identifier: MIT
 *
 * The store: opening, look-up, publication, removal.
 */
#include "harness/run/store.h"

#include "base/clock.h"
#include "base/files.h"
#include "base/lock.h"
#include "base/owned.h"
#include "base/path.h"
#include "base/usage.h"
#include "harness/host.h"
#include "harness/progress.h"
#include "harness/run/index.h"
#include "harness/run/store_entry.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static const char work_prefix[] = "work-";

/* A checkpoint belongs to one key, thus to one version and device. After a change of those it is
 * never resumed, which the store cannot detect: it expires after 30 days. */
static const time_t checkpoint_limit_s = 30 * 24 * 3600;

struct neph_store {
    struct neph_path folder, frames, failed, tmp, resting, lock;
    char host[NEPH_HOST_CLASS_SIZE];
};

/* ---- ownership of the folder ----------------------------------------------------------------- */

/* "<key>.<pid>": work folders of stores without a marker file. */
static bool is_old_work(const char *name)
{
    const char *pid = name + NEPH_HASH_HEX_SIZE;
    return strlen(name) > NEPH_HASH_HEX_SIZE && name[NEPH_HASH_HEX_SIZE - 1] == '.' &&
           strspn(name, "0123456789abcdef") == NEPH_HASH_HEX_SIZE - 1 &&
           strspn(pid, "0123456789") == strlen(pid);
}

static bool is_old_entry(const char *name)
{
    return neph_entry_is_key(name) || is_old_work(name) || neph_file_is_temporary(name);
}

static bool is_index_file(const char *name)
{
    return strncmp(name, "neph.sqlite", 11) == 0 || strncmp(name, "damaged-", 8) == 0;
}

static bool is_history(const char *name)
{
    return strncmp(name, "night-", 6) == 0 || strncmp(name, "accept-", 7) == 0 ||
           neph_file_is_temporary(name);
}

static const struct {
    const char *name;
    bool (*fits)(const char *); /* test of the names in the folder */
    bool was_always;            /* in every old store; else only in later ones */
} parts_of_old[] = {
    {"frames", neph_entry_is_key, true}, {"failed", neph_entry_is_key, true},
    {"tmp", is_old_entry, true},         {"resting", is_old_entry, true},
    {"index", is_index_file, false},     {"history", is_history, false},
};
enum { PARTS_OF_OLD = sizeof(parts_of_old) / sizeof(parts_of_old[0]) };

static bool is_store_part(const char *name)
{
    for (int i = 0; i < PARTS_OF_OLD; i++)
        if (strcmp(name, parts_of_old[i].name) == 0)
            return true;
    return false;
}

/* Whether all names in a folder pass the test. */
static bool has_only_names(const char *path, bool (*fits)(const char *))
{
    struct neph_arena arena = {NULL};
    struct neph_names names;
    bool alone = neph_dir_list(path, &arena, &names, NULL) == NEPH_OK;
    for (int i = 0; i < names.count; i++)
        alone = alone && fits(names.list[i]);
    neph_arena_finish(&arena);
    return alone;
}

/* A store without a marker file: it has the store's folders, and only known names in them. */
static bool is_old_store(const char *folder)
{
    bool is_old = has_only_names(folder, is_store_part);
    for (int i = 0; i < PARTS_OF_OLD && is_old; i++) {
        const struct neph_path part = neph_path_in(folder, parts_of_old[i].name);
        is_old = (!parts_of_old[i].was_always && !neph_path_exists(part.text)) ||
                 has_only_names(part.text, parts_of_old[i].fits);
    }
    return is_old;
}

static const struct neph_owned_kind store_kind = {
    .name = "store", .version = 1, .is_old = is_old_store};

/* ---- leftovers ------------------------------------------------------------------------------- */

static bool is_finished(const struct neph_store *store, const char *folder, const char *key)
{
    (void)folder;
    return neph_path_exists(neph_path_in(store->frames.text, key).text);
}

static bool is_expired_checkpoint(const struct neph_store *store, const char *folder,
                                  const char *key)
{
    struct stat info;
    return is_finished(store, folder, key) || (stat(neph_path_in(folder, key).text, &info) == 0 &&
                                               time(NULL) - info.st_mtime > checkpoint_limit_s);
}

/* Removes the entries of a folder whose name fits and for which `is_over` is true (NULL: all). */
static void
remove_entries(const struct neph_store *store, const char *folder, bool (*fits)(const char *),
               bool (*is_over)(const struct neph_store *, const char *folder, const char *name))
{
    struct neph_arena arena = {NULL};
    struct neph_names names;
    neph_dir_list(folder, &arena, &names, NULL);
    for (int i = 0; i < names.count; i++)
        if (fits(names.list[i]) && (!is_over || is_over(store, folder, names.list[i])))
            neph_dir_remove(neph_path_in(folder, names.list[i]).text, NULL);
    neph_arena_finish(&arena);
}

static void remove_leftovers(const struct neph_store *store)
{
    neph_scratch_sweep(store->tmp.text, work_prefix);
    neph_file_sweep(store->folder.text);
    neph_file_sweep(store->resting.text);
    remove_entries(store, store->tmp.text, is_old_work, NULL);
    remove_entries(store, store->failed.text, neph_entry_is_key, is_finished);
    remove_entries(store, store->resting.text, neph_entry_is_key, is_expired_checkpoint);
}

/* ---- opening --------------------------------------------------------------------------------- */

static void name_parts(const char *folder, struct neph_store *store)
{
    store->folder = neph_path_in("", folder);
    store->frames = neph_path_in(folder, "frames");
    store->failed = neph_path_in(folder, "failed");
    store->tmp = neph_path_in(folder, "tmp");
    store->resting = neph_path_in(folder, "resting");
    store->lock = neph_path_in(folder, ".neph-lock");
    neph_host_class(store->host);
}

static enum neph_status make_parts(const struct neph_store *store, struct neph_diag *diag)
{
    const char *const parts[] = {store->frames.text, store->failed.text, store->tmp.text,
                                 store->resting.text};
    enum neph_status status = neph_owned_claim(store->folder.text, &store_kind, diag);
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]) && !status; i++)
        status = neph_dir_create(parts[i], diag);
    return status;
}

/* Runs under the store's lock. A database that cannot be written is only a warning: frames are
 * found without it, and the next run refreshes it. */
static enum neph_status update_index(const struct neph_store *store, bool reads,
                                     struct neph_diag *diag)
{
    struct neph_database *index = NULL;
    struct neph_diag why = {.line = 0};
    if (neph_index_place() == NEPH_INDEX_NONE)
        return NEPH_OK;
    const enum neph_status status = neph_index_open(store->folder.text, reads, &index, &why);
    neph_database_close(index);
    if (status == NEPH_ERR_IO) {
        neph_progress_warn("the store's database is not up to date; frames are not affected: %s",
                           why.message);
        return NEPH_OK;
    }
    if (status && diag)
        *diag = why;
    return status;
}

enum neph_status neph_store_open(const char *folder, struct neph_store **store,
                                 struct neph_diag *diag)
{
    struct neph_store *opened = calloc(1, sizeof(*opened));
    if (!opened)
        return neph_fail_memory(diag);
    int lock = -1;
    name_parts(folder, opened);
    enum neph_status status = make_parts(opened, diag);
    if (!status)
        status = neph_lock_wait(opened->lock.text, &lock, diag);
    if (!status) {
        remove_leftovers(opened);
        status = update_index(opened, true, diag);
        close(lock);
    }
    if (status)
        free(opened);
    else
        *store = opened;
    return status;
}

void neph_store_close(struct neph_store *store)
{
    int lock = -1;
    if (!store)
        return;
    if (neph_lock_wait(store->lock.text, &lock, NULL) == NEPH_OK) {
        update_index(store, false, NULL);
        close(lock);
    }
    free(store);
}

const char *neph_store_folder(const struct neph_store *store)
{
    return store->folder.text;
}

enum neph_status neph_store_index(const struct neph_store *store, struct neph_database **index,
                                  struct neph_diag *diag)
{
    int lock = -1;
    enum neph_status status = neph_lock_wait(store->lock.text, &lock, diag);
    if (status)
        return status;
    status = neph_index_open(store->folder.text, false, index, diag);
    close(lock);
    return status;
}

enum neph_status neph_store_rebuild_index(const struct neph_store *store, const char *why,
                                          struct neph_database **index, struct neph_diag *diag)
{
    int lock = -1;
    enum neph_status status = neph_lock_wait(store->lock.text, &lock, diag);
    if (status)
        return status;
    status = neph_index_set_aside(store->folder.text, why, diag);
    if (!status)
        status = neph_index_open(store->folder.text, false, index, diag);
    close(lock);
    return status;
}

/* ---- look-up --------------------------------------------------------------------------------- */

/* Moves an entry away in one step, so that other processes never see a part of it. Runs under the
 * store's lock. `why` NULL: without a message. */
static void discard(const struct neph_store *store, const char *entry, const char *why)
{
    struct neph_scratch *bin = NULL;
    struct neph_diag diag = {.line = 0};
    if (why)
        neph_progress_warn("'%s' is not used and is removed: %s", entry, why);
    if (neph_scratch_create(store->tmp.text, work_prefix, &bin, &diag)) {
        neph_progress_warn("'%s' cannot be removed: %s", entry, diag.message);
    } else {
        if (rename(entry, neph_path_in(neph_scratch_path(bin), "entry").text) != 0)
            neph_progress_warn("'%s' cannot be removed: %s", entry, strerror(errno));
    }
    neph_scratch_destroy(bin);
}

/* Checks again under the lock, as another process may have replaced the entry by a good one. */
static enum neph_entry_state discard_if_bad(const struct neph_store *store, const char *entry,
                                            const char *key, json_t **record)
{
    char why[NEPH_ENTRY_WHY_BYTES];
    int lock = -1;
    if (neph_lock_wait(store->lock.text, &lock, NULL))
        return NEPH_ENTRY_BAD;
    const enum neph_entry_state state = neph_entry_check(entry, key, record, why);
    if (state == NEPH_ENTRY_BAD)
        discard(store, entry, why);
    close(lock);
    return state;
}

/* Updates the modification time of job.json, which nothing else changes. Eviction and the frame
 * lists of nightly runs use it. */
static void update_use_time(const char *frame_path)
{
    const struct neph_path record = neph_path_format(
        "%.*sjob.json", (int)(strrchr(frame_path, '/') + 1 - frame_path), frame_path);
    if (utimensat(AT_FDCWD, record.text, NULL, 0) != 0)
        neph_progress_warn(
            "cannot update the time of '%s', so eviction counts the frame as older: %s",
            record.text, strerror(errno));
}

void neph_store_key_from_path(const char *frame_path, char key[NEPH_HASH_HEX_SIZE])
{
    const size_t digits = NEPH_HASH_HEX_SIZE - 1;
    const char *slash = strrchr(frame_path, '/');
    key[0] = '\0';
    if (!slash || (size_t)(slash - frame_path) <= digits || slash[-1 - (ptrdiff_t)digits] != '/' ||
        strspn(slash - digits, "0123456789abcdef") != digits)
        return;
    snprintf(key, NEPH_HASH_HEX_SIZE, "%.*s", (int)digits, slash - digits);
}

bool neph_store_find(struct neph_store *store, const char *key, char **frame_path, json_t **record)
{
    char why[NEPH_ENTRY_WHY_BYTES];
    const struct neph_path entry = neph_path_in(store->frames.text, key);
    json_t *found = NULL;
    enum neph_entry_state state = neph_entry_check(entry.text, key, &found, why);
    if (state == NEPH_ENTRY_BAD)
        state = discard_if_bad(store, entry.text, key, &found);
    if (state == NEPH_ENTRY_UNREADABLE)
        neph_progress_warn("'%s' is not used: %s", entry.text, why);
    char *path = state == NEPH_ENTRY_GOOD ? neph_path_join(entry.text, "frame.exr") : NULL;
    if (!path) {
        json_decref(state == NEPH_ENTRY_GOOD ? found : NULL);
        return false;
    }
    update_use_time(path);
    *frame_path = path;
    *record = found;
    return true;
}

struct neph_path neph_store_checkpoint_path(const struct neph_store *store, const char *key)
{
    return neph_path_in(store->resting.text, key);
}

/* ---- work folders and publication ------------------------------------------------------------ */

enum neph_status neph_store_begin(struct neph_store *store, struct neph_scratch **scratch,
                                  struct neph_diag *diag)
{
    return neph_scratch_create(store->tmp.text, work_prefix, scratch, diag);
}

static bool worth_keeping(const char *name)
{
    static const char *const endings[] = {".log", ".json", ".pov"};
    const char *dot = strrchr(name, '.');
    for (size_t i = 0; dot && i < sizeof(endings) / sizeof(endings[0]); i++)
        if (strcmp(dot, endings[i]) == 0)
            return true;
    return strcmp(name, "frame.exr") == 0;
}

/* Whether a file left by an external program fits into the limits of kept files. */
static bool fits(const char *path, struct neph_usage *kept)
{
    struct stat info;
    if (lstat(path, &info) != 0 || !S_ISREG(info.st_mode) || access(path, R_OK) != 0)
        return false;
    kept->bytes += (int64_t)info.st_size;
    kept->entries++;
    const bool is_kept = kept->bytes <= NEPH_KEPT_BYTES && kept->entries <= NEPH_KEPT_ENTRIES;
    if (!is_kept)
        kept->bytes -= (int64_t)info.st_size;
    return is_kept;
}

/* `kept` not NULL, files of an external program: only logs and inputs, within the limits. `kept`
 * NULL, files written by neph: results and images as well. */
static bool is_file_kept(const char *path, const char *name, const json_t *record,
                         struct neph_usage *kept)
{
    return kept ? worth_keeping(name) && fits(path, kept)
                : worth_keeping(name) || neph_entry_has_picture(record, name);
}

/* Removes the other files. Files written by neph are synced to disk, then the folder. */
static enum neph_status remove_and_sync_files(const char *scratch, const json_t *record,
                                              struct neph_usage *kept, struct neph_diag *diag)
{
    struct neph_arena arena = {NULL};
    struct neph_names names;
    enum neph_status status = neph_dir_list(scratch, &arena, &names, diag);
    for (int i = 0; i < names.count && !status; i++) {
        const struct neph_path path = neph_path_in(scratch, names.list[i]);
        if (!is_file_kept(path.text, names.list[i], record, kept))
            status = neph_dir_remove(path.text, diag);
        else if (!kept)
            status = neph_file_sync(path.text, diag);
    }
    neph_arena_finish(&arena);
    return status || kept ? status : neph_file_sync(scratch, diag);
}

enum neph_status neph_store_clean(const struct neph_scratch *scratch, struct neph_diag *diag)
{
    struct neph_usage kept = {.bytes = 0};
    return remove_and_sync_files(neph_scratch_path(scratch), NULL, &kept, diag);
}

/* Runs under the store's lock. A good entry from another run is used as it is. */
static enum neph_status put_entry(const struct neph_store *store, const char *key,
                                  const char *scratch, const char *entry, struct neph_diag *diag)
{
    char why[NEPH_ENTRY_WHY_BYTES];
    json_t *theirs = NULL;
    const enum neph_entry_state state = neph_entry_check(entry, key, &theirs, why);
    json_decref(theirs);
    if (state == NEPH_ENTRY_GOOD)
        return NEPH_OK;
    if (state == NEPH_ENTRY_UNREADABLE)
        return neph_fail(diag, NEPH_ERR_IO, "'%s' is in the way: %s", entry, why);
    if (state == NEPH_ENTRY_BAD)
        discard(store, entry, why);
    if (rename(scratch, entry) != 0)
        return neph_fail(diag, NEPH_ERR_IO, "cannot publish '%s': %s", entry, strerror(errno));
    neph_dir_remove(neph_path_in(store->failed.text, key).text, NULL);
    return neph_file_sync(store->frames.text, diag);
}

enum neph_status neph_store_publish(struct neph_store *store, const char *key,
                                    const struct neph_scratch *scratch, json_t *record,
                                    struct neph_diag *diag)
{
    const char *path = neph_scratch_path(scratch);
    char now[32];
    int lock = -1;
    neph_utc_now(now);
    enum neph_status status = neph_json_put(record, "host", json_string(store->host), diag);
    if (!status)
        status = neph_json_put(record, "created_utc", json_string(now), diag);
    if (!status)
        status = neph_entry_write_record(path, key, record, diag);
    if (!status)
        status = remove_and_sync_files(path, record, NULL, diag);
    if (!status)
        status = neph_lock_wait(store->lock.text, &lock, diag);
    if (!status) {
        status = put_entry(store, key, path, neph_path_in(store->frames.text, key).text, diag);
        close(lock);
    }
    return status;
}

bool neph_store_remove(struct neph_store *store, const char *key, int64_t unused_since_s,
                       const char *why)
{
    const struct neph_path entry = neph_path_in(store->frames.text, key);
    struct stat info;
    int lock = -1;
    bool removes = neph_lock_wait(store->lock.text, &lock, NULL) == NEPH_OK;
    if (removes && unused_since_s > 0 &&
        stat(neph_path_in(entry.text, "job.json").text, &info) == 0)
        removes = info.st_mtime <= unused_since_s;
    if (removes)
        discard(store, entry.text, why);
    removes = removes && !neph_path_exists(entry.text);
    if (lock >= 0)
        close(lock);
    return removes;
}

void neph_store_abandon(struct neph_store *store, const char *key,
                        const struct neph_scratch *scratch, char **kept)
{
    const struct neph_path entry = neph_path_in(store->failed.text, key);
    int lock = -1;
    *kept = NULL;
    if (neph_store_clean(scratch, NULL) || neph_lock_wait(store->lock.text, &lock, NULL))
        return;
    if (neph_dir_remove(entry.text, NULL) == NEPH_OK &&
        rename(neph_scratch_path(scratch), entry.text) == 0)
        *kept = strdup(entry.text);
    close(lock);
}
