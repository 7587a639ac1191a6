/* SPDX-License-Identifier: MIT
 *
 * How a child process ended and what it took: what the keeper counts, and neph reads.
 */
#ifndef NEPH_BASE_CHILD_RESULT_H
#define NEPH_BASE_CHILD_RESULT_H

#include <stdint.h>

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
