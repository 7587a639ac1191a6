/* SPDX-License-Identifier: MIT
 *
 * Lattices of numbers as 3D images, which a device's texture unit interpolates: faster than eight
 * loads and a lerp, with weights of as few bits as the device has (Vulkan asks for four, GPUs have
 * eight). Not for other folders.
 */
#ifndef NEPH_RENDERER_TEXTURE_H
#define NEPH_RENDERER_TEXTURE_H

#include "renderer/compute.h"
#include "renderer/march_params.h"

/* The numbers of one slab along z, x fastest; `context` is that of _create. Called from several
 * threads at a time. */
typedef void neph_texture_slab(const void *context, int z, float *values);

struct neph_texture_params {
    enum neph_texel_format format;
    int size[3];             /* texels along x, y, z */
    neph_texture_slab *slab; /* numbers from 0 to 1 */
    const void *context;
    const char *name;
};

/* Between texels the numbers are trilinear, beyond the outermost those of the faces.
 * NEPH_ERR_UNSUPPORTED: the device does
 * not interpolate 3D images of that format, or not of that size, in words. Zero-initialise
 * `texture`; free with _destroy. */
enum neph_status neph_texture_create(const struct neph_vulkan *vulkan,
                                     const struct neph_texture_params *params,
                                     struct neph_texture *texture, struct neph_diag *diag);

/* A zero one is fine. Waits for all that is on its way to the device. */
void neph_texture_destroy(const struct neph_vulkan *vulkan, struct neph_texture *texture);

/* Whether the device interpolates 3D images of a format at all. */
bool neph_texture_filters(const struct neph_vulkan *vulkan, enum neph_texel_format format);

#endif
