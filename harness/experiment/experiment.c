/* SPDX-License-Identifier: MIT */
#include "harness/experiment/experiment.h"

#include "base/arena.h"
#include "base/clock.h"
#include "base/interrupt.h"
#include "harness/engines/engines.h"
#include "harness/experiment/pool.h"
#include "harness/old_options.h"
#include "harness/progress.h"
#include "harness/run/seed.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Open the store, run the experiment once, publish the results. `places` NULL: the results are
 * dropped. */
static enum neph_status run_once(const struct neph_experiment *experiment, void *request,
                                 const char *store_folder, struct neph_shared_device *device,
                                 const struct neph_publication_places *places, bool quiet,
                                 struct neph_diag *diag)
{
    static const struct neph_publication_places nowhere = {.json = true};
    const struct neph_cli_shared *shared = request;
    struct neph_experiment_run run = {.device = device, .output = shared->output, .quiet = quiet};
    struct neph_publication publication = {.places = NULL};
    enum neph_status status = store_folder ? neph_store_open(store_folder, &run.store, diag)
                                           : NEPH_OK;
    if (!status)
        status = neph_publication_begin(places ? places : &nowhere, &publication, diag);
    if (!status)
        status = experiment->run(request, &run, &publication, diag);
    if (!status && places)
        status = neph_publication_publish(&publication, diag);
    neph_publication_finish(&publication);
    neph_store_close(run.store);
    return status;
}

/* ---- parts ----------------------------------------------------------------------------------- */

struct parts {
    const struct neph_experiment *experiment;
    const void *request;
    const char *store_folder;
    struct neph_shared_device *device;
    struct neph_progress progress;
};

bool neph_experiment_operand(void *request, int index)
{
    return neph_cli_only_operand(request, index);
}

/* A copy of the request, changed to part `index`; for free(). NULL: there are no more parts, or
 * memory is short. */
static void *part_of(const struct parts *parts, int index)
{
    void *request = malloc(parts->experiment->request_size);
    if (!request)
        return NULL;
    memcpy(request, parts->request, parts->experiment->request_size);
    if (parts->experiment->part(request, index))
        return request;
    free(request);
    return NULL;
}

/* Worker: render the parts that the queue gives it. A part that fails fails again in the main run,
 * which reports the error. */
static enum neph_status run_parts(struct neph_worker *worker, void *context, struct neph_diag *diag)
{
    const struct parts *parts = context;
    if (worker->index == 0)
        return NEPH_OK; /* this process runs the whole experiment afterwards */
    for (int index; !neph_interrupted() && (index = neph_worker_next(worker)) >= 0;) {
        char message[64];
        const double start_s = neph_wall_s();
        void *request = part_of(parts, index);
        if (!request)
            break;
        run_once(parts->experiment, request, parts->store_folder, parts->device, NULL, true, diag);
        free(request);
        snprintf(message, sizeof(message), "%d %.3f", index, neph_wall_s() - start_s);
        neph_worker_tell(worker, message);
    }
    return NEPH_OK;
}

static enum neph_status hear(const char *text, void *context, struct neph_diag *diag)
{
    struct parts *parts = context;
    int index;
    double seconds;
    char name[32];
    (void)diag;
    if (!text || sscanf(text, "%d %lf", &index, &seconds) != 2)
        return NEPH_OK;
    snprintf(name, sizeof(name), "part %d", index + 1);
    neph_progress_step(&parts->progress, name, "done", seconds);
    return NEPH_OK;
}

static enum neph_status run_workers(const struct neph_experiment *experiment, const void *request,
                                    const char *store_folder, struct neph_shared_device *device,
                                    struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = request;
    struct parts parts = {.experiment = experiment,
                          .request = request,
                          .store_folder = store_folder,
                          .device = device,
                          .progress = neph_progress_start(shared->quiet, 0)};
    int count = 0;
    for (void *part; (part = part_of(&parts, count)); count++)
        free(part);
    if (count < 2)
        return NEPH_OK;
    parts.progress.workers = shared->jobs < count ? shared->jobs : count;
    neph_progress_expect(&parts.progress, 0, count, 0.0);
    const enum neph_status status = neph_pool_run(parts.progress.workers, device, run_parts, hear,
                                                  &parts, diag);
    neph_progress_end(&parts.progress);
    return status;
}

/* ---- the main run ---------------------------------------------------------------------------- */

/* Paths of the files of struct neph_experiment in OUTPUT; NULL: the experiment writes no such
 * file. */
struct paths {
    const char *store, *chart, *document, *csv;
};

/* The options that print all numbers, for the last line of the answer. */
static const char *flags_of(const struct neph_cli_syntax *syntax)
{
    for (const struct neph_cli_option *row = syntax ? syntax->options : NULL; row && row->name;
         row++)
        if (strcmp(row->name, "csv") == 0)
            return "--all, --csv FILE or --json";
    return "--all or --json";
}

enum { FILES_MAX = 12 };

