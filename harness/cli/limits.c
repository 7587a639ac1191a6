/* SPDX-License-Identifier: MIT
 *
 * `neph limits RUN...`: how much frames differ from run to run, as a file of limits for `neph
 * compare --limits FILE` and `neph flicker --limits FILE`.
 */
#include "harness/cli/cli.h"

#include "base/files.h"
#include "base/hash.h"
#include "base/heap.h"
#include "base/threads.h"
#include "harness/cli/limits_night.h"
#include "harness/compare/alone.h"
#include "harness/compare/choice.h"
#include "harness/compare/headlines.h"
#include "harness/compare/repeats.h"
#include "harness/progress.h"
#include "metrics/colour_config.h"
#include "metrics/extractors/extractors.h"
#include "metrics/run_limit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- options --------------------------------------------------------------------------------- */

struct request {
    struct neph_cli_shared shared;
    struct neph_cli_words references;
    struct neph_cli_list metrics;
    struct neph_frame_choice frame_choice;
    const char *ocio, *space; /* a config with colour spaces, and its name of linear Rec.709 */
    const char *environment;
    double share, confidence;
    double frame_rate_hz, pixels_per_degree, exposure_ev, white_cd_per_m2; /* NaN: the default */
    int warm_up_frames;
    bool temporal, by_position, negative_is_fine;
};

enum { MEASURING, VIEWING, JUDGING, WRITING }; /* groups of the help */

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"reference", 0, NULL,
     "The reference of later comparisons (default: the first run); may be given several times",
     NEPH_CLI_WORDS, AT(references)},
    {"metric", 'm', "NAME[,NAME]",
     "Extractors, some of their metrics, or 'all'. Fewer numbers have narrower limits",
     NEPH_CLI_NAMES, AT(metrics)},
    {.name = "set", .argument = "EXTRACTOR:KEY=VALUE", .help = "A setting of an extractor"},
    {"temporal", 0, NULL,
     "The metrics of `neph flicker` in place of those of `neph compare`; without -r, the runs have "
     "no reference",
     NEPH_CLI_FLAG, AT(temporal)},
    {"warm-up", 0, "N", "Leave out the first N frames of each run", NEPH_CLI_INTEGER,
     AT(warm_up_frames), "0", 0, 1000000},
    {"by-position", 0, NULL,
     "Frames belong together by their place in the sequence, whatever their numbers", NEPH_CLI_FLAG,
     AT(by_position)},
    {"part", .kind = NEPH_CLI_WORD, AT(frame_choice.part)},
    {"layer", .kind = NEPH_CLI_WORD, AT(frame_choice.layer)},
    {"convert", .kind = NEPH_CLI_FLAG, AT(frame_choice.convert)},
    {"ocio", .kind = NEPH_CLI_WORD, AT(ocio)},
    {"space", .kind = NEPH_CLI_WORD, AT(space)},
    {"negative-ok", 0, NULL, "Values below 0 are no reason to stop", NEPH_CLI_FLAG,
     AT(negative_is_fine)},
    {"fps", .kind = NEPH_CLI_REAL, AT(frame_rate_hz), .group = VIEWING},
    {"ppd", .kind = NEPH_CLI_REAL, AT(pixels_per_degree), .group = VIEWING},
    {"exposure", 0, NULL, "Display value = 2^EV times radiance (default: 0)", NEPH_CLI_REAL,
     AT(exposure_ev), .group = VIEWING},
    {"white", .kind = NEPH_CLI_REAL, AT(white_cd_per_m2), .group = VIEWING},
    {"share", 0, "P", "Share of further runs that are within all limits", NEPH_CLI_REAL, AT(share),
     "0.95", 0.5, 0.9999, .group = JUDGING},
    {"confidence", 0, "C", "Confidence that the limits hold for this share", NEPH_CLI_REAL,
     AT(confidence), "0.95", 0.5, 0.9999, .group = JUDGING},
    {"environment", 0, "TEXT",
     "Program and device of the runs (default: as the frames state them); a comparison with frames "
     "of another one warns",
     NEPH_CLI_WORD, AT(environment), .group = JUDGING},
    {.name = "output",
     .help = "Folder of limits.json",
     .otherwise = "out/limits",
     .group = WRITING},
    {"all", 0, NULL, "All limits, and the numbers without a limit", NEPH_CLI_FLAG,
     .at = offsetof(struct request, shared) + offsetof(struct neph_cli_shared, all),
     .group = WRITING},
    {.name = "json", .group = WRITING},
    {"jobs", 0, NULL, "Threads; numbers do not depend on it (default: as many as processors)",
     NEPH_CLI_INTEGER,
     .at = offsetof(struct request, shared) + offsetof(struct neph_cli_shared, jobs), .minimum = 1,
     .maximum = 256, .group = WRITING},
    {.name = "quiet", .group = WRITING},
    {.name = NULL},
};
#undef AT

