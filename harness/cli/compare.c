/* SPDX-License-Identifier: MIT
 *
 * `neph compare REFERENCE TEST`: error of frames, each by itself.
 */
#include "harness/cli/cli.h"

#include "harness/cli/comparison.h"

static const struct neph_cli_operands operands = {
    .shown = "REFERENCE TEST",
    .minimum = 2,
    .maximum = 2,
    .missing = "two images or sequences are needed: REFERENCE TEST",
    .surplus = "a reference and a test (quote patterns)",
};

static const struct neph_cli_syntax syntax = {
    .options = neph_cli_comparison_options,
    .operands = &operands,
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
    struct neph_cli_comparison request = {.purpose = NULL};
    neph_cli_parse(&syntax, argc, argv, &request);
    struct neph_comparison comparison = {.choice_count = 0};
    enum neph_status status = neph_cli_comparison_prepare(&request, false, &comparison, diag);
    comparison.frozen_is_fine = true; /* nothing here speaks of stability */
    if (!status)
        status = neph_sequence_find(1, &request.shared.operands[0], comparison.by_position,
                                    &comparison.reference, diag);
    if (!status)
        status = neph_sequence_find(1, &request.shared.operands[1], comparison.by_position,
                                    &comparison.test, diag);
    if (!status)
        status = neph_cli_comparison_run(&request, &comparison, diag);
    neph_comparison_finish(&comparison);
    return status;
}
