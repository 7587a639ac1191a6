/* SPDX-License-Identifier: MIT */
#include "harness/cli_comparison.h"

#include "base/files.h"
#include "harness/cli.h"
#include "harness/measure.h"
#include "harness/versus.h"
#include "metrics/pooling.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- options --------------------------------------------------------------------------------- */

enum {
    KEY_JSON = 0x200,
    KEY_CSV,
    KEY_MASK,
    KEY_MAPS,
    KEY_FAIL_ABOVE,
    KEY_FAIL_BELOW,
    KEY_SECOND,
    KEY_RINGS,
    KEY_VERSUS,
    KEY_FROZEN_OK,
    KEY_NEGATIVE_OK,
    KEY_WARM_UP,
    KEY_VIEWING, /* and three more, in the order of `viewings` */
};

static const struct argp_option options[] = {
    {"metric", 'm', "NAME", 0,
     "An extractor, one of its metrics, or 'all'; may be given several times; `neph metrics` lists "
     "them",
     0},
    {"set", 's', "EXTRACTOR.KEY=VALUE", 0, "A setting of an extractor, such as lag.step_frame=40",
     0},
    {"mask", KEY_MASK, "NAME|FILE", 0,
     "Only this mask: a name (all, sky, depth_edge, ...; `neph metrics --masks`), or a picture "
     "that is above 0.5 inside",
     0},
    {"rings", KEY_RINGS, NULL, 0,
     "Also the masks of rings at depth edges, by distance and side (flicker always takes them, and "
     "shows them with this)",
     0},
    {"second-reference", KEY_SECOND, "WORD", 0,
     "The reference by another seed: takes the reference's own noise out of squared errors", 0},
    {"versus", KEY_VERSUS, "WORD", 0,
     "Another test of the same frames: each number's difference, test - other, paired frame by "
     "frame, with intervals and corrected p-values; without these where a sequence has one number",
     0},
    {"warm-up", KEY_WARM_UP, "N", 0, "Leave out the first N frames (default: 0)", 0},
    {"fps", KEY_VIEWING, "HZ", 0, "Frame rate of the display (default: 60)", 1},
    {"ppd", KEY_VIEWING + 1, "N", 0,
     "Pixels per degree of the display (default: 67.02, 0.7 m from a screen 0.7 m and 3840 px "
     "wide; a desk monitor has 40)",
     1},
    {"exposure", KEY_VIEWING + 2, "EV", 0, "Display value = 2^EV times radiance (default: 0)", 1},
    {"white", KEY_VIEWING + 3, "CD_PER_M2", 0, "Luminance of the display value 1 (default: 100)",
     1},
    {"fail-above", KEY_FAIL_ABOVE, "[QUANTITY:]METRIC[@MASK]=LIMIT", 0,
     "Exit with 1 when |value| is above the limit, such as radiance:rel_rmse@all=0.01 (quantity "
     "and mask as here when left out); may be given several times",
     2},
    {"fail-below", KEY_FAIL_BELOW, "[QUANTITY:]METRIC[@MASK]=LIMIT", 0,
     "The same for numbers that should be large: ssim_mean=0.98", 2},
    {"frozen-ok", KEY_FROZEN_OK, NULL, 0,
     "Frames that are bit for bit the one before are meant to be so", 2},
    {"negative-ok", KEY_NEGATIVE_OK, NULL, 0,
     "Values below 0 are no reason to stop: a filter with negative lobes made them", 2},
    {"json", KEY_JSON, NULL, 0, "Results as JSON on stdout", 3},
    {"csv", KEY_CSV, "FILE", 0, "Results as CSV", 3},
    {"maps", KEY_MAPS, "DIR", 0, "Maps as EXR, and as PNG on a fixed scale", 3},
    {"quiet", 'q', NULL, 0, "No progress", 3},
    {0},
};

