/* SPDX-License-Identifier: MIT
 *
 * Common parts of all tests: cmocka with its required includes, and comparisons that print both
 * values.
 */
#ifndef NEPH_TESTS_NEPH_TEST_H
#define NEPH_TESTS_NEPH_TEST_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/status.h"

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* Written before the declaration of a local variable: test_end_KIND() ends it with its block. A
 * failing test does not get there. */
#define OWNED(kind) __attribute__((cleanup(test_end_##kind)))

/* A kind: memory from malloc() and similar functions. */
static inline void test_end_memory(void *pointer)
{
    free(*(void **)pointer);
}

/* |actual - expected| <= absolute + relative * |expected|; NaN never passes. */
#define neph_assert_close(actual, expected, relative, absolute)                                    \
    neph_assert_close_at((actual), (expected), (relative), (absolute), #actual, __FILE__, __LINE__)

static inline void neph_assert_close_at(double actual, double expected, double relative,
                                        double absolute, const char *text, const char *file,
                                        int line)
{
    double allowed = absolute + relative * fabs(expected);
    if (actual == expected || fabs(actual - expected) <= allowed)
        return;
    print_error("%s = %.17g, expected %.17g, off by %.3g, allowed %.3g\n", text, actual, expected,
                fabs(actual - expected), allowed);
    _fail(file, line);
}

/* minimum <= value <= maximum. cmocka's assert_in_range() is deprecated from 2.0 on, and its
 * replacement is not in 1.1. */
#define neph_assert_in_range(value, minimum, maximum)                                              \
    neph_assert_in_range_at((intmax_t)(value), (intmax_t)(minimum), (intmax_t)(maximum), #value,   \
                            __FILE__, __LINE__)

static inline void neph_assert_in_range_at(intmax_t value, intmax_t minimum, intmax_t maximum,
                                           const char *text, const char *file, int line)
{
    if (minimum <= value && value <= maximum)
        return;
    print_error("%s = %jd is not in %jd..%jd\n", text, value, minimum, maximum);
    _fail(file, line);
}

/* Passes when the status is NEPH_OK; prints the diagnostic otherwise. */
#define neph_assert_ok(status, diag) neph_assert_ok_at((status), (diag), __FILE__, __LINE__)

static inline void neph_assert_ok_at(enum neph_status status, const struct neph_diag *diag,
                                     const char *file, int line)
{
    if (status == NEPH_OK)
        return;
    print_error("%s: %s\n", neph_status_name(status), diag ? diag->message : "");
    _fail(file, line);
}

/* Files with tests that run external programs have these tests in a second group, which `main`
 * selects: ctest runs it as engine/<file>, without sanitizers. */
static inline bool neph_test_wants_engines(int argc, char **argv)
{
    return argc == 2 && strcmp(argv[1], "--engines") == 0;
}

/* The tests of a day have ten minutes, the tests of a night have hours (`scripts/test --night` sets
 * this variable). Night tests are cases that repeat the guarantee of a faster case, and the
 * remaining part of a table whose entries differ only in numbers. */
static inline bool neph_test_is_night(void)
{
    return getenv("NEPH_TEST_NIGHT") != NULL;
}

static inline int neph_test_by_day(int day, int night)
{
    return neph_test_is_night() ? night : day;
}

/* At the start of a night case. */
static inline void neph_test_waits_for_the_night(void)
{
    if (!neph_test_is_night())
        skip();
}

/* Under the sanitizers tests draw an 11th of the paths, photons or trials, and use every 11th of a
 * table of cases that differ only in their numbers (11 has no factor in common with the 2, 3, 4, 5
 * that tests cycle through): any of them is enough for the sanitizers. The release build checks the
 * numbers, by day with a third of the paths, by night with all. Tolerances in standard errors of
 * the estimate adapt automatically; a bound on these errors is stated for all paths, and
 * neph_test_noise() converts it. */
#ifdef NEPH_SANITIZED
enum { NEPH_TEST_EVERY = 11 };
#else
enum { NEPH_TEST_EVERY = 1 };
#endif

/* One of this number of paths is drawn. */
static inline int neph_test_path_step(void)
{
    return NEPH_TEST_EVERY > 1 ? NEPH_TEST_EVERY : neph_test_by_day(3, 1);
}

static inline int neph_test_paths(int count)
{
    return (count + neph_test_path_step() - 1) / neph_test_path_step();
}

static inline double neph_test_noise(double standard_error)
{
    return standard_error * sqrt((double)neph_test_path_step());
}

/* Property tests: a small deterministic generator; print the seed when a property fails. */
static inline uint64_t neph_test_random(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u); /* splitmix64 */
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static inline double neph_test_uniform(uint64_t *state, double low, double high)
{
    return low + (high - low) * (double)(neph_test_random(state) >> 11) * 0x1p-53;
}

#endif
