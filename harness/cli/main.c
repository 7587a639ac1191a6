/* SPDX-License-Identifier: MIT
 *
 * The program `neph`: the table of verbs, its help, and the exit code.
 */
#include "harness/cli/cli.h"

#include "base/interrupt.h"
#include "base/text.h"
#include "harness/experiments/experiments.h"
#include "harness/surroundings.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdio_ext.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const struct {
    const char *name;
    neph_verb *run; /* NULL: see `experiment` */
    const struct neph_experiment *experiment;
    const char *help;
} verbs[] = {
    {"validate", NULL, &neph_experiment_validate,
     "run scenes over all engines, gate the errors, write a report"},
    {"study", neph_cli_study, NULL,
     "longer measurements: steps against their limit, flicker of presets"},
    {"ablate", NULL, &neph_experiment_ablation,
     "quality and cost of each part of the real-time renderer"},
    {"render", neph_cli_render, NULL, "render a scene with one engine"},
    {"fly", neph_cli_fly, NULL, "fly through a scene in a window: presets, errors, flicker, times"},
    {"export", neph_cli_export, NULL, "leave a scene as files for Blender or POV-Ray"},
    {"bake", neph_cli_bake, NULL, "a medium of a scene as a volume file, with its error"},
    {"droplets", neph_cli_droplets, NULL,
     "extinction, albedo and phase function of cloud droplets from their sizes"},
    {"fluxes", neph_cli_fluxes, NULL,
     "sunlight that columns of a scene reflect, transmit and absorb, with errors"},
    {"benchmark", neph_cli_benchmark, NULL, "how long engines take for the same noise"},
    {"sweep", NULL, &neph_experiment_sweep,
     "speed against accuracy of engines and settings over a scene"},
    {"scaling", NULL, &neph_experiment_scaling,
     "how cost grows with pixels, steps, voxels, density, frames"},
    {"pick", NULL, &neph_experiment_pick,
     "the cheapest configuration of a scene that is good enough"},
    {"compare", neph_cli_compare, NULL,
     "measure the error of frames of any renderer against a reference"},
    {"flicker", neph_cli_flicker, NULL,
     "measure the flicker and the lag of a sequence of any renderer"},
    {"fit", neph_cli_fit, NULL,
     "which medium explains a frame of any renderer, and known mistakes"},
    {"limits", neph_cli_limits, NULL,
     "how much frames differ from run to run, as limits for compare and flicker"},
    {"view", neph_cli_view, NULL,
     "a page to look at frames of any renderer with, down to their values"},
    {"post", neph_cli_post, NULL, "frames of any renderer through tone mapping and upscalers"},
    {"conform", neph_cli_conform, NULL,
     "whether a device renders real sizes right, and as another does"},
    {"metrics", neph_cli_metrics, NULL, "list metrics and masks, with definitions and sources"},
    {"nightly", neph_cli_nightly, NULL,
     "nightly run: measure, compare with the accepted run, report changes"},
    {"baseline", neph_cli_baseline, NULL,
     "accept a nightly run as the baseline, or list acceptances"},
    {"serve", neph_cli_serve, NULL,
     "the nightly page for a browser of this machine, to accept changes there"},
    {"store", neph_cli_store, NULL, "check, shrink or export the store of frames"},
    {"scenes", neph_cli_scenes, NULL, "list the catalogue, or show and check one scene"},
    {"engines", neph_cli_engines, NULL, "list the engines, or explain the settings of one"},
    {"doctor", neph_cli_doctor, NULL, "installed and missing programs, and how to install them"},
};
enum { VERB_COUNT = sizeof(verbs) / sizeof(verbs[0]) };

static void print_help(FILE *out)
{
    fprintf(out, "Usage: neph VERB [ARGUMENT...]\n"
                 "A validation harness for volumetric rendering.\n\n");
    for (int i = 0; i < VERB_COUNT; i++)
        fprintf(out, "  %-9s %s\n", verbs[i].name, verbs[i].help);
    fprintf(
        out,
        "\n"
        "`neph VERB --help` teaches each with examples.\n\n"
        "Exit codes: 0 done; 1 a gate failed or a difference is too large; 2 the engine cannot\n"
        "model the scene, or the images lack the requested layers; 3 an engine failed; 64 wrong\n"
        "usage; 65 wrong input; 66 no such file; 69 engine or driver missing; 70 a bug in neph;\n"
        "71 out of memory; 74 reading or writing failed; 124 time limit; 130 interrupted.\n");
}

static void print_diag(const char *verb, enum neph_status status, const struct neph_diag *diag)
{
    if (diag->file[0] && diag->line > 0 && status != NEPH_ERR_INTERRUPTED)
        fprintf(stderr, "%s:%d:%d: %s\n", diag->file, diag->line, diag->column, diag->message);
    else
        fprintf(stderr, "neph %s: %s\n", verb,
                diag->message[0] ? diag->message : neph_status_name(status));
    if (diag->hint[0])
        fprintf(stderr, "  hint: %s\n", diag->hint);
    fputs(diag->more, stderr);
}

/* Flush stdout. Lost output is an error, whatever the result of the verb; an earlier error keeps
 * its exit code. */
static int close_output(int exit_code)
{
    errno = 0;
    const bool flushed = fflush(stdout) == 0; /* the write may fail as late as here if the buffer
                                               * was large */
    if (flushed && !ferror(stdout))
        return exit_code;
    fprintf(stderr, "neph: the output was cut: cannot write to stdout%s%s\n", errno ? ": " : "",
            errno ? strerror(errno) : "");
    __fpurge(stdout);
    clearerr(stdout);
    return exit_code ? exit_code : neph_status_exit_code(NEPH_ERR_IO);
}

/* argp ends the process itself after --help. */
static void close_output_at_exit(void)
{
    const int exit_code = close_output(0);
    if (exit_code)
        _exit(exit_code);
}

static int run_verb(int index, int argc, char **argv)
{
    char name[64];
    struct neph_diag diag = {.line = 0};
    snprintf(name, sizeof(name), "neph %s", verbs[index].name);
    argv[0] = name;
    const enum neph_status status = verbs[index].run ? verbs[index].run(argc, argv, &diag)
                                                     : neph_experiment_main(verbs[index].experiment,
                                                                            argc, argv, &diag);
    if (status != NEPH_OK && diag.message[0])
        print_diag(verbs[index].name, status, &diag);
    return close_output(neph_status_exit_code(status));
}

static int refuse_verb(const char *verb)
{
    char text[256];
    neph_text_format(text, sizeof(text), "%s", verb);
    fprintf(stderr, "neph: there is no verb '%s'; `neph --help` lists them\n", text);
    return neph_status_exit_code(NEPH_ERR_USAGE);
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        print_help(stderr);
        return neph_status_exit_code(NEPH_ERR_USAGE);
    }
    neph_interrupt_install();
    atexit(close_output_at_exit);
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 ||
        strcmp(argv[1], "help") == 0) {
        print_help(stdout);
        return close_output(0);
    }
    if (strcmp(argv[1], "--version") == 0) {
        printf("neph %s\n", NEPH_VERSION);
        return close_output(0);
    }
    neph_surroundings_settle(stderr);
    for (int i = 0; i < VERB_COUNT; i++)
        if (strcmp(argv[1], verbs[i].name) == 0)
            return run_verb(i, argc - 1, argv + 1);
    return refuse_verb(argv[1]);
}
