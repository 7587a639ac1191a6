/* SPDX-License-Identifier: MIT
 *
 * All errors of one scene file: kept while the file is read, reported together in the order of
 * lines. Private to scenes/.
 */
#ifndef NEPH_SCENES_ERRORS_H
#define NEPH_SCENES_ERRORS_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>

enum { NEPH_ERRORS_MAX = 32, NEPH_ERROR_PATH_SIZE = 160 };

struct neph_error {
    enum neph_status status;
    char path[NEPH_ERROR_PATH_SIZE]; /* of the value that it belongs to: "media[0].grid.size" */
    int order, line, column;
    char message[sizeof(((struct neph_diag *)NULL)->message)];
    char hint[sizeof(((struct neph_diag *)NULL)->hint)];
};

/* Set the file; the rest is 0 at first. */
struct neph_errors {
    const char *file;                /* borrowed */
    struct neph_diag now;            /* of the error that is being reported */
    char path[NEPH_ERROR_PATH_SIZE]; /* of its value; "": of the value that is being read */
    int count;                       /* reading ends with NEPH_ERRORS_MAX */
    struct neph_error list[NEPH_ERRORS_MAX];
};

/* Say that the error in `now` belongs to the value at this path. */
void neph_errors_attribute(struct neph_errors *errors, const char *path);

/* Move the error in `now` into the list. `path` is the value being read, if the error was not
 * attributed to another. An error without a message was moved before. */
void neph_errors_keep(struct neph_errors *errors, enum neph_status status, const char *path);

/* Whether reading ends here. */
bool neph_errors_are_full(const struct neph_errors *errors);

/* Whether an error belongs to one of these keys, which are separated by spaces, of the mapping at
 * this path ("": of the scene), or to the mapping itself: a key of it is not known. */
bool neph_errors_concern(const struct neph_errors *errors, const char *path, const char *keys);

/* Fill the diag: the first error by its line, the others in `more`. Returns the status of an error
 * that is not the file's (no memory, interrupted), which is then reported without the others; else
 * NEPH_ERR_INPUT if one is that; else that of the first. NEPH_OK: there is no error. */
enum neph_status neph_errors_report(struct neph_errors *errors, struct neph_diag *diag);

#endif
