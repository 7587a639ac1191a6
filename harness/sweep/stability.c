/* SPDX-License-Identifier: MIT
 *
 * Compares the Pareto fronts of several sweeps.
 */
#include "harness/sweep/stability.h"

#include <math.h>
#include <string.h>

/* Fails to compile when an outcome is added, as the table of words needs a row for it. */
_Static_assert(NEPH_STABILITY_OUTCOMES == 5, "a new kind");

const char *const neph_stability_words[NEPH_STABILITY_OUTCOMES] = {
    [NEPH_STABILITY_ABSENT] = "absent", [NEPH_STABILITY_OFF] = "off",
    [NEPH_STABILITY_ON] = "on all",     [NEPH_STABILITY_WITHIN] = "within intervals",
    [NEPH_STABILITY_MOVED] = "moved",
};

/* --- one point ------------------------------------------------------------------------------ */

static struct neph_sweep_value point_cost_value(const struct neph_sweep_point *point,
                                                enum neph_sweep_cost cost)
{
    if (cost == NEPH_SWEEP_COST_TIME)
        return (struct neph_sweep_value){point->time.median, point->time.low, point->time.high};
    return (struct neph_sweep_value){point->evaluations, NAN, NAN};
}

static double lower_bound_or_value(const struct neph_sweep_value *value)
{
    return isnan(value->low) ? value->value : value->low;
}

static double upper_bound_or_value(const struct neph_sweep_value *value)
{
    return isnan(value->high) ? value->value : value->high;
}

bool neph_stability_dominates(const struct neph_sweep_point *a, const struct neph_sweep_point *b,
                              enum neph_sweep_cost cost, enum neph_sweep_number number)
{
    const struct neph_sweep_value price_a = point_cost_value(a, cost),
                                  price_b = point_cost_value(b, cost);
    const double dearest = upper_bound_or_value(&price_a),
                 cheapest = lower_bound_or_value(&price_b);
    const double largest = upper_bound_or_value(&a->numbers[number]),
                 least = lower_bound_or_value(&b->numbers[number]);
    return dearest <= cheapest && largest <= least && (dearest < cheapest || largest < least);
}

static bool is_measured(const struct neph_sweep_point *point, enum neph_sweep_cost cost,
                        enum neph_sweep_number number)
{
    return !point->missing[0] && !isnan(neph_sweep_point_cost(point, cost)) &&
           !isnan(point->numbers[number].value);
}

static bool is_beaten(const struct neph_sweep *sweep, int point, enum neph_sweep_cost cost,
                      enum neph_sweep_number number)
{
    for (int i = 0; i < sweep->point_count; i++)
        if (is_measured(&sweep->points[i], cost, number) &&
            neph_stability_dominates(&sweep->points[i], &sweep->points[point], cost, number))
            return true;
    return false;
}

/* Smallest relative reduction of cost or value that puts the point on the front; of the value only
 * where the costs are equal. */
static double compute_front_distance(const struct neph_sweep *sweep,
                                     const struct neph_sweep_point *point,
                                     enum neph_sweep_cost cost, enum neph_sweep_number number)
{
    double factor = 1.0;
    for (int i = 0; i < sweep->point_count; i++) {
        const struct neph_sweep_point *other = &sweep->points[i];
        const double dearer = neph_sweep_point_cost(point, cost) /
                              neph_sweep_point_cost(other, cost);
        const double larger = point->numbers[number].value / other->numbers[number].value;
        if (is_measured(other, cost, number) && dearer >= 1.0)
            factor = fmax(factor, dearer > 1.0 ? fmin(dearer, larger) : larger);
    }
    return factor - 1.0;
}

double neph_stability_front_distance(const struct neph_sweep *sweeps, int count, int point,
                                     enum neph_sweep_cost cost, enum neph_sweep_number number)
{
    double most = 0.0;
    for (int i = 0; i < count; i++)
        if (is_measured(&sweeps[i].points[point], cost, number))
            most = fmax(most,
                        compute_front_distance(&sweeps[i], &sweeps[i].points[point], cost, number));
    return most;
}

