/* SPDX-License-Identifier: MIT
 *
 * Render times with the start-up separated, for reports.
 */
#include "harness/run/speed.h"

#include "harness/run/benchmark.h"
#include "metrics/significance.h"

#include <math.h>
#include <stdlib.h>

enum {
    FRAMES_LEAST = 3,    /* per round */
    RENDERS_MOST = 3,    /* per job */
    FEWER_SAMPLES = 16,  /* the second sample count is smaller by this factor */
    SMALL_WIDTH_PX = 8,  /* a frame with a negligible time for pixels; Blender's minimum */
    SMALL_HEIGHT_PX = 4, /* 4 x 4 pixels */
    FIRST_REPEAT = 1000, /* for jobs that are only timed: no frame of a report has these numbers */
};

static const double alpha = 0.05;

static struct neph_speed not_measured(void)
{
    return (struct neph_speed){.start_s = NAN, .render_s = NAN, .low_s = NAN, .high_s = NAN};
}

bool neph_speed_is_measured(const struct neph_speed *speed)
{
    return speed->repeats >= 2;
}

const char *neph_speed_interval_name(const struct neph_speed *speed)
{
    return speed->is_flight ? "10 % to 90 % of the frames" : "95 % of the mean";
}

json_t *neph_speed_json(const struct neph_speed *speed)
{
    return neph_speed_is_measured(speed)
               ? json_pack(
                     "{s:o, s:o, s:o, s:o, s:i, s:s}", "start_s", neph_json_number(speed->start_s),
                     "render_s", neph_json_number(speed->render_s), "low_s",
                     neph_json_number(speed->low_s), "high_s", neph_json_number(speed->high_s),
                     "repeats", speed->repeats, "interval", neph_speed_interval_name(speed))
               : json_null();
}

struct neph_speed neph_speed_of_renders(const double *render_s, int count, double process_s,
                                        double in_render_s)
{
    double mean_s = 0.0, squares = 0.0, least_s = INFINITY;
    if (count < 2)
        return not_measured();
    for (int i = 0; i < count; i++) {
        mean_s += render_s[i] / count;
        least_s = fmin(least_s, render_s[i]);
    }
    for (int i = 0; i < count; i++)
        squares += (render_s[i] - mean_s) * (render_s[i] - mean_s);
    const double within_s = fmin(isfinite(in_render_s) ? in_render_s : 0.0, least_s);
    const double half_s = neph_student_critical(alpha, count - 1.0) *
                          sqrt(squares / ((count - 1.0) * count));
    return (struct neph_speed){
        .repeats = count,
        .start_s = process_s + in_render_s,
        .render_s = mean_s - within_s,
        .low_s = fmax(0.0, mean_s - within_s - half_s),
        .high_s = mean_s - within_s + half_s,
    };
}

int neph_speed_falls(const struct neph_speed *speeds, int count, int *earlier)
{
    for (int i = 1; i < count; i++)
        for (int k = 0; k < i; k++)
            if (neph_speed_is_measured(&speeds[i]) && neph_speed_is_measured(&speeds[k]) &&
                speeds[i].high_s < speeds[k].low_s) {
                *earlier = k;
                return i;
            }
    return -1;
}

/* ---- stored times -------------------------------------------------------------------------- */

bool neph_speed_find(const struct neph_times *times, const struct neph_job *job,
                     struct neph_speed *speed)
{
    struct neph_spread time;
    int repeats;
    double start_s;
    if (!neph_times_find(times, job, &time, &repeats, &start_s))
        return false;
    *speed = (struct neph_speed){.repeats = repeats,
                                 .start_s = start_s,
                                 .render_s = time.median,
                                 .low_s = time.low,
                                 .high_s = time.high,
                                 .is_flight = neph_flight_applies(job->engine)};
    return true;
}

