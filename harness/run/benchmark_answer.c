/* SPDX-License-Identifier: MIT
 *
 * The summary lines of `neph benchmark`.
 */
#include "harness/run/benchmark_answer.h"

#include <math.h>
#include <string.h>

/* Fails to compile when a kind is added, as the tables of this file need a row for it. */
_Static_assert(NEPH_RMSE_FOUND_COUNT == 5, "a new kind");

enum { NAME_SIZE = 96, TEXT_SIZE = 400 };

/* "cycles (Blender 3.4.1)" for an external renderer; the project's engines are named without a
 * version. */
static const char *format_engine_name(const struct neph_job *job, char text[NAME_SIZE])
{
    if (job->engine->rung == NEPH_LEVEL_EXTERNAL)
        snprintf(text, NAME_SIZE, "%s (%.60s)", job->engine->name, job->info->version);
    else
        snprintf(text, NAME_SIZE, "%s", job->engine->name);
    return text;
}

/* ---- engines with noise ---------------------------------------------------------------------- */

/* `times`: the time of `other` over the time of `base` for the same noise. */
static void answer_pair(const struct neph_benchmark_engine *base,
                        const struct neph_benchmark_engine *other, struct neph_answer *answer)
{
    char first[NAME_SIZE], second[NAME_SIZE], interval[NEPH_ANSWER_INTERVAL_SIZE];
    const struct neph_benchmark_value times = other->times;
    const bool is_faster = times.high<1.0, is_slower = times.low> 1.0;
    if (is_faster)
        neph_answer_add(answer, "%s: %.3g times%s as fast as %s for the same noise",
                        format_engine_name(&other->job, first), 1.0 / times.value,
                        neph_answer_interval(1.0 / times.high, 1.0 / times.low, interval),
                        format_engine_name(&base->job, second));
    else
        neph_answer_add(answer, "%s%s: %.3g times%s as fast as %s for the same noise",
                        is_slower ? "" : "not told apart: ", format_engine_name(&base->job, first),
                        times.value, neph_answer_interval(times.low, times.high, interval),
                        format_engine_name(&other->job, second));
}

/* "1 % of error in 12 s" */
static void append_time(const struct neph_rmse_time *time, char text[TEXT_SIZE])
{
    static const char *const notes[] = {
        [NEPH_RMSE_WITHIN] = "",
        [NEPH_RMSE_BEFORE] = " (extrapolated)",
        [NEPH_RMSE_BEYOND] = " (extrapolated)",
        [NEPH_RMSE_NEVER] = " never, its bias is larger",
        [NEPH_RMSE_UNKNOWN] = " not measured (more --seconds, or --error)",
    };
    const size_t used = strlen(text);
    if (isnan(time->render_s))
        snprintf(text + used, TEXT_SIZE - used, "; %g %% of error%s", 100.0 * time->rmse,
                 notes[time->found]);
    else
        snprintf(text + used, TEXT_SIZE - used, "; %g %% of error in %.3g s%s", 100.0 * time->rmse,
                 time->render_s, notes[time->found]);
}

static void answer_engine(const struct neph_benchmark_engine *engine, struct neph_answer *answer)
{
    char text[TEXT_SIZE] = "", name[NAME_SIZE], interval[NEPH_ANSWER_INTERVAL_SIZE];
    const struct neph_benchmark_value bias = engine->bias;
    const bool is_zero = bias.low <= 0.0 && bias.high >= 0.0;
    for (int i = 0; i < NEPH_BENCHMARK_RMSES; i++)
        append_time(&engine->rmse_times[i], text);
    neph_answer_add(answer, "%s: bias %+.2f %%%s%s; start %.2f s%s",
                    format_engine_name(&engine->job, name), 100.0 * bias.value,
                    neph_answer_interval(100.0 * bias.low, 100.0 * bias.high, interval),
                    is_zero ? ", not told apart from 0" : "", engine->start_s, text);
}

/* One engine: its time to a noise of 1 % instead of a comparison. */
static void answer_single(const struct neph_benchmark_engine *engine, struct neph_answer *answer)
{
    char name[NAME_SIZE], interval[NEPH_ANSWER_INTERVAL_SIZE];
    const double percent = 1e4; /* (1 / 0.01)^2: noise^2 * time is the time to a noise of 1 */
    neph_answer_add(answer, "%s: 1 %% of noise in %.3g s%s", format_engine_name(&engine->job, name),
                    percent * engine->cost_s.value,
                    neph_answer_interval(percent * engine->cost_s.low,
                                         percent * engine->cost_s.high, interval));
}

