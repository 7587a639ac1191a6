/* SPDX-License-Identifier: MIT
 *
 * From the sums of one signal (flicker_sums.h) to its amplitudes at the periods of four and two
 * frames, which are all that a strict cycle of four frames can hold besides its mean, and to the
 * noise around them.
 */
#ifndef NEPH_METRICS_EXTRACTORS_FLICKER_SPECTRUM_H
#define NEPH_METRICS_EXTRACTORS_FLICKER_SPECTRUM_H

#include "metrics/extractors/flicker_sums.h"

#include <stdbool.h>

/* What is the same for all pixels.
 * The trend is the line of the least-squares fit of a line and a cycle of four frames together: a
 * line is then taken out wholly, and of a cycle nothing. (A line fitted alone also follows the
 * cycle: it takes up to 12 / N^2 of a pure four-frame flicker.) */
struct neph_flicker_window {
    int frame_count; /* N, a multiple of 4, at least 16 */
    bool detrend;    /* take the trend out of the signal */
    bool keep_noise; /* do not subtract the noise floor from the amplitudes */
    double ramp[NEPH_FLICKER_LINEAR_COUNT];
};

struct neph_flicker_window neph_flicker_window_of(int frame_count, bool detrend, bool keep_noise);

/* In the unit of the signal. D_k is its discrete Fourier transform, after detrending. */
struct neph_flicker_spectrum {
    /* The parts of the cycle: signal = quarter_cos cos(pi t / 2) + quarter_sin sin(pi t / 2)
     * + half (-1)^t; nothing is subtracted from them. */
    double quarter_cos, quarter_sin, half;
    /* Noise: mean square of the amplitude that the neighbouring bins show; quarter: those at N/4 -+
     * 1 and 2; half: those at N/2 - 1 and N/2 - 2, since there are none above (the bins beyond N/2
     * repeat them). For white noise of standard deviation s these are 4 s^2 / N and s^2 / N. */
    double quarter_noise, half_noise;
    /* Four-frame flicker, 2 |D_(N/4)| / N, and two-frame flicker, |D_(N/2)| / N, both with the
     * noise floor subtracted: sqrt(max(0, amplitude^2 - noise)). */
    double a4, a2;
};

/* `linear`: the first NEPH_FLICKER_LINEAR_COUNT sums. Being linear, those of a mean of pixels are
 * the mean of the sums. */
struct neph_flicker_spectrum neph_flicker_spectrum_of(const struct neph_flicker_window *window,
                                                      const double *linear);

/* Population variance of the signal, of the detrended signal when `detrended`; never below 0. */
double neph_flicker_variance(const struct neph_flicker_window *window, const double *sums,
                             bool detrended);

/* Whether a cycle of four frames stands out of the noise: the probability that noise which is white
 * around the bin shows as much at the period of four frames, or of two. F distribution with 2 and 8
 * degrees of freedom, two parts of one bin against those of four, or 1 and 4. 1 when there is
 * neither signal nor noise. `keep_noise` makes no difference. */
double neph_flicker_quarter_p(const struct neph_flicker_spectrum *spectrum);
double neph_flicker_half_p(const struct neph_flicker_spectrum *spectrum);

#endif
