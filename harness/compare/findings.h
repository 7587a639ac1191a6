/* SPDX-License-Identifier: MIT
 *
 * What the numbers say in words: verdicts with the numbers that they stand on.
 */
#ifndef NEPH_HARNESS_COMPARE_FINDINGS_H
#define NEPH_HARNESS_COMPARE_FINDINGS_H

#include "harness/compare/measure.h"

#include <stdbool.h>

enum { NEPH_FINDING_NUMBERS = 3 };

/* A number that a verdict stands on. */
struct neph_finding_number {
    const char *key; /* in reports; static; NULL: there are no more */
    double value;    /* NaN: not known */
    bool is_count;
};

struct neph_finding {
    const char *name; /* static, as the rest but for the text */
    const struct neph_quantity *quantity;
    char mask[NEPH_IMAGE_NAME_MAX];
    const char *verdict;
    char text[512];
    struct neph_finding_number numbers[NEPH_FINDING_NUMBERS];
    bool has_interval; /* of the first number */
    double low, high;  /* NaN: it has none */
    struct neph_clipped clipped;
};

/* Start from {0}; free with _finish. */
struct neph_findings {
    struct neph_finding *list; /* owned */
    int count;
};

void neph_findings_finish(struct neph_findings *findings);

/* From measurements, over all frames where there are several, those of
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
 * attribute NEPH_CYCLE_ATTRIBUTE of the first test frame, or NULL.
 */
enum neph_status neph_findings_make(const struct neph_measurements *measurements,
                                    double frame_rate_hz, bool frozen, const char *declared_cycles,
                                    struct neph_findings *findings, struct neph_diag *diag);

/* As an array of {"finding", "quantity", "mask", "verdict", "text", and the numbers by their keys,
 * "interval", "clipped"}; NULL when memory is short. */
json_t *neph_findings_json(const struct neph_findings *findings);

#endif
