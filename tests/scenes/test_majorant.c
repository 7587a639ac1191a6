/* SPDX-License-Identifier: MIT
 *
 * Majorants are never exceeded, are not far too large, and have the requested cells.
 */
#include "tests/scene_builders.h"

#include "scenes/grid.h"
#include "scenes/majorant.h"
#include "scenes/media.h"

static struct neph_majorants *make(const struct neph_medium *medium, const struct neph_bounds *box,
                                   int cell_count)
{
    struct neph_majorants *majorants = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_majorants_create(medium, box, cell_count, &majorants, &diag), &diag);
    return majorants;
}

static struct neph_grid *random_grid(uint64_t *seed)
{
    const int size[3] = {1 + (int)(neph_test_random(seed) % 12),
                         1 + (int)(neph_test_random(seed) % 12),
                         1 + (int)(neph_test_random(seed) % 12)};
    const struct neph_vec3 origin_m = {neph_test_uniform(seed, -5, 5),
                                       neph_test_uniform(seed, -5, 5),
                                       neph_test_uniform(seed, -5, 5)};
    const struct neph_vec3 spacing_m = {neph_test_uniform(seed, 0.1, 1),
                                        neph_test_uniform(seed, 0.1, 1),
                                        neph_test_uniform(seed, 0.1, 1)};
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_grid_create(size, origin_m, spacing_m, &grid, &diag), &diag);
    /* Mostly one value: interpolation between equal floats must not round above them. */
    for (int n = 0; n < size[0] * size[1] * size[2]; n++)
        grid->values[n] = neph_test_uniform(seed, 0, 1) < 0.5
                              ? 0.1f
                              : (float)fmax(0.0, neph_test_uniform(seed, -1, 1));
    neph_assert_ok(neph_grid_seal(grid, &diag), &diag);
    return grid;
}

/* A medium of each kind in turn, of sizes around 1 to 10 m near the origin. The caller destroys a
 * grid. */
static struct neph_medium random_medium(uint64_t *seed, uint64_t trial)
{
    struct neph_medium medium = {.bounds = everywhere,
                                 .extinction_color = {1, 1, 1},
                                 .extinction_per_m = pow(10.0, neph_test_uniform(seed, -3, 2))};
    const struct neph_vec3 center_m = {neph_test_uniform(seed, -3, 3),
                                       neph_test_uniform(seed, -3, 3),
                                       neph_test_uniform(seed, -3, 3)};
    const double length_m = neph_test_uniform(seed, 0.3, 5.0);
    static const enum neph_medium_kind kinds[] = {NEPH_MEDIUM_HOMOGENEOUS, NEPH_MEDIUM_HEIGHT_FOG,
                                                  NEPH_MEDIUM_GAUSSIAN, NEPH_MEDIUM_SHELL,
                                                  NEPH_MEDIUM_GRID};
    medium.kind = kinds[trial % COUNT(kinds)];
    medium.gaussian = (struct neph_gaussian){center_m, length_m};
    medium.shell = (struct neph_shell){center_m, neph_test_uniform(seed, 0.1, 5.0), length_m};
    if (medium.kind == NEPH_MEDIUM_GRID)
        medium.grid = random_grid(seed);
    if (medium.kind == NEPH_MEDIUM_HOMOGENEOUS || medium.kind == NEPH_MEDIUM_HEIGHT_FOG) {
        medium.layer_count = 2;
        const double falloff_per_m = medium.kind == NEPH_MEDIUM_HEIGHT_FOG ? 1.0 / length_m : 0.0;
        for (int i = 0; i < 2; i++)
            medium.layers[i] = (struct neph_fog_layer){0.3 + i, falloff_per_m * (1 + i),
                                                       center_m.y};
    }
    if (neph_test_uniform(seed, 0, 1) < 0.3)
        medium.bounds = (struct neph_bounds){{-2, -3, -2.5}, {3, 2.5, 4}};
    return medium;
}

static struct neph_bounds random_box(uint64_t *seed)
{
    const struct neph_vec3 low = {neph_test_uniform(seed, -8, 2), neph_test_uniform(seed, -8, 2),
                                  neph_test_uniform(seed, -8, 2)};
    return (struct neph_bounds){low,
                                {low.x + pow(10.0, neph_test_uniform(seed, -2, 1)),
                                 low.y + pow(10.0, neph_test_uniform(seed, -2, 1)),
                                 low.z + pow(10.0, neph_test_uniform(seed, -2, 1))}};
}

