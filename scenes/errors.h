/* SPDX-License-Identifier: MIT
 *
 * All errors of one scene file: collected while the file is read, reported together in the order of
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
    char path[NEPH_ERROR_PATH_SIZE]; /* of the value in error: "media[0].grid.size" */
    int order, line, column;
    char message[sizeof(((struct neph_diag *)NULL)->message)];
    char hint[sizeof(((struct neph_diag *)NULL)->hint)];
};

/* Set the file; zero-initialise the other members. */
struct neph_errors {
    const char *file;                /* borrowed */
    struct neph_diag now;            /* the error that is being reported */
    char path[NEPH_ERROR_PATH_SIZE]; /* of its value; "": the value that is being read */
    int count;                       /* reading ends at NEPH_ERRORS_MAX */
    struct neph_error list[NEPH_ERRORS_MAX];
};

/* Attributes the error in `now` to the value at this path. */
void neph_errors_attribute(struct neph_errors *errors, const char *path);

/* Moves the error in `now` into the list. `path` is the value being read, unless the error was
 * attributed to another. An error without a message has been moved before. */
void neph_errors_keep(struct neph_errors *errors, enum neph_status status, const char *path);

/* Whether reading ends because the list is full. */
bool neph_errors_are_full(const struct neph_errors *errors);

/* Whether an error belongs to one of these keys (separated by spaces) of the mapping at this path
 * ("": the scene), or to the mapping itself because of an unknown key. */
bool neph_errors_concern(const struct neph_errors *errors, const char *path, const char *keys);

/* Fills the diag: the first error by line, the others in `more`. Returns
 * - the status of an error that the file did not cause (no memory, interrupted), which is then
 *   reported without the others,
 * - else NEPH_ERR_INPUT if any error has that status,
 * - else the status of the first error; NEPH_OK without errors. */
enum neph_status neph_errors_report(struct neph_errors *errors, struct neph_diag *diag);

#endif
