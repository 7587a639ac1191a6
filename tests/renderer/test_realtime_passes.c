/* SPDX-License-Identifier: MIT
 *
 * The declarations of the passes agree with their shaders: reads and writes are found in the
 * compiled SPIR-V.
 */
#include "tests/renderer/renderer_test.h"
#include "tests/renderer/shader_words.h"

#include "renderer/realtime/options.h"
#include "renderer/realtime/passes.h"

#include <stdlib.h>

/* The opcodes of SPIR-V 1.5 that are needed. */
enum {
    OP_CONSTANT = 43,
    OP_LOAD = 61,
    OP_STORE = 62,
    OP_ACCESS_CHAIN = 65,
    OP_IN_BOUNDS_ACCESS_CHAIN = 66,
    OP_DECORATE = 71,
    DECORATION_BINDING = 33,
};

/* Properties of an id of the module; 0: unknown. */
struct id {
    uint32_t binding;  /* + 1 */
    uint32_t constant; /* + 1 */
    uint32_t target;   /* + 1: a pointer into it */
};

struct module {
    struct id *ids;
    uint32_t targets_binding; /* + 1: the last binding, except for images and texels */
    bool sees_targets;        /* accesses targets as texels, too */
    uint32_t reads, writes;
};

static bool is_of_texels(uint32_t binding)
{
    return binding >= NEPH_GPU_TEXELS_BINDING && binding <= NEPH_GPU_TEXEL_FOURS_BINDING;
}

static void take_access(struct module *module, const uint32_t *words)
{
    const struct id *base = &module->ids[words[3]], *index = &module->ids[words[4]];
    if (base->binding == 0 || (base->binding != module->targets_binding &&
                               !(module->sees_targets && is_of_texels(base->binding - 1))))
        return;
    assert_true(index->constant > 0); /* the optimizer knows which target it is */
    module->ids[words[2]].target = index->constant;
}

static void take_instruction(struct module *module, const uint32_t *words)
{
    const uint32_t operation = words[0] & 0xffffu;
    if (operation == OP_DECORATE && words[2] == DECORATION_BINDING) {
        module->ids[words[1]].binding = words[3] + 1;
        if (words[3] + 1 > module->targets_binding && words[3] != NEPH_GPU_IMAGES_BINDING &&
            !is_of_texels(words[3]))
            module->targets_binding = words[3] + 1;
    } else if (operation == OP_CONSTANT) {
        module->ids[words[2]].constant = words[3] + 1;
    } else if (operation == OP_ACCESS_CHAIN || operation == OP_IN_BOUNDS_ACCESS_CHAIN) {
        take_access(module, words);
    } else if (operation == OP_LOAD && module->ids[words[3]].target) {
        module->reads |= NEPH_RT_BIT(module->ids[words[3]].target - 1);
    } else if (operation == OP_STORE && module->ids[words[1]].target) {
        module->writes |= NEPH_RT_BIT(module->ids[words[1]].target - 1);
    }
}

/* Adds the accesses of a shader with the given constants. In passes that read the scene, texels
 * belong to its grids. */
static void reflect_with(const struct neph_rt_pass *pass, const struct neph_rt_shader *shader,
                         const uint32_t *constants, int count, struct module *sum)
{
    enum { HEADER_WORDS = 5, BOUND = 3 };
    size_t word_count = 0;
    OWNED(memory)
    uint32_t *words = test_shader_words(shader->code, shader->code_bytes, constants, count,
                                        &word_count);
    struct module module = {.ids = calloc(words[BOUND], sizeof(*module.ids)),
                            .sees_targets = !pass->rays};
    assert_non_null(module.ids);
    for (size_t i = HEADER_WORDS; i < word_count; i += words[i] >> 16)
        take_instruction(&module, words + i);
    free(module.ids);
    sum->reads |= module.reads;
    sum->writes |= module.writes;
}

