/* SPDX-License-Identifier: MIT
 *
 * What baked media cost in accuracy, in the form of reports.
 */
#ifndef NEPH_HARNESS_ENGINES_BAKES_H
#define NEPH_HARNESS_ENGINES_BAKES_H

#include "base/image.h"
#include "harness/json.h"
#include "scenes/bake.h"

/* The attribute of a frame that was rendered from grids: the object below as text. */
#define NEPH_BAKES_ATTRIBUTE "neph.bake"

/* A flat object of the sizes of all grids as text and of the largest errors among them; a new
 * reference, NULL when memory is short. `count` is at least 1. */
json_t *neph_bakes_json(const struct neph_bake *bakes, int count);

/* Label a frame with them; nothing to do when `count` is 0. */
enum neph_status neph_bakes_label(const struct neph_bake *bakes, int count,
                                  struct neph_image *frame, struct neph_diag *diag);

/* The object that a frame is labelled with, a new reference; JSON null when it has none. */
json_t *neph_bakes_of_frame(const struct neph_image *frame);

#endif
