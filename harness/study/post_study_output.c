/* SPDX-License-Identifier: MIT */
#include "harness/study/post_study.h"

#include "base/written.h"
#include "harness/study/numbers_plot.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Columns of all tables. */
static const struct {
    const char *title, *name;
    size_t at;
    const char *format;
} columns[] = {
    {"scene: error", "scene_error", offsetof(struct neph_post_numbers, scene_error), "%.4f"},
    {"change", "scene_change", offsetof(struct neph_post_numbers, scene_change), "%.4f"},
    {"display: FLIP", "flip", offsetof(struct neph_post_numbers, flip), "%.4f"},
    {"flicker seen", "seen", offsetof(struct neph_post_numbers, seen), "%.2f"},
    {"share seen", "seen_share", offsetof(struct neph_post_numbers, seen_share), "%.3f"},
    {"change of luma", "luma_change", offsetof(struct neph_post_numbers, luma_change), "%.4f"},
    {"ms", "ms", offsetof(struct neph_post_numbers, ms), "%.3f"},
};
enum { COLUMNS = sizeof(columns) / sizeof(columns[0]) };

static double value_of(const struct neph_post_numbers *numbers, int column)
{
    return *(const double *)((const char *)numbers + columns[column].at);
}

static void print_value(double value, const char *format, FILE *out)
{
    if (isnan(value))
        fputs("none", out);
    else
        fprintf(out, format, value);
}

static void print_rows(const struct neph_post_study *study, int scene, bool of_whole, FILE *out)
{
    const struct neph_post_numbers *numbers = study->numbers[scene];
    for (int r = 0; study->rows[r].name; r++) {
        if (study->rows[r].is_of_whole != of_whole)
            continue;
        fprintf(out, "| %s |", study->rows[r].name);
        for (int c = 0; c < COLUMNS; c++) {
            fputc(' ', out);
            print_value(value_of(&numbers[r], c), columns[c].format, out);
            fputs(" |", out);
        }
        fputc('\n', out);
    }
}

static void print_table(const struct neph_post_study *study, int scene, bool of_whole, FILE *out)
{
    bool any = false;
    for (int r = 0; study->rows[r].name; r++)
        any |= study->rows[r].is_of_whole == of_whole;
    if (!any)
        return;
    fprintf(out, "\n| %s |", of_whole ? "out of the whole" : "alone, on the curve");
    for (int c = 0; c < COLUMNS; c++)
        fprintf(out, " %s |", columns[c].title);
    fputs("\n| --- |", out);
    for (int c = 0; c < COLUMNS; c++)
        fputs(" ---: |", out);
    fputc('\n', out);
    print_rows(study, scene, of_whole, out);
}

static void print_study(const void *what, FILE *out)
{
    const struct neph_post_study *study = what;
    const struct neph_post_study_params *params = study->params;
    fprintf(out,
            "neph %s, realtime %s, %d steps, seed %d, on %s: %d frames after %d at %g Hz, %dx%d, "
            "behind the "
            "same chain as the march averaged over 16 rays a pixel.\nError and change of light "
            "before the curve are rms over the reference's mean; flicker seen is in thresholds; "
            "the change of luma is of its error, from frame to frame; ms of the device.\n",
            NEPH_VERSION, params->preset, params->steps, params->seed, study->device,
            params->frame_count, params->warm_up, params->frame_rate_hz, params->width_px,
            params->height_px);
    for (int i = 0; i < params->scene_count; i++) {
        fprintf(out, "\n%s\n", study->names[i]);
        print_table(study, i, false, out);
        print_table(study, i, true, out);
    }
}

static void print_csv(const void *what, FILE *out)
{
    const struct neph_post_study *study = what;
    fputs("scene,chain", out);
    for (int c = 0; c < COLUMNS; c++)
        fprintf(out, ",%s", columns[c].name);
    fputc('\n', out);
    for (int i = 0; i < study->params->scene_count; i++)
        for (int r = 0; study->rows[r].name; r++) {
            fprintf(out, "%s,\"%s\"", study->names[i], study->rows[r].name);
            for (int c = 0; c < COLUMNS; c++) {
                const double value = value_of(&study->numbers[i][r], c);
                fprintf(out, isnan(value) ? "," : ",%.9g", value);
            }
            fputc('\n', out);
        }
}

enum neph_status neph_post_study_text(const struct neph_post_study *study, char **text,
                                      struct neph_diag *diag)
{
    return neph_written(print_study, study, text, diag);
}

enum neph_status neph_post_study_csv(const struct neph_post_study *study, char **text,
                                     struct neph_diag *diag)
{
    return neph_written(print_csv, study, text, diag);
}

json_t *neph_post_study_json(const struct neph_post_study *study)
{
    json_t *scenes = json_array();
    for (int i = 0; i < study->params->scene_count; i++) {
        json_t *chains = json_array();
        for (int r = 0; study->rows[r].name; r++) {
            json_t *chain = json_pack("{s:s, s:s, s:b}", "name", study->rows[r].name, "settings",
                                      study->rows[r].settings, "of_whole",
                                      study->rows[r].is_of_whole);
            for (int c = 0; c < COLUMNS; c++)
                neph_json_set(&chain, columns[c].name,
                              neph_json_number(value_of(&study->numbers[i][r], c)));
            neph_json_add(&chains, chain);
        }
        neph_json_add(&scenes, json_pack("{s:s, s:o}", "scene", study->names[i], "chains", chains));
    }
    return json_pack("{s:s, s:s, s:i, s:o}", "device", study->device, "preset",
                     study->params->preset, "seed", study->params->seed, "scenes", scenes);
}

/* ---- the chart ------------------------------------------------------------------------------- */

enum neph_status neph_post_study_plot(const struct neph_post_study *study, char **svg,
                                      struct neph_diag *diag)
{
    struct neph_numbers_plot plot = {
        .rows = study->rows,
        .over = "the curve alone",
        .scene_count = study->params->scene_count,
        .scenes = (const char *const *)study->names,
        .numbers = study->numbers[0],
        .stride = NEPH_POST_ROWS_MAX,
    };
    while (strcmp(study->rows[plot.base].name, NEPH_POST_BASE) != 0)
        plot.base++;
    return neph_numbers_plot(&plot, svg, diag);
}
