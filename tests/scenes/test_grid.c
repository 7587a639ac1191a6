/* SPDX-License-Identifier: MIT
 *
 * Grids against an interpolation by another algorithm (a sum of hat functions over all nodes),
 * closed forms, and the general properties of an integral.
 */
#include "tests/scene_builders.h"

#include "base/sort.h"
#include "scenes/bounds.h"
#include "scenes/grid.h"

#include <float.h>

static struct neph_grid *make_grid(const int size[3], struct neph_vec3 origin_m,
                                   struct neph_vec3 spacing_m)
{
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_grid_create(size, origin_m, spacing_m, &grid, &diag), &diag);
    return grid;
}

static void seal(struct neph_grid *grid)
{
    struct neph_diag diag = {0};
    neph_assert_ok(neph_grid_seal(grid, &diag), &diag);
}

/* Sides of 1 to 7 nodes, any position and spacing, about a third of the nodes empty. */
static struct neph_grid *random_grid(uint64_t *seed)
{
    int size[3];
    for (int axis = 0; axis < 3; axis++)
        size[axis] = 1 + (int)(neph_test_random(seed) % 7);
    const struct neph_vec3 origin_m = {neph_test_uniform(seed, -9, 9),
                                       neph_test_uniform(seed, -9, 9),
                                       neph_test_uniform(seed, -9, 9)};
    const struct neph_vec3 spacing_m = {pow(10.0, neph_test_uniform(seed, -1, 1)),
                                        pow(10.0, neph_test_uniform(seed, -1, 1)),
                                        pow(10.0, neph_test_uniform(seed, -1, 1))};
    struct neph_grid *grid = make_grid(size, origin_m, spacing_m);
    for (int n = 0; n < size[0] * size[1] * size[2]; n++)
        grid->values[n] = (float)fmax(0.0, neph_test_uniform(seed, -0.5, 1.0));
    seal(grid);
    return grid;
}

/* A position in or around the support; every fourth coordinate is a node's. */
static double random_coordinate(uint64_t *seed, double origin_m, double spacing_m, int size)
{
    double u = neph_test_uniform(seed, -2.0, size + 1.0);
    if (neph_test_uniform(seed, 0, 1) < 0.25)
        u = floor(u);
    return origin_m + u * spacing_m;
}

static struct neph_vec3 random_place(uint64_t *seed, const struct neph_grid *grid)
{
    return (struct neph_vec3){
        random_coordinate(seed, grid->origin_m.x, grid->spacing_m.x, grid->size[0]),
        random_coordinate(seed, grid->origin_m.y, grid->spacing_m.y, grid->size[1]),
        random_coordinate(seed, grid->origin_m.z, grid->spacing_m.z, grid->size[2])};
}

/* Any direction; half of them along an axis or in a plane of the lattice, with zeros of any sign or
 * values next to zero. */
static struct neph_vec3 lattice_direction(uint64_t *seed)
{
    static const double small[] = {0.0, -0.0, 1e-300, -1e-17, 1e-9, -5e-324};
    double d[3];
    for (int axis = 0; axis < 3; axis++)
        d[axis] = neph_test_uniform(seed, 0, 1) < 0.3 ? small[neph_test_random(seed) % COUNT(small)]
                                                      : neph_test_uniform(seed, -1.0, 1.0);
    const struct neph_vec3 direction = {d[0], d[1], d[2]};
    if (neph_vec3_length(direction) < 0.1)
        return (struct neph_vec3){d[0], -1.0, d[2]};
    return neph_vec3_normalize(direction);
}

static double hat(double u)
{
    return fmax(0.0, 1.0 - fabs(u));
}

