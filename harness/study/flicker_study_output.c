/* SPDX-License-Identifier: MIT */
#include "harness/study/flicker_study_output.h"

#include "harness/study/flicker_pairs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- what was asked -------------------------------------------------------------------------- */

/* The longest period P that `frame_count` frames tell from P - 1: their frequencies are
 * 1 / (P (P - 1)) apart, and a bin is 1 / N. */
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
    const struct neph_study_display *display = &neph_study_displays[0];
    fprintf(out,
            "neph %s, %s: %dx%d, %d steps, %d frame%s, %d seed%s a scene.\n"
            "Display: %g Hz, %g pixels a degree, white at 100 cd/m2.\n"
            "%d frames tell periods of 2 to %d frames apart; longer ones run into each other.\n",
            NEPH_VERSION, study->device, params->width_px, params->height_px, params->steps,
            params->frame_count, params->frame_count == 1 ? "" : "s", params->seed_count,
            params->seed_count == 1 ? "" : "s", display->frame_rate_hz, display->pixels_per_degree,
            params->frame_count, longest_period(params->frame_count));
}

static void print_scenes(const struct neph_flicker_study *study, FILE *out)
{
    fprintf(out, "\n**Scenes and their references**\n\n"
                 "| scene | | frames | reference | pictures | CPU s | CPU s of the presets |\n"
                 "| --- | --- | ---: | --- | ---: | ---: | ---: |\n");
    for (int i = 0; i < study->params->scene_count; i++) {
        const struct neph_study_scene *scene = &study->scenes[i];
        if (scene->left_out)
            fprintf(out, "| %s | left out | | cannot: %s | | | |\n", scene->name, scene->left_out);
        else
            fprintf(out, "| %s | %s | %d | %s | %d | %.1f | %.1f |\n", scene->name,
                    scene->moves ? "moves" : "at rest", scene->frame_count,
                    scene->reference ? scene->reference : "", scene->picture_count,
                    scene->reference_s, scene->takes_s);
    }
    for (int i = 0; i < study->params->scene_count; i++)
        if (!study->scenes[i].left_out && study->scenes[i].frame_count < study->params->frame_count)
            fprintf(out,
                    "\n%s has %d frames of motion: they tell periods of 2 to %d frames apart.\n",
                    study->scenes[i].name, study->scenes[i].frame_count,
                    longest_period(study->scenes[i].frame_count));
}

/* ---- tables ---------------------------------------------------------------------------------- */

/* Mean over seeds of a number, whether it counts or not; NaN when a seed has none. */
static double shown(const struct neph_flicker_study *study, int metric, int scene, int preset,
                    bool centre)
{
    double sum = 0.0;
    for (int seed = 0; seed < study->params->seed_count; seed++) {
        const struct neph_study_cell *cell = neph_study_cell_at(study, scene, preset, seed, metric);
        sum += centre ? cell->centre : cell->value;
    }
    return sum / study->params->seed_count;
}

static const struct neph_study_cell *
first_that_does_not_count(const struct neph_flicker_study *study, int metric, int scene, int preset)
{
    for (int seed = 0; seed < study->params->seed_count; seed++) {
        const struct neph_study_cell *cell = neph_study_cell_at(study, scene, preset, seed, metric);
        if (!cell->counts)
            return cell;
    }
    return NULL;
}

static bool has_bound(const struct neph_flicker_study *study, int metric, int scene, int preset)
{
    bool found = false;
    for (int seed = 0; seed < study->params->seed_count; seed++)
        found |= neph_study_cell_at(study, scene, preset, seed, metric)->is_bound;
    return found;
}

static void print_cell(const struct neph_flicker_study *study, int metric, int scene, int preset,
                       FILE *out)
{
    const double scale = neph_study_metrics[metric].scale;
    const double value = shown(study, metric, scene, preset, false);
    const double centre = shown(study, metric, scene, preset, true);
    const char *mark = first_that_does_not_count(study, metric, scene, preset) ? "*"
                       : has_bound(study, metric, scene, preset)               ? "<"
                                                                               : "";
    if (isnan(value))
        fprintf(out, " - |");
    else if (isnan(centre))
        fprintf(out, " %s%.3g |", mark, scale * value);
    else
        fprintf(out, " %s%.3g (%.3g) |", mark, scale * value, scale * centre);
}

