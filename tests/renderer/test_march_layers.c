/* SPDX-License-Identifier: MIT
 *
 * Layers above each other in the ray marcher: a medium split into layers, in any order, equals the
 * undivided medium, seen from below, inside, between two layers, and above.
 */
#include "tests/renderer/frames.h"

#include "scenes/bounds.h"
#include "scenes/sheet.h"

enum { WIDTH_PX = 24, HEIGHT_PX = 16, LAYERS = 3 };

static const struct neph_bounds room = {{-30.0, 0.0, -30.0}, {30.0, 12.0, 30.0}};
static const double floors_m[LAYERS + 1] = {0.0, 3.5, 7.0, 12.0};

/* Below, in a layer, on the border of two, in the highest, above all. */
static const double heights_m[] = {-4.0, 1.0, 3.5, 9.0, 15.0};

static void look_from(struct test_scene *test, double height_m)
{
    test->key.position_m = (struct neph_vec3){2.0, height_m, 20.0};
    test->key.look_at_m = (struct neph_vec3){0.0, 5.5, -2.0};
}

static struct neph_image *render(struct neph_vulkan *vulkan, const struct neph_scene *scene)
{
    const struct neph_march_params params = {
        .width_px = WIDTH_PX, .height_px = HEIGHT_PX, .steps = 48};
    return test_march(vulkan, scene, &params, NULL);
}

static double largest_difference(const struct neph_image *a, const struct neph_image *b)
{
    return fmax(test_largest_difference(a, b, NULL),
                fmax(test_largest_difference(a, b, "volume"),
                     test_largest_difference(a, b, "transmittance")));
}

/* The largest difference between the frames of `scene` and of other layers, over all heights. */
static double off_by(struct neph_vulkan *vulkan, struct test_scene *test,
                     const struct neph_medium *layers)
{
    double largest = 0.0;
    for (size_t h = 0; h < sizeof(heights_m) / sizeof(heights_m[0]); h++) {
        struct test_scene other = *test;
        look_from(test, heights_m[h]);
        other.key = test->key;
        other.scene.camera_keys = &other.key;
        other.scene.solids = other.solids;
        other.scene.medium_count = LAYERS;
        memcpy(other.scene.media, layers, LAYERS * sizeof(*layers));
        OWNED(image) struct neph_image *one = render(vulkan, &test->scene);
        OWNED(image) struct neph_image *two = render(vulkan, &other.scene);
        largest = fmax(largest, largest_difference(one, two));
    }
    return largest;
}

static void check_medium(struct neph_vulkan *vulkan, const char *name, struct neph_medium medium)
{
    static const int order[LAYERS] = {1, 2, 0};
    struct test_scene test;
    struct neph_medium layers[LAYERS];
    test_scene_init(&test);
    test_add_box(&test, (struct neph_vec3){-100.0, -6.0, -100.0},
                 (struct neph_vec3){100.0, -5.0, 100.0});
    struct neph_medium *whole = test_add_cloud(&test, medium.kind, medium.extinction_per_m);
    medium.albedo = whole->albedo;
    medium.phase = whole->phase;
    medium.bounds = room;
    *whole = medium;
    for (int i = 0; i < LAYERS; i++) {
        layers[i] = medium;
        layers[i].bounds.min_m.y = floors_m[order[i]];
        layers[i].bounds.max_m.y = floors_m[order[i] + 1];
    }
    const double largest = off_by(vulkan, &test, layers);
    print_message("%s: cut into layers it is off by %.1e\n", name, largest);
    /* Radiance of up to 1 in float32, and steps that start at the optical depth 1e-7 of a layer. */
    assert_true(largest < 2e-5);
}

static void test_a_medium_in_layers_is_the_medium(void **state)
{
    uint64_t seed = 4;
    OWNED(grid)
    struct neph_grid *grid = random_lattice((const int[3]){6, 5, 6},
                                            (struct neph_vec3){-7.0, 1.0, -7.0},
                                            (struct neph_vec3){2.8, 2.3, 2.8}, -0.5, &seed);
    check_medium(*state, "voxels", make_voxels(0.3, grid));
    if (neph_test_is_night()) {
        check_medium(*state, "height fog", make_height_fog(0.2, 0.3));
        check_medium(*state, "homogeneous", make_homogeneous(0.08, room));
        check_medium(*state, "a blob", make_blob(0.5, (struct neph_vec3){1.0, 6.0, -2.0}, 2.5));
        check_medium(*state, "a shell",
                     make_shell(0.1, (struct neph_vec3){0.0, -40.0, 0.0}, 39.0, 5.0));
    }
}

