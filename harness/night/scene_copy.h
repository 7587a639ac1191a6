/* SPDX-License-Identifier: MIT
 *
 * The store's copies of the scene files that nights have measured. A later night whose scene was
 * edited renders the accepted version once more from its copy.
 *
 *   STORE/scenes/<hash>-<terms>/<name>.yaml    the file, byte by byte; eight digits of each
 *
 * Files that a scene names, such as volumes, are not copied: a copy is used only if it still has
 * the hash of the scene.
 */
#ifndef NEPH_HARNESS_NIGHT_SCENE_COPY_H
#define NEPH_HARNESS_NIGHT_SCENE_COPY_H

#include "base/arena.h"
#include "base/hash.h"
#include "harness/run/history.h"
#include "scenes/scene.h"

/* BLAKE2b of what a scene's file says beside the scene and a night depends on: gates, exposure, the
 * chain of its frames, what is measured over time and with which limits, injections. */
enum neph_status neph_scene_terms(const struct neph_scene *scene, char terms[NEPH_HASH_HEX_SIZE],
                                  struct neph_diag *diag);

/* Where the copy of a scene lies; of the arena. */
const char *neph_scene_copy_path(const char *store_folder, const struct neph_history_scene *scene,
                                 struct neph_arena *arena);

/* Load the scene `name` of the catalogue, copy its file where the store has no copy, and fill `row`
 * but for its step. Texts are of the arena. Errors: as of loading; NEPH_ERR_IO. */
enum neph_status neph_scene_copy_keep(const char *store_folder, const char *name,
                                      struct neph_arena *arena, struct neph_history_scene *row,
                                      struct neph_diag *diag);

#endif
