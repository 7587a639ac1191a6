/* SPDX-License-Identifier: MIT
 *
 * A thin layer of cloud, such as cirrus: voxels of one node's height, so that every engine with
 * voxels supports it. Across the layer the density is a tent, 0 at both faces; along the layer it
 * is a pattern. So the optical depth straight up through a place is the pattern there times the
 * optical depth of the sheet, in closed form, and half of it above the middle plane.
 *
 * Around a planet the grid has as many nodes of height as the layer curves down to its corners.
 * Each column is a tent between the nodes next to its middle: tents of half a thickness add up to 1
 * anywhere, so the optical depth straight up is the same, and the middle is in its place; the faces
 * are up to half a thickness farther out.
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
    double stretch;         /* length of a wisp over its width */
    struct neph_vec3 along; /* direction of wisps; x and z, which are not both 0 */
    double coverage;        /* part of the pattern that is not clear, 0 (nearly nothing) .. 1 */
};

/* The pattern, 0..1, at a place. */
double neph_sheet_value(const struct neph_sheet *sheet, struct neph_vec3 point_m);

/* Depth of the layer below its middle point at this horizontal distance from it [m]. */
double neph_sheet_drop_m(const struct neph_sheet *sheet, double x_m, double z_m);

/* A sealed grid of the pattern. Free with neph_grid_destroy(). Errors as for neph_grid_create(). */
enum neph_status neph_sheet_make(const struct neph_sheet *sheet, struct neph_grid **grid,
                                 struct neph_diag *diag);

/* Extinction [1/m] in the middle plane, where the pattern is 1, for an optical depth straight
 * through. */
double neph_sheet_extinction_per_m(const struct neph_sheet *sheet, double optical_depth);

#endif
