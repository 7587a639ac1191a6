/* SPDX-License-Identifier: MIT
 *
 * `neph compare REFERENCE TEST`: error of frames, each by itself; and
 * `neph flicker --reference REFERENCE... TEST...`: how a sequence moves where it should not.
 */
#include "harness/cli/cli.h"

#include "base/arena.h"
#include "base/text.h"
#include "harness/compare/comparison.h"
#include "harness/compare/limits.h"
#include "harness/compare/verdict.h"
#include "harness/old_options.h"
#include "metrics/extractors/extractors.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- options --------------------------------------------------------------------------------- */

/* The shared settings are of extractors. */
struct request {
    struct neph_cli_shared shared;
    bool temporal;                    /* `neph flicker` */
    struct neph_cli_words references; /* of `neph flicker` */
    struct neph_cli_list metrics;
    struct neph_cli_words above, below; /* limits */
    const char *mask, *csv, *maps, *layer;
    const char *second; /* words of the second reference */
    const char *versus; /* words of the other test */
    double frame_rate_hz, pixels_per_degree, exposure_ev, white_cd_per_m2; /* NaN: as usual */
    int warm_up_frames;
    bool rings, by_position, frozen_is_fine, negative_is_fine, all;
};

enum { MEASURING, VIEWING, JUDGING, WRITING }; /* groups of the help */

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"metric", 'm', "NAME[,NAME]",
     "Extractors, some of their metrics, or 'all'; `neph metrics` lists them", NEPH_CLI_NAMES,
     AT(metrics)},
    {.name = "set",
     .argument = "EXTRACTOR:KEY=VALUE",
     .help = "A setting of an extractor, such as lag:step_frame=40; may be given several times"},
    {"mask", 0, "NAME|FILE",
     "Only this mask: a name (all, sky, depth_edge, ...; `neph metrics --masks`), or a picture "
     "that is above 0.5 inside",
     NEPH_CLI_WORD, AT(mask)},
    {"layer", .kind = NEPH_CLI_WORD, AT(layer)},
    {"rings", 0, NULL,
     "Also the masks of rings at depth edges, by distance and side (flicker always takes them, and "
     "shows them with this)",
     NEPH_CLI_FLAG, AT(rings)},
    {"second-reference", 0, "FILES",
     "The reference by another seed: takes the reference's own noise out of squared errors; or, "
     "with lag:old=second, the same scene without its step",
     NEPH_CLI_WORD, AT(second)},
    {"versus", 0, "FILES",
     "Another test of the same frames: each number's difference, test - other, paired frame by "
     "frame, or tile by tile where a sequence has one number, with intervals and corrected "
     "p-values",
     NEPH_CLI_WORD, AT(versus)},
    {"warm-up", 0, "N", "Leave out the first N frames", NEPH_CLI_INTEGER, AT(warm_up_frames), "0",
     0, 1000000},
    {"by-position", 0, NULL,
     "Frames belong together by their place in the sequence, whatever their numbers", NEPH_CLI_FLAG,
     AT(by_position)},
    {"fps", .kind = NEPH_CLI_REAL, AT(frame_rate_hz), .group = VIEWING},
    {"ppd", .kind = NEPH_CLI_REAL, AT(pixels_per_degree), .group = VIEWING},
    {"exposure", 0, NULL, "Display value = 2^EV times radiance (default: 0)", NEPH_CLI_REAL,
     AT(exposure_ev), .group = VIEWING},
    {"white", .kind = NEPH_CLI_REAL, AT(white_cd_per_m2), .group = VIEWING},
    {"fail-above", 0, "[QUANTITY:]METRIC[@MASK]=LIMIT",
     "Exit with 1 when |value| is above the limit, such as radiance:rel_rmse@all=0.01 (quantity "
     "and mask as here when left out); may be given several times",
     NEPH_CLI_WORDS, AT(above), .group = JUDGING},
    {"fail-below", 0, "[QUANTITY:]METRIC[@MASK]=LIMIT",
     "The same for numbers that should be large: ssim_mean=0.98", NEPH_CLI_WORDS, AT(below),
     .group = JUDGING},
    {"frozen-ok", 0, NULL, "Frames that are bit for bit the one before are meant to be so",
     NEPH_CLI_FLAG, AT(frozen_is_fine), .group = JUDGING},
    {"negative-ok", 0, NULL,
     "Values below 0 are no reason to stop: a filter with negative lobes made them", NEPH_CLI_FLAG,
     AT(negative_is_fine), .group = JUDGING},
    {"all", 0, NULL, "The table of all numbers and findings in place of the ten lines",
     NEPH_CLI_FLAG, AT(all), .group = WRITING},
    {.name = "json", .group = WRITING},
    {"csv", 0, "FILE", "Results as CSV; '-': on stdout, in place of the table", NEPH_CLI_FILE,
     AT(csv), .group = WRITING},
    {"maps", 0, "DIR",
     "Maps as EXR, and as PNG on a fixed scale: DIR/MAP_QUANTITY[_FRAME].exr and .png",
     NEPH_CLI_OUTPUT, AT(maps), .group = WRITING},
    {"quiet", 'q', NULL, "No progress, and of the answer only its first line", NEPH_CLI_FLAG,
     .at = offsetof(struct request, shared) + offsetof(struct neph_cli_shared, quiet),
     .group = WRITING},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_option flicker_options[] = {
    {"reference", 0, NULL,
     "The reference: one frame, or as many as the test has; may be given several times",
     NEPH_CLI_WORDS, .at = offsetof(struct request, references)},
    {.name = NULL},
};

