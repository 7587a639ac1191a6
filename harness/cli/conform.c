/* SPDX-License-Identifier: MIT
 *
 * `neph conform` and `neph conform A B`.
 */
#include "harness/cli/cli.h"

#include "harness/data.h"
#include "harness/run/conform.h"

#include <argp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { KEY_JSON = 1, KEY_SIZE, KEY_SCENE, KEY_PICTURES, KEY_SAMPLES, SCENES_MAX = 256 };

struct request {
    const char *folders[2]; /* to compare; NULL: render */
    const char *engine, *size, *output, *pictures, *samples;
    const char *scenes[SCENES_MAX];
    int scene_count;
    bool json, quiet;
};

static const struct argp_option options[] = {
    {"size", KEY_SIZE, "WxH", 0, "Size in pixels (default: 1920x1080)", 0},
    {"scene", KEY_SCENE, "SCENE", 0,
     "A file, or a name of the catalogue; may be given several times (default: the catalogue and "
     "scenes/failure)",
     0},
    {"engine", 'e', "ENGINE", 0,
     "One of march, march_octaves, march_horizon, tracer, realtime (default: all)", 0},
    {"frames", KEY_PICTURES, "N", 0,
     "Pictures of realtime, counted all and the last kept "
     "(default: 6)",
     0},
    {"samples", KEY_SAMPLES, "N", 0, "Paths per pixel of tracer (default: 16)", 0},
    {"output", 'o', "DIR", 0, "Folder of what is kept (default: out/conform)", 0},
    {"json", KEY_JSON, NULL, 0, "Everything as JSON on stdout", 0},
    {"quiet", 'q', NULL, 0, "No progress", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct request *request = state->input;
    switch (key) {
    case KEY_JSON:
        request->json = true;
        return 0;
    case 'q':
        request->quiet = true;
        return 0;
    case KEY_SIZE:
        request->size = argument;
        return 0;
    case KEY_SCENE:
        if (request->scene_count == SCENES_MAX)
            argp_error(state, "more than %d scenes", SCENES_MAX);
        request->scenes[request->scene_count++] = argument;
        return 0;
    case 'e':
        request->engine = argument;
        return 0;
    case KEY_PICTURES:
        request->pictures = argument;
        return 0;
    case KEY_SAMPLES:
        request->samples = argument;
        return 0;
    case 'o':
        if (!argument[0])
            argp_error(state, "the output folder has no name");
        request->output = argument;
        return 0;
    case ARGP_KEY_ARG:
        if (state->arg_num > 1)
            argp_error(state, "two folders, not '%s' as well", argument);
        request->folders[state->arg_num] = argument;
        return 0;
    case ARGP_KEY_END:
        if (request->folders[0] && !request->folders[1])
            argp_error(state, "which folder to compare '%s' with?", request->folders[0]);
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

static const struct argp argp = {
    .options = options,
    .parser = parse,
    .args_doc = "\nA B",
    .doc =
        "Render every scene at a real size with every engine of ours that runs on a Vulkan "
        "device, and count what is not finite or below zero: exit 1 if anything is. Or hold two "
        "such folders, of two devices, against each other: exit 1 if a picture is further apart "
        "than float32 and each engine's own decisions explain; --scene and --engine compare a "
        "part.\v"
        "DIR gets SCENE.json with counts, means and hashes of whole pictures, and 48x27 pixels "
        "of each as EXR: small enough to carry from one machine to another. Scenes may be "
        "rendered by several runs into one folder. The device is lavapipe unless "
        "NEPH_VULKAN_DEVICE names part of another's name.\n\n"
        "Examples:\n"
        "  NEPH_VULKAN_DEVICE=nvidia neph conform -o gpu\n"
        "  NEPH_VULKAN_DEVICE=nvidia neph conform --size 3840x2160 --scene cloud_below -o gpu4k\n"
        "  neph conform --size 192x108 -o cpu\n"
        "  neph conform cpu gpu",
};

/* --- render ------------------------------------------------------------------------------- */

static enum neph_status append_all(enum neph_data_scenes which, char **names, int *count,
                                   struct neph_diag *diag)
{
    char **list;
    int found = 0;
    const enum neph_status status = neph_data_list_scenes(which, &list, &found, diag);
    if (status)
        return status;
    for (int i = 0; i < found && *count < SCENES_MAX; i++) {
        names[(*count)++] = list[i];
        list[i] = NULL;
    }
    free(list);
    return NEPH_OK;
}

static enum neph_status list_scenes(const struct request *request, char *names[SCENES_MAX + 1],
                                    int *count, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < request->scene_count && !status; i++) {
        names[*count] = strdup(request->scenes[i]);
        status = names[(*count)++] ? NEPH_OK : neph_fail_memory(diag);
    }
    if (request->scene_count == 0)
        for (int which = 0; which < NEPH_DATA_SCENES_COUNT && !status; which++)
            status = append_all(which, names, count, diag);
    return status;
}

static void print_wrong(const json_t *report)
{
    size_t i, j;
    json_t *scene, *entry;
    json_array_foreach(report, i, scene)
    {
        const char *absent = json_string_value(json_object_get(scene, "absent"));
        if (absent)
            printf("%s: left out: %s\n", json_string_value(json_object_get(scene, "scene")),
                   absent);
        json_array_foreach(json_object_get(scene, "pictures"), j, entry)
        {
            const char *reason = json_string_value(json_object_get(entry, "reason"));
            const char *wrong = json_string_value(json_object_get(entry, "first_wrong"));
            const char *outcome = json_string_value(json_object_get(entry, "outcome"));
            if (strcmp(outcome, "failed") == 0 || wrong[0])
                printf("%s: %s\n", json_string_value(json_object_get(entry, "picture")),
                       wrong[0] ? wrong : reason);
        }
    }
}

static enum neph_status render(const struct request *request, struct neph_diag *diag)
{
    char *names[SCENES_MAX + 1] = {NULL};
    struct neph_conform_params params = {.folder = request->output,
                                         .scenes = names,
                                         .engine = request->engine,
                                         .skip_absent = request->scene_count == 0,
                                         .quiet = request->quiet || request->json};
    json_t *report = NULL;
    int expected = 0, sound = 0;
    enum neph_status status = neph_cli_parse_size(request->size, &params.width_px,
                                                  &params.height_px, diag);
    if (!status)
        status = neph_cli_parse_int("number of pictures", request->pictures, 1, 1000,
                                    &params.pictures, diag);
    if (!status)
        status = neph_cli_parse_int("number of samples", request->samples, 2, 1000000,
                                    &params.samples, diag);
    if (!status)
        status = list_scenes(request, names, &params.scene_count, diag);
    if (!status)
        status = neph_conform_render(&params, &report, diag);
    for (int i = 0; i < params.scene_count; i++)
        free(names[i]);
    if (status)
        return status;
    neph_conform_count(report, &expected, &sound);
    if (request->json) {
        status = neph_cli_print_json(report, diag);
    } else {
        print_wrong(report);
        printf("%d of %d pictures are finite and nowhere negative\n", sound, expected);
        json_decref(report);
    }
    if (status)
        return status;
    if (expected == 0)
        return neph_fail(diag, NEPH_ERR_GATE, "no engine could render any of these scenes");
    if (sound < expected)
        return neph_fail(diag, NEPH_ERR_GATE, "%d of %d pictures are not as they should be",
                         expected - sound, expected);
    return NEPH_OK;
}

/* --- compare ------------------------------------------------------------------------------ */

static void print_comparison(const json_t *report)
{
    size_t i;
    json_t *picture;
    const json_t *devices = json_object_get(report, "devices");
    json_array_foreach(json_object_get(report, "pictures"), i, picture)
    {
        if (!json_is_true(json_object_get(picture, "agrees")))
            printf("%s: %s\n", json_string_value(json_object_get(picture, "picture")),
                   json_string_value(json_object_get(picture, "because")));
    }
    printf("%lld of %lld pictures agree between %s and %s\n",
           (long long)json_integer_value(json_object_get(report, "agreeing")),
           (long long)json_integer_value(json_object_get(report, "expected")),
           json_string_value(json_array_get(devices, 0)),
           json_string_value(json_array_get(devices, 1)));
}

static enum neph_status compare(const struct request *request, struct neph_diag *diag)
{
    json_t *report = NULL;
    const struct neph_conform_part part = {request->engine, request->scenes, request->scene_count};
    enum neph_status status = neph_conform_compare(request->folders[0], request->folders[1], &part,
                                                   &report, diag);
    if (status)
        return status;
    const long long expected = json_integer_value(json_object_get(report, "expected"));
    const long long agreeing = json_integer_value(json_object_get(report, "agreeing"));
    if (request->json) {
        status = neph_cli_print_json(report, diag);
    } else {
        print_comparison(report);
        json_decref(report);
    }
    if (status)
        return status;
    if (expected == 0)
        return neph_fail(diag, NEPH_ERR_GATE, "there is nothing to compare in these folders");
    if (agreeing < expected)
        return neph_fail(diag, NEPH_ERR_GATE, "%lld of %lld pictures differ", expected - agreeing,
                         expected);
    return NEPH_OK;
}

enum neph_status neph_cli_conform(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {
        .size = "1920x1080", .output = "out/conform", .pictures = "6", .samples = "16"};
    neph_cli_parse(&argp, argc, argv, &request);
    return request.folders[0] ? compare(&request, diag) : render(&request, diag);
}
