/* SPDX-License-Identifier: MIT */
#include "renderer/specialize.h"

#include "renderer/spirv_fold.h"

#include <stdlib.h>
#include <string.h>

static uint32_t head(uint32_t operation, size_t length)
{
    return (uint32_t)length << 16 | operation;
}

/* --- blocks that nothing reaches but a merge instruction ---------------------------------- */

static void keep_named(const struct neph_spirv_module *module,
                       const struct neph_spirv_block *header)
{
    const uint32_t *words = module->words + header->merge;
    neph_spirv_block_of(module, words[1])->is_merge = true;
    if (neph_spirv_operation(module, header->merge) == OP_LOOP_MERGE)
        neph_spirv_block_of(module, words[2])->loop = neph_spirv_label_of(module, header);
}

static bool keeps_merge(const struct neph_spirv_module *module,
                        const struct neph_spirv_block *block)
{
    return block->merge &&
           (neph_spirv_operation(module, block->merge) == OP_LOOP_MERGE ||
            neph_spirv_operation(module, block->terminator) == OP_SWITCH || !block->taken);
}

static void keep_named_blocks(const struct neph_spirv_module *module)
{
    for (int i = 0; i < module->block_count; i++)
        if (module->blocks[i].is_reachable && keeps_merge(module, &module->blocks[i]))
            keep_named(module, &module->blocks[i]);
}

/* --- what is used ------------------------------------------------------------------------- */

struct marks {
    const struct neph_spirv_module *module;
    uint32_t *ids; /* owned: still to be looked at */
    int count;
};

/* A number that is not an id at all keeps, at worst, more than is needed. */
static void mark(struct marks *marks, uint32_t id)
{
    const struct neph_spirv_module *module = marks->module;
    if (id >= module->id_count || module->ids[id].is_used)
        return;
    module->ids[id].is_used = true;
    if (module->ids[id].at)
        marks->ids[marks->count++] = id;
}

static void mark_words(struct marks *marks, size_t at, size_t first)
{
    for (size_t i = first; i < neph_spirv_length(marks->module, at); i++)
        mark(marks, marks->module->words[at + i]);
}

static bool is_known(const struct neph_spirv_module *module, uint32_t id)
{
    return module->ids[id].is_known;
}

static void mark_phi(struct marks *marks, size_t at, uint32_t label)
{
    const uint32_t *words = marks->module->words + at;
    for (size_t i = 3; i < neph_spirv_length(marks->module, at); i += 2)
        if (neph_spirv_goes(marks->module, words[i + 1], label))
            mark(marks, words[i]);
}

/* What the definition of an id that is used has need of. */
static void mark_definition(struct marks *marks, uint32_t id)
{
    const struct neph_spirv_module *module = marks->module;
    const size_t at = module->ids[id].at;
    const uint32_t operation = neph_spirv_operation(module, at), *words = module->words + at;
    mark(marks, words[1]);
    if (is_known(module, id))
        return;
    if (operation == OP_PHI && module->ids[id].block != NEPH_SPIRV_NO_BLOCK)
        mark_phi(marks, at, neph_spirv_label_of(module, &module->blocks[module->ids[id].block]));
    else if (operation == OP_SELECT && is_known(module, words[3]))
        mark(marks, words[module->ids[words[3]].value ? 4 : 5]);
    else
        mark_words(marks, at, 3);
}

static void mark_global(struct marks *marks, size_t at)
{
    const uint32_t operation = neph_spirv_operation(marks->module, at);
    const uint32_t *words = marks->module->words + at;
    if (operation == OP_DECORATE && words[2] == NEPH_SPIRV_BUILT_IN)
        mark(marks, words[1]);
    else if (operation != OP_DECORATE && operation != OP_NAME &&
             !neph_spirv_is_pure(marks->module, at))
        mark_words(marks, at, 1);
}

static void mark_block(struct marks *marks, const struct neph_spirv_block *block)
{
    const struct neph_spirv_module *module = marks->module;
    for (size_t at = block->at; at < block->terminator; at += neph_spirv_length(module, at))
        if (!neph_spirv_is_pure(module, at))
            mark_words(marks, at, 1);
    if (!block->taken || neph_spirv_operation(module, block->terminator) == OP_SWITCH)
        mark_words(marks, block->terminator, 1);
}

/* Returns the word behind it. */
static size_t mark_function_part(struct marks *marks, size_t at)
{
    const struct neph_spirv_module *module = marks->module;
    if (neph_spirv_operation(module, at) != OP_LABEL) {
        mark_words(marks, at, 1);
        return at + neph_spirv_length(module, at);
    }
    const struct neph_spirv_block *block = neph_spirv_block_of(module, module->words[at + 1]);
    if (block->is_reachable)
        mark_block(marks, block);
    return block->end;
}

