/* SPDX-License-Identifier: MIT
 *
 * Statistics of a flicker study: paired differences, levels with intervals, rankings.
 */
#include "harness/study/flicker_pairs.h"

#include "metrics/series.h"
#include "metrics/significance.h"

#include <math.h>
#include <stdlib.h>

/* Fails to compile when a kind is added, as the intervals are interpreted here. */
_Static_assert(NEPH_INTERVAL_KIND_COUNT == 5, "a new kind");

/* The metric's least value, or the highest upper bound that replaces a value of the preset. */
static double find_comparison_least(const struct neph_flicker_study *study, int metric, int scene,
                                    int preset)
{
    double least = neph_study_metrics[metric].least;
    for (int seed = 0; seed < study->params->seed_count; seed++) {
        const struct neph_study_cell *cell = neph_study_cell_at(study, scene, preset, seed, metric);
        if (cell->is_bound)
            least = fmax(least, cell->value);
    }
    return least;
}

/* log10 of a metric of a preset in a scene: mean over seeds of the value or the least value,
 * whichever is larger. NaN when a seed has no value that counts. */
static double decades_above(const struct neph_flicker_study *study, int metric, int display,
                            int scene, int preset, double least)
{
    double sum = 0.0;
    for (int seed = 0; seed < study->params->seed_count; seed++) {
        const struct neph_study_cell *cell = neph_study_cell_at(study, scene, preset, seed, metric);
        const double value = cell->displays[display];
        if (!cell->counts || isnan(value))
            return NAN;
        sum += log10(fmax(value, least));
    }
    return sum / study->params->seed_count;
}

static double decades(const struct neph_flicker_study *study, int metric, int display, int scene,
                      int preset)
{
    return decades_above(study, metric, display, scene, preset,
                         find_comparison_least(study, metric, scene, preset));
}

double neph_study_cost_decades(const struct neph_flicker_study *study, size_t cost, int scene,
                               int preset)
{
    double sum = 0.0;
    for (int seed = 0; seed < study->params->seed_count; seed++) {
        const struct neph_study_cost *costs = neph_study_cost_at(study, scene, preset, seed);
        const double value = *(const double *)((const char *)costs + cost);
        sum += value > 0.0 ? log10(value) : NAN; /* without evaluations there is no ratio */
    }
    return sum / study->params->seed_count;
}

/* ---- pairs ----------------------------------------------------------------------------------- */

double neph_study_difference(const struct neph_flicker_study *study, int metric, int display,
                             int first, int second, int scene)
{
    const double least = fmax(find_comparison_least(study, metric, scene, first),
                              find_comparison_least(study, metric, scene, second));
    return decades_above(study, metric, display, scene, first, least) -
           decades_above(study, metric, display, scene, second, least);
}

static void count_signs(const double *a, const double *b, int count, struct neph_study_pair *pair)
{
    for (int i = 0; i < count; i++) {
        pair->better += a[i] < b[i];
        pair->worse += a[i] > b[i];
        pair->alike += a[i] == b[i];
    }
    pair->p_sign = neph_sign_p(pair->worse, pair->better);
}

/* Fills a pair from the values of `pair->scene_count` scenes. */
static enum neph_status summarize(const double *a, const double *b, struct neph_study_pair *pair,
                                  struct neph_diag *diag)
{
    struct neph_paired paired = {.p = 1.0};
    enum neph_status status = NEPH_OK;
    if (pair->scene_count > 0)
        status = neph_series_paired(a, b, pair->scene_count, NEPH_REPLICATE_RUNS, &paired, diag);
    if (!status && paired.difference.defined) {
        pair->mean = paired.difference.value;
        pair->has_interval = paired.difference.interval != NEPH_INTERVAL_NONE;
        pair->low = paired.difference.low;
        pair->high = paired.difference.high;
    }
    count_signs(a, b, pair->scene_count, pair);
    return status;
}

enum neph_status neph_study_pair(const struct neph_flicker_study *study, int metric, int display,
                                 int first, int second, struct neph_study_pair *pair,
                                 struct neph_diag *diag)
{
    const int scene_count = study->params->scene_count;
    double *a = calloc(2 * (size_t)scene_count, sizeof(*a)), *b = a + scene_count;
    if (!a)
        return neph_fail_memory(diag);
    struct neph_study_pair found = {.mean = NAN, .p_sign = 1.0};
    for (int scene = 0; scene < scene_count; scene++) {
        const double least = fmax(find_comparison_least(study, metric, scene, first),
                                  find_comparison_least(study, metric, scene, second));
        a[found.scene_count] = decades_above(study, metric, display, scene, first, least);
        b[found.scene_count] = decades_above(study, metric, display, scene, second, least);
        found.scene_count += !isnan(a[found.scene_count]) && !isnan(b[found.scene_count]);
    }
    const enum neph_status status = summarize(a, b, &found, diag);
    free(a);
    if (!status)
        *pair = found;
    return status;
}

int neph_study_pair_verdict(const struct neph_study_pair *pair)
{
    if (!pair->has_interval)
        return 0;
    return pair->low > 0.0 ? 1 : pair->high < 0.0 ? -1 : 0;
}

/* ---- floors ---------------------------------------------------------------------------------- */

