/* SPDX-License-Identifier: MIT
 *
 * Files of all formats, types and channel counts, and OpenEXR files in the schemes of eight
 * programs, compared with OpenImageIO's own reading of them.
 */
#include "base/child.h"
#include "base/files.h"
#include "base/oiio.h"
#include "base/srgb.h"
#include "harness/compare/frame.h"
#include "tests/base/scratch.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>

enum { HEAD_BYTES = 3 * sizeof(int32_t) };

/* As make_foreign.cpp writes it. */
struct reading {
    char *bytes;
    int32_t width_px, height_px, channel_count;
    const float *samples;
};

static struct reading load_reading(const char *folder, const char *name)
{
    struct reading reading = {.bytes = NULL};
    size_t size = 0;
    const struct neph_path path = neph_path_format("%s/%s.samples", folder, name);
    neph_assert_ok(neph_file_read(path.text, SIZE_MAX, &reading.bytes, &size, NULL), NULL);
    memcpy(&reading.width_px, reading.bytes, HEAD_BYTES);
    reading.samples = (const float *)(void *)(reading.bytes + HEAD_BYTES);
    assert_int_equal(size, HEAD_BYTES + sizeof(float) * (size_t)reading.width_px *
                                            (size_t)reading.height_px *
                                            (size_t)reading.channel_count);
    return reading;
}

/* The channel of the frame that has the samples of channel `c` of the file. */
static const float *find_channel(const struct neph_image *frame, int channel_count, int c)
{
    static const char *const names[] = {"R", "G", "B", "A"};
    return neph_image_channel(frame, channel_count == 1 ? "R" : names[c]);
}

/* How a file in the scheme of a program is read: see make_foreign.cpp. */
struct scheme {
    char layer[128], depth[128];
    int index[4]; /* of R, G, B and Z in the file; -1: none */
};

static bool load_scheme(const char *folder, const char *name, struct scheme *scheme)
{
    char key[128], value[128];
    FILE *file = fopen(neph_path_format("%s/%s.scheme", folder, name).text, "r");
    *scheme = (struct scheme){.index = {-1, -1, -1, -1}};
    if (!file)
        return false;
    while (fscanf(file, "%127s %127s", key, value) == 2) {
        if (strcmp(key, "layer") == 0)
            snprintf(scheme->layer, sizeof(scheme->layer), "%s", value);
        else if (strcmp(key, "depth") == 0)
            snprintf(scheme->depth, sizeof(scheme->depth), "%s", value);
        else
            scheme->index[strchr("RGBZ", key[0]) - "RGBZ"] = (int)strtol(value, NULL, 10);
    }
    fclose(file);
    return true;
}

/* Bit for bit, and no other depth. */
static void compare_scheme(const char *name, const struct neph_image *frame,
                           const struct reading *reading, const struct scheme *scheme)
{
    static const char *const names[] = {"R", "G", "B", "Z"};
    const size_t count = neph_image_pixel_count(frame);
    assert_int_equal(count, reading->width_px * reading->height_px);
    for (int c = 0; c < 4; c++) {
        const float *samples = neph_image_channel(frame, names[c]);
        if (!samples != (scheme->index[c] < 0))
            print_error("%s: channel %s\n", name, names[c]);
        assert_true(!samples == (scheme->index[c] < 0));
        if (samples)
            assert_memory_equal(samples, reading->samples + (size_t)scheme->index[c] * count,
                                count * sizeof(*samples));
    }
}

static void compare(const char *name, const struct neph_image *frame, const struct reading *reading)
{
    const size_t count = neph_image_pixel_count(frame);
    const bool is_srgb = neph_image_attribute(frame, "encoding") != NULL;
    assert_int_equal(frame->width_px, reading->width_px);
    assert_int_equal(frame->height_px, reading->height_px);
    for (int c = 0; c < reading->channel_count; c++) {
        const float *samples = find_channel(frame, reading->channel_count, c);
        if (!samples && c == 3 && is_srgb) /* opaque alpha is dropped */
            continue;
        if (!samples)
            print_error("%s: no channel %d\n", name, c);
        assert_non_null(samples);
        for (size_t i = 0; i < count; i++) {
            const double given = (double)reading->samples[(size_t)c * count + i];
            const double expected = is_srgb ? neph_srgb_to_linear(given) : given;
            /* A code as a float has an error of 2^-24, and the curve a slope of at most 2.4 in
             * relative terms. */
            if (!(fabs((double)samples[i] - expected) <= (is_srgb ? 0x1p-22 * expected : 0.0)))
                print_error("%s: channel %d, pixel %zu: %.9g instead of %.9g\n", name, c, i,
                            (double)samples[i], expected);
            neph_assert_close((double)samples[i], expected, is_srgb ? 0x1p-22 : 0.0, 0.0);
        }
    }
}

