/* SPDX-License-Identifier: MIT */
#include "harness/study/screen_study.h"

#include "base/written.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- tables ---------------------------------------------------------------------------------- */

static void print_percent(double value, FILE *out)
{
    if (isnan(value))
        fprintf(out, " |");
    else
        fprintf(out, " %.2f |", 100.0 * value);
}

static void print_gap(const char *scene, const char *model, const struct neph_screen_gap *gap,
                      FILE *out)
{
    fprintf(out, "| %s | %s |", scene, model);
    const double columns[] = {gap->error, gap->bias, gap->own, gap->known_error, gap->lost_error};
    for (size_t i = 0; i < sizeof(columns) / sizeof(columns[0]); i++)
        print_percent(columns[i], out);
    fprintf(out, "\n");
}

static void print_truth(const char *scene, const struct neph_screen_truth *truth, FILE *out)
{
    fprintf(out, "| %s | *no model can* |", scene);
    print_percent(truth->beyond, out);
    fprintf(out, " | | noise %.2f | lost %.0f %% of %d px:", 100.0 * truth->noise,
            100.0 * truth->lost / truth->pixels, truth->pixels);
    fprintf(out, " %d off, %d behind, %d thin, %d else |\n", truth->lost_by[NEPH_LOST_OFF],
            truth->lost_by[NEPH_LOST_BEHIND], truth->lost_by[NEPH_LOST_THIN],
            truth->lost_by[NEPH_SCREEN_LOSSES]);
}

static void print_part(const struct neph_screen_study *study, int part, FILE *out)
{
    const struct neph_screen_study_params *params = study->params;
    fprintf(out,
            "\n**%s** [%% of %s]\n\n"
            "| scene | | error | bias | against what the screen shows | known pixels | lost pixels "
            "|\n| --- | --- | ---: | ---: | ---: | ---: | ---: |\n",
            neph_screen_part_names[part],
            part == NEPH_SCREEN_AO ? "the hemisphere" : "all such light");
    for (int s = 0; s < params->scene_count; s++) {
        const struct neph_screen_scene *scene = &study->scenes[s];
        if (scene->truths[part].pixels == 0)
            continue;
        print_truth(params->scenes[s]->name, &scene->truths[part], out);
        for (int m = 0; m < params->model_count; m++)
            print_gap(params->scenes[s]->name, params->models[m], &scene->gaps[m][part], out);
    }
}

static void print_witness_row(const char *scene, const char *model,
                              const struct neph_screen_gap gaps[NEPH_SCREEN_PARTS], FILE *out)
{
    fprintf(out, "| %s | %s |", scene, model);
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++) {
        print_percent(gaps[part].error, out);
        print_percent(gaps[part].bias, out);
    }
    fprintf(out, "\n");
}

static void print_witness(const struct neph_screen_study *study, FILE *out)
{
    const struct neph_screen_study_params *params = study->params;
    fprintf(out, "\n**Against Cycles** [%%, as above], %d samples\n\n| scene | |",
            params->witness_samples);
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++)
        fprintf(out, " %s: error | bias |", neph_screen_part_names[part]);
    fprintf(out, "\n| --- | --- |");
    for (int part = 0; part < 2 * NEPH_SCREEN_PARTS; part++)
        fprintf(out, " ---: |");
    fprintf(out, "\n");
    for (int s = 0; s < params->scene_count; s++) {
        const struct neph_screen_scene *scene = &study->scenes[s];
        const char *name = params->scenes[s]->name;
        if (scene->witness_cannot[0]) {
            fprintf(out, "| %s | *it cannot: %s* |\n", name, scene->witness_cannot);
            continue;
        }
        print_witness_row(name, "*cycles against surfaces*", scene->witness, out);
        for (int m = 0; m < params->model_count; m++)
            print_witness_row(name, params->models[m], scene->against_witness[m], out);
    }
}

