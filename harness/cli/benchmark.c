/* SPDX-License-Identifier: MIT
 *
 * `neph benchmark SCENE`.
 */
#include "harness/cli/cli.h"

#include "base/threads.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/run/benchmark.h"
#include "scenes/bake.h"
#include "scenes/horizon.h"
#include "scenes/media.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared;
    const char *engines;
    double rung_s;
    int voxels;
};

static const struct neph_cli_option options[] = {
    {"engines", 'e', "A,B", "Engines, the first being the one that the others are measured by",
     NEPH_CLI_WORD, .at = offsetof(struct request, engines), .otherwise = "tracer,cycles"},
    {.name = "size", .otherwise = "96x54"},
    {"seconds", 0, "S", "About how long the last of four rungs takes, each half the one above it",
     NEPH_CLI_REAL, .at = offsetof(struct request, rung_s), .otherwise = "4", .minimum = 0.01,
     .maximum = 10000},
    {.name = "set",
     .argument = "ENGINE:KEY=VALUE",
     .help = "A setting of an engine; may be given several times"},
    {"voxels", 0, "N",
     "First turn every medium but fog into a voxel grid of N nodes along its longest side, so that "
     "all engines render the same one",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, voxels), .minimum = NEPH_BAKE_RESOLUTION_MIN,
     .maximum = NEPH_GRID_SIDE_MAX},
    {.name = "output", .help = "Folder for scratch files", .otherwise = "out"},
    {.name = "json"},
    {.name = "quiet"},
    {.name = NULL},
};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &neph_cli_one_scene,
    .doc = "How long engines take for the same noise, on the same cores in one run: noise^2 x time "
           "of each, and how many times the time of the first engine the others need.\v"
           "Noise is measured between two seeds, error against two independent references of the "
           "tracer, whose own noise so falls out. Time is rendering alone, each engine's start "
           "(kernels "
           "compiled, grids read) apart; starting Blender itself is in neither. Intervals hold 95 "
           "%, from the scatter of the four rungs; keep the machine "
           "quiet. The bias is what no time removes. The time to a stated error, bias "
           "included, is interpolated between rungs; where it lies off the ladder, that is "
           "said.\n\n"
           "Examples:\n"
           "  neph benchmark slab_multiple_thin\n"
           "  neph benchmark gaussian_blob --voxels 64 --seconds 10\n"
           "  neph benchmark voxel_grid -e tracer,oracle --json\n"
           "  neph benchmark height_fog_up --set cycles:step=0.1",
};

/* --- the scene ---------------------------------------------------------------------------- */

static enum neph_status to_voxels(struct neph_scene *scene, int resolution, struct neph_diag *diag)
{
    for (int m = 0; m < scene->medium_count; m++) {
        struct neph_medium *medium = &scene->media[m];
        if (neph_medium_is_fog(medium) || medium->grid)
            continue;
        const struct neph_bounds box = neph_medium_support(medium);
        struct neph_bake bake;
        const enum neph_status status = neph_medium_bake(medium, &box, resolution, &bake, diag);
        if (status)
            return status;
        const struct neph_medium baked = neph_medium_from_bake(medium, &bake);
        bake.grid = NULL; /* the scene's now */
        neph_bake_finish(&bake);
        neph_medium_finish(medium);
        *medium = baked;
    }
    return neph_scene_hash(scene, diag);
}

/* --- jobs --------------------------------------------------------------------------------- */