/* Why numbers of a metric do not count, once for each scene. */
static void print_reasons(const struct neph_flicker_study *study, int metric, FILE *out)
{
    for (int scene = 0; scene < study->params->scene_count; scene++)
        for (int preset = 0; preset < study->params->preset_count; preset++) {
            const struct neph_study_cell *cell = first_that_does_not_count(study, metric, scene,
                                                                           preset);
            if (!cell || study->scenes[scene].left_out)
                continue;
            fprintf(out, "\n%s, %s: %s.", study->scenes[scene].name, study->params->presets[preset],
                    cell->because);
            break;
        }
    fprintf(out, "\n");
}

static bool was_asked_for(const struct neph_flicker_study *study, int metric)
{
    return study->params->takes[neph_study_metrics[metric].take];
}

static void print_table(const struct neph_flicker_study *study, int metric, FILE *out)
{
    const struct neph_flicker_study_params *params = study->params;
    fprintf(out, "\n**%s**\n\n| scene |", neph_study_metrics[metric].title);
    for (int preset = 0; preset < params->preset_count; preset++)
        fprintf(out, " %s |", params->presets[preset]);
    fprintf(out, "\n| --- |");
    for (int preset = 0; preset < params->preset_count; preset++)
        fprintf(out, " ---: |");
    for (int scene = 0; scene < params->scene_count; scene++) {
        if (study->scenes[scene].left_out)
            continue;
        fprintf(out, "\n| %s |", study->scenes[scene].name);
        for (int preset = 0; preset < params->preset_count; preset++)
            print_cell(study, metric, scene, preset, out);
    }
    fprintf(out, "\n");
    print_reasons(study, metric, out);
}

/* ---- pairs ----------------------------------------------------------------------------------- */

/* At how many displays the pair's verdict is that of the first; of metrics of the eye. */
static enum neph_status count_agreeing(const struct neph_flicker_study *study, int metric,
                                       int first, int second, int verdict, int *count,
                                       struct neph_diag *diag)
{
    *count = 0;
    for (int display = 0; display < NEPH_STUDY_DISPLAYS; display++) {
        struct neph_study_pair pair;
        const enum neph_status status = neph_study_pair(study, metric, display, first, second,
                                                        &pair, diag);
        if (status)
            return status;
        *count += neph_study_pair_verdict(&pair) == verdict;
    }
    return NEPH_OK;
}

static enum neph_status print_pair(const struct neph_flicker_study *study, int metric, int first,
                                   int second, FILE *out, struct neph_diag *diag)
{
    static const char *const words[] = {"better", "undecided", "worse"};
    struct neph_study_pair pair;
    int agreeing = 0;
    enum neph_status status = neph_study_pair(study, metric, 0, first, second, &pair, diag);
    if (status)
        return status;
    const int verdict = neph_study_pair_verdict(&pair);
    fprintf(out, "| %s | %s |", study->params->presets[first], study->params->presets[second]);
    if (isnan(pair.mean))
        fprintf(out, " - | - |");
    else if (!pair.has_interval)
        fprintf(out, " %+.2f | - |", pair.mean);
    else
        fprintf(out, " %+.2f | [%+.2f, %+.2f] |", pair.mean, pair.low, pair.high);
    fprintf(out, " %d, %d, %d | %.2g | %s", pair.better, pair.worse, pair.alike, pair.p_sign,
            words[verdict + 1]);
    if (neph_study_metrics[metric].of_the_eye) {
        status = count_agreeing(study, metric, first, second, verdict, &agreeing, diag);
        if (agreeing == NEPH_STUDY_DISPLAYS)
            fprintf(out, ", at all %d displays", NEPH_STUDY_DISPLAYS);
        else
            fprintf(out, ", at %d of %d displays", agreeing, NEPH_STUDY_DISPLAYS);
    }
    fprintf(out, " |\n");
    return status;
}

