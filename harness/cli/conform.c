/* SPDX-License-Identifier: MIT
 *
 * `neph conform` renders test frames on this device; `neph conform A B` compares two such folders.
 */
#include "harness/cli/cli.h"

#include "harness/data.h"
#include "harness/experiment/experiment.h"
#include "harness/run/conform.h"

#include <stdio.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared; /* operands: two folders to compare; none: render */
    struct neph_cli_list engines, only;
    int pictures, samples;
};

static const struct neph_cli_option options[] = {
    {.name = "size", .otherwise = "1920x1080"},
    {"only", 0, NULL,
     "Only these scenes: files, or names of the catalogue and of scenes/stress (default: all of "
     "both)",
     NEPH_CLI_NAMES, .at = offsetof(struct request, only)},
    {"engine", 0, NULL,
     "Some of march, march_octaves, march_horizon, march_octaves_fitted, march_traced, "
     "march_diffused, march_similarity, march_slab, fog_look, tracer, realtime (default: "
     "all)",
     NEPH_CLI_NAMES, .at = offsetof(struct request, engines)},
    {"frames", 0, NULL, "Frames of realtime, counted all and the last kept", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, pictures), .otherwise = "6", .minimum = 1, .maximum = 1000},
    {"samples", 0, "N", "Paths per pixel of tracer", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, samples), .otherwise = "16", .minimum = 2, .maximum = 1000000},
    {.name = "output", .help = "Folder for the results", .otherwise = "out/conform"},
    {.name = "json"},
    {.name = "quiet"},
    {.name = NULL},
};

static const struct neph_cli_operands operands = {
    .shown = "\nA B",
    .maximum = 2,
    .surplus = "two folders",
};

static void check(const void *request, const struct argp_state *state)
{
    const struct neph_cli_shared *shared = request;
    if (shared->operand_count == 1)
        argp_error(state, "which folder to compare '%s' with?", shared->operands[0]);
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc = "Render every scene at a real size with every built-in Vulkan engine, and count values "
           "that are not finite or below zero: exit 1 if there are any. Or compare two such "
           "folders, of two devices: exit 1 if a frame differs by more than float32 and each "
           "engine's own decisions explain; --only and --engine compare a part.\v"
           "DIR gets SCENE.json with counts, means and hashes of whole frames, and 48x27 pixels of "
           "each as EXR: small enough to carry from one machine to another. Scenes may be rendered "
           "by several runs into one folder. The device is lavapipe unless NEPH_VULKAN_DEVICE "
           "names part of another's name.\n\n"
           "Examples:\n"
           "  NEPH_VULKAN_DEVICE=nvidia neph conform -o gpu\n"
           "  NEPH_VULKAN_DEVICE=nvidia neph conform --size 3840x2160 --only cloud_below -o gpu4k\n"
           "  neph conform --size 192x108 -o cpu\n"
           "  neph conform cpu gpu",
};

/* --- render ------------------------------------------------------------------------------- */

/* The requested scenes, or else all scenes; owned by the arena. */
static enum neph_status list_scenes(const struct neph_cli_list *asked, struct neph_arena *arena,
                                    struct neph_conform_params *params, struct neph_diag *diag)
{
    const char **names = neph_arena_zeroed(arena, NEPH_CLI_WORDS_MAX, sizeof(*names));
    enum neph_status status = names ? NEPH_OK : neph_fail_memory(diag);
    params->skip_absent = asked->count == 0;
    params->scenes = asked->count > 0 ? asked->words : names;
    params->scene_count = asked->count;
    for (int which = 0; asked->count == 0 && which < NEPH_DATA_SCENES_COUNT && !status; which++) {
        char **list = NULL;
        int found = 0;
        status = neph_data_list_scenes(which, &list, &found, diag);
        for (int i = 0; i < found && params->scene_count < NEPH_CLI_WORDS_MAX; i++)
            names[params->scene_count++] = neph_arena_text(arena, list[i]);
        neph_data_free_names(list);
    }
    return status ? status : neph_arena_check(arena, diag);
}

