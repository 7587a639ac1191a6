/* SPDX-License-Identifier: MIT
 *
 * Where the project's own files lie: scenes, scripts, the report's page.
 */
#ifndef NEPH_HARNESS_DATA_H
#define NEPH_HARNESS_DATA_H

#include "base/status.h"
#include "scenes/scene.h"

/* NEPH_DATA_DIR from the environment; else what is installed with the running program; else the
 * folder it was built from. For the caller to free; NULL when memory is short. */
char *neph_data_directory(void);

/* "<data>/<relative>" for the caller to free; NULL when memory is short. */
char *neph_data_path(const char *relative);

/* The path of a renamed file or folder: for one release, of its old name where only that is
 * there. */
char *neph_data_renamed_path(const char *relative, const char *old_relative);

/* Where what can be made again is kept: $XDG_CACHE_HOME/nephelometer, else
 * $HOME/.cache/nephelometer, else a folder of /tmp. For the caller to free; NULL when memory is
 * short. */
char *neph_cache_path(void);

/* Load a scene by path, or by its name in the catalogue. */
enum neph_status neph_data_load_scene(const char *path_or_name, struct neph_scene **scene,
                                      struct neph_diag *diag);

/* Whether the scenes of a run, paths or names of the catalogue, are there and have names of their
 * own: frames are stored by them. NEPH_ERR_NOT_FOUND; NEPH_ERR_USAGE names the two that share
 * one. */
enum neph_status neph_data_check_scenes(const char *const *scenes, int count,
                                        struct neph_diag *diag);

/* The folders of the catalogue; no name is in both. */
enum neph_data_scenes {
    NEPH_DATA_CATALOG, /* measured against truth over all engines: what `neph validate` runs */
    NEPH_DATA_STRESS,  /* where methods fail over many frames: what stability is measured with */
    NEPH_DATA_SCENES_COUNT,
};

/* The names in a folder, sorted, NULL-terminated. Free with neph_data_free_names. */
enum neph_status neph_data_list_scenes(enum neph_data_scenes which, char ***names, int *count,
                                       struct neph_diag *diag);
void neph_data_free_names(char **names);

#endif
