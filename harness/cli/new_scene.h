/* SPDX-License-Identifier: MIT
 *
 * `neph scenes --new`: writes a commented scene file as a starting point.
 */
#ifndef NEPH_HARNESS_CLI_NEW_SCENE_H
#define NEPH_HARNESS_CLI_NEW_SCENE_H

#include "base/status.h"

#include <stdbool.h>

struct neph_new_scene {
    const char *kind;   /* fog, cloud, grid or vdb */
    const char *path;   /* NAME.yaml, to be written */
    const char *vdb;    /* only of kind vdb; else NULL */
    bool may_overwrite; /* replace an existing file */
};

/* Write the file. NEPH_ERR_USAGE: there is no such kind, the path is not a scene file, or the file
 * exists and may not be replaced. Other errors as of neph_volume_scene_text() and
 * neph_file_write(). */
enum neph_status neph_new_scene_write(const struct neph_new_scene *request, struct neph_diag *diag);

/* Print on stdout the scene file that neph makes of a .vdb. */
enum neph_status neph_new_scene_print(const char *vdb, struct neph_diag *diag);

#endif
