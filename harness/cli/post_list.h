/* SPDX-License-Identifier: MIT
 *
 * `neph post --list`.
 */
#ifndef NEPH_HARNESS_CLI_POST_LIST_H
#define NEPH_HARNESS_CLI_POST_LIST_H

#include "harness/cli/cli.h"
#include "renderer/post/plan.h"

/* All stages in their usual order; each line begins with the indent. */
void neph_cli_post_print_stages(const char *indent);
json_t *neph_cli_post_stages_json(void);

/* Print what a chain has on, and its volumes; NULL: all stages, settings and presets. */
enum neph_status neph_cli_post_list(const struct neph_post_plan *plan, bool as_json,
                                    struct neph_diag *diag);

#endif
