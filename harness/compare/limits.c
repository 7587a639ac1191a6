/* SPDX-License-Identifier: MIT */
#include "harness/compare/limits.h"

#include "harness/compare/measure.h"
#include "metrics/extractors/extractors.h"
#include "metrics/pooling.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum neph_status neph_limit_parse(const char *text, bool below, struct neph_limit *limit,
                                  struct neph_diag *diag)
{
    char rest[64], *end;
    const char *colon = strchr(text, ':');
    *limit = (struct neph_limit){"radiance", "", "all", 0.0, below};
    bool fits = !colon || (size_t)(colon - text) < sizeof(limit->quantity);
    if (colon && fits)
        snprintf(limit->quantity, sizeof(limit->quantity), "%.*s", (int)(colon - text), text);
    const char *name = colon ? colon + 1 : text;
    _Static_assert(NEPH_IMAGE_NAME_MAX == 256, "the width of a mask in the format");
    fits &= sscanf(name, "%63[^@=]@%255[^=]=%63s", limit->metric, limit->mask, rest) == 3 ||
            sscanf(name, "%63[^@=]=%63s", limit->metric, rest) == 2;
    if (!fits)
        return neph_fail(diag, NEPH_ERR_USAGE, "limit '%s' is not [QUANTITY:]METRIC[@MASK]=LIMIT",
                         text);
    limit->value = strtod(rest, &end);
    if (*end || !isfinite(limit->value) || limit->value < 0.0)
        return neph_fail(diag, NEPH_ERR_USAGE, "limit '%s' is not a finite number >= 0", rest);
    if (!neph_quantity_find(limit->quantity))
        return neph_fail(diag, NEPH_ERR_USAGE, "limit '%s': there is no quantity '%s'", text,
                         limit->quantity);
    if (neph_metric_find(limit->metric, NULL))
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_USAGE, "limit '%s': there is no metric '%s'", text, limit->metric);
    neph_hint(diag, "`neph metrics` lists them");
    return NEPH_ERR_USAGE;
}

/* " in frame N", or "" for a number of all frames. */
static void name_frame(const struct neph_measurement *number, char *text, size_t size)
{
    text[0] = '\0';
    if (number->frame >= 0)
        snprintf(text, size, " in frame %d", number->frame);
}

/* Excess of a value over its limit; <= 0: within the limit. */
static double excess(const struct neph_measurement *number, const struct neph_limit *limit)
{
    const double size = fabs(number->value);
    return limit->below ? limit->value - size : size - limit->value;
}

/* Durations of the lag test are cut off at the end of the sequence. When more than `share` of the
 * pixels are still unsettled, the number is only a lower bound and cannot meet an upper limit. */
static const struct bounded_time {
    const char *metric, *unsettled;
    double share;
} bounded_times[] = {
    {"half_life_p50", "share_unsettled", 0.5},
    {"half_life_p95", "share_unsettled", 0.05},
    {"half_life_mean", "share_unsettled", 0.0},
    {"half_life_phase_0", "share_unsettled", 0.0},
    {"half_life_phase_1", "share_unsettled", 0.0},
    {"half_life_phase_2", "share_unsettled", 0.0},
    {"half_life_phase_3", "share_unsettled", 0.0},
    {"frames_to_10_p95", "share_unsettled_10", 0.05},
    {"frames_to_1_p95", "share_unsettled_1", 0.05},
};

static bool is_lower_bound(const struct neph_measurements *list, const struct neph_limit *limit)
{
    for (size_t b = 0; b < sizeof(bounded_times) / sizeof(bounded_times[0]); b++) {
        const struct bounded_time *time = &bounded_times[b];
        if (strcmp(time->metric, limit->metric) != 0)
            continue;
        const struct neph_measurement *share = neph_measurement_find(list, limit->quantity,
                                                                     time->unsettled, limit->mask);
        return share && share->value > time->share;
    }
    return false;
}