static const struct neph_cli_operands compare_operands = {
    .shown = "REFERENCE TEST",
    .minimum = 2,
    .maximum = 2,
    .missing = "two images or sequences are needed: REFERENCE TEST",
    .surplus = "a reference and a test (quote patterns)",
};

static const struct neph_cli_operands flicker_operands = {
    .shown = "--reference REFERENCE... TEST..."};

static void check_flicker(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    if (request->references.count == 0 || request->shared.operand_count == 0)
        argp_error(state, "both are needed: --reference REFERENCE and TEST");
}

static const struct neph_cli_syntax compare_syntax = {
    .options = options,
    .operands = &compare_operands,
    .doc =
        "Measure the error of TEST against REFERENCE: EXR frames on linear data, or PNG pictures.\v"
        "Each is " NEPH_SEQUENCE_HELP ". Values that are not finite, or negative, are an error "
        "before anything else. The sign is test - reference. PNG pictures are decoded from sRGB. "
        "Frames are files: pipes, and so <(COMMAND) of a shell, are refused.\n"
        "\n"
        "Examples:\n"
        "  neph compare exact.exr march.exr\n"
        "  neph compare exact.exr march.exr --json --mask depth_edge\n"
        "  neph compare old.png new.png --metric flip --maps out --fail-above flip_mean=0.05\n"
        "  neph compare reference.exr 'night/frame.*.exr' --csv errors.csv",
};

static const struct neph_cli_syntax flicker_syntax = {
    .options = flicker_options,
    .more = options,
    .check = check_flicker,
    .operands = &flicker_operands,
    .doc =
        "Measure the flicker of a sequence: amplitude at the periods of a four-frame cycle, noise, "
        "visibility at the frame rate of the display, change that the reference does not have, "
        "and lag: half-life and ghosts (with a step or a cut in the reference), gain and delay "
        "(with "
        "light that goes up and down), ghosts behind moving edges (with motion vectors).\v"
        "Each is " NEPH_SEQUENCE_HELP ". Frames are counted from the first after --warm-up; only "
        "whole cycles of four are measured, and 128 frames make good intervals. Flicker without "
        "the lag beside it says little: a picture that never changes does not flicker; `neph "
        "scenes "
        "NAME --variant sun_step` makes scenes to measure it with. "
        "Exit code 1 when frames are frozen, 2 when they are too few.\n\n"
        "Examples:\n"
        "  neph flicker --reference still.exr 'taa/frame.*.exr' --warm-up 44\n"
        "  neph flicker --reference 'full/*.exr' 'fast/*.exr' --mask depth_edge --maps out\n"
        "  neph flicker --reference lights/ taa/ -s lag:step_frame=16 --metric lag\n"
        "  neph flicker --reference sines/ taa/ --warm-up 64 -s follow:period_1=32 -m follow\n"
        "  neph flicker --reference ref.png 'game/*.png' --fps 30 --fail-above "
        "a4_p95@all=0.0157",
};