static const struct neph_cli_operands operands = {.shown = "RUN..."};

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    neph_cli_check_colours(request->ocio, request->space, request->frame_choice.convert, state);
    if (request->frame_choice.convert && neph_cli_are_nightly_runs(&request->shared))
        argp_error(state, "--convert is for frames, not for reports of nightly runs");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &operands,
    .check = check,
    .doc =
        "Measure how much frames of a renderer differ from run to run, and write a file of limits "
        "for `neph compare --limits` and `neph flicker --limits`.\v"
        "Each RUN is one run of the same frames, with another seed or of a renderer that is not "
        "deterministic: a file, a folder (its .exr files, else its .png files), or a pattern in "
        "quotes. Each is compared with the reference; 5 runs are the least, 10 make useful limits, "
        "20 narrow ones. With the confidence C at least the share P of further runs is within all "
        "limits, and a further run is beyond any of them with probability (1 - P)(1 - C) at most. "
        "When all runs are equal the limits are their numbers. A limit holds for frames of the "
        "same size, number, reference and display. Reports of nightly runs with different seeds "
        "(nightly.json) make limits of their series, for `neph nightly --limits`.\n\n"
        "Examples:\n"
        "  neph limits runs/seed_*.exr -o limits\n"
        "  neph compare -r runs/seed_1.exr march.exr --limits limits/limits.json\n"
        "  neph limits -r reference.exr runs/* -m rel_rmse,flip_mean\n"
        "  neph limits --temporal nights/* -o flicker",
};

/* ---- runs ------------------------------------------------------------------------------------ */

/* The state of the verb. */
struct work {
    const struct request *request;
    struct neph_sequence reference; /* owned; empty: none */
    int first_run;                  /* 1: the first operand is the reference */
    struct neph_comparison form;    /* extractors and conditions; without sequences */
    struct neph_repeats repeats;
    struct neph_limits limits;
};

static int run_count(const struct work *work)
{
    return work->request->shared.operand_count - work->first_run;
}

static enum neph_status check_count(const struct work *work, struct neph_diag *diag)
{
    const int least = NEPH_RUN_LIMIT_RUNS_MIN, given = work->request->shared.operand_count;
    if (run_count(work) >= least)
        return NEPH_OK;
    if (work->first_run > 0)
        neph_fail(diag, NEPH_ERR_USAGE,
                  "%d run%s named, at least %d are needed: the first is the reference, %d show the "
                  "spread",
                  given, given == 1 ? " is" : "s are", least + 1, least);
    else
        neph_fail(diag, NEPH_ERR_USAGE, "%d run%s named, at least %d are needed", given,
                  given == 1 ? " is" : "s are", least);
    neph_hint(diag, "each operand is one run: put a pattern in quotes only for the frames of one");
    return NEPH_ERR_USAGE;
}

/* The reference: of -r, the first run, or none. */
static enum neph_status find_reference(struct work *work, struct neph_diag *diag)
{
    const struct request *request = work->request;
    if (request->references.count > 0)
        return neph_sequence_find(request->references.count, request->references.list,
                                  request->by_position, &work->reference, diag);
    if (request->temporal)
        return NEPH_OK;
    work->first_run = 1;
    const enum neph_status status = check_count(work, diag);
    return status ? status
                  : neph_sequence_find(1, request->shared.operands, request->by_position,
                                       &work->reference, diag);
}

