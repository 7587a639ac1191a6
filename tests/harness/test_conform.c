/* SPDX-License-Identifier: MIT
 *
 * Validity of frames, and the allowed differences between two devices: with folders written by hand
 * and without a device.
 */
#include "tests/base/scratch.h"
#include "tests/neph_test.h"

#include "base/exr.h"
#include "base/files.h"
#include "harness/run/conform.h"

/* --- counting ----------------------------------------------------------------------------- */

static json_t *make_conform_report(const char *outcome, int non_finite, int negative)
{
    return json_pack("[{s:[{s:s, s:i, s:i}]}]", "pictures", "outcome", outcome, "non_finite",
                     non_finite, "negative", negative);
}

static void test_counted_cases(void **state)
{
    static const struct {
        const char *outcome;
        int non_finite, negative, expected, sound;
    } cases[] = {
        {"rendered", 0, 0, 1, 1}, {"rendered", 1, 0, 1, 0}, {"rendered", 0, 1, 1, 0},
        {"failed", 0, 0, 1, 0},   {"cannot", 0, 0, 0, 0},
    };
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        int expected = -1, sound = -1;
        json_t *report = make_conform_report(cases[i].outcome, cases[i].non_finite,
                                             cases[i].negative);
        neph_conform_count(report, &expected, &sound);
        assert_int_equal(expected, cases[i].expected);
        assert_int_equal(sound, cases[i].sound);
        json_decref(report);
    }
}

/* --- comparing ---------------------------------------------------------------------------- */

enum { WIDTH_PX = 40, HEIGHT_PX = 25, PIXELS = WIDTH_PX * HEIGHT_PX };

/* One frame with one channel; `variance` < 0: no variance layer. */
struct device {
    const char *engine, *channel;
    float pixels[PIXELS];
    double mean, variance;
};

static struct device make_conform_device(const char *engine, const char *channel)
{
    struct device device = {.engine = engine, .channel = channel, .mean = 0.5, .variance = -1.0};
    for (int i = 0; i < PIXELS; i++)
        device.pixels[i] = (float)(i + 1) / PIXELS;
    return device;
}

static json_t *scene_json(const struct device *device)
{
    json_t *channels = json_pack("[{s:s, s:f, s:f, s:i}]", "channel", device->channel, "mean",
                                 device->mean, "largest", 1.0, "far", 0);
    if (device->variance >= 0.0)
        neph_json_add(&channels, json_pack("{s:s, s:f, s:f, s:i}", "channel", "variance.R", "mean",
                                           device->variance, "largest", 1.0, "far", 0));
    return json_pack("{s:s, s:s, s:s, s:s, s:[{s:s, s:s, s:s, s:s, s:i, s:[i,i], s:o}]}", "format",
                     "neph-conform-1", "scene", "s", "scene_hash", "0", "device", "d", "pictures",
                     "picture", "s_e", "engine", device->engine, "settings", "", "outcome",
                     "rendered", "pictures", 1, "size_px", 100, 100, "channels", channels);
}

static void write_device(const char *folder, const struct device *device)
{
    struct neph_diag diag = {0};
    struct neph_image *image = NULL;
    float *samples;
    char *json_path = neph_path_join(folder, "s.json"),
         *exr_path = neph_path_join(folder, "s_e.exr");
    json_t *scene = scene_json(device);
    neph_assert_ok(neph_dir_create(folder, &diag), &diag);
    assert_int_equal(json_dump_file(scene, json_path, 0), 0);
    neph_assert_ok(neph_image_create(WIDTH_PX, HEIGHT_PX, &image, &diag), &diag);
    neph_assert_ok(neph_image_add_channel(image, device->channel, &samples, &diag), &diag);
    memcpy(samples, device->pixels, sizeof(device->pixels));
    if (device->variance >= 0.0)
        neph_assert_ok(neph_image_add_channel(image, "variance.R", &samples, &diag), &diag);
    neph_assert_ok(neph_exr_write(exr_path, image, &diag), &diag);
    neph_image_destroy(image);
    json_decref(scene);
    free(json_path);
    free(exr_path);
}

static bool agree(void **state, const struct device *a, const struct device *b)
{
    struct neph_diag diag = {0};
    char folder_a[SCRATCH_PATH_MAX], folder_b[SCRATCH_PATH_MAX];
    const struct neph_conform_part all = {.engine_count = 0};
    json_t *report = NULL;
    write_device(scratch_path(state, folder_a, "a"), a);
    write_device(scratch_path(state, folder_b, "b"), b);
    neph_assert_ok(neph_conform_compare(folder_a, folder_b, &all, &report, &diag), &diag);
    assert_int_equal(json_integer_value(json_object_get(report, "expected")), 1);
    const bool agrees = json_integer_value(json_object_get(report, "agreeing")) == 1;
    json_decref(report);
    return agrees;
}

/* Bounds of a marcher: 2e-4 of the value and 2e-5 of the largest; 2 of 1,000 pixels may be beyond.
 */
static void test_pixels_of_a_march(void **state)
{
    const struct device a = make_conform_device("march", "R");
    struct device b = a;
    assert_true(agree(state, &a, &b));
    for (int i = 0; i < PIXELS; i++)
        b.pixels[i] = a.pixels[i] * (1.0f + 1e-4f) + 1e-5f;
    assert_true(agree(state, &a, &b));
    b = a;
    b.pixels[3] = 0.5f;
    b.pixels[4] = NAN;
    assert_true(agree(state, &a, &b));
    b.pixels[5] = INFINITY;
    assert_false(agree(state, &a, &b));
    b = a;
    for (int i = 0; i < PIXELS; i++)
        b.pixels[i] *= 1.0004f;
    assert_false(agree(state, &a, &b));
}

/* The mean over all pixels shows a difference that the sparse pixels do not. */
static void test_means(void **state)
{
    const struct device a = make_conform_device("march", "R");
    struct device b = a;
    b.mean = a.mean + 1.5e-5;
    assert_true(agree(state, &a, &b));
    b.mean = a.mean + 3e-5;
    assert_false(agree(state, &a, &b));
}

/* Half precision and thresholds: more pixels may differ, the mean may not. */
static void test_pixels_of_realtime(void **state)
{
    const struct device a = make_conform_device("realtime", "R");
    struct device b = a;
    for (int i = 0; i < PIXELS / 25; i++)
        b.pixels[i] = 1.0f;
    assert_true(agree(state, &a, &b));
    for (int i = 0; i < PIXELS / 16; i++)
        b.pixels[i] = 1.0f;
    assert_false(agree(state, &a, &b));
    b = a;
    b.mean = a.mean + 1e-3;
    assert_false(agree(state, &a, &b));
}

/* A few other paths with an equal mean are valid. Estimated variances are not compared. */
static void test_light_of_the_tracer(void **state)
{
    struct device a = make_conform_device("tracer", "R");
    a.variance = 0.02;
    struct device b = a;
    b.variance = 0.03;
    for (int i = 0; i < PIXELS / 25; i++)
        b.pixels[i] = a.pixels[PIXELS - 1 - i];
    assert_true(agree(state, &a, &b));
    b.mean = a.mean + 6e-4;
    assert_false(agree(state, &a, &b));
    b.mean = a.mean;
    for (int i = 0; i < PIXELS / 16; i++)
        b.pixels[i] = a.pixels[PIXELS - 1 - i];
    assert_false(agree(state, &a, &b));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_counted_cases),
        cmocka_unit_test_setup_teardown(test_pixels_of_a_march, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_means, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_pixels_of_realtime, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_light_of_the_tracer, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests_name("conform", tests, NULL, NULL);
}
