/* SPDX-License-Identifier: MIT
 *
 * A light study for people, spreadsheets and programs.
 */
#ifndef NEPH_HARNESS_STUDY_LIGHT_STUDY_OUTPUT_H
#define NEPH_HARNESS_STUDY_LIGHT_STUDY_OUTPUT_H

#include "harness/json.h"
#include "harness/study/light_study.h"

/* All of it as text that is Markdown, too: verdicts, the cells, what models are off by along each
 * axis, and by cloud, sun, g and albedo. `*text` is for the caller to free. Errors:
 * NEPH_ERR_MEMORY. */
enum neph_status neph_light_study_text(const struct neph_light_study *study, char **text,
                                       struct neph_diag *diag);

/* A line for each cell and model (RFC 4180), a line of names first; for the caller to free. Errors:
 * NEPH_ERR_MEMORY. */
enum neph_status neph_light_study_csv(const struct neph_light_study *study, char **text,
                                      struct neph_diag *diag);

/* The whole study; NULL when memory is short. */
json_t *neph_light_study_json(const struct neph_light_study *study);

/* Radiance over the tracer's as an SVG picture: for each model a square of optical depth towards
 * the eye and the sun, and one of the first and the angle to the sun, with numbers of pixels; for
 * the caller to free. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_light_study_plot(const struct neph_light_study *study, char **svg,
                                       struct neph_diag *diag);

#endif
