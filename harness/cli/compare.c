/* SPDX-License-Identifier: MIT
 *
 * `neph compare REFERENCE TEST`: the error of each frame; and `neph flicker [-r REFERENCE] [BEFORE]
 * TEST`: unwanted change of a sequence over time.
 */
#include "harness/cli/cli.h"

#include "base/clock.h"
#include "base/heap.h"
#include "base/interrupt.h"
#include "base/threads.h"
#include "harness/cli/compare_page.h"
#include "harness/cli/compare_sides.h"
#include "harness/cli/compare_z.h"
#include "harness/compare/alone.h"
#include "harness/compare/choice.h"
#include "harness/compare/comparison.h"
#include "harness/compare/limits_file.h"
#include "harness/compare/verdict.h"
#include "metrics/colour_config.h"
#include "metrics/extractors/extractors.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- options --------------------------------------------------------------------------------- */

/* The settings in `shared` belong to extractors. */
struct request {
    struct neph_cli_shared shared;
    bool temporal; /* `neph flicker` */
    struct neph_cli_words references;
    struct neph_cli_list metrics;
    struct neph_cli_words above, below; /* limits */
    const char *limits_path;
    const struct neph_limits *limits; /* of that file; NULL: none */
    const char *mask, *csv, *junit, *page, *maps;
    struct neph_frame_choice frame_choice;
    const char *ocio, *space; /* a config with colour spaces, and its name of linear Rec.709 */
    struct neph_clips clips;
    const char *window; /* mode of differing data windows */
    const char *second; /* words of the second reference */
    const char *versus; /* words of the other test */
    const char *partner;
    const struct neph_partner_display *partner_display; /* of `partner`; NULL: none */
    double frame_rate_hz, pixels_per_degree, exposure_ev, white_cd_per_m2; /* NaN: the default */
    const char *variance; /* name of the layer of variances, for --z */
    int warm_up_frames, samples;
    bool z, rings, by_position, allow_frozen_frames, negative_is_fine, all;
};

