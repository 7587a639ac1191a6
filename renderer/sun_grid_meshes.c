/* SPDX-License-Identifier: MIT
 *
 * Meshes in the grid across the sun.
 *
 * The triangles of a mesh that face the sun are sheets. A sun ray passes as many sheets as its
 * neighbours, except across the outline: edges at which such triangles end or overlap. So a cell
 * without outline, with a triangle over its middle, has a sheet over all of it. The same holds for
 * the triangles that face away. Only the height of triangles holds for a mesh with holes.
 */
#include "renderer/sun_grid.h"

#include "renderer/gpu_meshes.h"
#include "renderer/shaders/constants.h"
#include "scenes/bounds.h"
#include "scenes/mesh.h"
#include "scenes/mesh_place.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");

/* More triangles of all instances take too long: instances are boxes then, which hide nothing
 * surely. */
static const double triangles_max = 8e6;

static const unsigned char triangle_edges[3][2] = {{0, 1}, {1, 2}, {2, 0}};

_Static_assert(NEPH_ALPHA_COUNT == 3, "a new kind"); /* all but IGNORED make holes */

/* --- edges ----------------------------------------------------------------------------------- */

/* A side of a triangle. Vertices are the first ones of all at the same place. */
struct side {
    uint32_t low, high; /* vertices */
    int triangle;
    int direction; /* 1: from low to high; -1 */
};

static int compare_sides(const void *a, const void *b)
{
    const struct side *first = a, *second = b;
    if (first->low != second->low)
        return first->low < second->low ? -1 : 1;
    return first->high < second->high ? -1 : first->high > second->high;
}

struct placed_vertex {
    struct neph_vec3 at;
    uint32_t number;
};

static int compare_places(const void *a, const void *b)
{
    const struct placed_vertex *first = a, *second = b;
    const struct neph_vec3 p = first->at, q = second->at;
    if (p.x != q.x)
        return p.x < q.x ? -1 : 1;
    if (p.y != q.y)
        return p.y < q.y ? -1 : 1;
    if (p.z != q.z)
        return p.z < q.z ? -1 : 1;
    return first->number < second->number ? -1 : first->number > second->number;
}

static bool is_same_place(struct neph_vec3 p, struct neph_vec3 q)
{
    return p.x == q.x && p.y == q.y && p.z == q.z;
}

/* For each vertex the first one at its place. NULL: no memory. */
static uint32_t *find_first_vertices(const struct neph_mesh_data *data)
{
    const size_t count = (size_t)data->vertex_count;
    struct placed_vertex *sorted = malloc(count * sizeof(*sorted));
    uint32_t *firsts = malloc(count * sizeof(*firsts));
    if (!sorted || !firsts) {
        free(firsts);
        free(sorted);
        return NULL;
    }
    for (size_t i = 0; i < count; i++)
        sorted[i] = (struct placed_vertex){data->positions[i], (uint32_t)i};
    qsort(sorted, count, sizeof(*sorted), compare_places);
    for (size_t i = 0; i < count; i++)
        firsts[sorted[i].number] = i > 0 && is_same_place(sorted[i].at, sorted[i - 1].at)
                                       ? firsts[sorted[i - 1].number]
                                       : sorted[i].number;
    free(sorted);
    return firsts;
}

/* All sides, those between the same vertices behind each other. NULL: no memory. */
static struct side *find_sides(const struct neph_mesh_data *data)
{
    const size_t count = (size_t)data->triangle_count;
    uint32_t *firsts = find_first_vertices(data);
    struct side *sides = malloc(3 * count * sizeof(*sides));
    if (!firsts || !sides) {
        free(sides);
        free(firsts);
        return NULL;
    }
    for (size_t i = 0; i < 3 * count; i++) {
        const int *triangle = data->triangles[i / 3];
        const uint32_t a = firsts[triangle[i % 3]], b = firsts[triangle[(i + 1) % 3]];
        sides[i] = (struct side){a < b ? a : b, a < b ? b : a, (int)(i / 3), a < b ? 1 : -1};
    }
    qsort(sides, 3 * count, sizeof(*sides), compare_sides);
    free(firsts);
    return sides;
}

/* --- cells ----------------------------------------------------------------------------------- */

/* The work on one instance. */
struct adding {
    struct neph_sun_grid *grid;
    struct neph_sun_row *rows;
    const struct neph_mesh_data *data;
    struct neph_sun_point *points; /* of the vertices */
    signed char *facing;           /* of the triangles: 1 the sun is on the normal's side; -1; 0 */
    /* All cells; empty_cell outside of the current instance. */
    struct cell {
        float lowest_m; /* of the triangles of one facing */
        bool is_covered, has_outline;
    } * cells;
};

static const struct cell empty_cell = {INFINITY, false, false};

static struct cell *find_cell(const struct adding *adding, int column, int row)
{
    return &adding->cells[(size_t)row * (size_t)adding->grid->width + (size_t)column];
}

/* Heights over the plane of u and v, of a triangle's plane. */
struct plane {
    double constant, slope_u, slope_v;
    bool is_upright;
};

