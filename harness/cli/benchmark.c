/* SPDX-License-Identifier: MIT
 *
 * `neph benchmark SCENE`.
 */
#include "harness/cli/cli.h"

#include "base/threads.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/experiment/experiment.h"
#include "harness/progress.h"
#include "harness/run/benchmark_answer.h"
#include "renderer/shortcuts.h"
#include "scenes/bake.h"
#include "scenes/display.h"
#include "scenes/horizon.h"
#include "scenes/media.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_RMSE_FOUND_COUNT == 5, "a new kind");

struct request {
    struct neph_cli_shared shared;
    const char *preset, *chain;
    struct neph_cli_list engines;
    double rung_s, error;   /* NaN: not given */
    int repeat, resolution; /* -1: not given */
    bool without_ceilings;
    struct neph_scene *scene;
    struct both *both;
};

enum { ENGINES_MAX = NEPH_BENCHMARK_ENGINES_MAX + NEPH_BENCHMARK_FRAMES_ENGINES_MAX };

/* A requested engine that cannot render the scene. */
struct left_out {
    const char *engine;
    struct neph_diag why;
};

/* Two kinds of engines: those with noise, and those with frames in flight. */
struct both {
    struct neph_benchmark noise;
    struct neph_benchmark_frames frames;
    struct neph_showing showing; /* the post-processing of the frames, with --chain */
    struct neph_engine_info noise_infos[NEPH_BENCHMARK_ENGINES_MAX + 1];
    struct neph_engine_info frame_infos[NEPH_BENCHMARK_FRAMES_ENGINES_MAX];
    int left_out_count;
    struct left_out left_out[ENGINES_MAX];
};