/* Trilinear interpolation between nodes surrounded by zeros is a sum of products of hats. */
static double hat_density(const struct neph_grid *grid, struct neph_vec3 p)
{
    const double u = (p.x - grid->origin_m.x) / grid->spacing_m.x;
    const double v = (p.y - grid->origin_m.y) / grid->spacing_m.y;
    const double w = (p.z - grid->origin_m.z) / grid->spacing_m.z;
    double sum = 0.0;
    const float *value = grid->values;
    for (int k = 0; k < grid->size[2]; k++)
        for (int j = 0; j < grid->size[1]; j++)
            for (int i = 0; i < grid->size[0]; i++)
                sum += (double)*value++ * hat(u - i) * hat(v - j) * hat(w - k);
    return sum;
}

/* The two sums differ by roundings of terms that are all positive. */
static void test_density_is_a_sum_of_hats(void **state)
{
    const uint64_t first_seed = 11;
    for (uint64_t trial = 0; trial < 400; trial++) {
        uint64_t seed = first_seed + trial;
        struct neph_grid *grid = random_grid(&seed);
        for (int n = 0; n < 50; n++) {
            const struct neph_vec3 p = random_place(&seed, grid);
            const double density = neph_grid_density(grid, p), expected = hat_density(grid, p);
            if (!(fabs(density - expected) <= 1e-14))
                print_error("seed %llu\n", (unsigned long long)(first_seed + trial));
            neph_assert_close(density, expected, 0.0, 1e-14);
            assert_true(density >= 0.0);
        }
        neph_grid_destroy(grid);
    }
}

static void test_density_at_nodes_and_beyond(void **state)
{
    const int size[3] = {3, 2, 1};
    struct neph_grid *grid = make_grid(size, (struct neph_vec3){1, 2, 3},
                                       (struct neph_vec3){0.5, 2, 4});
    for (int n = 0; n < 6; n++)
        grid->values[n] = (float)(n + 1);
    seal(grid);
    assert_true(grid->maximum == 6.0f);
    for (int j = 0; j < 2; j++)
        for (int i = 0; i < 3; i++) {
            const struct neph_vec3 node_m = {1 + 0.5 * i, 2 + 2.0 * j, 3};
            neph_assert_close(neph_grid_density(grid, node_m), 3 * j + i + 1, 0.0, 0.0);
            const struct neph_vec3 half_m = {node_m.x, node_m.y, 3 - 2.0};
            neph_assert_close(neph_grid_density(grid, half_m), 0.5 * (3 * j + i + 1), 0.0, 0.0);
        }
    const struct neph_bounds support = neph_grid_support(grid);
    assert_true(support.min_m.x == 0.5 && support.max_m.x == 2.5 && support.min_m.z == -1.0 &&
                support.max_m.z == 7.0);
    const double bad[] = {NAN, INFINITY, -INFINITY, DBL_MAX, -DBL_MAX, 7.0, -1.0};
    for (size_t i = 0; i < COUNT(bad); i++)
        assert_true(neph_grid_density(grid, (struct neph_vec3){1, 2, bad[i]}) == 0.0);
    neph_grid_destroy(grid);
}

/* ---- integrals ------------------------------------------------------------------------------ */

enum { CUTS_MAX = 64 };

/* The intersections of a ray with the lattice planes across one axis. */
static int cut_axis(double *cuts, double origin, double direction, double first, double spacing,
                    int size, double t0, double t1)
{
    int count = 0;
    for (int i = -1; i <= size && direction != 0.0; i++) {
        const double t = (first + i * spacing - origin) / direction;
        if (t > t0 && t < t1)
            cuts[count++] = t;
    }
    return count;
}

/* Simpson's rule, exact for cubics, between all planes at once. */
static double reference_integral(const struct neph_grid *grid, struct neph_vec3 o,
                                 struct neph_vec3 d, double t0, double t1)
{
    double cuts[CUTS_MAX];
    int count = 0;
    cuts[count++] = t0;
    cuts[count++] = t1;
    count += cut_axis(cuts + count, o.x, d.x, grid->origin_m.x, grid->spacing_m.x, grid->size[0],
                      t0, t1);
    count += cut_axis(cuts + count, o.y, d.y, grid->origin_m.y, grid->spacing_m.y, grid->size[1],
                      t0, t1);
    count += cut_axis(cuts + count, o.z, d.z, grid->origin_m.z, grid->spacing_m.z, grid->size[2],
                      t0, t1);
    assert_true(count <= CUTS_MAX);
    neph_sort_doubles(cuts, (size_t)count);
    double sum = 0.0;
    for (int i = 0; i + 1 < count; i++) {
        const double a = cuts[i], b = cuts[i + 1], middle = 0.5 * (a + b);
        sum += (b - a) / 6.0 *
               (hat_density(grid, neph_vec3_along(o, d, a)) +
                4.0 * hat_density(grid, neph_vec3_along(o, d, middle)) +
                hat_density(grid, neph_vec3_along(o, d, b)));
    }
    return sum;
}

