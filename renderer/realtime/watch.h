/* SPDX-License-Identifier: MIT
 *
 * Bad values in the targets of a frame, counted where they are: what comes home is a number.
 */
#ifndef NEPH_RENDERER_REALTIME_WATCH_H
#define NEPH_RENDERER_REALTIME_WATCH_H

#include "renderer/realtime/device.h"

/* Values of the view's part of some targets (NEPH_RT_BIT() of each) that are not finite, or
 * negative; of RT_MOVED, where that means something, those that are not finite. Waits for all that
 * was sent before. */
enum neph_status neph_rt_watch(struct neph_rt_device *device, uint32_t targets, uint64_t *bad,
                               struct neph_diag *diag);

/* The targets that hold what a frame has made, once it has been handed on: not what it found
 * there, which the next one overwrites. */
uint32_t neph_rt_watched(const struct neph_gpu_view *view);

#endif
