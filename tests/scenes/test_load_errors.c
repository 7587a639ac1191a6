/* SPDX-License-Identifier: MIT
 *
 * All errors of a scene file are reported at once: each once, in the order of lines, without
 * consequential errors. The name of a scene, and optional keys.
 */
#include "tests/base/scratch.h"

#include "base/files.h"
#include "scenes/scene.h"

#define START                                                                                      \
    "title: a probe\n"                                                                             \
    "camera: {position_m: [0, 1, 5], look_at_m: [0, 1, 0], vertical_fov_deg: 40}\n"                \
    "scattering: single\n"

/* Writes `text` as `name` in a new folder, loads it, removes it. */
static enum neph_status load_as(const char *name, const char *text, struct neph_scene **scene,
                                struct neph_diag *diag)
{
    char folder[] = "/tmp/neph-load-XXXXXX";
    assert_non_null(mkdtemp(folder));
    char *path = neph_path_join(folder, name);
    scratch_write(path, text, strlen(text));
    *scene = NULL;
    const enum neph_status status = neph_scene_load(path, scene, diag);
    free(path);
    neph_dir_remove(folder, NULL);
    return status;
}

enum { EXPECTED_MAX = 8 };

/* From line 4 on, after START; each error as "LINE: words" of its message. */
static const struct wrong {
    const char *text, *errors[EXPECTED_MAX];
} wrong[] = {
    /* Values of one mapping, of entries of a list, of one list of numbers. */
    {"sun: {direction: [0, 0, 0], irradiance_w_per_m2: [1, -2, -3]}\n",
     {"4: length 0", "4: irradiance_w_per_m2[1]: -2", "4: irradiance_w_per_m2[2]: -3"}},
    {"lights:\n"
     "  - {position_m: [0, 1, 0], intensity_w_per_sr: [-1, 1, 1]}\n"
     "  - {position_m: [0, far, 0], intensity_w_per_sr: [1, 1, 1]}\n"
     "  - {position_m: [0, 1, 0]}\n",
     {"5: -1 is outside", "6: found 'far'",
      "7: lights[2]: give position_m and intensity_w_per_sr"}},
    /* A misspelled key is not reported as missing, too; the other keys of its mapping are read. */
    {"sun: {direktion: [0, 1, 0], irradiance_w_per_m2: [1, 1]}\n"
     "media:\n"
     "  - homogeneous: {extinktion_per_m: 1, albedo: [2, 1, 1],\n"
     "      bounds: {min_m: [0, 0, 0], max_m: [1, 1, 1]}}\n",
     {"4: unknown key 'direktion'", "4: found a list of 2", "6: unknown key 'extinktion_per_m'",
      "6: albedo[0]: 2"}},
    /* Checks of several keys run only where these keys are valid. */
    {"solids:\n"
     "  - box: {min_m: [0, 0, 0], max_m: [-1, 1, -1], albedo: [1, 7, 1]}\n"
     "  - box: {min_m: [0, none, 0], max_m: [-1, 1, -1], albedo: [1, 1, 1]}\n",
     {"5: max_m[0]: -1 m is not above", "5: max_m[2]", "5: albedo[1]: 7", "6: found 'none'"}},
    /* A light inside a solid; not tested if the solids are wrong. */
    {"solids: [{sphere: {center_m: [0, 1, 0], radius_m: 2, albedo: [1, 1, 1]}}]\n"
     "lights: [{position_m: [0, 1, 0], intensity_w_per_sr: [1, 1, 1]}]\n"
     "background_w_per_m2_sr: blue\n",
     {"5: inside a solid", "6: found 'blue'"}},
    {"solids: [{sphere: {center_m: [0, 1, 0], radius_m: -2, albedo: [1, 1, 1]}}]\n"
     "lights: [{position_m: [0, 1, 0], intensity_w_per_sr: [1, 1, 1]}]\n",
     {"4: radius_m: -2"}},
    /* No medium drifts; but if a medium is wrong, only the medium is reported. */
    {"wind: {velocity_m_per_s: [1, 0, 0]}\n", {"4: no medium of the scene drifts"}},
    {"wind: {velocity_m_per_s: [1, 0, 0]}\n"
     "media: [{gausian: {center_m: [0, 1, 0]}}]\n",
     {"5: unknown key 'gausian'"}},
    /* A missing file, next to a wrong number. */
    {"media:\n"
     "  - volume: {file: none.vdb, extinction_per_m: 1, albedo: [1, 1, 3]}\n"
     "  - volume: {file: none.raw, extinction_per_m: 1, albedo: [1, 1, 1]}\n",
     {"5: cannot read the volume 'none.vdb'", "5: albedo[2]: 3",
      "6: must end in .vdb, .df3, .nc"}},
    /* A duplicate key. */
    {"scattering: none\nbake_resolution: 1\n", {"4: stands twice", "5: 1 is outside 2 to 1024"}},
};

