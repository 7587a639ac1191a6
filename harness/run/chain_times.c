/* SPDX-License-Identifier: MIT
 *
 * GPU times of the display chain's stages.
 */
#include "harness/run/chain_times.h"

#include "base/clock.h"
#include "harness/engines/vulkan_device.h"
#include "metrics/statistics.h"

#include <math.h>
#include <stdlib.h>

static const double warm_up_s = 1.0;

/* Runs before each timed one that raise the GPU's clock: about 40 ms at 1920x1080. On an H100 the
 * median was 1.6 times the least time after ten runs, and three times without any. Lavapipe has no
 * clock that rises. */
enum { HEAT_RUNS = 1500 };

enum neph_status neph_chain_warm_up(struct neph_vulkan *vulkan,
                                    const struct neph_post_params *params,
                                    const struct neph_image *frame, struct neph_diag *diag)
{
    const double end_s = neph_wall_s() + warm_up_s;
    struct neph_post_params own = *params;
    enum neph_status status = NEPH_OK;
    own.eye = NULL;
    while (!status && neph_wall_s() < end_s) {
        struct neph_image *picture = NULL;
        status = neph_post_run(vulkan, &own, frame, &picture, NULL, diag);
        neph_image_destroy(picture);
    }
    return status;
}

/* Sorts `seconds`. */
static struct neph_chain_time summarise_times(double *seconds, int count)
{
    const bool has_clock = !isnan(seconds[0]);
    return (struct neph_chain_time){
        .least_s = has_clock ? neph_percentile(seconds, (size_t)count, 0.0) : NAN,
        .spread_s = neph_spread_compute(seconds, count),
    };
}

/* Times of one stage, or of all stages together. */
typedef double seconds_of_repeats[NEPH_CHAIN_REPEATS_MAX];

static void record_repeat(const struct neph_post_stats *stats, int repeat,
                          seconds_of_repeats *seconds)
{
    for (int s = 0; s < NEPH_POST_STAGES_MAX; s++) {
        seconds[s][repeat] = stats->gpu_s[s];
        seconds[NEPH_POST_STAGES_MAX][repeat] += stats->gpu_s[s];
    }
}

enum neph_status neph_chain_measure(struct neph_vulkan *vulkan,
                                    const struct neph_post_params *params,
                                    const struct neph_image *frame, int repeats, double limit_s,
                                    struct neph_image **picture, struct neph_post_stats *stats,
                                    struct neph_chain_times *times, struct neph_diag *diag)
{
    const double end_s = neph_wall_s() + limit_s;
    const struct neph_exposure_state before = params->eye
                                                  ? *params->eye
                                                  : (struct neph_exposure_state){.is_open = false};
    struct neph_post_params own = *params;
    struct neph_exposure_state eye = before;
    struct neph_image *made = NULL;
    seconds_of_repeats *seconds = calloc(NEPH_POST_STAGES_MAX + 1, sizeof(*seconds));
    enum neph_status status = seconds ? NEPH_OK : neph_fail_memory(diag);
    int count = 0;
    own.eye = &eye;
    own.warm_up_runs = repeats == 1 || neph_vulkan_describe(vulkan).is_cpu ? 0 : HEAT_RUNS;
    while (!status && count < repeats && (count == 0 || neph_wall_s() < end_s)) {
        eye = before;
        neph_image_destroy(made);
        made = NULL;
        status = neph_post_run(vulkan, &own, frame, &made, stats, diag);
        if (!status)
            record_repeat(stats, count++, seconds);
    }
    if (!status) {
        times->count = count;
        for (int s = 0; s < NEPH_POST_STAGES_MAX; s++)
            times->stages[s] = summarise_times(seconds[s], count);
        times->all = summarise_times(seconds[NEPH_POST_STAGES_MAX], count);
        *picture = made;
        if (params->eye)
            *params->eye = eye;
    }
    free(seconds);
    return status;
}

/* ---- JSON ------------------------------------------------------------------------------------ */

json_t *neph_chain_time_json(const char *name, const struct neph_chain_time *time)
{
    const struct neph_spread *s = &time->spread_s;
    return json_pack("{s:s, s:o, s:o, s:o, s:o}", "name", name, "ms",
                     neph_json_number(1e3 * s->median), "low_ms", neph_json_number(1e3 * s->low),
                     "high_ms", neph_json_number(1e3 * s->high), "least_ms",
                     neph_json_number(1e3 * time->least_s));
}

json_t *neph_chain_stages_json(const struct neph_post_params *params,
                               const struct neph_chain_times *times)
{
    const struct neph_post_stage *sequence[NEPH_POST_STAGES_MAX];
    const int count = neph_post_sequence(params->order, &params->settings, sequence);
    json_t *stages = json_array();
    for (int i = 0; i < count; i++)
        neph_json_add(&stages,
                      neph_chain_time_json(sequence[i]->name,
                                           &times->stages[sequence[i] - neph_post_stages]));
    return stages;
}
