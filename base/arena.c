/* SPDX-License-Identifier: MIT */
#include "base/arena.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum { HUGE_PAGE = 1 << 21 };

struct neph_arena_block {
    struct neph_arena_block *before;
    max_align_t content[];
};

/* Huge pages, where the system has them: a renderer touches hundreds of megabytes for the first
 * time in its first few frames, and faulting them in as small pages takes longer than the frames.
 * calloc() does not touch memory that is fresh from the system. */
static void advise_huge_pages(void *block, size_t size)
{
    const uintptr_t begin = ((uintptr_t)block + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
    const uintptr_t end = ((uintptr_t)block + size) / HUGE_PAGE * HUGE_PAGE;
    if (begin < end)
        madvise((void *)begin, end - begin, MADV_HUGEPAGE); /* a hint; failure is harmless */
}

void *neph_arena_allocate(struct neph_arena *arena, size_t count, size_t size)
{
    struct neph_arena_block *block = NULL;
    if (count == 0 || size <= (SIZE_MAX - sizeof(*block)) / count)
        block = calloc(1, sizeof(*block) + count * size);
    if (!block) {
        arena->is_short = true;
        return NULL;
    }
    advise_huge_pages(block, sizeof(*block) + count * size);
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
