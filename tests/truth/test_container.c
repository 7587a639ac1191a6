/* SPDX-License-Identifier: MIT
 *
 * The finite box in place of an unbounded medium: the light that reaches a camera changes by at
 * most the error reported with the box.
 */
#include "tests/scene_builders.h"

#include "scenes/media.h"
#include "truth/transport.h"

/* One medium seen from the keys of a camera, a sun overhead. */
struct setting {
    struct neph_camera_key keys[2];
    struct neph_scene scene;
};

static void make_setting(struct setting *setting, struct neph_medium medium, struct neph_vec3 eye0,
                         struct neph_vec3 eye1)
{
    *setting = (struct setting){
        .keys = {{.frame = 0.0, .position_m = eye0}, {.frame = 10.0, .position_m = eye1}},
        .scene = {.camera_key_count = 2,
                  .scattering = NEPH_SCATTERING_SINGLE,
                  .sun = {true, {0, 1, 0}, {1, 1, 1}},
                  .medium_count = 1,
                  .media = {medium}}};
    setting->scene.camera_keys = setting->keys;
}

static bool is_a_finite_box(const struct neph_bounds *box)
{
    return isfinite(box->min_m.x) && isfinite(box->min_m.y) && isfinite(box->min_m.z) &&
           isfinite(box->max_m.x) && isfinite(box->max_m.y) && isfinite(box->max_m.z) &&
           box->min_m.x < box->max_m.x && box->min_m.y < box->max_m.y &&
           box->min_m.z < box->max_m.z;
}

static double transmittance(struct neph_medium medium, struct neph_bounds bounds,
                            struct neph_vec3 eye, struct neph_vec3 direction)
{
    medium.bounds = bounds;
    return exp(-neph_medium_optical_depth(&medium, eye, direction, 0.0, INFINITY));
}

/* Any azimuth; slopes of all sizes, including level and vertical: grazing views are most affected
 * by the parts that a box omits. */
static struct neph_vec3 random_view(uint64_t *seed)
{
    const double kind = neph_test_uniform(seed, 0, 1),
                 azimuth = neph_test_uniform(seed, 0, 2 * M_PI);
    double y = pow(10.0, neph_test_uniform(seed, -9, 0));
    if (kind < 0.5)
        y = neph_test_uniform(seed, 0, 1);
    else if (kind < 0.55)
        y = 0.0;
    else if (kind < 0.6)
        y = 1.0;
    if (neph_test_uniform(seed, 0, 1) < 0.5)
        y = -y;
    const double across = sqrt(1.0 - y * y);
    return (struct neph_vec3){across * cos(azimuth), y, across * sin(azimuth)};
}

/* The largest difference in transmittance over `views` views from the camera's path. */
static double worst_view(const struct setting *setting, const struct neph_bounds *box, int views,
                         uint64_t *seed)
{
    const struct neph_medium *medium = &setting->scene.media[0];
    double worst = 0.0;
    for (int i = 0; i < views; i++) {
        const double along = i % 3 ? neph_test_uniform(seed, 0, 1) : i % 2;
        const struct neph_vec3 eye = neph_vec3_along(
            setting->keys[0].position_m,
            neph_vec3_sub(setting->keys[1].position_m, setting->keys[0].position_m), along);
        const struct neph_vec3 d = random_view(seed);
        const double difference = fabs(transmittance(*medium, *box, eye, d) -
                                       transmittance(*medium, medium->bounds, eye, d));
        worst = fmax(worst, difference);
    }
    return worst;
}

/* A finite medium is unchanged, without error. */
static void test_finite_bounds_are_kept(void **state)
{
    struct neph_medium fog = make_height_fog(0.1, 0.2);
    fog.bounds = (struct neph_bounds){{-1, -2, -3}, {4, 5, 6}};
    struct setting setting;
    make_setting(&setting, fog, (struct neph_vec3){0, 9, 0}, (struct neph_vec3){0, 9, 0});
    double error = NAN;
    const struct neph_bounds box = neph_medium_container(&setting.scene, &fog, &error);
    assert_true(error == 0.0);
    assert_memory_equal(&box, &fog.bounds, sizeof(box));
}

