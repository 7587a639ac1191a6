/* SPDX-License-Identifier: MIT
 *
 * The output of a flicker study: text, tables, JSON.
 */
#include "harness/experiments/flicker.h"

#include "harness/document/table.h"
#include "harness/study/flicker_answer.h"
#include "harness/study/flicker_floor.h"
#include "harness/study/flicker_pairs.h"
#include "harness/study/flicker_plot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static int count_displays(const struct neph_flicker_study *study)
{
    return neph_study_display_count(study->params->frame_rate_hz);
}

static struct neph_study_display find_display(const struct neph_flicker_study *study, int index)
{
    return neph_study_display_at(study->params->frame_rate_hz, index);
}

/* ---- text: head ------------------------------------------------------------------------------ */

/* The longest period P that `frame_count` frames distinguish from P - 1: the two frequencies differ
 * by 1 / (P (P - 1)), and the frequency resolution is 1 / N. */
static int longest_period(int frame_count)
{
    int period = 2;
    while (period * (period + 1) <= frame_count)
        period++;
    return period;
}

static void print_head(const struct neph_flicker_study *study, FILE *out)
{
    const struct neph_flicker_study_params *params = study->params;
    const struct neph_study_display display = find_display(study, 0);
    fprintf(out,
            "neph %s, %s: %dx%d, %d steps, %d frame%s, %d seed%s a scene.\n"
            "Display: %g Hz, %g pixels a degree, white at 100 cd/m2.\n"
            "%d frames resolve periods of 2 to %d frames; longer periods are not separated.\n",
            NEPH_VERSION, study->device, params->width_px, params->height_px, params->steps,
            params->frame_count, params->frame_count == 1 ? "" : "s", params->seed_count,
            params->seed_count == 1 ? "" : "s", display.frame_rate_hz, display.pixels_per_degree,
            params->frame_count, longest_period(params->frame_count));
}

/* Hide the number just added from the text when the scene was left out. */
static void add_empty_cells(struct neph_table *table, const char *left_out)
{
    if (left_out)
        neph_table_shown(table, "%s", "");
}

static void fill_scenes(const struct neph_flicker_study *study, struct neph_table *table)
{
    static const struct neph_column columns[] = {
        {.key = "scene", .title = "scene"},
        {.key = "title"},
        {.key = "moves"},
        {.title = ""},
        {.key = "frames", .title = "frames", .format = "%g"},
        {.key = "left_out"},
        {.key = "reference", .title = "reference"},
        {.key = "reference_pictures", .title = "pictures", .format = "%g"},
        {.key = "reference_cpu_s", .title = "CPU s", .format = "%.1f"},
        {.key = "takes_cpu_s", .title = "CPU s of the presets", .format = "%.1f"},
    };
    neph_table_columns(table, columns, sizeof(columns) / sizeof(columns[0]));
    for (int i = 0; i < study->params->scene_count; i++) {
        const struct neph_study_scene *scene = &study->scenes[i];
        const char *why = scene->left_out;
        neph_table_word(table, scene->name);
        neph_table_word(table, scene->title);
        neph_table_flag(table, scene->moves);
        neph_table_word(table, why ? "left out" : scene->moves ? "moves" : "at rest");
        neph_table_count(table, scene->frame_count);
        add_empty_cells(table, why);
        neph_table_word(table, why);
        neph_table_word(table, scene->reference);
        if (why)
            neph_table_shown(table, "cannot: %s", why);
        neph_table_count(table, scene->picture_count);
        add_empty_cells(table, why);
        neph_table_number(table, scene->reference_s);
        add_empty_cells(table, why);
        neph_table_number(table, scene->takes_s);
        add_empty_cells(table, why);
    }
}

static void print_scenes(const struct neph_flicker_study *study,
                         struct neph_publication *publication)
{
    FILE *out = publication->text;
    struct neph_table table = {.cells = NULL};
    fill_scenes(study, &table);
    fprintf(out, "\n**Scenes and their references**\n\n");
    neph_publication_table(publication, &table);
    for (int i = 0; i < study->params->scene_count; i++) {
        const struct neph_study_scene *scene = &study->scenes[i];
        if (!scene->left_out && scene->frame_count < study->params->frame_count)
            fprintf(out,
                    "\n"
                    "%s has %d frames of motion: they resolve periods of 2 to %d frames.\n",
                    scene->name, scene->frame_count, longest_period(scene->frame_count));
    }
}

/* ---- text: a table for each metric ----------------------------------------------------------- */

static bool is_metric_selected(const struct neph_flicker_study *study, int metric)
{
    return study->params->takes[neph_study_metrics[metric].take];
}

