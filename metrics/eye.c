/* SPDX-License-Identifier: MIT */
#include "metrics/eye.h"

#include <math.h>

/* Constants of elaTCSF, from the paper. */
static const double summation = 3.80022, threshold_energy = 6.52801;

/* Lower limit of the luminance: below all displays and all experiments; the model itself ends at
 * 0.001. */
static const double darkest_cd_per_m2 = 0.01;

static const double field_deg = 90.0;

struct complex {
    double re, im;
};

static struct complex times(struct complex a, struct complex b)
{
    return (struct complex){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

/* 1 / (1 + i x) */
static struct complex low_pass(double x)
{
    const double scale = 1.0 / (1.0 + x * x);
    return (struct complex){scale, -x * scale};
}

/* The difference of two cascades of low-pass filters, with 15 and 16 stages. */
static double temporal_response(double frequency_hz)
{
    const double tau_s = 0.00292069, kappa = 2.12547, zeta = 0.721095, xi = 154.133;
    const double x = 2.0 * M_PI * frequency_hz * tau_s;
    const struct complex a = low_pass(x), a2 = times(a, a), a4 = times(a2, a2), a8 = times(a4, a4);
    const struct complex b = low_pass(kappa * x), b2 = times(b, b), b4 = times(b2, b2);
    const struct complex b8 = times(b4, b4), b16 = times(b8, b8);
    const struct complex a15 = times(times(a, a2), times(a4, a8));
    return xi * hypot(a15.re - zeta * b16.re, a15.im - zeta * b16.im);
}

/* Sensitivity at a point `eccentricity_deg` from the fixation point, without the luminance
 * factor. */
static double point_sensitivity(double frequency_hz, double log_luminance, double eccentricity_deg)
{
    const double peripheral_hz = (frequency_hz + 2.0) / (1.0 + 0.0341811 * eccentricity_deg) - 2.0;
    return pow(10.0, -0.0330933 * eccentricity_deg) *
           temporal_response(peripheral_hz / (0.6678 + 0.222269 * log_luminance));
}

static double luminance_factor(double luminance_cd_per_m2)
{
    return 1.76801 * pow(1.0 + 1.62402 / luminance_cd_per_m2, -0.533781);
}

/* Mean of S^beta over a ring of the disk. */
static double ring_mean(double frequency_hz, double log_luminance, double eccentricity_deg,
                        double radius_deg)
{
    enum { ANGLES = 32 };
    const int angles = eccentricity_deg > 0.0 ? ANGLES : 1;
    double sum = 0.0;
    for (int k = 0; k < angles; k++) {
        const double x = eccentricity_deg + radius_deg * cos(M_PI * (k + 0.5) / angles);
        const double y = radius_deg * sin(M_PI * (k + 0.5) / angles);
        sum += pow(point_sensitivity(frequency_hz, log_luminance, hypot(x, y)), summation);
    }
    return sum / angles;
}

/* Gauss-Legendre quadrature, eight points per ten degrees of the radius. */
double neph_eye_elatcsf(double frequency_hz, double luminance_cd_per_m2, double eccentricity_deg,
                        double radius_deg)
{
    static const double nodes[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                    0.9602898564975363};
    static const double weights[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                      0.1012285362903763};
    const double luminance = fmax(luminance_cd_per_m2, darkest_cd_per_m2);
    const double log_luminance = log10(luminance), end_deg = fmin(radius_deg, field_deg);
    const int panels = 1 + (int)(end_deg / 10.0);
    const double half_deg = 0.5 * end_deg / panels;
    double integral = 0.0;
    for (int k = 0; k < 8 * panels; k++) {
        const int node = k % 4, side = k / 4 % 2;
        const double centre_deg = (2 * (k / 8) + 1) * half_deg;
        const double r_deg = centre_deg + (side ? half_deg : -half_deg) * nodes[node];
        integral += weights[node] * half_deg * 2.0 * M_PI * r_deg *
                    ring_mean(frequency_hz, log_luminance, eccentricity_deg, r_deg);
    }
    return luminance_factor(luminance) * pow(integral / threshold_energy, 1.0 / summation);
}

double neph_eye_sensitivity(double frequency_hz, double luminance_cd_per_m2, double radius_deg)
{
    return pow(10.0, NEPH_EYE_LEVEL_DB / 20.0) *
           neph_eye_elatcsf(frequency_hz, luminance_cd_per_m2, 0.0, radius_deg);
}

double neph_eye_spatial(double cycles_per_degree)
{
    return exp(-0.0242 * fmax(cycles_per_degree - 1.0, 0.0));
}

double neph_eye_flicker_probability(double contrast_over_threshold)
{
    return -expm1(-M_LN2 * contrast_over_threshold * contrast_over_threshold);
}

double neph_eye_pop_probability(double response_cd_per_m2)
{
    return -expm1(-0.1008 * pow(response_cd_per_m2, 0.9061));
}
