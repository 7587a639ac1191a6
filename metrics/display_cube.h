/* SPDX-License-Identifier: MIT
 *
 * A view of a user's OpenColorIO config as a table, for programs that cannot call OpenColorIO.
 *
 * The axes are linear Rec.709 R, G and B: a value x is at the position log2(1 + x / knee) / log2(1
 * + top / knee) of its axis, clamped to 0 .. 1. Values between nodes are interpolated trilinearly.
 */
#ifndef NEPH_METRICS_DISPLAY_CUBE_H
#define NEPH_METRICS_DISPLAY_CUBE_H

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { NEPH_DISPLAY_CUBE_SIDE = 40 };

/* The view. A NULL name: the default of the config. */
struct neph_display_choice {
    const char *config; /* path of the config */
    const char *display, *view;
    const char *space; /* the config's name of linear Rec.709; NULL: found by the role
                          aces_interchange (ACES2065-1), or, without it, the role scene_linear */
};

struct neph_display_cube {
    char name[128]; /* "Filmic on sRGB" */
    double knee, top;
    float *nodes[3];              /* R, G, B in codes, NEPH_DISPLAY_CUBE_SIDE^3 each, red fastest.
                                   * Nodes may lie outside of 0 .. 255, so that interpolated values
                                   * are clamped without a bend at the limits; nodes[0] is owned */
    double error_mean, error_max; /* error of the table, in codes, over random colours */
    int not_numbers; /* number of NaN colours in the config's tables and nodes; they are 0 here, and
                      * the caller reports them */
};

/* Bake the view. Free the nodes with neph_display_cube_finish(). NEPH_ERR_NOT_FOUND: no such
 * config. NEPH_ERR_INPUT: OpenColorIO cannot read it, or it has no such display, view or space; the
 * message lists the existing names. */
enum neph_status neph_display_cube_bake(const struct neph_display_choice *choice,
                                        struct neph_display_cube *cube, struct neph_diag *diag);
void neph_display_cube_finish(struct neph_display_cube *cube);

#ifdef __cplusplus
}
#endif

#endif
