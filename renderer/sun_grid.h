/* SPDX-License-Identifier: MIT
 *
 * A grid across the sun for shadows of solids (shaders/sun_grid.glsl): each cell has the height
 * towards the sun from which on no solid hides the sun, and the height up to which one surely does.
 * Between both, rays decide. Both heights have reserves for the rounding of rays in float32, so the
 * grid changes no decision (conservative shadow maps: S. Hertel, K. Hormann, R. Westermann, "A
 * Hybrid GPU Rendering Pipeline for Alias-Free Hard Shadows", Eurographics 2009, Areas Papers).
 *
 * Solids that are wide, such as a ground, or that move are not in the grid: rays test them, and
 * they are few. Private to renderer/.
 */
#ifndef NEPH_RENDERER_SUN_GRID_H
#define NEPH_RENDERER_SUN_GRID_H

#include "base/status.h"
#include "renderer/compute.h"
#include "scenes/quadrature.h"
#include "scenes/scene.h"
#include "shaders/structs.h"

/* Coordinates u, v across the sun and w towards it [m]. */
struct neph_sun_axes {
    struct neph_vec3 origin_m, u, v, w; /* unit vectors */
};

struct neph_sun_grid {
    struct neph_sun_axes axes;
    double low_u_m, low_v_m; /* corner of cell (0, 0) */
    double cell_m;           /* side of a cell */
    int width, height;       /* in cells */
    float (*limits_m)[2];    /* of each cell: hidden up to, seen from */
    uint32_t *listed;        /* of each cell: boxes and spheres in it, by NEPH_GPU_LISTED_BITS */
    /* The solids for which it is. */
    int solid_count;
    struct neph_solid *solids;
};

/* The hull of all boxes of a scene that rest, or without boxes of such spheres. And whether a solid
 * is not in the grid: it moves, or is at least a quarter as wide along two axes as the hull. A mesh
 * is not wide. */
struct neph_bounds neph_plain_hull(const struct neph_scene *scene);
bool neph_is_apart(const struct neph_solid *solid, const struct neph_bounds *hull);

/* The number of cells for which a scene needs room: 0 where few solids or a moving sun make a grid
 * useless. And the number of words of four that they take. */
size_t neph_sun_grid_room(const struct neph_scene *scene);
size_t neph_sun_grid_words(const struct neph_scene *scene);

/* Build the grid of a scene that has room for one; zero-initialise `grid`, free with _destroy. */
enum neph_status neph_sun_grid_create(const struct neph_scene *scene, struct neph_sun_grid *grid,
                                      struct neph_diag *diag);
void neph_sun_grid_destroy(struct neph_sun_grid *grid);

/* Free the cells, after their upload. */
void neph_sun_grid_free_cells(struct neph_sun_grid *grid);

/* Whether it is the grid of a scene's sun and of its solids that rest. */
bool neph_sun_grid_fits(const struct neph_sun_grid *grid, const struct neph_scene *scene);

/* The member of a frame, for a camera; in the buffer `words` of four are before the grid. Where
 * the camera is too far for float32, no point uses the grid. */
struct neph_gpu_sun_grid neph_sun_grid_place(const struct neph_sun_grid *grid,
                                             struct neph_vec3 camera_m, uint32_t words);

/* Upload the cells behind the first `words` of four of a buffer. */
enum neph_status neph_sun_grid_upload(const struct neph_sun_grid *grid,
                                      const struct neph_vulkan *vulkan,
                                      const struct neph_buffer *buffer, size_t words,
                                      struct neph_diag *diag);

/* --- for sun_grid_meshes.c ------------------------------------------------------------------- */

struct neph_sun_point {
    double u, v, w;
};

struct neph_sun_point neph_sun_point(const struct neph_sun_axes *axes, struct neph_vec3 point_m);

/* The cells of a row, first .. last; none where first > last. */
struct neph_sun_row {
    int first, last;
};

/* The rows first .. last that the hull of some points touches, and in `rows`, indexed by the row,
 * their cells. Cells are larger by a reserve on all sides. `edges` has pairs of points that include
 * all edges of the hull. */
struct neph_sun_row neph_sun_grid_touch(const struct neph_sun_grid *grid,
                                        const struct neph_sun_point *points, int point_count,
                                        const unsigned char (*edges)[2], int edge_count,
                                        struct neph_sun_row *rows);

/* The corners of a box, bit k of the index for the high side along axis k. And the rows that a box
 * with such corners touches, as above, and its highest point. */
void neph_sun_grid_corners(const struct neph_bounds *box, struct neph_vec3 corners_m[8]);
struct neph_sun_row neph_sun_grid_touch_box(const struct neph_sun_grid *grid,
                                            const struct neph_vec3 corners_m[8],
                                            struct neph_sun_row *rows, double *top_m);

/* The least and the largest value of constant + slope_u u + slope_v v in a cell with its reserve,
 * lowered and raised by the reserve of heights. */
struct neph_interval neph_sun_grid_range(const struct neph_sun_grid *grid, int column, int row,
                                         double constant, double slope_u, double slope_v);

/* Raise both limits of a cell: for a solid that hides the sun up to dark_m, -inf: nowhere surely,
 * and nowhere from lit_m on. */
void neph_sun_grid_raise(struct neph_sun_grid *grid, int column, int row, double dark_m,
                         double lit_m);

/* Adds the instances of meshes. */
enum neph_status neph_sun_grid_add_meshes(const struct neph_scene *scene,
                                          struct neph_sun_grid *grid, struct neph_diag *diag);

#endif
