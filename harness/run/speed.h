/* SPDX-License-Identifier: MIT
 *
 * How long an engine takes for a frame, with its start-up apart, as `neph benchmark` measures it.
 * For reports, whose times all have this definition.
 *
 * Engines whose frames can be in flight (march*, realtime, screen): the first frame from nothing,
 * a second of warm-up, then frames in flight; the median, with the 10 % and 90 % of the frames.
 * Other engines: whole renders of the radiance, of another seed each; the mean, with its 95 %
 * interval. What a render takes before its first sample is start-up, too: of engines with a number
 * of samples by the line through two numbers of them, else by a frame of few pixels.
 */
#ifndef NEPH_HARNESS_RUN_SPEED_H
#define NEPH_HARNESS_RUN_SPEED_H

#include "harness/run/times.h"

struct neph_speed {
    int repeats;    /* frames or renders that were timed; fewer than 2: not measured */
    double start_s; /* process, device, kernels, grids; NaN: not measured */
    double render_s, low_s, high_s; /* of one warm frame, and its interval; NaN: not measured */
    bool is_flight;                 /* the interval is that of frames, not of their mean */
};

bool neph_speed_is_measured(const struct neph_speed *speed);

/* {"start_s", "render_s", "low_s", "high_s", "repeats", "interval"}; null: not measured. */
json_t *neph_speed_json(const struct neph_speed *speed);

/* "10 % to 90 % of the frames", "95 % of the mean". */
const char *neph_speed_interval_name(const struct neph_speed *speed);

/* The speed of renders that took `render_s`. Each had `process_s` of start-up before it and
 * `in_render_s` before its first sample. Fewer than two renders are no measurement. */
struct neph_speed neph_speed_of_renders(const double *render_s, int count, double process_s,
                                        double in_render_s);

/* Whether more work took less time: of a list of speeds by ascending work, the first one that lies
 * wholly below the interval of one with less work, which is `*earlier`. -1: none. Speeds that were
 * not measured are passed over. */
int neph_speed_falls(const struct neph_speed *speeds, int count, int *earlier);

/* What `times` has of a job; false: nothing. And keep it there. */
bool neph_speed_find(const struct neph_times *times, const struct neph_job *job,
                     struct neph_speed *speed);
enum neph_status neph_speed_keep(struct neph_times *times, const struct neph_job *job,
                                 const struct neph_speed *speed, struct neph_diag *diag);

/* ---- frames in flight ------------------------------------------------------------------------ */

enum { NEPH_SPEED_FRAMES_MAX = 256 };

/* A job whose frames are timed, in rounds, so that those of several jobs take turns. */
struct neph_speed_flight {
    struct neph_job job; /* its sequence is the flight's */
    long picture;
    double first_s; /* of the first frame, from nothing */
    struct neph_flown flown;
};

/* The first frame, and the warm-up. _close whatever the status. */
enum neph_status neph_speed_flight_open(const struct neph_job *job,
                                        struct neph_speed_flight *flight, struct neph_diag *diag);
/* A round: at least 3 frames, as many as there are in `seconds`. */
enum neph_status neph_speed_flight_round(struct neph_speed_flight *flight, double seconds,
                                         struct neph_diag *diag);
struct neph_speed neph_speed_of_flight(struct neph_speed_flight *flight);
void neph_speed_flight_close(struct neph_speed_flight *flight);

/* ---- renders --------------------------------------------------------------------------------- */

/* The start-up of a job whose frames cannot be in flight: `*process_s` before its render, and
 * `*in_render_s` within it, where a render of the job takes `render_s`. Renders one small frame. */
enum neph_status neph_speed_start(const struct neph_job *job, double render_s,
                                  struct neph_store *store, double *process_s, double *in_render_s,
                                  struct neph_diag *diag);

/* ---- one job --------------------------------------------------------------------------------- */

/* Measure a job, or take what `times` has of it. `known_s`: times of renders of this job that the
 * caller has, other seeds', warm; `known_count` of them. Renders are repeated while that fits into
 * `seconds`, three at most: where it does not, nothing is measured. Errors: those of the store,
 * NEPH_ERR_INTERRUPTED, NEPH_ERR_MEMORY; an engine that fails is not measured. */
enum neph_status neph_speed_measure(const struct neph_job *job, const double *known_s,
                                    int known_count, double seconds, struct neph_store *store,
                                    struct neph_times *times, struct neph_speed *speed,
                                    struct neph_diag *diag);

#endif
