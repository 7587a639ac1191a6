/* SPDX-License-Identifier: MIT
 *
 * The ray marcher with many rays a pixel, averaged: the reference of moving scenes. The mean over
 * the pixel's square (a box filter) is linear in radiance, volume and transmittance, and depends on
 * no other pixel and no other frame.
 */
#ifndef NEPH_RENDERER_MARCH_AVERAGE_H
#define NEPH_RENDERER_MARCH_AVERAGE_H

#include "renderer/march.h"

#define NEPH_MARCH_RAYS_PER_PX_MAX 256

/* Offset of ray 0 .. rays_per_px - 1 from the pixel's centre, in pixels: the Hammersley set of base
 * 2 (J. Hammersley 1960; a (0, m, 2)-net by H. Niederreiter 1987), shifted by half a step so that
 * its mean is the centre. Example: each column, each row and each cell of 4 x 4 has one of 16
 * points. Equal in all pixels and frames. `rays_per_px` is a power of two; a single ray goes
 * through the centre. */
void neph_march_sample_offset(int ray, int rays_per_px, float jitter_px[2]);

/* As neph_march_frame(): R G B, volume.* and transmittance.* are means over the rays, summed in
 * double. Z and volume.distance are of an additional ray through the centre, because the mean of
 * two depths is not the depth of any point. With one ray the bits equal neph_march_frame(). Counts
 * and times include all rays. NEPH_ERR_USAGE: `rays_per_px` is not a power of two in 1..256. */
enum neph_status neph_march_average(struct neph_march *march, const struct neph_scene *scene,
                                    double frame, int rays_per_px, struct neph_image **image,
                                    struct neph_march_stats *stats, struct neph_diag *diag);

#endif
