/* SPDX-License-Identifier: MIT */
#include "harness/report/validation.h"

#include "base/doubt.h"

#include <stdio.h>
#include <string.h>

/* Compiles only when this file handles every verdict. */
_Static_assert(NEPH_GATE_VERDICT_COUNT == 3, "a new kind");

static void print_number(const struct neph_frame_result *frame, const char *quantity,
                         const char *metric, FILE *out)
{
    const struct neph_measurement *number = neph_measurement_find(&frame->measurements, quantity,
                                                                  metric, "all");
    if (number && number->defined)
        fprintf(out, " %11.3e", number->value);
    else
        fprintf(out, " %11s", "-");
}

static void print_gates(const struct neph_scene_result *scene, const struct neph_engine *engine,
                        FILE *out)
{
    int counts[] = {[NEPH_GATE_PASS] = 0, [NEPH_GATE_FAIL] = 0, [NEPH_GATE_NOT_MEASURED] = 0};
    for (int g = 0; g < scene->gate_count; g++)
        counts[scene->gates[g].verdict] += strcmp(scene->gates[g].engine, engine->name) == 0;
    const int passed = counts[NEPH_GATE_PASS], failed = counts[NEPH_GATE_FAIL];
    if (failed > 0)
        fprintf(out, "FAIL %d of %d\n", failed, passed + failed);
    else if (passed > 0)
        fprintf(out, "pass %d\n", passed);
    else
        fprintf(out, "-\n");
}

/* Error of the voxel grids of a frame that was rendered from voxels, below its numbers. */
static void print_bakes(const struct neph_bakes_summary *bakes, FILE *out)
{
    fprintf(out, "%38s of %s: ", "", bakes->grid);
    if (bakes->worst.transmittance_max > 0.0)
        fprintf(out, "errors: transmittance up to %.1e, extinction %.1e rms\n",
                bakes->worst.transmittance_max, bakes->worst.extinction_rms_relative);
    else
        fprintf(out, "nothing is lost\n");
}

/* The step that a study chose, and the remaining bias. */
static void print_study(const struct neph_study *study, FILE *out)
{
    const struct neph_study_level *level = &study->levels[study->chosen];
    fprintf(out, "%38s %s = %g by a study: step bias %+.3f %% +- %.3f %% (%s)\n", "", study->option,
            level->setting, 100.0 * level->bias, 100.0 * level->bias_noise,
            neph_study_verdict_name(study->verdict));
}

static void print_frame(const struct neph_scene_result *scene,
                        const struct neph_frame_result *frame, FILE *out)
{
    fprintf(out, "%-24s %-13s %-9s", scene->name, frame->engine->name,
            neph_outcome_name(frame->outcome));
    print_number(frame, "radiance", "rel_bias", out);
    print_number(frame, "radiance", "rel_rmse", out);
    print_number(frame, "transmittance", "max_abs", out);
    fprintf(out, " %8.2f  ", frame->cost.wall_s);
    print_gates(scene, frame->engine, out);
    if (frame->bakes)
        print_bakes(frame->bakes, out);
    if (frame->study)
        print_study(frame->study, out);
    char doubt[NEPH_DOUBT_ROOM];
    neph_doubt_describe(frame->noise_doubt, doubt, sizeof(doubt));
    if (doubt[0])
        fprintf(out, "%38s %s\n", "", doubt);
    if (frame->is_look && frame->note[0])
        fprintf(out, "%38s %s\n", "", frame->note);
}

void neph_validation_print(const struct neph_validation *validation, FILE *out)
{
    fprintf(out, "%-24s %-13s %-9s %11s %11s %11s %8s  %s\n", "scene", "engine", "outcome",
            "L rel_bias", "L rel_rmse", "T max_abs", "seconds", "gates");
    for (int s = 0; s < validation->scene_count; s++)
        for (int f = 0; f < validation->scenes[s].frame_count; f++)
            print_frame(&validation->scenes[s], &validation->scenes[s].frames[f], out);
    for (int a = 0; a < validation->absent_count; a++)
        fprintf(out, "%-24s not here: %s\n", validation->absent[a].scene,
                validation->absent[a].reason);
}
