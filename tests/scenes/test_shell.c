/* SPDX-License-Identifier: MIT
 *
 * Atmospheres against 40-digit references and closed forms, and the general properties of an
 * optical depth.
 */
#include "tests/scene_builders.h"

#include "scenes/media.h"
#include "scenes/radial.h"
#include "tests/scenes/reference_radial.h"

#include <float.h>

/* The ground at the origin, its centre below. */
static struct neph_medium planet(double radius_m, double scale_height_m)
{
    return make_shell(1.0, (struct neph_vec3){0.0, -radius_m, 0.0}, radius_m, scale_height_m);
}

/* Half of them almost level. */
static struct neph_vec3 random_slope(uint64_t *seed)
{
    struct neph_vec3 direction = random_direction(seed);
    if (neph_test_uniform(seed, 0, 1) < 0.5)
        direction.y *= 1e-3;
    return neph_vec3_normalize(direction);
}

/* The effect of rounding on the intersection of a line with the ground [m]: the impact parameter is
 * accurate to a few roundings of the radius, and the position is sqrt(R^2 - impact^2) from the
 * nearest point. */
static double ground_rounding_m(const struct neph_medium *medium, struct neph_vec3 origin_m,
                                struct neph_vec3 direction, double epsilon)
{
    const double radius_m = medium->shell.radius_m;
    const struct neph_radial_line line = neph_radial_line(medium->shell.center_m, origin_m,
                                                          direction, 0.0, 1.0);
    const double rise_m2 = (double)((radius_m - line.impact_m) * (radius_m + line.impact_m));
    const double rounding_m2 = 4.0 * epsilon * radius_m * radius_m;
    if (rise_m2 < -rounding_m2)
        return 0.0;
    return rounding_m2 / sqrt(fmax(rise_m2, rounding_m2));
}

/* 1e-12, plus the rounding of altitudes where long double is short (R / H); where the line meets
 * the ground, the rounding of this position, too. */
static void test_optical_depth_against_reference(void **state)
{
    double worst = 0.0;
    for (size_t i = 0; i < COUNT(reference_shell); i++) {
        const struct reference_shell *r = &reference_shell[i];
        const struct neph_medium medium = planet(r->radius_m, r->scale_height_m);
        const double altitudes = 4.0 * LDBL_EPSILON * r->radius_m / r->scale_height_m;
        for (const struct reference_piece *p = r->pieces; p < r->pieces + r->count; p++) {
            const double tau = neph_medium_optical_depth(&medium, p->origin_m, r->direction,
                                                         p->t0_m, p->t1_m);
            const double ground_m = ground_rounding_m(&medium, p->origin_m, r->direction,
                                                      LDBL_EPSILON);
            neph_assert_close(tau, p->optical_depth, 1e-12 + altitudes, ground_m);
            if (ground_m <= 1e-14 * p->optical_depth)
                worst = fmax(worst, fabs(tau / p->optical_depth - 1.0));
        }
    }
    print_message("worst relative error of an optical depth: %.2g\n", worst);
}

/* Chapman's function at 90 degrees, X e^X K_1(X), is sqrt(pi X / 2) (1 + 3 / (8 X) - 15 / (128 X^2)
 * + 105 / (1024 X^3)) to the next term, -4725 / (32768 X^4). */
static void test_level_rays_from_the_ground(void **state)
{
    static const double xs[] = {40.0, 797.0, 1e4, 1e6, 1e9};
    for (size_t i = 0; i < COUNT(xs); i++) {
        const double x = xs[i];
        const struct neph_medium medium = planet(x, 1.0);
        const double chapman = sqrt(0.5 * M_PI * x) *
                               (1.0 + 3.0 / (8.0 * x) - 15.0 / (128.0 * x * x) +
                                105.0 / (1024.0 * x * x * x));
        const double tau = neph_medium_optical_depth(&medium, (struct neph_vec3){0, 0, 0},
                                                     (struct neph_vec3){0, 0, 1}, 0.0, INFINITY);
        neph_assert_close(tau, chapman, 1e-13 + 0.15 / (x * x * x * x), 0.0);
        if (x == 797.0)
            neph_assert_close(tau, 35.4, 0.0, 0.05); /* where the plane-parallel formula gives
                                                        infinity */
    }
}

