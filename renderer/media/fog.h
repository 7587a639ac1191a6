/* SPDX-License-Identifier: MIT
 *
 * Fog layers in the device's layout. Private to renderer/ and its tests.
 */
#ifndef NEPH_RENDERER_MEDIA_FOG_H
#define NEPH_RENDERER_MEDIA_FOG_H

#include "scenes/scene.h"
#include "shaders/structs.h"

/* A layer relative to the height of the camera; its extinction must be above 0. */
struct neph_gpu_fog_layer neph_gpu_fog_layer_from(const struct neph_fog_layer *layer,
                                                  double camera_y_m);

#endif
