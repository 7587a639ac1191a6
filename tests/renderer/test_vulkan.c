/* SPDX-License-Identifier: MIT
 *
 * The device: discovery, messages when something is missing, and that validation messages fail a
 * test.
 */
#include "tests/renderer/renderer_test.h"

#include "base/files.h"
#include "base/hash.h"
#include "renderer/compute.h"
#include "renderer/device_memory.h"
#include "renderer/shader_code.h"

#include <dirent.h>
#include <stdlib.h>

static void test_describes_the_device(void **state)
{
    const struct neph_vulkan_description description = neph_vulkan_describe(*state);
    print_message("%s, %s, Vulkan %s, subgroup %u, cpu %d\n", description.device,
                  description.driver, description.api_version, description.subgroup_size,
                  description.is_cpu);
    assert_true(description.device[0] != '\0');
    assert_true(description.driver[0] != '\0');
    assert_true(description.subgroup_size > 0);
}

static void test_two_devices_live_side_by_side(void **state)
{
    struct neph_vulkan *first = test_vulkan_open();
    struct neph_vulkan *second = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_vulkan_create(NULL, &second, &diag), &diag);
    assert_int_equal(neph_vulkan_destroy(first), 0);
    struct neph_buffer buffer = {0};
    neph_assert_ok(neph_buffer_create(second, NEPH_BUFFER_UPLOAD, 64, "buffer", &buffer, &diag),
                   &diag);
    neph_buffer_destroy(second, &buffer);
    assert_int_equal(neph_vulkan_destroy(second), 0);
}

static const uint32_t sum_code[] = {
#include "shaders/tracer_sum.comp.inc"
};

static const uint32_t halves_code[] = {
#include "shaders/halves.comp.inc"
};

static const struct neph_kernel *sum_kernel(struct neph_vulkan *vulkan, uint32_t kinds,
                                            uint32_t unknown)
{
    const struct neph_kernel_params params = {.name = "tracer_sum",
                                              .code = sum_code,
                                              .code_bytes = sizeof(sum_code),
                                              .buffer_count = NEPH_KERNEL_STORAGE_MAX,
                                              .uniform_count = 1,
                                              .push_size_bytes = 64,
                                              .constant_count = 3,
                                              .constants = {[0] = kinds, [2] = unknown}};
    const struct neph_kernel *kernel = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_kernel_get(vulkan, &params, &kernel, &diag), &diag);
    return kernel;
}

/* The shader that sums the tracer's samples reads a few bits of constant 0, and has no constant
 * 2. */
static void test_only_bits_that_the_shader_reads_make_another_kernel(void **state)
{
    const uint32_t read = neph_shader_constant_bits(sum_code, 0);
    assert_true(read != 0u && read != UINT32_MAX);
    const struct neph_kernel *kernel = sum_kernel(*state, 0, 0);
    assert_ptr_equal(kernel, sum_kernel(*state, ~read, 7));
    for (uint32_t bit = 1u; bit != 0u; bit <<= 1)
        if (read & bit)
            assert_ptr_not_equal(kernel, sum_kernel(*state, bit, 0));
}

static void test_destroy_takes_null(void **state)
{
    assert_int_equal(neph_vulkan_destroy(NULL), 0);
}

static void assert_unavailable(const struct neph_vulkan_params *params, const char *in_message,
                               const char *in_hint)
{
    struct neph_vulkan *vulkan = NULL;
    struct neph_diag diag = {0};
    assert_int_equal(neph_vulkan_create(params, &vulkan, &diag), NEPH_ERR_UNAVAILABLE);
    assert_null(vulkan);
    print_message("%s (%s)\n", diag.message, diag.hint);
    assert_non_null(strstr(diag.message, in_message));
    assert_non_null(strstr(diag.hint, in_hint));
}

/* Runs with an environment variable that hides an installed component. */
static void with_environment(const char *name, const char *value,
                             const struct neph_vulkan_params *params, const char *in_message,
                             const char *in_hint)
{
    OWNED(memory) char *before = getenv(name) ? strdup(getenv(name)) : NULL;
    setenv(name, value, 1);
    assert_unavailable(params, in_message, in_hint);
    if (before)
        setenv(name, before, 1);
    else
        unsetenv(name);
}

static void test_no_driver_is_said_with_the_install_line(void **state)
{
    with_environment("VK_ICD_FILENAMES", "/nonexistent/icd.json", NULL, "Vulkan",
                     "apt-get install mesa-vulkan-drivers");
}