/* ---- what to measure ------------------------------------------------------------------------- */

/* The extractor of that name, or of a metric of that name; NULL: there is none. */
static const struct neph_extractor *find_extractor(const char *word)
{
    const struct neph_extractor *extractor = neph_extractor_find(word);
    if (!extractor)
        neph_metric_find(word, &extractor);
    return extractor;
}

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
    const struct neph_extractor *extractor = find_extractor(word);
    if (extractor) {
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

/* Settings were written EXTRACTOR.KEY=VALUE. */
static void warn_of_dot(const char *extractor, const char *key)
{
    char was[160], is[160];
    neph_text_format(was, sizeof(was), "-s %s.%s", extractor, key);
    neph_text_format(is, sizeof(is), "-s %s:%s", extractor, key);
    neph_old_option_warn("neph", was, is);
}

static enum neph_status apply_setting(struct neph_comparison *comparison, const char *text,
                                      struct neph_diag *diag)
{
    char name[64], owner[96];
    const size_t length = strcspn(text, ".:=");
    const char *key = text + length + 1;
    if (text[length] == '\0' || text[length] == '=' || length >= sizeof(name))
        return neph_fail(diag, NEPH_ERR_USAGE, "setting '%s' is not EXTRACTOR:KEY=VALUE", text);
    snprintf(name, sizeof(name), "%.*s", (int)length, text);
    if (text[length] == '.')
        warn_of_dot(name, key);
    const struct neph_extractor *extractor = neph_extractor_find(name);
    if (!extractor)
        return neph_fail(diag, NEPH_ERR_USAGE, "setting '%s': there is no extractor '%s'", text,
                         name);
    choose(comparison, extractor); /* who sets something wants it */
    snprintf(owner, sizeof(owner), "extractor %s", name);
    return neph_options_set(extractor->options, owner, key,
                            &find_choice(comparison, extractor)->settings, diag);
}

/* What was given, over the defaults. */
static struct neph_viewing viewing_of(const struct request *request)
{
    struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    const struct {
        double given, *value;
    } conditions[] = {
        {request->frame_rate_hz, &viewing.frame_rate_hz},
        {request->pixels_per_degree, &viewing.pixels_per_degree},
        {request->exposure_ev, &viewing.exposure_ev},
        {request->white_cd_per_m2, &viewing.white_cd_per_m2},
    };
    for (size_t i = 0; i < sizeof(conditions) / sizeof(conditions[0]); i++)
        if (!isnan(conditions[i].given))
            *conditions[i].value = conditions[i].given;
    return viewing;
}

/* A name of a mask has neither dot nor slash; the name of a picture has an extension. */
static bool names_mask_file(const struct request *request)
{
    return request->mask && strpbrk(request->mask, "./");
}

/* The mask that is wanted; NULL: all masks. */
static const char *wanted_mask(const struct request *request)
{
    return names_mask_file(request) ? "file" : request->mask;
}

static int limit_count(const struct request *request)
{
    return request->above.count + request->below.count;
}

static enum neph_status parse_limit(const struct request *request, int index,
                                    struct neph_limit *limit, struct neph_diag *diag)
{
    const bool below = index >= request->above.count;
    const char *word = below ? request->below.list[index - request->above.count]
                             : request->above.list[index];
    return neph_limit_parse(word, below, limit, diag);
}

/* A number that has a limit is measured. */
static enum neph_status choose_limited(struct neph_comparison *comparison,
                                       const struct request *request, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < limit_count(request) && !status; i++) {
        struct neph_limit limit;
        const struct neph_extractor *extractor = NULL;
        status = parse_limit(request, i, &limit, diag);
        if (!status && neph_metric_find(limit.metric, &extractor))
            choose(comparison, extractor);
        comparison->detail_masks |= !status && neph_mask_is_detail(limit.mask);
    }
    return status;
}

