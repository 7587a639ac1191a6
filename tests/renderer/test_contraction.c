/* SPDX-License-Identifier: MIT
 *
 * Contraction: a device may fuse a product into a sum without rounding in between, which lavapipe
 * does not do. No CPU driver shows the effect, so the tests read the shaders' SPIR-V, inlined into
 * one function and with default constants.
 */
#include "tests/renderer/shader_words.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#define SHADER(name) static const uint32_t name[] =

SHADER(march){
#include "shaders/march.comp.inc"
};
SHADER(probe){
#include "shaders/probe.comp.inc"
};
SHADER(probe_media){
#include "shaders/probe_media.comp.inc"
};
SHADER(rt_compose){
#include "realtime/composition/compose.comp.inc"
};
SHADER(rt_march){
#include "realtime/ray_march/ray_march.comp.inc"
};
SHADER(rt_min_max){
#include "realtime/depth_map/depth_map.comp.inc"
};
SHADER(rt_reconstruct){
#include "realtime/reconstruction/reconstruct.comp.inc"
};
SHADER(rt_scene){
#include "realtime/scene_rays/scene_rays.comp.inc"
};
SHADER(rt_taa){
#include "realtime/anti_aliasing/taa.comp.inc"
};
SHADER(rt_taa_gpu){
#include "realtime/anti_aliasing/taa_gpu.comp.inc"
};
SHADER(rt_tile_index){
#include "realtime/tile_index/tile_index.comp.inc"
};
SHADER(rt_upscale){
#include "realtime/upscale/upscale.comp.inc"
};
SHADER(tracer){
#include "shaders/tracer.comp.inc"
};
SHADER(tracer_first){
#include "shaders/tracer_first.comp.inc"
};
SHADER(tracer_guess){
#include "shaders/tracer_guess.comp.inc"
};
SHADER(tracer_lit){
#include "shaders/tracer_lit.comp.inc"
};
SHADER(tracer_sum){
#include "shaders/tracer_sum.comp.inc"
};
SHADER(tracer_view){
#include "shaders/tracer_view.comp.inc"
};

static const struct shader {
    const char *name;
    const uint32_t *code;
    size_t code_bytes;
} shaders[] = {
#define ENTRY(name)                                                                                \
    {                                                                                              \
#name, name, sizeof(name)                                                                  \
    }
    ENTRY(march),      ENTRY(probe),        ENTRY(probe_media),    ENTRY(rt_compose),
    ENTRY(rt_march),   ENTRY(rt_min_max),   ENTRY(rt_reconstruct), ENTRY(rt_scene),
    ENTRY(rt_taa),     ENTRY(rt_taa_gpu),   ENTRY(rt_tile_index),  ENTRY(rt_upscale),
    ENTRY(tracer),     ENTRY(tracer_first), ENTRY(tracer_guess),   ENTRY(tracer_lit),
    ENTRY(tracer_sum), ENTRY(tracer_view),
};

/* SPIR-V 1.5, section 3 */
enum {
    OP_EXT_INST = 12,
    OP_DECORATE = 71,
    OP_VECTOR_SHUFFLE = 79,
    OP_COMPOSITE_CONSTRUCT = 80,
    OP_COMPOSITE_EXTRACT = 81,
    OP_F_NEGATE = 127,
    OP_F_SUB = 131,
    OP_F_MUL = 133,
    OP_VECTOR_TIMES_SCALAR = 142,
    OP_SELECT = 169,
    DECORATION_NO_CONTRACTION = 42,
    /* GLSL.std.450 */
    GLSL_TRUNC = 3,
    GLSL_FLOOR = 8,
    GLSL_CEIL = 9,
    GLSL_F_MIN = 37,
    GLSL_F_MAX = 40,
    GLSL_F_CLAMP = 43,
    GLSL_FMA = 50,
};

/* A module, indexed by result ids. */
struct module {
    uint32_t bound;
    const uint32_t **results; /* instruction of each result; NULL: not of interest */
    bool *is_kept;            /* NoContraction */
};

static uint32_t get_opcode(const uint32_t *instruction)
{
    return instruction[0] & 0xffffu;
}

static uint32_t instruction_length(const uint32_t *instruction)
{
    return instruction[0] >> 16;
}

