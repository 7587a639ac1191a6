/* SPDX-License-Identifier: MIT
 *
 * Voxels as a medium: scenes/grid.h.
 */
#include "scenes/grid.h"
#include "scenes/hash_text.h"
#include "scenes/media.h"
#include "scenes/medium_kind.h"
#include "scenes/solids.h"

#include <math.h>

static double extinction_per_m(const struct neph_medium *medium, struct neph_vec3 point_m)
{
    return medium->extinction_per_m * neph_grid_density(medium->grid, point_m);
}

static double optical_depth(const struct neph_medium *medium, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m)
{
    return medium->extinction_per_m *
           neph_grid_integral_m(medium->grid, origin_m, direction, t0_m, t1_m);
}

static double bound_per_m(const struct neph_medium *medium, const struct neph_bounds *box)
{
    return medium->extinction_per_m * neph_grid_maximum_in(medium->grid, box);
}

static void drift(struct neph_medium *medium, struct neph_vec3 by_m)
{
    medium->grid->origin_m = neph_vec3_add(medium->grid->origin_m, by_m);
    medium->bounds = neph_bounds_moved(medium->bounds, by_m);
}

static struct neph_bounds support(const struct neph_medium *medium)
{
    return neph_grid_support(medium->grid);
}

/* The shadow that a grid throws on the ray, an eighth of its cells at a time: nodes are then closer
 * than its cells. */
static void cut_scales(struct neph_cuts *cuts, const struct neph_medium *medium)
{
    const struct neph_solid box = {.kind = NEPH_SOLID_BOX, .box = neph_medium_support(medium)};
    const int *size = medium->grid->size;
    const int cells = size[0] > size[1] ? size[0] : size[1];
    const int pieces = 1 + (cells > size[2] ? cells : size[2]) / 8;
    double low_m, high_m;
    if (cuts->scene->medium_count == 1) /* its own cells are cut finer */
        return;
    if (!neph_solid_shadow(&box, cuts->scene->sun.direction, cuts->origin_m, cuts->direction,
                           cuts->t0_m, cuts->t1_m, &low_m, &high_m))
        return;
    for (int k = 0; k <= pieces; k++)
        neph_cut(cuts, low_m + (high_m - low_m) * k / pieces);
}

/* The faces of the cells on the ray, where the density has kinks. */
static void cut_kinks(struct neph_cuts *cuts, const struct neph_medium *medium)
{
    const struct neph_grid *grid = medium->grid;
    const struct neph_bounds support = neph_medium_support(medium);
    const double origin[3] = {cuts->origin_m.x, cuts->origin_m.y, cuts->origin_m.z};
    const double view[3] = {cuts->direction.x, cuts->direction.y, cuts->direction.z};
    const double first[3] = {grid->origin_m.x, grid->origin_m.y, grid->origin_m.z};
    const double spacing[3] = {grid->spacing_m.x, grid->spacing_m.y, grid->spacing_m.z};
    double near_m, far_m;
    if (!neph_cuts_inside(cuts, &support, &near_m, &far_m))
        return;
    for (int axis = 0; axis < 3; axis++)
        for (int i = -1; i <= grid->size[axis] && view[axis] != 0.0; i++) {
            const double t_m = (first[axis] + i * spacing[axis] - origin[axis]) / view[axis];
            if (t_m >= near_m && t_m <= far_m)
                neph_cut(cuts, t_m);
        }
}

static void hash(const struct neph_medium *medium, FILE *text)
{
    const struct neph_grid *grid = medium->grid;
    neph_put_number(text, "extinction_per_m", medium->extinction_per_m);
    neph_put_three(text, "size", grid->size[0], grid->size[1], grid->size[2]);
    neph_put_vec3(text, "origin_m", grid->origin_m);
    neph_put_vec3(text, "spacing_m", grid->spacing_m);
    fprintf(text, "values %s\n", grid->hash);
}

static void destroy(struct neph_medium *medium)
{
    neph_grid_destroy(medium->grid);
}

static void borrow(struct neph_medium *medium, void *room)
{
    struct neph_grid *grid = room;
    *grid = *medium->grid;
    medium->grid = grid;
}

const struct neph_medium_row neph_medium_grid = {
    .facts = {.name = "voxel grid",
              .has_closed_form = true,
              .has_kinks = true,
              .needs_majorants = true,
              .majorant_cells = NEPH_MAJORANT_CELLS},
    .extinction_per_m = extinction_per_m,
    .optical_depth = optical_depth,
    .bound_per_m = bound_per_m,
    .support = support,
    .cut_scales = cut_scales,
    .cut_kinks = cut_kinks,
    .drift = drift,
    .hash = hash,
    .destroy = destroy,
    .borrow = borrow,
    .room_size = sizeof(struct neph_grid),
};
