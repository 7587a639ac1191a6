/* SPDX-License-Identifier: MIT
 *
 * What `neph compare` and `neph flicker` have in common: their options and their output.
 */
#ifndef NEPH_HARNESS_CLI_COMPARISON_H
#define NEPH_HARNESS_CLI_COMPARISON_H

#include "harness/compare/comparison.h"

#include <argp.h>

enum { NEPH_CLI_LIMITS_MAX = 32 };

/* A limit of --fail-above or --fail-below, as written. */
struct neph_cli_limit {
    const char *text;
    bool below;
};

struct neph_cli_comparison {
    const char *purpose; /* the extractor that the verb is there for, when none is named; or NULL */
    const char *metrics[NEPH_CHOICES_MAX];
    const char *settings[NEPH_CHOICES_MAX];
    struct neph_cli_limit limits[NEPH_CLI_LIMITS_MAX];
    int metric_count, setting_count, limit_count;
    const char *mask, *csv, *maps, *layer;
    const char *second; /* words of the second reference */
    const char *versus; /* words of the other test */
    const char *viewing[4];
    const char *warm_up;
    bool json, quiet, rings, by_position, frozen_is_fine, negative_is_fine;
};

/* An argp child; its input is a struct neph_cli_comparison. */
extern const struct argp neph_cli_comparison_argp;

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