/* By day the files that neph reads itself, and a few of the others: the helper program needs half a
 * second of processor time to start. */
static bool is_taken(const char *name)
{
    static const char *const others[] = {"uint8_3_0.tif", "half_4_16.tif", "uint8_1_0.ppm",
                                         "uint8_3_0.jpg", "float_3_0.hdr"};
    const char *dot = strrchr(name, '.');
    if (name[0] == '.' || !dot || strcmp(dot, ".samples") == 0 || strcmp(dot, ".scheme") == 0)
        return false;
    bool is_of_the_day = strcmp(dot, ".exr") == 0 || strcmp(dot, ".png") == 0;
    for (size_t i = 0; i < sizeof(others) / sizeof(others[0]); i++)
        is_of_the_day |= strcmp(name, others[i]) == 0;
    return is_of_the_day || neph_test_is_night();
}

static void make_files(void **state)
{
    const struct scratch *scratch = *state;
    const char *const argv[] = {NEPH_MAKE_FOREIGN, scratch->folder, NULL};
    const struct neph_child_params params = {.argv = argv};
    struct neph_child_result result;
    struct neph_diag diag = {0};
    if (!argv[0][0] || !neph_oiio_is_available()) {
        print_message("skipped: neph was built without OpenImageIO (libopenimageio-dev)\n");
        skip();
    }
    neph_assert_ok(neph_child_run(&params, &result, &diag), &diag);
}

static void test_all_kinds_as_openimageio_reads_them(void **state)
{
    const struct scratch *scratch = *state;
    struct neph_diag diag = {0};
    int count = 0;
    make_files(state);
    DIR *folder = opendir(scratch->folder);
    assert_non_null(folder);
    for (const struct dirent *entry; (entry = readdir(folder)) != NULL;) {
        if (!is_taken(entry->d_name))
            continue;
        struct neph_image *frame = NULL;
        const struct neph_path path = neph_path_in(scratch->folder, entry->d_name);
        struct reading reading = load_reading(scratch->folder, entry->d_name);
        struct scheme scheme;
        const bool has_scheme = load_scheme(scratch->folder, entry->d_name, &scheme);
        const struct neph_frame_choice choice = {.layer = scheme.layer[0] ? scheme.layer : NULL,
                                                 .depth = scheme.depth[0] ? scheme.depth : NULL};
        neph_assert_ok(neph_frame_read(path.text, &choice, 0, &frame, &diag), &diag);
        if (has_scheme)
            compare_scheme(entry->d_name, frame, &reading, &scheme);
        else
            compare(entry->d_name, frame, &reading);
        neph_image_destroy(frame);
        free(reading.bytes);
        count++;
    }
    closedir(folder);
    assert_int_equal(count, 8 * 8 + (neph_test_is_night() ? 49 : 18 + 5));
}

/* Damaged files of each format: neph has an image or an error, and goes on. */
static void test_damaged_files(void **state)
{
    static const char *const names[] = {"uint8_3_0.tif", "half_4_16.tif", "uint8_1_0.ppm",
                                        "uint8_3_0.jpg", "float_3_0.hdr", "uint8_4_0.webp"};
    uint64_t random = 1;
    neph_test_waits_for_the_night();
    make_files(state);
    for (size_t n = 0; n < 20 * sizeof(names) / sizeof(names[0]); n++) {
        char path[SCRATCH_PATH_MAX], *data = NULL;
        size_t size = 0;
        struct neph_image *image = NULL;
        struct neph_diag diag = {0};
        scratch_path(state, path, names[n / 20]);
        neph_assert_ok(neph_file_read(path, SIZE_MAX, &data, &size, NULL), NULL);
        for (int i = 0; i < 4; i++)
            data[neph_test_random(&random) % size] = (char)neph_test_random(&random);
        scratch_path(state, path, "damaged");
        scratch_write(path, data, n % 2 ? size : neph_test_random(&random) % size);
        const enum neph_status status = neph_frame_read(path, NULL, SIZE_MAX, &image, &diag);
        assert_true(status == NEPH_OK || status == NEPH_ERR_INPUT || status == NEPH_ERR_GATE);
        neph_image_destroy(image);
        free(data);
        unlink(path);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#include "cases/test_foreign.inc"
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
