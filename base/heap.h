/* SPDX-License-Identifier: MIT
 *
 * Large blocks of the heap: huge pages, and memory that is kept for the next frame.
 */
#ifndef NEPH_BASE_HEAP_H
#define NEPH_BASE_HEAP_H

#include <stddef.h>

/* From now on, keep freed memory in the process, for the next frame. The default of glibc returns
 * planes of an image to the system, which clears each page of them again for the next image: a
 * third of the time of `neph flicker`. Planes above 32 MiB are still returned, which is glibc's
 * limit. Call from main, before there are threads. */
void neph_heap_keep(void);

/* Zeroed memory for free(), as of calloc(), in huge pages where the system has them: faulting in
 * the planes of an image as small pages takes longer than reading them from a file, and a renderer
 * touches hundreds of megabytes in its first frames. NULL when memory is short. */
void *neph_allocate_plane(size_t count, size_t size);

#endif