static void test_no_validation_layer_is_said_with_the_install_line(void **state)
{
    with_environment("VK_LAYER_PATH", "/nonexistent",
                     &(struct neph_vulkan_params){.validation = NEPH_VALIDATION_ON}, "validation",
                     "apt-get install vulkan-validationlayers");
}

static void read_device_name(char device[256])
{
    struct neph_vulkan *vulkan = test_vulkan_open();
    snprintf(device, 256, "%s", neph_vulkan_describe(vulkan).device);
    neph_vulkan_destroy(vulkan);
}

static void test_unknown_device_lists_what_there_is(void **state)
{
    char device[256];
    read_device_name(device);
    assert_unavailable(&(struct neph_vulkan_params){.device = "abacus"}, "abacus", device);
}

static void test_device_is_found_by_part_of_its_name(void **state)
{
    struct neph_vulkan *vulkan = NULL;
    char device[256];
    read_device_name(device);
    for (char *c = device; *c; c++)
        *c = (char)(*c >= 'a' && *c <= 'z' ? *c - 'a' + 'A' : *c); /* case-insensitive */
    struct neph_diag diag = {0};
    neph_assert_ok(
        neph_vulkan_create(&(struct neph_vulkan_params){.device = device}, &vulkan, &diag), &diag);
    neph_vulkan_destroy(vulkan);
}

static void test_validation_reports_a_mistake(void **state)
{
    struct neph_vulkan *vulkan = test_vulkan_open();
    const VkBufferCreateInfo no_usage = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = 64,
    };
    VkBuffer buffer = VK_NULL_HANDLE;
    if (vulkan->api.vkCreateBuffer(vulkan->device, &no_usage, NULL, &buffer) == VK_SUCCESS)
        vulkan->api.vkDestroyBuffer(vulkan->device, buffer, NULL);
    struct neph_diag diag = {0};
    assert_int_equal(neph_vulkan_check(vulkan, &diag), NEPH_ERR_INTERNAL);
    /* of "usage" in layers of 2023, of "None" in later ones */
    assert_non_null(strstr(diag.message, "VUID-VkBufferCreateInfo-"));
    neph_vulkan_destroy(vulkan);
}

static void test_validation_reports_a_leak(void **state)
{
    struct neph_vulkan *vulkan = test_vulkan_open();
    struct neph_buffer leaked = {0};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD, 64, "leaked", &leaked, &diag),
                   &diag);
    neph_assert_ok(neph_vulkan_check(vulkan, &diag), &diag);
    assert_true(neph_vulkan_destroy(vulkan) > 0);
}

static void test_memory_is_counted_as_long_as_it_is_had(void **state)
{
    struct neph_diag diag = {0};
    struct neph_vulkan *vulkan = *state;
    struct neph_buffer buffers[2] = {{0}, {0}};
    const uint64_t before = neph_device_memory();
    const size_t sizes_bytes[2] = {3 << 20, 5 << 20};
    neph_device_memory_reset_peak();
    for (int i = 0; i < 2; i++) {
        neph_assert_ok(neph_buffer_create(vulkan, NEPH_BUFFER_DEVICE, sizes_bytes[i], "counted",
                                          &buffers[i], &diag),
                       &diag);
        assert_true(neph_device_memory() == before + sizes_bytes[i]);
        neph_buffer_destroy(vulkan, &buffers[i]);
        neph_buffer_destroy(vulkan, &buffers[i]); /* nothing is freed twice */
    }
    assert_true(neph_device_memory() == before);
    assert_true(neph_device_memory_peak() == before + sizes_bytes[1]);
    neph_device_memory_reset_peak();
    assert_true(neph_device_memory_peak() == before);
}

static void test_too_large_a_buffer_is_refused(void **state)
{
    struct neph_buffer buffer = {0};
    struct neph_diag diag = {0};
    assert_int_equal(
        neph_buffer_create(*state, NEPH_BUFFER_DEVICE, (size_t)1 << 40, "huge", &buffer, &diag),
        NEPH_ERR_UNSUPPORTED);
    assert_non_null(strstr(diag.message, "huge"));
}

