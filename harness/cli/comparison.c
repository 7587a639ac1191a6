/* SPDX-License-Identifier: MIT */
#include "harness/cli/comparison.h"

#include "harness/cli/cli.h"
#include "harness/compare/comparison_output.h"
#include "harness/compare/limits.h"
#include "harness/compare/measure.h"
#include "harness/compare/versus.h"
#include "metrics/extractors/extractors.h"

#include <math.h>
#include <string.h>

/* ---- options --------------------------------------------------------------------------------- */

enum { MEASURING, VIEWING, JUDGING, WRITING }; /* groups of the help */

const struct neph_cli_option neph_cli_comparison_options[] = {
    {"metric", 'm', "NAME",
     "An extractor, one of its metrics, or 'all'; may be given several times; `neph metrics` lists "
     "them",
     NEPH_CLI_WORDS, .at = offsetof(struct neph_cli_comparison, metrics)},
    {.name = "set",
     .argument = "EXTRACTOR.KEY=VALUE",
     .help = "A setting of an extractor, such as lag.step_frame=40"},
    {"mask", 0, "NAME|FILE",
     "Only this mask: a name (all, sky, depth_edge, ...; `neph metrics --masks`), or a picture "
     "that is above 0.5 inside",
     NEPH_CLI_WORD, .at = offsetof(struct neph_cli_comparison, mask)},
    {"layer", 0, "NAME",
     "Radiance, depth and masks are the channels NAME.R and so on (Blender: ViewLayer.Combined)",
     NEPH_CLI_WORD, .at = offsetof(struct neph_cli_comparison, layer)},
    {"rings", 0, NULL,
     "Also the masks of rings at depth edges, by distance and side (flicker always takes them, and "
     "shows them with this)",
     NEPH_CLI_FLAG, .at = offsetof(struct neph_cli_comparison, rings)},
    {"second-reference", 0, "WORD",
     "The reference by another seed: takes the reference's own noise out of squared errors; or, "
     "with lag.old=second, the same scene without its step",
     NEPH_CLI_WORD, .at = offsetof(struct neph_cli_comparison, second)},
    {"versus", 0, "WORD",
     "Another test of the same frames: each number's difference, test - other, paired frame by "
     "frame, or tile by tile where a sequence has one number, with intervals and corrected "
     "p-values",
     NEPH_CLI_WORD, .at = offsetof(struct neph_cli_comparison, versus)},
    {"warm-up", 0, "N", "Leave out the first N frames", NEPH_CLI_INTEGER,
     .at = offsetof(struct neph_cli_comparison, warm_up_frames), .otherwise = "0", .minimum = 0,
     .maximum = 1000000},
    {"by-position", 0, NULL,
     "Frames belong together by their place in the sequence, whatever their numbers", NEPH_CLI_FLAG,
     .at = offsetof(struct neph_cli_comparison, by_position)},
    {"fps", 0, "HZ",
     "Frame rate of the display (default: 60; of flicker what the frames say, else 30)",
     NEPH_CLI_REAL, .at = offsetof(struct neph_cli_comparison, frame_rate_hz), .group = VIEWING},
    {"ppd", 0, "N",
     "Pixels per degree of the display (default: 67.02, 0.7 m from a screen 0.7 m and 3840 px "
     "wide; of flicker 60; a desk monitor has 40)",
     NEPH_CLI_REAL, .at = offsetof(struct neph_cli_comparison, pixels_per_degree),
     .group = VIEWING},
    {"exposure", 0, "EV", "Display value = 2^EV times radiance (default: 0)", NEPH_CLI_REAL,
     .at = offsetof(struct neph_cli_comparison, exposure_ev), .group = VIEWING},
    {"white", 0, "CD_PER_M2", "Luminance of the display value 1 (default: 100)", NEPH_CLI_REAL,
     .at = offsetof(struct neph_cli_comparison, white_cd_per_m2), .group = VIEWING},
    {"fail-above", 0, "[QUANTITY:]METRIC[@MASK]=LIMIT",
     "Exit with 1 when |value| is above the limit, such as radiance:rel_rmse@all=0.01 (quantity "
     "and mask as here when left out); may be given several times",
     NEPH_CLI_WORDS, .at = offsetof(struct neph_cli_comparison, above), .group = JUDGING},
    {"fail-below", 0, "[QUANTITY:]METRIC[@MASK]=LIMIT",
     "The same for numbers that should be large: ssim_mean=0.98", NEPH_CLI_WORDS,
     .at = offsetof(struct neph_cli_comparison, below), .group = JUDGING},
    {"frozen-ok", 0, NULL, "Frames that are bit for bit the one before are meant to be so",
     NEPH_CLI_FLAG, .at = offsetof(struct neph_cli_comparison, frozen_is_fine), .group = JUDGING},
    {"negative-ok", 0, NULL,
     "Values below 0 are no reason to stop: a filter with negative lobes made them", NEPH_CLI_FLAG,
     .at = offsetof(struct neph_cli_comparison, negative_is_fine), .group = JUDGING},
    {.name = "json", .group = WRITING},
    {"csv", 0, "FILE", "Results as CSV; '-': on stdout, in place of the table", NEPH_CLI_FILE,
     .at = offsetof(struct neph_cli_comparison, csv), .group = WRITING},
    {"maps", 0, "DIR",
     "Maps as EXR, and as PNG on a fixed scale: DIR/MAP_QUANTITY[_FRAME].exr and .png",
     NEPH_CLI_OUTPUT, .at = offsetof(struct neph_cli_comparison, maps), .group = WRITING},
    {.name = "quiet", .group = WRITING},
    {.name = NULL},
};

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

