/* SPDX-License-Identifier: MIT
 *
 * `neph fly`: shows a scene in a window, with a camera that the user moves.
 */
#include "harness/cli/cli.h"

#include "harness/data.h"
#include "harness/engines/vulkan_device.h"
#include "harness/fly/fly.h"
#include "harness/run/seed.h"

#include <limits.h>
#include <stdio.h>

enum { FRAMES_MAX = 1000000 };

struct request {
    struct neph_cli_shared shared;
    const char *preset, *keys;
    int frame_count, seed;
};

static const struct neph_cli_option options[] = {
    {"preset", 0, NULL,
     "Preset of engine realtime to begin with; `neph engines realtime` "
     "lists them",
     NEPH_CLI_ONE, .at = offsetof(struct request, preset), .otherwise = "ours"},
    {.name = "set",
     .help = "A setting of engine realtime, in all presets; may be given several "
             "times"},
    {.name = "size", .otherwise = "320x180"},
    {"frames", 0, NULL, "Leave after N frames", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, frame_count), .minimum = 1, .maximum = FRAMES_MAX},
    {"keys", 0, "KEYS",
     "Press these keys, one after the other: KEY or KEY*FRAMES, such as \"w*60 x .*8 p\", . for "
     "none. The camera then moves by the scene's frame rate and not by the clock: the same flight "
     "each time, to compare times and frames",
     NEPH_CLI_WORD, .at = offsetof(struct request, keys)},
    {"seed", 0, NULL, "Random seed (default: one of the scene's own)", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, seed), .minimum = 0, .maximum = INT_MAX},
    {.name = "output", .help = "Folder for screenshots and recorded paths", .otherwise = "out/fly"},
    {.name = "json"},
    {.name = "quiet", .help = "Do not print the names of written files"},
    {.name = NULL},
};

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &neph_cli_one_scene,
    .doc =
        "Fly through a scene in a window: presets of realtime and march at a key, their error "
        "and their flicker as maps, times of all passes.\v"
        "W A S D, Q and E fly, the right button looks around, the wheel changes the speed. 0 to "
        "9 and B are presets, R and M realtime and march, C a line to drag between the two, X the "
        "error against march, F the flicker of a static camera, [ and ] the exposure, space "
        "stops sun and wind, T shows the time of each pass, H all keys. P writes "
        "DIR/SCENE_fly.exr and .png, K records the way as DIR/SCENE_path.yaml, a scene for "
        "every engine; no file is replaced. Needs SDL 2 and a display. At the end come the "
        "number of frames and the median of their times.\n\n"
        "Examples:\n"
        "  neph fly fence_backlit\n"
        "  neph fly cloud_below --size 640x360 --preset unity -s lighting=octaves\n"
        "  neph fly fence_backlit --frames 300 --keys \"w*60 d*60\" --json",
};

/* Print a median time; nothing if too few frames were shown for one. */
static void print_median(const json_t *result, const char *key, const char *what)
{
    const json_t *median_s = json_object_get(result, key);
    if (json_is_number(median_s))
        printf(", median %.3g ms %s", 1e3 * json_number_value(median_s), what);
}

static void print_result(const json_t *result)
{
    const json_t *file;
    size_t index;
    printf("%lld frames", (long long)json_integer_value(json_object_get(result, "frames")));
    print_median(result, "frame_median_s", "from frame to frame");
    print_median(result, "render_median_s", "to render");
    printf("\n");
    json_array_foreach(json_object_get(result, "files"), index, file)
        printf("%s\n", json_string_value(file));
}

static enum neph_status fly(const struct request *request, const struct neph_scene *scene,
                            struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &request->shared;
    struct neph_shared_device device = {.open = NULL};
    const struct neph_fly_params params = {
        .studio = {.scene = scene,
                   .width_px = shared->size.width_px,
                   .height_px = shared->size.height_px,
                   .settings = shared->settings.list,
                   .setting_count = shared->settings.count,
                   .device = &device,
                   .seed = request->seed >= 0 ? (uint64_t)request->seed
                                              : neph_seed_for_scene(scene, 1)},
        .preset = request->preset,
        .folder = shared->output,
        .keys = request->keys,
        .frame_limit = request->frame_count > 0 ? request->frame_count : 0,
    };
    json_t *result = NULL;
    enum neph_status status = neph_fly(&params, &result, diag);
    neph_shared_device_close(&device);
    if (!result)
        return status;
    if (!shared->json)
        print_result(result);
    const enum neph_status printed = neph_cli_print_json(result, shared->json,
                                                         status ? NULL : diag);
    return status ? status : printed;
}

enum neph_status neph_cli_fly(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    struct neph_scene *scene = NULL;
    enum neph_status status = neph_data_load_scene(request.shared.operands[0], &scene, diag);
    if (!status)
        status = neph_cli_open_folder(request.shared.output, diag);
    if (!status)
        status = fly(&request, scene, diag);
    neph_scene_destroy(scene);
    return status;
}
