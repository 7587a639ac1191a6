/* SPDX-License-Identifier: MIT
 *
 * Checks that a frame of an external renderer shows the scene: a program may omit a medium, or all
 * light, without an error.
 */
#ifndef NEPH_HARNESS_ENGINES_FRAME_CHECK_H
#define NEPH_HARNESS_ENGINES_FRAME_CHECK_H

#include "base/image.h"
#include "scenes/scene.h"

/* Check a frame of the scene at `frame`, on some 150 pixels. NEPH_ERR_ENGINE, with a message that
 * starts with the renderer's `name`, in two cases:
 * - most pixels that see media have less than a tenth of the optical depth;
 * - all radiance is 0 although pixels see the background, sunlit media or emitting media.
 *
 * Layers that the frame does not have are not checked. */
enum neph_status neph_frame_check(const struct neph_scene *scene, int frame, const char *name,
                                  const struct neph_image *image, struct neph_diag *diag);

#endif
