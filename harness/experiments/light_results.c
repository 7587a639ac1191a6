/* SPDX-License-Identifier: MIT */
#include "harness/experiments/light.h"

#include "harness/document/table.h"
#include "metrics/significance.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Compiles only when this file handles every part. */
_Static_assert(NEPH_LIGHT_PARTS == 2, "a new kind");

static const char *const part_names[NEPH_LIGHT_PARTS] = {"dense parts", "whole picture"};

static double degrees(double angle_rad)
{
    return angle_rad / NEPH_RAD_PER_DEG;
}

/* The side of the sun from the camera. */
static const char *find_sun_side(const struct neph_light_cell *cell)
{
    const double from_ahead = fabs(degrees(cell->light.sun_azimuth_rad));
    return from_ahead < 60.0 ? "in front" : from_ahead <= 120.0 ? "beside" : "behind";
}

/* A column for each model. */
static void add_model_columns(const struct neph_light_study *study, struct neph_table *table)
{
    for (int model = 0; model < study->request->models.count; model++)
        neph_table_column(table, (struct neph_column){.title = study->request->models.words[model],
                                                      .format = "%g"});
}

static void print_head(const struct neph_light_study *study, FILE *out)
{
    const struct neph_light_request *request = study->request;
    fprintf(out,
            "neph %s, %s: %dx%d, %d steps; the tracer twice, each to a noise of %g with at most %d "
            "samples.\nRadiance of the media under a sun of 1 W/m2 and nothing else, black "
            "solids. Dense: pixels that less than a tenth comes through.\nBias: mean of the model "
            "over mean of the tracer, less 1. rms: over the same mean, without the tracer's "
            "noise.\n",
            NEPH_VERSION, study->tracer.info.device, request->shared.size.width_px,
            request->shared.size.height_px, request->steps, request->noise, request->samples);
    if (request->sun_speed_deg_per_s > 0.0)
        fprintf(out,
                "Models with a history have rendered the sun sinking to its place by %g degrees a "
                "second, at 60 frames a second.\n",
                request->sun_speed_deg_per_s);
}

/* Print once for each model why it has no result, or only single scattering. */
static void print_notes(const struct neph_light_study *study, FILE *out)
{
    for (int model = 0; model < study->request->models.count; model++)
        for (int i = 0; i < study->cell_count; i++) {
            const struct neph_light_gap *gap = &study->cells[i].gaps[model];
            const char *name = study->request->models.words[model];
            if (study->cells[i].left_out[0] || (!gap->once && !gap->because[0]))
                continue;
            if (gap->once)
                fprintf(out, "\n%s: of light scattered once, against all orders.\n", name);
            else
                fprintf(out, "\n%s cannot, in %s: %s.\n", name, study->cells[i].scene,
                        gap->because);
            break;
        }
}

/* ---- verdicts -------------------------------------------------------------------------------- */

#define AT(member) offsetof(struct neph_light_verdict, member)
static const struct neph_field verdict_fields[] = {
    {{"mean_abs_bias", "mean of abs(bias)", .format = "%.1f", .scale = 100.0}, AT(mean_bias)},
    {{"worst_abs_bias", "worst", .format = "%.1f", .scale = 100.0}, AT(worst_bias)},
    {{"mean_rms", "mean rms", .format = "%.1f", .scale = 100.0}, AT(mean_rms)},
    {{"share_bias_within_5_percent", "cells with abs(bias) <= 5", .format = "%.1f", .scale = 100.0},
     AT(share_within)},
    {{"share_bias_within_15_percent", "<= 15", .format = "%.1f", .scale = 100.0}, AT(share_near)},
    {{"share_rms_within_15_percent", "with rms <= 15", .format = "%.1f", .scale = 100.0},
     AT(share_smooth)},
};
#undef AT
enum { VERDICT_FIELDS = sizeof(verdict_fields) / sizeof(verdict_fields[0]) };

