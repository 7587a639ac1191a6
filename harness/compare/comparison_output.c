/* SPDX-License-Identifier: MIT */
#include "harness/compare/comparison_output.h"

#include "base/files.h"
#include "harness/compare/measure.h"
#include "metrics/extractors/extractors.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void print_line(const json_t *item, bool with_frame)
{
    const json_t *value = json_object_get(item, "value");
    const json_t *interval = json_object_get(item, "interval");
    const json_t *frame = json_object_get(item, "frame");
    char number[32] = "undefined", bounds[48] = "-", which[16] = "all";
    if (json_is_number(value))
        snprintf(number, sizeof(number), "%.6e", json_number_value(value));
    if (json_is_array(interval))
        snprintf(bounds, sizeof(bounds), "%.2e..%.2e",
                 json_number_value(json_array_get(interval, 0)),
                 json_number_value(json_array_get(interval, 1)));
    else if (strcmp(neph_json_text(item, "interval_kind"), "deterministic") == 0)
        snprintf(bounds, sizeof(bounds), "deterministic");
    if (frame)
        snprintf(which, sizeof(which), "%lld", (long long)json_integer_value(frame));
    if (with_frame)
        printf("%-6s", which);
    printf("%-14s %-13s %-22s %14s  %-22s %8lld  %s\n", neph_json_text(item, "quantity"),
           neph_json_text(item, "mask"), neph_json_text(item, "metric"), number, bounds,
           (long long)json_integer_value(json_object_get(item, "pixel_count")),
           json_is_number(value) ? neph_json_text(item, "unit")
                                 : neph_json_text(item, "undefined_because"));
}

static bool is_hidden(const json_t *item, bool details)
{
    return !details && neph_mask_is_detail(neph_json_text(item, "mask"));
}

/* Each reason once. */
static void print_versus_reasons(const json_t *list, bool details)
{
    json_t *counts = json_object();
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *item = json_array_get(list, i);
        const char *because = neph_json_text(item, "because");
        if (*because && !is_hidden(item, details))
            neph_json_set(&counts, because,
                          json_integer(json_integer_value(json_object_get(counts, because)) + 1));
    }
    const char *because;
    json_t *count;
    json_object_foreach(counts, because, count)
        printf("no p-value for %lld numbers: %s\n", (long long)json_integer_value(count), because);
    json_decref(counts);
}

static void print_p(const json_t *p)
{
    if (json_is_number(p))
        printf(" %9.2g", json_number_value(p));
    else
        printf(" %9s", "-");
}

static void print_versus(const json_t *list, bool details)
{
    if (json_array_size(list) > 0)
        printf("%-14s %-13s %-22s %14s  %-22s %9s %9s\n", "quantity", "mask", "test - other",
               "difference", "95 % interval", "p (Holm)", "p (sign)");
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *item = json_array_get(list, i);
        const json_t *interval = json_object_get(item, "interval");
        char bounds[48] = "-";
        if (is_hidden(item, details))
            continue;
        if (json_is_array(interval))
            snprintf(bounds, sizeof(bounds), "%.2e..%.2e",
                     json_number_value(json_array_get(interval, 0)),
                     json_number_value(json_array_get(interval, 1)));
        printf("%-14s %-13s %-22s %14.6e  %-22s", neph_json_text(item, "quantity"),
               neph_json_text(item, "mask"), neph_json_text(item, "metric"),
               json_number_value(json_object_get(item, "difference")), bounds);
        print_p(json_object_get(item, "p_holm"));
        print_p(json_object_get(item, "p_sign"));
        printf("\n");
    }
    print_versus_reasons(list, details);
}

static void print_findings(const json_t *list, bool details)
{
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *item = json_array_get(list, i);
        const bool is_of_part = strcmp(neph_json_text(item, "finding"), "clipped") == 0 &&
                                strcmp(neph_json_text(item, "mask"), "all") != 0;
        if (details || (!is_of_part && !neph_mask_is_detail(neph_json_text(item, "mask"))))
            printf("%s of %s over '%s': %s: %s\n", neph_json_text(item, "finding"),
                   neph_json_text(item, "quantity"), neph_json_text(item, "mask"),
                   neph_json_text(item, "verdict"), neph_json_text(item, "text"));
    }
}

/* Of the numbers of sequences, the few that a first look needs; of lag none are left out. */
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

static bool stands_for_others(const json_t *item)
{
    const struct neph_extractor *owner = NULL;
    const char *metric = neph_json_text(item, "metric");
    neph_metric_find(metric, &owner);
    if (!owner || strcmp(owner->name, "lag") == 0 || !owner->temporal)
        return true;
    for (size_t h = 0; h < sizeof(headlines) / sizeof(headlines[0]); h++)
        if (strcmp(headlines[h], metric) == 0)
            return true;
    return false;
}