static const struct neph_study_cell *find_excluded_cell(const struct neph_flicker_study *study,
                                                        int metric, int scene, int preset)
{
    for (int seed = 0; seed < study->params->seed_count; seed++) {
        const struct neph_study_cell *cell = neph_study_cell_at(study, scene, preset, seed, metric);
        if (!cell->counts)
            return cell;
    }
    return NULL;
}

/* Add means over seeds of a preset or floor, valid or not; no mean when a seed has no number. */
static void add_means(const struct neph_flicker_study *study, int metric, int scene, int preset,
                      struct neph_table *table)
{
    const double scale = neph_study_metrics[metric].scale;
    const int seed_count = study->params->seed_count;
    double value = 0.0, centre = 0.0;
    bool is_bound = false;
    for (int seed = 0; seed < seed_count; seed++) {
        const struct neph_study_cell *cell = neph_study_cell_at(study, scene, preset, seed, metric);
        value += cell->value;
        centre += cell->centre;
        is_bound |= cell->is_bound;
    }
    const char *mark = find_excluded_cell(study, metric, scene, preset) ? "*" : is_bound ? "<" : "";
    neph_table_number(table, value);
    if (!isnan(value) && isnan(centre))
        neph_table_shown(table, "%s%.3g", mark, scale * (value / seed_count));
    else if (!isnan(value))
        neph_table_shown(table, "%s%.3g (%.3g)", mark, scale * (value / seed_count),
                         scale * (centre / seed_count));
}

/* Add the means of the lower candidate of a floor. */
static void add_floor_means(const struct neph_flicker_study *study, int metric, int scene,
                            int preset, struct neph_table *table)
{
    const struct neph_study_scene_gap gap = neph_study_scene_gap(study, metric, 0, preset, scene);
    if (gap.lower < 0)
        neph_table_number(table, NAN);
    else
        add_means(study, metric, scene, gap.lower, table);
}

/* Print once for each scene why numbers of a metric are not valid. */
static void print_reasons(const struct neph_flicker_study *study, int metric, FILE *out)
{
    const struct neph_flicker_study_params *params = study->params;
    for (int scene = 0; scene < params->scene_count; scene++)
        for (int preset = 0; preset < params->preset_count + params->floor_count; preset++) {
            const struct neph_study_cell *cell = find_excluded_cell(study, metric, scene, preset);
            if (!cell || study->scenes[scene].left_out)
                continue;
            fprintf(out, "\n%s, %s: %s.", study->scenes[scene].name, params->presets[preset],
                    cell->because);
            break;
        }
    fprintf(out, "\n");
}

static void print_metric(const struct neph_flicker_study *study, int metric,
                         struct neph_publication *publication)
{
    const struct neph_flicker_study_params *params = study->params;
    struct neph_table table = {.cells = NULL};
    neph_table_column(&table, (struct neph_column){.title = "scene"});
    for (int preset = 0; preset < params->preset_count; preset++)
        neph_table_column(&table,
                          (struct neph_column){.title = params->presets[preset], .format = "%g"});
    for (int preset = 0; params->floors && preset < params->preset_count; preset++)
        if (neph_flicker_floor_first(study, preset) == preset)
            neph_table_column(&table, (struct neph_column){.title = neph_flicker_floor_title(
                                                               study, preset, &table.arena),
                                                           .format = "%g"});
    for (int scene = 0; scene < params->scene_count; scene++) {
        if (study->scenes[scene].left_out)
            continue;
        neph_table_word(&table, study->scenes[scene].name);
        for (int preset = 0; preset < params->preset_count; preset++)
            add_means(study, metric, scene, preset, &table);
        for (int preset = 0; params->floors && preset < params->preset_count; preset++)
            if (neph_flicker_floor_first(study, preset) == preset)
                add_floor_means(study, metric, scene, preset, &table);
    }
    fprintf(publication->text, "\n**%s**\n\n", neph_study_metrics[metric].title);
    neph_publication_table(publication, &table);
    print_reasons(study, metric, publication->text);
}

/* ---- pairs ----------------------------------------------------------------------------------- */

static void begin_pairs(struct neph_table *table)
{
    static const struct neph_column columns[] = {
        {.key = "metric"},
        {.key = "mask"},
        {.key = "rate_hz"},
        {.key = "pixels_per_degree"},
        {.key = "first", .title = "first"},
        {.key = "second", .title = "second"},
        {.key = "scenes"},
        {.key = "decades", .title = "decades", .format = "%+.2f"},
        {.key = "interval", .title = "interval", .format = "%g"},
        {.key = "better"},
        {.key = "worse"},
        {.key = "alike"},
        {.title = "better, worse, alike", .format = "%g"},
        {.key = "p_sign", .title = "p of signs", .format = "%.2g"},
        {.title = ""},
    };
    neph_table_columns(table, columns, sizeof(columns) / sizeof(columns[0]));
}

