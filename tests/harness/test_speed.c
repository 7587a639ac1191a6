/* SPDX-License-Identifier: MIT
 *
 * Durations in reports, on synthetic values: start-up time is separated, intervals have their
 * stated confidence, and a shorter time for more work is reported if it is significant.
 */
#include "tests/neph_test.h"

#include "harness/run/benchmark.h"
#include "harness/run/speed.h"

#include <math.h>

static const double rounding = 1e-10; /* relative; the quantile is within 1e-11 */

static void assert_is(double value, double wanted)
{
    if (!(fabs(value - wanted) <= rounding * fabs(wanted)))
        fail_msg("%.17g, not %.17g", value, wanted);
}

/* Two seconds of start-up within each render, 0.5 before: mean 3, standard error 1/sqrt(3), and
 * Student's 97.5 % quantile of 2 degrees of freedom, (2 p - 1) / sqrt(2 p (1 - p)). */
static void test_start_up_is_apart_and_the_interval_is_students(void **state)
{
    const double render_s[] = {4.0, 5.0, 6.0};
    const double half_s = 0.95 / sqrt(2.0 * 0.975 * 0.025) / sqrt(3.0);
    const struct neph_speed speed = neph_speed_from_renders(render_s, 3, 0.5, 2.0);
    assert_int_equal(speed.repeats, 3);
    assert_is(speed.start_s, 2.5);
    assert_is(speed.render_s, 3.0);
    assert_is(speed.low_s, 3.0 - half_s);
    assert_is(speed.high_s, 3.0 + half_s);
    assert_false(speed.is_flight);
}

static void test_one_render_is_no_measurement(void **state)
{
    const double render_s[] = {4.0};
    const struct neph_speed speed = neph_speed_from_renders(render_s, 1, 0.5, 0.0);
    json_t *json = neph_speed_json(&speed);
    assert_false(neph_speed_is_measured(&speed));
    assert_true(json_is_null(json));
    assert_true(isnan(speed.render_s));
    json_decref(json);
}

/* An unmeasured start-up time is null; no render is shorter than its start-up. */
static void test_an_unknown_start_is_no_number(void **state)
{
    const double render_s[] = {1.0, 1.0};
    const struct neph_speed unknown = neph_speed_from_renders(render_s, 2, NAN, NAN);
    const struct neph_speed all_start = neph_speed_from_renders(render_s, 2, 0.0, 7.0);
    json_t *json = neph_speed_json(&unknown);
    assert_true(json_is_null(json_object_get(json, "start_s")));
    assert_is(json_number_value(json_object_get(json, "render_s")), 1.0);
    assert_true(all_start.render_s == 0.0);
    json_decref(json);
}

/* t = 1.5 + 0.25 s a sample. A point that was slow by chance does not change the start-up time. */
static void test_the_start_of_a_ladder(void **state)
{
    const int samples[] = {4, 16, 64};
    const double mean_s[] = {2.5, 5.5, 17.5}, least_s[] = {2.5, 6.5, 17.5};
    assert_is(neph_sample_levels_start_time(samples, mean_s, least_s, 3), 1.5);
}

enum { POINTS = 6, SERIES = 2000 };

/* A random number with mean 0 and variance 1: the sum of twelve uniform ones. */
static double normal(uint64_t *state)
{
    double sum = -6.0;
    for (int i = 0; i < 12; i++)
        sum += neph_test_uniform(state, 0.0, 1.0);
    return sum;
}

static struct neph_speed made_up(double low_s, double render_s, double high_s)
{
    return (struct neph_speed){
        .repeats = 3, .render_s = render_s, .low_s = low_s, .high_s = high_s};
}

static void test_less_time_for_more_work_is_found(void **state)
{
    struct neph_speed speeds[POINTS];
    int earlier = -1;
    for (int i = 0; i < POINTS; i++)
        speeds[i] = made_up(0.9 * (i + 1), i + 1.0, 1.1 * (i + 1));
    assert_int_equal(neph_speed_find_inversion(speeds, POINTS, &earlier), -1);
    speeds[3] = made_up(1.75, 1.8, 1.9); /* below point 2, 2.7..3.3, and within point 1, 1.8..2.2 */
    assert_int_equal(neph_speed_find_inversion(speeds, POINTS, &earlier), 3);
    assert_int_equal(earlier, 2);
    speeds[2].repeats = 0; /* not measured: not compared with any point */
    assert_int_equal(neph_speed_find_inversion(speeds, POINTS, &earlier), -1);
}

/* The duration does not depend on the work, but is noisy: intervals of 95 % are disjoint only by
 * chance. Two of six points may be, in either order: at most 15 pairs times 5 %. The true rate is
 * far lower: disjoint intervals are far less likely than one interval that misses the truth (two
 * standard errors each, in opposite directions). A cold start in the first points, as real charts
 * had it, is always found. */
static void test_noise_is_not_taken_for_a_fall(void **state)
{
    uint64_t random = 42;
    print_message("seed %d\n", (int)random);
    int falls = 0, found = 0, earlier;
    for (int n = 0; n < SERIES; n++) {
        struct neph_speed even[POINTS], cold[POINTS];
        for (int i = 0; i < POINTS; i++) {
            double render_s[3], with_start_s[3];
            for (int k = 0; k < 3; k++) {
                render_s[k] = 1.0 + 0.01 * normal(&random);
                with_start_s[k] = render_s[k] + (i < 2 ? 1.0 : 0.0);
            }
            even[i] = neph_speed_from_renders(render_s, 3, 0.0, 0.0);
            cold[i] = neph_speed_from_renders(with_start_s, 3, 0.0, 0.0);
        }
        falls += neph_speed_find_inversion(even, POINTS, &earlier) >= 0;
        found += neph_speed_find_inversion(cold, POINTS, &earlier) >= 0;
    }
    neph_assert_in_range(falls, 0, SERIES / 20);
    neph_assert_in_range(found, SERIES * 9 / 10, SERIES);
}

#include "tests/main.h"