/* The number of lines in `text` that begin with a position in probe.yaml. */
static int count_error_lines(const char *text)
{
    int count = 0;
    for (const char *at = text; (at = strstr(at, "probe.yaml:")); at++)
        count++;
    return count;
}

static void check_error(const struct wrong *row, const char *expected, const char *found)
{
    char place[32];
    const char *words = strchr(expected, ' ') + 1;
    snprintf(place, sizeof(place), "probe.yaml:%.*s:", (int)strcspn(expected, ":"), expected);
    const char *at = found ? strstr(found, place) : NULL;
    const size_t length = at ? strcspn(at, "\n") : 0;
    char line[1024] = "";
    snprintf(line, sizeof(line), "%.*s", (int)length, at ? at : "");
    if (!at || (size_t)(at - found) > strcspn(found, "\n") || !strstr(line, words))
        fail_msg("%s: expected '%s' of:\n%s", row->text, expected, found ? found : "nothing");
}

static void test_all_errors_are_reported_once(void **state)
{
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        struct neph_diag diag = {.line = 0};
        struct neph_scene *scene;
        char first[2048], all[12000];
        char *text = neph_format("%s%s", START, wrong[i].text);
        assert_int_equal(load_as("probe.yaml", text, &scene, &diag), NEPH_ERR_INPUT);
        free(text);
        neph_diag_format(&diag, "", first, sizeof(first));
        snprintf(all, sizeof(all), "%s%s", first, diag.more);
        int count = 0;
        const char *at = all;
        for (; count < EXPECTED_MAX && wrong[i].errors[count]; count++) {
            at = at ? strstr(at, "/tmp/neph-load-") : NULL;
            check_error(&wrong[i], wrong[i].errors[count], at);
            at++;
        }
        if (count_error_lines(all) != count)
            fail_msg("%s: %d errors, not %d:\n%s", wrong[i].text, count_error_lines(all), count,
                     all);
    }
}

/* A file full of errors is read only up to the first 32 of them. */
static void test_reading_ends(void **state)
{
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene;
    char *text = strdup(START "lights:\n");
    for (int i = 0; i < 16; i++) {
        char *longer = neph_format("%s  - {position_m: [x, y, z], intensity_w_per_sr: no}\n", text);
        free(text);
        text = longer;
    }
    assert_int_equal(load_as("probe.yaml", text, &scene, &diag), NEPH_ERR_INPUT);
    free(text);
    assert_int_equal(diag.line, 5);
    assert_true(count_error_lines(diag.more) > 20 && count_error_lines(diag.more) < 32);
    assert_non_null(strstr(diag.more, "reading ended after 32 errors, of which "));
    assert_true(strlen(diag.more) < sizeof(diag.more));
}

/* A file that is not a mapping has no missing keys. */
static void test_a_file_of_another_form(void **state)
{
    static const char *const texts[] = {"a word\n", "[1, 2]\n"};
    for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
        struct neph_diag diag = {.line = 0};
        struct neph_scene *scene;
        assert_int_equal(load_as("probe.yaml", texts[i], &scene, &diag), NEPH_ERR_INPUT);
        assert_non_null(strstr(diag.message, "expected a mapping"));
        assert_string_equal(diag.more, "");
    }
}

/* After a single error the list of further errors is empty. */
static void test_a_single_error(void **state)
{
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene;
    assert_int_equal(load_as("probe.yaml", START "bake_resolution: 0\n", &scene, &diag),
                     NEPH_ERR_INPUT);
    assert_string_equal(diag.more, "");
    assert_int_equal(diag.line, 4);
}

