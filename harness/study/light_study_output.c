/* SPDX-License-Identifier: MIT */
#include "harness/study/light_study_output.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- words ----------------------------------------------------------------------------------- */

static double degrees(double angle_rad)
{
    return angle_rad / NEPH_RAD_PER_DEG;
}

static void print_percent(double part, FILE *out)
{
    if (isnan(part))
        fprintf(out, " - |");
    else
        fprintf(out, " %.1f |", 100.0 * part);
}

/* Where the sun stands as seen by the camera. */
static const char *side_of(const struct neph_light_cell *cell)
{
    const double from_ahead = fabs(degrees(cell->light.sun_azimuth_rad));
    return from_ahead < 60.0 ? "in front" : from_ahead <= 120.0 ? "beside" : "behind";
}

static void print_head(const struct neph_light_study *study, FILE *out)
{
    const struct neph_light_study_params *params = study->params;
    fprintf(out,
            "neph %s, %s: %dx%d, %d steps; the tracer twice, each to a noise of %g with at most %d "
            "samples.\nRadiance of the media under a sun of 1 W/m2 and nothing else, black "
            "solids. Dense: pixels that less than a tenth comes through.\nBias: mean of the model "
            "over mean of the tracer, less 1. rms: over the same mean, without the tracer's "
            "noise.\n",
            NEPH_VERSION, study->device, params->width_px, params->height_px, params->steps,
            params->noise, params->samples);
}

/* ---- verdicts -------------------------------------------------------------------------------- */

static void print_verdict(const struct neph_light_verdict *verdict, FILE *out)
{
    fprintf(out, " %d |", verdict->cell_count);
    print_percent(verdict->mean_bias, out);
    print_percent(verdict->worst_bias, out);
    print_percent(verdict->mean_rms, out);
    print_percent(verdict->share_within, out);
    print_percent(verdict->share_smooth, out);
    fprintf(out, "\n");
}

static void print_verdicts(const struct neph_light_study *study, FILE *out)
{
    fprintf(out, "\n**Models in the dense parts, over cells, in %%**\n\n"
                 "| model | cells | mean of abs(bias) | worst | mean rms | cells with abs(bias) <= "
                 "5 | with rms <= 15 |\n"
                 "| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n");
    for (int model = 0; model < study->params->model_count; model++) {
        const struct neph_light_verdict verdict = neph_light_verdict_of(study, model, NULL, NULL);
        fprintf(out, "| %s |", study->params->models[model]);
        print_verdict(&verdict, out);
    }
}

/* ---- by what a cell is ----------------------------------------------------------------------- */

/* A cell's value of a key, as words. */
typedef void key_function(const struct neph_light_cell *cell, char *word, size_t size);

static void key_scene(const struct neph_light_cell *cell, char *word, size_t size)
{
    snprintf(word, size, "%s", cell->scene);
}

static void key_sun(const struct neph_light_cell *cell, char *word, size_t size)
{
    snprintf(word, size, "%s", side_of(cell));
}

static void key_g(const struct neph_light_cell *cell, char *word, size_t size)
{
    snprintf(word, size, "%.3g", cell->light.g);
}

static void key_albedo(const struct neph_light_cell *cell, char *word, size_t size)
{
    snprintf(word, size, "%.4g", cell->light.albedo);
}

static const struct {
    const char *title;
    key_function *of;
} keys[] = {{"cloud", key_scene}, {"sun", key_sun}, {"g", key_g}, {"albedo", key_albedo}};
enum { KEY_COUNT = sizeof(keys) / sizeof(keys[0]), WORD_SIZE = 96 };

struct match {
    key_function *of;
    const char *word;
};

static bool is_match(const struct neph_light_cell *cell, const void *context)
{
    char word[WORD_SIZE];
    const struct match *match = context;
    match->of(cell, word, sizeof(word));
    return strcmp(word, match->word) == 0;
}

/* Whether no cell before has the word. */
static bool is_first(const struct neph_light_study *study, int cell, const struct match *match)
{
    for (int i = 0; i < cell; i++)
        if (!study->cells[i].left_out[0] && is_match(&study->cells[i], match))
            return false;
    return true;
}

/* The mean bias, with its sign: whether a model is too dark or too bright there. */
static double signed_bias(const struct neph_light_study *study, int model,
                          const struct match *match)
{
    double sum = 0.0;
    int count = 0;
    for (int i = 0; i < study->cell_count; i++) {
        const double bias = neph_light_bias(&study->cells[i].gaps[model].dense);
        if (isnan(bias) || !is_match(&study->cells[i], match))
            continue;
        sum += bias;
        count++;
    }
    return count > 0 ? sum / count : NAN;
}

