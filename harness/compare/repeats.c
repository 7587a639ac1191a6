/* SPDX-License-Identifier: MIT */
#include "harness/compare/repeats.h"

#include "harness/compare/direction.h"
#include "metrics/run_limit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_RUN_LIMIT_SIDE_COUNT == 3, "a new kind");

void neph_repeats_finish(struct neph_repeats *repeats)
{
    neph_arena_finish(&repeats->arena);
    *repeats = (struct neph_repeats){.run_count = 0};
}

/* ---- the numbers of a run -------------------------------------------------------------------- */

static struct neph_repeat *find_repeat(const struct neph_repeats *repeats,
                                       const struct neph_measurement *number)
{
    for (int i = 0; i < repeats->count; i++) {
        struct neph_repeat *repeat = &repeats->list[i];
        if (repeat->metric == number->metric && repeat->quantity == number->quantity &&
            strcmp(repeat->limit.mask, number->mask) == 0)
            return repeat;
    }
    return NULL;
}

/* Metrics without a direction, such as a gain that should be 1, have no limit. */
static bool can_have_limit(const struct neph_measurement *number)
{
    return neph_metric_direction(number->metric) != NEPH_NO_DIRECTION;
}

static void add_repeat(struct neph_repeats *repeats, const struct neph_measurement *number)
{
    struct neph_arena *arena = &repeats->arena;
    struct neph_repeat *list = neph_arena_grow_list(arena, repeats->list, repeats->count,
                                                    &repeats->room, sizeof(*list));
    double *values = neph_arena_allocate(arena, (size_t)repeats->run_count, sizeof(*values));
    if (!list || !values)
        return;
    struct neph_repeat *repeat = &list[repeats->count];
    repeats->list = list;
    *repeat = (struct neph_repeat){
        number->metric, number->quantity, number->unit, {.value = 0.0}, values};
    snprintf(repeat->limit.quantity, sizeof(repeat->limit.quantity), "%s", number->quantity->name);
    snprintf(repeat->limit.metric, sizeof(repeat->limit.metric), "%s", number->metric->name);
    snprintf(repeat->limit.mask, sizeof(repeat->limit.mask), "%s", number->mask);
    repeat->limit.below = neph_metric_direction(number->metric) == NEPH_LARGER_IS_BETTER;
    repeats->count++;
}

/* The number that the limit is checked by: of the worst frame. NaN: one is not defined, or there is
 * none. */
static double worst_value(const struct neph_measurements *numbers, const struct neph_limit *limit)
{
    struct neph_limit extreme = *limit; /* a limit that all numbers meet */
    extreme.value = limit->below ? 0.0 : INFINITY;
    if (neph_limit_check(numbers, &extreme, NULL))
        return NAN;
    const struct neph_measurement *worst = neph_limit_worst(numbers, limit);
    return worst ? worst->value : NAN;
}

enum neph_status neph_repeats_add(struct neph_repeats *repeats,
                                  const struct neph_measurements *numbers, struct neph_diag *diag)
{
    for (int i = 0; i < numbers->count && repeats->done_count == 0; i++)
        if (can_have_limit(&numbers->list[i]) && !find_repeat(repeats, &numbers->list[i]))
            add_repeat(repeats, &numbers->list[i]);
    for (int i = 0; i < repeats->count; i++)
        repeats->list[i].values[repeats->done_count] = worst_value(numbers,
                                                                   &repeats->list[i].limit);
    repeats->done_count++;
    return neph_arena_check(&repeats->arena, diag);
}

/* ---- all runs -------------------------------------------------------------------------------- */

static int count_defined(const struct neph_repeats *repeats, const struct neph_repeat *repeat)
{
    int count = 0;
    for (int r = 0; r < repeats->done_count; r++)
        count += !isnan(repeat->values[r]);
    return count;
}

static bool is_equal(const struct neph_repeats *repeats, const struct neph_repeat *repeat)
{
    return neph_run_values_are_equal(repeat->values, repeats->done_count);
}

