/* SPDX-License-Identifier: MIT
 *
 * Measurements of a sequence without a reference: changes from frame to frame, by metrics that do
 * not depend on the reference as long as it is constant.
 */
#ifndef NEPH_HARNESS_COMPARE_ALONE_H
#define NEPH_HARNESS_COMPARE_ALONE_H

#include "harness/compare/measure.h"

/* A sentence about the quantities that remain unknown without a reference. */
extern const char *const neph_alone_unknown;

/* True when some metrics of an extractor need no reference. */
bool neph_extractor_needs_no_reference(const struct neph_extractor *extractor);

/* True when a number needs no reference; `context` is unused (signature of
 * neph_measurements_select()). */
bool neph_needs_no_reference(const struct neph_measurement *number, const void *context);

#endif
