/* SPDX-License-Identifier: MIT */
#include "harness/compare/verdict.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_INTERVAL_KIND_COUNT == 5, "a new kind");

enum { LINES_MAX = 10, LAST_LINES = 2 };

/* The numbers that answer first, if they were measured. */
static const struct headline {
    const char *quantity, *metric;
} headlines[] = {
    {"radiance", "seen_contrast"},  {"radiance", "rel_rmse"},  {"radiance", "rel_bias"},
    {"radiance", "max_rel"},        {"radiance", "pu_psnr"},   {"radiance", "ssim_mean"},
    {"radiance", "flip_mean"},      {"transmittance", "rmse"}, {"radiance", "cyclic_share"},
    {"radiance", "restless_share"}, {"radiance", "a4_p95"},    {"radiance", "residual_change_rms"},
    {"radiance", "half_life_p50"},
};
enum { HEADLINE_COUNT = sizeof(headlines) / sizeof(headlines[0]) };

enum { SMALLER_IS_BETTER = 1, LARGER_IS_BETTER = -1 };

/* The metrics that have a direction, by how their names begin. Of the others, such as a gain that
 * should be 1, it is only said which value is higher. */
static const struct direction {
    const char *begin;
    int sign;
} directions[] = {
    {"bias", SMALLER_IS_BETTER},       {"rel_", SMALLER_IS_BETTER},
    {"mae", SMALLER_IS_BETTER},        {"rmse", SMALLER_IS_BETTER},
    {"max_", SMALLER_IS_BETTER},       {"p50", SMALLER_IS_BETTER},
    {"p95", SMALLER_IS_BETTER},        {"p99", SMALLER_IS_BETTER},
    {"stops_", SMALLER_IS_BETTER},     {"flip_", SMALLER_IS_BETTER},
    {"seen_c", SMALLER_IS_BETTER},     {"seen_s", SMALLER_IS_BETTER},
    {"std_", SMALLER_IS_BETTER},       {"a4_", SMALLER_IS_BETTER},
    {"a2_", SMALLER_IS_BETTER},        {"block_a4_", SMALLER_IS_BETTER},
    {"cyclic_", SMALLER_IS_BETTER},    {"restless_", SMALLER_IS_BETTER},
    {"half_life_", SMALLER_IS_BETTER}, {"residual_change_rms", SMALLER_IS_BETTER},
    {"pu_psnr", LARGER_IS_BETTER},     {"residual_change_psnr", LARGER_IS_BETTER},
    {"ssim_", LARGER_IS_BETTER},       {"ms_ssim", LARGER_IS_BETTER},
};

/* 0: it has none. */
static int find_direction(const struct neph_metric *metric)
{
    for (size_t i = 0; i < sizeof(directions) / sizeof(directions[0]); i++)
        if (strncmp(directions[i].begin, metric->name, strlen(directions[i].begin)) == 0)
            return directions[i].sign;
    return 0;
}

/* ---- a number over its frames ---------------------------------------------------------------- */

struct summary {
    const struct neph_measurement *number; /* of all frames, or of the worst; NULL: none */
    double mean;
    int frame_count; /* 0: one number of all frames */
};

