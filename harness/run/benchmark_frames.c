/* SPDX-License-Identifier: MIT
 *
 * The benchmark of engines without noise: timed frames in flight, error, roofline limits, JSON.
 */
#include "harness/run/benchmark_frames.h"

#include "base/clock.h"
#include "base/threads.h"
#include "harness/engines/engines.h"
#include "harness/engines/frame_stats.h"
#include "harness/engines/vulkan_device.h"
#include "harness/progress.h"
#include "metrics/statistics.h"
#include "renderer/device_memory.h"
#include "renderer/realtime/passes.h"
#include "renderer/shortcuts.h"
#include "scenes/motion.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when a kind is added, as the tables of this file need a row for it. */
_Static_assert(NEPH_MEDIUM_KIND_COUNT == 8, "a new kind");
_Static_assert(NEPH_TEXEL_FORMAT_COUNT == 3, "a new kind");

static const double limit_s = 10.0;

/* Seconds for each roofline limit. The clock of a GPU needs time to rise; lavapipe has no clock
 * that rises. */
static const double cpu_ceiling_s = 0.25, gpu_ceiling_s = 1.0;

enum {
    REST_FRAMES = 8, /* frames of one batch, after which the gradient pass is checked */
    REST_FRAMES_MAX = 512
};

static bool is_on(const struct neph_job *job, const char *option)
{
    const double value = neph_setting(job->engine, &job->shot.settings, option);
    return !isnan(value) && value != 0.0;
}

/* --- times of frames and passes ----------------------------------------------------------- */

/* Median and range of one double of the frames' costs, given by its offset in the struct. */
static struct neph_spread spread_at(const struct neph_flown *flown, size_t offset, double *room)
{
    for (int i = 0; i < flown->count; i++)
        memcpy(&room[i], (const char *)&flown->costs[i] + offset, sizeof(room[i]));
    return neph_spread_of(room, flown->count);
}

/* The first frame in which a pass ran; NULL: it never ran. */
static const struct neph_flight_cost *first_with(const struct neph_flown *flown, int pass)
{
    for (int i = 0; i < flown->count; i++)
        if (flown->costs[i].passes[pass].gpu_s != 0.0)
            return &flown->costs[i];
    return NULL;
}

static void conclude_pass(const struct neph_flown *flown, int pass, double *room,
                          struct neph_benchmark_frames_engine *engine)
{
    const struct neph_flight_cost *first = first_with(flown, pass);
    if (first)
        engine->passes[engine->pass_count++] = (struct neph_benchmark_pass){
            .name = first->passes[pass].name,
            .gpu_s = spread_at(flown, offsetof(struct neph_flight_cost, passes[pass].gpu_s), room),
            .traffic_bytes = first->passes[pass].traffic_bytes,
            .variant_gain = NAN,
            .density_evaluations = NAN,
        };
}

/* The first of these frames from which on the gradient pass is skipped; -1: it runs to the end. */
static int steady_from(const struct neph_job *job, const struct neph_flown *flown)
{
    int pass = 0, from = flown->count;
    if (!is_on(job, "gradient") || flown->count == 0)
        return -1;
    while (pass < flown->costs[0].pass_count &&
           strcmp(flown->costs[0].passes[pass].name, "gradient") != 0)
        pass++;
    if (pass == flown->costs[0].pass_count)
        return -1;
    while (from > 0 && flown->costs[from - 1].passes[pass].gpu_s == 0.0)
        from--;
    return from < flown->count ? from : -1;
}

static void conclude(const struct neph_flown *flown, double *room,
                     struct neph_benchmark_frames_engine *engine)
{
    engine->frame_count = flown->count;
    engine->mean_s = flown->all_s / flown->count;
    engine->gpu_s = spread_at(flown, offsetof(struct neph_flight_cost, gpu_s), room);
    engine->cpu_s = spread_at(flown, offsetof(struct neph_flight_cost, cpu_s), room);
    engine->frame_s = neph_spread_of(flown->frame_s, flown->count);
    engine->steady_from = steady_from(&engine->job, flown);
    engine->pass_count = 0;
    for (int pass = 0; pass < flown->costs[0].pass_count; pass++)
        conclude_pass(flown, pass, room, engine);
}

