/* SPDX-License-Identifier: MIT */
#include "base/heap.h"

#include <malloc.h>

enum { LARGEST_BYTES = 32 << 20, STEP_BYTES = 16 << 20, NEVER = 1 << 30 };

void neph_heap_keep(void)
{
#ifdef M_ARENA_MAX           /* not in other C libraries, which this does not concern */
    mallopt(M_ARENA_MAX, 1); /* one thread reads a frame, another one frees it */
    mallopt(M_MMAP_THRESHOLD, LARGEST_BYTES);
    mallopt(M_TRIM_THRESHOLD, NEVER);
    mallopt(M_TOP_PAD, STEP_BYTES);
#endif
}
