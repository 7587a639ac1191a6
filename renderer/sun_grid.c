/* SPDX-License-Identifier: MIT */
#include "renderer/sun_grid.h"

#include "renderer/gpu_meshes.h"
#include "renderer/relative.h"
#include "renderer/shaders/constants.h"
#include "scenes/bounds.h"
#include "scenes/quadrature.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Does not compile with a new kind: this file then needs a change. */
_Static_assert(NEPH_SOLID_KIND_COUNT == 3, "a new kind");
_Static_assert(NEPH_SCENE_SOLIDS_MAX <= 1 << NEPH_GPU_LISTED_BITS &&
                   2 + 3 * NEPH_GPU_LISTED_BITS <= 32,
               "three numbers of solids and their count in a word");

enum {
    SOLIDS_MIN = 8,        /* fewer are tested in less time than a cell is read, on lavapipe */
    SOLID_CELLS = 1 << 12, /* cells for each solid */
    CELLS_MAX = 1 << 20,
    SIDE_MAX = 4096,
};

/* Reserves, in sides of a cell. Points use the grid up to `reach` from the camera, and the camera
 * up to `reach` from the grid's corner: float32 has rounded their coordinates by less than 0.03
 * then, and rays the places and heights of solids by as much. A sun ray starts 1e-6 times the
 * point's distance above the point (SHADOW_START in shaders/scene.glsl), at most 0.025. */
static const double reserve = 0.1, height_reserve = 0.5, reach = 2.5e4;

/* --- solids ---------------------------------------------------------------------------------- */

static double get_side(const struct neph_bounds *box, int axis)
{
    const double sides[3] = {box->max_m.x - box->min_m.x, box->max_m.y - box->min_m.y,
                             box->max_m.z - box->min_m.z};
    return sides[axis];
}

static const struct neph_bounds nothing = {{INFINITY, INFINITY, INFINITY},
                                           {-INFINITY, -INFINITY, -INFINITY}};

static struct neph_bounds find_hull(const struct neph_scene *scene, enum neph_solid_kind kind)
{
    struct neph_bounds hull = nothing;
    for (int i = 0; i < scene->solid_count; i++)
        if (scene->solids[i].kind == kind && !scene->solids[i].moves)
            hull = neph_bounds_hull(hull, neph_solid_bounds(&scene->solids[i]));
    return hull;
}

struct neph_bounds neph_plain_hull(const struct neph_scene *scene)
{
    const struct neph_bounds boxes = find_hull(scene, NEPH_SOLID_BOX);
    return neph_bounds_are_empty(&boxes) ? find_hull(scene, NEPH_SOLID_SPHERE) : boxes;
}

bool neph_is_apart(const struct neph_solid *solid, const struct neph_bounds *hull)
{
    const struct neph_bounds box = neph_solid_bounds(solid);
    int wide_axes = 0;
    for (int axis = 0; axis < 3; axis++)
        wide_axes += get_side(&box, axis) >= 0.25 * get_side(hull, axis);
    return solid->moves || (solid->kind != NEPH_SOLID_MESH && wide_axes >= 2);
}

size_t neph_sun_grid_room(const struct neph_scene *scene)
{
    if (!scene->sun.present || scene->medium_count == 0 || scene->sun_key_count > 0)
        return 0;
    if (neph_gpu_count_instances(scene) > 0)
        return CELLS_MAX;
    const size_t cells = SOLID_CELLS * (size_t)scene->solid_count;
    return scene->solid_count < SOLIDS_MIN ? 0 : cells < CELLS_MAX ? cells : CELLS_MAX;
}

/* Two limits and one list for each cell. */
size_t neph_sun_grid_words(const struct neph_scene *scene)
{
    return 3 * neph_sun_grid_room(scene) / 4;
}

/* --- axes and cells -------------------------------------------------------------------------- */

