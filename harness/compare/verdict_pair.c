/* SPDX-License-Identifier: MIT */
#include "harness/compare/verdict_pair.h"

#include "harness/compare/direction.h"
#include "harness/compare/headlines.h"

#include <math.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_INTERVAL_KIND_COUNT == 5, "a new kind");
_Static_assert(NEPH_DIRECTION_COUNT == 3, "a new kind");

/* Error probability of both tests of a difference, as of its 95 % interval. */
static const double level = 0.05;

/* Six whole cycles: with five the smallest p-value of the sign test is 2 / 2^5 = 0.0625, above the
 * level. */
enum { FRAMES_MIN = 6 * NEPH_MOVEMENT_CYCLE };

const char *const neph_not_told_apart = "not told apart";
static const char too_few[] = "p-values of flicker need 24 frames after the warm-up";
static const char opposite[] = "over time the frames as a whole say the opposite";

/* ---- over time ------------------------------------------------------------------------------- */

/* Prefixes of flicker metrics, and the series over time that corresponds to each. */
static const struct {
    const char *begin;
    bool is_cyclic;
} timed[] = {
    {"seen_", false},       {"pop_", false},      {"coherent_contrast", false},
    {"worst_tile_", false}, {"std_", false},      {"mad_", false},
    {"p2p_", false},        {"restless_", false}, {"a4_", true},
    {"a2_", true},          {"block_a", true},    {"cyclic_", true},
    {"cycle_", true},       {"repeats_", true},
};

/* The series over time for a number. NULL: it is not a flicker metric, or there is no series. The
 * series covers radiance over all pixels; its p-value also applies to masks, its counts do not. */
static const struct neph_time_difference *find_time(const struct neph_differences *versus,
                                                    const struct neph_measurement *number)
{
    if (strcmp(number->quantity->name, "radiance") != 0 || number->frame >= 0)
        return NULL;
    for (size_t i = 0; i < sizeof(timed) / sizeof(timed[0]); i++)
        if (strncmp(timed[i].begin, number->metric->name, strlen(timed[i].begin)) == 0) {
            const struct neph_time_difference *time = timed[i].is_cyclic ? &versus->cycles
                                                                         : &versus->frames;
            return time->count > 0 ? time : NULL;
        }
    return NULL;
}

/* ---- verdicts -------------------------------------------------------------------------------- */

/* A number that can have either sign is better closer to 0. */
static const char *find_word(const struct neph_difference *difference)
{
    const enum neph_direction direction = neph_metric_direction(difference->number->metric);
    const bool is_smaller = fabs(difference->first) < fabs(difference->second);
    if (direction == NEPH_NO_DIRECTION)
        return difference->value > 0.0 ? "higher" : "lower";
    return is_smaller == (direction == NEPH_SMALLER_IS_BETTER) ? "better" : "worse";
}

static void take_series(const struct neph_difference *difference,
                        const struct neph_time_difference *time, bool is_cyclic,
                        struct neph_judged_difference *judged)
{
    judged->what = is_cyclic ? "cycles" : "frames";
    judged->count = time ? time->count : difference->frame_count;
    judged->below = time ? time->below : difference->frames_below;
    judged->above = time ? time->above : difference->frames_above;
}

struct neph_judged_difference neph_judge_difference(const struct neph_differences *versus,
                                                    const struct neph_difference *difference)
{
    const struct neph_time_difference *time = find_time(versus, difference->number);
    const int frame_count = versus->frames.count;
    struct neph_judged_difference judged = {.word = neph_not_told_apart, .p = difference->p};
    if (!time || strcmp(difference->number->mask, "all") == 0)
        take_series(difference, time, time == &versus->cycles, &judged);
    if (difference->value == 0.0) {
        judged.word = "equal";
        judged.p = NAN;
        return judged;
    }
    if (difference->interval == NEPH_INTERVAL_NONE) {
        judged.because = difference->because;
        return judged;
    }
    if (difference->low <= 0.0 && difference->high >= 0.0)
        return judged;
    const bool agrees = time && time->value * difference->value > 0.0;
    judged.p = time ? fmax(judged.p, time->p) : judged.p;
    if (!time || (agrees && time->p < level))
        judged.word = find_word(difference);
    else
        judged.because = frame_count < FRAMES_MIN ? too_few : agrees ? NULL : opposite;
    return judged;
}

/* ---- text ------------------------------------------------------------------------------------ */

static void write_p(const struct neph_judged_difference *judged, FILE *out)
{
    if (!isnan(judged->p))
        fprintf(out, judged->p < 0.001 ? ", p < 0.001" : ", p = %.2g", judged->p);
}

/* "in 63 of 64 frames" counts the frames that agree with the verdict. For a metric with both signs,
 * or without a verdict, the text is "lower in 63 of 64 frames". */
