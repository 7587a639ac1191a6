/* SPDX-License-Identifier: MIT
 *
 * `neph study screen [SCENE...]`.
 */
#include "harness/cli/study.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/vulkan_device.h"
#include "harness/study/screen_page.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared; /* operands: scenes */
    const char *models, *markdown;
    int samples, rays, witness_samples, frame_count;
    double radius_m;
};

static const struct neph_cli_option options[] = {
    {"models", 0, "A,B", "Screens to hold against the truth; screen+KEY=VALUE+... changes one",
     NEPH_CLI_WORD, .at = offsetof(struct request, models),
     .otherwise = "screen,screen+preset=ours,screen+preset=fast,screen+preset=slices"},
    {"radius", 0, "M", "Ambient occlusion: what is farther hides nothing [m]", NEPH_CLI_REAL,
     .at = offsetof(struct request, radius_m), .otherwise = "1", .minimum = 1e-3, .maximum = 1e6},
    {.name = "size", .otherwise = "96x54"},
    {"samples", 0, "N", "Samples a pixel of the truth", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, samples), .otherwise = "256", .minimum = 2, .maximum = 1 << 24},
    {"rays", 0, "N", "Rays a pixel, to say why it is lost", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, rays), .otherwise = "64", .minimum = 1, .maximum = 1 << 16},
    {"cycles", 0, "N",
     "Hold them against Cycles' passes, too, with N samples a pixel; 0: it is not asked",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, witness_samples), .otherwise = "0",
     .minimum = 0, .maximum = 1 << 16},
    {"frames", 0, "N",
     "Pictures, over which error and flicker of the whole are measured, at least 16; a scene that "
     "moves has as many as it has; 0: none",
     NEPH_CLI_INTEGER, .at = offsetof(struct request, frame_count), .otherwise = "0", .minimum = 0,
     .maximum = 1024},
    {.name = "output", .help = "Folder of the store and of screen/", .otherwise = "out"},
    {.name = "json", .help = "All numbers as JSON on stdout, instead of the tables"},
    {"markdown", 0, "FILE", "The tables into a file, too", NEPH_CLI_FILE,
     .at = offsetof(struct request, markdown)},
    {.name = "quiet"},
    {.name = NULL},
};

static const struct neph_cli_operands operands = {
    .shown = "[SCENE...]", .maximum = NEPH_SCREEN_SCENES_MAX, .surplus = "so many scenes"};

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    if (request->frame_count > 0 && request->frame_count < 16)
        argp_error(state, "--frames=%d: flicker wants 16 frames or more, 0 is none",
                   request->frame_count);
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc =
        "Render solids with passes on a G-buffer, and say how far ambient occlusion, indirect "
        "light and reflections are from the truth (engine surfaces): what is the method's own, and "
        "what no screen can know, being off the picture or behind what it shows. Without a SCENE: "
        "the surface_ scenes of the catalogue.\v"
        "What is finished stays in DIR/store, and the same command goes on from there. "
        "DIR/screen/index.html shows which pixels no screen can know, and why.\n\n"
        "Examples:\n"
        "  neph study screen --markdown screen.md\n"
        "  neph study screen surface_corner --models screen,screen+preset=ours --radius 2\n"
        "  neph study screen surface_room --models screen+preset=ours,screen+preset=fast\n"
        "  neph study screen --cycles 256\n"
        "  neph study screen surface_ground --frames 32 --models "
        "screen,screen+gi=off,screen+ssr=off",
};

static const char *const usual_scenes[] = {"surface_step",   "surface_corner", "surface_room",
                                           "surface_ground", "surface_mirror", "surface_rough"};

static enum neph_status print_results(const struct request *request,
                                      const struct neph_screen_study *study, struct neph_diag *diag)
{
    char *text = NULL;
    enum neph_status status = neph_screen_study_text(study, &text, diag);
    if (!status && request->markdown)
        status = neph_file_write(request->markdown, text, strlen(text), diag);
    if (!status && request->shared.json)
        status = neph_json_print(neph_screen_study_json(study), diag);
    else if (!status)
        fputs(text, stdout);
    free(text);
    return status;
}

static enum neph_status run(const struct request *request,
                            const struct neph_screen_study_params *params, struct neph_diag *diag)
{
    struct neph_store *store = NULL;
    struct neph_screen_study *study = calloc(1, sizeof(*study));
    char *folder = neph_path_join(request->shared.output, "store");
    char *page = neph_path_join(request->shared.output, "screen");
    enum neph_status status = folder && page && study ? neph_screen_page_claim(page, diag)
                                                      : neph_fail_memory(diag);
    if (!status)
        status = neph_store_open(folder, &store, diag);
    if (!status)
        status = neph_screen_study_run(params, store, study, diag);
    if (!status)
        status = neph_screen_page_write(study, page, diag);
    if (!status)
        status = print_results(request, study, diag);
    if (study)
        neph_screen_study_finish(study);
    neph_store_close(store);
    free(page);
    free(folder);
    free(study);
    return status;
}

static enum neph_status load_scenes(const struct neph_cli_shared *shared,
                                    struct neph_scene *scenes[NEPH_SCREEN_SCENES_MAX], int *count,
                                    struct neph_diag *diag)
{
    const int asked = shared->operand_count;
    const int wanted = asked > 0 ? asked : (int)(sizeof(usual_scenes) / sizeof(usual_scenes[0]));
    enum neph_status status = NEPH_OK;
    for (*count = 0; *count < wanted && !status; *count += !status)
        status = neph_data_load_scene(asked > 0 ? shared->operands[*count] : usual_scenes[*count],
                                      &scenes[*count], diag);
    return status;
}

enum neph_status neph_cli_study_screen(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const char *models[NEPH_LIGHT_MODELS_MAX];
    struct neph_scene *scenes[NEPH_SCREEN_SCENES_MAX];
    struct neph_shared_device device = {.open = NULL};
    struct neph_screen_study_params params = {.scenes = scenes,
                                              .models = models,
                                              .width_px = request.shared.size.width_px,
                                              .height_px = request.shared.size.height_px,
                                              .samples = request.samples,
                                              .radius_m = request.radius_m,
                                              .rays = request.rays,
                                              .witness_samples = request.witness_samples,
                                              .frame_count = request.frame_count,
                                              .device = &device,
                                              .quiet = request.shared.quiet};
    char *words = strdup(request.models);
    enum neph_status status = words ? neph_cli_split(words, "models", NEPH_LIGHT_MODELS_MAX, models,
                                                     &params.model_count, diag)
                                    : neph_fail_memory(diag);
    if (!status)
        status = load_scenes(&request.shared, scenes, &params.scene_count, diag);
    if (!status)
        status = run(&request, &params, diag);
    for (int i = 0; i < params.scene_count; i++)
        neph_scene_destroy(scenes[i]);
    neph_shared_device_close(&device);
    free(words);
    return status;
}
