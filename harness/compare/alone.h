/* SPDX-License-Identifier: MIT
 *
 * What can be measured of a sequence without a reference: how its frames change, by metrics that a
 * constant in the place of the reference does not move.
 */
#ifndef NEPH_HARNESS_COMPARE_ALONE_H
#define NEPH_HARNESS_COMPARE_ALONE_H

#include "harness/compare/measure.h"

/* What remains unknown without a reference, in a sentence. */
extern const char *const neph_alone_unknown;

/* Whether some metrics of an extractor need no reference. */
bool neph_extractor_needs_no_reference(const struct neph_extractor *extractor);

/* Whether a number needs none; `context` is not used (neph_measurements_select()). */
bool neph_needs_no_reference(const struct neph_measurement *number, const void *context);

#endif