enum { MEASURING, VIEWING, JUDGING, WRITING }; /* groups of the help */

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"reference", 0, NULL,
     "The reference: one frame, or as many as the test has; may be given several times",
     NEPH_CLI_WORDS, AT(references)},
    {"metric", 'm', "NAME[,NAME]",
     "Extractors, some of their metrics, or 'all'; `neph metrics` lists them", NEPH_CLI_NAMES,
     AT(metrics)},
    {.name = "set",
     .argument = "EXTRACTOR:KEY=VALUE",
     .help = "A setting of an extractor, such as lag:step_frame=40; may be given several times"},
    {"mask", 0, "NAME|FILE",
     "Only this mask: a name (all, sky, depth_edge, ...; `neph metrics --masks`), or an image that "
     "is above 0.5 inside",
     NEPH_CLI_WORD, AT(mask)},
    {"part", .kind = NEPH_CLI_WORD, AT(frame_choice.part)},
    {"layer", .kind = NEPH_CLI_WORD, AT(frame_choice.layer)},
    {"depth", .kind = NEPH_CLI_WORD, AT(frame_choice.depth)},
    {"convert", .kind = NEPH_CLI_FLAG, AT(frame_choice.convert)},
    {"ocio", .kind = NEPH_CLI_WORD, AT(ocio)},
    {"space", .kind = NEPH_CLI_WORD, AT(space)},
    {"window", .kind = NEPH_CLI_WORD, AT(window), "union"},
    {"rings", 0, NULL,
     "Also the ring masks at depth edges, by distance and side (flicker always measures them, and "
     "shows them with this)",
     NEPH_CLI_FLAG, AT(rings)},
    {"second-reference", 0, "FILES",
     "The reference with another seed: removes the reference's noise from squared errors; or, with "
     "lag:old=second, the same scene without its step",
     NEPH_CLI_WORD, AT(second)},
    {"versus", 0, "FILES",
     "Another test of the same frames, as BEFORE: both values and their difference, test - other, "
     "paired frame by frame, or tile by tile where a sequence has one number, with intervals and "
     "corrected p-values",
     NEPH_CLI_WORD, AT(versus)},
    {"partner", 0, "PROGRAM[:DISPLAY]",
     "Also the number of another program, which must be in PATH: cvvdp (the JOD of ColorVideoVDP "
     "for its display standard_4k), cvvdp:standard_fhd, cvvdp:standard_hdr_linear or "
     "cvvdp:standard_hdr_linear_dark",
     NEPH_CLI_WORD, AT(partner)},
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
    {"limits", 0, "FILE",
     "Exit with 1 when a number is beyond its limit in a file of `neph limits`", NEPH_CLI_WORD,
     AT(limits_path), .group = JUDGING},
    {"z", 0, NULL,
     "Noise or bias: exit with 1 when two renders of path tracers differ by more than the noise of "
     "both, at the level 0.05. The noise is from variance.R G B, from second moments (m2_*, "
     "Mitsuba), or from several files of each with different seeds",
     NEPH_CLI_FLAG, AT(z), .group = JUDGING},
    {"variance", 0, "LAYER", "With --z: channels LAYER.R G B are the variance of the mean R G B",
     NEPH_CLI_WORD, AT(variance), "variance", .group = JUDGING},
    {"samples", 0, NULL, "With --z and second moments: samples a pixel of both renders",
     NEPH_CLI_INTEGER, AT(samples), NULL, 2, 1e9, .group = JUDGING},
    {"frozen-ok", 0, NULL, "Frames that are bit for bit the one before are meant to be so",
     NEPH_CLI_FLAG, AT(allow_frozen_frames), .group = JUDGING},
    {"negative-ok", 0, NULL,
     "Values below 0 are no reason to stop: a filter with negative lobes made them", NEPH_CLI_FLAG,
     AT(negative_is_fine), .group = JUDGING},
    {"all", 0, NULL, "The table of all numbers and findings behind the first line", NEPH_CLI_FLAG,
     AT(all), .group = WRITING},
    {.name = "json", .group = WRITING},
    {"csv", 0, "FILE", "Results as CSV; '-': on stdout, in place of the table", NEPH_CLI_FILE,
     AT(csv), .group = WRITING},
    {"junit", 0, NULL, "JUnit XML: a test case for each limit", NEPH_CLI_FILE, AT(junit),
     .group = WRITING},
    {"maps", 0, "DIR",
     "Maps as EXR, and as PNG on a fixed scale: DIR/MAP_QUANTITY[_FRAME].exr and .png",
     NEPH_CLI_OUTPUT, AT(maps), .group = WRITING},
    {"page", 0, NULL, "An HTML page with charts over time, maps, the worst frames and all numbers",
     NEPH_CLI_OUTPUT, AT(page), .group = WRITING},
    {"jobs", 0, NULL, "Threads; numbers do not depend on it (default: as many as processors)",
     NEPH_CLI_INTEGER,
     .at = offsetof(struct request, shared) + offsetof(struct neph_cli_shared, jobs), .minimum = 1,
     .maximum = 256, .group = WRITING},
    {"quiet", 'q', NULL, "No progress, and of the answer only its first line", NEPH_CLI_FLAG,
     .at = offsetof(struct request, shared) + offsetof(struct neph_cli_shared, quiet),
     .group = WRITING},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_operands compare_operands = {.shown = "[REFERENCE|BEFORE] TEST"};

static const struct neph_cli_operands flicker_operands = {.shown = "[BEFORE] TEST"};

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    neph_cli_check_colours(request->ocio, request->space, request->frame_choice.convert, state);
}