/* Under which numbers of displays hold. */
static void print_viewing(const json_t *viewing)
{
    if (viewing)
        printf("display: %g frames a second, %g pixels per degree, %g EV, white %g cd/m2, dark "
               "surround\n",
               json_number_value(json_object_get(viewing, "frame_rate_hz")),
               json_number_value(json_object_get(viewing, "pixels_per_degree")),
               json_number_value(json_object_get(viewing, "exposure_ev")),
               json_number_value(json_object_get(viewing, "white_cd_per_m2")));
}

/* Of a sequence the table holds what is said of all its frames, if there is such a thing. Of a
 * single frame nothing is left out: metrics of sequences say no more than that they have none. */
void neph_comparison_print(const json_t *document, bool details, bool all)
{
    const json_t *list = json_object_get(document, "measurements");
    const bool is_sequence = json_integer_value(json_object_get(document, "frames")) > 1;
    bool has_overall = false;
    for (size_t i = 0; i < json_array_size(list) && is_sequence; i++)
        has_overall |= !json_object_get(json_array_get(list, i), "frame");
    const bool with_frame = !has_overall && is_sequence;
    printf("%s%-14s %-13s %-22s %14s  %-22s %8s  %s\n", with_frame ? "frame " : "", "quantity",
           "mask", "metric", "value", "95 % interval", "pixels", "unit");
    int left_out = 0;
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *item = json_array_get(list, i);
        if ((has_overall && json_object_get(item, "frame")) ||
            (!details && neph_mask_is_detail(neph_json_text(item, "mask"))))
            continue;
        if (all || stands_for_others(item))
            print_line(item, with_frame);
        else
            left_out++;
    }
    if (left_out > 0)
        printf("%d more numbers: --metric flicker, --json or --csv\n", left_out);
    print_versus(json_object_get(document, "versus"), details);
    print_findings(json_object_get(document, "findings"), details);
    const json_t *missing = json_object_get(document, "not_taken");
    for (size_t i = 0; i < json_array_size(missing); i++) {
        const json_t *item = json_array_get(missing, i);
        printf("not taken: %s of %s: %s\n", neph_json_text(item, "extractor"),
               neph_json_text(item, "quantity"), neph_json_text(item, "because"));
    }
    print_viewing(json_object_get(json_array_get(list, 0), "viewing"));
    printf("frames: %lld measured, %lld of them frozen\n",
           (long long)json_integer_value(json_object_get(document, "frames")),
           (long long)json_integer_value(json_object_get(document, "frozen")));
}

/* Text as CSV has it (RFC 4180): names of masks come from the user's files. */
static void csv_text(FILE *out, const char *text)
{
    if (!strpbrk(text, ",\"\r\n")) {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', out);
        fputc(*text, out);
    }
    fputc('"', out);
}

/* A number as CSV has it: nothing for null. */
static void csv_number(FILE *out, const json_t *value)
{
    if (json_is_integer(value))
        fprintf(out, ",%lld", (long long)json_integer_value(value));
    else if (json_is_number(value))
        fprintf(out, ",%.17g", json_number_value(value));
    else
        fputc(',', out);
}

static void write_csv_lines(FILE *out, const json_t *list)
{
    static const char *const words[] = {"quantity", "metric", "mask", "unit", "interval_kind"};
    static const char *const conditions[] = {"frame_rate_hz", "pixels_per_degree", "exposure_ev",
                                             "white_cd_per_m2"};
    fprintf(out, "quantity,metric,mask,unit,interval_kind,frame,value,low,high,n,pixel_count,"
                 "frame_rate_hz,pixels_per_degree,exposure_ev,white_cd_per_m2,"
                 "undefined_because\n");
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *item = json_array_get(list, i);
        const json_t *interval = json_object_get(item, "interval");
        for (size_t w = 0; w < sizeof(words) / sizeof(words[0]); w++) {
            fputs(w > 0 ? "," : "", out);
            csv_text(out, neph_json_text(item, words[w]));
        }
        csv_number(out, json_object_get(item, "frame"));
        csv_number(out, json_object_get(item, "value"));
        csv_number(out, json_array_get(interval, 0));
        csv_number(out, json_array_get(interval, 1));
        csv_number(out, json_object_get(item, "n"));
        csv_number(out, json_object_get(item, "pixel_count"));
        for (int c = 0; c < 4; c++)
            csv_number(out, json_object_get(json_object_get(item, "viewing"), conditions[c]));
        fputc(',', out);
        csv_text(out, neph_json_text(item, "undefined_because"));
        fputc('\n', out);
    }
}

enum neph_status neph_comparison_write_csv(const char *path, const json_t *list,
                                           struct neph_diag *diag)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return neph_fail_memory(diag);
    write_csv_lines(out, list);
    enum neph_status status = fclose(out) == 0 ? NEPH_OK : neph_fail_memory(diag);
    if (!status && strcmp(path, "-") == 0)
        fwrite(text, 1, size, stdout); /* whether it went out is looked at once, at the end */
    else if (!status)
        status = neph_file_write(path, text, size, diag);
    free(text);
    return status;
}