static enum neph_status print_pairs(const struct neph_flicker_study *study, int metric, FILE *out,
                                    struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    fprintf(out,
            "\nFirst over second in decades, below 0 the first is better; 95 %% intervals over "
            "scenes.\n\n"
            "| first | second | decades | interval | better, worse, alike | p of signs | |\n"
            "| --- | --- | ---: | ---: | ---: | ---: | --- |\n");
    for (int first = 0; first < study->params->preset_count; first++)
        for (int second = first + 1; second < study->params->preset_count && !status; second++)
            status = print_pair(study, metric, first, second, out, diag);
    return status;
}

/* ---- the ranking ----------------------------------------------------------------------------- */

static enum neph_status print_ranking(const struct neph_flicker_study *study, FILE *out,
                                      struct neph_diag *diag)
{
    int first[NEPH_STUDY_PRESETS_MAX] = {0};
    int agreeing = 0;
    fprintf(out,
            "\n**Ranking by: %s**\n\nBest first, by the mean over scenes in which all presets "
            "have a number that counts.\n\n",
            neph_study_metrics[neph_study_headline()].title);
    for (int display = 0; display < NEPH_STUDY_DISPLAYS; display++) {
        int order[NEPH_STUDY_PRESETS_MAX] = {0};
        const enum neph_status status = neph_study_ranking(study, display, order, diag);
        if (status)
            return status;
        bool same = true;
        fprintf(out, "- %g Hz, %g pixels a degree:", neph_study_displays[display].frame_rate_hz,
                neph_study_displays[display].pixels_per_degree);
        for (int i = 0; i < study->params->preset_count; i++) {
            if (display == 0)
                first[i] = order[i];
            same = same && order[i] == first[i];
            fprintf(out, "%s %s", i ? "," : "", study->params->presets[order[i]]);
        }
        agreeing += same;
        fprintf(out, "%s\n", same ? "" : " (another order)");
    }
    if (agreeing == NEPH_STUDY_DISPLAYS)
        fprintf(out, "\nThe order holds at all %d displays.\n", NEPH_STUDY_DISPLAYS);
    else
        fprintf(out, "\nThe order holds at %d of %d displays: it is no ranking.\n", agreeing,
                NEPH_STUDY_DISPLAYS);
    return NEPH_OK;
}

/* ---- all of it ------------------------------------------------------------------------------- */

/* What was printed into memory, unless memory was short on the way. */
static enum neph_status close_text(FILE *out, enum neph_status status, char **text,
                                   struct neph_diag *diag)
{
    const bool cut = ferror(out) != 0, closed = fclose(out) == 0;
    if (!status && (cut || !closed))
        status = neph_fail_memory(diag);
    if (status) {
        free(*text);
        *text = NULL;
    }
    return status;
}

enum neph_status neph_flicker_study_text(const struct neph_flicker_study *study, char **text,
                                         struct neph_diag *diag)
{
    size_t size;
    *text = NULL;
    FILE *out = open_memstream(text, &size);
    if (!out)
        return neph_fail_memory(diag);
    print_head(study, out);
    print_scenes(study, out);
    fprintf(out,
            "\nIn brackets: the same number against centre rays. *: takes no part in pairs and "
            "ranking, for the reason below its table. <: cannot be told from the rest of what "
            "changes, all of which stands for it as a bound; in a pair what lies below the bound "
            "is alike.\n");
    enum neph_status status = NEPH_OK;
    for (int metric = 0; neph_study_metrics[metric].title && !status; metric++) {
        if (!was_asked_for(study, metric))
            continue;
        print_table(study, metric, out);
        if (study->params->preset_count > 1)
            status = print_pairs(study, metric, out, diag);
    }
    if (!status && study->params->preset_count > 1 && was_asked_for(study, neph_study_headline()))
        status = print_ranking(study, out, diag);
    return close_text(out, status, text, diag);
}

