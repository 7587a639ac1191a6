/* SPDX-License-Identifier: MIT */
#include "harness/night/judge.h"

#include "base/sort.h"
#include "metrics/significance.h"
#include "metrics/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_JUDGED_COUNT == 5, "a new kind");
_Static_assert(NEPH_SERIES_KINDS == 3, "a new kind");

static const struct neph_series_rule rules[] = {
    [NEPH_SERIES_FIXED] = {"fixed", 0.005, 1, 1},
    [NEPH_SERIES_DRAWN] = {"drawn", 0.01, 8, 1},
    [NEPH_SERIES_TIMED] = {"timed", 0.03, 8, 3},
};

static const char *const judged_words[] = {
    [NEPH_JUDGED_NOT] = "not judged", [NEPH_JUDGED_SAME] = "same",   [NEPH_JUDGED_MOVED] = "moved",
    [NEPH_JUDGED_BETTER] = "better",  [NEPH_JUDGED_WORSE] = "worse",
};

/* Relative differences of a fixed series below this are no change: another compiler or processor
 * may cause them. */
static const double rounding = 1e-9;

/* A reference is suspected when at least half of its series moved, at least five series exist, and
 * the moved series belong to at least two families of engines. */
static const double stale_share = 0.5;
enum { STALE_FAMILIES = 2, STALE_SERIES = 5 };

static const double trimmed_share = 0.2; /* on either side */

const struct neph_series_rule *neph_series_rule(enum neph_series_kind kind)
{
    return &rules[kind];
}

enum neph_series_kind neph_find_series_kind(const char *word)
{
    int kind = 0;
    while (kind < NEPH_SERIES_KINDS && strcmp(rules[kind].word, word) != 0)
        kind++;
    return (enum neph_series_kind)kind;
}

const char *neph_judged_word(enum neph_judged judged)
{
    return judged_words[judged];
}

/* ---- estimates from the baseline ------------------------------------------------------------- */

/* Trimmed mean of the baseline, deviation of a single run, correlation of consecutive runs, degrees
 * of freedom. */
struct centre {
    int count;
    double mean, deviation, correlation, dof;
};

/* The standard deviation of a normal variable after winsorizing a share g on either side, with z
 * the (1 - g) quantile: sqrt(1 - 2 g - 2 z phi(z) + 2 g z^2). */
static double winsorized_deviation(double g)
{
    if (!(g > 0.0))
        return 1.0;
    const double z = neph_normal_critical(2.0 * g), density = exp(-0.5 * z * z) / sqrt(2.0 * M_PI);
    return sqrt(1.0 - 2.0 * g - 2.0 * z * density + 2.0 * g * z * z);
}

/* First-order autocorrelation of values clamped to low..high; 0 <= r <= 0.95. The estimate from a
 * short series is biased by -(1 + 4 r) / n (Kendall, Biometrika 41, 1954). This bias is removed,
 * and the standard error 1 / sqrt(n) is added: an underestimated correlation would raise false
 * alarms. */
static double compute_autocorrelation(const double *values, int count, double mean, double low,
                                      double high)
{
    double products = 0.0, squares = 0.0, last = 0.0;
    for (int i = 0; i < count; i++) {
        const double d = fmin(fmax(values[i], low), high) - mean;
        products += i > 0 ? d * last : 0.0;
        squares += d * d;
        last = d;
    }
    const double found = squares > 0.0 ? products / squares : 0.0;
    return fmin(fmax(found + (1.0 + 4.0 * found) / count + 1.0 / sqrt(count), 0.0), 0.95);
}

/* The number of independent values with the same information about the mean as `count` runs. */
static double count_independent_values(int count, double correlation)
{
    return fmax(count * (1.0 - correlation) / (1.0 + correlation), 1.0);
}

