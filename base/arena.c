/* SPDX-License-Identifier: MIT */
#include "base/arena.h"

#include "base/heap.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct neph_arena_block {
    struct neph_arena_block *before;
    max_align_t content[];
};

void *neph_arena_allocate(struct neph_arena *arena, size_t count, size_t size)
{
    struct neph_arena_block *block = NULL;
    if (count == 0 || size <= (SIZE_MAX - sizeof(*block)) / count)
        block = neph_allocate_plane(1, sizeof(*block) + count * size);
    if (!block) {
        arena->is_short = true;
        return NULL;
    }
    block->before = arena->last;
    arena->last = block;
    return block->content;
}

void *neph_arena_copy(struct neph_arena *arena, const void *from, size_t size)
{
    void *to = neph_arena_allocate(arena, 1, size);
    return to ? memcpy(to, from, size) : NULL;
}

void *neph_arena_grow_list(struct neph_arena *arena, void *list, int count, int *room, size_t size)
{
    enum { FIRST = 16 };
    if (count < *room)
        return list;
    const int wanted = *room > 0 ? 2 * *room : FIRST;
    void *grown = neph_arena_allocate(arena, (size_t)wanted, size);
    if (!grown)
        return NULL;
    if (count > 0)
        memcpy(grown, list, (size_t)count * size);
    *room = wanted;
    return grown;
}

const char *neph_arena_copy_text(struct neph_arena *arena, const char *text)
{
    return text ? neph_arena_format(arena, "%s", text) : NULL;
}

const char *neph_arena_format(struct neph_arena *arena, const char *format, ...)
{
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    const int length = vsnprintf(NULL, 0, format, arguments);
    char *text = neph_arena_allocate(arena, (size_t)length + 1, 1);
    if (text)
        vsnprintf(text, (size_t)length + 1, format, again);
    va_end(again);
    va_end(arguments);
    return text ? text : "";
}

enum neph_status neph_arena_check(const struct neph_arena *arena, struct neph_diag *diag)
{
    return arena->is_short ? neph_fail_memory(diag) : NEPH_OK;
}

void neph_arena_finish(struct neph_arena *arena)
{
    while (arena->last) {
        struct neph_arena_block *before = arena->last->before;
        free(arena->last);
        arena->last = before;
    }
}
