/* SPDX-License-Identifier: MIT
 *
 * Counts the bad values of a sequence, on the device where possible.
 */
#ifndef NEPH_HARNESS_STRESS_WATCH_H
#define NEPH_HARNESS_STRESS_WATCH_H

#include "harness/run/job.h"

/* Renders the warm-up and `frame_count` frames. `*bad`: number of values, in all images of all
 * these frames, that are not finite or negative. Where the settings use no image of the engine's
 * own (split=none), the collected frames are counted instead. NEPH_ERR_UNSUPPORTED: the engine
 * cannot count. NEPH_ERR_INTERRUPTED. Other errors as of neph_job_open(). */
enum neph_status neph_count_bad_values(struct neph_job *job, int frame_count, uint64_t *bad,
                                       struct neph_diag *diag);

#endif
