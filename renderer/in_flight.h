/* SPDX-License-Identifier: MIT
 *
 * Frames in flight: the CPU prepares a frame while the device works on earlier ones. Memory that
 * the CPU writes for a frame exists once per slot. Not for other folders.
 */
#ifndef NEPH_RENDERER_IN_FLIGHT_H
#define NEPH_RENDERER_IN_FLIGHT_H

#include "renderer/compute.h"

enum { NEPH_IN_FLIGHT_FRAMES = 3 };

/* Zero-initialise. Frame number n has slot n % NEPH_IN_FLIGHT_FRAMES. */
struct neph_in_flight {
    uint64_t sent, home;                     /* counts of frames submitted and collected */
    uint64_t batches[NEPH_IN_FLIGHT_FRAMES]; /* batches submitted up to the end of the slot's frame
                                              */
};

/* Wait until the frame that had the next slot before is done, and return the slot. A frame that was
 * not collected by _home is dropped. */
enum neph_status neph_in_flight_begin(const struct neph_vulkan *vulkan,
                                      struct neph_in_flight *flight, int *slot,
                                      struct neph_diag *diag);

/* Mark a frame as complete: all its batches have been submitted. */
void neph_in_flight_end(const struct neph_vulkan *vulkan, struct neph_in_flight *flight);

/* Wait for the oldest frame in flight and collect it. NEPH_ERR_USAGE: none is in flight. */
enum neph_status neph_in_flight_collect(const struct neph_vulkan *vulkan,
                                        struct neph_in_flight *flight, int *slot,
                                        struct neph_diag *diag);

/* Wait for all submitted work, whether its frames are complete or not, and drop these frames. */
enum neph_status neph_in_flight_drain(const struct neph_vulkan *vulkan,
                                      struct neph_in_flight *flight, struct neph_diag *diag);

/* The copies of a buffer that are not in use by the current frame. */
struct neph_buffer_ring {
    struct neph_buffer waiting[NEPH_IN_FLIGHT_FRAMES - 1];
};

/* Create copies with the size of an upload buffer. Zero-initialise; free with _destroy, also after
 * an error. */
enum neph_status neph_buffer_ring_create(const struct neph_vulkan *vulkan,
                                         const struct neph_buffer *like, const char *name,
                                         struct neph_buffer_ring *turns, struct neph_diag *diag);
void neph_buffer_ring_destroy(const struct neph_vulkan *vulkan, struct neph_buffer_ring *turns);

/* Swap `buffer` with the copy that has been unused longest. Called once a frame, after
 * neph_in_flight_begin(), so that no kernel reads the new `buffer`. It has the contents of an older
 * frame. */
void neph_buffer_ring_advance(struct neph_buffer_ring *turns, struct neph_buffer *buffer);

#endif
