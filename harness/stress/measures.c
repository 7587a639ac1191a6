/* SPDX-License-Identifier: MIT
 *
 * The measures of the stress tests: which metrics each one reads, and its value.
 */
#include "harness/stress/measures.h"

#include "harness/study/flicker_metrics.h"
#include "harness/study/take.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Fails to compile when a measure is added, as the table needs a row for it. */
_Static_assert(NEPH_FAILING_MEASURES == 8, "a new kind");

static double use_value(const double numbers[NEPH_STRESS_NUMBERS])
{
    return numbers[0];
}

static double magnitude(const double numbers[NEPH_STRESS_NUMBERS])
{
    return fabs(numbers[0]);
}

/* The upper bound (the whole) where the part itself is not measurable. */
static double use_value_or_bound(const double numbers[NEPH_STRESS_NUMBERS])
{
    return isnan(numbers[0]) ? numbers[1] : numbers[0];
}

/* Infinite where too many pixels never settle: such pixels have no time and are not in the
 * percentile. */
static double use_time_or_infinity(const double numbers[NEPH_STRESS_NUMBERS])
{
    return numbers[1] > NEPH_STUDY_NEVER_MOST ? INFINITY : numbers[0];
}

/* 0 where the edges have no error, whatever the error elsewhere. */
static double ratio(const double numbers[NEPH_STRESS_NUMBERS])
{
    return numbers[0] == 0.0 ? 0.0 : numbers[0] / numbers[1];
}

static const struct neph_stress_measure measures[NEPH_FAILING_MEASURES] = {
    [NEPH_FAILING_ERROR] = {"error", {"rel_rmse"}, {NULL}, use_value},
    [NEPH_FAILING_FLICKER] = {"seen", {"seen_contrast"}, {NULL}, use_value, true},
    [NEPH_FAILING_PERIOD_4] =
        {"cycles", {"repeats_4", "cycle_std"}, {NULL}, use_value_or_bound, true},
    [NEPH_FAILING_LAG] =
        {"lag", {"frames_to_10_p95", "share_unsettled_10"}, {NULL}, use_time_or_infinity, true},
    [NEPH_FAILING_EDGE_RATIO] = {"error", {"rmse", "rmse"}, {"depth_edge", "non_edge"}, ratio},
    [NEPH_FAILING_NEVER_SEEN] = {"lag", {"share_never_settled"}, {NULL}, use_value, true},
    [NEPH_FAILING_ENERGY] = {"error", {"rel_bias"}, {NULL}, magnitude},
    [NEPH_FAILING_BAD_VALUES] = {NULL, {NULL}, {NULL}, use_value},
};

const struct neph_stress_measure *neph_stress_measure(enum neph_failing_measure measure)
{
    return &measures[measure];
}

static bool is_listed(const char *const *names, const char *name)
{
    while (*names && strcmp(*names, name) != 0)
        names++;
    return *names != NULL;
}

/* Whether a limit is measured. */
static bool is_measured_limit(const struct neph_failing_limit *limit, bool over_time)
{
    return over_time || !measures[limit->measure].over_time;
}

void neph_stress_extractors(const struct neph_failing *failing, bool over_time,
                            const char *names[NEPH_FAILING_MEASURES + 1])
{
    int count = 0;
    names[0] = NULL;
    for (int i = 0; i < failing->limit_count; i++) {
        const char *extractor = measures[failing->limits[i].measure].extractor;
        if (!extractor || is_listed(names, extractor) ||
            !is_measured_limit(&failing->limits[i], over_time))
            continue;
        names[count++] = extractor;
        names[count] = NULL;
    }
}

static const char *limit_mask(const struct neph_failing_limit *limit, int number)
{
    const char *own = measures[limit->measure].masks[number];
    return own ? own : limit->over;
}

void neph_stress_list_metrics(const struct neph_failing *failing, bool over_time,
                              struct neph_meter_number kept[NEPH_STRESS_METRICS_MAX])
{
    int count = 0;
    for (int i = 0; i < failing->limit_count; i++) {
        const struct neph_failing_limit *limit = &failing->limits[i];
        for (int n = 0; n < NEPH_STRESS_NUMBERS && is_measured_limit(limit, over_time); n++)
            if (measures[limit->measure].metrics[n])
                kept[count++] = (struct neph_meter_number){measures[limit->measure].metrics[n],
                                                           limit_mask(limit, n)};
    }
    kept[count] = (struct neph_meter_number){.metric = NULL};
}

double neph_stress_read(const struct neph_failing_limit *limit, const json_t *document,
                        char why[NEPH_STRESS_WHY_SIZE])
{
    const struct neph_stress_measure *measure = &measures[limit->measure];
    double numbers[NEPH_STRESS_NUMBERS] = {NAN, NAN};
    why[0] = '\0';
    for (int n = 0; n < NEPH_STRESS_NUMBERS && measure->metrics[n]; n++) {
        const json_t *found = neph_capture_find_value(document, measure->metrics[n],
                                                      limit_mask(limit, n));
        const json_t *value = json_object_get(found, "value");
        if (json_is_number(value))
            numbers[n] = json_number_value(value);
        else if (!why[0])
            snprintf(why, NEPH_STRESS_WHY_SIZE, "%s",
                     found ? neph_json_text(found, "undefined_because")
                           : "the mask is empty, or the whole frame");
    }
    const double value = measure->value(numbers);
    if (!isnan(value))
        why[0] = '\0';
    return value;
}
