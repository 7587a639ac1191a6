/* SPDX-License-Identifier: MIT
 *
 * The shadow map of clouds: on the ground, compared with closed forms and with its CPU reference,
 * which interpolates in double; in fog between clouds; and its stability while sun, wind and camera
 * move.
 */
#include "tests/renderer/frames.h"

#include "renderer/cloud_shadow.h"
#include "scenes/bounds.h"
#include "scenes/media.h"
#include "scenes/motion.h"

enum { SIDE_PX = 48, PIXELS = SIDE_PX * SIDE_PX };

static const double ground_m = -2.0;

/* --- the ground ------------------------------------------------------------------------------ */

/* An orthographic view from above, below all clouds: a pixel is a point of the ground, without
 * media in between. */
static void look_down(struct test_scene *test, double side_m)
{
    test_scene_init(test);
    test->key.look_at_m = (struct neph_vec3){0.0, ground_m, 0.0};
    test->scene.camera_up = (struct neph_vec3){0.0, 0.0, -1.0};
    test->scene.vertical_fov_rad = 0.0;
    test->scene.orthographic_height_m = side_m;
    test_add_box(test, (struct neph_vec3){-1e3, ground_m - 1.0, -1e3},
                 (struct neph_vec3){1e3, ground_m, 1e3});
}

static struct neph_vec3 pixel_ground_point(const struct test_scene *test, int pixel)
{
    const double pixel_m = test->scene.orthographic_height_m / SIDE_PX;
    const double column = pixel % SIDE_PX + 0.5, row = pixel / SIDE_PX + 0.5;
    return (struct neph_vec3){test->key.position_m.x + (column - 0.5 * SIDE_PX) * pixel_m, ground_m,
                              test->key.position_m.z + (row - 0.5 * SIDE_PX) * pixel_m};
}

static struct neph_march_params mapped(int texels, int layers)
{
    return (struct neph_march_params){
        .width_px = SIDE_PX,
        .height_px = SIDE_PX,
        .steps = 1,
        .sun_steps = 64,
        .shortcuts = {.cloud_shadow = true,
                      .shadow = {.texels = texels, .layers = layers, .levels = 1}}};
}

/* Sunlight on the ground in channel c, relative to the sun's. */
static void measure(struct neph_vulkan *vulkan, const struct test_scene *test,
                    const struct neph_march_params *params, int c, double through[PIXELS])
{
    static const char *const names[3] = {"R", "G", "B"};
    const double sun[3] = {10.0, 9.0, 8.0}, albedo[3] = {0.5, 0.4, 0.3};
    const double full = sun[c] * albedo[c] / M_PI * test->scene.sun.direction.y;
    OWNED(image) struct neph_image *image = test_march(vulkan, &test->scene, params, NULL);
    for (int p = 0; p < PIXELS; p++)
        through[p] = (double)neph_image_channel(image, names[c])[p] / full;
}

static double compute_optical_depth(const struct neph_scene *scene, struct neph_vec3 point_m, int c)
{
    const struct neph_rgb depth = neph_scene_optical_depth(scene, point_m, scene->sun.direction,
                                                           0.0, 1e5);
    return c == 0 ? depth.r : c == 1 ? depth.g : depth.b;
}

/* Largest and mean difference of all pixels. */
struct difference {
    double largest, mean;
};

static struct difference against_truth(const struct test_scene *test, int c,
                                       const double through[PIXELS])
{
    struct difference off = {0.0, 0.0};
    for (int p = 0; p < PIXELS; p++) {
        const double truth = exp(
            -compute_optical_depth(&test->scene, pixel_ground_point(test, p), c));
        off.largest = fmax(off.largest, fabs(through[p] - truth));
        off.mean += fabs(through[p] - truth) / PIXELS;
    }
    return off;
}

/* --- the CPU reference: closed forms at the texels, interpolated transmittance ---------------- */

