/* SPDX-License-Identifier: MIT
 *
 * A sequence that nobody looks at but to count its bad values, on the device where it can be.
 */
#ifndef NEPH_HARNESS_STRESS_WATCH_H
#define NEPH_HARNESS_STRESS_WATCH_H

#include "harness/run/job.h"

/* Render so many pictures after the engine's warm-up, in all images of which, and of the warm-up,
 * `*bad` values are not finite or negative. Where the settings make a picture without images of the
 * engine's own (split=none), they are counted in the picture, which comes home for it.
 * NEPH_ERR_UNSUPPORTED: the engine cannot count them. NEPH_ERR_INTERRUPTED. Others as of
 * neph_job_open(). */
enum neph_status neph_watch_sequence(struct neph_job *job, int frame_count, uint64_t *bad,
                                     struct neph_diag *diag);

#endif
