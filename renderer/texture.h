/* SPDX-License-Identifier: MIT
 *
 * Grids of numbers as 3D images, interpolated by the texture unit: faster than eight loads and a
 * trilinear interpolation. The weights have few bits (Vulkan requires four, GPUs have eight). Not
 * for other folders.
 */
#ifndef NEPH_RENDERER_TEXTURE_H
#define NEPH_RENDERER_TEXTURE_H

#include "renderer/compute.h"
#include "renderer/march_params.h"

/* Write the values of one slab along z, x fastest; `context` was passed to _create. Called from
 * several threads at a time. */
typedef void neph_texture_slab(const void *context, int z, float *values);

struct neph_texture_params {
    enum neph_texel_format format;
    int size[3];             /* texels along x, y, z */
    neph_texture_slab *slab; /* values from 0 to 1 */
    const void *context;
    const char *name;
};

/* Create a texture with trilinear interpolation, clamped to the edge. NEPH_ERR_UNSUPPORTED, with
 * the reason: the device does not filter 3D images of that format, or not of that size.
 * Zero-initialise `texture`; free with _destroy. */
enum neph_status neph_texture_create(const struct neph_vulkan *vulkan,
                                     const struct neph_texture_params *params,
                                     struct neph_texture *texture, struct neph_diag *diag);

/* A zero-initialised texture is fine. Waits for all submitted work. */
void neph_texture_destroy(const struct neph_vulkan *vulkan, struct neph_texture *texture);

/* Whether the device filters 3D images of a format at all. */
bool neph_texture_can_filter(const struct neph_vulkan *vulkan, enum neph_texel_format format);

#endif