/* What was given, over what is usual of single frames or of sequences. */
static struct neph_viewing viewing_of(const struct neph_cli_comparison *asked, bool temporal)
{
    struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    if (temporal) {
        viewing.frame_rate_hz = 30.0;
        viewing.pixels_per_degree = 60.0;
    }
    const struct {
        double given, *value;
    } conditions[] = {
        {asked->frame_rate_hz, &viewing.frame_rate_hz},
        {asked->pixels_per_degree, &viewing.pixels_per_degree},
        {asked->exposure_ev, &viewing.exposure_ev},
        {asked->white_cd_per_m2, &viewing.white_cd_per_m2},
    };
    for (size_t i = 0; i < sizeof(conditions) / sizeof(conditions[0]); i++)
        if (!isnan(conditions[i].given))
            *conditions[i].value = conditions[i].given;
    return viewing;
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
                                       const struct neph_cli_words *limits, bool below,
                                       struct neph_diag *diag)
{
    for (int i = 0; i < limits->count; i++) {
        struct neph_limit limit;
        const struct neph_extractor *extractor = NULL;
        const enum neph_status status = neph_limit_parse(limits->list[i], below, &limit, diag);
        if (status)
            return status;
        if (neph_metric_find(limit.metric, &extractor))
            choose(comparison, extractor);
        comparison->detail_masks |= neph_mask_is_detail(limit.mask);
    }
    return NEPH_OK;
}

static enum neph_status check_limits(const struct neph_measurements *measurements,
                                     const struct neph_cli_words *limits, bool below,
                                     struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < limits->count && !status; i++) {
        struct neph_limit limit;
        status = neph_limit_parse(limits->list[i], below, &limit, diag);
        if (!status)
            status = neph_limit_check(measurements, &limit, diag);
    }
    return status;
}

/* ---- all of it ------------------------------------------------------------------------------- */