/* Append to a bounded list of words. */
static void add_word(struct argp_state *state, const char **list, int *count, int most,
                     const char *word)
{
    if (*count == most)
        argp_error(state, "more than %d of '%s' and its like", most, word);
    list[(*count)++] = word;
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct neph_cli_comparison *asked = state->input;
    switch (key) {
    case 'm':
        add_word(state, asked->metrics, &asked->metric_count, NEPH_CHOICES_MAX, argument);
        return 0;
    case 's':
        add_word(state, asked->settings, &asked->setting_count, NEPH_CHOICES_MAX, argument);
        return 0;
    case KEY_FAIL_ABOVE:
    case KEY_FAIL_BELOW:
        if (asked->limit_count == NEPH_CLI_LIMITS_MAX)
            argp_error(state, "more than %d limits", NEPH_CLI_LIMITS_MAX);
        asked->limits[asked->limit_count++] = (struct neph_cli_limit){argument,
                                                                      key == KEY_FAIL_BELOW};
        return 0;
    case KEY_RINGS:
        asked->rings = true;
        return 0;
    case KEY_JSON:
        asked->json = true;
        return 0;
    case KEY_FROZEN_OK:
        asked->frozen_is_fine = true;
        return 0;
    case KEY_NEGATIVE_OK:
        asked->negative_is_fine = true;
        return 0;
    case 'q':
        asked->quiet = true;
        return 0;
    }
    const struct {
        int key;
        const char **word;
    } words[] = {
        {KEY_CSV, &asked->csv},
        {KEY_MASK, &asked->mask},
        {KEY_MAPS, &asked->maps},
        {KEY_SECOND, &asked->second},
        {KEY_VERSUS, &asked->versus},
        {KEY_WARM_UP, &asked->warm_up},
        {KEY_VIEWING, &asked->viewing[0]},
        {KEY_VIEWING + 1, &asked->viewing[1]},
        {KEY_VIEWING + 2, &asked->viewing[2]},
        {KEY_VIEWING + 3, &asked->viewing[3]},
    };
    for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
        if (words[i].key == key) {
            *words[i].word = argument;
            return 0;
        }
    return ARGP_ERR_UNKNOWN;
}

const struct argp neph_cli_comparison_argp = {.options = options, .parser = parse};

/* ---- what to measure ------------------------------------------------------------------------- */

static struct neph_meter_choice *find_choice(struct neph_comparison *comparison,
                                             const struct neph_extractor *extractor)
{
    for (int i = 0; i < comparison->choice_count; i++)
        if (comparison->choices[i].extractor == extractor)
            return &comparison->choices[i];
    return NULL;
}

static void choose(struct neph_comparison *comparison, const struct neph_extractor *extractor)
{
    if (!find_choice(comparison, extractor) && comparison->choice_count < NEPH_CHOICES_MAX)
        comparison->choices[comparison->choice_count++] = (struct neph_meter_choice){
            extractor, neph_options_default(extractor->options)};
}

static enum neph_status choose_word(struct neph_comparison *comparison, const char *word,
                                    struct neph_diag *diag)
{
    const struct neph_extractor *extractor = neph_extractor_find(word);
    if (extractor || neph_metric_find(word, &extractor)) {
        choose(comparison, extractor);
        return NEPH_OK;
    }
    if (strcmp(word, "all") != 0) {
        neph_fail(diag, NEPH_ERR_USAGE, "there is no extractor or metric '%s'", word);
        neph_hint(diag, "`neph metrics` lists them");
        return NEPH_ERR_USAGE;
    }
    for (int i = 0; i < neph_extractor_count(); i++)
        choose(comparison, neph_extractor_at(i));
    return NEPH_OK;
}

static enum neph_status apply_setting(struct neph_comparison *comparison, const char *text,
                                      struct neph_diag *diag)
{
    char name[64], owner[96];
    const char *dot = strchr(text, '.'), *equals = strchr(text, '=');
    if (!dot || !equals || dot > equals || (size_t)(dot - text) >= sizeof(name))
        return neph_fail(diag, NEPH_ERR_USAGE, "setting '%s' is not EXTRACTOR.KEY=VALUE", text);
    snprintf(name, sizeof(name), "%.*s", (int)(dot - text), text);
    const struct neph_extractor *extractor = neph_extractor_find(name);
    if (!extractor)
        return neph_fail(diag, NEPH_ERR_USAGE, "setting '%s': there is no extractor '%s'", text,
                         name);
    choose(comparison, extractor); /* who sets something wants it */
    snprintf(owner, sizeof(owner), "extractor %s", name);
    return neph_options_set(extractor->options, owner, dot + 1,
                            &find_choice(comparison, extractor)->settings, diag);
}

