/* SPDX-License-Identifier: MIT
 *
 * The textures of Horizon clouds, from a seed.
 */
#ifndef NEPH_SCENES_HORIZON_TEXTURES_H
#define NEPH_SCENES_HORIZON_TEXTURES_H

#include "base/status.h"

#include <stdint.h>

#define NEPH_HORIZON_BASE_SIDE 64     /* base noise: side^3 texels of 4 channels, periodic */
#define NEPH_HORIZON_DETAIL_SIDE 32   /* detail noise: side^3 texels of 3 channels, periodic */
#define NEPH_HORIZON_WEATHER_SIDE 256 /* weather map: side^2 texels of 4 channels, periodic */

/* Fill arrays of the sizes and layouts of struct neph_horizon. NEPH_ERR_INTERRUPTED only. */
enum neph_status neph_horizon_fill_base(uint64_t seed, float *base, struct neph_diag *diag);
enum neph_status neph_horizon_fill_detail(uint64_t seed, float *detail, struct neph_diag *diag);
enum neph_status neph_horizon_fill_weather(uint64_t seed, float *weather, struct neph_diag *diag);

#endif
