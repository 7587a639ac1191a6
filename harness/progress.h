/* SPDX-License-Identifier: MIT
 *
 * Progress of long work on stderr: one line with the time left on a terminal, a plain line per
 * finished step elsewhere.
 */
#ifndef NEPH_HARNESS_PROGRESS_H
#define NEPH_HARNESS_PROGRESS_H

#include <stdbool.h>

struct neph_progress {
    bool quiet, terminal;
    int done, total;
    double start_s, told_s; /* of the last line of neph_progress_tick(), since the start */
};

struct neph_progress neph_progress_start(bool quiet, int total);

/* A step begins: shown on a terminal only. */
void neph_progress_begin(const struct neph_progress *progress, const char *what);

/* A step is over; `outcome` is a word or two. */
void neph_progress_step(struct neph_progress *progress, const char *what, const char *outcome,
                        double seconds);

/* A step of many short ones is over: elsewhere than on a terminal a line every ten seconds. */
void neph_progress_tick(struct neph_progress *progress, const char *what);

/* Wipe the terminal's line. */
void neph_progress_end(const struct neph_progress *progress);

#endif
