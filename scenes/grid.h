/* SPDX-License-Identifier: MIT
 *
 * A voxel grid of density. The density is trilinear between the nodes; beyond the outermost nodes
 * it falls to 0 within one cell, as if the lattice continued with zeros (like OpenVDB's trilinear
 * sampler with a background of 0, and like Cycles and POV-Ray with a padded grid). A grid of
 * constant cells has the density of the nearest node along each axis, and ends half a cell beyond
 * the outermost nodes: the clouds of radiation codes are tables of such cells.
 */
#ifndef NEPH_SCENES_GRID_H
#define NEPH_SCENES_GRID_H

#include "scenes/scene.h"

#include <stddef.h>
#include <stdint.h>

#define NEPH_GRID_SIDE_MAX 1024
/* Extent of an endless grid to both sides of the world's origin, and the least spacing of its
 * nodes: cells within that extent are counted in an int. */
#define NEPH_GRID_ENDLESS_M 1e6
#define NEPH_GRID_ENDLESS_SPACING_M 1e-2
/* Limit of a file, 512^3 floats: 512 MiB; a larger grid is refused with the sizes in words. */
#define NEPH_GRID_NODES_MAX ((size_t)1 << 27)

#define NEPH_GRID_NOTE_SIZE 400

struct neph_grid {
    int size[3];                /* nodes along x, y, z; 1..NEPH_GRID_SIDE_MAX */
    struct neph_vec3 origin_m;  /* of node (0, 0, 0) */
    struct neph_vec3 spacing_m; /* between nodes, > 0 */
    bool is_endless[3];         /* along x, y, z: the nodes repeat periodically */
    bool is_constant;           /* in a cell around each node; else trilinear between nodes */
    float *values;              /* owned; x fastest, then y, then z; finite, >= 0; dimensionless */
    float maximum;              /* of values */
    char hash[NEPH_HASH_HEX_SIZE]; /* of size and values; set by neph_grid_seal */
    /* How a reader changed the values of its file, for people; "": not at all. */
    char note[NEPH_GRID_NOTE_SIZE];
};

/* A grid of zeros. NEPH_ERR_INPUT: a side or the product is out of range, in words. */
enum neph_status neph_grid_create(const int size[3], struct neph_vec3 origin_m,
                                  struct neph_vec3 spacing_m, struct neph_grid **grid,
                                  struct neph_diag *diag);

/* Call after the values are written: checks them (finite, not negative; the error names the first
 * bad node), and computes the maximum and the hash. */
enum neph_status neph_grid_seal(struct neph_grid *grid, struct neph_diag *diag);

/* Changes place and spacing; sealed or not. On errors as for neph_grid_create() the grid keeps its
 * place. */
enum neph_status neph_grid_place(struct neph_grid *grid, struct neph_vec3 origin_m,
                                 struct neph_vec3 spacing_m, struct neph_diag *diag);

/* NULL is fine. */
void neph_grid_destroy(struct neph_grid *grid);

/* The box in which the density may be above 0: one cell beyond the outermost nodes (half a cell, if
 * cells are constant), or the extent of an endless grid. */
struct neph_bounds neph_grid_support(const struct neph_grid *grid);

/* Whether the grid is endless along any axis. */
bool neph_grid_is_endless(const struct neph_grid *grid);

/* The node with the value of any node number, along an endless axis. */
int neph_grid_wrapped(const struct neph_grid *grid, int axis, int node);

/* Density at a point. */
double neph_grid_density(const struct neph_grid *grid, struct neph_vec3 point_m);

/* The integral of the density along origin + t direction over [t0_m, t1_m] [m]. Exact: within a
 * cell the density is a cubic in t, and two-point Gauss quadrature integrates a cubic. The cells
 * are traversed as in Amanatides and Woo (1987). */
double neph_grid_integral_m(const struct neph_grid *grid, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m);

/* The distance in [t0_m, t1_m] at which the integral from t0_m reaches `integral_m`, by exact
 * inversion; +inf if it does not. Only for constant cells. */
double neph_grid_free_path_m(const struct neph_grid *grid, struct neph_vec3 origin_m,
                             struct neph_vec3 direction, double t0_m, double t1_m,
                             double integral_m);

/* The largest density in a box (up to rounding), sides included; sides may be infinite. Tighter
 * than the largest node around the box, which is a quarter larger in cells of 4 nodes of a cloud:
 * every excess costs tracking methods candidates. */
double neph_grid_maximum_in(const struct neph_grid *grid, const struct neph_bounds *box);

/* The largest node of all cells that overlap the box by more than rounding (1e-6 of a cell): for
 * trackers that sample one random node in place of the density. */
double neph_grid_node_maximum_in(const struct neph_grid *grid, const struct neph_bounds *box);

#endif
