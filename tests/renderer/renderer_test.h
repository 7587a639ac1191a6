/* SPDX-License-Identifier: MIT
 *
 * Common part of the Vulkan tests: a device with validation enabled; every validation message fails
 * the test.
 */
#ifndef NEPH_TESTS_RENDERER_TEST_H
#define NEPH_TESTS_RENDERER_TEST_H

#include "tests/renderer/owned.h"

#include "base/option.h"
#include "renderer/compute.h"
#include "renderer/vulkan.h"

#include <stdlib.h>

/* Sets options from "key=value key=value". */
static inline void test_assign(const struct neph_option *options, const char *assignments,
                               struct neph_settings *settings)
{
    char *copy = strdup(assignments), *rest = copy;
    for (char *word; (word = strsep(&rest, " ")) != NULL;) {
        struct neph_diag diag = {0};
        if (*word)
            neph_assert_ok(neph_options_set(options, "test", word, settings, &diag), &diag);
    }
    free(copy);
}

/* Opens the device. Specialized shaders are cached across tests if NEPH_TEST_CACHE names a
 * folder. */
static inline struct neph_vulkan *test_vulkan_open(void)
{
    struct neph_vulkan *vulkan = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(
        neph_vulkan_create(&(struct neph_vulkan_params){.validation = NEPH_VALIDATION_ON,
                                                        .cache_folder = getenv("NEPH_TEST_CACHE")},
                           &vulkan, &diag),
        &diag);
    return vulkan;
}

/* The first bytes of a buffer on the device. For free(). */
static inline void *test_read_buffer(struct neph_vulkan *vulkan, const struct neph_buffer *buffer,
                                     size_t bytes)
{
    struct neph_buffer readback = {0};
    struct neph_diag diag = {0};
    neph_assert_ok(
        neph_buffer_create(vulkan, NEPH_BUFFER_READBACK, bytes, "readback", &readback, &diag),
        &diag);
    neph_assert_ok(neph_buffer_download(vulkan, buffer, &readback, bytes, &diag), &diag);
    void *copy = malloc(bytes);
    assert_non_null(copy);
    memcpy(copy, readback.mapped, bytes);
    neph_buffer_destroy(vulkan, &readback);
    return copy;
}

/* cmocka group fixtures. */
static inline int test_vulkan_setup(void **state)
{
    *state = test_vulkan_open();
    return 0;
}

static inline int test_vulkan_teardown(void **state)
{
    struct neph_diag diag = {0};
    if (neph_vulkan_check(*state, &diag))
        print_error("%s\n", diag.message);
    const int message_count = neph_vulkan_destroy(*state);
    if (message_count > 0)
        print_error("%d validation messages\n", message_count);
    return message_count;
}

#endif