/* Vertically H (1 - e^{-L / H}), on any planet; through its hollow middle twice this. */
static void test_vertical_rays(void **state)
{
    static const double radii[] = {1e-6, 1.0, 50.0, 6.371e6, 1e9};
    static const double heights[] = {1.0, 1200.0, 8000.0};
    for (size_t i = 0; i < COUNT(radii); i++)
        for (size_t j = 0; j < COUNT(heights); j++) {
            const double radius_m = radii[i], height_m = heights[j];
            const struct neph_medium medium = planet(radius_m, height_m);
            const struct neph_vec3 foot = {0, 0, 0}, up = {0, 1, 0},
                                   below = {0, -3.0 * radius_m, 0};
            neph_assert_close(neph_medium_optical_depth(&medium, foot, up, 0.0, INFINITY), height_m,
                              1e-14, 0.0);
            neph_assert_close(neph_medium_optical_depth(&medium, foot, up, 0.0, 0.3 * height_m),
                              -height_m * expm1(-0.3), 1e-14, 0.0);
            neph_assert_close(neph_medium_optical_depth(&medium, below, up, -INFINITY, INFINITY),
                              2.0 * height_m, 1e-14, 0.0);
            neph_assert_close(neph_medium_optical_depth(&medium, foot, up, -2.0 * radius_m, 0.0),
                              0.0, 0.0, 1e-18 * radius_m);
        }
}

struct trial {
    struct neph_medium medium;
    struct neph_vec3 origin_m, direction;
    double a_m, b_m, c_m;
};

static struct trial random_trial(uint64_t *seed)
{
    const double height_m = pow(10.0, neph_test_uniform(seed, 0, 4));
    const double radius_m = height_m * pow(10.0, neph_test_uniform(seed, -2, 4));
    const double span_m = 20.0 * height_m + 3.0 * sqrt(radius_m * height_m);
    const double a_m = neph_test_uniform(seed, -span_m, span_m);
    const double b_m = a_m + span_m * pow(10.0, neph_test_uniform(seed, -6, 0));
    return (struct trial){
        .medium = planet(radius_m, height_m),
        .origin_m = {neph_test_uniform(seed, -span_m, span_m),
                     neph_test_uniform(seed, -1, 9) * height_m,
                     neph_test_uniform(seed, -span_m, span_m)},
        .direction = random_slope(seed),
        .a_m = a_m,
        .b_m = b_m,
        .c_m = b_m + span_m * pow(10.0, neph_test_uniform(seed, -6, 0)),
    };
}

static double depth(const struct trial *t, double from_m, double to_m)
{
    return neph_medium_optical_depth(&t->medium, t->origin_m, t->direction, from_m, to_m);
}

/* tau(a, b) + tau(b, c) = tau(a, c) to the roundings of three sums. The reversed ray, from a
 * position rounded to 2^-53 of its distance from the world's origin, meets the same air. */
static void test_optical_depth_adds_and_reverses(void **state)
{
    const uint64_t first_seed = 20250902;
    double worst = 0.0;
    for (uint64_t n = 0; n < 20000; n++) {
        uint64_t seed = first_seed + n;
        const struct trial t = random_trial(&seed);
        const double whole = depth(&t, t.a_m, t.c_m);
        const double parts = depth(&t, t.a_m, t.b_m) + depth(&t, t.b_m, t.c_m);
        struct trial back = t;
        back.origin_m = neph_vec3_along(t.origin_m, t.direction, t.c_m);
        back.direction = neph_vec3_scale(t.direction, -1.0);
        const double reversed = depth(&back, 0.0, t.c_m - t.a_m);
        const double ground_m = ground_rounding_m(&t.medium, t.origin_m, t.direction, LDBL_EPSILON);
        const double place_m = 4.0 * DBL_EPSILON *
                               (neph_vec3_length(t.origin_m) + fabs(t.a_m) + fabs(t.c_m));
        const double moved = place_m / t.medium.shell.scale_height_m;
        const double moved_ground_m = ground_rounding_m(&t.medium, t.origin_m, t.direction,
                                                        place_m / t.medium.shell.radius_m);
        if (!(fabs(parts - whole) <= 1e-13 * whole + ground_m))
            print_error("seed %llu\n", (unsigned long long)(first_seed + n));
        neph_assert_close(parts, whole, 1e-13, ground_m);
        neph_assert_close(reversed, whole, 1e-13 + moved, place_m + moved_ground_m);
        assert_true(whole >= 0.0 && isfinite(whole));
        if (whole > 0.0 && ground_m < 1e-15 * whole)
            worst = fmax(worst, fabs(parts / whole - 1.0));
    }
    print_message("parts against the whole: off by %.2g at most\n", worst);
}

