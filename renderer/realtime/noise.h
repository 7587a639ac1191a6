/* SPDX-License-Identifier: MIT
 *
 * Periods of the dithers.
 */
#ifndef NEPH_RENDERER_REALTIME_NOISE_H
#define NEPH_RENDERER_REALTIME_NOISE_H

/* The number of frames after which the values of a pixel repeat; 0: never, or they do not change.
 * `kind`: RT_DITHER_*. */
int neph_rt_dither_period(int kind);

#endif