/* Twice the area in the plane of u and v. */
static double find_area(const struct neph_sun_point p[3])
{
    return (p[1].u - p[0].u) * (p[2].v - p[0].v) - (p[2].u - p[0].u) * (p[1].v - p[0].v);
}

static struct plane find_plane(const struct neph_sun_point p[3])
{
    const double area = find_area(p), b = p[1].w - p[0].w, c = p[2].w - p[0].w;
    const double slope_u = (b * (p[2].v - p[0].v) - c * (p[1].v - p[0].v)) / area;
    const double slope_v = (c * (p[1].u - p[0].u) - b * (p[2].u - p[0].u)) / area;
    return (struct plane){p[0].w - slope_u * p[0].u - slope_v * p[0].v, slope_u, slope_v,
                          !(fabs(slope_u) < 1e6 && fabs(slope_v) < 1e6)};
}

/* Whether a triangle is surely over the middle of a cell. */
static bool is_over_middle(const struct neph_sun_grid *grid, const struct neph_sun_point p[3],
                           int column, int row)
{
    const double u = grid->low_u_m + (column + 0.5) * grid->cell_m;
    const double v = grid->low_v_m + (row + 0.5) * grid->cell_m;
    int left = 0, right = 0;
    for (int i = 0; i < 3; i++) {
        const struct neph_sun_point a = p[i], b = p[(i + 1) % 3];
        const double side = (b.u - a.u) * (v - a.v) - (b.v - a.v) * (u - a.u);
        const double rounding = 1e-12 * grid->cell_m * grid->cell_m;
        left += side > rounding;
        right += side < -rounding;
    }
    return left == 3 || right == 3;
}

static void get_triangle(const struct adding *adding, int triangle, struct neph_sun_point p[3])
{
    for (int corner = 0; corner < 3; corner++)
        p[corner] = adding->points[adding->data->triangles[triangle][corner]];
}

static void add_triangle(struct adding *adding, int triangle)
{
    const struct neph_sun_grid *grid = adding->grid;
    struct neph_sun_point p[3];
    get_triangle(adding, triangle, p);
    const struct plane plane = find_plane(p);
    const double margin_m = neph_sun_grid_range(grid, 0, 0, 0.0, 0.0, 0.0).high;
    const double low_m = fmin(p[0].w, fmin(p[1].w, p[2].w)) - margin_m;
    const double high_m = fmax(p[0].w, fmax(p[1].w, p[2].w)) + margin_m;
    const struct neph_sun_row all = neph_sun_grid_touch(grid, p, 3, triangle_edges, 3,
                                                        adding->rows);
    for (int row = all.first; row <= all.last; row++)
        for (int column = adding->rows[row].first; column <= adding->rows[row].last; column++) {
            const struct neph_interval range =
                plane.is_upright ? (struct neph_interval){low_m, high_m}
                                 : neph_sun_grid_range(grid, column, row, plane.constant,
                                                       plane.slope_u, plane.slope_v);
            struct cell *cell = find_cell(adding, column, row);
            cell->lowest_m = fminf(cell->lowest_m, (float)fmax(low_m, range.low));
            cell->is_covered |= is_over_middle(grid, p, column, row);
            neph_sun_grid_raise(adding->grid, column, row, -INFINITY, fmin(high_m, range.high));
        }
}

static void add_outline(struct adding *adding, const struct side *side)
{
    static const unsigned char edge[1][2] = {{0, 1}};
    const struct neph_sun_point ends[2] = {adding->points[side->low], adding->points[side->high]};
    const struct neph_sun_row all = neph_sun_grid_touch(adding->grid, ends, 2, edge, 1,
                                                        adding->rows);
    for (int row = all.first; row <= all.last; row++)
        for (int column = adding->rows[row].first; column <= adding->rows[row].last; column++)
            find_cell(adding, column, row)->has_outline = true;
}

/* The edges at which triangles of a facing end or overlap: their sides do not cancel. */
static void add_outlines(struct adding *adding, const struct side *sides, int facing)
{
    const size_t count = 3 * (size_t)adding->data->triangle_count;
    for (size_t first = 0, end; first < count; first = end) {
        int sum = 0;
        for (end = first; end < count && compare_sides(&sides[first], &sides[end]) == 0; end++)
            sum += adding->facing[sides[end].triangle] == facing ? sides[end].direction : 0;
        if (sum != 0)
            add_outline(adding, &sides[first]);
    }
}

/* Raises the cells in the rectangle around the points, and empties them. A sheet with holes hides
 * nothing surely. */