static void print_key_row(const struct neph_light_study *study, const struct match *match,
                          FILE *out)
{
    fprintf(out, "| %s |", match->word);
    for (int model = 0; model < study->params->model_count; model++) {
        const struct neph_light_verdict verdict = neph_light_verdict_of(study, model, is_match,
                                                                        match);
        if (verdict.cell_count == 0)
            fprintf(out, " - |");
        else
            fprintf(out, " %.1f (%+.1f), %d |", 100.0 * verdict.mean_bias,
                    100.0 * signed_bias(study, model, match), verdict.cell_count);
    }
    fprintf(out, "\n");
}

static void print_key(const struct neph_light_study *study, int key, FILE *out)
{
    fprintf(out, "\n**By %s: mean of abs(bias) in the dense parts (of bias), cells**\n\n| %s |",
            keys[key].title, keys[key].title);
    for (int model = 0; model < study->params->model_count; model++)
        fprintf(out, " %s |", study->params->models[model]);
    fprintf(out, "\n| --- |");
    for (int model = 0; model < study->params->model_count; model++)
        fprintf(out, " ---: |");
    fprintf(out, "\n");
    for (int i = 0; i < study->cell_count; i++) {
        char word[WORD_SIZE];
        const struct match match = {keys[key].of, word};
        if (study->cells[i].left_out[0])
            continue;
        match.of(&study->cells[i], word, sizeof(word));
        if (is_first(study, i, &match))
            print_key_row(study, &match, out);
    }
}

/* ---- along the axes -------------------------------------------------------------------------- */

/* All pixels of a bin of an axis. */
static struct neph_light_sums sums_along(const struct neph_light_study *study, int model,
                                         enum neph_light_axis axis, int bin)
{
    struct neph_light_sums sums = {.count = 0};
    const struct neph_light_map *map = axis == NEPH_LIGHT_SUN ? &study->eye_sun[model]
                                                              : &study->eye_angle[model];
    for (int other = 0; other < NEPH_LIGHT_BINS; other++)
        neph_light_sums_merge(&sums, axis == NEPH_LIGHT_EYE ? &map->bins[bin][other]
                                                            : &map->bins[other][bin]);
    return sums;
}

static void print_axis(const struct neph_light_study *study, enum neph_light_axis axis, FILE *out)
{
    const struct neph_light_axis_row *row = &neph_light_axes[axis];
    fprintf(out,
            "\n**By %s: radiance over the tracer's (rms in %%), pixels of all cells**\n\n"
            "| from | to | pixels |",
            row->title);
    for (int model = 0; model < study->params->model_count; model++)
        fprintf(out, " %s |", study->params->models[model]);
    fprintf(out, "\n| ---: | ---: | ---: |");
    for (int model = 0; model < study->params->model_count; model++)
        fprintf(out, " ---: |");
    fprintf(out, "\n");
    for (int bin = 0; bin < NEPH_LIGHT_BINS; bin++) {
        fprintf(out, "| %.3g | %.3g | %ld |", row->edges[bin], row->edges[bin + 1],
                sums_along(study, 0, axis, bin).count);
        for (int model = 0; model < study->params->model_count; model++) {
            const struct neph_light_sums sums = sums_along(study, model, axis, bin);
            if (isnan(neph_light_ratio(&sums)))
                fprintf(out, " - |");
            else
                fprintf(out, " %.3f (%.0f) |", neph_light_ratio(&sums),
                        100.0 * neph_light_rms(&sums));
        }
        fprintf(out, "\n");
    }
}

/* ---- cells ----------------------------------------------------------------------------------- */

static void print_gap(const struct neph_light_gap *gap, FILE *out)
{
    const struct neph_light_sums *dense = &gap->dense;
    if (isnan(neph_light_bias(dense)))
        fprintf(out, " - |");
    else
        fprintf(out, " %+.1f (%.1f) |", 100.0 * neph_light_bias(dense),
                100.0 * neph_light_rms(dense));
}

static void print_cell(const struct neph_light_study *study, const struct neph_light_cell *cell,
                       FILE *out)
{
    const struct neph_light_sums *dense = &cell->gaps[0].dense;
    fprintf(out, "| %s | %.0f, %.0f | %.3g | %.4g | %.3g |", cell->scene,
            degrees(cell->light.sun_elevation_rad), degrees(cell->light.sun_azimuth_rad),
            cell->light.g, cell->light.albedo, cell->light.density);
    if (cell->left_out[0]) {
        fprintf(out, " left out: %s |\n", cell->left_out);
        return;
    }
    fprintf(out, " %ld | %.1f |", dense->count,
            dense->count > 0 ? 100.0 * sqrt(dense->noise) / dense->truth : 0.0);
    for (int model = 0; model < study->params->model_count; model++)
        print_gap(&cell->gaps[model], out);
    fprintf(out, "\n");
}

