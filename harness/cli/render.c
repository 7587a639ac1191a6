/* SPDX-License-Identifier: MIT
 *
 * `neph render` and `neph export`: render or export frames of one scene with one engine.
 */
#include "base/path.h"
#include "harness/cli/render_shown.h"

#include "base/doubt.h"
#include "base/exr.h"
#include "base/files.h"
#include "base/owned.h"
#include "harness/cli/cli.h"
#include "harness/compare/sequence.h"
#include "harness/data.h"
#include "harness/engines/engines.h"
#include "harness/engines/frame_stats.h"
#include "harness/engines/vulkan_device.h"
#include "harness/progress.h"
#include "harness/report/scene_layers.h"
#include "harness/report/step_bias.h"
#include "harness/report/step_depth.h"
#include "harness/run/configuration.h"
#include "harness/run/job.h"
#include "harness/run/noise.h"
#include "harness/run/seed.h"
#include "scenes/motion.h"
#include "scenes/rescatter.h"
#include "scenes/words.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Limit of --frames for engines with history, which continue beyond the scene's last key frame. */
enum { FRAMES_MAX = 100000 };

struct request {
    struct neph_cli_shared shared;
    const char *checkpoint, *preset, *depth, *config, *scattering, *chain;
    int first_frame, frame_count, seed;
    bool noise, scene_layers, stats;
    struct neph_configuration configuration; /* from --config; without it the engine is NULL */
};

/* Shared with `neph export`, which has another default engine. */
#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"preset", 0, NULL,
     "Engine realtime: a set of settings by name, before any --set; `neph engines realtime` lists "
     "them",
     NEPH_CLI_ONE, AT(preset)},
    {"config", 0, "FILE",
     "Engine, settings and orders of scattering as `neph pick` has left them, in place of --engine "
     "and --preset, before any --set",
     NEPH_CLI_WORD, AT(config)},
    {"scattering", 0, "ORDERS",
     "Treat the scene as if it had none, single or multiple scattering: measures the effect of "
     "missing orders",
     NEPH_CLI_WORD, AT(scattering)},
    {.name = "set"},
    {.name = "size", .otherwise = "320x180"},
    {"frame", 0, "N", "First frame, 0-based", NEPH_CLI_INTEGER, AT(first_frame), "0", 0, INT_MAX},
    {"frames", 0, NULL, "How many frames; engine realtime goes on beyond the scene's last",
     NEPH_CLI_INTEGER, AT(frame_count), "1", 1, FRAMES_MAX},
    {"seed", 0, NULL,
     "Random seed (default: one of the scene's own, so that the errors of two "
     "scenes are independent; it is in the results and in the frame, as neph.seed)",
     NEPH_CLI_INTEGER, AT(seed), .minimum = 0, .maximum = INT_MAX},
    {.name = "time-limit", .otherwise = "3600"},
    {"checkpoint", 0, "FILE",
     "Engines oracle and tracer: continue from FILE, if it exists, and save all paths in it: an "
     "interrupted render loses seconds (oracle) or the current batch (tracer), and a finished one "
     "can be continued with more samples",
     NEPH_CLI_FILE, AT(checkpoint)},
    {"scene-layers", 0, NULL,
     "Add layers of the scene for `neph compare` and `neph flicker`: masks of clouds, fog, thin "
     "objects and the sun, and motion vectors of solids and sky before a camera that moves",
     NEPH_CLI_FLAG, AT(scene_layers)},
    {"depth", 0, "SOURCE",
     "Engine realtime: Z [m along the camera's axis; inf: sky] of these EXR files in place of the "
     "scene's solids, which still shade the media, and R G B, which is the background of the media "
     "(without: black). SOURCE: " NEPH_SEQUENCE_HELP "; one file serves all frames",
     NEPH_CLI_WORD, AT(depth)},
    {"stats", 0, NULL,
     "Cost of each frame: density evaluations, rays, steps, bytes, device time per pass (engines "
     "that count them). The first frames of an idle GPU are two to four times slower: neph "
     "benchmark warms it first",
     NEPH_CLI_FLAG, AT(stats)},
    {"chain", 0, "FILE",
     "Show the frames by this post-processing chain, in place of the scene's; off: none",
     NEPH_CLI_WORD, AT(chain)},
    {"noise", 0, NULL,
     "Engine cycles: render every frame with a second seed, too, for its noise; other engines by "
     "chance know theirs",
     NEPH_CLI_FLAG, AT(noise)},
    {.name = "blender"},
    {.name = "json"},
    {.name = "quiet"},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_option render_defaults[] = {
    {.name = "engine", .otherwise = "march"},
    {.name = "output", .otherwise = "out/render"},
    {.name = NULL}};
