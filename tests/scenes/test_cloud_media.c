/* SPDX-License-Identifier: MIT
 *
 * Gaussian blobs, spherical shells and voxel grids: line integrals against closed forms, quadrature
 * of the density, and their own properties (additivity, reversal); majorants.
 */
#include "tests/scene_builders.h"

#include "scenes/grid.h"
#include "scenes/majorant.h"
#include "scenes/media.h"
#include "scenes/quadrature.h"

static struct neph_medium planet(double radius_m, double scale_height_m)
{
    return make_shell(1.0 / scale_height_m, (struct neph_vec3){0.0, -radius_m, 0.0}, radius_m,
                      scale_height_m);
}

static struct neph_medium voxels(uint64_t seed)
{
    return make_voxels(1.5,
                       random_lattice((const int[3]){5, 4, 3}, (struct neph_vec3){-2.0, 1.0, 0.5},
                                      (struct neph_vec3){1.0, 0.5, 2.0}, -0.3, &seed));
}

struct line {
    const struct neph_medium *medium;
    struct neph_vec3 origin_m, direction;
};

static void density_on_line(double t_m, void *context, double value[3])
{
    const struct line *line = context;
    value[0] = value[1] = value[2] = neph_medium_extinction_per_m(
        line->medium, neph_vec3_along(line->origin_m, line->direction, t_m));
}

/* Quadrature of the density over equal pieces: independent of every closed form. */
static double brute_force(const struct line *line, double t0_m, double t1_m, int piece_count)
{
    struct neph_interval pieces[512];
    double result[3];
    assert_true(piece_count <= 512);
    for (int i = 0; i < piece_count; i++)
        pieces[i] = (struct neph_interval){t0_m + (t1_m - t0_m) * i / piece_count,
                                           t0_m + (t1_m - t0_m) * (i + 1) / piece_count};
    neph_integrate(density_on_line, (void *)line, pieces, piece_count, result);
    return result[0];
}

static double depth(const struct line *line, double t0_m, double t1_m)
{
    return neph_medium_optical_depth(line->medium, line->origin_m, line->direction, t0_m, t1_m);
}

/* Random rays around the origin: against quadrature, split in two, and reversed. */
static void check_lines(const struct neph_medium *medium, double reach_m, double relative,
                        uint64_t seed)
{
    uint64_t random = seed;
    for (int i = 0; i < 60; i++) {
        const struct line line = {medium,
                                  {neph_test_uniform(&random, -reach_m, reach_m),
                                   neph_test_uniform(&random, -reach_m, reach_m),
                                   neph_test_uniform(&random, -reach_m, reach_m)},
                                  random_direction(&random)};
        const double end_m = 3.0 * reach_m, cut_m = neph_test_uniform(&random, 0.0, end_m);
        const double whole = depth(&line, 0.0, end_m);
        const double floor = 1e-12 * medium->extinction_per_m * reach_m;
        neph_assert_close(whole, brute_force(&line, 0.0, end_m, 64), relative, floor);
        neph_assert_close(depth(&line, 0.0, cut_m) + depth(&line, cut_m, end_m), whole, 1e-12,
                          floor);
        const struct line back = {medium, neph_vec3_along(line.origin_m, line.direction, end_m),
                                  neph_vec3_scale(line.direction, -1.0)};
        neph_assert_close(depth(&back, 0.0, end_m), whole, 1e-11, floor);
    }
}

static void test_gaussian_lines(void **state)
{
    const struct neph_medium medium = make_blob(0.7, (struct neph_vec3){0.3, -0.2, 0.1}, 0.8);
    check_lines(&medium, 3.0, 1e-11, 101);
    /* Through the middle: sigma w sqrt(2 pi). */
    const struct line line = {&medium, {-1e3, -0.2, 0.1}, {1, 0, 0}};
    neph_assert_close(depth(&line, 0.0, INFINITY), 0.7 * 0.8 * sqrt(2.0 * M_PI), 1e-13, 0.0);
}