/* The majorant of the cell at a position given as a fraction of the box on each axis. */
static double majorant_at(const struct neph_majorants *m, const double share[3])
{
    int cell[3];
    for (int axis = 0; axis < 3; axis++)
        cell[axis] = (int)fmin(m->size[axis] - 1, floor(share[axis] * m->size[axis]));
    return (double)m->extinction_per_m[(cell[2] * m->size[1] + cell[1]) * m->size[0] + cell[0]];
}

/* Random positions and, every other time, on the faces of cells. */
static double random_share(uint64_t *seed, int size)
{
    const double share = neph_test_uniform(seed, 0.0, 1.0);
    return neph_test_uniform(seed, 0, 1) < 0.5 ? share : floor(share * (size + 1)) / size;
}

static void test_no_extinction_passes_its_majorant(void **state)
{
    const uint64_t first_seed = 4711;
    double tightest = 0.0;
    for (uint64_t trial = 0; trial < 1500; trial++) {
        uint64_t seed = first_seed + trial;
        const struct neph_medium medium = random_medium(&seed, trial);
        const struct neph_bounds box = random_box(&seed);
        const int cell_count = 1 + (int)(neph_test_random(&seed) % 300);
        struct neph_majorants *majorants = make(&medium, &box, cell_count);
        for (int n = 0; n < 200; n++) {
            const double share[3] = {random_share(&seed, majorants->size[0]),
                                     random_share(&seed, majorants->size[1]),
                                     random_share(&seed, majorants->size[2])};
            const struct neph_vec3 p = {box.min_m.x + share[0] * (box.max_m.x - box.min_m.x),
                                        box.min_m.y + share[1] * (box.max_m.y - box.min_m.y),
                                        box.min_m.z + share[2] * (box.max_m.z - box.min_m.z)};
            const double extinction = neph_medium_extinction_per_m(&medium, p);
            const double majorant = majorant_at(majorants, share);
            if (!(extinction <= majorant))
                print_error("seed %llu, kind %d: %.17g > %.17g\n",
                            (unsigned long long)(first_seed + trial), medium.kind, extinction,
                            majorant);
            assert_true(extinction <= majorant);
            tightest = fmax(tightest, majorant > 0.0 ? extinction / majorant : 0.0);
        }
        neph_majorants_destroy(majorants);
        neph_grid_destroy(medium.grid);
    }
    assert_true(tightest > 0.9999);
}

/* The largest of the eight nodes around a position, among nodes with a weight. */
static double node_maximum_at(const struct neph_grid *grid, struct neph_vec3 point_m)
{
    const double u[3] = {(point_m.x - grid->origin_m.x) / grid->spacing_m.x,
                         (point_m.y - grid->origin_m.y) / grid->spacing_m.y,
                         (point_m.z - grid->origin_m.z) / grid->spacing_m.z};
    double maximum = 0.0;
    for (int corner = 0; corner < 8; corner++) {
        int node[3];
        bool is_there = true;
        for (int axis = 0; axis < 3; axis++) {
            node[axis] = (int)floor(u[axis]) + (corner >> axis & 1);
            is_there = is_there && node[axis] >= 0 && node[axis] < grid->size[axis] &&
                       fabs(u[axis] - node[axis]) < 1.0 - 2e-6;
        }
        if (is_there)
            maximum = fmax(
                maximum,
                (double)
                    grid->values[(node[2] * grid->size[1] + node[1]) * grid->size[0] + node[0]]);
    }
    return maximum;
}

/* Where a tracker may select any of the nodes around a position, cells of any size and in any part
 * of the grid bound all of them; none is larger than the largest node. */
static void test_covered_nodes_pass_no_majorant(void **state)
{
    const uint64_t first_seed = 815;
    int tight_fails = 0;
    for (uint64_t trial = 0; trial < 500; trial++) {
        uint64_t seed = first_seed + trial;
        struct neph_grid *grid = random_grid(&seed);
        const struct neph_medium medium = {.kind = NEPH_MEDIUM_GRID,
                                           .bounds = everywhere,
                                           .extinction_color = {1, 1, 1},
                                           .extinction_per_m = 3.0,
                                           .grid = grid};
        const struct neph_bounds box = trial % 2 ? random_box(&seed) : neph_grid_support(grid);
        const int cell_count = 1 + (int)(neph_test_random(&seed) % 300);
        struct neph_majorants *tight = make(&medium, &box, cell_count);
        struct neph_majorants *covered = make(&medium, &box, cell_count);
        neph_majorants_cover_nodes(covered, &medium);
        for (int n = 0; n < 200; n++) {
            const double share[3] = {random_share(&seed, covered->size[0]),
                                     random_share(&seed, covered->size[1]),
                                     random_share(&seed, covered->size[2])};
            const struct neph_vec3 p = {box.min_m.x + share[0] * (box.max_m.x - box.min_m.x),
                                        box.min_m.y + share[1] * (box.max_m.y - box.min_m.y),
                                        box.min_m.z + share[2] * (box.max_m.z - box.min_m.z)};
            const double node = 3.0 * node_maximum_at(grid, p);
            const double majorant = majorant_at(covered, share);
            if (!(node <= majorant))
                print_error("seed %llu: %.17g > %.17g\n", (unsigned long long)(first_seed + trial),
                            node, majorant);
            assert_true(node <= majorant && majorant >= majorant_at(tight, share));
            assert_true(majorant <= 3.0 * (double)grid->maximum * (1.0 + 2e-5));
            tight_fails += node > majorant_at(tight, share);
        }
        neph_majorants_destroy(tight);
        neph_majorants_destroy(covered);
        neph_grid_destroy(grid);
    }
    assert_true(tight_fails > 1000); /* otherwise the positions test nothing */
}

