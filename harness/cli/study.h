/* SPDX-License-Identifier: MIT
 *
 * The kinds of `neph study`.
 */
#ifndef NEPH_HARNESS_CLI_STUDY_H
#define NEPH_HARNESS_CLI_STUDY_H

#include "harness/cli/cli.h"

neph_verb neph_cli_study_steps;
neph_verb neph_cli_study_flicker;

#endif
