/* SPDX-License-Identifier: MIT */
#include "base/heap.h"

#include <malloc.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum { LARGEST_BYTES = 32 << 20, STEP_BYTES = 16 << 20, NEVER = 1 << 30, HUGE_PAGE = 1 << 21 };

void neph_heap_keep(void)
{
#ifdef M_ARENA_MAX           /* not in other C libraries, which this does not concern */
    mallopt(M_ARENA_MAX, 1); /* one thread reads a frame, another one frees it */
    mallopt(M_MMAP_THRESHOLD, LARGEST_BYTES);
    mallopt(M_TRIM_THRESHOLD, NEVER);
    mallopt(M_TOP_PAD, STEP_BYTES);
#endif
}

static void advise_huge_pages(void *block, size_t size)
{
    const uintptr_t begin = ((uintptr_t)block + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
    const uintptr_t end = ((uintptr_t)block + size) / HUGE_PAGE * HUGE_PAGE;
    if (begin < end)
        madvise((void *)begin, end - begin, MADV_HUGEPAGE); /* a hint; failure is harmless */
}

/* Larger blocks come from the system, zeroed and untouched; calloc() would touch smaller ones
 * before the advice. */
void *neph_allocate_plane(size_t count, size_t size)
{
    const bool is_touched = count <= LARGEST_BYTES / size && count * size >= HUGE_PAGE;
    void *plane = is_touched ? malloc(count * size) : calloc(count, size);
    if (plane)
        advise_huge_pages(plane, count * size);
    return plane && is_touched ? memset(plane, 0, count * size) : plane;
}