/* In double, without the margin for float: a grid of one value, where interpolation may round above
 * it, in boxes as small as a point. */
static void test_bound_of_even_density_and_small_boxes(void **state)
{
    const int size[3] = {4, 4, 4};
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_grid_create(size, (struct neph_vec3){0, 0, 0}, (struct neph_vec3){1, 1, 1},
                                    &grid, &diag),
                   &diag);
    for (int n = 0; n < 64; n++)
        grid->values[n] = 0.1f;
    neph_assert_ok(neph_grid_seal(grid, &diag), &diag);
    const struct neph_medium medium = {
        .kind = NEPH_MEDIUM_GRID, .bounds = everywhere, .extinction_per_m = 0.3, .grid = grid};
    uint64_t seed = 12;
    for (int n = 0; n < 20000; n++) {
        const struct neph_vec3 p = {neph_test_uniform(&seed, 0, 3), neph_test_uniform(&seed, 0, 3),
                                    neph_test_uniform(&seed, 0, 3)};
        const struct neph_bounds place = {p, p};
        const double bound = neph_medium_extinction_bound_per_m(&medium, &place);
        assert_true(neph_medium_extinction_per_m(&medium, p) <= bound);
        neph_assert_close(bound, 0.3 * (double)0.1f, 2e-12, 0.0);
    }
    neph_grid_destroy(grid);
}

/* Cells bound their own points: the mean of the majorants over a blob approaches the mean of its
 * extinction as cells get smaller. */
static void test_more_cells_are_tighter(void **state)
{
    const struct neph_medium medium = {.kind = NEPH_MEDIUM_GAUSSIAN,
                                       .bounds = everywhere,
                                       .extinction_color = {1, 1, 1},
                                       .extinction_per_m = 1.0,
                                       .gaussian = {{0, 0, 0}, 1.0}};
    const struct neph_bounds box = {{-4, -4, -4}, {4, 4, 4}};
    const double mean = pow(2.0 * M_PI, 1.5) / 512.0; /* (w sqrt(2 pi))^3 / volume */
    double last = 1.0;
    for (int side = 1; side <= 64; side *= 2) {
        struct neph_majorants *m = make(&medium, &box, side * side * side);
        assert_true(m->size[0] == side && m->size[1] == side && m->size[2] == side);
        double sum = 0.0;
        for (int i = 0; i < side * side * side; i++)
            sum += (double)m->extinction_per_m[i];
        sum /= side * side * side;
        assert_true(sum <= last * (1.0 + 1e-4) && sum >= mean);
        last = sum;
        neph_majorants_destroy(m);
    }
    print_message("mean majorant of cells of an eighth of the width: %.3f of the mean\n",
                  last / mean);
    /* On each axis the bound is taken up to half a cell nearer to the middle than the mean
     * position: the integral of e^{-x^2/2} grows by the cell's 1/8, twice a half, over sqrt(2 pi).
     */
    assert_true(last < 1.02 * pow(1.0 + 0.125 / sqrt(2.0 * M_PI), 3.0) * mean);
}

