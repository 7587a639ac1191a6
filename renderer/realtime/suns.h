/* SPDX-License-Identifier: MIT
 *
 * Sun history: the suns of the last frames. Gradient samples (gradient/gradient.comp) compare light
 * over a fixed number of frames, so they cannot see two cases, which are found here:
 * - the sun flashes with exactly this period, and both samples see the same light;
 * - the sun jumps, and texels that the slot override never marches keep the old light.
 */
#ifndef NEPH_RENDERER_REALTIME_SUNS_H
#define NEPH_RENDERER_REALTIME_SUNS_H

#include "scenes/scene.h"

#include <stdbool.h>
#include <stdint.h>

enum { NEPH_RT_SUNS_MAX = 64 };

struct neph_rt_sun_history {
    struct neph_sun suns[NEPH_RT_SUNS_MAX]; /* of frame n at n mod NEPH_RT_SUNS_MAX */
    uint32_t last;                          /* number of the latest frame */
    uint32_t count;                         /* consecutive frames up to it; 0: none yet */
};

/* Stores the sun of a frame. The number of the latest frame replaces its sun; a number that is not
 * the next one restarts the history. */
void neph_rt_sun_history_add(struct neph_rt_sun_history *suns, uint32_t number,
                             const struct neph_sun *sun);

/* Whether the latest 2 x `period` suns are one period twice, with a difference inside the period.
 * Two suns differ when a channel of the irradiance differs by a tenth or the direction by 0.1 rad:
 * from there on the presets with a gradient treat light as changed. A slow sun is never periodic in
 * this sense: at its turning point it differs from the sun one period before. False while the
 * history is shorter, and for periods above half of NEPH_RT_SUNS_MAX. */
bool neph_rt_sun_history_is_periodic(const struct neph_rt_sun_history *suns, uint32_t period);

/* Whether the sun of one of the latest `pictures` frames differs from the frame before it. */
bool neph_rt_sun_history_has_jump(const struct neph_rt_sun_history *suns, uint32_t pictures);

#endif
