/* SPDX-License-Identifier: MIT
 *
 * Finds layers in Blender's images. Callers use the short names of Blender up to version 4; Blender
 * 5 writes long names.
 */
#ifndef NEPH_HARNESS_ENGINES_CYCLES_LAYERS_H
#define NEPH_HARNESS_ENGINES_CYCLES_LAYERS_H

#include "base/image.h"

/* The channels of a layer such as "VolumeDir", under its short or its long name. NEPH_ERR_ENGINE
 * names a missing layer. */
enum neph_status neph_cycles_layer(const struct neph_image *image, const char *name,
                                   float *channels[3], struct neph_diag *diag);

/* The depth channel. */
enum neph_status neph_cycles_depth(const struct neph_image *image, const float **depth,
                                   struct neph_diag *diag);

#endif