/* Warm-up of a static scene: renders frames until the engine has detected that the scene is static
 * and skips the gradient pass, but for at most 10 s. */
static enum neph_status come_to_rest(struct neph_job *job, long *picture, struct neph_diag *diag)
{
    const double start_s = neph_wall_s();
    struct neph_flight_cost costs[REST_FRAMES];
    double frame_s[REST_FRAMES];
    enum neph_status status = NEPH_OK;
    if (!is_on(job, "gradient") || !neph_scene_is_static(job->shot.scene))
        return NEPH_OK;
    for (int sent = 0; sent < REST_FRAMES_MAX && neph_wall_s() - start_s < limit_s && !status;
         sent += REST_FRAMES) {
        struct neph_flown flown = {.costs = costs, .frame_s = frame_s};
        status = neph_flight_fly(job, picture, 1, REST_FRAMES, limit_s, &flown, diag);
        if (!status && steady_from(job, &flown) >= 0)
            break;
    }
    return status;
}

static enum neph_status time_frames(struct neph_benchmark_frames_engine *engine, long *picture,
                                    int frame_count, struct neph_diag *diag)
{
    struct neph_flown flown = {
        .costs = calloc((size_t)frame_count, sizeof(*flown.costs)),
        .frame_s = calloc((size_t)frame_count, sizeof(*flown.frame_s)),
    };
    double *room = calloc((size_t)frame_count, sizeof(*room));
    enum neph_status status = flown.costs && flown.frame_s && room ? NEPH_OK
                                                                   : neph_fail_memory(diag);
    if (!status)
        status = neph_flight_warm_up(&engine->job, picture, diag);
    if (!status)
        status = come_to_rest(&engine->job, picture, diag);
    if (!status)
        status = neph_flight_fly(&engine->job, picture, 1, frame_count, limit_s, &flown, diag);
    if (!status)
        conclude(&flown, room, engine);
    free(room);
    free(flown.frame_s);
    free(flown.costs);
    return status;
}

/* --- the error ---------------------------------------------------------------------------- */

/* The marcher with the engine's lighting: "march", "march_octaves", ... */
static const struct neph_engine *reference_of(const struct neph_job *job)
{
    const struct neph_engine *engine = job->engine;
    const int lighting = neph_option_find(engine->options, "lighting");
    char name[64];
    if (!engine->shortcut_of)
        return engine;
    const int choice = lighting < 0 ? 0 : (int)job->shot.settings.values[lighting];
    snprintf(name, sizeof(name), "%s_%s", engine->shortcut_of,
             lighting < 0 ? "" : engine->options[lighting].choices[choice]);
    const struct neph_engine *found = neph_engine_find(name);
    return found ? found : neph_engine_find(engine->shortcut_of);
}

static enum neph_status relative_rmse(const struct neph_image *image,
                                      const struct neph_image *reference, double *error,
                                      struct neph_diag *diag)
{
    float *of[3], *to[3];
    if (!neph_image_rgb(image, NULL, of) || !neph_image_rgb(reference, NULL, to))
        return neph_fail(diag, NEPH_ERR_INTERNAL, "a frame has no radiance");
    *error = neph_relative_error_of((const float *const[]){to[0], to[1], to[2]},
                                    (const float *const[]){of[0], of[1], of[2]}, 3,
                                    neph_image_pixel_count(image))
                 .rmse;
    return NEPH_OK;
}

/* The reference gets the engine's sky settings: a sky from tables, or none, is no part of the
 * shortcut error. */