/* Rounding of positions (below 200 m in lattices of 0.1 m: 2^-45 of a cell) times at most 21 cells
 * of 10 m and density 1. */
static const double integral_absolute_m = 21 * 10.0 * 0x1p-45;

static void test_integral_against_planes_and_simpson(void **state)
{
    const uint64_t first_seed = 200;
    double worst_m = 0.0;
    for (uint64_t trial = 0; trial < 3000; trial++) {
        uint64_t seed = first_seed + trial;
        struct neph_grid *grid = random_grid(&seed);
        const struct neph_vec3 o = random_place(&seed, grid), d = lattice_direction(&seed);
        const double t0 = neph_test_uniform(&seed, -20, 20);
        const double t1 = t0 + neph_test_uniform(&seed, 0, 90);
        const double integral_m = neph_grid_integral_m(grid, o, d, t0, t1);
        const double expected_m = reference_integral(grid, o, d, t0, t1);
        worst_m = fmax(worst_m, fabs(integral_m - expected_m));
        if (!(fabs(integral_m - expected_m) <= integral_absolute_m))
            print_error("seed %llu\n", (unsigned long long)(first_seed + trial));
        neph_assert_close(integral_m, expected_m, 0.0, integral_absolute_m);
        neph_grid_destroy(grid);
    }
    print_message("worst absolute error of an integral: %.2g m\n", worst_m);
}

static void test_integral_adds_and_reverses(void **state)
{
    const uint64_t first_seed = 9000;
    for (uint64_t trial = 0; trial < 5000; trial++) {
        uint64_t seed = first_seed + trial;
        struct neph_grid *grid = random_grid(&seed);
        const struct neph_vec3 o = random_place(&seed, grid), d = lattice_direction(&seed);
        const double a = neph_test_uniform(&seed, -40, 40), b = neph_test_uniform(&seed, a, 90);
        const double whole = neph_grid_integral_m(grid, o, d, -200, 200);
        const double parts = neph_grid_integral_m(grid, o, d, -200, a) +
                             neph_grid_integral_m(grid, o, d, a, b) +
                             neph_grid_integral_m(grid, o, d, b, INFINITY);
        const double back = neph_grid_integral_m(grid, o, neph_vec3_scale(d, -1.0), -200, 200);
        if (!(fabs(parts - whole) <= integral_absolute_m &&
              fabs(back - whole) <= integral_absolute_m))
            print_error("seed %llu\n", (unsigned long long)(first_seed + trial));
        neph_assert_close(parts, whole, 0.0, integral_absolute_m);
        neph_assert_close(back, whole, 0.0, integral_absolute_m);
        neph_grid_destroy(grid);
    }
}

