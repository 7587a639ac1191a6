/* SPDX-License-Identifier: MIT
 *
 * The command line: one function and one file for each verb. Only results go to stdout; progress
 * and problems go to stderr.
 */
#ifndef NEPH_HARNESS_CLI_CLI_H
#define NEPH_HARNESS_CLI_CLI_H

#include "base/option.h"
#include "base/scratch.h"
#include "base/status.h"
#include "harness/json.h"
#include "harness/options.h"
#include "harness/run/store.h"

/* Run a verb on its own arguments (argv[0] is "neph VERB"). */
typedef enum neph_status neph_verb(int argc, char **argv, struct neph_diag *diag);

neph_verb neph_cli_render;
neph_verb neph_cli_fly;
neph_verb neph_cli_export;
neph_verb neph_cli_bake;
neph_verb neph_cli_droplets;
neph_verb neph_cli_fluxes;
neph_verb neph_cli_benchmark;
neph_verb neph_cli_compare;
neph_verb neph_cli_flicker;
neph_verb neph_cli_fit;
neph_verb neph_cli_limits;
neph_verb neph_cli_view;
neph_verb neph_cli_post;
neph_verb neph_cli_metrics;
neph_verb neph_cli_conform;
neph_verb neph_cli_study;
neph_verb neph_cli_nightly;
neph_verb neph_cli_baseline;
neph_verb neph_cli_serve;
neph_verb neph_cli_store;
neph_verb neph_cli_scenes;
neph_verb neph_cli_engines;
neph_verb neph_cli_doctor;

/* Create the output folder if needed, and remove scratch folders in it that killed runs have
 * left. */
enum neph_status neph_cli_open_folder(const char *output, struct neph_diag *diag);

/* Open the store in that folder. NEPH_ERR_NOT_FOUND: there is none; other errors as of
 * neph_store_open(). */
enum neph_status neph_cli_open_store(const char *output, struct neph_store **store,
                                     struct neph_diag *diag);

/* Create a scratch folder for an engine's files inside that folder. End it with
 * neph_cli_end_scratch(). */
enum neph_status neph_cli_begin_scratch(const char *output, struct neph_scratch **scratch,
                                        struct neph_diag *diag);

/* Remove the scratch folder. After a failure of the engine (`status`), a folder with logs stays and
 * the diag names it. `scratch` may be NULL. */
void neph_cli_end_scratch(struct neph_scratch *scratch, enum neph_status status,
                          struct neph_diag *diag);

/* Refuse --ocio without --convert, and --space without --ocio. */
void neph_cli_check_colours(const char *ocio, const char *space, bool convert,
                            const struct argp_state *state);

/* A table of options, as JSON and as text. */
json_t *neph_cli_options_json(const struct neph_option *options);
void neph_cli_print_options(const struct neph_option *options);

/* A list of presets (NULL: none), as JSON and as text; each line starts with `indent` spaces. */
json_t *neph_cli_presets_json(const struct neph_preset *presets);
void neph_cli_print_presets(const struct neph_preset *presets, int indent);

/* The stages of the post-processing chain, as JSON and as text. */
json_t *neph_cli_post_stages_json(void);
void neph_cli_post_print_stages(const char *indent);

/* Print on stderr that the results of a verb are in that folder. */
void neph_cli_print_folder(const char *verb, const char *folder);

/* Print JSON on stdout if `wanted`; always takes the reference over. */
enum neph_status neph_cli_print_json(json_t *json, bool wanted, struct neph_diag *diag);

#endif