static void keep_sky(const struct neph_job *job, struct neph_job *reference)
{
    const struct neph_option *options = reference->engine->options;
    for (int i = 0; options[i].name; i++) {
        const int own = neph_option_find(job->engine->options, options[i].name);
        if (own >= 0 && strncmp(options[i].name, "sky", 3) == 0)
            reference->shot.settings.values[i] = job->shot.settings.values[own];
    }
}

static enum neph_status measure_error(struct neph_benchmark_frames_engine *engine,
                                      const struct neph_image *image, int frame,
                                      struct neph_diag *diag)
{
    struct neph_job job = engine->job;
    struct neph_image *reference = NULL;
    struct neph_cost cost;
    job.engine = engine->reference;
    job.sequence = NULL;
    job.shot.frame = frame;
    job.shot.settings = neph_settings_default(job.engine);
    keep_sky(&engine->job, &job);
    enum neph_status status = neph_job_render(&job, &reference, &cost, diag);
    if (!status)
        status = relative_rmse(image, reference, &engine->error, diag);
    neph_image_destroy(reference);
    return status;
}

static struct neph_benchmark_pass *pass_named(struct neph_benchmark_frames_engine *engine,
                                              const char *name)
{
    for (int p = 0; p < engine->pass_count; p++)
        if (strcmp(engine->passes[p].name, name) == 0)
            return &engine->passes[p];
    return NULL;
}

/* Adds a pass with density evaluations that the marcher's count includes. */
static void add_evaluator(const struct neph_benchmark_pass *pass, struct neph_benchmark_pass *march)
{
    const size_t used = strlen(march->with);
    snprintf(march->with + used, sizeof(march->with) - used, "%s%s", used ? ", " : "", pass->name);
    march->evaluation_s += pass->gpu_s.median;
}

/* The device counts all density evaluations of a frame in one number: of the marcher, of the
 * pass "scene" where it lights solids, and of the sun cache or the shadow map where a moving sun or
 * wind makes it refill. The count is dropped (NaN) where one of the passes has no time of its own.
 */
static void find_evaluators(struct neph_benchmark_frames_engine *engine,
                            struct neph_benchmark_pass *march)
{
    const struct neph_scene *scene = engine->job.shot.scene;
    const struct neph_benchmark_pass *lit = pass_named(engine, "scene");
    const struct neph_benchmark_pass *map = pass_named(engine, "cloud shadow");
    const bool fills = neph_scene_moves(scene);
    march->evaluation_s = march->gpu_s.median;
    if (lit && scene->solid_count > 0 && (scene->sun.present || scene->light_count > 0))
        add_evaluator(lit, march);
    if (map && fills)
        add_evaluator(map, march);
    if (fills &&
        (is_on(&engine->job, "sun_cache") || (!map && is_on(&engine->job, "cloud_shadow"))))
        march->density_evaluations = NAN;
}

static void take_counts(const struct neph_image *image, struct neph_benchmark_frames_engine *engine)
{
    json_t *stats = neph_frame_stats(image);
    const json_t *count = json_object_get(stats, "density_evaluations");
    struct neph_benchmark_pass *march = pass_named(engine, "march");
    if (march && count) {
        march->is_march = true;
        march->density_evaluations = json_number_value(count);
        find_evaluators(engine, march);
    }
    json_decref(stats);
}

/* Times the display chain as `neph render` runs it; each repeat starts from the same adapted
 * exposure. */
static enum neph_status time_chain(const struct neph_benchmark_frames *benchmark,
                                   struct neph_benchmark_frames_engine *engine,
                                   const struct neph_image *frame, int number, int repeats,
                                   struct neph_diag *diag)
{
    struct neph_showing *showing = benchmark->showing;
    struct neph_open_device *device = NULL;
    struct neph_image *picture = NULL;
    struct neph_post_stats stats;
    showing->params.step_s = 1.0 / engine->job.shot.scene->frame_rate_hz;
    enum neph_status status = neph_showing_settle(showing, number, diag);
    if (!status)
        status = neph_device_acquire(engine->job.shot.device, &device, diag);
    if (!status)
        status = neph_chain_warm_up(device->vulkan, &showing->params, frame, diag);
    if (!status)
        status = neph_chain_take(device->vulkan, &showing->params, frame, repeats, limit_s,
                                 &picture, &stats, &engine->chain, diag);
    neph_image_destroy(picture);
    neph_device_release(device);
    return status;
}

