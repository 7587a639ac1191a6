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

/* Open the job's sequence on a device that it opens for itself, and take its first picture:
 * `*first_s` from nothing, with device, kernels and grids. Close it with neph_job_close(). */
enum neph_status neph_flight_open(struct neph_job *job, double *first_s, struct neph_diag *diag);

/* A second of pictures that are not timed, and of an engine that remembers at least as many as fill
 * its history. */
enum neph_status neph_flight_warm_up(struct neph_job *job, long *picture, struct neph_diag *diag);

/* The time of a picture: on the device's clock where it has one, else by the wall clock. Reorders
 * what has come home. */
struct neph_spread neph_flight_time(struct neph_flown *flown);

/* Pictures of a job whose sequence is open, from number `*picture` on, until there are `most`, or
 * `least` and the time is over. They are added to `flown`, which may be NULL. Errors: those of the
 * engine; NEPH_ERR_INTERRUPTED. */
enum neph_status neph_flight_fly(struct neph_job *job, long *picture, int least, int most,
                                 double seconds, struct neph_flown *flown, struct neph_diag *diag);

#endif
