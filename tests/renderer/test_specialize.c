/* SPDX-License-Identifier: MIT
 *
 * Shaders with their specialization constants applied: results of a probe with many control-flow
 * constructs compared with C, validation of the renderer's shaders by the layer, and invalid
 * shaders.
 */
#include "tests/renderer/probe.h"

#include "renderer/realtime/shared/names.h"
#include "renderer/shader_code.h"
#include "renderer/specialize.h"

#include <zlib.h>

static const uint32_t probe_code[] = {
#include "shaders/probe_constants.comp.inc"
};
static const uint32_t march_code[] = {
#include "shaders/march.comp.inc"
};
static const uint32_t tracer_code[] = {
#include "shaders/tracer.comp.inc"
};
static const uint32_t first_code[] = {
#include "shaders/tracer_first.comp.inc"
};
static const uint32_t taa_code[] = {
#include "realtime/anti_aliasing/taa.comp.inc"
};

static const uint32_t reconstruct_code[] = {
#include "realtime/reconstruction/reconstruct.comp.inc"
};
static const uint32_t ray_march_code[] = {
#include "realtime/ray_march/ray_march.comp.inc"
};

enum { ANSWERS = 64, CONSTANTS = 4 };

struct constants {
    uint32_t kind, is_on, turns;
    float factor;
};

/* --- shaders/probe_constants.comp in C -------------------------------------------------------- */

static uint32_t early(const struct constants *c, uint32_t x)
{
    if (c->kind == 1)
        return x + 1;
    if (c->is_on && x > 40)
        return 7;
    for (uint32_t i = 0; i < c->turns; i++) {
        if (c->kind == 4)
            return i;
        if (x % 3 == i)
            return 100 + i;
    }
    return x * 2;
}

static uint32_t chosen(const struct constants *c, uint32_t x)
{
    if (c->kind == 0)
        return x + 5;
    if (c->kind == 2)
        return (x * 3) ^ 9;
    return c->kind == 3 ? x ^ 9 : 1;
}

static uint32_t turns(const struct constants *c, uint32_t x)
{
    uint32_t sum = 0;
    do {
        sum += x & 3;
        if (c->kind == 3)
            break;
        for (uint32_t i = 0; c->is_on && i < x; i++)
            sum += i == c->kind ? 0 : i;
    } while (!c->is_on && sum < 6 && x % 4 != 0);
    do
        sum += c->is_on && c->kind == 2 ? 11 : 0;
    while (c->is_on && c->kind == 2 && sum <= 60);
    return sum;
}

static float scaled(const struct constants *c, uint32_t x)
{
    const float value = c->is_on ? (float)x * c->factor : (float)x + c->factor;
    if (c->kind > 2 || value > 9.0f)
        return value;
    return c->kind == 2 ? c->factor : 3.0f;
}

/* --- the probe ---------------------------------------------------------------------------- */

static void check_answers(const struct constants *c, uint32_t (*answers)[4])
{
    enum { KEPT = 11 };
    for (uint32_t x = 0; x < ANSWERS; x++) {
        const float value = scaled(c, x);
        assert_int_equal(answers[x][0], early(c, x) + KEPT);
        assert_int_equal(answers[x][1], chosen(c, x) + (c->kind << 3 | c->is_on));
        assert_int_equal(answers[x][2], turns(c, x));
        assert_memory_equal(&answers[x][3], &value, sizeof(value));
    }
}

static void test_every_way(void **state)
{
    uint32_t asked[ANSWERS];
    for (uint32_t i = 0; i < ANSWERS; i++)
        asked[i] = i;
    for (uint32_t i = 0; i < 24; i++) {
        const struct constants constants = {i % 6, i / 6 % 2, i / 12 * 3, 0.25f};
        struct neph_kernel_params params = {.name = "probe_constants",
                                            .code = probe_code,
                                            .code_bytes = sizeof(probe_code),
                                            .buffer_count = 2,
                                            .constant_count = CONSTANTS};
        memcpy(params.constants, &constants, sizeof(constants));
        uint32_t(*answers)[4] = test_probe(*state, &params, NULL, asked, sizeof(asked[0]),
                                           sizeof(*answers), ANSWERS);
        check_answers(&constants, answers);
        free(answers);
    }
}