enum neph_status neph_cli_comparison_prepare(const struct neph_cli_comparison *asked, bool temporal,
                                             struct neph_comparison *comparison,
                                             struct neph_diag *diag)
{
    if (asked->shared.json && asked->csv && strcmp(asked->csv, "-") == 0)
        return neph_fail(diag, NEPH_ERR_USAGE, "--json and --csv - are both for stdout");
    enum neph_status status = NEPH_OK;
    comparison->viewing = viewing_of(asked, temporal);
    comparison->own_frame_rate = temporal && isnan(asked->frame_rate_hz);
    for (int i = 0; i < asked->metrics.count && !status; i++)
        status = choose_word(comparison, asked->metrics.list[i], diag);
    for (int i = 0; i < neph_extractor_count() && asked->metrics.count == 0; i++) {
        const struct neph_extractor *extractor = neph_extractor_at(i);
        if (!extractor->costly && extractor->temporal == temporal)
            choose(comparison, extractor);
    }
    for (int i = 0; i < asked->shared.settings.count && !status; i++)
        status = apply_setting(comparison, asked->shared.settings.list[i], diag);
    if (!status)
        status = choose_limited(comparison, &asked->above, false, diag);
    if (!status)
        status = choose_limited(comparison, &asked->below, true, diag);
    if (!status && asked->second)
        status = neph_sequence_find(1, &asked->second, asked->by_position, &comparison->second,
                                    diag);
    comparison->warm_up_frames = asked->warm_up_frames;
    comparison->mask = wanted_mask(asked);
    if (asked->mask && !is_mask_name(asked->mask))
        comparison->mask_file = asked->mask;
    comparison->detail_masks |= temporal || asked->rings ||
                                (asked->mask && neph_mask_is_detail(asked->mask));
    comparison->layer = asked->layer;
    comparison->maps_directory = asked->maps;
    comparison->frozen_is_fine = asked->frozen_is_fine;
    comparison->by_position = asked->by_position;
    comparison->quiet = asked->shared.quiet;
    comparison->negative_allowed = asked->negative_is_fine ? SIZE_MAX : 0;
    return status;
}

/* ---- which numbers to show ------------------------------------------------------------------- */

static bool is_wanted(const struct neph_measurement *number, const void *context)
{
    const struct neph_cli_comparison *asked = context;
    const char *mask = wanted_mask(asked), *metric = number->metric->name;
    if (mask && strcmp(mask, number->mask) != 0)
        return false;
    const struct neph_extractor *owner = NULL;
    neph_metric_find(metric, &owner);
    bool named = asked->metrics.count == 0;
    for (int i = 0; i < asked->metrics.count; i++) {
        const char *word = asked->metrics.list[i];
        named |= strcmp(word, "all") == 0 || strcmp(word, owner->name) == 0 ||
                 strcmp(word, metric) == 0;
    }
    for (int i = 0; i < asked->shared.settings.count; i++) {
        const char *setting = asked->shared.settings.list[i];
        const size_t length = strlen(owner->name);
        named |= strncmp(setting, owner->name, length) == 0 && setting[length] == '.';
    }
    return named;
}

/* Findings stand on several metrics; those of the wanted mask, and of no mask in particular. */
static bool is_wanted_finding(const struct neph_cli_comparison *asked,
                              const struct neph_finding *finding)
{
    const char *mask = wanted_mask(asked);
    return !mask || strcmp(mask, finding->mask) == 0 || strcmp(finding->name, "half_life") == 0;
}

/* Leave only what was asked for. */
static void select_wanted(const struct neph_cli_comparison *asked, struct neph_compared *compared)
{
    struct neph_findings *findings = &compared->findings;
    int kept = 0;
    neph_measurements_select(&compared->numbers, is_wanted, asked);
    for (int i = 0; i < findings->count; i++)
        if (is_wanted_finding(asked, &findings->list[i]))
            findings->list[kept++] = findings->list[i];
    findings->count = kept;
}

/* ---- the run --------------------------------------------------------------------------------- */

static enum neph_status print_all(const struct neph_cli_comparison *asked,
                                  const struct neph_compared *compared, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (compared->numbers.count == 0 && asked->mask)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "nothing to measure over the mask '%s': the reference has no such pixels, "
                         "or lacks the layer that it is made from",
                         asked->mask);
    const bool csv_on_stdout = asked->csv && strcmp(asked->csv, "-") == 0;
    if (asked->shared.json)
        status = neph_json_print(neph_compared_json(compared), diag);
    else if (!csv_on_stdout)
        neph_comparison_print(compared, asked->rings || asked->mask, asked->metrics.count > 0);
    return asked->csv && !status ? neph_comparison_write_csv(asked->csv, compared, diag) : status;
}

/* Found before anything is measured. */
static enum neph_status find_versus(const struct neph_cli_comparison *asked,
                                    const struct neph_comparison *comparison,
                                    struct neph_sequence *other, struct neph_diag *diag)
{
    if (!asked->versus)
        return NEPH_OK;
    enum neph_status status = neph_sequence_find(1, &asked->versus, asked->by_position, other,
                                                 diag);
    if (!status && other->count != comparison->test.count)
        status = neph_fail(diag, NEPH_ERR_INPUT,
                           "%d frames of the other test, %d of the test: as many are needed",
                           other->count, comparison->test.count);
    if (!status && !asked->by_position)
        status = neph_sequence_check_numbers(&comparison->test, "the test", other, "the other test",
                                             diag);
    return status;
}

