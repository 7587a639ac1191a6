/* SPDX-License-Identifier: MIT */
#include "renderer/spirv_fold.h"

#include <stdlib.h>

/* --- operations --------------------------------------------------------------------------- */

/* Else 32 bits. */
enum { NOT_KNOWN = -1 };

static int64_t fold_unary(uint32_t operation, uint32_t a)
{
    switch (operation) {
    case OP_BITCAST:
        return a;
    case OP_NOT:
        return ~a;
    case OP_LOGICAL_NOT:
        return !a;
    default:
        return NOT_KNOWN;
    }
}

static int64_t fold_comparison(uint32_t operation, uint32_t a, uint32_t b)
{
    switch (operation) {
    case OP_I_EQUAL:
    case OP_LOGICAL_EQUAL:
        return a == b;
    case OP_I_NOT_EQUAL:
    case OP_LOGICAL_NOT_EQUAL:
        return a != b;
    case OP_U_GREATER_THAN:
        return a > b;
    case OP_U_GREATER_THAN_EQUAL:
        return a >= b;
    case OP_U_LESS_THAN:
        return a < b;
    case OP_U_LESS_THAN_EQUAL:
        return a <= b;
    default:
        return NOT_KNOWN;
    }
}

/* Shifts by 32 and more are not defined. */
static int64_t fold_binary(uint32_t operation, uint32_t a, uint32_t b)
{
    enum { BITS = 32 };
    switch (operation) {
    case OP_I_ADD:
        return a + b;
    case OP_I_SUB:
        return a - b;
    case OP_I_MUL:
        return a * b;
    case OP_BITWISE_AND:
    case OP_LOGICAL_AND:
        return a & b;
    case OP_BITWISE_OR:
    case OP_LOGICAL_OR:
        return a | b;
    case OP_BITWISE_XOR:
        return a ^ b;
    case OP_SHIFT_RIGHT_LOGICAL:
        return b < BITS ? (int64_t)(a >> b) : NOT_KNOWN;
    case OP_SHIFT_LEFT_LOGICAL:
        return b < BITS ? (int64_t)(a << b) : NOT_KNOWN;
    default:
        return fold_comparison(operation, a, b);
    }
}

/* Where one operand decides, whatever the other is. */
static int64_t fold_absorbing(uint32_t operation, const struct neph_spirv_id *operand)
{
    const bool is_and = operation == OP_LOGICAL_AND || operation == OP_BITWISE_AND;
    if (!operand->is_known || !(is_and || operation == OP_LOGICAL_OR))
        return NOT_KNOWN;
    return operand->value == (is_and ? 0 : 1) ? (int64_t)operand->value : NOT_KNOWN;
}

static int64_t fold_two(uint32_t operation, const struct neph_spirv_id *a,
                        const struct neph_spirv_id *b)
{
    if (a->is_known && b->is_known)
        return fold_binary(operation, a->value, b->value);
    return fold_absorbing(operation, a->is_known ? a : b);
}

static int64_t fold_select(const struct neph_spirv_module *module, const uint32_t *operands)
{
    const struct neph_spirv_id *condition = &module->ids[operands[0]];
    const struct neph_spirv_id *chosen = &module->ids[operands[condition->value ? 1 : 2]];
    return condition->is_known && chosen->is_known ? (int64_t)chosen->value : NOT_KNOWN;
}

static int64_t fold_operation(const struct neph_spirv_module *module, uint32_t operation,
                              const uint32_t *operands, size_t operand_count)
{
    const struct neph_spirv_id *ids = module->ids;
    if (operation == OP_SELECT)
        return fold_select(module, operands);
    if (operand_count == 1 && fold_unary(operation, 0) != NOT_KNOWN && ids[operands[0]].is_known)
        return fold_unary(operation, ids[operands[0]].value);
    if (operand_count == 2 && fold_binary(operation, 0, 0) != NOT_KNOWN)
        return fold_two(operation, &ids[operands[0]], &ids[operands[1]]);
    return NOT_KNOWN;
}

