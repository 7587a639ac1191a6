/* SPDX-License-Identifier: MIT
 *
 * Render time of an engine, with its start-up separated, measured as by `neph benchmark`. All times
 * of reports have this definition.
 *
 *   engines                       measurement
 *   frames in flight              first frame with start-up, a second of warm-up, then frames in
 *   (march*, realtime, screen)    flight: median, 10 % and 90 % quantiles
 *   others                        whole renders of the radiance with different seeds: mean with its
 *                                 95 % interval
 *
 * Time within a render before its first sample counts as start-up, too. It is measured by a line
 * through two sample counts, or, for engines without a number of samples, by a frame of few pixels.
 */
#ifndef NEPH_HARNESS_RUN_SPEED_H
#define NEPH_HARNESS_RUN_SPEED_H

#include "harness/run/times.h"

struct neph_speed {
    int repeats;                    /* timed frames or renders; fewer than 2: not measured */
    double start_s;                 /* process, device, kernels, grids; NaN: not measured */
    double render_s, low_s, high_s; /* of one warm frame, with the interval; NaN: not measured */
    bool is_flight;                 /* the interval is over frames, not of the mean */
};

bool neph_speed_is_measured(const struct neph_speed *speed);

/* {"start_s", "render_s", "low_s", "high_s", "repeats", "interval"}; null: not measured. */
json_t *neph_speed_json(const struct neph_speed *speed);

/* "10 % to 90 % of the frames", "95 % of the mean". */
const char *neph_speed_interval_name(const struct neph_speed *speed);

/* The speed from renders that took `render_s`, each with a start-up of `process_s` before it and of
 * `in_render_s` before its first sample. Fewer than two renders: not measured. */
struct neph_speed neph_speed_from_renders(const double *render_s, int count, double process_s,
                                          double in_render_s);

/* Detects more work that takes less time. `speeds` are sorted by work, ascending. Returns the first
 * one whose interval lies entirely below the interval of an earlier one, `*earlier`; -1: none.
 * Skips speeds that were not measured. */
int neph_speed_find_inversion(const struct neph_speed *speeds, int count, int *earlier);

/* Read the stored speed of a job from `times` (false: none), and store one. */
bool neph_speed_find(const struct neph_times *times, const struct neph_job *job,
                     struct neph_speed *speed);
enum neph_status neph_speed_keep(struct neph_times *times, const struct neph_job *job,
                                 const struct neph_speed *speed, struct neph_diag *diag);

/* ---- frames in flight ------------------------------------------------------------------------ */

enum { NEPH_SPEED_FRAMES_MAX = 256 };

/* Times one job in rounds, so that several jobs can take turns. */
struct neph_speed_flight {
    struct neph_job job; /* owns its open sequence */
    long picture;
    double first_s; /* time of the first frame, with start-up */
    struct neph_flight_results flown;
};

/* Renders the first frame and the warm-up. Call neph_speed_flight_close() even after an error. */
enum neph_status neph_speed_flight_open(const struct neph_job *job,
                                        struct neph_speed_flight *flight, struct neph_diag *diag);
/* Renders a round: at least 3 frames, and as many as fit into `seconds`. */
enum neph_status neph_speed_flight_round(struct neph_speed_flight *flight, double seconds,
                                         struct neph_diag *diag);

/* The speed from all rounds so far; sorts the flight's times. */
struct neph_speed neph_speed_from_flight(struct neph_speed_flight *flight);
void neph_speed_flight_close(struct neph_speed_flight *flight);

/* ---- renders --------------------------------------------------------------------------------- */

/* Start-up of a job without frames in flight: `*process_s` before its render and `*in_render_s`
 * within it. `render_s` is the time of a whole render. Renders one small frame. */
enum neph_status neph_speed_start(const struct neph_job *job, double render_s,
                                  struct neph_store *store, double *process_s, double *in_render_s,
                                  struct neph_diag *diag);

/* ---- one job --------------------------------------------------------------------------------- */

/* Measures a job, or reads its speed from `times`. `known_s`: `known_count` times of earlier warm
 * renders of this job with other seeds. Renders are repeated while they fit into `seconds`, up to
 * three in all; fewer than two in all: not measured. Errors: of the store, NEPH_ERR_INTERRUPTED,
 * NEPH_ERR_MEMORY. A failing engine is no error; its speed is not measured. */
enum neph_status neph_speed_measure(const struct neph_job *job, const double *known_s,
                                    int known_count, double seconds, struct neph_store *store,
                                    struct neph_times *times, struct neph_speed *speed,
                                    struct neph_diag *diag);

#endif
