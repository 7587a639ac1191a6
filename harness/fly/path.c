/* SPDX-License-Identifier: MIT */
#include "harness/fly/path.h"

#include "base/files.h"
#include "base/text.h"
#include "scenes/variant.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A scene name has at most 64 bytes; the base name leaves room for "_path_9999". */
enum { NAME_SIZE = 65, NAME_MAX_BYTES = 54, TITLE_MAX_BYTES = 120 };

static const char title_end[] = "; a camera flown by hand";

bool neph_fly_path_add(struct neph_fly_path *path, const struct neph_camera_key *key)
{
    if (path->frame_count == NEPH_SCENE_KEYS_MAX)
        return false;
    path->keys[path->frame_count] = *key;
    path->keys[path->frame_count].frame = path->frame_count;
    path->frame_count++;
    return true;
}

const char *neph_fly_free_name(const char *folder, const char *name, const char *const suffixes[],
                               struct neph_arena *arena)
{
    for (int number = 1;; number++) {
        char counted[16] = "";
        bool is_there = false;
        if (number > 1)
            snprintf(counted, sizeof(counted), "_%d", number);
        const char *stem = neph_arena_format(arena, "%s/%s%s", folder, name, counted);
        for (int i = 0; suffixes[i]; i++)
            is_there |= neph_path_exists(neph_arena_format(arena, "%s%s", stem, suffixes[i]));
        if (!is_there || arena->is_short)
            return stem;
    }
}

/* The scene of a path: the original with the camera, name and title replaced. */
static struct neph_scene make_path_scene(const struct neph_fly_path *path,
                                         const struct neph_scene *scene, char *name, char *title)
{
    struct neph_scene made = *scene;
    made.name = name;
    made.title = title;
    made.camera_keys = (struct neph_camera_key *)path->keys;
    made.camera_key_count = path->frame_count;
    made.frame_count = path->frame_count;
    made.pause_count = made.frame_scale_count = made.advance_count = 0;
    return made;
}

static enum neph_status write_as(const struct neph_fly_path *path, const struct neph_scene *scene,
                                 const char *stem, const char *file, struct neph_diag *diag)
{
    const char *slash = strrchr(stem, '/');
    char name[NAME_SIZE], title[TITLE_MAX_BYTES + 1], *text = NULL;
    snprintf(name, sizeof(name), "%s", slash + 1);
    neph_text_format(title, sizeof(title) - (sizeof(title_end) - 1), "%s", scene->title);
    strcat(title, title_end);
    const struct neph_scene made = make_path_scene(path, scene, name, title);
    enum neph_status status = neph_scene_camera_text(&made, &text, diag);
    if (!status)
        status = neph_file_write(file, text, strlen(text), diag);
    free(text);
    return status;
}

enum neph_status neph_fly_path_write(const struct neph_fly_path *path,
                                     const struct neph_scene *scene, const char *folder,
                                     struct neph_arena *arena, const char **file,
                                     struct neph_diag *diag)
{
    if (path->frame_count == 0)
        return neph_fail(diag, NEPH_ERR_USAGE, "the path has no frame");
    static const char *const suffixes[] = {".yaml", NULL};
    const char *name = neph_arena_format(arena, "%.*s_path", NAME_MAX_BYTES, scene->name);
    const char *stem = neph_fly_free_name(folder, name, suffixes, arena);
    *file = neph_arena_format(arena, "%s.yaml", stem);
    const enum neph_status status = neph_arena_check(arena, diag);
    return status ? status : write_as(path, scene, stem, *file, diag);
}