enum neph_status neph_speed_keep(struct neph_times *times, const struct neph_job *job,
                                 const struct neph_speed *speed, struct neph_diag *diag)
{
    double load = NAN;
    if (getloadavg(&load, 1) != 1)
        load = NAN;
    const struct neph_spread time = {speed->render_s, speed->low_s, speed->high_s};
    const enum neph_status status = neph_times_put(times, job, time, speed->repeats, speed->start_s,
                                                   load, diag);
    return status ? status : neph_times_save(times, diag);
}

/* ---- frames in flight ------------------------------------------------------------------------ */

enum neph_status neph_speed_flight_open(const struct neph_job *job,
                                        struct neph_speed_flight *flight, struct neph_diag *diag)
{
    *flight = (struct neph_speed_flight){.job = *job, .picture = 1, .first_s = NAN};
    flight->flown.costs = calloc(NEPH_SPEED_FRAMES_MAX, sizeof(*flight->flown.costs));
    flight->flown.frame_s = calloc(NEPH_SPEED_FRAMES_MAX, sizeof(*flight->flown.frame_s));
    if (!flight->flown.costs || !flight->flown.frame_s)
        return neph_fail_memory(diag);
    const enum neph_status status = neph_flight_open(&flight->job, &flight->first_s, diag);
    return status ? status : neph_flight_warm_up(&flight->job, &flight->picture, diag);
}

enum neph_status neph_speed_flight_round(struct neph_speed_flight *flight, double seconds,
                                         struct neph_diag *diag)
{
    const int room = NEPH_SPEED_FRAMES_MAX - flight->flown.count;
    const int least = room < FRAMES_LEAST ? room : FRAMES_LEAST;
    return room > 0 ? neph_flight_fly(&flight->job, &flight->picture, least, room, seconds,
                                      &flight->flown, diag)
                    : NEPH_OK;
}

struct neph_speed neph_speed_of_flight(struct neph_speed_flight *flight)
{
    if (flight->flown.count < 2)
        return not_measured();
    const struct neph_spread time = neph_flight_time(&flight->flown);
    return (struct neph_speed){
        .repeats = flight->flown.count,
        .start_s = fmax(0.0, flight->first_s - time.median),
        .render_s = time.median,
        .low_s = time.low,
        .high_s = time.high,
        .is_flight = true,
    };
}

void neph_speed_flight_close(struct neph_speed_flight *flight)
{
    if (flight->job.engine)
        neph_job_close(&flight->job);
    free(flight->flown.costs);
    free(flight->flown.frame_s);
    *flight = (struct neph_speed_flight){.picture = 0};
}

static enum neph_status fly(const struct neph_job *job, double seconds, struct neph_speed *speed,
                            struct neph_diag *diag)
{
    struct neph_speed_flight flight;
    enum neph_status status = neph_speed_flight_open(job, &flight, diag);
    if (!status)
        status = neph_speed_flight_round(&flight, seconds, diag);
    if (!status)
        *speed = neph_speed_of_flight(&flight);
    neph_speed_flight_close(&flight);
    return status;
}

/* ---- renders --------------------------------------------------------------------------------- */

/* Renders radiance with a seed that no frame of a report has. `*cost` stays as it is where the
 * engine fails. */
static enum neph_status render(const struct neph_job *of, int repeat, struct neph_store *store,
                               struct neph_cost *cost, struct neph_diag *diag)
{
    struct neph_job job = *of;
    struct neph_job_result result = {.outcome = NEPH_OUTCOME_FAILED};
    job.shot.layers = NEPH_LAYER_RADIANCE;
    job.shot.seed += (uint64_t)repeat;
    job.repeat = FIRST_REPEAT + repeat;
    const enum neph_status status = neph_job_run(&job, store, &result, diag);
    if (!status && result.outcome == NEPH_OUTCOME_RENDERED)
        *cost = result.cost;
    neph_job_result_finish(&result);
    return status;
}

