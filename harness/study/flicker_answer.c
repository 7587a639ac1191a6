/* SPDX-License-Identifier: MIT
 *
 * The summary lines of a flicker study.
 */
#include "harness/study/flicker_answer.h"

#include "harness/study/flicker_pairs.h"

#include <math.h>

enum { RIVAL_LINES = 3, RIVAL_LINES_WITH_FLOORS = 2, METRIC_LINES = 3, TEXT_SIZE = 400 };

/* Presets sorted by a metric, best first; presets without a value last. */
struct ranking {
    int metric;
    struct neph_study_level levels[NEPH_STUDY_PRESETS_MAX];
    int order[NEPH_STUDY_PRESETS_MAX];
};

static bool is_before(const struct neph_study_level *a, const struct neph_study_level *b)
{
    return a->mean < b->mean || (isfinite(a->mean) && isnan(b->mean));
}

static enum neph_status rank_presets(const struct neph_flicker_study *study, int metric,
                                     struct ranking *ranking, struct neph_diag *diag)
{
    const enum neph_status status = neph_study_levels(study, metric, 0, ranking->levels, diag);
    ranking->metric = metric;
    for (int preset = 0; preset < study->params->preset_count && !status; preset++) {
        int place = preset; /* insertion sort: equal presets keep their order */
        for (; place > 0 &&
               is_before(&ranking->levels[preset], &ranking->levels[ranking->order[place - 1]]);
             place--)
            ranking->order[place] = ranking->order[place - 1];
        ranking->order[place] = preset;
    }
    return status;
}

/* The first metric, from `from` on, of the rendered sequences; -1: none. */
static int first_metric(const struct neph_flicker_study *study, int from)
{
    for (int metric = from; neph_study_metrics[metric].title; metric++)
        if (study->params->takes[neph_study_metrics[metric].take])
            return metric;
    return -1;
}

/* ": 0.81 times (0.7 to 0.95): better, p = 0.03, better in 7, worse in 2, alike in 0 scenes" */
static const char *pair_words(const struct neph_study_pair *pair, char text[TEXT_SIZE])
{
    char interval[NEPH_ANSWER_INTERVAL_SIZE] = "", p[32] = "";
    const double low = pair->has_interval ? pair->low : NAN,
                 high = pair->has_interval ? pair->high : NAN;
    if (pair->has_interval)
        neph_answer_interval(pow(10.0, low), pow(10.0, high), interval);
    if (isfinite(pair->p_sign))
        snprintf(p, sizeof(p), pair->p_sign < 0.001 ? ", p < 0.001" : ", p = %.2g", pair->p_sign);
    if (isnan(pair->mean))
        snprintf(text, TEXT_SIZE, ": no scene has both");
    else
        snprintf(text, TEXT_SIZE,
                 ": %.3g times%s: %s%s, better in %d, worse in %d, alike in %d scenes",
                 pow(10.0, pair->mean), interval, neph_answer_difference_word(low, high), p,
                 pair->better, pair->worse, pair->alike);
    return text;
}

/* ---- floors ---------------------------------------------------------------------------------- */

/* "0.34 times (0.15 to 0.77)" */
static const char *gap_words(const struct neph_study_gap *gap, char text[TEXT_SIZE])
{
    char interval[NEPH_ANSWER_INTERVAL_SIZE] = "";
    const struct neph_study_pair *pair = &gap->pair;
    if (pair->has_interval)
        neph_answer_interval(pow(10.0, pair->low), pow(10.0, pair->high), interval);
    snprintf(text, TEXT_SIZE, "%.3g times%s", pow(10.0, pair->mean), interval);
    return text;
}

/* " (floor 1.82)", or "" without one. */
static enum neph_status floor_words(const struct neph_flicker_study *study, int metric, int preset,
                                    char text[TEXT_SIZE], struct neph_diag *diag)
{
    struct neph_study_gap gap = {.floor = NAN};
    const enum neph_status status = neph_study_gap(study, metric, 0, preset, &gap, diag);
    text[0] = '\0';
    if (!isnan(gap.floor))
        snprintf(text, TEXT_SIZE, " (floor %.3g)",
                 neph_study_metrics[metric].scale * pow(10.0, gap.floor));
    return status;
}

