/* SPDX-License-Identifier: MIT */
#include "scenes/bake.h"

#include "base/threads.h"
#include "scenes/media.h"
#include "scenes/solids.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Chords through media without closed form cost milliseconds each. */
enum { POINTS = 1 << 16, CHORDS_CLOSED = 1 << 14, CHORDS_QUADRATURE = 192, TRIES = 256 };
static const uint64_t error_seed = 20150810;

/* Margins below this part of the largest extinction do not get nodes of the grid. */
static const double thinnest_of_densest = 1e-5;

/* ---- the lattice ----------------------------------------------------------------------------- */

bool neph_medium_is_whole_grid(const struct neph_medium *medium)
{
    if (!medium->grid || medium->grid->is_constant || /* voxel files are trilinear */
        neph_is_turned(&medium->turn))
        return false;
    const struct neph_bounds support = neph_grid_support(medium->grid), *bounds = &medium->bounds;
    return bounds->min_m.x <= support.min_m.x && bounds->max_m.x >= support.max_m.x &&
           bounds->min_m.y <= support.min_m.y && bounds->max_m.y >= support.max_m.y &&
           bounds->min_m.z <= support.min_m.z && bounds->max_m.z >= support.max_m.z;
}

static enum neph_status check_request(const struct neph_bounds *box, int resolution,
                                      struct neph_diag *diag)
{
    const struct neph_vec3 side_m = neph_vec3_sub(box->max_m, box->min_m);
    if (!isfinite(side_m.x) || !isfinite(side_m.y) || !isfinite(side_m.z)) {
        neph_fail(diag, NEPH_ERR_INPUT, "the medium has no end, and a grid must have one");
        neph_hint(diag, "give it bounds");
        return NEPH_ERR_INPUT;
    }
    if (!(side_m.x > 0.0 && side_m.y > 0.0 && side_m.z > 0.0))
        return neph_fail(diag, NEPH_ERR_INPUT, "the bounds exclude the whole medium");
    if (resolution < NEPH_BAKE_RESOLUTION_MIN || resolution > NEPH_GRID_SIDE_MAX)
        return neph_fail(diag, NEPH_ERR_INPUT, "resolution %d: it must be %d..%d", resolution,
                         NEPH_BAKE_RESOLUTION_MIN, NEPH_GRID_SIDE_MAX);
    return NEPH_OK;
}

static double *get_axis(struct neph_vec3 *v, int axis)
{
    return axis == 0 ? &v->x : axis == 1 ? &v->y : &v->z;
}

/* Moves a face towards the opposite one while the excluded part stays thinner than `limit_per_m`;
 * found by bisection. */
static double trimmed_face_m(const struct neph_medium *medium, const struct neph_bounds *box,
                             int axis, bool is_low, double limit_per_m)
{
    struct neph_bounds left = *box;
    double *cut_m = get_axis(is_low ? &left.max_m : &left.min_m, axis);
    double thin_m = *get_axis(is_low ? &left.min_m : &left.max_m, axis), dense_m = *cut_m;
    for (int i = 0; i < 20; i++) {
        *cut_m = 0.5 * (thin_m + dense_m);
        if (neph_medium_extinction_bound_per_m(medium, &left) <= limit_per_m)
            thin_m = *cut_m;
        else
            dense_m = *cut_m;
    }
    return thin_m;
}

static struct neph_bounds trim(const struct neph_medium *medium, struct neph_bounds box)
{
    const double densest_per_m = neph_medium_extinction_bound_per_m(medium, &box);
    const double limit_per_m = thinnest_of_densest * densest_per_m;
    for (int axis = 0; axis < 3 && densest_per_m > 0.0; axis++) {
        *get_axis(&box.min_m, axis) = trimmed_face_m(medium, &box, axis, true, limit_per_m);
        *get_axis(&box.max_m, axis) = trimmed_face_m(medium, &box, axis, false, limit_per_m);
    }
    return box;
}

static int nodes_along(double side_m, double longest_m, int resolution)
{
    const double nodes = round(resolution * side_m / longest_m);
    return nodes < NEPH_BAKE_RESOLUTION_MIN ? NEPH_BAKE_RESOLUTION_MIN : (int)nodes;
}

