/* SPDX-License-Identifier: MIT */
#include "renderer/spirv.h"

#include <stdlib.h>

/* Two instructions of GLSL.std.450 write through a pointer. */
enum { GLSL_MODF = 35, GLSL_FREXP = 51 };

static const struct {
    uint32_t first, last;
} pure_operations[] = {
    {OP_UNDEF, OP_UNDEF},
    {OP_EXT_INST, OP_EXT_INST},
    {OP_CONSTANT_TRUE, OP_CONSTANT_NULL},
    {OP_SPEC_CONSTANT_TRUE, OP_SPEC_CONSTANT_OP},
    {OP_LOAD, OP_LOAD},
    {OP_ACCESS_CHAIN, OP_ARRAY_LENGTH},
    {OP_VECTOR_EXTRACT_DYNAMIC, OP_TRANSPOSE},
    {OP_CONVERT_F_TO_U, OP_BITCAST},
    {OP_S_NEGATE, OP_S_MUL_EXTENDED},
    {OP_ANY, OP_F_UNORD_GREATER_THAN_EQUAL},
    {OP_SHIFT_RIGHT_LOGICAL, OP_BIT_COUNT},
    {OP_PHI, OP_PHI},
    {OP_COPY_LOGICAL, OP_COPY_LOGICAL},
};

bool neph_spirv_is_pure(const struct neph_spirv_module *module, size_t at)
{
    const uint32_t operation = neph_spirv_operation(module, at);
    if (operation == OP_EXT_INST)
        return module->words[at + 4] != GLSL_MODF && module->words[at + 4] != GLSL_FREXP;
    if (operation == OP_VARIABLE)
        return at > module->functions;
    for (size_t i = 0; i < sizeof(pure_operations) / sizeof(pure_operations[0]); i++)
        if (operation >= pure_operations[i].first && operation <= pure_operations[i].last)
            return true;
    return false;
}

/* --- reading ------------------------------------------------------------------------------ */

/* Index the definitions. Returns the number of blocks. */
static int read_ids(struct neph_spirv_module *module)
{
    int block_count = 0;
    module->functions = module->word_count;
    for (size_t at = NEPH_SPIRV_HEADER_WORDS; at < module->word_count;
         at += neph_spirv_length(module, at)) {
        const uint32_t operation = neph_spirv_operation(module, at);
        if (operation == OP_FUNCTION && at < module->functions)
            module->functions = at;
        block_count += operation == OP_LABEL;
        if (neph_spirv_is_pure(module, at))
            module->ids[module->words[at + 2]].at = at;
    }
    return block_count;
}

static bool is_terminator(uint32_t operation)
{
    return operation >= OP_BRANCH && operation <= OP_UNREACHABLE;
}

/* Index a block. Returns the index of the word after it. */
static size_t read_block(struct neph_spirv_module *module, size_t at, int index)
{
    struct neph_spirv_block *block = &module->blocks[index];
    block->at = at;
    module->ids[module->words[at + 1]].block = index;
    while (!is_terminator(neph_spirv_operation(module, at))) {
        const uint32_t operation = neph_spirv_operation(module, at);
        if (neph_spirv_is_pure(module, at))
            module->ids[module->words[at + 2]].block = index;
        if (operation == OP_LOOP_MERGE || operation == OP_SELECTION_MERGE)
            block->merge = at;
        at += neph_spirv_length(module, at);
    }
    block->terminator = at;
    block->end = at + neph_spirv_length(module, at);
    return block->end;
}

static void read_blocks(struct neph_spirv_module *module)
{
    size_t at = module->functions;
    while (at < module->word_count)
        if (neph_spirv_operation(module, at) == OP_LABEL)
            at = read_block(module, at, module->block_count++);
        else
            at += neph_spirv_length(module, at);
}

bool neph_spirv_read(const uint32_t *words, size_t size_bytes, struct neph_spirv_module *module)
{
    enum { BOUND = 3 };
    *module = (struct neph_spirv_module){
        .words = words,
        .word_count = size_bytes / sizeof(*words),
        .id_count = words[BOUND],
    };
    module->ids = calloc(module->id_count, sizeof(*module->ids));
    if (!module->ids)
        return false;
    for (uint32_t i = 0; i < module->id_count; i++)
        module->ids[i].block = NEPH_SPIRV_NO_BLOCK;
    module->blocks = calloc((size_t)read_ids(module) + 1, sizeof(*module->blocks));
    if (!module->blocks)
        return false;
    read_blocks(module);
    return true;
}

void neph_spirv_free(struct neph_spirv_module *module)
{
    free(module->blocks);
    free(module->ids);
    *module = (struct neph_spirv_module){0};
}