/* --- the renderer's shaders ----------------------------------------------------------------- */

static const struct {
    const char *name;
    const uint32_t *code;
    size_t code_bytes;
} shaders[] = {
    {"probe_constants", probe_code, sizeof(probe_code)},
    {"march", march_code, sizeof(march_code)},
    {"tracer", tracer_code, sizeof(tracer_code)},
    {"tracer_first", first_code, sizeof(first_code)},
    {"taa", taa_code, sizeof(taa_code)},
};

static bool has_open_constants(const uint32_t *words, size_t size_bytes)
{
    enum { HEADER_WORDS = 5, OP_DECORATE = 71, SPEC_ID = 1 };
    bool has = false;
    for (size_t i = HEADER_WORDS; i < size_bytes / sizeof(*words); i += words[i] >> 16)
        has |= (words[i] & 0xffff) == OP_DECORATE && words[i + 2] == SPEC_ID;
    return has;
}

/* The layer validates every module that is created. */
static void check_module(struct neph_vulkan *vulkan, const uint32_t *words, size_t size_bytes)
{
    const VkShaderModuleCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
        .codeSize = size_bytes,
        .pCode = words,
    };
    VkShaderModule module;
    assert_int_equal(vulkan->api.vkCreateShaderModule(vulkan->device, &info, NULL, &module), 0);
    vulkan->api.vkDestroyShaderModule(vulkan->device, module, NULL);
    struct neph_diag diag = {0};
    neph_assert_ok(neph_vulkan_check(vulkan, &diag), &diag);
}

static void specialize(const uint32_t *code, size_t code_bytes, const uint32_t *constants,
                       int count, uint32_t **words, size_t *size_bytes, size_t *whole_bytes)
{
    struct neph_diag diag = {0};
    OWNED(memory) uint32_t *whole = NULL;
    neph_assert_ok(neph_shader_unpack(code, code_bytes, &whole, whole_bytes, &diag), &diag);
    assert_true(has_open_constants(whole, *whole_bytes));
    neph_assert_ok(neph_specialize(whole, *whole_bytes, constants, count, words, size_bytes, &diag),
                   &diag);
}

static void test_valid_for_all_constants(void **state)
{
    enum { COUNT = 12 };
    const size_t tries = (size_t)neph_test_by_day(1, 3);
    const uint64_t seed = 20261123;
    uint64_t random = seed;
    for (size_t i = 0; i < tries * sizeof(shaders) / sizeof(shaders[0]); i++) {
        uint32_t constants[COUNT], *spirv = NULL;
        size_t bytes = 0, whole_bytes = 0;
        for (int j = 0; j < COUNT; j++)
            constants[j] = (uint32_t)neph_test_random(&random) >> neph_test_random(&random) % 32;
        const size_t shader = i / tries;
        print_message("%s, seed %llu, try %zu\n", shaders[shader].name, (unsigned long long)seed,
                      i % tries);
        specialize(shaders[shader].code, shaders[shader].code_bytes, constants, COUNT, &spirv,
                   &bytes, &whole_bytes);
        assert_false(has_open_constants(spirv, bytes));
        check_module(*state, spirv, bytes);
        free(spirv);
    }
}

/* Bits that a shader does not read make no other kernel (kernel.c): the words are the same for all
 * values of these bits. A pass of the real-time pipeline reads few of 150 settings. */
