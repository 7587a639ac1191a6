/* SPDX-License-Identifier: MIT
 *
 * A report that is published repeatedly: a chart is drawn only once, an existing page stays
 * complete, and folders that neph did not create are put back.
 */
#include "tests/base/scratch.h"
#include "tests/harness/image_test.h"

#include "harness/engines/engines.h"
#include "harness/report/report.h"

#include <sys/stat.h>
#include <unistd.h>

enum { WIDTH = 4, HEIGHT = 3, SCENES_MAX = 2 };

/* A script in place of node: it records that it ran, and copies the specification to the chart. */
static const char node[] =
    "#!/bin/sh\necho run >> \"${0%/bin/node}/runs\"\n/bin/cat \"$2\" > \"$3\"\n";

static void put(void **state, const char *name, const char *text)
{
    char path[SCRATCH_PATH_MAX], folder[SCRATCH_PATH_MAX];
    scratch_path(state, path, name);
    snprintf(folder, sizeof(folder), "%.*s", (int)(strrchr(path, '/') - path), path);
    neph_assert_ok(neph_dir_create(folder, NULL), NULL);
    neph_assert_ok(neph_file_write(path, text, strlen(text), NULL), NULL);
}

static void write_frame(void **state, const char *name, float value)
{
    char path[SCRATCH_PATH_MAX];
    write_image(scratch_path(state, path, name), grey_image(WIDTH, HEIGHT, value));
}

/* A page, a node and frames of the test. */
static int setup(void **state)
{
    static const char *const page[] = {"page.html",     "report.html",     "report.css",
                                       "page.js",       "report.js",       "view.html",
                                       "view.css",      "view.js",         "view_planes.js",
                                       "view_paint.js", "render_chart.mjs"};
    char path[SCRATCH_PATH_MAX];
    if (scratch_setup(state))
        return -1;
    for (size_t i = 0; i < COUNT(page); i++) {
        char name[64];
        snprintf(name, sizeof(name), "data/scripts/report/%s", page[i]);
        put(state, name, page[i]);
    }
    put(state, "bin/node", node);
    chmod(scratch_path(state, path, "bin/node"), 0755);
    char *programs = neph_format("%s:/usr/bin:/bin", scratch_path(state, path, "bin"));
    setenv("PATH", programs, 1);
    free(programs);
    setenv("NEPH_DATA_DIR", scratch_path(state, path, "data"), 1);
    put(state, "runs", "");
    write_frame(state, "exact.exr", 0.25f);
    write_frame(state, "march.exr", 0.5f);
    return 0;
}

static int chart_runs(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct stat info;
    assert_int_equal(stat(scratch_path(state, path, "runs"), &info), 0);
    return (int)info.st_size / (int)strlen("run\n");
}

static struct neph_frame_result make_frame_result(void **state, struct neph_arena *arena,
                                                  const char *engine)
{
    char path[SCRATCH_PATH_MAX], name[64];
    snprintf(name, sizeof(name), "%s.exr", engine);
    return (struct neph_frame_result){
        .engine = neph_engine_find(engine),
        .reason = "",
        .note = "",
        .settings = "",
        .path = neph_arena_copy_text(arena, scratch_path(state, path, name))};
}

/* The truth and one engine. */
static void add_scene(void **state, struct neph_validation *validation, const char *name)
{
    struct neph_arena *arena = &validation->arena;
    struct neph_frame_result *frames = neph_arena_allocate(arena, 2, sizeof(*frames));
    frames[0] = make_frame_result(state, arena, "exact");
    frames[1] = make_frame_result(state, arena, "march");
    validation->scenes[validation->scene_count++] = (struct neph_scene_result){
        .name = name,
        .title = name,
        .physics = "",
        .hash = "",
        .frame_count = 2,
        .frames = frames,
        .difference_scales = {0.1, 0.1}};
}

/* A scene and a chart. */
static struct neph_validation make_validation(void **state)
{
    struct neph_validation made = {.title = "test"};
    made.scenes = neph_arena_allocate(&made.arena, SCENES_MAX, sizeof(*made.scenes));
    made.charts = neph_arena_allocate(&made.arena, 1, sizeof(*made.charts));
    made.chart_count = 1;
    made.charts[0] = (struct neph_chart){
        .id = "speed", .title = "", .caption = "", .spec = json_pack("{s:i}", "width", 1)};
    add_scene(state, &made, "fog");
    return made;
}

static struct neph_report *open_report(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_report *report = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_report_open(scratch_path(state, path, "out/report"), &report, &diag),
                   &diag);
    return report;
}

static void publish(struct neph_report *report, struct neph_validation *validation)
{
    struct neph_diag diag = {0};
    neph_assert_ok(neph_report_publish(report, validation, &diag), &diag);
}

static ino_t read_inode(void **state, const char *name)
{
    char path[SCRATCH_PATH_MAX];
    struct stat info;
    if (stat(scratch_path(state, path, name), &info) != 0)
        fail_msg("%s is not there", path);
    return info.st_ino;
}