/* Returns whether this is news. */
static bool know(struct neph_spirv_module *module, size_t at, int64_t value)
{
    struct neph_spirv_id *id = &module->ids[module->words[at + 2]];
    if (value == NOT_KNOWN || id->is_known || !module->ids[module->words[at + 1]].scalar)
        return false;
    id->is_known = true;
    id->value = (uint32_t)value;
    return true;
}

/* --- constants ---------------------------------------------------------------------------- */

static int64_t own_value(const struct neph_spirv_module *module, size_t at)
{
    const uint32_t *words = module->words + at;
    switch (neph_spirv_operation(module, at)) {
    case OP_CONSTANT_TRUE:
    case OP_SPEC_CONSTANT_TRUE:
        return 1;
    case OP_CONSTANT_FALSE:
    case OP_SPEC_CONSTANT_FALSE:
        return 0;
    case OP_CONSTANT:
    case OP_SPEC_CONSTANT:
        return words[3];
    case OP_SPEC_CONSTANT_OP:
        return fold_operation(module, words[3], words + 4, neph_spirv_length(module, at) - 4);
    default:
        return NOT_KNOWN;
    }
}

/* Decorations come before all that they decorate. */
static void take_constant(struct neph_spirv_module *module, size_t at, const uint32_t *constants,
                          int count)
{
    const uint32_t *words = module->words + at;
    if (neph_spirv_operation(module, at) != OP_DECORATE || words[2] != NEPH_SPIRV_SPEC_ID ||
        words[3] >= (uint32_t)count)
        return;
    module->ids[words[1]].is_known = true;
    module->ids[words[1]].value = constants[words[3]];
}

static void fold_constants(struct neph_spirv_module *module, const uint32_t *constants, int count)
{
    for (size_t at = NEPH_SPIRV_HEADER_WORDS; at < module->functions;
         at += neph_spirv_length(module, at)) {
        take_constant(module, at, constants, count);
        if (neph_spirv_is_pure(module, at))
            know(module, at, own_value(module, at));
    }
}

/* --- blocks ------------------------------------------------------------------------------- */

bool neph_spirv_goes(const struct neph_spirv_module *module, uint32_t from, uint32_t to)
{
    const struct neph_spirv_block *block = neph_spirv_block_of(module, from);
    return block->is_reachable && (!block->taken || block->taken == to);
}

/* What all ways into the block that are ever taken agree on. */
static int64_t fold_phi(const struct neph_spirv_module *module, size_t at, uint32_t label)
{
    const uint32_t *words = module->words + at;
    int64_t value = NOT_KNOWN;
    for (size_t i = 3; i < neph_spirv_length(module, at); i += 2) {
        const struct neph_spirv_id *id = &module->ids[words[i]];
        if (!neph_spirv_goes(module, words[i + 1], label))
            continue;
        if (!id->is_known || (value != NOT_KNOWN && value != id->value))
            return NOT_KNOWN;
        value = id->value;
    }
    return value;
}

static bool fold_instruction(struct neph_spirv_module *module, size_t at, uint32_t label)
{
    const uint32_t operation = neph_spirv_operation(module, at);
    if (!neph_spirv_is_pure(module, at))
        return false;
    return know(module, at,
                operation == OP_PHI ? fold_phi(module, at, label)
                                    : fold_operation(module, operation, module->words + at + 3,
                                                     neph_spirv_length(module, at) - 3));
}

/* A loop must keep its way back. */
static bool goes_back(const struct neph_spirv_module *module, const struct neph_spirv_block *block)
{
    const uint32_t *words = module->words + block->terminator;
    return neph_spirv_block_of(module, words[2]) <= block ||
           neph_spirv_block_of(module, words[3]) <= block;
}