void neph_benchmark_answer(const struct neph_benchmark *benchmark, struct neph_answer *answer)
{
    const struct neph_shot *shot = &benchmark->reference.shot;
    if (benchmark->engine_count == 0)
        return;
    if (benchmark->engine_count == 1)
        answer_single(&benchmark->engines[0], answer);
    for (int e = 1; e < benchmark->engine_count; e++)
        answer_pair(&benchmark->engines[0], &benchmark->engines[e], answer);
    for (int e = 0; e < benchmark->engine_count; e++)
        answer_engine(&benchmark->engines[e], answer);
    neph_answer_add(answer, "%s, %d x %d pixels; reference: tracer with a noise of %.2g %%",
                    shot->scene->name, shot->width_px, shot->height_px,
                    100.0 * benchmark->reference_noise);
}

/* ---- frames in flight ------------------------------------------------------------------------ */

/* The device's own time where it has timestamps, else wall-clock time. */
static const struct neph_spread *
select_frame_time(const struct neph_benchmark_frames_engine *engine)
{
    return isfinite(engine->gpu_s.median) ? &engine->gpu_s : &engine->frame_s;
}

static const struct neph_benchmark_pass *
longest_pass(const struct neph_benchmark_frames_engine *engine)
{
    const struct neph_benchmark_pass *longest = NULL;
    for (int p = 0; p < engine->pass_count; p++)
        if (!longest || engine->passes[p].gpu_s.median > longest->gpu_s.median)
            longest = &engine->passes[p];
    return longest;
}

static void answer_frames_engine(const struct neph_benchmark_frames_engine *engine,
                                 const char *rest, struct neph_answer *answer)
{
    char name[NAME_SIZE];
    const struct neph_spread *time = select_frame_time(engine);
    neph_answer_add(answer,
                    "%s: %.3g ms a frame (10 %% to 90 %%: %.3g to %.3g), %.3g frames a second, "
                    "error %.3g %% against %s%s",
                    format_engine_name(&engine->job, name), 1e3 * time->median, 1e3 * time->low,
                    1e3 * time->high, 1.0 / engine->mean_s, 100.0 * engine->error,
                    engine->reference->name, rest);
}

/* The faster engine first. Ranges of 10 % to 90 % that overlap count as "not told apart". */
static void answer_frames_pair(const struct neph_benchmark_frames_engine *a,
                               const struct neph_benchmark_frames_engine *b,
                               struct neph_answer *answer)
{
    char first[NAME_SIZE], second[NAME_SIZE];
    const bool is_swapped = select_frame_time(b)->median < select_frame_time(a)->median;
    const struct neph_benchmark_frames_engine *fast = is_swapped ? b : a,
                                              *slow = is_swapped ? a : b;
    neph_answer_add(
        answer, "%s%s: %.3g times as fast as %s, %.3g ms a frame against %.3g ms",
        select_frame_time(fast)->high < select_frame_time(slow)->low ? "" : "not told apart: ",
        format_engine_name(&fast->job, first),
        select_frame_time(slow)->median / select_frame_time(fast)->median,
        format_engine_name(&slow->job, second), 1e3 * select_frame_time(fast)->median,
        1e3 * select_frame_time(slow)->median);
}

void neph_benchmark_frames_answer(const struct neph_benchmark_frames *benchmark,
                                  struct neph_answer *answer)
{
    for (int e = 1; e < benchmark->engine_count; e++)
        answer_frames_pair(&benchmark->engines[0], &benchmark->engines[e], answer);
    for (int e = 0; e < benchmark->engine_count; e++) {
        const struct neph_benchmark_pass *pass = longest_pass(&benchmark->engines[e]);
        char rest[NAME_SIZE] = "";
        if (pass && isfinite(pass->gpu_s.median))
            snprintf(rest, sizeof(rest), "; longest pass: %.40s, %.3g ms", pass->name,
                     1e3 * pass->gpu_s.median);
        answer_frames_engine(&benchmark->engines[e], rest, answer);
    }
    if (benchmark->engine_count > 0) {
        const struct neph_job *job = &benchmark->engines[0].job;
        neph_answer_add(answer, "%s, %d x %d pixels, %s", job->shot.scene->name, job->shot.width_px,
                        job->shot.height_px, job->info->device);
    }
}
