/* SPDX-License-Identifier: MIT
 *
 * A thin layer of cloud, such as cirrus: voxels of one node's height, so that every engine that has
 * voxels has it. Across the layer the density is a tent, 0 at both faces; along it, a pattern. So
 * the optical depth straight up through a place is the pattern there times that of the sheet, in
 * closed form, and half of it from the middle plane on.
 *
 * Around a planet it is as many nodes high as it goes down towards its corners, each column a tent
 * between those next to its middle: tents of half a thickness add up to 1 wherever they lie, so
 * that the optical depth straight up is the same, and the middle is where it belongs; the faces are
 * up to half a thickness farther.
 */
#ifndef NEPH_SCENES_SHEET_H
#define NEPH_SCENES_SHEET_H

#include "scenes/grid.h"

enum neph_sheet_pattern {
    NEPH_SHEET_EVEN,    /* 1 everywhere */
    NEPH_SHEET_STREAKS, /* wisps drawn out along a direction, with clear air between them */
    NEPH_SHEET_PATTERN_COUNT,
};

struct neph_sheet {
    struct neph_vec3 center_m;
    double side_m;          /* along x and z */
    double thickness_m;     /* from face to face, > 0 */
    double planet_radius_m; /* of a planet under the middle, more than side_m; 0: it is level */
    int nodes;              /* along each side, 2..NEPH_GRID_SIDE_MAX */
    enum neph_sheet_pattern pattern;
    int seed;
    double wisp_m;          /* between wisps, across them */
    double stretch;         /* a wisp's length is so many times that */
    struct neph_vec3 along; /* wisps; its x and z count, which are not both 0 */
    double coverage;        /* of the pattern that is not clear, 0 (nearly nothing) .. 1 */
};

/* The pattern, 0..1, at a place. */
double neph_sheet_value(const struct neph_sheet *sheet, struct neph_vec3 point_m);

/* How far the layer lies below its middle, so far from that to the side [m]. */
double neph_sheet_drop_m(const struct neph_sheet *sheet, double x_m, double z_m);

/* A sealed grid of these values. For neph_grid_destroy(). Errors as of neph_grid_create(). */
enum neph_status neph_sheet_make(const struct neph_sheet *sheet, struct neph_grid **grid,
                                 struct neph_diag *diag);

/* Extinction [1/m] in the middle plane, where the pattern is 1, for an optical depth straight
 * through. */
double neph_sheet_extinction_per_m(const struct neph_sheet *sheet, double optical_depth);

#endif
