/* SPDX-License-Identifier: MIT */
#include "harness/compare/verdict.h"

#include "harness/compare/direction.h"
#include "harness/compare/headlines.h"
#include "harness/compare/verdict_pair.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_INTERVAL_KIND_COUNT == 5, "a new kind");

enum { LINES_MAX = 10, LAST_LINES = 2 };

/* ---- a number over its frames ---------------------------------------------------------------- */

struct summary {
    const struct neph_measurement *number; /* of all frames, or of the worst frame; NULL: none */
    double mean;
    int frame_count; /* 0: a single number of all frames */
};

static bool is_worse(const struct neph_measurement *a, const struct neph_measurement *b)
{
    return neph_metric_direction(a->metric) == NEPH_LARGER_IS_BETTER
               ? a->value < b->value
               : fabs(a->value) > fabs(b->value);
}

static struct summary summarize(const struct neph_measurements *list, const char *quantity,
                                const char *metric, const char *mask)
{
    struct summary made = {.number = NULL};
    double sum = 0.0;
    for (int i = 0; i < list->count; i++) {
        const struct neph_measurement *number = &list->list[i];
        if (!number->defined || strcmp(number->quantity->name, quantity) != 0 ||
            strcmp(number->metric->name, metric) != 0 || strcmp(number->mask, mask) != 0)
            continue;
        if (number->frame < 0)
            return (struct summary){number, number->value, 0};
        sum += number->value;
        made.frame_count++;
        if (!made.number || is_worse(number, made.number))
            made.number = number;
    }
    made.mean = sum / made.frame_count;
    if (made.frame_count == 1)
        made.frame_count = 0;
    return made;
}

/* The number of the frame with the worst value; NULL: there is only one frame. */
static const struct neph_measurement *worst_frame(const struct neph_measurements *list,
                                                  const struct neph_measurement *number)
{
    const struct neph_measurement *worst = NULL;
    int count = 0;
    for (int i = 0; i < list->count; i++) {
        const struct neph_measurement *other = &list->list[i];
        if (other->frame < 0 || !other->defined || other->metric != number->metric ||
            other->quantity != number->quantity || strcmp(other->mask, number->mask) != 0)
            continue;
        count++;
        if (!worst || is_worse(other, worst))
            worst = other;
    }
    return count > 1 ? worst : NULL;
}

static void print_summary(const struct summary *summary, FILE *out)
{
    const struct neph_measurement *number = summary->number;
    const char *unit = strcmp(number->unit, "1") == 0 ? "" : number->unit;
    fprintf(out, "%s %.4g%s%s", number->metric->name, summary->mean, *unit ? " " : "", unit);
    if (summary->frame_count > 0)
        fprintf(out, " in the mean of %d frames, %s %.4g in frame %d", summary->frame_count,
                neph_metric_direction(number->metric) ? "worst" : "largest", number->value,
                number->frame);
    else if (neph_interval_is_bounded(number->interval))
        fprintf(out, " (95 %%: %.3g to %.3g)", number->low, number->high);
}

/* ---- limits ---------------------------------------------------------------------------------- */

/* Format a value and its limit with the least number of digits that makes them differ. */
static void format_both(const struct neph_measurement *worst, const struct neph_limit *limit,
                        char value[32], char bound[32])
{
    for (int digits = 4; digits <= 17; digits++) {
        snprintf(value, 32, "%.*g", digits, worst->value);
        snprintf(bound, 32, "%.*g", digits, limit->value);
        if (strcmp(value, bound) != 0 || worst->value == limit->value)
            return;
    }
}

void neph_verdict_limit(const struct neph_measurements *list, const struct neph_limit *limit,
                        FILE *out)
{
    const struct neph_measurement *worst = neph_limit_worst(list, limit);
    const bool is_kept = neph_limit_check(list, limit, NULL) == NEPH_OK;
    const bool is_radiance = strcmp(limit->quantity, "radiance") == 0;
    char value[32], bound[32];
    fprintf(out, "%s %s%s%s", is_kept ? "PASS" : "FAIL", is_radiance ? "" : limit->quantity,
            is_radiance ? "" : ":", limit->metric);
    if (strcmp(limit->mask, "all") != 0)
        fprintf(out, "@%s", limit->mask);
    if (!worst) {
        fprintf(out, "%s\n", is_kept ? ": the images are equal" : ": not measured");
        return;
    }
    const bool is_above = fabs(worst->value) > limit->value;
    const bool is_below = fabs(worst->value) < limit->value;
    format_both(worst, limit, value, bound);
    fprintf(out, " %s %s %s", value,
            limit->below ? (is_below ? "<" : ">=") : (is_above ? ">" : "<="), bound);
    if (worst_frame(list, worst))
        fprintf(out, " (worst: frame %d)", worst->frame);
    fprintf(out, "\n");
}