static struct centre compute_centre(const double *values, int count)
{
    double sorted[NEPH_JUDGE_WINDOW];
    struct centre centre = {.count = count};
    memcpy(sorted, values, (size_t)count * sizeof(*sorted));
    neph_sort_doubles(sorted, (size_t)count);
    const int cut = (int)(trimmed_share * count);
    const double low = sorted[cut], high = sorted[count - 1 - cut];
    double sum = 0.0, winsorized = 0.0, squares = 0.0;
    for (int i = 0; i < count; i++) {
        const double held = fmin(fmax(sorted[i], low), high);
        sum += i >= cut && i < count - cut ? sorted[i] : 0.0;
        winsorized += held / count;
    }
    for (int i = 0; i < count; i++) {
        const double d = fmin(fmax(sorted[i], low), high) - winsorized;
        squares += d * d;
    }
    centre.mean = sum / (count - 2 * cut);
    centre.correlation = compute_autocorrelation(values, count, winsorized, low, high);
    /* The expected variance within a short correlated series is the variance of a value minus the
     * variance of the mean. */
    const double worth = count_independent_values(count, centre.correlation);
    const double within = fmax(1.0 - 1.0 / worth, 0.1);
    centre.deviation = sqrt(squares / count / within) / winsorized_deviation((double)cut / count);
    const double r2 = centre.correlation * centre.correlation;
    centre.dof = fmax((count - 2 * cut) * (1.0 - r2) / (1.0 + r2) - 1.0, 1.0);
    return centre;
}

/* ---- a series' numbers ----------------------------------------------------------------------- */

/* Logarithm of a duration, or the value itself; NaN for a duration that is not positive. */
static double level(const struct neph_series *series, double value)
{
    return series->kind == NEPH_SERIES_TIMED ? log(value > 0.0 ? value : NAN) : value;
}

/* Append a finite value. In a drawn series a repetition of the same bits is skipped: the program
 * was unchanged, so it is no new sample and would make the spread too small. */
static void append(double *values, int *count, double value, enum neph_series_kind kind)
{
    const bool again = kind == NEPH_SERIES_DRAWN && *count > 0 && value == values[*count - 1];
    if (isfinite(value) && !again)
        values[(*count)++] = value;
}

/* The levels of the first baseline runs, at most NEPH_JUDGE_WINDOW; returns their number. */
static int baseline_values(const struct neph_series *series, double values[NEPH_JUDGE_WINDOW])
{
    int count = 0;
    for (int i = 0; i < series->past_count && count < NEPH_JUDGE_WINDOW; i++)
        if (!series->set_aside || !series->set_aside[i])
            append(values, &count, level(series, series->past[i]), series->kind);
    return count;
}

/* The levels of the last runs, this run first; returns their number. */
static int recent_values(const struct neph_series *series, double values[NEPH_JUDGE_WEEK])
{
    int count = 0;
    values[count++] = level(series, series->tonight);
    for (int i = series->past_count - 1; i > 0 && count < NEPH_JUDGE_WEEK; i--)
        append(values, &count, level(series, series->past[i]), series->kind);
    return count;
}

/* ---- tests ----------------------------------------------------------------------------------- */

/* One test of a series: the change of its level, and the standard error of that change. */
struct look {
    double difference, error, dof; /* dof infinite: normal */
};

static double compute_p_value(const struct look *look)
{
    if (!(look->error > 0.0))
        return fabs(look->difference) > 0.0 ? 0.0 : 1.0;
    const double t = look->difference / look->error;
    return isfinite(look->dof) ? neph_student_p(t, look->dof) : neph_normal_p(t);
}

/* Test of the last `nights` runs: their least deviation when all deviate to one side, otherwise
 * 0. */
static struct look test_nights(const struct centre *centre, const double *recent, int nights)
{
    double least = recent[0] - centre->mean;
    for (int i = 1; i < nights; i++) {
        const double difference = recent[i] - centre->mean;
        if (least * difference <= 0.0)
            least = 0.0;
        else if (fabs(difference) < fabs(least))
            least = difference;
    }
    const double worth = count_independent_values(centre->count, centre->correlation);
    return (struct look){least, centre->deviation * sqrt(1.0 + 1.0 / worth), centre->dof};
}

/* Test of the median of the last seven runs. The variance of a median is pi / 2 times the variance
 * of a mean. */
