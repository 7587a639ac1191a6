/* SPDX-License-Identifier: MIT
 *
 * Fault injection: writes the values that a scene file requests (scenes/injection.h) into the
 * targets of a running renderer. The device must be idle. Each function adds the number of values
 * that it wrote to `*count`.
 */
#ifndef NEPH_RENDERER_REALTIME_INJECTION_H
#define NEPH_RENDERER_REALTIME_INJECTION_H

#include "renderer/realtime/device.h"
#include "scenes/injection.h"

/* Into every target that the next frame reads as history. */
enum neph_status neph_rt_inject_history(struct neph_rt_device *device,
                                        enum neph_injected_value value, uint64_t *count,
                                        struct neph_diag *diag);

/* Into the rays of the march, before the next pass reads them. */
enum neph_status neph_rt_inject_rays(struct neph_rt_device *device,
                                     const struct neph_injected_rays *rays, uint64_t *count,
                                     struct neph_diag *diag);

/* Into all texels outside the view. */
enum neph_status neph_rt_inject_outside_view(struct neph_rt_device *device,
                                             enum neph_injected_value value, uint64_t *count,
                                             struct neph_diag *diag);

#endif
