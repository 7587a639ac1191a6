/* SPDX-License-Identifier: MIT
 *
 * `neph study post SCENE...`: the influence of each stage of the post-processing chain on error and
 * flicker of a real-time renderer, with the stage alone on the tone curve and removed from the
 * whole chain.
 */
#include "harness/experiments/experiments.h"

#include "base/exr.h"
#include "base/interrupt.h"
#include "harness/data.h"
#include "harness/document/table.h"
#include "harness/engines/engines.h"
#include "harness/progress.h"
#include "harness/run/seed.h"
#include "harness/study/numbers_plot.h"
#include "harness/study/post_measure.h"
#include "harness/study/take.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS_MAX = 40, SCENES_MAX = 32, SETTINGS_MAX = 400 };

struct request {
    struct neph_cli_shared shared; /* operands: the scenes */
    struct neph_cli_list chains;   /* texts in their names; none: all chains */
    const char *preset;            /* of realtime: "NAME" or "NAME+KEY=VALUE+..." */
    int frames, warm_up, steps, seed;
    double rate_hz;
};

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"preset", 0, NULL, "Preset of realtime, which renders the frames; NAME+KEY=VALUE changes it",
     NEPH_CLI_ONE, AT(preset), "ours"},
    {"frames", 0, NULL, "Frames that are measured, a multiple of 4", NEPH_CLI_INTEGER, AT(frames),
     "32", 16, 1024},
    {"warm-up", 0, NULL, "Frames before them, a multiple of 4", NEPH_CLI_INTEGER, AT(warm_up), "32",
     0, 1024},
    {"fps", 0, NULL, "Frames a second", NEPH_CLI_REAL, AT(rate_hz), "30", 1, 1000},
    {.name = "size", .otherwise = "192x108"},
    {"steps", 0, NULL, "Steps of every view ray", NEPH_CLI_INTEGER, AT(steps), "32", 1, 4096},
    {"seed", 0, NULL, "Seed of the noise of frames and grain", NEPH_CLI_INTEGER, AT(seed), "1", 1,
     1 << 20},
    {"only", 0, NULL,
     "Only chains with one of these texts in their name, and the curve by itself (default: all)",
     NEPH_CLI_NAMES, AT(chains), .maximum = ROWS_MAX},
    {.name = "jobs", .otherwise = "1"},
    {.name = "output", .help = "Folder of the store and of post.svg", .otherwise = "out/study"},
    {.name = "all", .help = "The tables of all scenes and chains"},
    {.name = "json", .help = "All numbers as JSON on stdout"},
    {.name = "csv", .help = "A line for each chain and scene"},
    {.name = "markdown"},
    {.name = "quiet"},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_operands operands = {.shown = "SCENE...",
                                                  .minimum = 1,
                                                  .maximum = SCENES_MAX,
                                                  .missing = "which scenes?",
                                                  .surplus = "too many scenes"};

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    if (request->frames % 4 != 0 || request->warm_up % 4 != 0)
        argp_error(state, "--frames and --warm-up are multiples of 4: cycles have so many");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc = "Put frames of the real-time renderer and their reference through the same "
           "post-processing chains, each stage by itself and each removed from the whole chain, "
           "and print how error and flicker change: before the tone curve, and as a display shows "
           "the frames.\vThe reference is the ray marcher with the same lighting, averaged over 16 "
           "rays a pixel. The reference gets no grain, which is noise and counts as noise. Chains "
           "without automatic exposure have the exposure that automatic exposure would find for "
           "the reference. Finished frames stay in DIR/store; DIR/post.svg is the chart.\n"
           "\n"
           "Examples:\n"
           "  neph study post fence_backlit voxel_grid --markdown post.md\n"
           "  neph study post ridge_far --preset seed --frames 64 --csv post.csv\n"
           "  neph study post railings --only whole,fxaa,sharpening --seed 2 --size 96x54",
};

/* ---- chains ---------------------------------------------------------------------------------- */