static enum neph_status choose_extractors(struct neph_comparison *comparison,
                                          const struct request *request, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < request->metrics.count && !status; i++)
        status = choose_word(comparison, request->metrics.words[i], diag);
    for (int i = 0; i < neph_extractor_count() && request->metrics.count == 0; i++) {
        const struct neph_extractor *extractor = neph_extractor_at(i);
        if (!extractor->costly && extractor->temporal == request->temporal)
            choose(comparison, extractor);
    }
    for (int i = 0; i < request->shared.settings.count && !status; i++)
        status = apply_setting(comparison, request->shared.settings.list[i], diag);
    return status ? status : choose_limited(comparison, request, diag);
}

/* All but the sequences of reference and test. */
static enum neph_status prepare(const struct request *request, struct neph_comparison *comparison,
                                struct neph_diag *diag)
{
    if (request->shared.json && request->csv && strcmp(request->csv, "-") == 0)
        return neph_fail(diag, NEPH_ERR_USAGE, "--json and --csv - are both for stdout");
    *comparison = (struct neph_comparison){
        .viewing = viewing_of(request),
        .own_frame_rate = isnan(request->frame_rate_hz),
        .warm_up_frames = request->warm_up_frames,
        .mask = wanted_mask(request),
        .mask_file = names_mask_file(request) ? request->mask : NULL,
        .detail_masks = request->temporal || request->rings ||
                        (request->mask && neph_mask_is_detail(request->mask)),
        .layer = request->layer,
        .maps_directory = request->maps,
        .frozen_is_fine = request->frozen_is_fine || !request->temporal,
        .by_position = request->by_position,
        .quiet = request->shared.quiet,
        .negative_allowed = request->negative_is_fine ? SIZE_MAX : 0,
    };
    const enum neph_status status = choose_extractors(comparison, request, diag);
    return status || !request->second
               ? status
               : neph_sequence_find(1, &request->second, request->by_position, &comparison->second,
                                    diag);
}

/* What a shell has expanded behind --reference is put back where it belongs. */
static enum neph_status find_split(const struct request *request,
                                   struct neph_comparison *comparison, struct neph_arena *arena,
                                   struct neph_diag *diag)
{
    const int given = request->references.count, count = request->shared.operand_count;
    const char *const *words = request->shared.operands;
    bool *is_reference = neph_arena_zeroed(arena, (size_t)count, sizeof(*is_reference));
    const char **references = neph_arena_zeroed(arena, (size_t)(given + count), sizeof(*words));
    const char **tests = neph_arena_zeroed(arena, (size_t)count, sizeof(*words));
    enum neph_status status = neph_arena_check(arena, diag);
    if (!status)
        status = neph_sequence_split(given, request->references.list, count, words, is_reference,
                                     diag);
    if (status)
        return status;
    int reference_count = given, test_count = 0;
    memcpy(references, request->references.list, (size_t)given * sizeof(*words));
    for (int i = 0; i < count; i++)
        if (is_reference[i])
            references[reference_count++] = words[i];
        else
            tests[test_count++] = words[i];
    status = neph_sequence_find(reference_count, references, request->by_position,
                                &comparison->reference, diag);
    return status ? status
                  : neph_sequence_find(test_count, tests, request->by_position, &comparison->test,
                                       diag);
}

static enum neph_status find_pair(const struct request *request, struct neph_comparison *comparison,
                                  struct neph_diag *diag)
{
    const char *const *words = request->shared.operands;
    const enum neph_status status = neph_sequence_find(1, words, request->by_position,
                                                       &comparison->reference, diag);
    return status ? status
                  : neph_sequence_find(1, words + 1, request->by_position, &comparison->test, diag);
}