static const struct neph_cli_syntax compare_syntax = {
    .options = options,
    .operands = &compare_operands,
    .check = check,
    .doc = "Measure the error of TEST against a reference: EXR frames with linear data, or PNG "
           "images.\v"
           "-r names the reference; without it, the first operand is the reference. With it, two "
           "operands are BEFORE and TEST: is TEST better? Each is " NEPH_SEQUENCE_HELP
           ". Values that are not finite, or negative, are an error before anything else. The sign "
           "is test - reference. PNG images are decoded from sRGB. Frames are files: pipes, and so "
           "<(COMMAND) of a shell, are refused.\n\n"
           "Examples:\n"
           "  neph compare exact.exr march.exr\n"
           "  neph compare -r ref.png before.png after.png\n"
           "  neph compare -r full/ before/ after/ --page out/compare\n"
           "  neph compare exact.exr march.exr --json --mask depth_edge\n"
           "  neph compare old.png new.png -m flip --maps out/maps --fail-above flip_mean=0.05\n"
           "  neph compare -r reference.exr 'night/frame.*.exr' --csv errors.csv\n"
           "  neph compare --z -r 'old/seed_*.exr' 'new/seed_*.exr'",
};

static const struct neph_cli_syntax flicker_syntax = {
    .options = options,
    .operands = &flicker_operands,
    .check = check,
    .doc =
        "Measure the flicker of a sequence: amplitude at the periods of a four-frame cycle, noise, "
        "visibility at the frame rate of the display, change that the reference does not have, "
        "and lag: half-life and ghosts (with a step or a cut in the reference), gain and delay "
        "(with light that goes up and down), ghosts behind moving edges (with motion vectors).\v"
        "Two sequences are BEFORE and TEST: does TEST flicker less? Without a reference (-r) they "
        "are compared with each other, and change of the scene itself counts as flicker. Each "
        "is " NEPH_SEQUENCE_HELP
        ". Frames are counted from the first after --warm-up; only whole cycles of four are "
        "measured, and 128 frames make good intervals. Flicker without the lag beside it says "
        "little: a frame that never changes does not flicker; `neph scenes NAME --variant "
        "sun_step` makes scenes to measure it with. Exit code 1 when frames are frozen, 2 when "
        "they are too few.\n\n"
        "Examples:\n"
        "  neph flicker before/ after/\n"
        "  neph flicker -r full/ before/ after/ --page out/flicker\n"
        "  neph flicker -r still.exr 'taa/frame.*.exr' --warm-up 44\n"
        "  neph flicker -r full/ fast/ --mask depth_edge --maps out/maps\n"
        "  neph flicker -r lights/ taa/ -s lag:step_frame=16 -m lag\n"
        "  neph flicker -r sines/ taa/ --warm-up 64 -s follow:period_1=32 -m follow\n"
        "  neph flicker -r ref.png game/ --fps 30 --fail-above a4_p95@all=0.0157",
};

/* ---- the measurement set-up ------------------------------------------------------------------ */

static struct neph_viewing make_viewing(const struct request *request)
{
    return neph_viewing_complete(
        (struct neph_viewing){request->frame_rate_hz, request->pixels_per_degree,
                              request->exposure_ev, request->white_cd_per_m2});
}

/* Whether --mask names a file: names of built-in masks have neither dot nor slash. */
static bool names_mask_file(const struct request *request)
{
    return request->mask && strpbrk(request->mask, "./");
}

/* The name of the only wanted mask; NULL: all masks. */
static const char *wanted_mask(const struct request *request)
{
    return names_mask_file(request) ? "file" : request->mask;
}

static struct neph_named make_named(const struct request *request)
{
    return (struct neph_named){
        .metrics = request->metrics.words,
        .metric_count = request->metrics.count,
        .settings = request->shared.settings.list,
        .setting_count = request->shared.settings.count,
        .mask = wanted_mask(request),
        .is_flicker = request->temporal,
    };
}

/* The limits of the command line. */
static int own_limit_count(const struct request *request)
{
    return request->above.count + request->below.count;
}

/* The limits of the command line and of the file. */
static int limit_count(const struct request *request)
{
    return own_limit_count(request) + (request->limits ? request->limits->count : 0);
}

static enum neph_status parse_limit(const struct request *request, int index,
                                    struct neph_limit *limit, struct neph_diag *diag)
{
    if (index >= own_limit_count(request)) {
        *limit = request->limits->list[index - own_limit_count(request)].limit;
        return NEPH_OK;
    }
    const bool below = index >= request->above.count;
    const char *word = below ? request->below.list[index - request->above.count]
                             : request->above.list[index];
    return neph_limit_parse(word, below, limit, diag);
}

