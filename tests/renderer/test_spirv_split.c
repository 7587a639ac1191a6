/* SPDX-License-Identifier: MIT
 *
 * Loops that are split for a validation layer (renderer/spirv_split.h): the modules are valid,
 * their results are unchanged, and the layer's checks can be added.
 */
#include "tests/renderer/probe.h"
#include "tests/renderer/shader_words.h"

#include "renderer/spirv_split.h"

static const uint32_t probe_code[] = {
#include "shaders/probe_loops.comp.inc"
};
static const uint32_t march_code[] = {
#include "shaders/march.comp.inc"
};
static const uint32_t first_code[] = {
#include "shaders/tracer_first.comp.inc"
};
static const uint32_t ray_march_code[] = {
#include "realtime/ray_march/ray_march.comp.inc"
};

#define CODE(code_) code_, sizeof(code_)
static const struct {
    const uint32_t *code;
    size_t code_bytes;
} shaders[] = {{CODE(probe_code)}, {CODE(march_code)}, {CODE(first_code)}, {CODE(ray_march_code)}};

enum { SHADERS = sizeof(shaders) / sizeof(shaders[0]), HEADER_WORDS = 5, ANSWERS = 64 };

static bool is_between(uint32_t operation, uint32_t first, uint32_t last)
{
    return operation >= first && operation <= last;
}

/* Loads, stores, images and atomics between the label of a loop's header and its OpLoopMerge. */
static int count_accesses(const uint32_t *words, size_t word_count)
{
    enum { LOAD = 61, STORE = 62, LOOP_MERGE = 246, LABEL = 248 };
    int count = 0, of_block = 0;
    for (size_t i = HEADER_WORDS; i < word_count; i += words[i] >> 16) {
        const uint32_t operation = words[i] & 0xffff;
        of_block = operation == LABEL ? 0 : of_block;
        of_block += is_between(operation, LOAD, STORE) || is_between(operation, 87, 99) ||
                    is_between(operation, 227, 242);
        count += operation == LOOP_MERGE ? of_block : 0;
    }
    return count;
}

/* The layer validates every module that is created. */
static void check_module(struct neph_vulkan *vulkan, const uint32_t *words, size_t size_bytes)
{
    const VkShaderModuleCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                           .codeSize = size_bytes,
                                           .pCode = words};
    VkShaderModule module;
    struct neph_diag diag = {0};
    assert_int_equal(vulkan->api.vkCreateShaderModule(vulkan->device, &info, NULL, &module), 0);
    vulkan->api.vkDestroyShaderModule(vulkan->device, module, NULL);
    neph_assert_ok(neph_vulkan_check(vulkan, &diag), &diag);
}

static void test_headers_have_no_access(void **state)
{
    const uint32_t constants[12] = {(1u << NEPH_MEDIUM_KIND_COUNT) - 1, 262532};
    int before = 0;
    for (int i = 0; i < SHADERS; i++) {
        size_t count = 0, bytes = 0, again_bytes = 0;
        OWNED(memory) uint32_t *split = NULL, *again = NULL;
        OWNED(memory)
        uint32_t *words = test_shader_words(shaders[i].code, shaders[i].code_bytes, constants, 12,
                                            &count);
        before += count_accesses(words, count);
        assert_true(neph_spirv_split_loops(words, count * sizeof(*words), &split, &bytes));
        assert_int_equal(count_accesses(split, bytes / sizeof(*split)), 0);
        check_module(*state, split, bytes);
        assert_true(neph_spirv_split_loops(split, bytes, &again, &again_bytes));
        assert_int_equal(again_bytes, bytes);
        assert_memory_equal(again, split, bytes);
    }
    print_message("%d accesses in headers before\n", before);
    assert_true(before > 0);
}

/* Ways 0 and 1 of shaders/probe_loops.comp, which lavapipe executes correctly. */
static void check_answers(struct neph_vulkan *vulkan)
{
    for (uint32_t way = 0; way < 2; way++) {
        const struct neph_kernel_params params = {.name = "probe_loops",
                                                  .code = probe_code,
                                                  .code_bytes = sizeof(probe_code),
                                                  .buffer_count = 2,
                                                  .constant_count = 2,
                                                  .constants = {way, 0}};
        uint32_t asked[ANSWERS];
        for (uint32_t i = 0; i < ANSWERS; i++)
            asked[i] = i;
        OWNED(memory)
        uint32_t *answers = test_probe(vulkan, &params, NULL, asked, sizeof(*asked),
                                       sizeof(*answers), ANSWERS);
        for (uint32_t x = 0, sum = 0, i = 0; x < ANSWERS; x++) {
            while (way == 0 && (i == 0 || sum < x))
                sum += ++i;
            assert_int_equal(answers[x], way == 0 ? sum : x);
        }
    }
}

static void test_the_layer_can_add_its_checks(void **state)
{
    const struct neph_vulkan_params params = {.validation = NEPH_VALIDATION_SHADERS};
    struct neph_vulkan *vulkan = NULL;
    struct neph_diag diag = {0};
    (void)state;
    neph_assert_ok(neph_vulkan_create(&params, &vulkan, &diag), &diag);
    check_answers(vulkan);
    neph_assert_ok(neph_vulkan_check(vulkan, &diag), &diag);
    assert_int_equal(neph_vulkan_destroy(vulkan), 0);
}

#include "tests/renderer/main.h"