static const struct neph_cli_option options[] = {
    {"engine", 0, NULL,
     "Engines; of those with noise the first is the one that the others are measured by (default: "
     "tracer and the Cycles of each Blender)",
     NEPH_CLI_NAMES, .at = offsetof(struct request, engines)},
    {"repeat", 0, NULL,
     "Number of timed frames of march*, realtime and screen, within 10 s (default: 200)",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, repeat), .minimum = 1,
     .maximum = NEPH_BENCHMARK_FRAMES_MAX},
    {"preset", 0, NULL, "Engines realtime and screen: a set of settings by name, before any --set",
     NEPH_CLI_ONE, .at = offsetof(struct request, preset)},
    {"chain", 0, NULL,
     "Time this post-processing chain after their frames, in place of the scene's; off: none",
     NEPH_CLI_WORD, .at = offsetof(struct request, chain)},
    {.name = "size", .otherwise = "192x108"},
    {"seconds", 0, "S",
     "About how long the last of four rungs takes, each half the one above it (default: 4)",
     NEPH_CLI_REAL, .at = offsetof(struct request, rung_s), .minimum = 0.01, .maximum = 10000},
    {"error", 0, NULL,
     "In place of --seconds: rungs of each engine up to this relative RMSE, from three times it on",
     NEPH_CLI_REAL, .at = offsetof(struct request, error), .minimum = 1e-4, .maximum = 1.0},
    {.name = "set",
     .argument = "ENGINE:KEY=VALUE",
     .help = "A setting of an engine; may be given several times"},
    {"resolution", 0, NULL,
     "First turn every medium but fog into a voxel grid of N nodes along its longest side, so that "
     "all engines render the same one",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, resolution),
     .minimum = NEPH_BAKE_RESOLUTION_MIN, .maximum = NEPH_GRID_SIDE_MAX},
    {"no-ceilings", 0, NULL,
     "Do not measure the limits of the device, which takes 15 s on a GPU: no shares of them",
     NEPH_CLI_FLAG, .at = offsetof(struct request, without_ceilings)},
    {.name = "blender"},
    {.name = "output", .help = "Folder for scratch files", .otherwise = "out/benchmark"},
    {.name = "all", .help = "All measurements, passes and shares of the device's limits"},
    {.name = "json"},
    {.name = "quiet"},
    {.name = NULL},
};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &neph_cli_one_scene,
    .doc = "Measure how long engines take, and say which is faster and by how much.\v"
           "Engines with noise (tracer, oracle, cycles): the time to the same noise, on the same "
           "cores in one run, and how many times as long the others take as the first. Noise is "
           "measured between two seeds; error is measured against two independent references of "
           "the tracer, so that the noise of the references cancels. Time is rendering only: the "
           "start of an engine (kernels compiled, grids read) is a number of its own, and starting "
           "Blender is in neither. Intervals are 95 %, from the scatter of the four rungs: keep "
           "the machine quiet. The time to a stated error, bias included, is interpolated between "
           "rungs. With --error each engine gets more samples until it reaches that error, however "
           "long that takes.\n\n"
           "Engines march*, realtime and screen: frames in flight one after the other (screen "
           "waits for each), without reading them back, after a second of warm-up: median, 10 % "
           "and 90 % of the time of a frame and of its passes on the device; the error (rel_rmse "
           "against the ray marcher with the same lighting at its defaults); and the share of the "
           "device's limits that each pass reaches: bytes copied, or voxel grid samples from a "
           "buffer or from the texture unit, measured in the same run. With a post-processing "
           "chain (display.chain of the scene, or --chain) --size is the size of the display, and "
           "each stage has a line in --all.\n\n"
           "Examples:\n"
           "  neph benchmark slab_multiple_thin\n"
           "  neph benchmark gaussian_blob --resolution 64 --seconds 10\n"
           "  neph benchmark grid_cloud_multiple --error 0.01 --size 48x27\n"
           "  neph benchmark voxel_grid -e tracer,oracle --json\n"
           "  neph benchmark height_fog_up --set cycles:step=0.1\n"
           "  neph benchmark cloud_below -e march_octaves,realtime -p ours --all\n"
           "  neph benchmark surface_rough -e screen -p fast --size 640x360",
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
        const enum neph_status status = neph_medium_sample(medium, &box, resolution, &bake, diag);
        if (status)
            return status;
        const struct neph_medium baked = neph_medium_from_bake(medium, &bake);
        bake.grid = NULL; /* now owned by the scene */
        neph_bake_finish(&bake);
        neph_medium_finish(medium);
        *medium = baked;
    }
    return neph_scene_hash(scene, diag);
}

/* --- jobs --------------------------------------------------------------------------------- */

/* Everything of a job but its preset and settings. */
static void fill_job(const struct neph_engine *engine, const struct request *request,
                     struct neph_shared_device *device, struct neph_engine_info *info,
                     struct neph_job *job)
{
    neph_engine_probe(engine, device, info);
    *job = (struct neph_job){.engine = engine,
                             .info = info,
                             .shot = {.scene = request->scene,
                                      .settings = neph_settings_default(engine),
                                      .layers = NEPH_LAYER_RADIANCE,
                                      .width_px = request->shared.size.width_px,
                                      .height_px = request->shared.size.height_px,
                                      .time_limit_s = 3600.0,
                                      .device = device}};
}