/* Choose the extractors of all metrics that have a limit. */
static enum neph_status choose_limited(struct neph_comparison *comparison,
                                       const struct request *request, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < limit_count(request) && !status; i++) {
        struct neph_limit limit;
        const struct neph_extractor *extractor = NULL;
        status = parse_limit(request, i, &limit, diag);
        if (!status && neph_metric_find(limit.metric, &extractor))
            neph_choose_extractor(comparison, extractor);
        comparison->detail_masks |= !status && neph_mask_is_detail(limit.mask);
    }
    return status;
}

static enum neph_status choose_extractors(struct neph_comparison *comparison,
                                          const struct request *request, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < request->metrics.count && !status; i++)
        status = neph_choose_word(comparison, request->metrics.words[i], diag);
    if (request->metrics.count == 0)
        neph_choose_usual(comparison, request->temporal);
    for (int i = 0; request->limits && i < request->limits->setting_count && !status; i++)
        status = neph_choose_setting(comparison, request->limits->settings[i], diag);
    for (int i = 0; i < request->shared.settings.count && !status; i++)
        status = neph_choose_setting(comparison, request->shared.settings.list[i], diag);
    if (!status)
        status = choose_limited(comparison, request, diag);
    if (status)
        return status;
    if (request->partner && comparison->without_reference)
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "--partner compares with a reference: name it with -r");
    return neph_choice_check_reference(comparison, request->second ? "--second-reference" : NULL,
                                       diag);
}

/* Fill the comparison; it takes over the sequences of reference and test. */
static enum neph_status prepare(const struct request *request, struct neph_sides *sides,
                                struct neph_comparison *comparison, struct neph_diag *diag)
{
    if (request->shared.json && request->csv && strcmp(request->csv, "-") == 0)
        return neph_fail(diag, NEPH_ERR_USAGE, "--json and --csv - are both for stdout");
    *comparison = (struct neph_comparison){
        .source = &neph_frame_files,
        .reference = sides->reference,
        .without_reference = sides->without_reference,
        .test = sides->test,
        .viewing = make_viewing(request),
        .own_frame_rate = isnan(request->frame_rate_hz),
        .warm_up_frames = request->warm_up_frames,
        .mask = wanted_mask(request),
        .mask_file = names_mask_file(request) ? request->mask : NULL,
        .detail_masks = request->temporal || request->rings ||
                        (request->mask && neph_mask_is_detail(request->mask)),
        .frame_choice = request->frame_choice,
        .maps_directory = request->maps,
        .allow_frozen_frames = request->allow_frozen_frames || !request->temporal,
        .by_position = request->by_position,
        .with_histogram = !request->temporal,
        .quiet = request->shared.quiet,
        .negative_allowed = request->negative_is_fine ? SIZE_MAX : 0,
    };
    sides->reference = sides->test = (struct neph_sequence){.count = 0};
    const enum neph_status status = choose_extractors(comparison, request, diag);
    return status || !request->second
               ? status
               : neph_sequence_find(1, &request->second, request->by_position, &comparison->second,
                                    diag);
}

/* ---- the run --------------------------------------------------------------------------------- */

/* Whether stdout gets text for people, not JSON or CSV. */
static bool is_for_people(const struct request *request)
{
    return !request->shared.json && (!request->csv || strcmp(request->csv, "-") != 0);
}

/* The state of a run, from the parsed options to the answer. */
struct work {
    const struct request *request;
    const struct neph_sides *sides;
    struct neph_comparison asked[NEPH_PAGE_SIDES]; /* of the test and of the other test */
    struct neph_compared compared[NEPH_PAGE_SIDES];
    struct neph_cli_page page;
    struct neph_junit *junit;
    bool limits_apply;   /* those of the file, to these frames */
    int limit_lines;     /* printed */
    json_t *limits_json; /* the result of the file of limits; owned; NULL: none */
};

