/* SPDX-License-Identifier: MIT
 *
 * A voxel grid of density. The density between the nodes is trilinear; beyond the outermost nodes
 * it falls to 0 within one cell, as if the lattice went on with zeros (what OpenVDB's trilinear
 * sampler does with a background of 0, and what Cycles and POV-Ray do with a padded grid).
 */
#ifndef NEPH_SCENES_GRID_H
#define NEPH_SCENES_GRID_H

#include "scenes/scene.h"

#include <stddef.h>
#include <stdint.h>

#define NEPH_GRID_SIDE_MAX 1024
/* How far a grid without end goes, to both sides of the world's origin, and how close its nodes may
 * be: cells on the way there are counted in an int. */
#define NEPH_GRID_ENDLESS_M 1e6
#define NEPH_GRID_ENDLESS_SPACING_M 1e-2
/* 512^3 floats: 512 MiB. What a file may ask for; larger is refused with the sizes in words. */
#define NEPH_GRID_NODES_MAX ((size_t)1 << 27)

struct neph_grid {
    int size[3];                /* nodes along x, y, z; 1..NEPH_GRID_SIDE_MAX */
    struct neph_vec3 origin_m;  /* of node (0, 0, 0) */
    struct neph_vec3 spacing_m; /* between nodes, > 0 */
    bool is_endless[3];         /* along x, y, z: behind the last node comes the first again */
    float *values;              /* owned; x fastest, then y, then z; finite, >= 0; dimensionless */
    float maximum;              /* of values */
    char hash[NEPH_HASH_HEX_SIZE]; /* of size and values; set by neph_grid_seal */
};

/* A grid of zeros. NEPH_ERR_INPUT: a side or the product is out of range, in words. */
enum neph_status neph_grid_create(const int size[3], struct neph_vec3 origin_m,
                                  struct neph_vec3 spacing_m, struct neph_grid **grid,
                                  struct neph_diag *diag);

/* After the values are written: check them (finite, not negative; the error names the first bad
 * node), find the maximum and the hash. */
enum neph_status neph_grid_seal(struct neph_grid *grid, struct neph_diag *diag);

/* Put it somewhere else, stretched or not; sealed or not. NEPH_ERR_INPUT as for neph_grid_create(),
 * and then it stays where it was. */
enum neph_status neph_grid_place(struct neph_grid *grid, struct neph_vec3 origin_m,
                                 struct neph_vec3 spacing_m, struct neph_diag *diag);

/* NULL is fine. */
void neph_grid_destroy(struct neph_grid *grid);

/* Where the density may be above 0: one cell beyond the outermost nodes, or as far as there is a
 * world. */
struct neph_bounds neph_grid_support(const struct neph_grid *grid);

/* Along any axis. */
bool neph_grid_is_endless(const struct neph_grid *grid);

/* The node that has the value of any, along an axis that has no end. */
int neph_grid_wrapped(const struct neph_grid *grid, int axis, int node);

/* Trilinear density at a point. */
double neph_grid_density(const struct neph_grid *grid, struct neph_vec3 point_m);

/* The integral of the density along origin + t direction over [t0_m, t1_m] [m]: exact, because
 * within a cell the density is a cubic in t, and two-point Gauss integrates a cubic. Cells are
 * walked as by Amanatides and Woo (1987). */
double neph_grid_integral_m(const struct neph_grid *grid, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m);

/* The largest density in a box (to rounding), sides included; they may be infinite. Not only the
 * largest node around it, which is a quarter more in cells of 4 nodes of a cloud: tracking methods
 * pay for every bit of that. */
double neph_grid_maximum_in(const struct neph_grid *grid, const struct neph_bounds *box);

/* The largest node of all cells that the box reaches into by more than rounding (1e-6 of a cell):
 * for trackers that look up one node by chance in place of the density. */
double neph_grid_node_maximum_in(const struct neph_grid *grid, const struct neph_bounds *box);

#endif