static struct neph_sun_axes find_axes(struct neph_vec3 sun)
{
    const struct neph_vec3 up = {0.0, fabs(sun.y) < 0.9 ? 1.0 : 0.0, fabs(sun.y) < 0.9 ? 0.0 : 1.0};
    const struct neph_vec3 u = neph_vec3_normalize(neph_vec3_cross(up, sun));
    return (struct neph_sun_axes){{0.0, 0.0, 0.0}, u, neph_vec3_cross(sun, u), sun};
}

struct neph_sun_point neph_sun_point(const struct neph_sun_axes *axes, struct neph_vec3 point_m)
{
    const struct neph_vec3 from_m = neph_vec3_sub(point_m, axes->origin_m);
    return (struct neph_sun_point){neph_vec3_dot(from_m, axes->u), neph_vec3_dot(from_m, axes->v),
                                   neph_vec3_dot(from_m, axes->w)};
}

void neph_sun_grid_corners(const struct neph_bounds *box, struct neph_vec3 corners_m[8])
{
    for (int i = 0; i < 8; i++)
        corners_m[i] = (struct neph_vec3){i & 1 ? box->max_m.x : box->min_m.x,
                                          i & 2 ? box->max_m.y : box->min_m.y,
                                          i & 4 ? box->max_m.z : box->min_m.z};
}

/* The sides of cells for which the grid has at most `room` of them. */
static bool choose_cells(struct neph_sun_grid *grid, double u_m, double v_m, size_t room)
{
    double cell_m = fmax(sqrt(u_m * v_m / (double)room), fmax(u_m, v_m) / (SIDE_MAX - 4));
    if (!(cell_m > 0.0 && cell_m < INFINITY))
        return false;
    while ((u_m / cell_m + 3.0) * (v_m / cell_m + 3.0) > (double)room)
        cell_m *= 1.02;
    grid->cell_m = cell_m;
    grid->width = (int)(u_m / cell_m) + 2;
    grid->height = (int)(v_m / cell_m) + 2;
    return true;
}

/* Around all solids that are in the grid, with half a cell on all sides. False: there is none. */
static bool place_grid(const struct neph_scene *scene, const bool *is_apart,
                       struct neph_sun_grid *grid)
{
    struct neph_bounds hull = nothing, across = nothing;
    struct neph_vec3 corners_m[8];
    for (int i = 0; i < scene->solid_count; i++)
        if (!is_apart[i])
            hull = neph_bounds_hull(hull, neph_solid_bounds(&scene->solids[i]));
    if (neph_bounds_are_empty(&hull))
        return false;
    grid->axes.origin_m = neph_bounds_middle(&hull);
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_bounds box = neph_solid_bounds(&scene->solids[i]);
        neph_sun_grid_corners(&box, corners_m);
        for (int k = 0; k < 8 && !is_apart[i]; k++) {
            const struct neph_sun_point at = neph_sun_point(&grid->axes, corners_m[k]);
            const struct neph_vec3 place_m = {at.u, at.v, at.w};
            across = neph_bounds_hull(across, (struct neph_bounds){place_m, place_m});
        }
    }
    if (!choose_cells(grid, get_side(&across, 0), get_side(&across, 1), neph_sun_grid_room(scene)))
        return false;
    grid->low_u_m = across.min_m.x - 0.5 * grid->cell_m;
    grid->low_v_m = across.min_m.y - 0.5 * grid->cell_m;
    return true;
}

static struct neph_sun_row find_cells(double low, double high, int count)
{
    return (struct neph_sun_row){(int)fmax(0.0, floor(low - reserve)),
                                 (int)fmin(count - 1, floor(high + reserve))};
}

/* The part of the edge from a to b between two v, extending [*low, *high] of u. */
static void extend_row(struct neph_sun_point a, struct neph_sun_point b, double low_v,
                       double high_v, double *low, double *high)
{
    const double side = b.v - a.v;
    double t0 = 0.0, t1 = 1.0;
    if (fmin(a.v, b.v) > high_v || fmax(a.v, b.v) < low_v)
        return;
    if (side != 0.0) {
        const double at_low = (low_v - a.v) / side, at_high = (high_v - a.v) / side;
        t0 = fmax(0.0, fmin(at_low, at_high));
        t1 = fmin(1.0, fmax(at_low, at_high));
    }
    const double u0 = a.u + t0 * (b.u - a.u), u1 = a.u + t1 * (b.u - a.u);
    *low = fmin(*low, fmin(u0, u1));
    *high = fmax(*high, fmax(u0, u1));
}

