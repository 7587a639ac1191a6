/* SPDX-License-Identifier: MIT
 *
 * Layers above each other: a medium cut into layers, listed in any order, equals the medium; seen
 * from below, from inside, from between two layers and from above.
 */
#include "tests/scene_builders.h"

#include "scenes/bounds.h"
#include "scenes/media.h"
#include "scenes/sheet.h"
#include "truth/transport.h"

enum { LAYERS = 3, ORDERS = 6 };

static const int orders[ORDERS][LAYERS] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                           {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};

/* The box of all media, and the heights between the layers. */
static const struct neph_bounds room = {{-30.0, 0.0, -30.0}, {30.0, 12.0, 30.0}};
static const double floors_m[LAYERS + 1] = {0.0, 3.5, 7.0, 12.0};

/* Below, in a layer, on the border of two, in the highest, and above all. */
static const double heights_m[] = {-4.0, 1.0, 3.5, 9.0, 15.0};

static struct neph_medium in_room(struct neph_medium medium)
{
    medium.albedo = (struct neph_rgb){0.9, 0.8, 0.7};
    medium.phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.4};
    medium.bounds = room;
    return medium;
}

static struct neph_scene sunny(struct neph_medium medium)
{
    struct neph_scene scene = make_sunny(medium, (struct neph_vec3){0.5, 0.7, -0.6});
    scene.background_w_per_m2_sr = (struct neph_rgb){0.1, 0.2, 0.4};
    return scene;
}

static struct neph_scene cut_up(const struct neph_scene *whole, const int order[LAYERS])
{
    struct neph_scene cut = *whole;
    cut.medium_count = LAYERS;
    for (int i = 0; i < LAYERS; i++) {
        cut.media[i] = whole->media[0];
        cut.media[i].bounds.min_m.y = floors_m[order[i]];
        cut.media[i].bounds.max_m.y = floors_m[order[i] + 1];
    }
    return cut;
}

static double difference(struct neph_rgb a, struct neph_rgb b)
{
    return fmax(fabs(a.r - b.r), fmax(fabs(a.g - b.g), fabs(a.b - b.b)));
}

static double largest_difference(const struct neph_scene *a, const struct neph_scene *b,
                                 double height_m, uint64_t *seed)
{
    double largest = 0.0;
    for (int ray = 0; ray < neph_test_by_day(8, 24); ray++) {
        const struct neph_vec3 eye_m = {neph_test_uniform(seed, -8, 8), height_m,
                                        neph_test_uniform(seed, -8, 8)};
        const struct neph_vec3 direction = random_direction(seed);
        const struct neph_ray_light one = neph_transport_ray(a, eye_m, direction);
        const struct neph_ray_light other = neph_transport_ray(b, eye_m, direction);
        largest = fmax(largest, difference(one.transmittance, other.transmittance));
        largest = fmax(largest, difference(one.radiance, other.radiance));
        largest = fmax(largest, difference(one.volume, other.volume));
    }
    return largest;
}

static void check_medium(const char *name, struct neph_medium medium)
{
    const struct neph_scene whole = sunny(in_room(medium));
    double largest = 0.0;
    uint64_t seed = 77;
    for (int order = 0; order < ORDERS; order++) {
        const struct neph_scene cut = cut_up(&whole, orders[order]);
        for (size_t h = 0; h < sizeof(heights_m) / sizeof(heights_m[0]); h++)
            largest = fmax(largest, largest_difference(&whole, &cut, heights_m[h], &seed));
    }
    print_message("%s: cut into layers it is off by %.1e\n", name, largest);
    /* Both quadratures are accurate to 1e-10 of their largest part. */
    assert_true(largest < 1e-9);
}

static void test_a_medium_in_layers_is_the_medium(void **state)
{
    uint64_t seed = 4;
    struct neph_grid *grid = random_lattice((const int[3]){6, 5, 6},
                                            (struct neph_vec3){-7.0, 1.0, -7.0},
                                            (struct neph_vec3){2.8, 2.3, 2.8}, -0.5, &seed);
    struct neph_medium plume = make_medium(NEPH_MEDIUM_PLUME, 0.4);
    plume.plume = (struct neph_plume){{0.0, 0.5, 0.0}, {0.0, 1.0, 0.0}, 3.0, 9.0};
    check_medium("homogeneous", make_homogeneous(0.08, room));
    check_medium("height fog", make_height_fog(0.2, 0.3));
    check_medium("a blob", make_blob(0.5, (struct neph_vec3){1.0, 6.0, -2.0}, 2.5));
    check_medium("a shell", make_shell(0.1, (struct neph_vec3){0.0, -40.0, 0.0}, 39.0, 5.0));
    check_medium("voxels", make_voxels(0.3, grid));
    check_medium("a plume", plume);
    neph_grid_destroy(grid);
}

/* A sheet above a cloud, and haze below and around both: in any order. */
static void test_any_order_of_layers_is_the_same(void **state)
{
    struct neph_diag diag = {0};
    struct neph_grid *grid = NULL;
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
    neph_assert_ok(neph_sheet_make(&sheet, &grid, &diag), &diag);
    const struct neph_medium layers[LAYERS] = {
        in_room(make_height_fog(0.05, 0.2)),
        in_room(make_blob(0.5, (struct neph_vec3){1.0, 5.0, -2.0}, 1.5)),
        in_room(make_voxels(neph_sheet_extinction_per_m(&sheet, 0.6), grid))};
    struct neph_scene first = sunny(layers[0]);
    memcpy(first.media, layers, sizeof(layers));
    first.medium_count = LAYERS;
    double largest = 0.0;
    uint64_t seed = 9;
    for (int order = 1; order < ORDERS; order++) {
        struct neph_scene other = first;
        for (int i = 0; i < LAYERS; i++)
            other.media[i] = layers[orders[order][i]];
        for (size_t h = 0; h < sizeof(heights_m) / sizeof(heights_m[0]); h++)
            largest = fmax(largest, largest_difference(&first, &other, heights_m[h], &seed));
    }
    print_message("in any order: off by %.1e\n", largest);
    assert_true(largest < 1e-9);
    neph_grid_destroy(grid);
}

#include "tests/main.h"