/* The extinction is the derivative of the optical depth: over 1e-6 H it changes by a relative 1e-6,
 * and against its middle by the square of this. */
static void test_extinction_is_the_derivative(void **state)
{
    const uint64_t first_seed = 70;
    for (uint64_t n = 0; n < 3000; n++) {
        uint64_t seed = first_seed + n;
        struct trial t = random_trial(&seed);
        const double end_m = t.a_m + 1e-6 * t.medium.shell.scale_height_m;
        const double length_m = end_m - t.a_m; /* as rounded */
        const struct neph_vec3 middle = neph_vec3_along(t.origin_m, t.direction,
                                                        t.a_m + 0.5 * length_m);
        const double at_per_m = neph_medium_extinction_per_m(&t.medium, middle);
        const long double r_m = neph_radial_distance_m(t.medium.shell.center_m, middle);
        if (fabsl(r_m - t.medium.shell.radius_m) > length_m) /* not on the ground */
            neph_assert_close(depth(&t, t.a_m, end_m) / length_m, at_per_m, 1e-9, 0.0);
    }
}

/* Any numbers that a scene could contain: never NaN, negative or infinite; never more than a whole
 * level line at the ground; a longer ray never meets less. */
static void test_is_never_nonsense(void **state)
{
    static const double radii[] = {1e-9, 1.0, 6.371e6, 1e12};
    static const double heights[] = {1e-3, 1.0, 8000.0, 1e9};
    static const double places[] = {-1e300, -1e9, -6.371e6, -1.0, -1e-300, 0.0, 5e-324, 3e4, 1e20};
    static const double lengths[] = {5e-324, 1e-300, 1.0, 1e6, 1e13, 1e300, DBL_MAX, INFINITY};
    static const struct neph_vec3 directions[] = {
        {1, 0, 0}, {0, -1, -0.0}, {0, 1, 5e-324}, {0.6, -0.8, 1e-300}, {0.6, 1e-9, -0.8}};
    for (size_t r = 0; r < COUNT(radii); r++)
        for (size_t h = 0; h < COUNT(heights); h++)
            for (size_t x = 0; x < COUNT(places); x++)
                for (size_t y = 0; y < COUNT(places); y++)
                    for (size_t k = 0; k < COUNT(directions); k++) {
                        const struct neph_medium medium = planet(radii[r], heights[h]);
                        const struct neph_vec3 o = {places[x], places[y], 0.0};
                        const double most = 2.0 * heights[h] + 4.0 * sqrt(radii[r] * heights[h]);
                        double shorter = 0.0;
                        /* such a short segment may be above or below the ground */
                        const double place_m = LDBL_EPSILON * radii[r];
                        for (size_t l = 0; l < COUNT(lengths); l++) {
                            const double tau = neph_medium_optical_depth(&medium, o, directions[k],
                                                                         0.0, lengths[l]);
                            if (!(tau >= shorter * (1.0 - 1e-13) - place_m && tau <= most))
                                print_error("R %g, H %g, origin %g %g, direction %zu, length %g: "
                                            "%g after %g\n",
                                            radii[r], heights[h], o.x, o.y, k, lengths[l], tau,
                                            shorter);
                            assert_true(tau >= shorter * (1.0 - 1e-13) - place_m && tau <= most);
                            shorter = tau;
                        }
                        const double at_per_m = neph_medium_extinction_per_m(&medium, o);
                        assert_true(at_per_m >= 0.0 && at_per_m <= 1.0);
                    }
}

static void test_nothing_below_the_ground(void **state)
{
    const struct neph_medium medium = planet(6.371e6, 8000.0);
    assert_true(neph_medium_extinction_per_m(&medium, (struct neph_vec3){0, 0, 0}) == 1.0);
    assert_true(neph_medium_extinction_per_m(&medium, (struct neph_vec3){0, -1e-6, 0}) == 0.0);
    assert_true(neph_medium_optical_depth(&medium, (struct neph_vec3){0, -100, 0},
                                          (struct neph_vec3){1, 0, 0}, 0.0, 1000.0) == 0.0);
}

