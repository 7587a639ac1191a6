/* SPDX-License-Identifier: MIT
 *
 * Records a camera path, with a key for each frame, and writes it as a scene file.
 */
#ifndef NEPH_HARNESS_FLY_PATH_H
#define NEPH_HARNESS_FLY_PATH_H

#include "base/arena.h"
#include "scenes/scene.h"

/* Start from {0}. */
struct neph_fly_path {
    struct neph_camera_key keys[NEPH_SCENE_KEYS_MAX];
    int frame_count; /* recorded so far */
};

/* Add the camera of the next frame. Every frame has a key, also with a static camera: interpolation
 * between equal keys changes the last bits of the camera, so the frames would no longer count as
 * static. False, with nothing added: a scene file cannot hold another key. */
bool neph_fly_path_add(struct neph_fly_path *path, const struct neph_camera_key *key);

/* Write the scene with this path to the first unused name of SCENE_path.yaml, SCENE_path_2.yaml, ..
 * in `folder`. `scene` was read from a file, whose comments are kept. `*file` is owned by the
 * arena. Errors as of neph_scene_camera_text() and neph_file_write(); NEPH_ERR_USAGE: the path is
 * empty. */
enum neph_status neph_fly_path_write(const struct neph_fly_path *path,
                                     const struct neph_scene *scene, const char *folder,
                                     struct neph_arena *arena, const char **file,
                                     struct neph_diag *diag);

/* The first of "folder/NAME", "folder/NAME_2", .. that exists with none of the suffixes (such as
 * ".exr"; the list ends with NULL). Owned by the arena; check the arena for errors. */
const char *neph_fly_free_name(const char *folder, const char *name, const char *const suffixes[],
                               struct neph_arena *arena);

#endif
