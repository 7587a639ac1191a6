/* SPDX-License-Identifier: MIT
 *
 * Blobs against 40-digit references, and the general properties of an optical depth.
 */
#include "tests/scene_builders.h"

#include "scenes/media.h"
#include "tests/scenes/reference_radial.h"

#include <float.h>

/* 1e-12; more where a position many widths away is rounded: e^{-x^2/2} multiplies the error of x
 * (from the distance in long double) by x, x < 40. Subnormal results have no digits. */
static void test_optical_depth_against_reference(void **state)
{
    double worst = 0.0;
    for (size_t i = 0; i < COUNT(reference_gaussian); i++) {
        const struct reference_gaussian *r = &reference_gaussian[i];
        const struct neph_medium medium = make_blob(1.0, r->center_m, r->width_m);
        for (const struct reference_piece *p = r->pieces; p < r->pieces + r->count; p++) {
            const double tau = neph_medium_optical_depth(&medium, p->origin_m, r->direction,
                                                         p->t0_m, p->t1_m);
            const double distance_m = neph_vec3_length(neph_vec3_sub(p->origin_m, r->center_m));
            const double places = 40.0 * LDBL_EPSILON * distance_m / r->width_m;
            neph_assert_close(tau, p->optical_depth, 1e-12 + places, DBL_MIN);
            if (p->optical_depth > DBL_MIN && places < 1e-13)
                worst = fmax(worst, fabs(tau / p->optical_depth - 1.0));
        }
    }
    print_message("worst relative error of an optical depth: %.2g\n", worst);
}

/* tau(0, a) + tau(a, b) = tau(0, b), and the reversed ray meets the same blob. The reversed ray
 * starts at a rounded position: 2^-53 of 20 widths, where the exponent changes by at most 20 times
 * this. */
static void test_optical_depth_adds_and_reverses(void **state)
{
    const uint64_t first_seed = 20250901;
    for (uint64_t trial = 0; trial < 20000; trial++) {
        uint64_t seed = first_seed + trial;
        const double width_m = pow(10.0, neph_test_uniform(&seed, -2, 4));
        const struct neph_medium medium = make_blob(0.3, random_point(&seed, 2.0 * width_m),
                                                    width_m);
        const struct neph_vec3 o = random_point(&seed, 6.0 * width_m), d = random_direction(&seed);
        const double a_m = neph_test_uniform(&seed, -8.0, 8.0) * width_m;
        const double b_m = a_m + width_m * pow(10.0, neph_test_uniform(&seed, -6, 1));
        const double c_m = b_m + width_m * pow(10.0, neph_test_uniform(&seed, -6, 1));
        const double whole = neph_medium_optical_depth(&medium, o, d, a_m, c_m);
        const double parts = neph_medium_optical_depth(&medium, o, d, a_m, b_m) +
                             neph_medium_optical_depth(&medium, o, d, b_m, c_m);
        const double back = neph_medium_optical_depth(&medium, neph_vec3_along(o, d, c_m),
                                                      neph_vec3_scale(d, -1.0), 0.0, c_m - a_m);
        const double ends = 0.3 * 20.0 * width_m * 0x1p-52; /* the positions of a, b and c */
        if (!(fabs(parts - whole) <= 1e-13 * whole + ends &&
              fabs(back - whole) <= 1e-12 * whole + ends))
            print_error("seed %llu\n", (unsigned long long)(first_seed + trial));
        neph_assert_close(parts, whole, 1e-13, ends);
        neph_assert_close(back, whole, 1e-12, ends);
        assert_true(whole >= 0.0 && isfinite(whole));
    }
}

/* The extinction is the derivative of the optical depth: over 1e-6 widths it changes by a relative
 * 2e-5 at most (x < 12) at the ends, and by the square of this against the middle. */
static void test_extinction_is_the_derivative(void **state)
{
    const uint64_t first_seed = 7;
    for (uint64_t trial = 0; trial < 2000; trial++) {
        uint64_t seed = first_seed + trial;
        const struct neph_medium medium = make_blob(0.7, random_point(&seed, 5.0), 2.0);
        const struct neph_vec3 o = random_point(&seed, 8.0), d = random_direction(&seed);
        const double length_m = 2e-6;
        const double slope = neph_medium_optical_depth(&medium, o, d, 0.0, length_m) / length_m;
        const double middle = neph_medium_extinction_per_m(&medium,
                                                           neph_vec3_along(o, d, 0.5 * length_m));
        neph_assert_close(slope, middle, 1e-9, 0.0);
    }
}