static double texel_through(const struct neph_shadow_space *space, const struct neph_scene *scene,
                            int level, const double texel[2], int c)
{
    struct neph_vec3 point_m = neph_vec3_along(space->origin_m, scene->sun.direction,
                                               space->start_m);
    for (int axis = 0; axis < 2; axis++)
        point_m = neph_vec3_along(point_m, space->side[axis],
                                  space->levels[level].low_m[axis] +
                                      texel[axis] * space->levels[level].texel_m[axis]);
    return exp(-compute_optical_depth(scene, point_m, c));
}

/* Below all clouds, in the finest level that contains the point. */
static double reference_through(const struct neph_shadow_space *space,
                                const struct neph_shadow_map *map, const struct neph_scene *scene,
                                struct neph_vec3 point_m, int c)
{
    for (int level = 0; level < map->levels; level++) {
        double place[2], low[2], sum = 0.0;
        for (int axis = 0; axis < 2; axis++) {
            const double at_m = neph_vec3_dot(neph_vec3_sub(point_m, space->origin_m),
                                              space->across[axis]);
            place[axis] = (at_m - space->levels[level].low_m[axis]) /
                          space->levels[level].texel_m[axis];
            low[axis] = floor(place[axis]);
        }
        if (place[0] < 0.0 || place[1] < 0.0 || place[0] > map->texels - 1 ||
            place[1] > map->texels - 1)
            continue;
        for (int corner = 0; corner < 4; corner++) {
            const int step[2] = {corner & 1, corner >> 1};
            double weight = 1.0, texel[2];
            for (int axis = 0; axis < 2; axis++) {
                weight *= step[axis] ? place[axis] - low[axis] : 1.0 - place[axis] + low[axis];
                texel[axis] = low[axis] + step[axis];
            }
            sum += weight * texel_through(space, scene, level, texel, c);
        }
        return sum;
    }
    return exp(-compute_optical_depth(scene, point_m, c));
}

static void check_reference(struct neph_vulkan *vulkan, const struct test_scene *test,
                            const struct neph_shadow_map *map, const char *what)
{
    struct neph_march_params params = mapped(map->texels, 1);
    double through[PIXELS], largest = 0.0, from_truth = 0.0;
    params.shortcuts.shadow = *map;
    const struct neph_shadow_space space = neph_shadow_space_compute(map, &test->scene,
                                                                     test->key.position_m);
    measure(vulkan, test, &params, 1, through);
    for (int p = 0; p < PIXELS; p++) {
        const struct neph_vec3 point_m = pixel_ground_point(test, p);
        const double reference = reference_through(&space, map, &test->scene, point_m, 1);
        largest = fmax(largest, fabs(through[p] - reference));
        from_truth = fmax(from_truth,
                          fabs(reference - exp(-compute_optical_depth(&test->scene, point_m, 1))));
    }
    print_message("%s: off the reference by %.1e, which is off the truth by %.1e\n", what, largest,
                  from_truth);
    /* A position of some 30 m has a rounding error of 2e-6 m in float32. On a texel of a tenth of a
     * metre this is 2e-5 of the difference between two texels. */
    assert_true(largest < 3e-5);
    assert_true(from_truth > 100.0 * largest);
}

/* --- clouds ---------------------------------------------------------------------------------- */

static const double blob_per_m = 0.8, blob_width_m = 2.0;

static void add_blob(struct test_scene *test, struct neph_vec3 at_m)
{
    struct neph_medium *blob = test_add_cloud(test, NEPH_MEDIUM_GAUSSIAN, blob_per_m);
    const struct neph_vec3 reach_m = {9.0, 9.0, 9.0};
    blob->gaussian = (struct neph_gaussian){at_m, blob_width_m};
    blob->bounds = (struct neph_bounds){neph_vec3_sub(at_m, reach_m), neph_vec3_add(at_m, reach_m)};
}