/* "Flicker seen: ours 0.62, floor 1.82: 0.34 times (0.15 to 0.77)" */
static enum neph_status answer_headline_gap(const struct neph_flicker_study *study, int metric,
                                            int preset, struct neph_answer *answer,
                                            struct neph_diag *diag)
{
    char text[TEXT_SIZE];
    struct neph_study_gap gap = {.preset = NAN};
    const char *title = neph_study_metrics[metric].title, *name = study->params->presets[preset];
    const double scale = neph_study_metrics[metric].scale;
    const enum neph_status status = neph_study_gap(study, metric, 0, preset, &gap, diag);
    if (!status && gap.pair.scene_count == 0)
        neph_answer_add(answer, "%s: %s: no scene has a floor", title, name);
    else if (!status)
        neph_answer_add(answer, "%s: %s %.3g, floor %.3g: %s (every pixel marched, %d scene%s)",
                        title, name, scale * pow(10.0, gap.preset), scale * pow(10.0, gap.floor),
                        gap_words(&gap, text), gap.pair.scene_count,
                        gap.pair.scene_count == 1 ? "" : "s");
    return status;
}

/* "ours over its floor: error 1.52 times (0.78 to 2.96), half-life 2.4 times": the metrics with
 * names, without `headline`. */
static enum neph_status answer_named_gaps(const struct neph_flicker_study *study, int headline,
                                          int preset, struct neph_answer *answer,
                                          struct neph_diag *diag)
{
    const char *line = NULL;
    enum neph_status status = NEPH_OK;
    for (int metric = 0; neph_study_metrics[metric].title && !status; metric++) {
        char text[TEXT_SIZE];
        struct neph_study_gap gap = {.preset = NAN};
        if (!neph_study_metrics[metric].name || metric == headline ||
            !study->params->takes[neph_study_metrics[metric].take])
            continue;
        status = neph_study_gap(study, metric, 0, preset, &gap, diag);
        if (!status && gap.pair.scene_count > 0)
            line = neph_arena_format(&answer->arena, "%s%s %s %s", line ? line : "",
                                     line ? "," : "", neph_study_metrics[metric].name,
                                     gap_words(&gap, text));
    }
    if (!status && line)
        neph_answer_add(answer, "%s over its floor:%s", study->params->presets[preset], line);
    return status;
}

static enum neph_status answer_floor(const struct neph_flicker_study *study, int metric, int preset,
                                     struct neph_answer *answer, struct neph_diag *diag)
{
    if (!study->params->floors) {
        neph_answer_add(answer, "without floors (--no-floor)");
        return NEPH_OK;
    }
    const enum neph_status status = answer_headline_gap(study, metric, preset, answer, diag);
    return status ? status : answer_named_gaps(study, metric, preset, answer, diag);
}

/* ---- presets --------------------------------------------------------------------------------- */

/* The values are geometric means over the scenes in which all presets have one. */
static enum neph_status answer_pair(const struct neph_flicker_study *study, int metric, int best,
                                    int rival, const char *end, struct neph_answer *answer,
                                    struct neph_diag *diag)
{
    char text[TEXT_SIZE], floor_of_best[TEXT_SIZE], floor_of_rival[TEXT_SIZE];
    const double scale = neph_study_metrics[metric].scale;
    struct neph_study_level levels[NEPH_STUDY_PRESETS_MAX];
    struct neph_study_pair pair = {.mean = NAN};
    enum neph_status status = neph_study_levels(study, metric, 0, levels, diag);
    if (!status)
        status = neph_study_pair(study, metric, 0, best, rival, &pair, diag);
    if (!status)
        status = floor_words(study, metric, best, floor_of_best, diag);
    if (!status)
        status = floor_words(study, metric, rival, floor_of_rival, diag);
    if (!status)
        neph_answer_add(answer, "%s: %s %.3g%s, %s %.3g%s%s%s", neph_study_metrics[metric].title,
                        study->params->presets[best], scale * pow(10.0, levels[best].mean),
                        floor_of_best, study->params->presets[rival],
                        scale * pow(10.0, levels[rival].mean), floor_of_rival,
                        pair_words(&pair, text), end);
    return status;
}

