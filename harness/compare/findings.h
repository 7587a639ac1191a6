/* SPDX-License-Identifier: MIT
 *
 * What the numbers say in words: verdicts with the numbers that they stand on.
 */
#ifndef NEPH_HARNESS_COMPARE_FINDINGS_H
#define NEPH_HARNESS_COMPARE_FINDINGS_H

#include "harness/json.h"

#include <stdbool.h>

/* From an array of measurements (harness/compare/measure.h), over all frames where there are several: an
 * array of objects {"finding", "quantity", "mask", "verdict", "text", and the numbers}:
 *   seen               seen | not seen, for each mask: whether most people see flicker in any of
 *                      its pixels (metrics/extractors/seen.c)
 *   flicker            cyclic | restless | calm | frozen, for each mask
 *                      (metrics/extractors/flicker_verdict.h)
 *   cycle              the three strongest periods of flicker that a mask has, with "period" and
 *                      "value" (RMS), and who may have made it (see cycle_frequency.h)
 *   cycle_unseparated  periods that so many frames do not tell from those that were found
 *   edge_ratio         a4_p95 at depth edges over that elsewhere, with both parts; its "interval"
 *                      is that of the one over that of the other: wider than 95 %
 *   reference_limited  the reference alone flickers more than a third of what the test shows
 *   noise_floor        the error is below the noise of one seed of the reference
 *   clipped            pixels are brighter than metrics of the display can tell
 *   follow             of each known period of the light: follows | late | lost, with "period",
 *                      "gain" and "lag" (null: lost)
 *   half_life          beside flicker: known, or not measured and how to
 *   unsettled          after a step or cut: unsettled | settles, with the "share" of the picture
 *   edge_ghost         behind moving edges: ghosts | clean (a tenth of the front is left in the 4th
 *                      frame, or less), with "residual" and "frames"
 * Numbers that were not measured make no finding. `frozen`: there are frames equal to the one
 * before, and they were not meant to be: what would be calm is "frozen". `declared_cycles`: the
 * attribute NEPH_CYCLE_ATTRIBUTE of the first test frame, or NULL. NULL when memory is short.
 */
json_t *neph_findings(const json_t *measurements, bool frozen, const char *declared_cycles);

#endif
