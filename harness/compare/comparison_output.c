/* SPDX-License-Identifier: MIT */
#include "harness/compare/comparison.h"

#include "base/files.h"
#include "base/written.h"
#include "harness/document/table.h"
#include "metrics/extractors/extractors.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_INTERVAL_KIND_COUNT == 5, "a new kind");

static void write_bounds(bool is_there, double low, double high, char text[48])
{
    if (is_there)
        snprintf(text, 48, "%.2e..%.2e", low, high);
    else
        snprintf(text, 48, "-");
}

static void print_line(const struct neph_measurement *number, bool with_frame)
{
    char value[32] = "undefined", bounds[48], which[16] = "all";
    if (number->defined)
        snprintf(value, sizeof(value), "%.6e", number->value);
    write_bounds(neph_interval_is_bounded(number->interval), number->low, number->high, bounds);
    if (number->interval == NEPH_INTERVAL_DETERMINISTIC)
        snprintf(bounds, sizeof(bounds), "%s", neph_interval_name(number->interval));
    if (number->frame >= 0)
        snprintf(which, sizeof(which), "%d", number->frame);
    if (with_frame)
        printf("%-6s", which);
    printf("%-14s %-13s %-22s %14s  %-22s %8zu  %s\n", number->quantity->name, number->mask,
           number->metric->name, value, bounds, number->pixel_count,
           number->defined ? number->unit : number->undefined_because);
}

static bool is_hidden(const char *mask, bool details)
{
    return !details && neph_mask_is_detail(mask);
}

/* ---- against another test -------------------------------------------------------------------- */

/* Print each reason once, at its first number. */
static void print_versus_reasons(const struct neph_differences *versus, bool details)
{
    for (int i = 0; i < versus->count; i++) {
        const char *because = versus->list[i].because;
        int before = 0, count = 0;
        for (int k = 0; k < versus->count && *because; k++) {
            const bool same = !is_hidden(versus->list[k].number->mask, details) &&
                              strcmp(versus->list[k].because, because) == 0;
            count += same;
            before += same && k < i;
        }
        if (count > 0 && before == 0 && !is_hidden(versus->list[i].number->mask, details))
            printf("no p-value for %d numbers: %s\n", count, because);
    }
}

static void print_p(double p)
{
    if (isnan(p))
        printf(" %9s", "-");
    else
        printf(" %9.2g", p);
}

/* Print the difference of movement: harness/compare/movement.h. */
static void print_time(const char *what, const struct neph_time_difference *time)
{
    if (time->count > 0)
        printf("movement of %s (RMS of luma): test - other %.6e, lower in %d of %d, p %.2g\n", what,
               time->value, time->below, time->count, time->p);
}

static void print_versus(const struct neph_differences *versus, bool details)
{
    if (versus->count > 0)
        printf("%-14s %-13s %-22s %13s %13s %13s  %-22s %9s %9s\n", "quantity", "mask", "metric",
               "test", "other", "test - other", "95 % interval", "p (Holm)", "p (sign)");
    for (int i = 0; i < versus->count; i++) {
        const struct neph_difference *difference = &versus->list[i];
        const struct neph_measurement *number = difference->number;
        char bounds[48];
        if (is_hidden(number->mask, details))
            continue;
        write_bounds(difference->interval != NEPH_INTERVAL_NONE, difference->low, difference->high,
                     bounds);
        printf("%-14s %-13s %-22s %13.6e %13.6e %13.6e  %-22s", number->quantity->name,
               number->mask, number->metric->name, difference->first, difference->second,
               difference->value, bounds);
        print_p(difference->p_holm);
        print_p(difference->p_sign);
        printf("\n");
    }
    print_versus_reasons(versus, details);
    print_time("frames", &versus->frames);
    print_time("cycles", &versus->cycles);
}

/* ---- complete output ------------------------------------------------------------------------- */

