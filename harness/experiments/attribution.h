/* SPDX-License-Identifier: MIT
 *
 * The output of an attribution (study/attribution_study.h).
 */
#ifndef NEPH_HARNESS_EXPERIMENTS_ATTRIBUTION_H
#define NEPH_HARNESS_EXPERIMENTS_ATTRIBUTION_H

#include "harness/document/publication.h"
#include "harness/study/attribution_study.h"

/* Write an attribution in all requested forms. NEPH_ERR_MEMORY, NEPH_ERR_INTERNAL. */
enum neph_status neph_attribution_publish(const struct neph_attribution_study *attribution,
                                          struct neph_publication *publication,
                                          struct neph_diag *diag);

#endif