/* Add an engine to the benchmark of its kind, with its job. */
static enum neph_status add_engine(const char *name, const struct request *request,
                                   struct neph_shared_device *device, struct neph_diag *diag)
{
    struct both *both = request->both;
    const struct neph_engine *engine = neph_engine_find(name);
    char reason[256];
    if (!engine) {
        neph_fail(diag, NEPH_ERR_USAGE, "there is no engine '%s'", name);
        neph_hint(diag, "`neph engines` lists them");
        return NEPH_ERR_USAGE;
    }
    const bool flies = neph_flight_applies(engine);
    if (!flies && !neph_benchmark_applies(engine, reason, sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_USAGE, "engine '%s' %s", name, reason);
    int *count = flies ? &both->frames.engine_count : &both->noise.engine_count;
    const int most = flies ? NEPH_BENCHMARK_FRAMES_ENGINES_MAX : NEPH_BENCHMARK_ENGINES_MAX;
    if (*count == most)
        return neph_fail(diag, NEPH_ERR_USAGE, "more than %d engines %s", most,
                         flies ? "with frames in flight" : "with noise");
    const int e = (*count)++;
    struct neph_job *job = flies ? &both->frames.engines[e].job : &both->noise.engines[e].job;
    fill_job(engine, request, device, flies ? &both->frame_infos[e] : &both->noise_infos[e], job);
    const char *preset = engine->presets ? request->preset : NULL;
    *(flies ? &both->frames.engines[e].preset
            : &both->noise.engines[e].preset) = neph_settings_origin(engine, preset);
    return preset ? neph_settings_preset(engine, preset, &job->shot.settings, diag) : NEPH_OK;
}

static enum neph_status apply_setting(struct both *both, const char *text, struct neph_diag *diag)
{
    for (int e = 0; e < both->noise.engine_count + both->frames.engine_count; e++) {
        const int f = e - both->noise.engine_count;
        struct neph_job *job = f < 0 ? &both->noise.engines[e].job : &both->frames.engines[f].job;
        const char *assignment = neph_settings_for(job->engine, text);
        if (assignment)
            return neph_settings_set(job->engine, &job->shot.settings, assignment, diag);
    }
    return neph_fail(diag, NEPH_ERR_USAGE, "setting '%s': ENGINE:KEY=VALUE of one of the engines",
                     text);
}

/* Whether an engine stays in the benchmark. An engine that cannot render the scene is noted in
 * `left_out`; any other error ends the benchmark through `*status`. */
static bool can_go_on(const struct neph_job *job, struct both *both, enum neph_status *status,
                      struct neph_diag *diag)
{
    struct neph_diag why = {.line = 0};
    if (*status)
        return false;
    *status = neph_job_explain(job, neph_job_check(job, &why), &why);
    if (*status == NEPH_ERR_UNSUPPORTED) {
        const char *lighting = neph_engine_other_lighting(job->engine, job->shot.scene,
                                                          &job->shot.settings);
        if (lighting)
            neph_hint(&why, "-s %s:lighting=%s", job->engine->name, lighting);
        both->left_out[both->left_out_count++] = (struct left_out){job->engine->name, why};
        *status = NEPH_OK;
        return false;
    }
    if (*status)
        *diag = why;
    return !*status;
}

/* Remove the engines that cannot render the scene. NEPH_ERR_UNSUPPORTED: none is left. */
static enum neph_status leave_out(struct both *both, struct neph_diag *diag)
{
    struct neph_benchmark_engine *noise = both->noise.engines;
    struct neph_benchmark_frames_engine *frames = both->frames.engines;
    int noisy = 0, flying = 0;
    enum neph_status status = NEPH_OK;
    for (int e = 0; e < both->noise.engine_count; e++)
        if (can_go_on(&noise[e].job, both, &status, diag))
            noise[noisy++] = noise[e];
    for (int e = 0; e < both->frames.engine_count; e++)
        if (can_go_on(&frames[e].job, both, &status, diag))
            frames[flying++] = frames[e];
    both->noise.engine_count = noisy;
    both->frames.engine_count = flying;
    if (status || noisy + flying > 0)
        return status;
    *diag = both->left_out[0].why;
    return NEPH_ERR_UNSUPPORTED;
}

static bool any_has_presets(const struct both *both)
{
    bool any = false;
    for (int e = 0; e < both->noise.engine_count; e++)
        any |= both->noise.engines[e].job.engine->presets != NULL;
    for (int e = 0; e < both->frames.engine_count; e++)
        any |= both->frames.engines[e].job.engine->presets != NULL;
    return any;
}

/* Load the chain, and reduce the frames to the size that its upscaling stage expects. */
static enum neph_status find_chain(const struct request *request, struct neph_diag *diag)
{
    struct both *both = request->both;
    const char *path = request->chain ? request->chain : neph_scene_display(request->scene)->chain;
    if (!path || strcmp(path, "off") == 0 || (both->frames.engine_count == 0 && !request->chain))
        return NEPH_OK;
    if (both->frames.engine_count == 0)
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "--chain=%s: none of the engines can have frames in flight", path);
    both->showing.scene = request->scene;
    both->frames.showing = &both->showing;
    enum neph_status status = neph_showing_load(&both->showing, path, diag);
    if (!status)
        status = neph_showing_check(&both->showing, diag);
    if (!status)
        status = neph_showing_check_size(&both->showing, diag);
    both->showing.params.width_px = request->shared.size.width_px;
    both->showing.params.height_px = request->shared.size.height_px;
    for (int e = 0; e < both->frames.engine_count && !status; e++) {
        struct neph_shot *shot = &both->frames.engines[e].job.shot;
        neph_post_frame_size(both->showing.params.order, &both->showing.settings, &shot->width_px,
                             &shot->height_px);
    }
    return status;
}