static const struct neph_cli_option export_defaults[] = {
    {.name = "engine", .otherwise = "povray"},
    {.name = "output", .otherwise = "out/export"},
    {.name = NULL}};

static const struct neph_cli_syntax render_syntax = {
    .options = options,
    .more = render_defaults,
    .operands = &neph_cli_one_scene,
    .doc = "Render a scene (a file, or a name of the catalogue) with one engine.\v"
           "Writes DIR/SCENE_ENGINE_FRAME.exr: R G B, volume.*, transmittance.* and Z, 32-bit "
           "float, with the settings as attributes. Frames that are finished when an engine fails "
           "or at Ctrl-C are kept. With a post-processing chain (display.chain of the scene, or "
           "--chain) DIR/shown gets the displayed image of each frame, as EXR and PNG; --size is "
           "then the size of the display, and frames are smaller by the upscaling of the chain.\n\n"
           "Examples:\n"
           "  neph render height_fog_level\n"
           "  neph render my_fog.yaml -e cycles -s samples=256 --size 640x360\n"
           "  neph render camera_dolly --engine march --frames 8\n"
           "  neph render camera_dolly -e realtime -p ours --frames 8 --stats -o out/ours\n"
           "  neph render cloud_below -e tracer -s samples=65536 --checkpoint below.sums",
};

static const struct neph_cli_syntax export_syntax = {
    .options = options,
    .more = export_defaults,
    .operands = &neph_cli_one_scene,
    .doc = "Export a scene as files that open in Blender or render with POV-Ray by hand.\v"
           "Prints the one-line command to run inside DIR, which is a new or empty folder, or the "
           "folder of an earlier export, which is replaced.\n\n"
           "Examples:\n"
           "  neph export fence_backlit --engine povray -o fence_pov\n"
           "  neph export fence_backlit --engine cycles -o fence_blend",
};

/* Check that the scene has these frames. Engines without history stop at the scene's last frame. */
static enum neph_status check_frames(const struct request *request,
                                     const struct neph_engine *engine,
                                     const struct neph_scene *scene, struct neph_diag *diag)
{
    const int first = request->first_frame;
    const int most = engine->has_frame_history ? FRAMES_MAX : scene->frame_count - first;
    enum neph_status status = neph_cli_check_range("--frame", first, 0, scene->frame_count - 1,
                                                   diag);
    if (!status)
        status = neph_cli_check_range("--frames", request->frame_count, 1, most, diag);
    if (status)
        neph_hint(diag, "scene %s ends with frame %d", scene->name, scene->frame_count - 1);
    return status;
}

/* Check options that apply to some engines only. */
static enum neph_status check_engine(const struct request *request,
                                     const struct neph_engine *engine, struct neph_diag *diag)
{
    if (request->checkpoint && (!engine->can_checkpoint || request->frame_count > 1))
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "--checkpoint is for one frame of an engine that adds up paths (oracle, "
                         "tracer)");
    if (request->depth && !engine->accepts_given_frame)
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "--depth is for engine realtime; engine %s renders the scene's solids",
                         engine->name);
    if (request->preset && request->config)
        return neph_fail(diag, NEPH_ERR_USAGE, "--preset or --config, not both");
    if (request->preset && !engine->presets)
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "--preset is for engine realtime; engine %s has no presets", engine->name);
    return NEPH_OK;
}