/* When memory is short, the table's arena reports it. */
static struct neph_study_pair compare_presets(const struct neph_flicker_study *study, int metric,
                                              int display, int first, int second,
                                              struct neph_table *table)
{
    struct neph_study_pair pair = {.scene_count = 0};
    table->arena.is_short |= neph_study_pair(study, metric, display, first, second, &pair, NULL) !=
                             NEPH_OK;
    return pair;
}

/* A verdict; for eye metrics with the number of displays that agree. */
static const char *verdict_text(const struct neph_flicker_study *study, int metric, int first,
                                int second, int verdict, struct neph_table *table)
{
    static const char *const words[] = {"better", "undecided", "worse"};
    const int display_count = count_displays(study);
    int agreeing = 0;
    if (!neph_study_metrics[metric].of_the_eye)
        return words[verdict + 1];
    for (int display = 0; display < display_count; display++) {
        const struct neph_study_pair pair = compare_presets(study, metric, display, first, second,
                                                            table);
        agreeing += neph_study_pair_verdict(&pair) == verdict;
    }
    return agreeing == display_count
               ? neph_arena_format(&table->arena, "%s, at all %d displays", words[verdict + 1],
                                   agreeing)
               : neph_arena_format(&table->arena, "%s, at %d of %d displays", words[verdict + 1],
                                   agreeing, display_count);
}

static void add_pair(const struct neph_flicker_study *study, int metric, int display, int first,
                     int second, struct neph_table *table)
{
    const struct neph_study_metric *of = &neph_study_metrics[metric];
    const struct neph_study_display at = find_display(study, display);
    const struct neph_study_pair pair = compare_presets(study, metric, display, first, second,
                                                        table);
    const int verdict = neph_study_pair_verdict(&pair);
    neph_table_word(table, of->metric);
    neph_table_word(table, of->mask);
    neph_table_numbers(table, 2, (const double[]){at.frame_rate_hz, at.pixels_per_degree});
    neph_table_word(table, study->params->presets[first]);
    neph_table_word(table, study->params->presets[second]);
    neph_table_count(table, pair.scene_count);
    neph_table_number(table, pair.mean);
    neph_table_value(table,
                     pair.has_interval ? json_pack("[f,f]", pair.low, pair.high) : json_null());
    neph_table_shown(table, pair.has_interval ? "[%+.2f, %+.2f]" : "-", pair.low, pair.high);
    neph_table_count(table, pair.better);
    neph_table_count(table, pair.worse);
    neph_table_count(table, pair.alike);
    neph_table_word(table, NULL);
    neph_table_shown(table, "%d, %d, %d", pair.better, pair.worse, pair.alike);
    neph_table_number(table, pair.p_sign);
    neph_table_word(table, verdict_text(study, metric, first, second, verdict, table));
}

/* Add the pairs of a metric for the first `display_count` displays. */
static void add_pairs(const struct neph_flicker_study *study, int metric, int display_count,
                      struct neph_table *table)
{
    const int preset_count = study->params->preset_count;
    for (int display = 0; display < display_count; display++)
        for (int first = 0; first < preset_count; first++)
            for (int second = first + 1; second < preset_count; second++)
                add_pair(study, metric, display, first, second, table);
}

static void print_pairs(const struct neph_flicker_study *study, int metric,
                        struct neph_publication *publication)
{
    struct neph_table table = {.cells = NULL};
    begin_pairs(&table);
    add_pairs(study, metric, 1, &table);
    fprintf(publication->text, "\nFirst over second in decades, below 0 the first is better; 95 %% "
                               "intervals over scenes.\n\n");
    neph_publication_table(publication, &table);
}

static void print_ratios(const struct neph_flicker_study *study, int metric,
                         struct neph_publication *publication)
{
    struct neph_table table = {.cells = NULL};
    neph_flicker_floor_begin_ratios(&table);
    neph_flicker_floor_add_ratios(study, metric, 1, &table);
    fprintf(publication->text, "\nTimes the floor, below 1 the preset is better than every pixel "
                               "marched; geometric means, 95 %% intervals over scenes.\n\n");
    neph_publication_table(publication, &table);
}