static enum neph_status parse_viewing(const struct neph_cli_comparison *asked,
                                      struct neph_viewing *viewing, struct neph_diag *diag)
{
    *viewing = NEPH_VIEWING_DEFAULTS;
    const struct {
        const char *name;
        double *value;
    } conditions[] = {
        {"--fps", &viewing->frame_rate_hz},
        {"--ppd", &viewing->pixels_per_degree},
        {"--exposure", &viewing->exposure_ev},
        {"--white", &viewing->white_cd_per_m2},
    };
    for (int i = 0; i < 4; i++) {
        char *end = NULL;
        if (!asked->viewing[i])
            continue;
        *conditions[i].value = strtod(asked->viewing[i], &end);
        if (end == asked->viewing[i] || *end)
            return neph_fail(diag, NEPH_ERR_USAGE, "%s '%s' is not a number", conditions[i].name,
                             asked->viewing[i]);
    }
    return NEPH_OK;
}

/* ---- masks ----------------------------------------------------------------------------------- */

/* A name of a mask has neither dot nor slash; the name of a picture has an extension. */
static bool is_mask_name(const char *word)
{
    return !strchr(word, '.') && !strchr(word, '/');
}

/* The mask that was asked for; NULL: all masks. */
static const char *wanted_mask(const struct neph_cli_comparison *asked)
{
    return asked->mask && !is_mask_name(asked->mask) ? "file" : asked->mask;
}

static bool is_detail(const char *mask)
{
    const struct neph_mask_kind *kind = neph_mask_kind_find(mask);
    return kind && kind->is_detail;
}

/* ---- limits ---------------------------------------------------------------------------------- */

struct limit {
    char quantity[32], metric[64], mask[NEPH_IMAGE_NAME_MAX];
    double value;
    bool below;
};