/* Run the program of --partner. The results after Ctrl-C are complete but for its number. */
static enum neph_status ask_partner(struct work *work, struct neph_diag *diag)
{
    const struct request *request = work->request;
    const struct neph_comparison *asked = &work->asked[NEPH_PAGE_TEST];
    struct neph_compared *compared = &work->compared[NEPH_PAGE_TEST];
    if (!request->partner_display)
        return NEPH_OK;
    const struct neph_partner_job job = {
        .display = request->partner_display,
        .reference = &asked->reference,
        .test = &asked->test,
        .other = &work->sides->other,
        .first = asked->warm_up_frames,
        .is_sequence = request->temporal,
        .choice = asked->frame_choice,
        .negative_allowed = asked->negative_allowed,
        .viewing = compared->viewing,
        .with_pixels_per_degree = !isnan(request->pixels_per_degree),
    };
    if (!request->shared.quiet)
        fprintf(stderr, "cvvdp: %d frames\n", asked->test.count - job.first);
    const enum neph_status status = neph_partner_run(&job, &compared->partner, diag);
    if (status == NEPH_ERR_INTERRUPTED)
        neph_interrupt_acknowledge();
    return status;
}

/* The note behind the first line of the answer: the missing or the assumed reference. */
static const char *find_note(const struct neph_sides *sides, struct neph_arena *arena)
{
    if (sides->without_reference)
        return neph_alone_unknown;
    return sides->reference_word ? neph_arena_format(arena, "reference: %s", sides->reference_word)
                                 : NULL;
}

static struct neph_verdict_form make_form(const struct work *work, struct neph_arena *arena)
{
    const struct request *request = work->request;
    return (struct neph_verdict_form){
        .mask = wanted_mask(request),
        .test = work->sides->test_name,
        .other = work->sides->other_name,
        .note = find_note(work->sides, arena),
        .lines_used = work->limit_lines,
        .is_brief = request->shared.quiet || request->all,
        .shows_metrics = request->metrics.count > 0,
    };
}

static void print_people(const struct work *work, const struct neph_verdict_form *form)
{
    const struct request *request = work->request;
    const struct neph_compared *compared = &work->compared[NEPH_PAGE_TEST];
    if (compared->numbers.count > 0)
        neph_verdict(compared, form, stdout);
    if (!request->all || request->shared.quiet)
        return;
    if (form->note)
        printf("%s\n", form->note);
    neph_comparison_print(compared, request->rings || request->mask, request->metrics.count > 0);
}

static enum neph_status write_page(struct work *work, struct neph_verdict_form form,
                                   struct neph_diag *diag)
{
    const bool has_other = work->compared[NEPH_PAGE_OTHER].asked;
    form.is_brief = false;
    form.lines_used = 0;
    form.is_on_page = true;
    return neph_cli_page_write(&work->page, work->junit->name, &form,
                               &work->compared[NEPH_PAGE_TEST],
                               has_other ? &work->compared[NEPH_PAGE_OTHER] : NULL, diag);
}

static enum neph_status print_json(struct work *work, struct neph_diag *diag)
{
    json_t *json = neph_compared_json(&work->compared[NEPH_PAGE_TEST]);
    if (work->limits_apply)
        neph_json_set(&json, "limits", work->limits_json);
    work->limits_json = NULL;
    return neph_json_print(json, diag);
}

static enum neph_status print_all(struct work *work, struct neph_diag *diag)
{
    const struct request *request = work->request;
    const struct neph_compared *compared = &work->compared[NEPH_PAGE_TEST];
    struct neph_arena arena = {0};
    const struct neph_verdict_form form = make_form(work, &arena);
    enum neph_status status = neph_arena_check(&arena, diag);
    if (!status && compared->numbers.count == 0 && request->mask)
        status = neph_fail(
            diag, NEPH_ERR_UNSUPPORTED,
            "nothing to measure over the mask '%s': the reference has no such pixels, "
            "or lacks the layer that it is made from",
            request->mask);
    else if (!status && request->shared.json)
        status = print_json(work, diag);
    else if (!status && is_for_people(request))
        print_people(work, &form);
    fflush(stdout);
    if (!status && request->csv)
        status = neph_comparison_write_csv(request->csv, compared, diag);
    if (!status)
        status = write_page(work, form, diag);
    neph_arena_finish(&arena);
    return status;
}

