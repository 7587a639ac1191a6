/* SPDX-License-Identifier: MIT
 *
 * Pictures in flight: as in a game a few are on their way to the device at once, and nothing of
 * them is read back.
 */
#ifndef NEPH_HARNESS_RUN_FLIGHT_H
#define NEPH_HARNESS_RUN_FLIGHT_H

#include "harness/run/job.h"

/* What many pictures take: half of them less than the median, a tenth less than `low` and a tenth
 * more than `high`. */
struct neph_spread {
    double median, low, high;
};

/* Reorders the values. All NaN when the first is not finite: there is no clock. */
struct neph_spread neph_spread_of(double *values, int count);

/* What came home. Room for as many pictures as are flown is the caller's. */
struct neph_flown {
    struct neph_flight_cost *costs;
    double *frame_s; /* of the wall clock, from one picture to the next */
    double all_s;    /* from the first's departure to the last at home */
    int count;
};

/* Whether the engine's pictures can be in flight. */
bool neph_flight_applies(const struct neph_engine *engine);

/* The frame of picture number `picture`: 0 .. count - 1, and back, so that nothing jumps and the
 * wind blows no cloud away. */
int neph_flight_frame(long picture, int count);

/* Pictures of a job whose sequence is open, from number `*picture` on, until there are `most`, or
 * `least` and the time is over. They are added to `flown`, which may be NULL. Errors: those of the
 * engine; NEPH_ERR_INTERRUPTED. */
enum neph_status neph_flight_fly(struct neph_job *job, long *picture, int least, int most,
                                 double seconds, struct neph_flown *flown, struct neph_diag *diag);

#endif