/* Any doubles: never NaN, never negative, never infinite for finite blobs. */
static void test_is_never_nonsense(void **state)
{
    static const double widths[] = {1e-300, 1e-9, 1.0, 1e9, 1e300};
    static const double places[] = {-1e300, -1e9, -1.0, -1e-300, 0.0, 5e-324, 30.0, 1e20};
    static const double lengths[] = {5e-324, 1e-300, 1.0, 1e9, DBL_MAX, INFINITY};
    static const struct neph_vec3 directions[] = {
        {1, 0, 0}, {-1, -0.0, 0}, {0.6, 0.8, 1e-300}, {0, 5e-324, -1}};
    for (size_t w = 0; w < COUNT(widths); w++)
        for (size_t x = 0; x < COUNT(places); x++)
            for (size_t y = 0; y < COUNT(places); y++)
                for (size_t l = 0; l < COUNT(lengths); l++)
                    for (size_t k = 0; k < COUNT(directions); k++) {
                        const struct neph_medium medium = make_blob(
                            1.0 / widths[w], (struct neph_vec3){0, 1, 0}, widths[w]);
                        const struct neph_vec3 o = {places[x], places[y], 0.0};
                        const double tau = neph_medium_optical_depth(&medium, o, directions[k], 0.0,
                                                                     lengths[l]);
                        if (!(tau >= 0.0 && tau <= 2.51))
                            print_error("width %g, origin %g %g, direction %zu, length %g: %g\n",
                                        widths[w], o.x, o.y, k, lengths[l], tau);
                        assert_true(tau >= 0.0 && tau <= 2.51); /* sqrt(2 pi) */
                        const double at_per_m = neph_medium_extinction_per_m(&medium, o);
                        assert_true(at_per_m >= 0.0 && at_per_m <= 1.0 / widths[w]);
                    }
}

static void test_bound_holds_in_any_box(void **state)
{
    const uint64_t first_seed = 55;
    double used = 0.0;
    for (uint64_t trial = 0; trial < 2000; trial++) {
        uint64_t seed = first_seed + trial;
        const struct neph_medium medium = make_blob(2.0, random_point(&seed, 3.0), 1.0);
        const struct neph_vec3 a = random_point(&seed, 5.0), b = random_point(&seed, 5.0);
        const struct neph_bounds box = {{fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z)},
                                        {fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z)}};
        used = fmax(used, assert_bound(&medium, &box, 50, &seed));
        assert_true(neph_medium_extinction_bound_per_m(&medium, &box) <= 2.0 * (1.0 + 1e-11));
    }
    assert_true(used > 0.95); /* a tight bound */
    const struct neph_medium medium = make_blob(2.0, (struct neph_vec3){0, 0, 0}, 1.0);
    neph_assert_close(neph_medium_extinction_bound_per_m(&medium, &everywhere), 2.0, 1e-11, 0.0);
}

/* The box of an unbounded blob: e^-27.6 at the middle of its faces; the loss of transmittance on a
 * line is at most the stated one. It is largest on lines in the faces, just outside. */
static void test_container_loses_no_more_than_it_says(void **state)
{
    const struct neph_scene scene = {0};
    const struct neph_vec3 c = {100.0, 50.0, -30.0};
    struct neph_medium medium = make_blob(1e5, c, 10.0);
    medium.extinction_color = (struct neph_rgb){0.5, 4.0, 1.0};
    double said;
    const struct neph_bounds box = neph_medium_container(&scene, &medium, &said);
    const double at_face = neph_medium_extinction_per_m(&medium,
                                                        (struct neph_vec3){box.max_m.x, c.y, c.z});
    neph_assert_close(at_face, 1e-12 * 1e5, 1e-9, 0.0);
    struct neph_medium boxed = medium;
    boxed.bounds = box;
    double worst = 0.0;
    uint64_t seed = 3;
    for (int n = 0; n < 20000; n++) {
        struct neph_vec3 o = neph_vec3_add(c, random_point(&seed, 90.0));
        struct neph_vec3 d = random_direction(&seed);
        if (n % 2) { /* along a face, next to it */
            o.x = box.max_m.x * (1.0 + 1e-9), d.x = 0.0;
            d = neph_vec3_normalize(d);
        }
        if (n % 4 == 3)
            o.y = c.y, d = (struct neph_vec3){0, 0, 1};
        const double open = neph_medium_optical_depth(&medium, o, d, -1e4, 1e4);
        const double cut = neph_medium_optical_depth(&boxed, o, d, -1e4, 1e4);
        worst = fmax(worst, fabs(exp(-4.0 * open) - exp(-4.0 * cut)));
    }
    print_message("cut of a blob: %.3g found, %.3g said\n", worst, said);
    assert_true(worst <= said && worst > 0.5 * said);
}

static void test_container_keeps_finite_bounds(void **state)
{
    const struct neph_scene scene = {0};
    struct neph_medium medium = make_blob(1.0, (struct neph_vec3){0, 0, 0}, 10.0);
    medium.bounds = (struct neph_bounds){{-5, -6, -7}, {5, 6, 7}};
    double error = 1.0;
    const struct neph_bounds box = neph_medium_container(&scene, &medium, &error);
    assert_true(error == 0.0);
    assert_memory_equal(&box, &medium.bounds, sizeof(box));
    /* Bounds away from the blob: still a valid box, of size zero. */
    medium.bounds = (struct neph_bounds){{500, -6, -7}, {600, 6, 7}};
    const struct neph_bounds away = neph_medium_container(&scene, &medium, &error);
    assert_true(away.min_m.x <= away.max_m.x && error < 1e-10);
}

#include "tests/main.h"