static void print_verdicts(const struct neph_light_study *study,
                           struct neph_publication *publication)
{
    static const struct neph_column columns[] = {
        {.title = "model"}, {.title = "of"}, {.title = "cells", .format = "%ld"}};
    struct neph_table table = {.cells = NULL};
    neph_table_columns(&table, columns, 3);
    neph_table_fields(&table, verdict_fields, VERDICT_FIELDS);
    for (int model = 0; model < study->request->models.count; model++)
        for (int part = 0; part < NEPH_LIGHT_PARTS; part++) {
            const struct neph_light_verdict verdict = neph_light_find_verdict(
                study, model, (enum neph_light_part)part, NULL, NULL);
            neph_table_word(&table, "");
            neph_table_shown(&table, "%s%s", study->request->models.words[model],
                             neph_light_model_is_non_physical(&study->models[model]) ? ", a look"
                                                                                     : "");
            neph_table_word(&table, part_names[part]);
            neph_table_count(&table, verdict.cell_count);
            neph_table_field_cells(&table, verdict_fields, VERDICT_FIELDS, &verdict);
        }
    fprintf(publication->text, "\n**Models over cells, in %%**\n\n");
    neph_publication_table(publication, &table);
}

static json_t *verdict_json(const struct neph_light_study *study, int model,
                            enum neph_light_part part)
{
    const struct neph_light_verdict verdict = neph_light_find_verdict(study, model, part, NULL,
                                                                      NULL);
    return neph_fields_json(json_pack("{s:i}", "cells", verdict.cell_count), verdict_fields,
                            VERDICT_FIELDS, &verdict);
}

/* ---- groups of cells ------------------------------------------------------------------------- */

enum key { KEY_SCENE, KEY_SUN, KEY_G, KEY_ALBEDO, KEY_DEPTH, KEYS };
static const char *const key_titles[KEYS] = {"cloud", "sun", "g", "albedo", "optical depth"};

enum { WORD_SIZE = 96 };

/* A group: the cells with this value of a key. */
struct match {
    enum key key;
    char word[WORD_SIZE];
};

static void write_depth_range(double depth, char *word)
{
    static const double edges[] = {3.0, 10.0, 30.0, 100.0};
    double from = 0.0;
    for (size_t i = 0; i < sizeof(edges) / sizeof(edges[0]); from = edges[i++])
        if (depth < edges[i]) {
            snprintf(word, WORD_SIZE, "%g to %g", from, edges[i]);
            return;
        }
    snprintf(word, WORD_SIZE, "%g and more", from);
}

static struct match make_match(const struct neph_light_cell *cell, enum key key)
{
    struct match match = {.key = key};
    if (key == KEY_SCENE || key == KEY_SUN)
        snprintf(match.word, WORD_SIZE, "%s", key == KEY_SUN ? find_sun_side(cell) : cell->scene);
    else if (key == KEY_DEPTH)
        write_depth_range(cell->optical_depth, match.word);
    else if (key == KEY_G)
        snprintf(match.word, WORD_SIZE, "%.3g", cell->light.g);
    else
        snprintf(match.word, WORD_SIZE, "%.4g", cell->light.albedo);
    return match;
}

static bool is_match(const struct neph_light_cell *cell, const void *context)
{
    const struct match *match = context;
    return strcmp(make_match(cell, match->key).word, match->word) == 0;
}

/* True when no earlier cell is in the group. */
static bool is_first(const struct neph_light_study *study, int cell, const struct match *match)
{
    for (int i = 0; i < cell; i++)
        if (!study->cells[i].left_out[0] && is_match(&study->cells[i], match))
            return false;
    return true;
}

static void add_key_row(const struct neph_light_study *study, enum neph_light_part part,
                        const struct match *match, struct neph_table *table)
{
    neph_table_word(table, match->word);
    for (int model = 0; model < study->request->models.count; model++) {
        const struct neph_light_verdict verdict = neph_light_find_verdict(study, model, part,
                                                                          is_match, match);
        neph_table_number(table, verdict.mean_bias);
        if (verdict.cell_count > 0)
            neph_table_shown(table, "%.1f (%+.1f), %d", 100.0 * verdict.mean_bias,
                             100.0 * verdict.mean_signed_bias, verdict.cell_count);
    }
}

