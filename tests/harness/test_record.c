/* SPDX-License-Identifier: MIT
 *
 * Records: a struct, its JSON and its table row agree.
 */
#include "tests/base/scratch.h"

#include "harness/json_file.h"
#include "harness/run/record.h"

struct sample {
    const char *name, *note;
    int64_t count, size_px[2];
    double value, error;
};
#define SAMPLE(member) NEPH_RECORD_FIELD(struct sample, member)
static const struct neph_record_form form = {
    sizeof(struct sample),
    {SAMPLE(name), NEPH_RECORD_OPTIONAL(struct sample, note), SAMPLE(count), SAMPLE(size_px),
     SAMPLE(value), NEPH_RECORD_OPTIONAL(struct sample, error)}};

static const struct sample samples[] = {
    {"fog", "", 7, {96, 54}, 0.1, NAN},
    {"\"sea\" / \xc3\xa9", "less", -(INT64_C(1) << 52) - 1, {0, 1}, -1e-300, 0.25},
};

static void test_a_record_survives_json_and_the_database(void **state)
{
    static const char *const steps[] = {
        "CREATE TABLE rows (id INTEGER PRIMARY KEY, name TEXT, note TEXT, count INTEGER, width "
        "INTEGER, height INTEGER, value REAL, error REAL) STRICT",
        NULL};
    char path[SCRATCH_PATH_MAX];
    struct neph_database *database = NULL;
    neph_assert_ok(neph_database_open(scratch_path(state, path, "a"), steps, &database, NULL),
                   NULL);
    for (size_t i = 0; i < COUNT(samples); i++) {
        json_t *json = neph_record_json(&form, &samples[i]), *list = NULL;
        struct sample read;
        assert_int_equal(json_object_size(json), samples[i].note[0] ? 6 : 5);
        neph_record_read(&form, json, NULL, &read);
        json_t *again = neph_record_json(&form, &read);
        assert_true(json_equal(json, again));
        neph_assert_ok(neph_record_put(database, NULL,
                                       "INSERT INTO rows VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
                                       (int64_t)i + 1, &form, &read),
                       NULL);
        neph_assert_ok(neph_record_list(database, &form, &list, NULL,
                                        "SELECT name, note, count, width, height, value, error "
                                        "FROM rows WHERE id = ?",
                                        "i", (int64_t)i + 1),
                       NULL);
        assert_int_equal(json_array_size(list), 1);
        assert_true(json_equal(json_array_get(list, 0), json));
        json_decref(list);
        json_decref(again);
        json_decref(json);
    }
    neph_database_close(database);
}

static void test_records_that_differ_in_any_field(void **state)
{
    const struct sample one = {"a", "b", 1, {2, 3}, 4.0, 5.0};
    struct sample others[] = {one, one, one, one, one, one, one};
    others[0].name = "c";
    others[1].note = "";
    others[2].count = 2;
    others[3].size_px[0] = 3;
    others[4].size_px[1] = 2;
    others[5].value = 4.5;
    others[6].error = NAN;
    assert_true(neph_record_is_equal(&form, &one, &one));
    for (size_t i = 0; i < COUNT(others); i++)
        assert_false(neph_record_is_equal(&form, &one, &others[i]));
}

static void test_missing_json_keys_are_empty(void **state)
{
    struct sample read;
    neph_record_read(&form, NULL, NULL, &read);
    assert_string_equal(read.name, "");
    assert_true(read.count == 0 && read.size_px[1] == 0 && read.value == 0.0 && isnan(read.error));
    const struct sample broken = {"\xff", "", 0, {0, 0}, 0.0, 0.0},
                        infinite = {"a", "", .value = NAN};
    assert_null(neph_record_json(&form, &broken));
    assert_null(neph_record_json(&form, &infinite));
}

/* The order of keys does not matter. */
static void test_a_digest_depends_on_json_content(void **state)
{
    char path[SCRATCH_PATH_MAX], a[NEPH_HASH_HEX_SIZE], b[NEPH_HASH_HEX_SIZE];
    json_t *one = json_pack("{s:i, s:f}", "a", 1, "b", 0.1), *read = NULL;
    json_t *other = json_pack("{s:f, s:i}", "b", 0.1, "a", 1);
    neph_assert_ok(neph_json_digest(one, a, NULL), NULL);
    neph_assert_ok(neph_json_write(other, JSON_INDENT(3), scratch_path(state, path, "x"), NULL),
                   NULL);
    neph_assert_ok(neph_json_read(path, 1000, &read, NULL), NULL);
    neph_assert_ok(neph_json_digest(read, b, NULL), NULL);
    assert_string_equal(a, b);
    assert_int_equal(neph_json_read(path, 3, &read, NULL), NEPH_ERR_INPUT);
    assert_int_equal(neph_json_write(NULL, 0, path, NULL), NEPH_ERR_MEMORY);
    json_decref(one);
    json_decref(other);
    json_decref(read);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_a_record_survives_json_and_the_database),
        cmocka_unit_test(test_records_that_differ_in_any_field),
        cmocka_unit_test(test_missing_json_keys_are_empty),
        scratch_test(test_a_digest_depends_on_json_content),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