/* The names of the files that an experiment writes; the list ends with NULL. */
static void list_files(const struct neph_experiment *experiment, const char *files[FILES_MAX + 1])
{
    const char *const fixed[] = {experiment->chart, experiment->document, experiment->csv,
                                 experiment->opens_stores ? NULL : "store"};
    int count = 0;
    for (const char *const *name = experiment->files; name && *name && count < FILES_MAX; name++)
        files[count++] = *name;
    for (size_t i = 0; i < sizeof(fixed) / sizeof(fixed[0]) && count < FILES_MAX; i++)
        if (fixed[i])
            files[count++] = fixed[i];
    files[count] = NULL;
}

static enum neph_status run_in(const struct neph_experiment *experiment, void *request,
                               const struct paths *paths, struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = request;
    const char *files[FILES_MAX + 1];
    list_files(experiment, files);
    const struct neph_publication_places places = {
        .markdown = shared->markdown,
        .csv = shared->csv ? shared->csv : paths->csv,
        .chart = paths->chart,
        .document = paths->document,
        .json = shared->json,
        .all = shared->all,
        .quiet = shared->quiet,
        .rest = {flags_of(experiment->syntax), shared->output, files}};
    struct neph_shared_device device = {.open = NULL};
    enum neph_status status = NEPH_OK;
    if (shared->jobs > 1 && experiment->part)
        status = run_workers(experiment, request, paths->store, &device, diag);
    if (status == NEPH_ERR_INTERRUPTED)
        neph_hint(diag, "finished frames are in the store: the same command continues from there");
    if (!status)
        status = run_once(experiment, request, paths->store, &device, &places, shared->quiet, diag);
    neph_shared_device_close(&device);
    return status;
}

static enum neph_status run_with(const struct neph_experiment *experiment, void *request,
                                 struct neph_diag *diag)
{
    const char *output = ((const struct neph_cli_shared *)request)->output;
    const char *const names[] = {experiment->opens_stores ? NULL : "store", experiment->chart,
                                 experiment->document, experiment->csv};
    const char *in[4] = {NULL};
    const char *slash = output && output[strlen(output) - 1] == '/' ? "" : "/";
    struct neph_arena arena = {.last = NULL};
    if (output)
        neph_old_output_warn(output);
    for (int i = 0; i < 4; i++)
        if (output && names[i])
            in[i] = neph_arena_format(&arena, "%s%s%s", output, slash, names[i]);
    enum neph_status status = neph_arena_check(&arena, diag);
    if (!status)
        status = run_in(experiment, request, &(struct paths){in[0], in[1], in[2], in[3]}, diag);
    neph_arena_finish(&arena);
    return status;
}

enum neph_status neph_experiment_main(const struct neph_experiment *experiment, int argc,
                                      char **argv, struct neph_diag *diag)
{
    void *request = calloc(1, experiment->request_size);
    if (!request)
        return neph_fail_memory(diag);
    neph_cli_parse(experiment->syntax, argc, argv, request);
    const struct neph_experiment *chosen = experiment->choose ? experiment->choose(request)
                                                              : experiment;
    enum neph_status status = neph_cli_split_lists(experiment->syntax, request, diag);
    if (!status && chosen->prepare)
        status = chosen->prepare(request, diag);
    if (!status)
        status = run_with(chosen, request, diag);
    if (chosen->finish)
        chosen->finish(request);
    neph_cli_free_lists(experiment->syntax, request);
    free(request);
    return status;
}

/* ---- jobs ------------------------------------------------------------------------------------ */

/* Check the size with the engine and, for a real-time method, with its reference, which is rendered
 * at the same size. */
static enum neph_status check_size(const struct neph_job *job, struct neph_diag *diag)
{
    const struct neph_engine *engine = job->engine;
    enum neph_status status = neph_engine_check_size(engine, job->shot.width_px,
                                                     job->shot.height_px, diag);
    if (!status && engine->shortcut_of)
        status = neph_engine_check_size(neph_engine_find(engine->shortcut_of), job->shot.width_px,
                                        job->shot.height_px, diag);
    return status;
}

enum neph_status neph_experiment_job(const struct neph_experiment_run *run,
                                     const struct neph_scene *scene,
                                     const struct neph_experiment_frames *frames,
                                     struct neph_engine_info *info, struct neph_job *job,
                                     struct neph_diag *diag)
{
    char steps[32], why[512];
    snprintf(steps, sizeof(steps), "steps=%d", frames->steps);
    *job = (struct neph_job){.info = info,
                             .shot = {.scene = scene,
                                      .width_px = frames->size.width_px,
                                      .height_px = frames->size.height_px,
                                      .layers = NEPH_LAYERS_ALL,
                                      .seed = neph_seed_of(scene, frames->seed),
                                      .device = run->device}};
    const enum neph_status status = neph_engine_words(frames->words, steps, &job->engine,
                                                      &job->shot.settings, diag);
    if (status)
        return status;
    const enum neph_status fits = check_size(job, diag);
    if (fits)
        return fits;
    neph_engine_probe(job->engine, run->device, info);
    if (!info->available)
        return neph_fail(diag, NEPH_ERR_UNAVAILABLE, "%s: %s", job->engine->name, info->missing);
    if (!job->engine->can_render(scene, &job->shot.settings, why, sizeof(why)))
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s: %s cannot: %s", scene->name,
                         frames->words, why);
    return NEPH_OK;
}