/* ---- which numbers to show ------------------------------------------------------------------- */

static bool is_wanted(const struct neph_measurement *number, const void *context)
{
    const struct request *request = context;
    const char *mask = wanted_mask(request), *metric = number->metric->name;
    if (mask && strcmp(mask, number->mask) != 0)
        return false;
    const struct neph_extractor *owner = NULL;
    neph_metric_find(metric, &owner);
    bool named = request->metrics.count == 0;
    for (int i = 0; i < request->metrics.count; i++) {
        const char *word = request->metrics.words[i];
        named |= strcmp(word, "all") == 0 || strcmp(word, owner->name) == 0 ||
                 strcmp(word, metric) == 0;
    }
    for (int i = 0; i < request->shared.settings.count; i++) {
        const char *setting = request->shared.settings.list[i];
        const size_t length = strlen(owner->name);
        named |= strncmp(setting, owner->name, length) == 0 &&
                 (setting[length] == '.' || setting[length] == ':');
    }
    return named;
}

/* Findings stand on several metrics; those of the wanted mask, and of no mask in particular. */
static bool is_wanted_finding(const struct request *request, const struct neph_finding *finding)
{
    const char *mask = wanted_mask(request);
    return !mask || strcmp(mask, finding->mask) == 0 || strcmp(finding->name, "half_life") == 0;
}

/* Leave only what was asked for. */
static void select_wanted(const struct request *request, struct neph_compared *compared)
{
    struct neph_findings *findings = &compared->findings;
    int kept = 0;
    neph_measurements_select(&compared->numbers, is_wanted, request);
    for (int i = 0; i < findings->count; i++)
        if (is_wanted_finding(request, &findings->list[i]))
            findings->list[kept++] = findings->list[i];
    findings->count = kept;
}

/* ---- the run --------------------------------------------------------------------------------- */

/* Whether stdout is for people. */
static bool is_for_people(const struct request *request)
{
    return !request->shared.json && (!request->csv || strcmp(request->csv, "-") != 0);
}

static enum neph_status print_all(const struct request *request,
                                  const struct neph_compared *compared, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (compared->numbers.count == 0 && request->mask)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED,
                         "nothing to measure over the mask '%s': the reference has no such pixels, "
                         "or lacks the layer that it is made from",
                         request->mask);
    if (request->shared.json)
        status = neph_json_print(neph_compared_json(compared), diag);
    else if (is_for_people(request) && request->all)
        neph_comparison_print(compared, request->rings || request->mask,
                              request->metrics.count > 0);
    else if (is_for_people(request))
        neph_verdict_print(compared, &(struct neph_verdict_form){
                                         .mask = wanted_mask(request),
                                         .lines_used = limit_count(request),
                                         .is_brief = request->shared.quiet,
                                         .shows_metrics = request->metrics.count > 0,
                                     });
    return request->csv && !status ? neph_comparison_write_csv(request->csv, compared, diag)
                                   : status;
}

/* Found before anything is measured. */
static enum neph_status find_versus(const struct request *request,
                                    const struct neph_comparison *comparison,
                                    struct neph_sequence *other, struct neph_diag *diag)
{
    if (!request->versus)
        return NEPH_OK;
    enum neph_status status = neph_sequence_find(1, &request->versus, request->by_position, other,
                                                 diag);
    if (!status && other->count != comparison->test.count)
        status = neph_fail(diag, NEPH_ERR_INPUT,
                           "%d frames of the other test, %d of the test: as many are needed",
                           other->count, comparison->test.count);
    if (!status && !request->by_position)
        status = neph_sequence_check_numbers(&comparison->test, "the test", other, "the other test",
                                             diag);
    return status;
}

/* Compares with the other test, too, and keeps the differences alone. `compared` has only what was
 * asked for: p-values are corrected for these. */
