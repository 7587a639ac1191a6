/* SPDX-License-Identifier: MIT
 *
 * What a flicker study answers: which preset is better, by how much, over how many scenes and
 * seeds.
 */
#ifndef NEPH_HARNESS_STUDY_FLICKER_ANSWER_H
#define NEPH_HARNESS_STUDY_FLICKER_ANSWER_H

#include "harness/document/answer.h"
#include "harness/study/flicker_study.h"

/* The first metric of the study decides the verdict; the best preset is compared with each other
 * one in it, and with the second in others. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_flicker_answer(const struct neph_flicker_study *study,
                                     struct neph_answer *answer, struct neph_diag *diag);

#endif
