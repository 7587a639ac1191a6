/* SPDX-License-Identifier: MIT
 *
 * The policy of the heap for a long series of frames.
 */
#ifndef NEPH_BASE_HEAP_H
#define NEPH_BASE_HEAP_H

/* From now on, keep freed memory in the process, for the next frame. The default of glibc returns
 * planes of an image to the system, which clears each page of them again for the next image: a
 * third of the time of `neph flicker`. Planes above 32 MiB are still returned, which is glibc's
 * limit. Call from main, before there are threads. */
void neph_heap_keep(void);

#endif
