/* SPDX-License-Identifier: MIT
 *
 * Which extractors a comparison takes, from words of the command line.
 */
#ifndef NEPH_HARNESS_CLI_COMPARE_CHOICE_H
#define NEPH_HARNESS_CLI_COMPARE_CHOICE_H

#include "harness/compare/comparison.h"

/* The extractor of that name, or of a metric of that name; NULL: there is none. */
const struct neph_extractor *neph_find_extractor(const char *word);

/* Take an extractor with its usual settings, unless it is taken already. */
void neph_choose(struct neph_comparison *comparison, const struct neph_extractor *extractor);

/* Take an extractor by its name or by that of one of its metrics, or "all". NEPH_ERR_USAGE. */
enum neph_status neph_choose_word(struct neph_comparison *comparison, const char *word,
                                  struct neph_diag *diag);

/* "EXTRACTOR:KEY=VALUE" takes that extractor, too. NEPH_ERR_USAGE. */
enum neph_status neph_choose_setting(struct neph_comparison *comparison, const char *text,
                                     struct neph_diag *diag);

#endif
