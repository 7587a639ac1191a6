/* SPDX-License-Identifier: MIT
 *
 * The store's copies of the scene files that nightly runs have measured. When a scene is edited, a
 * later run renders the accepted version once more from its copy.
 *
 *   STORE/scenes/<hash>-<terms>/<name>.yaml    the file, byte by byte; eight digits of each
 *
 * Files that a scene refers to, such as volumes, are not copied: a copy is used only if it still
 * has the scene's hash.
 */
#ifndef NEPH_HARNESS_NIGHT_SCENE_COPY_H
#define NEPH_HARNESS_NIGHT_SCENE_COPY_H

#include "base/arena.h"
#include "base/hash.h"
#include "harness/run/history.h"
#include "scenes/scene.h"

/* BLAKE2b of the parts of a scene file that affect a nightly run and are not in the scene's hash:
 * gates, exposure, post-processing chain, measurements over time with their limits, injections. */
enum neph_status neph_scene_terms(const struct neph_scene *scene, char terms[NEPH_HASH_HEX_SIZE],
                                  struct neph_diag *diag);

/* The path of a scene's copy, allocated in the arena. */
const char *neph_scene_copy_path(const char *store_folder, const struct neph_history_scene *scene,
                                 struct neph_arena *arena);

/* Load the scene `name` of the catalogue, copy its file unless the store has a copy, and fill all
 * fields of `row` but its step. Texts are allocated in the arena. Errors: as
 * neph_data_load_scene(); NEPH_ERR_IO. */
enum neph_status neph_scene_copy_keep(const char *store_folder, const char *name,
                                      struct neph_arena *arena, struct neph_history_scene *row,
                                      struct neph_diag *diag);

#endif
