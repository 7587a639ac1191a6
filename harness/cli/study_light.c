/* SPDX-License-Identifier: MIT
 *
 * `neph study light [SCENE...]`.
 */
#include "harness/cli/study.h"

#include "base/files.h"
#include "harness/data.h"
#include "harness/engines/vulkan_device.h"
#include "harness/physics/light_laws.h"
#include "harness/study/light_fit.h"
#include "harness/study/light_study_output.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct request {
    struct neph_cli_shared shared; /* operands: scenes */
    const char *models, *suite, *suns, *g, *albedo, *density, *csv, *markdown, *fit;
    double noise, sun_speed;
    int samples, steps;
    bool laws;
};

/* What was found; the laws where they were asked for. */
struct findings {
    struct neph_light_study study;
    struct neph_light_laws laws;
};

static const struct neph_cli_option options[] = {
    {"models", 0, "A,B",
     "Lighting models to hold against the tracer, by their engines; ENGINE+KEY=VALUE changes one, "
     "and ENGINE+preset=NAME has a preset's values (default: all that engines offer)",
     NEPH_CLI_WORD, .at = offsetof(struct request, models)},
    {"suite", 0, "NAME",
     "tuning: what models were fitted on; test: others (default, without a SCENE: test); test2: "
     "others again",
     NEPH_CLI_WORD, .at = offsetof(struct request, suite)},
    {"suns", 0, "E:A,E:A",
     "Elevations and azimuths of the sun in degrees; azimuth 0 is ahead of the camera, against the "
     "light, 180 behind it (default: as each SCENE has it; so are the next three)",
     NEPH_CLI_WORD, .at = offsetof(struct request, suns), .group = 1},
    {"g", 0, "A,B", "Mean cosines of Henyey-Greenstein", NEPH_CLI_WORD,
     .at = offsetof(struct request, g), .group = 1},
    {"albedo", 0, "A,B", "Albedos", NEPH_CLI_WORD, .at = offsetof(struct request, albedo),
     .group = 1},
    {"density", 0, "A,B", "Factors of the extinction", NEPH_CLI_WORD,
     .at = offsetof(struct request, density), .group = 1},
    {"sun-speed", 0, "DEG",
     "What remembers pictures sees the sun sink to its place by so many degrees a second, in 32 "
     "pictures, 60 a second",
     NEPH_CLI_REAL, .at = offsetof(struct request, sun_speed), .otherwise = "0", .minimum = 0,
     .maximum = 50},
    {.name = "size", .otherwise = "48x27"},
    {"steps", 0, "N", "Steps of every view ray", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, steps), .otherwise = "128", .minimum = 1, .maximum = 65536},
    {"noise", 0, "X",
     "The tracer stops at this rms standard error over rms radiance; its noise is taken out of "
     "what is reported",
     NEPH_CLI_REAL, .at = offsetof(struct request, noise), .otherwise = "0.2", .minimum = 1e-6,
     .maximum = 10},
    {"samples", 0, "N", "Or at so many samples a pixel", NEPH_CLI_INTEGER,
     .at = offsetof(struct request, samples), .otherwise = "1024", .minimum = 2,
     .maximum = 1 << 28},
    {.name = "output", .help = "Folder of the store and of light.svg", .otherwise = "out"},
    {.name = "json", .help = "All numbers as JSON on stdout, instead of the tables"},
    {"csv", 0, "FILE", "A line for each cell and model", NEPH_CLI_FILE,
     .at = offsetof(struct request, csv)},
    {"markdown", 0, "FILE", "The tables into a file, too", NEPH_CLI_FILE,
     .at = offsetof(struct request, markdown)},
    {"laws", 0, NULL,
     "Also hold the models to what they owe whatever the cloud: a white furnace, the balance of "
     "energy and reciprocity, against closed forms",
     NEPH_CLI_FLAG, .at = offsetof(struct request, laws)},
    {"fit", 0, "FILE",
     "Also fit octaves to what the tracer found, and write their coefficients as the file that "
     "renderer/octaves_fitted.c includes; not on the suite that they are judged by",
     NEPH_CLI_FILE, .at = offsetof(struct request, fit)},
    {.name = "quiet"},
    {.name = NULL},
};

static const struct neph_cli_operands operands = {.shown = "[SCENE...]"};

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    const bool has_sweep = request->suns || request->g || request->albedo || request->density;
    const char *suite = request->suite ? request->suite : "test";
    if (request->fit && request->shared.operand_count == 0 && strncmp(suite, "test", 4) == 0)
        argp_error(state, "the suite %s is what a fit is judged by: --fit has --suite tuning",
                   suite);
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
    .doc =
        "Render clouds with the lighting models of the ray marcher and with the tracer, and say "
        "how far each model is from all orders of scattering: by optical depth towards the eye and "
        "the sun, by the angle to the sun, and in the dense parts of every cell, which is a cloud "
        "with a sun, g and albedo.\v"
        "The light is a sun of 1 W/m2 alone: solids are black, and the sky is dark. The optical "
        "depth towards the sun is that of the first place before which half of the light is lost "
        "that the medium takes from the ray. Dense parts are pixels that less than a tenth comes "
        "through. The tracer renders twice, with two seeds, so that its noise can be taken out. "
        "NEPH_VULKAN_DEVICE names the device. What is finished stays in DIR/store, and the same "
        "command goes on from there.\n\n"
        "Examples:\n"
        "  neph study light --suite test --markdown light.md\n"
        "  neph study light cloud_below --suns 50:180,15:0 --g 0,0.85 --albedo 1,0.9\n"
        "  neph study light gaussian_blob --density 10 --models march_octaves",
};

