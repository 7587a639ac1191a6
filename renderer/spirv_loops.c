/* SPDX-License-Identifier: MIT */
#include "renderer/spirv_loops.h"

#include "renderer/spirv.h"

#include <stdlib.h>
#include <string.h>

enum {
    OP_TYPE_FIRST = 19,
    OP_TYPE_POINTER = 32,
    OP_TYPE_LAST = 39,
    OP_STORE = 62,
    OP_VECTOR_SHUFFLE = 79,
    OP_COMPOSITE_EXTRACT = 81,
    OP_COMPOSITE_INSERT = 82,
    OP_IMAGE_SAMPLE_EXPLICIT_LOD = 88,
    OP_IMAGE_FETCH = 95,
    OP_IMAGE_READ = 98,
    OP_IMAGE_WRITE = 99,
    OP_GROUP_NON_UNIFORM_ALL = 334,
    OP_GROUP_NON_UNIFORM_ANY = 335,
};

/* Storage classes that threads cannot write: a thread that has left the loop reads the same values
 * from them as before. */
enum { CLASS_INPUT = 1, CLASS_UNIFORM = 2, CLASS_PUSH_CONSTANT = 9 };

struct definition {
    size_t at; /* word index; 0: not defined yet */
    int block; /* or NEPH_SPIRV_NO_BLOCK */
    bool is_type;
    /* For the loop being checked: */
    bool is_carried;   /* passed to the next iteration by a phi */
    bool is_different; /* recomputed by a thread that has left, it would differ */
    bool is_lost;      /* and its value after the loop is therefore wrong */
};

/* A block in the loop being checked. */
struct place {
    bool is_in;
    bool is_before_exit; /* the loop may be left after this block, in the same iteration */
    bool is_continue;    /* in the continue construct */
};

struct search {
    struct neph_spirv_module module;
    struct definition *definitions; /* owned, by id */
    struct place *places;           /* owned, by block */
    int header, merge, target;      /* blocks of the loop being checked */
    bool continue_has_loads;        /* the continue construct has loads */
};

/* --- the module ------------------------------------------------------------------------------- */

static bool has_result(const struct search *search, size_t at)
{
    const uint32_t *words = search->module.words + at;
    return neph_spirv_length(&search->module, at) >= 3 && words[1] < search->module.id_count &&
           search->definitions[words[1]].is_type;
}

static void define(struct search *search, size_t at, int block)
{
    const uint32_t operation = neph_spirv_operation(&search->module, at);
    const uint32_t *words = search->module.words + at;
    if (operation >= OP_TYPE_FIRST && operation <= OP_TYPE_LAST)
        search->definitions[words[1]] = (struct definition){
            .at = at, .block = NEPH_SPIRV_NO_BLOCK, .is_type = true};
    else if (has_result(search, at))
        search->definitions[words[2]] = (struct definition){.at = at, .block = block};
}

static void define_all(struct search *search)
{
    const struct neph_spirv_module *module = &search->module;
    for (size_t at = NEPH_SPIRV_HEADER_WORDS; at < module->functions;
         at += neph_spirv_length(module, at))
        define(search, at, NEPH_SPIRV_NO_BLOCK);
    for (int b = 0; b < module->block_count; b++)
        for (size_t at = module->blocks[b].at; at < module->blocks[b].end;
             at += neph_spirv_length(module, at))
            define(search, at, b);
}

/* The words of an instruction that may be ids. Literal numbers follow them, or precede them in
 * OP_EXT_INST. */
struct operands {
    size_t at, end;
};

