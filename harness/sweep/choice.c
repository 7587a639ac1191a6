/* SPDX-License-Identifier: MIT
 *
 * Choosing a preset from a flicker study: levels, Pareto front, budget, output.
 */
#include "harness/sweep/choice.h"

#include "harness/engines/engines.h"
#include "harness/run/configuration.h"
#include "harness/sweep/front.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* Fails to compile when a measure is added, as the table of measures needs a row for it. */
_Static_assert(NEPH_CHOICE_NUMBERS == 6, "a new kind");

const struct neph_choice_measure neph_choice_measures[NEPH_CHOICE_NUMBERS] = {
    [NEPH_CHOICE_FLICKER] = {"flicker", "flicker seen, contrast over threshold", NEPH_STUDY_FLICKER,
                             "seen_contrast", "all", 0},
    [NEPH_CHOICE_HALF_LIFE] = {"half-life", "half-life after a step of the sun [frames]",
                               NEPH_STUDY_STEP, "half_life_p50", "all", 0},
    [NEPH_CHOICE_LAG] = {"lag", "lag behind a sun that swings in 64 frames [frames]",
                         NEPH_STUDY_SINE, "follow_lag_3_p50", "all", 0},
    [NEPH_CHOICE_ERROR] = {"error", "relative RMSE against its own model", NEPH_STUDY_FLICKER,
                           "rel_rmse", "all", 0},
    [NEPH_CHOICE_WORK] = {"evaluations", "density evaluations per pixel", NEPH_STUDY_FLICKER, NULL,
                          NULL, offsetof(struct neph_study_cost, density_evaluations)},
    [NEPH_CHOICE_TIME] = {"ms", "milliseconds on the device", NEPH_STUDY_FLICKER, NULL, NULL,
                          offsetof(struct neph_study_cost, gpu_ms)},
};
_Static_assert(NEPH_CHOICE_NUMBERS <= (int)NEPH_FRONT_AXES_MAX, "a front has so many axes");

int neph_choice_find(const char *name)
{
    for (int n = 0; n < NEPH_CHOICE_NUMBERS; n++)
        if (strcmp(neph_choice_measures[n].name, name) == 0)
            return n;
    return -1;
}

/* --- levels --------------------------------------------------------------------------------- */

static bool all_have_cost(const struct neph_flicker_study *study, size_t offset, int scene)
{
    for (int preset = 0; preset < study->params->preset_count; preset++)
        if (isnan(neph_study_cost_decades(study, offset, scene, preset)))
            return false;
    return true;
}

static void level_costs(const struct neph_flicker_study *study, int number,
                        struct neph_choice *choice)
{
    const size_t offset = neph_choice_measures[number].cost;
    double sums[NEPH_STUDY_PRESETS_MAX] = {0.0};
    int count = 0;
    for (int scene = 0; scene < study->params->scene_count; scene++) {
        if (!all_have_cost(study, offset, scene))
            continue;
        count++;
        for (int preset = 0; preset < choice->candidate_count; preset++)
            sums[preset] += neph_study_cost_decades(study, offset, scene, preset);
    }
    choice->scene_counts[number] = count;
    for (int preset = 0; preset < choice->candidate_count; preset++) {
        choice->candidates[preset].levels[number] = count > 0 ? pow(10.0, sums[preset] / count)
                                                              : NAN;
        choice->candidates[preset].floors[number] = NAN;
    }
}

static enum neph_status level_metric(const struct neph_flicker_study *study, int number,
                                     struct neph_choice *choice, struct neph_diag *diag)
{
    const struct neph_choice_measure *measure = &neph_choice_measures[number];
    struct neph_study_level levels[NEPH_STUDY_PRESETS_MAX], floors[NEPH_STUDY_PRESETS_MAX];
    const int metric = neph_study_metric_find(measure->metric, measure->mask);
    enum neph_status status = neph_study_levels(study, metric, 0, levels, diag);
    if (!status)
        status = neph_study_floor_levels(study, metric, 0, floors, diag);
    if (status)
        return status;
    choice->scene_counts[number] = levels[0].scene_count;
    for (int preset = 0; preset < choice->candidate_count; preset++) {
        choice->candidates[preset].levels[number] = pow(10.0, levels[preset].mean);
        choice->candidates[preset].floors[number] = pow(10.0, floors[preset].mean);
    }
    return NEPH_OK;
}

