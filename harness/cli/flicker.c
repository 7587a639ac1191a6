/* SPDX-License-Identifier: MIT
 *
 * `neph flicker --reference REFERENCE... TEST...`: how a sequence moves where it should not.
 */
#include "harness/cli/cli.h"

#include "harness/cli/comparison.h"

#include <stdlib.h>

struct request {
    struct neph_cli_comparison comparison;
    struct neph_cli_words references;
};

static const struct neph_cli_option options[] = {
    {"reference", 'r', "WORD",
     "The reference: one frame, or as many as the test has; may be given several times",
     NEPH_CLI_WORDS, .at = offsetof(struct request, references)},
    {.name = NULL},
};

static const struct neph_cli_operands operands = {.shown = "--reference REFERENCE... TEST..."};

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    if (request->references.count == 0 || request->comparison.shared.operand_count == 0)
        argp_error(state, "both are needed: --reference REFERENCE and TEST");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .more = neph_cli_comparison_options,
    .check = check,
    .operands = &operands,
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
        "  neph flicker --reference lights/ taa/ -s lag.step_frame=16 --metric lag\n"
        "  neph flicker --reference sines/ taa/ --warm-up 64 -s follow.period_1=32 -m follow\n"
        "  neph flicker --reference ref.png 'game/*.png' --fps 30 --fail-above "
        "a4_p95@all=0.0157",
};

/* What a shell has expanded behind --reference is put back where it belongs. */
static enum neph_status split(const struct request *request, struct neph_comparison *comparison,
                              struct neph_diag *diag)
{
    const int given = request->references.count;
    const int operand_count = request->comparison.shared.operand_count;
    const char *const *words = request->comparison.shared.operands;
    bool *is_reference = calloc((size_t)operand_count, sizeof(*is_reference));
    const char **references = calloc((size_t)(given + operand_count), sizeof(*references));
    const char **tests = calloc((size_t)operand_count, sizeof(*tests));
    enum neph_status status = is_reference && references && tests ? NEPH_OK
                                                                  : neph_fail_memory(diag);
    if (!status)
        status = neph_sequence_split(given, request->references.list, operand_count, words,
                                     is_reference, diag);
    int reference_count = 0, test_count = 0;
    for (int i = 0; i < given && !status; i++)
        references[reference_count++] = request->references.list[i];
    for (int i = 0; i < operand_count && !status; i++) {
        if (is_reference[i])
            references[reference_count++] = words[i];
        else
            tests[test_count++] = words[i];
    }
    if (!status)
        status = neph_sequence_find(reference_count, references, comparison->by_position,
                                    &comparison->reference, diag);
    if (!status)
        status = neph_sequence_find(test_count, tests, comparison->by_position, &comparison->test,
                                    diag);
    free(is_reference);
    free(references);
    free(tests);
    return status;
}

enum neph_status neph_cli_flicker(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {.comparison = {.purpose = "flicker"}};
    neph_cli_parse(&syntax, argc, argv, &request);
    struct neph_comparison comparison = {.choice_count = 0};
    enum neph_status status = neph_cli_comparison_prepare(&request.comparison, true, &comparison,
                                                          diag);
    if (!status)
        status = split(&request, &comparison, diag);
    if (!status)
        status = neph_cli_comparison_run(&request.comparison, &comparison, diag);
    neph_comparison_finish(&comparison);
    return status;
}