static void print_findings(const struct neph_findings *findings, bool details)
{
    for (int i = 0; i < findings->count; i++) {
        const struct neph_finding *finding = &findings->list[i];
        const bool is_of_part = strcmp(finding->name, "clipped") == 0 &&
                                strcmp(finding->mask, "all") != 0;
        if (details || (!is_of_part && !neph_mask_is_detail(finding->mask)))
            printf("%s of %s over '%s': %s: %s\n", finding->name, finding->quantity->name,
                   finding->mask, finding->verdict, finding->text);
    }
}

/* The numbers of a sequence that are printed by default. */
static const char *const headlines[] = {
    "seen_contrast",
    "seen_share",
    "seen_share_6db_more",
    "seen_share_6db_less",
    "seen_p",
    "pop_share",
    "seen_hz",
    "seen_period",
    "coherent_contrast",
    "worst_tile_contrast",
    "std_p95",
    "a4_mean",
    "a4_p95",
    "a2_p95",
    "block_a4_p95",
    "cyclic_share",
    "restless_share",
    "age_slope",
    "reference_a4_p95",
    "residual_change_rms",
    "residual_change_psnr",
    "motion_residual_excess",
    "motion_coverage",
    "disoccluded_recovery",
    "follow_gain_1_p50",
    "follow_lag_1_p50",
    "follow_gain_2_p50",
    "follow_lag_2_p50",
    "follow_gain_3_p50",
    "follow_lag_3_p50",
    "edge_ghost_residual_4",
    "edge_ghost_frames",
};

/* True for a number that is printed by default. All numbers of lag and of single frames are. */
static bool is_summary_number(const struct neph_measurement *number)
{
    const struct neph_extractor *owner = NULL;
    const char *metric = number->metric->name;
    neph_metric_find(metric, &owner);
    if (!owner || strcmp(owner->name, "lag") == 0 || !owner->temporal)
        return true;
    for (size_t h = 0; h < sizeof(headlines) / sizeof(headlines[0]); h++)
        if (strcmp(headlines[h], metric) == 0)
            return true;
    return false;
}

/* Print the table of numbers: of a sequence those over all frames, if there are any; of a single
 * frame all numbers, where metrics of sequences are reported as undefined. */
static void print_numbers(const struct neph_compared *compared, bool details, bool all)
{
    const struct neph_measurements *numbers = &compared->numbers;
    const bool is_sequence = compared->frame_count > 1;
    bool has_overall = false;
    for (int i = 0; i < numbers->count && is_sequence; i++)
        has_overall |= numbers->list[i].frame < 0;
    const bool with_frame = !has_overall && is_sequence;
    printf("%s%-14s %-13s %-22s %14s  %-22s %8s  %s\n", with_frame ? "frame " : "", "quantity",
           "mask", "metric", "value", "95 % interval", "pixels", "unit");
    int left_out = 0;
    for (int i = 0; i < numbers->count; i++) {
        const struct neph_measurement *number = &numbers->list[i];
        if ((has_overall && number->frame >= 0) || is_hidden(number->mask, details))
            continue;
        if (all || is_summary_number(number))
            print_line(number, with_frame);
        else
            left_out++;
    }
    if (left_out > 0)
        printf("%d more numbers: --metric flicker, --json or --csv\n", left_out);
}

/* Print a property of the reference and of the test, either of which may be absent. Returns the
 * number of lines. */
static int print_sides(const char *what, const char *joint, const char *reference, const char *test,
                       FILE *out)
{
    const bool is_common = reference && test && strcmp(reference, test) == 0;
    if (!reference && !test)
        return 0;
    fprintf(out, "%s:", what);
    if (is_common)
        fprintf(out, " both %s %s", joint, test);
    if (reference && !is_common)
        fprintf(out, " the reference %s %s%s", joint, reference, test ? ";" : "");
    if (test && !is_common)
        fprintf(out, " the test %s %s", joint, test);
    fprintf(out, "\n");
    return 1;
}

int neph_comparison_print_reading(const struct neph_compared *compared, FILE *out)
{
    char windows[256];
    int lines = 0;
    neph_windows_sentence(&compared->asked->windows, windows, sizeof(windows));
    if (windows[0])
        lines += fprintf(out, "%s\n", windows) > 0;
    lines += print_sides("decoded as sRGB", "from", compared->reference_video, compared->test_video,
                         out);
    lines += print_sides("converted to linear Rec.709", "from", compared->reference_space,
                         compared->test_space, out);
    return lines;
}

