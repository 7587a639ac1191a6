/* SPDX-License-Identifier: MIT
 *
 * `neph study steps ENGINE SCENE`: how far an engine's steps are from their limit.
 */
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/experiments/experiments.h"
#include "harness/study/studies.h"
#include "harness/study/study.h"

#include <math.h>
#include <stdio.h>

/* Compiles only when this file handles every verdict. */
_Static_assert(NEPH_STUDY_VERDICT_COUNT == 3, "a new kind");

struct request {
    struct neph_cli_shared shared; /* operands: engine and scene; with --renew scenes */
    bool renew;
    char **names;             /* scenes of the catalogue; owned */
    struct neph_scene *scene; /* owned */
    struct neph_job job;
    bool is_part; /* a job of --jobs: one scene, or */
    int part;     /* one frame of the study */
};

static const struct neph_cli_option options[] = {
    {.name = "size", .otherwise = "192x108"},
    {.name = "set", .help = "Another setting of the engine; may be given several times"},
    {.name = "output", .help = "Folder of the store", .otherwise = "out/study"},
    {.name = "time-limit", .otherwise = "3600"},
    {"renew", 0, NULL,
     "Make the studies that come with neph (scenes/studies) where they are missing or of another "
     "version; of the whole catalogue, or of only the given scene",
     NEPH_CLI_FLAG, .at = offsetof(struct request, renew)},
    {.name = "blender"},
    {.name = "jobs", .otherwise = "1"},
    {.name = "all", .help = "The mean radiance and the bias of each step"},
    {.name = "json"},
    {.name = "quiet"},
    {.name = "quiet"},
    {.name = NULL},
};

static const struct neph_cli_operands operands = {
    .shown = "ENGINE SCENE\n--renew [SCENE]",
    .maximum = 2,
    .surplus = "one engine and one scene",
};

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    if (request->renew && request->shared.operand_count > 1)
        argp_error(state, "--renew takes one scene at the most, and studies every engine");
    if (!request->renew && request->shared.operand_count < 2)
        argp_error(state, "an engine and a scene are needed");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc = "Halve the step of an engine that marches through uneven media until its bias is "
           "known, and print the coarsest setting that is good enough. Engines: cycles, povray, "
           "march.\vStep bias is not noise: more samples per pixel do not remove it. The limit "
           "of small steps is Richardson's extrapolation of the last two steps with the known "
           "order of the engine. The observed order shows whether that order was right, where "
           "noise allows to see it.\n\n"
           "Examples:\n"
           "  neph study steps povray height_fog_up\n"
           "  neph study steps --renew\n"
           "  neph study steps cycles height_fog_down --size 96x54 --set samples=256 --json",
};

static void print_study(const struct neph_study *study, const struct neph_cli_shared *shared,
                        FILE *out)
{
    fprintf(out, "%s in %s: mean radiance by %s, %dx%d\n", shared->operands[0], shared->operands[1],
            study->option, shared->size.width_px, shared->size.height_px);
    fprintf(out, "%12s %14s %10s %12s %10s %9s\n", study->option, "radiance", "noise", "bias",
            "noise", "seconds");
    for (int i = 0; i < study->level_count; i++) {
        const struct neph_study_level *level = &study->levels[i];
        fprintf(out, "%12.5g %14.7g %10.1e %+11.4f%% %9.4f%% %9.2f%s\n", level->setting,
                level->radiance, level->noise, 100.0 * level->bias, 100.0 * level->bias_noise,
                level->wall_s, i == study->chosen ? "  <- chosen" : "");
    }
    fprintf(out, "limit %.7g by order %g", study->limit, study->order);
    if (isfinite(study->observed_order))
        fprintf(out, "; observed order %.2f", study->observed_order);
    static const char *const sentences[] = {
        [NEPH_STUDY_WITHIN] = "the chosen setting is within 0.1 % of the limit, noise included",
        [NEPH_STUDY_NOISE] = "noise hides whether any setting is within 0.1 %: the coarsest "
                             "setting with a bias within the noise is chosen",
        [NEPH_STUDY_OFF] = "even the finest setting has a bias of more than 0.1 %, or its error "
                           "does not shrink by the order that the limit assumes: take the bias as "
                           "a guess, and smaller steps by hand",
    };
    fprintf(out, "\n%s\n", sentences[study->verdict]);
}

static void answer_study(const struct neph_study *study, const struct neph_cli_shared *shared,
                         struct neph_answer *answer)
{
    static const char *const starts[] = {
        [NEPH_STUDY_WITHIN] =
            "%s: %s=%.4g is enough for 0.1 %% of bias: bias %+.3f %% with a noise "
            "of %.3f %%, %.2f s a frame",
        [NEPH_STUDY_NOISE] = "%s: %s=%.4g is not told apart from the limit of small steps: bias "
                             "%+.3f %% with a noise of %.3f %%, %.2f s a frame",
        [NEPH_STUDY_OFF] =
            "%s: no step is known to be within 0.1 %%: the finest measured, %s=%.4g, "
            "has a bias of %+.3f %% with a noise of %.3f %%, %.2f s a frame",
    };
    const int last = study->level_count - 1;
    const struct neph_study_level *level =
        &study->levels[study->verdict == NEPH_STUDY_OFF ? last : study->chosen];
    neph_answer_add(answer, starts[study->verdict], shared->operands[0], study->option,
                    level->setting, 100.0 * level->bias, 100.0 * level->bias_noise, level->wall_s);
    neph_answer_add(answer,
                    "limit %.7g by order %g, observed order %.2f; %d steps measured in %s, "
                    "%dx%d pixels",
                    study->limit, study->order, study->observed_order, study->level_count,
                    shared->operands[1], shared->size.width_px, shared->size.height_px);
}