static enum neph_status make_job(const struct request *request, const struct neph_scene *scene,
                                 struct neph_shared_device *device, struct neph_engine_info *info,
                                 struct neph_job *job, struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &request->shared;
    const struct neph_engine *engine = request->config ? request->configuration.engine
                                                       : neph_engine_find(shared->engine);
    if (!engine) {
        neph_fail(diag, NEPH_ERR_USAGE, "there is no engine '%s'", shared->engine);
        neph_hint(diag, "`neph engines` lists them");
        return NEPH_ERR_USAGE;
    }
    *job = (struct neph_job){.engine = engine,
                             .info = info,
                             .shot = {.scene = scene,
                                      .engine = engine,
                                      .settings = request->config ? request->configuration.settings
                                                                  : neph_settings_default(engine),
                                      .layers = NEPH_LAYERS_ALL,
                                      .width_px = shared->size.width_px,
                                      .height_px = shared->size.height_px,
                                      .frame = request->first_frame,
                                      .seed = request->seed >= 0 ? (uint64_t)request->seed
                                                                 : neph_seed_for_scene(scene, 1),
                                      .time_limit_s = shared->time_limit_s,
                                      .device = device,
                                      .checkpoint = request->checkpoint}};
    enum neph_status status = check_frames(request, engine, scene, diag);
    if (!status)
        status = check_engine(request, engine, diag);
    if (!status && request->preset)
        status = neph_settings_preset(engine, request->preset, &job->shot.settings, diag);
    for (int i = 0; i < shared->settings.count && !status; i++)
        status = neph_settings_set(engine, &job->shot.settings, shared->settings.list[i], diag);
    if (!status)
        neph_engine_probe(engine, device, info);
    return status;
}

/* The state that all frames of a run share, beside the job. */
struct run {
    const struct request *request;
    struct neph_job *job;
    struct neph_sequence depths; /* files of --depth */
    struct neph_shown shown;
    int width_px, height_px; /* window size of the current frame's display image */
    json_t *results;         /* owned */
};

/* The path DIR/SCENE_ENGINE_FRAME.exr. It may not be the file that --depth is read from. */
static enum neph_status name_frame(const struct request *request, const struct neph_job *job,
                                   const char *depth, struct neph_path *path,
                                   struct neph_diag *diag)
{
    *path = neph_path_format("%s/%s_%s_%04d.exr", request->shared.output, job->shot.scene->name,
                             job->engine->name, job->shot.frame);
    if (!depth || !neph_path_is_same(path->text, depth))
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_USAGE, "the frame would be written over '%s' of --depth", depth);
    neph_hint(diag, "name another folder with -o");
    return NEPH_ERR_USAGE;
}

/* Find the noise from the frame's own variance, or from a second seed with --noise. NaN:
 * unknown. */
static enum neph_status find_noise(const struct request *request, const struct neph_job *job,
                                   const struct neph_image *frame, double *noise,
                                   struct neph_diag *diag)
{
    *noise = neph_noise_from_variance(frame);
    if (isfinite(*noise) || !job->engine->stochastic)
        return NEPH_OK;
    if (!request->noise) {
        if (!request->shared.quiet)
            fprintf(stderr,
                    "neph render: %s does not know its noise: --noise renders a second seed\n",
                    job->engine->name);
        return NEPH_OK;
    }
    struct neph_job second = *job;
    struct neph_image *other = NULL;
    struct neph_cost cost;
    second.shot.seed = job->shot.seed == 0x7fffffff ? 0 : job->shot.seed + 1;
    const enum neph_status status = neph_job_render(&second, &other, &cost, diag);
    if (!status)
        *noise = neph_noise_from_two_seeds(frame, other);
    neph_image_destroy(other);
    return status;
}

/* Errors that are not visible in a frame; NaN where unknown. */
struct frame_errors {
    double noise, step_depth, step_bias;
    double doubt; /* of the noise (base/doubt.h) */
};

static void warn(const struct neph_job *job, char *warning)
{
    if (warning)
        fprintf(stderr, "neph render: warning: frame %d: %s\n", job->shot.frame, warning);
    free(warning);
}

/* The step bias costs extra rendering, so it is estimated only once for a sequence of an engine
 * with history, whose frames are fast. */
static bool estimates_step_bias(const struct request *request, const struct neph_job *job)
{
    return !job->engine->has_frame_history || job->shot.frame == request->first_frame;
}

