/* SPDX-License-Identifier: MIT
 *
 * A view of somebody's OpenColorIO config as a table, for programs that cannot call OpenColorIO.
 *
 * The axes are those of linear Rec.709 R, G and B: a value x is at the place
 * log2(1 + x / knee) / log2(1 + top / knee) of its axis, 0 .. 1, clamped. Between the nodes values
 * are trilinear.
 */
#ifndef NEPH_METRICS_DISPLAY_CUBE_H
#define NEPH_METRICS_DISPLAY_CUBE_H

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { NEPH_DISPLAY_CUBE_SIDE = 40 };

/* Which view. NULL names: what the config says by default. */
struct neph_display_choice {
    const char *config; /* a file */
    const char *display, *view;
    const char *space; /* that is linear Rec.709; NULL: the role scene_linear is */
};

struct neph_display_cube {
    char name[128]; /* "Filmic on sRGB" */
    double knee, top;
    float *nodes[3];              /* R, G, B in codes, NEPH_DISPLAY_CUBE_SIDE^3 each, red fastest;
                                     a display ends at 0 and 255, and nodes need not, so that what
                                     lies between two is clamped and not bent; nodes[0] is owned */
    double error_mean, error_max; /* of the table, in codes, over colours drawn at random */
    int not_numbers; /* colours in the tables of the config, and nodes, that are NaN: they are 0
                        here, and it is for the caller to tell */
};

/* Free the nodes with neph_display_cube_finish(). NEPH_ERR_NOT_FOUND: no such config.
 * NEPH_ERR_INPUT: OpenColorIO cannot read it, or it has no such display, view or space; the message
 * names those that there are. */
enum neph_status neph_display_cube_bake(const struct neph_display_choice *choice,
                                        struct neph_display_cube *cube, struct neph_diag *diag);
void neph_display_cube_finish(struct neph_display_cube *cube);

#ifdef __cplusplus
}
#endif

#endif