/* A row of nodes: spacing times their sum, for any direction and origin. */
static void test_integral_along_nodes_by_hand(void **state)
{
    const int size[3] = {5, 4, 3};
    struct neph_grid *grid = make_grid(size, (struct neph_vec3){0, 0, 0},
                                       (struct neph_vec3){2, 1, 0.5});
    for (int n = 0; n < 60; n++)
        grid->values[n] = 1.0f;
    seal(grid);
    const struct {
        struct neph_vec3 origin, direction;
        double t1, expected;
    } rays[] = {
        {{-10, 1, 0.5}, {1, 0, 0}, INFINITY, 10.0},        /* 5 nodes, 2 m each */
        {{30, 1, 0.5}, {-1, -0.0, 0}, INFINITY, 10.0},     /* reversed */
        {{-10, 0, 0}, {1, 0, 0}, INFINITY, 10.0},          /* in two outer planes at once */
        {{-10, -0.5, 0}, {1, 0, 0}, INFINITY, 5.0},        /* halfway out */
        {{-10, -0.5, -0.25}, {1, 0, 0}, INFINITY, 2.5},    /* and in the second direction */
        {{-10, -1, 0}, {1, 0, 0}, INFINITY, 0.0},          /* in the face of the support */
        {{-10, 4, 0}, {1, 0, 0}, INFINITY, 0.0},           /* in the opposite face */
        {{4, 2, -7}, {0, 0, 1}, INFINITY, 1.5},            /* 3 nodes */
        {{4, -7, 0.5}, {0, 1, 0}, INFINITY, 4.0},          /* 4 nodes */
        {{4, 1, 0.5}, {1, 0, 0}, INFINITY, 5.0},           /* from a node inside */
        {{4, 1, 0.5}, {-1, 0, 0}, 3.0, 3.0},               /* from inside to inside */
        {{3, 1, 0.5}, {1, 0, 0}, 1.0, 1.0},                /* to a node */
        {{3, 1, 0.5}, {1, 0, 0}, 0.0, 0.0},                /* no length */
        {{30, 1, 0.5}, {1, 0, 0}, INFINITY, 0.0},          /* behind */
        {{1e9, 1, 0.5}, {-1, 0, 0}, INFINITY, 10.0},       /* from far away */
        {{-1e300, 1, 0.5}, {1, 0, 0}, INFINITY, 0.0},      /* from too far to resolve anything */
        {{8, 3, 1.0}, {1, 5e-324, -1e-300}, INFINITY, 1.0} /* outward from the last node */
    };
    for (size_t i = 0; i < COUNT(rays); i++) {
        const double integral_m = neph_grid_integral_m(grid, rays[i].origin, rays[i].direction, 0.0,
                                                       rays[i].t1);
        assert_true(isfinite(integral_m) && integral_m >= 0.0);
        if (fabs(rays[i].origin.x) < 1e200)
            neph_assert_close(integral_m, rays[i].expected, 1e-14, 0.0);
    }
    neph_grid_destroy(grid);
}

/* One node: along the diagonal of cubic cells the density is (1 - |t|)^3, a true cubic. */
static void test_integral_of_a_single_node(void **state)
{
    const int size[3] = {1, 1, 1};
    struct neph_grid *grid = make_grid(size, (struct neph_vec3){5, 5, 5},
                                       (struct neph_vec3){1, 1, 1});
    grid->values[0] = 2.0f;
    seal(grid);
    const double third = 1.0 / sqrt(3.0);
    for (int corner = 0; corner < 8; corner++) {
        const struct neph_vec3 d = {corner & 1 ? third : -third, corner & 2 ? third : -third,
                                    corner & 4 ? third : -third};
        const struct neph_vec3 o = neph_vec3_along((struct neph_vec3){5, 5, 5}, d, -20.0);
        /* 2 (the density) * 2 * Int_0^1 (1-s)^3 ds * sqrt 3 (metres per s) */
        neph_assert_close(neph_grid_integral_m(grid, o, d, 0.0, INFINITY), sqrt(3.0), 1e-13, 0.0);
        neph_assert_close(neph_grid_integral_m(grid, o, d, 0.0, 20.0), 0.5 * sqrt(3.0), 1e-13, 0.0);
    }
    neph_grid_destroy(grid);
}

/* The mean over a bundle of parallel rays that tile the support is the sum of all node values, a
 * property of the whole grid that is independent of cell-wise formulas. 64 x 64 midpoints of
 * piecewise linear functions with kinks on the raster are exact. */
