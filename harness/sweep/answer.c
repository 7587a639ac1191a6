/* SPDX-License-Identifier: MIT
 *
 * The summary lines of `neph sweep`.
 */
#include "harness/sweep/answer.h"

#include "base/threads.h"
#include "harness/sweep/finest.h"
#include "harness/sweep/output.h"
#include "harness/sweep/stability.h"

#include <math.h>
#include <string.h>

/* Further errors for which the cheapest series is printed. */
static const double levels[] = {0.01, 0.02, 0.05, 0.1, 0.2, 0.5};
enum {
    LEVELS = sizeof(levels) / sizeof(levels[0]),
    LEVEL_LINES = 2,
    SERIES_LINES = 3,
    TEXT_SIZE = 256,
};

/* ---- points ---------------------------------------------------------------------------------- */

enum neph_sweep_cost neph_sweep_cost_measured(const struct neph_sweep *sweep)
{
    for (int i = 0; i < sweep->point_count; i++)
        if (isfinite(sweep->points[i].time.median))
            return NEPH_SWEEP_COST_TIME;
    return NEPH_SWEEP_COST_WORK;
}

static double point_error(const struct neph_sweep_point *point)
{
    return point->numbers[NEPH_SWEEP_ERROR].value;
}

const struct neph_sweep_point *neph_sweep_cheapest(const struct neph_sweep *sweep, double error,
                                                   enum neph_sweep_cost cost,
                                                   const struct neph_sweep_series *except)
{
    const struct neph_sweep_point *best = NULL;
    for (int i = 0; i < sweep->point_count; i++) {
        const struct neph_sweep_point *point = &sweep->points[i];
        if (point->series == except || !(point_error(point) <= error) ||
            isnan(neph_sweep_point_cost(point, cost)))
            continue;
        if (!best || neph_sweep_point_cost(point, cost) < neph_sweep_point_cost(best, cost))
            best = point;
    }
    return best;
}

/* The cheapest point of a series within an error; where costs are not known, the first one. */
static const struct neph_sweep_point *
find_cheapest_in_series(const struct neph_sweep *sweep, double error, enum neph_sweep_cost cost,
                        const struct neph_sweep_series *series)
{
    const struct neph_sweep_point *best = NULL;
    for (int i = 0; i < sweep->point_count; i++) {
        const struct neph_sweep_point *point = &sweep->points[i];
        if (point->series == series && point_error(point) <= error &&
            (!best || neph_sweep_point_cost(point, cost) < neph_sweep_point_cost(best, cost)))
            best = point;
    }
    return best;
}

static const struct neph_sweep_point *least_error(const struct neph_sweep *sweep)
{
    const struct neph_sweep_point *best = NULL;
    for (int i = 0; i < sweep->point_count; i++)
        if (isfinite(point_error(&sweep->points[i])) &&
            (!best || point_error(&sweep->points[i]) < point_error(best)))
            best = &sweep->points[i];
    return best;
}

static int series_count(const struct neph_sweep *sweep)
{
    int count = 0;
    for (int i = 0; i < sweep->point_count; i++) {
        bool is_new = isfinite(point_error(&sweep->points[i]));
        for (int k = 0; k < i; k++)
            is_new &= sweep->points[k].series != sweep->points[i].series ||
                      isnan(point_error(&sweep->points[k]));
        count += is_new;
    }
    return count;
}

/* Whether both points were timed and their 10 % to 90 % ranges overlap. */
static bool has_overlapping_times(const struct neph_sweep_point *a,
                                  const struct neph_sweep_point *b)
{
    return a->time.low <= b->time.high && b->time.low <= a->time.high;
}

/* ---- words ----------------------------------------------------------------------------------- */

/* "8 steps" for "steps=8"; "as it is" for a series of one point. */
static const char *setting_words(const struct neph_sweep_point *point, char text[TEXT_SIZE])
{
    const int length = (int)strcspn(point->label, "=");
    if (!point->label[0])
        return "as it is";
    snprintf(text, TEXT_SIZE, "%s %.*s", point->label + length + 1, length, point->label);
    return text;
}

static const char *cost_words(const struct neph_sweep_point *point, enum neph_sweep_cost cost,
                              char text[TEXT_SIZE])
{
    if (cost == NEPH_SWEEP_COST_TIME)
        snprintf(text, TEXT_SIZE, "%.3g ms a frame", 1e3 * point->time.median);
    else
        snprintf(text, TEXT_SIZE, "%.3g density evaluations per pixel", point->evaluations);
    return text;
}