/* ---- first sentence -------------------------------------------------------------------------- */

static const struct neph_finding *find_finding(const struct neph_findings *list, const char *name,
                                               const char *mask)
{
    for (int i = 0; i < list->count; i++)
        if (strcmp(list->list[i].name, name) == 0 && strcmp(list->list[i].mask, mask) == 0)
            return &list->list[i];
    return NULL;
}

struct printed_findings {
    const char *finding, *words;
    bool needs_reference;
};

/* Findings about the flicker of a sequence. */
static const struct printed_findings answers[] = {{"seen", "flicker", false},
                                                  {"flicker", "four-frame cycle", false},
                                                  {"edge_ratio", "at depth edges", false},
                                                  {"half_life", "lag", true}};

/* Findings that reduce the reliability of the numbers. */
static const struct printed_findings cautions[] = {{"reference_limited", "the reference", true},
                                                   {"noise_floor", "the reference", true},
                                                   {"clipped", "the display", false}};
enum {
    ANSWERS = sizeof(answers) / sizeof(answers[0]),
    CAUTIONS = sizeof(cautions) / sizeof(cautions[0]),
};

/* Position within a table that is being printed. */
struct findings_print {
    const struct printed_findings *printed_findings;
    int count, next;
};

/* Print findings of a table. `label` precedes each line, or NULL. Returns the number of lines. */
static int print_findings(const struct neph_compared *compared, const char *mask, const char *label,
                          struct findings_print *findings_print, int lines_max, FILE *out)
{
    int lines = 0;
    while (findings_print->next < findings_print->count && lines < lines_max) {
        const struct printed_findings *printed_findings =
            &findings_print->printed_findings[findings_print->next++];
        const struct neph_finding *finding = find_finding(&compared->findings,
                                                          printed_findings->finding, mask);
        if (!finding || (compared->asked->without_reference && printed_findings->needs_reference))
            continue;
        fprintf(out, "%s%s%s: %s: %s\n", label ? label : "", label ? ": " : "",
                printed_findings->words, finding->verdict, finding->text);
        lines++;
    }
    return lines;
}

/* Print the error of single frames. Returns the number of lines. */
static int print_error(const struct neph_compared *compared, const char *mask, FILE *out)
{
    const struct neph_measurements *list = &compared->numbers;
    const struct summary rmse = summarize(list, "radiance", "rel_rmse", mask);
    const struct summary bias = summarize(list, "radiance", "rel_bias", mask);
    if (!rmse.number || !bias.number)
        return 0;
    if (rmse.mean == 0.0) {
        fprintf(out, "radiance is equal to the reference (RMSE 0)\n");
        return 1;
    }
    fprintf(out,
            "radiance is off by %.3g %% (RMSE over the mean of the reference), in the mean %.3g %% "
            "too %s",
            100.0 * rmse.mean, 100.0 * fabs(bias.mean), bias.mean < 0.0 ? "dark" : "bright");
    const struct neph_measurement *worst = worst_frame(list, rmse.number);
    if (worst)
        fprintf(out, "; worst: frame %d, %.3g %%", worst->frame, 100.0 * worst->value);
    fprintf(out, "\n");
    return 1;
}

/* ---- complete verdict ------------------------------------------------------------------------ */

/* Print the measured headlines; with `shows_metrics` also other numbers. Returns the number of
 * lines. */