static void test_the_shader_equals_the_reference(void **state)
{
    struct test_scene test;
    look_down(&test, 40.0);
    add_blob(&test, (struct neph_vec3){8.0, 14.0, -9.0});
    add_blob(&test, (struct neph_vec3){13.0, 18.0, -14.0});
    test.scene.media[0].extinction_color = (struct neph_rgb){1.0, 0.6, 0.2};
    struct neph_shadow_map map = {.texels = 64, .layers = 1, .levels = 1};
    check_reference(*state, &test, &map, "a level plane");
    map.plane = NEPH_SHADOW_SUN;
    check_reference(*state, &test, &map, "across the sun");
    map = (struct neph_shadow_map){.texels = 64, .layers = 3, .levels = 3};
    check_reference(*state, &test, &map, "three maps");
    map = (struct neph_shadow_map){.texels = 32, .layers = 1, .levels = 2, .extent_m = 20.0};
    check_reference(*state, &test, &map, "around the camera");
}

/* Bound of the interpolation error at a texel spacing h: h^2 / 8 times the second derivatives of
 * the transmittance T = e^-tau along both sides. On a plane perpendicular to the sun ray tau is a
 * Gaussian of width w with a maximum of at most s w sqrt(2 pi). A second derivative of e^-tau is at
 * most (tau' ^ 2 + |tau''|) e^-tau. With u = (r/w)^2 this is tau (u tau + |u - 1|) e^-tau / w^2.
 * Its maximum is at the rim of the shadow and is found numerically. */
static double blob_bound(double spacing_m)
{
    const double middle = blob_per_m * blob_width_m * sqrt(2.0 * M_PI);
    double largest = 0.0;
    for (double u = 0.0; u < 30.0; u += 1e-3) {
        const double depth = middle * exp(-0.5 * u);
        largest = fmax(largest, depth * (u * depth + fabs(u - 1.0)) * exp(-depth));
    }
    return spacing_m * spacing_m / 8.0 * 2.0 * largest / (blob_width_m * blob_width_m);
}

static void test_a_blob_is_of_second_order(void **state)
{
    struct test_scene test;
    double through[PIXELS], before = INFINITY;
    look_down(&test, 24.0);
    test.scene.sun.direction = (struct neph_vec3){0.0, 1.0, 0.0};
    add_blob(&test, (struct neph_vec3){1.0, 14.0, -2.0});
    for (int texels = 16; texels <= 128; texels *= 2) {
        struct neph_march_params params = mapped(texels, 1);
        const struct neph_shadow_space space = neph_shadow_space_compute(
            &params.shortcuts.shadow, &test.scene, test.key.position_m);
        measure(*state, &test, &params, 0, through);
        const struct difference off = against_truth(&test, 0, through);
        const double bound = blob_bound(space.levels[0].texel_m[0]);
        print_message("%d texels: off by %.2e, at most %.2e; mean %.1e\n", texels, off.largest,
                      bound, off.mean);
        assert_true(off.largest < bound && off.largest > 0.02 * bound);
        assert_true(off.largest < before / 2.5); /* 4, with texel sizes of eighths of octaves */
        before = off.largest;
    }
}

/* All texels have the same ray, so interpolation is exact. */
static void test_a_slab_is_exact(void **state)
{
    OWNED(media) struct test_scene test;
    uint64_t random = 1;
    double through[PIXELS];
    look_down(&test, 40.0);
    test_add_cloud(&test, NEPH_MEDIUM_GRID, 0.2)->grid = random_lattice(
        (const int[3]){3, 2, 3}, (struct neph_vec3){-200.0, 10.0, -200.0},
        (struct neph_vec3){200.0, 3.0, 200.0}, 1.0, &random);
    const struct neph_march_params params = mapped(64, 2);
    measure(*state, &test, &params, 0, through);
    /* Plus one half of each of the two adjacent cells, in which the density falls to 0. */
    const double truth = exp(-0.2 * (3.0 + 2.0 * 0.5 * 3.0) / test.scene.sun.direction.y);
    for (int p = 0; p < PIXELS; p++)
        assert_float_equal(through[p], truth, 2e-6);
}