static struct operands get_operands(const struct search *search, size_t at)
{
    const size_t length = neph_spirv_length(&search->module, at);
    struct operands operands = {has_result(search, at) ? 3 : 1, length};
    switch (neph_spirv_operation(&search->module, at)) {
    case OP_SWITCH:
        operands.end = 2;
        break;
    case OP_STORE:
        operands.end = 3;
        break;
    case OP_LOAD:
    case OP_COMPOSITE_EXTRACT:
    case OP_IMAGE_WRITE:
        operands.end = 4;
        break;
    case OP_VECTOR_SHUFFLE:
    case OP_COMPOSITE_INSERT:
    case OP_IMAGE_SAMPLE_EXPLICIT_LOD: /* with a constant level of detail */
    case OP_IMAGE_FETCH:
    case OP_IMAGE_READ:
        operands.end = 5;
        break;
    case OP_EXT_INST:
        operands.at = 5;
        break;
    default:
        break;
    }
    if (operands.end > length)
        operands.end = length;
    return operands;
}

/* The words of a terminator that are labels. */
struct branch_targets {
    size_t at, end, step;
};

static struct branch_targets get_branch_targets(const struct search *search, int block)
{
    const size_t at = search->module.blocks[block].terminator;
    switch (neph_spirv_operation(&search->module, at)) {
    case OP_BRANCH:
        return (struct branch_targets){at + 1, at + 2, 1};
    case OP_BRANCH_CONDITIONAL:
        return (struct branch_targets){at + 2, at + 4, 1};
    case OP_SWITCH:
        return (struct branch_targets){at + 2, at + neph_spirv_length(&search->module, at), 2};
    default:
        return (struct branch_targets){at, at, 1};
    }
}

static int get_block_index(const struct search *search, size_t word)
{
    return search->module.ids[search->module.words[word]].block;
}

static bool is_within(const struct search *search, uint32_t id)
{
    return id < search->module.id_count && search->definitions[id].at != 0 &&
           search->definitions[id].block != NEPH_SPIRV_NO_BLOCK &&
           search->places[search->definitions[id].block].is_in;
}

/* --- the loop being checked ------------------------------------------------------------------- */

/* Whether a block is in the loop: it is after the header, and the header can be reached from it
 * without the merge block. */
static bool is_in_loop_body(const struct search *search, int block)
{
    for (struct branch_targets way = get_branch_targets(search, block); way.at < way.end;
         way.at += way.step) {
        const int to = get_block_index(search, way.at);
        if (to == search->header || (to != search->merge && search->places[to].is_in))
            return true;
    }
    return false;
}

static bool is_exit_block(const struct search *search, int block)
{
    for (struct branch_targets way = get_branch_targets(search, block); way.at < way.end;
         way.at += way.step) {
        const int to = get_block_index(search, way.at);
        if (!search->places[to].is_in ||
            (to != search->header && search->places[to].is_before_exit))
            return true;
    }
    return false;
}

static void find_blocks(struct search *search)
{
    const int count = search->module.block_count;
    struct place *places = search->places;
    memset(places, 0, (size_t)count * sizeof(*places));
    places[search->header].is_in = true;
    for (bool has_news = true; has_news;) {
        has_news = false;
        for (int b = count - 1; b > search->header; b--)
            if (b != search->merge && !places[b].is_in && is_in_loop_body(search, b))
                has_news = places[b].is_in = true;
    }
    for (bool has_news = true; has_news;) {
        has_news = false;
        for (int b = count - 1; b >= search->header; b--)
            if (places[b].is_in && !places[b].is_before_exit && is_exit_block(search, b))
                has_news = places[b].is_before_exit = true;
    }
}

/* Whether a second iteration is possible. A return from the middle of a function is inlined as a
 * loop with a single iteration. */
static bool has_second_iteration(const struct search *search)
{
    for (int b = 0; b < search->module.block_count; b++)
        for (struct branch_targets way = get_branch_targets(search, b); way.at < way.end;
             way.at += way.step)
            if (get_block_index(search, way.at) == search->target)
                return true;
    return search->target == search->header;
}

/* Whether a value is uniform in the subgroup: the result of a vote. */
static bool is_vote(const struct search *search, uint32_t id)
{
    const size_t at = search->definitions[id].at;
    const uint32_t operation = neph_spirv_operation(&search->module, at);
    if (operation == OP_LOGICAL_NOT)
        return is_vote(search, search->module.words[at + 3]);
    return operation == OP_GROUP_NON_UNIFORM_ALL || operation == OP_GROUP_NON_UNIFORM_ANY;
}

