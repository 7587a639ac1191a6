/* SPDX-License-Identifier: MIT
 *
 * Disk usage of folders into which external programs write, and trimming to a limit.
 */
#ifndef NEPH_BASE_USAGE_H
#define NEPH_BASE_USAGE_H

#include <stdbool.h>
#include <stdint.h>

/* Limits of a folder that is kept for inspection, such as the folder of a failed frame. */
#define NEPH_KEPT_BYTES ((int64_t)64 << 20)
#define NEPH_KEPT_ENTRIES 1024

struct neph_usage {
    int64_t bytes;   /* on the disk */
    int64_t entries; /* files, folders, links and the like */
    bool is_known;   /* false: a folder below cannot be read, or is more than 64 levels deep */
};

/* Measure the files below `folder`; symbolic links are not followed. Files that disappear meanwhile
 * are left out. Allocates nothing and is safe after fork(). */
struct neph_usage neph_usage_measure(const char *folder);

/* Reduce the contents of `folder` to NEPH_KEPT_BYTES and NEPH_KEPT_ENTRIES. If they exceed a limit,
 * its subfolders are removed, and then the largest files until the others fit. A file "removed.txt"
 * in the folder records it. Entries that cannot be removed stay. */
void neph_usage_trim(const char *folder);

#endif