/* "0.83 % (0.8 to 0.86)" */
static const char *error_words(const struct neph_sweep_value *error, char text[TEXT_SIZE])
{
    char interval[NEPH_ANSWER_INTERVAL_SIZE];
    snprintf(text, TEXT_SIZE, "%.3g %%%s", 100.0 * error->value,
             neph_answer_interval(100.0 * error->low, 100.0 * error->high, interval));
    return text;
}

/* ---- the verdict ----------------------------------------------------------------------------- */

static void answer_found(const struct neph_sweep *sweep, double error, enum neph_sweep_cost cost,
                         const struct neph_sweep_point *found, struct neph_answer *answer)
{
    char setting[TEXT_SIZE], off[TEXT_SIZE], price[TEXT_SIZE], other[TEXT_SIZE] = "";
    const bool is_certain = !(found->numbers[NEPH_SWEEP_ERROR].high > error);
    const struct neph_sweep_point *next = neph_sweep_cheapest(sweep, error, cost, found->series);
    if (next && cost == NEPH_SWEEP_COST_TIME && has_overlapping_times(found, next))
        snprintf(other, sizeof(other), "; not told apart from %s in time", next->series->name);
    neph_answer_add(answer,
                    "%s: %s for %.3g %% of error: off by %s%s, %s, the cheapest of %d series%s",
                    found->series->name, setting_words(found, setting), 100.0 * error,
                    error_words(&found->numbers[NEPH_SWEEP_ERROR], off),
                    is_certain ? "" : ", not told apart from that error",
                    cost_words(found, cost, price), series_count(sweep), other);
}

/* A point of a series whose steps have converged although its lighting model is not within the
 * error. */
static const struct neph_sweep_point *find_converged_series(const struct neph_sweep *sweep,
                                                            double error)
{
    for (int s = 0; s < sweep->plan->series_count; s++) {
        const struct neph_sweep_point *found = neph_sweep_converged(sweep, &sweep->plan->series[s],
                                                                    error);
        if (found)
            return found;
    }
    return NULL;
}

static void answer_not_found(const struct neph_sweep *sweep, double error,
                             enum neph_sweep_cost cost, struct neph_answer *answer)
{
    char setting[TEXT_SIZE], off[TEXT_SIZE], price[TEXT_SIZE], of_model[TEXT_SIZE];
    const struct neph_sweep_point *best = least_error(sweep),
                                  *steps = find_converged_series(sweep, error);
    if (steps) {
        const struct neph_sweep_point *finest = neph_sweep_finest(sweep, steps->series);
        neph_answer_add(answer,
                        "%s: %s for %.3g %% of error against its own %s steps: %s%s, %s; its "
                        "lighting model is %s off the truth",
                        steps->series->name, setting_words(steps, setting), 100.0 * error,
                        finest->label + strlen("steps="), error_words(&steps->to_finest, off),
                        steps->to_finest.high > error ? ", not told apart from that error" : "",
                        cost_words(steps, cost, price),
                        error_words(&finest->numbers[NEPH_SWEEP_ERROR], of_model));
    }
    if (!best)
        neph_answer_add(answer, "no point could be measured");
    else
        neph_answer_add(answer,
                        "no series is within %.3g %% of the truth: the nearest is %s, %s: %s",
                        100.0 * error, best->series->name, setting_words(best, setting),
                        error_words(&best->numbers[NEPH_SWEEP_ERROR], off));
}

/* ---- below the verdict ----------------------------------------------------------------------- */

/* Adds a line for each other series that is within the error. */
static void answer_series(const struct neph_sweep *sweep, double error, enum neph_sweep_cost cost,
                          const struct neph_sweep_point *found, struct neph_answer *answer)
{
    int lines = 0;
    for (int s = 0; s < sweep->plan->series_count && lines < SERIES_LINES; s++) {
        char setting[TEXT_SIZE], off[TEXT_SIZE], price[TEXT_SIZE];
        const struct neph_sweep_series *series = &sweep->plan->series[s];
        const struct neph_sweep_point *other =
            series == found->series ? NULL : find_cheapest_in_series(sweep, error, cost, series);
        if (!other)
            continue;
        neph_answer_add(
            answer, "%s: %s: off by %s, %s", series->name, setting_words(other, setting),
            error_words(&other->numbers[NEPH_SWEEP_ERROR], off), cost_words(other, cost, price));
        lines++;
    }
}

