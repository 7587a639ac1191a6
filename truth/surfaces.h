/* SPDX-License-Identifier: MIT
 *
 * Renders an image of light between solids, unbiased and in double precision: truth/reflected.h at
 * every pixel's centre, with the standard error of all sampled light.
 */
#ifndef NEPH_TRUTH_SURFACES_H
#define NEPH_TRUTH_SURFACES_H

#include "base/image.h"
#include "truth/reflected.h"

#include <stdint.h>

struct neph_surfaces_params {
    int width_px, height_px;
    double frame;
    uint64_t seed;
    int samples;                         /* per pixel, 2..2^30 */
    struct neph_reflected_limits limits; /* its screen is the rendered frame */
};

/* Render R G B, volume.* (0), transmittance.* (1), Z and, as layers of R G B,
 *   diffuse_direct, diffuse_indirect, glossy_direct, glossy_indirect: per unit of colour
 *   diffuse_color, glossy_color: their colours
 *   ao: visibility, all channels
 *   diffuse_on_screen, glossy_on_screen, ao_on_screen: the parts from inside the frame
 * so that R G B = diffuse_color * (diffuse_direct + diffuse_indirect) + the same for glossy. For
 * the sky, R G B is the background, ao and ao_on_screen are 1 and the others are 0. variance.* is
 * the squared standard error of R G B, variance.LAYER.* of a layer. normal.x, .y, .z: unit, in
 * world axes; 0 for the sky. If the scene's scattering is not `multiple`, light meets no surface
 * before the visible one. The same params and scene give the same bits, on any number of threads.
 * `*frame` is owned by the caller. NEPH_ERR_USAGE: a parameter is out of range.
 * NEPH_ERR_UNSUPPORTED: see neph_reflected_is_supported(). */
enum neph_status neph_surfaces_render(const struct neph_scene *scene,
                                      const struct neph_surfaces_params *params,
                                      struct neph_image **frame, struct neph_diag *diag);

#endif
