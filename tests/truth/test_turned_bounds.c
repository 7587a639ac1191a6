/* SPDX-License-Identifier: MIT
 *
 * Turned bounds. A homogeneous medium in a turned box is the same medium in the box itself, if the
 * ray, the sun and the lights are turned back about its middle.
 */
#include "tests/scene_builders.h"

#include "scenes/column.h"
#include "scenes/medium_bounds.h"
#include "scenes/solids.h"
#include "truth/path.h"
#include "truth/transport.h"

static const struct neph_bounds box = {{-3, 1, -2}, {5, 4, 1}};
static const struct neph_vec3 middle_m = {1, 2.5, -0.5};

static struct neph_turn make_turn(int axis, double angle_rad)
{
    return (struct neph_turn){axis, cos(angle_rad), sin(angle_rad)};
}

static struct neph_vec3 turn_back(const struct neph_turn *turn, struct neph_vec3 point_m)
{
    return neph_vec3_add(middle_m, neph_rotate_back(turn, neph_vec3_sub(point_m, middle_m)));
}

/* A haze and a blob, whose density is the same from all sides, in the box. */
static struct neph_scene build_scene(const struct neph_turn *turn)
{
    struct neph_scene scene = {.scattering = NEPH_SCATTERING_SINGLE, .medium_count = 2};
    scene.sun = (struct neph_sun){
        true, neph_vec3_normalize((struct neph_vec3){0.3, 0.8, -0.5}), {1, 0.8, 0.6}};
    scene.light_count = 1;
    scene.lights[0] = (struct neph_light){.position_m = {2, 6, -4},
                                          .intensity_w_per_sr = {20, 20, 20}};
    scene.media[0] = make_homogeneous(0.2, box);
    scene.media[1] = make_blob(0.5, middle_m, 1.5);
    scene.media[1].bounds = box;
    for (int m = 0; m < 2; m++) {
        scene.media[m].albedo = (struct neph_rgb){0.9, 0.8, 0.7};
        scene.media[m].phase = (struct neph_phase){NEPH_PHASE_HENYEY_GREENSTEIN, 0.4};
        if (turn)
            neph_medium_turn_bounds(&scene.media[m], turn);
    }
    return scene;
}

static void assert_same_light(struct neph_rgb a, struct neph_rgb b)
{
    neph_assert_close(a.r, b.r, 1e-7, 1e-12); /* the quadrature's tolerance */
    neph_assert_close(a.g, b.g, 1e-7, 1e-12);
    neph_assert_close(a.b, b.b, 1e-7, 1e-12);
}

static void test_a_turned_box_is_a_box(void **state)
{
    enum { RAYS = 40 };
    uint64_t seed = 1;
    int met = 0;
    for (int n = 0; n < RAYS; n++) {
        const struct neph_turn turn = make_turn(n % 3, neph_test_uniform(&seed, -M_PI, M_PI));
        const struct neph_scene turned = build_scene(&turn);
        struct neph_scene plain = build_scene(NULL);
        const struct neph_vec3 from_m = random_point(&seed, 8.0);
        const struct neph_vec3 d = neph_vec3_normalize(
            neph_vec3_sub(random_place_in(&turned.media[0].bounds, &seed), from_m));
        plain.sun.direction = neph_rotate_back(&turn, plain.sun.direction);
        plain.lights[0].position_m = turn_back(&turn, plain.lights[0].position_m);
        const struct neph_ray_light found = neph_transport_ray(&turned, from_m, d),
                                    wanted = neph_transport_ray(&plain, turn_back(&turn, from_m),
                                                                neph_rotate_back(&turn, d));
        assert_same_light(found.transmittance, wanted.transmittance);
        assert_same_light(found.radiance, wanted.radiance);
        met += wanted.transmittance.g < 1.0;
    }
    assert_true(met > RAYS / 4);
}

/* The optical depth of a fog is the sum of its extinction, which is 0 outside. */
static void test_depth_is_the_sum_of_the_extinction(void **state)
{
    enum { RAYS = 60, STEPS = 4000 };
    uint64_t seed = 2;
    const double length_m = 30.0;
    for (int n = 0; n < RAYS; n++) {
        const struct neph_turn turn = make_turn(n % 3, neph_test_uniform(&seed, -M_PI, M_PI));
        struct neph_medium fog = make_height_fog(0.3, 0.4);
        fog.bounds = box;
        neph_medium_turn_bounds(&fog, &turn);
        const struct neph_vec3 from_m = random_point(&seed, 8.0), d = random_direction(&seed);
        double sum = 0.0;
        for (int i = 0; i < STEPS; i++)
            sum += neph_medium_extinction_per_m(
                &fog, neph_vec3_along(from_m, d, length_m * (i + 0.5) / STEPS));
        const double depth = neph_medium_optical_depth(&fog, from_m, d, 0.0, length_m);
        /* Two ends, each off by half a step of at most the densest fog: e^(0.4 * 6) of 0.3. */
        neph_assert_close(sum * length_m / STEPS, depth, 1e-4, length_m / STEPS * 3.4);
    }
}

