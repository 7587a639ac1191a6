/* SPDX-License-Identifier: MIT
 *
 * How soon the dither of each kind repeats.
 */
#ifndef NEPH_RENDERER_REALTIME_NOISE_H
#define NEPH_RENDERER_REALTIME_NOISE_H

/* The number of frames after which the values of a pixel repeat; 0: never, or they do not change.
 * `kind`: RT_DITHER_*. */
int neph_rt_dither_period(int kind);

#endif
