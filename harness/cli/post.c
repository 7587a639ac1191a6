/* SPDX-License-Identifier: MIT
 *
 * `neph post`: applies a post-processing chain to frames of any renderer.
 */
#include "harness/cli/cli.h"

#include "base/arena.h"
#include "base/files.h"
#include "base/interrupt.h"
#include "harness/compare/frame_windows.h"
#include "harness/compare/sequence.h"
#include "harness/data.h"
#include "harness/engines/vulkan_device.h"
#include "harness/progress.h"
#include "harness/run/chain_times.h"
#include "harness/run/showing.h"
#include "metrics/extractor.h"
#include "metrics/validity.h"
#include "renderer/post/display.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared;
    struct neph_cli_words reference;
    const char *preset, *chain, *scene;
    struct neph_frame_choice frame_choice;
    struct neph_clips clips;
    int repeat;
    int seed, bits; /* bits -1: chosen by the encoding */
    double rate_hz; /* NaN: the rate that the frames state */
    bool list, png, stats;
};

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"reference", 0, NULL,
     "Frames that the others will be compared with: the same chain, from its beginning, puts them "
     "into DIR/reference; may be given several times",
     NEPH_CLI_WORDS, AT(reference)},
    {"list", 0, NULL, "Stages, settings and presets, and nothing else", NEPH_CLI_FLAG, AT(list)},
    {"preset", 0, NULL, "A set of settings of the chain by name, before any --set", NEPH_CLI_ONE,
     AT(preset), "off"},
    {"chain", 0, "FILE",
     "Order, settings and volumes of the chain; --set goes on top of its settings", NEPH_CLI_WORD,
     AT(chain)},
    {"scene", 0, "SCENE",
     "Scene with the camera for the chain's volumes, at the number of each frame", NEPH_CLI_WORD,
     AT(scene)},
    {.name = "set",
     .argument = "KEY=VALUE",
     .help = "A setting of the chain; may be given several times"},
    {"layer", 0, "NAME", "Radiance is the channels NAME.R and so on (Blender: ViewLayer.Combined)",
     NEPH_CLI_WORD, AT(frame_choice.layer)},
    {"part", .kind = NEPH_CLI_WORD, AT(frame_choice.part)},
    {"seed", 0, NULL, "Seed of the grain", NEPH_CLI_INTEGER, AT(seed), "0", 0, INT_MAX},
    {"fps", 0, NULL, "Frames a second, for auto_exposure (default: the frames' attribute, else 60)",
     NEPH_CLI_REAL, AT(rate_hz), .minimum = 1e-3, .maximum = 1e4},
    {"png", 0, NULL, "A PNG beside each EXR", NEPH_CLI_FLAG, AT(png)},
    {"bits", 0, "N", "Of a channel of the PNG, 8 to 16 (default: 8, for an HDR display 10)",
     NEPH_CLI_INTEGER, AT(bits), .minimum = 8, .maximum = 16},
    {"stats", 0, NULL, "The device time of each stage, and the adapted exposure", NEPH_CLI_FLAG,
     AT(stats)},
    {"repeat", 0, "N",
     "Times that each frame goes through the chain; --stats has median, 10 and 90 % and least of "
     "them, after a second of warm-up",
     NEPH_CLI_INTEGER, AT(repeat), "1", 1, NEPH_CHAIN_REPEATS_MAX},
    {.name = "output", .help = "Folder for the output images", .otherwise = "out/post"},
    {.name = "json"},
    {.name = "quiet"},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_operands operands = {.shown = "FRAMES..."};

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    if (!request->list && request->shared.operand_count == 0)
        argp_error(state, "which frames?");
    if (request->list && request->shared.operand_count > 0)
        argp_error(state, "--list has no operands");
    if (request->chain && strcmp(request->preset, "off") != 0)
        argp_error(state, "a chain names its preset itself: no --preset with --chain");
    if (request->scene && !request->chain)
        argp_error(state, "--scene is for the volumes of a --chain");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc =
        "Apply a post-processing chain to frames of any renderer, as they are shown on a display.\v"
        "FRAMES: " NEPH_SEQUENCE_HELP
        ". R G B are scene-linear radiance. DIR gets an EXR with the name of each frame: the "
        "linear light of the display, where 1 is its white, or peak_nits with encode=pq; `neph "
        "compare`, `flicker` and `view` treat it as display values. --reference puts a reference "
        "through the same chain. Without tone mapping it is still radiance.\n\n"
        "The device is lavapipe unless NEPH_VULKAN_DEVICE names part of another's name.\n\n"
        "Examples:\n"
        "  neph post --list\n"
        "  neph post cloud.exr -p unreal -s exposure_ev=1 --png\n"
        "  neph post 'half/frame.*.exr' -s upscale=lanczos -s screen_percent=50 -o full\n"
        "  neph post 'walk/frame.*.exr' -p unreal -s auto_exposure=on --png\n"
        "  neph post 'walk/frame.*.exr' --chain chain.yaml --scene walk.yaml",
};

