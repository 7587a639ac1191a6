/* SPDX-License-Identifier: MIT
 *
 * Frames in flight: the CPU prepares one while the device still works on those before. What the CPU
 * writes for a frame lies in memory that takes turns. Not for other folders.
 */
#ifndef NEPH_RENDERER_IN_FLIGHT_H
#define NEPH_RENDERER_IN_FLIGHT_H

#include "renderer/compute.h"

enum { NEPH_IN_FLIGHT_FRAMES = 3 };

/* Zero-initialise. Frame number n has slot n % NEPH_IN_FLIGHT_FRAMES. */
struct neph_in_flight {
    uint64_t sent, home;                     /* frames, ever */
    uint64_t batches[NEPH_IN_FLIGHT_FRAMES]; /* sent when the frame of a slot was complete */
};

/* The slot of the next frame, once the frame that had it before is home. A frame that nobody has
 * asked for by _home is forgotten. */
enum neph_status neph_in_flight_begin(const struct neph_vulkan *vulkan,
                                      struct neph_in_flight *flight, int *slot,
                                      struct neph_diag *diag);

/* All batches of that frame have been sent. */
void neph_in_flight_end(const struct neph_vulkan *vulkan, struct neph_in_flight *flight);

/* Wait for the oldest frame that is on its way. NEPH_ERR_USAGE: there is none. */
enum neph_status neph_in_flight_home(const struct neph_vulkan *vulkan,
                                     struct neph_in_flight *flight, int *slot,
                                     struct neph_diag *diag);

/* Wait for all that was ever sent, frames complete or not, and forget them. */
enum neph_status neph_in_flight_land(const struct neph_vulkan *vulkan,
                                     struct neph_in_flight *flight, struct neph_diag *diag);

/* The buffers of a name that wait while one of them is used. */
struct neph_turns {
    struct neph_buffer waiting[NEPH_IN_FLIGHT_FRAMES - 1];
};

/* More buffers like an uploaded one. Zero-initialise; free with _destroy, also after an error. */
enum neph_status neph_turns_create(const struct neph_vulkan *vulkan, const struct neph_buffer *like,
                                   const char *name, struct neph_turns *turns,
                                   struct neph_diag *diag);
void neph_turns_destroy(const struct neph_vulkan *vulkan, struct neph_turns *turns);

/* The one that has waited longest takes the place of `buffer`: once a frame, after
 * neph_in_flight_begin(), it is one that no kernel reads. What it holds is old. */
void neph_turns_take(struct neph_turns *turns, struct neph_buffer *buffer);

#endif