/* The base row of the comparison. */
#define BASE "Unreal's curve"
#define WHOLE                                                                                      \
    "tone_map=unreal lut=on grain=1 vignette=0.5657 auto_exposure=on "                             \
    "bloom=conserving fxaa=quality_29 sharpen=cas "

const struct neph_post_row neph_post_rows[] = {
    {"no curve, cut off at 1", "tone_map=none", false},
    {BASE, "tone_map=unreal", false},
    {"Unreal's curve, HP", "film_slope=0.65 film_toe=0.63 film_shoulder=0.45 film_white_clip=0",
     false},
    {"narkowicz", "tone_map=narkowicz", false},
    {"neutral", "tone_map=neutral", false},
    {"agx", "tone_map=agx", false},
    {"reinhard", "tone_map=reinhard", false},
    {"HDR display, bt2390", "tone_map=bt2390 encode=pq", false},
    {"curve by table", "lut=on", false},
    {"grain", "grain=1", false},
    {"vignette", "vignette=0.5657", false},
    {"automatic exposure", "auto_exposure=on", false},
    {"bloom, conserving", "bloom=conserving", false},
    {"bloom, additive", "bloom=additive", false},
    {"fxaa, console", "fxaa=console", false},
    {"fxaa, quality 12", "fxaa=quality_12", false},
    {"fxaa, quality 29", "fxaa=quality_29", false},
    {"fxaa, quality 39", "fxaa=quality_39", false},
    {"cas", "sharpen=cas", false},
    {"rcas", "sharpen=rcas sharpen_amount=1", false},
    {"upscale to twice, nearest", "upscale=nearest", false},
    {"upscale to twice, bilinear", "upscale=bilinear", false},
    {"upscale to twice, smoothstep", "upscale=smoothstep", false},
    {"upscale to twice, directional", "upscale=directional", false},
    {"upscale to twice, gaussian", "upscale=gaussian", false},
    {"upscale to twice, catmull_rom", "upscale=catmull_rom", false},
    {"upscale to twice, lanczos", "upscale=lanczos", false},
    {"upscale to twice, easu", "upscale=easu", false},
    {"easu and rcas", "upscale=easu sharpen=rcas sharpen_amount=1", false},
    {"the whole", WHOLE, true},
    {"without automatic exposure", WHOLE "auto_exposure=off", true},
    {"without bloom", WHOLE "bloom=off", true},
    {"without table", WHOLE "lut=off", true},
    {"without grain", WHOLE "grain=0", true},
    {"without vignette", WHOLE "vignette=0", true},
    {"without fxaa", WHOLE "fxaa=off", true},
    {"without sharpening", WHOLE "sharpen=off", true},
    {.name = NULL},
};
_Static_assert(sizeof(neph_post_rows) / sizeof(neph_post_rows[0]) <= ROWS_MAX,
               "room for every row");

enum { KIND_REFERENCE, KIND_FRAMES, KIND_CHAIN };

struct study {
    const struct request *request;
    const struct neph_experiment_run *run;
    struct neph_progress progress;
    struct neph_open_device *device;
    struct neph_engine_info info;            /* of the realtime engine */
    struct neph_post_row rows[ROWS_MAX + 1]; /* the chosen rows; ends with a NULL name */
    int row_count;
    char *names[SCENES_MAX]; /* of the scenes; owned */
    struct neph_post_numbers numbers[SCENES_MAX][ROWS_MAX];
    int scene; /* index of the current scene */
    struct neph_image **references;
};

static enum neph_status set_words(const char *words, struct neph_settings *settings,
                                  struct neph_diag *diag)
{
    char copy[SETTINGS_MAX], *rest = copy;
    enum neph_status status = NEPH_OK;
    snprintf(copy, sizeof(copy), "%s", words);
    for (char *word; !status && (word = strsep(&rest, " "));)
        if (word[0])
            status = neph_options_set(neph_post_options, "the post-processing chain", word,
                                      settings, diag);
    return status;
}