int neph_comparison_print_histogram(const struct neph_compared *compared, FILE *out)
{
    static const struct {
        int first, last; /* edges: neph_histogram_count() */
        const char *range;
    } parts[] = {{-1, 4, "below -10 %"},
                 {4, 6, "to -1 %"},
                 {6, 8, "to -0.1 %"},
                 {8, 13, "to 0.1 %"},
                 {13, 15, "to 1 %"},
                 {15, 17, "to 10 %"},
                 {17, NEPH_HISTOGRAM_EDGES, "above"}};
    const struct neph_error_histogram *histogram = &compared->histogram;
    if (histogram->count == 0)
        return 0;
    fprintf(out, "relative error of samples of radiance");
    for (size_t p = 0; p < sizeof(parts) / sizeof(parts[0]); p++)
        fprintf(out, "%s %s: %.3g %%", p == 0 ? "," : ";", parts[p].range,
                100.0 * (double)neph_histogram_count(histogram, parts[p].first, parts[p].last) /
                    (double)histogram->count);
    if (histogram->not_finite > 0)
        fprintf(out, "; not finite: %llu samples", (unsigned long long)histogram->not_finite);
    fprintf(out, "\n");
    return 1;
}

void neph_comparison_print(const struct neph_compared *compared, bool details, bool all)
{
    const struct neph_viewing *viewing = &compared->viewing;
    neph_comparison_print_reading(compared, stdout);
    print_numbers(compared, details, all);
    print_versus(&compared->versus, details);
    print_findings(&compared->findings, details);
    if (compared->largest_error.is_known)
        printf(
            "largest error of radiance: %c of pixel (%d, %d) in frame %d: %.6g, reference %.6g\n",
            compared->largest_error.channel, compared->largest_error.x_px,
            compared->largest_error.y_px, compared->largest_error.frame,
            compared->largest_error.test, compared->largest_error.reference);
    neph_comparison_print_histogram(compared, stdout);
    for (int i = 0; i < compared->not_taken_count; i++)
        printf("not taken: %s of %s: %s\n", compared->not_taken[i].extractor,
               compared->not_taken[i].quantity, compared->not_taken[i].because);
    if (compared->numbers.count > 0)
        printf("display: %g frames a second, %g pixels per degree, %g EV, white %g cd/m2, dark "
               "surround\n",
               viewing->frame_rate_hz, viewing->pixels_per_degree, viewing->exposure_ev,
               viewing->white_cd_per_m2);
    neph_partner_print(&compared->partner, stdout);
    printf("frames: %d measured, %d of them frozen\n", compared->frame_count,
           compared->frozen_count);
}

/* ---- CSV ------------------------------------------------------------------------------------- */

/* Write a CSV field after another field; empty for a missing number. */
static void csv_number(FILE *out, bool is_there, double value)
{
    fputc(',', out);
    if (is_there)
        fprintf(out, "%.17g", value);
}

static const struct neph_difference *find_difference(const struct neph_differences *versus,
                                                     const struct neph_measurement *number)
{
    for (int i = 0; i < versus->count; i++) {
        const struct neph_measurement *of = versus->list[i].number;
        if (of->metric == number->metric && of->quantity == number->quantity &&
            strcmp(of->mask, number->mask) == 0)
            return &versus->list[i];
    }
    return NULL;
}

/* Only numbers of all frames have a difference in the table. */
static void write_csv_difference(FILE *out, const struct neph_differences *versus,
                                 const struct neph_measurement *number)
{
    const struct neph_difference *difference = number->frame < 0 ? find_difference(versus, number)
                                                                 : NULL;
    const bool is_there = difference != NULL;
    const bool is_sure = is_there && difference->interval != NEPH_INTERVAL_NONE;
    csv_number(out, is_there, is_there ? difference->second : 0.0);
    csv_number(out, is_there, is_there ? difference->value : 0.0);
    csv_number(out, is_sure, is_sure ? difference->low : 0.0);
    csv_number(out, is_sure, is_sure ? difference->high : 0.0);
    csv_number(out, is_there && !isnan(difference->p), is_there ? difference->p : 0.0);
    csv_number(out, is_there && !isnan(difference->p_holm), is_there ? difference->p_holm : 0.0);
}

