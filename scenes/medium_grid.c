/* SPDX-License-Identifier: MIT
 *
 * Voxels as a medium: scenes/grid.h.
 */
#include "scenes/grid.h"

#include "scenes/hash_text.h"
#include "scenes/load_volume.h"
#include "scenes/media.h"
#include "scenes/medium_bounds.h"
#include "scenes/medium_kind.h"
#include "scenes/sheet.h"
#include "scenes/solids.h"

#include <math.h>
#include <stddef.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_SHEET_PATTERN_COUNT == 2, "a new kind");

#define AT(member) offsetof(struct neph_medium, member)
#define GRID(member) offsetof(struct written_grid, member)
#define SHEET(member) offsetof(struct written_sheet, member)

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
    neph_medium_move_bounds(medium, by_m);
}

static struct neph_bounds support(const struct neph_medium *medium)
{
    return neph_grid_support(medium->grid);
}

/* The nodes along an axis that are within the bounds: [first, end). */
struct nodes {
    int first, end;
};

static struct nodes find_nodes(const struct neph_medium *medium, int axis)
{
    const struct neph_grid *grid = medium->grid;
    const double origin_m = (&grid->origin_m.x)[axis], spacing_m = (&grid->spacing_m.x)[axis],
                 low = ((&medium->bounds.min_m.x)[axis] - origin_m) / spacing_m,
                 high = ((&medium->bounds.max_m.x)[axis] - origin_m) / spacing_m;
    const double last = grid->size[axis];
    return (struct nodes){(int)fmin(fmax(ceil(low), 0.0), last),
                          (int)fmax(fmin(floor(high) + 1.0, last), 0.0)};
}

static double sum_nodes(const struct neph_grid *grid, int axis, struct nodes nodes, const int at[3])
{
    const size_t strides[3] = {1, (size_t)grid->size[0],
                               (size_t)grid->size[0] * (size_t)grid->size[1]};
    double sum = 0.0;
    size_t index = 0;
    for (int other = 0; other < 3; other++)
        index += strides[other] * (size_t)(other == axis ? nodes.first : at[other]);
    for (int i = nodes.first; i < nodes.end; i++, index += strides[axis])
        sum += (double)grid->values[index];
    return sum;
}

static struct neph_column column(const struct neph_medium *medium, int axis)
{
    const struct neph_grid *grid = medium->grid;
    const struct neph_bounds box = neph_medium_support(medium);
    const int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
    const struct nodes along = find_nodes(medium, axis), in_a = find_nodes(medium, a),
                       in_b = find_nodes(medium, b);
    struct neph_vec3 point_m = neph_vec3_scale(neph_vec3_add(box.min_m, box.max_m), 0.5);
    double largest = -1.0;
    int at[3] = {0};
    for (at[b] = in_b.first; at[b] < in_b.end; at[b]++)
        for (at[a] = in_a.first; at[a] < in_a.end; at[a]++) {
            const double sum = sum_nodes(grid, axis, along, at);
            if (sum <= largest)
                continue;
            largest = sum;
            (&point_m.x)[a] = (&grid->origin_m.x)[a] + at[a] * (&grid->spacing_m.x)[a];
            (&point_m.x)[b] = (&grid->origin_m.x)[b] + at[b] * (&grid->spacing_m.x)[b];
        }
    const double side_m = (&box.max_m.x)[axis] - (&box.min_m.x)[axis];
    return (struct neph_column){
        .point_m = point_m, .is_endless = grid->is_endless[axis] && side_m >= NEPH_GRID_ENDLESS_M};
}

/* Splits at the shadow that a grid casts on the ray, an eighth of its cells at a time: quadrature
 * nodes are then closer than its cells. */
