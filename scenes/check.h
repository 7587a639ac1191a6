/* SPDX-License-Identifier: MIT
 *
 * The checks of a scene file, each with the exact line and column of the offending value. Private
 * to scenes/.
 */
#ifndef NEPH_SCENES_CHECK_H
#define NEPH_SCENES_CHECK_H

#include "scenes/document.h"
#include "scenes/schema.h"

/* One walk over the file along the schema: keys, types, words, ranges. Stops at the first thing
 * that is wrong, in the order of the file. */
enum neph_status neph_check_document(struct neph_document *document, struct neph_diag *diag);

/* What ties values of the file to each other (max above min, unit directions, one variant of a
 * union, ...). The file has passed neph_check_document(). `stem` is the file's name without folder
 * and extension. */
enum neph_status neph_check_rules(struct neph_document *document, const struct neph_raw_scene *raw,
                                  const char *stem, struct neph_diag *diag);

/* What needs the finished scene: how many solids the fences make, cameras of all frames outside
 * solids and never degenerate, wind that moves media and not too far. */
enum neph_status neph_check_scene(struct neph_document *document, const struct neph_scene *scene,
                                  struct neph_diag *diag);

/* Fill the diag for the value at `path` (or for what exists of the path) and return
 * NEPH_ERR_INPUT. */
enum neph_status neph_check_fail(struct neph_document *document, const char *path,
                                 struct neph_diag *diag, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

#endif