/* Whether all threads leave together, so that none keeps executing after it has left. */
static bool is_exit_uniform(const struct search *search)
{
    const struct neph_spirv_module *module = &search->module;
    for (int b = search->header; b < module->block_count; b++) {
        if (!search->places[b].is_in)
            continue;
        const size_t at = module->blocks[b].terminator;
        const bool has_choice = neph_spirv_operation(module, at) == OP_BRANCH_CONDITIONAL;
        for (struct branch_targets way = get_branch_targets(search, b); way.at < way.end;
             way.at += way.step)
            if (!search->places[get_block_index(search, way.at)].is_in &&
                !(has_choice && is_vote(search, module->words[at + 1])))
                return false;
    }
    return true;
}

static void find_continue(struct search *search)
{
    const struct neph_spirv_module *module = &search->module;
    search->continue_has_loads = false;
    search->places[search->target].is_continue = true;
    for (int b = search->target; b < module->block_count; b++) {
        if (!search->places[b].is_continue)
            continue;
        for (struct branch_targets way = get_branch_targets(search, b); way.at < way.end;
             way.at += way.step)
            if (get_block_index(search, way.at) > search->target)
                search->places[get_block_index(search, way.at)].is_continue = true;
        for (size_t at = module->blocks[b].at; at < module->blocks[b].terminator;
             at += neph_spirv_length(module, at))
            search->continue_has_loads |= neph_spirv_operation(module, at) == OP_LOAD;
    }
}

/* --- lost values ------------------------------------------------------------------------------ */

/* The value that an iteration passes to a phi of the header; 0: none. */
static uint32_t find_carried_value(const struct search *search, size_t phi)
{
    const uint32_t *words = search->module.words + phi;
    for (size_t i = 3; i + 1 < neph_spirv_length(&search->module, phi); i += 2)
        if (search->places[search->module.ids[words[i + 1]].block].is_in)
            return words[i];
    return 0;
}

/* A header phi is updated as soon as the value for the next iteration is computed, so it differs
 * after exits that come later in the same iteration. If the continue construct is nearly empty,
 * Mesa turns the phi into a selection between that value and the initial one, which is not carried.
 */
static void check_header_phi(struct search *search, size_t at)
{
    struct definition *phi = &search->definitions[search->module.words[at + 2]];
    const uint32_t next = find_carried_value(search, at);
    if (next == search->module.words[at + 2] || !is_within(search, next))
        return;
    const struct place *place = &search->places[search->definitions[next].block];
    phi->is_different = place->is_before_exit;
    phi->is_lost = phi->is_different && !place->is_continue && !search->continue_has_loads;
}

static bool is_constant_load(const struct search *search, size_t load)
{
    const uint32_t *words = search->module.words;
    const size_t pointer = search->definitions[words[load + 3]].at;
    const size_t type = search->definitions[words[pointer + 1]].at;
    const uint32_t class = words[type + 2];
    return class == CLASS_INPUT || class == CLASS_UNIFORM || class == CLASS_PUSH_CONSTANT;
}

/* Decide for an instruction that is not a phi. */
static void check_instruction(struct search *search, size_t at)
{
    const struct neph_spirv_module *module = &search->module;
    struct definition *definition = &search->definitions[module->words[at + 2]];
    definition->is_different = !neph_spirv_is_pure(module, at) ||
                               (neph_spirv_operation(module, at) == OP_LOAD &&
                                !is_constant_load(search, at));
    const struct operands operands = get_operands(search, at);
    for (size_t i = operands.at; i < operands.end; i++)
        if (is_within(search, module->words[at + i]))
            definition->is_different |= search->definitions[module->words[at + i]].is_different;
    definition->is_lost = definition->is_different && !definition->is_carried;
}

/* Decide for all instructions of the loop, definitions before uses. Phis outside the header
 * preserve their values, as carried values do. */