static bool is_deterministic(const struct neph_repeats *repeats,
                             const struct neph_quantity *quantity)
{
    for (int i = 0; i < repeats->count; i++) {
        const int defined = count_defined(repeats, &repeats->list[i]);
        if (repeats->list[i].quantity == quantity && defined > 0 &&
            !(defined == repeats->done_count && is_equal(repeats, &repeats->list[i])))
            return false;
    }
    return true;
}

static bool are_copies(const struct neph_repeats *repeats, int a, int b)
{
    for (int i = 0; i < repeats->count; i++) {
        const double *values = repeats->list[i].values;
        if (values[a] != values[b] && !(isnan(values[a]) && isnan(values[b])))
            return false;
    }
    return true;
}

bool neph_repeats_find_copies(const struct neph_repeats *repeats, int *first, int *second)
{
    int equal = 1;
    bool found = false;
    for (int b = 1; b < repeats->done_count; b++) {
        equal += are_copies(repeats, 0, b);
        for (int a = 0; a < b && !found; a++) {
            found = are_copies(repeats, a, b);
            *first = a;
            *second = b;
        }
    }
    return found && equal < repeats->done_count;
}

static enum neph_run_limit_side find_side(const struct neph_repeat *repeat)
{
    if (repeat->limit.below)
        return NEPH_RUN_LIMIT_BELOW;
    return repeat->metric->low < 0.0 ? NEPH_RUN_LIMIT_EITHER : NEPH_RUN_LIMIT_ABOVE;
}

/* The numbers that share the chance of an alarm. */
static int count_noisy(const struct neph_repeats *repeats)
{
    int count = 0;
    for (int i = 0; i < repeats->count; i++)
        count += count_defined(repeats, &repeats->list[i]) == repeats->done_count &&
                 !is_equal(repeats, &repeats->list[i]);
    return count;
}

static const char *limit_number(const struct neph_repeats *repeats,
                                const struct neph_repeat *repeat,
                                const struct neph_run_limit_family *family,
                                struct neph_measured_limit *made)
{
    const double *values = repeat->values;
    if (count_defined(repeats, repeat) < repeats->done_count)
        return "not defined in all runs";
    *made = (struct neph_measured_limit){repeat->limit, repeat->unit, values[0], values[0], false};
    for (int r = 1; r < repeats->done_count; r++) {
        made->lowest = fmin(made->lowest, values[r]);
        made->highest = fmax(made->highest, values[r]);
    }
    if (is_deterministic(repeats, repeat->quantity)) {
        made->is_equal = true;
        made->limit.value = fabs(values[0]);
        return NULL;
    }
    return neph_run_limit(family, values, repeats->done_count, find_side(repeat),
                          repeat->metric->high, &made->limit.value);
}

enum neph_status neph_repeats_limit(const struct neph_repeats *repeats, struct neph_limits *limits,
                                    struct neph_diag *diag)
{
    const size_t room = (size_t)repeats->count + 1;
    const int noisy = count_noisy(repeats);
    const struct neph_run_limit_family family = {limits->share, limits->confidence,
                                                 noisy > 0 ? noisy : 1};
    limits->list = neph_arena_allocate(&limits->arena, room, sizeof(*limits->list));
    limits->unlimited = neph_arena_allocate(&limits->arena, room, sizeof(*limits->unlimited));
    limits->run_count = repeats->done_count;
    for (int i = 0; i < repeats->count && !limits->arena.is_short; i++) {
        const struct neph_repeat *repeat = &repeats->list[i];
        const char *because = limit_number(repeats, repeat, &family, &limits->list[limits->count]);
        if (because)
            limits->unlimited[limits->unlimited_count++] = (struct neph_unlimited){repeat->limit,
                                                                                   because};
        else
            limits->count++;
    }
    return neph_arena_check(&limits->arena, diag);
}