static struct module read_module(const uint32_t *words, size_t word_count)
{
    enum { HEADER_WORDS = 5, BOUND = 3, FIRST_WITH_RESULT = OP_VECTOR_SHUFFLE, LAST = OP_SELECT };
    struct module module = {.bound = words[BOUND]};
    module.results = calloc(module.bound, sizeof(*module.results));
    module.is_kept = calloc(module.bound, sizeof(*module.is_kept));
    assert_true(module.results && module.is_kept);
    const uint32_t *end = words + word_count;
    for (const uint32_t *at = words + HEADER_WORDS; at < end; at += instruction_length(at)) {
        assert_true(instruction_length(at) > 0 && at + instruction_length(at) <= end);
        const uint32_t op = get_opcode(at);
        if (op == OP_DECORATE && at[2] == DECORATION_NO_CONTRACTION)
            module.is_kept[at[1]] = true;
        if (op == OP_EXT_INST ||
            (op >= FIRST_WITH_RESULT && op <= LAST && instruction_length(at) > 3))
            module.results[at[2]] = at;
    }
    return module;
}

static void finish_module(struct module *module)
{
    free(module->results);
    free(module->is_kept);
}

/* Whether a value is an integer by rounding, possibly selected among several. */
static bool is_rounded(const struct module *module, uint32_t id, int depth)
{
    const uint32_t *at = module->results[id];
    if (!at || depth == 0)
        return false;
    const uint32_t op = get_opcode(at);
    uint32_t first = 0; /* operands from here on may be the rounded one */
    if (op == OP_EXT_INST) {
        const uint32_t function = at[4];
        if (function == GLSL_FLOOR || function == GLSL_CEIL || function == GLSL_TRUNC)
            return true;
        const bool chooses = function == GLSL_F_MIN || function == GLSL_F_MAX ||
                             function == GLSL_F_CLAMP;
        first = chooses ? 5 : 0;
    } else if (op == OP_COMPOSITE_EXTRACT || op == OP_F_NEGATE) {
        return is_rounded(module, at[3], depth - 1);
    } else if (op == OP_COMPOSITE_CONSTRUCT || op == OP_SELECT) {
        first = op == OP_SELECT ? 4 : 3;
    }
    for (uint32_t i = first; first > 0 && i < instruction_length(at); i++)
        if (at[i] < module->bound && is_rounded(module, at[i], depth - 1))
            return true;
    return false;
}

/* Whether a value is a product that may lose its rounding. */
static bool is_open_product(const struct module *module, uint32_t id)
{
    const uint32_t *at = module->results[id];
    while (at && get_opcode(at) == OP_COMPOSITE_EXTRACT) {
        id = at[3];
        at = module->results[id];
    }
    return at && !module->is_kept[id] &&
           (get_opcode(at) == OP_F_MUL || get_opcode(at) == OP_VECTOR_TIMES_SCALAR);
}

/* A difference between a product and an integer part that a device may fuse, or that the SPIR-V
 * optimizer has fused. */
static bool is_open_fraction(const struct module *module, uint32_t id)
{
    enum { DEPTH = 8 };
    const uint32_t *at = module->results[id];
    if (!at || module->is_kept[id])
        return false;
    if (get_opcode(at) == OP_EXT_INST)
        return at[4] == GLSL_FMA && is_rounded(module, at[7], DEPTH);
    return get_opcode(at) == OP_F_SUB && is_open_product(module, at[3]) &&
           is_rounded(module, at[4], DEPTH);
}

static int count_open_fractions(const struct shader *shader)
{
    size_t word_count = 0;
    OWNED(memory)
    uint32_t *words = test_shader_words(shader->code, shader->code_bytes, NULL, 0, &word_count);
    struct module module = read_module(words, word_count);
    int count = 0;
    for (uint32_t id = 0; id < module.bound; id++)
        count += is_open_fraction(&module, id);
    finish_module(&module);
    return count;
}

/* x - floor(x) is in [0, 1) for a rounded x, but not for a product that the device fuses into the
 * subtraction. On an NVIDIA H100, 5 to 23 pixels of each cloud at 1920x1080 became negative, by a
 * density of -1e-6 next to an empty node. */
static void test_no_fraction_of_an_unrounded_product(void **state)
{
    int bad = 0;
    for (size_t i = 0; i < sizeof(shaders) / sizeof(shaders[0]); i++) {
        const int count = count_open_fractions(&shaders[i]);
        if (count > 0)
            print_error("%s.comp: %d fractions that may be contracted\n", shaders[i].name, count);
        bad += count;
    }
    assert_int_equal(bad, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_no_fraction_of_an_unrounded_product)};
    return cmocka_run_group_tests_name("contraction", tests, NULL, NULL);
}