/* Far from the middle both ends are on one side: erf(b) - erf(a) would give 0. */
static void test_gaussian_tail(void **state)
{
    const struct neph_medium medium = make_blob(0.7, (struct neph_vec3){0, 0, 0}, 1.0);
    const struct line line = {&medium, {0, 0, 0}, {0, 0, 1}};
    /* 0.7 sqrt(pi/2) erfc(8 / sqrt 2), mpmath */
    neph_assert_close(depth(&line, 8.0, INFINITY), 1.0915544969584052e-15, 1e-12, 0.0);
    const struct line far = {&medium, {1e7, 40.0, 0.0}, {-1, 0, 0}};
    neph_assert_close(depth(&far, 0.0, INFINITY), 0.0, 0.0, 1e-300);
}

static void test_shell_lines(void **state)
{
    const struct neph_medium medium = planet(50.0, 1.0);
    struct line line = {&medium, {0, 0, 0}, {0, 1, 0}};
    neph_assert_close(depth(&line, 0.0, INFINITY), 1.0, 1e-14, 0.0);
    uint64_t random = 77;
    for (int i = 0; i < 40; i++) {
        line.origin_m = (struct neph_vec3){neph_test_uniform(&random, -20, 20),
                                           neph_test_uniform(&random, 5, 9), 0.0};
        line.direction = random_direction(&random);
        line.direction.y = 0.2 * fabs(line.direction.y); /* completely above the ground */
        line.direction = neph_vec3_normalize(line.direction);
        neph_assert_close(depth(&line, 0.0, 30.0), brute_force(&line, 0.0, 30.0, 64), 1e-12, 0.0);
        neph_assert_close(depth(&line, 0.0, 11.0) + depth(&line, 11.0, 30.0),
                          depth(&line, 0.0, 30.0), 1e-13, 0.0);
    }
}

/* Chapman's function at 90 degrees, mpmath of the integral: X e^X K_1(X). */
static void test_chapman(void **state)
{
    static const struct {
        double x, value;
    } rows[] = {
        {50.0, 8.9283279279407787}, {796.375, 35.385319517709898}, {1e6, 1253.3146073081549}};
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
        const struct neph_medium medium = planet(rows[i].x, 1.0);
        const struct line line = {&medium, {0, 0, 0}, {1, 0, 0}};
        neph_assert_close(depth(&line, 0.0, INFINITY), rows[i].value, 2e-13, 0.0);
        const struct line whole = {&medium, {-1e3 * rows[i].x, 0, 0}, {1, 0, 0}};
        neph_assert_close(depth(&whole, 0.0, INFINITY), 2.0 * rows[i].value, 2e-13, 0.0);
    }
}

static void test_shell_is_hollow(void **state)
{
    const struct neph_medium medium = planet(50.0, 1.0);
    const struct line through = {&medium, {0, 20, 0}, {0, -1, 0}};
    neph_assert_close(depth(&through, 0.0, INFINITY), 2.0 - exp(-20.0), 1e-13, 0.0);
    neph_assert_close(depth(&through, 21.0, 100.0), 0.0, 0.0, 0.0);
}

static void test_grid_lines(void **state)
{
    struct neph_medium medium = voxels(5);
    check_lines(&medium, 3.0, 3e-6, 202); /* quadrature across faces, where it converges slowly */
    medium.bounds = (struct neph_bounds){{-1.3, 1.2, 0.0}, {1.1, 2.0, 3.3}};
    check_lines(&medium, 3.0, 3e-6, 203);
    neph_grid_destroy(medium.grid);
}

/* Along axes, in faces, through nodes, from inside: positions where the cell is ambiguous. */
static void test_grid_on_faces(void **state)
{
    struct neph_medium medium = voxels(6);
    for (int i = -1; i <= 5; i++)
        for (int axis = 0; axis < 3; axis++)
            for (int sign = -1; sign <= 1; sign += 2) {
                struct line line = {&medium, {-2.0 + i, 1.0 + 0.5 * i, 0.5 + 2.0 * i}, {0, 0, 0}};
                *(axis == 0   ? &line.direction.x
                  : axis == 1 ? &line.direction.y
                              : &line.direction.z) = sign;
                const double whole = depth(&line, 0.0, INFINITY);
                /* On the lattice's lines the density is piecewise linear; its kinks are at most 0.5
                 * m apart, and so are the pieces' ends. */
                neph_assert_close(whole, brute_force(&line, 0.0, 32.0, 256), 1e-12, 1e-14);
            }
    neph_grid_destroy(medium.grid);
}