/* The frame after the timed ones: its evaluations are counted, its error is measured, and it passes
 * through the display chain. */
static enum neph_status look(const struct neph_benchmark_frames *benchmark,
                             struct neph_benchmark_frames_engine *engine, long picture,
                             int frame_count, struct neph_diag *diag)
{
    const int repeats = frame_count < NEPH_CHAIN_REPEATS_MAX ? frame_count : NEPH_CHAIN_REPEATS_MAX;
    struct neph_job job = engine->job;
    struct neph_image *image = NULL;
    struct neph_cost cost;
    job.shot.frame = neph_flight_frame(picture, job.shot.scene->frame_count);
    enum neph_status status = neph_job_render(&job, &image, &cost, diag);
    if (!status) {
        take_counts(image, engine);
        status = measure_error(engine, image, job.shot.frame, diag);
    }
    if (!status && benchmark->showing)
        status = time_chain(benchmark, engine, image, job.shot.frame, repeats, diag);
    neph_image_destroy(image);
    return status;
}

/* --- gains of variants -------------------------------------------------------------------- */

static double median_of(struct neph_benchmark_frames_engine *engine, const char *name)
{
    const struct neph_benchmark_pass *pass = pass_named(engine, name);
    return pass ? pass->gpu_s.median : 0.0;
}

/* Times the same frames with the readable shaders in place of the device's variants. */
static enum neph_status measure_gains(struct neph_benchmark_frames_engine *engine,
                                      enum neph_rt_device_kind kind, long *picture, int frame_count,
                                      struct neph_diag *diag)
{
    const struct neph_engine_sequence *sequence = engine->job.engine->sequence;
    struct neph_benchmark_frames_engine *readable = malloc(sizeof(*readable));
    if (!readable)
        return neph_fail_memory(diag);
    *readable = *engine;
    sequence->leave_variants(engine->job.sequence, true);
    const enum neph_status status = time_frames(readable, picture, frame_count, diag);
    sequence->leave_variants(engine->job.sequence, false);
    for (int p = 0; p < engine->pass_count && !status; p++) {
        struct neph_benchmark_pass *pass = &engine->passes[p];
        const int index = neph_rt_pass_index(pass->name);
        const struct neph_rt_shader *variant = index < 0 ? NULL
                                                         : &neph_rt_passes[index]->variants[kind];
        if (!variant || !variant->code)
            continue;
        const char *absorbed = variant->absorbs ? variant->absorbs->name : "";
        pass->variant_gain = (median_of(readable, pass->name) + median_of(readable, absorbed)) /
                             pass->gpu_s.median;
    }
    free(readable);
    return status;
}

/* --- one engine, the device, all ---------------------------------------------------------- */

static enum neph_status run_engine(const struct neph_benchmark_frames *benchmark,
                                   struct neph_benchmark_frames_engine *engine, int frame_count,
                                   struct neph_diag *diag)
{
    long picture = 1;
    const uint64_t others_bytes = neph_device_memory();
    neph_device_memory_watch();
    engine->reference = reference_of(&engine->job);
    enum neph_status status = neph_flight_open(&engine->job, &engine->first_s, diag);
    if (!status)
        status = time_frames(engine, &picture, frame_count, diag);
    engine->device_bytes = neph_device_memory_most() - others_bytes;
    if (!status && engine->job.engine->sequence->leave_variants)
        status = measure_gains(engine, benchmark->thread_count ? NEPH_RT_CPU : NEPH_RT_GPU,
                               &picture, frame_count, diag);
    if (!status)
        status = look(benchmark, engine, picture, frame_count, diag);
    neph_job_close(&engine->job);
    return status;
}

