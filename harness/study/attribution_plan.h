/* SPDX-License-Identifier: MIT
 *
 * The sequences of an attribution: a preset with each set of its parts made ideal.
 */
#ifndef NEPH_HARNESS_STUDY_ATTRIBUTION_PLAN_H
#define NEPH_HARNESS_STUDY_ATTRIBUTION_PLAN_H

#include "base/arena.h"
#include "harness/study/attribution_value.h"
#include "harness/study/ideal.h"

struct neph_attribution_part {
    const char *name, *what;
    const char *ideal; /* the setting that makes the part ideal; NULL: another reference does */
};
extern const struct neph_attribution_part neph_attribution_parts[NEPH_PARTS];

/* States without blur and aliasing, the parts of anti-aliasing: children of rays only with rays,
 * each with and without upscale. */
enum { NEPH_ATTRIBUTION_SEQUENCES = 34, NEPH_ATTRIBUTION_MAPS = 1 + NEPH_PART_BLUR };

/* The first NEPH_ATTRIBUTION_MAPS sequences have all parts real, then one part ideal. */
struct neph_attribution_plan {
    const char *preset;                               /* borrowed */
    const char *words[NEPH_ATTRIBUTION_SEQUENCES];    /* preset words */
    const char *labels[NEPH_ATTRIBUTION_SEQUENCES];   /* "ours, ideal rays" */
    neph_part_set states[NEPH_ATTRIBUTION_SEQUENCES]; /* without blur and aliasing */
    int count;
};

/* Plans the sequences of a preset. NEPH_ERR_USAGE: no such preset, or its parts have no ideal: it
 * has split=none, the a-trous filter, or is a user engine. NEPH_ERR_MEMORY. */
enum neph_status neph_attribution_plan_make(const char *preset, int steps, struct neph_arena *arena,
                                            struct neph_attribution_plan *plan,
                                            struct neph_diag *diag);

/* The sequence of a state; its blur and aliasing do not matter. */
int neph_attribution_find_sequence(const struct neph_attribution_plan *plan, neph_part_set state);

/* The reference that the sequence of a state is measured against, with the blur and the aliasing
 * that are ideal in the state; NEPH_IDEALS: the reference itself. */
enum neph_ideal_kind neph_attribution_find_reference(neph_part_set state);

/* The words of the sequence with all parts ideal. */
const char *neph_attribution_find_ideal(const struct neph_attribution_plan *plan);

#endif