static enum neph_status create_lattice(const struct neph_bounds *box, int resolution,
                                       struct neph_grid **grid, struct neph_diag *diag)
{
    const struct neph_vec3 side_m = neph_vec3_sub(box->max_m, box->min_m);
    const double longest_m = fmax(side_m.x, fmax(side_m.y, side_m.z));
    const int size[3] = {nodes_along(side_m.x, longest_m, resolution),
                         nodes_along(side_m.y, longest_m, resolution),
                         nodes_along(side_m.z, longest_m, resolution)};
    const struct neph_vec3 spacing_m = {side_m.x / size[0], side_m.y / size[1], side_m.z / size[2]};
    return neph_grid_create(size, neph_vec3_along(box->min_m, spacing_m, 0.5), spacing_m, grid,
                            diag);
}

struct sampling {
    const struct neph_medium *medium;
    double extinction_per_m;
    struct neph_grid *grid;
};

/* Blocks of this many nodes along each side are 0 where the bound of the medium is 0. Half of the
 * nodes around Horizon clouds lie in such blocks, and a bound costs as much as ten nodes. */
enum { BLOCK = 4 };

static struct neph_vec3 node_m(const struct neph_grid *grid, int i, int j, int k)
{
    return (struct neph_vec3){grid->origin_m.x + i * grid->spacing_m.x,
                              grid->origin_m.y + j * grid->spacing_m.y,
                              grid->origin_m.z + k * grid->spacing_m.z};
}

static int block_end(const struct neph_grid *grid, int axis, int first)
{
    return first + BLOCK < grid->size[axis] ? first + BLOCK : grid->size[axis];
}

static void sample_block(const struct sampling *sampling, int i0, int j0, int k0)
{
    struct neph_grid *grid = sampling->grid;
    const int i1 = block_end(grid, 0, i0), j1 = block_end(grid, 1, j0), k1 = block_end(grid, 2, k0);
    const struct neph_bounds box = {node_m(grid, i0, j0, k0), node_m(grid, i1 - 1, j1 - 1, k1 - 1)};
    if (neph_medium_extinction_bound_per_m(sampling->medium, &box) <= 0.0)
        return;
    for (int k = k0; k < k1; k++)
        for (int j = j0; j < j1; j++) {
            float *row = grid->values +
                         ((size_t)k * (size_t)grid->size[1] + (size_t)j) * (size_t)grid->size[0];
            for (int i = i0; i < i1; i++) {
                const double per_m = neph_medium_extinction_per_m(sampling->medium,
                                                                  node_m(grid, i, j, k));
                row[i] = (float)(per_m / sampling->extinction_per_m);
            }
        }
}

static void sample_layer(int layer, void *context)
{
    const struct sampling *sampling = context;
    for (int j = 0; j < sampling->grid->size[1]; j += BLOCK)
        for (int i = 0; i < sampling->grid->size[0]; i += BLOCK)
            sample_block(sampling, i, j, layer * BLOCK);
}

static double density_unit_per_m(const struct neph_medium *medium, const struct neph_bounds *box)
{
    const double per_m = medium->extinction_per_m > 0.0
                             ? medium->extinction_per_m
                             : neph_medium_extinction_bound_per_m(medium, box);
    return per_m > 0.0 ? per_m : 1.0;
}

static enum neph_status sample(const struct neph_medium *medium, const struct neph_bounds *box,
                               int resolution, struct neph_bake *bake, struct neph_diag *diag)
{
    enum neph_status status = check_request(box, resolution, diag);
    if (status)
        return status;
    const struct neph_bounds trimmed = trim(medium, *box);
    status = create_lattice(&trimmed, resolution, &bake->grid, diag);
    if (status)
        return status;
    bake->extinction_per_m = density_unit_per_m(medium, box);
    struct sampling sampling = {medium, bake->extinction_per_m, bake->grid};
    status = neph_parallel_rows((bake->grid->size[2] + BLOCK - 1) / BLOCK, sample_layer, &sampling,
                                diag);
    return status ? status : neph_grid_seal(bake->grid, diag);
}

