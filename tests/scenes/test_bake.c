/* SPDX-License-Identifier: MIT
 *
 * Baking: exact where it must be, an error with the order of trilinear interpolation, and a
 * reported error that an independent measurement confirms.
 */
#include "tests/scene_builders.h"

#include "scenes/bake.h"
#include "scenes/media.h"

static const struct neph_bounds unit_box = {{-1, -1, -1}, {1, 1, 1}};
static struct neph_medium make_bounded_medium(enum neph_medium_kind kind, struct neph_bounds bounds)
{
    return (struct neph_medium){.kind = kind,
                                .bounds = bounds,
                                .extinction_color = {1, 1, 1},
                                .albedo = {1, 0.5, 0.25},
                                .phase = {NEPH_PHASE_HENYEY_GREENSTEIN, 0.5}};
}

static struct neph_medium homogeneous(void)
{
    struct neph_medium medium = make_bounded_medium(NEPH_MEDIUM_HOMOGENEOUS, unit_box);
    medium.layer_count = 1;
    medium.layers[0].extinction_per_m = 0.7;
    return medium;
}

static struct neph_medium blob(void)
{
    struct neph_medium medium = make_bounded_medium(NEPH_MEDIUM_GAUSSIAN, everywhere);
    medium.extinction_per_m = 2.0;
    medium.gaussian = (struct neph_gaussian){{0.1, -0.2, 0.3}, 0.4};
    return medium;
}

static struct neph_bake bake(const struct neph_medium *medium, const struct neph_bounds *box,
                             int resolution)
{
    struct neph_bake made;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_medium_bake(medium, box, resolution, &made, &diag), &diag);
    return made;
}

static void test_lattice_and_nodes(void **state)
{
    const struct neph_medium medium = blob();
    const struct neph_bounds box = {{-1, -0.5, 0}, {1.5, 0.75, 0.5}};
    struct neph_bake made = bake(&medium, &box, 50);
    const struct neph_grid *grid = made.grid;
    const int size[3] = {50, 25, 10};
    assert_memory_equal(grid->size, size, sizeof(size));
    neph_assert_close(grid->origin_m.x, -0.975, 1e-15, 0);
    neph_assert_close(grid->spacing_m.z, 0.05, 1e-15, 0);
    assert_float_equal(made.extinction_per_m, 2.0, 0);
    assert_false(made.is_copy);
    for (int k = 0; k < size[2]; k++) {
        const struct neph_vec3 point_m = {grid->origin_m.x + 20 * grid->spacing_m.x,
                                          grid->origin_m.y + 7 * grid->spacing_m.y,
                                          grid->origin_m.z + k * grid->spacing_m.z};
        const double expected = neph_medium_extinction_per_m(&medium, point_m) / 2.0;
        assert_float_equal(grid->values[(k * size[1] + 7) * size[0] + 20], (float)expected, 0);
    }
    neph_bake_finish(&made);
}

/* Below 1e-5 of the maximum there are no nodes, and the resulting error is measured. */
static void test_thin_margins_are_trimmed(void **state)
{
    const struct neph_medium medium = blob();
    const struct neph_bounds box = neph_medium_support(&medium);
    struct neph_bake made = bake(&medium, &box, 64);
    const double side_m = made.grid->size[0] * made.grid->spacing_m.x;
    neph_assert_close(side_m, 2.0 * 0.4 * sqrt(2.0 * log(1e5)), 1e-5, 0);
    assert_true(made.error.optical_depth_max > 0.0);
    neph_bake_finish(&made);
}

/* Perpendicular to a sharp face, the grid's ramp compensates the half cell in front of it. */
static void test_sharp_faces_cost_no_optical_depth(void **state)
{
    const struct neph_medium medium = homogeneous();
    struct neph_bake made = bake(&medium, &unit_box, 7);
    const struct neph_medium baked = neph_medium_from_bake(&medium, &made);
    const struct neph_vec3 origin_m = {0.1, 0.2, -9}, along_z = {0, 0, 1};
    neph_assert_close(neph_medium_optical_depth(&baked, origin_m, along_z, 0.0, INFINITY), 1.4,
                      1e-7, 0); /* values are floats */
    assert_memory_equal(&baked.albedo, &medium.albedo, sizeof(medium.albedo));
    neph_bake_finish(&made);
}

/* Trilinear interpolation of a smooth density: error ~ spacing^2. */
static void test_error_is_of_second_order(void **state)
{
    const struct neph_medium medium = blob();
    const struct neph_bounds box = neph_medium_support(&medium);
    struct neph_bake coarse = bake(&medium, &box, 60), fine = bake(&medium, &box, 120);
    const struct neph_bake_error *a = &coarse.error, *b = &fine.error;
    neph_assert_close(a->extinction_rms_relative / b->extinction_rms_relative, 4.0, 0.1, 0);
    neph_assert_close(a->optical_depth_rms / b->optical_depth_rms, 4.0, 0.1, 0);
    /* At the maximum, in the middle of a cell: 3 h^2 / 8 of the curvature 1 / width^2. */
    const double h = coarse.grid->spacing_m.x / medium.gaussian.width_m;
    assert_true(a->extinction_max_relative < 1.01 * 3.0 * h * h / 8.0);
    assert_true(a->extinction_max_relative > 0.5 * 3.0 * h * h / 8.0);
    neph_bake_finish(&coarse);
    neph_bake_finish(&fine);
}

