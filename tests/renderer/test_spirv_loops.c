/* SPDX-License-Identifier: MIT
 *
 * Values used after a loop: the results of devices, and that renderer/spirv_loops.h detects the
 * kernels for which lavapipe loses them. Kernels of all tests are checked in the same way.
 */
#include "tests/renderer/probe.h"
#include "tests/renderer/shader_words.h"

#include "renderer/spirv_loops.h"

static const uint32_t probe_code[] = {
#include "shaders/probe_loops.comp.inc"
};

enum { ANSWERS = 64 };

/* --- shaders/probe_loops.comp in C -------------------------------------------------------- */

static uint32_t carried(uint32_t x)
{
    uint32_t sum = 0, i = 0;
    do
        sum += i++ + 1;
    while (sum < x);
    return sum;
}

static uint32_t same(uint32_t x)
{
    return x;
}

static uint32_t next_third(uint32_t x)
{
    return (x + 2) / 3 * 3;
}

static uint32_t place_before(uint32_t x)
{
    uint32_t at = x % 7, before = at, value = 0;
    while (value < x && at < 60) {
        value = before = at;
        at += 1 + (x & 1);
    }
    return before;
}

static uint32_t once(uint32_t x)
{
    const uint32_t value = x & 7;
    return value > 3 ? value + x : value > 1 ? x : value;
}

static uint32_t yes(uint32_t x)
{
    return 1;
}

static const struct {
    const char *name;
    uint32_t (*answer)(uint32_t x);
    bool is_kept; /* by lavapipe, too */
} ways[] = {
    {"carried from turn to turn", carried, true}, {"left at its start", same, true},
    {"read in the last turn", same, false},       {"made in the last turn", next_third, false},
    {"read in the last turn of all", yes, true},  {"where the turn before was", place_before, true},
    {"left in its first turn", once, true},
};

enum { WAYS = sizeof(ways) / sizeof(ways[0]) };

static struct neph_kernel_params make_params(uint32_t way)
{
    return (struct neph_kernel_params){.name = "probe_loops",
                                       .code = probe_code,
                                       .code_bytes = sizeof(probe_code),
                                       .buffer_count = 2,
                                       .constant_count = 2,
                                       .constants = {way, 0}};
}

/* Number of threads with a wrong result. */
static int run(struct neph_vulkan *vulkan, uint32_t way)
{
    const struct neph_kernel_params params = make_params(way);
    uint32_t asked[ANSWERS];
    int off = 0;
    for (uint32_t i = 0; i < ANSWERS; i++)
        asked[i] = i;
    OWNED(memory)
    uint32_t *answers = test_probe(vulkan, &params, NULL, asked, sizeof(*asked), sizeof(*answers),
                                   ANSWERS);
    for (uint32_t i = 0; i < ANSWERS; i++)
        off += answers[i] != ways[way].answer(i);
    return off;
}

static void test_what_is_kept_is_right(void **state)
{
    for (uint32_t way = 0; way < WAYS; way++)
        if (ways[way].is_kept)
            assert_int_equal(run(*state, way), 0);
}

static void test_what_is_lost_is_found(void **state)
{
    for (uint32_t way = 0; way < WAYS; way++) {
        const struct neph_kernel_params params = make_params(way);
        struct neph_spirv_lost lost;
        size_t words = 0;
        OWNED(memory)
        uint32_t *spirv = test_shader_words(params.code, params.code_bytes, params.constants, 2,
                                            &words);
        assert_true(neph_spirv_find_lost(spirv, words * sizeof(*spirv), &lost));
        print_message("%s: value %u, loop %u\n", ways[way].name, lost.value, lost.header);
        assert_int_equal(lost.value == 0, ways[way].is_kept);
        assert_int_equal(lost.header == 0, ways[way].is_kept);
    }
}

/* The shader is correct, and so is a GPU. lavapipe loses exactly the predicted values: threads that
 * leave last keep theirs. Such a kernel causes a validation message. */
static void test_the_fault(void **state)
{
    struct neph_vulkan *vulkan = NULL;
    struct neph_diag diag = {0};
    neph_assert_ok(neph_vulkan_create(NULL, &vulkan, &diag), &diag);
    const bool is_on_cpu = neph_vulkan_describe(vulkan).is_cpu;
    for (uint32_t way = 0; way < WAYS; way++) {
        const int off = run(vulkan, way);
        print_message("%s: %d of %d threads are off\n", ways[way].name, off, ANSWERS);
        assert_true(off == 0 || (is_on_cpu && !ways[way].is_kept && off < ANSWERS));
    }
    neph_vulkan_destroy(vulkan);
}

static void test_validation_tells(void **state)
{
    struct neph_vulkan *vulkan = NULL;
    const struct neph_kernel *kernel = NULL;
    const struct neph_kernel_params kept = make_params(1), lost = make_params(2);
    struct neph_diag diag = {0};
    neph_assert_ok(
        neph_vulkan_create(&(struct neph_vulkan_params){.validation = NEPH_VALIDATION_ON}, &vulkan,
                           &diag),
        &diag);
    neph_assert_ok(neph_kernel_get(vulkan, &kept, &kernel, &diag), &diag);
    neph_assert_ok(neph_vulkan_check(vulkan, &diag), &diag);
    neph_assert_ok(neph_kernel_get(vulkan, &lost, &kernel, &diag), &diag);
    const bool is_on_cpu = neph_vulkan_describe(vulkan).is_cpu;
    assert_int_equal(neph_vulkan_check(vulkan, &diag), is_on_cpu ? NEPH_ERR_INTERNAL : NEPH_OK);
    assert_true(!is_on_cpu || strstr(diag.message, "shader probe_loops"));
    assert_int_equal(neph_vulkan_destroy(vulkan), is_on_cpu);
}

#include "tests/renderer/main.h"