static void print_wrong(const json_t *report, FILE *out)
{
    size_t i, j;
    json_t *scene, *entry;
    json_array_foreach(report, i, scene)
    {
        const char *absent = neph_json_text(scene, "absent");
        if (absent[0])
            fprintf(out, "%s: left out: %s\n", neph_json_text(scene, "scene"), absent);
        json_array_foreach(json_object_get(scene, "pictures"), j, entry)
        {
            const char *reason = neph_json_text(entry, "reason");
            const char *wrong = neph_json_text(entry, "first_wrong");
            const char *outcome = neph_json_text(entry, "outcome");
            if (strcmp(outcome, "failed") == 0 || wrong[0])
                fprintf(out, "%s: %s\n", neph_json_text(entry, "picture"),
                        wrong[0] ? wrong : reason);
        }
    }
}

static enum neph_status render(const struct request *request, const struct neph_experiment_run *run,
                               struct neph_publication *publication, struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &request->shared;
    struct neph_arena arena = {NULL};
    struct neph_conform_params params = {.folder = run->output,
                                         .engines = request->engines.words,
                                         .engine_count = request->engines.count,
                                         .width_px = shared->size.width_px,
                                         .height_px = shared->size.height_px,
                                         .pictures = request->pictures,
                                         .samples = request->samples,
                                         .device = run->device,
                                         .quiet = run->quiet || shared->json};
    int expected = 0, sound = 0;
    enum neph_status status = list_scenes(&request->only, &arena, &params, diag);
    if (!status)
        status = neph_conform_render(&params, &publication->json, diag);
    neph_arena_finish(&arena);
    if (status)
        return status;
    if (!params.quiet)
        neph_cli_say_where("conform", run->output);
    neph_conform_count(publication->json, &expected, &sound);
    if (publication->text) {
        print_wrong(publication->json, publication->text);
        fprintf(publication->text, "%d of %d frames are finite and nowhere negative\n", sound,
                expected);
    }
    if (expected == 0)
        publication->verdict = neph_fail(&publication->reason, NEPH_ERR_GATE,
                                         "no engine could render any of these scenes");
    else if (sound < expected)
        publication->verdict = neph_fail(&publication->reason, NEPH_ERR_GATE,
                                         "%d of %d frames have invalid values", expected - sound,
                                         expected);
    return NEPH_OK;
}

/* --- compare ------------------------------------------------------------------------------ */

static void print_comparison(const json_t *report, FILE *out)
{
    size_t i;
    json_t *picture;
    const json_t *devices = json_object_get(report, "devices");
    json_array_foreach(json_object_get(report, "pictures"), i, picture)
    {
        if (!json_is_true(json_object_get(picture, "agrees")))
            fprintf(out, "%s: %s\n", neph_json_text(picture, "picture"),
                    neph_json_text(picture, "because"));
    }
    fprintf(out, "%lld of %lld frames agree between %s and %s\n",
            (long long)json_integer_value(json_object_get(report, "agreeing")),
            (long long)json_integer_value(json_object_get(report, "expected")),
            json_string_value(json_array_get(devices, 0)),
            json_string_value(json_array_get(devices, 1)));
}

static enum neph_status compare(const struct request *request, struct neph_publication *publication,
                                struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &request->shared;
    const struct neph_conform_part part = {request->engines.words, request->engines.count,
                                           request->only.words, request->only.count};
    const enum neph_status status = neph_conform_compare(shared->operands[0], shared->operands[1],
                                                         &part, &publication->json, diag);
    if (status)
        return status;
    const long long expected = json_integer_value(json_object_get(publication->json, "expected"));
    const long long agreeing = json_integer_value(json_object_get(publication->json, "agreeing"));
    if (publication->text)
        print_comparison(publication->json, publication->text);
    if (expected == 0)
        publication->verdict = neph_fail(&publication->reason, NEPH_ERR_GATE,
                                         "there is nothing to compare in these folders");
    else if (agreeing < expected)
        publication->verdict = neph_fail(&publication->reason, NEPH_ERR_GATE,
                                         "%lld of %lld frames differ", expected - agreeing,
                                         expected);
    return NEPH_OK;
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    const struct request *request = request_;
    return request->shared.operand_count > 0 ? compare(request, publication, diag)
                                             : render(request, run, publication, diag);
}

enum neph_status neph_cli_conform(int argc, char **argv, struct neph_diag *diag)
{
    static const struct neph_experiment experiment = {.syntax = &syntax,
                                                      .request_size = sizeof(struct request),
                                                      .opens_stores = true,
                                                      .run = run};
    return neph_experiment_main(&experiment, argc, argv, diag);
}
