/* SPDX-License-Identifier: MIT
 *
 * `neph study steps ENGINE SCENE`.
 */
#include "harness/cli/study.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/engines/vulkan_device.h"
#include "harness/study/studies.h"
#include "harness/study/study.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_STUDY_VERDICT_COUNT == 3, "a new kind");

struct request {
    struct neph_cli_shared shared; /* operands: the engine and the scene */
    bool renew;                    /* at most the scene */
};

static const struct neph_cli_option options[] = {
    {.name = "size", .otherwise = "64x36"},
    {.name = "set", .help = "Another setting of the engine; may be given several times"},
    {.name = "output", .help = "Folder of the store", .otherwise = "out"},
    {.name = "time-limit", .otherwise = "300"},
    {"renew", 0, NULL,
     "Make the studies that come with neph (scenes/studies) where they are missing or of another "
     "version; of the whole catalogue, or of the scene given alone",
     NEPH_CLI_FLAG, .at = offsetof(struct request, renew)},
    {.name = "json"},
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
    .doc = "Halve the step of an engine that marches through uneven media until its bias is known: "
           "the mean radiance at each step, the bias against the extrapolated limit of infinitely "
           "small steps, and the coarsest setting that is good enough. Engines: cycles, povray, "
           "march.\v"
           "Step bias is not noise: more samples per pixel do not remove it. The limit is "
           "Richardson's "
           "extrapolation of the last two steps by the engine's known order; the observed order, "
           "where "
           "noise lets it be seen, says whether that was right.\n\n"
           "Examples:\n"
           "  neph study steps povray height_fog_up\n"
           "  neph study steps --renew\n"
           "  neph study steps cycles height_fog_down --size 96x54 --set samples=256 --json",
};

static void print_study(const struct neph_study *study, const struct neph_cli_shared *shared)
{
    printf("%s in %s: mean radiance by %s, %dx%d\n", shared->operands[0], shared->operands[1],
           study->option, shared->size.width_px, shared->size.height_px);
    printf("%12s %14s %10s %12s %10s %9s\n", study->option, "radiance", "noise", "bias", "noise",
           "seconds");
    for (int i = 0; i < study->level_count; i++) {
        const struct neph_study_level *level = &study->levels[i];
        printf("%12.5g %14.7g %10.1e %+11.4f%% %9.4f%% %9.2f%s\n", level->setting, level->radiance,
               level->noise, 100.0 * level->bias, 100.0 * level->bias_noise, level->wall_s,
               i == study->chosen ? "  <- chosen" : "");
    }
    printf("limit %.7g by order %g", study->limit, study->order);
    if (isfinite(study->observed_order))
        printf("; observed order %.2f", study->observed_order);
    static const char *const sentences[] = {
        [NEPH_STUDY_WITHIN] = "the chosen setting is within 0.1 % of the limit, noise included",
        [NEPH_STUDY_NOISE] = "noise hides whether any setting is within 0.1 %: the coarsest whose "
                             "bias cannot be told from 0 is chosen",
        [NEPH_STUDY_OFF] = "even the finest setting is off by more than 0.1 %, or its error does "
                           "not shrink by the order that the limit assumes: take the bias as a "
                           "guess, and smaller steps by hand",
    };
    printf("\n%s\n", sentences[study->verdict]);
}

static enum neph_status prepare(const struct neph_cli_shared *shared,
                                const struct neph_scene *scene, struct neph_shared_device *device,
                                struct neph_engine_info *info, struct neph_job *job,
                                struct neph_diag *diag)
{
    const struct neph_engine *engine = neph_engine_find(shared->operands[0]);
    if (!engine || !engine->step.option) {
        neph_fail(diag, NEPH_ERR_USAGE,
                  engine ? "engine '%s' has no step to halve" : "there is no engine '%s'",
                  shared->operands[0]);
        neph_hint(diag, "cycles, povray and march have one");
        return NEPH_ERR_USAGE;
    }
    if (!neph_study_applies(engine, scene))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "scene %s holds homogeneous media alone: %s needs no steps there",
                         scene->name, engine->name);
    neph_engine_probe(engine, device, info);
    *job = (struct neph_job){.engine = engine,
                             .info = info,
                             .shot = {.scene = scene,
                                      .settings = neph_settings_default(engine),
                                      .layers = NEPH_LAYER_RADIANCE,
                                      .width_px = shared->size.width_px,
                                      .height_px = shared->size.height_px,
                                      .time_limit_s = shared->time_limit_s,
                                      .device = device,
                                      .seed = 1}};
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < shared->settings.count && !status; i++)
        status = neph_settings_set(engine, &job->shot.settings, shared->settings.list[i], diag);
    return status;
}

static enum neph_status run_study(const struct neph_cli_shared *shared, struct neph_store *store,
                                  struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    struct neph_shared_device device = {.open = NULL};
    struct neph_engine_info info;
    struct neph_job job;
    struct neph_study study;
    enum neph_outcome outcome = NEPH_OUTCOME_RENDERED;
    char reason[1600] = "";
    enum neph_status status = neph_data_load_scene(shared->operands[1], &scene, diag);
    if (!status)
        status = prepare(shared, scene, &device, &info, &job, diag);
    if (!status)
        status = neph_study_run(&job, store, &study, &outcome, reason, diag);
    if (!status)
        status = neph_outcome_check(outcome, reason, diag);
    if (!status && shared->json)
        status = neph_json_print(neph_study_json(&study), diag);
    else if (!status)
        print_study(&study, shared);
    neph_shared_device_close(&device);
    neph_scene_destroy(scene);
    return status;
}

static enum neph_status run_renewal(const struct neph_cli_shared *shared, struct neph_store *store,
                                    struct neph_diag *diag)
{
    char **names = NULL;
    int count = 0;
    if (shared->operand_count > 0)
        return neph_studies_renew(shared->operands, 1, shared->time_limit_s, store, false, diag);
    enum neph_status status = neph_data_list_scenes(NEPH_DATA_CATALOG, &names, &count, diag);
    if (!status)
        status = neph_studies_renew((const char *const *)names, count, shared->time_limit_s, store,
                                    false, diag);
    neph_data_free_names(names);
    return status;
}

enum neph_status neph_cli_study_steps(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    struct neph_store *store = NULL;
    char *folder = neph_path_join(request.shared.output, "store");
    enum neph_status status = folder ? neph_store_open(folder, &store, diag)
                                     : neph_fail_memory(diag);
    if (!status)
        status = request.renew ? run_renewal(&request.shared, store, diag)
                               : run_study(&request.shared, store, diag);
    neph_store_close(store);
    free(folder);
    return status;
}