/* A sheet above a cloud above haze, and in reverse order. */
static void test_any_order_of_layers_is_the_same(void **state)
{
    struct test_scene test;
    struct neph_diag diag = {0};
    OWNED(grid) struct neph_grid *grid = NULL;
    const struct neph_sheet sheet = {.center_m = {0.0, 10.0, 0.0},
                                     .side_m = 40.0,
                                     .thickness_m = 0.5,
                                     .nodes = 32,
                                     .pattern = NEPH_SHEET_STREAKS,
                                     .seed = 5,
                                     .wisp_m = 4.0,
                                     .stretch = 3.0,
                                     .along = {1.0, 0.0, 0.4},
                                     .coverage = 0.7};
    test_scene_init(&test);
    neph_assert_ok(neph_sheet_make(&sheet, &grid, &diag), &diag);
    struct neph_medium *fog = test_add(&test, make_height_fog(0.05, 0.2));
    fog->bounds = room;
    test_add(&test, make_blob(0.5, (struct neph_vec3){1.0, 5.0, -2.0}, 1.5));
    test_add(&test, make_voxels(neph_sheet_extinction_per_m(&sheet, 0.6), grid));
    const struct neph_medium other_way[LAYERS] = {test.scene.media[2], test.scene.media[1],
                                                  test.scene.media[0]};
    const double largest = off_by(*state, &test, other_way);
    print_message("the other way round: off by %.1e\n", largest);
    assert_true(largest < 2e-6);
}

/* The same scene ten thousand kilometres away gives the same frames, from every height. */
static void test_far_from_the_origin_it_is_the_same(void **state)
{
    struct test_scene test;
    uint64_t seed = 4;
    double largest = 0.0;
    const struct neph_vec3 far_m = {1e7, 0.0, -1e7};
    OWNED(grid)
    struct neph_grid *grid = random_lattice((const int[3]){6, 5, 6},
                                            (struct neph_vec3){-7.0, 1.0, -7.0},
                                            (struct neph_vec3){2.8, 2.3, 2.8}, -0.5, &seed);
    test_scene_init(&test);
    test_add_box(&test, (struct neph_vec3){-100.0, -6.0, -100.0},
                 (struct neph_vec3){100.0, -5.0, 100.0});
    for (int i = 0; i < LAYERS; i++)
        test_add(&test, make_voxels(0.1, grid))->bounds = room; /* for the kernel of layers */
    for (size_t h = 0; h < sizeof(heights_m) / sizeof(heights_m[0]); h++) {
        const struct neph_bounds ground = test.solids[0].box;
        const struct neph_vec3 corner_m = grid->origin_m;
        look_from(&test, heights_m[h]);
        OWNED(image) struct neph_image *here = render(*state, &test.scene);
        grid->origin_m = neph_vec3_add(grid->origin_m, far_m);
        test.solids[0].box = neph_bounds_translate(ground, far_m);
        test.key.position_m = neph_vec3_add(test.key.position_m, far_m);
        test.key.look_at_m = neph_vec3_add(test.key.look_at_m, far_m);
        for (int i = 0; i < LAYERS; i++)
            test.scene.media[i].bounds = neph_bounds_translate(room, far_m);
        OWNED(image) struct neph_image *there = render(*state, &test.scene);
        largest = fmax(largest, largest_difference(here, there));
        for (int i = 0; i < LAYERS; i++)
            test.scene.media[i].bounds = room;
        test.solids[0].box = ground;
        grid->origin_m = corner_m;
    }
    print_message("1e7 m away: off by %.1e\n", largest);
    assert_true(largest < 1e-6); /* a double's rounding at that distance is 2e-9 m; then float32 */
}

#include "tests/renderer/main.h"
