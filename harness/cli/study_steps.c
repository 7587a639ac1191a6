/* SPDX-License-Identifier: MIT
 *
 * `neph study steps ENGINE SCENE`.
 */
#include "harness/cli/study.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/study/studies.h"
#include "harness/study/study.h"

#include <argp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { KEY_JSON = 1, KEY_RENEW, KEY_SIZE, KEY_SET, KEY_TIME_LIMIT, ASSIGNMENTS_MAX = 16 };

struct request {
    const char *engine, *scene, *size, *output, *time_limit;
    const char *assignments[ASSIGNMENTS_MAX];
    int assignment_count;
    bool json, renew;
};

static const struct argp_option options[] = {
    {"size", KEY_SIZE, "WxH", 0, "Size in pixels (default: 64x36)", 0},
    {"set", KEY_SET, "KEY=VALUE", 0, "Another setting of the engine; may be given several times",
     0},
    {"output", 'o', "DIR", 0, "Folder of the store (default: out)", 0},
    {"time-limit", KEY_TIME_LIMIT, "S", 0, "Seconds per child process (default: 300)", 0},
    {"renew", KEY_RENEW, NULL, 0,
     "Make the studies that come with neph (scenes/studies) where they are missing or of another "
     "version; of the whole catalogue, or of the scene given alone",
     0},
    {"json", KEY_JSON, NULL, 0, "The study as JSON on stdout", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct request *request = state->input;
    switch (key) {
    case KEY_JSON:
        request->json = true;
        return 0;
    case KEY_RENEW:
        request->renew = true;
        return 0;
    case KEY_SIZE:
        request->size = argument;
        return 0;
    case KEY_TIME_LIMIT:
        request->time_limit = argument;
        return 0;
    case 'o':
        request->output = neph_cli_output(state, "--output", argument);
        return 0;
    case KEY_SET:
        if (request->assignment_count == ASSIGNMENTS_MAX)
            argp_error(state, "more than %d settings", ASSIGNMENTS_MAX);
        request->assignments[request->assignment_count++] = argument;
        return 0;
    case ARGP_KEY_ARG:
        if (!request->engine)
            request->engine = argument;
        else if (!request->scene)
            request->scene = argument;
        else
            argp_error(state, "one engine and one scene, not '%s' as well", argument);
        return 0;
    case ARGP_KEY_END:
        if (request->renew && request->scene)
            argp_error(state, "--renew takes one scene at the most, and studies every engine");
        if (!request->renew && !request->scene)
            argp_error(state, "an engine and a scene are needed");
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

static const struct argp argp = {
    .options = options,
    .parser = parse,
    .args_doc = "ENGINE SCENE\n--renew [SCENE]",
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

static void print_study(const struct neph_study *study, const struct request *request)
{
    printf("%s in %s: mean radiance by %s, %s\n", request->engine, request->scene, study->option,
           request->size);
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

static enum neph_status prepare(const struct request *request, const struct neph_scene *scene,
                                struct neph_engine_info *info, struct neph_job *job,
                                struct neph_diag *diag)
{
    const struct neph_engine *engine = neph_engine_find(request->engine);
    int limit_s = 0;
    if (!engine || !engine->step.option) {
        neph_fail(diag, NEPH_ERR_USAGE,
                  engine ? "engine '%s' has no step to halve" : "there is no engine '%s'",
                  request->engine);
        neph_hint(diag, "cycles, povray and march have one");
        return NEPH_ERR_USAGE;
    }
    if (!neph_study_applies(engine, scene))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "scene %s holds homogeneous media alone: %s needs no steps there",
                         scene->name, engine->name);
    neph_engine_probe(engine, info);
    *job = (struct neph_job){.engine = engine,
                             .info = info,
                             .shot = {.scene = scene,
                                      .settings = neph_settings_default(engine),
                                      .layers = NEPH_LAYER_RADIANCE,
                                      .seed = 1}};
    enum neph_status status = neph_cli_parse_size(request->size, &job->shot.width_px,
                                                  &job->shot.height_px, diag);
    if (!status)
        status = neph_cli_parse_int("time limit", request->time_limit, 1, 1000000, &limit_s, diag);
    job->shot.time_limit_s = limit_s;
    for (int i = 0; i < request->assignment_count && !status; i++)
        status = neph_settings_set(engine, &job->shot.settings, request->assignments[i], diag);
    return status;
}

static enum neph_status run_study(const struct request *request, struct neph_store *store,
                                  struct neph_diag *diag)
{
    struct neph_scene *scene = NULL;
    struct neph_engine_info info;
    struct neph_job job;
    struct neph_study study;
    enum neph_outcome outcome = NEPH_OUTCOME_RENDERED;
    char reason[1600] = "";
    enum neph_status status = neph_data_load_scene(request->scene, &scene, diag);
    if (!status)
        status = prepare(request, scene, &info, &job, diag);
    if (!status)
        status = neph_study_run(&job, store, &study, &outcome, reason, diag);
    if (!status)
        status = neph_outcome_check(outcome, reason, diag);
    if (!status && request->json)
        status = neph_cli_print_json(neph_study_json(&study), diag);
    else if (!status)
        print_study(&study, request);
    neph_scene_destroy(scene);
    return status;
}

/* The only operand of --renew stands where the engine's name does else. */
static enum neph_status run_renewal(const struct request *request, struct neph_store *store,
                                    struct neph_diag *diag)
{
    char **names = NULL;
    int count = 0, limit_s = 0;
    enum neph_status status = neph_cli_parse_int("time limit", request->time_limit, 1, 1000000,
                                                 &limit_s, diag);
    if (!status && request->engine)
        return neph_studies_renew(&request->engine, 1, limit_s, store, false, diag);
    if (!status)
        status = neph_data_list_scenes(NEPH_DATA_CATALOG, &names, &count, diag);
    if (!status)
        status = neph_studies_renew((const char *const *)names, count, limit_s, store, false, diag);
    neph_data_free_names(names);
    return status;
}

enum neph_status neph_cli_study_steps(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {.size = "64x36", .output = "out", .time_limit = "300"};
    neph_cli_parse(&argp, argc, argv, &request);
    struct neph_store *store = NULL;
    char *folder = neph_path_join(request.output, "store");
    enum neph_status status = folder ? neph_cli_check_output("-o", request.output, diag)
                                     : neph_fail_memory(diag);
    if (!status)
        status = neph_store_open(folder, &store, diag);
    if (!status)
        status = request.renew ? run_renewal(&request, store, diag)
                               : run_study(&request, store, diag);
    neph_store_close(store);
    free(folder);
    return status;
}
