/* SPDX-License-Identifier: MIT
 *
 * How much a folder holds, and how much of it is kept: programs of others write there.
 */
#ifndef NEPH_BASE_USAGE_H
#define NEPH_BASE_USAGE_H

#include <stdbool.h>
#include <stdint.h>

/* How much of a folder is kept for inspection, such as that of a failed frame. */
#define NEPH_KEPT_BYTES ((int64_t)64 << 20)
#define NEPH_KEPT_ENTRIES 1024

struct neph_usage {
    int64_t bytes;   /* on the disk */
    int64_t entries; /* files, folders, links and the like */
    bool is_known;   /* false: there is a folder below that cannot be read, or more than 64 deep */
};

/* Measure what is below `folder`; symbolic links are not followed. What goes away meanwhile is left
 * out. Allocates nothing and is safe after fork(). */
struct neph_usage neph_usage_measure(const char *folder);

/* Make what is below `folder` fit into NEPH_KEPT_BYTES and NEPH_KEPT_ENTRIES: when it does not,
 * the folders in it go, and then the largest files, until the rest does. A file "removed.txt"
 * there says so. What cannot be removed stays. */
void neph_usage_trim(const char *folder);

#endif