/* The default engines: the tracer, and as many Blender installations as fit. */
static int list_default(const char *names[NEPH_ENGINE_COUNT])
{
    int count, listed = 0;
    const struct neph_engine *const *engines = neph_engines(&count);
    names[listed++] = "tracer";
    for (int i = 0; i < count && listed < NEPH_BENCHMARK_ENGINES_MAX; i++)
        if (neph_engine_is(engines[i], "cycles"))
            names[listed++] = engines[i]->name;
    return listed;
}

static enum neph_status fill_both(const struct request *request, struct neph_shared_device *device,
                                  struct neph_diag *diag)
{
    struct both *both = request->both;
    const char *engines[NEPH_ENGINE_COUNT];
    int count = request->engines.count;
    if (count == 0)
        count = list_default(engines);
    const char *const *names = request->engines.count > 0 ? request->engines.words : engines;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && !status; i++)
        status = add_engine(names[i], request, device, diag);
    if (!status && request->preset && !any_has_presets(both))
        status = neph_fail(diag, NEPH_ERR_USAGE, "preset '%s': none of the engines has presets",
                           request->preset);
    for (int i = 0; i < request->shared.settings.count && !status; i++)
        status = apply_setting(both, request->shared.settings.list[i], diag);
    if (!status)
        status = leave_out(both, diag);
    if (!status)
        status = find_chain(request, diag);
    if (!status)
        fill_job(neph_engine_find("tracer"), request, device,
                 &both->noise_infos[NEPH_BENCHMARK_ENGINES_MAX], &both->noise.reference);
    return status;
}

/* --- results ------------------------------------------------------------------------------ */

/* Print "settings: preset ours, steps=8" or "settings: defaults": the preset and the differences
 * from it. */
static void print_settings(const struct neph_job *job, const char *preset, FILE *out)
{
    char *changes = neph_settings_changes(job->engine, &job->shot.settings, preset);
    fprintf(out, "settings: %s%s%s%s\n", preset ? "preset " : "defaults", preset ? preset : "",
            changes && changes[0] ? ", " : "", changes ? changes : "");
    free(changes);
}

static void print_engine(const struct neph_benchmark_engine *engine, FILE *out)
{
    for (int k = 0; k < NEPH_BENCHMARK_RUNGS; k++) {
        const struct neph_rmse_rung *rung = &engine->rungs[k];
        fprintf(out, "%-8s %8d %10.3f %10.3g %10.3f%% %10.3f%% %14.4g\n", engine->job.engine->name,
                rung->samples, rung->render_s, 1e-6 * neph_benchmark_paths_per_s(engine, k),
                100.0 * sqrt(rung->noise2), 100.0 * sqrt(fmax(0.0, rung->error2)),
                rung->noise2 * rung->render_s);
    }
}

/* Print "3 % error in 1.2 s (beyond the ladder, extrapolated)"; for an engine after the first, also
 * the ratio of its time to the time of the first engine. */