static void test_grid_density(void **state)
{
    struct neph_medium medium = voxels(7);
    const struct neph_grid *grid = medium.grid;
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 4; j++)
            for (int i = 0; i < 5; i++)
                neph_assert_close(
                    neph_grid_density(grid,
                                      (struct neph_vec3){-2.0 + i, 1.0 + 0.5 * j, 0.5 + 2.0 * k}),
                    (double)grid->values[(k * 4 + j) * 5 + i], 0.0, 0.0);
    const double edge = neph_grid_density(grid, (struct neph_vec3){-2.5, 1.0, 0.5});
    neph_assert_close(edge, 0.5 * (double)grid->values[0], 1e-15, 0.0);
    assert_true(neph_grid_density(grid, (struct neph_vec3){-3.0, 1.0, 0.5}) == 0.0);
    assert_true(neph_grid_density(grid, (struct neph_vec3){NAN, 1.0, 0.5}) == 0.0);
    neph_grid_destroy(medium.grid);
}

static void check_majorants(const struct neph_medium *medium, const struct neph_bounds *box,
                            uint64_t seed)
{
    struct neph_majorants *majorants = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_majorants_create(medium, box, 200, &majorants, &diag), &diag);
    const int *n = majorants->size;
    double used = 0.0;
    for (int s = 0; s < 4000; s++) {
        double u[3];
        int cell[3];
        for (int axis = 0; axis < 3; axis++) {
            u[axis] = neph_test_uniform(&seed, 0.0, 1.0);
            cell[axis] = (int)(u[axis] * n[axis]);
        }
        const struct neph_vec3 p = {box->min_m.x + u[0] * (box->max_m.x - box->min_m.x),
                                    box->min_m.y + u[1] * (box->max_m.y - box->min_m.y),
                                    box->min_m.z + u[2] * (box->max_m.z - box->min_m.z)};
        const double majorant =
            (double)majorants->extinction_per_m[(cell[2] * n[1] + cell[1]) * n[0] + cell[0]];
        const double extinction = neph_medium_extinction_per_m(medium, p);
        assert_true(extinction <= majorant);
        used = fmax(used, majorant > 0.0 ? extinction / majorant : 0.0);
    }
    assert_true(used > 0.5); /* a tight bound */
    neph_majorants_destroy(majorants);
}

static void test_majorants(void **state)
{
    const struct neph_bounds box = {{-4, -2, -3}, {4, 5, 8}};
    struct neph_medium medium = voxels(8);
    check_majorants(&medium, &box, 1);
    neph_grid_destroy(medium.grid);
    medium = make_blob(0.7, (struct neph_vec3){0.3, 1.0, 2.0}, 1.5);
    check_majorants(&medium, &box, 2);
    medium = planet(20.0, 2.0);
    check_majorants(&medium, &box, 3);
    medium = (struct neph_medium){.kind = NEPH_MEDIUM_HEIGHT_FOG,
                                  .bounds = everywhere,
                                  .layer_count = 1,
                                  .layers = {{0.3, 0.5, 1.0}}};
    check_majorants(&medium, &box, 4);
    struct neph_majorants *majorants = NULL;
    struct neph_diag diag = {0};
    assert_int_equal(neph_majorants_create(&medium, &everywhere, 8, &majorants, &diag),
                     NEPH_ERR_UNSUPPORTED);
}

static void test_bad_grids(void **state)
{
    const struct neph_vec3 o = {0, 0, 0}, one = {1, 1, 1}, flat = {1, 0, 1}, bad = {1, NAN, 1};
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    assert_int_equal(neph_grid_create((const int[3]){0, 4, 4}, o, one, &grid, &diag),
                     NEPH_ERR_INPUT);
    assert_int_equal(neph_grid_create((const int[3]){1024, 1024, 1024}, o, one, &grid, &diag),
                     NEPH_ERR_INPUT);
    assert_int_equal(neph_grid_create((const int[3]){2, 2, 2}, o, flat, &grid, &diag),
                     NEPH_ERR_INPUT);
    assert_int_equal(neph_grid_create((const int[3]){2, 2, 2}, bad, one, &grid, &diag),
                     NEPH_ERR_INPUT);
    neph_assert_ok(neph_grid_create((const int[3]){2, 2, 2}, o, one, &grid, &diag), &diag);
    grid->values[5] = -1.0f;
    assert_int_equal(neph_grid_seal(grid, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "(1, 0, 1)"));
    neph_grid_destroy(grid);
}

#include "tests/main.h"
