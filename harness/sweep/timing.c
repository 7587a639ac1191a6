/* SPDX-License-Identifier: MIT */
#include "harness/sweep/timing.h"

#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { WARM_UP_FRAMES = 16 }; /* four turns of the four frames: a history */

/* What is gathered of a point over the rounds. */
struct timed {
    struct neph_job job; /* with its sequence, of what flies */
    bool flies;
    long picture;
    struct neph_flown flown;
    double *seconds, *errors; /* of pictures that are rendered one at a time */
    int rendered;
};

/* Those that can be timed and were not before. */
static bool is_due(const struct neph_sweep_point *point)
{
    return !point->missing[0] && point->timed == 0;
}

/* --- one point ------------------------------------------------------------------------------ */

static enum neph_status open_one(const struct neph_sweep_bench *bench,
                                 const struct neph_sweep_point *point, struct timed *timed,
                                 struct neph_diag *diag)
{
    const size_t rounds = (size_t)bench->plan->round_count, room = rounds * NEPH_SWEEP_ROUND_MOST;
    timed->job = point->job;
    timed->flies = neph_flight_applies(point->job.engine);
    timed->flown.costs = timed->flies ? calloc(room, sizeof(*timed->flown.costs)) : NULL;
    timed->flown.frame_s = timed->flies ? calloc(room, sizeof(*timed->flown.frame_s)) : NULL;
    timed->seconds = calloc(rounds, sizeof(*timed->seconds));
    timed->errors = calloc(rounds, sizeof(*timed->errors));
    if ((timed->flies && (!timed->flown.costs || !timed->flown.frame_s)) || !timed->seconds ||
        !timed->errors)
        return neph_fail_memory(diag);
    if (!timed->flies)
        return NEPH_OK;
    const enum neph_status status = neph_job_open(&timed->job, diag);
    return status ? status
                  : neph_flight_fly(&timed->job, &timed->picture, WARM_UP_FRAMES, WARM_UP_FRAMES,
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

static enum neph_status run_round(struct neph_sweep_bench *bench, struct neph_sweep_point *point,
                                  struct timed *timed, int round, struct neph_diag *diag)
{
    struct neph_sweep_value error = {NAN, NAN, NAN};
    if (timed->flies)
        return neph_flight_fly(&timed->job, &timed->picture, NEPH_SWEEP_ROUND_LEAST,
                               NEPH_SWEEP_ROUND_MOST, NEPH_SWEEP_ROUND_S, &timed->flown, diag);
    const int index = timed->rendered;
    if (index > 0 && timed->seconds[index - 1] > NEPH_SWEEP_LONG_S)
        return NEPH_OK;
    const enum neph_status status = neph_sweep_point_render(bench, point, round, &error,
                                                            &timed->seconds[index], diag);
    timed->errors[index] = error.value;
    timed->rendered += !status && isfinite(error.value);
    return status;
}

/* --- what came of it ------------------------------------------------------------------------ */

/* On the device's clock where it has one. */
static struct neph_spread flight_time(struct timed *timed)
{
    struct neph_flown *flown = &timed->flown;
    if (flown->count > 0 && isfinite(flown->costs[0].gpu_s))
        for (int i = 0; i < flown->count; i++)
            flown->frame_s[i] = flown->costs[i].gpu_s;
    return neph_spread_of(flown->frame_s, flown->count);
}

/* Seeds of the rounds are independent: their mean. */
static double mean_of(const double *values, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        sum += values[i];
    return sum / count;
}

static void move_error(const struct timed *timed, struct neph_sweep_value *error)
{
    const double mean = mean_of(timed->errors, timed->rendered), moved = mean - error->value;
    *error = (struct neph_sweep_value){mean, error->low + moved, error->high + moved};
}

static void conclude(struct timed *timed, struct neph_sweep_point *point)
{
    if (timed->flies && timed->flown.count > 0) {
        point->timed = timed->flown.count;
        point->time = flight_time(timed);
    } else if (timed->rendered > 0) {
        if (!neph_sweep_is_sequence(point)) /* whose error is that of its last picture */
            move_error(timed, &point->numbers[NEPH_SWEEP_ERROR]);
        point->timed = timed->rendered;
        point->time = neph_spread_of(timed->seconds, timed->rendered);
    }
}

/* --- all ------------------------------------------------------------------------------------ */

static enum neph_status run_rounds(struct neph_sweep_bench *bench, struct neph_sweep_point *points,
                                   struct timed *all, int count, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int round = 0; round < bench->plan->round_count && !status; round++) {
        char what[64];
        snprintf(what, sizeof(what), "times, round %d of %d", round + 1, bench->plan->round_count);
        neph_progress_begin(bench->progress, what);
        const double start_s = neph_wall_s();
        for (int i = 0; i < count && !status; i++)
            if (is_due(&points[i]))
                status = run_round(bench, &points[i], &all[i], round, diag);
        if (!status)
            neph_progress_step(bench->progress, what, "timed", neph_wall_s() - start_s);
    }
    return status;
}

enum neph_status neph_sweep_time(struct neph_sweep_bench *bench, struct neph_sweep_point *points,
                                 int count, struct neph_diag *diag)
{
    struct timed *all = calloc((size_t)count, sizeof(*all));
    enum neph_status status = all ? NEPH_OK : neph_fail_memory(diag);
    for (int i = 0; i < count && !bench->retimes; i++)
        neph_times_find(bench->times, &points[i].job, &points[i].time, &points[i].timed);
    for (int i = 0; i < count && !status; i++)
        if (is_due(&points[i]))
            status = open_one(bench, &points[i], &all[i], diag);
    if (!status)
        status = run_rounds(bench, points, all, count, diag);
    const double load = neph_sweep_load();
    for (int i = 0; all && i < count; i++) {
        if (!status && is_due(&points[i])) {
            conclude(&all[i], &points[i]);
            status = points[i].timed > 0
                         ? neph_times_put(bench->times, &points[i].job, points[i].time,
                                          points[i].timed, load, diag)
                         : NEPH_OK;
        }
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