/* Drawn in proportion to the extinction, which is at most 2/m. */
static struct neph_vec3 dense_place_in(const struct neph_bounds *box,
                                       const struct neph_medium *medium, uint64_t *seed)
{
    struct neph_vec3 place_m;
    do
        place_m = random_place_in(box, seed);
    while (neph_test_uniform(seed, 0, 2) >= neph_medium_extinction_per_m(medium, place_m));
    return place_m;
}

/* Other chords of the same kind. 10 %: four standard errors of the rms of this number, from trials
 * with several seeds. */
static void test_error_equals_independent_chords(void **state)
{
    enum { CHORDS = 20000 };
    const struct neph_bounds box = {{-1.3, -1.2, -1}, {1, 1.1, 1.2}}; /* cuts the blob off */
    struct neph_medium medium = blob();
    medium.bounds = box;
    struct neph_bake made = bake(&medium, &box, 24);
    const struct neph_medium baked = neph_medium_from_bake(&medium, &made);
    double squares = 0.0;
    uint64_t seed = 5;
    for (int i = 0; i < CHORDS; i++) {
        const struct neph_vec3 a_m = dense_place_in(&baked.bounds, &medium, &seed);
        const struct neph_vec3 b_m = random_place_in(&baked.bounds, &seed);
        const struct neph_vec3 d = neph_vec3_normalize(neph_vec3_sub(b_m, a_m));
        const struct neph_vec3 start_m = neph_vec3_along(a_m, d, -10.0);
        squares += pow(neph_medium_optical_depth(&baked, start_m, d, 0.0, INFINITY) -
                           neph_medium_optical_depth(&medium, start_m, d, 0.0, INFINITY),
                       2.0);
    }
    neph_assert_close(made.error.optical_depth_rms, sqrt(squares / CHORDS), 0.1, 0);
    neph_bake_finish(&made);
}

static struct neph_medium grid_medium(struct neph_grid **grid)
{
    const int size[3] = {3, 4, 5};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_grid_create(size, (struct neph_vec3){0, 0, 0}, (struct neph_vec3){1, 1, 1},
                                    grid, &diag),
                   &diag);
    for (int n = 0; n < 60; n++)
        (*grid)->values[n] = (float)(n % 7);
    neph_assert_ok(neph_grid_seal(*grid, &diag), &diag);
    struct neph_medium medium = make_bounded_medium(NEPH_MEDIUM_GRID, everywhere);
    medium.grid = *grid;
    medium.extinction_per_m = 0.5;
    return medium;
}

static void test_whole_grids_are_copied(void **state)
{
    struct neph_grid *grid = NULL;
    struct neph_medium medium = grid_medium(&grid);
    const struct neph_bounds support = neph_medium_support(&medium);
    struct neph_bake made = bake(&medium, &support, 0);
    assert_true(made.is_copy);
    assert_string_equal(made.grid->hash, grid->hash);
    assert_float_equal(made.extinction_per_m, 0.5, 0);
    assert_float_equal(made.error.extinction_max_relative, 0.0, 0);
    neph_bake_finish(&made);

    medium.bounds.max_m.y = 3.5; /* cut: the medium has changed */
    assert_false(neph_medium_is_whole_grid(&medium));
    const struct neph_bounds box = neph_medium_support(&medium);
    made = bake(&medium, &box, 0);
    assert_false(made.is_copy);
    assert_true(made.error.extinction_max_relative > 0.0);
    neph_bake_finish(&made);
    neph_grid_destroy(grid);
}

static void test_unbakeable_media(void **state)
{
    const struct neph_medium medium = blob();
    const struct neph_bounds flat = {{0, 0, 0}, {1, 0, 1}};
    const struct {
        struct neph_bounds box;
        int resolution;
        const char *words;
    } cases[] = {
        {everywhere, 64, "no end"},  {flat, 64, "exclude the whole"}, {unit_box, 1, "2..1024"},
        {unit_box, 1025, "2..1024"}, {unit_box, 1000, "MiB"},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_bake made = {.grid = NULL};
        struct neph_diag diag = {0};
        assert_int_equal(
            neph_medium_bake(&medium, &cases[i].box, cases[i].resolution, &made, &diag),
            NEPH_ERR_INPUT);
        assert_non_null(strstr(diag.message, cases[i].words));
        assert_null(made.grid);
    }
}

#include "tests/main.h"
