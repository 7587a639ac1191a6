/* SPDX-License-Identifier: MIT
 *
 * What the page of a comparison is made of.
 */
#ifndef NEPH_HARNESS_REPORT_COMPARE_SHOWN_H
#define NEPH_HARNESS_REPORT_COMPARE_SHOWN_H

#include "harness/compare/comparison.h"

enum neph_page_side { NEPH_PAGE_TEST, NEPH_PAGE_OTHER, NEPH_PAGE_SIDES };

/* All is borrowed. */
struct neph_compare_page {
    const char *verb;                   /* "neph flicker" */
    const char *names[NEPH_PAGE_SIDES]; /* of the tests; NULL: there is no other test */
    const char *verdict;                /* lines for people, the answer first */
    const struct neph_sequence *tests[NEPH_PAGE_SIDES];
    const struct neph_compared *compared[NEPH_PAGE_SIDES]; /* that of the test has the versus */
    json_t *maps;                                          /* list of neph_compare_maps */
};

#endif
