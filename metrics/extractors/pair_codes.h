/* SPDX-License-Identifier: MIT
 *
 * The code values of a pair of frames, which several extractors look at: made when the first of
 * them asks, and once.
 */
#ifndef NEPH_METRICS_EXTRACTORS_PAIR_CODES_H
#define NEPH_METRICS_EXTRACTORS_PAIR_CODES_H

#include "metrics/extractors/code_value.h"

#include <stdbool.h>

struct neph_code_planes {
    struct neph_code *code;
    double *reference, *test; /* of all pixels */
    bool is_made;             /* of this pair */
};

/* Codes of pairs of one size and one way of viewing. Start from zeros and the arena that has them.
 */
struct neph_pair_codes {
    struct neph_arena *memory;
    struct neph_code_planes kinds[NEPH_CODE_COUNT];
};

/* Before another pair. */
void neph_pair_codes_forget(struct neph_pair_codes *codes);

/* The codes of a pair in its `codes`; `planes` is good until that is made to forget. What is not
 * finite is clamped as the curve is. NEPH_ERR_MEMORY, NEPH_ERR_INTERRUPTED. */
enum neph_status neph_pair_codes_of(const struct neph_frame_pair *pair, enum neph_code_kind kind,
                                    const struct neph_code_planes **planes, struct neph_diag *diag);

#endif
