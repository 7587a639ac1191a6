/* SPDX-License-Identifier: MIT
 *
 * Blue noise masks, in space alone or in space and time, made by ourselves and kept in a cache.
 *
 * A mask is a stack of slices, one per frame, each a torus of width x height pixels that holds
 * every rank 0 .. width * height - 1 once. Any threshold of it is a blue-noise set of pixels.
 *
 * Method: void and cluster (R. Ulichney, "The void-and-cluster method for dither array
 * generation", Proc. SPIE 1913, 1993), over all voxels of the stack at once. The energy of a voxel
 * is a sum over the voxels that are on (A. Wolfe et al., "Spatiotemporal Blue Noise Masks", EGSR
 * 2022):
 *
 *   exp(-(dx^2 + dy^2) / (2 sigma^2))   for voxels of the same slice,
 *   exp(-dt^2 / (2 sigma^2))            for voxels of the same pixel,
 *   0                                   for all others,
 *
 * with all distances on the torus. One slice is Ulichney's own method. One thing is ours: a voxel's
 * rank is its place among its slice's voxels alone, not among all, so that every frame has exactly
 * the same histogram: the mean of a whole tile does not flicker.
 */
#ifndef NEPH_RENDERER_BLUE_NOISE_H
#define NEPH_RENDERER_BLUE_NOISE_H

#include "base/status.h"

#include <stdint.h>

#define NEPH_BLUE_NOISE_VERSION 1    /* of the method and of the file: same version, same ranks */
#define NEPH_BLUE_NOISE_SIGMA_PX 1.9 /* Ulichney has 1.5 */
#define NEPH_BLUE_NOISE_SIGMA_FRAMES 1.9

enum {
    NEPH_BLUE_NOISE_SIDE_MAX_PX = 256, /* ranks fit 16 bits */
    NEPH_BLUE_NOISE_FRAMES_MAX = 256,
};

struct neph_blue_noise_request {
    int width_px, height_px; /* 1 .. NEPH_BLUE_NOISE_SIDE_MAX_PX */
    int frame_count;         /* 1 .. NEPH_BLUE_NOISE_FRAMES_MAX; 1: spatial */
    uint64_t seed;
};

struct neph_blue_noise {
    struct neph_blue_noise_request request;
    uint16_t *ranks; /* owned; [(frame * height_px + y) * width_px + x] */
};

/* Make a mask, for neph_blue_noise_destroy(): two seconds for 64x64x32 on one core. The same
 * request gives the same ranks; between machines only exp() could differ, in its last bits, since
 * energies are integers. NEPH_ERR_INTERNAL: a size out of range. NEPH_ERR_INTERRUPTED. */
enum neph_status neph_blue_noise_create(const struct neph_blue_noise_request *request,
                                        struct neph_blue_noise **noise, struct neph_diag *diag);
void neph_blue_noise_destroy(struct neph_blue_noise *noise);

/* A mask from the file neph_blue_noise_path() when that is whole and of this very request, else
 * made anew and written there; the folder is made when it is not there. NEPH_ERR_IO: the file
 * cannot be written. */
enum neph_status neph_blue_noise_load(const struct neph_blue_noise_request *request,
                                      const char *cache_folder, struct neph_blue_noise **noise,
                                      struct neph_diag *diag);

/* "<folder>/blue-noise-v1-64x64x32-seed7.bin", for the caller to free; NULL when memory is short.
 *
 * Format: the line "neph-blue-noise <version> <width> <height> <frames> <seed> <BLAKE2b-256 of the
 * ranks>", then the ranks in 2 bytes each, least byte first. */
char *neph_blue_noise_path(const struct neph_blue_noise_request *request, const char *cache_folder);

#endif