/* The sequences of a run. Without a reference the first measured frame stands in its place. */
static enum neph_status find_run(const struct work *work, int run,
                                 struct neph_comparison *comparison, struct neph_diag *diag)
{
    const struct request *request = work->request;
    const char *const *word = &request->shared.operands[work->first_run + run];
    enum neph_status status = neph_sequence_find(1, word, request->by_position, &comparison->test,
                                                 diag);
    if (status)
        return status;
    const int first = request->warm_up_frames < comparison->test.count ? request->warm_up_frames
                                                                       : 0;
    const char *still = comparison->test.paths[first];
    if (comparison->without_reference)
        return neph_sequence_find(1, &still, true, &comparison->reference, diag);
    if (!neph_path_is_same(work->reference.paths[0], comparison->test.paths[0]))
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_USAGE, "'%s' is the reference and a run", comparison->test.paths[0]);
    neph_hint(diag, "leave it out of the runs, or leave out -r: the first run is then the "
                    "reference");
    return NEPH_ERR_USAGE;
}

static enum neph_status check_same_count(const struct work *work, int run, int count,
                                         struct neph_diag *diag)
{
    if (run == 0 || count == work->limits.frame_count)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_INPUT, "'%s' has %d frames, '%s' has %d: as many are needed",
                     work->request->shared.operands[work->first_run], work->limits.frame_count,
                     work->request->shared.operands[work->first_run + run], count);
}

static bool is_wanted(const struct neph_measurement *number, const void *context)
{
    const struct request *request = context;
    const struct neph_extractor *owner = NULL;
    neph_metric_find(number->metric->name, &owner);
    for (int i = 0; i < request->metrics.count; i++) {
        const char *word = request->metrics.words[i];
        if (strcmp(word, "all") == 0 || strcmp(word, owner->name) == 0 ||
            strcmp(word, number->metric->name) == 0)
            return true;
    }
    return request->metrics.count == 0;
}

/* What the limits are for: the frames of the first run. */
static enum neph_status describe(struct work *work, const struct neph_comparison *comparison,
                                 const struct neph_compared *compared, struct neph_diag *diag)
{
    const struct request *request = work->request;
    struct neph_limits *limits = &work->limits;
    struct neph_frame_origin origin;
    const char *reference = work->reference.count > 0 ? work->reference.paths[0] : NULL;
    char digest[NEPH_HASH_HEX_SIZE] = "";
    enum neph_status status = neph_frame_origin_read(
        comparison->test.paths[comparison->warm_up_frames], &comparison->frame_choice,
        comparison->negative_allowed, &origin, diag);
    if (!status && reference)
        status = neph_hash_file(reference, digest, diag);
    if (status)
        return status;
    limits->environment = neph_arena_copy_text(
        &limits->arena, request->environment ? request->environment : origin.environment);
    limits->reference = neph_arena_copy_text(&limits->arena, reference);
    limits->reference_digest = neph_arena_copy_text(&limits->arena, reference ? digest : NULL);
    limits->width_px = origin.width_px;
    limits->height_px = origin.height_px;
    limits->frame_count = compared->frame_count;
    limits->warm_up_frames = comparison->warm_up_frames;
    limits->viewing = compared->viewing;
    limits->settings = request->shared.settings.list;
    limits->setting_count = request->shared.settings.count;
    return neph_arena_check(&limits->arena, diag);
}

static enum neph_status measure_run(struct work *work, int run, struct neph_diag *diag)
{
    struct neph_comparison comparison = work->form;
    struct neph_compared compared = {.asked = NULL};
    enum neph_status status = find_run(work, run, &comparison, diag);
    if (!comparison.without_reference)
        comparison.reference = work->reference;
    if (!status)
        status = check_same_count(work, run, comparison.test.count - comparison.warm_up_frames,
                                  diag);
    if (!status)
        status = neph_windows_find(
            (const struct neph_sequence *[]){&comparison.reference, &comparison.test}, 2, "union",
            &comparison.frame_choice, &comparison.windows, diag);
    if (!status)
        status = neph_comparison_run(&comparison, false, &compared, diag);
    if (!status && run == 0)
        status = describe(work, &comparison, &compared, diag);
    neph_measurements_select(&compared.numbers, is_wanted, work->request);
    if (!status)
        status = neph_repeats_add(&work->repeats, &compared.numbers, diag);
    if (!comparison.without_reference)
        comparison.reference = (struct neph_sequence){.count = 0}; /* of the verb */
    neph_compared_finish(&compared);
    neph_comparison_finish(&comparison);
    return status;
}