/* A voxel cloud with empty and dense voxels: 512 texels, and the convergence to that. */
static void test_voxels_are_within_two_per_cent(void **state)
{
    OWNED(media) struct test_scene test;
    uint64_t random = 5;
    double through[PIXELS], sunlit = 0.0;
    look_down(&test, 40.0);
    test_add_cloud(&test, NEPH_MEDIUM_GRID, 1.5)->grid = random_lattice(
        (const int[3]){24, 6, 24}, (struct neph_vec3){0.0, 8.0, -28.0},
        (struct neph_vec3){1.2, 0.8, 1.2}, -2.0, &random);
    for (int p = 0; p < PIXELS; p++)
        sunlit += exp(-compute_optical_depth(&test.scene, pixel_ground_point(&test, p), 0)) /
                  PIXELS;
    assert_true(sunlit > 0.2 && sunlit < 0.8);
    double before = INFINITY;
    for (int texels = 64; texels <= 512; texels *= 8) {
        const struct neph_march_params params = mapped(texels, 1);
        measure(*state, &test, &params, 0, through);
        const struct difference off = against_truth(&test, 0, through);
        print_message("%d texels: mean error %.2e of a mean of %.2f, largest %.2e\n", texels,
                      off.mean, sunlit, off.largest);
        assert_true(off.mean < before / 8.0);
        before = off.mean;
    }
    assert_true(before < 0.02 * sunlit);
    if (neph_test_is_night()) { /* needs a kernel of its own, and one for the map */
        struct neph_march_params skipping = mapped(512, 1);
        double skipped[PIXELS];
        skipping.shortcuts.skip = true;
        measure(*state, &test, &skipping, 0, skipped);
        assert_memory_equal(skipped, through, sizeof(through));
    }
}

/* Position on a row of pixels at which half of the cloud's attenuation is reached [m]. */
static double middle_of_edge(const struct test_scene *test, const double through[PIXELS], int row)
{
    const double half = 0.5 * (through[row] + through[row + SIDE_PX - 1]);
    for (int p = row; p < row + SIDE_PX - 1; p++)
        if (through[p] <= half && through[p + 1] > half) {
            const double part = (half - through[p]) / (through[p + 1] - through[p]);
            const double from_m = pixel_ground_point(test, p).x,
                         to_m = pixel_ground_point(test, p + 1).x;
            return from_m + part * (to_m - from_m);
        }
    return INFINITY;
}

/* A cloud with a straight edge, cut by its bounds. The shadow's edge is within half a texel of it,
 * and one texel away the values are correct. */
static void test_edges_keep_their_place(void **state)
{
    struct test_scene test;
    double through[PIXELS];
    look_down(&test, 10.0);
    test.scene.sun.direction = neph_vec3_normalize((struct neph_vec3){0.0, 0.8, -0.6});
    struct neph_medium *cloud = test_add_cloud(&test, NEPH_MEDIUM_GAUSSIAN, 3.0);
    cloud->gaussian = (struct neph_gaussian){{0.0, 12.0, -10.0}, 20.0};
    for (double edge_m = -0.5; edge_m < 0.5; edge_m += 0.173) {
        cloud->bounds = (struct neph_bounds){{-15.3, 10.0, -30.0}, {edge_m, 14.0, 10.0}};
        const struct neph_march_params params = mapped(32, 1);
        const double texel_m = neph_shadow_space_compute(&params.shortcuts.shadow, &test.scene,
                                                         test.key.position_m)
                                   .levels[0]
                                   .texel_m[0];
        measure(*state, &test, &params, 0, through);
        const int row = SIDE_PX / 2 * SIDE_PX;
        const double off_texels = (middle_of_edge(&test, through, row) - edge_m) / texel_m;
        print_message("an edge at %.3f m is off by %.2f texels\n", edge_m, off_texels);
        assert_true(fabs(off_texels) <= 0.5 + 1e-3);
        for (int p = row; p < row + SIDE_PX; p++) {
            const double from_edge = (pixel_ground_point(&test, p).x - edge_m) / texel_m;
            const double truth = exp(
                -compute_optical_depth(&test.scene, pixel_ground_point(&test, p), 0));
            assert_true(fabs(from_edge) <= 1.5 || fabs(through[p] - truth) < 1e-4);
        }
    }
}

/* --- between clouds -------------------------------------------------------------------------- */

