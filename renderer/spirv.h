/* SPDX-License-Identifier: MIT
 *
 * A SPIR-V module in memory, for renderer/specialize.h: where its values and blocks are. Words and
 * numbers are those of the SPIR-V specification 1.6, chapters 2 and 3.
 */
#ifndef NEPH_RENDERER_SPIRV_H
#define NEPH_RENDERER_SPIRV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum neph_spirv_operation {
    OP_UNDEF = 1,
    OP_NAME = 5,
    OP_CAPABILITY = 17,
    OP_EXT_INST = 12,
    OP_TYPE_BOOL = 20,
    OP_TYPE_INT = 21,
    OP_TYPE_FLOAT = 22,
    OP_CONSTANT_TRUE = 41,
    OP_CONSTANT_FALSE = 42,
    OP_CONSTANT = 43,
    OP_CONSTANT_COMPOSITE = 44,
    OP_CONSTANT_NULL = 46,
    OP_SPEC_CONSTANT_TRUE = 48,
    OP_SPEC_CONSTANT_FALSE = 49,
    OP_SPEC_CONSTANT = 50,
    OP_SPEC_CONSTANT_COMPOSITE = 51,
    OP_SPEC_CONSTANT_OP = 52,
    OP_FUNCTION = 54,
    OP_VARIABLE = 59,
    OP_LOAD = 61,
    OP_ACCESS_CHAIN = 65,
    OP_ARRAY_LENGTH = 68,
    OP_DECORATE = 71,
    OP_VECTOR_EXTRACT_DYNAMIC = 77,
    OP_COPY_OBJECT = 83,
    OP_TRANSPOSE = 84,
    OP_CONVERT_F_TO_U = 109,
    OP_BITCAST = 124,
    OP_S_NEGATE = 126,
    OP_I_ADD = 128,
    OP_I_SUB = 130,
    OP_I_MUL = 132,
    OP_S_MUL_EXTENDED = 152,
    OP_ANY = 154,
    OP_LOGICAL_EQUAL = 164,
    OP_LOGICAL_NOT_EQUAL = 165,
    OP_LOGICAL_OR = 166,
    OP_LOGICAL_AND = 167,
    OP_LOGICAL_NOT = 168,
    OP_SELECT = 169,
    OP_I_EQUAL = 170,
    OP_I_NOT_EQUAL = 171,
    OP_U_GREATER_THAN = 172,
    OP_U_GREATER_THAN_EQUAL = 174,
    OP_U_LESS_THAN = 176,
    OP_U_LESS_THAN_EQUAL = 178,
    OP_F_UNORD_GREATER_THAN_EQUAL = 191,
    OP_SHIFT_RIGHT_LOGICAL = 194,
    OP_SHIFT_LEFT_LOGICAL = 196,
    OP_BITWISE_OR = 197,
    OP_BITWISE_XOR = 198,
    OP_BITWISE_AND = 199,
    OP_NOT = 200,
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

/* Decorations. */
enum { NEPH_SPIRV_SPEC_ID = 1, NEPH_SPIRV_BUILT_IN = 11 };

/* What is known of the result of an instruction. */
struct neph_spirv_id {
    uint32_t scalar; /* of a type: OP_TYPE_BOOL, or _INT and _FLOAT of 32 bits; else 0 */
    uint32_t value;  /* where known: its bits; 0 or 1 for a bool */
    size_t at;       /* the word where it is defined */
    int block;       /* that it is defined in, or that it is the label of; or NEPH_SPIRV_NO_BLOCK */
    bool is_known, is_used;
};

struct neph_spirv_block {
    size_t at, end, terminator; /* words; from its label on */
    size_t merge;               /* the word of its OpLoopMerge or OpSelectionMerge; 0: none */
    uint32_t taken;             /* the label that the terminator always goes to; 0: not known */
    uint32_t loop;              /* unreachable, but the continue target of this loop; 0: of none */
    bool is_reachable;
    bool is_merge; /* unreachable, but named as a merge block */
};

struct neph_spirv_module {
    const uint32_t *words; /* borrowed */
    size_t word_count;
    size_t functions; /* the word where they begin */
    uint32_t id_count;
    struct neph_spirv_id *ids; /* owned */
    int block_count;
    struct neph_spirv_block *blocks; /* owned */
};

static inline uint32_t neph_spirv_operation(const struct neph_spirv_module *module, size_t at)
{
    return module->words[at] & 0xffff;
}

/* In words; the next instruction is that far. */
static inline size_t neph_spirv_length(const struct neph_spirv_module *module, size_t at)
{
    return module->words[at] >> 16;
}

/* The block of a label. */
static inline struct neph_spirv_block *neph_spirv_block_of(const struct neph_spirv_module *module,
                                                           uint32_t label)
{
    return &module->blocks[module->ids[label].block];
}

static inline uint32_t neph_spirv_label_of(const struct neph_spirv_module *module,
                                           const struct neph_spirv_block *block)
{
    return module->words[block->at + 1];
}

/* False: no memory. Free with _free in both cases. `words` is a valid module. */
bool neph_spirv_read(const uint32_t *words, size_t size_bytes, struct neph_spirv_module *module);
void neph_spirv_free(struct neph_spirv_module *module);

/* Whether an instruction does nothing but give a value: word 1 its type, word 2 its id. */
bool neph_spirv_is_pure(const struct neph_spirv_module *module, size_t at);

#endif