static struct look test_week(const struct centre *centre, const double *recent)
{
    double nights[NEPH_JUDGE_WEEK];
    memcpy(nights, recent, sizeof(nights));
    const double worth = count_independent_values(centre->count, centre->correlation),
                 week = count_independent_values(NEPH_JUDGE_WEEK, centre->correlation) / M_PI_2;
    return (struct look){neph_percentile(nights, NEPH_JUDGE_WEEK, 0.5) - centre->mean,
                         centre->deviation * sqrt(1.0 / fmax(week, 1.0) + 1.0 / worth),
                         centre->dof};
}

/* Test by standard errors only, against the baseline run. */
static struct look test_by_errors(const struct neph_series *series)
{
    const double error = hypot(series->standard_error, series->past_errors[0]);
    return (struct look){series->tonight - series->past[0], error, INFINITY};
}

/* ---- one series ------------------------------------------------------------------------------ */

/* The result for a series before Holm's correction. */
struct trial {
    bool judged, by_chance;
    double baseline; /* a level */
    double p;        /* smaller p of its tests, doubled when there are two */
    double difference;
    struct look soon; /* test of the latest runs, for the smallest detectable change */
    int nights;
};

static void choose(struct trial *trial, const struct look *look, double factor)
{
    const double p = fmin(factor * compute_p_value(look), 1.0);
    if (p > trial->p)
        return;
    trial->p = p;
    trial->difference = look->difference;
}

static struct trial try_fixed(const struct neph_series *series)
{
    const double before = series->past[0], change = fabs(series->tonight - before);
    const bool same = change <= rounding * fmax(fabs(before), series->unit);
    return (struct trial){.judged = true,
                          .baseline = before,
                          .p = same ? 1.0 : 0.0,
                          .difference = series->tonight - before,
                          .nights = 1};
}

/* Test by the spread of the runs only. */
static struct trial try_nights(const double *values, int count, const double *recent,
                               int recent_count, int needed)
{
    const struct centre centre = compute_centre(values, count);
    struct trial trial = {
        .judged = true, .by_chance = true, .baseline = centre.mean, .p = 1.0, .nights = count};
    if (recent_count >= needed) {
        trial.soon = test_nights(&centre, recent, needed);
        choose(&trial, &trial.soon, 2.0);
    }
    if (recent_count == NEPH_JUDGE_WEEK) {
        const struct look week = test_week(&centre, recent);
        choose(&trial, &week, 2.0);
    }
    return trial;
}

static bool has_errors(const struct neph_series *series)
{
    return isfinite(series->standard_error) && series->past_errors &&
           isfinite(series->past_errors[0]) &&
           series->standard_error + series->past_errors[0] > 0.0;
}

static struct trial try_series(const struct neph_series *series)
{
    double values[NEPH_JUDGE_WINDOW], recent[NEPH_JUDGE_WEEK];
    if (series->past_count < 1 || !isfinite(level(series, series->tonight)) ||
        !isfinite(level(series, series->past[0])))
        return (struct trial){.judged = false};
    /* A drawn number with the bits of the baseline run has no sampling noise between the two. */
    if (series->kind == NEPH_SERIES_FIXED ||
        (series->kind == NEPH_SERIES_DRAWN && series->tonight == series->past[0]))
        return try_fixed(series);
    const int count = baseline_values(series, values), of_late = recent_values(series, recent);
    struct trial by_errors = {.judged = false, .nights = count};
    if (series->kind == NEPH_SERIES_DRAWN && has_errors(series)) {
        const struct look look = test_by_errors(series);
        by_errors = (struct trial){
            true, true, series->past[0], compute_p_value(&look), look.difference, look, 1};
    }
    if (count < rules[series->kind].nights)
        return by_errors;
    const struct trial by_nights = try_nights(values, count, recent, of_late,
                                              rules[series->kind].needed);
    return by_errors.judged && by_errors.p > by_nights.p ? by_errors : by_nights;
}

/* ---- verdicts -------------------------------------------------------------------------------- */

/* A difference of levels as a relative change of the number. */
static double compute_relative_change(const struct neph_series *series, double baseline,
                                      double difference)
{
    if (series->kind == NEPH_SERIES_TIMED)
        return expm1(difference);
    return difference / fmax(fabs(baseline), series->unit);
}