static void print_rmse_time(const struct neph_rmse_time *time, const struct neph_rmse_time *first,
                            FILE *out)
{
    static const char *const notes[] = {
        [NEPH_RMSE_WITHIN] = "",
        [NEPH_RMSE_BEFORE] = " (before the ladder, extrapolated)",
        [NEPH_RMSE_BEYOND] = " (beyond the ladder, extrapolated)",
        [NEPH_RMSE_NEVER] = " never: it and the references part by more than that",
        [NEPH_RMSE_UNKNOWN] =
            " in a time that this ladder does not tell: take more --seconds, or --error"};
    fprintf(out, "  %g %% error", 100.0 * time->rmse);
    if (!isnan(time->render_s))
        fprintf(out, " in %.4g s", time->render_s);
    fprintf(out, "%s", notes[time->found]);
    if (time != first && !isnan(time->render_s / first->render_s))
        fprintf(out, "; %.3g times the first engine's", time->render_s / first->render_s);
    fprintf(out, "\n");
}

static void print_rmse_times(const struct neph_benchmark *benchmark, int e, FILE *out)
{
    const struct neph_benchmark_engine *engine = &benchmark->engines[e];
    for (int i = 0; i < NEPH_BENCHMARK_RMSES; i++)
        print_rmse_time(&engine->rmse_times[i], &benchmark->engines[0].rmse_times[i], out);
    if (isfinite(engine->law.slope))
        fprintf(out, "  noise^2 falls as time^%.2f; ", engine->law.slope);
    else
        fprintf(out, "  all rungs took the same time; ");
    fprintf(out, "bias^2 %.2g (%.2g..%.2g)\n", engine->law.bias2, engine->law.bias2_low,
            engine->law.bias2_high);
}

static void print_benchmark(const struct neph_benchmark *benchmark, FILE *out)
{
    const struct neph_shot *shot = &benchmark->reference.shot;
    fprintf(out, "%s, %d x %d, %d cores; reference: tracer, 2 x %d samples, noise %.2g %%\n",
            shot->scene->name, shot->width_px, shot->height_px, neph_processor_count(),
            benchmark->reference_samples, 100.0 * benchmark->reference_noise);
    for (int e = 0; e < benchmark->engine_count; e++) {
        const struct neph_job *job = &benchmark->engines[e].job;
        fprintf(out, "%s: %s; %s; ", job->engine->name, job->info->device, job->info->version);
        print_settings(job, benchmark->engines[e].preset, out);
    }
    fprintf(out, "%-8s %8s %10s %10s %11s %11s %14s\n", "engine", "samples", "seconds", "M paths/s",
            "noise", "error", "noise^2 x time");
    for (int e = 0; e < benchmark->engine_count; e++)
        print_engine(&benchmark->engines[e], out);
    for (int e = 0; e < benchmark->engine_count; e++) {
        const struct neph_benchmark_engine *engine = &benchmark->engines[e];
        fprintf(out,
                "%s: start %.2f s; noise^2 x time %.4g s (%.4g..%.4g); bias of the mean %+.2f %% "
                "(%+.2f..%+.2f)",
                engine->job.engine->name, engine->start_s, engine->cost_s.value, engine->cost_s.low,
                engine->cost_s.high, 100.0 * engine->bias.value, 100.0 * engine->bias.low,
                100.0 * engine->bias.high);
        if (e > 0)
            fprintf(out, "; needs %.3g (%.3g..%.3g) times the time of %s for the same noise",
                    engine->times.value, engine->times.low, engine->times.high,
                    benchmark->engines[0].job.engine->name);
        fprintf(out, "\n");
        print_rmse_times(benchmark, e, out);
    }
}

/* --- results of frames in flight ------------------------------------------------------------ */

static void print_times(const char *name, struct neph_spread s, const char *end, FILE *out)
{
    fprintf(out, "  %-20s %10.3f %10.3f %10.3f%s", name, 1e3 * s.median, 1e3 * s.low, 1e3 * s.high,
            end);
}

