/* SPDX-License-Identifier: MIT */
#include "harness/cli/comparison.h"

#include "harness/cli/cli.h"
#include "harness/compare/comparison_output.h"
#include "harness/compare/limits.h"
#include "harness/compare/measure.h"
#include "harness/compare/versus.h"
#include "metrics/extractors/extractors.h"

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
    KEY_LAYER,
    KEY_RINGS,
    KEY_VERSUS,
    KEY_FROZEN_OK,
    KEY_NEGATIVE_OK,
    KEY_WARM_UP,
    KEY_BY_POSITION,
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
    {"layer", KEY_LAYER, "NAME", 0,
     "Radiance, depth and masks are the channels NAME.R and so on (Blender: ViewLayer.Combined)",
     0},
    {"rings", KEY_RINGS, NULL, 0,
     "Also the masks of rings at depth edges, by distance and side (flicker always takes them, and "
     "shows them with this)",
     0},
    {"second-reference", KEY_SECOND, "WORD", 0,
     "The reference by another seed: takes the reference's own noise out of squared errors; or, "
     "with lag.old=second, the same scene without its step",
     0},
    {"versus", KEY_VERSUS, "WORD", 0,
     "Another test of the same frames: each number's difference, test - other, paired frame by "
     "frame, or tile by tile where a sequence has one number, with intervals and corrected "
     "p-values",
     0},
    {"warm-up", KEY_WARM_UP, "N", 0, "Leave out the first N frames (default: 0)", 0},
    {"by-position", KEY_BY_POSITION, NULL, 0,
     "Frames belong together by their place in the sequence, whatever their numbers", 0},
    {"fps", KEY_VIEWING, "HZ", 0,
     "Frame rate of the display (default: 60; of flicker what the frames say, else 30)", 1},
    {"ppd", KEY_VIEWING + 1, "N", 0,
     "Pixels per degree of the display (default: 67.02, 0.7 m from a screen 0.7 m and 3840 px "
     "wide; of flicker 60; a desk monitor has 40)",
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
    {"csv", KEY_CSV, "FILE", 0, "Results as CSV; '-': on stdout, in place of the table", 3},
    {"maps", KEY_MAPS, "DIR", 0,
     "Maps as EXR, and as PNG on a fixed scale: DIR/MAP_QUANTITY[_FRAME].exr and .png", 3},
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
    case KEY_BY_POSITION:
        asked->by_position = true;
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
    if (key == KEY_CSV || key == KEY_MAPS)
        neph_cli_output(state, key == KEY_CSV ? "--csv" : "--maps", argument);
    const struct {
        int key;
        const char **word;
    } words[] = {
        {KEY_CSV, &asked->csv},
        {KEY_LAYER, &asked->layer},
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

static enum neph_status parse_viewing(const struct neph_cli_comparison *asked, bool temporal,
                                      struct neph_viewing *viewing, struct neph_diag *diag)
{
    *viewing = NEPH_VIEWING_DEFAULTS;
    if (temporal) {
        viewing->frame_rate_hz = 30.0;
        viewing->pixels_per_degree = 60.0;
    }
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

/* ---- limits ---------------------------------------------------------------------------------- */

/* Who limits something wants it measured. */
static enum neph_status choose_limited(struct neph_comparison *comparison,
                                       const struct neph_cli_limit *written, struct neph_diag *diag)
{
    struct neph_limit limit;
    const struct neph_extractor *extractor = NULL;
    enum neph_status status = neph_limit_parse(written->text, written->below, &limit, diag);
    if (!status && neph_metric_find(limit.metric, &extractor))
        choose(comparison, extractor);
    comparison->detail_masks |= !status && neph_mask_is_detail(limit.mask);
    return status;
}

/* ---- all of it ------------------------------------------------------------------------------- */

enum neph_status neph_cli_comparison_prepare(const struct neph_cli_comparison *asked, bool temporal,
                                             struct neph_comparison *comparison,
                                             struct neph_diag *diag)
{
    if (asked->json && asked->csv && strcmp(asked->csv, "-") == 0)
        return neph_fail(diag, NEPH_ERR_USAGE, "--json and --csv - are both for stdout");
    enum neph_status status = parse_viewing(asked, temporal, &comparison->viewing, diag);
    comparison->own_frame_rate = temporal && !asked->viewing[0];
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
    comparison->detail_masks |= temporal || asked->rings ||
                                (asked->mask && neph_mask_is_detail(asked->mask));
    comparison->layer = asked->layer;
    comparison->maps_directory = asked->maps;
    comparison->frozen_is_fine = asked->frozen_is_fine;
    comparison->by_position = asked->by_position;
    comparison->quiet = asked->quiet;
    comparison->negative_allowed = asked->negative_is_fine ? SIZE_MAX : 0;
    return status;
}

/* ---- which numbers to show ------------------------------------------------------------------- */

static bool is_wanted(const struct neph_cli_comparison *asked, const json_t *item)
{
    const char *mask = wanted_mask(asked);
    if (mask && strcmp(mask, neph_json_text(item, "mask")) != 0)
        return false;
    const struct neph_extractor *owner = NULL;
    const struct neph_metric *metric = neph_metric_find(neph_json_text(item, "metric"), &owner);
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
    return !mask || strcmp(mask, neph_json_text(item, "mask")) == 0 ||
           strcmp(neph_json_text(item, "finding"), "half_life") == 0;
}

typedef bool wanted_function(const struct neph_cli_comparison *asked, const json_t *item);

static json_t *wanted_rows(const struct neph_cli_comparison *asked, const json_t *list,
                           wanted_function *wanted)
{
    json_t *kept = json_array();
    for (size_t i = 0; i < json_array_size(list); i++)
        if (wanted(asked, json_array_get(list, i)))
            neph_json_add(&kept, json_incref(json_array_get(list, i)));
    return kept;
}

static enum neph_status keep_wanted_rows(const struct neph_cli_comparison *asked, json_t *document,
                                         const char *key, wanted_function *wanted,
                                         struct neph_diag *diag)
{
    const json_t *list = json_object_get(document, key);
    return neph_json_put(document, key, wanted_rows(asked, list, wanted), diag);
}

/* The document with only what was asked for. */
static enum neph_status select_wanted(const struct neph_cli_comparison *asked, json_t *document,
                                      struct neph_diag *diag)
{
    enum neph_status status = keep_wanted_rows(asked, document, "measurements", is_wanted, diag);
    if (!status)
        status = keep_wanted_rows(asked, document, "findings", is_wanted_finding, diag);
    return status;
}

/* ---- the run --------------------------------------------------------------------------------- */

static enum neph_status print_all(const struct neph_cli_comparison *asked, json_t *document,
                                  struct neph_diag *diag)
{
    enum neph_status status = select_wanted(asked, document, diag);
    if (status)
        return status;
    const json_t *list = json_object_get(document, "measurements");
    if (json_array_size(list) == 0 && asked->mask)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "nothing to measure over the mask '%s': the reference has no such pixels, "
                         "or lacks the layer that it is made from",
                         asked->mask);
    const bool csv_on_stdout = asked->csv && strcmp(asked->csv, "-") == 0;
    if (asked->json)
        status = neph_cli_print_json(json_incref(document), diag);
    else if (!csv_on_stdout)
        neph_comparison_print(document, asked->rings || asked->mask, asked->metric_count > 0);
    return asked->csv && !status ? neph_comparison_write_csv(asked->csv, list, diag) : status;
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
    if (!status && !asked->by_position)
        status = neph_sequence_check_numbers(&comparison->test, "the test", other, "the other test",
                                             diag);
    return status;
}

/* Differences of what was asked for alone: p-values are corrected for these. */
static json_t *subtract(const struct neph_cli_comparison *asked, const json_t *document,
                        const struct neph_drawn *drawn, const json_t *other_document,
                        const struct neph_drawn *other_drawn, struct neph_diag *diag)
{
    json_t *numbers = wanted_rows(asked, json_object_get(document, "measurements"), is_wanted);
    json_t *others = wanted_rows(asked, json_object_get(other_document, "measurements"), is_wanted);
    json_t *differences = neph_versus(&(struct neph_versus_side){numbers, drawn},
                                      &(struct neph_versus_side){others, other_drawn}, diag);
    json_decref(numbers);
    json_decref(others);
    return differences;
}

/* The same again with the other test; its numbers stay out of sight, the differences are kept. */
static enum neph_status add_versus(const struct neph_cli_comparison *asked,
                                   const struct neph_comparison *comparison,
                                   const struct neph_sequence *other_test, json_t *document,
                                   const struct neph_drawn *drawn, struct neph_diag *diag)
{
    struct neph_comparison other = *comparison;
    struct neph_drawn other_drawn = {0};
    json_t *other_document = NULL, *differences = NULL;
    other.test = *other_test;
    other.maps_directory = NULL;
    enum neph_status status = neph_comparison_run(&other, &other_document, &other_drawn, diag);
    if (status == NEPH_ERR_GATE && other_document)
        neph_hint(diag, "these are frames of --versus; if they are meant to be frozen, say "
                        "--frozen-ok");
    if (!status) {
        differences = subtract(asked, document, drawn, other_document, &other_drawn, diag);
        status = differences ? NEPH_OK : NEPH_ERR_MEMORY;
    }
    if (differences)
        status = neph_json_put(document, "versus", differences, diag);
    json_decref(other_document);
    neph_measurements_destroy(other_drawn.list, other_drawn.count);
    return status;
}

static bool has_numbers_of(const json_t *measurements, const struct neph_extractor *extractor)
{
    for (size_t i = 0; i < json_array_size(measurements); i++) {
        const struct neph_extractor *owner = NULL;
        neph_metric_find(neph_json_text(json_array_get(measurements, i), "metric"), &owner);
        if (owner == extractor)
            return true;
    }
    return false;
}

/* What was asked for by name and gave nothing is not passed over. */
static enum neph_status check_taken(const char *word, const json_t *measurements,
                                    const json_t *not_taken, struct neph_diag *diag)
{
    const struct neph_extractor *extractor = neph_extractor_find(word);
    if (!extractor)
        neph_metric_find(word, &extractor);
    if (!extractor || has_numbers_of(measurements, extractor)) /* "all" is none */
        return NEPH_OK;
    const char *because = "the images have nothing that it is taken of";
    for (size_t i = 0; i < json_array_size(not_taken); i++)
        if (strcmp(neph_json_text(json_array_get(not_taken, i), "extractor"), extractor->name) == 0)
            because = neph_json_text(json_array_get(not_taken, i), "because");
    return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s was not measured: %s", word, because);
}

static enum neph_status check_all_taken(const struct neph_cli_comparison *asked,
                                        const json_t *measurements, const json_t *not_taken,
                                        struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (asked->metric_count == 0 && asked->purpose)
        status = check_taken(asked->purpose, measurements, not_taken, diag);
    for (int i = 0; i < asked->metric_count && !status; i++)
        status = check_taken(asked->metrics[i], measurements, not_taken, diag);
    return status;
}

enum neph_status neph_cli_comparison_run(const struct neph_cli_comparison *asked,
                                         const struct neph_comparison *comparison,
                                         struct neph_diag *diag)
{
    struct neph_limit limits[NEPH_CLI_LIMITS_MAX];
    enum neph_status status = asked->maps ? neph_cli_check_output("--maps", asked->maps, diag)
                                          : NEPH_OK;
    for (int i = 0; i < asked->limit_count && !status; i++)
        status = neph_limit_parse(asked->limits[i].text, asked->limits[i].below, &limits[i], diag);
    if (status)
        return status;
    json_t *document = NULL;
    struct neph_sequence other = {0};
    struct neph_drawn drawn = {0};
    status = find_versus(asked, comparison, &other, diag);
    if (!status)
        status = neph_comparison_run(comparison, &document, asked->versus ? &drawn : NULL, diag);
    if (!status && asked->versus)
        status = add_versus(asked, comparison, &other, document, &drawn, diag);
    neph_measurements_destroy(drawn.list, drawn.count);
    neph_sequence_finish(&other);
    if (!document)
        return status;
    json_t *all = json_copy(json_object_get(document, "measurements"));
    const enum neph_status printed = print_all(asked, document, status ? NULL : diag);
    status = status ? status : printed;
    if (!status)
        status = check_all_taken(asked, all, json_object_get(document, "not_taken"), diag);
    for (int i = 0; i < asked->limit_count && !status; i++)
        status = neph_limit_check(all, &limits[i], diag);
    json_decref(all);
    json_decref(document);
    return status;
}