static void write_csv_line(FILE *out, const struct neph_measurement *number,
                           const struct neph_compared *compared)
{
    const struct neph_viewing *viewing = &compared->viewing;
    const char *const words[] = {number->quantity->name, number->metric->name, number->mask,
                                 number->unit, neph_interval_name(number->interval)};
    const double conditions[] = {viewing->frame_rate_hz, viewing->pixels_per_degree,
                                 viewing->exposure_ev, viewing->white_cd_per_m2};
    const bool bounded = neph_interval_is_bounded(number->interval);
    for (size_t w = 0; w < sizeof(words) / sizeof(words[0]); w++) {
        fputs(w > 0 ? "," : "", out);
        neph_csv_word(words[w], out);
    }
    csv_number(out, number->frame >= 0, number->frame);
    csv_number(out, number->defined, number->value);
    csv_number(out, bounded, number->low);
    csv_number(out, bounded, number->high);
    fprintf(out, ",%d,%zu", number->n, number->pixel_count);
    for (size_t c = 0; c < sizeof(conditions) / sizeof(conditions[0]); c++)
        csv_number(out, true, conditions[c]);
    fputc(',', out);
    neph_csv_word(number->defined ? "" : number->undefined_because, out);
    if (compared->has_versus)
        write_csv_difference(out, &compared->versus, number);
    fputc('\n', out);
}

static void write_csv(const void *what, FILE *out)
{
    const struct neph_compared *compared = what;
    fprintf(out,
            "quantity,metric,mask,unit,interval_kind,frame,value,low,high,n,pixel_count,"
            "frame_rate_hz,pixels_per_degree,exposure_ev,white_cd_per_m2,"
            "undefined_because%s\n",
            compared->has_versus ? ",other,difference,difference_low,difference_high,p,p_holm"
                                 : "");
    for (int i = 0; i < compared->numbers.count; i++)
        write_csv_line(out, &compared->numbers.list[i], compared);
}

enum neph_status neph_comparison_write_csv(const char *path, const struct neph_compared *compared,
                                           struct neph_diag *diag)
{
    char *text = NULL;
    enum neph_status status = neph_write_to_text(write_csv, compared, &text, diag);
    if (!status && strcmp(path, "-") == 0)
        fputs(text, stdout); /* the exit code covers write errors of stdout */
    else if (!status)
        status = neph_file_write(path, text, strlen(text), diag);
    free(text);
    return status;
}

/* ---- JSON ------------------------------------------------------------------------------------ */

/* First file and number of files of a sequence. */
static json_t *sequence_json(const struct neph_sequence *sequence)
{
    return json_pack("{s:o, s:i}", "first",
                     sequence->count > 0 ? neph_json_cleaned(sequence->paths[0]) : json_null(),
                     "count", sequence->count);
}

static json_t *numbers_json(const struct neph_compared *compared)
{
    json_t *list = json_array();
    for (int i = 0; i < compared->numbers.count; i++) {
        json_t *item = neph_measurement_json(&compared->numbers.list[i]);
        neph_json_set(&item, "viewing", neph_viewing_json(&compared->viewing));
        neph_json_add(&list, item);
    }
    return list;
}

static json_t *not_taken_json(const struct neph_compared *compared)
{
    json_t *list = json_array();
    for (int i = 0; i < compared->not_taken_count; i++)
        neph_json_add(&list,
                      json_pack("{s:s, s:s, s:s}", "extractor", compared->not_taken[i].extractor,
                                "quantity", compared->not_taken[i].quantity, "because",
                                compared->not_taken[i].because));
    return list;
}