static enum neph_status add_versus(const struct request *request,
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
        select_wanted(request, &beside);
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

/* What was named and gave nothing is not passed over. */
static enum neph_status check_taken(const char *word, const struct neph_compared *compared,
                                    struct neph_diag *diag)
{
    const struct neph_extractor *extractor = find_extractor(word);
    if (!extractor || has_numbers_of(compared, extractor)) /* "all" is none */
        return NEPH_OK;
    const char *because = "the images have nothing that it is taken of";
    for (int i = 0; i < compared->not_taken_count; i++)
        if (strcmp(compared->not_taken[i].extractor, extractor->name) == 0)
            because = compared->not_taken[i].because;
    return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "%s was not measured: %s", word, because);
}

/* What was named is there, and all limits are kept. */
static enum neph_status check_all(const struct request *request,
                                  const struct neph_compared *compared, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    if (request->metrics.count == 0 && request->temporal)
        status = check_taken("flicker", compared, diag);
    for (int i = 0; i < request->metrics.count && !status; i++)
        status = check_taken(request->metrics.words[i], compared, diag);
    for (int i = 0; i < limit_count(request) && !status; i++) {
        struct neph_limit limit;
        status = parse_limit(request, i, &limit, diag);
        if (!status)
            status = neph_limit_check(&compared->numbers, &limit, diag);
    }
    return status;
}

static void print_limits(const struct request *request, const struct neph_compared *compared)
{
    for (int i = 0; i < limit_count(request); i++) {
        struct neph_limit limit;
        if (parse_limit(request, i, &limit, NULL) == NEPH_OK)
            neph_verdict_print_limit(&compared->numbers, &limit);
    }
}

/* Limits hold of all numbers, and are spoken of after those that are shown. */
static enum neph_status tell(const struct request *request,
                             const struct neph_comparison *comparison,
                             const struct neph_sequence *other, enum neph_status status,
                             struct neph_compared *compared, struct neph_diag *diag)
{
    struct neph_diag late = {.line = 0};
    const enum neph_status checked = check_all(request, compared, &late);
    if (is_for_people(request))
        print_limits(request, compared);
    select_wanted(request, compared);
    if (!status && request->versus)
        status = add_versus(request, comparison, other, compared, diag);
    const enum neph_status printed = print_all(request, compared, status ? NULL : diag);
    status = status ? status : printed;
    if (status || !checked)
        return status;
    *diag = late;
    return checked;
}

static enum neph_status measure(const struct request *request,
                                const struct neph_comparison *comparison, struct neph_diag *diag)
{
    struct neph_compared compared = {0};
    struct neph_sequence other = {0};
    enum neph_status status = find_versus(request, comparison, &other, diag);
    if (!status)
        status = neph_comparison_run(comparison, request->versus, &compared, diag);
    if (compared.asked)
        status = tell(request, comparison, &other, status, &compared, diag);
    neph_sequence_finish(&other);
    neph_compared_finish(&compared);
    return status;
}

static enum neph_status run(const struct neph_cli_syntax *syntax, bool temporal, int argc,
                            char **argv, struct neph_diag *diag)
{
    struct request request = {.temporal = temporal};
    struct neph_comparison comparison = {.choice_count = 0};
    struct neph_arena arena = {0};
    neph_cli_parse(syntax, argc, argv, &request);
    enum neph_status status = prepare(&request, &comparison, diag);
    if (!status)
        status = temporal ? find_split(&request, &comparison, &arena, diag)
                          : find_pair(&request, &comparison, diag);
    if (!status)
        status = measure(&request, &comparison, diag);
    neph_comparison_finish(&comparison);
    neph_arena_finish(&arena);
    return status;
}

enum neph_status neph_cli_compare(int argc, char **argv, struct neph_diag *diag)
{
    return run(&compare_syntax, false, argc, argv, diag);
}

enum neph_status neph_cli_flicker(int argc, char **argv, struct neph_diag *diag)
{
    return run(&flicker_syntax, true, argc, argv, diag);
}
