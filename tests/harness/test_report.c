/* SPDX-License-Identifier: MIT
 *
 * A report that is published again and again: what is drawn is drawn once, what changed is drawn
 * anew, the page that is there stays whole, and what is not neph's is given back.
 */
#include "tests/base/scratch.h"

#include "base/exr.h"
#include "harness/report/report.h"

#include <sys/stat.h>
#include <unistd.h>

enum { WIDTH = 4, HEIGHT = 3 };

/* A node that writes down that it ran, and copies the specification to the chart. */
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
    struct neph_image *image;
    float *planes[3];
    neph_assert_ok(neph_image_create(WIDTH, HEIGHT, &image, NULL), NULL);
    neph_assert_ok(neph_image_add_rgb(image, NULL, planes, NULL), NULL);
    for (int p = 0; p < WIDTH * HEIGHT; p++)
        planes[0][p] = planes[1][p] = planes[2][p] = value;
    neph_assert_ok(neph_exr_write(scratch_path(state, path, name), image, NULL), NULL);
    neph_image_destroy(image);
}

/* A page, a node and frames of the test's own. */
static int setup(void **state)
{
    static const char *const page[] = {"index.html", "report.css", "report.js", "render_chart.mjs"};
    char path[SCRATCH_PATH_MAX];
    if (scratch_setup(state))
        return -1;
    for (int i = 0; i < 4; i++) {
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

static json_t *frame_json(void **state, const char *engine)
{
    char path[SCRATCH_PATH_MAX], name[64];
    snprintf(name, sizeof(name), "%s.exr", engine);
    return json_pack("{s:s, s:s, s:n, s:{s:n, s:n}}", "engine", engine, "exr",
                     scratch_path(state, path, name), "picture", "difference", "radiance",
                     "transmittance");
}

static json_t *scene_json(void **state, const char *name)
{
    return json_pack("{s:s, s:f, s:{s:s}, s:{s:f, s:f}, s:[o, o]}", "name", name, "exposure_ev",
                     0.0, "truth", "engine", "exact", "difference_scale", "radiance", 0.1,
                     "transmittance", 0.1, "frames", frame_json(state, "exact"),
                     frame_json(state, "march"));
}

static json_t *document_json(void **state)
{
    return json_pack("{s:s, s:[o], s:[{s:s, s:{s:i}}]}", "format", "neph-report-1", "scenes",
                     scene_json(state, "fog"), "charts", "id", "speed", "spec", "width", 1);
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

static void publish(struct neph_report *report, json_t *document)
{
    struct neph_diag diag = {0};
    neph_assert_ok(neph_report_publish(report, document, &diag), &diag);
}

static ino_t inode_of(void **state, const char *name)
{
    char path[SCRATCH_PATH_MAX];
    struct stat info;
    if (stat(scratch_path(state, path, name), &info) != 0)
        fail_msg("%s is not there", path);
    return info.st_ino;
}

static json_t *published(void **state)
{
    char path[SCRATCH_PATH_MAX];
    json_t *data = json_load_file(scratch_path(state, path, "out/report/data.json"), 0, NULL);
    assert_non_null(data);
    return data;
}

static int count_in_out(void **state)
{
    struct scratch inner;
    void *inner_state = &inner;
    snprintf(inner.folder, sizeof(inner.folder), "%.200s/out",
             ((const struct scratch *)*state)->folder);
    return scratch_count(&inner_state);
}

static void test_what_is_drawn_is_drawn_once(void **state)
{
    struct neph_report *report = open_report(state);
    json_t *document = document_json(state);
    publish(report, document);
    const ino_t picture = inode_of(state, "out/report/images/fog/march.png");
    assert_int_equal(chart_runs(state), 1);

    /* The next scene is done; the document is another object with the same in it. */
    json_t *next = document_json(state);
    neph_assert_ok(
        neph_json_append(json_object_get(next, "scenes"), scene_json(state, "smoke"), NULL), NULL);
    publish(report, next);
    assert_true(inode_of(state, "out/report/images/fog/march.png") == picture);
    inode_of(state, "out/report/images/smoke/march.png");
    inode_of(state, "out/report/images/smoke/march_difference_radiance.png");
    inode_of(state, "out/report/charts/speed.svg");
    inode_of(state, "out/report/index.html");
    assert_int_equal(chart_runs(state), 1);
    assert_true(json_equal(json_array_get(json_object_get(document, "scenes"), 0),
                           json_array_get(json_object_get(next, "scenes"), 0)));
    assert_true(json_equal(json_object_get(document, "charts"), json_object_get(next, "charts")));
    json_t *data = published(state);
    assert_true(json_equal(data, next));
    neph_report_close(report);
    assert_int_equal(count_in_out(state), 1); /* the report alone */
    json_decref(data);
    json_decref(document);
    json_decref(next);
}

static void test_what_changed_is_drawn_anew(void **state)
{
    struct neph_report *report = open_report(state);
    json_t *document = document_json(state);
    publish(report, document);
    const ino_t picture = inode_of(state, "out/report/images/fog/march.png");
    const ino_t chart = inode_of(state, "out/report/charts/speed.svg");
    json_t *scene = json_array_get(json_object_get(document, "scenes"), 0);
    neph_assert_ok(neph_json_put(scene, "exposure_ev", json_real(1.0), NULL), NULL);
    json_t *spec = json_object_get(json_array_get(json_object_get(document, "charts"), 0), "spec");
    neph_assert_ok(neph_json_put(spec, "width", json_integer(2), NULL), NULL);
    publish(report, document);
    assert_false(inode_of(state, "out/report/images/fog/march.png") == picture);
    assert_false(inode_of(state, "out/report/charts/speed.svg") == chart);
    assert_int_equal(chart_runs(state), 2);
    neph_report_close(report);
    json_decref(document);
}

static void test_a_failure_leaves_the_report_before(void **state)
{
    struct neph_report *report = open_report(state);
    json_t *document = document_json(state), *broken = document_json(state);
    publish(report, document);
    const ino_t page = inode_of(state, "out/report");
    json_t *frames = json_object_get(json_array_get(json_object_get(broken, "scenes"), 0),
                                     "frames");
    neph_assert_ok(
        neph_json_put(json_array_get(frames, 1), "exr", json_string("/nowhere.exr"), NULL), NULL);
    struct neph_diag diag = {0};
    assert_int_equal(neph_report_publish(report, broken, &diag), NEPH_ERR_NOT_FOUND);
    assert_true(inode_of(state, "out/report") == page);
    neph_report_close(report);
    assert_int_equal(count_in_out(state), 1);
    json_decref(document);
    json_decref(broken);
}

static void test_the_last_of_two_runs_stands(void **state)
{
    struct neph_report *first = open_report(state), *second = open_report(state);
    json_t *one = document_json(state), *two = document_json(state);
    neph_assert_ok(neph_json_put(one, "title", json_string("one"), NULL), NULL);
    neph_assert_ok(neph_json_put(two, "title", json_string("two"), NULL), NULL);
    publish(first, one);
    publish(second, two);
    neph_report_close(second);
    json_t *data = published(state);
    assert_true(json_equal(data, two));
    json_decref(data);
    publish(first, one);
    neph_report_close(first);
    data = published(state);
    assert_true(json_equal(data, one));
    assert_int_equal(count_in_out(state), 1);
    json_decref(data);
    json_decref(one);
    json_decref(two);
}

static void test_folders_of_others_are_given_back(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_diag diag = {0};
    struct neph_report *report = open_report(state);
    json_t *document = document_json(state);
    put(state, "out/report/thesis.tex", "put there while neph was rendering");
    assert_int_equal(neph_report_publish(report, document, &diag), NEPH_ERR_USAGE);
    assert_non_null(strstr(diag.message, scratch_path(state, path, "out/report")));
    neph_report_close(report);
    inode_of(state, "out/report/thesis.tex");
    assert_int_equal(count_in_out(state), 1);
    report = NULL;
    assert_int_equal(neph_report_open(path, &report, &diag), NEPH_ERR_USAGE);
    json_decref(document);
}

static void test_a_link_to_a_report_stays_a_link(void **state)
{
    char path[SCRATCH_PATH_MAX], target[SCRATCH_PATH_MAX];
    struct stat info;
    neph_assert_ok(neph_dir_create(scratch_path(state, target, "elsewhere/page"), NULL), NULL);
    neph_assert_ok(neph_dir_create(scratch_path(state, path, "out"), NULL), NULL);
    assert_int_equal(symlink(target, scratch_path(state, path, "out/report")), 0);
    struct neph_report *report = open_report(state);
    json_t *document = document_json(state);
    publish(report, document);
    publish(report, document);
    neph_report_close(report);
    assert_int_equal(lstat(path, &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    inode_of(state, "elsewhere/page/index.html");
    json_decref(document);
}

#define report_test(function) cmocka_unit_test_setup_teardown(function, setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        report_test(test_what_is_drawn_is_drawn_once),
        report_test(test_what_changed_is_drawn_anew),
        report_test(test_a_failure_leaves_the_report_before),
        report_test(test_the_last_of_two_runs_stands),
        report_test(test_folders_of_others_are_given_back),
        report_test(test_a_link_to_a_report_stays_a_link),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