static enum neph_status settings_of(const struct neph_post_row *row, double exposure_ev,
                                    struct neph_settings *settings, struct neph_diag *diag)
{
    *settings = neph_options_default(neph_post_options);
    settings->values[POST_TONE] = 1.0;
    const enum neph_status status = set_words(row->settings, settings, diag);
    if (settings->values[POST_AUTO_EXPOSURE] == 0.0)
        settings->values[POST_EXPOSURE_EV] = exposure_ev;
    return status;
}

static enum neph_status measure_rows(struct study *study, const struct neph_post_film *film,
                                     struct neph_diag *diag)
{
    double exposure_ev;
    enum neph_status status = neph_post_meter(study->device->vulkan, film->references[0],
                                              &exposure_ev, diag);
    study->progress.kind = KIND_CHAIN;
    const struct neph_post_row *rows = study->rows;
    for (int r = 0; rows[r].name && !status; r++) {
        struct neph_settings settings;
        if (neph_interrupted())
            return neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted");
        neph_progress_begin(&study->progress, rows[r].name);
        status = settings_of(&rows[r], exposure_ev, &settings, diag);
        if (!status)
            status = neph_post_measure(study->device->vulkan, film, &settings,
                                       &study->numbers[study->scene][r], diag);
        if (!status)
            neph_progress_over(&study->progress, rows[r].name, "measured");
    }
    return status;
}

/* ---- frames ---------------------------------------------------------------------------------- */

static enum neph_status read_references(struct study *study, const struct neph_sequence *files,
                                        struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    study->references = calloc((size_t)files->count, sizeof(struct neph_image *));
    if (!study->references)
        return neph_fail_memory(diag);
    for (int i = 0; i < files->count && !status; i++)
        status = neph_exr_read(files->paths[i], &study->references[i], diag);
    return status;
}

static void free_references(struct study *study, int count)
{
    for (int i = 0; study->references && i < count; i++)
        neph_image_destroy(study->references[i]);
    free(study->references);
    study->references = NULL;
}

static enum neph_status look(const struct neph_take *take, const struct neph_take_frames *frames,
                             void *context, struct neph_diag *diag)
{
    struct study *study = context;
    const struct neph_sequence *files = &take->reference->frames[NEPH_REFERENCE_AVERAGED];
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < take->frame_count && !status; i++)
        if (!frames->images[i])
            status = neph_fail(diag, NEPH_ERR_INPUT,
                               "so many frames of that size do not fit in memory");
    if (!status)
        status = read_references(study, files, diag);
    const struct neph_post_film film = {
        .tests = frames->images,
        .references = (const struct neph_image *const *)study->references,
        .count = take->frame_count,
        .reference_count = files->count,
        .warm_up = study->request->warm_up,
        .frame_rate_hz = study->request->rate_hz,
        .seed = take->job.shot.seed,
    };
    if (!status)
        status = measure_rows(study, &film, diag);
    free_references(study, files->count);
    return status;
}

static enum neph_status run_scene(struct study *study, const struct neph_scene *scene,
                                  struct neph_diag *diag)
{
    struct neph_reference reference = {.text = NULL};
    struct neph_take take = {.frame_count = study->request->warm_up + study->request->frames,
                             .reference = &reference,
                             .look = look,
                             .look_context = study};
    const struct request *request = study->request;
    const struct neph_experiment_frames frames = {request->preset, request->steps,
                                                  request->shared.size, request->seed};
    enum neph_status status = neph_experiment_job(study->run, scene, &frames, &study->info,
                                                  &take.job, diag);
    study->progress.kind = KIND_REFERENCE;
    if (!status) /* one step of this kind was already expected for each scene */
        neph_progress_expect(&study->progress, KIND_REFERENCE,
                             neph_reference_picture_count(scene, 0, take.frame_count) - 1, 0.0);
    if (!status)
        status = neph_reference_make(&take.job, take.frame_count, study->run->store,
                                     &study->progress, &reference, diag);
    study->progress.kind = KIND_FRAMES;
    neph_progress_begin(&study->progress, scene->name);
    if (!status)
        status = neph_take_see(&take, study->run->store, diag);
    neph_reference_finish(&reference);
    return status;
}

