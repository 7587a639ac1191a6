/* SPDX-License-Identifier: MIT */
#include "harness/sweep/stability.h"

#include <math.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_STABILITY_OUTCOMES == 5, "a new kind");

const char *const neph_stability_words[NEPH_STABILITY_OUTCOMES] = {
    [NEPH_STABILITY_ABSENT] = "absent", [NEPH_STABILITY_OFF] = "off",
    [NEPH_STABILITY_ON] = "on all",     [NEPH_STABILITY_WITHIN] = "within intervals",
    [NEPH_STABILITY_MOVED] = "moved",
};

/* --- one point ------------------------------------------------------------------------------ */

static struct neph_sweep_value price_of(const struct neph_sweep_point *point,
                                        enum neph_sweep_cost cost)
{
    if (cost == NEPH_SWEEP_COST_TIME)
        return (struct neph_sweep_value){point->time.median, point->time.low, point->time.high};
    return (struct neph_sweep_value){point->evaluations, NAN, NAN};
}

static double low_of(const struct neph_sweep_value *value)
{
    return isnan(value->low) ? value->value : value->low;
}

static double high_of(const struct neph_sweep_value *value)
{
    return isnan(value->high) ? value->value : value->high;
}

bool neph_stability_beats(const struct neph_sweep_point *a, const struct neph_sweep_point *b,
                          enum neph_sweep_cost cost, enum neph_sweep_number number)
{
    const struct neph_sweep_value price_a = price_of(a, cost), price_b = price_of(b, cost);
    const double dearest = high_of(&price_a), cheapest = low_of(&price_b);
    const double largest = high_of(&a->numbers[number]), least = low_of(&b->numbers[number]);
    return dearest <= cheapest && largest <= least && (dearest < cheapest || largest < least);
}

static bool is_measured(const struct neph_sweep_point *point, enum neph_sweep_cost cost,
                        enum neph_sweep_number number)
{
    return !point->missing[0] && !isnan(neph_sweep_cost_of(point, cost)) &&
           !isnan(point->numbers[number].value);
}

static bool is_beaten(const struct neph_sweep *sweep, int point, enum neph_sweep_cost cost,
                      enum neph_sweep_number number)
{
    for (int i = 0; i < sweep->point_count; i++)
        if (is_measured(&sweep->points[i], cost, number) &&
            neph_stability_beats(&sweep->points[i], &sweep->points[point], cost, number))
            return true;
    return false;
}

/* By the least part that it would have to be cheaper or better, so that nothing beats it; better,
 * where what beats it costs the same. */
static double off_in(const struct neph_sweep *sweep, const struct neph_sweep_point *point,
                     enum neph_sweep_cost cost, enum neph_sweep_number number)
{
    double factor = 1.0;
    for (int i = 0; i < sweep->point_count; i++) {
        const struct neph_sweep_point *other = &sweep->points[i];
        const double dearer = neph_sweep_cost_of(point, cost) / neph_sweep_cost_of(other, cost);
        const double larger = point->numbers[number].value / other->numbers[number].value;
        if (is_measured(other, cost, number) && dearer >= 1.0)
            factor = fmax(factor, dearer > 1.0 ? fmin(dearer, larger) : larger);
    }
    return factor - 1.0;
}

double neph_stability_off(const struct neph_sweep *sweeps, int count, int point,
                          enum neph_sweep_cost cost, enum neph_sweep_number number)
{
    double most = 0.0;
    for (int i = 0; i < count; i++)
        if (is_measured(&sweeps[i].points[point], cost, number))
            most = fmax(most, off_in(&sweeps[i], &sweeps[i].points[point], cost, number));
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

/* A point and a number by which it is on a front somewhere. */
struct verdict {
    const struct neph_sweep_point *point;
    enum neph_sweep_number number;
    enum neph_stability_outcome outcome;
    int on;
    double off; /* at most, as a part */
};
typedef void seen(const struct verdict *verdict, void *context);

static void walk(const struct neph_sweep *sweeps, int count, enum neph_sweep_cost cost, seen *see,
                 void *context)
{
    for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++)
        for (int i = 0; i < sweeps[0].point_count; i++) {
            const enum neph_sweep_number number = (enum neph_sweep_number)n;
            const int on = count_fronts(sweeps, count, i, number);
            if (on == 0)
                continue;
            const struct verdict verdict = {
                .point = &sweeps[0].points[i],
                .number = number,
                .outcome = neph_stability_judge(sweeps, count, i, cost, number),
                .on = on,
                .off = neph_stability_off(sweeps, count, i, cost, number)};
            see(&verdict, context);
        }
}

struct print {
    FILE *out;
    int count, counts[NEPH_STABILITY_OUTCOMES];
};

static void print_one(const struct verdict *verdict, void *context)
{
    struct print *print = context;
    print->counts[verdict->outcome]++;
    if (verdict->outcome != NEPH_STABILITY_ON)
        fprintf(print->out, "%-10s %-16s %-14s on %d of %d, else off by %.2g %%: %s\n",
                neph_sweep_number_texts[verdict->number].name, verdict->point->series->name,
                verdict->point->label, verdict->on, print->count, 100.0 * verdict->off,
                neph_stability_words[verdict->outcome]);
}

void neph_stability_print(const struct neph_sweep *sweeps, int count, enum neph_sweep_cost cost,
                          FILE *out)
{
    struct print print = {out, count, {0}};
    fprintf(out, "%s: fronts of %d sweeps, each with a seed and a store of its own, by %s\n",
            sweeps[0].scene->name, count, cost == NEPH_SWEEP_COST_TIME ? "time" : "evaluations");
    walk(sweeps, count, cost, print_one, &print);
    fprintf(out, "on a front in all: %d; within each other's intervals: %d; moved: %d",
            print.counts[NEPH_STABILITY_ON], print.counts[NEPH_STABILITY_WITHIN],
            print.counts[NEPH_STABILITY_MOVED]);
    if (print.counts[NEPH_STABILITY_ABSENT] > 0)
        fprintf(out, "; not measured in one of them: %d", print.counts[NEPH_STABILITY_ABSENT]);
    fprintf(out, "\n");
}

struct list {
    json_t *points;
    int moved;
};

static void list_one(const struct verdict *verdict, void *context)
{
    struct list *list = context;
    list->moved += verdict->outcome == NEPH_STABILITY_MOVED;
    neph_json_add(&list->points,
                  json_pack("{s:s, s:s, s:s, s:s, s:i, s:f}", "series",
                            verdict->point->series->name, "label", verdict->point->label, "number",
                            neph_sweep_number_texts[verdict->number].name, "outcome",
                            neph_stability_words[verdict->outcome], "on_fronts", verdict->on, "off",
                            verdict->off));
}

json_t *neph_stability_json(const struct neph_sweep *sweeps, int count, enum neph_sweep_cost cost)
{
    struct list list = {json_array(), 0};
    walk(sweeps, count, cost, list_one, &list);
    return json_pack("{s:s, s:s, s:i, s:s, s:i, s:o}", "format", "neph-stability-1", "scene",
                     sweeps[0].scene->name, "sweeps", count, "cost",
                     cost == NEPH_SWEEP_COST_TIME ? "seconds" : "evaluations", "moved", list.moved,
                     "points", list.points);
}
