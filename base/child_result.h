/* SPDX-License-Identifier: MIT
 *
 * The result of a child process: how it ended and the resources it used. Filled by the keeper, read
 * by neph.
 */
#ifndef NEPH_BASE_CHILD_RESULT_H
#define NEPH_BASE_CHILD_RESULT_H

#include <stdint.h>

/* Limits on the output of a child; 0 in a field: no limit. The keeper measures every 0.1 s and at
 * the end, so a child may exceed a limit for up to 0.1 s. */
struct neph_child_limits {
    int64_t folder_bytes;   /* in its working folder; when confined, of any single file as well */
    int64_t folder_entries; /* in its working folder: files, folders, links and the like */
    int64_t log_bytes;      /* of stdout and stderr together */
};

/* The limit that was exceeded. */
enum neph_child_excess {
    NEPH_EXCESS_NONE,
    NEPH_EXCESS_BYTES,
    NEPH_EXCESS_ENTRIES,
    NEPH_EXCESS_HIDDEN, /* unreadable or too deep folders: neph_usage_measure() */
    NEPH_EXCESS_LOG,
};

struct neph_child_result {
    int exit_code; /* valid when signal is 0 */
    int signal;    /* the signal that ended it, or 0 */
    double wall_s;
    double cpu_s; /* user + system, of the child and all its descendants that were reaped */
    /* Maximum resident set of a single process: the child or one of its descendants. Exact when
     * above neph's own memory at the start. Below it the kernel reports neph's memory, so this is
     * the high-water mark of the child itself, sampled every 0.1 s. */
    int64_t peak_memory_bytes;
};

#endif
