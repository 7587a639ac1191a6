/* SPDX-License-Identifier: MIT
 *
 * The environment of a number, "VERSION, DEVICE[; NOTE][; against VERSION, DEVICE]": which two are
 * one, and what can be said of numbers of two.
 */
#ifndef NEPH_HARNESS_NIGHT_ENVIRONMENT_H
#define NEPH_HARNESS_NIGHT_ENVIRONMENT_H

#include "harness/night/judge.h"

/* Two environments that differ only by the revision of an engine of neph are one: a change of this
 * program is judged, whether or not its revision was raised. */
bool neph_is_same_environment(const char *a, const char *b);

/* Whether a number is worse than that of an earlier night (`before`, its standard error or NaN) in
 * another environment, by more than matters for its kind. Drawn numbers are compared by their
 * standard errors, at a tenth of the level `alpha`. Durations, which depend on the machine, and
 * drawn numbers with another note, which are of other samples, are never worse. `change` gets
 * baseline, change and floor. */
bool neph_is_worse_elsewhere(const struct neph_series *series, const char *environment,
                             double before, double before_error, const char *environment_before,
                             double alpha, struct neph_judgement *change);

#endif