static void test_bundle_of_rays_gives_the_volume_integral(void **state)
{
    const uint64_t first_seed = 77;
    for (uint64_t trial = 0; trial < 8; trial++) {
        uint64_t seed = first_seed + trial;
        struct neph_grid *grid = random_grid(&seed);
        const struct neph_bounds support = neph_grid_support(grid);
        const int ny = 16 * (grid->size[1] + 1), nz = 16 * (grid->size[2] + 1);
        const double dy = (support.max_m.y - support.min_m.y) / ny;
        const double dz = (support.max_m.z - support.min_m.z) / nz;
        double sum = 0.0, expected = 0.0;
        for (int i = 0; i < ny * nz; i++) {
            const struct neph_vec3 o = {support.min_m.x - 1.0,
                                        support.min_m.y + (i % ny + 0.5) * dy,
                                        support.min_m.z + (i / ny + 0.5) * dz};
            sum += dy * dz *
                   neph_grid_integral_m(grid, o, (struct neph_vec3){1, 0, 0}, 0.0, INFINITY);
        }
        for (int i = 0; i < grid->size[0] * grid->size[1] * grid->size[2]; i++)
            expected += (double)grid->values[i];
        expected *= grid->spacing_m.x * grid->spacing_m.y * grid->spacing_m.z;
        neph_assert_close(sum, expected, 1e-11, 0.0);
        neph_grid_destroy(grid);
    }
}

/* The time depends on crossed cells: a ray through 1024 cells may not read a million nodes. The
 * test does not measure time; its count of rays is too high for a slower method to finish. */
static void test_long_thin_grid_is_quick(void **state)
{
    const int size[3] = {1024, 32, 32};
    struct neph_grid *grid = make_grid(size, (struct neph_vec3){0, 0, 0},
                                       (struct neph_vec3){1, 1, 1});
    for (size_t n = 0; n < (size_t)1024 * 32 * 32; n++)
        grid->values[n] = 0.25f;
    seal(grid);
    uint64_t seed = 5;
    for (int n = 0; n < 3000; n++) {
        const double slope = neph_test_uniform(&seed, -0.01, 0.01);
        const double norm = sqrt(1.0 + 2.0 * slope * slope);
        const struct neph_vec3 d = {1.0 / norm, slope / norm, slope / norm};
        const double through = neph_grid_integral_m(grid, (struct neph_vec3){-5, 16, 16}, d, 0.0,
                                                    INFINITY);
        /* 1023 whole cells and two ramps, all inside in y and z. */
        neph_assert_close(through, 0.25 * 1024 * norm, 1e-12, 0.0);
    }
    neph_grid_destroy(grid);
}

/* ---- maxima ---------------------------------------------------------------------------------- */

/* Positions along one axis where a piecewise linear function within [low, high] may be largest. */
static int corner_places(double places[16], double low, double high, double first, double spacing,
                         int size)
{
    int count = 0;
    places[count++] = low;
    places[count++] = high;
    for (int i = 0; i < size; i++)
        if (first + i * spacing > low && first + i * spacing < high)
            places[count++] = first + i * spacing;
    return count;
}

/* The largest value at corners of the box and of all cells in it, by the sum of hats. */
static double largest_corner(const struct neph_grid *grid, const struct neph_bounds *box)
{
    double x[16], y[16], z[16], largest = 0.0;
    const int nx = corner_places(x, box->min_m.x, box->max_m.x, grid->origin_m.x, grid->spacing_m.x,
                                 grid->size[0]);
    const int ny = corner_places(y, box->min_m.y, box->max_m.y, grid->origin_m.y, grid->spacing_m.y,
                                 grid->size[1]);
    const int nz = corner_places(z, box->min_m.z, box->max_m.z, grid->origin_m.z, grid->spacing_m.z,
                                 grid->size[2]);
    for (int i = 0; i < nx * ny * nz; i++)
        largest = fmax(largest, hat_density(grid, (struct neph_vec3){x[i % nx], y[i / nx % ny],
                                                                     z[i / nx / ny]}));
    return largest;
}

