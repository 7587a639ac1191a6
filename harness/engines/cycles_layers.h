/* SPDX-License-Identifier: MIT
 *
 * The layers of Blender's images by the names that they have up to Blender 4; Blender 5 writes them
 * out in full.
 */
#ifndef NEPH_HARNESS_ENGINES_CYCLES_LAYERS_H
#define NEPH_HARNESS_ENGINES_CYCLES_LAYERS_H

#include "base/image.h"

/* The channels of layer "VolumeDir", whichever of its names it has. NEPH_ERR_ENGINE names the layer
 * that is not there. */
enum neph_status neph_cycles_layer(const struct neph_image *image, const char *name,
                                   float *channels[3], struct neph_diag *diag);

/* The depth. */
enum neph_status neph_cycles_depth(const struct neph_image *image, const float **depth,
                                   struct neph_diag *diag);

#endif