static enum neph_status fill_job(const char *name, const struct neph_scene *scene,
                                 const struct request *request, struct neph_engine_info *info,
                                 struct neph_job *job, struct neph_diag *diag)
{
    const struct neph_engine *engine = neph_engine_find(name);
    char reason[256];
    if (!engine) {
        neph_fail(diag, NEPH_ERR_USAGE, "there is no engine '%s'", name);
        neph_hint(diag, "`neph engines` lists them");
        return NEPH_ERR_USAGE;
    }
    if (!neph_benchmark_applies(engine, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_USAGE, "engine '%s' %s", name, reason);
    neph_engine_probe(engine, info);
    *job = (struct neph_job){.engine = engine,
                             .info = info,
                             .shot = {.scene = scene,
                                      .settings = neph_settings_default(engine),
                                      .layers = NEPH_LAYER_RADIANCE,
                                      .width_px = request->shared.size.width_px,
                                      .height_px = request->shared.size.height_px,
                                      .time_limit_s = 3600.0}};
    return NEPH_OK;
}

/* "cycles:step=0.1" */
static enum neph_status apply_setting(struct neph_benchmark *benchmark, const char *text,
                                      struct neph_diag *diag)
{
    const char *colon = strchr(text, ':');
    for (int e = 0; colon && e < benchmark->engine_count; e++) {
        struct neph_job *job = &benchmark->engines[e].job;
        const size_t length = strlen(job->engine->name);
        if ((size_t)(colon - text) == length && strncmp(text, job->engine->name, length) == 0)
            return neph_settings_set(job->engine, &job->shot.settings, colon + 1, diag);
    }
    return neph_fail(diag, NEPH_ERR_USAGE, "setting '%s': ENGINE:KEY=VALUE of one of the engines",
                     text);
}

static enum neph_status fill_benchmark(const struct request *request,
                                       const struct neph_scene *scene,
                                       struct neph_engine_info *infos,
                                       struct neph_benchmark *benchmark, struct neph_diag *diag)
{
    char names[256];
    snprintf(names, sizeof(names), "%s", request->engines);
    char *rest = names;
    enum neph_status status = fill_job("tracer", scene, request, &infos[NEPH_BENCHMARK_ENGINES_MAX],
                                       &benchmark->reference, diag);
    for (char *name = strsep(&rest, ","); name && !status; name = strsep(&rest, ",")) {
        const int e = benchmark->engine_count;
        if (e == NEPH_BENCHMARK_ENGINES_MAX)
            return neph_fail(diag, NEPH_ERR_USAGE, "more than %d engines",
                             NEPH_BENCHMARK_ENGINES_MAX);
        status = fill_job(name, scene, request, &infos[e], &benchmark->engines[e].job, diag);
        benchmark->engine_count++;
    }
    for (int i = 0; i < request->shared.settings.count && !status; i++)
        status = apply_setting(benchmark, request->shared.settings.list[i], diag);
    return status;
}

/* --- results ------------------------------------------------------------------------------ */

static void print_engine(const struct neph_benchmark_engine *engine)
{
    for (int k = 0; k < NEPH_BENCHMARK_RUNGS; k++) {
        const struct neph_benchmark_rung *rung = &engine->rungs[k];
        printf("%-8s %8d %10.3f %10.3f%% %10.3f%% %14.4g\n", engine->job.engine->name,
               rung->samples, rung->render_s, 100.0 * sqrt(rung->noise2),
               100.0 * sqrt(fmax(0.0, rung->error2)), rung->noise2 * rung->render_s);
    }
}

/* "3 % error in 1.2 s (beyond the ladder, extrapolated)"; of an engine after the first, how many
 * times the first one's time that is. */
static void print_rmse_time(const struct neph_rmse_time *time, const struct neph_rmse_time *first)
{
    static const char *const notes[] = {
        [NEPH_RMSE_WITHIN] = "",
        [NEPH_RMSE_BEFORE] = " (before the ladder, extrapolated)",
        [NEPH_RMSE_BEYOND] = " (beyond the ladder, extrapolated)",
        [NEPH_RMSE_NEVER] = " never: its bias is larger",
        [NEPH_RMSE_UNKNOWN] = " in a time that this ladder does not tell: take more --seconds"};
    printf("  %g %% error", 100.0 * time->rmse);
    if (!isnan(time->render_s))
        printf(" in %.4g s", time->render_s);
    printf("%s", notes[time->found]);
    if (time != first && !isnan(time->render_s / first->render_s))
        printf("; %.3g times the first engine's", time->render_s / first->render_s);
    printf("\n");
}

static void print_rmse_times(const struct neph_benchmark *benchmark, int e)
{
    const struct neph_benchmark_engine *engine = &benchmark->engines[e];
    for (int i = 0; i < NEPH_BENCHMARK_RMSES; i++)
        print_rmse_time(&engine->rmse_times[i], &benchmark->engines[0].rmse_times[i]);
    printf("  noise^2 falls as time^%.2f; bias^2 %.2g (%.2g..%.2g)\n", engine->law.slope,
           engine->law.bias2, engine->law.bias2_low, engine->law.bias2_high);
}

static void print_benchmark(const struct neph_benchmark *benchmark)
{
    const struct neph_shot *shot = &benchmark->reference.shot;
    printf("%s, %d x %d, %d cores; reference: tracer, 2 x %d samples, noise %.2g %%\n",
           shot->scene->name, shot->width_px, shot->height_px, neph_processor_count(),
           benchmark->reference_samples, 100.0 * benchmark->reference_noise);
    printf("%-8s %8s %10s %11s %11s %14s\n", "engine", "samples", "seconds", "noise", "error",
           "noise^2 x time");
    for (int e = 0; e < benchmark->engine_count; e++)
        print_engine(&benchmark->engines[e]);
    for (int e = 0; e < benchmark->engine_count; e++) {
        const struct neph_benchmark_engine *engine = &benchmark->engines[e];
        printf("%s: start %.2f s; noise^2 x time %.4g s (%.4g..%.4g); bias of the mean %+.2f %% "
               "(%+.2f..%+.2f)",
               engine->job.engine->name, engine->start_s, engine->cost_s.value, engine->cost_s.low,
               engine->cost_s.high, 100.0 * engine->bias.value, 100.0 * engine->bias.low,
               100.0 * engine->bias.high);
        if (e > 0)
            printf("; needs %.3g (%.3g..%.3g) times the time of %s for the same noise",
                   engine->times.value, engine->times.low, engine->times.high,
                   benchmark->engines[0].job.engine->name);
        printf("\n");
        print_rmse_times(benchmark, e);
    }
}

static void set_scratch(struct neph_benchmark *benchmark, const char *path)
{
    benchmark->reference.shot.scratch_directory = path;
    for (int e = 0; e < benchmark->engine_count; e++)
        benchmark->engines[e].job.shot.scratch_directory = path;
}

static enum neph_status run(const struct request *request, struct neph_scene *scene,
                            struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &request->shared;
    struct neph_benchmark benchmark = {.engine_count = 0};
    struct neph_engine_info infos[NEPH_BENCHMARK_ENGINES_MAX + 1];
    struct neph_scratch *scratch = NULL;
    enum neph_status status = fill_benchmark(request, scene, infos, &benchmark, diag);
    if (!status)
        status = neph_cli_open_folder(shared->output, diag);
    if (!status)
        status = neph_cli_begin_scratch(shared->output, &scratch, diag);
    if (!status)
        set_scratch(&benchmark, neph_scratch_path(scratch));
    if (!status)
        status = neph_benchmark_run(&benchmark, request->rung_s, shared->quiet || shared->json,
                                    diag);
    neph_cli_end_scratch(scratch, status, diag);
    if (status)
        return status;
    if (shared->json)
        return neph_cli_print_json(neph_benchmark_json(&benchmark), diag);
    print_benchmark(&benchmark);
    return NEPH_OK;
}

enum neph_status neph_cli_benchmark(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    struct neph_scene *scene = NULL;
    enum neph_status status = neph_data_load_scene(request.shared.operands[0], &scene, diag);
    if (!status && request.voxels > 0)
        status = to_voxels(scene, request.voxels, diag);
    if (!status)
        status = run(&request, scene, diag);
    neph_scene_destroy(scene);
    return status;
}
