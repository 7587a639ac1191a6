/* SPDX-License-Identifier: MIT
 *
 * What a scene's file wants put into the targets of a running renderer (scenes/injection.h). The
 * device must be done with all that it was sent. Each adds to `*count` how many values it put in.
 */
#ifndef NEPH_RENDERER_REALTIME_INJECTION_H
#define NEPH_RENDERER_REALTIME_INJECTION_H

#include "renderer/realtime/device.h"
#include "scenes/injection.h"

/* Into all that the next picture takes for its past. */
enum neph_status neph_rt_inject_history(struct neph_rt_device *device,
                                        enum neph_injected_value value, uint64_t *count,
                                        struct neph_diag *diag);

/* Into what the march has found, before the next pass reads it. */
enum neph_status neph_rt_inject_rays(struct neph_rt_device *device,
                                     const struct neph_injected_rays *rays, uint64_t *count,
                                     struct neph_diag *diag);

/* Into all of the targets that is not the view's. */
enum neph_status neph_rt_inject_around(struct neph_rt_device *device,
                                       enum neph_injected_value value, uint64_t *count,
                                       struct neph_diag *diag);

#endif