static bool is_worse(const struct trial *trial, const struct neph_series *series)
{
    if (!series->is_signed)
        return trial->difference > 0.0;
    return fabs(trial->baseline + trial->difference) > fabs(trial->baseline);
}

/* The smallest difference that a test finds significant. */
static double compute_detectable_difference(const struct look *look, double level_alpha)
{
    return look->error * (isfinite(look->dof) ? neph_student_critical(level_alpha, look->dof)
                                              : neph_normal_critical(level_alpha));
}

static struct neph_judgement judge_trial(const struct trial *trial,
                                         const struct neph_series *series, double adjusted,
                                         double alpha, int chances)
{
    const double least = rules[series->kind].least;
    struct neph_judgement judgement = {NEPH_JUDGED_NOT, NAN, NAN, NAN, NAN, trial->nights};
    if (!trial->judged)
        return judgement;
    judgement.baseline = series->kind == NEPH_SERIES_TIMED ? exp(trial->baseline) : trial->baseline;
    judgement.change = compute_relative_change(series, trial->baseline, trial->difference);
    judgement.p = adjusted;
    judgement.floor = least;
    if (trial->by_chance && trial->soon.error > 0.0) {
        const double seen = compute_detectable_difference(&trial->soon,
                                                          alpha / fmax(chances, 1) / 2.0);
        judgement.floor = fmax(least, compute_relative_change(series, trial->baseline, seen));
    }
    if (!(adjusted <= alpha))
        judgement.judged = NEPH_JUDGED_SAME;
    else if (fabs(judgement.change) < least)
        judgement.judged = NEPH_JUDGED_MOVED;
    else
        judgement.judged = is_worse(trial, series) ? NEPH_JUDGED_WORSE : NEPH_JUDGED_BETTER;
    return judgement;
}

/* ---- an engine over all scenes --------------------------------------------------------------- */

bool neph_pool_has(const struct neph_pool *pool, const struct neph_series *series)
{
    return series->engine && !series->is_signed && series->kind == pool->kind &&
           strcmp(series->engine, pool->engine) == 0 && strcmp(series->metric, pool->metric) == 0;
}

static void add_pool(const struct neph_series *series, struct neph_pool *pools, int *count)
{
    int at = 0;
    if (!series->engine || series->is_signed || series->kind == NEPH_SERIES_FIXED)
        return;
    while (at < *count && !neph_pool_has(&pools[at], series))
        at++;
    if (at == *count)
        pools[(*count)++] = (struct neph_pool){
            .engine = series->engine, .metric = series->metric, .kind = series->kind};
}

/* Relative change of a member from its baseline in a run (-1: this run); NaN: no number. */
static double member_change(const struct neph_series *series, int night)
{
    const double value = level(series, night < 0 ? series->tonight : series->past[night]);
    const double before = level(series, series->past[0]);
    return series->kind == NEPH_SERIES_TIMED ? value - before
                                             : (value - before) / fmax(fabs(before), series->unit);
}

/* Mean change over the pool's scenes in a run. The scenes are the same in every run, because a
 * scene that comes and goes would move the mean. NaN when a scene has no number in that run. */
static double pool_change(const struct neph_series *series, int count, const struct neph_pool *pool,
                          const bool *is_in, int night)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        if (is_in[i] && neph_pool_has(pool, &series[i]))
            sum += member_change(&series[i], night);
    return pool->scenes >= 2 ? sum / pool->scenes : NAN;
}

/* Choose the scenes of a pool: those with a number in this run and in the baseline run, and with
 * the largest number of runs. Returns that number. */
static int choose_members(const struct neph_series *series, int count, struct neph_pool *pool,
                          bool *is_in)
{
    int nights = 0;
    for (int i = 0; i < count; i++)
        if (neph_pool_has(pool, &series[i]) && series[i].past_count > nights)
            nights = series[i].past_count;
    for (int i = 0; i < count; i++)
        if (neph_pool_has(pool, &series[i])) {
            is_in[i] = nights > 0 && series[i].past_count == nights &&
                       isfinite(member_change(&series[i], 0)) &&
                       isfinite(member_change(&series[i], -1));
            pool->scenes += is_in[i];
        }
    return nights;
}

