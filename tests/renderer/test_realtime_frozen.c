/* SPDX-License-Identifier: MIT
 *
 * Presets with frozen bits, against which others are measured: `off` is the march, `fixed` the
 * defaults, `ours1` the preset of the first published study, and `ours2` the predecessor of `ours`.
 * One hash covers all channels of eight frames; each change of a hash is intended or a fault.
 *
 * Bits depend on the driver's version and its vector width. frozen_frames.txt has the hashes of
 * each tested device; on other devices the test is skipped with a message. After an intended
 * change, and on a new device, this command writes the hashes of the present device:
 *
 *   NEPH_TEST_FREEZE=1 ctest --test-dir build/release -R renderer/test_realtime_frozen
 */
#include "tests/renderer/sequence_test.h"

#include "base/files.h"
#include "base/hash.h"

enum { WIDTH_PX = 64, HEIGHT_PX = 36, FRAMES = 8, HASH_SIZE = 17 /* its first 16 digits */ };

static const char file_of_hashes[] = NEPH_SOURCE_DIR "/tests/renderer/frozen_frames.txt";

static const struct {
    const char *scene, *preset;
} cases[] = {
    {"fence_pitch4", "off"},   {"fence_pitch4", "fixed"}, {"fence_pitch4", "ours1"},
    {"fence_pitch4", "ours2"}, {"foliage", "off"},        {"foliage", "fixed"},
    {"foliage", "ours1"},      {"foliage", "ours2"},      {"camera_pan", "off"},
    {"camera_pan", "fixed"},   {"camera_pan", "ours1"},   {"camera_pan", "ours2"},
};

static struct neph_scene *load(const char *name)
{
    char path[512];
    snprintf(path, sizeof(path), NEPH_SOURCE_DIR "/scenes/stress/%s.yaml", name);
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_scene_load(path, &scene, &diag), &diag);
    return scene;
}

static void hash_frames(struct neph_vulkan *vulkan, const char *scene_name, const char *preset,
                        char hex[NEPH_HASH_HEX_SIZE])
{
    enum { CHANNELS_MAX = 16, PIXELS = WIDTH_PX * HEIGHT_PX };
    OWNED(scene) struct neph_scene *scene = load(scene_name);
    const struct neph_settings settings = test_preset(preset, "steps=16");
    OWNED(realtime)
    struct neph_realtime *realtime = test_sequence(vulkan, scene, &settings, WIDTH_PX, HEIGHT_PX);
    OWNED(memory) float *all = calloc((size_t)FRAMES * CHANNELS_MAX * PIXELS, sizeof(*all));
    size_t count = 0;
    struct neph_diag diag = {0};
    for (int frame = 0; frame < FRAMES; frame++) {
        OWNED(image) struct neph_image *image = test_next(realtime, scene, frame, NULL);
        assert_true(image->channel_count <= CHANNELS_MAX);
        for (int c = 0; c < image->channel_count; c++, count += PIXELS)
            memcpy(all + count, image->channels[c].samples, PIXELS * sizeof(*all));
    }
    neph_assert_ok(neph_hash(all, count * sizeof(*all), hex, &diag), &diag);
}

/* Scene, preset and hash of a line, if the line is for this device. */
static bool read_line(const char *line, const char *device, char scene[32], char preset[16],
                      char hash[HASH_SIZE])
{
    int end = 0;
    return sscanf(line, "%31s %15s %16s %n", scene, preset, hash, &end) == 3 &&
           strcmp(line + end, device) == 0;
}

/* Reads the hashes of this device, "" for missing cases, and writes the lines of all other devices
 * to `others`. Returns the number of lines of this device. */
static int read_hashes(const char *device, char hashes[COUNT(cases)][HASH_SIZE], FILE *others)
{
    OWNED(memory) char *text = NULL;
    size_t size = 0;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_file_read(file_of_hashes, 1 << 20, &text, &size, &diag), &diag);
    int count = 0;
    char *rest = NULL;
    for (char *line = strtok_r(text, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        char scene[32], preset[16], hash[HASH_SIZE];
        if (!read_line(line, device, scene, preset, hash)) {
            fprintf(others, "%s\n", line);
            continue;
        }
        count++;
        for (size_t i = 0; i < COUNT(cases); i++)
            if (strcmp(scene, cases[i].scene) == 0 && strcmp(preset, cases[i].preset) == 0)
                memcpy(hashes[i], hash, HASH_SIZE);
    }
    return count;
}

static void test_frozen_presets_keep_their_bits(void **state)
{
    struct neph_vulkan *vulkan = *state;
    const struct neph_vulkan_description description = neph_vulkan_describe(vulkan);
    char device[sizeof(description.driver) + sizeof(description.device)];
    snprintf(device, sizeof(device), "%s; %s", description.driver, description.device);
    const bool freeze = getenv("NEPH_TEST_FREEZE") != NULL;
    char hashes[COUNT(cases)][HASH_SIZE] = {0};
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    assert_non_null(file);
    const bool is_known = read_hashes(device, hashes, file) > 0;
    int wrong = 0;
    for (size_t i = 0; i < COUNT(cases) && (is_known || freeze); i++) {
        char hex[NEPH_HASH_HEX_SIZE];
        hash_frames(vulkan, cases[i].scene, cases[i].preset, hex);
        fprintf(file, "%s %s %.16s %s\n", cases[i].scene, cases[i].preset, hex, device);
        if (strncmp(hex, hashes[i], HASH_SIZE - 1) == 0)
            continue;
        print_message("%s %s: %.16s, was %s\n", cases[i].scene, cases[i].preset, hex, hashes[i]);
        wrong++;
    }
    fclose(file);
    struct neph_diag diag = {0};
    if (freeze)
        neph_assert_ok(neph_file_write(file_of_hashes, text, size, &diag), &diag);
    free(text);
    if (!is_known && !freeze) {
        print_message("%s has no hashes of %s\n", file_of_hashes, device);
        skip();
    }
    if (wrong > 0 && !freeze)
        fail_msg("%d of %zu sequences have other bits", wrong, COUNT(cases));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_frozen_presets_keep_their_bits),
    };
    return cmocka_run_group_tests(tests, test_vulkan_setup, test_vulkan_teardown);
}