static void print_pass(const struct neph_benchmark_frames *benchmark,
                       const struct neph_benchmark_frames_engine *engine,
                       const struct neph_benchmark_pass *pass, FILE *out)
{
    const char *limit;
    const double share = neph_benchmark_share(benchmark, engine, pass, &limit);
    const struct neph_benchmark_evaluation one = neph_benchmark_evaluation(benchmark, engine, pass);
    print_times(pass->name, pass->gpu_s, "", out);
    if (isfinite(pass->traffic_bytes))
        fprintf(out, "  %.4g MB", 1e-6 * pass->traffic_bytes);
    if (isfinite(pass->variant_gain))
        fprintf(out, "  %.3g times as fast as its readable shader", pass->variant_gain);
    if (isfinite(pass->density_evaluations))
        fprintf(out, "  %.4g M evaluations%s%s, %.4g M/s", 1e-6 * pass->density_evaluations,
                pass->with[0] ? " with " : "", pass->with,
                1e-6 * pass->density_evaluations / pass->evaluation_s);
    if (isfinite(share))
        fprintf(out, "  %.2g %% of the ceiling of %s", 100.0 * share, limit);
    if (isfinite(one.chain_share))
        fprintf(out, ", %.2g %% of those that wait for each other", 100.0 * one.chain_share);
    if (isfinite(one.multiply_adds))
        fprintf(out, "; one takes as long as %.3g multiply-adds", one.multiply_adds);
    fprintf(out, "\n");
}

static void print_chain(const struct neph_post_params *params,
                        const struct neph_benchmark_frames_engine *engine, FILE *out)
{
    const struct neph_post_stage *stages[NEPH_POST_STAGES_MAX];
    const int count = neph_post_sequence(params->order, &params->settings, stages);
    fprintf(out, "  to the display, %d times; least %.3f ms\n", engine->chain.count,
            1e3 * engine->chain.all.least_s);
    print_times("all stages", engine->chain.all.spread_s, "\n", out);
    for (int i = 0; i < count; i++)
        print_times(stages[i]->name, engine->chain.stages[stages[i] - neph_post_stages].spread_s,
                    "\n", out);
}

/* A median may mix frames rendered before and after the scene is known to be static: print that. */
static void print_steady(const struct neph_benchmark_frames_engine *engine, FILE *out)
{
    if (engine->steady_from == 0)
        fprintf(out, "  the scene was known to be static: these are frames with reused results\n");
    else if (engine->steady_from > 0)
        fprintf(out,
                "  of two kinds: results are reused from frame %d on, when the scene was known to "
                "be static\n",
                engine->steady_from + 1);
}

static void print_flight(const struct neph_benchmark_frames *benchmark,
                         const struct neph_benchmark_frames_engine *engine, FILE *out)
{
    fprintf(out, "%s: %d frames, %.4g a second with an error of %.3g %% of %s\n",
            engine->job.engine->name, engine->frame_count, 1.0 / engine->mean_s,
            100.0 * engine->error, engine->reference->name);
    fprintf(out, "  %-20s %10s %10s %10s\n", "[ms]", "median", "10 %", "90 %");
    print_times("frame to frame", engine->frame_s, "\n", out);
    print_times("on the device", engine->gpu_s, "\n", out);
    print_times("until it is sent", engine->cpu_s, "\n", out);
    for (int p = 0; p < engine->pass_count; p++)
        print_pass(benchmark, engine, &engine->passes[p], out);
    if (benchmark->showing)
        print_chain(&benchmark->showing->params, engine, out);
    print_steady(engine, out);
    fprintf(out, "  first frame after %.3g s; %.4g MB of the device's memory; ", engine->first_s,
            1e-6 * (double)engine->device_bytes);
    print_settings(&engine->job, engine->preset, out);
}

