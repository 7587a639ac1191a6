/* SPDX-License-Identifier: MIT
 *
 * The textures of Horizon clouds, from a seed. Private to scenes/horizon.c.
 */
#ifndef NEPH_SCENES_HORIZON_TEXTURES_H
#define NEPH_SCENES_HORIZON_TEXTURES_H

#include <stdint.h>

/* Fill arrays of the sizes and layouts of struct neph_horizon. */
void neph_horizon_fill_base(uint64_t seed, float *base);
void neph_horizon_fill_detail(uint64_t seed, float *detail);
void neph_horizon_fill_weather(uint64_t seed, float *weather);

#endif