static void test_maximum_is_valid_in_any_box(void **state)
{
    const uint64_t first_seed = 31;
    for (uint64_t trial = 0; trial < 500; trial++) {
        uint64_t seed = first_seed + trial;
        struct neph_grid *grid = random_grid(&seed);
        const struct neph_vec3 a = random_place(&seed, grid), b = random_place(&seed, grid);
        const struct neph_bounds box = {{fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z)},
                                        {fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z)}};
        const double maximum = neph_grid_maximum_in(grid, &box);
        assert_true(maximum >= 0.0 && maximum <= (double)grid->maximum * (1.0 + 8.0 * DBL_EPSILON));
        const struct neph_bounds place = {a, a};
        neph_assert_close(neph_grid_maximum_in(grid, &place), neph_grid_density(grid, a), 1e-15,
                          0.0);
        neph_assert_close(maximum, largest_corner(grid, &box), 1e-13, 1e-14);
        for (int n = 0; n < 100; n++) {
            const double density = neph_grid_density(grid, random_place_in(&box, &seed));
            if (!(density <= maximum * (1.0 + 8.0 * DBL_EPSILON)))
                print_error("seed %llu: %.17g > %.17g\n", (unsigned long long)(first_seed + trial),
                            density, maximum);
            assert_true(density <= maximum * (1.0 + 8.0 * DBL_EPSILON));
        }
        neph_grid_destroy(grid);
    }
}

static void test_maximum_by_hand(void **state)
{
    const int size[3] = {4, 1, 1};
    struct neph_grid *grid = make_grid(size, (struct neph_vec3){0, 0, 0},
                                       (struct neph_vec3){1, 1, 1});
    const float values[] = {1, 5, 0, 2};
    memcpy(grid->values, values, sizeof(values));
    seal(grid);
    const struct {
        double low, high, expected;
    } boxes[] = {
        {-INFINITY, INFINITY, 5},
        {-0.5, -0.1, 0.9},
        {0.5, 0.6, 3.4},
        {2.0, 2.0, 0},
        {2.0, 2.5, 1},
        {3.5, 9, 1},
        {4, 9, 0},
        {-9, -1, 0},
        {1.0, 1.0, 5},
        {-INFINITY, 0.0, 1},
        {3.0, INFINITY, 2},
        {7, 6, 0},
    };
    for (size_t i = 0; i < COUNT(boxes); i++) {
        const struct neph_bounds box = {{boxes[i].low, -1, -INFINITY}, {boxes[i].high, 2, 0.0}};
        neph_assert_close(neph_grid_maximum_in(grid, &box), boxes[i].expected, 1e-15, 0.0);
    }
    const struct neph_bounds above = {{-1, 1, -1}, {5, 2, 1}};
    assert_true(neph_grid_maximum_in(grid, &above) == 0.0);
    neph_grid_destroy(grid);
}

/* ---- creation -------------------------------------------------------------------------------- */

static void assert_refused(int nx, int ny, int nz, struct neph_vec3 origin_m,
                           struct neph_vec3 spacing_m, const char *words)
{
    const int size[3] = {nx, ny, nz};
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    assert_int_equal(neph_grid_create(size, origin_m, spacing_m, &grid, &diag), NEPH_ERR_INPUT);
    assert_null(grid);
    if (!strstr(diag.message, words))
        print_error("'%s' is not in '%s'\n", words, diag.message);
    assert_non_null(strstr(diag.message, words));
}

/* ---- constant cells ------------------------------------------------------------------------- */

/* The integral over a ray by the overlap of the ray with every cell. */
static double overlap_integral(const struct neph_grid *grid, struct neph_vec3 o, struct neph_vec3 d,
                               double t0, double t1)
{
    const struct neph_vec3 s = grid->spacing_m;
    double sum = 0.0;
    for (int n = 0; n < grid->size[0] * grid->size[1] * grid->size[2]; n++) {
        const int i = n % grid->size[0], j = n / grid->size[0] % grid->size[1],
                  k = n / grid->size[0] / grid->size[1];
        const struct neph_vec3 middle_m = {grid->origin_m.x + i * s.x, grid->origin_m.y + j * s.y,
                                           grid->origin_m.z + k * s.z};
        const struct neph_bounds cell = {neph_vec3_along(middle_m, s, -0.5),
                                         neph_vec3_along(middle_m, s, 0.5)};
        double from = t0, to = t1;
        if (neph_bounds_clip(&cell, o, d, &from, &to))
            sum += (to - from) * (double)grid->values[n];
    }
    return sum;
}