/* ---- scenes ---------------------------------------------------------------------------------- */

static bool is_chosen(const struct neph_cli_list *chains, const char *name)
{
    bool has_word = chains->count == 0 || strcmp(name, BASE) == 0;
    for (int i = 0; i < chains->count; i++)
        has_word |= strstr(name, chains->words[i]) != NULL;
    return has_word;
}

static bool is_known(const char *word)
{
    for (int r = 0; neph_post_rows[r].name; r++)
        if (strstr(neph_post_rows[r].name, word))
            return true;
    return false;
}

static enum neph_status choose_rows(struct study *study, struct neph_diag *diag)
{
    const struct neph_cli_list *chains = &study->request->chains;
    for (int i = 0; i < chains->count; i++)
        if (!is_known(chains->words[i])) {
            neph_fail(diag, NEPH_ERR_USAGE, "no chain has '%s' in its name", chains->words[i]);
            neph_hint(diag, "`neph study post SCENE` without --only has all of them");
            return NEPH_ERR_USAGE;
        }
    for (int r = 0; neph_post_rows[r].name; r++)
        if (is_chosen(chains, neph_post_rows[r].name))
            study->rows[study->row_count++] = neph_post_rows[r];
    return NEPH_OK;
}

static enum neph_status run_scenes(struct study *study, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < study->request->shared.operand_count && !status; i++) {
        struct neph_scene *scene = NULL;
        study->scene = i;
        status = neph_data_load_scene(study->request->shared.operands[i], &scene, diag);
        if (!status && !(study->names[i] = strdup(scene->name)))
            status = neph_fail_memory(diag);
        if (!status)
            status = run_scene(study, scene, diag);
        neph_scene_destroy(scene);
    }
    return status;
}

static enum neph_status measure(struct study *study, struct neph_diag *diag)
{
    enum neph_status status = choose_rows(study, diag);
    if (status)
        return status;
    const int scene_count = study->request->shared.operand_count;
    neph_progress_expect(&study->progress, KIND_REFERENCE, scene_count, 0.0);
    neph_progress_expect(&study->progress, KIND_CHAIN, scene_count * study->row_count, 0.0);
    neph_engine_probe(neph_engine_find("realtime"), study->run->device, &study->info);
    if (!study->info.available)
        return neph_fail(diag, NEPH_ERR_UNAVAILABLE, "realtime: %s", study->info.missing);
    status = neph_device_acquire(study->run->device, &study->device, diag);
    if (!status)
        status = run_scenes(study, diag);
    neph_progress_end(&study->progress);
    neph_device_release(study->device);
    return status;
}

/* ---- results ------------------------------------------------------------------------------- */

#define AT(member) offsetof(struct neph_post_numbers, member)
static const struct neph_field numbers[] = {
    {{"scene_error", "scene: error", "%.4f", .none = "none"}, AT(scene_error)},
    {{"scene_change", "change", "%.4f", .none = "none"}, AT(scene_change)},
    {{"flip", "display: FLIP", "%.4f", .none = "none"}, AT(flip)},
    {{"seen", "flicker seen", "%.2f", .none = "none"}, AT(seen)},
    {{"seen_share", "share seen", "%.3f", .none = "none"}, AT(seen_share)},
    {{"luma_change", "change of luma", "%.4f", .none = "none"}, AT(luma_change)},
    {{"ms", "ms", "%.3f", .none = "none"}, AT(ms)},
};
#undef AT
enum { NUMBERS = sizeof(numbers) / sizeof(numbers[0]) };

/* The rows of a table. */
enum part { ALONE, OF_WHOLE, ALL };

static void add_rows(const struct study *study, int scene, enum part part, struct neph_table *table)
{
    for (int r = 0; r < study->row_count; r++) {
        const struct neph_post_row *row = &study->rows[r];
        if (part != ALL && row->is_of_whole != (part == OF_WHOLE))
            continue;
        neph_table_word(table, study->names[scene]);
        neph_table_word(table, row->name);
        neph_table_word(table, row->name);
        neph_table_word(table, row->settings);
        neph_table_flag(table, row->is_of_whole);
        neph_table_field_cells(table, numbers, NUMBERS, &study->numbers[scene][r]);
    }
}

