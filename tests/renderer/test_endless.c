/* SPDX-License-Identifier: MIT
 *
 * Endless clouds: their frames equal the frames of many copies. (The I3RC step cloud is compared
 * with an independent Monte Carlo in neph physics.)
 */
#include "tests/renderer/frames.h"

#include "scenes/grid.h"

/* A grid of `count` nodes along x, in `copies` side by side around the world's origin and in 64
 * rows along z; 0: endless along both. Its bounds cut it above and below, between two equal
 * nodes. */
static struct neph_grid *make_columns(const double *values, int count, double spacing_m,
                                      double high_m, int copies)
{
    const int times = copies > 0 ? copies : 1, size[3] = {count * times, 2, copies > 0 ? 64 : 1};
    const struct neph_vec3 origin_m = {-spacing_m * count * (times / 2), 0.0,
                                       copies > 0 ? -32.0 * high_m : 0.0};
    struct neph_grid *grid = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_grid_create(size, origin_m, (struct neph_vec3){spacing_m, high_m, high_m},
                                    &grid, &diag),
                   &diag);
    const int nodes = size[0] * size[1] * size[2];
    for (int i = 0; i < nodes; i++)
        grid->values[i] = (float)values[i % size[0] % count];
    grid->is_endless[0] = grid->is_endless[2] = copies == 0;
    neph_assert_ok(neph_grid_seal(grid, &diag), &diag);
    return grid;
}

static void set_stage(struct test_scene *test, struct neph_grid *grid, double high_m)
{
    test_scene_init(test);
    test->key.position_m = (struct neph_vec3){130.0, 900.0, 20.0};
    test->key.look_at_m = (struct neph_vec3){260.0, 0.0, -350.0};
    struct neph_medium *cloud = test_add_cloud(test, NEPH_MEDIUM_GRID, 1.0);
    cloud->grid = grid;
    cloud->albedo = white;
    cloud->bounds = (struct neph_bounds){{-1e6, 0.0, -1e6}, {1e6, high_m, 1e6}};
    test->scene.scattering = NEPH_SCATTERING_SINGLE;
}

enum { WIDTH = 24, HEIGHT = 16, PIXELS = WIDTH * HEIGHT };

static const double columns[8] = {0.002, 0.004, 0.011, 0.02, 0.018, 0.0, 0.0, 0.001};

static struct neph_image *march(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                enum neph_march_mode mode)
{
    const struct neph_march_params params = {.width_px = WIDTH,
                                             .height_px = HEIGHT,
                                             .steps = 64,
                                             .transmittance = mode,
                                             .sun = mode,
                                             .sun_steps = 16,
                                             .shortcuts = {.skip = mode == NEPH_MARCH_MARCHED}};
    return test_march(vulkan, scene, &params, NULL);
}

/* 40 copies suffice where nothing beyond them is visible and sunlight does not cross more. */
static void test_a_march_sees_no_end(void **state)
{
    static const enum neph_march_mode modes[] = {NEPH_MARCH_EXACT, NEPH_MARCH_MARCHED};
    for (int n = 0; n < 2; n++) {
        struct test_scene endless, finite;
        OWNED(grid)
        struct neph_grid *all = make_columns(columns, 8, 50.0, 200.0, 0),
                         *some = make_columns(columns, 8, 50.0, 200.0, 40);
        set_stage(&endless, all, 200.0);
        set_stage(&finite, some, 200.0);
        OWNED(image)
        struct neph_image *a = march(*state, &endless.scene, modes[n]),
                          *b = march(*state, &finite.scene, modes[n]);
        const double off = test_distance(a, b, "G"),
                     through_off = test_distance(a, b, "transmittance.G");
        print_message("%s: radiance %.2g, transmittance %.2g\n", n ? "marched" : "exact", off,
                      through_off);
        assert_true(off < 2e-5);
        assert_true(through_off < 2e-5);
    }
}

/* Single scattering in double precision: the ray marcher's closed forms agree, and a long ray has
 * met the optical depth of as many copies. */
