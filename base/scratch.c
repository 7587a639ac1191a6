/* SPDX-License-Identifier: MIT */
#include "base/scratch.h"

#include "base/files.h"
#include "base/lock.h"
#include "base/usage.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

static const char lock_ending[] = ".lock";
static const size_t tag_length = 16;
static const int tries = 16; /* a try fails only if a sweep comes between two system calls */

struct neph_scratch {
    char *path, *lock_path;
    int lock_fd;
};

static enum neph_status fail(const char *parent, struct neph_diag *diag)
{
    return neph_fail(diag, NEPH_ERR_IO, "cannot create a scratch folder in '%s': %s", parent,
                     strerror(errno));
}

static enum neph_status name_scratch(const char *parent, const char *prefix,
                                     struct neph_scratch *scratch, struct neph_diag *diag)
{
    uint64_t tag;
    if (getrandom(&tag, sizeof(tag), 0) != (ssize_t)sizeof(tag))
        return fail(parent, diag);
    char *path = neph_path_join(parent, prefix);
    free(scratch->path);
    free(scratch->lock_path);
    scratch->path = path ? neph_format("%s%016" PRIx64, path, tag) : NULL;
    scratch->lock_path = scratch->path ? neph_format("%s%s", scratch->path, lock_ending) : NULL;
    free(path);
    return scratch->lock_path ? NEPH_OK : neph_fail_memory(diag);
}

static enum neph_status lock_scratch(const char *parent, const char *prefix,
                                     struct neph_scratch *scratch, struct neph_diag *diag)
{
    for (int i = 0; i < tries; i++) {
        const enum neph_status status = name_scratch(parent, prefix, scratch, diag);
        if (status)
            return status;
        scratch->lock_fd = neph_lock_create(scratch->lock_path);
        if (scratch->lock_fd >= 0)
            return NEPH_OK;
        if (errno != EEXIST)
            break;
    }
    return fail(parent, diag);
}

enum neph_status neph_scratch_create(const char *parent, const char *prefix,
                                     struct neph_scratch **scratch, struct neph_diag *diag)
{
    struct neph_scratch *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->lock_fd = -1;
    enum neph_status status = lock_scratch(parent, prefix, made, diag);
    if (!status && mkdir(made->path, 0777) != 0)
        status = fail(parent, diag);
    if (status) {
        neph_scratch_destroy(made);
        return status;
    }
    *scratch = made;
    return NEPH_OK;
}

const char *neph_scratch_path(const struct neph_scratch *scratch)
{
    return scratch->path;
}

void neph_scratch_destroy(struct neph_scratch *scratch)
{
    if (!scratch)
        return;
    if (scratch->lock_fd >= 0) {
        /* The lock file must outlive the folder: a sweep finds folders by their lock files. */
        if (neph_dir_remove(scratch->path, NULL) == NEPH_OK)
            unlink(scratch->lock_path);
        close(scratch->lock_fd);
    }
    free(scratch->path);
    free(scratch->lock_path);
    free(scratch);
}

bool neph_scratch_keep(struct neph_scratch *scratch)
{
    const bool kept = rmdir(scratch->path) != 0 && errno == ENOTEMPTY;
    if (kept)
        neph_usage_trim(scratch->path);
    unlink(scratch->lock_path);
    close(scratch->lock_fd);
    scratch->lock_fd = -1;
    neph_scratch_destroy(scratch);
    return kept;
}

/* PREFIX<16 hexadecimal digits>.lock */
static bool is_lock_name(const char *name, const char *prefix)
{
    const size_t prefix_length = strlen(prefix);
    return strncmp(name, prefix, prefix_length) == 0 &&
           strspn(name + prefix_length, "0123456789abcdef") == tag_length &&
           strcmp(name + prefix_length + tag_length, lock_ending) == 0;
}

static void sweep_one(const char *parent, const char *lock_name)
{
    char *lock_path = neph_path_join(parent, lock_name);
    char *path = lock_path ? strndup(lock_path, strlen(lock_path) - strlen(lock_ending)) : NULL;
    const int fd = path ? neph_lock_take_over(lock_path) : -1;
    if (fd >= 0) {
        if (neph_dir_remove(path, NULL) == NEPH_OK)
            unlink(lock_path);
        close(fd);
    }
    free(path);
    free(lock_path);
}

void neph_scratch_sweep(const char *parent, const char *prefix)
{
    DIR *directory = opendir(parent);
    if (!directory)
        return;
    for (const struct dirent *entry; (entry = readdir(directory));)
        if (is_lock_name(entry->d_name, prefix))
            sweep_one(parent, entry->d_name);
    closedir(directory);
}