/* ---- sweeps ---------------------------------------------------------------------------------- */

static enum neph_status read_number(const char *word, const char *what, double *value,
                                    struct neph_diag *diag)
{
    char *end;
    *value = strtod(word, &end);
    if (end == word || *end || !isfinite(*value))
        return neph_fail(diag, NEPH_ERR_USAGE, "--%s: '%s' is no number", what, word);
    return NEPH_OK;
}

/* "A,B"; none of NULL. */
static enum neph_status read_list(const char *text, const char *what,
                                  double list[NEPH_LIGHT_SWEEP_MAX], int *count,
                                  struct neph_diag *diag)
{
    const char *words[NEPH_LIGHT_SWEEP_MAX];
    char *copy = strdup(text ? text : "");
    enum neph_status status = copy ? NEPH_OK : neph_fail_memory(diag);
    if (!status && text)
        status = neph_cli_split(copy, what, NEPH_LIGHT_SWEEP_MAX, words, count, diag);
    for (int i = 0; i < *count && !status; i++)
        status = read_number(words[i], what, &list[i], diag);
    free(copy);
    return status;
}

static enum neph_status read_sun(const char *word, double sun_deg[2], struct neph_diag *diag)
{
    char *end;
    sun_deg[0] = strtod(word, &end);
    if (end == word || *end != ':' || !isfinite(sun_deg[0]))
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "--suns: '%s' is no elevation and azimuth, such as 50:180", word);
    return read_number(end + 1, "suns", &sun_deg[1], diag);
}

static enum neph_status read_suns(const char *text, struct neph_light_sweep *sweep,
                                  struct neph_diag *diag)
{
    const char *words[NEPH_LIGHT_SWEEP_MAX];
    char *copy = strdup(text ? text : "");
    enum neph_status status = copy ? NEPH_OK : neph_fail_memory(diag);
    if (!status && text)
        status = neph_cli_split(copy, "suns", NEPH_LIGHT_SWEEP_MAX, words, &sweep->sun_count, diag);
    for (int i = 0; i < sweep->sun_count && !status; i++)
        status = read_sun(words[i], sweep->suns_deg[i], diag);
    free(copy);
    return status;
}

static enum neph_status read_sweep(const struct request *request, struct neph_light_sweep *sweep,
                                   struct neph_diag *diag)
{
    enum neph_status status = read_suns(request->suns, sweep, diag);
    if (!status)
        status = read_list(request->g, "g", sweep->g, &sweep->g_count, diag);
    if (!status)
        status = read_list(request->albedo, "albedo", sweep->albedo, &sweep->albedo_count, diag);
    if (!status)
        status = read_list(request->density, "density", sweep->density, &sweep->density_count,
                           diag);
    return status;
}

/* The scenes that were named, each with the sweep. */
static enum neph_status list_entries(const struct request *request,
                                     struct neph_light_entry **entries, int *count,
                                     struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &request->shared;
    struct neph_light_sweep sweep = {.sun_count = 0};
    enum neph_status status = read_sweep(request, &sweep, diag);
    if (!status)
        status = neph_data_check_scenes(shared->operands, shared->operand_count, diag);
    if (status)
        return status;
    struct neph_light_entry *made = calloc((size_t)shared->operand_count, sizeof(*made));
    for (int i = 0; made && i < shared->operand_count; i++) {
        made[i] = (struct neph_light_entry){
            .scene = strdup(shared->operands[i]), .sweep_count = 1, .sweeps = {sweep}};
        if (!made[i].scene)
            status = neph_fail_memory(diag);
    }
    if (!made || status) {
        neph_light_entries_free(made, made ? shared->operand_count : 0);
        return neph_fail_memory(diag);
    }
    *entries = made;
    *count = shared->operand_count;
    return NEPH_OK;
}

/* ---- results --------------------------------------------------------------------------------- */

typedef enum neph_status writer(const struct neph_light_study *study, char **text,
                                struct neph_diag *diag);

static enum neph_status write_file(const char *path, writer *write,
                                   const struct neph_light_study *study, struct neph_diag *diag)
{
    char *text = NULL;
    enum neph_status status = write(study, &text, diag);
    if (!status)
        status = neph_file_write(path, text, strlen(text), diag);
    free(text);
    return status;
}