static void test_bits_that_are_not_read_change_nothing(void **state)
{
    enum { COUNT = RT_CONSTANT_COUNT };
    uint64_t random = 39;
    for (size_t i = 0; i < sizeof(shaders) / sizeof(shaders[0]); i++) {
        uint32_t all[COUNT], read[COUNT], *words[2] = {NULL};
        size_t bytes[2], whole_bytes;
        int unread = 0;
        if (!neph_test_is_night() && shaders[i].code != taa_code && shaders[i].code != probe_code)
            continue;
        for (int c = 0; c < COUNT; c++) {
            all[c] = (uint32_t)neph_test_random(&random) >> neph_test_random(&random) % 32;
            read[c] = all[c] & neph_shader_constant_bits(shaders[i].code, c);
            unread += __builtin_popcount(~neph_shader_constant_bits(shaders[i].code, c));
        }
        specialize(shaders[i].code, shaders[i].code_bytes, all, COUNT, &words[0], &bytes[0],
                   &whole_bytes);
        specialize(shaders[i].code, shaders[i].code_bytes, read, COUNT, &words[1], &bytes[1],
                   &whole_bytes);
        print_message("%s: %d of %d bits are not read\n", shaders[i].name, unread, 32 * COUNT);
        assert_int_equal(bytes[0], bytes[1]);
        assert_memory_equal(words[0], words[1], bytes[0]);
        assert_true(shaders[i].code != taa_code || unread > 32 * RT_CHOICE_CONSTANT_COUNT - 4 * 40);
        free(words[0]);
        free(words[1]);
    }
}

/* A march of an empty scene contains no medium, no light and no cloud. */
static void test_unused_goes(void **state)
{
    const uint32_t nothing[12] = {0}, all_kinds[12] = {(1u << NEPH_MEDIUM_KIND_COUNT) - 1, 262532};
    size_t bytes[2], whole_bytes;
    for (int i = 0; i < 2; i++) {
        OWNED(memory) uint32_t *spirv = NULL;
        specialize(march_code, sizeof(march_code), i == 0 ? nothing : all_kinds, 12, &spirv,
                   &bytes[i], &whole_bytes);
    }
    print_message("%zu bytes for nothing, %zu for all media\n", bytes[0], bytes[1]);
    assert_true(4 * bytes[0] < bytes[1]);
}

/* The tracer's work groups have the size given by a constant. */
static void test_the_size_of_work_groups_stays(void **state)
{
    enum { HEADER_WORDS = 5, OP_DECORATE = 71, BUILT_IN = 11, WORKGROUP_SIZE = 25 };
    const uint32_t constants[3] = {[2] = 8};
    OWNED(memory) uint32_t *words = NULL;
    size_t bytes = 0, whole_bytes = 0;
    specialize(tracer_code, sizeof(tracer_code), constants, 3, &words, &bytes, &whole_bytes);
    bool has_size = false;
    for (size_t i = HEADER_WORDS; i < bytes / sizeof(*words); i += words[i] >> 16)
        has_size |= (words[i] & 0xffff) == OP_DECORATE && words[i + 2] == BUILT_IN &&
                    words[i + 3] == WORKGROUP_SIZE;
    assert_true(has_size);
}

/* Whether a module declares the capability, or has a type that needs it. */
static bool has_int64(const uint32_t *words, size_t size_bytes)
{
    enum { HEADER_WORDS = 5, OP_CAPABILITY = 17, OP_TYPE_INT = 21, INT64 = 11 };
    bool has = false;
    for (size_t i = HEADER_WORDS; i < size_bytes / sizeof(*words); i += words[i] >> 16)
        has |= ((words[i] & 0xffff) == OP_CAPABILITY && words[i + 1] == INT64) ||
               ((words[i] & 0xffff) == OP_TYPE_INT && words[i + 2] == 64);
    return has;
}