/* In sides of a cell, from the grid's corner. */
static struct neph_sun_point to_cells(const struct neph_sun_grid *grid, struct neph_sun_point at)
{
    return (struct neph_sun_point){(at.u - grid->low_u_m) / grid->cell_m,
                                   (at.v - grid->low_v_m) / grid->cell_m, at.w};
}

struct neph_sun_row neph_sun_grid_touch(const struct neph_sun_grid *grid,
                                        const struct neph_sun_point *points, int point_count,
                                        const unsigned char (*edges)[2], int edge_count,
                                        struct neph_sun_row *rows)
{
    struct neph_sun_point at[8];
    double low_v = INFINITY, high_v = -INFINITY;
    for (int i = 0; i < point_count; i++) {
        at[i] = to_cells(grid, points[i]);
        low_v = fmin(low_v, at[i].v);
        high_v = fmax(high_v, at[i].v);
    }
    const struct neph_sun_row all = find_cells(low_v, high_v, grid->height);
    for (int row = all.first; row <= all.last; row++) {
        double low = INFINITY, high = -INFINITY;
        for (int i = 0; i < edge_count; i++)
            extend_row(at[edges[i][0]], at[edges[i][1]], row - reserve, row + 1.0 + reserve, &low,
                       &high);
        rows[row] = low <= high ? find_cells(low, high, grid->width) : (struct neph_sun_row){0, -1};
    }
    return all;
}