static void print_key(const struct neph_light_study *study, enum key key, enum neph_light_part part,
                      struct neph_publication *publication)
{
    struct neph_table table = {.cells = NULL};
    neph_table_column(&table, (struct neph_column){.title = key_titles[key]});
    add_model_columns(study, &table);
    for (int i = 0; i < study->cell_count; i++) {
        const struct match match = make_match(&study->cells[i], key);
        if (!study->cells[i].left_out[0] && is_first(study, i, &match))
            add_key_row(study, part, &match, &table);
    }
    fprintf(publication->text, "\n**By %s, %s: mean of abs(bias) (of bias) in %%, cells**\n\n",
            key_titles[key], part_names[part]);
    neph_publication_table(publication, &table);
}

/* ---- bins of the axes ------------------------------------------------------------------------ */

/* All pixels in a bin of an axis. */
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

static void print_axis(const struct neph_light_study *study, enum neph_light_axis axis,
                       struct neph_publication *publication)
{
    static const struct neph_column columns[] = {{.title = "from", .format = "%.3g"},
                                                 {.title = "to", .format = "%.3g"},
                                                 {.title = "pixels", .format = "%ld"}};
    const struct neph_light_axis_row *row = &neph_light_axes[axis];
    struct neph_table table = {.cells = NULL};
    neph_table_columns(&table, columns, 3);
    add_model_columns(study, &table);
    for (int bin = 0; bin < NEPH_LIGHT_BINS; bin++) {
        neph_table_numbers(&table, 2, &row->edges[bin]);
        neph_table_count(&table, sums_along(study, 0, axis, bin).count);
        for (int model = 0; model < study->request->models.count; model++) {
            const struct neph_light_sums sums = sums_along(study, model, axis, bin);
            const double ratio = neph_light_ratio(&sums);
            neph_table_number(&table, ratio);
            if (!isnan(ratio))
                neph_table_shown(&table, "%.3f (%.0f)", ratio, 100.0 * neph_light_rms(&sums));
        }
    }
    fprintf(publication->text,
            "\n**By %s: radiance over the tracer's (rms in %%), pixels of all cells**\n\n",
            row->title);
    neph_publication_table(publication, &table);
}

/* ---- cells ----------------------------------------------------------------------------------- */

static void add_cell_row(const struct neph_light_study *study, const struct neph_light_cell *cell,
                         enum neph_light_part part, struct neph_table *table)
{
    const struct neph_light_sums *sums = neph_light_part_sums(&cell->gaps[0], part);
    neph_table_word(table, cell->scene);
    neph_table_word(table, find_sun_side(cell));
    neph_table_shown(table, "%s, %.0f, %.0f", find_sun_side(cell),
                     degrees(cell->light.sun_elevation_rad), degrees(cell->light.sun_azimuth_rad));
    neph_table_numbers(table, 3,
                       (const double[]){cell->light.g, cell->light.albedo, cell->optical_depth});
    neph_table_count(table, sums->count);
    if (cell->left_out[0]) {
        neph_table_shown(table, "left out: %s", cell->left_out);
        neph_table_end_row(table);
        return;
    }
    neph_table_number(table, neph_light_counts(sums) ? sqrt(sums->noise) / sums->truth : 0.0);
    for (int model = 0; model < study->request->models.count; model++) {
        sums = neph_light_part_sums(&cell->gaps[model], part);
        neph_table_number(table, NAN);
        if (neph_light_counts(sums))
            neph_table_shown(table, "%+.1f (%.1f)", 100.0 * neph_light_bias(sums),
                             100.0 * neph_light_rms(sums));
    }
}

