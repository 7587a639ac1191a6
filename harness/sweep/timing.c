/* SPDX-License-Identifier: MIT
 *
 * Times of a sweep's points, in rounds.
 */
#include "harness/sweep/point.h"

#include "harness/sweep/repeat.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Fails to compile when a value is added, as rounds repeat the error only. */
_Static_assert(NEPH_SWEEP_NUMBERS == 5, "a new kind");

enum { WARM_UP_FRAMES = 16 }; /* four cycles of four frames fill a history */

/* Times and errors of a point over the rounds. */
struct timed {
    struct neph_job job; /* with its open sequence, for frames in flight */
    bool has_flight;
    long picture;
    struct neph_flight_results flown;
    double *seconds; /* of single frames; errors likewise */
    struct neph_sweep_value *errors;
    struct neph_cost last; /* of the latest single frame */
    int rendered;
};

/* Whether a point is to be timed: it can be rendered and has no stored time. */
static bool is_due(const struct neph_sweep_point *point)
{
    return !point->missing[0] && point->timed == 0;
}

/* Whether the rounds are seeds of the error. Points with a stored time get these frames, too, from
 * the store. */
static bool has_seeds(const struct neph_sweep_point *point)
{
    return !point->missing[0] && point->job.engine->stochastic &&
           !neph_flight_applies(point->job.engine) && !neph_sweep_is_sequence(point);
}

static bool takes_part(const struct neph_sweep_point *point)
{
    return is_due(point) || has_seeds(point);
}

/* --- one point ------------------------------------------------------------------------------ */

static enum neph_status open_one(const struct neph_sweep_context *bench,
                                 const struct neph_sweep_point *point, struct timed *timed,
                                 struct neph_diag *diag)
{
    const size_t rounds = (size_t)bench->plan->round_count, room = rounds * NEPH_SWEEP_ROUND_MOST;
    timed->job = point->job;
    timed->has_flight = neph_flight_applies(point->job.engine);
    timed->flown.costs = timed->has_flight ? calloc(room, sizeof(*timed->flown.costs)) : NULL;
    timed->flown.frame_s = timed->has_flight ? calloc(room, sizeof(*timed->flown.frame_s)) : NULL;
    timed->seconds = calloc(rounds, sizeof(*timed->seconds));
    timed->errors = calloc(rounds, sizeof(*timed->errors));
    if ((timed->has_flight && (!timed->flown.costs || !timed->flown.frame_s)) || !timed->seconds ||
        !timed->errors)
        return neph_fail_memory(diag);
    if (!timed->has_flight)
        return NEPH_OK;
    const enum neph_status status = neph_job_open(&timed->job, diag);
    return status ? status
                  : neph_flight_run(&timed->job, &timed->picture, WARM_UP_FRAMES, WARM_UP_FRAMES,
                                    0.0, NULL, diag);
}

static void close_one(struct timed *timed)
{
    if (timed->job.engine)
        neph_job_close(&timed->job);
    free(timed->flown.costs);
    free(timed->flown.frame_s);
    free(timed->seconds);
    free(timed->errors);
}

static bool is_enough(const struct timed *timed)
{
    return (timed->rendered > 0 && timed->last.render_s > NEPH_SWEEP_LONG_S) ||
           (timed->rendered > 1 && timed->last.wall_s > NEPH_SWEEP_LONG_START_S);
}

static enum neph_status run_round(struct neph_sweep_context *bench, struct neph_sweep_point *point,
                                  struct timed *timed, int round, struct neph_diag *diag)
{
    if (timed->has_flight)
        return neph_flight_run(&timed->job, &timed->picture, NEPH_SWEEP_ROUND_LEAST,
                               NEPH_SWEEP_ROUND_MOST, NEPH_SWEEP_ROUND_S, &timed->flown, diag);
    const int index = timed->rendered;
    if (is_enough(timed))
        return NEPH_OK;
    timed->errors[index].value = NAN;
    const enum neph_status status = neph_sweep_point_render(
        bench, point, round, &timed->errors[index], &timed->last, diag);
    timed->seconds[index] = timed->last.render_s;
    timed->rendered += !status && isfinite(timed->errors[index].value);
    return status;
}

/* --- results -------------------------------------------------------------------------------- */

static void set_point_time(struct timed *timed, struct neph_sweep_point *point)
{
    if (timed->has_flight && timed->flown.count > 0) {
        point->timed = timed->flown.count;
        point->time = neph_flight_time(&timed->flown);
    } else if (timed->rendered > 0) {
        point->timed = timed->rendered;
        point->time = neph_spread_compute(timed->seconds, timed->rendered);
    }
}

static enum neph_status store_point_results(const struct neph_sweep_context *bench,
                                            struct timed *timed, struct neph_sweep_point *point,
                                            double load, struct neph_diag *diag)
{
    const bool was_due = is_due(point);
    if (has_seeds(point) && timed->rendered > 0)
        point->numbers[NEPH_SWEEP_ERROR] = neph_sweep_average_seeds(timed->errors, timed->rendered);
    if (was_due)
        set_point_time(timed, point);
    return was_due && point->timed > 0 ? neph_times_put(bench->times, &point->job, point->time,
                                                        point->timed, NAN, load, diag)
                                       : NEPH_OK;
}

/* --- all points ----------------------------------------------------------------------------- */

static enum neph_status run_rounds(struct neph_sweep_context *bench,
                                   struct neph_sweep_point *points, struct timed *all, int count,
                                   struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int round = 0; round < bench->plan->round_count && !status; round++) {
        char what[64];
        snprintf(what, sizeof(what), "times, round %d of %d", round + 1, bench->plan->round_count);
        neph_progress_begin(bench->progress, what);
        for (int i = 0; i < count && !status; i++)
            if (takes_part(&points[i]))
                status = run_round(bench, &points[i], &all[i], round, diag);
        if (!status)
            neph_progress_over(bench->progress, what, "timed");
    }
    return status;
}

enum neph_status neph_sweep_time(struct neph_sweep_context *bench, struct neph_sweep_point *points,
                                 int count, struct neph_diag *diag)
{
    struct timed *all = calloc((size_t)count, sizeof(*all));
    enum neph_status status = all ? NEPH_OK : neph_fail_memory(diag);
    for (int i = 0; i < count && !bench->remeasures_times; i++)
        neph_times_find(bench->times, &points[i].job, &points[i].time, &points[i].timed, NULL);
    for (int i = 0; i < count && !status; i++)
        if (takes_part(&points[i]))
            status = open_one(bench, &points[i], &all[i], diag);
    if (!status)
        status = run_rounds(bench, points, all, count, diag);
    const double load = neph_sweep_load();
    for (int i = 0; all && i < count; i++) {
        if (!status)
            status = store_point_results(bench, &all[i], &points[i], load, diag);
        close_one(&all[i]);
    }
    free(all);
    return status ? status : neph_times_save(bench->times, diag);
}

double neph_sweep_load(void)
{
    double load = NAN;
    return getloadavg(&load, 1) == 1 ? load : NAN;
}
