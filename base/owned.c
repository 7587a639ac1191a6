/* SPDX-License-Identifier: MIT */
#include "base/owned.h"

#include "base/files.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char marker_name[] = ".neph-owned";
static const size_t marker_limit_bytes = 4096;

enum contents { NOTHING, SOMETHING, MARKED };

static enum neph_status refuse(struct neph_diag *diag, const char *folder,
                               const struct neph_owned_kind *kind, const char *why)
{
    neph_fail(diag, NEPH_ERR_USAGE,
              "'%s' %s: neph does not use it for its %s, because it would replace and remove files",
              folder, why, kind->name);
    neph_hint(diag, "name another folder with -o, or move '%s' away", folder);
    return NEPH_ERR_USAGE;
}

/* Whether a name counts as contents. The temporary file that becomes a marker does not. */
static bool counts(const char *name)
{
    return strcmp(name, ".") != 0 && strcmp(name, "..") != 0 && !neph_file_is_temporary(name);
}

static enum neph_status look_inside(const char *folder, const struct neph_owned_kind *kind,
                                    enum contents *contents, struct neph_diag *diag)
{
    *contents = NOTHING;
    DIR *directory = opendir(folder);
    if (!directory && errno == ENOENT)
        return NEPH_OK;
    if (!directory && errno == ENOTDIR)
        return refuse(diag, folder, kind, "is not a folder");
    if (!directory)
        return neph_fail(diag, NEPH_ERR_IO, "cannot open '%s': %s", folder, strerror(errno));
    for (const struct dirent *entry; (entry = readdir(directory));) {
        if (*contents == NOTHING && counts(entry->d_name))
            *contents = SOMETHING;
        if (strcmp(entry->d_name, marker_name) == 0)
            *contents = MARKED;
    }
    closedir(directory);
    return NEPH_OK;
}

/* The first line gives the kind of the folder; the lines after it are for people. */
static enum neph_status check_marker(const char *folder, const char *text,
                                     const struct neph_owned_kind *kind, struct neph_diag *diag)
{
    char name[32], why[128];
    int version;
    if (sscanf(text, "neph %31[a-z] %d", name, &version) != 2)
        return refuse(diag, folder, kind, "has a damaged marker file (.neph-owned)");
    if (strcmp(name, kind->name) != 0) {
        snprintf(why, sizeof(why), "is neph's %s", name);
        return refuse(diag, folder, kind, why);
    }
    if (version >= 1 && version <= kind->version)
        return NEPH_OK;
    snprintf(why, sizeof(why), "is a %s of layout %d, made by another version of neph", name,
             version);
    return refuse(diag, folder, kind, why);
}

static enum neph_status read_marker(const char *folder, const struct neph_owned_kind *kind,
                                    bool *found, struct neph_diag *diag)
{
    char *path = neph_path_join(folder, marker_name);
    char *text = NULL;
    size_t size;
    enum neph_status status = path ? neph_file_read(path, marker_limit_bytes, &text, &size, diag)
                                   : neph_fail_memory(diag);
    *found = status == NEPH_OK;
    if (*found)
        status = check_marker(folder, text, kind, diag);
    else if (status == NEPH_ERR_NOT_FOUND)
        status = NEPH_OK;
    free(text);
    free(path);
    return status;
}

/* Look inside first and read the marker second. Another run writes the marker before its files, so
 * if files were seen and there is still no marker, they are not of another run. */
static enum neph_status check(const char *folder, const struct neph_owned_kind *kind, bool *marked,
                              struct neph_diag *diag)
{
    enum contents contents;
    enum neph_status status = look_inside(folder, kind, &contents, diag);
    if (!status)
        status = read_marker(folder, kind, marked, diag);
    if (status || *marked || contents == NOTHING)
        return status;
    if (contents == SOMETHING && kind->is_old && kind->is_old(folder))
        return NEPH_OK;
    return refuse(diag, folder, kind, "has files in it and was not made by neph");
}

enum neph_status neph_owned_check(const char *folder, const struct neph_owned_kind *kind,
                                  struct neph_diag *diag)
{
    bool marked;
    return check(folder, kind, &marked, diag);
}

static enum neph_status mark(const char *folder, const struct neph_owned_kind *kind,
                             struct neph_diag *diag)
{
    char *path = neph_path_join(folder, marker_name);
    char *text = neph_format("neph %s %d\nNephelometer made this folder and replaces or removes "
                             "its contents; keep no files of your own here.\n",
                             kind->name, kind->version);
    const enum neph_status status = path && text ? neph_file_write(path, text, strlen(text), diag)
                                                 : neph_fail_memory(diag);
    free(path);
    free(text);
    return status;
}

enum neph_status neph_owned_claim(const char *folder, const struct neph_owned_kind *kind,
                                  struct neph_diag *diag)
{
    bool marked;
    enum neph_status status = check(folder, kind, &marked, diag);
    if (!status)
        status = neph_dir_create(folder, diag);
    return status || marked ? status : mark(folder, kind, diag);
}