static void say(const struct request *request, const struct neph_job *job,
                const struct frame_errors *frame_errors)
{
    warn(job, neph_step_depth_warning(frame_errors->step_depth, job->engine));
    warn(job, neph_step_bias_warning(frame_errors->step_bias, job->engine));
    if (isfinite(frame_errors->noise) && !request->shared.quiet)
        fprintf(stderr, "frame %d: noise %.2g %% of the rms radiance, seed %llu\n", job->shot.frame,
                100.0 * frame_errors->noise, (unsigned long long)job->shot.seed);
    char doubt[NEPH_DOUBT_ROOM];
    neph_doubt_describe(frame_errors->doubt, doubt, sizeof(doubt));
    if (doubt[0])
        fprintf(stderr, "neph render: warning: frame %d: %s\n", job->shot.frame, doubt);
    char *omission = request->shared.quiet || !estimates_step_bias(request, job)
                         ? NULL
                         : neph_step_bias_omission(&job->shot, job->engine);
    if (omission)
        fprintf(stderr, "frame %d: %s\n", job->shot.frame, omission);
    free(omission);
}

/* Write the display image beside the frame, and add the entry of both to the results. */
static enum neph_status show_and_note(struct run *run, const struct neph_image *frame,
                                      const char *path, const struct neph_cost *cost,
                                      const struct frame_errors *frame_errors,
                                      struct neph_diag *diag)
{
    const struct neph_shot *shot = &run->job->shot;
    char *name = neph_scene_name_from_path(path);
    struct neph_path shown = {""};
    json_t *stats = NULL;
    enum neph_status status = name ? neph_shown_make(&run->shown, frame, name, shot->frame,
                                                     run->width_px, run->height_px, shot->seed,
                                                     &shown, &stats, diag)
                                   : neph_fail_memory(diag);
    if (!status)
        status = neph_json_append(
            run->results,
            json_pack("{s:s, s:s?, s:i, s:[i,i], s:f, s:f, s:f, s:I, s:O, s:I, s:o, s:o, s:o, s:o}",
                      "exr", path, "shown", shown.text[0] ? shown.text : NULL, "frame", shot->frame,
                      "size_px", frame->width_px, frame->height_px, "render_s", cost->render_s,
                      "wall_s", cost->wall_s, "cpu_s", cost->cpu_s, "peak_memory_bytes",
                      (json_int_t)cost->peak_memory_bytes, "stats", stats, "seed",
                      (json_int_t)shot->seed, "noise", neph_json_number(frame_errors->noise),
                      "noise_doubt", neph_json_number(frame_errors->doubt), "step_optical_depth",
                      neph_json_number(frame_errors->step_depth), "step_bias",
                      neph_json_number(frame_errors->step_bias)),
            diag);
    if (!status && !run->request->shared.json)
        printf("%s\n%s%s", path, shown.text, shown.text[0] ? "\n" : "");
    json_decref(stats);
    free(name);
    return status;
}

/* Render and write one frame. The scratch folder is inside the output folder; a failing engine
 * leaves its logs there. */
static enum neph_status render_one(struct run *run, const char *depth, struct neph_diag *diag)
{
    const struct request *request = run->request;
    struct neph_job *job = run->job;
    struct neph_path path;
    struct neph_scratch *scratch = NULL;
    struct neph_image *frame = NULL;
    struct neph_cost cost = {0};
    enum neph_status status = name_frame(request, job, depth, &path, diag);
    if (!status)
        status = neph_cli_begin_scratch(request->shared.output, &scratch, diag);
    if (!status) {
        job->shot.scratch_directory = neph_scratch_path(scratch);
        status = neph_job_render(job, &frame, &cost, diag);
    }
    struct frame_errors frame_errors = {NAN, NAN, NAN, NAN};
    if (!status)
        status = find_noise(request, job, frame, &frame_errors.noise, diag);
    if (!status)
        frame_errors.doubt = neph_doubt_read(frame);
    if (!status && request->scene_layers)
        status = neph_scene_layers_add(job->shot.scene, job->shot.frame, frame, diag);
    if (!status)
        status = neph_exr_write(path.text, frame, diag);
    if (!status) {
        frame_errors.step_depth = neph_step_depth(&job->shot, job->engine);
        if (estimates_step_bias(request, job))
            frame_errors.step_bias = neph_step_bias(&job->shot, job->engine, frame);
        say(request, job, &frame_errors);
        status = show_and_note(run, frame, path.text, &cost, &frame_errors, diag);
    }
    neph_cli_end_scratch(scratch, status, diag);
    job->shot.scratch_directory = NULL;
    neph_image_destroy(frame);
    return status;
}

