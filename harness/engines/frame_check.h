/* SPDX-License-Identifier: MIT
 *
 * Whether an external renderer's frame shows the scene at all: a program may leave a medium out, or
 * all light, and end without an error.
 */
#ifndef NEPH_HARNESS_ENGINES_FRAME_CHECK_H
#define NEPH_HARNESS_ENGINES_FRAME_CHECK_H

#include "base/image.h"
#include "scenes/scene.h"

/* Check a frame of moment `frame` on some 150 pixels. NEPH_ERR_ENGINE, in words that begin with the
 * renderer's `name`: the transmittance of most pixels that see media is that of none (less than a
 * tenth of the optical depth); or all radiance is 0 where pixels see the background, the sun in
 * media, or media that emit. Layers that the frame does not have are not checked. */
enum neph_status neph_frame_check(const struct neph_scene *scene, int frame, const char *name,
                                  const struct neph_image *image, struct neph_diag *diag);

#endif