static void begin_table(const char *title, struct neph_table *table)
{
    const struct neph_column words[] = {
        {.key = "scene", .forms = NEPH_TABLE_CSV},
        {.title = title, .key = "chain", .forms = NEPH_TABLE_TEXT | NEPH_TABLE_CSV},
        {.key = "name", .forms = NEPH_TABLE_JSON},
        {.key = "settings", .forms = NEPH_TABLE_JSON},
        {.key = "of_whole", .forms = NEPH_TABLE_JSON},
    };
    neph_table_columns(table, words, 5);
    neph_table_fields(table, numbers, NUMBERS);
}

static void print_table(const struct study *study, int scene, enum part part, FILE *out)
{
    struct neph_table table = {.cells = NULL};
    begin_table(part == OF_WHOLE ? "out of the whole" : "each stage with the tone curve", &table);
    add_rows(study, scene, part, &table);
    if (table.cell_count > 0)
        fputc('\n', out);
    if (table.cell_count > 0)
        neph_table_print(&table, out);
    neph_table_finish(&table);
}

static void print_text(const struct study *study, FILE *out)
{
    const struct request *request = study->request;
    const struct neph_cli_size *size = &request->shared.size;
    fprintf(out,
            "neph %s, realtime %s, %d steps, seed %d, on %s: %d frames after %d at %g Hz, %dx%d, "
            "behind the same chain as the march averaged over 16 rays a pixel.\nError and change "
            "of light before the curve are rms over the reference's mean; flicker seen is in "
            "thresholds; the change of luma is of its error, from frame to frame; ms of the "
            "device.\n",
            NEPH_VERSION, request->preset, request->steps, request->seed, study->info.device,
            request->frames, request->warm_up, request->rate_hz, size->width_px, size->height_px);
    for (int i = 0; i < request->shared.operand_count; i++) {
        fprintf(out, "\n%s\n", study->names[i]);
        print_table(study, i, ALONE, out);
        print_table(study, i, OF_WHOLE, out);
    }
}

static json_t *scene_json(const struct study *study, int scene)
{
    struct neph_table table = {.cells = NULL};
    begin_table(NULL, &table);
    add_rows(study, scene, ALL, &table);
    json_t *chains = neph_table_json(&table);
    neph_table_finish(&table);
    return json_pack("{s:s, s:o}", "scene", study->names[scene], "chains", chains);
}

static void print_csv(const struct study *study, struct neph_publication *publication)
{
    struct neph_table table = {.cells = NULL};
    begin_table(NULL, &table);
    for (int i = 0; i < study->request->shared.operand_count; i++)
        add_rows(study, i, ALL, &table);
    neph_publication_csv(publication, "\n", &table);
}

/* ---- the answer ------------------------------------------------------------------------------ */

/* A chain relative to the tone curve by itself: factors of flicker and FLIP, geometric means over
 * the scenes. */
struct factors {
    int row;
    double seen, flip;
};

static double factor_of(const struct study *study, int row, int base, size_t at)
{
    const int count = study->request->shared.operand_count;
    double sum = 0.0;
    for (int s = 0; s < count; s++) {
        const char *of = (const char *)&study->numbers[s][row],
                   *over = (const char *)&study->numbers[s][base];
        sum += log(*(const double *)(of + at) / *(const double *)(over + at));
    }
    return exp(sum / count);
}

/* Sort chains by their flicker factor, largest first. Returns the number of chains with a
 * number. */
