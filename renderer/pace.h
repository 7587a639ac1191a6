/* SPDX-License-Identifier: MIT
 *
 * How much work a device gets in one dispatch: what it does in about 30 ms by its own clock, so
 * that Ctrl-C is heard, no watchdog barks, and what a dispatch costs besides does not count. Not
 * for other folders.
 */
#ifndef NEPH_RENDERER_PACE_H
#define NEPH_RENDERER_PACE_H

#include <stdint.h>

/* Zero: nothing has been measured. Work is in whatever unit its user counts. */
struct neph_pace {
    double work_per_s;
};

/* It did so much in that time. Not a positive number of seconds (there is no clock): teaches
 * nothing. */
void neph_pace_learn(struct neph_pace *pace, double work, double gpu_s);

/* Work of a dispatch, at least 1; `first` when nothing has been measured. */
uint64_t neph_pace_work(const struct neph_pace *pace, uint64_t first);

#endif