static enum neph_status parse_limit(const struct neph_cli_limit *written, struct limit *limit,
                                    struct neph_diag *diag)
{
    char rest[64], *end;
    const char *text = written->text, *colon = strchr(text, ':');
    *limit = (struct limit){"radiance", "", "all", 0.0, written->below};
    bool fits = !colon || (size_t)(colon - text) < sizeof(limit->quantity);
    if (colon && fits)
        snprintf(limit->quantity, sizeof(limit->quantity), "%.*s", (int)(colon - text), text);
    const char *name = colon ? colon + 1 : text;
    fits &= sscanf(name, "%63[^@=]@%63[^=]=%63s", limit->metric, limit->mask, rest) == 3 ||
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

/* Who limits something wants it measured. */
static enum neph_status choose_limited(struct neph_comparison *comparison,
                                       const struct neph_cli_limit *written, struct neph_diag *diag)
{
    struct limit limit;
    const struct neph_extractor *extractor = NULL;
    enum neph_status status = parse_limit(written, &limit, diag);
    if (!status && neph_metric_find(limit.metric, &extractor))
        choose(comparison, extractor);
    comparison->detail_masks |= !status && is_detail(limit.mask);
    return status;
}

/* ---- all of it ------------------------------------------------------------------------------- */

enum neph_status neph_cli_comparison_prepare(const struct neph_cli_comparison *asked, bool temporal,
                                             struct neph_comparison *comparison,
                                             struct neph_diag *diag)
{
    enum neph_status status = parse_viewing(asked, &comparison->viewing, diag);
    for (int i = 0; i < asked->metric_count && !status; i++)
        status = choose_word(comparison, asked->metrics[i], diag);
    for (int i = 0; i < neph_extractor_count() && asked->metric_count == 0; i++) {
        const struct neph_extractor *extractor = neph_extractor_at(i);
        if (!extractor->costly && extractor->temporal == temporal)
            choose(comparison, extractor);
    }
    for (int i = 0; i < asked->setting_count && !status; i++)
        status = apply_setting(comparison, asked->settings[i], diag);
    for (int i = 0; i < asked->limit_count && !status; i++)
        status = choose_limited(comparison, &asked->limits[i], diag);
    if (!status && asked->warm_up)
        status = neph_cli_parse_int("--warm-up", asked->warm_up, 0, 1000000,
                                    &comparison->warm_up_frames, diag);
    if (!status && asked->second)
        status = neph_sequence_find(1, &asked->second, &comparison->second, diag);
    comparison->mask = wanted_mask(asked);
    if (asked->mask && !is_mask_name(asked->mask))
        comparison->mask_file = asked->mask;
    comparison->detail_masks |= temporal || asked->rings || (asked->mask && is_detail(asked->mask));
    comparison->maps_directory = asked->maps;
    comparison->frozen_is_fine = asked->frozen_is_fine;
    comparison->quiet = asked->quiet;
    comparison->negative_allowed = asked->negative_is_fine ? SIZE_MAX : 0;
    return status;
}

/* ---- which numbers to show ------------------------------------------------------------------- */

static const char *text_of(const json_t *item, const char *key)
{
    const char *text = json_string_value(json_object_get(item, key));
    return text ? text : "";
}

static bool is_wanted(const struct neph_cli_comparison *asked, const json_t *item)
{
    const char *mask = wanted_mask(asked);
    if (mask && strcmp(mask, text_of(item, "mask")) != 0)
        return false;
    const struct neph_extractor *owner = NULL;
    const struct neph_metric *metric = neph_metric_find(text_of(item, "metric"), &owner);
    bool named = asked->metric_count == 0;
    for (int i = 0; i < asked->metric_count; i++)
        named |= strcmp(asked->metrics[i], "all") == 0 ||
                 strcmp(asked->metrics[i], owner->name) == 0 ||
                 strcmp(asked->metrics[i], metric->name) == 0;
    for (int i = 0; i < asked->setting_count; i++) {
        const size_t length = strlen(owner->name);
        named |= strncmp(asked->settings[i], owner->name, length) == 0 &&
                 asked->settings[i][length] == '.';
    }
    return named;
}

/* Findings stand on several metrics; those of the wanted mask, and of no mask in particular. */
static bool is_wanted_finding(const struct neph_cli_comparison *asked, const json_t *item)
{
    const char *mask = wanted_mask(asked);
    return !mask || strcmp(mask, text_of(item, "mask")) == 0 ||
           strcmp(text_of(item, "finding"), "half_life") == 0;
}

typedef bool wanted_function(const struct neph_cli_comparison *asked, const json_t *item);

static json_t *wanted_rows(const struct neph_cli_comparison *asked, const json_t *list,
                           wanted_function *wanted)
{
    json_t *kept = json_array();
    for (size_t i = 0; i < json_array_size(list); i++)
        if (wanted(asked, json_array_get(list, i)))
            json_array_append(kept, json_array_get(list, i));
    return kept;
}

static void keep_wanted_rows(const struct neph_cli_comparison *asked, json_t *document,
                             const char *key, wanted_function *wanted)
{
    const json_t *list = json_object_get(document, key);
    if (list)
        json_object_set_new(document, key, wanted_rows(asked, list, wanted));
}

/* The document with only what was asked for. */
static const json_t *select_wanted(const struct neph_cli_comparison *asked, json_t *document)
{
    keep_wanted_rows(asked, document, "measurements", is_wanted);
    keep_wanted_rows(asked, document, "findings", is_wanted_finding);
    return json_object_get(document, "measurements");
}

/* ---- output ---------------------------------------------------------------------------------- */

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
    else if (strcmp(text_of(item, "interval_kind"), "deterministic") == 0)
        snprintf(bounds, sizeof(bounds), "deterministic");
    if (frame)
        snprintf(which, sizeof(which), "%lld", (long long)json_integer_value(frame));
    if (with_frame)
        printf("%-6s", which);
    printf("%-14s %-13s %-22s %14s  %-22s %8lld  %s\n", text_of(item, "quantity"),
           text_of(item, "mask"), text_of(item, "metric"), number, bounds,
           (long long)json_integer_value(json_object_get(item, "pixel_count")),
           json_is_number(value) ? text_of(item, "unit") : text_of(item, "undefined_because"));
}

