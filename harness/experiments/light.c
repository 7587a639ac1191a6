/* SPDX-License-Identifier: MIT
 *
 * `neph study light [SCENE...]`: lighting models against the tracer (light.h).
 */
#include "harness/experiments/light.h"

#include "base/files.h"
#include "base/written.h"
#include "harness/data.h"
#include "harness/experiments/experiments.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define AT(member) .at = offsetof(struct neph_light_request, member)
static const struct neph_cli_option options[] = {
    {"model", 0, NULL,
     "Lighting models to compare with the tracer, by their engines; ENGINE+KEY=VALUE changes one, "
     "and ENGINE+preset=NAME has a preset's values (default: all that engines offer)",
     NEPH_CLI_LIST, AT(models), .maximum = NEPH_LIGHT_MODELS_MAX},
    {"suite", 0, NULL,
     "tuning: the clouds that models were fitted to; test, test2: other clouds (default without a "
     "SCENE: test)",
     NEPH_CLI_WORD, AT(suite)},
    {"suns", 0, "E:A,E:A",
     "Elevations and azimuths of the sun in degrees; azimuth 0 is ahead of the camera, against the "
     "light, 180 behind it (default: as each SCENE has it; so are the next three)",
     NEPH_CLI_LIST, AT(suns), .group = 1, .maximum = NEPH_LIGHT_SWEEP_MAX},
    {"g", 0, "A,B", "Mean cosines of Henyey-Greenstein", NEPH_CLI_NUMBERS, AT(g), .group = 1,
     .maximum = NEPH_LIGHT_SWEEP_MAX},
    {"albedo", 0, "A,B", "Albedos", NEPH_CLI_NUMBERS, AT(albedo), .group = 1,
     .maximum = NEPH_LIGHT_SWEEP_MAX},
    {"density", 0, "A,B", "Factors of the extinction", NEPH_CLI_NUMBERS, AT(density), .group = 1,
     .maximum = NEPH_LIGHT_SWEEP_MAX},
    {"sun-speed", 0, "DEG",
     "For models with a history: the sun sinks to its place at so many degrees per second, in 32 "
     "frames at 60 Hz",
     NEPH_CLI_REAL, AT(sun_speed_deg_per_s), "0", 0, 50},
    {.name = "size", .otherwise = "48x27"},
    {"steps", 0, NULL, "Steps of every view ray", NEPH_CLI_INTEGER, AT(steps), "128", 1, 65536},
    {"noise-limit", 0, "X",
     "The tracer stops at this rms standard error over rms radiance; its noise is removed from the "
     "results",
     NEPH_CLI_REAL, AT(noise), "0.2", 1e-6, 10},
    {"samples", 0, NULL, "Or at so many samples a pixel", NEPH_CLI_INTEGER, AT(samples), "1024", 2,
     1 << 28},
    {.name = "jobs", .otherwise = "1"},
    {.name = "output", .help = "Folder of the store and of light.svg", .otherwise = "out/study"},
    {.name = "all", .help = "The tables of all models and cells"},
    {.name = "json", .help = "All numbers as JSON on stdout"},
    {.name = "csv", .help = "A line for each cell and model"},
    {.name = "markdown"},
    {"laws", 0, NULL,
     "Also test the models by laws of every cloud: a white furnace, the balance of energy and "
     "reciprocity, against closed forms",
     NEPH_CLI_FLAG, AT(laws)},
    {"fit", 0, "FILE",
     "Also fit octaves to the tracer's results, and write their coefficients as the file that "
     "renderer/octaves_fitted.c includes; not with the suite of the evaluation",
     NEPH_CLI_FILE, AT(fit)},
    {.name = "quiet"},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_operands operands = {.shown = "[SCENE...]"};

static void check(const void *request_, const struct argp_state *state)
{
    const struct neph_light_request *request = request_;
    const bool has_sweep = request->suns.count || request->g.count || request->albedo.count ||
                           request->density.count;
    const char *suite = request->suite ? request->suite : "test";
    if (request->fit && request->shared.operand_count == 0 && strncmp(suite, "test", 4) == 0)
        argp_error(state, "the suite %s evaluates fits: use --fit with --suite tuning", suite);
    if (request->suite && request->shared.operand_count > 0)
        argp_error(state, "a suite or scenes by name, not both");
    if (has_sweep && request->shared.operand_count == 0)
        argp_error(state, "--suns, --g, --albedo and --density are of a SCENE: suites have their "
                          "own");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc = "Render clouds with the lighting models of the ray marcher and with the tracer, and "
           "print how far each model is from all orders of scattering: by optical depth towards "
           "the camera and the sun, by the angle to the sun, and in the dense parts of every cell. "
           "A cell is a cloud with a sun, g and albedo.\vThe only light is a sun of 1 W/m2: solids "
           "are black, and the sky is dark. The optical depth towards the sun is measured at the "
           "first place before which the medium takes half of the extinction of the whole ray. "
           "Dense parts are pixels with a transmittance below a tenth. The tracer renders twice, "
           "with two seeds, so that its noise can be removed. NEPH_VULKAN_DEVICE names the device. "
           "Finished frames stay in DIR/store, and the same command continues from there.\n"
           "\n"
           "Examples:\n"
           "  neph study light --suite test --markdown light.md\n"
           "  neph study light cloud_below --suns 50:180,15:0 --g 0,0.85 --albedo 1,0.9\n"
           "  neph study light gaussian_blob --density 10 --model march_octaves",
};

/* ---- cells ----------------------------------------------------------------------------------- */

/* Parse "ELEVATION:AZIMUTH" in degrees. */
static enum neph_status read_sun(const char *word, double sun_deg[2], struct neph_diag *diag)
{
    char *end;
    sun_deg[0] = strtod(word, &end);
    if (end == word || *end != ':' || !isfinite(sun_deg[0]))
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "--suns: '%s' is no elevation and azimuth, such as 50:180", word);
    const char *second = end + 1;
    sun_deg[1] = strtod(second, &end);
    if (end == second || *end || !isfinite(sun_deg[1]))
        return neph_fail(diag, NEPH_ERR_USAGE, "--suns: '%s' is no number", second);
    return NEPH_OK;
}