struct neph_study_scene_gap neph_study_scene_gap(const struct neph_flicker_study *study, int metric,
                                                 int display, int preset, int scene)
{
    struct neph_study_scene_gap gap = {NAN, NAN, -1};
    if (!study->params->floors)
        return gap;
    const int *candidates = study->params->floors[preset].candidates;
    double least = find_comparison_least(study, metric, scene, preset);
    for (int i = 0; i < NEPH_STUDY_FLOOR_CANDIDATES; i++)
        least = fmax(least, find_comparison_least(study, metric, scene, candidates[i]));
    const double value = decades_above(study, metric, display, scene, preset, least),
                 own = decades_above(study, metric, display, scene, candidates[0], least),
                 other = decades_above(study, metric, display, scene, candidates[1], least);
    if (isnan(value) || isnan(own) || isnan(other))
        return gap;
    return (struct neph_study_scene_gap){value, fmin(own, other), candidates[other < own]};
}

enum neph_status neph_study_gap(const struct neph_flicker_study *study, int metric, int display,
                                int preset, struct neph_study_gap *gap, struct neph_diag *diag)
{
    const int scene_count = study->params->scene_count;
    double *a = calloc(2 * (size_t)scene_count, sizeof(*a)), *b = a + scene_count;
    if (!a)
        return neph_fail_memory(diag);
    struct neph_study_gap found = {.pair = {.mean = NAN, .p_sign = 1.0}};
    int count = 0;
    for (int scene = 0; scene < scene_count; scene++) {
        const struct neph_study_scene_gap in_scene = neph_study_scene_gap(study, metric, display,
                                                                          preset, scene);
        if (in_scene.lower < 0)
            continue;
        a[count] = in_scene.preset;
        b[count++] = in_scene.floor;
        found.preset += in_scene.preset;
        found.floor += in_scene.floor;
    }
    found.pair.scene_count = count;
    found.preset = count ? found.preset / count : NAN;
    found.floor = count ? found.floor / count : NAN;
    const enum neph_status status = summarize(a, b, &found.pair, diag);
    free(a);
    if (!status)
        *gap = found;
    return status;
}

/* ---- levels ---------------------------------------------------------------------------------- */

/* Mean over the presets in a scene; NaN when a preset has none. */
static double scene_mean(const struct neph_flicker_study *study, int metric, int display, int scene)
{
    double sum = 0.0;
    for (int preset = 0; preset < study->params->preset_count; preset++)
        sum += decades(study, metric, display, scene, preset);
    return sum / study->params->preset_count;
}

/* A number of a preset in a scene, in decades. */
typedef double read_decades(const struct neph_flicker_study *study, int metric, int display,
                            int scene, int preset);

static double compute_floor_decades(const struct neph_flicker_study *study, int metric, int display,
                                    int scene, int preset)
{
    return neph_study_scene_gap(study, metric, display, preset, scene).floor;
}

/* The level of one number; `own` has room for all scenes. */
static struct neph_study_level make_level(const struct neph_flicker_study *study, int metric,
                                          int display, int preset, read_decades *read, double *own)
{
    int count = 0;
    double of_all = 0.0;
    for (int scene = 0; scene < study->params->scene_count; scene++) {
        const double mean = scene_mean(study, metric, display, scene),
                     value = read(study, metric, display, scene, preset);
        if (isnan(mean) || isnan(value))
            continue;
        own[count++] = value - mean;
        of_all += mean;
    }
    const struct neph_mean mean = neph_series_mean(own, count, NEPH_REPLICATE_RUNS);
    of_all = count > 0 ? of_all / count : NAN;
    return (struct neph_study_level){
        .scene_count = count,
        .mean = of_all + mean.value,
        .has_interval = mean.interval == NEPH_INTERVAL_RUNS,
        .low = of_all + mean.low,
        .high = of_all + mean.high,
    };
}

static enum neph_status make_levels(const struct neph_flicker_study *study, int metric, int display,
                                    read_decades *read, struct neph_study_level *levels,
                                    struct neph_diag *diag)
{
    double *own = calloc((size_t)study->params->scene_count, sizeof(*own));
    if (!own)
        return neph_fail_memory(diag);
    for (int preset = 0; preset < study->params->preset_count; preset++)
        levels[preset] = make_level(study, metric, display, preset, read, own);
    free(own);
    return NEPH_OK;
}

enum neph_status neph_study_levels(const struct neph_flicker_study *study, int metric, int display,
                                   struct neph_study_level *levels, struct neph_diag *diag)
{
    return make_levels(study, metric, display, decades, levels, diag);
}

enum neph_status neph_study_floor_levels(const struct neph_flicker_study *study, int metric,
                                         int display, struct neph_study_level *levels,
                                         struct neph_diag *diag)
{
    return make_levels(study, metric, display, compute_floor_decades, levels, diag);
}

enum neph_status neph_study_ranking(const struct neph_flicker_study *study, int display, int *order,
                                    struct neph_diag *diag)
{
    struct neph_study_level levels[NEPH_STUDY_PRESETS_MAX];
    const enum neph_status status = neph_study_levels(study, neph_study_find_headline(), display,
                                                      levels, diag);
    for (int preset = 0; preset < study->params->preset_count && !status; preset++) {
        int place = preset; /* insertion sort: equal presets keep their order */
        for (; place > 0 && levels[order[place - 1]].mean > levels[preset].mean; place--)
            order[place] = order[place - 1];
        order[place] = preset;
    }
    return status;
}