/* ---- --list ---------------------------------------------------------------------------------- */

static const char *stage_size_text(const struct neph_post_stage *stage)
{
    static const char *const sizes[] = {
        [NEPH_POST_MAKES_PICTURE] = "the size that it gets",
        [NEPH_POST_MAKES_LARGER] = "the display's size",
        [NEPH_POST_MAKES_TABLE] = "a table",
        [NEPH_POST_MAKES_HISTOGRAM] = "a histogram",
        [NEPH_POST_MAKES_EXPOSURE] = "an exposure",
        [NEPH_POST_MAKES_PYRAMID] = "an image pyramid",
        [NEPH_POST_MAKES_BLOOM] = "the size that it gets",
    };
    return sizes[stage->makes];
}

json_t *neph_cli_post_stages_json(void)
{
    json_t *stages = json_array();
    for (const struct neph_post_stage *s = neph_post_stages; s->name; s++)
        neph_json_add(&stages, json_pack("{s:s, s:s, s:s, s:s, s:s}", "name", s->name, "pass",
                                         neph_post_pass_names[s->pass], "note", s->note, "setting",
                                         neph_post_options[s->settings[1]].name, "makes",
                                         stage_size_text(s)));
    return stages;
}

void neph_cli_post_print_stages(const char *indent)
{
    for (const struct neph_post_stage *s = neph_post_stages; s->name; s++)
        printf("%s%-17s %s; on with %s\n", indent, s->name, s->note,
               neph_post_options[s->settings[1]].name);
}

static json_t *weights_json(const struct neph_post_plan *plan)
{
    json_t *volumes = json_array();
    for (int i = 0; i < plan->volume_count; i++)
        neph_json_add(&volumes,
                      json_pack("{s:o, s:f, s:f, s:f}", "name",
                                neph_json_cleaned(plan->volumes[i].name), "priority",
                                plan->volumes[i].priority, "weight", plan->volumes[i].weight,
                                "blend_radius_m", plan->volumes[i].blend_radius_m));
    return volumes;
}

/* List the enabled stages of a chain, in the order of its file. */
static enum neph_status list_chain(const struct neph_post_plan *plan, bool as_json,
                                   struct neph_diag *diag)
{
    const struct neph_settings settings = neph_post_plan_settings(plan);
    const struct neph_post_stage *stages[NEPH_POST_STAGES_MAX];
    const int count = neph_post_sequence(&plan->order, &settings, stages);
    json_t *names = json_array();
    for (int i = 0; i < count; i++)
        neph_json_add(&names, json_string(stages[i]->name));
    if (as_json)
        return neph_json_print(
            json_pack("{s:o, s:o}", "stages", names, "volumes", weights_json(plan)), diag);
    json_decref(names);
    printf("stages that are on, in their order\n");
    for (int i = 0; i < count; i++)
        printf("    %-17s %s\n", stages[i]->name, stages[i]->note);
    for (int i = 0; i < plan->volume_count; i++)
        printf("volume %s: priority %g, weight %g, %s\n", plan->volumes[i].name,
               plan->volumes[i].priority, plan->volumes[i].weight,
               plan->volumes[i].box.present ? "in its box" : "everywhere");
    return NEPH_OK;
}

static enum neph_status list_all(bool as_json, struct neph_diag *diag)
{
    if (as_json)
        return neph_json_print(json_pack("{s:o, s:o, s:o}", "stages", neph_cli_post_stages_json(),
                                         "settings", neph_cli_options_json(neph_post_options),
                                         "presets", neph_cli_presets_json(neph_post_presets)),
                               diag);
    printf("stages, in their order\n");
    neph_cli_post_print_stages("    ");
    printf("settings\n");
    neph_cli_print_options(neph_post_options);
    printf("presets, each the defaults with\n");
    neph_cli_print_presets(neph_post_presets, 4);
    return NEPH_OK;
}

