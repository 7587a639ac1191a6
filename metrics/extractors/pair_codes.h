/* SPDX-License-Identifier: MIT
 *
 * The code values and the display luma of a pair of frames, shared by several extractors: computed
 * once, at the first request.
 */
#ifndef NEPH_METRICS_EXTRACTORS_PAIR_CODES_H
#define NEPH_METRICS_EXTRACTORS_PAIR_CODES_H

#include "metrics/extractors/code_value.h"

#include <stdbool.h>

struct neph_code_planes {
    struct neph_code *code;
    double *reference, *test; /* of all pixels */
    bool is_made;             /* computed for this pair */
};

/* Display luma (display_luma.h) of all pixels of both frames. The luma of a reference that is the
 * same as in the pair before is kept. */
struct neph_luma_planes {
    double *reference, *test;
    float *seen[3]; /* the planes of `reference` */
    bool has_seen;
    bool is_made; /* computed for this pair */
};

/* Codes of pairs with one size and one set of viewing conditions. Start from zeros and the arena
 * for the planes.
 */
struct neph_pair_codes {
    struct neph_arena *memory;
    struct neph_code_planes kinds[NEPH_CODE_COUNT];
    struct neph_luma_planes luma;
    struct neph_arena luma_memory; /* of `luma`; ended by neph_pair_luma_end() */
};

/* Invalidate the codes, before another pair. */
void neph_pair_codes_forget(struct neph_pair_codes *codes);

/* The codes of a pair, in its `codes`; `planes` is valid until neph_pair_codes_forget(). Values
 * that are not finite are clamped to the curve. NEPH_ERR_MEMORY, NEPH_ERR_INTERRUPTED. */
enum neph_status neph_pair_codes_get(const struct neph_frame_pair *pair, enum neph_code_kind kind,
                                     const struct neph_code_planes **planes,
                                     struct neph_diag *diag);

/* The luma of a pair of three planes, valid until neph_pair_codes_forget(). NEPH_ERR_MEMORY,
 * NEPH_ERR_INTERRUPTED. */
enum neph_status neph_pair_luma_get(const struct neph_frame_pair *pair,
                                    const struct neph_luma_planes **planes, struct neph_diag *diag);

/* Free the memory of the luma, after the last pair. */
void neph_pair_luma_end(struct neph_pair_codes *codes);

#endif