static void test_exact_sees_no_end(void **state)
{
    struct test_scene endless, finite;
    OWNED(grid)
    struct neph_grid *all = make_columns(columns, 8, 50.0, 200.0, 0),
                     *some = make_columns(columns, 8, 50.0, 200.0, 40);
    set_stage(&endless, all, 200.0);
    set_stage(&finite, some, 200.0);
    for (int i = 0; i < PIXELS; i += neph_test_by_day(37, 5)) {
        const struct neph_ray_light a = test_exact_ray(&endless.scene, WIDTH, HEIGHT, i),
                                    b = test_exact_ray(&finite.scene, WIDTH, HEIGHT, i);
        neph_assert_close(a.volume.g, b.volume.g, 1e-7, 1e-9);
        neph_assert_close(a.transmittance.g, b.transmittance.g, 1e-9, 1e-12);
    }
}

/* Methods that need a box around all shapes refuse an endless one, with a reason. */
static void test_tables_refuse(void **state)
{
    struct test_scene test;
    OWNED(grid) struct neph_grid *all = make_columns(columns, 8, 50.0, 200.0, 0);
    set_stage(&test, all, 200.0);
    const struct neph_march_params params = {
        .width_px = 8,
        .height_px = 8,
        .steps = 8,
        .shortcuts = {.sun_cache = true, .sun_cache_voxels = 16, .sun_cache_frames = 1}};
    struct neph_march *made = NULL;
    struct neph_diag diag = {0};
    assert_int_equal(neph_march_create(*state, &test.scene, &params, &made, &diag),
                     NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "sun_cache=grid"));
    assert_non_null(strstr(diag.message, "without end"));
}

/* ---- the step cloud of I3RC ------------------------------------------------------------------ */

enum { NODES = 32, ACROSS = 128, DEEP = 2, SEEN = ACROSS * DEEP };

static const double period_m = 500.0, high_m = 250.0;

/* Half a period of optical depth 2, half of 18; a step is a ramp between two nodes. `copies` as in
 * make_columns(). */
static struct neph_grid *make_step_cloud(int copies)
{
    double values[NODES];
    for (int i = 0; i < NODES; i++)
        values[i] = (i < NODES / 2 ? 2.0 : 18.0) / high_m;
    return make_columns(values, NODES, period_m / NODES, high_m, copies);
}

/* View straight down on one period, from half a node before the first: halves of the period are
 * halves of the frame. All orders, sun 60 degrees from the zenith, sunlight towards -x. */
static struct neph_image *trace_step_cloud(struct neph_vulkan *vulkan, int copies, int samples)
{
    OWNED(grid) struct neph_grid *grid = make_step_cloud(copies);
    struct test_scene test;
    set_stage(&test, grid, high_m);
    struct neph_scene *scene = &test.scene;
    scene->scattering = NEPH_SCATTERING_MULTIPLE;
    scene->media[0].phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.85};
    scene->sun.direction = (struct neph_vec3){sqrt(0.75), 0.5, 0.0};
    scene->sun.irradiance_w_per_m2 = white;
    scene->background_w_per_m2_sr = make_grey(0.0);
    scene->orthographic_height_m = period_m * DEEP / ACROSS;
    scene->camera_up = (struct neph_vec3){0.0, 0.0, -1.0};
    const double middle_m = 0.5 * period_m - 0.5 * period_m / NODES;
    test.key.position_m = (struct neph_vec3){middle_m, 1000.0, 0.0};
    test.key.look_at_m = (struct neph_vec3){middle_m, 0.0, 0.0};
    const struct neph_tracer_params params = test_samples(ACROSS, DEEP, 11, samples);
    return test_trace(vulkan, scene, &params, NULL);
}

static double half_mean(const struct neph_image *image, int half)
{
    const float *g = neph_image_channel(image, "G");
    double sum = 0.0;
    for (int i = 0; i < SEEN; i++)
        if (i % ACROSS / (ACROSS / 2) == half)
            sum += (double)g[i] / (SEEN / 2);
    return sum;
}

/* The same random numbers give the same paths as in 30 periods and 64 rows, except for the few
 * paths that leave these. */
static void test_paths_see_no_end(void **state)
{
    const int samples = neph_test_by_day(16, 256);
    OWNED(image)
    struct neph_image *endless = trace_step_cloud(*state, 0, samples),
                      *finite = trace_step_cloud(*state, 30, samples);
    for (int half = 0; half < 2; half++) {
        const double a = half_mean(endless, half), b = half_mean(finite, half);
        print_message("%s half: %.5f, of 30 periods %.5f\n", half ? "thick" : "thin", a, b);
        neph_assert_close(a, b, 2e-3, 0.0);
    }
}

/* ---- constant cells -------------------------------------------------------------------------- */

