/* SPDX-License-Identifier: MIT
 *
 * The metrics that a verdict shows first, for single frames and sequences, most important first.
 */
#ifndef NEPH_HARNESS_COMPARE_HEADLINES_H
#define NEPH_HARNESS_COMPARE_HEADLINES_H

#include "harness/compare/versus.h"

struct neph_headline {
    const char *quantity, *metric;
    const char *words; /* text after a value: "4.4 times the threshold"; NULL: the metric's name
                          before the value and its unit after it */
};

enum { NEPH_HEADLINES = 13 };
extern const struct neph_headline neph_headlines[NEPH_HEADLINES];

/* The difference to report first over a mask: of the first headline with a difference, else the
 * first difference of radiance; NULL: there is none. `*words` as in the headline. */
const struct neph_difference *neph_headline_difference(const struct neph_differences *list,
                                                       const char *mask, const char **words);

/* Format a value with three digits: 0.0123, 4.40, 17.0, 123. */
void neph_headline_value(double value, char text[32]);

/* The unit of a number with a blank before it; "" for the unit 1. */
const char *neph_headline_unit(const struct neph_measurement *number, char text[64]);

#endif
