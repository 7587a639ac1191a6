/* SPDX-License-Identifier: MIT
 *
 * An image as the colour of a surface. Values are bilinear between the centres of pixels, in linear
 * light, and the image repeats in both directions. The image is 1 wide and high: (u, v) = (0, 0) is
 * the lower left corner of its lowest left pixel, as in glTF, OBJ and Blender (glTF counts v from
 * the top; its reader turns it).
 */
#ifndef NEPH_SCENES_ALBEDO_TEXTURE_H
#define NEPH_SCENES_ALBEDO_TEXTURE_H

#include "base/hash.h"
#include "base/vec3.h"

#include <stdbool.h>
#include <stddef.h>

/* Immutable. */
struct neph_albedo_texture {
    int width_px, height_px;
    float *rgba;    /* rows from the top; linear, not multiplied by alpha; owned */
    bool has_alpha; /* else alpha is 1 */
    char hash[NEPH_HASH_HEX_SIZE];
};

struct neph_texel {
    struct neph_rgb color; /* 0..1 */
    double alpha;          /* 0..1 */
};

/* Reads a PNG as neph_png_read_rgba() does: sRGB becomes linear. */
enum neph_status neph_albedo_texture_read(const char *path, size_t limit_bytes,
                                          struct neph_albedo_texture **texture,
                                          struct neph_diag *diag);

/* Takes over `rgba`, from malloc(), also on errors. */
enum neph_status neph_albedo_texture_create(int width_px, int height_px, float *rgba,
                                            bool has_alpha, struct neph_albedo_texture **texture,
                                            struct neph_diag *diag);
void neph_albedo_texture_destroy(struct neph_albedo_texture *texture);

/* A finite place. */
struct neph_texel neph_albedo_texture_find(const struct neph_albedo_texture *texture, double u,
                                           double v);

#endif