static void cut_scales(struct neph_cuts *cuts, const struct neph_medium *medium)
{
    const struct neph_solid box = {.kind = NEPH_SOLID_BOX, .box = neph_medium_support(medium)};
    const int *size = medium->grid->size;
    const int cells = size[0] > size[1] ? size[0] : size[1];
    const int pieces = 1 + (cells > size[2] ? cells : size[2]) / 8;
    double low_m, high_m;
    if (cuts->scene->medium_count == 1) /* cut_kinks() already splits at every cell */
        return;
    if (!neph_solid_shadow(&box, cuts->scene->sun.direction, cuts->origin_m, cuts->direction,
                           cuts->t0_m, cuts->t1_m, &low_m, &high_m))
        return;
    for (int k = 0; k <= pieces; k++)
        neph_cuts_add(cuts, low_m + (high_m - low_m) * k / pieces);
}

/* The faces of the lattice across one axis that a part of a ray may cross. */
struct faces {
    int first, last;
};

static struct faces faces_on(const struct neph_grid *grid, int axis, double near, double far)
{
    const struct faces own = {-1, grid->size[axis]}, /* `near` and `far` in cells */
        met = {(int)floor(fmin(near, far)), (int)ceil(fmax(near, far))};
    return grid->is_endless[axis] ? met : own;
}

/* Splits at the faces of the cells on the ray, where the density has kinks. */
static void cut_kinks(struct neph_cuts *cuts, const struct neph_medium *medium)
{
    const struct neph_grid *grid = medium->grid;
    const struct neph_bounds support = neph_medium_support(medium);
    const double origin[3] = {cuts->origin_m.x, cuts->origin_m.y, cuts->origin_m.z};
    const double view[3] = {cuts->direction.x, cuts->direction.y, cuts->direction.z};
    const double first[3] = {grid->origin_m.x, grid->origin_m.y, grid->origin_m.z};
    const double spacing[3] = {grid->spacing_m.x, grid->spacing_m.y, grid->spacing_m.z};
    double near_m, far_m;
    if (!neph_cuts_clip(cuts, &support, &near_m, &far_m))
        return;
    for (int axis = 0; axis < 3; axis++) {
        const double face_m = first[axis] - (grid->is_constant ? 0.5 * spacing[axis] : 0.0),
                     start = (origin[axis] - face_m) / spacing[axis],
                     per_m = view[axis] / spacing[axis];
        const struct faces faces = faces_on(grid, axis, start + near_m * per_m,
                                            start + far_m * per_m);
        for (int i = faces.first; i <= faces.last && view[axis] != 0.0; i++) {
            const double t_m = (face_m + i * spacing[axis] - origin[axis]) / view[axis];
            if (t_m >= near_m && t_m <= far_m)
                neph_cuts_add(cuts, t_m);
        }
    }
}

