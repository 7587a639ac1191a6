/* SPDX-License-Identifier: MIT
 *
 * A picture of light between solids, unbiased and in double precision: truth/reflected.h for every
 * pixel's centre, with the standard error of everything that is drawn.
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
    struct neph_reflected_limits limits; /* its screen is the picture itself */
};

/* Render R G B, volume.* (0), transmittance.* (1), Z and, as layers of R G B,
 *   diffuse_direct, diffuse_indirect, glossy_direct, glossy_indirect: per unit of colour
 *   diffuse_color, glossy_color: their units
 *   ao: visibility, all channels
 *   diffuse_on_screen, glossy_on_screen, ao_on_screen: their parts that a screen can know
 * so that R G B = diffuse_color * (diffuse_direct + diffuse_indirect) + the same for glossy. Of the
 * sky R G B is the background, ao and ao_on_screen are 1 and the others are 0. variance.* is the
 * square of the standard error of R G B, variance.LAYER.* of a layer. normal.x, .y, .z: unit, in
 * the world's axes; of the sky 0. Where the scene does not scatter all orders, light meets no
 * surface before the one in view. Same params and scene: same bits, on any number of threads.
 * `*frame` is the caller's. NEPH_ERR_USAGE: a parameter is out of range. NEPH_ERR_UNSUPPORTED:
 * neph_reflected_can() says no. */
enum neph_status neph_surfaces_render(const struct neph_scene *scene,
                                      const struct neph_surfaces_params *params,
                                      struct neph_image **frame, struct neph_diag *diag);

#endif