static int copy_numbers(const struct neph_cli_list *list, double numbers[NEPH_LIGHT_SWEEP_MAX])
{
    memcpy(numbers, list->numbers, (size_t)list->count * sizeof(*numbers));
    return list->count;
}

/* The named scenes, each with the sweep. */
static enum neph_status list_entries(struct neph_light_request *request, struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &request->shared;
    struct neph_light_sweep sweep = {.sun_count = request->suns.count};
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < sweep.sun_count && !status; i++)
        status = read_sun(request->suns.words[i], sweep.suns_deg[i], diag);
    if (!status)
        status = neph_data_check_scenes(shared->operands, shared->operand_count, diag);
    if (status)
        return status;
    sweep.g_count = copy_numbers(&request->g, sweep.g);
    sweep.albedo_count = copy_numbers(&request->albedo, sweep.albedo);
    sweep.density_count = copy_numbers(&request->density, sweep.density);
    request->entry_count = shared->operand_count;
    request->entries = neph_arena_allocate(&request->arena, (size_t)shared->operand_count,
                                           sizeof(*request->entries));
    for (int i = 0; request->entries && i < shared->operand_count; i++)
        request->entries[i] = (struct neph_light_entry){
            .scene = shared->operands[i], .sweep_count = 1, .sweeps = {sweep}};
    return neph_arena_check(&request->arena, diag);
}

static enum neph_status offer_models(struct neph_cli_list *models, struct neph_diag *diag)
{
    models->text = neph_light_models_list();
    return models->text ? neph_cli_split(models->text, "models", NEPH_LIGHT_MODELS_MAX,
                                         models->words, &models->count, diag)
                        : neph_fail_memory(diag);
}

static enum neph_status prepare(void *request_, struct neph_diag *diag)
{
    struct neph_light_request *request = request_;
    enum neph_status status = request->models.count ? NEPH_OK
                                                    : offer_models(&request->models, diag);
    request->only_cell = -1;
    if (status)
        return status;
    return request->shared.operand_count > 0
               ? list_entries(request, diag)
               : neph_light_suite_find(request->suite ? request->suite : "test", &request->arena,
                                       &request->entries, &request->entry_count, diag);
}

static void finish(void *request)
{
    neph_arena_finish(&((struct neph_light_request *)request)->arena);
}

/* A job for each cell, and one for the laws. */
static bool part(void *request_, int index)
{
    struct neph_light_request *request = request_;
    const int cell_count = neph_light_cell_count(request);
    request->laws &= index == cell_count;
    request->only_cell = index;
    request->fit = NULL;
    return index < cell_count || request->laws;
}

/* ---- the run --------------------------------------------------------------------------------- */

struct fitted {
    const struct neph_light_study *study;
    struct neph_octaves_fit fit;
};

static void print_fit(const void *what, FILE *out)
{
    const struct fitted *fitted = what;
    neph_light_fit_print(fitted->study, &fitted->fit, out);
}

static enum neph_status write_fit(const struct neph_light_study *study, struct neph_diag *diag)
{
    struct fitted fitted = {.study = study};
    char *text = NULL;
    enum neph_status status = neph_light_fit(study, &fitted.fit, diag);
    if (!status)
        status = neph_write_to_text(print_fit, &fitted, &text, diag);
    if (!status)
        status = neph_file_write(study->request->fit, text, strlen(text), diag);
    free(text);
    return status;
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    const struct neph_light_request *request = request_;
    struct neph_light_study *study = calloc(1, sizeof(*study));
    if (!study)
        return neph_fail_memory(diag);
    study->request = request;
    study->run = run;
    enum neph_status status = neph_light_measure(study, diag);
    if (!status && request->laws)
        status = neph_light_laws_run(request->models.words, request->models.count, request->steps,
                                     run->device, run->store, &study->laws, diag);
    if (!status && request->only_cell < 0)
        status = neph_light_publish(study, publication, diag);
    if (!status && request->fit)
        publication->verdict = write_fit(study, &publication->reason);
    neph_light_study_finish(study);
    free(study);
    return status;
}

const struct neph_experiment neph_experiment_light = {
    .syntax = &syntax,
    .request_size = sizeof(struct neph_light_request),
    .chart = "light.svg",
    .prepare = prepare,
    .part = part,
    .run = run,
    .finish = finish};