/* Store the course of the pool for the page; NULL when memory is short. */
static void store_night_values(const struct neph_series *series, int count, struct neph_pool *pool,
                               const bool *is_in, int nights, struct neph_arena *arena)
{
    pool->nights = neph_arena_allocate(arena, (size_t)nights + 1, sizeof(*pool->nights));
    for (int night = 0; pool->nights && night <= nights; night++) {
        const double change = pool_change(series, count, pool, is_in, night < nights ? night : -1);
        pool->nights[night] = pool->kind == NEPH_SERIES_TIMED ? exp(change) : 1.0 + change;
    }
    pool->night_count = nights + 1;
}

/* Judge a pool by the spread of its changes, which are small numbers about 0 for all kinds. The
 * change of the baseline run is 0 by definition and is left out, as are runs in which a scene has
 * no number. */
static struct trial try_pool(const struct neph_series *series, int count, struct neph_pool *pool,
                             bool *is_in, struct neph_arena *arena)
{
    double values[NEPH_JUDGE_WINDOW], recent[NEPH_JUDGE_WEEK] = {0};
    int value_count = 0, recent_count = 0;
    const int nights = choose_members(series, count, pool, is_in);
    const double tonight = pool_change(series, count, pool, is_in, -1);
    store_night_values(series, count, pool, is_in, nights, arena);
    for (int night = 1; night < nights && value_count < NEPH_JUDGE_WINDOW; night++)
        append(values, &value_count, pool_change(series, count, pool, is_in, night), pool->kind);
    append(recent, &recent_count, tonight, pool->kind);
    for (int night = nights - 1; night > 0 && recent_count < NEPH_JUDGE_WEEK; night--)
        append(recent, &recent_count, pool_change(series, count, pool, is_in, night), pool->kind);
    if (value_count < rules[pool->kind].nights || !isfinite(tonight))
        return (struct trial){.judged = false, .nights = value_count};
    return try_nights(values, value_count, recent, recent_count, rules[pool->kind].needed);
}

/* ---- references that moved ------------------------------------------------------------------- */

static bool has_changed(const struct neph_judgement *judgement)
{
    return judgement->judged == NEPH_JUDGED_WORSE || judgement->judged == NEPH_JUDGED_BETTER;
}

static const char *series_family(const struct neph_series *series)
{
    return series->family ? series->family : series->engine;
}

static bool is_first_in_family(const struct neph_series *series,
                               const struct neph_judgement *judgements, int at)
{
    for (int i = 0; i < at; i++)
        if (series[i].truth && series[i].engine && has_changed(&judgements[i]) &&
            strcmp(series[i].truth, series[at].truth) == 0 &&
            strcmp(series_family(&series[i]), series_family(&series[at])) == 0)
            return false;
    return true;
}

static struct neph_stale count_truth(const struct neph_series *series, int count,
                                     const struct neph_judgement *judgements, const char *truth)
{
    struct neph_stale stale = {.truth = truth};
    for (int i = 0; i < count; i++) {
        if (!series[i].truth || !series[i].engine || strcmp(series[i].truth, truth) != 0 ||
            judgements[i].judged == NEPH_JUDGED_NOT)
            continue;
        stale.all++;
        stale.moved += has_changed(&judgements[i]);
        stale.families += has_changed(&judgements[i]) && is_first_in_family(series, judgements, i);
    }
    return stale;
}

static bool is_known(const struct neph_series *series, int at)
{
    for (int i = 0; i < at; i++)
        if (series[i].truth && strcmp(series[i].truth, series[at].truth) == 0)
            return true;
    return false;
}