static int sort_chains(const struct study *study, int base, struct factors list[ROWS_MAX])
{
    int count = 0;
    for (int r = 0; r < study->row_count; r++) {
        const struct factors made = {
            r, factor_of(study, r, base, offsetof(struct neph_post_numbers, seen)),
            factor_of(study, r, base, offsetof(struct neph_post_numbers, flip))};
        if (r == base || !isfinite(made.seen))
            continue;
        int place = count++;
        for (; place > 0 && made.seen > list[place - 1].seen; place--)
            list[place] = list[place - 1];
        list[place] = made;
    }
    return count;
}

static void answer(const struct study *study, int base, struct neph_answer *answer)
{
    enum { EACH = 3 };
    const int scenes = study->request->shared.operand_count;
    struct factors list[ROWS_MAX];
    const int count = sort_chains(study, base, list);
    if (count == 0) {
        neph_answer_add(answer, "not measured: no chain except the tone curve has a flicker");
        return;
    }
    const struct factors *most = &list[0], *least = &list[count - 1];
    neph_answer_add(answer,
                    "most flicker: %s, %.3g times the flicker of the tone curve; least: %s, %.3g "
                    "times; %d chains over %d scene%s and 1 seed, no interval",
                    study->rows[most->row].name, most->seen, study->rows[least->row].name,
                    least->seen, count, scenes, scenes == 1 ? "" : "s");
    for (int i = 0; i < count; i++)
        if (i < EACH || i >= count - EACH)
            neph_answer_add(answer,
                            "%s: flicker %.3g times, FLIP %.3g times the value of the tone curve",
                            study->rows[list[i].row].name, list[i].seen, list[i].flip);
}

static enum neph_status write_results(const struct study *study,
                                      struct neph_publication *publication, struct neph_diag *diag)
{
    struct neph_numbers_plot plot = {
        .rows = study->rows,
        .over = "the tone curve",
        .scene_count = study->request->shared.operand_count,
        .scenes = (const char *const *)study->names,
        .numbers = study->numbers[0],
        .stride = ROWS_MAX,
    };
    while (strcmp(study->rows[plot.base].name, BASE) != 0)
        plot.base++;
    if (publication->text)
        print_text(study, publication->text);
    answer(study, plot.base, &publication->answer);
    print_csv(study, publication);
    json_t *scenes = json_array();
    for (int i = 0; i < plot.scene_count; i++)
        neph_json_add(&scenes, scene_json(study, i));
    publication->json = json_pack("{s:s, s:s, s:i, s:o}", "device", study->info.device, "preset",
                                  study->request->preset, "seed", study->request->seed, "scenes",
                                  scenes);
    if (publication->chart)
        neph_numbers_plot(&plot, publication->chart);
    return neph_json_check(publication->json, diag);
}

static enum neph_status prepare(void *request, struct neph_diag *diag)
{
    const struct request *post = request;
    const struct neph_cli_shared *shared = &post->shared;
    const struct neph_cli_size *size = &shared->size;
    if (!neph_take_fits(size->width_px, size->height_px, post->warm_up + post->frames)) {
        neph_fail(
            diag, NEPH_ERR_USAGE,
            "%d frames of %d x %d pixels need more than 1 GiB, the limit for frames in memory",
            post->warm_up + post->frames, size->width_px, size->height_px);
        neph_hint(diag, "give fewer --frames, a shorter --warm-up, or a smaller --size");
        return NEPH_ERR_USAGE;
    }
    return neph_data_check_scenes(shared->operands, shared->operand_count, diag);
}

static enum neph_status run(void *request, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    struct study *study = calloc(1, sizeof(*study));
    if (!study)
        return neph_fail_memory(diag);
    study->request = request;
    study->run = run;
    study->progress = neph_progress_start(run->quiet, 0);
    enum neph_status status = measure(study, diag);
    if (!status)
        status = write_results(study, publication, diag);
    for (int i = 0; i < SCENES_MAX; i++)
        free(study->names[i]);
    free(study);
    return status;
}

const struct neph_experiment neph_experiment_post = {.syntax = &syntax,
                                                     .request_size = sizeof(struct request),
                                                     .chart = "post.svg",
                                                     .prepare = prepare,
                                                     .part = neph_experiment_operand,
                                                     .run = run};
