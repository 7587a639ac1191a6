/* SPDX-License-Identifier: MIT
 *
 * The answer of `neph fit`: a sentence, a table and JSON.
 */
#ifndef NEPH_HARNESS_FIT_ANSWER_H
#define NEPH_HARNESS_FIT_ANSWER_H

#include "harness/fit/mistakes.h"
#include "harness/json.h"

struct neph_fit_answer {
    const struct neph_fit *fit;
    const struct neph_fit_verdict *verdict;
    const char *frame; /* its path */
};

/* The names of the unknowns on the command line; ends with NULL. */
extern const char *const neph_fit_unknown_names[];

/* Whether the frame agrees with the scene, or how it differs. */
void neph_fit_sentence(const struct neph_fit_answer *answer, char *text, size_t size);

/* The sentence; unless `is_short` the estimates and what the fit used, too. */
void neph_fit_print(const struct neph_fit_answer *answer, bool is_short, FILE *out);

json_t *neph_fit_json(const struct neph_fit_answer *answer);

#endif
