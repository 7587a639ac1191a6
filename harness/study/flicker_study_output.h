/* SPDX-License-Identifier: MIT
 *
 * A flicker study for people, spreadsheets and programs.
 */
#ifndef NEPH_HARNESS_STUDY_FLICKER_STUDY_OUTPUT_H
#define NEPH_HARNESS_STUDY_FLICKER_STUDY_OUTPUT_H

#include "harness/json.h"
#include "harness/study/flicker_study.h"

/* All of it as text that is Markdown, too: what was asked, what the reference is and has cost, a
 * table for each metric with the number against centre rays beside each, pairs, and the ranking at
 * all displays. `*text` is for the caller to free. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_flicker_study_text(const struct neph_flicker_study *study, char **text,
                                         struct neph_diag *diag);

/* A line for each scene, preset, seed and metric (RFC 4180), a line of names first; for the caller
 * to free. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_flicker_study_csv(const struct neph_flicker_study *study, char **text,
                                        struct neph_diag *diag);

/* The whole study; NULL when memory is short. */
json_t *neph_flicker_study_json(const struct neph_flicker_study *study);

/* Flicker seen against lag as an SVG picture, a point with intervals for each preset; for the
 * caller to free. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_flicker_study_plot(const struct neph_flicker_study *study, char **svg,
                                         struct neph_diag *diag);

#endif
