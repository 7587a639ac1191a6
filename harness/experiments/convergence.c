/* SPDX-License-Identifier: MIT
 *
 * `neph study convergence SCENE...`: the number of frames after which the error of a real-time
 * preset has settled, from a cold start (a cut, a loaded level).
 */
#include "harness/experiments/experiments.h"

#include "harness/data.h"
#include "harness/document/table.h"
#include "harness/study/take.h"
#include "renderer/realtime/options.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES_MAX = 1024, PRESETS_MAX = 16 };

struct request {
    struct neph_cli_shared shared; /* operands: the scenes */
    struct neph_cli_list presets;
    int frames, steps, seed;
};

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"preset", 0, NULL, "Presets to compare; PRESET+KEY=VALUE changes one", NEPH_CLI_LIST,
     AT(presets), .maximum = PRESETS_MAX, .presets = neph_rt_presets, .uses = NEPH_RT_CONVERGENCE},
    {"frames", 0, NULL, "Frames from the cold start", NEPH_CLI_INTEGER, AT(frames), "64", 16,
     FRAMES_MAX},
    {.name = "size", .otherwise = "192x108"},
    {"steps", 0, NULL, "Steps of every view ray, of the reference's too", NEPH_CLI_INTEGER,
     AT(steps), "32", 1, 4096},
    {"seed", 0, NULL, "Seed of the noise of frames", NEPH_CLI_INTEGER, AT(seed), "1", 1, 1 << 20},
    {.name = "jobs", .otherwise = "1"},
    {.name = "output", .help = "Folder of the store", .otherwise = "out/study"},
    {.name = "all", .help = "The table of all scenes and presets"},
    {.name = "json", .help = "All numbers as JSON on stdout"},
    {.name = "csv", .help = "A line for each scene and preset"},
    {.name = "markdown", .help = "The table into a file, too"},
    {.name = "quiet"},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_operands operands = {
    .shown = "SCENE...", .minimum = 1, .missing = "which scenes?"};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .doc = "Render scenes from a cold start with presets of the real-time renderer, and print "
           "after how many frames the error against the reference stays within a tenth of its "
           "final value.\vThe error is the relative RMSE of radiance against the ray marcher in "
           "the same frame, averaged over 16 rays a pixel. The final error is the mean of the "
           "last quarter of the frames. Finished frames stay in DIR/store, and the same command "
           "continues from there.\n\n"
           "Examples:\n"
           "  neph study convergence fence_sky cloud_gaps --size 96x54\n"
           "  neph study convergence ridge_far --preset ours,ours+taa_jitter_length=8 --frames 128",
};

/* Frames with an error in the table, if the sequence is long enough. */
static const int shown_frames[] = {1, 2, 4, 8, 16, 32, 64};
enum { SHOWN = sizeof(shown_frames) / sizeof(shown_frames[0]) };

static const double settled_within = 0.1;

/* Read the errors of all frames from a measurement document. */
static enum neph_status read_errors(const json_t *document, int count, double *errors,
                                    struct neph_diag *diag)
{
    const json_t *list = json_object_get(document, "measurements"), *item;
    size_t index;
    for (int i = 0; i < count; i++)
        errors[i] = NAN;
    json_array_foreach((json_t *)list, index, item)
    {
        const json_int_t frame = json_integer_value(json_object_get(item, "frame"));
        if (json_object_get(item, "frame") && frame < count &&
            strcmp(neph_json_text(item, "metric"), "rel_rmse") == 0 &&
            strcmp(neph_json_text(item, "quantity"), "radiance") == 0 &&
            strcmp(neph_json_text(item, "mask"), "all") == 0)
            errors[frame] = neph_json_real(item, "value");
    }
    for (int i = 0; i < count; i++)
        if (isnan(errors[i]))
            return neph_fail(diag, NEPH_ERR_INPUT, "frame %d has no error", i);
    return NEPH_OK;
}