/* Unreal's default fog from eye height: a box of some kilometres, accurate to 1e-6. */
static void test_unreal_default_fog(void **state)
{
    const struct neph_medium fog = make_height_fog(9.609e-4, 0.01386294361119891);
    const struct neph_vec3 eye = {0.0, 1.7, 0.0};
    struct setting setting;
    make_setting(&setting, fog, eye, eye);
    double error = NAN;
    const struct neph_bounds box = neph_medium_container(&setting.scene, &fog, &error);
    uint64_t seed = 1;
    const double worst = worst_view(&setting, &box, neph_test_paths(20000), &seed);
    print_message("default fog: x %.0f..%.0f, y %.0f..%.0f m, worst view off by %.1g of %.1g\n",
                  box.min_m.x, box.max_m.x, box.min_m.y, box.max_m.y, worst, error);
    assert_true(is_a_finite_box(&box));
    assert_true(worst <= error && error < 1e-6);
    assert_true(box.max_m.x < 2e5 && box.max_m.y < 1e4 && box.min_m.y > -1e4);
}

/* No view from the eyes has an error above the stated one, for any fog. */
static void test_no_view_is_off_by_more_than_stated(void **state)
{
    const uint64_t first_seed = 141421;
    double largest_stated = 0.0, least_slack = INFINITY;
    const uint64_t trials = (uint64_t)neph_test_by_day(150, 400);
    for (uint64_t trial = 0; trial < trials; trial += NEPH_TEST_EVERY) {
        uint64_t seed = first_seed + trial;
        struct neph_medium fog = make_height_fog(pow(10.0, neph_test_uniform(&seed, -6, 1)),
                                                 pow(10.0, neph_test_uniform(&seed, -4, 0)));
        fog.layers[0].height_m = neph_test_uniform(&seed, -100, 100);
        if (trial % 3 == 0) {
            fog.layer_count = 2;
            fog.layers[1] = (struct neph_fog_layer){pow(10.0, neph_test_uniform(&seed, -6, 1)),
                                                    pow(10.0, neph_test_uniform(&seed, -4, 0)),
                                                    neph_test_uniform(&seed, -100, 100)};
        }
        if (trial % 5 == 0)
            fog.bounds.min_m.y = -120.0; /* open on five sides */
        struct setting setting;
        const struct neph_vec3 eye0 = {neph_test_uniform(&seed, -50, 50),
                                       neph_test_uniform(&seed, -100, 300), 0.0};
        struct neph_vec3 eye1 = eye0;
        if (trial % 2)
            eye1 = (struct neph_vec3){30.0, neph_test_uniform(&seed, -100, 3000), 100.0};
        make_setting(&setting, fog, eye0, eye1);
        setting.scene.sun.direction = neph_vec3_normalize(
            (struct neph_vec3){0.5, neph_test_uniform(&seed, -0.2, 1), 0.3});
        double error = NAN;
        const struct neph_bounds box = neph_medium_container(&setting.scene, &fog, &error);
        const double worst = worst_view(&setting, &box, neph_test_paths(1000), &seed);
        if (!(is_a_finite_box(&box) && worst <= error))
            print_error("seed %llu: a %g, b %g, %d layers, eyes %g..%g: off by %g, stated %g\n",
                        (unsigned long long)(first_seed + trial), fog.layers[0].extinction_per_m,
                        fog.layers[0].falloff_per_m, fog.layer_count, eye0.y, eye1.y, worst, error);
        assert_true(is_a_finite_box(&box));
        assert_true(worst <= error);
        largest_stated = fmax(largest_stated, error);
        if (worst > 1e-12)
            least_slack = fmin(least_slack, error / worst);
    }
    print_message("largest stated error %.2g; stated over found, at least %.2f\n", largest_stated,
                  least_slack);
}