static void print_ceilings(const struct neph_ceilings *ceilings, FILE *out)
{
    fprintf(out,
            "ceilings: copies %.4g GB/s (2 x %zu MiB), buffer samples %.4g G/s, waiting for each "
            "other %.4g (grid of %d^3)",
            1e-9 * ceilings->copy_bytes_per_s, ceilings->copy_bytes >> 20,
            1e-9 * ceilings->buffer_samples_per_s, 1e-9 * ceilings->buffer_chain_per_s,
            ceilings->grid_side);
    for (int f = 0; f < NEPH_TEXEL_FORMAT_COUNT; f++)
        if (isfinite(ceilings->texture_samples_per_s[f]))
            fprintf(out, ", %s texture samples %.4g G/s, waiting %.4g", neph_texel_formats[f],
                    1e-9 * ceilings->texture_samples_per_s[f],
                    1e-9 * ceilings->texture_chain_per_s[f]);
    fprintf(out, ", multiply-adds %.4g G/s, exponentials %.4g G/s\n",
            1e-9 * ceilings->multiply_adds_per_s, 1e-9 * ceilings->exponentials_per_s);
}

static void print_frames(const struct neph_benchmark_frames *benchmark, FILE *out)
{
    const struct neph_job *job = &benchmark->engines[0].job;
    fprintf(out, "%s, %d x %d; %s; %s; ", job->shot.scene->name, job->shot.width_px,
            job->shot.height_px, job->info->device, job->info->version);
    if (benchmark->thread_count > 0)
        fprintf(out, "%d threads; ", benchmark->thread_count);
    if (isfinite(benchmark->cpu_clock_hz))
        fprintf(out, "clock %.3g GHz\n", 1e-9 * benchmark->cpu_clock_hz);
    else
        fprintf(out, "clock not known%s\n",
                benchmark->without_ceilings ? "" : ", multiply-adds are its measure");
    if (!benchmark->without_ceilings)
        print_ceilings(&benchmark->ceilings, out);
    for (int e = 0; e < benchmark->engine_count; e++)
        print_flight(benchmark, &benchmark->engines[e], out);
}

static void print_left_out(const struct both *both, FILE *out)
{
    for (int i = 0; i < both->left_out_count; i++) {
        const struct neph_diag *why = &both->left_out[i].why;
        fprintf(out, "%s%s%s\n", why->message, why->hint[0] ? "; " : "", why->hint);
    }
}

static json_t *left_out_json(const struct both *both)
{
    json_t *list = json_array();
    for (int i = 0; i < both->left_out_count; i++) {
        const struct left_out *out = &both->left_out[i];
        neph_json_add(&list, json_pack("{s:s, s:s, s:s}", "engine", out->engine, "reason",
                                       out->why.message, "hint", out->why.hint));
    }
    return list;
}

/* --- running ------------------------------------------------------------------------------ */

static void set_scratch(struct both *both, const char *path)
{
    both->noise.reference.shot.scratch_directory = path;
    for (int e = 0; e < both->noise.engine_count; e++)
        both->noise.engines[e].job.shot.scratch_directory = path;
    for (int e = 0; e < both->frames.engine_count; e++)
        both->frames.engines[e].job.shot.scratch_directory = path;
}

/* One JSON document for each kind; an object of both if there are both. */
static json_t *json_of(const struct both *both)
{
    const bool has_noise = both->noise.engine_count > 0, has_frames = both->frames.engine_count > 0;
    json_t *noise = has_noise ? neph_benchmark_json(&both->noise) : NULL,
           *json = has_frames ? neph_benchmark_frames_json(&both->frames) : noise;
    if (has_noise && has_frames)
        json = json_pack("{s:s, s:o, s:o}", "format", "neph-benchmark-both-1", "frames", json,
                         "noise", noise);
    neph_json_set(&json, "cannot", left_out_json(both));
    return json;
}