static void hash(const struct neph_medium *medium, FILE *text)
{
    const struct neph_grid *grid = medium->grid;
    neph_put_number(text, "extinction_per_m", medium->extinction_per_m);
    neph_put_three(text, "size", grid->size[0], grid->size[1], grid->size[2]);
    neph_put_vec3(text, "origin_m", grid->origin_m);
    neph_put_vec3(text, "spacing_m", grid->spacing_m);
    if (neph_grid_is_endless(grid))
        neph_put_three(text, "endless", grid->is_endless[0], grid->is_endless[1],
                       grid->is_endless[2]);
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

/* --- in a scene file --- */

enum { VALUES_MAX = 4096 };

struct written_grid {
    struct neph_written_medium common;
    int size[3];
    struct neph_vec3 origin_m, spacing_m;
    int repeat[3];
    int interpolation; /* 0 trilinear, 1 constant */
    int value_count;
    double values[VALUES_MAX];
};

static const char *const interpolations[] = {"trilinear", "constant", NULL};

static const struct neph_field grid_fields[] = {
    {"size", NEPH_WHOLES, GRID(size), "nodes", 1, NEPH_GRID_SIDE_MAX, .note = "along x, y, z"},
    {"origin_m", NEPH_THREE, GRID(origin_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "of the first node"},
    {"spacing_m", NEPH_THREE, GRID(spacing_m), "m", 1e-4, NEPH_FAR_M, .note = "between nodes"},
    {"values", NEPH_NUMBERS, GRID(values), "", 0, 1e6, .note = "x fastest, then y, then z",
     .least = 1, .most = VALUES_MAX, .count_at = GRID(value_count)},
    {"repeat", NEPH_WHOLES, GRID(repeat), "", 0, NEPH_GRID_SIDE_MAX,
     .note = "number of copies side by side along x, y, z, the last node beside the first of the "
             "next; 0: without end, over the whole world",
     .standard = "[1, 1, 1]"},
    {"interpolation", NEPH_WORD, GRID(interpolation), .words = interpolations,
     .note = "constant: each node's value in the cell around it, as in tables of radiation codes",
     .standard = "trilinear"},
    {"extinction_per_m", NEPH_NUMBER, AT(extinction_per_m), "1/m", 0, 1e4, .note = "at value 1",
     .standard = NEPH_OR_ANOTHER_DENSITY},
    {"bounds", NEPH_RECORD, AT(bounds), .record = &neph_bounds_record, .standard = "unbounded"},
    {0},
};

/* Fills in the values of all copies. */
static void fill_copies(const struct written_grid *written, struct neph_grid *grid)
{
    const int *own = written->size, *all = grid->size;
    float *value = grid->values;
    for (int k = 0; k < all[2]; k++)
        for (int j = 0; j < all[1]; j++)
            for (int i = 0; i < all[0]; i++)
                *value++ = (float)written
                               ->values[((k % own[2]) * own[1] + j % own[1]) * own[0] + i % own[0]];
}

static enum neph_status finish_grid(struct neph_reader *reader, const yaml_node_t *node,
                                    void *written)
{
    const struct written_grid *grid = written;
    struct neph_medium *medium = written;
    const long wanted = (long)grid->size[0] * grid->size[1] * grid->size[2];
    (void)node;
    if (wanted != grid->value_count)
        return neph_refuse(reader, "values", "%d values for %d x %d x %d = %ld nodes",
                           grid->value_count, grid->size[0], grid->size[1], grid->size[2], wanted);
    const double spacing_m[3] = {grid->spacing_m.x, grid->spacing_m.y, grid->spacing_m.z};
    int size[3];
    for (int axis = 0; axis < 3; axis++) {
        const int copies = grid->repeat[axis] > 0 ? grid->repeat[axis] : 1;
        size[axis] = grid->size[axis] * copies; /* 2^20 at most */
        if (grid->repeat[axis] == 0 && spacing_m[axis] < NEPH_GRID_ENDLESS_SPACING_M)
            return neph_refuse(reader, "spacing_m",
                               "nodes %g m apart along an axis without end: %g m at least",
                               spacing_m[axis], NEPH_GRID_ENDLESS_SPACING_M);
    }
    const enum neph_status status = neph_grid_create(size, grid->origin_m, grid->spacing_m,
                                                     &medium->grid, reader->diag);
    if (status)
        return status;
    fill_copies(grid, medium->grid);
    for (int axis = 0; axis < 3; axis++)
        medium->grid->is_endless[axis] = grid->repeat[axis] == 0;
    medium->grid->is_constant = grid->interpolation == 1;
    return neph_grid_seal(medium->grid, reader->diag);
}

static const char *const patterns[] = {
    [NEPH_SHEET_EVEN] = "even", [NEPH_SHEET_STREAKS] = "streaks", NULL};

struct written_sheet {
    struct neph_written_medium common;
    struct neph_sheet sheet;
    double optical_depth;
};

static const struct neph_field sheet_fields[] = {
    {"center_m", NEPH_THREE, SHEET(sheet.center_m), "m", -NEPH_FAR_M, NEPH_FAR_M,
     .note = "its middle"},
    {"side_m", NEPH_NUMBER, SHEET(sheet.side_m), "m", 1e-2, NEPH_FAR_M, .note = "along x and z"},
    {"thickness_m", NEPH_NUMBER, SHEET(sheet.thickness_m), "m", 1e-3, 1e5,
     .note = "between the faces, where the density is 0; it is largest at the middle"},
    {"planet_radius_m", NEPH_NUMBER, SHEET(sheet.planet_radius_m), "m", 0, 1e9,
     .note =
         "radius of a planet that it follows, whose ground is at y = 0 below its middle; 0: level",
     .standard = "0"},
    {"optical_depth", NEPH_NUMBER, SHEET(optical_depth), "", 0, 1e3,
     .note = "straight up through it, where the pattern is 1"},
    {"nodes", NEPH_WHOLE, SHEET(sheet.nodes), "nodes", 2, NEPH_GRID_SIDE_MAX,
     .note = "of the pattern, along each side", .standard = "512"},
    {"pattern", NEPH_WORD, SHEET(sheet.pattern), .words = patterns,
     .note = "1 everywhere, or wisps with clear air between them", .standard = "even"},
    {"seed", NEPH_WHOLE, SHEET(sheet.seed), "", 0, 1e9, .standard = "1"},
    {"wisp_m", NEPH_NUMBER, SHEET(sheet.wisp_m), "m", 1e-2, NEPH_FAR_M,
     .note = "between wisps, across them", .standard = "1000"},
    {"stretch", NEPH_NUMBER, SHEET(sheet.stretch), "", 1, 100,
     .note = "length of a wisp over its width", .standard = "6"},
    {"along", NEPH_THREE, SHEET(sheet.along), "", -1e6, 1e6,
     .note = "direction of the wisps; only x and z are used", .standard = "[1, 0, 0]"},
    {"coverage", NEPH_NUMBER, SHEET(sheet.coverage), "", 0, 1,
     .note = "part of the pattern that is not clear", .standard = "0.5"},
    {"bounds", NEPH_RECORD, AT(bounds), .record = &neph_bounds_record, .standard = "unbounded"},
    {0},
};

static enum neph_status finish_sheet(struct neph_reader *reader, const yaml_node_t *node,
                                     void *written)
{
    struct written_sheet *sheet = written;
    struct neph_medium *medium = written;
    (void)node;
    if (sheet->sheet.along.x == 0.0 && sheet->sheet.along.z == 0.0)
        return neph_refuse(reader, "along",
                           "wisps lie along a level direction: its x or z is not 0");
    if (sheet->sheet.planet_radius_m > 0.0 &&
        sheet->sheet.planet_radius_m + fmin(sheet->sheet.center_m.y, 0.0) < sheet->sheet.side_m)
        return neph_refuse(reader, "planet_radius_m",
                           "a planet of %g m is too small for a sheet of %g m: 0 is level",
                           sheet->sheet.planet_radius_m, sheet->sheet.side_m);
    medium->extinction_per_m = neph_sheet_extinction_per_m(&sheet->sheet, sheet->optical_depth);
    return neph_sheet_make(&sheet->sheet, &medium->grid, reader->diag);
}

const struct neph_medium_row neph_medium_grid = {
    .facts = {.name = "voxel grid",
              .place = "at value 1",
              .has_closed_form = true,
              .has_kinks = true,
              .needs_majorants = true,
              .majorant_cells = NEPH_MAJORANT_CELLS},
    .forms = {{"grid",
               "voxels, trilinear between nodes, falling to 0 one cell beyond the outermost",
               grid_fields, sizeof(struct written_grid), finish_grid},
              {"volume", "voxels from a file", neph_volume_fields,
               sizeof(struct neph_written_volume), neph_finish_volume},
              {"sheet", "a thin layer, such as cirrus (scenes/sheet.h)", sheet_fields,
               sizeof(struct written_sheet), finish_sheet}},
    .extinction_per_m = extinction_per_m,
    .optical_depth = optical_depth,
    .bound_per_m = bound_per_m,
    .column = column,
    .support = support,
    .cut_scales = cut_scales,
    .cut_kinks = cut_kinks,
    .drift = drift,
    .hash = hash,
    .destroy = destroy,
    .borrow = borrow,
    .room_size = sizeof(struct neph_grid),
};