static void print_versus(const json_t *list, bool rings)
{
    if (json_array_size(list) > 0)
        printf("%-14s %-13s %-22s %14s  %-22s %9s %9s\n", "quantity", "mask", "test - other",
               "difference", "95 % interval", "p (Holm)", "p (sign)");
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *item = json_array_get(list, i);
        const json_t *interval = json_object_get(item, "interval");
        char bounds[48] = "-";
        if (!rings && is_detail(text_of(item, "mask")))
            continue;
        if (json_is_array(interval))
            snprintf(bounds, sizeof(bounds), "%.2e..%.2e",
                     json_number_value(json_array_get(interval, 0)),
                     json_number_value(json_array_get(interval, 1)));
        printf("%-14s %-13s %-22s %14.6e  %-22s ", text_of(item, "quantity"), text_of(item, "mask"),
               text_of(item, "metric"), json_number_value(json_object_get(item, "difference")),
               bounds);
        if (json_is_number(json_object_get(item, "p")))
            printf("%9.2g %9.2g\n", json_number_value(json_object_get(item, "p_holm")),
                   json_number_value(json_object_get(item, "p_sign")));
        else
            printf("%9s %9s\n", "-", "-");
    }
}

static void print_findings(const json_t *list, bool rings)
{
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *item = json_array_get(list, i);
        if (rings || !is_detail(text_of(item, "mask")))
            printf("%s of %s over '%s': %s: %s\n", text_of(item, "finding"),
                   text_of(item, "quantity"), text_of(item, "mask"), text_of(item, "verdict"),
                   text_of(item, "text"));
    }
}

/* Of a sequence the table holds what is said of all its frames, if there is such a thing. Of a
 * single frame nothing is left out: metrics of sequences say no more than that they have none. */
static void print_table(const json_t *document, bool rings)
{
    const json_t *list = json_object_get(document, "measurements");
    const bool is_sequence = json_integer_value(json_object_get(document, "frames")) > 1;
    bool has_overall = false;
    for (size_t i = 0; i < json_array_size(list) && is_sequence; i++)
        has_overall |= !json_object_get(json_array_get(list, i), "frame");
    const bool with_frame = !has_overall && is_sequence;
    printf("%s%-14s %-13s %-22s %14s  %-22s %8s  %s\n", with_frame ? "frame " : "", "quantity",
           "mask", "metric", "value", "95 % interval", "pixels", "unit");
    for (size_t i = 0; i < json_array_size(list); i++)
        if ((!has_overall || !json_object_get(json_array_get(list, i), "frame")) &&
            (rings || !is_detail(text_of(json_array_get(list, i), "mask"))))
            print_line(json_array_get(list, i), with_frame);
    print_versus(json_object_get(document, "versus"), rings);
    print_findings(json_object_get(document, "findings"), rings);
    const json_t *missing = json_object_get(document, "not_taken");
    for (size_t i = 0; i < json_array_size(missing); i++) {
        const json_t *item = json_array_get(missing, i);
        printf("not taken: %s of %s: %s\n", text_of(item, "extractor"), text_of(item, "quantity"),
               text_of(item, "because"));
    }
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
            csv_text(out, text_of(item, words[w]));
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
        csv_text(out, text_of(item, "undefined_because"));
        fputc('\n', out);
    }
}