/* Homogeneous and infinite: a box as large as the visible range. */
static void test_homogeneous_without_bounds(void **state)
{
    struct neph_medium fog = make_height_fog(0.02, 0.0);
    struct setting setting;
    make_setting(&setting, fog, (struct neph_vec3){5, 2, -3}, (struct neph_vec3){9, 20, 0});
    double error = NAN;
    struct neph_bounds box = neph_medium_container(&setting.scene, &fog, &error);
    uint64_t seed = 2;
    assert_true(is_a_finite_box(&box) && error < 1e-6);
    assert_true(worst_view(&setting, &box, 5000, &seed) <= error);

    /* A layer between two heights, open to the sides, from inside. */
    setting.keys[1].position_m.y = 8.0;
    fog.bounds.min_m.y = 0.0;
    fog.bounds.max_m.y = 10.0;
    setting.scene.media[0] = fog;
    box = neph_medium_container(&setting.scene, &fog, &error);
    assert_true(is_a_finite_box(&box) && error < 1e-6);
    assert_true(box.min_m.y == 0.0 && box.max_m.y == 10.0);
    assert_true(worst_view(&setting, &box, 5000, &seed) <= error);
}

/* A finite box and a valid error for any values in a scene file. */
static void test_corners(void **state)
{
    static const double extinctions[] = {0.0, 1e-300, 1e-8, 1.0, 1e6};
    static const double falloffs[] = {0.0, 1e-300, 1e-9, 0.1, 100.0};
    static const double eyes[] = {-1e6, 0.0, 1e4, 1e6};
    static const double suns[] = {-1.0, 0.0, 1e-300, 1e-6, 0.5};
    for (int n = 0; n < 5 * 5 * 4 * 5; n += neph_test_path_step()) {
        const double a = extinctions[n % 5], b = falloffs[n / 5 % 5], y = eyes[n / 25 % 4];
        const double s = suns[n / 100];
        const struct neph_medium fog = make_height_fog(a, b);
        struct setting setting;
        make_setting(&setting, fog, (struct neph_vec3){0, y, 0}, (struct neph_vec3){0, y, 0});
        setting.scene.sun.direction = (struct neph_vec3){0.0, s, sqrt(1.0 - s * s)};
        double error = NAN;
        const struct neph_bounds box = neph_medium_container(&setting.scene, &fog, &error);
        uint64_t seed = (uint64_t)n;
        const double worst = worst_view(&setting, &box, neph_test_paths(300), &seed);
        if (!(is_a_finite_box(&box) && worst <= error && error <= 1.0))
            print_error("a %g, b %g, eye %g, sun %g: x %g..%g y %g..%g, off by %g, stated %g\n", a,
                        b, y, s, box.min_m.x, box.max_m.x, box.min_m.y, box.max_m.y, worst, error);
        assert_true(is_a_finite_box(&box));
        assert_true(worst <= error && error <= 1.0);
    }
}

/* Sunlight, too, crosses as much fog in the box as without it: scattered radiance is unchanged. */
static void test_scattered_light_stays(void **state)
{
    const uint64_t first_seed = 173205;
    double worst = 0.0;
    for (uint64_t trial = 0; trial < 300; trial += (uint64_t)neph_test_path_step()) {
        uint64_t seed = first_seed + trial;
        const struct neph_medium fog = make_height_fog(
            pow(10.0, neph_test_uniform(&seed, -4, -1)),
            pow(10.0, neph_test_uniform(&seed, -2.5, -0.5)));
        const struct neph_vec3 eye = {0, neph_test_uniform(&seed, 0, 100), 0};
        struct setting setting;
        make_setting(&setting, fog, eye, eye);
        setting.scene.sun.direction = neph_vec3_normalize(
            (struct neph_vec3){0.5, neph_test_uniform(&seed, 0.1, 1), 0.3});
        double error = NAN;
        struct neph_scene boxed = setting.scene;
        boxed.media[0].bounds = neph_medium_container(&setting.scene, &fog, &error);
        for (int i = 0; i < 20; i++) {
            struct neph_vec3 d = random_view(&seed);
            if (fabs(d.y) < 0.02)
                continue;
            const double difference = fabs(neph_transport_ray(&boxed, eye, d).volume.r -
                                           neph_transport_ray(&setting.scene, eye, d).volume.r);
            if (difference > 1e-6)
                print_error("seed %llu: off by %g\n", (unsigned long long)(first_seed + trial),
                            difference);
            worst = fmax(worst, difference);
        }
    }
    print_message("scattered radiance in the box: off by %.2g at most\n", worst);
    assert_true(worst < 1e-6);
}

#include "tests/main.h"
