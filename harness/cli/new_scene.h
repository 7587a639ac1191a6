/* SPDX-License-Identifier: MIT
 *
 * `neph scenes --new`: writes a commented scene file to begin with.
 */
#ifndef NEPH_HARNESS_CLI_NEW_SCENE_H
#define NEPH_HARNESS_CLI_NEW_SCENE_H

#include "base/status.h"

#include <stdbool.h>

struct neph_new_scene {
    const char *kind;   /* fog, cloud, grid or vdb */
    const char *path;   /* NAME.yaml, to be written */
    const char *vdb;    /* of kind vdb; else NULL */
    bool may_overwrite; /* a file of that name is replaced */
};

/* Write the file. NEPH_ERR_USAGE: there is no such kind, the path is no scene file, or there is a
 * file that may not be replaced. Else errors of neph_volume_scene_text() and neph_file_write(). */
enum neph_status neph_new_scene_write(const struct neph_new_scene *request, struct neph_diag *diag);

/* The scene file that neph reads a .vdb as, on stdout. */
enum neph_status neph_new_scene_print(const char *vdb, struct neph_diag *diag);

#endif