/* renderer/requirements.c requires shaderInt64 of a CPU device, but not of a GPU. */
static void test_kernels_of_a_gpu_need_no_int64(void **state)
{
    static const struct {
        const uint32_t *code;
        size_t code_bytes;
    } passes[] = {{taa_code, sizeof(taa_code)},
                  {reconstruct_code, sizeof(reconstruct_code)},
                  {ray_march_code, sizeof(ray_march_code)}};
    for (size_t i = 0; i < COUNT(passes); i++)
        for (uint32_t variant = 0; variant < 4; variant++) {
            uint32_t constants[RT_CONSTANT_COUNT] = {0}, *words = NULL;
            size_t bytes = 0, whole_bytes = 0;
            const bool is_gpu = variant / 2 == 1;
            constants[RT_GPU_ACCESS_CONSTANT] = is_gpu;
            constants[RT_SPECIALISED_CONSTANT] = variant % 2;
            specialize(passes[i].code, passes[i].code_bytes, constants, RT_CONSTANT_COUNT, &words,
                       &bytes, &whole_bytes);
            assert_true(has_int64(words, bytes) == !is_gpu);
            free(words);
        }
}

/* --- refusals ------------------------------------------------------------------------------- */

enum { PACKED_HEAD = 2 + 34 };

/* Packed as by pack_shader.py, with constant 1 and the lowest digit of constant 33. */
static size_t pack(const void *module, size_t size_bytes, uint32_t packed[64])
{
    uLongf deflated = (64 - PACKED_HEAD) * sizeof(*packed);
    unsigned char planes[64];
    for (size_t i = 0; i < size_bytes; i++)
        planes[i % 4 * (size_bytes / 4) + i / 4] = ((const unsigned char *)module)[i];
    memset(packed, 0, 64 * sizeof(*packed));
    packed[0] = (uint32_t)size_bytes;
    packed[1] = 34;
    packed[2 + 1] = UINT32_MAX;
    packed[2 + 33] = 15;
    assert_int_equal(compress((Bytef *)(packed + PACKED_HEAD), &deflated, planes, size_bytes),
                     Z_OK);
    return PACKED_HEAD * sizeof(*packed) + deflated;
}

/* The batch that needs a kernel gets its shader's name, its constants and the reason. */
static void test_a_refused_shader_is_named(void **state)
{
    static const uint32_t no_spirv[8] = {0x07230203, 0x00010500, 0, 2, 0, 0x0001ffff, 1, 2};
    uint32_t packed[64];
    const struct neph_kernel_params params = {
        .name = "refused",
        .code = packed,
        .code_bytes = pack(no_spirv, sizeof(no_spirv), packed),
        .constant_count = 34,
        .constants = {[1] = 7, [2] = 8, [33] = 0x79},
    };
    const struct neph_dispatch dispatch = {.group_count = 1};
    const struct neph_kernel *kernel = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_kernel_get(*state, &params, &kernel, &diag), &diag);
    for (int i = 0; i < 2; i++) {
        diag = (struct neph_diag){0};
        assert_int_equal(neph_kernel_run(*state, kernel, &dispatch, NULL, &diag),
                         NEPH_ERR_INTERNAL);
        print_message("%s\n", diag.message);
        assert_non_null(strstr(diag.message, "shader refused with the constants 1:7 33:9: "
                                             "SPIRV-Tools refuses to specialise it: "));
    }
}

static void test_a_damaged_shader_is_found(void **state)
{
    static const uint32_t module[16] = {1, 2, 3};
    uint32_t packed[64], *words = NULL;
    size_t size_bytes = 0;
    struct neph_diag diag = {0};
    const size_t bytes = pack(module, sizeof(module), packed);
    neph_assert_ok(neph_shader_unpack(packed, bytes, &words, &size_bytes, &diag), &diag);
    assert_int_equal(size_bytes, sizeof(module));
    assert_memory_equal(words, module, sizeof(module));
    free(words);
    static const uint32_t bits[][2] = {{0, 0}, {1, UINT32_MAX}, {33, 15}, {34, 0}, {96, 0}};
    for (size_t i = 0; i < COUNT(bits); i++)
        assert_int_equal(neph_shader_constant_bits(packed, (int)bits[i][0]), bits[i][1]);
    packed[PACKED_HEAD + 1] ^= 0x100;
    assert_int_equal(neph_shader_unpack(packed, bytes, &words, &size_bytes, &diag),
                     NEPH_ERR_INTERNAL);
}

#include "tests/renderer/main.h"