static enum neph_status write_csv(const char *path, const json_t *list, struct neph_diag *diag)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return neph_fail_memory(diag);
    write_csv_lines(out, list);
    enum neph_status status = fclose(out) == 0 ? neph_file_write(path, text, size, diag)
                                               : neph_fail_memory(diag);
    free(text);
    return status;
}

/* ---- are the limits kept? -------------------------------------------------------------------- */

static bool matches(const json_t *item, const struct limit *limit)
{
    return strcmp(text_of(item, "quantity"), limit->quantity) == 0 &&
           strcmp(text_of(item, "metric"), limit->metric) == 0 &&
           strcmp(text_of(item, "mask"), limit->mask) == 0;
}

/* " in frame N", or nothing for a number of all frames. */
static void name_frame(const json_t *item, char *text, size_t size)
{
    const json_t *frame = json_object_get(item, "frame");
    text[0] = '\0';
    if (frame)
        snprintf(text, size, " in frame %lld", (long long)json_integer_value(frame));
}

/* A PSNR of equal images is no number, and keeps every limit. */
static bool is_without_error(const json_t *item)
{
    return strcmp(text_of(item, "undefined_because"), neph_pool_no_error) == 0;
}

/* How far a value is beyond its limit; <= 0: it is not. */
static double excess(const json_t *item, const struct limit *limit)
{
    const double size = fabs(json_number_value(json_object_get(item, "value")));
    return limit->below ? limit->value - size : size - limit->value;
}

/* Times of the lag test stop counting at the end of the sequence: where more pixels than `share`
 * are on their way still, the number is a lower bound, and below no limit. */
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

static bool is_lower_bound(const json_t *list, const struct limit *limit)
{
    for (size_t b = 0; b < sizeof(bounded_times) / sizeof(bounded_times[0]); b++) {
        const struct bounded_time *time = &bounded_times[b];
        if (strcmp(time->metric, limit->metric) != 0)
            continue;
        const json_t *share = neph_measurement_find(list, limit->quantity, time->unsettled,
                                                    limit->mask);
        return json_number_value(json_object_get(share, "value")) > time->share;
    }
    return false;
}

/* Every number of that name is held to the limit, of all frames and of each; the worst is named. */
static enum neph_status check_limit(const json_t *list, const struct limit *limit,
                                    struct neph_diag *diag)
{
    const json_t *worst = NULL;
    bool without_error = false;
    int beyond_count = 0;
    char where[32];
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *item = json_array_get(list, i);
        if (!matches(item, limit))
            continue;
        if (is_without_error(item)) {
            without_error = true;
            continue;
        }
        name_frame(item, where, sizeof(where));
        if (!json_is_number(json_object_get(item, "value")))
            return neph_fail(diag, NEPH_ERR_GATE, "%s of %s over '%s'%s is not defined: %s",
                             limit->metric, limit->quantity, limit->mask, where,
                             text_of(item, "undefined_because"));
        beyond_count += excess(item, limit) > 0.0;
        if (!worst || excess(item, limit) > excess(worst, limit))
            worst = item;
    }
    if (!worst && !without_error) {
        neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s of %s over '%s' was not measured of these images",
                  limit->metric, limit->quantity, limit->mask);
        neph_hint(diag, "the images lack this quantity, the reference this mask, or see 'not "
                        "taken' above");
        return NEPH_ERR_UNSUPPORTED;
    }
    if (beyond_count == 0 && worst && !limit->below && is_lower_bound(list, limit))
        return neph_fail(diag, NEPH_ERR_GATE,
                         "%s of %s over '%s' is at least %.6g: the sequence ends too early to hold "
                         "it to the limit %g",
                         limit->metric, limit->quantity, limit->mask,
                         json_number_value(json_object_get(worst, "value")), limit->value);
    if (beyond_count == 0)
        return NEPH_OK;
    name_frame(worst, where, sizeof(where));
    neph_fail(diag, NEPH_ERR_GATE, "%s of %s over '%s' is %.6g%s, %s the limit %g", limit->metric,
              limit->quantity, limit->mask, json_number_value(json_object_get(worst, "value")),
              where, limit->below ? "below" : "above", limit->value);
    if (beyond_count > 1)
        neph_hint(diag, "the worst of %d such numbers", beyond_count);
    return NEPH_ERR_GATE;
}

