/* SPDX-License-Identifier: MIT
 *
 * Colour spaces of an OpenColorIO config that the test writes. The command line with them:
 * tests/harness/e2e_ocio.py.
 */
#include "base/colour_convert.h"
#include "metrics/colour_config.h"
#include "tests/base/scratch.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

static const char config_text[] =
    "ocio_profile_version: 2\n"
    "roles: {scene_linear: light, working: stops}\n"
    "file_rules: [!<Rule> {name: Default, colorspace: light}]\n"
    "displays: {screen: [!<View> {name: plain, colorspace: light}]}\n"
    "colorspaces:\n"
    "  - !<ColorSpace> {name: light}\n"
    "  - !<ColorSpace>\n"
    "    name: stops\n"
    "    aliases: [log2]\n"
    "    to_scene_reference: !<LogTransform> {base: 2, direction: inverse}\n"
    "  - !<ColorSpace>\n"
    "    name: ring\n"
    "    from_scene_reference: !<ColorSpaceTransform> {src: light, dst: ring}\n";

static struct neph_colour_source *open_config(void **state, const char *space)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_colour_source *source = NULL;
    struct neph_diag diag = {0};
    scratch_path(state, path, "config.ocio");
    neph_assert_ok(neph_file_write(path, config_text, strlen(config_text), NULL), NULL);
    neph_assert_ok(neph_colour_config_open(path, space, &source, &diag), &diag);
    return source;
}

static void test_names(void **state)
{
    struct neph_colour_source *source = open_config(state, "light");
    static const char *const names[] = {"stops", "STOPS", "log2", "working"};
    struct neph_diag diag = {0};
    const char *space = NULL;
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        neph_assert_ok(source->find(source->context, names[i], &space, &diag), &diag);
        assert_string_equal(space, "stops");
    }
    assert_int_equal(source->find(source->context, "stop", &space, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "no colour space 'stop'"));
    assert_string_equal(diag.hint, "it has stops, ring, light"); /* the most similar first */
    assert_int_equal(source->find(source->context, "", &space, NULL), NEPH_ERR_INPUT);
    assert_string_equal(source->label, "config.ocio");
    neph_colour_config_close(source);
    neph_colour_config_close(NULL);
}

enum { WIDTH = 37, HEIGHT = 5, COUNT = WIDTH * HEIGHT };

struct picture {
    const struct neph_colour_source *source;
    float samples[3][COUNT];
    enum neph_status status;
};

static void *convert_picture(void *context)
{
    struct picture *picture = context;
    float *const planes[3] = {picture->samples[0], picture->samples[1], picture->samples[2]};
    const int size_px[2] = {WIDTH, HEIGHT};
    picture->status = picture->source->convert(picture->source->context, "stops", planes, size_px,
                                               NULL);
    return NULL;
}

/* By several threads at once, as frames are read. */
static void test_values_are_the_closed_form(void **state)
{
    struct neph_colour_source *source = open_config(state, "light");
    static struct picture pictures[4];
    pthread_t threads[4];
    for (int t = 0; t < 4; t++) {
        pictures[t].source = source;
        for (int i = 0; i < 3 * COUNT; i++)
            pictures[t].samples[i / COUNT][i % COUNT] = (float)(8.0 * i / (3 * COUNT) - 4.0);
        assert_int_equal(pthread_create(&threads[t], NULL, convert_picture, &pictures[t]), 0);
    }
    for (int t = 0; t < 4; t++) {
        pthread_join(threads[t], NULL);
        neph_assert_ok(pictures[t].status, NULL);
        for (int i = 0; i < 3 * COUNT; i++) {
            const double code = (double)(float)(8.0 * i / (3 * COUNT) - 4.0);
            /* roundings of the argument, at most 4 ln 2 of 2^-24, and of the result */
            neph_assert_close((double)pictures[t].samples[i / COUNT][i % COUNT], exp2(code),
                              8.0 * 0x1p-24, 0.0);
        }
    }
    neph_colour_config_close(source);
}

static void test_spaces_that_cannot_be_converted(void **state)
{
    struct neph_colour_source *source = open_config(state, "light");
    float samples[3][2] = {{1.0f, 1.0f}, {1.0f, 200.0f}, {1.0f, 1.0f}};
    float *const planes[3] = {samples[0], samples[1], samples[2]};
    struct neph_diag diag = {0};
    assert_int_equal(source->convert(source->context, "stops", planes, (const int[2]){2, 1}, &diag),
                     NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "no finite number for the pixel (1, 0)"));
    assert_int_equal(source->convert(source->context, "ring", planes, (const int[2]){2, 1}, &diag),
                     NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "'ring' of the OpenColorIO config is defined by itself"));
    neph_colour_config_close(source);
}

static void test_configs_that_cannot_be_used(void **state)
{
    char path[SCRATCH_PATH_MAX];
    struct neph_colour_source *source = open_config(state, "light"), *none = NULL;
    struct neph_diag diag = {0};
    neph_colour_config_close(source);
    scratch_path(state, path, "config.ocio");
    assert_int_equal(neph_colour_config_open(path, NULL, &none, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "no role aces_interchange"));
    assert_int_equal(neph_colour_config_open(path, "lihgt", &none, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "no colour space 'lihgt'"));
    scratch_path(state, path, "nowhere.ocio");
    assert_int_equal(neph_colour_config_open(path, NULL, &none, &diag), NEPH_ERR_NOT_FOUND);
    neph_assert_ok(neph_file_write(path, "colorspaces: 7\n", 15, NULL), NULL);
    assert_int_equal(neph_colour_config_open(path, NULL, &none, NULL), NEPH_ERR_INPUT);
    assert_null(none);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        scratch_test(test_names),
        scratch_test(test_values_are_the_closed_form),
        scratch_test(test_spaces_that_cannot_be_converted),
        scratch_test(test_configs_that_cannot_be_used),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