/* With settings that are read and not constant, on a CPU and, for passes without rays, on a GPU. */
static struct module reflect(const struct neph_rt_pass *pass)
{
    const uint32_t role = (uint32_t)pass->role;
    const uint32_t on_cpu[RT_CONSTANT_COUNT] = {[RT_ROLE_CONSTANT] = role};
    const uint32_t on_gpu[RT_CONSTANT_COUNT] = {[RT_ROLE_CONSTANT] = role,
                                                [RT_GPU_ACCESS_CONSTANT] = 1};
    struct module sum = {.reads = 0};
    reflect_with(pass, &pass->shader, role ? on_cpu : NULL, role ? RT_CONSTANT_COUNT : 0, &sum);
    if (!pass->rays)
        reflect_with(pass, &pass->shader, on_gpu, RT_CONSTANT_COUNT, &sum);
    for (int kind = 0; kind < NEPH_RT_DEVICE_KINDS; kind++)
        if (pass->variants[kind].code)
            reflect_with(pass, &pass->variants[kind], kind == NEPH_RT_GPU ? on_gpu : NULL,
                         kind == NEPH_RT_GPU ? RT_CONSTANT_COUNT : 0, &sum);
    return sum;
}

static void assert_same_targets(const char *pass, const char *what, uint32_t declared,
                                uint32_t found)
{
    for (int t = 0; t < RT_TARGET_COUNT; t++) {
        const bool is_declared = declared & NEPH_RT_BIT(t), is_found = found & NEPH_RT_BIT(t);
        if (is_declared != is_found)
            fail_msg("%s %s '%s' %s", pass, what, neph_rt_target_name(t),
                     is_found ? "and does not declare it" : "by its record, not by its shader");
    }
}

static void test_records_agree_with_shaders(void **state)
{
    for (int p = 0; neph_rt_passes[p]; p++) {
        const struct neph_rt_pass *pass = neph_rt_passes[p];
        const struct module module = reflect(pass);
        assert_same_targets(pass->name, "reads", pass->reads | pass->replaces, module.reads);
        assert_same_targets(pass->name, "writes", pass->writes, module.writes);
    }
}

/* Every target that is read was written by a pass before, in this frame or the last. */
static void test_targets_are_written_before_reads(void **state)
{
    uint32_t there = 0;
    for (int p = 0; neph_rt_passes[p]; p++) {
        const struct neph_rt_pass *pass = neph_rt_passes[p];
        there |= neph_rt_targets_before(pass);
    }
    for (int p = 0; neph_rt_passes[p]; p++) {
        const struct neph_rt_pass *pass = neph_rt_passes[p];
        assert_same_targets(pass->name, "reads before it is made", pass->reads & ~there,
                            pass->reads & ~there & pass->writes);
        there |= pass->writes;
        if (pass->picture)
            assert_true(pass->writes & NEPH_RT_BIT(pass->picture));
    }
}

/* Targets that are handed on are written, and have the same shape under both names for all
 * settings. */
static void test_histories_have_one_shape(void **state)
{
    for (int format = RT_FORMAT_HALF; format <= RT_FORMAT_FLOAT; format++) {
        struct neph_settings settings = neph_options_default(neph_rt_options);
        struct neph_gpu_view view;
        settings.values[RT_TARGET_FORMAT] = format;
        settings.values[RT_SCREEN_PERCENT] = format == RT_FORMAT_HALF ? 100 : 67;
        neph_rt_view_init(&view, &settings, (int[2]){37, 21}, (int[2]){0, 0}, (int[2]){37, 21});
        for (int p = 0; neph_rt_passes[p]; p++) {
            const struct neph_rt_pass *pass = neph_rt_passes[p];
            for (int i = 0; i < NEPH_RT_HISTORIES_MAX && pass->histories[i].before; i++) {
                const struct neph_rt_history history = pass->histories[i];
                assert_true(pass->writes & NEPH_RT_BIT(history.now));
                assert_memory_equal(&view.targets[history.now], &view.targets[history.before],
                                    sizeof(view.targets[0]));
            }
        }
    }
}

