/* SPDX-License-Identifier: MIT
 *
 * The errors of baked media, in the form of reports and frame attributes.
 */
#ifndef NEPH_HARNESS_ENGINES_BAKES_H
#define NEPH_HARNESS_ENGINES_BAKES_H

#include "base/image.h"
#include "harness/json.h"
#include "scenes/bake.h"

/* Attribute of a frame rendered from grids: the summary as JSON. */
#define NEPH_BAKES_ATTRIBUTE "neph.bake"

struct neph_bakes_summary {
    char grid[512];               /* the sizes of all grids, as text */
    struct neph_bake_error worst; /* worst value of each error; counts and seed are unset */
};

/* The summary as a flat JSON object; a new reference, NULL: memory is short. */
json_t *neph_bakes_summary_json(const struct neph_bakes_summary *summary);

/* The summary of these bakes as JSON; `count` is at least 1. */
json_t *neph_bakes_json(const struct neph_bake *bakes, int count);

/* Attach the summary to a frame; does nothing for `count` 0. */
enum neph_status neph_bakes_label(const struct neph_bake *bakes, int count,
                                  struct neph_image *frame, struct neph_diag *diag);

/* Read the summary from a frame; false: it has none. */
bool neph_bakes_from_frame(const struct neph_image *frame, struct neph_bakes_summary *summary);

#endif