static int count_fronts(const struct neph_sweep *sweeps, int count, int point,
                        enum neph_sweep_number number)
{
    int on = 0;
    for (int i = 0; i < count; i++)
        on += sweeps[i].points[point].on_front[number];
    return on;
}

enum neph_stability_outcome neph_stability_judge(const struct neph_sweep *sweeps, int count,
                                                 int point, enum neph_sweep_cost cost,
                                                 enum neph_sweep_number number)
{
    const int on = count_fronts(sweeps, count, point, number);
    for (int i = 0; i < count; i++)
        if (!is_measured(&sweeps[i].points[point], cost, number))
            return NEPH_STABILITY_ABSENT;
    if (on == 0 || on == count)
        return on ? NEPH_STABILITY_ON : NEPH_STABILITY_OFF;
    for (int i = 0; i < count; i++)
        if (!sweeps[i].points[point].on_front[number] && is_beaten(&sweeps[i], point, cost, number))
            return NEPH_STABILITY_MOVED;
    return NEPH_STABILITY_WITHIN;
}

/* --- all ------------------------------------------------------------------------------------ */

json_t *neph_stability_json(const struct neph_sweep *sweeps, int count, enum neph_sweep_cost cost)
{
    json_t *points = json_array();
    int moved = 0;
    for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++)
        for (int i = 0; i < sweeps[0].point_count; i++) {
            const enum neph_sweep_number number = (enum neph_sweep_number)n;
            const struct neph_sweep_point *point = &sweeps[0].points[i];
            const int on = count_fronts(sweeps, count, i, number);
            if (on == 0)
                continue;
            const enum neph_stability_outcome outcome = neph_stability_judge(sweeps, count, i, cost,
                                                                             number);
            moved += outcome == NEPH_STABILITY_MOVED;
            neph_json_add(
                &points, json_pack("{s:s, s:s, s:s, s:s, s:i, s:f}", "series", point->series->name,
                                   "label", point->label, "number", neph_sweep_number_texts[n].name,
                                   "outcome", neph_stability_words[outcome], "on_fronts", on, "off",
                                   neph_stability_front_distance(sweeps, count, i, cost, number)));
        }
    return json_pack("{s:s, s:s, s:i, s:s, s:i, s:o}", "format", "neph-stability-1", "scene",
                     sweeps[0].scene->name, "sweeps", count, "cost",
                     cost == NEPH_SWEEP_COST_TIME ? "seconds" : "evaluations", "moved", moved,
                     "points", points);
}

void neph_stability_print(const json_t *stability, FILE *out)
{
    const json_t *points = json_object_get(stability, "points"), *point;
    const int count = (int)json_integer_value(json_object_get(stability, "sweeps"));
    const bool is_timed = strcmp(neph_json_text(stability, "cost"), "seconds") == 0;
    int counts[NEPH_STABILITY_OUTCOMES] = {0};
    size_t index;
    fprintf(out, "%s: fronts of %d sweeps, each with a seed and a store of its own, by %s\n",
            neph_json_text(stability, "scene"), count, is_timed ? "time" : "evaluations");
    json_array_foreach(points, index, point)
    {
        const char *outcome = neph_json_text(point, "outcome");
        for (int i = 0; i < NEPH_STABILITY_OUTCOMES; i++)
            counts[i] += strcmp(outcome, neph_stability_words[i]) == 0;
        if (strcmp(outcome, neph_stability_words[NEPH_STABILITY_ON]) != 0)
            fprintf(out, "%-10s %-16s %-14s on %d of %d, else off by %.2g %%: %s\n",
                    neph_json_text(point, "number"), neph_json_text(point, "series"),
                    neph_json_text(point, "label"),
                    (int)json_integer_value(json_object_get(point, "on_fronts")), count,
                    100.0 * neph_json_real(point, "off"), outcome);
    }
    fprintf(out, "on a front in all: %d; within each other's intervals: %d; moved: %d",
            counts[NEPH_STABILITY_ON], counts[NEPH_STABILITY_WITHIN], counts[NEPH_STABILITY_MOVED]);
    if (counts[NEPH_STABILITY_ABSENT] > 0)
        fprintf(out, "; not measured in one of them: %d", counts[NEPH_STABILITY_ABSENT]);
    fprintf(out, "\n");
}