static void mark_definitions(struct marks *marks)
{
    while (marks->count > 0)
        mark_definition(marks, marks->ids[--marks->count]);
}

/* False: no memory. */
static bool mark_used(const struct neph_spirv_module *module)
{
    struct marks marks = {module, calloc(module->id_count, sizeof(uint32_t)), 0};
    if (!marks.ids)
        return false;
    for (size_t at = NEPH_SPIRV_HEADER_WORDS; at < module->functions;
         at += neph_spirv_length(module, at))
        mark_global(&marks, at);
    for (size_t at = module->functions; at < module->word_count;)
        at = mark_function_part(&marks, at);
    mark_definitions(&marks);
    free(marks.ids);
    return true;
}

/* --- writing ------------------------------------------------------------------------------ */

/* Never longer than what is read. */
struct writer {
    const struct neph_spirv_module *module;
    uint32_t *words;
    size_t count;
};

static void put(struct writer *writer, uint32_t word)
{
    writer->words[writer->count++] = word;
}

static void copy(struct writer *writer, size_t at)
{
    const size_t length = neph_spirv_length(writer->module, at);
    memcpy(writer->words + writer->count, writer->module->words + at, length * sizeof(uint32_t));
    writer->count += length;
}

static void put_constant(struct writer *writer, size_t at)
{
    const uint32_t *words = writer->module->words + at;
    const uint32_t value = writer->module->ids[words[2]].value;
    const bool is_bool = writer->module->ids[words[1]].scalar == OP_TYPE_BOOL;
    if (is_bool)
        put(writer, head(value ? OP_CONSTANT_TRUE : OP_CONSTANT_FALSE, 3));
    else
        put(writer, head(OP_CONSTANT, 4));
    put(writer, words[1]);
    put(writer, words[2]);
    if (!is_bool)
        put(writer, value);
}

/* A decoration of what is not written any more, or as a constant. */
static bool is_stale(const struct neph_spirv_module *module, size_t decoration)
{
    const uint32_t *words = module->words + decoration;
    const struct neph_spirv_id *id = &module->ids[words[1]];
    const bool is_in_function = id->block != NEPH_SPIRV_NO_BLOCK;
    return !id->is_used ||
           (is_in_function && (id->is_known || !module->blocks[id->block].is_reachable)) ||
           (neph_spirv_operation(module, decoration) == OP_DECORATE &&
            words[2] == NEPH_SPIRV_SPEC_ID);
}

/* To take a texel buffer of an array by a number that is not known, which lavapipe does not offer:
 * the front end asks for it wherever a function is told the number, and has it known in the end. */
static bool is_idle_capability(const struct neph_spirv_module *module, size_t at)
{
    enum { STORAGE_TEXEL_BUFFER_ARRAY_DYNAMIC_INDEXING = 5305 };
    return neph_spirv_operation(module, at) == OP_CAPABILITY &&
           module->words[at + 1] == STORAGE_TEXEL_BUFFER_ARRAY_DYNAMIC_INDEXING;
}

static void put_global(struct writer *writer, size_t at)
{
    const struct neph_spirv_module *module = writer->module;
    const uint32_t operation = neph_spirv_operation(module, at), *words = module->words + at;
    if (is_idle_capability(module, at))
        return;
    if (operation == OP_DECORATE || operation == OP_NAME) {
        if (!is_stale(module, at))
            copy(writer, at);
    } else if (!neph_spirv_is_pure(module, at)) {
        copy(writer, at);
    } else if (module->ids[words[2]].is_used && is_known(module, words[2])) {
        put_constant(writer, at);
    } else if (module->ids[words[2]].is_used) {
        const size_t first = writer->count;
        copy(writer, at);
        if (operation == OP_SPEC_CONSTANT_COMPOSITE)
            writer->words[first] = head(OP_CONSTANT_COMPOSITE, neph_spirv_length(module, at));
    }
}

/* What has become a constant within a function. */
static void put_found_constants(struct writer *writer)
{
    const struct neph_spirv_module *module = writer->module;
    for (uint32_t i = 0; i < module->id_count; i++) {
        const struct neph_spirv_id *id = &module->ids[i];
        if (id->is_used && id->is_known && id->block != NEPH_SPIRV_NO_BLOCK)
            put_constant(writer, id->at);
    }
}