static enum neph_status measure_runs(struct work *work, struct neph_diag *diag)
{
    const int count = run_count(work);
    struct neph_progress progress = neph_progress_start(work->request->shared.quiet, count);
    enum neph_status status = NEPH_OK;
    work->repeats.run_count = count;
    for (int run = 0; run < count && !status; run++) {
        const char *name = work->request->shared.operands[work->first_run + run];
        neph_progress_begin(&progress, name);
        status = measure_run(work, run, diag);
        if (!status)
            neph_progress_tick(&progress, name);
    }
    neph_progress_end(&progress);
    if (status == NEPH_ERR_INTERRUPTED)
        return neph_fail(diag, status, "interrupted after %d of %d runs: no limits were written",
                         work->repeats.done_count, count);
    return status;
}

/* ---- limits ---------------------------------------------------------------------------------- */

static enum neph_status check_copies(const struct work *work, struct neph_diag *diag)
{
    const char *const *runs = work->request->shared.operands + work->first_run;
    int first, second;
    if (!neph_repeats_find_copies(&work->repeats, &first, &second))
        return NEPH_OK;
    neph_fail(diag, NEPH_ERR_INPUT, "the runs '%s' and '%s' have the same numbers, others differ",
              runs[first], runs[second]);
    neph_hint(diag, "repeats need different seeds; leave copies out");
    return NEPH_ERR_INPUT;
}

static void print_limit(const struct neph_measured_limit *limit)
{
    const char *unit = strcmp(limit->unit, "1") == 0 ? "" : limit->unit;
    printf("%-13s %-14s %-22s %11.5g to %-11.5g %s %.5g%s%s\n", limit->limit.quantity,
           limit->limit.mask, limit->limit.metric, limit->lowest, limit->highest,
           limit->limit.below ? ">=" : "<=", limit->limit.value, *unit ? " " : "", unit);
}

/* The limits of the most important numbers over all pixels. */
static void print_headlines(const struct neph_limits *limits)
{
    for (int h = 0; h < NEPH_HEADLINES; h++)
        for (int i = 0; i < limits->count; i++)
            if (strcmp(limits->list[i].limit.metric, neph_headlines[h].metric) == 0 &&
                strcmp(limits->list[i].limit.quantity, neph_headlines[h].quantity) == 0 &&
                strcmp(limits->list[i].limit.mask, "all") == 0)
                print_limit(&limits->list[i]);
}

static void print_all(const struct neph_limits *limits)
{
    for (int i = 0; i < limits->count; i++)
        print_limit(&limits->list[i]);
    for (int i = 0; i < limits->unlimited_count; i++)
        printf("%-13s %-14s %-22s no limit: %s\n", limits->unlimited[i].limit.quantity,
               limits->unlimited[i].limit.mask, limits->unlimited[i].limit.metric,
               limits->unlimited[i].because);
}

static void print_guarantee(const struct neph_limits *limits, int noisy)
{
    const struct neph_run_limit_family family = {limits->share, limits->confidence, noisy};
    printf("with %g %% confidence at least %g %% of further runs are within all of them; a further "
           "run is beyond any with probability %.2g at most\n",
           100.0 * limits->confidence, 100.0 * limits->share, neph_run_limit_alarm_rate(&family));
    printf("limit: mean and %.1f standard deviations, on a scale of values and of logarithms; %.1f "
           "with %d runs\n",
           neph_run_limit_factor(&family, limits->run_count, NEPH_RUN_LIMIT_ABOVE),
           neph_run_limit_factor(&family, 2 * limits->run_count, NEPH_RUN_LIMIT_ABOVE),
           2 * limits->run_count);
}