/* A frame with a map of so many layers; 0: without a map. */
static struct neph_image *between(struct neph_vulkan *vulkan, const struct neph_scene *scene,
                                  int layers)
{
    struct neph_march_params params = mapped(256, layers > 0 ? layers : 1);
    params.steps = 48;
    params.shortcuts.cloud_shadow = layers > 0;
    return test_march(vulkan, scene, &params, NULL);
}

/* Fog between two layers of clouds, and a tower through both. */
static void test_layers_give_depths_between_clouds(void **state)
{
    OWNED(media) struct test_scene test;
    uint64_t random = 21;
    test_scene_init(&test);
    for (int i = 0; i < 2; i++)
        test_add_cloud(&test, NEPH_MEDIUM_GRID, 0.6)->grid = random_lattice(
            (const int[3]){10, 3, 10}, (struct neph_vec3){-12.0, i == 0 ? -1.0 : 9.0, -30.0},
            (struct neph_vec3){2.0, 1.0, 2.0}, -1.5, &random);
    test_add_medium(&test, 0.02, 0.05, 0.0)->bounds = (struct neph_bounds){{-20.0, -4.0, -40.0},
                                                                           {20.0, 20.0, 0.0}};
    test_add_box(&test, (struct neph_vec3){-1.0, -4.0, -16.0},
                 (struct neph_vec3){1.0, 20.0, -14.0});
    OWNED(image)
    struct neph_image *truth = between(*state, &test.scene, 0),
                      *with_one = between(*state, &test.scene, 1),
                      *with_sixteen = between(*state, &test.scene, 16);
    const double one = test_distance(with_one, truth, "R");
    const double sixteen = test_distance(with_sixteen, truth, "R");
    print_message("one layer: off by %.2e; sixteen: %.2e\n", one, sixteen);
    assert_true(one > 2e-3 && sixteen < 0.2 * one);
}

/* A scene with fog only has no map, and its frames have the same bits. */
static void test_only_fog_keeps_the_bits(void **state)
{
    struct test_scene test;
    double through[2][PIXELS];
    look_down(&test, 20.0);
    test_add_medium(&test, 0.02, 0.05, 0.0);
    struct neph_march_params params = mapped(32, 1);
    measure(*state, &test, &params, 0, through[0]);
    params.shortcuts.cloud_shadow = false;
    measure(*state, &test, &params, 0, through[1]);
    assert_memory_equal(through[0], through[1], sizeof(through[0]));
}

/* --- stability -------------------------------------------------------------------------------- */

static bool is_whole(double value)
{
    return fabs(value - round(value)) < 1e-6;
}

/* Texels are the same columns of air for every camera and sun, and move with the wind. */
static void test_texels_stay_with_the_clouds(void **state)
{
    struct test_scene test;
    test_scene_init(&test);
    add_blob(&test, (struct neph_vec3){8.0, 14.0, -9.0});
    const struct neph_shadow_map map = {.texels = 64, .layers = 1, .levels = 2, .extent_m = 60.0};
    const struct neph_shadow_space here = neph_shadow_space_compute(&map, &test.scene,
                                                                    test.key.position_m);
    uint64_t random = 3;
    for (int i = 0; i < 200; i++) {
        struct test_scene moved = test;
        const struct neph_vec3 wind_m = random_point(&random, 30.0);
        moved.key.position_m = random_point(&random, 50.0);
        moved.scene.sun.direction = random_direction(&random);
        neph_medium_drift(&moved.scene.media[0], wind_m);
        if (fabs(moved.scene.sun.direction.y) < 0.02)
            continue;
        const struct neph_shadow_space there = neph_shadow_space_compute(&map, &moved.scene,
                                                                         moved.key.position_m);
        const struct neph_vec3 gone_m = neph_vec3_sub(there.origin_m, here.origin_m);
        assert_float_equal(neph_vec3_length(neph_vec3_sub(gone_m, wind_m)), 0.0, 1e-9);
        for (int level = 0; level < 2; level++)
            for (int axis = 0; axis < 2; axis++) {
                const double texel_m = there.levels[level].texel_m[axis];
                assert_float_equal(texel_m, here.levels[level].texel_m[axis], 0.0);
                assert_true(is_whole(there.levels[level].low_m[axis] / texel_m));
            }
    }
}