static void print_cells(const struct neph_light_study *study, enum neph_light_part part,
                        struct neph_publication *publication)
{
    static const struct neph_column columns[] = {
        {.title = "cloud"},
        {.title = "sun"},
        {.title = "g", .format = "%.3g", .none = "nan"},
        {.title = "albedo", .format = "%.4g", .none = "nan"},
        {.title = "optical depth", .format = "%.3g", .none = "nan"},
        {.title = "pixels", .format = "%ld"},
        {.title = "noise", .format = "%.1f", .scale = 100.0},
    };
    struct neph_table table = {.cells = NULL};
    neph_table_columns(&table, columns, sizeof(columns) / sizeof(columns[0]));
    add_model_columns(study, &table);
    for (int i = 0; i < study->cell_count; i++)
        add_cell_row(study, &study->cells[i], part, &table);
    fprintf(publication->text, "\n**Cells, %s: bias (rms) in %%**\n\n", part_names[part]);
    neph_publication_table(publication, &table);
}

static void print_text(const struct neph_light_study *study, struct neph_publication *publication)
{
    print_head(study, publication->text);
    print_notes(study, publication->text);
    print_verdicts(study, publication);
    for (int key = 0; key < KEYS; key++)
        for (int part = 0; part < NEPH_LIGHT_PARTS; part++)
            print_key(study, (enum key)key, (enum neph_light_part)part, publication);
    for (int axis = 0; axis < NEPH_LIGHT_AXES; axis++)
        print_axis(study, (enum neph_light_axis)axis, publication);
    fprintf(
        publication->text,
        "\n"
        "In the next tables the sun's elevation and azimuth are in degrees, and azimuth 0 is the "
        "direction of the camera, 180 behind it; a tenth of a cell's pixels with media have more "
        "than its optical depth; noise is the standard error of the tracer's mean, in %%.\n");
    for (int part = 0; part < NEPH_LIGHT_PARTS; part++)
        print_cells(study, (enum neph_light_part)part, publication);
}

/* ---- CSV ------------------------------------------------------------------------------------- */

/* Values that are not finite become missing numbers. */
static void add_finite(struct neph_table *table, int count, const double *values)
{
    for (int i = 0; i < count; i++)
        neph_table_number(table, isfinite(values[i]) ? values[i] : NAN);
}

static void add_csv_sums(const struct neph_light_sums *sums, struct neph_table *table)
{
    const double numbers[] = {neph_light_bias(sums), neph_light_bias_noise(sums),
                              neph_light_rms(sums)};
    neph_table_count(table, sums->count);
    add_finite(table, 3, numbers);
}

static void add_csv_row(const struct neph_light_study *study, const struct neph_light_cell *cell,
                        int model, struct neph_table *table)
{
    const struct neph_light_gap *gap = &cell->gaps[model];
    const double numbers[] = {degrees(cell->light.sun_elevation_rad),
                              degrees(cell->light.sun_azimuth_rad),
                              cell->light.g,
                              cell->light.albedo,
                              cell->light.density,
                              cell->optical_depth};
    neph_table_word(table, cell->scene);
    add_finite(table, 6, numbers);
    neph_table_word(table, find_sun_side(cell));
    neph_table_word(table, study->request->models.words[model]);
    add_csv_sums(&gap->dense, table);
    add_csv_sums(&gap->all, table);
    add_finite(table, 2, (const double[]){gap->render_s, cell->noise});
    neph_table_word(table, cell->left_out[0] ? cell->left_out : gap->because);
}