struct neph_sun_row neph_sun_grid_touch_box(const struct neph_sun_grid *grid,
                                            const struct neph_vec3 corners_m[8],
                                            struct neph_sun_row *rows, double *top_m)
{
    static const unsigned char edges[12][2] = {{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3},
                                               {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
    struct neph_sun_point points[8];
    *top_m = -INFINITY;
    for (int i = 0; i < 8; i++) {
        points[i] = neph_sun_point(&grid->axes, corners_m[i]);
        *top_m = fmax(*top_m, points[i].w);
    }
    return neph_sun_grid_touch(grid, points, 8, edges, 12, rows);
}

struct neph_interval neph_sun_grid_range(const struct neph_sun_grid *grid, int column, int row,
                                         double constant, double slope_u, double slope_v)
{
    const double u = grid->low_u_m + (column + 0.5) * grid->cell_m;
    const double v = grid->low_v_m + (row + 0.5) * grid->cell_m;
    const double middle = constant + slope_u * u + slope_v * v;
    const double by = ((0.5 + reserve) * (fabs(slope_u) + fabs(slope_v)) + height_reserve) *
                      grid->cell_m;
    return (struct neph_interval){middle - by, middle + by};
}

void neph_sun_grid_raise(struct neph_sun_grid *grid, int column, int row, double dark_m,
                         double lit_m)
{
    float *limits_m = grid->limits_m[(size_t)row * (size_t)grid->width + (size_t)column];
    const float dark = nextafterf((float)dark_m, -INFINITY),
                lit = nextafterf((float)lit_m, INFINITY);
    limits_m[0] = dark > limits_m[0] ? dark : limits_m[0];
    limits_m[1] = lit > limits_m[1] ? lit : limits_m[1];
}

/* Add a solid, by its number on the device, to the list of a cell. */
static void list_solid(struct neph_sun_grid *grid, int column, int row, uint32_t number)
{
    uint32_t *listed = &grid->listed[(size_t)row * (size_t)grid->width + (size_t)column];
    const uint32_t count = *listed & 3;
    if (*listed != NEPH_GPU_MANY_LISTED)
        *listed = count == 3 ? NEPH_GPU_MANY_LISTED
                             : (*listed + 1) | number << (2 + NEPH_GPU_LISTED_BITS * count);
}

/* --- boxes ----------------------------------------------------------------------------------- */

/* Where rays towards the sun enter and leave the two faces of a box across one of its axes, as
 * functions of u and v. */
struct slab {
    bool is_parallel; /* to the sun */
    struct neph_affine2 {
        double constant, slope_u, slope_v;
    } in, out, place; /* place: the coordinate of the ray at w = 0 */
    double low, high;
};

static double evaluate(const struct neph_affine2 *f, double u, double v)
{
    return f->constant + f->slope_u * u + f->slope_v * v;
}

static struct neph_affine2 find_face(const struct neph_affine2 *place, double face, double sun)
{
    return (struct neph_affine2){(face - place->constant) / sun, -place->slope_u / sun,
                                 -place->slope_v / sun};
}

static double get_component(struct neph_vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static void find_slabs(const struct neph_solid *box, const struct neph_sun_axes *axes,
                       struct slab slabs[3])
{
    const struct neph_vec3 middle_m = neph_bounds_middle(&box->box);
    const struct neph_vec3 place_m = neph_vec3_add(middle_m, neph_box_place_m(box, axes->origin_m));
    const struct neph_vec3 u = neph_box_direction(box, axes->u),
                           v = neph_box_direction(box, axes->v);
    const struct neph_vec3 sun = neph_box_direction(box, axes->w);
    for (int axis = 0; axis < 3; axis++) {
        struct slab *slab = &slabs[axis];
        const double along = get_component(sun, axis);
        slab->low = get_component(box->box.min_m, axis);
        slab->high = get_component(box->box.max_m, axis);
        slab->place = (struct neph_affine2){get_component(place_m, axis), get_component(u, axis),
                                            get_component(v, axis)};
        slab->is_parallel = fabs(along) < 1e-9;
        slab->in = find_face(&slab->place, along > 0.0 ? slab->low : slab->high, along);
        slab->out = find_face(&slab->place, along > 0.0 ? slab->high : slab->low, along);
    }
}

static bool meets_box(const struct slab slabs[3], double u, double v)
{
    double in = -INFINITY, out = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        const double place = evaluate(&slabs[axis].place, u, v);
        if (slabs[axis].is_parallel && !(place > slabs[axis].low && place < slabs[axis].high))
            return false;
        if (slabs[axis].is_parallel)
            continue;
        in = fmax(in, evaluate(&slabs[axis].in, u, v));
        out = fmin(out, evaluate(&slabs[axis].out, u, v));
    }
    return in < out;
}

/* A box is convex: it covers a cell where it covers the corners. */
static bool covers_cell(const struct neph_sun_grid *grid, const struct slab slabs[3], int column,
                        int row)
{
    for (int corner = 0; corner < 4; corner++) {
        const double i = column + (corner & 1 ? 1.0 + reserve : -reserve);
        const double j = row + (corner & 2 ? 1.0 + reserve : -reserve);
        if (!meets_box(slabs, grid->low_u_m + i * grid->cell_m, grid->low_v_m + j * grid->cell_m))
            return false;
    }
    return true;
}

/* The limits where rays leave the box: the least of three planes. */
static void add_box_cell(struct neph_sun_grid *grid, const struct slab slabs[3], double top_m,
                         int column, int row, uint32_t number)
{
    double dark_m = INFINITY, lit_m = top_m + height_reserve * grid->cell_m;
    for (int axis = 0; axis < 3; axis++) {
        const struct neph_affine2 *out = &slabs[axis].out;
        if (slabs[axis].is_parallel)
            continue;
        const struct neph_interval range = neph_sun_grid_range(grid, column, row, out->constant,
                                                               out->slope_u, out->slope_v);
        dark_m = fmin(dark_m, range.low);
        lit_m = fmin(lit_m, range.high);
    }
    neph_sun_grid_raise(grid, column, row,
                        covers_cell(grid, slabs, column, row) ? dark_m : -INFINITY, lit_m);
    list_solid(grid, column, row, number);
}

static void add_box(struct neph_sun_grid *grid, const struct neph_solid *box, uint32_t number,
                    struct neph_sun_row *rows)
{
    const struct neph_vec3 middle_m = neph_bounds_middle(&box->box);
    struct neph_vec3 corners_m[8];
    struct slab slabs[3];
    double top_m;
    neph_sun_grid_corners(&box->box, corners_m);
    for (int i = 0; i < 8 && neph_is_turned(&box->turn); i++)
        corners_m[i] = neph_vec3_add(
            middle_m, neph_rotate(&box->turn, neph_vec3_sub(corners_m[i], middle_m)));
    find_slabs(box, &grid->axes, slabs);
    const struct neph_sun_row all = neph_sun_grid_touch_box(grid, corners_m, rows, &top_m);
    for (int row = all.first; row <= all.last; row++)
        for (int column = rows[row].first; column <= rows[row].last; column++)
            add_box_cell(grid, slabs, top_m, column, row, number);
}

/* --- balls ----------------------------------------------------------------------------------- */

/* The least and the largest distance of the points of a cell from a place, along one axis. */
static struct neph_interval find_distances(double place, int cell)
{
    const double from = place - (cell + 0.5), half = 0.5 + reserve;
    return (struct neph_interval){fmax(0.0, fabs(from) - half), fabs(from) + half};
}

static double find_half_chord(double radius, double u, double v)
{
    return sqrt(fmax(0.0, radius * radius - u * u - v * v));
}

static void add_ball(struct neph_sun_grid *grid, const struct neph_solid *ball, uint32_t number)
{
    const struct neph_sun_point at = to_cells(grid, neph_sun_point(&grid->axes, ball->center_m));
    const double radius = ball->radius_m / grid->cell_m;
    const struct neph_sun_row rows = find_cells(at.v - radius, at.v + radius, grid->height);
    const struct neph_sun_row columns = find_cells(at.u - radius, at.u + radius, grid->width);
    for (int row = rows.first; row <= rows.last; row++)
        for (int column = columns.first; column <= columns.last; column++) {
            const struct neph_interval u = find_distances(at.u, column);
            const struct neph_interval v = find_distances(at.v, row);
            const double least = find_half_chord(radius, u.high, v.high);
            if (hypot(u.low, v.low) > radius)
                continue;
            neph_sun_grid_raise(
                grid, column, row,
                least > 0.0 ? at.w + (least - height_reserve) * grid->cell_m : -INFINITY,
                at.w + (find_half_chord(radius, u.low, v.low) + height_reserve) * grid->cell_m);
            list_solid(grid, column, row, number);
        }
}

/* --- the grid -------------------------------------------------------------------------------- */

static enum neph_status fill_grid(const struct neph_scene *scene, const bool *is_apart,
                                  struct neph_sun_grid *grid, struct neph_diag *diag)
{
    const size_t count = (size_t)grid->width * (size_t)grid->height;
    struct neph_sun_row *rows = malloc((size_t)grid->height * sizeof(*rows));
    grid->limits_m = malloc(count * sizeof(*grid->limits_m));
    grid->listed = calloc(count, sizeof(*grid->listed));
    uint32_t number = 0;
    if (!rows || !grid->limits_m || !grid->listed) {
        free(rows);
        return neph_fail_memory(diag);
    }
    for (size_t i = 0; i < count; i++)
        grid->limits_m[i][0] = grid->limits_m[i][1] = -NEPH_GPU_FAR_M;
    for (int i = 0; i < scene->solid_count; i++) {
        const struct neph_solid *solid = &scene->solids[i];
        if (solid->kind == NEPH_SOLID_BOX && !is_apart[i])
            add_box(grid, solid, number, rows);
        else if (solid->kind == NEPH_SOLID_SPHERE && !is_apart[i])
            add_ball(grid, solid, number);
        number += solid->kind != NEPH_SOLID_MESH;
    }
    free(rows);
    return neph_sun_grid_add_meshes(scene, grid, diag);
}

static enum neph_status keep_solids(const struct neph_scene *scene, struct neph_sun_grid *grid,
                                    struct neph_diag *diag)
{
    const size_t bytes = (size_t)scene->solid_count * sizeof(*scene->solids);
    grid->solids = malloc(bytes);
    if (!grid->solids)
        return neph_fail_memory(diag);
    memcpy(grid->solids, scene->solids, bytes);
    grid->solid_count = scene->solid_count;
    return NEPH_OK;
}

enum neph_status neph_sun_grid_create(const struct neph_scene *scene, struct neph_sun_grid *grid,
                                      struct neph_diag *diag)
{
    bool *is_apart = malloc((size_t)scene->solid_count * sizeof(*is_apart));
    if (!is_apart)
        return neph_fail_memory(diag);
    const struct neph_bounds hull = neph_plain_hull(scene);
    for (int i = 0; i < scene->solid_count; i++)
        is_apart[i] = neph_is_apart(&scene->solids[i], &hull);
    grid->axes = find_axes(scene->sun.direction);
    enum neph_status status = NEPH_OK;
    if (place_grid(scene, is_apart, grid)) {
        status = fill_grid(scene, is_apart, grid, diag);
        if (!status)
            status = keep_solids(scene, grid, diag);
    }
    free(is_apart);
    return status;
}

void neph_sun_grid_free_cells(struct neph_sun_grid *grid)
{
    free(grid->listed);
    free(grid->limits_m);
    grid->listed = NULL;
    grid->limits_m = NULL;
}

void neph_sun_grid_destroy(struct neph_sun_grid *grid)
{
    free(grid->solids);
    neph_sun_grid_free_cells(grid);
    *grid = (struct neph_sun_grid){.cell_m = 0.0};
}

bool neph_sun_grid_fits(const struct neph_sun_grid *grid, const struct neph_scene *scene)
{
    const struct neph_vec3 sun = scene->sun.direction, own = grid->axes.w;
    bool fits = grid->solids && scene->sun.present && grid->solid_count == scene->solid_count &&
                sun.x == own.x && sun.y == own.y && sun.z == own.z;
    for (int i = 0; i < scene->solid_count && fits; i++) {
        const struct neph_solid *solid = &scene->solids[i];
        fits = solid->moves ? grid->solids[i].moves
                            : memcmp(&grid->solids[i], solid, sizeof(*solid)) == 0;
    }
    return fits;
}

struct neph_gpu_sun_grid neph_sun_grid_place(const struct neph_sun_grid *grid,
                                             struct neph_vec3 camera_m, uint32_t words)
{
    const struct neph_sun_point at = neph_sun_point(&grid->axes, camera_m);
    const struct neph_sun_point cells = to_cells(grid, at);
    const double away = fmax(fabs(cells.u), fmax(fabs(cells.v), fabs(at.w) / grid->cell_m));
    struct neph_gpu_sun_grid made = {
        .corner_cells = {(float)cells.u, (float)cells.v},
        .height_m = (float)at.w,
        .reach_m = (float)(away < reach ? reach * grid->cell_m : 0.0),
        .size = {(uint32_t)grid->width, (uint32_t)grid->height},
        .first = 2 * words,
        .first_listed = 4 * words + 2 * (uint32_t)(grid->width * grid->height),
    };
    neph_gpu_direction(made.across_u, neph_vec3_scale(grid->axes.u, 1.0 / grid->cell_m));
    neph_gpu_direction(made.across_v, neph_vec3_scale(grid->axes.v, 1.0 / grid->cell_m));
    return made;
}

enum neph_status neph_sun_grid_upload(const struct neph_sun_grid *grid,
                                      const struct neph_vulkan *vulkan,
                                      const struct neph_buffer *buffer, size_t words,
                                      struct neph_diag *diag)
{
    const size_t cells = (size_t)grid->width * (size_t)grid->height;
    const size_t first = words * 4 * sizeof(uint32_t), limits = cells * sizeof(grid->limits_m[0]);
    const enum neph_status status = neph_buffer_upload(vulkan, buffer, first, grid->limits_m,
                                                       limits, diag);
    return status ? status
                  : neph_buffer_upload(vulkan, buffer, first + limits, grid->listed,
                                       cells * sizeof(grid->listed[0]), diag);
}