static enum neph_status copy(const struct neph_medium *medium, struct neph_bake *bake,
                             struct neph_diag *diag)
{
    const struct neph_grid *from = medium->grid;
    enum neph_status status = neph_grid_create(from->size, from->origin_m, from->spacing_m,
                                               &bake->grid, diag);
    if (status)
        return status;
    const size_t count = (size_t)from->size[0] * (size_t)from->size[1] * (size_t)from->size[2];
    memcpy(bake->grid->values, from->values, count * sizeof(*from->values));
    bake->extinction_per_m = medium->extinction_per_m;
    bake->is_copy = true;
    return neph_grid_seal(bake->grid, diag);
}

/* ---- the error ------------------------------------------------------------------------------- */

/* splitmix64 (G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014), uniform in 0..1. */
static double next_uniform(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static struct neph_vec3 next_point(uint64_t *state, const struct neph_bounds *region)
{
    const double x = next_uniform(state), y = next_uniform(state), z = next_uniform(state);
    return (struct neph_vec3){region->min_m.x + x * (region->max_m.x - region->min_m.x),
                              region->min_m.y + y * (region->max_m.y - region->min_m.y),
                              region->min_m.z + z * (region->max_m.z - region->min_m.z)};
}

/* Measures errors of extinction. Returns the largest sampled extinction [1/m]. */
static double measure_extinction(const struct neph_medium *medium, const struct neph_medium *baked,
                                 const struct neph_bounds *region, struct neph_bake_error *error)
{
    uint64_t state = error->seed;
    double squares = 0.0, difference_squares = 0.0, largest = 0.0, difference_largest = 0.0;
    for (int i = 0; i < error->point_count; i++) {
        const struct neph_vec3 point_m = next_point(&state, region);
        const double per_m = neph_medium_extinction_per_m(medium, point_m);
        const double difference = neph_medium_extinction_per_m(baked, point_m) - per_m;
        squares += per_m * per_m;
        difference_squares += difference * difference;
        largest = fmax(largest, per_m);
        difference_largest = fmax(difference_largest, fabs(difference));
    }
    if (largest > 0.0) {
        error->extinction_rms_relative = sqrt(difference_squares / squares);
        error->extinction_max_relative = difference_largest / largest;
    }
    return largest;
}

struct chords {
    const struct neph_medium *medium, *baked;
    const struct neph_bounds *region;
    double largest_per_m;
    uint64_t seed;
    double *medium_depths, *baked_depths;
};

/* A random point in proportion to the extinction, by rejection. */
static struct neph_vec3 next_dense_point(uint64_t *state, const struct chords *chords)
{
    struct neph_vec3 point_m = next_point(state, chords->region);
    for (int i = 0; i < TRIES; i++) {
        const double level_per_m = next_uniform(state) * chords->largest_per_m;
        if (level_per_m < neph_medium_extinction_per_m(chords->medium, point_m))
            break;
        point_m = next_point(state, chords->region);
    }
    return point_m;
}

/* Measures a line through a dense point and a uniform one, through the whole region. */
static void measure_chord(int chord, void *context)
{
    const struct chords *chords = context;
    uint64_t state = chords->seed + ((uint64_t)chord << 32);
    const struct neph_vec3 a = next_dense_point(&state, chords);
    const struct neph_vec3 b = next_point(&state, chords->region);
    const struct neph_vec3 d = neph_vec3_normalize(neph_vec3_sub(b, a));
    double t0_m = -INFINITY, t1_m = INFINITY;
    chords->medium_depths[chord] = chords->baked_depths[chord] = 0.0;
    if (!neph_bounds_clip(chords->region, a, d, &t0_m, &t1_m))
        return;
    const struct neph_vec3 from_m = neph_vec3_along(a, d, t0_m);
    const double length_m = t1_m - t0_m;
    chords->medium_depths[chord] = neph_medium_optical_depth(chords->medium, from_m, d, 0.0,
                                                             length_m);
    chords->baked_depths[chord] = neph_medium_optical_depth(chords->baked, from_m, d, 0.0,
                                                            length_m);
}

static void summarize_chords(const struct chords *chords, struct neph_bake_error *error)
{
    double squares = 0.0, sum = 0.0;
    for (int i = 0; i < error->chord_count; i++) {
        const double depth = chords->medium_depths[i];
        const double difference = chords->baked_depths[i] - depth;
        squares += difference * difference;
        sum += difference;
        error->optical_depth_max = fmax(error->optical_depth_max, fabs(difference));
        error->transmittance_max = fmax(error->transmittance_max,
                                        fabs(exp(-chords->baked_depths[i]) - exp(-depth)));
    }
    error->optical_depth_rms = sqrt(squares / error->chord_count);
    error->optical_depth_mean = sum / error->chord_count;
}

static enum neph_status measure_chords(const struct neph_medium *medium,
                                       const struct neph_medium *baked,
                                       const struct neph_bounds *region, double largest_per_m,
                                       struct neph_bake_error *error, struct neph_diag *diag)
{
    double *depths = malloc(2 * (size_t)error->chord_count * sizeof(*depths));
    if (!depths)
        return neph_fail_memory(diag);
    struct chords chords = {.medium = medium,
                            .baked = baked,
                            .region = region,
                            .largest_per_m = largest_per_m,
                            .seed = error->seed,
                            .medium_depths = depths,
                            .baked_depths = depths + error->chord_count};
    enum neph_status status = neph_parallel_rows(error->chord_count, measure_chord, &chords, diag);
    if (!status)
        summarize_chords(&chords, error);
    free(depths);
    return status;
}

static struct neph_bounds join(struct neph_bounds a, struct neph_bounds b)
{
    for (int axis = 0; axis < 3; axis++) {
        double *low_m = get_axis(&a.min_m, axis), *high_m = get_axis(&a.max_m, axis);
        *low_m = fmin(*low_m, *get_axis(&b.min_m, axis));
        *high_m = fmax(*high_m, *get_axis(&b.max_m, axis));
    }
    return a;
}

/* Measures errors over the box and over the ramps of the grid that extend beyond it. */
static enum neph_status measure(const struct neph_medium *medium, const struct neph_bounds *box,
                                struct neph_bake *bake, struct neph_diag *diag)
{
    const struct neph_medium baked = neph_medium_from_bake(medium, bake);
    const struct neph_bounds region = join(*box, neph_grid_support(bake->grid));
    bake->error = (struct neph_bake_error){
        .point_count = POINTS,
        .chord_count = neph_medium_has_closed_form(medium) ? CHORDS_CLOSED : CHORDS_QUADRATURE,
        .seed = error_seed};
    const double largest_per_m = measure_extinction(medium, &baked, &region, &bake->error);
    return measure_chords(medium, &baked, &region, largest_per_m, &bake->error, diag);
}

/* ---------------------------------------------------------------------------------------------- */

enum neph_status neph_medium_sample(const struct neph_medium *medium, const struct neph_bounds *box,
                                    int resolution, struct neph_bake *bake, struct neph_diag *diag)
{
    struct neph_bake made = {.grid = NULL};
    const int nodes = resolution ? resolution : NEPH_BAKE_RESOLUTION_DEFAULT;
    const enum neph_status status = resolution == 0 && neph_medium_is_whole_grid(medium)
                                        ? copy(medium, &made, diag)
                                        : sample(medium, box, nodes, &made, diag);
    if (status)
        neph_bake_finish(&made);
    else
        *bake = made;
    return status;
}

enum neph_status neph_medium_bake(const struct neph_medium *medium, const struct neph_bounds *box,
                                  int resolution, struct neph_bake *bake, struct neph_diag *diag)
{
    struct neph_bake made;
    enum neph_status status = neph_medium_sample(medium, box, resolution, &made, diag);
    if (status)
        return status;
    if (!made.is_copy)
        status = measure(medium, box, &made, diag);
    if (status)
        neph_bake_finish(&made);
    else
        *bake = made;
    return status;
}

void neph_bake_finish(struct neph_bake *bake)
{
    neph_grid_destroy(bake->grid);
    bake->grid = NULL;
}

struct neph_medium neph_medium_from_bake(const struct neph_medium *medium,
                                         const struct neph_bake *bake)
{
    struct neph_medium baked = *medium;
    baked.kind = NEPH_MEDIUM_GRID;
    baked.bounds = neph_grid_support(bake->grid);
    baked.turn = (struct neph_turn){0}; /* voxels outside of turned bounds are 0 */
    baked.extinction_per_m = bake->extinction_per_m;
    baked.grid = bake->grid;
    baked.horizon = NULL;
    baked.layer_count = 0;
    return baked;
}
