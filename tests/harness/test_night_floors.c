/* SPDX-License-Identifier: MIT
 *
 * Floors in nightly runs: series of their own, a ratio beside the number of the preset, and
 * accepted runs of versions without floors.
 */
#include "tests/harness/store_test.h"

#include "harness/night/output.h"
#include "harness/night/readers.h"
#include "harness/run/history.h"

#define NUMBER "failure/none/ours/error over all"

static const char result[] = "{\"device\": \"D\", \"results\": [{\"scene\": \"none\", \"point\": "
                             "\"\", \"measure\": \"error\", \"over\": \"all\", \"column\": "
                             "\"ours\", \"value\": 0.5%s}]}";

static void read_result(const char *floor, struct neph_arena *arena,
                        struct neph_night_numbers *numbers)
{
    struct neph_diag diag = {0};
    json_t *document = json_loads(neph_arena_format(arena, result, floor), 0, NULL);
    assert_non_null(document);
    neph_assert_ok(neph_night_read(NEPH_NIGHT_STRESS, document, NAN, "host", arena, numbers, &diag),
                   &diag);
    json_decref(document);
}

static void test_a_floor_is_a_series(void **state)
{
    struct neph_arena arena = {NULL};
    struct neph_night_numbers numbers;
    read_result(", \"floor\": 0.125", &arena, &numbers);
    assert_int_equal(numbers.count, 2);
    assert_string_equal(numbers.list[0].series, NUMBER);
    assert_string_equal(numbers.list[1].series, NUMBER NEPH_NIGHT_FLOOR);
    assert_string_equal(numbers.list[1].kind, "fixed");
    assert_true(numbers.list[1].value == 0.125);
    read_result(", \"floor\": null", &arena, &numbers); /* none, or infinite */
    assert_int_equal(numbers.count, 1);
    read_result("", &arena, &numbers); /* an earlier version */
    assert_int_equal(numbers.count, 1);
    neph_arena_finish(&arena);
}

/* A row of `list`, which has both fields or null for both. */
static void assert_floor(const json_t *list, size_t index, double floor, double times)
{
    const json_t *row = json_array_get(list, index);
    const json_t *found = json_object_get(row, "preset_floor");
    const json_t *ratio = json_object_get(row, "times_preset_floor");
    assert_true(isnan(floor) ? json_is_null(found) : json_number_value(found) == floor);
    assert_true(isnan(times) ? json_is_null(ratio) : json_number_value(ratio) == times);
}

static void test_the_document_has_ratios(void **state)
{
    struct neph_compared series[] = {
        {NUMBER, "", "", 0.5, {0}},
        {NUMBER NEPH_NIGHT_FLOOR, "", "", 0.125, {0}},
        {"failure/none/ours/flicker over all", "", "", 2.0, {0}}, /* static */
        {"failure/none/ours/lag over all", "", "", 2.0, {0}},
        {"failure/none/ours/lag over all" NEPH_NIGHT_FLOOR, "", "", 0.0, {0}},
    };
    struct neph_finding finding = neph_finding(NEPH_FOUND_WORSE, NUMBER, "", "");
    finding.tonight = 0.25;
    finding.example = "";
    const struct neph_night night = {
        .revision = "",
        .host = "",
        .program = "",
        .comparison = {
            .findings = &finding, .finding_count = 1, .series = series, .series_count = 5}};
    json_t *document = neph_night_json(&night, "quick");
    const json_t *rows = json_object_get(document, "series");
    assert_int_equal(json_array_size(rows), 5);
    assert_floor(rows, 0, 0.125, 4.0);
    assert_floor(rows, 1, NAN, NAN);
    assert_floor(rows, 2, NAN, NAN);
    assert_floor(rows, 3, 0.0, NAN);
    assert_floor(json_object_get(document, "findings"), 0, 0.125, 2.0);
    json_decref(document);
}

/* ---- histories ------------------------------------------------------------------------------- */

static int64_t add_night(struct neph_store *store, struct neph_database *index,
                         const struct neph_measurement *numbers, int count)
{
    const struct neph_history_night who = {"quick", "a", "program", "host"};
    const struct neph_history_step step = {"failure none", "done", "", "", 1.0, NAN};
    const char *folder = neph_store_folder(store);
    struct neph_diag diag = {0};
    int64_t night = 0;
    bool resumed;
    json_t *none = json_array();
    neph_assert_ok(neph_history_begin(index, folder, &who, &night, &resumed, &diag), &diag);
    neph_assert_ok(neph_history_add(index, night, &step, numbers, count, &diag), &diag);
    neph_assert_ok(neph_history_end(index, folder, night, "pass", none, &diag), &diag);
    json_decref(none);
    return night;
}

/* The first run is of a version without floors; the last has a worse floor. */
static void test_floors_begin_after_an_accepted_run(void **state)
{
    const struct neph_measurement runs[][2] = {
        {{NUMBER, "fixed", 0.5, NAN, "D", ""}, {NULL, NULL, 0.0, NAN, NULL, NULL}},
        {{NUMBER, "fixed", 0.5, NAN, "D", ""},
         {NUMBER NEPH_NIGHT_FLOOR, "fixed", 0.25, NAN, "D", ""}},
        {{NUMBER, "fixed", 0.5, NAN, "D", ""},
         {NUMBER NEPH_NIGHT_FLOOR, "fixed", 0.3, NAN, "D", ""}},
    };
    static const struct {
        int numbers, compared, fresh, findings;
    } expected[] = {{1, 0, 1, 0}, {2, 1, 1, 0}, {2, 2, 0, 1}};
    struct neph_store *store = open_store(state);
    struct neph_database *index = NULL;
    assert_int_equal(neph_store_index(store, &index, NULL), NEPH_OK);
    for (int i = 0; i < 3; i++) {
        struct neph_night_comparison c = {0};
        struct neph_diag diag = {0};
        const int64_t night = add_night(store, index, runs[i], expected[i].numbers);
        neph_assert_ok(neph_night_compare(index, night, 0, NULL, 0.005, &c, &diag), &diag);
        assert_int_equal(c.compared, expected[i].compared);
        assert_int_equal(c.fresh, expected[i].fresh);
        assert_int_equal(c.finding_count, expected[i].findings);
        if (c.finding_count > 0) {
            assert_int_equal(c.findings[0].found, NEPH_FOUND_WORSE);
            assert_string_equal(c.findings[0].series, NUMBER NEPH_NIGHT_FLOOR);
        }
        neph_night_comparison_finish(&c);
        neph_assert_ok(
            neph_history_accept(index, neph_store_folder(store), "*", night, "me", "why", &diag),
            &diag);
    }
    neph_database_close(index);
    neph_store_close(store);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_floor_is_a_series),
        cmocka_unit_test(test_the_document_has_ratios),
        scratch_test(test_floors_begin_after_an_accepted_run),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
