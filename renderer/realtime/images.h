/* SPDX-License-Identifier: MIT
 *
 * Conversion between targets on the device and images on the CPU. The images are those of one view.
 */
#ifndef NEPH_RENDERER_REALTIME_IMAGES_H
#define NEPH_RENDERER_REALTIME_IMAGES_H

#include "base/image.h"
#include "renderer/realtime/device.h"

/* Uploads up to three channels of an image at rendered resolution to a full-resolution target. No
 * effect when the target has no memory. A NULL channel and the texels outside the view become 0;
 * infinity becomes FAR_M. */
enum neph_status neph_rt_upload_image(struct neph_rt_device *device, int target,
                                      float *const channels[3], struct neph_diag *diag);

/* Downloads up to four channels of a target to an image at output resolution; NULL: not wanted.
 * With screen_percent below 100 each output pixel gets the value of the rendered pixel around its
 * centre. */
enum neph_status neph_rt_download_image(struct neph_rt_device *device, int target,
                                        float *const channels[4], struct neph_diag *diag);

/* Resamples all channels of an image from rendered to output resolution in the same way. `*image`
 * is replaced on success. */
enum neph_status neph_rt_resample_image(const struct neph_rt_device *device,
                                        struct neph_image **image, struct neph_diag *diag);

/* Uploads an external frame in place of the scene pass's output: Z and, where it has them, R G B of
 * the radiance behind all media (otherwise 0). Adds the written targets to `*given` (NEPH_RT_BIT()
 * of each). Errors: neph_realtime_render(). */
enum neph_status neph_rt_upload_frame(struct neph_rt_device *device, const struct neph_image *frame,
                                      uint32_t *given, struct neph_diag *diag);

/* Creates a finished frame with the channels of neph_realtime_render(); `picture` is the target of
 * its R G B. The caller frees it with neph_image_destroy(). */
enum neph_status neph_rt_download_frame(struct neph_rt_device *device, int picture,
                                        struct neph_image **frame, struct neph_diag *diag);

#endif