/* Compare the reference with the other test as well. Only the wanted numbers stay, because p-values
 * are corrected for their count. Frozen frames of the other test make the command fail after its
 * comparison. */
static enum neph_status add_versus(struct work *work, struct neph_diag *diag)
{
    struct neph_comparison *other = &work->asked[NEPH_PAGE_OTHER];
    struct neph_compared *compared = work->compared, *beside = &work->compared[NEPH_PAGE_OTHER];
    *other = work->asked[NEPH_PAGE_TEST];
    other->test = work->sides->other;
    other->maps_directory = NULL;
    if (other->with_movement)
        neph_cli_page_add_comparison(&work->page, NEPH_PAGE_OTHER, other);
    const enum neph_status judged = neph_comparison_run(other, true, beside, diag);
    enum neph_status status = beside->asked && judged == NEPH_ERR_GATE ? NEPH_OK : judged;
    if (judged == NEPH_ERR_GATE && beside->asked)
        neph_hint(diag, "these are frames of '%s'; if they are meant to be frozen, say --frozen-ok",
                  work->sides->other_name);
    if (!status) {
        const struct neph_named named = make_named(work->request);
        neph_named_select(&named, beside);
        status = neph_versus(&compared->numbers, &beside->numbers, &compared->versus, diag);
    }
    if (!status)
        status = neph_versus_add_movement(&compared->movement, &beside->movement, &compared->versus,
                                          diag);
    compared->has_versus = !status;
    return status ? status : judged;
}

/* Check that all named metrics were measured, and that all limits are met. */
static enum neph_status check_all(const struct request *request,
                                  const struct neph_compared *compared, struct neph_diag *diag)
{
    const struct neph_named named = make_named(request);
    enum neph_status status = neph_named_check(&named, compared, diag);
    for (int i = 0; i < limit_count(request) && !status; i++) {
        struct neph_limit limit;
        status = parse_limit(request, i, &limit, diag);
        if (!status)
            status = neph_limit_check(&compared->numbers, &limit, diag);
    }
    return status;
}

static void print_limits(struct work *work)
{
    const struct request *request = work->request;
    const struct neph_measurements *numbers = &work->compared[NEPH_PAGE_TEST].numbers;
    for (int i = 0; i < own_limit_count(request); i++) {
        struct neph_limit limit;
        if (parse_limit(request, i, &limit, NULL) == NEPH_OK)
            neph_verdict_limit(numbers, &limit, stdout);
    }
    work->limit_lines = own_limit_count(request);
    if (work->limits_apply)
        work->limit_lines += neph_limits_print(request->limits, numbers, stdout);
}

/* ---- JUnit ----------------------------------------------------------------------------------- */

static const char *junit_group(const struct request *request, struct neph_junit *junit)
{
    const struct neph_cli_shared *shared = &request->shared;
    return neph_arena_format(&junit->arena, "%s %s", junit->name,
                             shared->operand_count > 0 ? shared->operands[shared->operand_count - 1]
                                                       : "");
}

/* Add a test case for each limit. `measured` NULL: nothing was measured, and `why` is the
 * reason. */
static void add_limits(const struct request *request, const struct neph_measurements *measured,
                       const struct neph_diag *why, struct neph_junit *junit)
{
    for (int i = 0; i < limit_count(request); i++) {
        struct neph_limit limit;
        if (parse_limit(request, i, &limit, NULL) == NEPH_OK)
            neph_limit_add_case(measured, &limit, junit_group(request, junit), why->message, junit);
    }
}

/* Add a test case for the run itself if it failed for another reason than a limit, such as frozen
 * frames, or if there are no limits. */
static void add_run(const struct request *request, enum neph_status status,
                    const struct neph_diag *why, struct neph_junit *junit)
{
    if (status || limit_count(request) == 0)
        neph_junit_add(junit, junit_group(request, junit), "measured",
                       status ? NEPH_JUNIT_FAILED : NEPH_JUNIT_PASSED, status ? why->message : "");
}