/* A line for each cell and model. */
static void print_csv(const struct neph_light_study *study, struct neph_publication *publication)
{
    static const char *const names[] = {"scene",
                                        "sun_elevation_deg",
                                        "sun_azimuth_deg",
                                        "g",
                                        "albedo",
                                        "density",
                                        "optical_depth",
                                        "sun",
                                        "model",
                                        "dense_pixels",
                                        "dense_bias",
                                        "dense_bias_noise",
                                        "dense_rms",
                                        "pixels",
                                        "bias",
                                        "bias_noise",
                                        "rms",
                                        "render_s",
                                        "tracer_noise",
                                        "because"};
    struct neph_table table = {.cells = NULL};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        neph_table_column(&table, (struct neph_column){.key = names[i]});
    for (int i = 0; i < study->cell_count; i++)
        for (int model = 0; model < study->request->models.count; model++)
            add_csv_row(study, &study->cells[i], model, &table);
    neph_publication_csv(publication, "\r\n", &table);
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

static json_t *cell_json(const struct neph_light_study *study, const struct neph_light_cell *cell)
{
    const struct neph_relight *light = &cell->light;
    json_t *models = json_array();
    for (int model = 0; model < study->request->models.count; model++) {
        const struct neph_light_gap *gap = &cell->gaps[model];
        neph_json_add(&models, json_pack("{s:s, s:o, s:o, s:f, s:b, s:s}", "model",
                                         study->request->models.words[model], "dense",
                                         sums_json(&gap->dense), "all", sums_json(&gap->all),
                                         "render_s", gap->render_s, "scattered_once", gap->once,
                                         "because", gap->because));
    }
    return json_pack("{s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:f, s:s, s:o}", "scene",
                     cell->scene, "sun", find_sun_side(cell), "sun_elevation_deg",
                     neph_json_number(degrees(light->sun_elevation_rad)), "sun_azimuth_deg",
                     neph_json_number(degrees(light->sun_azimuth_rad)), "g",
                     neph_json_number(light->g), "albedo", neph_json_number(light->albedo),
                     "density", neph_json_number(light->density), "optical_depth",
                     neph_json_number(cell->optical_depth), "tracer_noise",
                     neph_json_number(cell->noise), "tracer_s", cell->tracer_s, "left_out",
                     cell->left_out, "models", models);
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

static json_t *axis_json(const struct neph_light_axis_row *axis)
{
    json_t *edges = json_array();
    for (int i = 0; i <= NEPH_LIGHT_BINS; i++)
        neph_json_add(&edges, neph_json_number(axis->edges[i]));
    return json_pack("{s:s, s:o}", "title", axis->title, "edges", edges);
}

static json_t *make_json(const struct neph_light_study *study)
{
    const struct neph_light_request *request = study->request;
    json_t *verdicts = json_array(), *cells = json_array(), *axes = json_array(),
           *maps = json_array();
    for (int m = 0; m < request->models.count; m++) {
        const char *name = request->models.words[m];
        neph_json_add(&verdicts, json_pack("{s:s, s:b, s:o, s:o}", "model", name, "look",
                                           neph_light_model_is_non_physical(&study->models[m]),
                                           "dense", verdict_json(study, m, NEPH_LIGHT_DENSE), "all",
                                           verdict_json(study, m, NEPH_LIGHT_WHOLE)));
        neph_json_add(&maps, json_pack("{s:s, s:o, s:o}", "model", name, "eye_sun",
                                       map_json(&study->eye_sun[m]), "eye_angle",
                                       map_json(&study->eye_angle[m])));
    }
    for (int i = 0; i < study->cell_count; i++)
        neph_json_add(&cells, cell_json(study, &study->cells[i]));
    for (int axis = 0; axis < NEPH_LIGHT_AXES; axis++)
        neph_json_add(&axes, axis_json(&neph_light_axes[axis]));
    return json_pack("{s:s, s:s, s:s, s:[i,i], s:i, s:f, s:i, s:f, s:i, s:o, s:o, s:o, s:o}",
                     "format", "neph-light-study-2", "version", NEPH_VERSION, "device",
                     study->tracer.info.device, "size_px", request->shared.size.width_px,
                     request->shared.size.height_px, "steps", request->steps, "noise",
                     request->noise, "samples", request->samples, "sun_speed_deg_per_s",
                     request->sun_speed_deg_per_s, "broken", study->failed_count, "verdicts",
                     verdicts, "cells", cells, "axes", axes, "maps", maps);
}

/* ---- complete output ------------------------------------------------------------------------- */

/* Print the laws after the study. */
static enum neph_status print_laws(const struct neph_light_study *study, FILE *out,
                                   struct neph_diag *diag)
{
    char *text = NULL;
    const enum neph_status status = neph_light_laws_text(&study->laws, &text, diag);
    if (!status)
        fputs(text, out);
    free(text);
    return status;
}

/* ---- the answer ------------------------------------------------------------------------------ */

/* Count the cells in which the |bias| of one model is smaller than the other's, and larger. */
static void count_nearer(const struct neph_light_study *study, int model, int other, int *nearer,
                         int *farther)
{
    *nearer = *farther = 0;
    for (int i = 0; i < study->cell_count; i++) {
        const struct neph_light_cell *cell = &study->cells[i];
        const struct neph_light_sums *a = neph_light_part_sums(&cell->gaps[model],
                                                               NEPH_LIGHT_DENSE);
        const struct neph_light_sums *b = neph_light_part_sums(&cell->gaps[other],
                                                               NEPH_LIGHT_DENSE);
        if (cell->left_out[0] || !neph_light_counts(a) || !neph_light_counts(b))
            continue;
        *nearer += fabs(neph_light_bias(a)) < fabs(neph_light_bias(b));
        *farther += fabs(neph_light_bias(a)) > fabs(neph_light_bias(b));
    }
}

/* Sort by mean |bias| in dense parts, smallest first; models without a number last. */
static void sort_models(const struct neph_light_study *study,
                        struct neph_light_verdict verdicts[NEPH_LIGHT_MODELS_MAX],
                        int order[NEPH_LIGHT_MODELS_MAX])
{
    for (int m = 0; m < study->request->models.count; m++) {
        int place = m;
        verdicts[m] = neph_light_find_verdict(study, m, NEPH_LIGHT_DENSE, NULL, NULL);
        const double bias = verdicts[m].mean_bias;
        for (; place > 0; place--) {
            const double before = verdicts[order[place - 1]].mean_bias;
            if (!(bias < before || (isfinite(bias) && isnan(before))))
                break;
            order[place] = order[place - 1];
        }
        order[place] = m;
    }
}

static void answer(const struct neph_light_study *study, struct neph_answer *answer)
{
    struct neph_light_verdict verdicts[NEPH_LIGHT_MODELS_MAX];
    int order[NEPH_LIGHT_MODELS_MAX];
    const int count = study->request->models.count;
    sort_models(study, verdicts, order);
    for (int i = 0; i < count; i++) {
        const struct neph_light_verdict *of = &verdicts[order[i]];
        const char *name = study->request->models.words[order[i]];
        char against[160] = "";
        int nearer, farther;
        if (of->cell_count == 0) {
            neph_answer_add(answer, "%s: not measured", name);
            continue;
        }
        if (i == 0 && count > 1) {
            count_nearer(study, order[0], order[1], &nearer, &farther);
            const double p = neph_sign_p(farther, nearer);
            snprintf(against, sizeof(against),
                     "; %s %.60s: nearer in %d, farther in %d cells, p = "
                     "%.2g",
                     p < 0.05 ? "than" : "not told apart from",
                     study->request->models.words[order[1]], nearer, farther, p);
        }
        neph_answer_add(answer,
                        "%s%s: bias %.1f %% in the mean, %.1f %% at most, over %d cells "
                        "(dense parts)%s",
                        i == 0 && count > 1 ? "nearest: " : "", name, 100.0 * of->mean_bias,
                        100.0 * of->worst_bias, of->cell_count, against);
    }
}

enum neph_status neph_light_publish(const struct neph_light_study *study,
                                    struct neph_publication *publication, struct neph_diag *diag)
{
    if (publication->text)
        print_text(study, publication);
    answer(study, &publication->answer);
    if (publication->csv)
        print_csv(study, publication);
    if (publication->chart)
        neph_light_plot(study, publication->chart);
    publication->broken_count = study->failed_count;
    publication->broken_words = "cells broke; their lines say why";
    publication->json = make_json(study);
    if (!study->request->laws)
        return NEPH_OK;
    neph_json_set(&publication->json, "laws", neph_light_laws_json(&study->laws));
    return publication->text ? print_laws(study, publication->text, diag) : NEPH_OK;
}