static enum neph_status list_scenes(struct request *request, struct neph_diag *diag)
{
    struct neph_cli_shared *shared = &request->shared;
    enum neph_status status = NEPH_OK;
    shared->json = false; /* --renew has no JSON output */
    if (shared->operand_count == 0) {
        status = neph_data_list_scenes(NEPH_DATA_CATALOG, &request->names, &shared->operand_count,
                                       diag);
        shared->operands = (const char *const *)request->names;
    }
    return status;
}

static enum neph_status make_job(struct request *request, struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &request->shared;
    const struct neph_engine *engine = neph_engine_find(shared->operands[0]);
    if (!engine || !engine->step.option) {
        neph_fail(diag, NEPH_ERR_USAGE,
                  engine ? "engine '%s' has no step to halve" : "there is no engine '%s'",
                  shared->operands[0]);
        neph_hint(diag, "cycles, povray and march have one");
        return NEPH_ERR_USAGE;
    }
    if (!neph_study_applies(engine, request->scene))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "scene %s has only homogeneous media: %s needs no steps there",
                         request->scene->name, engine->name);
    request->job = (struct neph_job){.engine = engine,
                                     .shot = {.scene = request->scene,
                                              .settings = neph_settings_default(engine),
                                              .layers = NEPH_LAYER_RADIANCE,
                                              .width_px = shared->size.width_px,
                                              .height_px = shared->size.height_px,
                                              .time_limit_s = shared->time_limit_s,
                                              .seed = 1}};
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < shared->settings.count && !status; i++)
        status = neph_settings_set(engine, &request->job.shot.settings, shared->settings.list[i],
                                   diag);
    return status;
}

static enum neph_status prepare(void *request_, struct neph_diag *diag)
{
    struct request *request = request_;
    if (request->renew)
        return list_scenes(request, diag);
    const enum neph_status status = neph_data_load_scene(request->shared.operands[1],
                                                         &request->scene, diag);
    return status ? status : make_job(request, diag);
}

static bool part(void *request_, int index)
{
    struct request *request = request_;
    struct neph_job job;
    request->is_part = true;
    request->part = index;
    return request->renew ? neph_cli_only_operand(&request->shared, index)
                          : neph_study_job(&request->job, index, &job);
}

static enum neph_status run_part(const struct request *request, struct neph_store *store,
                                 struct neph_diag *diag)
{
    struct neph_job job;
    struct neph_job_result result;
    neph_study_job(&request->job, request->part, &job);
    const enum neph_status status = neph_job_run(&job, store, &result, diag);
    neph_job_result_finish(&result);
    return status;
}

static enum neph_status run_study(const struct request *request, struct neph_store *store,
                                  struct neph_publication *publication, struct neph_diag *diag)
{
    struct neph_study study;
    enum neph_outcome outcome = NEPH_OUTCOME_RENDERED;
    char reason[1600] = "";
    enum neph_status status = neph_study_run(&request->job, store, &study, &outcome, reason, diag);
    if (!status)
        status = neph_outcome_check(outcome, reason, diag);
    if (status)
        return status;
    if (publication->text)
        print_study(&study, &request->shared, publication->text);
    answer_study(&study, &request->shared, &publication->answer);
    publication->json = neph_study_json(&study);
    return neph_json_check(publication->json, diag);
}

static enum neph_status no_steps(const struct neph_engine *engine,
                                 const struct neph_engine_info *info, struct neph_diag *diag)
{
    neph_fail(diag, NEPH_ERR_UNSUPPORTED,
              "%s takes no steps with these settings: %s renders "
              "volumes without them",
              engine->name, info->version);
    neph_hint(diag, "-s volume_biased=on has volumes marched in steps");
    return NEPH_ERR_UNSUPPORTED;
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    struct request *request = request_;
    const struct neph_cli_shared *shared = &request->shared;
    struct neph_engine_info info;
    if (request->renew)
        return neph_studies_renew(shared->operands, shared->operand_count, shared->time_limit_s,
                                  run->store, !request->is_part, run->quiet, diag);
    neph_engine_probe(request->job.engine, run->device, &info);
    if (info.available &&
        !neph_engine_has_steps(request->job.engine, &info, &request->job.shot.settings))
        return no_steps(request->job.engine, &info, diag);
    request->job.info = &info;
    request->job.shot.device = run->device;
    return request->is_part ? run_part(request, run->store, diag)
                            : run_study(request, run->store, publication, diag);
}

static void finish(void *request_)
{
    struct request *request = request_;
    neph_scene_destroy(request->scene);
    neph_data_free_names(request->names);
}

const struct neph_experiment neph_experiment_steps = {.syntax = &syntax,
                                                      .request_size = sizeof(struct request),
                                                      .prepare = prepare,
                                                      .part = part,
                                                      .run = run,
                                                      .finish = finish};
