/* SPDX-License-Identifier: MIT
 *
 * A fog study for people, spreadsheets and programs.
 */
#ifndef NEPH_HARNESS_STUDY_FOG_STUDY_OUTPUT_H
#define NEPH_HARNESS_STUDY_FOG_STUDY_OUTPUT_H

#include "harness/json.h"
#include "harness/study/fog_study.h"

/* All of it as text that is Markdown, too. `*text` is for the caller to free. Errors:
 * NEPH_ERR_MEMORY. */
enum neph_status neph_fog_study_text(const struct neph_fog_study *study, char **text,
                                     struct neph_diag *diag);

/* A line for each row (RFC 4180), a line of names first; for the caller to free. Errors:
 * NEPH_ERR_MEMORY. */
enum neph_status neph_fog_study_csv(const struct neph_fog_study *study, char **text,
                                    struct neph_diag *diag);

/* The whole study; NULL when memory is short. */
json_t *neph_fog_study_json(const struct neph_fog_study *study);

#endif
