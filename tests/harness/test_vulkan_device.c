/* SPDX-License-Identifier: MIT
 *
 * The device that jobs of a command share: opened at the first use, kept with its kernels, replaced
 * when it cannot serve another job. Frames equal frames from a separate device.
 */
#include "tests/neph_test.h"

#include "harness/engines/engines.h"
#include "harness/engines/gpu_frames.h"
#include "harness/engines/vulkan_device.h"
#include "renderer/vulkan_device.h"
#include "scenes/scene.h"

#include <string.h>

static struct neph_open_device *acquire(struct neph_shared_device *shared)
{
    struct neph_open_device *device = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_device_acquire(shared, &device, &diag), &diag);
    return device;
}

static void test_it_is_kept_from_one_user_to_the_next(void **state)
{
    struct neph_shared_device shared = {.open = NULL};
    struct neph_open_device *first = acquire(&shared), *second = acquire(&shared);
    assert_ptr_equal(first, second);
    neph_device_release(first);
    neph_device_release(second);
    assert_ptr_equal(shared.open, first);
    assert_int_equal(first->user_count, 1);
    neph_shared_device_close(&shared);
    assert_null(shared.open);
    neph_shared_device_close(&shared);
    neph_device_release(NULL);
}

static void test_a_user_outlives_the_sharing(void **state)
{
    struct neph_shared_device shared = {.open = NULL};
    struct neph_open_device *device = acquire(&shared);
    neph_shared_device_close(&shared);
    assert_int_equal(device->user_count, 1);
    assert_true(neph_vulkan_describe(device->vulkan).device[0] != '\0');
    struct neph_open_device *other = acquire(&shared);
    assert_ptr_not_equal(other, device);
    neph_device_release(other);
    neph_device_release(device);
    neph_shared_device_close(&shared);
}

static VKAPI_ATTR VkResult VKAPI_CALL lose(VkQueue queue, uint32_t count,
                                           const VkSubmitInfo *submits, VkFence fence)
{
    return VK_ERROR_DEVICE_LOST;
}

/* Makes a device in use invalid: the next user gets a new one, and the old one's user keeps the
 * old. */
static void check_replaced(void (*spoil)(struct neph_vulkan *vulkan))
{
    struct neph_shared_device shared = {.open = NULL};
    struct neph_open_device *old = acquire(&shared);
    spoil(old->vulkan);
    struct neph_open_device *replaced = acquire(&shared), *next = acquire(&shared);
    assert_ptr_not_equal(replaced, old);
    assert_ptr_equal(next, replaced);
    assert_int_equal(old->user_count, 1);
    neph_device_release(old);
    neph_device_release(next);
    neph_device_release(replaced);
    neph_shared_device_close(&shared);
}

static void lose_device(struct neph_vulkan *vulkan)
{
    vulkan->api.vkQueueSubmit = lose;
}

static void test_a_lost_device_is_replaced(void **state)
{
    check_replaced(lose_device);
}

static void complain(struct neph_vulkan *vulkan)
{
    vulkan->message_count++;
}

/* Its message would fail every later frame, too. */
static void test_a_device_with_a_validation_message_is_replaced(void **state)
{
    check_replaced(complain);
}

static void test_a_probe_opens_the_device_and_leaves_it_open(void **state)
{
    struct neph_shared_device shared = {.open = NULL};
    struct neph_engine_info alone, first, second;
    neph_vulkan_probe(NULL, NULL, &alone);
    neph_vulkan_probe(NULL, &shared, &first);
    const struct neph_open_device *open = shared.open;
    assert_non_null(open);
    assert_int_equal(open->user_count, 1);
    neph_vulkan_probe(NULL, &shared, &second);
    assert_ptr_equal(shared.open, open);
    assert_true(alone.available && first.available && second.available);
    assert_string_equal(alone.device, first.device);
    assert_string_equal(alone.version, first.version);
    assert_string_equal(second.device, first.device);
    neph_shared_device_close(&shared);
}

/* A failed attempt leaves nothing. */
static void test_without_a_driver_each_need_says_so(void **state)
{
    struct neph_shared_device shared = {.open = NULL};
    struct neph_open_device *device = NULL;
    struct neph_engine_info info;
    struct neph_diag diag = {0};
    char *before = getenv("VK_ICD_FILENAMES") ? strdup(getenv("VK_ICD_FILENAMES")) : NULL;
    setenv("VK_ICD_FILENAMES", "/nonexistent/icd.json", 1);
    neph_vulkan_probe(NULL, &shared, &info);
    assert_false(info.available);
    assert_false(info.broken);
    assert_non_null(strstr(info.install_line, "apt-get install"));
    assert_int_equal(neph_device_acquire(&shared, &device, &diag), NEPH_ERR_UNAVAILABLE);
    assert_non_null(strstr(diag.hint, "apt-get install"));
    assert_null(device);
    assert_null(shared.open);
    if (before)
        setenv("VK_ICD_FILENAMES", before, 1);
    else
        unsetenv("VK_ICD_FILENAMES");
    free(before);
    neph_device_release(acquire(&shared));
    neph_shared_device_close(&shared);
}

/* ---- frames ---------------------------------------------------------------------------------- */

enum { width = 16, height = 9 };

static struct neph_image *render(const struct neph_scene *scene, struct neph_shared_device *shared)
{
    const struct neph_engine *engine = &neph_engine_march;
    const struct neph_shot shot = {.scene = scene,
                                   .settings = neph_settings_default(engine),
                                   .width_px = width,
                                   .height_px = height,
                                   .layers = NEPH_LAYERS_ALL,
                                   .seed = 1,
                                   .device = shared};
    struct neph_image *frame = NULL;
    struct neph_cost cost;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_engine_render(engine, &shot, &frame, &cost, &diag), &diag);
    return frame;
}

static void assert_same(const struct neph_image *a, const struct neph_image *b)
{
    assert_int_equal(a->channel_count, b->channel_count);
    for (int c = 0; c < a->channel_count; c++)
        assert_memory_equal(a->channels[c].samples, b->channels[c].samples,
                            neph_image_pixel_count(a) * sizeof(float));
}

static void test_frames_are_those_of_a_device_of_their_own(void **state)
{
    struct neph_shared_device shared = {.open = NULL};
    struct neph_scene *scene = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(
        neph_scene_load(NEPH_SOURCE_DIR "/scenes/catalog/gaussian_blob.yaml", &scene, &diag),
        &diag);
    struct neph_image *own = render(scene, NULL), *first = render(scene, &shared);
    const struct neph_kernel *kernels = shared.open->vulkan->kernels;
    struct neph_image *second = render(scene, &shared);
    assert_non_null(kernels);
    assert_ptr_equal(shared.open->vulkan->kernels, kernels); /* none was created for the second */
    assert_same(own, first);
    assert_same(own, second);
    neph_image_destroy(second);
    neph_image_destroy(first);
    neph_image_destroy(own);
    neph_scene_destroy(scene);
    neph_shared_device_close(&shared);
}

#include "tests/main.h"