/* ---- the run --------------------------------------------------------------------------------- */

static enum neph_status print_all(const struct neph_cli_comparison *asked, json_t *document,
                                  struct neph_diag *diag)
{
    const json_t *list = select_wanted(asked, document);
    if (json_array_size(list) == 0 && asked->mask)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "nothing to measure over the mask '%s': the reference has no such pixels, "
                         "or lacks the layer that it is made from",
                         asked->mask);
    if (asked->json)
        neph_cli_print_json(json_incref(document));
    else
        print_table(document, asked->rings || asked->mask);
    return asked->csv ? write_csv(asked->csv, list, diag) : NEPH_OK;
}

/* Found before anything is measured. */
static enum neph_status find_versus(const struct neph_cli_comparison *asked,
                                    const struct neph_comparison *comparison,
                                    struct neph_sequence *other, struct neph_diag *diag)
{
    if (!asked->versus)
        return NEPH_OK;
    enum neph_status status = neph_sequence_find(1, &asked->versus, other, diag);
    if (!status && other->count != comparison->test.count)
        status = neph_fail(diag, NEPH_ERR_INPUT,
                           "%d frames of the other test, %d of the test: as many are needed",
                           other->count, comparison->test.count);
    return status;
}

/* Differences of what was asked for alone: p-values are corrected for these. */
static json_t *subtract(const struct neph_cli_comparison *asked, const json_t *document,
                        const json_t *other_document, struct neph_diag *diag)
{
    json_t *numbers = wanted_rows(asked, json_object_get(document, "measurements"), is_wanted);
    json_t *others = wanted_rows(asked, json_object_get(other_document, "measurements"), is_wanted);
    json_t *differences = neph_versus(numbers, others, diag);
    json_decref(numbers);
    json_decref(others);
    return differences;
}

/* The same again with the other test; its numbers stay out of sight, the differences are kept. */
static enum neph_status add_versus(const struct neph_cli_comparison *asked,
                                   const struct neph_comparison *comparison,
                                   const struct neph_sequence *other_test, json_t *document,
                                   struct neph_diag *diag)
{
    struct neph_comparison other = *comparison;
    json_t *other_document = NULL, *differences = NULL;
    other.test = *other_test;
    other.maps_directory = NULL;
    enum neph_status status = neph_comparison_run(&other, &other_document, diag);
    if (status == NEPH_ERR_GATE && other_document)
        neph_hint(diag, "these are frames of --versus; if they are meant to be frozen, say "
                        "--frozen-ok");
    if (!status) {
        differences = subtract(asked, document, other_document, diag);
        status = differences ? NEPH_OK : NEPH_ERR_MEMORY;
    }
    if (differences)
        json_object_set_new(document, "versus", differences);
    json_decref(other_document);
    return status;
}

enum neph_status neph_cli_comparison_run(const struct neph_cli_comparison *asked,
                                         const struct neph_comparison *comparison,
                                         struct neph_diag *diag)
{
    struct limit limits[NEPH_CLI_LIMITS_MAX];
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < asked->limit_count && !status; i++)
        status = parse_limit(&asked->limits[i], &limits[i], diag);
    if (status)
        return status;
    json_t *document = NULL;
    struct neph_sequence other = {0};
    status = find_versus(asked, comparison, &other, diag);
    if (!status)
        status = neph_comparison_run(comparison, &document, diag);
    if (!status && asked->versus)
        status = add_versus(asked, comparison, &other, document, diag);
    neph_sequence_finish(&other);
    if (!document)
        return status;
    json_t *all = json_copy(json_object_get(document, "measurements"));
    const enum neph_status printed = print_all(asked, document, status ? NULL : diag);
    status = status ? status : printed;
    for (int i = 0; i < asked->limit_count && !status; i++)
        status = check_limit(all, &limits[i], diag);
    json_decref(all);
    json_decref(document);
    return status;
}
