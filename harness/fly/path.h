/* SPDX-License-Identifier: MIT
 *
 * The way of a camera, a key for each frame, as a scene file that is rendered like any other.
 */
#ifndef NEPH_HARNESS_FLY_PATH_H
#define NEPH_HARNESS_FLY_PATH_H

#include "base/arena.h"
#include "scenes/scene.h"

/* Start from {0}. */
struct neph_fly_path {
    struct neph_camera_key keys[NEPH_SCENE_KEYS_MAX];
    int frame_count; /* so far */
};

/* The camera of the next frame. Each has a key of its own, also at rest: between keys that are the
 * same the last bits of a camera change, and with them what counts as the same moment. False, and
 * nothing is added: a scene file has no room for another key. */
bool neph_fly_path_add(struct neph_fly_path *path, const struct neph_camera_key *key);

/* Write the scene with this way to the first of SCENE_path.yaml, SCENE_path_2.yaml, .. in `folder`
 * that is not there yet. `scene` is one that was read from a file, whose comments stay. `*file` is
 * of the arena. Errors as of neph_scene_camera_text() and neph_file_write(); NEPH_ERR_USAGE: the
 * path is empty. */
enum neph_status neph_fly_path_write(const struct neph_fly_path *path,
                                     const struct neph_scene *scene, const char *folder,
                                     struct neph_arena *arena, const char **file,
                                     struct neph_diag *diag);

/* The first of "folder/NAME", "folder/NAME_2", .. that is there with none of the suffixes (".exr"),
 * which end with NULL; of the arena, to be checked. */
const char *neph_fly_free_name(const char *folder, const char *name, const char *const suffixes[],
                               struct neph_arena *arena);

#endif