/* Whether the data of the published page equals the given one. */
static bool is_published(void **state, const struct neph_validation *validation)
{
    char path[SCRATCH_PATH_MAX];
    json_t *data = json_load_file(scratch_path(state, path, "out/report/data.json"), 0, NULL);
    json_t *expected = neph_validation_json(validation);
    assert_non_null(data);
    assert_non_null(expected);
    const bool same = json_equal(data, expected);
    json_decref(data);
    json_decref(expected);
    return same;
}

static int count_in_out(void **state)
{
    struct scratch inner;
    void *inner_state = &inner;
    snprintf(inner.folder, sizeof(inner.folder), "%.200s/out",
             ((const struct scratch *)*state)->folder);
    return scratch_count(&inner_state);
}

static void test_a_chart_is_drawn_once(void **state)
{
    struct neph_report *report = open_report(state);
    struct neph_validation validation = make_validation(state);
    publish(report, &validation);
    const ino_t picture = read_inode(state, "out/report/images/fog/march.png");
    assert_int_equal(chart_runs(state), 1);
    assert_true(is_published(state, &validation));

    add_scene(state, &validation, "smoke");
    publish(report, &validation);
    assert_true(read_inode(state, "out/report/images/fog/march.png") == picture);
    read_inode(state, "out/report/images/smoke/march.png");
    read_inode(state, "out/report/images/smoke/march_difference_radiance.png");
    read_inode(state, "out/report/charts/speed.svg");
    read_inode(state, "out/report/index.html");
    assert_int_equal(chart_runs(state), 1);
    assert_string_equal(validation.scenes[1].frames[1].picture, "images/smoke/march.png");
    assert_string_equal(validation.charts[0].svg, "charts/speed.svg");
    assert_true(is_published(state, &validation));
    neph_report_close(report);
    assert_int_equal(count_in_out(state), 1); /* only the report */
    neph_validation_finish(&validation);
}

static void test_a_scene_has_a_viewer(void **state)
{
    struct neph_report *report = open_report(state);
    struct neph_validation validation = make_validation(state);
    publish(report, &validation);
    const ino_t frame = read_inode(state, "out/report/view/fog/frames/1_0_radiance.js");
    read_inode(state, "out/report/view/fog/index.html");
    read_inode(state, "out/report/view/fog/view_paint.js");
    publish(report, &validation);
    assert_true(read_inode(state, "out/report/view/fog/frames/1_0_radiance.js") == frame);
    assert_string_equal(validation.scenes[0].viewer, "view/fog/index.html");
    neph_report_close(report);
    neph_validation_finish(&validation);
}

/* A page that a study left next to the report is copied into it, so that the report can be moved.
 * Without such a page there is none. */