/* A loop whose way back is never taken goes back from where it names it, with any value. */
static void put_phi(struct writer *writer, size_t at, uint32_t label)
{
    const uint32_t *words = writer->module->words + at;
    const size_t first = writer->count;
    writer->count += 3;
    for (size_t i = 3; i < neph_spirv_length(writer->module, at); i += 2)
        if (neph_spirv_goes(writer->module, words[i + 1], label)) {
            put(writer, words[i]);
            put(writer, words[i + 1]);
        }
    const struct neph_spirv_block *block = neph_spirv_block_of(writer->module, label);
    if (block->merge && neph_spirv_operation(writer->module, block->merge) == OP_LOOP_MERGE) {
        const uint32_t target = writer->module->words[block->merge + 2];
        if (!neph_spirv_block_of(writer->module, target)->is_reachable) {
            put(writer, writer->words[first + 3]);
            put(writer, target);
        }
    }
    writer->words[first] = head(OP_PHI, writer->count - first);
    memcpy(writer->words + first + 1, words + 1, 2 * sizeof(*words));
}

static void put_chosen(struct writer *writer, size_t at)
{
    const uint32_t *words = writer->module->words + at;
    put(writer, head(OP_COPY_OBJECT, 4));
    put(writer, words[1]);
    put(writer, words[2]);
    put(writer, words[writer->module->ids[words[3]].value ? 4 : 5]);
}

static void put_pure(struct writer *writer, size_t at, uint32_t label)
{
    const struct neph_spirv_module *module = writer->module;
    const uint32_t operation = neph_spirv_operation(module, at), *words = module->words + at;
    if (!module->ids[words[2]].is_used || is_known(module, words[2]))
        return;
    if (operation == OP_PHI)
        put_phi(writer, at, label);
    else if (operation == OP_SELECT && is_known(module, words[3]))
        put_chosen(writer, at);
    else
        copy(writer, at);
}

static void put_terminator(struct writer *writer, const struct neph_spirv_block *block)
{
    const bool is_switch = neph_spirv_operation(writer->module, block->terminator) == OP_SWITCH;
    if (!block->taken) {
        copy(writer, block->terminator);
        return;
    }
    put(writer, is_switch ? head(OP_SWITCH, 3) : head(OP_BRANCH, 2));
    if (is_switch)
        put(writer, writer->module->words[block->terminator + 1]);
    put(writer, block->taken);
}

static void put_block(struct writer *writer, const struct neph_spirv_block *block)
{
    const struct neph_spirv_module *module = writer->module;
    for (size_t at = block->at; at < block->terminator; at += neph_spirv_length(module, at))
        if (neph_spirv_is_pure(module, at))
            put_pure(writer, at, neph_spirv_label_of(module, block));
        else if (at != block->merge || keeps_merge(module, block))
            copy(writer, at);
    put_terminator(writer, block);
}

static void put_stub(struct writer *writer, const struct neph_spirv_block *block)
{
    copy(writer, block->at);
    put(writer, block->loop ? head(OP_BRANCH, 2) : head(OP_UNREACHABLE, 1));
    if (block->loop)
        put(writer, block->loop);
}

/* Returns the word behind what it writes. */
static size_t put_function_part(struct writer *writer, size_t at)
{
    const struct neph_spirv_module *module = writer->module;
    if (neph_spirv_operation(module, at) != OP_LABEL) {
        copy(writer, at);
        return at + neph_spirv_length(module, at);
    }
    const struct neph_spirv_block *block = neph_spirv_block_of(module, module->words[at + 1]);
    if (block->is_reachable)
        put_block(writer, block);
    else if (block->loop || block->is_merge)
        put_stub(writer, block);
    return block->end;
}

static void put_module(struct writer *writer)
{
    const struct neph_spirv_module *module = writer->module;
    memcpy(writer->words, module->words, NEPH_SPIRV_HEADER_WORDS * sizeof(uint32_t));
    writer->count = NEPH_SPIRV_HEADER_WORDS;
    size_t at = NEPH_SPIRV_HEADER_WORDS;
    for (; at < module->functions; at += neph_spirv_length(module, at))
        put_global(writer, at);
    put_found_constants(writer);
    while (at < module->word_count)
        at = put_function_part(writer, at);
}

enum neph_status neph_specialize(const uint32_t *words, size_t size_bytes,
                                 const uint32_t *constants, int count, uint32_t **specialized,
                                 size_t *specialized_bytes, struct neph_diag *diag)
{
    struct neph_spirv_module module;
    struct writer writer = {.module = &module};
    bool has_memory = neph_spirv_read(words, size_bytes, &module) &&
                      neph_spirv_fold(&module, constants, count);
    if (has_memory) {
        keep_named_blocks(&module);
        has_memory = mark_used(&module) && (writer.words = malloc(size_bytes));
    }
    if (has_memory) {
        put_module(&writer);
        *specialized = writer.words;
        *specialized_bytes = writer.count * sizeof(uint32_t);
    }
    neph_spirv_free(&module);
    return has_memory ? NEPH_OK : neph_fail_memory(diag);
}
