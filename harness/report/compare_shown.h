/* SPDX-License-Identifier: MIT
 *
 * The input of the page of a comparison.
 */
#ifndef NEPH_HARNESS_REPORT_COMPARE_SHOWN_H
#define NEPH_HARNESS_REPORT_COMPARE_SHOWN_H

#include "harness/compare/comparison.h"

enum neph_page_side { NEPH_PAGE_TEST, NEPH_PAGE_OTHER, NEPH_PAGE_SIDES };

/* All pointers are borrowed. */
struct neph_compare_page {
    const char *verb;                   /* "neph flicker" */
    const char *names[NEPH_PAGE_SIDES]; /* names of the tests; NULL: there is no second test */
    const char *verdict;                /* lines of plain text, the answer first */
    const struct neph_sequence *tests[NEPH_PAGE_SIDES];
    const struct neph_compared *compared[NEPH_PAGE_SIDES]; /* NEPH_PAGE_TEST has the comparison of
                                                              the two */
    json_t *maps;                                          /* list of neph_compare_maps */
};

#endif