static void print_ranking(const struct neph_flicker_study *study,
                          struct neph_publication *publication)
{
    FILE *out = publication->text;
    int first[NEPH_STUDY_PRESETS_MAX] = {0};
    const int display_count = count_displays(study);
    int agreeing = 0;
    fprintf(out,
            "\n**Ranking by: %s**\n\nBest first, by the mean over scenes in which all presets "
            "have a number that counts.\n\n",
            neph_study_metrics[neph_study_find_headline()].title);
    for (int display = 0; display < display_count; display++) {
        const struct neph_study_display at = find_display(study, display);
        int order[NEPH_STUDY_PRESETS_MAX] = {0};
        publication->arena.is_short |= neph_study_ranking(study, display, order, NULL) != NEPH_OK;
        if (display == 0)
            memcpy(first, order, sizeof(first));
        const bool is_same = memcmp(order, first, sizeof(first)) == 0;
        fprintf(out, "- %g Hz, %g pixels a degree:", at.frame_rate_hz, at.pixels_per_degree);
        for (int i = 0; i < study->params->preset_count; i++)
            fprintf(out, "%s %s", i ? "," : "", study->params->presets[order[i]]);
        agreeing += is_same;
        fprintf(out, "%s\n", is_same ? "" : " (another order)");
    }
    if (agreeing == display_count)
        fprintf(out,
                "\n"
                "The order is the same at all %d displays.\n",
                display_count);
    else
        fprintf(out,
                "\n"
                "The order is the same at %d of %d displays: it is not a ranking.\n",
                agreeing, display_count);
}

static void print_text(const struct neph_flicker_study *study, struct neph_publication *publication)
{
    const bool has_pairs = study->params->preset_count > 1;
    print_head(study, publication->text);
    print_scenes(study, publication);
    neph_flicker_floor_print_list(study, &publication->arena, publication->text);
    fprintf(
        publication->text,
        "\n"
        "In brackets: the same number against centre rays. *: left out of pairs and ranking, for "
        "the reason below its table. <: not separated from the other changes; the number is the "
        "sum of all changes, an upper bound; in a pair, numbers below the bound count as equal.\n");
    for (int metric = 0; neph_study_metrics[metric].title; metric++) {
        if (!is_metric_selected(study, metric))
            continue;
        print_metric(study, metric, publication);
        if (study->params->floors)
            print_ratios(study, metric, publication);
        if (has_pairs)
            print_pairs(study, metric, publication);
    }
    if (has_pairs && is_metric_selected(study, neph_study_find_headline()))
        print_ranking(study, publication);
}

/* ---- all numbers ----------------------------------------------------------------------------- */

static void begin_results(const struct neph_flicker_study *study, struct neph_table *table)
{
    static const struct neph_column columns[] = {
        {.key = "scene"},
        {.key = "preset"},
        {.key = "seed"},
        {.key = "metric"},
        {.key = "mask"},
        {.key = "value"},
        {.key = "against_centre_rays"},
        {.key = "is_bound"},
        {.key = "counts"},
        {.key = "because"},
        {.key = "at_displays", .forms = NEPH_TABLE_JSON},
    };
    neph_table_columns(table, columns, sizeof(columns) / sizeof(columns[0]));
    for (int d = 0; d < count_displays(study); d++) {
        const struct neph_study_display at = find_display(study, d);
        char key[64];
        snprintf(key, sizeof(key), "at_%g_hz_%g_ppd", at.frame_rate_hz, at.pixels_per_degree);
        neph_table_column(table, (struct neph_column){.key = key, .forms = NEPH_TABLE_CSV});
    }
    neph_flicker_floor_columns(table);
}

static void add_result(const struct neph_flicker_study *study, int scene, int preset, int seed,
                       int metric, struct neph_table *table)
{
    const struct neph_study_cell *cell = neph_study_cell_at(study, scene, preset, seed, metric);
    json_t *displays = json_array();
    for (int d = 0; d < count_displays(study) && neph_study_metrics[metric].of_the_eye; d++)
        neph_json_add(&displays, neph_json_number(cell->displays[d]));
    neph_table_word(table, study->scenes[scene].name);
    neph_table_word(table, study->params->presets[preset]);
    neph_table_count(table, study->params->seeds_before + seed + 1);
    neph_table_word(table, neph_study_metrics[metric].metric);
    neph_table_word(table, neph_study_metrics[metric].mask);
    neph_table_numbers(table, 2, (const double[]){cell->value, cell->centre});
    neph_table_flag(table, cell->is_bound);
    neph_table_flag(table, cell->counts);
    neph_table_word(table, cell->because);
    neph_table_value(table, displays);
    neph_table_numbers(table, count_displays(study), cell->displays);
    neph_flicker_floor_cells(study, metric, scene, preset, seed, table);
}