/* Adds a line for each larger error at which another point is the cheapest. */
static void answer_levels(const struct neph_sweep *sweep, double error, enum neph_sweep_cost cost,
                          struct neph_answer *answer)
{
    const struct neph_sweep_point *before = neph_sweep_cheapest(sweep, error, cost, NULL);
    int lines = 0;
    for (int i = 0; i < LEVELS && lines < LEVEL_LINES; i++) {
        char setting[TEXT_SIZE], off[TEXT_SIZE], price[TEXT_SIZE];
        const struct neph_sweep_point *found = neph_sweep_cheapest(sweep, levels[i], cost, NULL);
        if (levels[i] <= error || !found || found == before)
            continue;
        neph_answer_add(answer, "for %.3g %%: %s, %s: off by %s, %s", 100.0 * levels[i],
                        found->series->name, setting_words(found, setting),
                        error_words(&found->numbers[NEPH_SWEEP_ERROR], off),
                        cost_words(found, cost, price));
        before = found;
        lines++;
    }
}

static void answer_missing(const struct neph_sweep *sweep, struct neph_answer *answer)
{
    const struct neph_sweep_point *first = NULL;
    int count = 0;
    for (int i = 0; i < sweep->point_count; i++) {
        count += sweep->points[i].missing[0] != '\0';
        if (!first && sweep->points[i].missing[0])
            first = &sweep->points[i];
    }
    if (first)
        neph_answer_add(answer, "not rendered: %d of %d points; %s: %.200s", count,
                        sweep->point_count, first->series->name, first->missing);
}

static void answer_truth(const struct neph_sweep *sweep, double error, struct neph_answer *answer)
{
    if (sweep->floor > 0.0)
        neph_answer_add(
            answer, "truth: %s with a noise of %.3g %%%s; %d x %d pixels, %s", sweep->truth,
            100.0 * sweep->floor,
            2.0 * sweep->floor > error ? ", too much for that error: a plan has truth_samples" : "",
            sweep->plan->width_px, sweep->plan->height_px, neph_sweep_device(sweep));
    else
        neph_answer_add(answer, "truth: %s, without noise; %d x %d pixels, %s", sweep->truth,
                        sweep->plan->width_px, sweep->plan->height_px, neph_sweep_device(sweep));
}

void neph_sweep_answer(const struct neph_sweep *sweep, double error, struct neph_answer *answer)
{
    const enum neph_sweep_cost cost = neph_sweep_cost_measured(sweep);
    const struct neph_sweep_point *found = neph_sweep_cheapest(sweep, error, cost, NULL);
    if (found)
        answer_found(sweep, error, cost, found, answer);
    else
        answer_not_found(sweep, error, cost, answer);
    if (found)
        answer_series(sweep, error, cost, found, answer);
    answer_levels(sweep, error, cost, answer);
    answer_truth(sweep, error, answer);
    answer_missing(sweep, answer);
    if (cost == NEPH_SWEEP_COST_TIME && sweep->load > 1.5 * neph_processor_count())
        neph_answer_add(answer, "times were measured on a busy machine (load %.1f)", sweep->load);
}

/* ---- several sweeps -------------------------------------------------------------------------- */

void neph_stability_answer(const json_t *stability, struct neph_answer *answer)
{
    const json_t *points = json_object_get(stability, "points"), *point;
    const int sweeps = (int)json_integer_value(json_object_get(stability, "sweeps"));
    const int moved = (int)json_integer_value(json_object_get(stability, "moved"));
    size_t index, always = 0;
    json_array_foreach(points, index, point)
        always += (int)json_integer_value(json_object_get(point, "on_fronts")) == sweeps;
    neph_answer_add(answer,
                    "the fronts %s: %d of %zu points left a front by more than their intervals, "
                    "%zu are on it in all %d sweeps",
                    moved > 0 ? "moved" : "are equal", moved, json_array_size(points), always,
                    sweeps);
    json_array_foreach(points, index, point)
    {
        if (strcmp(neph_json_text(point, "outcome"), neph_stability_words[NEPH_STABILITY_MOVED]))
            continue;
        neph_answer_add(answer, "%s: %s %s on %d of %d, else off by %.2g %%",
                        neph_json_text(point, "number"), neph_json_text(point, "series"),
                        neph_json_text(point, "label"),
                        (int)json_integer_value(json_object_get(point, "on_fronts")), sweeps,
                        100.0 * neph_json_real(point, "off"));
    }
}