/* Check the limits, then print. Limits apply to all numbers, so they are checked before the numbers
 * that are not shown are removed. */
static enum neph_status tell(struct work *work, enum neph_status status, struct neph_diag *diag)
{
    const struct request *request = work->request;
    const struct neph_named named = make_named(request);
    struct neph_compared *compared = &work->compared[NEPH_PAGE_TEST];
    struct neph_diag late = {.line = 0};
    if (!status && request->limits)
        status = neph_limits_check_use(request->limits, compared, diag);
    work->limits_apply = request->limits && !status;
    const enum neph_status checked = check_all(request, compared, &late);
    if (is_for_people(request))
        print_limits(work);
    if (work->limits_apply && request->shared.json)
        work->limits_json = neph_limits_result_json(request->limits, &compared->numbers);
    add_limits(request, request->limits && !work->limits_apply ? NULL : &compared->numbers, diag,
               work->junit);
    neph_named_select(&named, compared);
    if (work->sides->other.count > 0 && (!status || status == NEPH_ERR_GATE)) {
        const enum neph_status versus = add_versus(work, status ? NULL : diag);
        status = status ? status : versus;
    }
    struct neph_diag partner = {.line = 0};
    const enum neph_status beside = status ? NEPH_OK : ask_partner(work, &partner);
    const enum neph_status printed = print_all(work, status ? NULL : diag);
    status = status ? status : printed;
    add_run(request, status ? status : beside, status ? diag : &partner, work->junit);
    if (status || (!checked && !beside))
        return status;
    *diag = checked ? late : partner;
    return checked ? checked : beside;
}

/* ---- all of it ------------------------------------------------------------------------------- */

static enum neph_status measure(const struct request *request,
                                const struct neph_comparison *comparison,
                                const struct neph_sides *sides, struct neph_junit *junit,
                                struct neph_diag *diag)
{
    struct work work = {.request = request, .sides = sides, .junit = junit};
    struct neph_comparison *asked = &work.asked[NEPH_PAGE_TEST];
    struct neph_compared *compared = &work.compared[NEPH_PAGE_TEST];
    *asked = *comparison;
    enum neph_status status = neph_sides_check(sides, request->window, asked, diag);
    if (!status)
        status = neph_cli_page_begin(request->page, &work.page, diag);
    if (!status && asked->with_movement)
        neph_cli_page_add_comparison(&work.page, NEPH_PAGE_TEST, asked);
    if (!status)
        status = neph_comparison_run(asked, sides->other.count > 0, compared, diag);
    if (compared->asked)
        status = tell(&work, status, diag);
    for (int side = 0; side < NEPH_PAGE_SIDES; side++)
        neph_compared_finish(&work.compared[side]);
    json_decref(work.limits_json);
    neph_cli_page_end(&work.page);
    return status;
}

/* Write the JUnit file; none for a wrong command line. */
static enum neph_status write_junit(const struct request *request, enum neph_status status,
                                    struct neph_junit *junit, struct neph_diag *diag)
{
    if (!request->junit || status == NEPH_ERR_USAGE)
        return status;
    if (junit->count == 0) { /* the run failed before it measured anything */
        add_limits(request, NULL, diag, junit);
        add_run(request, limit_count(request) == 0 ? status : NEPH_OK, diag, junit);
    }
    const enum neph_status written = neph_junit_write(junit, request->junit, status ? NULL : diag);
    return status ? status : written;
}

/* ---- noise or bias --------------------------------------------------------------------------- */