/* Approximately the requested number of cells, nearly cubes, in a box of any shape. */
static void test_cells_of_flat_and_long_boxes(void **state)
{
    const struct neph_medium medium = {.kind = NEPH_MEDIUM_HOMOGENEOUS,
                                       .bounds = everywhere,
                                       .layer_count = 1,
                                       .layers = {{1.0, 0.0, 0.0}}};
    const struct {
        struct neph_vec3 extent_m;
        int cell_count, expected[3];
    } rows[] = {
        {{8, 8, 8}, 1, {1, 1, 1}},
        {{8, 8, 8}, 4096, {16, 16, 16}},
        {{1000, 1, 1000}, 400, {20, 1, 20}},
        {{1, 1, 1000}, 100, {1, 1, 100}},
        {{1e-6, 1e5, 1e5}, 100, {1, 10, 10}},
        {{4, 2, 1}, 64, {8, 4, 2}},
        {{1, 1, 1e9}, 1 << 20, {1, 1, 1024}},
        {{1e-3, 4, 1000}, 10, {1, 1, 10}},
    };
    for (size_t i = 0; i < COUNT(rows); i++) {
        const struct neph_bounds box = {{0, 0, 0}, rows[i].extent_m};
        struct neph_majorants *m = make(&medium, &box, rows[i].cell_count);
        for (int axis = 0; axis < 3; axis++)
            if (m->size[axis] != rows[i].expected[axis])
                print_error("row %zu: %d x %d x %d\n", i, m->size[0], m->size[1], m->size[2]);
        assert_memory_equal(m->size, rows[i].expected, sizeof(m->size));
        neph_majorants_destroy(m);
    }
}

/* A grid of 7 x 3 x 1 nodes has 8 x 4 x 2 cells with its ramps. Thinner majorant cells cost more
 * without a benefit, in its whole support or in a part. */
static void test_cells_are_no_thinner_than_a_grid_s(void **state)
{
    const int size[3] = {7, 3, 1};
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_grid_create(size, (struct neph_vec3){0.1, 0.7, -0.3},
                                    (struct neph_vec3){0.3, 0.3, 0.3}, &grid, &diag),
                   &diag);
    neph_assert_ok(neph_grid_seal(grid, &diag), &diag);
    const struct neph_medium medium = {
        .kind = NEPH_MEDIUM_GRID, .bounds = everywhere, .extinction_per_m = 1.0, .grid = grid};
    const struct neph_bounds support = neph_medium_support(&medium);
    struct neph_majorants *m = make(&medium, &support, 1000000);
    assert_true(m->size[0] == 8 && m->size[1] == 4 && m->size[2] == 2);
    neph_majorants_destroy(m);
    const struct neph_bounds part = {{0.2, 0.7, -0.3}, {1.2, 0.8, 0.1}};
    m = make(&medium, &part, 1000000);
    assert_true(m->size[0] == 3 && m->size[1] == 1 && m->size[2] == 1);
    neph_majorants_destroy(m);
    neph_grid_destroy(grid);
}

static void assert_refused(const struct neph_bounds *box, int cell_count, const char *words)
{
    const struct neph_medium medium = {.kind = NEPH_MEDIUM_GAUSSIAN,
                                       .bounds = everywhere,
                                       .extinction_per_m = 1.0,
                                       .gaussian = {{0, 0, 0}, 1.0}};
    struct neph_majorants *majorants = NULL;
    struct neph_diag diag = {0};
    assert_int_not_equal(neph_majorants_create(&medium, box, cell_count, &majorants, &diag),
                         NEPH_OK);
    assert_null(majorants);
    assert_non_null(strstr(diag.message, words));
}

static void test_what_has_no_majorants(void **state)
{
    const struct neph_bounds open = {{-1, -INFINITY, -1}, {1, 1, 1}};
    const struct neph_bounds nowhere = {{-1, -1, NAN}, {1, 1, 1}};
    const struct neph_bounds flat = {{-1, -1, 1}, {1, 1, 1}};
    const struct neph_bounds good = {{-1, -1, -1}, {1, 1, 1}};
    assert_refused(&everywhere, 8, "a Gaussian blob without finite bounds");
    assert_refused(&open, 8, "without finite bounds");
    assert_refused(&nowhere, 8, "without finite bounds");
    assert_refused(&flat, 8, "exclude all of it");
    assert_refused(&good, 0, "0 cells");
    neph_majorants_destroy(NULL);
}

/* 1e30 per metre and 1e-50 per metre, at the limits of float. */
static void test_float_ends(void **state)
{
    const struct neph_bounds box = {{-1, -1, -1}, {1, 1, 1}};
    static const double extinctions[] = {0.0, 5e-324, 1e-50, 1e-40, 1e30};
    for (size_t i = 0; i < COUNT(extinctions); i++) {
        const struct neph_medium medium = {.kind = NEPH_MEDIUM_GAUSSIAN,
                                           .bounds = everywhere,
                                           .extinction_per_m = extinctions[i],
                                           .gaussian = {{0, 0, 0}, 1.0}};
        struct neph_majorants *m = make(&medium, &box, 8);
        for (int n = 0; n < 8; n++)
            assert_true((double)m->extinction_per_m[n] >= extinctions[i] &&
                        isfinite(m->extinction_per_m[n]));
        assert_true((m->extinction_per_m[0] == 0.0f) == (extinctions[i] == 0.0));
        neph_majorants_destroy(m);
    }
}

#include "tests/main.h"