/* ---- frames ---------------------------------------------------------------------------------- */

/* A chain, and the frames that it processes. */
struct work {
    const struct request *request;
    struct neph_display_chain showing;
    struct neph_scene *scene; /* owned; NULL: none */
    struct neph_vulkan *vulkan;
    struct neph_sequence frames;
    const char *folder; /* of the output images */
    json_t **results;   /* owned by the caller */
};

static enum neph_status find_chain(struct work *work, struct neph_diag *diag)
{
    const struct request *request = work->request;
    if (!request->chain)
        return NEPH_OK;
    enum neph_status status = neph_display_chain_load(&work->showing, request->chain, diag);
    if (!status && request->scene)
        status = neph_data_load_scene(request->scene, &work->scene, diag);
    work->showing.scene = work->scene;
    if (status || work->scene || request->list || !neph_post_plan_needs_camera(&work->showing.plan))
        return status;
    neph_fail(diag, NEPH_ERR_USAGE, "'%s' has volumes in boxes: where is the camera?",
              request->chain);
    neph_hint(diag, "--scene SCENE");
    return NEPH_ERR_USAGE;
}

static enum neph_status find_settings(struct work *work, struct neph_diag *diag)
{
    const struct request *request = work->request;
    struct neph_settings *settings = &work->showing.settings;
    const struct neph_post_stage *stages[NEPH_POST_STAGES_MAX];
    static const char owner[] = "the post-processing chain";
    enum neph_status status = NEPH_OK;
    if (!request->chain)
        status = neph_options_preset(neph_post_options, owner, neph_post_presets, request->preset,
                                     settings, diag);
    for (int i = 0; i < request->shared.settings.count && !status; i++)
        status = neph_options_set(neph_post_options, owner, request->shared.settings.list[i],
                                  settings, diag);
    if (status) {
        if (diag && !diag->hint[0])
            neph_hint(diag, "`neph post --list` explains them");
        return status;
    }
    status = neph_display_chain_check(&work->showing, diag);
    if (!status && request->png && request->bits == 8 && neph_post_is_hdr(settings))
        status = neph_fail(diag, NEPH_ERR_USAGE, "--bits=8: ST 2084 wants 10 to 16");
    if (status)
        return status;
    if (neph_post_sequence(work->showing.params.order, settings, stages) > 0 ||
        work->showing.plan.volume_count > 0)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_USAGE, "all stages of the chain are off");
    neph_hint(diag, "give a --preset, or --set; `neph post --list` explains them");
    return NEPH_ERR_USAGE;
}

/* DIR/NAME.ending for an input FOLDER/NAME.ext. */
static const char *path_for(const struct work *work, const char *frame, const char *ending,
                            struct neph_arena *arena)
{
    const char *slash = strrchr(frame, '/'), *name = slash ? slash + 1 : frame;
    const char *dot = strrchr(name, '.');
    return neph_arena_format(arena, "%s/%.*s.%s", work->folder,
                             (int)(dot ? (size_t)(dot - name) : strlen(name)), name, ending);
}

static int by_text(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Refuse two outputs of the same name, and an output that would overwrite its input. */
static enum neph_status check_names(const struct work *work, struct neph_diag *diag)
{
    const int count = work->frames.count;
    struct neph_arena arena = {0};
    const char **paths = neph_arena_allocate(&arena, (size_t)count, sizeof(*paths));
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && paths && !status; i++) {
        paths[i] = path_for(work, work->frames.paths[i], "exr", &arena);
        if (neph_path_is_same(work->frames.paths[i], paths[i]))
            status = neph_fail(diag, NEPH_ERR_USAGE, "'%s' would be written over itself: -o DIR",
                               paths[i]);
    }
    if (!status)
        status = neph_arena_check(&arena, diag);
    if (!status)
        qsort(paths, (size_t)count, sizeof(*paths), by_text);
    for (int i = 1; i < count && !status; i++)
        if (strcmp(paths[i - 1], paths[i]) == 0)
            status = neph_fail(diag, NEPH_ERR_USAGE, "two of the frames would both be '%s'",
                               paths[i]);
    neph_arena_finish(&arena);
    return status;
}