static int print_numbers(const struct neph_compared *compared, const char *mask, int lines_max,
                         bool shows_metrics, FILE *out)
{
    const struct neph_measurements *list = &compared->numbers;
    int lines = 0;
    for (int h = 0; h < NEPH_HEADLINES && lines < lines_max; h++) {
        const struct summary summary = summarize(list, neph_headlines[h].quantity,
                                                 neph_headlines[h].metric, mask);
        if (!summary.number)
            continue;
        if (strcmp(neph_headlines[h].quantity, "radiance") != 0)
            fprintf(out, "%s: ", neph_headlines[h].quantity);
        print_summary(&summary, out);
        fprintf(out, ": %s\n", summary.number->metric->help);
        lines++;
    }
    const char *before = "";
    for (int i = 0; i < list->count && lines < lines_max && shows_metrics; i++) {
        const struct neph_measurement *number = &list->list[i];
        const struct summary summary = summarize(list, number->quantity->name, number->metric->name,
                                                 mask);
        bool is_headline = strcmp(number->metric->name, before) == 0;
        before = number->metric->name;
        for (int h = 0; h < NEPH_HEADLINES; h++)
            is_headline |= strcmp(neph_headlines[h].metric, number->metric->name) == 0;
        if (is_headline || summary.number != number)
            continue;
        print_summary(&summary, out);
        fprintf(out, ": %s\n", number->metric->help);
        lines++;
    }
    return lines;
}

/* Print the parts of the frames that no extractor measures. Returns the number of lines. */
static int print_left_out(const struct neph_compared *compared, FILE *out)
{
    int lines = 0;
    for (int i = 0; i < compared->not_taken_count; i++) {
        if (strcmp(compared->not_taken[i].extractor, "everything") != 0)
            continue;
        fprintf(out, "not measured: %s: %s\n", compared->not_taken[i].quantity,
                compared->not_taken[i].because);
        lines++;
    }
    return lines;
}

/* Print the first line; false: there is none. */
static bool print_answer(const struct neph_compared *compared, const struct neph_verdict_form *form,
                         const char *mask, struct findings_print *findings_print, FILE *out)
{
    const char *label = compared->has_versus ? form->test : NULL;
    if (label && neph_verdict_pair(compared, mask, form->test, form->other, out))
        return true;
    if (print_findings(compared, mask, label, findings_print, 1, out) > 0)
        return true;
    return !label && !form->shows_metrics && print_error(compared, mask, out) > 0;
}

static void print_ways(const struct neph_compared *compared, bool is_on_page, FILE *out)
{
    const struct neph_viewing *viewing = &compared->viewing;
    fprintf(out,
            "display: %g frames a second, %g pixels per degree, %g EV, white %g cd/m2, dark "
            "surround; %d frame%s measured, %d frozen\n",
            viewing->frame_rate_hz, viewing->pixels_per_degree, viewing->exposure_ev,
            viewing->white_cd_per_m2, compared->frame_count, compared->frame_count == 1 ? "" : "s",
            compared->frozen_count);
    if (is_on_page)
        return;
    fprintf(out,
            "%d number%s in all: --all, --csv FILE or --json; a page with charts and maps: --page "
            "DIR\n",
            compared->numbers.count, compared->numbers.count == 1 ? "" : "s");
}

void neph_verdict(const struct neph_compared *compared, const struct neph_verdict_form *form,
                  FILE *out)
{
    const char *mask = form->mask ? form->mask : "all";
    const char *label = compared->has_versus ? form->test : NULL;
    struct findings_print answer = {answers, ANSWERS, 0}, caution = {cautions, CAUTIONS, 0};
    const int lines_max = form->is_brief ? 1 : LINES_MAX - LAST_LINES;
    int lines = form->lines_used;
    if (lines < lines_max)
        lines += print_answer(compared, form, mask, &answer, out);
    if (!form->is_brief) {
        if (form->note && lines < lines_max)
            lines += fprintf(out, "%s\n", form->note) > 0;
        lines += neph_comparison_print_reading(compared, out);
        lines += print_findings(compared, mask, label, &answer, lines_max - lines, out);
        lines += print_findings(compared, mask, label, &caution, lines_max - lines, out);
        lines += print_left_out(compared, out);
        lines += neph_partner_print(&compared->partner, out);
    }
    if (compared->has_versus)
        neph_verdict_pair_numbers(compared, mask, form->test, form->other, form->shows_metrics,
                                  lines_max - lines, out);
    else
        print_numbers(compared, mask, lines_max - lines, form->shows_metrics, out);
    if (form->is_on_page)
        neph_comparison_print_histogram(compared, out);
    if (!form->is_brief)
        print_ways(compared, form->is_on_page, out);
}
