/* SPDX-License-Identifier: MIT */
#include "harness/cli/new_scene.h"

#include "base/files.h"
#include "harness/data.h"
#include "scenes/volume_scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEMPLATE_MAX_BYTES = 64 * 1024 };

static const char kind_vdb[] = "vdb";
static const char *const kinds[] = {"fog", "cloud", "grid", kind_vdb}; /* files of scenes/new/ */

static enum neph_status check_kind(const struct neph_new_scene *request, struct neph_diag *diag)
{
    for (size_t i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++)
        if (strcmp(request->kind, kinds[i]) == 0)
            return NEPH_OK;
    neph_fail(diag, NEPH_ERR_USAGE, "--new '%s': there is no such scene to begin with",
              request->kind);
    neph_hint(diag, "fog, cloud, grid or vdb");
    return NEPH_ERR_USAGE;
}

/* The file name without .yaml becomes the name of the scene, so it may have only these letters. */
static enum neph_status check_path(const struct neph_new_scene *request, struct neph_diag *diag)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyz0123456789_";
    const char *slash = strrchr(request->path, '/');
    const char *name = slash ? slash + 1 : request->path;
    const size_t length = strspn(name, letters);
    if (length < 1 || length > 64 || strcmp(name + length, ".yaml") != 0) {
        neph_fail(diag, NEPH_ERR_USAGE,
                  "'%s' is no name of a scene file: 1 to 64 of a-z, 0-9 and _, then .yaml",
                  request->path);
        neph_hint(diag, "the scene has the name of its file: my_fog.yaml has the scene my_fog");
        return NEPH_ERR_USAGE;
    }
    if (neph_path_exists(request->path) && !request->may_overwrite) {
        neph_fail(diag, NEPH_ERR_USAGE, "'%s' is there, and is not overwritten", request->path);
        neph_hint(diag, "choose another name, or give --force to replace it");
        return NEPH_ERR_USAGE;
    }
    return NEPH_OK;
}

static enum neph_status read_template(const char *kind, char **text, size_t *size,
                                      struct neph_diag *diag)
{
    char *folder = neph_data_path("scenes/new");
    char *path = folder ? neph_format("%s/%s.yaml", folder, kind) : NULL;
    const enum neph_status status = path
                                        ? neph_file_read(path, TEMPLATE_MAX_BYTES, text, size, diag)
                                        : neph_fail_memory(diag);
    free(path);
    free(folder);
    return status;
}

/* The path of the .vdb for the scene file: relative if both files are in one folder, else
 * absolute. */
static char *written_name(const struct neph_new_scene *request)
{
    char *folder = strdup(request->path), *beside = NULL;
    const char *slash = strrchr(request->vdb, '/');
    const char *name = slash ? slash + 1 : request->vdb;
    char *cut = folder ? strrchr(folder, '/') : NULL;
    if (folder)
        beside = cut ? neph_format("%.*s/%s", (int)(cut - folder), folder, name) : strdup(name);
    free(folder);
    const bool is_beside = beside && neph_path_is_same(beside, request->vdb);
    free(beside);
    return is_beside ? strdup(name) : realpath(request->vdb, NULL);
}

static enum neph_status make_volume_scene(const struct neph_new_scene *request, char **text,
                                          size_t *size, struct neph_diag *diag)
{
    if (!neph_path_exists(request->vdb))
        return neph_fail(diag, NEPH_ERR_NOT_FOUND, "there is no file '%s'", request->vdb);
    char *written = written_name(request);
    const enum neph_status status = written
                                        ? neph_volume_scene_text(request->vdb, written, text, diag)
                                        : neph_fail_memory(diag);
    free(written);
    if (!status)
        *size = strlen(*text);
    return status;
}

enum neph_status neph_new_scene_write(const struct neph_new_scene *request, struct neph_diag *diag)
{
    char *text = NULL;
    size_t size = 0;
    enum neph_status status = check_kind(request, diag);
    if (!status)
        status = check_path(request, diag);
    if (!status)
        status = strcmp(request->kind, kind_vdb) == 0
                     ? make_volume_scene(request, &text, &size, diag)
                     : read_template(request->kind, &text, &size, diag);
    if (!status)
        status = neph_file_write(request->path, text, size, diag);
    free(text);
    return status;
}

enum neph_status neph_new_scene_print(const char *vdb, struct neph_diag *diag)
{
    char *text = NULL;
    const struct neph_new_scene request = {.path = "scene.yaml", .vdb = vdb};
    size_t size = 0;
    const enum neph_status status = make_volume_scene(&request, &text, &size, diag);
    if (!status)
        fputs(text, stdout);
    free(text);
    return status;
}
