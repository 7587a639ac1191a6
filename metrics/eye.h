/* SPDX-License-Identifier: MIT
 *
 * The model of the eye for flicker: the sensitivity to a disk of light that is modulated in time,
 * and the visibility of contrasts above the threshold. Independent of images.
 *
 * The shape is elaTCSF (Cai, Bozorgian, Ashraf, Wanat, Mantiuk, elaTCSF: A Temporal Contrast
 * Sensitivity Function for Flicker Detection and Modeling Variable Refresh Rate Flicker, SIGGRAPH
 * Asia 2024), with the spatial fall-off of the pyramid of visibility in Denes and Mantiuk,
 * Predicting visible flicker in temporally changing images, HVEI 2020. The absolute level is a
 * choice, because experiments differ by up to 18 dB in criterion, adaptation and surround. It is
 * the level of De Lange, Research into the dynamic nature of the human fovea-cortex systems, JOSA
 * 48, 1958: a practised observer, a disk of 1 degree radius, 10 to 1000 cd/m2 and up to 30 Hz, the
 * range of a display with 60 frames a second.
 *
 * Sensitivity is 1 / Michelson contrast of a sine at threshold. tests/metrics/test_eye.c compares
 * the model with 380 thresholds of six experiments.
 */
#ifndef NEPH_METRICS_EYE_H
#define NEPH_METRICS_EYE_H

/* elaTCSF exceeds De Lange's sensitivity by this much. A change of 6 dB, as much as the same
 * observers differ between experiments, is a factor of 2 in every contrast. */
#define NEPH_EYE_LEVEL_DB (-4.26)

/* Below this frequency, change counts as drift or lag, not as flicker [Hz]. The experiments begin
 * at 1.5. */
#define NEPH_EYE_FLICKER_HZ 0.5

/* Spatial uncertainty of flicker detection: standard deviation of a Gaussian [deg] (Denes and
 * Mantiuk 2020). */
#define NEPH_EYE_BLUR_DEG 0.36

/* Time constant [s] of the temporal edge filter, h(t) = -sign(t) exp(-|t| / 0.016 s) up to its norm
 * (Ebelin, Denes, Akenine-Moller, Astrom, Oskarsson, McIlhagga, Estimates of Temporal Edge
 * Detection Filters in Human Vision, ACM TAP 2024). */
#define NEPH_EYE_EDGE_S 0.016

/* Sensitivity of elaTCSF to a disk of `radius_deg` with its centre `eccentricity_deg` from the
 * fixation point: (integral of S^3.80022 dA / 6.52801)^(1/3.80022) over the disk. Points 90 degrees
 * and more from the disk's centre do not count; luminances below 0.01 cd/m2 count as 0.01. */
double neph_eye_elatcsf(double frequency_hz, double luminance_cd_per_m2, double eccentricity_deg,
                        double radius_deg);

/* Sensitivity to a fixated disk, at the level of De Lange. */
double neph_eye_sensitivity(double frequency_hz, double luminance_cd_per_m2, double radius_deg);

/* Relative sensitivity to a grating of rho cycles per degree: exp(-0.0242 (rho - 1)), the fall-off
 * of Denes and Mantiuk, from the lowest frequency of their images on: below 1, elaTCSF's disk has
 * its own. */
double neph_eye_spatial(double cycles_per_degree);

/* Probability that flicker is seen, from its contrast R in units of the threshold: 1 - 0.5^(R^2)
 * (Denes and Mantiuk 2020). One half at 1. */
double neph_eye_flicker_probability(double contrast_over_threshold);

/* Probability that a temporal edge is seen, from the response in cd/m2 of the edge filter with a
 * positive part of sum 1: 1 - exp(-0.1008 x^0.9061) (Ebelin et al. 2024; the response to a step is
 * its height). One half at 8.4 cd/m2. */
double neph_eye_pop_probability(double response_cd_per_m2);

#endif