enum neph_status neph_choice_make(const struct neph_flicker_study *study,
                                  struct neph_choice *choice, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    choice->candidate_count = study->params->preset_count;
    for (int n = 0; n < NEPH_CHOICE_NUMBERS && !status; n++)
        if (neph_choice_measures[n].metric)
            status = level_metric(study, n, choice, diag);
        else
            level_costs(study, n, choice);
    if (!status)
        neph_choice_judge(choice);
    return status;
}

/* --- the front ------------------------------------------------------------------------------ */

/* Times are specific to a device: they are used only when the request names them. */
static bool is_weighed(const struct neph_choice *choice, int number)
{
    const bool is_asked = choice->least == NEPH_CHOICE_TIME ||
                          !isnan(choice->budget[NEPH_CHOICE_TIME]);
    return (number != NEPH_CHOICE_TIME || is_asked) && choice->scene_counts[number] > 0;
}

static void find_front(struct neph_choice *choice)
{
    struct neph_front_point points[NEPH_STUDY_PRESETS_MAX];
    int axes = 0;
    for (int n = 0; n < NEPH_CHOICE_NUMBERS; n++) {
        if (!is_weighed(choice, n))
            continue;
        for (int i = 0; i < choice->candidate_count; i++)
            points[i].values[axes] = choice->candidates[i].levels[n];
        axes++;
    }
    neph_front_find(points, choice->candidate_count, axes);
    for (int i = 0; i < choice->candidate_count; i++) {
        struct neph_choice_candidate *candidate = &choice->candidates[i];
        candidate->on_front = axes > 0 && points[i].on_front;
        candidate->beaten_by = -1;
        for (int k = 0; k < choice->candidate_count && candidate->beaten_by < 0; k++) {
            struct neph_front_point two[] = {points[i], points[k]};
            neph_front_find(two, 2, axes);
            if (points[k].on_front && !two[0].on_front)
                candidate->beaten_by = k;
        }
    }
}

/* --- the choice ----------------------------------------------------------------------------- */

/* Largest ratio of a level to its budget; 1: exactly within. */
static double excess(const struct neph_choice *choice, int index)
{
    double worst = 0.0;
    for (int n = 0; n < NEPH_CHOICE_NUMBERS; n++) {
        const double level = choice->candidates[index].levels[n], most = choice->budget[n];
        if (!isnan(most))
            worst = fmax(worst, isnan(level) ? INFINITY : level / most);
    }
    return worst;
}

/* Log of the product of all levels in use. */
static double compute_level_product(const struct neph_choice *choice, int index)
{
    double sum = 0.0;
    for (int n = 0; n < NEPH_CHOICE_NUMBERS; n++)
        if (is_weighed(choice, n))
            sum += log(choice->candidates[index].levels[n]);
    return sum;
}

/* Whether `a` is the better choice. */
static bool is_before(const struct neph_choice *choice, int a, int b)
{
    const double level_a = choice->candidates[a].levels[choice->least];
    const double level_b = choice->candidates[b].levels[choice->least];
    if (level_a > NEPH_CHOICE_ALIKE * level_b || level_b > NEPH_CHOICE_ALIKE * level_a)
        return level_a < level_b;
    return compute_level_product(choice, a) < compute_level_product(choice, b);
}

