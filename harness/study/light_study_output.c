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
    if (params->sun_speed_rad_per_s > 0.0)
        fprintf(out,
                "What remembers pictures has seen the sun sink by %g degrees a second, 60 "
                "pictures a second, to its place.\n",
                degrees(params->sun_speed_rad_per_s));
}

/* ---- verdicts -------------------------------------------------------------------------------- */

static void print_verdict(const struct neph_light_verdict *verdict, FILE *out)
{
    fprintf(out, " %d |", verdict->cell_count);
    print_percent(verdict->mean_bias, out);
    print_percent(verdict->worst_bias, out);
    print_percent(verdict->mean_rms, out);
    print_percent(verdict->share_within, out);
    print_percent(verdict->share_near, out);
    print_percent(verdict->share_smooth, out);
    fprintf(out, "\n");
}

static void print_verdicts(const struct neph_light_study *study, FILE *out)
{
    fprintf(out,
            "\n**Models over cells, in %%**\n\n"
            "| model | of | cells | mean of abs(bias) | worst | mean rms | cells with abs(bias) "
            "<= 5 | <= 15 | with rms <= 15 |\n"
            "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
    for (int model = 0; model < study->params->model_count; model++)
        for (int p = 0; p < NEPH_LIGHT_PARTS; p++) {
            const enum neph_light_part part = (enum neph_light_part)p;
            const struct neph_light_verdict verdict = neph_light_verdict_of(study, model, part,
                                                                            NULL, NULL);
            fprintf(out, "| %s%s | %s |", study->params->models[model],
                    study->looks[model] ? ", a look" : "", neph_light_part_name(part));
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

static void key_depth(const struct neph_light_cell *cell, char *word, size_t size)
{
    static const double edges[] = {3.0, 10.0, 30.0, 100.0};
    double from = 0.0;
    for (size_t i = 0; i < sizeof(edges) / sizeof(edges[0]); from = edges[i++])
        if (cell->optical_depth < edges[i]) {
            snprintf(word, size, "%g to %g", from, edges[i]);
            return;
        }
    snprintf(word, size, "%g and more", from);
}

static const struct {
    const char *title;
    key_function *of;
} keys[] = {{"cloud", key_scene},
            {"sun", key_sun},
            {"g", key_g},
            {"albedo", key_albedo},
            {"optical depth", key_depth}};
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
                          enum neph_light_part part, const struct match *match)
{
    double sum = 0.0;
    int count = 0;
    for (int i = 0; i < study->cell_count; i++) {
        const struct neph_light_sums *sums = neph_light_part_of(&study->cells[i].gaps[model], part);
        if (!neph_light_counts(sums) || !is_match(&study->cells[i], match))
            continue;
        sum += neph_light_bias(sums);
        count++;
    }
    return count > 0 ? sum / count : NAN;
}

static void print_key_row(const struct neph_light_study *study, enum neph_light_part part,
                          const struct match *match, FILE *out)
{
    fprintf(out, "| %s |", match->word);
    for (int model = 0; model < study->params->model_count; model++) {
        const struct neph_light_verdict verdict = neph_light_verdict_of(study, model, part,
                                                                        is_match, match);
        if (verdict.cell_count == 0)
            fprintf(out, " - |");
        else
            fprintf(out, " %.1f (%+.1f), %d |", 100.0 * verdict.mean_bias,
                    100.0 * signed_bias(study, model, part, match), verdict.cell_count);
    }
    fprintf(out, "\n");
}

static void print_key(const struct neph_light_study *study, int key, enum neph_light_part part,
                      FILE *out)
{
    fprintf(out, "\n**By %s, %s: mean of abs(bias) (of bias) in %%, cells**\n\n| %s |",
            keys[key].title, neph_light_part_name(part), keys[key].title);
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
            print_key_row(study, part, &match, out);
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

static void print_gap(const struct neph_light_sums *sums, FILE *out)
{
    if (neph_light_counts(sums))
        fprintf(out, " %+.1f (%.1f) |", 100.0 * neph_light_bias(sums),
                100.0 * neph_light_rms(sums));
    else
        fprintf(out, " - |");
}

static void print_cell(const struct neph_light_study *study, const struct neph_light_cell *cell,
                       enum neph_light_part part, FILE *out)
{
    const struct neph_light_sums *sums = neph_light_part_of(&cell->gaps[0], part);
    fprintf(out, "| %s | %s, %.0f, %.0f | %.3g | %.4g | %.3g |", cell->scene, side_of(cell),
            degrees(cell->light.sun_elevation_rad), degrees(cell->light.sun_azimuth_rad),
            cell->light.g, cell->light.albedo, cell->optical_depth);
    if (cell->left_out[0]) {
        fprintf(out, " left out: %s |\n", cell->left_out);
        return;
    }
    fprintf(out, " %ld | %.1f |", sums->count,
            neph_light_counts(sums) ? 100.0 * sqrt(sums->noise) / sums->truth : 0.0);
    for (int model = 0; model < study->params->model_count; model++)
        print_gap(neph_light_part_of(&cell->gaps[model], part), out);
    fprintf(out, "\n");
}

static void print_cells(const struct neph_light_study *study, enum neph_light_part part, FILE *out)
{
    fprintf(out,
            "\n**Cells, %s: bias (rms) in %%**\n\n"
            "| cloud | sun | g | albedo | optical depth | pixels | noise |",
            neph_light_part_name(part));
    for (int model = 0; model < study->params->model_count; model++)
        fprintf(out, " %s |", study->params->models[model]);
    fprintf(out, "\n| --- | --- | ---: | ---: | ---: | ---: | ---: |");
    for (int model = 0; model < study->params->model_count; model++)
        fprintf(out, " ---: |");
    fprintf(out, "\n");
    for (int i = 0; i < study->cell_count; i++)
        print_cell(study, &study->cells[i], part, out);
}

static void print_all_cells(const struct neph_light_study *study, FILE *out)
{
    fprintf(out,
            "\nIn the next tables the sun's elevation and azimuth are in degrees, and azimuth "
            "0 is where the camera looks, 180 behind it; a tenth of a cell's pixels with media "
            "have more than its optical depth; noise is what the tracer's leaves of its mean, "
            "in %%.\n");
    for (int part = 0; part < NEPH_LIGHT_PARTS; part++)
        print_cells(study, (enum neph_light_part)part, out);
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
        for (int part = 0; part < NEPH_LIGHT_PARTS; part++)
            print_key(study, key, (enum neph_light_part)part, out);
    for (int axis = 0; axis < NEPH_LIGHT_AXES; axis++)
        print_axis(study, (enum neph_light_axis)axis, out);
    print_all_cells(study, out);
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
    print_number(cell->optical_depth, out);
    print_quoted(side_of(cell), out);
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
    fputs("scene,sun_elevation_deg,sun_azimuth_deg,g,albedo,density,optical_depth,sun,model,"
          "dense_pixels,dense_bias,dense_bias_noise,dense_rms,pixels,bias,bias_noise,rms,render_s,"
          "tracer_noise,because\r\n",
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
            &list, json_pack("{s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:f, s:s, s:o}",
                             "scene", cell->scene, "sun", side_of(cell), "sun_elevation_deg",
                             neph_json_number(degrees(light->sun_elevation_rad)), "sun_azimuth_deg",
                             neph_json_number(degrees(light->sun_azimuth_rad)), "g",
                             neph_json_number(light->g), "albedo", neph_json_number(light->albedo),
                             "density", neph_json_number(light->density), "optical_depth",
                             neph_json_number(cell->optical_depth), "tracer_noise",
                             neph_json_number(cell->noise), "tracer_s", cell->tracer_s, "left_out",
                             cell->left_out, "models", gaps_json(study, cell)));
    }
    return list;
}

static json_t *verdict_json(const struct neph_light_verdict *verdict)
{
    return json_pack("{s:i, s:o, s:o, s:o, s:o, s:o, s:o}", "cells", verdict->cell_count,
                     "mean_abs_bias", neph_json_number(verdict->mean_bias), "worst_abs_bias",
                     neph_json_number(verdict->worst_bias), "mean_rms",
                     neph_json_number(verdict->mean_rms), "share_bias_within_5_percent",
                     neph_json_number(verdict->share_within), "share_bias_within_15_percent",
                     neph_json_number(verdict->share_near), "share_rms_within_15_percent",
                     neph_json_number(verdict->share_smooth));
}

static json_t *verdicts_json(const struct neph_light_study *study)
{
    json_t *list = json_array();
    for (int model = 0; model < study->params->model_count; model++) {
        const struct neph_light_verdict dense = neph_light_verdict_of(study, model,
                                                                      NEPH_LIGHT_DENSE, NULL, NULL),
                                        whole = neph_light_verdict_of(study, model,
                                                                      NEPH_LIGHT_WHOLE, NULL, NULL);
        neph_json_add(&list, json_pack("{s:s, s:b, s:o, s:o}", "model",
                                       study->params->models[model], "look", study->looks[model],
                                       "dense", verdict_json(&dense), "all", verdict_json(&whole)));
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
    return json_pack("{s:s, s:s, s:s, s:[i,i], s:i, s:f, s:i, s:f, s:i, s:o, s:o, s:o, s:o}",
                     "format", "neph-light-study-2", "version", NEPH_VERSION, "device",
                     study->device, "size_px", params->width_px, params->height_px, "steps",
                     params->steps, "noise", params->noise, "samples", params->samples,
                     "sun_speed_deg_per_s", degrees(params->sun_speed_rad_per_s), "broken",
                     study->failed_count, "verdicts", verdicts_json(study), "cells",
                     cells_json(study), "axes", axes_json(), "maps", maps_json(study));
}
