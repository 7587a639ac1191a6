/* SPDX-License-Identifier: MIT
 *
 * A sequence of which only the bad values are counted, on the device where that is possible.
 */
#ifndef NEPH_HARNESS_STRESS_WATCH_H
#define NEPH_HARNESS_STRESS_WATCH_H

#include "harness/run/job.h"

/* Render so many frames after the engine's warm-up. `*bad` values in all their images, and in those
 * of the warm-up, are not finite or negative. Where the settings render a frame without images of
 * the engine's own (split=none), the values are counted in the frame, which is collected.
 * NEPH_ERR_UNSUPPORTED: the engine cannot count them. NEPH_ERR_INTERRUPTED. Others as of
 * neph_job_open(). */
enum neph_status neph_watch_sequence(struct neph_job *job, int frame_count, uint64_t *bad,
                                     struct neph_diag *diag);

#endif