/* The result of checking all numbers of a metric. */
struct limit_result {
    const struct neph_measurement *worst; /* NULL: none measured, or none with an error */
    int beyond_count;
    bool without_error;
};

static enum neph_status check_all_numbers(const struct neph_measurements *list,
                                          const struct neph_limit *limit,
                                          struct limit_result *limit_result, struct neph_diag *diag)
{
    *limit_result = (struct limit_result){.worst = NULL};
    for (int i = 0; i < list->count; i++) {
        const struct neph_measurement *number = &list->list[i];
        char where[32];
        if (strcmp(number->quantity->name, limit->quantity) != 0 ||
            strcmp(number->metric->name, limit->metric) != 0 ||
            strcmp(number->mask, limit->mask) != 0)
            continue;
        name_frame(number, where, sizeof(where));
        /* The PSNR of equal images is undefined and meets every limit. */
        if (!number->defined && strcmp(number->undefined_because, neph_pool_no_error) == 0)
            limit_result->without_error = true;
        else if (!number->defined)
            return neph_fail(diag, NEPH_ERR_GATE, "%s of %s over '%s'%s is not defined: %s",
                             limit->metric, limit->quantity, limit->mask, where,
                             number->undefined_because);
        else if (!limit_result->worst || excess(number, limit) > excess(limit_result->worst, limit))
            limit_result->worst = number;
        limit_result->beyond_count += number->defined && excess(number, limit) > 0.0;
    }
    return NEPH_OK;
}

const struct neph_measurement *neph_limit_worst(const struct neph_measurements *list,
                                                const struct neph_limit *limit)
{
    struct limit_result limit_result;
    return check_all_numbers(list, limit, &limit_result, NULL) ? NULL : limit_result.worst;
}

enum neph_status neph_limit_check(const struct neph_measurements *list,
                                  const struct neph_limit *limit, struct neph_diag *diag)
{
    struct limit_result limit_result;
    char where[32];
    const enum neph_status status = check_all_numbers(list, limit, &limit_result, diag);
    if (status)
        return status;
    if (!limit_result.worst && !limit_result.without_error) {
        neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s of %s over '%s' was not measured of these images",
                  limit->metric, limit->quantity, limit->mask);
        neph_hint(diag, "the images lack this quantity, the reference this mask, or see 'not "
                        "taken' above");
        return NEPH_ERR_UNSUPPORTED;
    }
    if (limit_result.beyond_count == 0 && limit_result.worst && !limit->below &&
        is_lower_bound(list, limit))
        return neph_fail(diag, NEPH_ERR_GATE,
                         "%s of %s over '%s' is at least %.6g: the sequence ends too early to "
                         "check the limit %g",
                         limit->metric, limit->quantity, limit->mask, limit_result.worst->value,
                         limit->value);
    if (limit_result.beyond_count == 0)
        return NEPH_OK;
    name_frame(limit_result.worst, where, sizeof(where));
    neph_fail(diag, NEPH_ERR_GATE, "%s of %s over '%s' is %.6g%s, %s the limit %g", limit->metric,
              limit->quantity, limit->mask, limit_result.worst->value, where,
              limit->below ? "below" : "above", limit->value);
    if (limit_result.beyond_count > 1)
        neph_hint(diag, "the worst of %d such numbers", limit_result.beyond_count);
    return NEPH_ERR_GATE;
}

void neph_limit_add_case(const struct neph_measurements *list, const struct neph_limit *limit,
                         const char *group, const char *because, struct neph_junit *junit)
{
    struct neph_diag diag = {.line = 0};
    const enum neph_status status = list ? neph_limit_check(list, limit, &diag) : NEPH_ERR_GATE;
    const char *name = neph_arena_format(&junit->arena, "%s:%s@%s %s %g", limit->quantity,
                                         limit->metric, limit->mask,
                                         limit->below ? ">=" : "<=", limit->value);
    neph_junit_add(junit, group, name, status ? NEPH_JUNIT_FAILED : NEPH_JUNIT_PASSED,
                   !status ? ""
                   : list  ? diag.message
                           : because);
}