/* Sums of a preset over its scenes. */
struct settled {
    double frames, error; /* `frames` only over scenes that settle */
    int scene_count, settled_count;
};

static void add_row(const struct request *request, const char *scene, const char *preset,
                    const double *errors, struct settled *sum, struct neph_table *table)
{
    const int count = request->frames;
    double final = 0.0;
    int settled = count;
    for (int i = count - count / 4; i < count; i++)
        final += errors[i] / (count / 4);
    while (settled > 0 && fabs(errors[settled - 1] - final) <= settled_within * final)
        settled--;
    sum->scene_count++;
    sum->settled_count += settled < count;
    sum->frames += settled < count ? settled + 1 : 0;
    sum->error += final;
    neph_table_word(table, scene);
    neph_table_word(table, preset);
    neph_table_numbers(table, 2, (const double[]){settled < count ? settled + 1 : NAN, final});
    for (int i = 0; i < SHOWN; i++)
        neph_table_number(table, shown_frames[i] <= count ? errors[shown_frames[i] - 1] : NAN);
}

/* The errors of a preset's frames, from the store or rendered. */
static enum neph_status measure(const struct neph_capture *take, struct neph_store *store,
                                double *errors, struct neph_diag *diag)
{
    char *folder = NULL;
    json_t *record = NULL, *document = NULL;
    enum neph_status status = neph_capture_run(take, store, &folder, &record, diag);
    if (!status)
        status = neph_capture_document(folder, take->readings[0].name, &document, diag);
    if (!status)
        status = read_errors(document, take->frame_count, errors, diag);
    json_decref(document);
    json_decref(record);
    free(folder);
    return status;
}

static enum neph_status run_preset(const struct request *request,
                                   const struct neph_experiment_run *run,
                                   const struct neph_scene *scene, int index, struct settled *sum,
                                   struct neph_table *table, struct neph_diag *diag)
{
    static const char *const extractors[] = {"error", NULL};
    static const struct neph_measurement_set reading = {.name = "error",
                                                        .against = NEPH_REFERENCE_AVERAGED,
                                                        .extractors = extractors,
                                                        .viewing = NEPH_VIEWING_DEFAULTS};
    const char *preset = request->presets.words[index];
    const struct neph_experiment_frames frames = {preset, request->steps, request->shared.size,
                                                  request->seed};
    double errors[FRAMES_MAX];
    struct neph_engine_info info;
    struct neph_reference reference = {.text = NULL};
    struct neph_progress unseen = neph_progress_start(true, 0);
    struct neph_capture take = {.frame_count = request->frames,
                                .reference = &reference,
                                .readings = &reading,
                                .reading_count = 1,
                                .plain = true,
                                .allow_frozen_frames = true};
    enum neph_status status = neph_experiment_job(run, scene, &frames, &info, &take.job, diag);
    if (!status)
        status = neph_reference_make(&take.job, take.frame_count, run->store, &unseen, &reference,
                                     diag);
    if (!status)
        status = measure(&take, run->store, errors, diag);
    if (!status)
        add_row(request, scene->name, preset, errors, &sum[index], table);
    neph_reference_finish(&reference);
    return status;
}

static void begin_table(struct neph_table *table)
{
    static const struct neph_column columns[] = {
        {.key = "scene", .title = "scene"},
        {.key = "preset", .title = "preset"},
        {.key = "settled_frame", .title = "settled at frame", .format = "%g", .none = "never"},
        {.key = "final_error", .title = "final error", .format = "%.4f"},
    };
    neph_table_columns(table, columns, 4);
    for (int i = 0; i < SHOWN; i++) {
        char key[32], title[32];
        snprintf(key, sizeof(key), "error_%d", shown_frames[i]);
        snprintf(title, sizeof(title), "after %d", shown_frames[i]);
        neph_table_column(table,
                          (struct neph_column){.key = key, .title = title, .format = "%.4f"});
    }
}

