/* SPDX-License-Identifier: MIT
 *
 * Output folders: neph replaces and removes their contents, so each carries the marker file
 * .neph-owned. A folder without the marker that is not empty belongs to the user and is not
 * touched.
 */
#ifndef NEPH_BASE_OWNED_H
#define NEPH_BASE_OWNED_H

#include "base/status.h"

#include <stdbool.h>

/* A kind of output folder. */
struct neph_owned_kind {
    const char *name; /* one word, the content of the marker */
    int version;      /* of the folder's layout; a marker with a higher version is refused */
    /* Whether an older neph, which wrote no markers, made the folder: all its files must be
     * recognised. NULL: no folder without a marker is recognised. */
    bool (*is_old)(const char *folder);
};

/* Whether neph may replace the contents of `folder`: the folder is missing, empty, marked as of
 * this kind, or made by an older neph. Else NEPH_ERR_USAGE with the way out. Changes nothing. */
enum neph_status neph_owned_check(const char *folder, const struct neph_owned_kind *kind,
                                  struct neph_diag *diag);

/* neph_owned_check(), then create the folder if it is missing, and mark it. */
enum neph_status neph_owned_claim(const char *folder, const struct neph_owned_kind *kind,
                                  struct neph_diag *diag);

#endif