/* The map is placed by differences in double, so it is the same ten thousand kilometres away. */
static void test_far_from_the_origin_it_is_the_same(void **state)
{
    struct test_scene test;
    double here[PIXELS], there[PIXELS], largest = 0.0;
    const struct neph_vec3 far_m = {1e7, 0.0, -1e7};
    look_down(&test, 24.0);
    add_blob(&test, (struct neph_vec3){1.0, 14.0, -2.0});
    struct neph_march_params params = mapped(64, 1);
    params.shortcuts.shadow.levels = 2;
    measure(*state, &test, &params, 0, here);
    neph_medium_drift(&test.scene.media[0], far_m);
    test.solids[0].box = neph_bounds_translate(test.solids[0].box, far_m);
    test.key.position_m = neph_vec3_add(test.key.position_m, far_m);
    test.key.look_at_m = neph_vec3_add(test.key.look_at_m, far_m);
    measure(*state, &test, &params, 0, there);
    for (int p = 0; p < PIXELS; p++)
        largest = fmax(largest, fabs(here[p] - there[p]));
    print_message("1e7 m away: off by %.1e\n", largest);
    assert_true(largest < 1e-6); /* a double's rounding at that distance is 2e-9 m; then float32 */
}

/* A map of all clouds does not change while the sun moves by some degrees, so it need not be
 * refilled. It contains all clouds. */
static void test_a_map_of_all_clouds_stays(void **state)
{
    struct test_scene test;
    struct neph_shadow_level before = {.texel_m = {0.0, 0.0}};
    int changes = 0;
    test_scene_init(&test);
    add_blob(&test, (struct neph_vec3){8.0, 14.0, -9.0});
    const struct neph_shadow_map map = {.texels = 64, .layers = 1, .levels = 1};
    for (int tenths = 900; tenths >= 300; tenths--) {
        const double height_rad = tenths * M_PI / 1800.0;
        test.scene.sun.direction = (struct neph_vec3){cos(height_rad), sin(height_rad), 0.0};
        const struct neph_shadow_space space = neph_shadow_space_compute(&map, &test.scene,
                                                                         test.key.position_m);
        const struct neph_shadow_level *now = &space.levels[0];
        changes += memcmp(now, &before, sizeof(before)) != 0;
        before = *now;
        /* Half of the clouds' box, and the part that its height adds. */
        const double half_m = 9.0 +
                              9.0 * fabs(test.scene.sun.direction.x) / test.scene.sun.direction.y;
        assert_true(now->low_m[0] <= 9.0 - half_m + 1e-9);
        assert_true(now->low_m[0] + 63 * now->texel_m[0] >= 9.0 + half_m - 1e-9);
    }
    /* 1 + cot(30 degrees) is 1.45 octaves above 1: 12 changes, and the first map. */
    neph_assert_in_range(changes, 12, 13);
}

/* --- over several frames ---------------------------------------------------------------------- */

static bool same_radiance(const struct neph_image *a, const struct neph_image *b)
{
    const struct test_rgb one = test_layer(a, NULL), other = test_layer(b, NULL);
    bool same = true;
    for (int c = 0; c < 3; c++)
        same &= memcmp(one.of[c], other.of[c], neph_image_pixel_count(a) * sizeof(float)) == 0;
    return same;
}

/* The map is filled once; over four frames when the sun has moved; at once when the map has
 * changed. */