static void test_constant_cells_against_their_overlaps(void **state)
{
    for (uint64_t trial = 0; trial < 1500; trial++) {
        uint64_t seed = 500 + trial;
        struct neph_grid *grid = random_grid(&seed);
        grid->is_constant = true;
        const struct neph_vec3 o = random_place(&seed, grid), d = random_direction(&seed);
        const double t0 = neph_test_uniform(&seed, -20, 20);
        const double t1 = t0 + neph_test_uniform(&seed, 0, 90);
        const double whole_m = neph_grid_integral_m(grid, o, d, t0, t1);
        if (!(fabs(whole_m - overlap_integral(grid, o, d, t0, t1)) <= integral_absolute_m))
            print_error("seed %llu\n", (unsigned long long)(500 + trial));
        neph_assert_close(whole_m, overlap_integral(grid, o, d, t0, t1), 0.0, integral_absolute_m);
        const double part_m = whole_m * neph_test_uniform(&seed, 0.01, 0.99);
        const double at_m = neph_grid_free_path_m(grid, o, d, t0, t1, part_m);
        if (whole_m > 0.0) /* the inverse */
            neph_assert_close(neph_grid_integral_m(grid, o, d, t0, at_m), part_m, 0.0,
                              integral_absolute_m);
        assert_true(isinf(neph_grid_free_path_m(grid, o, d, t0, t1, 1.001 * whole_m + 1e-9)));
        neph_grid_destroy(grid);
    }
}

static void test_constant_cells_end_halfway_and_repeat(void **state)
{
    struct neph_grid *grid = make_grid((const int[3]){2, 1, 1}, (struct neph_vec3){10, 0, 0},
                                       (struct neph_vec3){2, 4, 6});
    grid->values[0] = 3.0f;
    grid->values[1] = 5.0f;
    grid->is_constant = true;
    char trilinear[NEPH_HASH_HEX_SIZE];
    seal(grid);
    const struct neph_bounds support = neph_grid_support(grid);
    assert_true(support.min_m.x == 9.0 && support.max_m.x == 13.0 && support.min_m.y == -2.0 &&
                support.max_m.z == 3.0);
    static const struct {
        double x_m, density;
    } points[] = {{8.9, 0}, {9.1, 3}, {10.9, 3}, {11.1, 5}, {12.9, 5}, {13.1, 0}};
    for (size_t i = 0; i < COUNT(points); i++)
        assert_true(neph_grid_density(grid, (struct neph_vec3){points[i].x_m, 1.9, -2.9}) ==
                    points[i].density);
    const struct neph_bounds left = {{9.5, -1, -1}, {10.5, 1, 1}};
    assert_true(neph_grid_maximum_in(grid, &left) >= 3.0);
    grid->is_endless[0] = true; /* a period of 4 m: mean density 4 */
    neph_assert_close(neph_grid_integral_m(grid, (struct neph_vec3){-100.3, 0, 0},
                                           (struct neph_vec3){1, 0, 0}, 0.0, 400.0),
                      1600.0, 1e-12, 0.0);
    memcpy(trilinear, grid->hash, sizeof(trilinear));
    grid->is_endless[0] = grid->is_constant = false;
    seal(grid);
    assert_string_not_equal(grid->hash, trilinear);
    neph_grid_destroy(grid);
}

