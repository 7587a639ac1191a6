/* SPDX-License-Identifier: MIT
 *
 * The size of dispatches: work for about 30 ms of measured device time. Short enough for Ctrl-C and
 * for watchdogs, long enough that the overhead of a dispatch does not matter. Not for other
 * folders.
 */
#ifndef NEPH_RENDERER_PACE_H
#define NEPH_RENDERER_PACE_H

#include <stdint.h>

/* Zero: nothing measured yet. The unit of work is the caller's. */
struct neph_pace {
    double work_per_s;
};

/* Record that the device did `work` in `gpu_s` seconds. Ignored unless `gpu_s` is positive (NaN
 * without a clock). */
void neph_pace_update(struct neph_pace *pace, double work, double gpu_s);

/* Work of the next dispatch, at least 1; `first` when nothing has been measured. */
uint64_t neph_pace_work(const struct neph_pace *pace, uint64_t first);

#endif
