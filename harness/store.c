/* SPDX-License-Identifier: MIT */
#include "harness/store.h"

#include "base/files.h"
#include "base/owned.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const size_t record_limit_bytes = 1 << 20;

struct neph_store {
    char *frames, *failed, *tmp, *resting;
};

/* ---- whose folder it is ---------------------------------------------------------------------- */

static bool is_key(const char *name)
{
    return strlen(name) == NEPH_HASH_HEX_SIZE - 1 &&
           strspn(name, "0123456789abcdef") == NEPH_HASH_HEX_SIZE - 1;
}

/* <key>.<pid>: work in progress of stores without a marker. */
static bool is_old_work(const char *name)
{
    const char *pid = name + NEPH_HASH_HEX_SIZE;
    return strlen(name) > NEPH_HASH_HEX_SIZE && name[NEPH_HASH_HEX_SIZE - 1] == '.' &&
           strspn(name, "0123456789abcdef") == NEPH_HASH_HEX_SIZE - 1 &&
           strspn(pid, "0123456789") == strlen(pid);
}

static bool is_old_entry(const char *name)
{
    return is_key(name) || is_old_work(name) || neph_file_is_temporary(name);
}

static bool is_store_part(const char *name)
{
    static const char *const parts[] = {"frames", "failed", "tmp", "resting"};
    for (size_t i = 0; i < sizeof(parts) / sizeof(parts[0]); i++)
        if (strcmp(name, parts[i]) == 0)
            return true;
    return false;
}

/* Whether `folder`/`part` is a folder of such names alone. */
static bool holds_alone(const char *folder, const char *part, bool (*fits)(const char *))
{
    char *path = neph_path_join(folder, part);
    DIR *directory = path ? opendir(path) : NULL;
    bool alone = directory != NULL;
    for (const struct dirent *entry; alone && (entry = readdir(directory));)
        alone = strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0 ||
                fits(entry->d_name);
    if (directory)
        closedir(directory);
    free(path);
    return alone;
}

/* A store of before the marker: its four folders, and nothing in them but what it names. */
static bool is_old_store(const char *folder)
{
    return holds_alone(folder, ".", is_store_part) && holds_alone(folder, "frames", is_key) &&
           holds_alone(folder, "failed", is_key) && holds_alone(folder, "tmp", is_old_entry) &&
           holds_alone(folder, "resting", is_old_entry);
}

static const struct neph_owned_kind store_kind = {
    .name = "store", .version = 1, .is_old = is_old_store};

/* tmp/<key>.<pid>: whether the process that made it is gone. */
static bool is_stale(const char *name)
{
    const char *dot = strrchr(name, '.');
    if (!dot)
        return true;
    char *end;
    const long pid = strtol(dot + 1, &end, 10);
    return *end != '\0' || pid <= 0 || (kill((pid_t)pid, 0) != 0 && errno == ESRCH);
}

static void remove_stale_work(const char *tmp)
{
    DIR *directory = opendir(tmp);
    if (!directory)
        return;
    for (struct dirent *entry; (entry = readdir(directory));) {
        if (entry->d_name[0] == '.' || !is_stale(entry->d_name))
            continue;
        char *path = neph_path_join(tmp, entry->d_name);
        if (path)
            neph_dir_remove(path, NULL);
        free(path);
    }
    closedir(directory);
}

enum neph_status neph_store_open(const char *folder, struct neph_store **store,
                                 struct neph_diag *diag)
{
    struct neph_store *opened = calloc(1, sizeof(*opened));
    if (!opened)
        return neph_fail_memory(diag);
    opened->frames = neph_path_join(folder, "frames");
    opened->failed = neph_path_join(folder, "failed");
    opened->tmp = neph_path_join(folder, "tmp");
    opened->resting = neph_path_join(folder, "resting");
    enum neph_status status = NEPH_OK;
    if (!opened->frames || !opened->failed || !opened->tmp || !opened->resting)
        status = neph_fail_memory(diag);
    if (!status)
        status = neph_owned_claim(folder, &store_kind, diag);
    if (!status)
        status = neph_dir_create(opened->frames, diag);
    if (!status)
        status = neph_dir_create(opened->failed, diag);
    if (!status)
        status = neph_dir_create(opened->tmp, diag);
    if (!status)
        status = neph_dir_create(opened->resting, diag);
    if (status) {
        neph_store_close(opened);
        return status;
    }
    remove_stale_work(opened->tmp);
    *store = opened;
    return NEPH_OK;
}

void neph_store_close(struct neph_store *store)
{
    if (!store)
        return;
    free(store->frames);
    free(store->failed);
    free(store->tmp);
    free(store->resting);
    free(store);
}

static json_t *read_record(const char *entry)
{
    char *path = neph_path_join(entry, "job.json");
    char *text = NULL;
    size_t size;
    json_t *record = NULL;
    if (path && neph_file_read(path, record_limit_bytes, &text, &size, NULL) == NEPH_OK)
        record = json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL);
    free(text);
    free(path);
    return record;
}

