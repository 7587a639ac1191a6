/* SPDX-License-Identifier: MIT
 *
 * Between the view of the targets on the device and images on the CPU.
 */
#ifndef NEPH_RENDERER_REALTIME_IMAGES_H
#define NEPH_RENDERER_REALTIME_IMAGES_H

#include "base/image.h"
#include "renderer/realtime/device.h"

/* Up to three channels of an image of what is rendered become those of a full-resolution
 * target, where it has memory; NULL: 0, and so is what is not of the view. Infinity becomes
 * FAR_M. */
enum neph_status neph_rt_give(struct neph_rt_device *device, int target, float *const channels[3],
                              struct neph_diag *diag);

/* The other way, up to four, to an image of the picture; NULL: not wanted. Where less is rendered a
 * pixel has what the rendered one has that it lies in. */
enum neph_status neph_rt_bring(struct neph_rt_device *device, int target, float *const channels[4],
                               struct neph_diag *diag);

/* All channels of an image of what is rendered, for the picture in the same way; `*image` is
 * replaced on success. */
enum neph_status neph_rt_spread(const struct neph_rt_device *device, struct neph_image **image,
                                struct neph_diag *diag);

/* What the scene pass would make, from a frame from elsewhere: Z and, where it has them, R G B of
 * what is behind all media; without them nothing shines there. Adds the targets to `*given`
 * (NEPH_RT_BIT() of each). Errors: neph_realtime_render(). */
enum neph_status neph_rt_give_frame(struct neph_rt_device *device, const struct neph_image *frame,
                                    uint32_t *given, struct neph_diag *diag);

/* A finished frame with the channels of neph_realtime_render(); `picture` is the target of its
 * R G B. For neph_image_destroy(). */
enum neph_status neph_rt_bring_frame(struct neph_rt_device *device, int picture,
                                     struct neph_image **frame, struct neph_diag *diag);

#endif
