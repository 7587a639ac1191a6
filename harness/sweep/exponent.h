/* SPDX-License-Identifier: MIT
 *
 * How a cost grows: the exponent of a power law through its points, and whether it is as it should
 * be.
 */
#ifndef NEPH_HARNESS_SWEEP_EXPONENT_H
#define NEPH_HARNESS_SWEEP_EXPONENT_H

/* cost ~ x^value. NaN: fewer than three points with a logarithm, or all at one x. The interval is
 * Student's, 95 %, of the scatter about the line: of what is counted it says how straight that is.
 */
struct neph_exponent {
    double value, low, high;
    int count; /* points in it */
};

/* The straight line through the logarithms of least squares. Points whose x or y is not above 0 are
 * left out. */
struct neph_exponent neph_exponent_fit(const double *x, const double *y, int count);

/* Exponents that are as they should be; `low` may be -INFINITY. */
struct neph_exponent_range {
    double low, high;
};

/* Exponents that differ by less are called the same: a factor of 1.26 over a decade. */
#define NEPH_EXPONENT_SAME 0.1

enum neph_exponent_verdict {
    NEPH_EXPONENT_NONE,     /* there is no exponent */
    NEPH_EXPONENT_EXPECTED, /* the interval lies within the range, NEPH_EXPONENT_SAME wider */
    NEPH_EXPONENT_OTHER,    /* it lies outside */
    NEPH_EXPONENT_UNTOLD,   /* it is wider than that */
    NEPH_EXPONENT_VERDICTS,
};
extern const char *const neph_exponent_verdict_words[NEPH_EXPONENT_VERDICTS];

enum neph_exponent_verdict neph_exponent_judge(const struct neph_exponent *exponent,
                                               struct neph_exponent_range range);

#endif
