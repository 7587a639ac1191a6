/* SPDX-License-Identifier: MIT
 *
 * The summary lines of `neph pick`: the choice with its values, or the nearest candidate.
 */
#ifndef NEPH_HARNESS_SWEEP_PICK_ANSWER_H
#define NEPH_HARNESS_SWEEP_PICK_ANSWER_H

#include "harness/document/answer.h"
#include "harness/sweep/choice.h"
#include "harness/sweep/pick.h"

/* The answer for one scene; `config` is the path of pick.json. */
void neph_pick_answer(const struct neph_pick_params *params, const struct neph_pick *pick,
                      const char *config, struct neph_answer *answer);

/* The answer for a preset over scenes. Errors: NEPH_ERR_MEMORY. */
enum neph_status neph_choice_answer(const struct neph_choice *choice,
                                    const struct neph_flicker_study *study, const char *config,
                                    struct neph_answer *answer, struct neph_diag *diag);

#endif