/* Cells of `columns`, cut off half a node beyond them, or endless. */
static struct neph_grid *make_cells(bool is_endless)
{
    struct neph_grid *grid = make_columns(columns, 8, 50.0, 100.0, is_endless ? 0 : 3);
    struct neph_diag diag = {0};
    grid->is_constant = true;
    neph_assert_ok(neph_grid_seal(grid, &diag), &diag);
    return grid;
}

/* The ray marcher's exact integrals in float32 against those in double precision, with and without
 * an end. */
static void test_constant_cells_are_those_of_the_truth(void **state)
{
    for (int is_endless = 0; is_endless < 2; is_endless++) {
        struct test_scene test;
        OWNED(grid) struct neph_grid *grid = make_cells(is_endless);
        set_stage(&test, grid, 150.0);
        test.scene.media[0].bounds.min_m.y = -50.0;
        OWNED(image) struct neph_image *image = march(*state, &test.scene, NEPH_MARCH_EXACT);
        const float *through = neph_image_channel(image, "transmittance.G");
        for (int i = 0; i < PIXELS; i += neph_test_by_day(17, 3)) {
            const struct neph_ray_light truth = test_exact_ray(&test.scene, WIDTH, HEIGHT, i);
            neph_assert_close((double)through[i], truth.transmittance.g, 0.0, 2e-4);
        }
    }
}

/* Light on the device and by the oracle's inversion cell by cell: means within four standard
 * errors, which are below 5 %. */
static void compare_paths(struct neph_vulkan *vulkan, bool is_endless)
{
    const int samples = neph_test_by_day(128, 4096);
    struct test_scene test;
    OWNED(grid) struct neph_grid *grid = make_cells(is_endless);
    set_stage(&test, grid, 150.0);
    test.scene.media[0].bounds.min_m.y = -50.0;
    test.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    const struct neph_tracer_params params = test_samples(8, 6, 3, samples);
    OWNED(image)
    struct neph_image *image = test_trace(vulkan, &test.scene, &params, NULL),
                      *truth = test_oracle(&test.scene, 8, 6, 3, samples);
    const float *a = neph_image_channel(image, "G"), *b = neph_image_channel(truth, "G"),
                *va = neph_image_channel(image, "variance.G"),
                *vb = neph_image_channel(truth, "variance.G");
    double off = 0.0, variance = 0.0, sum = 0.0;
    for (int i = 0; i < 48; i++) {
        off += (double)a[i] - (double)b[i];
        variance += (double)va[i] + (double)vb[i];
        sum += (double)b[i];
    }
    print_message("mean %.4f, off by %.2g, standard error %.2g\n", sum / 48, off / 48,
                  sqrt(variance) / 48);
    assert_true(fabs(off) < 4.0 * sqrt(variance));
    assert_true(sqrt(variance) < 0.05 * sum);
}

static void test_paths_through_constant_cells(void **state)
{
    compare_paths(*state, true);
    compare_paths(*state, false); /* walks the view ray first (shaders/tracer_way.glsl) */
}

/* A view of the caller's rays that are the camera's is the camera's view. */
static void test_own_rays_replace_the_camera(void **state)
{
    struct test_scene test;
    OWNED(grid) struct neph_grid *grid = make_cells(true);
    set_stage(&test, grid, 150.0);
    test.scene.vertical_fov_rad = 0.0;
    test.scene.orthographic_height_m = 300.0;
    test.scene.scattering = NEPH_SCATTERING_MULTIPLE;
    struct neph_tracer_params params = test_samples(8, 6, 5, 16);
    OWNED(image) struct neph_image *seen = test_trace(*state, &test.scene, &params, NULL);
    const struct neph_camera camera = neph_scene_camera(&test.scene, 0.0);
    double rays[48][6];
    for (int i = 0; i < 48; i++) {
        const struct neph_pixel_ray ray = neph_camera_ray(&camera, 8, 6, i % 8, i / 8);
        const double own[6] = {ray.origin_m.x,  ray.origin_m.y,  ray.origin_m.z,
                               ray.direction.x, ray.direction.y, ray.direction.z};
        memcpy(rays[i], own, sizeof(own));
    }
    params.rays = rays[0];
    OWNED(image) struct neph_image *own = test_trace(*state, &test.scene, &params, NULL);
    assert_true(test_distance(seen, own, "transmittance.G") < 1e-4);
    /* The same random numbers, from origins that differ by rounding. */
    assert_true(test_distance(seen, own, "G") < 0.05);
}

#include "tests/renderer/main.h"
