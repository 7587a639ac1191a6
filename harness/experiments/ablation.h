/* SPDX-License-Identifier: MIT
 *
 * What is published of an ablation (study/ablation.h).
 */
#ifndef NEPH_HARNESS_EXPERIMENTS_ABLATION_H
#define NEPH_HARNESS_EXPERIMENTS_ABLATION_H

#include "harness/document/publication.h"
#include "harness/study/ablation.h"

/* The parts of a preset, what each does, who claims it, and what is there without it; needs no
 * more than a plan. */
void neph_ablation_list(const struct neph_ablation *ablation, FILE *out);

/* Write an ablation that was judged in all forms that are wanted. Errors: NEPH_ERR_MEMORY,
 * NEPH_ERR_INTERNAL. */
enum neph_status neph_ablation_publish(const struct neph_ablation *ablation,
                                       struct neph_publication *publication,
                                       struct neph_diag *diag);

#endif