/* Compares with the other test, too, and keeps the differences alone. `compared` has only what was
 * asked for: p-values are corrected for these. */
static enum neph_status add_versus(const struct neph_cli_comparison *asked,
                                   const struct neph_comparison *comparison,
                                   const struct neph_sequence *other_test,
                                   struct neph_compared *compared, struct neph_diag *diag)
{
    struct neph_comparison other = *comparison;
    struct neph_compared beside = {0};
    other.test = *other_test;
    other.maps_directory = NULL;
    enum neph_status status = neph_comparison_run(&other, true, &beside, diag);
    if (status == NEPH_ERR_GATE && beside.asked)
        neph_hint(diag, "these are frames of --versus; if they are meant to be frozen, say "
                        "--frozen-ok");
    if (!status) {
        select_wanted(asked, &beside);
        status = neph_versus(&compared->numbers, &beside.numbers, &compared->versus, diag);
        compared->has_versus = !status;
    }
    neph_compared_finish(&beside);
    return status;
}

static bool has_numbers_of(const struct neph_compared *compared,
                           const struct neph_extractor *extractor)
{
    for (int i = 0; i < compared->numbers.count; i++) {
        const struct neph_extractor *owner = NULL;
        neph_metric_find(compared->numbers.list[i].metric->name, &owner);
        if (owner == extractor)
            return true;
    }
    return false;
}

/* What was asked for by name and gave nothing is not passed over. */
static enum neph_status check_taken(const char *word, const struct neph_compared *compared,
                                    struct neph_diag *diag)
{
    const struct neph_extractor *extractor = neph_extractor_find(word);
    if (!extractor)
        neph_metric_find(word, &extractor);
    if (!extractor || has_numbers_of(compared, extractor)) /* "all" is none */
        return NEPH_OK;
    const char *because = "the images have nothing that it is taken of";
    for (int i = 0; i < compared->not_taken_count; i++)
        if (strcmp(compared->not_taken[i].extractor, extractor->name) == 0)
            because = compared->not_taken[i].because;
    return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s was not measured: %s", word, because);
}

/* What was asked for by name is there, and all limits are kept. */
static enum neph_status check_all(const struct neph_cli_comparison *asked,
                                  const struct neph_compared *compared, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (asked->metrics.count == 0 && asked->purpose)
        status = check_taken(asked->purpose, compared, diag);
    for (int i = 0; i < asked->metrics.count && !status; i++)
        status = check_taken(asked->metrics.list[i], compared, diag);
    if (!status)
        status = check_limits(&compared->numbers, &asked->above, false, diag);
    if (!status)
        status = check_limits(&compared->numbers, &asked->below, true, diag);
    return status;
}

/* Limits hold of all numbers, and are spoken of after those that are shown. */
static enum neph_status tell(const struct neph_cli_comparison *asked,
                             const struct neph_comparison *comparison,
                             const struct neph_sequence *other, enum neph_status status,
                             struct neph_compared *compared, struct neph_diag *diag)
{
    struct neph_diag late = {.line = 0};
    const enum neph_status checked = check_all(asked, compared, &late);
    select_wanted(asked, compared);
    if (!status && asked->versus)
        status = add_versus(asked, comparison, other, compared, diag);
    const enum neph_status printed = print_all(asked, compared, status ? NULL : diag);
    status = status ? status : printed;
    if (status || !checked)
        return status;
    *diag = late;
    return checked;
}

enum neph_status neph_cli_comparison_run(const struct neph_cli_comparison *asked,
                                         const struct neph_comparison *comparison,
                                         struct neph_diag *diag)
{
    struct neph_compared compared = {0};
    struct neph_sequence other = {0};
    enum neph_status status = find_versus(asked, comparison, &other, diag);
    if (!status)
        status = neph_comparison_run(comparison, asked->versus, &compared, diag);
    if (compared.asked)
        status = tell(asked, comparison, &other, status, &compared, diag);
    neph_sequence_finish(&other);
    neph_compared_finish(&compared);
    return status;
}
