/* SPDX-License-Identifier: MIT
 *
 * The size limit of the stress tests' page: the worst scenarios have images, even if they fail
 * late, and omitted ones are counted.
 */
#include "tests/base/scratch.h"

#include "base/files.h"
#include "harness/engines/engines.h"
#include "harness/json.h"
#include "harness/report/report_folder.h"
#include "harness/stress/page.h"

#include <math.h>

enum { SCENES = 3, PICTURE_BYTES = 40000 };

/* One scenario each, with one measure in one column. */
struct fixture {
    char names[SCENES][16], exhibits[SCENES][SCRATCH_PATH_MAX], page_folder[SCRATCH_PATH_MAX];
    struct neph_failing_limit limit;
    struct neph_failing failing;
    struct neph_scene scenes[SCENES], *listed[SCENES];
    struct neph_stress_cell cells[SCENES];
    struct neph_stress_row rows[SCENES];
    struct neph_stress_suite suite;
};

/* An entry of a store: a record, and an image of a given size. */
static void make_exhibit(void **state, struct fixture *fixture, int number)
{
    static const char record[] = "{\"pictures\": [\"worst.png\"], \"worst_frame\": 3}";
    static const uint8_t picture[PICTURE_BYTES] = {0};
    char name[32], path[SCRATCH_PATH_MAX + 16];
    snprintf(name, sizeof(name), "exhibit%d", number);
    scratch_path(state, fixture->exhibits[number], name);
    neph_assert_ok(neph_dir_create(fixture->exhibits[number], NULL), NULL);
    snprintf(path, sizeof(path), "%s/job.json", fixture->exhibits[number]);
    scratch_write(path, record, strlen(record));
    snprintf(path, sizeof(path), "%s/worst.png", fixture->exhibits[number]);
    scratch_write(path, picture, sizeof(picture));
}

static void start(void **state, struct fixture *fixture)
{
    static char words[] = "words", nobody[] = "";
    *fixture = (struct fixture){.limit = {.over = words, .limit = 1.0, .reason = words}};
    fixture->suite = (struct neph_stress_suite){
        .column_count = 1,
        .columns = {{"fixed", neph_engine_find("realtime"), true}},
        .scene_count = SCENES,
        .row_count = SCENES,
        .scenes = fixture->listed,
        .rows = fixture->rows,
    };
    fixture->failing = (struct neph_failing){words,  words,          words,
                                             nobody, .width_px = 96, .height_px = 54};
    for (int i = 0; i < SCENES; i++) {
        make_exhibit(state, fixture, i);
        snprintf(fixture->names[i], sizeof(fixture->names[i]), "scene%d", i);
        fixture->scenes[i] = (struct neph_scene){
            .name = fixture->names[i], .title = words, .failing = &fixture->failing};
        fixture->listed[i] = &fixture->scenes[i];
        fixture->cells[i] = (struct neph_stress_cell){NAN, NEPH_STRESS_NOT_YET, "", NULL, NULL};
        fixture->rows[i] = (struct neph_stress_row){.scene = &fixture->scenes[i],
                                                    .point = "",
                                                    .limit = &fixture->limit,
                                                    .cells = &fixture->cells[i]};
    }
    scratch_path(state, fixture->page_folder, "report");
}

static void fail_cell(struct fixture *fixture, int number, double value)
{
    fixture->cells[number] = (struct neph_stress_cell){value, NEPH_STRESS_FAIL, "",
                                                       fixture->exhibits[number], NULL};
}

/* The scenes with evidence, as bits; the folder has as many images. */
static int shown(const struct fixture *fixture, int *left_out)
{
    char path[SCRATCH_PATH_MAX + 64];
    snprintf(path, sizeof(path), "%s/data.json", fixture->page_folder);
    json_t *data = json_load_file(path, 0, NULL);
    const json_t *evidence = json_object_get(data, "evidence");
    int bits = 0, pictures = 0;
    for (size_t i = 0; i < json_array_size(evidence); i++)
        for (int s = 0; s < SCENES; s++)
            bits |= strcmp(neph_json_text(json_array_get(evidence, i), "scene"),
                           fixture->names[s]) == 0
                        ? 1 << s
                        : 0;
    for (int s = 0; s < SCENES; s++) {
        snprintf(path, sizeof(path), "%s/images/exhibit%d/worst.png", fixture->page_folder, s);
        pictures |= neph_path_exists(path) ? 1 << s : 0;
    }
    assert_int_equal(pictures, bits);
    *left_out = (int)json_integer_value(
        json_object_get(json_object_get(data, "pictures"), "left_out"));
    json_decref(data);
    return bits;
}

static void publish(const struct fixture *fixture, struct neph_stress_page *page)
{
    struct neph_diag diag = {.line = 0};
    neph_assert_ok(neph_stress_page_publish(&fixture->suite, page, &diag), &diag);
}

/* Space for two of three, besides a page of about 50 kB and its data. */
static void test_the_worst_have_images(void **state)
{
    struct fixture fixture;
    struct neph_stress_page page = {.limit_bytes = 2 * PICTURE_BYTES + 80000};
    int left_out;
    start(state, &fixture);
    neph_assert_ok(neph_stress_page_open(fixture.page_folder, &page, NULL), NULL);
    publish(&fixture, &page);
    assert_int_equal(shown(&fixture, &left_out), 0);
    fail_cell(&fixture, 0, 2.0);
    fail_cell(&fixture, 1, 3.0);
    publish(&fixture, &page);
    assert_int_equal(shown(&fixture, &left_out), 1 | 2);
    assert_int_equal(left_out, 0);
    fail_cell(&fixture, 2, 9.0); /* the worst, and the last */
    publish(&fixture, &page);
    assert_int_equal(shown(&fixture, &left_out), 2 | 4);
    assert_int_equal(left_out, 1);
    neph_report_folder_close(page.folder);
}

/* A folder that neph did not create stays unchanged. */
static void test_a_foreign_folder_is_refused(void **state)
{
    struct neph_stress_page page = {.limit_bytes = 1000000};
    char folder[SCRATCH_PATH_MAX], path[SCRATCH_PATH_MAX];
    scratch_path(state, folder, "theirs");
    neph_assert_ok(neph_dir_create(folder, NULL), NULL);
    scratch_write(scratch_path(state, path, "theirs/letter.txt"), "dear", 4);
    assert_int_equal(neph_stress_page_open(folder, &page, NULL), NEPH_ERR_USAGE);
    assert_null(page.folder);
    assert_true(neph_path_exists(path));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_the_worst_have_images),
        scratch_test(test_a_foreign_folder_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