static bool is_worse(const struct neph_measurement *a, const struct neph_measurement *b)
{
    return find_direction(a->metric) == LARGER_IS_BETTER ? a->value < b->value
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

/* The frame in which a number is worst; NULL: there are not several frames. */
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

static void print_summary(const struct summary *summary)
{
    const struct neph_measurement *number = summary->number;
    const char *unit = strcmp(number->unit, "1") == 0 ? "" : number->unit;
    printf("%s %.4g%s%s", number->metric->name, summary->mean, *unit ? " " : "", unit);
    if (summary->frame_count > 0)
        printf(" in the mean of %d frames, %s %.4g in frame %d", summary->frame_count,
               find_direction(number->metric) ? "worst" : "largest", number->value, number->frame);
    else if (neph_interval_is_bounded(number->interval))
        printf(" (95 %%: %.3g to %.3g)", number->low, number->high);
}

/* ---- limits ---------------------------------------------------------------------------------- */

void neph_verdict_print_limit(const struct neph_measurements *list, const struct neph_limit *limit)
{
    const struct neph_measurement *worst = neph_limit_worst(list, limit);
    const bool is_kept = neph_limit_check(list, limit, NULL) == NEPH_OK;
    const bool is_radiance = strcmp(limit->quantity, "radiance") == 0;
    printf("%s %s%s%s", is_kept ? "PASS" : "FAIL", is_radiance ? "" : limit->quantity,
           is_radiance ? "" : ":", limit->metric);
    if (strcmp(limit->mask, "all") != 0)
        printf("@%s", limit->mask);
    if (!worst) {
        printf("%s\n", is_kept ? ": the images are equal" : ": not measured");
        return;
    }
    const bool is_above = fabs(worst->value) > limit->value;
    printf(" %.4g %s %.4g", worst->value,
           limit->below ? (is_above ? ">" : "<") : (is_above ? ">" : "<="), limit->value);
    if (worst_frame(list, worst))
        printf(" (worst: frame %d)", worst->frame);
    printf("\n");
}

/* ---- the sentence ---------------------------------------------------------------------------- */

static const struct neph_difference *find_difference(const struct neph_differences *list,
                                                     const char *quantity, const char *metric,
                                                     const char *mask)
{
    for (int i = 0; i < list->count; i++) {
        const struct neph_measurement *number = list->list[i].number;
        if (strcmp(number->quantity->name, quantity) == 0 && strcmp(number->mask, mask) == 0 &&
            (!metric || strcmp(number->metric->name, metric) == 0))
            return &list->list[i];
    }
    return NULL;
}

/* The difference that answers: of the first headline that has one, else the first. */
static const struct neph_difference *main_difference(const struct neph_differences *list,
                                                     const char *mask)
{
    for (int h = 0; h < HEADLINE_COUNT; h++) {
        const struct neph_difference *found = find_difference(list, headlines[h].quantity,
                                                              headlines[h].metric, mask);
        if (found)
            return found;
    }
    return find_difference(list, "radiance", NULL, mask);
}

/* Better, worse, or not told apart; of a metric without a direction higher or lower. A number that
 * may be of either sign is better nearer to 0. */
static const char *word_for(const struct neph_difference *difference)
{
    const int direction = find_direction(difference->number->metric);
    const double other = difference->first - difference->value;
    if (difference->value == 0.0)
        return "equal";
    if (difference->interval == NEPH_INTERVAL_NONE ||
        (difference->low <= 0.0 && difference->high >= 0.0))
        return "not told apart";
    if (direction == 0)
        return difference->value > 0.0 ? "higher" : "lower";
    const bool is_smaller = fabs(difference->first) < fabs(other);
    return is_smaller == (direction == SMALLER_IS_BETTER) ? "better" : "worse";
}

static void print_difference(const struct neph_difference *difference)
{
    const double other = difference->first - difference->value;
    printf("%s: %s %.4g, of --versus %.4g", word_for(difference), difference->number->metric->name,
           difference->first, other);
    if (difference->interval == NEPH_INTERVAL_NONE) {
        printf("; %s\n", difference->because);
        return;
    }
    printf(" (difference %.3g, 95 %%: %.3g to %.3g", difference->value, difference->low,
           difference->high);
    if (!isnan(difference->p))
        printf(difference->p < 0.001 ? ", p < 0.001" : ", p = %.2g", difference->p);
    if (difference->below + difference->above > 0)
        printf(", lower in %d of %d batches of frames", difference->below,
               difference->below + difference->above);
    printf(")\n");
}

static const struct neph_finding *find_finding(const struct neph_findings *list, const char *name,
                                               const char *mask)
{
    for (int i = 0; i < list->count; i++)
        if (strcmp(list->list[i].name, name) == 0 && strcmp(list->list[i].mask, mask) == 0)
            return &list->list[i];
    return NULL;
}

struct told {
    const char *finding, *words;
};

/* The flicker of a sequence. */
static const struct told answers[] = {{"seen", "flicker"},
                                      {"flicker", "four-frame cycle"},
                                      {"edge_ratio", "at depth edges"},
                                      {"half_life", "lag"}};

/* Reasons to trust the numbers less. */
static const struct told cautions[] = {{"reference_limited", "the reference"},
                                       {"noise_floor", "the reference"},
                                       {"clipped", "the display"}};

/* Returns the number of lines. */
static int print_findings(const struct neph_compared *compared, const char *mask,
                          const struct told *told, int count, int lines_max)
{
    int lines = 0;
    for (int i = 0; i < count && lines < lines_max; i++) {
        const struct neph_finding *finding = find_finding(&compared->findings, told[i].finding,
                                                          mask);
        if (!finding)
            continue;
        printf("%s: %s: %s\n", told[i].words, finding->verdict, finding->text);
        lines++;
    }
    return lines;
}

/* The error of frames one by one. Returns the number of lines. */
static int print_error(const struct neph_compared *compared, const char *mask)
{
    const struct neph_measurements *list = &compared->numbers;
    const struct summary rmse = summarize(list, "radiance", "rel_rmse", mask);
    const struct summary bias = summarize(list, "radiance", "rel_bias", mask);
    if (!rmse.number || !bias.number)
        return 0;
    printf("radiance is off by %.3g %% (RMSE over the mean of the reference), in the mean %.3g %% "
           "too %s",
           100.0 * rmse.mean, 100.0 * fabs(bias.mean), bias.mean < 0.0 ? "dark" : "bright");
    const struct neph_measurement *worst = worst_frame(list, rmse.number);
    if (worst)
        printf("; worst: frame %d, %.3g %%", worst->frame, 100.0 * worst->value);
    printf("\n");
    return 1;
}

/* ---- all of it ------------------------------------------------------------------------------- */

/* Headlines that were measured, else the first numbers there are; how many lines. */
static int print_numbers(const struct neph_compared *compared, const char *mask, int lines_max,
                         bool shows_metrics)
{
    const struct neph_measurements *list = &compared->numbers;
    int lines = 0;
    for (int h = 0; h < HEADLINE_COUNT && lines < lines_max; h++) {
        const struct summary summary = summarize(list, headlines[h].quantity, headlines[h].metric,
                                                 mask);
        if (!summary.number)
            continue;
        if (strcmp(headlines[h].quantity, "radiance") != 0)
            printf("%s: ", headlines[h].quantity);
        print_summary(&summary);
        printf(": %s\n", summary.number->metric->help);
        lines++;
    }
    const char *before = "";
    for (int i = 0; i < list->count && lines < lines_max && shows_metrics; i++) {
        const struct neph_measurement *number = &list->list[i];
        const struct summary summary = summarize(list, number->quantity->name, number->metric->name,
                                                 mask);
        bool is_headline = strcmp(number->metric->name, before) == 0;
        before = number->metric->name;
        for (int h = 0; h < HEADLINE_COUNT; h++)
            is_headline |= strcmp(headlines[h].metric, number->metric->name) == 0;
        if (is_headline || summary.number != number)
            continue;
        print_summary(&summary);
        printf(": %s\n", number->metric->help);
        lines++;
    }
    return lines;
}

/* Parts of the frames that no extractor took; how many lines. */
static int print_left_out(const struct neph_compared *compared)
{
    int lines = 0;
    for (int i = 0; i < compared->not_taken_count; i++) {
        if (strcmp(compared->not_taken[i].extractor, "everything") != 0)
            continue;
        printf("not measured: %s: %s\n", compared->not_taken[i].quantity,
               compared->not_taken[i].because);
        lines++;
    }
    return lines;
}

void neph_verdict_print(const struct neph_compared *compared, const struct neph_verdict_form *form)
{
    const struct neph_viewing *viewing = &compared->viewing;
    const char *mask = form->mask ? form->mask : "all";
    const struct neph_difference *difference = main_difference(&compared->versus, mask);
    int lines = form->lines_used;
    if (difference) {
        print_difference(difference);
        lines++;
    }
    const int lines_max = form->is_brief ? 1 : LINES_MAX - LAST_LINES;
    const int answered = print_findings(compared, mask, answers,
                                        sizeof(answers) / sizeof(answers[0]), lines_max - lines);
    lines += answered;
    if (answered == 0 && !form->shows_metrics && lines < lines_max)
        lines += print_error(compared, mask);
    if (!form->is_brief) {
        lines += print_findings(compared, mask, cautions, sizeof(cautions) / sizeof(cautions[0]),
                                lines_max - lines);
        lines += print_left_out(compared);
    }
    print_numbers(compared, mask, lines_max - lines, form->shows_metrics);
    if (form->is_brief)
        return;
    printf("display: %g frames a second, %g pixels per degree, %g EV, white %g cd/m2, dark "
           "surround; %d frame%s measured, %d frozen\n",
           viewing->frame_rate_hz, viewing->pixels_per_degree, viewing->exposure_ev,
           viewing->white_cd_per_m2, compared->frame_count, compared->frame_count == 1 ? "" : "s",
           compared->frozen_count);
    printf("%d numbers in all: --all, --csv FILE or --json; maps of errors: --maps DIR\n",
           compared->numbers.count);
}