static enum neph_status write(const struct work *work, const char *frame,
                              struct neph_image *picture, struct neph_diag *diag)
{
    struct neph_arena arena = {0};
    const char *exr = path_for(work, frame, "exr", &arena);
    const char *png = work->request->png ? path_for(work, frame, "png", &arena) : NULL;
    enum neph_status status = neph_arena_check(&arena, diag);
    if (!status)
        status = neph_display_chain_write(&work->showing, picture, exr, png, diag);
    neph_arena_finish(&arena);
    return status;
}

static void print_time(const struct work *work, const char *frame, const char *name,
                       const struct neph_chain_time *time)
{
    const struct neph_spread *s = &time->spread_s;
    if (!work->request->stats || work->request->shared.json)
        return;
    printf("%s: %-17s %8.3f ms", frame, name, 1e3 * s->median);
    if (work->request->repeat > 1)
        printf(", 10 to 90 %% %.3f to %.3f, least %.3f", 1e3 * s->low, 1e3 * s->high,
               1e3 * time->least_s);
    printf("\n");
}

/* Add one entry to the list that --json prints, and print the times. */
static void note(struct work *work, const char *frame, const struct neph_image *picture,
                 const struct neph_post_stats *stats, const struct neph_chain_times *times)
{
    const struct neph_post_stage *sequence[NEPH_POST_STAGES_MAX];
    const struct neph_post_params *params = &work->showing.params;
    const int count = neph_post_sequence(params->order, &params->settings, sequence);
    for (int i = 0; i < count; i++)
        print_time(work, frame, sequence[i]->name, &times->stages[sequence[i] - neph_post_stages]);
    print_time(work, frame, "all stages", &times->all);
    json_t *result = json_pack("{s:s, s:i, s:i, s:o, s:o}", "frame", frame, "width_px",
                               picture->width_px, "height_px", picture->height_px, "stages",
                               neph_chain_stages_json(params, times), "all",
                               neph_chain_time_json("all stages", &times->all));
    if (isfinite(stats->adapted_ev)) {
        neph_json_set(&result, "metered_ev", neph_json_number(stats->metered_ev));
        neph_json_set(&result, "adapted_ev", neph_json_number(stats->adapted_ev));
        if (work->request->stats && !work->request->shared.json)
            printf("%s: metered %.4f EV, adapted to %.4f EV\n", frame, stats->metered_ev,
                   stats->adapted_ev);
    }
    neph_json_add(work->results, result);
}

static enum neph_status run(struct work *work, const struct neph_image *frame, bool is_first,
                            struct neph_image **picture, struct neph_post_stats *stats,
                            struct neph_chain_times *times, struct neph_diag *diag)
{
    const struct request *request = work->request;
    struct neph_display_chain *showing = &work->showing;
    enum neph_status status = NEPH_OK;
    if (is_first && request->stats && request->repeat > 1)
        status = neph_chain_warm_up(work->vulkan, &showing->params, frame, diag);
    showing->params.eye = &showing->eye;
    if (!status)
        status = neph_chain_measure(work->vulkan, &showing->params, frame, request->repeat,
                                    INFINITY, picture, stats, times, diag);
    showing->params.eye = NULL;
    return status;
}

static double frame_rate_hz(const struct work *work, const struct neph_image *frame)
{
    const double said_hz = neph_frame_rate_hz(frame);
    if (!isnan(work->request->rate_hz))
        return work->request->rate_hz;
    return isnan(said_hz) ? NEPH_VIEWING_DEFAULTS.frame_rate_hz : said_hz;
}

/* The chain works in linear Rec.709: its colour tables and its luminance weights are defined there.
 * Refuse other colour spaces. */
static enum neph_status check_radiance(const char *path, const struct neph_image *frame,
                                       struct neph_diag *diag)
{
    const char *space = neph_image_attribute(frame, "colour_space");
    if (neph_image_attribute(frame, "encoding"))
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' has display values, not radiance", path);
    if (!space)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT, "'%s' is not in linear Rec.709: it says that it is in %s", path,
              space);
    neph_hint(diag, "convert it to linear Rec.709 (lin_rec709_scene); if its values are in it in "
                    "truth, write it without colorInteropID and oiio:ColorSpace");
    return NEPH_ERR_INPUT;
}

/* Copy channels that neph does not know (alpha, identifiers, layers of other programs) to the
 * output, unchanged and with their names, if the output has the frame's size. */