enum neph_status neph_speed_start(const struct neph_job *job, double render_s,
                                  struct neph_store *store, double *process_s, double *in_render_s,
                                  struct neph_diag *diag)
{
    const int index = neph_engine_samples(job->engine);
    struct neph_cost cost = {.render_s = NAN, .wall_s = NAN};
    struct neph_job small = *job;
    double fewer = NAN;
    *process_s = *in_render_s = NAN;
    if (index >= 0) {
        const double all = job->shot.settings.values[index];
        fewer = fmax(job->engine->options[index].minimum, floor(all / FEWER_SAMPLES));
        small.shot.settings.values[index] = fewer;
    } else {
        small.shot.width_px = SMALL_WIDTH_PX;
        small.shot.height_px = SMALL_HEIGHT_PX;
    }
    const enum neph_status status = render(&small, 0, store, &cost, diag);
    if (status || isnan(cost.render_s))
        return status;
    *process_s = fmax(0.0, cost.wall_s - cost.render_s);
    *in_render_s = cost.render_s;
    if (index >= 0 && job->shot.settings.values[index] > fewer)
        *in_render_s = neph_rungs_start(
            (const int[]){(int)fewer, (int)job->shot.settings.values[index]},
            (const double[]){cost.render_s, render_s}, (const double[]){cost.render_s, render_s},
            2);
    return status;
}

/* Adds renders to the known ones while they fit into `seconds`. */
static enum neph_status repeat(const struct neph_job *job, double seconds, struct neph_store *store,
                               double render_s[RENDERS_MOST], int *count, struct neph_diag *diag)
{
    double spent_s = 0.0, each_s = *count > 0 ? render_s[0] : 0.0;
    enum neph_status status = NEPH_OK;
    for (int i = 1; *count < RENDERS_MOST && spent_s + each_s <= seconds && !status; i++) {
        struct neph_cost cost = {.render_s = NAN};
        status = render(job, i, store, &cost, diag);
        if (status || isnan(cost.render_s))
            break;
        spent_s += cost.wall_s;
        each_s = cost.wall_s;
        render_s[(*count)++] = cost.render_s;
    }
    return status;
}

static double mean_of(const double *values, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        sum += values[i];
    return sum / count;
}

static enum neph_status time_renders(const struct neph_job *job, const double *known_s,
                                     int known_count, double seconds, struct neph_store *store,
                                     struct neph_speed *speed, struct neph_diag *diag)
{
    double render_s[RENDERS_MOST], process_s, in_render_s;
    int count = 0;
    for (; count < known_count && count < RENDERS_MOST; count++)
        render_s[count] = known_s[count];
    enum neph_status status = repeat(job, seconds, store, render_s, &count, diag);
    if (status || count < 2)
        return status;
    status = neph_speed_start(job, mean_of(render_s, count), store, &process_s, &in_render_s, diag);
    if (!status)
        *speed = neph_speed_of_renders(render_s, count, process_s, in_render_s);
    return status;
}

/* ---- one job --------------------------------------------------------------------------------- */

enum neph_status neph_speed_measure(const struct neph_job *job, const double *known_s,
                                    int known_count, double seconds, struct neph_store *store,
                                    struct neph_times *times, struct neph_speed *speed,
                                    struct neph_diag *diag)
{
    struct neph_diag why = {.line = 0};
    *speed = not_measured();
    if (neph_speed_find(times, job, speed))
        return NEPH_OK;
    enum neph_status status = neph_flight_applies(job->engine)
                                  ? fly(job, seconds, speed, &why)
                                  : time_renders(job, known_s, known_count, seconds, store, speed,
                                                 &why);
    if (status == NEPH_ERR_ENGINE || status == NEPH_ERR_UNSUPPORTED ||
        status == NEPH_ERR_UNAVAILABLE || status == NEPH_ERR_TIMEOUT)
        status = NEPH_OK; /* the report has the engine's error with its frame */
    if (status && diag)
        *diag = why;
    if (status || !neph_speed_is_measured(speed))
        return status;
    return neph_speed_keep(times, job, speed, diag);
}