static void test_the_map_refills_over_frames(void **state)
{
    enum { PICTURES = 4 };
    struct test_scene test;
    struct neph_march_stats first, rest, stats;
    look_down(&test, 20.0);
    add_blob(&test, (struct neph_vec3){8.0, 14.0, -9.0});
    struct neph_march_params params = mapped(64, 1);
    params.shortcuts.shadow.extent_m = 60.0;
    params.shortcuts.shadow.frames = PICTURES;
    OWNED(march) struct neph_march *march = test_march_open(*state, &test.scene, &params);
    neph_image_destroy(test_march_next(march, &test.scene, &first));
    neph_image_destroy(test_march_next(march, &test.scene, &rest));
    assert_int_equal(first.closed_forms - rest.closed_forms, 64 * 64);
    for (int picture = -1; picture <= PICTURES; picture++) {
        if (picture == 0)
            test.scene.sun.direction = neph_vec3_normalize((struct neph_vec3){0.49, 0.7, -0.6});
        OWNED(image) struct neph_image *frame = test_march_next(march, &test.scene, &stats);
        OWNED(image) struct neph_image *fresh = test_march(*state, &test.scene, &params, NULL);
        const bool is_filling = picture >= 0 && picture < PICTURES;
        assert_int_equal(stats.closed_forms - rest.closed_forms,
                         is_filling ? 64 * 64 / PICTURES : 0);
        assert_true(same_radiance(frame, fresh) || (is_filling && picture < PICTURES - 1));
        assert_false(picture == 0 && same_radiance(frame, fresh));
    }
    test.key.position_m.x += 20.0;
    test.key.look_at_m.x += 20.0;
    neph_image_destroy(test_march_next(march, &test.scene, &stats));
    assert_int_equal(stats.closed_forms - rest.closed_forms, 64 * 64);
}

/* --- in real time ---------------------------------------------------------------------------- */

/* The background's light equals the ray marcher's bit by bit: by day of the full-resolution march,
 * at night of the split frame, because its kernels take seconds to compile. */
static void test_in_real_time_the_ground_is_the_same(void **state)
{
    struct test_scene test;
    struct neph_realtime_stats stats;
    struct neph_settings settings = test_preset(
        NULL, "cloud_shadow=map taa=off ray_dither=none upscale_dither=none "
              "cloud_shadow_texels=64 cloud_shadow_layers=2 cloud_shadow_levels=2 "
              "cloud_shadow_plane=sun steps=1 split=none");
    if (neph_test_is_night())
        settings.values[RT_SPLIT] = RT_SPLIT_FOUR;
    look_down(&test, 20.0);
    add_blob(&test, (struct neph_vec3){8.0, 14.0, -9.0});
    const struct neph_realtime_params params = {SIDE_PX, SIDE_PX, &settings, 7, NULL};
    OWNED(image) struct neph_image *image = test_film(*state, &test.scene, &params, 1, &stats);
    struct neph_march_params march = mapped(64, 2);
    march.shortcuts.shadow.levels = 2;
    march.shortcuts.shadow.plane = NEPH_SHADOW_SUN;
    OWNED(image) struct neph_image *marched = test_march(*state, &test.scene, &march, NULL);
    assert_true(same_radiance(image, marched));
    if (neph_test_is_night())
        assert_true(stats.shadow_gpu_s > 0.0 || isnan(stats.shadow_gpu_s));
}

/* --- refusals -------------------------------------------------------------------------------- */

static void test_values_out_of_range_are_refused(void **state)
{
    static const struct {
        struct neph_shadow_map map;
        const char *name;
    } cases[] = {{{15, 1, 1, 0.0, 0, 1}, "cloud_shadow_texels"},
                 {{64, 0, 1, 0.0, 0, 1}, "cloud_shadow_layers"},
                 {{64, 1, 5, 0.0, 0, 1}, "cloud_shadow_levels"},
                 {{64, 1, 1, -1.0, 0, 1}, "cloud_shadow_extent_m"},
                 {{64, 1, 1, 0.0, 0, 257}, "sun_cache_frames"}};
    struct test_scene test;
    look_down(&test, 20.0);
    add_blob(&test, (struct neph_vec3){8.0, 14.0, -9.0});
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct neph_diag diag = {0};
        struct neph_march_params params = mapped(64, 1);
        params.shortcuts.shadow = cases[i].map;
        assert_int_equal(neph_march_check(&test.scene, &params, &diag), NEPH_ERR_USAGE);
        assert_non_null(strstr(diag.message, cases[i].name));
    }
}

#include "tests/renderer/main.h"
