/* SPDX-License-Identifier: MIT
 *
 * `neph compare REFERENCE TEST`: error of frames, each by itself.
 */
#include "harness/cli/cli.h"

#include "harness/cli/comparison.h"

struct request {
    struct neph_cli_comparison shared;
    const char *reference, *test;
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct request *request = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &request->shared;
        return 0;
    case ARGP_KEY_ARG:
        if (!request->reference)
            request->reference = argument;
        else if (!request->test)
            request->test = argument;
        else
            argp_error(state, "a reference and a test, not '%s' as well; quote patterns", argument);
        return 0;
    case ARGP_KEY_END:
        if (!request->test)
            argp_error(state, "two images or sequences are needed: REFERENCE TEST");
        return 0;
    }
    return ARGP_ERR_UNKNOWN;
}

static const struct argp_child children[] = {{&neph_cli_comparison_argp, 0, NULL, 0}, {0}};

static const struct argp argp = {
    .parser = parse,
    .children = children,
    .args_doc = "REFERENCE TEST",
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

enum neph_status neph_cli_compare(int argc, char **argv, struct neph_diag *diag)
{
    struct request request = {.reference = NULL};
    neph_cli_parse(&argp, argc, argv, &request);
    struct neph_comparison comparison = {.choice_count = 0};
    enum neph_status status = neph_cli_comparison_prepare(&request.shared, false, &comparison,
                                                          diag);
    comparison.frozen_is_fine = true; /* nothing here speaks of stability */
    if (!status)
        status = neph_sequence_find(1, &request.reference, &comparison.reference, diag);
    if (!status)
        status = neph_sequence_find(1, &request.test, &comparison.test, diag);
    if (!status)
        status = neph_cli_comparison_run(&request.shared, &comparison, diag);
    neph_comparison_finish(&comparison);
    return status;
}