static json_t *movement_json(const struct neph_movement *movement)
{
    json_t *frames = json_array(), *cycles = json_array();
    for (int f = 0; f < movement->frame_count; f++)
        neph_json_add(&frames, neph_json_number(movement->frames[f]));
    for (int c = 0; c < movement->frame_count / NEPH_MOVEMENT_CYCLE; c++)
        neph_json_add(&cycles, neph_json_number(movement->cycles[c]));
    return json_pack("{s:o, s:o}", "frames", frames, "cycles", cycles);
}

static json_t *largest_error_json(const struct neph_largest_error *largest)
{
    const char channel[2] = {largest->channel, '\0'};
    if (!largest->is_known)
        return json_null();
    return json_pack("{s:i, s:i, s:i, s:s, s:f, s:f}", "frame", largest->frame, "x", largest->x_px,
                     "y", largest->y_px, "channel", channel, "reference", largest->reference,
                     "test", largest->test);
}

static json_t *histogram_json(const struct neph_error_histogram *histogram)
{
    json_t *edges = json_array(), *counts = json_array();
    for (int i = 0; i < NEPH_HISTOGRAM_EDGES; i++)
        neph_json_add(&edges, json_real(neph_histogram_edge(i)));
    for (int i = 0; i < NEPH_HISTOGRAM_BINS; i++)
        neph_json_add(&counts, json_integer((json_int_t)neph_histogram_count(histogram, i, i + 1)));
    return json_pack(
        "{s:s, s:o, s:o, s:I, s:I, s:I}", "error",
        "(test - reference) / max(|reference|, 1e-4 S) of radiance, S the mean "
        "luminance of the reference",
        "edges", edges, "counts", counts, "below",
        (json_int_t)neph_histogram_count(histogram, -1, 0), "above",
        (json_int_t)neph_histogram_count(histogram, NEPH_HISTOGRAM_BINS, NEPH_HISTOGRAM_EDGES),
        "not_finite", (json_int_t)histogram->not_finite);
}

json_t *neph_compared_json(const struct neph_compared *compared)
{
    const struct neph_comparison *asked = compared->asked;
    json_t *maps = json_array();
    for (int i = 0; i < compared->map_count; i++)
        neph_json_add(&maps, json_string(compared->maps[i]));
    json_t *json = json_pack(
        "{s:s, s:o, s:o, s:i, s:i, s:i, s:b, s:o, s:o, s:o, s:o}", "version", NEPH_VERSION,
        "reference", asked->without_reference ? json_null() : sequence_json(&asked->reference),
        "test", sequence_json(&asked->test), "warm_up_frames", asked->warm_up_frames, "frames",
        compared->frame_count, "frozen", compared->frozen_count, "interrupted",
        compared->interrupted, "measurements", numbers_json(compared), "findings",
        neph_findings_json(&compared->findings), "not_taken", not_taken_json(compared), "maps",
        maps);
    neph_json_set(&json, "window", neph_windows_json(&asked->windows));
    if (compared->reference_space || compared->test_space)
        neph_json_set(&json, "converted",
                      json_pack("{s:s?, s:s?}", "reference", compared->reference_space, "test",
                                compared->test_space));
    if (compared->reference_video || compared->test_video)
        neph_json_set(&json, "video",
                      json_pack("{s:s?, s:s?}", "reference", compared->reference_video, "test",
                                compared->test_video));
    if (compared->has_largest_error)
        neph_json_set(&json, "largest_error", largest_error_json(&compared->largest_error));
    if (compared->histogram.count + compared->histogram.not_finite > 0)
        neph_json_set(&json, "error_histogram", histogram_json(&compared->histogram));
    if (compared->movement.frame_count > 0)
        neph_json_set(&json, "movement", movement_json(&compared->movement));
    if (compared->partner.display)
        neph_json_set(&json, "partners", json_pack("[o]", neph_partner_json(&compared->partner)));
    if (compared->has_versus) {
        neph_json_set(&json, "versus", neph_differences_json(&compared->versus));
        neph_json_set(&json, "versus_movement", neph_time_differences_json(&compared->versus));
    }
    return json;
}
