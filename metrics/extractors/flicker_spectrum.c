/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/flicker_spectrum.h"

#include <math.h>

struct neph_flicker_window neph_flicker_window_make(int frame_count, bool detrend, bool keep_noise)
{
    struct neph_flicker_window window = {
        .frame_count = frame_count, .detrend = detrend, .keep_noise = keep_noise};
    neph_flicker_ramp_sums(frame_count, window.ramp);
    return window;
}

/* The slope of the trend [signal per frame]. In a joint fit of a line and a cycle, only the part of
 * the line that no cycle can represent determines the slope: its steps from cycle to cycle (Frisch
 * and Waugh, Econometrica 1, 1933), which are the weights of NEPH_FLICKER_TREND. */
static double compute_trend_slope(const struct neph_flicker_window *window, const double *linear)
{
    return linear[NEPH_FLICKER_TREND] / window->ramp[NEPH_FLICKER_TREND];
}

static double sum_of_squares(const double *values, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        sum += values[i] * values[i];
    return sum;
}

static double amplitude(double square, double noise)
{
    return sqrt(fmax(0.0, square - noise));
}

struct neph_flicker_spectrum neph_flicker_spectrum_compute(const struct neph_flicker_window *window,
                                                           const double *linear)
{
    const double slope = window->detrend ? compute_trend_slope(window, linear) : 0.0;
    const double n = (double)window->frame_count;
    double sums[NEPH_FLICKER_LINEAR_COUNT];
    for (int s = 0; s < NEPH_FLICKER_LINEAR_COUNT; s++)
        sums[s] = linear[s] - slope * window->ramp[s];

    /* For every j, the bins N/4 - j and N/4 + j together have twice the squares of their four sums
     * (the mixed terms cancel): the mean over four bins is half the sum of the eight squares. A bin
     * N/2 - j is the complex number of its two sums. */
    const double quarter_bins = 0.5 * sum_of_squares(sums + NEPH_FLICKER_QUARTER, 8);
    const double half_bins = 0.5 * sum_of_squares(sums + NEPH_FLICKER_HALF, 4);
    const double *phase = sums + NEPH_FLICKER_PHASE_0;
    struct neph_flicker_spectrum spectrum = {
        .quarter_cos = 2.0 / n * (phase[0] - phase[2]),
        .quarter_sin = 2.0 / n * (phase[1] - phase[3]),
        .half = 1.0 / n * ((phase[0] - phase[1]) + (phase[2] - phase[3])),
        .quarter_noise = 4.0 / (n * n) * quarter_bins,
        .half_noise = 1.0 / (n * n) * half_bins,
    };
    const double subtracted = window->keep_noise ? 0.0 : 1.0;
    spectrum.a4 = amplitude(spectrum.quarter_cos * spectrum.quarter_cos +
                                spectrum.quarter_sin * spectrum.quarter_sin,
                            subtracted * spectrum.quarter_noise);
    spectrum.a2 = amplitude(spectrum.half * spectrum.half, subtracted * spectrum.half_noise);
    return spectrum;
}

double neph_flicker_variance(const struct neph_flicker_window *window, const double *sums,
                             bool detrended)
{
    const double n = (double)window->frame_count;
    const double *phase = sums + NEPH_FLICKER_PHASE_0;
    const double sum = (phase[0] + phase[1]) + (phase[2] + phase[3]);
    double scatter = sums[NEPH_FLICKER_SQUARE] - sum * sum / n;
    if (detrended) {
        /* With tau = t - (N - 1) / 2 = 4 (c - (C - 1) / 2) + (t mod 4 - 3 / 2): sums of tau v and
         * of tau^2. */
        const double along = 4.0 * sums[NEPH_FLICKER_TREND] +
                             (1.5 * (phase[3] - phase[0]) + 0.5 * (phase[2] - phase[1]));
        const double slope = compute_trend_slope(window, sums);
        scatter += slope * (slope * n * (n * n - 1.0) / 12.0 - 2.0 * along);
    }
    return fmax(0.0, scatter / n);
}

double neph_flicker_quarter_p(const struct neph_flicker_spectrum *spectrum)
{
    const double power = spectrum->quarter_cos * spectrum->quarter_cos +
                         spectrum->quarter_sin * spectrum->quarter_sin;
    const double whole = power + 4.0 * spectrum->quarter_noise;
    if (!(whole > 0.0))
        return 1.0;
    /* (1 + F / 4)^-4 for F = power / noise, rearranged to avoid a division by zero noise. */
    const double share = 4.0 * spectrum->quarter_noise / whole;
    return (share * share) * (share * share);
}

double neph_flicker_half_p(const struct neph_flicker_spectrum *spectrum)
{
    const double power = spectrum->half * spectrum->half;
    const double whole = power + 4.0 * spectrum->half_noise;
    if (!(whole > 0.0))
        return 1.0;
    /* F with 1 and 4 degrees of freedom is the square of Student's t with 4, whose two-sided tail
     * is 1 - sin a (1 + cos^2 a / 2) with tan a = t / 2 (Abramowitz and Stegun, 26.7.4). With c =
     * cos^2 a = 4 noise / (4 noise + power) and sin a = sqrt(1 - c) this is c^2 (3 + c) / (4 (1 +
     * sin a (1 + c / 2))), which has no cancellation for small c. */
    const double c = 4.0 * spectrum->half_noise / whole;
    return c * c * (3.0 + c) / (4.0 * (1.0 + sqrt(1.0 - c) * (1.0 + 0.5 * c)));
}
