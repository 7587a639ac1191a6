/* SPDX-License-Identifier: MIT
 *
 * An ablation for people, spreadsheets and programs.
 */
#ifndef NEPH_HARNESS_STUDY_ABLATION_OUTPUT_H
#define NEPH_HARNESS_STUDY_ABLATION_OUTPUT_H

#include "harness/json.h"
#include "harness/study/ablation.h"

/* The parts of a preset, what each does, who claims it, and what is there without it; needs no
 * more than a plan. For the caller to free. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_ablation_list(const struct neph_ablation *ablation, char **text,
                                    struct neph_diag *diag);

/* All of it as text that is Markdown, too: what was asked, a line and a verdict for each part, and
 * its numbers. For the caller to free. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_ablation_text(const struct neph_ablation *ablation, char **text,
                                    struct neph_diag *diag);

/* A line for each part, place, measure and scene, and one for all scenes (RFC 4180), a line of
 * names first; for the caller to free. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_ablation_csv(const struct neph_ablation *ablation, char **text,
                                   struct neph_diag *diag);

/* All of it; NULL when memory is short. */
json_t *neph_ablation_json(const struct neph_ablation *ablation);

/* A tornado chart for each measure, below each other in one SVG picture; for the caller to free.
 * Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_ablation_plot(const struct neph_ablation *ablation, char **svg,
                                    struct neph_diag *diag);

/* A change of so many decades as people read it: "-12 %", "+0.4 %", "x16". */
enum { NEPH_ABLATION_CHANGE_SIZE = 24 };
void neph_ablation_change(double decades, char text[NEPH_ABLATION_CHANGE_SIZE]);

/* What a part does in the preset, as a sentence without its end. */
void neph_ablation_sentence(const struct neph_ablation *ablation,
                            const struct neph_ablation_comparison *in_preset, FILE *out);

#endif