/* ---- CSV ------------------------------------------------------------------------------------- */

static void print_number(double value, FILE *out)
{
    if (isnan(value))
        fprintf(out, ",");
    else
        fprintf(out, ",%.9g", value);
}

/* In quotes, which are doubled inside. */
static void print_quoted(const char *text, FILE *out)
{
    fputs(",\"", out);
    for (; *text; text++)
        fprintf(out, *text == '"' ? "\"\"" : "%c", *text);
    fputc('"', out);
}

static void print_row(const struct neph_flicker_study *study, int scene, int preset, int seed,
                      int metric, FILE *out)
{
    const struct neph_study_cell *cell = neph_study_cell_at(study, scene, preset, seed, metric);
    fprintf(out, "%s", study->scenes[scene].name);
    print_quoted(study->params->presets[preset], out);
    fprintf(out, ",%d,%s,%s", seed + 1, neph_study_metrics[metric].metric,
            neph_study_metrics[metric].mask);
    print_number(cell->value, out);
    print_number(cell->centre, out);
    fprintf(out, ",%d,%d", cell->is_bound, cell->counts);
    print_quoted(cell->because, out);
    for (int display = 0; display < NEPH_STUDY_DISPLAYS; display++)
        print_number(cell->displays[display], out);
    fputs("\r\n", out);
}

