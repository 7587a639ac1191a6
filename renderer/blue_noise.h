/* SPDX-License-Identifier: MIT
 *
 * Blue noise masks for dithering, one spatial and one spatiotemporal: the file
 * renderer/blue_noise.png, made by scripts/make_blue_noise.c. A seed shifts both masks.
 *
 * A mask is a stack of slices, one a frame. A slice is a torus of 64x64 pixels with each rank 0 ..
 * 4095 once. The pixels below any threshold of rank are a blue-noise set. The spatial mask has one
 * slice; the spatiotemporal mask has 32, repeated periodically. The file stores the slices as
 * 12-bit ranks, three slices (R, G, B) in each block of 64x64 pixels, blocks from top to bottom.
 * The first slice, R of the first block, is the spatial mask.
 *
 * Method: void and cluster (R. Ulichney, "The void-and-cluster method for dither array generation",
 * Proc. SPIE 1913, 1993), over all voxels of the stack at once. The energy of a voxel is a sum over
 * the voxels that are on (A. Wolfe et al., "Spatiotemporal Blue Noise Masks", EGSR 2022):
 *
 *   exp(-(dx^2 + dy^2) / (2 sigma^2))   for voxels of the same slice, sigma = 1.9 px,
 *   exp(-dt^2 / (2 sigma^2))            for voxels of the same pixel, sigma = 1.9 frames,
 *   0                                   for all others,
 *
 * with all distances on the torus (Ulichney has a sigma of 1.5). For one slice this is Ulichney's
 * method. Unlike Wolfe et al., a voxel is ranked within its slice and not within the stack. So all
 * frames have the same histogram, and the mean of a whole 64x64 tile does not flicker.
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

/* Load the ranks of the spatial and then of the spatiotemporal mask, [(slice * 64 + y) * 64 + x],
 * from the file at `path`. Both masks are shifted in space, and the second also in time, by
 * pcg(seed) (M. Jarzynski, M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020): bits
 * 0..5 are the shift in x, 6..11 the shift in y, 12..16 the shift in time.
 *
 * NEPH_ERR_NOT_FOUND, NEPH_ERR_IO: as of neph_hash_file(). NEPH_ERR_INPUT: the file is not exactly
 * the one that this program was built with. Stored frames are keyed by the program, so any other
 * file would make their keys wrong. */
enum neph_status neph_blue_noise_load(const char *path, uint32_t seed,
                                      uint32_t ranks[NEPH_BLUE_NOISE_COUNT],
                                      struct neph_diag *diag);

#endif