static enum neph_status copy_unknown_channels(const struct neph_image *frame,
                                              struct neph_image *picture, struct neph_diag *diag)
{
    static const char vector[] = "vector.";
    const bool fits = frame->width_px == picture->width_px &&
                      frame->height_px == picture->height_px;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < frame->channel_count && fits && !status; i++) {
        const char *name = frame->channels[i].name;
        float *samples;
        if (neph_validity_has_rule(name))
            continue;
        name += strncmp(name, vector, strlen(vector)) == 0 ? strlen(vector) : 0;
        if (neph_image_channel(picture, name))
            continue;
        status = neph_image_add_channel(picture, name, &samples, diag);
        if (!status)
            memcpy(samples, frame->channels[i].samples,
                   neph_image_pixel_count(frame) * sizeof(*samples));
    }
    return status;
}

static enum neph_status make(struct work *work, int index, struct neph_diag *diag)
{
    const char *path = work->frames.paths[index];
    struct neph_image *frame = NULL, *picture = NULL;
    struct neph_post_stats stats;
    struct neph_chain_times times;
    enum neph_status status = neph_frame_read_as_written(path, &work->request->frame_choice, 0,
                                                         &frame, diag);
    if (status)
        return status;
    work->showing.params.step_s = 1.0 / frame_rate_hz(work, frame);
    status = neph_display_chain_set_frame(
        &work->showing, work->frames.numbers ? (int)work->frames.numbers[index] : index, diag);
    if (!status)
        status = check_radiance(path, frame, diag);
    if (!status)
        status = run(work, frame, index == 0, &picture, &stats, &times, diag);
    if (!status)
        status = copy_unknown_channels(frame, picture, diag);
    if (!status)
        status = write(work, path, picture, diag);
    if (!status)
        note(work, path, picture, &stats, &times);
    neph_image_destroy(picture);
    neph_image_destroy(frame);
    return status;
}

static enum neph_status make_pictures(struct work *work, const char *const *words, int word_count,
                                      struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &work->request->shared;
    enum neph_status status = find_settings(work, diag);
    if (!status)
        status = neph_sequence_find(word_count, words, false, &work->frames, diag);
    if (!status)
        status = neph_part_check(&work->frames, work->request->frame_choice.part, diag);
    struct neph_progress progress = neph_progress_start(shared->quiet || shared->json,
                                                        work->frames.count);
    if (!status)
        status = check_names(work, diag);
    if (!status)
        status = neph_cli_open_folder(work->folder, diag);
    if (!status)
        status = neph_vulkan_open(&work->vulkan, diag);
    for (int i = 0; i < work->frames.count && !status; i++) {
        if (neph_interrupted())
            return neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted after %d of %d frames", i,
                             work->frames.count);
        neph_progress_begin(&progress, work->frames.paths[i]);
        status = make(work, i, diag);
        if (!status)
            neph_progress_over(&progress, work->frames.paths[i], "done");
    }
    return status;
}

/* Process a sequence, or list the stages. */
static enum neph_status work_on(const struct request *request, const char *folder,
                                const char *const *words, int word_count, json_t **results,
                                struct neph_diag *diag)
{
    struct work work = {.request = request, .folder = folder, .results = results};
    work.showing.params.seed = (uint64_t)request->seed;
    work.showing.bits = request->bits;
    enum neph_status status = find_chain(&work, diag);
    if (!status && request->list)
        status = request->chain ? list_chain(&work.showing.plan, request->shared.json, diag)
                                : list_all(request->shared.json, diag);
    else if (!status)
        status = make_pictures(&work, words, word_count, diag);
    neph_vulkan_destroy(work.vulkan);
    neph_sequence_finish(&work.frames);
    neph_scene_destroy(work.scene);
    neph_display_chain_finish(&work.showing);
    return status;
}

enum neph_status neph_cli_post(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    request.frame_choice.clips = &request.clips;
    const struct neph_cli_shared *shared = &request.shared;
    json_t *results = json_array();
    enum neph_status status = neph_oiio_server_create(&request.frame_choice.server, diag);
    if (!status)
        status = work_on(&request, shared->output, shared->operands, shared->operand_count,
                         &results, diag);
    if (!status && request.reference.count > 0)
        status = work_on(&request, neph_path_in(shared->output, "reference").text,
                         request.reference.list, request.reference.count, &results, diag);
    if (!status && !request.list && !shared->quiet)
        neph_cli_print_folder("post", shared->output);
    neph_clips_close(&request.clips);
    neph_oiio_server_destroy(request.frame_choice.server);
    const enum neph_status printed = neph_cli_print_json(
        results, !status && !request.list && shared->json, diag);
    return status ? status : printed;
}
