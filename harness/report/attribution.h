/* SPDX-License-Identifier: MIT
 *
 * Who disagrees with whom in a scene, and which engine is the odd one out: all pairs of rendered
 * frames held against each other with their noise taken out (metrics/pair.h), at a level corrected
 * for the number of pairs (Sidak).
 */
#ifndef NEPH_HARNESS_REPORT_ATTRIBUTION_H
#define NEPH_HARNESS_REPORT_ATTRIBUTION_H

#include "base/status.h"
#include "harness/json.h"

/* The probability that engines that all agree are told apart. */
#define NEPH_ATTRIBUTION_FAMILY_ALPHA 0.01

/* `frames`: the "frames" of a scene's document, of which those with an "exr" take part
 * ("exr_second" is the second seed of a stochastic engine, null of a deterministic one).
 * `*attribution` (the caller's) receives the "attribution" of scripts/report/README.md, or JSON
 * null when fewer than three engines rendered or there is nothing to compare. The mask is "medium"
 * of the first frame that has a transmittance, else "all". */
enum neph_status neph_attribute(const json_t *frames, json_t **attribution, struct neph_diag *diag);

/* The rule alone, for tests: `verdicts[i * count + j]` of metrics/pair.h, symmetric. The index of
 * the odd one out, or -1; `*sentence` (at most 400 characters) says why, in words. */
int neph_odd_one_out(const char *const *names, int count, const int *verdicts, char sentence[400]);

#endif
