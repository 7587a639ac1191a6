/* SPDX-License-Identifier: MIT
 *
 * Tent layers against their antiderivative, and the general properties of an optical depth.
 */
#include "tests/scene_builders.h"

#include "scenes/media.h"
#include "scenes/radial.h"

#include <float.h>

static const struct neph_tent ozone = {{0, -6.36e6, 0}, 6.36e6, 25e3, 15e3};

/* --- the integral in closed form, in long double --------------------------------------------- */

/* The integral of sqrt(p^2 + s^2) - radius. */
static long double antiderivative(long double p_m, long double radius_m, long double s_m)
{
    const long double turned = p_m > 0.0L ? p_m * p_m * asinhl(s_m / p_m) : 0.0L;
    return 0.5L * (s_m * hypotl(p_m, s_m) + turned) - radius_m * s_m;
}

/* Over one side of the line, |s| from `low` to `high`, of the part of the tent between two radii
 * where it is linear from 0 at `zero_m`. */
static long double part(long double p_m, long double low_m, long double high_m, long double inner_m,
                        long double outer_m, long double zero_m)
{
    const long double inner_s_m = inner_m > p_m ? sqrtl((inner_m - p_m) * (inner_m + p_m)) : 0.0L;
    const long double outer_s_m = outer_m > p_m ? sqrtl((outer_m - p_m) * (outer_m + p_m)) : 0.0L;
    const long double from_m = fmaxl(low_m, inner_s_m), to_m = fminl(high_m, outer_s_m);
    return from_m < to_m
               ? fabsl(antiderivative(p_m, zero_m, to_m) - antiderivative(p_m, zero_m, from_m))
               : 0.0L;
}

static double closed_form_m(const struct neph_tent *tent, struct neph_vec3 origin_m,
                            struct neph_vec3 direction, double t0_m, double t1_m)
{
    const struct neph_radial_line line = neph_radial_line(tent->center_m, origin_m, direction, t0_m,
                                                          t1_m);
    const long double peak_m = (long double)tent->radius_m + tent->altitude_m, p = line.impact_m;
    const long double foot_m = peak_m - tent->half_width_m, top_m = peak_m + tent->half_width_m;
    const long double ends_m[2][2] = {{fmaxl(0, line.s0_m), line.s1_m},
                                      {fmaxl(0, -line.s1_m), -line.s0_m}};
    long double sum = 0.0L;
    for (int side = 0; side < 2; side++)
        sum += part(p, ends_m[side][0], ends_m[side][1], foot_m, peak_m, foot_m) +
               part(p, ends_m[side][0], ends_m[side][1], peak_m, top_m, top_m);
    return (double)(sum / tent->half_width_m);
}

struct trial {
    struct neph_medium medium;
    struct neph_vec3 origin_m, direction;
    double length_m;
};

static struct trial random_trial(uint64_t *seed)
{
    const double width_m = pow(10.0, neph_test_uniform(seed, 0, 4));
    const struct neph_tent tent = {{0, 0, 0},
                                   width_m * pow(10.0, neph_test_uniform(seed, -2, 3)),
                                   width_m * neph_test_uniform(seed, 1, 3),
                                   width_m};
    const double span_m = 2.0 * (tent.radius_m + 3.0 * width_m);
    return (struct trial){.medium = make_tent(1.0, tent),
                          .origin_m = {neph_test_uniform(seed, -span_m, span_m),
                                       neph_test_uniform(seed, -span_m, span_m), 0.3 * width_m},
                          .direction = random_direction(seed),
                          .length_m = span_m * pow(10.0, neph_test_uniform(seed, -3, 0.5))};
}

static double depth(const struct trial *t, double from_m, double to_m)
{
    return neph_medium_optical_depth(&t->medium, t->origin_m, t->direction, from_m, to_m);
}

/* The closed form loses radius^2 of its digits. */
static void test_optical_depth_is_the_closed_form(void **state)
{
    double worst = 0.0;
    for (uint64_t n = 0; n < 4000; n++) {
        uint64_t seed = 4100 + n;
        const struct trial t = random_trial(&seed);
        const struct neph_tent *tent = &t.medium.tent;
        const double reach_m = neph_vec3_length(t.origin_m) + t.length_m + tent->radius_m;
        const double lost_m = 16.0 * LDBL_EPSILON * reach_m * reach_m / tent->half_width_m;
        const double expected_m = closed_form_m(tent, t.origin_m, t.direction, 0.0, t.length_m);
        neph_assert_close(depth(&t, 0.0, t.length_m), expected_m, 1e-12, lost_m);
        worst = fmax(worst,
                     fabs(depth(&t, 0.0, t.length_m) - expected_m) / (1e-12 * expected_m + lost_m));
    }
    print_message("worst error of an optical depth: %.2g of what is allowed\n", worst);
}