/* Missing data is the status if nothing else is wrong; a wrong value takes precedence. */
static void test_status_of_several(void **state)
{
    static const char missing[] = START "media:\n  - volume: {file: none.vdb, extinction_per_m: 1, "
                                        "albedo: [1, 1, 1]}\n";
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene;
    assert_int_equal(load_as("probe.yaml", missing, &scene, &diag), NEPH_ERR_NOT_FOUND);
    char *text = neph_format("%sbake_resolution: 0\n", missing);
    assert_int_equal(load_as("probe.yaml", text, &scene, &diag), NEPH_ERR_INPUT);
    free(text);
    assert_non_null(strstr(diag.message, "none.vdb"));
    assert_non_null(strstr(diag.more, "bake_resolution"));
}

static bool refuse_metrics(const char *metric, char *why, size_t size)
{
    snprintf(why, size, "is no metric");
    return strcmp(metric, "known") == 0;
}

static void test_metrics_of_gates_are_checked(void **state)
{
    static const char text[] = START
        "gates:\n"
        "  - {engine: march, quantity: radiance, metric: known, maximum: 1, reason: r}\n"
        "  - {engine: march, quantity: radiance, metric: other, maximum: 1, reason: r}\n"
        "environment_light: perhaps\n";
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene = NULL;
    char path[SCRATCH_PATH_MAX];
    scratch_write(scratch_path(state, path, "probe.yaml"), text, strlen(text));
    assert_int_equal(neph_scene_load_checked(path, refuse_metrics, &scene, &diag), NEPH_ERR_INPUT);
    assert_string_equal(diag.message, "gates[1].metric: 'other' is no metric");
    assert_int_equal(diag.line, 6);
    assert_int_equal(count_error_lines(diag.more), 1);
    assert_non_null(strstr(diag.more, "probe.yaml:7:20: environment_light"));
}

/* --- optional keys ---------- */

static void hash_scene_text(const char *name, const char *text, char hash[NEPH_HASH_HEX_SIZE])
{
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene;
    neph_assert_ok(load_as(name, text, &scene, &diag), &diag);
    memcpy(hash, scene->hash, NEPH_HASH_HEX_SIZE);
    neph_scene_destroy(scene);
}

static void test_a_scene_is_called_like_its_file(void **state)
{
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene;
    char without[NEPH_HASH_HEX_SIZE], with[NEPH_HASH_HEX_SIZE];
    neph_assert_ok(load_as("my_fog.yaml", START, &scene, &diag), &diag);
    assert_string_equal(scene->name, "my_fog");
    assert_string_equal(scene->description, "");
    assert_null(scene->warning);
    neph_scene_destroy(scene);
    hash_scene_text("my_fog.yaml", START, without);
    hash_scene_text("my_fog.yaml", "name: my_fog\ndescription: words\n" START, with);
    assert_string_equal(with, without);
}

static void test_names_of_files_that_are_none(void **state)
{
    static const char *const names[] = {"My fog.yaml", "fog-1.yaml", ".yaml",
                                        "a2345678901234567890123456789012345678901234567890123456"
                                        "78901234x.yaml"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        struct neph_diag diag = {.line = 0};
        struct neph_scene *scene;
        assert_int_equal(load_as(names[i], START, &scene, &diag), NEPH_ERR_INPUT);
        assert_non_null(strstr(diag.message, "rename the file: 1 to 64 of a-z, 0-9 and _"));
        assert_int_equal(diag.line, 1);
    }
}

static void test_the_older_name_of_description(void **state)
{
    struct neph_diag diag = {.line = 0};
    struct neph_scene *scene;
    neph_assert_ok(load_as("probe.yaml", START "physics: words\n", &scene, &diag), &diag);
    assert_string_equal(scene->description, "words");
    assert_non_null(strstr(scene->warning, "probe.yaml:4: the key `physics` is now called "
                                           "`description`"));
    neph_scene_destroy(scene);
    assert_int_equal(load_as("probe.yaml", START "physics: a\ndescription: b\n", &scene, &diag),
                     NEPH_ERR_INPUT);
    assert_int_equal(diag.line, 4);
    assert_string_equal(diag.more, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all_errors_are_reported_once),
        cmocka_unit_test(test_reading_ends),
        cmocka_unit_test(test_a_file_of_another_form),
        cmocka_unit_test(test_a_single_error),
        cmocka_unit_test(test_status_of_several),
        scratch_test(test_metrics_of_gates_are_checked),
        cmocka_unit_test(test_a_scene_is_called_like_its_file),
        cmocka_unit_test(test_names_of_files_that_are_none),
        cmocka_unit_test(test_the_older_name_of_description),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