/* No point of the turned box is outside of the box around it, and its corners are on it. */
static void test_the_box_around(void **state)
{
    uint64_t seed = 3;
    for (int n = 0; n < 300; n++) {
        const struct neph_turn turn = make_turn(n % 3, neph_test_uniform(&seed, -M_PI, M_PI));
        struct neph_medium medium = make_homogeneous(1.0, box);
        neph_medium_turn_bounds(&medium, &turn);
        double nearest_m = INFINITY;
        for (int corner = 0; corner < 8; corner++) {
            const struct neph_vec3 at_m = {corner & 1 ? box.max_m.x : box.min_m.x,
                                           corner & 2 ? box.max_m.y : box.min_m.y,
                                           corner & 4 ? box.max_m.z : box.min_m.z};
            const struct neph_vec3 to_m = neph_vec3_add(
                middle_m, neph_rotate(&turn, neph_vec3_sub(at_m, middle_m)));
            const struct neph_bounds *hull = &medium.bounds;
            assert_true(to_m.x >= hull->min_m.x - 1e-12 && to_m.x <= hull->max_m.x + 1e-12 &&
                        to_m.y >= hull->min_m.y - 1e-12 && to_m.y <= hull->max_m.y + 1e-12 &&
                        to_m.z >= hull->min_m.z - 1e-12 && to_m.z <= hull->max_m.z + 1e-12);
            nearest_m = fmin(nearest_m, hull->max_m.x - to_m.x);
        }
        assert_true(nearest_m < 1e-12);
        const struct neph_vec3 point_m = random_point(&seed, 8.0);
        const struct neph_vec3 own_m = neph_medium_own_point_m(&medium, point_m);
        assert_int_equal(neph_medium_contains(&medium, point_m), neph_bounds_contain(&box, own_m));
        neph_medium_shift(&medium, (struct neph_vec3){7, 0, 0});
        assert_int_equal(
            neph_medium_contains(&medium, neph_vec3_add(point_m, (struct neph_vec3){7, 0, 0})),
            neph_bounds_contain(&box, own_m));
    }
}

/* A box away from the origin: the line to the origin's side misses it. */
static void test_the_column_is_in_the_turned_box(void **state)
{
    const struct neph_turn turn = make_turn(1, 0.6);
    struct neph_medium medium = make_homogeneous(0.5,
                                                 (struct neph_bounds){{-4, -1, -16}, {4, 4, -8}});
    neph_medium_turn_bounds(&medium, &turn);
    neph_assert_close(neph_medium_column_optical_depth(&medium, 1), 0.5 * 5.0, 1e-12, 0.0);
    /* The bottom of a fog, whose rounded place would be outside. */
    struct neph_medium fog = make_height_fog(0.3, 1.0);
    fog.bounds = (struct neph_bounds){{-4, -1.9, -4}, {4, 2.5, 4}};
    neph_medium_turn_bounds(&fog, &turn);
    const double bottom_per_m = neph_medium_extinction_per_m(&fog,
                                                             (struct neph_vec3){0, -1.8999, 0});
    neph_assert_close(neph_medium_column_optical_depth(&fog, 0), bottom_per_m * 8.0 / cos(0.6),
                      1e-3, 0.0);
    neph_assert_close(neph_medium_column_optical_depth(&medium, 0), 0.5 * 8.0 / cos(0.6), 1e-12,
                      0.0);
}

/* Paths collide where the medium is: single scattering by paths and in closed form. */
static void test_paths_meet_the_medium(void **state)
{
    enum { PATHS = 20000 };
    const struct neph_turn turn = make_turn(1, 0.6);
    struct neph_scene scene = build_scene(&turn);
    scene.light_count = 0;
    const struct neph_vec3 from_m = {-9, 3, 4},
                           d = neph_vec3_normalize((struct neph_vec3){1.0, -0.05, -0.45});
    struct neph_diag diag = {0};
    struct neph_tracker *tracker;
    neph_assert_ok(neph_tracker_create(&scene, &tracker, &diag), &diag);
    const struct neph_view view = neph_view_create(&scene, from_m, d);
    const struct neph_ray_light truth = neph_transport_ray(&scene, from_m, d);
    struct neph_tracking_cost cost = {0, 0};
    double sum = 0.0, squares = 0.0;
    const int paths = neph_test_paths(PATHS);
    for (int n = 0; n < paths; n++) {
        struct neph_random random = neph_random_stream(7, 0, (uint64_t)n);
        const double light = neph_path_trace(&scene, tracker, &view, NULL, &random, &cost).volume.g;
        sum += light;
        squares += light * light;
    }
    const double mean = sum / paths, error = sqrt((squares / paths - mean * mean) / paths);
    assert_true(truth.volume.g > 0.0 && error < neph_test_noise(0.02) * mean);
    neph_assert_close(mean, truth.volume.g, 1e-6, 4.5 * error);
    neph_tracker_destroy(tracker);
}

#include "tests/main.h"
