/* SPDX-License-Identifier: MIT
 *
 * What baked media cost in accuracy, in the form of reports.
 */
#ifndef NEPH_HARNESS_ENGINES_BAKES_H
#define NEPH_HARNESS_ENGINES_BAKES_H

#include "base/image.h"
#include "harness/json.h"
#include "scenes/bake.h"

/* The attribute of a frame that was rendered from grids: its summary as JSON. */
#define NEPH_BAKES_ATTRIBUTE "neph.bake"

struct neph_bakes_summary {
    char grid[512];               /* the sizes of all grids in words */
    struct neph_bake_error worst; /* of each number; counts and seed are not kept */
};

/* The summary as a flat object; a new reference, NULL when memory is short. */
json_t *neph_bakes_summary_json(const struct neph_bakes_summary *summary);

/* That of bakes; `count` is at least 1. */
json_t *neph_bakes_json(const struct neph_bake *bakes, int count);

/* Label a frame with them; nothing to do when `count` is 0. */
enum neph_status neph_bakes_label(const struct neph_bake *bakes, int count,
                                  struct neph_image *frame, struct neph_diag *diag);

/* What a frame is labelled with; false when there is nothing. */
bool neph_bakes_of_frame(const struct neph_image *frame, struct neph_bakes_summary *summary);

#endif
