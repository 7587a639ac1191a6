/* SPDX-License-Identifier: MIT
 *
 * The environment of a number, "VERSION, DEVICE[; NOTE][; against VERSION, DEVICE]": whether two
 * environments are equal, and comparison of numbers across environments.
 */
#ifndef NEPH_HARNESS_NIGHT_ENVIRONMENT_H
#define NEPH_HARNESS_NIGHT_ENVIRONMENT_H

#include "harness/night/judge.h"

/* True when two environments are equal or differ only by the revision of an engine of neph. A
 * change of neph itself is always compared, with or without a raised revision. */
bool neph_is_same_environment(const char *a, const char *b);

/* True when a number is worse than `before`, its value in an earlier run in another environment, by
 * more than the threshold of its kind. Drawn numbers are compared by their standard errors
 * (`before_error` may be NaN) at a tenth of the level `alpha`. Always false for durations, which
 * depend on the machine, and for drawn numbers with another note, which have another number of
 * samples. `change` gets baseline, change and floor. */
bool neph_is_worse_elsewhere(const struct neph_series *series, const char *environment,
                             double before, double before_error, const char *environment_before,
                             double alpha, struct neph_judgement *change);

#endif