static void print_limits(const struct request *request, const struct neph_limits *limits,
                         const char *path)
{
    const int noisy = neph_limits_count_noisy(limits);
    printf("%d limits of %d runs in '%s'%s\n", limits->count, limits->run_count, path,
           noisy > 0 ? "" : ": all runs are equal, and a further run has to be, too");
    if (request->shared.quiet)
        return;
    if (noisy > 0)
        print_guarantee(limits, noisy);
    printf("environment: %s\n", limits->environment[0]
                                    ? limits->environment
                                    : "not stated by the frames; --environment TEXT names it");
    if (request->shared.all) {
        print_all(limits);
        return;
    }
    print_headlines(limits);
    if (limits->unlimited_count > 0)
        printf("%d numbers have no limit: --all names the reasons\n", limits->unlimited_count);
}

static enum neph_status conclude(struct work *work, struct neph_diag *diag)
{
    const struct neph_cli_shared *shared = &work->request->shared;
    const struct neph_path path = neph_path_in(shared->output, "limits.json");
    enum neph_status status = check_copies(work, diag);
    if (!status)
        status = neph_repeats_limit(&work->repeats, &work->limits, diag);
    if (!status && work->limits.count == 0)
        status = neph_fail(
            diag, NEPH_ERR_UNSUPPORTED, "none of %d numbers has a limit%s%s",
            work->limits.unlimited_count, work->limits.unlimited_count > 0 ? ": " : "",
            work->limits.unlimited_count > 0 ? work->limits.unlimited[0].because : "");
    if (!status)
        status = neph_dir_create(shared->output, diag);
    if (!status)
        status = neph_limits_write(&work->limits, path.text, diag);
    if (!status && shared->json)
        status = neph_json_print(neph_limits_json(&work->limits), diag);
    else if (!status)
        print_limits(work->request, &work->limits, path.text);
    return status;
}

/* ---- the verb -------------------------------------------------------------------------------- */

static enum neph_status choose(struct work *work, struct neph_diag *diag)
{
    const struct request *request = work->request;
    struct neph_comparison *form = &work->form;
    *form = (struct neph_comparison){
        .source = &neph_frame_files,
        .without_reference = work->reference.count == 0,
        .viewing = neph_viewing_complete(
            (struct neph_viewing){request->frame_rate_hz, request->pixels_per_degree,
                                  request->exposure_ev, request->white_cd_per_m2}),
        .own_frame_rate = isnan(request->frame_rate_hz),
        .warm_up_frames = request->warm_up_frames,
        .detail_masks = request->temporal,
        .frame_choice = request->frame_choice,
        .negative_allowed = request->negative_is_fine ? SIZE_MAX : 0,
        .allow_frozen_frames = true,
        .by_position = request->by_position,
        .plain = true,
        .quiet = true,
    };
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < request->metrics.count && !status; i++)
        status = neph_choose_word(form, request->metrics.words[i], diag);
    if (!status && request->metrics.count == 0)
        neph_choose_usual(form, request->temporal);
    for (int i = 0; i < request->shared.settings.count && !status; i++)
        status = neph_choose_setting(form, request->shared.settings.list[i], diag);
    return status ? status : neph_choice_check_reference(form, NULL, diag);
}

enum neph_status neph_cli_limits(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {.temporal = false};
    struct work work = {.request = &request};
    neph_cli_parse(&syntax, argc, argv, &request);
    if (request.shared.jobs > 0)
        neph_set_thread_count(request.shared.jobs);
    neph_heap_keep();
    if (neph_cli_are_nightly_runs(&request.shared))
        return neph_cli_limit_nights(&request.shared, request.share, request.confidence, diag);
    work.limits.share = request.share;
    work.limits.confidence = request.confidence;
    struct neph_colour_source *colours = NULL;
    enum neph_status status = neph_oiio_server_create(&request.frame_choice.server, diag);
    if (!status && request.ocio)
        status = neph_colour_config_open(request.ocio, request.space, &colours, diag);
    request.frame_choice.colours = colours;
    if (!status)
        status = find_reference(&work, diag);
    if (!status)
        status = check_count(&work, diag);
    if (!status)
        status = choose(&work, diag);
    if (!status)
        status = measure_runs(&work, diag);
    if (!status)
        status = conclude(&work, diag);
    neph_repeats_finish(&work.repeats);
    neph_limits_finish(&work.limits);
    neph_sequence_finish(&work.reference);
    neph_colour_config_close(colours);
    neph_oiio_server_destroy(request.frame_choice.server);
    return status;
}
