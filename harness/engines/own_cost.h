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

/* neph_engine.render of an engine whose pictures come in a row: a picture alone, which pays for
 * what it is set up with. */
enum neph_status neph_own_picture(const struct neph_engine_sequence *sequence,
                                  const struct neph_shot *shot, struct neph_image **frame,
                                  struct neph_cost *cost, struct neph_diag *diag);

#endif
