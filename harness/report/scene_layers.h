/* SPDX-License-Identifier: MIT
 *
 * What a scene knows of a frame and a renderer need not: where clouds, fog, thin objects and the
 * sun are, and how the picture of solids and sky moved since the frame before. Layers for the
 * metrics (base/image.h).
 */
#ifndef NEPH_HARNESS_REPORT_SCENE_LAYERS_H
#define NEPH_HARNESS_REPORT_SCENE_LAYERS_H

#include "base/image.h"
#include "scenes/scene.h"

/* Add to a rendered frame the layers that its channels allow; an existing one stays.
 *   mask.fog, mask.cloud  from transmittance: optical depth above 0.001 in some channel by the
 *                         homogeneous media and height fogs in front of the solid; by all others
 *                         together. Only when the scene has media of that sort
 *   mask.thin             within 1 px of a solid marked thin, by the scene's own rays
 *   mask.sun              no solid, within 0.27 degrees (and half a pixel) of the sun
 *   motion.x, .y, .depth  from Z, of solids and sky, when the camera moves (metrics/motion.h), in
 *                         pixels of this frame's size; across a cut NEPH_MOTION_NOWHERE_PX and 0.
 *                         What wind does to media is not in it
 * The frame's own size and the shot's frame number are used. */
enum neph_status neph_scene_layers_add(const struct neph_scene *scene, int frame,
                                       struct neph_image *image, struct neph_diag *diag);

#endif