static enum neph_status find_depths(const struct request *request, struct neph_sequence *depths,
                                    struct neph_diag *diag)
{
    if (!request->depth)
        return NEPH_OK;
    const enum neph_status status = neph_sequence_find(1, &request->depth, false, depths, diag);
    if (!status && depths->count != 1 && depths->count != request->frame_count)
        return neph_fail(
            diag, NEPH_ERR_USAGE,
            "--depth names %d files, --frames is %d; name one file for all frames, or one for each",
            depths->count, request->frame_count);
    return status;
}

/* Render frame `i`, with the only file of --depth, with file `i` of --depth, or without. The first
 * call opens the sequence. */
static enum neph_status render_next(struct run *run, int i, struct neph_diag *diag)
{
    struct neph_job *job = run->job;
    const struct neph_sequence *depths = &run->depths;
    const char *path = depths->count == 0 ? NULL : depths->paths[depths->count > 1 ? i : 0];
    struct neph_image *given = NULL;
    enum neph_status status = path ? neph_exr_read(path, &given, diag) : NEPH_OK;
    job->shot.given = given;
    if (!status && i == 0)
        status = neph_job_open(job, diag);
    if (!status)
        status = render_one(run, path, diag);
    if (status == NEPH_ERR_INPUT && given)
        neph_hint(diag, "that is '%s' of --depth, in frame %d", path, job->shot.frame);
    neph_image_destroy(given);
    return status;
}

static void print_stats(const json_t *results)
{
    json_t *stats = json_array(), *result;
    size_t index;
    json_array_foreach(results, index, result)
        neph_json_add(&stats, json_incref(json_object_get(result, "stats")));
    neph_frame_stats_print(stats);
    json_decref(stats);
}

/* The requested size is the size of the window; the chain may need a smaller frame. */
static void set_size(struct run *run)
{
    const struct neph_cli_shared *shared = &run->request->shared;
    struct neph_shot *shot = &run->job->shot;
    run->width_px = shared->size.width_px;
    run->height_px = shared->size.height_px;
    neph_scene_frame_size(shot->scene, shot->frame, &run->width_px, &run->height_px);
    shot->width_px = run->width_px;
    shot->height_px = run->height_px;
    neph_shown_frame_size(&run->shown, &shot->width_px, &shot->height_px);
}

static enum neph_status open_run(struct run *run, struct neph_diag *diag)
{
    const struct request *request = run->request;
    enum neph_status status = find_depths(request, &run->depths, diag);
    if (!status)
        status = neph_cli_open_folder(request->shared.output, diag);
    return status ? status
                  : neph_shown_open(&run->shown, request->chain, &run->job->shot,
                                    request->shared.output, diag);
}

static enum neph_status render_frames(const struct request *request, struct neph_job *job,
                                      struct neph_diag *diag)
{
    struct run run = {.request = request, .job = job, .results = json_array()};
    struct neph_progress progress = neph_progress_start(
        request->shared.quiet || request->shared.json, request->frame_count);
    enum neph_status status = open_run(&run, diag);
    for (int i = 0; i < request->frame_count && !status; i++) {
        char what[128];
        snprintf(what, sizeof(what), "frame %d", job->shot.frame);
        neph_progress_begin(&progress, what);
        set_size(&run);
        status = render_next(&run, i, diag);
        neph_progress_over(&progress, what, neph_status_name(status));
        job->shot.frame++;
    }
    neph_progress_end(&progress);
    neph_job_explain(job, status, diag);
    neph_job_close(job);
    neph_shown_close(&run.shown);
    neph_sequence_finish(&run.depths);
    if (request->stats && !request->shared.json && json_array_size(run.results) > 0)
        print_stats(run.results);
    const enum neph_status printed = neph_cli_print_json(run.results, request->shared.json,
                                                         status ? NULL : diag);
    return status ? status : printed;
}

