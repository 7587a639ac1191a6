/* SPDX-License-Identifier: MIT
 *
 * Blue noise masks, one in space and one in space and time: the file renderer/blue_noise.png, made
 * by scripts/make_blue_noise.c. A seed shifts both masks.
 *
 * A mask is a stack of slices, one a frame, each a torus of 64x64 pixels that holds every rank
 * 0 .. 4095 once. Any threshold of a slice is a blue-noise set of pixels. The spatial mask has one
 * slice, the spatiotemporal mask 32, after which the first follows again. In the file the first
 * three slices are R, G and B of the uppermost 64x64 pixels, and R is the spatial mask; the next
 * three slices stand below, and so on. A rank is a value of 12 bits.
 *
 * Method: void and cluster (R. Ulichney, "The void-and-cluster method for dither array
 * generation", Proc. SPIE 1913, 1993), over all voxels of the stack at once. The energy of a voxel
 * is a sum over the voxels that are on (A. Wolfe et al., "Spatiotemporal Blue Noise Masks", EGSR
 * 2022):
 *
 *   exp(-(dx^2 + dy^2) / (2 sigma^2))   for voxels of the same slice, sigma = 1.9 px,
 *   exp(-dt^2 / (2 sigma^2))            for voxels of the same pixel, sigma = 1.9 frames,
 *   0                                   for all others,
 *
 * with all distances on the torus (Ulichney has a sigma of 1.5). For one slice that is Ulichney's
 * method. One thing is ours: the rank of a voxel is its place among the voxels of its slice, not
 * among all, so that every frame has exactly the same histogram: the mean of a whole tile does not
 * flicker.
 */
#ifndef NEPH_RENDERER_BLUE_NOISE_H
#define NEPH_RENDERER_BLUE_NOISE_H

#include "base/status.h"

#include <stdint.h>

enum {
    NEPH_BLUE_NOISE_SIDE_PX = 64, /* a power of two, as NEPH_BLUE_NOISE_FRAMES */
    NEPH_BLUE_NOISE_PIXELS = NEPH_BLUE_NOISE_SIDE_PX * NEPH_BLUE_NOISE_SIDE_PX,
    NEPH_BLUE_NOISE_FRAMES = 32,
    NEPH_BLUE_NOISE_SLICES = 1 + NEPH_BLUE_NOISE_FRAMES,
    NEPH_BLUE_NOISE_COUNT = NEPH_BLUE_NOISE_SLICES * NEPH_BLUE_NOISE_PIXELS,
};

/* Ranks of the spatial mask and then of the spatiotemporal mask, [(slice * 64 + y) * 64 + x], from
 * the file at `path`. Both masks are shifted by the same pixels, and the second by frames, which
 * pcg(seed) decides (M. Jarzynski, M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020):
 * bits 0..5 are the shift in x, 6..11 the shift in y, 12..16 the shift in time.
 *
 * NEPH_ERR_NOT_FOUND, NEPH_ERR_IO: as of neph_hash_file(). NEPH_ERR_INPUT: the file is not the one
 * that belongs to this program, bit by bit: frames are filed by the program that made them. */
enum neph_status neph_blue_noise_load(const char *path, uint32_t seed,
                                      uint32_t ranks[NEPH_BLUE_NOISE_COUNT],
                                      struct neph_diag *diag);

#endif
