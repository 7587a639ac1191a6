/* SPDX-License-Identifier: MIT
 *
 * What a picture has cost that neph renders in its own process.
 */
#ifndef NEPH_HARNESS_ENGINES_OWN_COST_H
#define NEPH_HARNESS_ENGINES_OWN_COST_H

#include "harness/engines/engine.h"

struct neph_stopwatch {
    double wall_s, cpu_s;
};

struct neph_stopwatch neph_stopwatch_start(void);

/* Since the start; NaN for `render_s`: all of it. The peak of memory is that of the process. */
struct neph_cost neph_own_cost(struct neph_stopwatch start, double render_s);

/* The end of neph_engine.render: `image` and its cost are handed over, or, after an error, it is
 * destroyed. Returns `status`. */
enum neph_status neph_own_frame(enum neph_status status, struct neph_image *image,
                                struct neph_stopwatch start, double render_s,
                                struct neph_image **frame, struct neph_cost *cost);

#endif