/* Refuse options that --z would ignore, and --z where it says nothing. */
static enum neph_status check_z(const struct request *request, const struct neph_sides *sides,
                                struct neph_diag *diag)
{
    const struct {
        bool is_given;
        const char *name;
    } others[] = {
        {request->metrics.count > 0, "metric"},
        {request->shared.settings.count > 0, "set"},
        {request->mask, "mask"},
        {request->rings, "rings"},
        {request->frame_choice.convert, "convert"},
        {request->second, "second-reference"},
        {request->versus, "versus"},
        {request->partner, "partner"},
        {request->warm_up_frames > 0, "warm-up"},
        {request->above.count > 0, "fail-above"},
        {request->below.count > 0, "fail-below"},
        {request->limits_path, "limits"},
        {request->csv, "csv"},
        {request->page, "page"},
    };
    if (request->temporal)
        return neph_fail(diag, NEPH_ERR_USAGE, "--z compares renders: use `neph compare --z`");
    for (size_t i = 0; i < sizeof(others) / sizeof(others[0]); i++)
        if (others[i].is_given)
            return neph_fail(diag, NEPH_ERR_USAGE, "--z takes no --%s", others[i].name);
    if (sides->other.count == 0)
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_USAGE, "--z compares one test with the reference");
    neph_hint(diag, "name the seeds of a render by a folder or by a pattern in quotes");
    return NEPH_ERR_USAGE;
}

static enum neph_status run_z(const struct request *request, const struct neph_sides *sides,
                              struct neph_junit *junit, struct neph_diag *diag)
{
    const struct neph_cli_z z = {
        .reference = &sides->reference,
        .test = &sides->test,
        .reading = {.choice = request->frame_choice,
                    .variance = request->variance,
                    .samples = request->samples,
                    .negative_allowed = request->negative_is_fine ? SIZE_MAX : 0},
        .window = request->window,
        .maps = request->maps,
        .group = junit_group(request, junit),
        .json = request->shared.json,
        .quiet = request->shared.quiet,
        .all = request->all,
    };
    const enum neph_status status = check_z(request, sides, diag);
    return status ? status : neph_cli_z_run(&z, junit, diag);
}

/* Without --z. */
static enum neph_status run_metrics(const struct request *request, struct neph_sides *sides,
                                    struct neph_junit *junit, struct neph_diag *diag)
{
    struct neph_comparison comparison = {.choice_count = 0};
    enum neph_status status = prepare(request, sides, &comparison, diag);
    if (!status)
        status = measure(request, &comparison, sides, junit, diag);
    neph_comparison_finish(&comparison);
    return status;
}

static enum neph_status run(const struct neph_cli_syntax *syntax, bool temporal, int argc,
                            char **argv, struct neph_diag *diag)
{
    struct request request = {.temporal = temporal};
    struct neph_sides sides = {.without_reference = false};
    struct neph_limits limits = {.path = NULL};
    struct neph_colour_source *colours = NULL;
    struct neph_junit junit = {.name = temporal ? "neph flicker" : "neph compare"};
    neph_cli_parse(syntax, argc, argv, &request);
    if (request.shared.jobs > 0)
        neph_set_thread_count(request.shared.jobs);
    neph_heap_keep();
    request.frame_choice.clips = &request.clips;
    const double start_s = neph_wall_s();
    const struct neph_side_words words = {
        .references = request.references.list,
        .reference_count = request.references.count,
        .operands = request.shared.operands,
        .operand_count = request.shared.operand_count,
        .versus = request.versus,
        .by_position = request.by_position || request.z, /* seeds are no frame numbers */
        .is_flicker = temporal,
    };
    enum neph_status status = neph_oiio_server_create(&request.frame_choice.server, diag);
    if (!status && request.ocio)
        status = neph_colour_config_open(request.ocio, request.space, &colours, diag);
    request.frame_choice.colours = colours;
    if (!status && request.limits_path) {
        status = neph_limits_read(request.limits_path, &limits, diag);
        request.limits = status ? NULL : &limits;
    }
    if (!status && request.partner)
        status = neph_partner_find(request.partner, &request.partner_display, diag);
    if (!status)
        status = neph_sides_find(&words, request.warm_up_frames, &sides, diag);
    if (!status)
        status = request.z ? run_z(&request, &sides, &junit, diag)
                           : run_metrics(&request, &sides, &junit, diag);
    junit.seconds = neph_wall_s() - start_s;
    status = write_junit(&request, status, &junit, diag);
    neph_junit_finish(&junit);
    neph_sides_finish(&sides);
    neph_limits_finish(&limits);
    neph_clips_close(&request.clips);
    neph_colour_config_close(colours);
    neph_oiio_server_destroy(request.frame_choice.server);
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