static void fill_results(const struct neph_flicker_study *study, struct neph_table *table)
{
    const struct neph_flicker_study_params *params = study->params;
    begin_results(study, table);
    for (int scene = 0; scene < params->scene_count; scene++)
        for (int preset = 0; preset < params->preset_count + params->floor_count; preset++)
            for (int seed = 0; seed < params->seed_count; seed++)
                for (int metric = 0; neph_study_metrics[metric].title; metric++)
                    if (!study->scenes[scene].left_out && is_metric_selected(study, metric))
                        add_result(study, scene, preset, seed, metric, table);
}

static json_t *metrics_json(const struct neph_flicker_study *study)
{
    json_t *list = json_array();
    for (int m = 0; neph_study_metrics[m].title; m++) {
        const struct neph_study_metric *metric = &neph_study_metrics[m];
        if (is_metric_selected(study, m))
            neph_json_add(&list, json_pack("{s:s, s:s, s:s, s:s, s:b}", "title", metric->title,
                                           "take", neph_study_captures[metric->take].name, "metric",
                                           metric->metric, "mask", metric->mask, "of_the_eye",
                                           metric->of_the_eye));
    }
    return list;
}

static json_t *presets_json(const struct neph_flicker_study *study)
{
    json_t *list = json_array();
    for (int i = 0; i < study->params->preset_count; i++)
        neph_json_add(&list, json_pack("{s:s, s:s}", "preset", study->params->presets[i],
                                       "settings", study->settings[i]));
    return list;
}

static json_t *pairs_json(const struct neph_flicker_study *study)
{
    struct neph_table table = {.cells = NULL};
    begin_pairs(&table);
    for (int metric = 0; neph_study_metrics[metric].title; metric++)
        if (is_metric_selected(study, metric))
            add_pairs(study, metric,
                      neph_study_metrics[metric].of_the_eye ? count_displays(study) : 1, &table);
    json_t *list = neph_table_json(&table);
    neph_table_finish(&table);
    return list;
}

static json_t *ratios_json(const struct neph_flicker_study *study)
{
    struct neph_table table = {.cells = NULL};
    neph_flicker_floor_begin_ratios(&table);
    for (int metric = 0; neph_study_metrics[metric].title && study->params->floors; metric++)
        if (is_metric_selected(study, metric))
            neph_flicker_floor_add_ratios(
                study, metric, neph_study_metrics[metric].of_the_eye ? count_displays(study) : 1,
                &table);
    json_t *list = neph_table_json(&table);
    neph_table_finish(&table);
    return list;
}

static json_t *study_json(const struct neph_flicker_study *study, const struct neph_table *results)
{
    const struct neph_flicker_study_params *params = study->params;
    struct neph_table scenes = {.cells = NULL};
    fill_scenes(study, &scenes);
    json_t *json = json_pack(
        "{s:s, s:s, s:s, s:[i,i], s:o, s:i, s:i, s:i, s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:o}",
        "format", "neph-flicker-study-1", "version", NEPH_VERSION, "device", study->device,
        "size_px", params->width_px, params->height_px, "fps",
        neph_json_number(params->frame_rate_hz > 0.0 ? params->frame_rate_hz : NAN), "steps",
        params->steps, "frames", params->frame_count, "seeds", params->seed_count, "broken",
        study->failed_count, "presets", presets_json(study), "scenes", neph_table_json(&scenes),
        "metrics", metrics_json(study), "results", neph_table_json(results), "pairs",
        pairs_json(study), "floors", neph_flicker_floor_json(study), "times_floor",
        ratios_json(study));
    neph_table_finish(&scenes);
    return json;
}

enum neph_status neph_flicker_publish(const struct neph_flicker_study *study,
                                      struct neph_publication *publication, struct neph_diag *diag)
{
    struct neph_table results = {.cells = NULL};
    enum neph_status status = NEPH_OK;
    fill_results(study, &results);
    if (publication->text)
        print_text(study, publication);
    if (publication->chart)
        status = neph_flicker_study_plot(study, publication->chart, diag);
    if (!status)
        status = neph_flicker_answer(study, &publication->answer, diag);
    if (!status && publication->places->json) {
        publication->json = study_json(study, &results);
        status = neph_json_check(publication->json, diag);
    }
    neph_publication_csv(publication, "\r\n", &results);
    publication->broken_count = study->failed_count;
    publication->broken_words = "sequences failed; their cells give the reason";
    return status;
}
