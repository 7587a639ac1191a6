/* SPDX-License-Identifier: MIT
 *
 * Converts the sums of a signal (flicker_sums.h) to its amplitudes at the periods of four and two
 * frames, and to the noise around these frequencies. A strict cycle of four frames has no other
 * frequencies besides its mean.
 */
#ifndef NEPH_METRICS_EXTRACTORS_FLICKER_SPECTRUM_H
#define NEPH_METRICS_EXTRACTORS_FLICKER_SPECTRUM_H

#include "metrics/extractors/flicker_sums.h"

#include <stdbool.h>

/* Values that all pixels share. The trend is the line of a joint least-squares fit of a line and a
 * cycle of four frames: it removes a line completely, and nothing of a cycle. (A line fitted
 * without the cycle would follow it and remove up to 12 / N^2 of a pure four-frame flicker.) */
struct neph_flicker_window {
    int frame_count; /* N, a multiple of 4, at least 16 */
    bool detrend;    /* subtract the trend from the signal */
    bool keep_noise; /* do not subtract the noise floor from the amplitudes */
    double ramp[NEPH_FLICKER_LINEAR_COUNT];
};

struct neph_flicker_window neph_flicker_window_make(int frame_count, bool detrend, bool keep_noise);

/* Results in the unit of the signal. D_k is its discrete Fourier transform, after detrending. */
struct neph_flicker_spectrum {
    /* Components of the cycle: signal = quarter_cos cos(pi t / 2) + quarter_sin sin(pi t / 2) +
     * half (-1)^t; without subtraction of noise. */
    double quarter_cos, quarter_sin, half;
    /* Noise: the mean square of the amplitude in neighbouring bins; quarter: the bins N/4 -+ 1 and
     * 2; half: N/2 - 1 and N/2 - 2 (the bins beyond N/2 repeat them). For white noise of standard
     * deviation s these are 4 s^2 / N and s^2 / N. */
    double quarter_noise, half_noise;
    /* Four-frame flicker, 2 |D_(N/4)| / N, and two-frame flicker, |D_(N/2)| / N, both with the
     * noise floor subtracted: sqrt(max(0, amplitude^2 - noise)). */
    double a4, a2;
};

/* Compute the spectrum. `linear`: the first NEPH_FLICKER_LINEAR_COUNT sums. They are linear: the
 * sums of a mean of pixels are the mean of the sums. */
struct neph_flicker_spectrum neph_flicker_spectrum_compute(const struct neph_flicker_window *window,
                                                           const double *linear);

/* Population variance of the signal, or of the detrended signal with `detrended`; never
 * negative. */
double neph_flicker_variance(const struct neph_flicker_window *window, const double *sums,
                             bool detrended);

/* Probability that noise which is white around the bin has as much power at the period of four
 * frames (or two). F test with 2 and 8 degrees of freedom (two components of one bin against those
 * of four bins), or with 1 and 4. 1 without signal and noise. Independent of `keep_noise`. */
double neph_flicker_quarter_p(const struct neph_flicker_spectrum *spectrum);
double neph_flicker_half_p(const struct neph_flicker_spectrum *spectrum);

#endif