static void write_count(const struct neph_difference *difference,
                        const struct neph_judged_difference *judged, FILE *out)
{
    const bool is_judged = strcmp(judged->word, neph_not_told_apart) != 0;
    const bool is_positive = difference->first >= 0.0 && difference->second >= 0.0;
    if (judged->count == 0 || strcmp(judged->word, "equal") == 0)
        return;
    if (is_judged && is_positive)
        fprintf(out, ", in %d of %d %s", difference->value < 0.0 ? judged->below : judged->above,
                judged->count, judged->what);
    else
        fprintf(out, ", lower in %d of %d %s", judged->below, judged->count, judged->what);
}

static const struct neph_measurement *find_place(const struct neph_measurements *list,
                                                 const char *metric)
{
    const struct neph_measurement *found = neph_measurement_find(list, "radiance", metric, "all");
    return found && found->defined ? found : NULL;
}

static void write_worst(const struct neph_compared *compared,
                        const struct neph_difference *difference, const char *mask, FILE *out)
{
    const struct neph_measurement *x = find_place(&compared->numbers, "worst_tile_x");
    const struct neph_measurement *y = find_place(&compared->numbers, "worst_tile_y");
    const struct neph_measurement *period = find_place(&compared->numbers, "worst_tile_period");
    if (strncmp(difference->number->metric->name, "seen_", 5) != 0 || strcmp(mask, "all") != 0)
        return;
    if (x && y && period)
        fprintf(out, "; worst at (%.0f, %.0f), period %.2g frames", x->value, y->value,
                period->value);
}

static void write_values(const struct neph_difference *difference, const char *words,
                         const char *test, const char *other, FILE *out)
{
    const struct neph_measurement *number = difference->number;
    char first[32], second[32], unit[64];
    neph_headline_value(difference->first, first);
    neph_headline_value(difference->second, second);
    neph_headline_unit(number, unit);
    if (words)
        fprintf(out, "%s: %s %s, %s: %s", test, first, words, other, second);
    else
        fprintf(out, "%s: %s %s%s, %s: %s%s", test, number->metric->name, first, unit, other,
                second, unit);
}

bool neph_verdict_pair(const struct neph_compared *compared, const char *mask, const char *test,
                       const char *other, FILE *out)
{
    const char *words;
    const struct neph_difference *difference = neph_headline_difference(&compared->versus, mask,
                                                                        &words);
    if (!difference)
        return false;
    const struct neph_judged_difference judged = neph_judge_difference(&compared->versus,
                                                                       difference);
    write_values(difference, words, test, other, out);
    fprintf(out, "; %s", judged.word);
    write_p(&judged, out);
    write_count(difference, &judged, out);
    if (judged.because)
        fprintf(out, " (%s)", judged.because);
    write_worst(compared, difference, mask, out);
    fputc('\n', out);
    return true;
}

static void write_number(const struct neph_differences *versus,
                         const struct neph_difference *difference, const char *test,
                         const char *other, FILE *out)
{
    const struct neph_measurement *number = difference->number;
    const struct neph_judged_difference judged = neph_judge_difference(versus, difference);
    if (strcmp(number->quantity->name, "radiance") != 0)
        fprintf(out, "%s: ", number->quantity->name);
    write_values(difference, NULL, test, other, out);
    fprintf(out, "; difference %.3g", difference->value);
    if (difference->interval != NEPH_INTERVAL_NONE)
        fprintf(out, " (95 %%: %.3g to %.3g)", difference->low, difference->high);
    fprintf(out, ", %s: %s\n", judged.word, number->metric->help);
}

static bool is_headline(const struct neph_measurement *number, int headline)
{
    return strcmp(number->metric->name, neph_headlines[headline].metric) == 0 &&
           strcmp(number->quantity->name, neph_headlines[headline].quantity) == 0;
}

int neph_verdict_pair_numbers(const struct neph_compared *compared, const char *mask,
                              const char *test, const char *other, bool shows_metrics,
                              int lines_max, FILE *out)
{
    const struct neph_differences *versus = &compared->versus;
    int lines = 0;
    for (int h = 0; h <= NEPH_HEADLINES; h++)
        for (int i = 0; i < versus->count && lines < lines_max; i++) {
            const struct neph_measurement *number = versus->list[i].number;
            bool is_shown = h < NEPH_HEADLINES ? is_headline(number, h) : shows_metrics;
            for (int k = 0; k < NEPH_HEADLINES && h == NEPH_HEADLINES; k++)
                is_shown &= !is_headline(number, k);
            if (!is_shown || strcmp(number->mask, mask) != 0)
                continue;
            write_number(versus, &versus->list[i], test, other, out);
            lines++;
        }
    return lines;
}
