/* SPDX-License-Identifier: MIT
 *
 * The sizes of the sky's tables for the ray marcher.
 */
#include "renderer/march_params.h"

struct neph_march_sky neph_march_sky_choose(struct neph_march_sky_choices choices)
{
    return (struct neph_march_sky){
        .is_on = choices.is_on,
        .has_shadows = choices.has_shadows,
        .tables = {.steps = 48,
                   .sun_altitudes = 64,
                   .sun_cosines = 256,
                   .field = {.altitudes = 24,
                             .suns = 64,
                             .degree = 2,
                             .orders = 8,
                             .above = 8,
                             .below = 4,
                             .around = 6,
                             .steps = 16},
                   .view = {.is_table = true, .elevations = 48, .azimuths = 48},
                   .aerial = {choices.columns, choices.rows, choices.slices, choices.far_m},
                   .refill = (enum neph_sky_refill)choices.refill},
    };
}
