/* SPDX-License-Identifier: MIT
 *
 * What `neph compare` and `neph flicker` have in common: their options and their output.
 */
#ifndef NEPH_HARNESS_CLI_COMPARISON_H
#define NEPH_HARNESS_CLI_COMPARISON_H

#include "harness/options.h"
#include "harness/compare/comparison.h"

/* What is asked for; the shared settings are of extractors. */
struct neph_cli_comparison {
    struct neph_cli_shared shared;
    const char *purpose; /* the extractor that the verb is there for, when none is named; or NULL */
    struct neph_cli_words metrics, above, below; /* the latter two limits */
    const char *mask, *csv, *maps, *layer;
    const char *second; /* words of the second reference */
    const char *versus; /* words of the other test */
    double frame_rate_hz, pixels_per_degree, exposure_ev, white_cd_per_m2; /* NaN: as usual */
    int warm_up_frames;
    bool rings, by_position, frozen_is_fine, negative_is_fine;
};

/* Options of a struct neph_cli_comparison. */
extern const struct neph_cli_option neph_cli_comparison_options[];

/* Fill the choices, the viewing conditions and the rest of `comparison` (not its sequences) from
 * the options. `temporal`: without --metric, the extractors of sequences instead of those of single
 * frames. */
enum neph_status neph_cli_comparison_prepare(const struct neph_cli_comparison *asked, bool temporal,
                                             struct neph_comparison *comparison,
                                             struct neph_diag *diag);

/* Run it; print the results as a table or JSON, write the CSV, check the limits. */
enum neph_status neph_cli_comparison_run(const struct neph_cli_comparison *asked,
                                         const struct neph_comparison *comparison,
                                         struct neph_diag *diag);

#endif
