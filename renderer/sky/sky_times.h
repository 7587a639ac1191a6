/* SPDX-License-Identifier: MIT
 *
 * Device times of the sky's tables.
 */
#ifndef NEPH_RENDERER_SKY_SKY_TIMES_H
#define NEPH_RENDERER_SKY_SKY_TIMES_H

/* Device time [s]; NaN: no clock; 0: not filled. Of the tables of the air (filled once), of views
 * from positions, of shadows on the air in front of the camera, and of that air. */
struct neph_sky_times {
    double air_s, view_s, shade_s, aerial_s;
};

static inline double neph_sky_gpu_s(const struct neph_sky_times *times)
{
    return times->air_s + times->view_s + times->shade_s + times->aerial_s;
}

#endif