static uint32_t switch_target(const struct neph_spirv_module *module, size_t at, uint32_t value)
{
    const uint32_t *words = module->words + at;
    for (size_t i = 3; i < neph_spirv_length(module, at); i += 2)
        if (words[i] == value)
            return words[i + 1];
    return words[2];
}

/* Returns whether the way is newly known. */
static bool fold_terminator(const struct neph_spirv_module *module, struct neph_spirv_block *block)
{
    const uint32_t operation = neph_spirv_operation(module, block->terminator);
    const uint32_t *words = module->words + block->terminator;
    if (block->taken || (operation != OP_BRANCH_CONDITIONAL && operation != OP_SWITCH) ||
        !module->ids[words[1]].is_known)
        return false;
    const uint32_t value = module->ids[words[1]].value;
    if (operation == OP_SWITCH)
        block->taken = switch_target(module, block->terminator, value);
    else if (!goes_back(module, block))
        block->taken = words[value ? 2 : 3];
    return block->taken != 0;
}

static bool fold_block(struct neph_spirv_module *module, struct neph_spirv_block *block)
{
    const uint32_t label = neph_spirv_label_of(module, block);
    bool has_news = false;
    for (size_t at = block->at; at < block->terminator; at += neph_spirv_length(module, at))
        has_news |= fold_instruction(module, at, label);
    return fold_terminator(module, block) || has_news;
}

/* --- reach -------------------------------------------------------------------------------- */

struct stack {
    int *blocks, count;
};

static void reach(const struct neph_spirv_module *module, struct stack *stack, uint32_t label)
{
    struct neph_spirv_block *block = neph_spirv_block_of(module, label);
    if (block->is_reachable)
        return;
    block->is_reachable = true;
    stack->blocks[stack->count++] = (int)(block - module->blocks);
}

static void reach_next(const struct neph_spirv_module *module, struct stack *stack,
                       const struct neph_spirv_block *block)
{
    const uint32_t *words = module->words + block->terminator;
    const size_t length = neph_spirv_length(module, block->terminator);
    const uint32_t operation = neph_spirv_operation(module, block->terminator);
    if (block->taken)
        reach(module, stack, block->taken);
    else if (operation == OP_BRANCH)
        reach(module, stack, words[1]);
    else if (operation == OP_BRANCH_CONDITIONAL || operation == OP_SWITCH)
        reach(module, stack, words[2]);
    if (!block->taken && operation == OP_BRANCH_CONDITIONAL)
        reach(module, stack, words[3]);
    for (size_t i = 4; i < length && !block->taken && operation == OP_SWITCH; i += 2)
        reach(module, stack, words[i]);
}

/* From the first block of each function. */
static void find_reachable(const struct neph_spirv_module *module, struct stack *stack)
{
    for (int i = 0; i < module->block_count; i++)
        module->blocks[i].is_reachable = false;
    bool is_first = true;
    for (size_t at = module->functions; at < module->word_count;
         at += neph_spirv_length(module, at)) {
        if (neph_spirv_operation(module, at) == OP_FUNCTION)
            is_first = true;
        else if (neph_spirv_operation(module, at) == OP_LABEL && is_first) {
            reach(module, stack, module->words[at + 1]);
            is_first = false;
        }
    }
    while (stack->count > 0)
        reach_next(module, stack, &module->blocks[stack->blocks[--stack->count]]);
}

/* Each turn believes in all ways that the one before has not excluded. */
bool neph_spirv_fold(struct neph_spirv_module *module, const uint32_t *constants, int count)
{
    struct stack stack = {.blocks = calloc((size_t)module->block_count + 1, sizeof(int))};
    if (!stack.blocks)
        return false;
    fold_constants(module, constants, count);
    bool has_news = true;
    while (has_news) {
        has_news = false;
        find_reachable(module, &stack);
        for (int i = 0; i < module->block_count; i++)
            if (module->blocks[i].is_reachable)
                has_news |= fold_block(module, &module->blocks[i]);
    }
    free(stack.blocks);
    return true;
}
