/* SPDX-License-Identifier: MIT
 *
 * `neph study KIND ...`: the table of studies. Each kind of study is a file and a line here.
 */
#include "harness/cli/cli.h"

#include "harness/engines/engines.h"
#include "harness/experiments/experiments.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *name;
    const struct neph_experiment *experiment;
    const char *help;
} kinds[] = {
    {"steps", &neph_experiment_steps,
     "how far an engine's steps are from their limit, and which are enough"},
    {"flicker", &neph_experiment_flicker,
     "which preset of the real-time renderer flickers and lags less, with intervals"},
    {"attribution", &neph_experiment_attribution,
     "which part of a real-time preset causes how much of its flicker, and where"},
    {"light", &neph_experiment_light,
     "how far lighting models are from all orders of scattering, and where"},
    {"sky", &neph_experiment_sky,
     "how far models of a planet's atmosphere are from all orders of scattering, and where"},
    {"fog", &neph_experiment_fog,
     "model error of each control of a non-physical fog model, against exact"},
    {"screen", &neph_experiment_screen,
     "how far occlusion, reflections and indirect light on a screen are from the truth, and why"},
    {"convergence", &neph_experiment_convergence,
     "after how many frames a preset of the real-time renderer is as good as it gets"},
    {"phase", &neph_experiment_phase,
     "what is lost when droplets are drawn with a simpler phase function"},
    {"post", &neph_experiment_post, "effect of each post-processing stage on error and flicker"},
};
enum { KIND_COUNT = sizeof(kinds) / sizeof(kinds[0]) };

static void print_help(FILE *out)
{
    fprintf(out, "Usage: neph study KIND [ARGUMENT...]\n\n");
    for (int i = 0; i < KIND_COUNT; i++)
        fprintf(out, "  %-12s %s\n", kinds[i].name, kinds[i].help);
    fprintf(out, "\n`neph study KIND --help` teaches each with examples. Without a KIND, "
                 "`neph study ENGINE SCENE`\nand `neph study --renew` are of `steps`.\n\n"
                 "Examples:\n"
                 "  neph study steps march fence_backlit\n"
                 "  neph study flicker --suite test --markdown study.md\n"
                 "  neph study light cloud_below --suns 50:180,15:0 --g 0,0.85\n"
                 "  neph study fog fog_look_evening\n");
}

static enum neph_status refuse_kind(const char *word, struct neph_diag *diag)
{
    char names[128] = "";
    for (int i = 0; i < KIND_COUNT; i++) {
        const size_t length = strlen(names);
        snprintf(names + length, sizeof(names) - length, "%s%s", i > 0 ? ", " : "", kinds[i].name);
    }
    neph_fail(diag, NEPH_ERR_USAGE, "there is no study '%s', and no engine", word);
    neph_hint(diag, "studies are %s; engines with steps are cycles, povray and march", names);
    return NEPH_ERR_USAGE;
}

enum neph_status neph_cli_study(int argc, char **argv, struct neph_diag *diag)
{
    const char *first = argc > 1 ? argv[1] : "--help";
    if (strcmp(first, "--help") == 0 || strcmp(first, "-?") == 0) {
        print_help(argc > 1 ? stdout : stderr);
        return argc > 1 ? NEPH_OK : NEPH_ERR_USAGE;
    }
    for (int i = 0; i < KIND_COUNT; i++)
        if (strcmp(first, kinds[i].name) == 0) {
            char name[64];
            snprintf(name, sizeof(name), "neph study %s", kinds[i].name);
            argv[1] = name;
            return neph_experiment_main(kinds[i].experiment, argc - 1, argv + 1, diag);
        }
    if (first[0] != '-' && !neph_engine_find(first))
        return refuse_kind(first, diag);
    return neph_experiment_main(&neph_experiment_steps, argc, argv, diag);
}