/* The current clock of the first processor; NaN: not known. */
static double clock_of_cpu(void)
{
    FILE *file = fopen("/proc/cpuinfo", "r");
    char line[256];
    double mhz = NAN;
    while (file && isnan(mhz) && fgets(line, sizeof(line), file))
        if (sscanf(line, "cpu MHz : %lf", &mhz) != 1)
            mhz = NAN;
    if (file)
        fclose(file);
    return 1e6 * mhz;
}

/* Threads of lavapipe: its own limit where that is set, else all processors. */
static int threads_of_cpu(void)
{
    const char *limit = getenv("LP_NUM_THREADS");
    const int count = limit ? atoi(limit) : 0;
    return count > 0 ? count : neph_processor_count();
}

/* The format of the textures that an engine's settings sample; -1: it samples buffers. */
static int texel_format_of(const struct neph_job *job)
{
    const double *values = job->shot.settings.values;
    const int sampling = neph_option_find(job->engine->options, "grid_sampling");
    const int format = neph_option_find(job->engine->options, "grid_format");
    return sampling < 0 || values[sampling] == 0.0 ? -1 : (int)values[format];
}

/* The texture formats of all engines as bits; where no engine samples textures, the default format,
 * so that both ways to sample are measured. */
static unsigned texel_formats(const struct neph_benchmark_frames *benchmark)
{
    unsigned formats = 0;
    for (int e = 0; e < benchmark->engine_count; e++) {
        const int format = texel_format_of(&benchmark->engines[e].job);
        formats |= format < 0 ? 0u : 1u << format;
    }
    return formats ? formats : 1u << NEPH_TEXEL_R16F;
}

static struct neph_ceilings no_ceilings(void)
{
    struct neph_ceilings none = {.copy_bytes_per_s = NAN,
                                 .buffer_samples_per_s = NAN,
                                 .buffer_chain_per_s = NAN,
                                 .multiply_adds_per_s = NAN,
                                 .exponentials_per_s = NAN};
    for (int f = 0; f < NEPH_TEXEL_FORMAT_COUNT; f++)
        none.texture_samples_per_s[f] = none.texture_chain_per_s[f] = NAN;
    return none;
}

static enum neph_status measure_device(struct neph_benchmark_frames *benchmark,
                                       struct neph_diag *diag)
{
    struct neph_open_device *device = NULL;
    enum neph_status status = neph_device_acquire(benchmark->engines[0].job.shot.device, &device,
                                                  diag);
    if (status)
        return status;
    const bool is_cpu = neph_vulkan_describe(device->vulkan).is_cpu;
    benchmark->ceilings = no_ceilings();
    if (!benchmark->without_ceilings)
        status = neph_ceilings_measure(device->vulkan, is_cpu ? cpu_ceiling_s : gpu_ceiling_s,
                                       texel_formats(benchmark), &benchmark->ceilings, diag);
    benchmark->thread_count = is_cpu ? threads_of_cpu() : 0;
    benchmark->cpu_clock_hz = is_cpu ? clock_of_cpu() : NAN;
    neph_device_release(device);
    return status;
}

static bool samples_grids(const struct neph_scene *scene)
{
    bool all = scene->medium_count > 0;
    for (int i = 0; i < scene->medium_count; i++)
        all &= scene->media[i].kind == NEPH_MEDIUM_GRID;
    return all;
}

enum neph_status neph_benchmark_frames_run(struct neph_benchmark_frames *benchmark, int frame_count,
                                           bool quiet, struct neph_diag *diag)
{
    struct neph_progress progress = neph_progress_start(quiet, 1 + benchmark->engine_count);
    neph_progress_begin(&progress, "ceilings");
    benchmark->samples_grids = samples_grids(benchmark->engines[0].job.shot.scene);
    enum neph_status status = measure_device(benchmark, diag);
    for (int e = 0; e < benchmark->engine_count && !status; e++) {
        struct neph_benchmark_frames_engine *engine = &benchmark->engines[e];
        neph_progress_begin(&progress, engine->job.engine->name);
        status = run_engine(benchmark, engine, frame_count, diag);
        if (!status)
            neph_progress_step(&progress, engine->job.engine->name, "timed", engine->first_s);
    }
    neph_progress_end(&progress);
    return status;
}

