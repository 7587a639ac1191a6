/* SPDX-License-Identifier: MIT
 *
 * A SPIR-V module in memory, with an index of its values and blocks, for renderer/spirv_loops.h and
 * spirv_split.h. Words and opcodes as in the SPIR-V specification 1.6, chapters 2 and 3.
 */
#ifndef NEPH_RENDERER_SPIRV_H
#define NEPH_RENDERER_SPIRV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum neph_spirv_operation {
    OP_UNDEF = 1,
    OP_EXT_INST = 12,
    OP_CONSTANT_TRUE = 41,
    OP_CONSTANT_NULL = 46,
    OP_SPEC_CONSTANT_TRUE = 48,
    OP_SPEC_CONSTANT_OP = 52,
    OP_FUNCTION = 54,
    OP_VARIABLE = 59,
    OP_LOAD = 61,
    OP_ACCESS_CHAIN = 65,
    OP_ARRAY_LENGTH = 68,
    OP_VECTOR_EXTRACT_DYNAMIC = 77,
    OP_TRANSPOSE = 84,
    OP_CONVERT_F_TO_U = 109,
    OP_BITCAST = 124,
    OP_S_NEGATE = 126,
    OP_S_MUL_EXTENDED = 152,
    OP_ANY = 154,
    OP_LOGICAL_NOT = 168,
    OP_F_UNORD_GREATER_THAN_EQUAL = 191,
    OP_SHIFT_RIGHT_LOGICAL = 194,
    OP_BIT_COUNT = 205,
    OP_PHI = 245,
    OP_LOOP_MERGE = 246,
    OP_SELECTION_MERGE = 247,
    OP_LABEL = 248,
    OP_BRANCH = 249,
    OP_BRANCH_CONDITIONAL = 250,
    OP_SWITCH = 251,
    OP_UNREACHABLE = 255,
    OP_COPY_LOGICAL = 400,
};

enum { NEPH_SPIRV_HEADER_WORDS = 5, NEPH_SPIRV_NO_BLOCK = -1 };

/* The result of an instruction. */
struct neph_spirv_id {
    size_t at; /* index of the word of its definition */
    int block; /* of its definition, or that it labels; NEPH_SPIRV_NO_BLOCK: none */
};

struct neph_spirv_block {
    size_t at, end, terminator; /* word indices, from the label on */
    size_t merge;               /* word index of OpLoopMerge or OpSelectionMerge; 0: none */
};

struct neph_spirv_module {
    const uint32_t *words; /* borrowed */
    size_t word_count;
    size_t functions; /* word index of the first function */
    uint32_t id_count;
    struct neph_spirv_id *ids; /* owned */
    int block_count;
    struct neph_spirv_block *blocks; /* owned */
};

static inline uint32_t neph_spirv_operation(const struct neph_spirv_module *module, size_t at)
{
    return module->words[at] & 0xffff;
}

/* Number of words of an instruction; the next one follows them. */
static inline size_t neph_spirv_length(const struct neph_spirv_module *module, size_t at)
{
    return module->words[at] >> 16;
}

/* The block of a label. */
static inline struct neph_spirv_block *neph_spirv_get_block(const struct neph_spirv_module *module,
                                                            uint32_t label)
{
    return &module->blocks[module->ids[label].block];
}

static inline uint32_t neph_spirv_get_label(const struct neph_spirv_module *module,
                                            const struct neph_spirv_block *block)
{
    return module->words[block->at + 1];
}

/* False: no memory. Call _free in both cases. `words` is a valid module. */
bool neph_spirv_read(const uint32_t *words, size_t size_bytes, struct neph_spirv_module *module);
void neph_spirv_free(struct neph_spirv_module *module);

/* Whether an instruction only computes a value: word 1 is its type, word 2 its id. */
bool neph_spirv_is_pure(const struct neph_spirv_module *module, size_t at);

#endif
