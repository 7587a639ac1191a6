/* SPDX-License-Identifier: MIT */
#include "renderer/spirv_split.h"

#include "renderer/spirv.h"

#include <stdlib.h>
#include <string.h>

enum { BOUND = 3, ADDED_WORDS = 8 }; /* two labels and two branches */

/* The labels of the blocks that a loop header is split into. */
struct parts {
    uint32_t body; /* 0: the header is unchanged */
    uint32_t back; /* 0: the header does not branch to itself */
};

struct splitter {
    struct neph_spirv_module module;
    struct parts *parts; /* owned, by block */
    uint32_t bound;
    uint32_t *out; /* for the caller */
    size_t count;
};

static size_t skip_phis(const struct neph_spirv_module *module,
                        const struct neph_spirv_block *block)
{
    size_t at = block->at + neph_spirv_length(module, block->at);
    while (neph_spirv_operation(module, at) == OP_PHI)
        at += neph_spirv_length(module, at);
    return at;
}

/* Whether a header can be split. Its terminator moves to another block than OpLoopMerge: possible
 * for an OpBranch, and for a conditional branch that exits or continues the loop, since it needs no
 * OpSelectionMerge. */
static bool can_split_header(const struct neph_spirv_module *module,
                             const struct neph_spirv_block *block)
{
    if (!block->merge || neph_spirv_operation(module, block->merge) != OP_LOOP_MERGE ||
        skip_phis(module, block) == block->merge)
        return false;
    const uint32_t *loop = module->words + block->merge, *end = module->words + block->terminator;
    const uint32_t operation = neph_spirv_operation(module, block->terminator);
    return operation == OP_BRANCH ||
           (operation == OP_BRANCH_CONDITIONAL &&
            (end[2] == loop[1] || end[2] == loop[2] || end[3] == loop[1] || end[3] == loop[2]));
}

static void plan_splits(struct splitter *splitter)
{
    const struct neph_spirv_module *module = &splitter->module;
    for (int b = 0; b < module->block_count; b++) {
        const struct neph_spirv_block *block = &module->blocks[b];
        if (!can_split_header(module, block))
            continue;
        splitter->parts[b].body = splitter->bound++;
        if (module->words[block->merge + 2] == neph_spirv_get_label(module, block))
            splitter->parts[b].back = splitter->bound++;
    }
}

/* --- output ----------------------------------------------------------------------------------- */

static void write_word(struct splitter *splitter, uint32_t word)
{
    splitter->out[splitter->count++] = word;
}

static void write_instruction(struct splitter *splitter, uint32_t operation, uint32_t operand)
{
    write_word(splitter, 2u << 16 | operation);
    write_word(splitter, operand);
}

static void copy_words(struct splitter *splitter, size_t at, size_t end)
{
    memcpy(splitter->out + splitter->count, splitter->module.words + at,
           (end - at) * sizeof(*splitter->out));
    splitter->count += end - at;
}

/* The new predecessor of `block` for a branch that came from `parent`. */
static uint32_t map_predecessor(const struct splitter *splitter, int block, uint32_t parent)
{
    const int from = splitter->module.ids[parent].block;
    const struct parts *parts = &splitter->parts[from];
    if (from == block && parts->back)
        return parts->back;
    return parts->body ? parts->body : parent;
}

static void copy_phis(struct splitter *splitter, int block, size_t at, size_t end)
{
    const struct neph_spirv_module *module = &splitter->module;
    for (size_t length; at < end; at += length) {
        uint32_t *words = splitter->out + splitter->count;
        length = neph_spirv_length(module, at);
        copy_words(splitter, at, at + length);
        for (size_t i = 4; i < length; i += 2)
            words[i] = map_predecessor(splitter, block, words[i]);
    }
}

/* Copy the OpLoopMerge or the branch of a block, whose operands 1 .. last may be labels. The label
 * of the block itself is replaced by the label of its new last block. */
static void copy_redirected(struct splitter *splitter, int block, size_t at, size_t last)
{
    const struct neph_spirv_module *module = &splitter->module;
    const uint32_t label = neph_spirv_get_label(module, &module->blocks[block]);
    const size_t length = neph_spirv_length(module, at);
    uint32_t *words = splitter->out + splitter->count;
    copy_words(splitter, at, at + length);
    for (size_t i = 1; i <= last && i < length && splitter->parts[block].back; i++)
        if (words[i] == label)
            words[i] = splitter->parts[block].back;
}

static void write_block(struct splitter *splitter, int b)
{
    const struct neph_spirv_module *module = &splitter->module;
    const struct neph_spirv_block *block = &module->blocks[b];
    const struct parts *parts = &splitter->parts[b];
    const size_t phis = block->at + neph_spirv_length(module, block->at);
    const size_t body = skip_phis(module, block);
    copy_words(splitter, block->at, phis);
    copy_phis(splitter, b, phis, body);
    if (!parts->body) {
        copy_words(splitter, body, block->end);
        return;
    }
    copy_redirected(splitter, b, block->merge, 2);
    write_instruction(splitter, OP_BRANCH, parts->body);
    write_instruction(splitter, OP_LABEL, parts->body);
    copy_words(splitter, body, block->merge);
    copy_redirected(splitter, b, block->terminator, 3);
    if (!parts->back)
        return;
    write_instruction(splitter, OP_LABEL, parts->back);
    write_instruction(splitter, OP_BRANCH, neph_spirv_get_label(module, block));
}

static void write_module(struct splitter *splitter)
{
    const struct neph_spirv_module *module = &splitter->module;
    size_t at = 0;
    for (int b = 0; b < module->block_count; b++) {
        copy_words(splitter, at, module->blocks[b].at);
        write_block(splitter, b);
        at = module->blocks[b].end;
    }
    copy_words(splitter, at, module->word_count);
    splitter->out[BOUND] = splitter->bound;
}

bool neph_spirv_split_loops(const uint32_t *words, size_t size_bytes, uint32_t **split,
                            size_t *split_bytes)
{
    struct splitter splitter = {.bound = words[BOUND]};
    bool fits = neph_spirv_read(words, size_bytes, &splitter.module);
    if (fits) {
        const size_t blocks = (size_t)splitter.module.block_count;
        splitter.parts = calloc(blocks + 1, sizeof(*splitter.parts));
        splitter.out = calloc(splitter.module.word_count + ADDED_WORDS * blocks,
                              sizeof(*splitter.out));
        fits = splitter.parts && splitter.out;
    }
    if (fits) {
        plan_splits(&splitter);
        write_module(&splitter);
        *split = splitter.out;
        *split_bytes = splitter.count * sizeof(*splitter.out);
    } else {
        free(splitter.out);
    }
    free(splitter.parts);
    neph_spirv_free(&splitter.module);
    return fits;
}