static enum neph_status answer_single(const struct neph_flicker_study *study,
                                      const struct ranking *ranking, const char *end,
                                      struct neph_answer *answer, struct neph_diag *diag)
{
    char floor[TEXT_SIZE];
    const enum neph_status status = floor_words(study, ranking->metric, 0, floor, diag);
    if (status)
        return status;
    const struct neph_study_metric *metric = &neph_study_metrics[ranking->metric];
    const double level = ranking->levels[0].mean;
    if (isnan(level))
        neph_answer_add(answer, "%s: not measured: %s%s", study->params->presets[0], metric->title,
                        end);
    else
        neph_answer_add(answer, "%s: %.3g%s: %s%s", study->params->presets[0],
                        metric->scale * pow(10.0, level), floor, metric->title, end);
    return NEPH_OK;
}

static void answer_left_out(const struct neph_flicker_study *study, struct neph_answer *answer)
{
    for (int i = 0; i < study->params->scene_count; i++)
        if (study->scenes[i].left_out)
            neph_answer_add(answer, "left out: %s: %.200s", study->scenes[i].name,
                            study->scenes[i].left_out);
    if (study->failed_count > 0)
        neph_answer_add(answer, "%d sequences failed; --all prints the reasons",
                        study->failed_count);
}

static enum neph_status answer_presets(const struct neph_flicker_study *study,
                                       const struct ranking *ranking, const char *end,
                                       struct neph_answer *answer, struct neph_diag *diag)
{
    const int *order = ranking->order, count = study->params->preset_count;
    const int rival_lines = study->params->floors ? RIVAL_LINES_WITH_FLOORS : RIVAL_LINES;
    enum neph_status status = answer_pair(study, ranking->metric, order[0], order[1], end, answer,
                                          diag);
    if (!status)
        status = answer_floor(study, ranking->metric, order[0], answer, diag);
    for (int i = 2; i < count && i < 2 + rival_lines && !status; i++)
        status = answer_pair(study, ranking->metric, order[0], order[i], "", answer, diag);
    int lines = 0;
    for (int metric = first_metric(study, ranking->metric + 1);
         metric >= 0 && lines < METRIC_LINES && !status; metric = first_metric(study, metric + 1)) {
        const bool is_first = neph_study_metrics[metric].take !=
                              neph_study_metrics[metric - 1].take;
        if (!is_first) /* only the first metric of each sequence */
            continue;
        status = answer_pair(study, metric, order[0], order[1], "", answer, diag);
        lines++;
    }
    return status;
}

enum neph_status neph_flicker_answer(const struct neph_flicker_study *study,
                                     struct neph_answer *answer, struct neph_diag *diag)
{
    const struct neph_flicker_study_params *params = study->params;
    struct ranking ranking;
    char end[96];
    int scene_count = 0;
    for (int i = 0; i < params->scene_count; i++)
        scene_count += !study->scenes[i].left_out;
    snprintf(end, sizeof(end), " (%d scene%s, %d seed%s)", scene_count, scene_count == 1 ? "" : "s",
             params->seed_count, params->seed_count == 1 ? "" : "s");
    const int metric = first_metric(study, 0);
    enum neph_status status = metric < 0 ? NEPH_OK : rank_presets(study, metric, &ranking, diag);
    if (!status && metric >= 0 && params->preset_count == 1) {
        status = answer_single(study, &ranking, end, answer, diag);
        if (!status)
            status = answer_floor(study, metric, 0, answer, diag);
    } else if (!status && metric >= 0)
        status = answer_presets(study, &ranking, end, answer, diag);
    if (!status)
        answer_left_out(study, answer);
    return status;
}
