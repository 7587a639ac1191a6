/* SPDX-License-Identifier: MIT
 *
 * Majorant grids: for each cell of a coarse lattice over a finite box, a number that the extinction
 * of one medium never passes inside the cell. What tracking methods step through.
 */
#ifndef NEPH_SCENES_MAJORANT_H
#define NEPH_SCENES_MAJORANT_H

#include "scenes/scene.h"

struct neph_majorants {
    struct neph_bounds box;  /* finite */
    int size[3];             /* cells along x, y, z */
    float *extinction_per_m; /* owned; x fastest; rounded up; of extinction_color 1 */
};

/* Over a box (finite; normally the medium's support) with about `cell_count` cells that are as near
 * to cubes as whole numbers allow, none thinner than a grid medium's own cells.
 * NEPH_ERR_UNSUPPORTED: the box is infinite or has no inside. */
enum neph_status neph_majorants_create(const struct neph_medium *medium,
                                       const struct neph_bounds *box, int cell_count,
                                       struct neph_majorants **majorants, struct neph_diag *diag);

/* Raise the majorants of a grid medium to the largest node around each cell, as a tracker needs
 * that looks up one of the eight nodes around a place by chance; nothing changes for other kinds.
 * They are looser then: who knows the density itself does without. */
void neph_majorants_cover_nodes(struct neph_majorants *majorants, const struct neph_medium *medium);

/* NULL is fine. */
void neph_majorants_destroy(struct neph_majorants *majorants);

#endif