static void check_loop_values(struct search *search)
{
    const struct neph_spirv_module *module = &search->module;
    for (int b = search->header; b < module->block_count; b++)
        for (size_t at = module->blocks[b].at; at < module->blocks[b].terminator;
             at += neph_spirv_length(module, at)) {
            if (!search->places[b].is_in || !has_result(search, at))
                continue;
            if (neph_spirv_operation(module, at) != OP_PHI)
                check_instruction(search, at);
            else if (b == search->header)
                check_header_phi(search, at);
        }
}

static void reset_definitions(struct search *search)
{
    const struct neph_spirv_module *module = &search->module;
    for (uint32_t id = 0; id < module->id_count; id++) {
        struct definition *definition = &search->definitions[id];
        definition->is_carried = definition->is_different = definition->is_lost = false;
    }
    const struct neph_spirv_block *header = &module->blocks[search->header];
    for (size_t at = header->at; at < header->terminator; at += neph_spirv_length(module, at))
        if (neph_spirv_operation(module, at) == OP_PHI)
            search->definitions[find_carried_value(search, at)].is_carried = true;
}

/* Whether a phi at a loop exit has different inputs: it then preserves its value. */
static bool is_preserving_phi(const struct search *search, size_t at)
{
    const uint32_t *words = search->module.words + at;
    if (neph_spirv_operation(&search->module, at) != OP_PHI)
        return false;
    for (size_t i = 5; i < neph_spirv_length(&search->module, at); i += 2)
        if (words[i] != words[3])
            return true;
    return false;
}

/* The first lost value that a block uses; 0: none. */
static uint32_t find_used_lost_value(const struct search *search,
                                     const struct neph_spirv_block *block)
{
    const struct neph_spirv_module *module = &search->module;
    for (size_t at = block->at; at < block->end; at += neph_spirv_length(module, at)) {
        const struct operands operands = get_operands(search, at);
        for (size_t i = operands.at; i < operands.end && !is_preserving_phi(search, at); i++) {
            const uint32_t id = module->words[at + i];
            if (is_within(search, id) && search->definitions[id].is_lost)
                return id;
        }
    }
    return 0;
}

static uint32_t find_in_loop(struct search *search, int header)
{
    const struct neph_spirv_module *module = &search->module;
    const size_t merge = module->blocks[header].merge;
    search->header = header;
    search->merge = get_block_index(search, merge + 1);
    search->target = get_block_index(search, merge + 2);
    find_blocks(search);
    if (!has_second_iteration(search) || is_exit_uniform(search))
        return 0;
    find_continue(search);
    reset_definitions(search);
    check_loop_values(search);
    uint32_t id = 0;
    for (int b = 0; b < module->block_count && !id; b++)
        if (!search->places[b].is_in)
            id = find_used_lost_value(search, &module->blocks[b]);
    return id;
}

static bool is_loop(const struct search *search, int block)
{
    const size_t merge = search->module.blocks[block].merge;
    return merge && neph_spirv_operation(&search->module, merge) == OP_LOOP_MERGE;
}

bool neph_spirv_find_lost(const uint32_t *words, size_t size_bytes, struct neph_spirv_lost *lost)
{
    struct search search = {0};
    *lost = (struct neph_spirv_lost){0};
    bool has_memory = neph_spirv_read(words, size_bytes, &search.module);
    const struct neph_spirv_module *module = &search.module;
    if (has_memory) {
        search.definitions = calloc(module->id_count, sizeof(*search.definitions));
        search.places = calloc((size_t)module->block_count + 1, sizeof(*search.places));
        has_memory = search.definitions && search.places;
    }
    if (has_memory)
        define_all(&search);
    for (int b = 0; has_memory && b < module->block_count && !lost->value; b++)
        if (is_loop(&search, b))
            *lost = (struct neph_spirv_lost){find_in_loop(&search, b),
                                             neph_spirv_get_label(module, &module->blocks[b])};
    if (!lost->value)
        lost->header = 0;
    free(search.places);
    free(search.definitions);
    neph_spirv_free(&search.module);
    return has_memory;
}