/* Every choice fits into the hexadecimal digit that shaders get. */
static void test_choices_fit_into_their_constants(void **state)
{
    for (const struct neph_option *option = neph_rt_options; option->name; option++) {
        int count = 0;
        while (option->choices && option->choices[count])
            count++;
        assert_true(count <= 16);
    }
}

/* One thread per texel, or per column of texels; the last column may be smaller. */
static void test_threads_cover_all_texels(void **state)
{
    struct neph_settings settings = neph_options_default(neph_rt_options);
    struct neph_gpu_view view;
    settings.values[RT_SCREEN_PERCENT] = 50; /* of 73x41, rounded up */
    neph_rt_view_init(&view, &settings, (int[2]){73, 41}, (int[2]){0, 0}, (int[2]){73, 41});
    static const struct {
        int resolution, column;
        uint64_t count;
    } cases[] = {
        {RT_OUTPUT, 0, 73 * 41},
        {RT_OUTPUT, 4, 73 * 11},
        {RT_FULL, 0, 37 * 21},
        {RT_FULL, 4, 37 * 6},
        {RT_FULL, 21, 37},
        {RT_FULL, 64, 37},
        {RT_HALF, 0, 19 * 11},
        {RT_HALF, 2, 19 * 6},
        {RT_QUARTER, 0, 10 * 6},
        {RT_QUARTER, 3, 10 * 2},
        {RT_FROXEL, 0, 37 * 21 * 64},
        {RT_FROXEL_COLUMN, 0, 37 * 21},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct neph_rt_pass pass = {.resolution = cases[i].resolution,
                                          .shader = {.column = cases[i].column}};
        assert_int_equal(neph_rt_thread_count(&view, &pass, &pass.shader), cases[i].count);
    }
    /* A group of 64 per block. */
    const struct neph_rt_condition always = {RT_OVERRIDE, (int)settings.values[RT_OVERRIDE]};
    const struct neph_rt_shader plain = {.column = 0}, wide = {.block = {32, 8}},
                                square = {.block = {8, 8}};
    const struct neph_rt_pass full = {.resolution = RT_FULL};
    assert_int_equal(neph_rt_thread_count(&view, &full, &wide), 64 * 2 * 3);
    const struct neph_rt_pass turns = {.resolution = RT_QUARTER, .in_colours = &always};
    assert_int_equal(neph_rt_colour_count(&view, &turns, &plain), 4);
    assert_int_equal(neph_rt_thread_count(&view, &turns, &plain), 5 * 3); /* of one colour */
    assert_int_equal(neph_rt_colour_count(&view, &turns, &square), 1);
    assert_int_equal(neph_rt_thread_count(&view, &turns, &square), 64 * 2 * 1);
    const struct neph_rt_condition never = {RT_OVERRIDE, RT_OVERRIDE_NONE};
    const struct neph_rt_pass none = {.resolution = RT_QUARTER, .in_colours = &never};
    assert_int_equal(neph_rt_thread_count(&view, &none, &plain), 10 * 6);
}

/* The number of froxel columns is the same for every frame size, in whole pixels; a given size is
 * used. */
static void test_froxel_columns_follow_frame_size(void **state)
{
    static const struct {
        int width_px, height_px, asked_px, px;
    } cases[] = {{1920, 1080, 0, 12}, {3840, 2160, 0, 24}, {320, 180, 0, 2}, {161, 90, 0, 2},
                 {160, 90, 0, 1},     {96, 54, 0, 1},      {96, 54, 12, 12}};
    struct neph_settings settings = neph_options_default(neph_rt_options);
    for (size_t i = 0; i < COUNT(cases); i++) {
        const int size_px[2] = {cases[i].width_px, cases[i].height_px};
        struct neph_gpu_view view;
        settings.values[RT_FROXEL_PX] = cases[i].asked_px;
        neph_rt_view_init(&view, &settings, size_px, (int[2]){0, 0}, size_px);
        assert_int_equal((int)view.settings[RT_FROXEL_PX], cases[i].px);
    }
}

#include "tests/main.h"
