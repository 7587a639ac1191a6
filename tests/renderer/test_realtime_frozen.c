/* SPDX-License-Identifier: MIT
 *
 * The presets that others are measured against keep their bits: `off` is the march, `fixed` the
 * defaults, `ours1` what the first published study used and `ours` what the second did. One hash of
 * all channels of eight frames; a change of any of them is meant, or a fault.
 *
 * Bits are those of one driver: another one, or its compiler for another processor, may round
 * elsewhere. There the test only says so; what must hold everywhere is in the other tests.
 */
#include "tests/renderer/sequence_test.h"

#include "base/hash.h"

enum { WIDTH_PX = 64, HEIGHT_PX = 36, FRAMES = 8 };

static const char measured_on[] =
    "llvmpipe Mesa 22.3.6 (LLVM 15.0.6); llvmpipe (LLVM 15.0.6, 256 bits)";

static const struct {
    const char *scene, *preset, *hash; /* its first 16 digits */
} frozen[] = {
    {"fence_pitch4", "off", "43d68f48517941a6"},   {"fence_pitch4", "fixed", "86bf9c129a75bc68"},
    {"fence_pitch4", "ours1", "9538e4a77c7e86c7"}, {"foliage", "off", "36340f34149a33e5"},
    {"foliage", "fixed", "2a2742244aef76d3"},      {"foliage", "ours1", "bb6c05f501ceb18b"},
    {"camera_pan", "off", "0a4a69e2f67dedda"},     {"camera_pan", "fixed", "6081c049a85ce4d9"},
    {"camera_pan", "ours1", "08f454f312e1428b"},
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

static void test_frozen_presets_keep_their_bits(void **state)
{
    struct neph_vulkan *vulkan = *state;
    const struct neph_vulkan_description description = neph_vulkan_describe(vulkan);
    char device[sizeof(description.driver) + sizeof(description.device)];
    snprintf(device, sizeof(device), "%s; %s", description.driver, description.device);
    const bool is_known = strcmp(device, measured_on) == 0;
    int wrong = 0;
    for (size_t i = 0; i < COUNT(frozen) && is_known; i++) {
        char hex[NEPH_HASH_HEX_SIZE];
        hash_frames(vulkan, frozen[i].scene, frozen[i].preset, hex);
        if (strncmp(hex, frozen[i].hash, 16) == 0)
            continue;
        print_error("{\"%s\", \"%s\", \"%.16s\"} was \"%s\"\n", frozen[i].scene, frozen[i].preset,
                    hex, frozen[i].hash);
        wrong++;
    }
    if (!is_known) {
        print_message("frozen on %s; this is %s\n", measured_on, device);
        skip();
    }
    assert_int_equal(wrong, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_frozen_presets_keep_their_bits),
    };
    return cmocka_run_group_tests(tests, test_vulkan_setup, test_vulkan_teardown);
}