void neph_choice_judge(struct neph_choice *choice)
{
    choice->chosen = choice->nearest = -1;
    find_front(choice);
    for (int i = 0; i < choice->candidate_count; i++) {
        struct neph_choice_candidate *candidate = &choice->candidates[i];
        candidate->is_within = excess(choice, i) <= 1.0;
        if (choice->nearest < 0 || excess(choice, i) < excess(choice, choice->nearest))
            choice->nearest = i;
        if (candidate->on_front && candidate->is_within &&
            !isnan(candidate->levels[choice->least]) &&
            (choice->chosen < 0 || is_before(choice, i, choice->chosen)))
            choice->chosen = i;
    }
    if (choice->chosen >= 0)
        choice->nearest = choice->chosen;
}

/* --- output --------------------------------------------------------------------------------- */

static void print_row(const double numbers[NEPH_CHOICE_NUMBERS], FILE *out)
{
    for (int n = 0; n < NEPH_CHOICE_NUMBERS; n++)
        if (isnan(numbers[n]))
            fprintf(out, " %11s", "-");
        else
            fprintf(out, " %11.4g", numbers[n]);
}

static void print_candidates(const struct neph_choice *choice,
                             const struct neph_flicker_study *study, FILE *out)
{
    fprintf(out, "%-24s", "candidate");
    for (int n = 0; n < NEPH_CHOICE_NUMBERS; n++)
        fprintf(out, " %11s", neph_choice_measures[n].name);
    fprintf(out, "\n%-24s", "  scenes that count");
    for (int n = 0; n < NEPH_CHOICE_NUMBERS; n++)
        fprintf(out, " %11d", choice->scene_counts[n]);
    fprintf(out, "\n");
    for (int i = 0; i < choice->candidate_count; i++) {
        const struct neph_choice_candidate *candidate = &choice->candidates[i];
        const char *name = study->params->presets[i]; /* a long name gets a line of its own */
        fprintf(out, strlen(name) > 24 ? "%s\n%24s" : "%-24s%s", name, "");
        print_row(candidate->levels, out);
        fprintf(out, "%s%s%s%s\n", candidate->on_front ? "  front" : "",
                candidate->is_within ? "" : "  over the budget",
                candidate->beaten_by < 0 ? "" : "  beaten by ",
                candidate->beaten_by < 0 ? "" : study->params->presets[candidate->beaten_by]);
        fprintf(out, "%-24s", "  its floor");
        print_row(candidate->floors, out);
        fputc('\n', out);
    }
}

static void print_request(const struct neph_choice *choice, FILE *out)
{
    fprintf(out, "asked: the least %s", neph_choice_measures[choice->least].name);
    for (int n = 0; n < NEPH_CHOICE_NUMBERS; n++)
        if (!isnan(choice->budget[n]))
            fprintf(out, ", %s of %.4g at most", neph_choice_measures[n].name, choice->budget[n]);
    fprintf(out, "\n");
}

/* "-12 %", "x3.4"; extreme changes as a bound. */
static void format_change(double decades, char text[16])
{
    const double ratio = pow(10.0, decades);
    if (ratio > 100.0 || ratio < 0.01)
        snprintf(text, 16, ratio > 1.0 ? ">x100" : "<-99 %%");
    else if (ratio > 2.0)
        snprintf(text, 16, "x%.2g", ratio);
    else
        snprintf(text, 16, "%+.1f %%", 100.0 * (ratio - 1.0));
}

/* "flicker  -12 % [-20 %, -3 %]  7 better, 2 worse" */
static void print_pair(const char *name, const struct neph_study_pair *pair, FILE *out)
{
    char mean[16], low[16], high[16];
    if (isnan(pair->mean))
        return;
    format_change(pair->mean, mean);
    format_change(pair->low, low);
    format_change(pair->high, high);
    fprintf(out, "  %-10s %9s", name, mean);
    if (pair->has_interval)
        fprintf(out, " [%s, %s]", low, high);
    fprintf(out, "  %d better, %d worse\n", pair->better, pair->worse);
}

