/* SPDX-License-Identifier: MIT
 *
 * Findings: verdicts in words that follow from the measurements, with the numbers behind them.
 */
#ifndef NEPH_HARNESS_COMPARE_FINDINGS_H
#define NEPH_HARNESS_COMPARE_FINDINGS_H

#include "harness/compare/measure.h"

#include <stdbool.h>

enum { NEPH_FINDING_NUMBERS = 3 };

/* A number behind a verdict. */
struct neph_finding_number {
    const char *key; /* key in reports; static; NULL: end of the list */
    double value;    /* NaN: unknown */
    bool is_count;
};

struct neph_finding {
    const char *name; /* static, as all pointers here */
    const struct neph_quantity *quantity;
    char mask[NEPH_IMAGE_NAME_MAX];
    const char *verdict;
    char text[512];
    struct neph_finding_number numbers[NEPH_FINDING_NUMBERS];
    bool has_interval; /* of the first number */
    double low, high;  /* NaN: unknown */
    struct neph_clipped clipped;
};

/* Start from {0}; free with neph_findings_finish(). */
struct neph_findings {
    struct neph_finding *list; /* owned */
    int count;
};

void neph_findings_finish(struct neph_findings *findings);

/* Derive the findings from measurements; of a sequence, from those over all frames:
 *   seen               seen | not seen, for each mask: whether most people see flicker in any of
 *                      its pixels (metrics/extractors/seen.c)
 *   flicker            cyclic | restless | calm | frozen, for each mask
 *                      (metrics/extractors/flicker_verdict.h)
 *   cycle              cyclic: the three strongest periods of flicker in a mask, with "period" and
 *                      "value" (RMS), and their possible cause (see cycle_frequency.h)
 *   cycle_unseparated  not told apart: periods that this number of frames cannot distinguish from
 *                      the periods found
 *   edge_ratio         edges | even: a4_p95 at depth edges over a4_p95 elsewhere, with both values;
 *                      its "interval" is the quotient of both intervals and wider than 95 %
 *   reference_limited  the reference by itself has more than a third of the test's flicker
 *   noise_floor        at noise floor | resolved: is the error below the noise of one seed of the
 *                      reference?
 *   clipped            pixels are brighter than the display metrics can distinguish
 *   follow             follows | late | lost, for each known period of the light: with "period",
 *                      "gain" and "lag" (null: lost)
 *   half_life          measured | not settled | not measured, accompanies flicker
 *   unsettled          unsettled | settles, after a step or cut: with the "share" of the frame
 *   edge_ghost         ghosts | clean, behind moving edges: clean when at most a tenth of the front
 *                      remains in the 4th frame; with "residual" and "frames"
 * A missing measurement causes no finding. `frozen`: some frames unexpectedly equal the frame
 * before, so "calm" becomes "frozen". `declared_cycles`: the attribute NEPH_CYCLE_ATTRIBUTE of the
 * first test frame, or NULL. */
enum neph_status neph_findings_make(const struct neph_measurements *measurements,
                                    double frame_rate_hz, bool frozen, const char *declared_cycles,
                                    struct neph_findings *findings, struct neph_diag *diag);

/* An array of {"finding", "quantity", "mask", "verdict", "text", "interval", "clipped"} with the
 * numbers by their keys; NULL when memory is short. */
json_t *neph_findings_json(const struct neph_findings *findings);

#endif
