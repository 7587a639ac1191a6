/* SPDX-License-Identifier: MIT
 *
 * The cost of a whole command, `neph flicker -r STILL FRAMES`, on synthetic files, for
 * bench_metrics.
 */
#ifndef NEPH_TESTS_BENCH_PROGRAM_H
#define NEPH_TESTS_BENCH_PROGRAM_H

#include "base/status.h"

struct bench_program {
    int width_px, height_px, frame_count; /* frame_count >= 16, a multiple of 4 */
};

/* The cost of the whole command. */
struct bench_program_cost {
    double wall_s, user_s, system_s;
};

/* Run build/.../neph beside this program. Four uncompressed frames are written to a temporary
 * folder and linked as many times as needed, so that they are read from the page cache.
 * NEPH_ERR_UNAVAILABLE: there is no such program. */
enum neph_status bench_program_run(const struct bench_program *bench,
                                   struct bench_program_cost *cost, struct neph_diag *diag);

#endif
