/* SPDX-License-Identifier: MIT
 *
 * An arena allocator, for objects with the same lifetime: many small allocations, one free.
 */
#ifndef NEPH_BASE_ARENA_H
#define NEPH_BASE_ARENA_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>

struct neph_arena_block;

/* Start from {0}; free with neph_arena_finish(). */
struct neph_arena {
    struct neph_arena_block *last;
    bool is_short; /* an allocation has failed: see neph_arena_check() */
};

/* `count` zeroed objects of `size` bytes; NULL when memory is short. The arena owns them. */
void *neph_arena_allocate(struct neph_arena *arena, size_t count, size_t size);

/* A copy of `size` bytes; NULL when memory is short. */
void *neph_arena_copy(struct neph_arena *arena, const void *from, size_t size);

/* A list of `count` objects of `size` bytes with room for one more, zeroed: the list itself, or a
 * copy with twice the `*room`. Start from NULL and a room of 0. NULL when memory is short. */
void *neph_arena_grow_list(struct neph_arena *arena, void *list, int count, int *room, size_t size);

/* A copy of a text, or printf into a new one. When memory is short the result is "", so that a
 * caller can make many texts and call neph_arena_check() once at the end. A NULL text stays NULL.
 */
const char *neph_arena_copy_text(struct neph_arena *arena, const char *text);
const char *neph_arena_format(struct neph_arena *arena, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* NEPH_ERR_MEMORY when any allocation of the arena has failed. */
enum neph_status neph_arena_check(const struct neph_arena *arena, struct neph_diag *diag);

void neph_arena_finish(struct neph_arena *arena);

#endif