static void close_cells(struct adding *adding, bool has_holes)
{
    const struct neph_sun_grid *grid = adding->grid;
    struct neph_sun_point low = {INFINITY, INFINITY, 0.0}, high = {-INFINITY, -INFINITY, 0.0};
    for (int i = 0; i < adding->data->vertex_count; i++) {
        const struct neph_sun_point at = adding->points[i];
        low = (struct neph_sun_point){fmin(low.u, at.u), fmin(low.v, at.v), 0.0};
        high = (struct neph_sun_point){fmax(high.u, at.u), fmax(high.v, at.v), 0.0};
    }
    const struct neph_sun_point corners[4] = {
        low, {high.u, low.v, 0.0}, high, {low.u, high.v, 0.0}};
    static const unsigned char around[4][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
    const struct neph_sun_row all = neph_sun_grid_touch(grid, corners, 4, around, 4, adding->rows);
    for (int row = all.first; row <= all.last; row++)
        for (int column = adding->rows[row].first; column <= adding->rows[row].last; column++) {
            struct cell *cell = find_cell(adding, column, row);
            if (cell->is_covered && !cell->has_outline && !has_holes)
                neph_sun_grid_raise(adding->grid, column, row, cell->lowest_m, -INFINITY);
            *cell = empty_cell;
        }
}

/* --- instances ------------------------------------------------------------------------------- */

static void place_points(struct adding *adding, const struct neph_solid *solid)
{
    struct neph_vec3 axes[3];
    neph_mesh_axes(solid, axes);
    for (int i = 0; i < adding->data->vertex_count; i++) {
        const struct neph_vec3 p = neph_vec3_scale(adding->data->positions[i], solid->scale_m);
        struct neph_vec3 at_m = neph_vec3_along(solid->center_m, axes[0], p.x);
        at_m = neph_vec3_along(neph_vec3_along(at_m, axes[1], p.y), axes[2], p.z);
        adding->points[i] = neph_sun_point(&adding->grid->axes, at_m);
    }
    for (int i = 0; i < adding->data->triangle_count; i++) {
        struct neph_sun_point p[3];
        get_triangle(adding, i, p);
        const double area = find_area(p);
        adding->facing[i] = (signed char)((area > 0.0) - (area < 0.0));
    }
}

static void add_instance(struct adding *adding, const struct side *sides, bool has_holes)
{
    for (int facing = -1; facing <= 1; facing++) {
        for (int i = 0; i < adding->data->triangle_count; i++)
            if (adding->facing[i] == facing)
                add_triangle(adding, i);
        if (facing != 0)
            add_outlines(adding, sides, facing);
        close_cells(adding, has_holes);
    }
}

/* All instances of a mesh. */
static enum neph_status add_mesh(const struct neph_scene *scene, const struct neph_mesh *mesh,
                                 struct adding *adding, struct neph_diag *diag)
{
    const size_t vertices = (size_t)mesh->data.vertex_count;
    struct side *sides = find_sides(&mesh->data);
    adding->data = &mesh->data;
    adding->points = malloc(vertices * sizeof(*adding->points));
    adding->facing = malloc((size_t)mesh->data.triangle_count);
    const bool has_room = sides && adding->points && adding->facing;
    for (int i = 0; i < scene->solid_count && has_room; i++)
        if (scene->solids[i].mesh == mesh && !scene->solids[i].moves) {
            place_points(adding, &scene->solids[i]);
            add_instance(adding, sides, mesh->material.alpha != NEPH_ALPHA_IGNORED);
        }
    free(adding->facing);
    free(adding->points);
    free(sides);
    return has_room ? NEPH_OK : neph_fail_memory(diag);
}

/* Instances as boxes. */
static void add_bounds(const struct neph_scene *scene, struct adding *adding)
{
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_bounds box = neph_solid_bounds(&scene->solids[i]);
        struct neph_vec3 corners_m[8];
        double top_m;
        if (scene->solids[i].kind != NEPH_SOLID_MESH || scene->solids[i].moves)
            continue;
        neph_sun_grid_corners(&box, corners_m);
        const struct neph_sun_row all = neph_sun_grid_touch_box(adding->grid, corners_m,
                                                                adding->rows, &top_m);
        for (int row = all.first; row <= all.last; row++)
            for (int column = adding->rows[row].first; column <= adding->rows[row].last; column++)
                neph_sun_grid_raise(
                    adding->grid, column, row, -INFINITY,
                    neph_sun_grid_range(adding->grid, column, row, top_m, 0.0, 0.0).high);
    }
}

enum neph_status neph_sun_grid_add_meshes(const struct neph_scene *scene,
                                          struct neph_sun_grid *grid, struct neph_diag *diag)
{
    const size_t count = (size_t)grid->width * (size_t)grid->height;
    struct adding adding = {.grid = grid};
    enum neph_status status = NEPH_OK;
    if (neph_gpu_count_instances(scene) == 0)
        return NEPH_OK;
    adding.rows = malloc((size_t)grid->height * sizeof(*adding.rows));
    adding.cells = malloc(count * sizeof(*adding.cells));
    if (!adding.rows || !adding.cells)
        status = neph_fail_memory(diag);
    for (size_t i = 0; i < count && !status; i++)
        adding.cells[i] = empty_cell;
    if (!status && neph_gpu_count_triangles(scene) > triangles_max)
        add_bounds(scene, &adding);
    else
        for (int i = 0; i < scene->mesh_count && !status; i++)
            status = add_mesh(scene, scene->meshes[i], &adding, diag);
    free(adding.cells);
    free(adding.rows);
    return status;
}