static enum neph_status print_pairs(const struct neph_choice *choice,
                                    const struct neph_flicker_study *study, FILE *out,
                                    struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < choice->candidate_count && !status; i++) {
        if (i == choice->nearest)
            continue;
        fprintf(out, "\nover %s, with 95 %% intervals over scenes:\n", study->params->presets[i]);
        for (int n = 0; n < NEPH_CHOICE_WORK && !status; n++) {
            const struct neph_choice_measure *of = &neph_choice_measures[n];
            struct neph_study_pair pair;
            status = neph_study_pair(study, neph_study_metric_find(of->metric, of->mask), 0,
                                     choice->nearest, i, &pair, diag);
            if (!status)
                print_pair(neph_choice_measures[n].name, &pair, out);
        }
    }
    return status;
}

enum neph_status neph_choice_print(const struct neph_choice *choice,
                                   const struct neph_flicker_study *study, FILE *out,
                                   struct neph_diag *diag)
{
    print_candidates(choice, study, out);
    fprintf(out, "\n");
    print_request(choice, out);
    if (choice->chosen >= 0)
        fprintf(out, "choice: %s\n", study->params->presets[choice->chosen]);
    else if (choice->scene_counts[choice->least] == 0)
        fprintf(out, "no choice: '%s' was not measured\n",
                neph_choice_measures[choice->least].name);
    else
        fprintf(out, "no preset is within the budget; the nearest is %s\n",
                study->params->presets[choice->nearest]);
    return print_pairs(choice, study, out, diag);
}

static json_t *candidate_json(const struct neph_choice *choice,
                              const struct neph_flicker_study *study, int index)
{
    const struct neph_choice_candidate *candidate = &choice->candidates[index];
    json_t *json = json_pack(
        "{s:s, s:b, s:b, s:s?}", "preset", study->params->presets[index], "on_front",
        candidate->on_front, "within", candidate->is_within, "beaten_by",
        candidate->beaten_by < 0 ? NULL : study->params->presets[candidate->beaten_by]);
    json_t *floor = json_object();
    for (int n = 0; n < NEPH_CHOICE_NUMBERS; n++) {
        neph_json_set(&json, neph_choice_measures[n].name, neph_json_number(candidate->levels[n]));
        if (neph_choice_measures[n].metric)
            neph_json_set(&floor, neph_choice_measures[n].name,
                          neph_json_number(candidate->floors[n]));
    }
    neph_json_set(&json, "floor", floor);
    return json;
}

json_t *neph_choice_json(const struct neph_choice *choice, const struct neph_flicker_study *study)
{
    const struct neph_flicker_study_params *params = study->params;
    struct neph_configuration configuration = {.rescatters = false};
    char steps[32];
    snprintf(steps, sizeof(steps), "steps=%d", params->steps);
    json_t *candidates = json_array(), *scenes = json_array(),
           *asked = json_pack("{s:s}", "least", neph_choice_measures[choice->least].name);
    for (int n = 0; n < NEPH_CHOICE_NUMBERS; n++)
        neph_json_set(&asked, neph_choice_measures[n].name, neph_json_number(choice->budget[n]));
    for (int i = 0; i < choice->candidate_count; i++)
        neph_json_add(&candidates, candidate_json(choice, study, i));
    for (int i = 0; i < params->scene_count; i++)
        neph_json_add(&scenes, json_string(study->scenes[i].name));
    json_t *json = neph_engine_parse_words(params->presets[choice->nearest], steps,
                                           &configuration.engine, &configuration.settings,
                                           NULL) == NEPH_OK
                       ? neph_configuration_json(&configuration)
                       : NULL;
    neph_json_set(&json, "preset", json_string(params->presets[choice->nearest]));
    neph_json_set(&json, "found", json_boolean(choice->chosen >= 0));
    neph_json_set(&json, "asked", asked);
    neph_json_set(&json, "device", json_string(study->device));
    neph_json_set(&json, "scenes", scenes);
    neph_json_set(&json, "candidates", candidates);
    return json;
}
