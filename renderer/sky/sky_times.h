/* SPDX-License-Identifier: MIT
 *
 * What a device took for tables of the sky.
 */
#ifndef NEPH_RENDERER_SKY_SKY_TIMES_H
#define NEPH_RENDERER_SKY_SKY_TIMES_H

/* Device time [s]; NaN: it has no clock; 0: nothing had to be filled. Of the tables of the air,
 * made once, of what is seen from places, and of the air before the camera. */
struct neph_sky_times {
    double air_s, view_s, aerial_s;
};

static inline double neph_sky_gpu_s(const struct neph_sky_times *times)
{
    return times->air_s + times->view_s + times->aerial_s;
}

#endif