static bool hash_is_right(const char *frame_path, const json_t *record)
{
    char hex[NEPH_HASH_HEX_SIZE];
    const char *expected = json_string_value(json_object_get(record, "frame_blake2b"));
    return expected && neph_hash_file(frame_path, hex, NULL) == NEPH_OK &&
           strcmp(hex, expected) == 0;
}

bool neph_store_find(struct neph_store *store, const char *key, char **frame_path, json_t **record)
{
    char *entry = neph_path_join(store->frames, key);
    if (!entry || !neph_path_exists(entry)) {
        free(entry);
        return false;
    }
    json_t *found = read_record(entry);
    char *path = neph_path_join(entry, "frame.exr");
    const bool good = found && path && hash_is_right(path, found);
    if (good) {
        *frame_path = path;
        *record = found;
    } else {
        neph_dir_remove(entry, NULL);
        json_decref(found);
        free(path);
    }
    free(entry);
    return good;
}

char *neph_store_resting_place(const struct neph_store *store, const char *key)
{
    return neph_path_join(store->resting, key);
}

enum neph_status neph_store_begin(struct neph_store *store, const char *key, char **scratch,
                                  struct neph_diag *diag)
{
    char *path = neph_format("%s/%s.%ld", store->tmp, key, (long)getpid());
    if (!path)
        return neph_fail_memory(diag);
    enum neph_status status = neph_dir_remove(path, diag);
    if (!status)
        status = neph_dir_create(path, diag);
    if (status) {
        free(path);
        return status;
    }
    *scratch = path;
    return NEPH_OK;
}

static bool has_ending(const char *name, const char *ending)
{
    const size_t length = strlen(name), ending_length = strlen(ending);
    return length >= ending_length && strcmp(name + length - ending_length, ending) == 0;
}

static bool worth_keeping(const char *name)
{
    static const char *const endings[] = {".log", ".json", ".pov"};
    for (size_t i = 0; i < sizeof(endings) / sizeof(endings[0]); i++)
        if (has_ending(name, endings[i]))
            return true;
    return strcmp(name, "frame.exr") == 0;
}

/* Remove what need not be kept and bring the rest to disk. */
static enum neph_status tidy(const char *scratch, struct neph_diag *diag)
{
    DIR *directory = opendir(scratch);
    if (!directory)
        return neph_fail(diag, NEPH_ERR_IO, "cannot open '%s': %s", scratch, strerror(errno));
    for (struct dirent *entry; (entry = readdir(directory));) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0 ||
            worth_keeping(entry->d_name))
            continue;
        char *path = neph_path_join(scratch, entry->d_name);
        if (path)
            neph_dir_remove(path, NULL);
        free(path);
    }
    fsync(dirfd(directory));
    closedir(directory);
    return NEPH_OK;
}

static enum neph_status write_record(const char *scratch, json_t *record, struct neph_diag *diag)
{
    char hex[NEPH_HASH_HEX_SIZE];
    char *frame_path = neph_path_join(scratch, "frame.exr");
    char *record_path = neph_path_join(scratch, "job.json");
    char *text = NULL;
    enum neph_status status = frame_path && record_path ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = neph_hash_file(frame_path, hex, diag);
    if (!status && json_object_set_new(record, "frame_blake2b", json_string(hex)) != 0)
        status = neph_fail_memory(diag);
    if (!status && !(text = json_dumps(record, JSON_INDENT(2))))
        status = neph_fail_memory(diag);
    if (!status)
        status = neph_file_write(record_path, text, strlen(text), diag);
    free(text);
    free(frame_path);
    free(record_path);
    return status;
}

static void sync_folder(const char *path)
{
    const int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd >= 0) {
        fsync(fd);
        close(fd);
    }
}

enum neph_status neph_store_publish(struct neph_store *store, const char *key, const char *scratch,
                                    json_t *record, struct neph_diag *diag)
{
    enum neph_status status = write_record(scratch, record, diag);
    if (!status)
        status = tidy(scratch, diag);
    if (status)
        return status;
    char *entry = neph_path_join(store->frames, key);
    if (!entry)
        return neph_fail_memory(diag);
    if (rename(scratch, entry) == 0)
        sync_folder(store->frames);
    else if (errno == ENOTEMPTY || errno == EEXIST)
        neph_dir_remove(scratch, NULL); /* another run was first: theirs is as good */
    else
        status = neph_fail(diag, NEPH_ERR_IO, "cannot publish '%s': %s", entry, strerror(errno));
    free(entry);
    return status;
}

void neph_store_abandon(struct neph_store *store, const char *key, const char *scratch, char **kept)
{
    *kept = NULL;
    char *entry = neph_path_join(store->failed, key);
    if (entry && neph_dir_remove(entry, NULL) == NEPH_OK && tidy(scratch, NULL) == NEPH_OK &&
        rename(scratch, entry) == 0)
        *kept = entry;
    else
        free(entry);
}
