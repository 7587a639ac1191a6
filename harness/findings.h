/* SPDX-License-Identifier: MIT
 *
 * What the numbers say in words: verdicts with the numbers that they stand on.
 */
#ifndef NEPH_HARNESS_FINDINGS_H
#define NEPH_HARNESS_FINDINGS_H

#include "harness/json.h"

#include <stdbool.h>

/* From an array of measurements (harness/measure.h), over all frames where there are several: an
 * array of objects {"finding", "quantity", "mask", "verdict", "text", and the numbers}:
 *   flicker            cyclic | restless | calm | frozen, for each mask
 *                      (metrics/extractors/flicker_verdict.h)
 *   edge_ratio         a4_p95 at depth edges over that elsewhere, with both parts; its "interval"
 *                      is that of the one over that of the other: wider than 95 %
 *   reference_limited  the reference alone flickers more than a third of what the test shows
 *   noise_floor        the error is below the noise of one seed of the reference
 *   clipped            pixels are brighter than metrics of the display can tell
 *   half_life          beside flicker: known, or not measured and how to
 * Numbers that were not measured make no finding. `frozen`: there are frames equal to the one
 * before, and they were not meant to be: what would be calm is "frozen". NULL when memory is short.
 */
json_t *neph_findings(const json_t *measurements, bool frozen);

#endif
