/* SPDX-License-Identifier: MIT
 *
 * The floors in the report's frames over time: which number of two counts.
 */
#include "tests/neph_test.h"

#include "harness/report/over_time.h"

#include <math.h>

/* A document of one measurement over all pixels; NaN: it has no value. */
static json_t *make_document(double value)
{
    return json_pack("{s:[{s:s, s:s, s:s, s:o}]}", "measurements", "quantity", "radiance", "metric",
                     "seen_contrast", "mask", "all", "value", neph_json_number(value));
}

static void test_the_lower_number_is_the_floor(void **state)
{
    static const struct {
        double own, other, floor, times;
    } cases[] = {
        {4.0, 2.0, 2.0, 3.0}, {2.0, 4.0, 2.0, 3.0}, {NAN, 4.0, NAN, NAN},
        {4.0, NAN, NAN, NAN}, {0.0, 4.0, 0.0, NAN},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        json_t *preset = make_document(6.0), *own = make_document(cases[i].own),
               *other = make_document(cases[i].other);
        json_t *made = neph_over_time_add_floor(
            json_array_get(json_object_get(preset, "measurements"), 0),
            (const json_t *const[]){own, other});
        const double floor = neph_json_real(made, "floor"),
                     times = neph_json_real(made, "times_floor");
        assert_true(neph_json_real(made, "value") == 6.0);
        assert_true(isnan(cases[i].floor) ? isnan(floor) : floor == cases[i].floor);
        assert_true(isnan(cases[i].times) ? isnan(times) : times == cases[i].times);
        json_decref(made);
        json_decref(preset);
        json_decref(own);
        json_decref(other);
    }
}

/* A mask that the floor lacks; and an engine that failed has no document. */
static void test_a_missing_number_is_no_floor(void **state)
{
    json_t *preset = make_document(6.0), *own = make_document(2.0);
    json_t *measurement = json_array_get(json_object_get(preset, "measurements"), 0);
    json_t *made = neph_over_time_add_floor(measurement, (const json_t *const[]){own, NULL});
    assert_true(json_is_null(json_object_get(made, "floor")));
    json_decref(made);
    assert_int_equal(json_object_set_new(measurement, "mask", json_string("depth_edge")), 0);
    made = neph_over_time_add_floor(measurement, (const json_t *const[]){own, own});
    assert_true(json_is_null(json_object_get(made, "floor")));
    assert_true(json_is_null(json_object_get(made, "times_floor")));
    json_decref(made);
    json_decref(preset);
    json_decref(own);
}

#include "tests/main.h"
