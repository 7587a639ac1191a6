/* SPDX-License-Identifier: MIT
 *
 * A scene around the medium of a .vdb file, as the text of a scene file: written by `neph scenes
 * --new vdb`, and used when a .vdb is given in place of a scene.
 */
#ifndef NEPH_SCENES_VOLUME_SCENE_H
#define NEPH_SCENES_VOLUME_SCENE_H

#include "base/status.h"

#include <stdbool.h>

/* Whether a .vdb is given in place of a scene file. */
bool neph_is_volume_scene(const char *path);

/* The text; the caller frees it. The camera sees the whole volume; the sun is behind the camera on
 * the right; the densest vertical column has an optical depth of 20. `path` is the .vdb, `written`
 * its name in the scene file. Errors: those of neph_volume_read(); NEPH_ERR_INPUT: the file has no
 * density, or places it outside the world, or its name does not fit into a scene file. */
enum neph_status neph_volume_scene_text(const char *path, const char *written, char **text,
                                        struct neph_diag *diag);

#endif
