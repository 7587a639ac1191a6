/* SPDX-License-Identifier: MIT
 *
 * The march through many points of each pixel, averaged: what references are made of. The mean over
 * the pixel's square (a box filter) is linear in radiance, volume and transmittance, and knows
 * neither other pixels nor other frames.
 */
#ifndef NEPH_RENDERER_MARCH_AVERAGE_H
#define NEPH_RENDERER_MARCH_AVERAGE_H

#include "renderer/march.h"

#define NEPH_MARCH_RAYS_PER_PX_MAX 256

/* Where ray 0 .. rays_per_px - 1 meets the pixel, from its centre, in pixels: the Hammersley set of
 * base 2 (J. Hammersley 1960; a (0, m, 2)-net by H. Niederreiter 1987), moved by half a step so
 * that its mean is the centre. Of 16 points each column, row, and cell of 4 x 4 holds one. The same
 * in all pixels and frames. `rays_per_px` is a power of two; the only ray of 1 is the centre's. */
void neph_march_point(int ray, int rays_per_px, float jitter_px[2]);

/* As neph_march_frame(): R G B, volume.* and transmittance.* are means over the points, summed in
 * double; Z and volume.distance are the centre ray's, which is marched besides (the mean of two
 * depths is no depth). With one ray the bits are those of neph_march_frame(). Counts and seconds
 * are of all rays. NEPH_ERR_USAGE: `rays_per_px` is no power of two in 1..256. */
enum neph_status neph_march_average(struct neph_march *march, const struct neph_scene *scene,
                                    double frame, int rays_per_px, struct neph_image **image,
                                    struct neph_march_stats *stats, struct neph_diag *diag);

#endif