/* Boxes around the ground, high up and below, wide and thin. */
static void test_bound_holds_in_any_box(void **state)
{
    const uint64_t first_seed = 550;
    double used = 0.0;
    for (uint64_t trial = 0; trial < 3000; trial++) {
        uint64_t seed = first_seed + trial;
        const double height_m = pow(10.0, neph_test_uniform(&seed, -1, 4));
        const double radius_m = height_m * pow(10.0, neph_test_uniform(&seed, -1, 6));
        const struct neph_medium medium = planet(radius_m, height_m);
        const double wide_m = pow(10.0, neph_test_uniform(&seed, -2, 2)) * height_m;
        const struct neph_vec3 low = {neph_test_uniform(&seed, -2, 1) * wide_m,
                                      neph_test_uniform(&seed, -2, 9) * height_m,
                                      neph_test_uniform(&seed, -2, 1) * wide_m};
        const struct neph_vec3 side = {wide_m, height_m * neph_test_uniform(&seed, 0.01, 2),
                                       wide_m};
        const struct neph_bounds box = {low, neph_vec3_add(low, side)};
        used = fmax(used, assert_bound(&medium, &box, 50, &seed));
        assert_true(neph_medium_extinction_bound_per_m(&medium, &box) <= 1.0 + 1e-11);
    }
    assert_true(used > 0.95);
    const struct neph_medium medium = planet(100.0, 1.0);
    const struct neph_bounds inside = {{-10, -110, -10}, {10, -90, 10}};
    assert_true(neph_medium_extinction_bound_per_m(&medium, &inside) == 0.0);
    neph_assert_close(neph_medium_extinction_bound_per_m(&medium, &everywhere), 1.0, 1e-11, 0.0);
}

/* The cube around the planet: level lines above its faces lose most, and no line loses more than
 * stated. */
static void test_container_loses_no_more_than_it_says(void **state)
{
    const struct neph_scene scene = {0};
    static const struct neph_shell planets[] = {
        {{0, -6.371e6, 0}, 6.371e6, 8000.0}, {{5, 6, 7}, 1.0, 1.0}, {{0, 0, 0}, 50.0, 500.0}};
    for (size_t i = 0; i < COUNT(planets); i++) {
        struct neph_medium medium = planet(1.0, 1.0);
        medium.shell = planets[i];
        medium.extinction_per_m = 3.0 / planets[i].scale_height_m;
        medium.extinction_color = (struct neph_rgb){1.0, 2.0, 5.0};
        double said;
        const struct neph_bounds box = neph_medium_container(&scene, &medium, &said);
        assert_true(said > 0.0 && said < 1e-7);
        struct neph_medium boxed = medium;
        boxed.bounds = box;
        const struct neph_vec3 c = planets[i].center_m;
        const double reach_m = box.max_m.x - c.x;
        double worst = 0.0;
        uint64_t seed = 30;
        for (int n = 0; n < 4000; n++) {
            struct neph_vec3 d = random_slope(&seed);
            struct neph_vec3 o = neph_vec3_along(c, random_slope(&seed),
                                                 neph_test_uniform(&seed, 0.0, 1.7) * reach_m);
            if (n % 2) /* just above the middle of a face */
                o = (struct neph_vec3){c.x, box.max_m.y + 1e-9 * reach_m, c.z}, d.y = 0.0;
            d = neph_vec3_normalize(d);
            const double open = neph_medium_optical_depth(&medium, o, d, -1e9, 1e9);
            const double cut = neph_medium_optical_depth(&boxed, o, d, -1e9, 1e9);
            worst = fmax(worst, fabs(expm1(-5.0 * open) - expm1(-5.0 * cut)));
        }
        print_message("R %g, H %g: box of %.6g m, %.3g found, %.3g said\n", planets[i].radius_m,
                      planets[i].scale_height_m, 2.0 * reach_m, worst, said);
        assert_true(worst <= said && worst > 0.9 * said);
    }
}

static void test_container_keeps_finite_bounds(void **state)
{
    const struct neph_scene scene = {0};
    struct neph_medium medium = planet(6.371e6, 8000.0);
    medium.bounds = (struct neph_bounds){{-5e4, 0, -7e4}, {5e4, 6e4, 7e4}};
    double error = 1.0;
    const struct neph_bounds box = neph_medium_container(&scene, &medium, &error);
    assert_true(error == 0.0);
    assert_memory_equal(&box, &medium.bounds, sizeof(box));
}

#include "tests/main.h"