/* The study, and the laws below it; for the caller to free. */
static enum neph_status make_text(const struct request *request, const struct findings *found,
                                  char **text, struct neph_diag *diag)
{
    char *tables = NULL, *laws = NULL;
    enum neph_status status = neph_light_study_text(&found->study, &tables, diag);
    if (!status && request->laws)
        status = neph_light_laws_text(&found->laws, &laws, diag);
    if (!status && asprintf(text, "%s%s", tables, laws ? laws : "") < 0)
        status = neph_fail_memory(diag);
    free(laws);
    free(tables);
    return status;
}

static json_t *make_json(const struct request *request, const struct findings *found)
{
    json_t *made = neph_light_study_json(&found->study);
    if (request->laws)
        neph_json_set(&made, "laws", neph_light_laws_json(&found->laws));
    return made;
}

static enum neph_status print_results(const struct request *request, const struct findings *found,
                                      struct neph_diag *diag)
{
    char *text = NULL;
    if (request->shared.json && !request->markdown)
        return neph_json_print(make_json(request, found), diag);
    enum neph_status status = make_text(request, found, &text, diag);
    if (!status && request->markdown)
        status = neph_file_write(request->markdown, text, strlen(text), diag);
    if (!status && request->shared.json)
        status = neph_json_print(make_json(request, found), diag);
    else if (!status)
        fputs(text, stdout);
    free(text);
    return status;
}

static enum neph_status write_fit(const char *path, const struct neph_light_study *study,
                                  struct neph_diag *diag)
{
    struct neph_octaves_fit fit;
    char *text = NULL;
    enum neph_status status = neph_light_fit(study, &fit, diag);
    if (!status)
        status = neph_light_fit_text(study, &fit, &text, diag);
    if (!status)
        status = neph_file_write(path, text, strlen(text), diag);
    free(text);
    return status;
}

static enum neph_status write_all(const struct request *request, const struct findings *found,
                                  struct neph_diag *diag)
{
    const struct neph_light_study *study = &found->study;
    char *svg = neph_path_join(request->shared.output, "light.svg");
    enum neph_status status = svg ? print_results(request, found, diag) : neph_fail_memory(diag);
    if (!status && request->csv)
        status = write_file(request->csv, neph_light_study_csv, study, diag);
    if (!status)
        status = write_file(svg, neph_light_study_plot, study, diag);
    if (!status && request->fit)
        status = write_fit(request->fit, study, diag);
    if (!status && study->failed_count > 0)
        status = neph_fail(diag, NEPH_ERR_ENGINE, "%d cells broke; their lines say why",
                           study->failed_count);
    free(svg);
    return status;
}

/* ---- the verb -------------------------------------------------------------------------------- */

static enum neph_status run(const struct request *request,
                            const struct neph_light_study_params *params, struct neph_diag *diag)
{
    struct neph_store *store = NULL;
    struct findings found = {.study = {.params = params}};
    char *folder = neph_path_join(request->shared.output, "store");
    enum neph_status status = folder ? neph_store_open(folder, &store, diag)
                                     : neph_fail_memory(diag);
    if (!status)
        status = neph_light_study_run(params, store, &found.study, diag);
    if (!status && request->laws)
        status = neph_light_laws_run(params->models, params->model_count, params->steps,
                                     params->device, store, &found.laws, diag);
    if (!status)
        status = write_all(request, &found, diag);
    neph_light_study_finish(&found.study);
    neph_store_close(store);
    free(folder);
    return status;
}

enum neph_status neph_cli_study_light(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {0};
    neph_cli_parse(&syntax, argc, argv, &request);
    const struct neph_cli_shared *shared = &request.shared;
    const char *models[NEPH_LIGHT_MODELS_MAX];
    struct neph_light_entry *entries = NULL;
    char *words = request.models ? strdup(request.models) : neph_light_models_offered();
    struct neph_shared_device device = {.open = NULL};
    struct neph_light_study_params params = {.models = models,
                                             .width_px = shared->size.width_px,
                                             .height_px = shared->size.height_px,
                                             .steps = request.steps,
                                             .noise = request.noise,
                                             .samples = request.samples,
                                             .sun_speed_rad_per_s = request.sun_speed *
                                                                    NEPH_RAD_PER_DEG,
                                             .with_lit = request.fit != NULL,
                                             .device = &device,
                                             .quiet = shared->quiet};
    enum neph_status status = words ? neph_cli_split(words, "models", NEPH_LIGHT_MODELS_MAX, models,
                                                     &params.model_count, diag)
                                    : neph_fail_memory(diag);
    if (!status && shared->operand_count > 0)
        status = list_entries(&request, &entries, &params.entry_count, diag);
    else if (!status)
        status = neph_light_suite_find(request.suite ? request.suite : "test", &entries,
                                       &params.entry_count, diag);
    params.entries = entries;
    if (!status)
        status = run(&request, &params, diag);
    neph_shared_device_close(&device);
    neph_light_entries_free(entries, params.entry_count);
    free(words);
    return status;
}