static void test_a_page_beside_it_is_taken(void **state)
{
    char folder[SCRATCH_PATH_MAX], page[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    struct neph_report *report = open_report(state);
    struct neph_validation validation = make_validation(state);
    publish(report, &validation);
    assert_false(validation.has_screen);
    neph_assert_ok(neph_dir_create(scratch_path(state, folder, "out/screen"), &diag), &diag);
    neph_assert_ok(
        neph_file_write(scratch_path(state, page, "out/screen/index.html"), "page", 4, &diag),
        &diag);
    publish(report, &validation);
    assert_false(validation.has_screen); /* neph did not create it */
    neph_assert_ok(
        neph_file_write(scratch_path(state, page, "out/screen/.neph-owned"), "neph", 4, &diag),
        &diag);
    publish(report, &validation);
    publish(report, &validation);
    assert_true(validation.has_screen);
    read_inode(state, "out/report/screen/index.html");
    json_t *json = neph_validation_json(&validation);
    assert_string_equal(json_string_value(json_object_get(json, "screen")), "screen/index.html");
    json_decref(json);
    neph_report_close(report);
    neph_validation_finish(&validation);
}

/* There is no viewer where a frame is no measurement, or where space is insufficient; the report is
 * published anyway. */
static void test_a_scene_may_have_no_viewer(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_report *report = open_report(state);
    struct neph_validation validation = make_validation(state);
    write_frame(state, "march.exr", NAN);
    publish(report, &validation);
    assert_null(validation.scenes[0].viewer);
    assert_false(neph_path_exists(scratch_path(state, path, "out/report/view/fog")));
    write_frame(state, "march.exr", 0.5f);
    add_scene(state, &validation, "smoke");
    validation.scenes[1].width_px = validation.scenes[1].height_px = 1024;
    publish(report, &validation);
    assert_null(validation.scenes[1].viewer);
    read_inode(state, "out/report/images/smoke/march.png");
    assert_true(is_published(state, &validation));
    neph_report_close(report);
    neph_validation_finish(&validation);
}

static void test_a_failure_leaves_the_report_before(void **state)
{
    struct neph_report *report = open_report(state);
    struct neph_validation validation = make_validation(state);
    publish(report, &validation);
    const ino_t page = read_inode(state, "out/report");
    add_scene(state, &validation, "smoke");
    validation.scenes[1].frames[1].path = "/nowhere.exr";
    struct neph_diag diag = {0};
    assert_int_equal(neph_report_publish(report, &validation, &diag), NEPH_ERR_NOT_FOUND);
    assert_true(read_inode(state, "out/report") == page);
    neph_report_close(report);
    assert_int_equal(count_in_out(state), 1);
    neph_validation_finish(&validation);
}

static void test_the_last_of_two_runs_stands(void **state)
{
    struct neph_report *first = open_report(state), *second = open_report(state);
    struct neph_validation one = make_validation(state), two = make_validation(state);
    one.title = "one";
    two.title = "two";
    publish(first, &one);
    publish(second, &two);
    neph_report_close(second);
    assert_true(is_published(state, &two));
    publish(first, &one);
    neph_report_close(first);
    assert_true(is_published(state, &one));
    assert_int_equal(count_in_out(state), 1);
    neph_validation_finish(&one);
    neph_validation_finish(&two);
}

static void test_folders_of_others_are_given_back(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    struct neph_report *report = open_report(state);
    struct neph_validation validation = make_validation(state);
    put(state, "out/report/thesis.tex", "put there while neph was rendering");
    assert_int_equal(neph_report_publish(report, &validation, &diag), NEPH_ERR_USAGE);
    assert_non_null(strstr(diag.message, scratch_path(state, path, "out/report")));
    neph_report_close(report);
    read_inode(state, "out/report/thesis.tex");
    assert_int_equal(count_in_out(state), 1);
    report = NULL;
    assert_int_equal(neph_report_open(path, &report, &diag), NEPH_ERR_USAGE);
    neph_validation_finish(&validation);
}

static void test_a_link_to_a_report_stays_a_link(void **state)
{
    char path[SCRATCH_PATH_MAX], target[SCRATCH_PATH_MAX];
    struct stat info;
    neph_assert_ok(neph_dir_create(scratch_path(state, target, "elsewhere/page"), NULL), NULL);
    neph_assert_ok(neph_dir_create(scratch_path(state, path, "out"), NULL), NULL);
    assert_int_equal(symlink(target, scratch_path(state, path, "out/report")), 0);
    struct neph_report *report = open_report(state);
    struct neph_validation validation = make_validation(state);
    publish(report, &validation);
    publish(report, &validation);
    neph_report_close(report);
    assert_int_equal(lstat(path, &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    read_inode(state, "elsewhere/page/index.html");
    neph_validation_finish(&validation);
}

static void assert_verdict(const struct neph_validation *validation, const char *expected)
{
    char text[256] = "";
    FILE *out = fmemopen(text, sizeof(text), "w");
    neph_validation_print_verdict(validation, out);
    fclose(out);
    assert_string_equal(text, expected);
}

/* "pass" refers only to frames that were compared. */
static void test_a_verdict_names_the_engines_that_it_is_without(void **state)
{
    struct neph_validation made = make_validation(state);
    add_scene(state, &made, "cloud");
    made.field = (struct neph_run_engines){
        .count = 2, .engines = {neph_engine_find("exact"), neph_engine_find("march")}};
    struct neph_frame_result *fog = &made.scenes[0].frames[1], *cloud = &made.scenes[1].frames[1];
    assert_verdict(&made, "pass");
    fog->outcome = NEPH_OUTCOME_OVER_BUDGET;
    assert_verdict(&made, "pass, without march in 1 of 2 scenes (did not fit its budget)");
    cloud->note = "64 samples per pixel did not fit into 30 s";
    assert_verdict(&made, "pass, without march in 1 of 2 scenes (did not fit its budget), "
                          "with fewer samples than set for march in 1 of 2 scenes");
    cloud->is_look = true;
    fog->outcome = cloud->outcome = NEPH_OUTCOME_MISSING;
    assert_verdict(&made, "pass, without march (not installed)");
    fog->outcome = cloud->outcome = NEPH_OUTCOME_CANNOT;
    made.verdict = NEPH_VERDICT_FAIL;
    assert_verdict(&made, "fail");
    neph_validation_finish(&made);
}

#define report_test(function) cmocka_unit_test_setup_teardown(function, setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        report_test(test_a_chart_is_drawn_once),
        report_test(test_a_scene_has_a_viewer),
        report_test(test_a_page_beside_it_is_taken),
        report_test(test_a_scene_may_have_no_viewer),
        report_test(test_a_failure_leaves_the_report_before),
        report_test(test_the_last_of_two_runs_stands),
        report_test(test_folders_of_others_are_given_back),
        report_test(test_a_link_to_a_report_stays_a_link),
        report_test(test_a_verdict_names_the_engines_that_it_is_without),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