static void print_flicker(const struct neph_screen_study *study, FILE *out)
{
    const struct neph_screen_study_params *params = study->params;
    fprintf(out,
            "\n**Over frames**, the picture against surfaces: light over its mean [%%]; on a "
            "display by Unreal's curve FLIP,\nflicker seen over threshold, share of pixels "
            "where it is seen; milliseconds of the passes\n\n"
            "| scene | | frames | error | its change | FLIP | flicker seen | share [%%] | ms |\n"
            "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
    for (int s = 0; s < params->scene_count; s++)
        for (int m = 0; m < params->model_count; m++) {
            const struct neph_post_numbers *numbers = &study->scenes[s].flicker[m];
            fprintf(out, "| %s | %s | %d |", params->scenes[s]->name, params->models[m],
                    study->scenes[s].frame_count);
            print_percent(numbers->scene_error, out);
            print_percent(numbers->scene_change, out);
            fprintf(out, " %.4f | %.2f |", numbers->flip, numbers->seen);
            print_percent(numbers->seen_share, out);
            fprintf(out, " %.3g |\n", numbers->ms);
        }
}

static void print_losses(const struct neph_screen_study *study, FILE *out)
{
    fprintf(out, "\n**Why** [%% of the hemisphere over surfaces in the picture]\n\n"
                 "| scene | as far as | meets what is off the picture | meets what is behind | "
                 "passes behind something thin |\n| --- | ---: | ---: | ---: | ---: |\n");
    for (int s = 0; s < study->params->scene_count; s++) {
        const struct neph_screen_scene *scene = &study->scenes[s];
        const char *name = study->params->scenes[s]->name;
        fprintf(out, "| %s | %g m |", name, study->params->radius_m);
        for (int i = 0; i < NEPH_SCREEN_LOSSES; i++)
            print_percent(scene->near[i], out);
        fprintf(out, "\n| %s | all the way |", name);
        for (int i = 0; i < NEPH_SCREEN_LOSSES; i++)
            print_percent(scene->far[i], out);
        fprintf(out, "\n");
    }
}

static void print_study(const void *what, FILE *out)
{
    const struct neph_screen_study *study = what;
    const struct neph_screen_study_params *params = study->params;
    fprintf(out,
            "neph %s, against surfaces with %d samples, %dx%d, ambient occlusion within %g m.\n"
            "Errors are mean and absolute, light times the colour of its surface. A pixel is lost "
            "where what the picture shows of\nits truth is off by more than %g %% of it (of the "
            "hemisphere, %g %%).\n",
            NEPH_VERSION, params->samples, params->width_px, params->height_px, params->radius_m,
            100.0 * NEPH_SCREEN_LOST, 50.0 * NEPH_SCREEN_LOST);
    for (int part = 0; part < NEPH_SCREEN_PARTS; part++)
        print_part(study, part, out);
    print_losses(study, out);
    if (params->witness_samples > 0)
        print_witness(study, out);
    if (params->frame_count > 0)
        print_flicker(study, out);
}

enum neph_status neph_screen_study_text(const struct neph_screen_study *study, char **text,
                                        struct neph_diag *diag)
{
    return neph_written(print_study, study, text, diag);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *gap_json(const struct neph_screen_gap *gap)
{
    return json_pack("{s:o, s:o, s:o, s:o, s:o}", "error", neph_json_number(gap->error), "bias",
                     neph_json_number(gap->bias), "own", neph_json_number(gap->own), "known",
                     neph_json_number(gap->known_error), "lost", neph_json_number(gap->lost_error));
}

static json_t *part_json(const struct neph_screen_study *study,
                         const struct neph_screen_scene *scene, int part)
{
    const struct neph_screen_truth *truth = &scene->truths[part];
    json_t *models = json_object();
    for (int m = 0; m < study->params->model_count; m++)
        neph_json_set(&models, study->params->models[m], gap_json(&scene->gaps[m][part]));
    return json_pack("{s:i, s:i, s:{s:i, s:i, s:i, s:i}, s:o, s:o, s:o}", "pixels", truth->pixels,
                     "lost", truth->lost, "lost_by", "off", truth->lost_by[NEPH_LOST_OFF], "behind",
                     truth->lost_by[NEPH_LOST_BEHIND], "thin", truth->lost_by[NEPH_LOST_THIN],
                     "else", truth->lost_by[NEPH_SCREEN_LOSSES], "noise",
                     neph_json_number(truth->noise), "beyond", neph_json_number(truth->beyond),
                     "models", models);
}

static json_t *witness_json(const struct neph_screen_study *study,
                            const struct neph_screen_scene *scene, int part)
{
    json_t *models = json_object();
    for (int m = 0; m < study->params->model_count; m++)
        neph_json_set(&models, study->params->models[m],
                      gap_json(&scene->against_witness[m][part]));
    return json_pack("{s:o, s:o}", "cycles", gap_json(&scene->witness[part]), "models", models);
}

static json_t *flicker_json(const struct neph_screen_study *study,
                            const struct neph_screen_scene *scene)
{
    json_t *models = json_object();
    for (int m = 0; m < study->params->model_count && scene->frame_count > 0; m++) {
        const struct neph_post_numbers *numbers = &scene->flicker[m];
        neph_json_set(
            &models, study->params->models[m],
            json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "ms", neph_json_number(numbers->ms),
                      "error", neph_json_number(numbers->scene_error), "change",
                      neph_json_number(numbers->scene_change), "flip",
                      neph_json_number(numbers->flip), "seen", neph_json_number(numbers->seen),
                      "seen_share", neph_json_number(numbers->seen_share), "luma_change",
                      neph_json_number(numbers->luma_change)));
    }
    return json_pack("{s:i, s:o}", "frames", scene->frame_count, "models", models);
}

static json_t *losses_json(const double shares[NEPH_SCREEN_LOSSES])
{
    return json_pack("{s:f, s:f, s:f}", "off", shares[NEPH_LOST_OFF], "behind",
                     shares[NEPH_LOST_BEHIND], "thin", shares[NEPH_LOST_THIN]);
}

json_t *neph_screen_study_json(const struct neph_screen_study *study)
{
    json_t *scenes = json_object();
    for (int s = 0; s < study->params->scene_count; s++) {
        const struct neph_screen_scene *scene = &study->scenes[s];
        json_t *found = json_object();
        json_t *witness = json_object();
        for (int part = 0; part < NEPH_SCREEN_PARTS; part++) {
            neph_json_set(&found, neph_screen_part_names[part], part_json(study, scene, part));
            neph_json_set(&witness, neph_screen_part_names[part], witness_json(study, scene, part));
        }
        neph_json_set(&found, "against_cycles", witness);
        neph_json_set(&found, "over_frames", flicker_json(study, scene));
        neph_json_set(&found, "near", losses_json(scene->near));
        neph_json_set(&found, "far", losses_json(scene->far));
        neph_json_set(&scenes, study->params->scenes[s]->name, found);
    }
    return json_pack("{s:f, s:i, s:o}", "radius_m", study->params->radius_m, "samples",
                     study->params->samples, "scenes", scenes);
}
