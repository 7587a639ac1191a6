/* SPDX-License-Identifier: MIT
 *
 * Counts bad values in the targets of a frame on the device, so that only a number is read back.
 */
#ifndef NEPH_RENDERER_REALTIME_WATCH_H
#define NEPH_RENDERER_REALTIME_WATCH_H

#include "renderer/realtime/device.h"

/* Counts values that are not finite or are negative in the view's part of some targets
 * (NEPH_RT_BIT() of each). RT_MOVED may be negative. Waits for all earlier submissions. */
enum neph_status neph_rt_watch(struct neph_rt_device *device, uint32_t targets, uint64_t *bad,
                               struct neph_diag *diag);

/* The targets that a frame has written, after the swap of the histories. The targets under their
 * names of the current frame are left out: the next frame overwrites them. */
uint32_t neph_rt_find_watched_targets(const struct neph_gpu_view *view);

#endif