double neph_benchmark_share(const struct neph_benchmark_frames *benchmark,
                            const struct neph_benchmark_frames_engine *engine,
                            const struct neph_benchmark_pass *pass, const char **limit)
{
    static const char *const textures[NEPH_TEXEL_FORMAT_COUNT] = {
        [NEPH_TEXEL_R32F] = "r32f texture samples",
        [NEPH_TEXEL_R16F] = "r16f texture samples",
        [NEPH_TEXEL_R8] = "r8 texture samples",
    };
    const struct neph_ceilings *ceilings = &benchmark->ceilings;
    const int format = texel_format_of(&engine->job);
    if (!pass->is_march) {
        *limit = "copies";
        return pass->traffic_bytes / pass->gpu_s.median / ceilings->copy_bytes_per_s;
    }
    *limit = NULL;
    if (!benchmark->samples_grids || pass->density_evaluations == 0.0)
        return NAN;
    *limit = format < 0 ? "buffer samples" : textures[format];
    return pass->density_evaluations / pass->evaluation_s /
           (format < 0 ? ceilings->buffer_samples_per_s : ceilings->texture_samples_per_s[format]);
}

struct neph_benchmark_evaluation
neph_benchmark_evaluation(const struct neph_benchmark_frames *benchmark,
                          const struct neph_benchmark_frames_engine *engine,
                          const struct neph_benchmark_pass *pass)
{
    const struct neph_ceilings *ceilings = &benchmark->ceilings;
    const int format = texel_format_of(&engine->job);
    const double per_s = pass->density_evaluations / pass->evaluation_s;
    if (!pass->is_march || pass->density_evaluations == 0.0)
        return (struct neph_benchmark_evaluation){NAN, NAN};
    const double chain_per_s = format < 0 ? ceilings->buffer_chain_per_s
                                          : ceilings->texture_chain_per_s[format];
    return (struct neph_benchmark_evaluation){
        .chain_share = benchmark->samples_grids ? per_s / chain_per_s : NAN,
        .multiply_adds = ceilings->multiply_adds_per_s / per_s,
    };
}

/* --- JSON --------------------------------------------------------------------------------- */

static json_t *spread_json(struct neph_spread s)
{
    return json_pack("{s:o, s:o, s:o}", "median", neph_json_number(s.median), "low",
                     neph_json_number(s.low), "high", neph_json_number(s.high));
}

static json_t *passes_json(const struct neph_benchmark_frames *benchmark,
                           const struct neph_benchmark_frames_engine *engine)
{
    json_t *passes = json_array();
    for (int p = 0; p < engine->pass_count; p++) {
        const struct neph_benchmark_pass *pass = &engine->passes[p];
        const char *limit;
        const double share = neph_benchmark_share(benchmark, engine, pass, &limit);
        const struct neph_benchmark_evaluation one = neph_benchmark_evaluation(benchmark, engine,
                                                                               pass);
        neph_json_add(&passes,
                      json_pack("{s:s, s:o, s:o, s:o, s:o, s:s, s:s?, s:o, s:o, s:o}", "pass",
                                pass->name, "gpu_s", spread_json(pass->gpu_s), "traffic_bytes",
                                neph_json_number(pass->traffic_bytes), "density_evaluations",
                                neph_json_number(pass->density_evaluations), "variant_gain",
                                neph_json_number(pass->variant_gain), "evaluations_with",
                                pass->with, "ceiling", limit, "share", neph_json_number(share),
                                "chain_share", neph_json_number(one.chain_share), "multiply_adds",
                                neph_json_number(one.multiply_adds)));
    }
    return passes;
}