enum neph_status neph_flicker_study_csv(const struct neph_flicker_study *study, char **text,
                                        struct neph_diag *diag)
{
    const struct neph_flicker_study_params *params = study->params;
    size_t size;
    *text = NULL;
    FILE *out = open_memstream(text, &size);
    if (!out)
        return neph_fail_memory(diag);
    fputs("scene,preset,seed,metric,mask,value,against_centre_rays,is_bound,counts,because", out);
    for (int d = 0; d < NEPH_STUDY_DISPLAYS; d++)
        fprintf(out, ",at_%g_hz_%g_ppd", neph_study_displays[d].frame_rate_hz,
                neph_study_displays[d].pixels_per_degree);
    fputs("\r\n", out);
    for (int scene = 0; scene < params->scene_count; scene++)
        for (int preset = 0; preset < params->preset_count; preset++)
            for (int seed = 0; seed < params->seed_count; seed++)
                for (int metric = 0; neph_study_metrics[metric].title; metric++)
                    if (!study->scenes[scene].left_out && was_asked_for(study, metric))
                        print_row(study, scene, preset, seed, metric, out);
    return close_text(out, NEPH_OK, text, diag);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *real_or_null(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *scenes_json(const struct neph_flicker_study *study)
{
    json_t *list = json_array();
    for (int i = 0; i < study->params->scene_count; i++) {
        const struct neph_study_scene *scene = &study->scenes[i];
        neph_json_add(&list, json_pack("{s:s, s:s, s:b, s:i, s:s?, s:s?, s:i, s:f, s:f}", "scene",
                                       scene->name, "title", scene->title, "moves", scene->moves,
                                       "frames", scene->frame_count, "left_out", scene->left_out,
                                       "reference", scene->reference, "reference_pictures",
                                       scene->picture_count, "reference_cpu_s", scene->reference_s,
                                       "takes_cpu_s", scene->takes_s));
    }
    return list;
}

static json_t *metrics_json(const struct neph_flicker_study *study)
{
    json_t *list = json_array();
    for (int m = 0; neph_study_metrics[m].title; m++) {
        const struct neph_study_metric *metric = &neph_study_metrics[m];
        if (was_asked_for(study, m))
            neph_json_add(&list,
                          json_pack("{s:s, s:s, s:s, s:s, s:b}", "title", metric->title, "take",
                                    neph_study_takes[metric->take].name, "metric", metric->metric,
                                    "mask", metric->mask, "of_the_eye", metric->of_the_eye));
    }
    return list;
}

static json_t *cell_json(const struct neph_flicker_study *study, int scene, int preset, int seed,
                         int metric)
{
    const struct neph_study_cell *cell = neph_study_cell_at(study, scene, preset, seed, metric);
    json_t *displays = json_array();
    for (int d = 0; d < NEPH_STUDY_DISPLAYS && neph_study_metrics[metric].of_the_eye; d++)
        neph_json_add(&displays, real_or_null(cell->displays[d]));
    return json_pack("{s:s, s:s, s:i, s:s, s:s, s:o, s:o, s:b, s:b, s:s, s:o}", "scene",
                     study->scenes[scene].name, "preset", study->params->presets[preset], "seed",
                     seed + 1, "metric", neph_study_metrics[metric].metric, "mask",
                     neph_study_metrics[metric].mask, "value", real_or_null(cell->value),
                     "against_centre_rays", real_or_null(cell->centre), "is_bound", cell->is_bound,
                     "counts", cell->counts, "because", cell->because, "at_displays", displays);
}

static json_t *results_json(const struct neph_flicker_study *study)
{
    const struct neph_flicker_study_params *params = study->params;
    json_t *list = json_array();
    for (int scene = 0; scene < params->scene_count; scene++)
        for (int preset = 0; preset < params->preset_count; preset++)
            for (int seed = 0; seed < params->seed_count; seed++)
                for (int metric = 0; neph_study_metrics[metric].title; metric++)
                    if (!study->scenes[scene].left_out && was_asked_for(study, metric))
                        neph_json_add(&list, cell_json(study, scene, preset, seed, metric));
    return list;
}

static json_t *pair_json(const struct neph_flicker_study *study, int metric, int display, int first,
                         int second)
{
    struct neph_study_pair pair;
    if (neph_study_pair(study, metric, display, first, second, &pair, NULL))
        return NULL;
    json_t *interval = pair.has_interval ? json_pack("[f,f]", pair.low, pair.high) : json_null();
    return json_pack("{s:s, s:s, s:f, s:f, s:s, s:s, s:i, s:o, s:o, s:i, s:i, s:i, s:f}", "metric",
                     neph_study_metrics[metric].metric, "mask", neph_study_metrics[metric].mask,
                     "rate_hz", neph_study_displays[display].frame_rate_hz, "pixels_per_degree",
                     neph_study_displays[display].pixels_per_degree, "first",
                     study->params->presets[first], "second", study->params->presets[second],
                     "scenes", pair.scene_count, "decades", real_or_null(pair.mean), "interval",
                     interval, "better", pair.better, "worse", pair.worse, "alike", pair.alike,
                     "p_sign", pair.p_sign);
}

static json_t *pairs_json(const struct neph_flicker_study *study)
{
    const int preset_count = study->params->preset_count;
    json_t *list = json_array();
    for (int metric = 0; neph_study_metrics[metric].title; metric++) {
        const int displays = neph_study_metrics[metric].of_the_eye ? NEPH_STUDY_DISPLAYS : 1;
        for (int display = 0; display < displays && was_asked_for(study, metric); display++)
            for (int first = 0; first < preset_count; first++)
                for (int second = first + 1; second < preset_count; second++)
                    neph_json_add(&list, pair_json(study, metric, display, first, second));
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

json_t *neph_flicker_study_json(const struct neph_flicker_study *study)
{
    const struct neph_flicker_study_params *params = study->params;
    return json_pack("{s:s, s:s, s:s, s:[i,i], s:i, s:i, s:i, s:i, s:o, s:o, s:o, s:o, s:o}",
                     "format", "neph-flicker-study-1", "version", NEPH_VERSION, "device",
                     study->device, "size_px", params->width_px, params->height_px, "steps",
                     params->steps, "frames", params->frame_count, "seeds", params->seed_count,
                     "broken", study->failed_count, "presets", presets_json(study), "scenes",
                     scenes_json(study), "metrics", metrics_json(study), "results",
                     results_json(study), "pairs", pairs_json(study));
}
