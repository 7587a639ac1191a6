/* SPDX-License-Identifier: MIT
 *
 * The output of an ablation (study/ablation.h).
 */
#ifndef NEPH_HARNESS_EXPERIMENTS_ABLATION_H
#define NEPH_HARNESS_EXPERIMENTS_ABLATION_H

#include "harness/document/publication.h"
#include "harness/study/ablation.h"

/* Print the parts of a preset: effect, claim and its source, and the settings without the part.
 * Requires only a plan. */
void neph_ablation_list(const struct neph_ablation *ablation, FILE *out);

/* Write a judged ablation in all requested forms. NEPH_ERR_MEMORY, NEPH_ERR_INTERNAL. */
enum neph_status neph_ablation_publish(const struct neph_ablation *ablation,
                                       struct neph_publication *publication,
                                       struct neph_diag *diag);

#endif