static struct neph_rungs_aim aim_of(const struct request *request)
{
    static const double usual_rung_s = 4.0;
    if (!isnan(request->error))
        return (struct neph_rungs_aim){.error = request->error};
    return (struct neph_rungs_aim){.rung_s = isnan(request->rung_s) ? usual_rung_s
                                                                    : request->rung_s};
}

/* Warn about options that apply to no requested engine. */
static void warn_of_idle(const struct request *request, const struct both *both)
{
    if (both->noise.engine_count == 0 && !(isnan(request->error) && isnan(request->rung_s)))
        neph_progress_warn("--%s has no effect: none of the engines has noise",
                           isnan(request->error) ? "seconds" : "error");
    if (both->frames.engine_count == 0 && request->repeat > 0)
        neph_progress_warn("--repeat has no effect: none of the engines can have frames in flight");
}

static enum neph_status measure(const struct request *request, struct neph_diag *diag)
{
    static const int usual_frame_count = 200;
    struct both *both = request->both;
    const bool quiet = request->shared.quiet || request->shared.json;
    enum neph_status status = NEPH_OK;
    warn_of_idle(request, both);
    both->frames.without_ceilings = request->without_ceilings;
    both->noise.aim = aim_of(request);
    if (both->frames.engine_count > 0)
        status = neph_benchmark_frames_run(
            &both->frames, request->repeat > 0 ? request->repeat : usual_frame_count, quiet, diag);
    if (!status && both->noise.engine_count > 0)
        status = neph_benchmark_run(&both->noise, quiet, diag);
    return status;
}

static void print(const struct both *both, FILE *out)
{
    if (both->frames.engine_count > 0)
        print_frames(&both->frames, out);
    if (both->noise.engine_count > 0)
        print_benchmark(&both->noise, out);
    print_left_out(both, out);
}

static void answer(const struct both *both, struct neph_answer *answer)
{
    neph_benchmark_frames_answer(&both->frames, answer);
    neph_benchmark_answer(&both->noise, answer);
    for (int i = 0; i < both->left_out_count; i++)
        neph_answer_add(answer, "left out: %s", both->left_out[i].why.message);
}

static enum neph_status prepare(void *request_, struct neph_diag *diag)
{
    struct request *request = request_;
    if (!isnan(request->error) && !isnan(request->rung_s))
        return neph_fail(diag, NEPH_ERR_USAGE, "--seconds and --error: one of them ends a ladder");
    request->both = calloc(1, sizeof(*request->both));
    if (!request->both)
        return neph_fail_memory(diag);
    const enum neph_status status = neph_data_load_scene(request->shared.operands[0],
                                                         &request->scene, diag);
    return status || request->resolution < 1 ? status
                                             : to_voxels(request->scene, request->resolution, diag);
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    const struct request *request = request_;
    struct neph_scratch *scratch = NULL;
    enum neph_status status = fill_both(request, run->device, diag);
    if (!status)
        status = neph_cli_open_folder(run->output, diag);
    if (!status)
        status = neph_cli_begin_scratch(run->output, &scratch, diag);
    if (!status)
        set_scratch(request->both, neph_scratch_path(scratch));
    if (!status)
        status = measure(request, diag);
    neph_cli_end_scratch(scratch, status, diag);
    if (!status && publication->text)
        print(request->both, publication->text);
    if (!status)
        answer(request->both, &publication->answer);
    if (!status && request->shared.json)
        publication->json = json_of(request->both);
    return status;
}

static void finish(void *request_)
{
    struct request *request = request_;
    if (request->both)
        neph_showing_finish(&request->both->showing);
    free(request->both);
    neph_scene_destroy(request->scene);
}

enum neph_status neph_cli_benchmark(int argc, char **argv, struct neph_diag *diag)
{
    static const struct neph_experiment experiment = {.syntax = &syntax,
                                                      .request_size = sizeof(struct request),
                                                      .opens_stores = true,
                                                      .prepare = prepare,
                                                      .run = run,
                                                      .finish = finish};
    return neph_experiment_main(&experiment, argc, argv, diag);
}