static void print_cells(const struct neph_light_study *study, FILE *out)
{
    fprintf(out, "\n**Cells: bias in the dense parts (rms), in %%**\n\nThe sun's elevation and "
                 "azimuth in degrees: 0 is where the camera looks, 180 behind it. Noise: of the "
                 "tracer's mean over the dense parts.\n\n"
                 "| cloud | sun | g | albedo | density | pixels | noise |");
    for (int model = 0; model < study->params->model_count; model++)
        fprintf(out, " %s |", study->params->models[model]);
    fprintf(out, "\n| --- | ---: | ---: | ---: | ---: | ---: | ---: |");
    for (int model = 0; model < study->params->model_count; model++)
        fprintf(out, " ---: |");
    fprintf(out, "\n");
    for (int i = 0; i < study->cell_count; i++)
        print_cell(study, &study->cells[i], out);
}

/* Once for each model: why it has nothing, or not what others have. */
static void print_notes(const struct neph_light_study *study, FILE *out)
{
    for (int model = 0; model < study->params->model_count; model++)
        for (int i = 0; i < study->cell_count; i++) {
            const struct neph_light_gap *gap = &study->cells[i].gaps[model];
            if (study->cells[i].left_out[0] || (!gap->once && !gap->because[0]))
                continue;
            if (gap->once)
                fprintf(out, "\n%s: of light scattered once, against all orders.\n",
                        study->params->models[model]);
            else
                fprintf(out, "\n%s cannot, in %s: %s.\n", study->params->models[model],
                        study->cells[i].scene, gap->because);
            break;
        }
}

/* ---- all of it ------------------------------------------------------------------------------- */

/* What was printed into memory, unless memory was short on the way. */
static enum neph_status close_text(FILE *out, char **text, struct neph_diag *diag)
{
    const bool cut = ferror(out) != 0, closed = fclose(out) == 0;
    if (!cut && closed)
        return NEPH_OK;
    free(*text);
    *text = NULL;
    return neph_fail_memory(diag);
}

enum neph_status neph_light_study_text(const struct neph_light_study *study, char **text,
                                       struct neph_diag *diag)
{
    size_t size;
    *text = NULL;
    FILE *out = open_memstream(text, &size);
    if (!out)
        return neph_fail_memory(diag);
    print_head(study, out);
    print_notes(study, out);
    print_verdicts(study, out);
    for (int key = 0; key < KEY_COUNT; key++)
        print_key(study, key, out);
    for (int axis = 0; axis < NEPH_LIGHT_AXES; axis++)
        print_axis(study, (enum neph_light_axis)axis, out);
    print_cells(study, out);
    return close_text(out, text, diag);
}

/* ---- CSV ------------------------------------------------------------------------------------- */

static void print_number(double value, FILE *out)
{
    if (isfinite(value))
        fprintf(out, ",%.9g", value);
    else
        fprintf(out, ",");
}

/* In quotes, which are doubled inside. */
static void print_quoted(const char *text, FILE *out)
{
    fputs(",\"", out);
    for (; *text; text++)
        fprintf(out, *text == '"' ? "\"\"" : "%c", *text);
    fputc('"', out);
}

static void print_sums(const struct neph_light_sums *sums, FILE *out)
{
    fprintf(out, ",%ld", sums->count);
    print_number(neph_light_bias(sums), out);
    print_number(neph_light_bias_noise(sums), out);
    print_number(neph_light_rms(sums), out);
}

static void print_row(const struct neph_light_study *study, const struct neph_light_cell *cell,
                      int model, FILE *out)
{
    const struct neph_light_gap *gap = &cell->gaps[model];
    fprintf(out, "%s", cell->scene);
    print_number(degrees(cell->light.sun_elevation_rad), out);
    print_number(degrees(cell->light.sun_azimuth_rad), out);
    print_number(cell->light.g, out);
    print_number(cell->light.albedo, out);
    print_number(cell->light.density, out);
    print_quoted(study->params->models[model], out);
    print_sums(&gap->dense, out);
    print_sums(&gap->all, out);
    print_number(gap->render_s, out);
    print_number(cell->noise, out);
    print_quoted(cell->left_out[0] ? cell->left_out : gap->because, out);
    fputs("\r\n", out);
}

