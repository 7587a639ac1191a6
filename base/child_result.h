/* SPDX-License-Identifier: MIT
 *
 * How a child process ended and what it took: what the keeper counts, and neph reads.
 */
#ifndef NEPH_BASE_CHILD_RESULT_H
#define NEPH_BASE_CHILD_RESULT_H

#include <stdint.h>

/* How much a child may write; 0 in a field: no limit. The keeper measures every 0.1 s and once more
 * at the end, so a child may be over a limit for that long. */
struct neph_child_limits {
    int64_t folder_bytes;   /* in its working folder; a confined child: any single file, too */
    int64_t folder_entries; /* there: files, folders, links and the like */
    int64_t log_bytes;      /* what it prints */
};

/* Which of them it has passed. */
enum neph_child_excess {
    NEPH_EXCESS_NONE,
    NEPH_EXCESS_BYTES,
    NEPH_EXCESS_ENTRIES,
    NEPH_EXCESS_HIDDEN, /* folders that cannot be counted: neph_usage_measure() */
    NEPH_EXCESS_LOG,
};

struct neph_child_result {
    int exit_code; /* valid when signal is 0 */
    int signal;    /* the signal that ended it, or 0 */
    double wall_s;
    double cpu_s; /* user + system of the child and of all that it started and that was reaped */
    /* Maximum resident set of the child or of one process beneath it. Exact when above neph's own
     * memory at the start; below it the kernel's number is neph's, and this is the high-water mark
     * of the child alone, sampled every 0.1 s. */
    int64_t peak_memory_bytes;
};

#endif
