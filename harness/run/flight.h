/* SPDX-License-Identifier: MIT
 *
 * Frames in flight: a few frames are submitted to the device ahead, as in a game, and none is read
 * back.
 */
#ifndef NEPH_HARNESS_RUN_FLIGHT_H
#define NEPH_HARNESS_RUN_FLIGHT_H

#include "harness/run/job.h"

/* Times of many frames: the median, the 10 % quantile `low` and the 90 % quantile `high`. */
struct neph_spread {
    double median, low, high;
};

/* Sorts the values. All NaN when the first value is not finite: the device has no timestamps. */
struct neph_spread neph_spread_compute(double *values, int count);

/* Collected frames. The caller's arrays have room for all frames that are submitted. */
struct neph_flight_results {
    struct neph_flight_cost *costs;
    double *frame_s; /* wall-clock time from one frame to the next */
    double all_s;    /* from the first submission to the last frame collected */
    int count;
};

/* Whether the engine can have several frames in flight. */
bool neph_flight_applies(const struct neph_engine *engine);

/* The scene's frame for frame number `picture` of the flight: 0 .. count - 1 and backwards again.
 * So nothing jumps, and the wind carries no cloud out of view. */
int neph_flight_frame(long picture, int count);

/* Opens the job's sequence on a device of its own and renders the first frame. `*first_s` is the
 * time of all that: device, kernels, grids, frame. Close the job with neph_job_close(). */
enum neph_status neph_flight_open(struct neph_job *job, double *first_s, struct neph_diag *diag);

/* Renders frames for a second without timing; for an engine with a history at least as many frames
 * as fill the history. */
enum neph_status neph_flight_warm_up(struct neph_job *job, long *picture, struct neph_diag *diag);

/* The time of a frame: by the device's timestamps where it has them, else wall-clock time. Sorts
 * `flown`. */
struct neph_spread neph_flight_time(struct neph_flight_results *flown);

/* Renders frames of a job whose sequence is open, from number `*picture` on: `most` frames, or
 * fewer when `seconds` are over, but at least `least`. The results are appended to `flown`, which
 * may be NULL. Errors of the engine; NEPH_ERR_INTERRUPTED. */
enum neph_status neph_flight_run(struct neph_job *job, long *picture, int least, int most,
                                 double seconds, struct neph_flight_results *flown,
                                 struct neph_diag *diag);

#endif