enum neph_status neph_light_study_csv(const struct neph_light_study *study, char **text,
                                      struct neph_diag *diag)
{
    size_t size;
    *text = NULL;
    FILE *out = open_memstream(text, &size);
    if (!out)
        return neph_fail_memory(diag);
    fputs("scene,sun_elevation_deg,sun_azimuth_deg,g,albedo,density,model,dense_pixels,dense_bias,"
          "dense_bias_noise,dense_rms,pixels,bias,bias_noise,rms,render_s,tracer_noise,because\r\n",
          out);
    for (int i = 0; i < study->cell_count; i++)
        for (int model = 0; model < study->params->model_count; model++)
            print_row(study, &study->cells[i], model, out);
    return close_text(out, text, diag);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *sums_json(const struct neph_light_sums *sums)
{
    return json_pack("{s:i, s:o, s:o, s:o, s:o}", "pixels", (int)sums->count, "ratio",
                     neph_json_number(neph_light_ratio(sums)), "bias",
                     neph_json_number(neph_light_bias(sums)), "bias_noise",
                     neph_json_number(neph_light_bias_noise(sums)), "rms",
                     neph_json_number(neph_light_rms(sums)));
}

static json_t *gaps_json(const struct neph_light_study *study, const struct neph_light_cell *cell)
{
    json_t *list = json_array();
    for (int model = 0; model < study->params->model_count; model++) {
        const struct neph_light_gap *gap = &cell->gaps[model];
        neph_json_add(&list,
                      json_pack("{s:s, s:o, s:o, s:f, s:b, s:s}", "model",
                                study->params->models[model], "dense", sums_json(&gap->dense),
                                "all", sums_json(&gap->all), "render_s", gap->render_s,
                                "scattered_once", gap->once, "because", gap->because));
    }
    return list;
}

static json_t *cells_json(const struct neph_light_study *study)
{
    json_t *list = json_array();
    for (int i = 0; i < study->cell_count; i++) {
        const struct neph_light_cell *cell = &study->cells[i];
        const struct neph_relight *light = &cell->light;
        neph_json_add(
            &list,
            json_pack("{s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:f, s:s, s:o}", "scene", cell->scene,
                      "sun_elevation_deg", neph_json_number(degrees(light->sun_elevation_rad)),
                      "sun_azimuth_deg", neph_json_number(degrees(light->sun_azimuth_rad)), "g",
                      neph_json_number(light->g), "albedo", neph_json_number(light->albedo),
                      "density", neph_json_number(light->density), "tracer_noise",
                      neph_json_number(cell->noise), "tracer_s", cell->tracer_s, "left_out",
                      cell->left_out, "models", gaps_json(study, cell)));
    }
    return list;
}

static json_t *verdicts_json(const struct neph_light_study *study)
{
    json_t *list = json_array();
    for (int model = 0; model < study->params->model_count; model++) {
        const struct neph_light_verdict verdict = neph_light_verdict_of(study, model, NULL, NULL);
        neph_json_add(
            &list, json_pack("{s:s, s:i, s:o, s:o, s:o, s:o, s:o}", "model",
                             study->params->models[model], "cells", verdict.cell_count,
                             "mean_abs_bias", neph_json_number(verdict.mean_bias), "worst_abs_bias",
                             neph_json_number(verdict.worst_bias), "mean_rms",
                             neph_json_number(verdict.mean_rms), "share_bias_within_5_percent",
                             neph_json_number(verdict.share_within), "share_rms_within_15_percent",
                             neph_json_number(verdict.share_smooth)));
    }
    return list;
}

static json_t *map_json(const struct neph_light_map *map)
{
    json_t *rows = json_array();
    for (int i = 0; i < NEPH_LIGHT_BINS; i++) {
        json_t *row = json_array();
        for (int j = 0; j < NEPH_LIGHT_BINS; j++)
            neph_json_add(&row, sums_json(&map->bins[i][j]));
        neph_json_add(&rows, row);
    }
    return rows;
}

static json_t *axes_json(void)
{
    json_t *list = json_array();
    for (int axis = 0; axis < NEPH_LIGHT_AXES; axis++) {
        json_t *edges = json_array();
        for (int i = 0; i <= NEPH_LIGHT_BINS; i++)
            neph_json_add(&edges, neph_json_number(neph_light_axes[axis].edges[i]));
        neph_json_add(
            &list, json_pack("{s:s, s:o}", "title", neph_light_axes[axis].title, "edges", edges));
    }
    return list;
}

static json_t *maps_json(const struct neph_light_study *study)
{
    json_t *list = json_array();
    for (int model = 0; model < study->params->model_count; model++)
        neph_json_add(&list, json_pack("{s:s, s:o, s:o}", "model", study->params->models[model],
                                       "eye_sun", map_json(&study->eye_sun[model]), "eye_angle",
                                       map_json(&study->eye_angle[model])));
    return list;
}

json_t *neph_light_study_json(const struct neph_light_study *study)
{
    const struct neph_light_study_params *params = study->params;
    return json_pack("{s:s, s:s, s:s, s:[i,i], s:i, s:f, s:i, s:i, s:o, s:o, s:o, s:o}", "format",
                     "neph-light-study-1", "version", NEPH_VERSION, "device", study->device,
                     "size_px", params->width_px, params->height_px, "steps", params->steps,
                     "noise", params->noise, "samples", params->samples, "broken",
                     study->failed_count, "verdicts", verdicts_json(study), "cells",
                     cells_json(study), "axes", axes_json(), "maps", maps_json(study));
}
