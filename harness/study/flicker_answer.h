/* SPDX-License-Identifier: MIT
 *
 * The summary lines of a flicker study: the better preset, by how much, over how many scenes and
 * seeds.
 */
#ifndef NEPH_HARNESS_STUDY_FLICKER_ANSWER_H
#define NEPH_HARNESS_STUDY_FLICKER_ANSWER_H

#include "harness/document/answer.h"
#include "harness/study/flicker_study.h"

/* The first metric of the study decides the verdict. The best preset is compared with the others in
 * that metric, and with the second in further ones. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_flicker_answer(const struct neph_flicker_study *study,
                                     struct neph_answer *answer, struct neph_diag *diag);

#endif