/* Vertically half a width on either side of the peak; half of this from the peak; level at the peak
 * of a planet's layer about sqrt(2 R w) * 2/3 on either side, to w / R. */
static void test_known_columns(void **state)
{
    const struct neph_medium medium = make_tent(2e-6, ozone);
    const struct neph_vec3 up = {0, 1, 0}, level = {1, 0, 0};
    neph_assert_close(
        neph_medium_optical_depth(&medium, (struct neph_vec3){0, 0, 0}, up, 0.0, INFINITY),
        2e-6 * 15e3, 1e-13, 0.0);
    neph_assert_close(
        neph_medium_optical_depth(&medium, (struct neph_vec3){0, 25e3, 0}, up, 0.0, 15e3),
        1e-6 * 15e3, 1e-13, 0.0);
    neph_assert_close(
        neph_medium_optical_depth(&medium, (struct neph_vec3){0, 25e3, 0}, level, 0.0, INFINITY),
        2e-6 * 2.0 / 3.0 * sqrt(2.0 * 6.385e6 * 15e3), 15e3 / 6.385e6, 0.0);
    assert_true(neph_medium_extinction_per_m(&medium, (struct neph_vec3){0, 25e3, 0}) == 2e-6);
    neph_assert_close(neph_medium_extinction_per_m(&medium, (struct neph_vec3){0, 17.5e3, 0}), 1e-6,
                      1e-12, 0.0);
    assert_true(neph_medium_extinction_per_m(&medium, (struct neph_vec3){0, 9.9e3, 0}) == 0.0);
    assert_true(neph_medium_extinction_per_m(&medium, (struct neph_vec3){0, 40.1e3, 0}) == 0.0);
}

static void test_optical_depth_adds(void **state)
{
    for (uint64_t n = 0; n < 4000; n++) {
        uint64_t seed = 900 + n;
        const struct trial t = random_trial(&seed);
        const double cut_m = t.length_m * neph_test_uniform(&seed, 0.0, 1.0);
        const double whole = depth(&t, 0.0, t.length_m);
        /* the cut is rounded to double, and there the density is at most 1 */
        neph_assert_close(depth(&t, 0.0, cut_m) + depth(&t, cut_m, t.length_m), whole, 1e-13,
                          1e-18 * t.length_m + LDBL_EPSILON * neph_vec3_length(t.origin_m));
        assert_true(whole >= 0.0 && isfinite(whole));
    }
}

/* Any box, any point in it; and the bound is as tight as the maximum on a fine grid. */
static void test_bound_holds_in_any_box(void **state)
{
    double used = 0.0;
    for (uint64_t n = 0; n < 1000; n++) {
        uint64_t seed = 30 + n;
        const struct trial t = random_trial(&seed);
        const double side_m = t.medium.tent.half_width_m *
                              pow(10.0, neph_test_uniform(&seed, -2, 1));
        const struct neph_bounds box = {
            t.origin_m, neph_vec3_add(t.origin_m, (struct neph_vec3){side_m, side_m, side_m})};
        used = fmax(used, assert_bound(&t.medium, &box, 40, &seed));
    }
    assert_true(used > 0.95);
    const struct neph_medium medium = make_tent(2e-6, ozone);
    neph_assert_close(neph_medium_extinction_bound_per_m(&medium, &everywhere), 2e-6, 1e-11, 0.0);
    const struct neph_bounds room = {{-1e3, 0, -1e3}, {1e3, 5e3, 1e3}}; /* below the foot */
    assert_true(neph_medium_extinction_bound_per_m(&medium, &room) == 0.0);
}

static void test_support_holds_all_of_it(void **state)
{
    const struct neph_medium medium = make_tent(1.0, ozone);
    double lost;
    const struct neph_bounds box = neph_medium_container(&(struct neph_scene){0}, &medium, &lost);
    assert_true(lost == 0.0);
    neph_assert_close(box.max_m.y, 40e3, 0.0, 1e-6);
    neph_assert_close(box.max_m.x, 6.4e6, 0.0, 1e-6);
    neph_assert_close(box.min_m.y, -2.0 * 6.36e6 - 40e3, 0.0, 1e-6);
}

#include "tests/main.h"