static void suspect_truths(const struct neph_series *series, int count,
                           struct neph_verdicts *verdicts)
{
    for (int i = 0; i < count && verdicts->stale_count < NEPH_JUDGE_TRUTHS_MAX; i++) {
        if (!series[i].truth || is_known(series, i))
            continue;
        const struct neph_stale stale = count_truth(series, count, verdicts->series,
                                                    series[i].truth);
        if (stale.all >= STALE_SERIES && stale.families >= STALE_FAMILIES &&
            stale.moved >= stale_share * stale.all)
            verdicts->stale[verdicts->stale_count++] = stale;
    }
}

/* ---- all ------------------------------------------------------------------------------------- */

static void tally(const struct neph_judgement *judgement, struct neph_verdicts *verdicts)
{
    verdicts->compared += judgement->judged != NEPH_JUDGED_NOT;
    verdicts->worse += judgement->judged == NEPH_JUDGED_WORSE;
    verdicts->better += judgement->judged == NEPH_JUDGED_BETTER;
    verdicts->moved += judgement->judged == NEPH_JUDGED_MOVED;
}

struct work {
    struct trial *trials; /* of the series, followed by the pools */
    double *p, *adjusted; /* of the trials with noise */
    bool *is_in;          /* the series is part of its pool */
};

static void try_all(const struct neph_series *series, int count, struct neph_verdicts *verdicts,
                    struct work *work)
{
    for (int i = 0; i < count; i++)
        add_pool(&series[i], verdicts->pools, &verdicts->pool_count);
    for (int i = 0; i < count; i++)
        work->trials[i] = try_series(&series[i]);
    for (int i = 0; i < verdicts->pool_count; i++)
        work->trials[count + i] = try_pool(series, count, &verdicts->pools[i], work->is_in,
                                           &verdicts->arena);
    for (int i = 0; i < count + verdicts->pool_count; i++)
        if (work->trials[i].judged && work->trials[i].by_chance)
            work->p[verdicts->chances++] = work->trials[i].p;
}

static void judge_all(const struct neph_series *series, int count, double alpha,
                      struct neph_verdicts *verdicts, struct work *work)
{
    const int chances = verdicts->chances;
    int at = 0;
    if (chances > 0)
        neph_holm(work->p, chances, work->adjusted);
    for (int i = 0; i < count + verdicts->pool_count; i++) {
        const struct trial *trial = &work->trials[i];
        const double p = trial->judged && trial->by_chance ? work->adjusted[at++] : trial->p;
        struct neph_judgement *judgement = i < count ? &verdicts->series[i]
                                                     : &verdicts->pools[i - count].judgement;
        /* A pool is judged as a series: its levels are changes, its baseline is 1. */
        const struct neph_series pool = {
            .kind = i < count ? series[i].kind : verdicts->pools[i - count].kind, .unit = 1.0};
        *judgement = judge_trial(trial, i < count ? &series[i] : &pool, p, alpha, chances);
        tally(judgement, verdicts);
    }
    suspect_truths(series, count, verdicts);
}

enum neph_status neph_judge(const struct neph_series *series, int count, double alpha,
                            struct neph_verdicts *verdicts, struct neph_diag *diag)
{
    const size_t room = 2 * (size_t)count + 1; /* at most as many pools as series */
    *verdicts = (struct neph_verdicts){.series = NULL};
    struct neph_arena *arena = &verdicts->arena;
    struct work work = {neph_arena_allocate(arena, room, sizeof(*work.trials)),
                        neph_arena_allocate(arena, room, sizeof(*work.p)),
                        neph_arena_allocate(arena, room, sizeof(*work.adjusted)),
                        neph_arena_allocate(arena, room, sizeof(*work.is_in))};
    verdicts->series = neph_arena_allocate(arena, room, sizeof(*verdicts->series));
    verdicts->pools = neph_arena_allocate(arena, room, sizeof(*verdicts->pools));
    if (!arena->is_short) {
        try_all(series, count, verdicts, &work);
        judge_all(series, count, alpha, verdicts, &work);
    }
    const enum neph_status status = neph_arena_check(arena, diag);
    if (status)
        neph_verdicts_finish(verdicts);
    return status;
}

void neph_verdicts_finish(struct neph_verdicts *verdicts)
{
    neph_arena_finish(&verdicts->arena);
    *verdicts = (struct neph_verdicts){.series = NULL};
}