static json_t *chain_json(const struct neph_benchmark_frames *benchmark,
                          const struct neph_benchmark_frames_engine *engine)
{
    if (!benchmark->showing)
        return json_null();
    return json_pack("{s:i, s:o, s:o}", "repeats", engine->chain.count, "stages",
                     neph_chain_stages_json(&benchmark->showing->params, &engine->chain), "all",
                     neph_chain_time_json("all stages", &engine->chain.all));
}

static json_t *engine_json(const struct neph_benchmark_frames *benchmark,
                           const struct neph_benchmark_frames_engine *engine)
{
    const struct neph_job *job = &engine->job;
    char *settings = neph_settings_text(job->engine, &job->shot.settings);
    char *changes = neph_settings_changes(job->engine, &job->shot.settings, engine->preset);
    json_t *json = json_pack(
        "{s:s, s:s, s:s, s:s, s:s?, s:s, s:f, s:I, s:i, s:i, s:f, s:o, s:o, s:o, s:o, s:s, s:o, "
        "s:o}",
        "engine", job->engine->name, "version", job->info->version, "device", job->info->device,
        "settings", settings ? settings : "", "preset", engine->preset, "changes",
        changes ? changes : "", "first_s", engine->first_s, "device_bytes",
        (json_int_t)engine->device_bytes, "frames", engine->frame_count, "steady_from",
        engine->steady_from, "mean_s", engine->mean_s, "frame_s", spread_json(engine->frame_s),
        "gpu_s", spread_json(engine->gpu_s), "cpu_s", spread_json(engine->cpu_s), "passes",
        passes_json(benchmark, engine), "reference", engine->reference->name, "error",
        neph_json_number(engine->error), "chain", chain_json(benchmark, engine));
    free(changes);
    free(settings);
    return json;
}

static json_t *ceilings_json(const struct neph_ceilings *ceilings)
{
    json_t *textures = json_object(), *chains = json_object();
    for (int f = 0; f < NEPH_TEXEL_FORMAT_COUNT; f++) {
        neph_json_set(&textures, neph_texel_formats[f],
                      neph_json_number(ceilings->texture_samples_per_s[f]));
        neph_json_set(&chains, neph_texel_formats[f],
                      neph_json_number(ceilings->texture_chain_per_s[f]));
    }
    return json_pack("{s:o, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:i}", "copy_bytes_per_s",
                     neph_json_number(ceilings->copy_bytes_per_s), "copy_bytes",
                     (json_int_t)ceilings->copy_bytes, "buffer_samples_per_s",
                     neph_json_number(ceilings->buffer_samples_per_s), "texture_samples_per_s",
                     textures, "buffer_chain_per_s", neph_json_number(ceilings->buffer_chain_per_s),
                     "texture_chain_per_s", chains, "multiply_adds_per_s",
                     neph_json_number(ceilings->multiply_adds_per_s), "exponentials_per_s",
                     neph_json_number(ceilings->exponentials_per_s), "grid_side",
                     ceilings->grid_side);
}

json_t *neph_benchmark_frames_json(const struct neph_benchmark_frames *benchmark)
{
    const struct neph_shot *shot = &benchmark->engines[0].job.shot;
    json_t *engines = json_array();
    for (int e = 0; e < benchmark->engine_count; e++)
        neph_json_add(&engines, engine_json(benchmark, &benchmark->engines[e]));
    return json_pack("{s:s, s:s, s:s, s:[i,i], s:i, s:o, s:o, s:o}", "format",
                     "neph-benchmark-frames-1", "scene", shot->scene->name, "scene_hash",
                     shot->scene->hash, "size_px", shot->width_px, shot->height_px, "threads",
                     benchmark->thread_count, "cpu_clock_hz",
                     neph_json_number(benchmark->cpu_clock_hz), "ceilings",
                     ceilings_json(&benchmark->ceilings), "engines", engines);
}