/* A bound of constant cells holds at each place in the box. */
static void test_constant_maximum_is_valid_in_any_box(void **state)
{
    for (uint64_t seed = 700; seed < 900; seed++) {
        uint64_t state_ = seed;
        struct neph_grid *grid = random_grid(&state_);
        grid->is_constant = true;
        const struct neph_vec3 a = random_place(&state_, grid), b = random_place(&state_, grid);
        const struct neph_bounds box = {{fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z)},
                                        {fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z)}};
        const double bound = neph_grid_maximum_in(grid, &box);
        for (int i = 0; i < 50; i++)
            assert_true(neph_grid_density(grid, random_place_in(&box, &state_)) <= bound);
        neph_grid_destroy(grid);
    }
}

static void test_bad_sizes_and_places_are_refused(void **state)
{
    const struct neph_vec3 zero = {0, 0, 0}, one = {1, 1, 1};
    assert_refused(0, 5, 5, zero, one, "0 x 5 x 5");
    assert_refused(5, -3, 5, zero, one, "5 x -3 x 5");
    assert_refused(5, 5, 1025, zero, one, "5 x 5 x 1025");
    assert_refused(INT32_MAX, INT32_MAX, INT32_MAX, zero, one, "1 to 1024");
    assert_refused(1024, 1024, 1024, zero, one, "4096 MiB; the most is 512 MiB");
    assert_refused(5, 5, 5, zero, (struct neph_vec3){1, 0, 1}, "spacing");
    assert_refused(5, 5, 5, zero, (struct neph_vec3){1, 1, -1}, "spacing");
    assert_refused(5, 5, 5, zero, (struct neph_vec3){NAN, 1, 1}, "spacing");
    assert_refused(5, 5, 5, zero, (struct neph_vec3){1, INFINITY, 1}, "finite");
    assert_refused(5, 5, 5, zero, (struct neph_vec3){1e308, 1, 1}, "finite");
    assert_refused(5, 5, 5, (struct neph_vec3){0, NAN, 0}, one, "finite");
    assert_refused(5, 5, 5, (struct neph_vec3){0, 0, -INFINITY}, one, "finite");
    assert_refused(5, 5, 5, (struct neph_vec3){1e20, 0, 0}, one, "lost to rounding");
    neph_grid_destroy(NULL);
}

static void test_bad_values_are_named(void **state)
{
    const int size[3] = {3, 4, 5};
    struct neph_grid *grid = make_grid(size, (struct neph_vec3){0, 0, 0},
                                       (struct neph_vec3){1, 1, 1});
    const float bad[] = {NAN, INFINITY, -INFINITY, -1e-30f};
    for (size_t i = 0; i < COUNT(bad); i++) {
        grid->values[(4 * 4 + 2) * 3 + 1] = bad[i];
        struct neph_diag diag = {0};
        assert_int_equal(neph_grid_seal(grid, &diag), NEPH_ERR_INPUT);
        assert_non_null(strstr(diag.message, "node (1, 2, 4)"));
        assert_int_equal(neph_grid_seal(grid, NULL), NEPH_ERR_INPUT);
    }
    neph_grid_destroy(grid);
}

/* The same values in another shape are another grid. */
static void test_hash_knows_size_and_values(void **state)
{
    const int shapes[3][3] = {{6, 1, 1}, {1, 6, 1}, {2, 3, 1}};
    char hashes[4][NEPH_HASH_HEX_SIZE];
    for (int i = 0; i < 3; i++) {
        struct neph_grid *grid = make_grid(shapes[i], (struct neph_vec3){0, 0, 0},
                                           (struct neph_vec3){1, 1, 1});
        grid->values[3] = 1.0f;
        seal(grid);
        memcpy(hashes[i], grid->hash, NEPH_HASH_HEX_SIZE);
        grid->values[3] = nextafterf(1.0f, 2.0f);
        seal(grid);
        memcpy(hashes[3], grid->hash, NEPH_HASH_HEX_SIZE);
        assert_string_not_equal(hashes[i], hashes[3]);
        neph_grid_destroy(grid);
    }
    assert_string_not_equal(hashes[0], hashes[1]);
    assert_string_not_equal(hashes[0], hashes[2]);
    assert_int_equal(strlen(hashes[0]), NEPH_HASH_HEX_SIZE - 1);
}

#include "tests/main.h"