/* The scattering orders of --scattering or --config; `*wanted`: one of them is given. */
static enum neph_status find_scattering(const struct request *request, bool *wanted,
                                        enum neph_scattering *scattering, struct neph_diag *diag)
{
    const char *word = request->scattering;
    *wanted = word || (request->config && request->configuration.rescatters);
    *scattering = request->configuration.scattering;
    if (!word)
        return NEPH_OK;
    for (int i = 0; neph_scattering_words[i]; i++)
        if (strcmp(neph_scattering_words[i], word) == 0) {
            *scattering = (enum neph_scattering)i;
            return NEPH_OK;
        }
    return neph_fail(diag, NEPH_ERR_USAGE,
                     "there is no scattering '%.40s'; it is none, single or multiple", word);
}

/* Load the scene. With other scattering orders, `*other` is a copy with those, which borrows from
 * the scene. */
static enum neph_status load(struct request *request, struct neph_scene **scene,
                             struct neph_scene **other, struct neph_diag *diag)
{
    bool wanted = false;
    enum neph_scattering scattering = NEPH_SCATTERING_NONE;
    enum neph_status status = request->config ? neph_configuration_read(
                                                    request->config, &request->configuration, diag)
                                              : NEPH_OK;
    if (!status)
        status = find_scattering(request, &wanted, &scattering, diag);
    if (!status)
        status = neph_data_load_scene(request->shared.operands[0], scene, diag);
    return status || !wanted ? status : neph_scene_rescatter(*scene, scattering, other, diag);
}

/* An exported folder is marked as owned by neph: its files have names such as scene.blend, which a
 * user's own files may also have. */
static const struct neph_owned_kind export_folder = {.name = "export", .version = 1};

static enum neph_status export_files(const struct request *request, struct neph_job *job,
                                     struct neph_diag *diag)
{
    char reason[512], command[1024];
    if (!job->engine->export_scene)
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "engine %s has nothing to export; use --engine cycles or povray",
                         job->engine->name);
    if (!neph_engine_can_render(job->engine, job->shot.scene, &job->shot.settings, reason,
                                sizeof(reason)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s cannot: %s", job->engine->name, reason);
    enum neph_status status = neph_owned_claim(request->shared.output, &export_folder, diag);
    if (!status)
        status = job->engine->export_scene(&job->shot, request->shared.output, command,
                                           sizeof(command), diag);
    if (status)
        return status;
    if (request->shared.json)
        return neph_json_print(
            json_pack("{s:s, s:s}", "folder", request->shared.output, "command", command), diag);
    printf("in %s: %s\n", request->shared.output, command);
    return NEPH_OK;
}

static enum neph_status export_frame(const struct request *request, struct neph_job *job,
                                     struct neph_diag *diag)
{
    struct neph_scene *still = NULL;
    enum neph_status status = NEPH_OK;
    if (neph_scene_moves(job->shot.scene))
        status = neph_scene_at(job->shot.scene, job->shot.frame, &still, diag);
    if (still)
        job->shot.scene = still;
    if (!status)
        status = export_files(request, job, diag);
    neph_scene_destroy(still);
    return status;
}

/* ---- the verbs ------------------------------------------------------------------------------- */

static enum neph_status run(const struct neph_cli_syntax *syntax, int argc, char **argv,
                            enum neph_status (*work)(const struct request *request,
                                                     struct neph_job *job, struct neph_diag *diag),
                            struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(syntax, argc, argv, &request);
    struct neph_scene *scene = NULL, *other = NULL;
    struct neph_shared_device device = {.open = NULL};
    struct neph_engine_info info;
    struct neph_job job;
    enum neph_status status = load(&request, &scene, &other, diag);
    if (!status)
        status = make_job(&request, other ? other : scene, &device, &info, &job, diag);
    if (!status)
        status = work(&request, &job, diag);
    neph_shared_device_close(&device);
    neph_scene_destroy(other);
    neph_scene_destroy(scene);
    return status;
}

enum neph_status neph_cli_render(int argc, char **argv, struct neph_diag *diag)
{
    return run(&render_syntax, argc, argv, render_frames, diag);
}

enum neph_status neph_cli_export(int argc, char **argv, struct neph_diag *diag)
{
    return run(&export_syntax, argc, argv, export_frame, diag);
}
