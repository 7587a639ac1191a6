/* SPDX-License-Identifier: MIT
 *
 * `neph validate` without a suite: scenes rendered by many engines, compared with the highest
 * reference level, with gates.
 */
#include "harness/experiments/validate.h"

#include "harness/data.h"
#include "harness/engines/engines.h"

enum { TIER_SCENES_MAX = 16 };

/* The scenes of a run: the named scenes, or the scenes of the tier. */
struct chosen_scenes {
    char **listed; /* the whole catalogue; owned; NULL: unused */
    const char *names[TIER_SCENES_MAX];
    struct neph_scene_plan plans[TIER_SCENES_MAX];
};

/* Take the scenes of a tier. A size or engines given by the user apply to all scenes. */
static void choose_planned(const struct neph_validate_request *request,
                           const struct neph_validate_tier *tier, struct chosen_scenes *chosen,
                           struct neph_validate_params *params)
{
    int count = 0;
    for (; tier->scenes[count].name && count < TIER_SCENES_MAX; count++) {
        struct neph_scene_plan *plan = &chosen->plans[count];
        *plan = tier->scenes[count];
        chosen->names[count] = plan->name;
        if (request->shared.size.width_px > 0)
            plan->width_px = plan->height_px = 0;
        if (request->engines.count > 0)
            plan->engines = NULL;
    }
    params->scenes = chosen->names;
    params->plans = chosen->plans;
    params->scene_count = count;
}

static enum neph_status choose_scenes(const struct neph_validate_request *request,
                                      struct neph_validate_params *params,
                                      struct chosen_scenes *chosen, struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &request->shared;
    const struct neph_validate_tier *tier = neph_validate_tier(request);
    enum neph_status status = NEPH_OK;
    params->scenes = shared->operands;
    params->scene_count = shared->operand_count;
    if (shared->operand_count == 0 && tier->scenes) {
        choose_planned(request, tier, chosen, params);
    } else if (shared->operand_count == 0) {
        status = neph_data_list_scenes(NEPH_DATA_CATALOG, &chosen->listed, &params->scene_count,
                                       diag);
        params->scenes = (const char *const *)chosen->listed;
    }
    return status;
}

/* Take the engines of a tier; `cycles` includes other Blender versions. */
static void choose_engines(const char *const *wanted, const char *engines[NEPH_ENGINE_COUNT],
                           struct neph_validate_params *params)
{
    int known;
    const struct neph_engine *const *all = neph_engines(&known);
    params->engines = engines;
    params->engine_count = 0;
    for (int i = 0; i < known; i++)
        for (const char *const *name = wanted; *name; name++)
            if (neph_engine_is_kind(all[i], *name))
                engines[params->engine_count++] = all[i]->name;
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    const struct neph_validate_request *request = request_;
    const struct neph_validate_tier *tier = neph_validate_tier(request);
    const bool names_engines = request->engines.count > 0;
    const bool is_tier = !names_engines && request->shared.operand_count == 0;
    struct neph_validation validation = {.title = NULL};
    struct neph_validate_params params = neph_validate_make_params(request, run);
    struct neph_times times = {.path = NULL};
    const struct neph_charts_params charts = {.ids = tier->charts,
                                              .times = &times,
                                              .repeats = tier->chart_repeats,
                                              .time_limit_s = params.budget_s,
                                              .device = run->device};
    struct chosen_scenes chosen = {.listed = NULL};
    params.over_time = is_tier && !request->no_charts;
    params.over_time_floors = tier->with_floors;
    params.charts = params.over_time ? &charts : NULL;
    enum neph_status status = choose_scenes(request, &params, &chosen, diag);
    if (!status && params.charts)
        status = neph_times_open_in(request->shared.output, &times, diag);
    params.times = params.over_time && tier->with_times ? &times : NULL;
    const char *engines[NEPH_ENGINE_COUNT];
    if (is_tier && tier->engines)
        choose_engines(tier->engines, engines, &params);
    if (!status)
        status = neph_validate(&params, run->store, &validation, diag);
    status = neph_validate_publish(request, &validation, publication, status, diag);
    neph_validation_finish(&validation);
    neph_times_close(&times);
    neph_data_free_names(chosen.listed);
    return status;
}

const struct neph_experiment neph_experiment_catalog = {
    .prepare = neph_validate_open_report, .run = run, .finish = neph_validate_close_report};
