/* SPDX-License-Identifier: MIT
 *
 * Folders that neph owns, whose contents it replaces and removes: each carries the marker file
 * .neph-owned. A folder with anything else in it is somebody else's and is left alone.
 */
#ifndef NEPH_BASE_OWNED_H
#define NEPH_BASE_OWNED_H

#include "base/status.h"

#include <stdbool.h>

/* What a folder is for. */
struct neph_owned_kind {
    const char *name; /* one word, which the marker holds */
    int version;      /* of the folder's form; a marker of a higher one is refused */
    /* Whether a folder without a marker was made by an older neph, beyond doubt: it holds nothing
     * that neph did not write. NULL: none is recognised. */
    bool (*is_old)(const char *folder);
};

/* Whether neph may do with `folder` what it likes: it is not there, empty, marked as of this kind,
 * or an older one. Else NEPH_ERR_USAGE with the way out. Changes nothing. */
enum neph_status neph_owned_check(const char *folder, const struct neph_owned_kind *kind,
                                  struct neph_diag *diag);

/* neph_owned_check(), then make the folder if need be and mark it. */
enum neph_status neph_owned_claim(const char *folder, const struct neph_owned_kind *kind,
                                  struct neph_diag *diag);

#endif