static void test_too_many_work_groups_are_refused(void **state)
{
    const struct neph_kernel_params params = {.name = "halves",
                                              .code = halves_code,
                                              .code_bytes = sizeof(halves_code),
                                              .buffer_count = 1};
    struct neph_vulkan *vulkan = *state;
    struct neph_buffer buffer = {0};
    struct neph_diag diag = {0};
    const struct neph_kernel *kernel = NULL;
    neph_assert_ok(neph_buffer_create(vulkan, NEPH_BUFFER_UPLOAD, 64, "buffer", &buffer, &diag),
                   &diag);
    neph_assert_ok(neph_kernel_get(vulkan, &params, &kernel, &diag), &diag);
    const struct neph_dispatch dispatch = {
        .buffers = {&buffer}, .group_count = vulkan->limits.maxComputeWorkGroupCount[0] + 1};
    assert_int_equal(neph_kernel_run(vulkan, kernel, &dispatch, NULL, &diag), NEPH_ERR_UNSUPPORTED);
    print_message("%s\n", diag.message);
    assert_non_null(strstr(diag.message, "halves"));
    neph_buffer_destroy(vulkan, &buffer);
}

/* --- pipeline caches ------------------------------------------------------------------------ */

static void open_and_close(const char *cache_folder)
{
    const struct neph_vulkan_params params = {.validation = NEPH_VALIDATION_ON,
                                              .cache_folder = cache_folder};
    struct neph_vulkan *vulkan = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_vulkan_create(&params, &vulkan, &diag), &diag);
    assert_int_equal(neph_vulkan_destroy(vulkan), 0);
}

/* The only file of a folder; the caller frees it. */
static char *only_file(const char *folder)
{
    char *path = NULL;
    DIR *entries = opendir(folder);
    assert_non_null(entries);
    for (struct dirent *entry; (entry = readdir(entries));)
        if (entry->d_name[0] != '.') {
            assert_null(path);
            path = neph_path_join(folder, entry->d_name);
        }
    closedir(entries);
    assert_non_null(path);
    return path;
}

/* It starts with the hash of the remaining bytes, as printed by `b2sum -l 256`. */
static bool is_sound(const char *path)
{
    OWNED(memory) char *data = NULL;
    char hash[NEPH_HASH_HEX_SIZE];
    size_t size_bytes = 0;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_file_read(path, 1 << 20, &data, &size_bytes, &diag), &diag);
    bool sound = size_bytes > 64;
    if (sound)
        neph_assert_ok(neph_hash(data + 64, size_bytes - 64, hash, &diag), &diag);
    sound = sound && memcmp(data, hash, 64) == 0;
    return sound;
}

static void test_a_broken_cache_is_renewed(void **state)
{
    static const char *const broken[] = {
        "", "not a cache",
        "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef and something"};
    char root[] = "/tmp/neph-test-pipelines-XXXXXX";
    assert_non_null(mkdtemp(root));
    OWNED(memory) char *folder = neph_path_join(root, "made");
    struct neph_diag diag = {0};
    open_and_close(folder);
    OWNED(memory) char *path = only_file(folder);
    assert_true(is_sound(path));
    for (size_t i = 0; i < sizeof(broken) / sizeof(broken[0]); i++) {
        neph_assert_ok(neph_file_write(path, broken[i], strlen(broken[i]), &diag), &diag);
        assert_false(is_sound(path));
        open_and_close(folder);
        assert_true(is_sound(path));
    }
    neph_assert_ok(neph_dir_remove(root, &diag), &diag);
}

static void test_no_room_for_the_cache_is_no_error(void **state)
{
    open_and_close("/dev/null/cache");
}

#define device_test(name)                                                                          \
    cmocka_unit_test_setup_teardown(name, test_vulkan_setup, test_vulkan_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        device_test(test_describes_the_device),
        cmocka_unit_test(test_two_devices_live_side_by_side),
        device_test(test_only_bits_that_the_shader_reads_make_another_kernel),
        cmocka_unit_test(test_destroy_takes_null),
        cmocka_unit_test(test_no_driver_is_said_with_the_install_line),
        cmocka_unit_test(test_no_validation_layer_is_said_with_the_install_line),
        cmocka_unit_test(test_unknown_device_lists_what_there_is),
        cmocka_unit_test(test_device_is_found_by_part_of_its_name),
        cmocka_unit_test(test_validation_reports_a_mistake),
        cmocka_unit_test(test_validation_reports_a_leak),
        device_test(test_memory_is_counted_as_long_as_it_is_had),
        device_test(test_too_large_a_buffer_is_refused),
        device_test(test_too_many_work_groups_are_refused),
        cmocka_unit_test(test_a_broken_cache_is_renewed),
        cmocka_unit_test(test_no_room_for_the_cache_is_no_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
