/* SPDX-License-Identifier: MIT
 *
 * The suns of the pictures before, of which no ray can tell: whether they flash with the period of
 * two looks at the same light, so that rays which are marched a second time after as many frames
 * (gradient/gradient.comp) see what they saw; and whether a sun has jumped, which texels that the
 * override never marches would not learn.
 */
#ifndef NEPH_RENDERER_REALTIME_SUNS_H
#define NEPH_RENDERER_REALTIME_SUNS_H

#include "scenes/scene.h"

#include <stdbool.h>
#include <stdint.h>

enum { NEPH_RT_SUNS_MAX = 64 };

struct neph_rt_suns {
    struct neph_sun suns[NEPH_RT_SUNS_MAX]; /* of picture number n the n mod NEPH_RT_SUNS_MAX-th */
    uint32_t last;                          /* the number of the latest picture */
    uint32_t count;                         /* of pictures in a row up to it; 0: none yet */
};

/* Keep the sun of a picture. The same number again replaces it, and another one than the next
 * begins anew. */
void neph_rt_suns_keep(struct neph_rt_suns *suns, uint32_t number, const struct neph_sun *sun);

/* Whether the latest 2 x `period` suns are one period twice and are not alike within it. A tenth of
 * the irradiance of a channel, or 0.1 rad, is a difference: from which on light counts as changed
 * in the presets that look twice. A slow sun is never that: where it turns back it is unlike itself
 * a period before. False while fewer are known, and beyond half of NEPH_RT_SUNS_MAX. */
bool neph_rt_suns_flash(const struct neph_rt_suns *suns, uint32_t period);

/* Whether one of the latest `pictures` has another sun than the one before it, in that sense. */
bool neph_rt_suns_jumped(const struct neph_rt_suns *suns, uint32_t pictures);

#endif