/* True when `a` settles in more scenes than `b`, or earlier in as many. */
static bool is_before(const struct settled *a, const struct settled *b)
{
    if (a->settled_count != b->settled_count)
        return a->settled_count > b->settled_count;
    return a->frames < b->frames;
}

static void answer(const struct request *request, const struct settled *sums,
                   struct neph_answer *answer)
{
    const int preset_count = request->presets.count, scene_count = request->shared.operand_count;
    int order[PRESETS_MAX];
    for (int p = 0; p < preset_count; p++) {
        int place = p; /* insertion sort: equal presets keep their order */
        for (; place > 0 && is_before(&sums[p], &sums[order[place - 1]]); place--)
            order[place] = order[place - 1];
        order[place] = p;
    }
    for (int i = 0; i < preset_count; i++) {
        const struct settled *sum = &sums[order[i]];
        const char *name = request->presets.words[order[i]];
        const double error = 100.0 * sum->error / sum->scene_count;
        const struct settled *next = i == 0 && preset_count > 1 ? &sums[order[1]] : NULL;
        const bool is_alike = next && !is_before(sum, next);
        if (sum->settled_count == 0)
            neph_answer_add(answer, "%s: not settled after %d frames, final error %.3g %%", name,
                            request->frames, error);
        else
            neph_answer_add(answer,
                            "%s%s: settled at frame %.3g, final error %.3g %% (means; settled in "
                            "%d of %d scenes, 1 seed)",
                            is_alike ? "not told apart from the next: " : "", name,
                            sum->frames / sum->settled_count, error, sum->settled_count,
                            scene_count);
    }
}

static enum neph_status prepare(void *request_, struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &((struct request *)request_)->shared;
    return neph_data_check_scenes(shared->operands, shared->operand_count, diag);
}

/* Check every preset with every scene before the first frame is rendered. */
static enum neph_status check_jobs(const struct request *request,
                                   const struct neph_experiment_run *run, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < request->shared.operand_count && !status; i++) {
        struct neph_scene *scene = NULL;
        status = neph_data_load_scene(request->shared.operands[i], &scene, diag);
        for (int p = 0; p < request->presets.count && !status; p++) {
            const struct neph_experiment_frames frames = {request->presets.words[p], request->steps,
                                                          request->shared.size, request->seed};
            struct neph_engine_info info;
            struct neph_job job;
            status = neph_experiment_job(run, scene, &frames, &info, &job, diag);
        }
        neph_scene_destroy(scene);
    }
    return status;
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    const struct request *request = request_;
    struct neph_table table = {.cells = NULL};
    struct settled sums[PRESETS_MAX] = {{0}};
    enum neph_status status = check_jobs(request, run, diag);
    struct neph_progress progress = neph_progress_start(run->quiet, request->shared.operand_count *
                                                                        request->presets.count);
    begin_table(&table);
    for (int i = 0; i < request->shared.operand_count && !status; i++) {
        struct neph_scene *scene = NULL;
        status = neph_data_load_scene(request->shared.operands[i], &scene, diag);
        for (int p = 0; p < request->presets.count && !status; p++) {
            neph_progress_begin(&progress, request->presets.words[p]);
            status = run_preset(request, run, scene, p, sums, &table, diag);
            if (!status)
                neph_progress_over(&progress, request->presets.words[p], "measured");
        }
        neph_scene_destroy(scene);
    }
    neph_progress_end(&progress);
    if (publication->text)
        neph_table_print(&table, publication->text);
    if (!status)
        answer(request, sums, &publication->answer);
    publication->json = json_pack("{s:s, s:i, s:o}", "format", "neph-convergence-study-1", "frames",
                                  request->frames, "rows", neph_table_json(&table));
    neph_publication_csv(publication, "\r\n", &table);
    return status;
}

const struct neph_experiment neph_experiment_convergence = {.syntax = &syntax,
                                                            .request_size = sizeof(struct request),
                                                            .prepare = prepare,
                                                            .part = neph_experiment_operand,
                                                            .run = run};
