/* SPDX-License-Identifier: MIT
 *
 * Paths in a scene file. Private to scenes/.
 */
#ifndef NEPH_SCENES_RESOLVE_PATH_H
#define NEPH_SCENES_RESOLVE_PATH_H

#include "scenes/fields.h"

/* Resolves a path: "$NAME/rest" starts at an environment variable that names a folder or a file; a
 * relative path starts at the scene file. The result lives in the reader's arena.
 * NEPH_ERR_NOT_FOUND: the variable is not set; the hint sets it to `example`. */
enum neph_status neph_resolve_path(const struct neph_reader *reader, const char *file,
                                   const char *example, const char **path);

#endif
