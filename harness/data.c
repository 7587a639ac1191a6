/* SPDX-License-Identifier: MIT */
#include "harness/data.h"

#include "base/files.h"
#include "metrics/extractors/extractors.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_DATA_SCENES_COUNT == 2, "a new kind");

static const struct {
    const char *name, *old_name;
} scene_folders[NEPH_DATA_SCENES_COUNT] = {
    [NEPH_DATA_CATALOG] = {"scenes/catalog", "scenes/catalog"},
    [NEPH_DATA_STRESS] = {"scenes/stress", "scenes/failure"},
};

char *neph_data_directory(void)
{
    const char *named = getenv("NEPH_DATA_DIR");
    if (named && named[0])
        return strdup(named);
    char *installed = neph_path_beside_program(NEPH_DATA_BESIDE_PROGRAM);
    return installed ? installed : strdup(NEPH_SOURCE_DIR);
}

char *neph_data_path(const char *relative)
{
    char *directory = neph_data_directory();
    char *path = directory ? neph_path_join(directory, relative) : NULL;
    free(directory);
    return path;
}

char *neph_data_renamed_path(const char *relative, const char *old_relative)
{
    char *path = neph_data_path(relative), *old = neph_data_path(old_relative);
    const bool is_old = path && old && !neph_path_exists(path) && neph_path_exists(old);
    free(is_old ? path : old);
    return is_old ? old : path;
}

/* For the caller to free; NULL when memory is short. */
static char *find_scene_folder(enum neph_data_scenes which)
{
    return neph_data_renamed_path(scene_folders[which].name, scene_folders[which].old_name);
}

static bool is_plain_name(const char *text)
{
    return text[0] && strspn(text, "abcdefghijklmnopqrstuvwxyz0123456789_") == strlen(text);
}

char *neph_cache_path(void)
{
    const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    if (cache && cache[0] == '/') /* relative ones are to be ignored: XDG Base Directory */
        return neph_format("%s/nephelometer", cache);
    if (home && *home)
        return neph_format("%s/.cache/nephelometer", home);
    return neph_format("/tmp/nephelometer-%ld", (long)getuid());
}

/* Gates hold numbers by the names of the metrics module, which the scenes module does not know. */
static bool may_limit(const char *metric, char *why, size_t size)
{
    const struct neph_extractor *owner = NULL;
    const bool is_there = neph_metric_find(metric, &owner);
    if (is_there && !owner->costly && !owner->temporal)
        return true;
    snprintf(why, size, "is %s", is_there ? "not among the numbers of every picture" : "no metric");
    return false;
}

static enum neph_status load(const char *path, struct neph_scene **scene, struct neph_diag *diag)
{
    const enum neph_status status = neph_scene_load_checked(path, may_limit, scene, diag);
    if (!status && (*scene)->warning)
        fprintf(stderr, "warning: %s\n", (*scene)->warning);
    return status;
}

/* The file of a scene, to free. NEPH_ERR_NOT_FOUND: no scene of the catalogue has that name; a path
 * is not looked at. */
static enum neph_status find_scene(const char *path_or_name, char **path, struct neph_diag *diag)
{
    const bool is_path = !is_plain_name(path_or_name) || neph_path_exists(path_or_name);
    if (is_path && !(*path = strdup(path_or_name)))
        return neph_fail_memory(diag);
    if (is_path)
        return NEPH_OK;
    for (int folder = 0; folder < NEPH_DATA_SCENES_COUNT; folder++) {
        char *within = find_scene_folder((enum neph_data_scenes)folder);
        char *found = within ? neph_format("%s/%s.yaml", within, path_or_name) : NULL;
        free(within);
        if (!found)
            return neph_fail_memory(diag);
        *path = found;
        if (neph_path_exists(found))
            return NEPH_OK;
        free(found);
    }
    neph_fail(diag, NEPH_ERR_NOT_FOUND, "no file and no scene of the catalogue is called '%s'",
              path_or_name);
    neph_hint(diag, "`neph scenes` lists the catalogue");
    return NEPH_ERR_NOT_FOUND;
}

enum neph_status neph_data_load_scene(const char *path_or_name, struct neph_scene **scene,
                                      struct neph_diag *diag)
{
    char *path;
    enum neph_status status = find_scene(path_or_name, &path, diag);
    if (status)
        return status;
    status = load(path, scene, diag);
    free(path);
    return status;
}

static enum neph_status check_is_there(const char *path_or_name, struct neph_diag *diag)
{
    char *path;
    enum neph_status status = find_scene(path_or_name, &path, diag);
    if (status)
        return status;
    if (!neph_path_exists(path))
        status = neph_fail(diag, NEPH_ERR_NOT_FOUND, "cannot read '%s': %s", path,
                           strerror(ENOENT));
    free(path);
    return status;
}

static enum neph_status compare_names(const char *first, const char *second, struct neph_diag *diag)
{
    char *a = neph_scene_name_from_path(first), *b = neph_scene_name_from_path(second);
    enum neph_status status = a && b ? NEPH_OK : neph_fail_memory(diag);
    if (!status && strcmp(a, b) == 0) {
        status = neph_fail(diag, NEPH_ERR_USAGE,
                           "'%s' and '%s' are both called %s: their pictures would be mixed up",
                           first, second, a);
        neph_hint(diag, "give one of them another name, in the file and of the file, or run them "
                        "one after the other with another -o");
    }
    free(a);
    free(b);
    return status;
}

enum neph_status neph_data_check_scenes(const char *const *scenes, int count,
                                        struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && !status; i++)
        status = check_is_there(scenes[i], diag);
    for (int i = 0; i < count && !status; i++)
        for (int j = 0; j < i && !status; j++)
            status = compare_names(scenes[j], scenes[i], diag);
    return status;
}

static int keep_yaml(const struct dirent *entry)
{
    const char *dot = strrchr(entry->d_name, '.');
    return entry->d_name[0] != '.' && dot && strcmp(dot, ".yaml") == 0;
}

enum neph_status neph_data_list_scenes(enum neph_data_scenes which, char ***names, int *count,
                                       struct neph_diag *diag)
{
    char *folder = find_scene_folder(which);
    struct dirent **entries = NULL;
    const int found = folder ? scandir(folder, &entries, keep_yaml, alphasort) : -1;
    if (found < 0) {
        enum neph_status status = neph_fail(diag, NEPH_ERR_NOT_FOUND, "no scenes at '%s': %s",
                                            folder ? folder : "?", strerror(errno));
        neph_hint(diag, "set NEPH_DATA_DIR to the folder that holds scenes/ and scripts/");
        free(folder);
        return status;
    }
    char **list = calloc((size_t)found + 1, sizeof(*list));
    bool complete = list != NULL;
    for (int i = 0; i < found; i++) {
        if (complete)
            complete = (list[i] = strndup(entries[i]->d_name,
                                          strlen(entries[i]->d_name) - strlen(".yaml")));
        free(entries[i]);
    }
    free(entries);
    free(folder);
    if (!complete) {
        neph_data_free_names(list);
        return neph_fail_memory(diag);
    }
    *names = list;
    *count = found;
    return NEPH_OK;
}

void neph_data_free_names(char **names)
{
    for (int i = 0; names && names[i]; i++)
        free(names[i]);
    free(names);
}
