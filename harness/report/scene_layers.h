/* SPDX-License-Identifier: MIT
 *
 * Layers that are computed from the scene and added to a frame for the metrics (base/image.h):
 * masks of clouds, fog, thin objects and the sun, and the motion vectors of solids and sky.
 */
#ifndef NEPH_HARNESS_REPORT_SCENE_LAYERS_H
#define NEPH_HARNESS_REPORT_SCENE_LAYERS_H

#include "base/image.h"
#include "scenes/scene.h"

/* Add to a rendered frame the layers that its channels allow; an existing layer is kept.
 *   mask.fog, mask.cloud  from transmittance: optical depth above 0.001 in some channel. Fog: the
 *                         homogeneous media and height fogs in front of the solid; cloud: all other
 *                         media together. Each only when the scene has such media
 *   mask.thin             within 1 px of a solid marked thin, by the scene's own rays
 *   mask.sun              no solid, within 0.27 degrees (and half a pixel) of the sun
 *   motion.x, .y, .depth  from Z, of solids and sky, when the camera or a solid moves
 *                         (metrics/motion.h), in pixels of this frame's size; across a cut
 *                         NEPH_MOTION_NOWHERE_PX and 0. Wind in media is not included
 * The size is the frame's own; `frame` is the number of the shot's frame. */
enum neph_status neph_scene_layers_add(const struct neph_scene *scene, int frame,
                                       struct neph_image *image, struct neph_diag *diag);

#endif
