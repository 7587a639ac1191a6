/* SPDX-License-Identifier: MIT
 *
 * Chooses the extractors of a comparison from words of a command line or of another program.
 */
#ifndef NEPH_HARNESS_COMPARE_CHOICE_H
#define NEPH_HARNESS_COMPARE_CHOICE_H

#include "harness/compare/comparison.h"

/* The extractor of that name, or the extractor with a metric of that name; NULL: there is none. */
const struct neph_extractor *neph_find_extractor(const char *word);

/* Add an extractor with its default settings, unless it is in the comparison already. */
void neph_choose_extractor(struct neph_comparison *comparison,
                           const struct neph_extractor *extractor);

/* Add an extractor by its name or by the name of one of its metrics; "all" adds all extractors.
 * NEPH_ERR_USAGE. */
enum neph_status neph_choose_word(struct neph_comparison *comparison, const char *word,
                                  struct neph_diag *diag);

/* Add the extractors that are measured when none is named: of `neph compare`, or with `temporal` of
 * `neph flicker`. */
void neph_choose_usual(struct neph_comparison *comparison, bool temporal);

/* Without a reference: NEPH_ERR_USAGE when a chosen extractor needs one, or when `option` does, an
 * option that was given (NULL: none). */
enum neph_status neph_choice_check_reference(const struct neph_comparison *comparison,
                                             const char *option, struct neph_diag *diag);

/* Apply "EXTRACTOR:KEY=VALUE", and add that extractor. NEPH_ERR_USAGE. */
enum neph_status neph_choose_setting(struct neph_comparison *comparison, const char *text,
                                     struct neph_diag *diag);

/* Viewing conditions: those given, and the default where one is NaN. */
struct neph_viewing neph_viewing_complete(struct neph_viewing given);

/* What the user named. All texts are borrowed. */
struct neph_named {
    const char *const *metrics; /* extractors, metrics, or "all"; none: the usual ones */
    int metric_count;
    const char *const *settings; /* "EXTRACTOR:KEY=VALUE" */
    int setting_count;
    const char *mask; /* NULL: all masks */
    bool is_flicker;
};

/* Remove the numbers and findings that are not named. */
void neph_named_select(const struct neph_named *named, struct neph_compared *compared);

/* NEPH_ERR_UNSUPPORTED: a named metric was not measured; without names, `flicker` of a task of
 * flicker. */
enum neph_status neph_named_check(const struct neph_named *named,
                                  const struct neph_compared *compared, struct neph_diag *diag);

#endif
