/* SPDX-License-Identifier: MIT
 *
 * Majorant grids: for each cell of a coarse lattice over a finite box, an upper bound of the
 * extinction of one medium inside the cell. For tracking methods.
 */
#ifndef NEPH_SCENES_MAJORANT_H
#define NEPH_SCENES_MAJORANT_H

#include "scenes/scene.h"

struct neph_majorants {
    struct neph_bounds box;  /* finite */
    int size[3];             /* cells along x, y, z */
    float *extinction_per_m; /* owned; x fastest; rounded up; for extinction_color 1 */
};

/* Creates majorants over a box (finite; normally the medium's support) with about `cell_count`
 * cells. Cells are as near to cubes as whole numbers allow, and not thinner than a grid medium's
 * own cells. NEPH_ERR_UNSUPPORTED: the box is infinite or has no inside. */
enum neph_status neph_majorants_create(const struct neph_medium *medium,
                                       const struct neph_bounds *box, int cell_count,
                                       struct neph_majorants **majorants, struct neph_diag *diag);

/* Raises the majorants of a grid medium to the largest node around each cell, for trackers that
 * sample one random node of the eight around a place; no effect on other kinds. The majorants are
 * looser then; trackers that evaluate the density do not need it. */
void neph_majorants_cover_nodes(struct neph_majorants *majorants, const struct neph_medium *medium);

/* NULL is fine. */
void neph_majorants_destroy(struct neph_majorants *majorants);

#endif
