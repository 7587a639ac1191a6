/* SPDX-License-Identifier: MIT
 *
 * The cost of a frame that neph renders in its own process.
 */
#ifndef NEPH_HARNESS_ENGINES_PROCESS_COST_H
#define NEPH_HARNESS_ENGINES_PROCESS_COST_H

#include "harness/engines/engine.h"

struct neph_stopwatch {
    double wall_s, cpu_s;
};

struct neph_stopwatch neph_stopwatch_start(void);

/* Cost since the start; `render_s` NaN: the whole wall time. The memory peak is the peak of the
 * process. */
struct neph_cost neph_measure_process_cost(struct neph_stopwatch start, double render_s);

/* Finish neph_engine.render: hand over `image` and its cost, or destroy it after an error. Returns
 * `status`. */
enum neph_status neph_finish_process_frame(enum neph_status status, struct neph_image *image,
                                           struct neph_stopwatch start, double render_s,
                                           struct neph_image **frame, struct neph_cost *cost);

#endif
