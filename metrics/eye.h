/* SPDX-License-Identifier: MIT
 *
 * The eye that flicker is held against: how sensitive a person is to a disk of light that is
 * modulated in time, and what a contrast above the threshold means. Knows no picture.
 *
 * The shape is elaTCSF (Cai, Bozorgian, Ashraf, Wanat, Mantiuk, elaTCSF: A Temporal Contrast
 * Sensitivity Function for Flicker Detection and Modeling Variable Refresh Rate Flicker, SIGGRAPH
 * Asia 2024) with the fall over spatial frequency of the pyramid of visibility in Denes and
 * Mantiuk, Predicting visible flicker in temporally changing images, HVEI 2020. The level is a
 * choice, because experiments differ among themselves by up to 18 dB in criterion, adaptation and
 * surround. It is that of De Lange, Research into the dynamic nature of the human fovea-cortex
 * systems, JOSA 48, 1958: a practised observer looks at a disk of 1 degree radius, at 10 to 1000
 * cd/m2 and up to 30 Hz, which is what a display of 60 frames a second shows.
 *
 * Sensitivity is 1 / the Michelson contrast of a sine at threshold. What that is worth against 380
 * thresholds of six experiments is measured in tests/metrics/test_eye.c.
 */
#ifndef NEPH_METRICS_EYE_H
#define NEPH_METRICS_EYE_H

/* elaTCSF lies above De Lange's thresholds by this much. A change of 6 dB, as much as the same
 * observers differ from one experiment to the next, is a factor of 2 in every contrast. */
#define NEPH_EYE_LEVEL_DB (-4.26)

/* Below, a change is drift or lag and no flicker [Hz]. The experiments begin at 1.5. */
#define NEPH_EYE_FLICKER_HZ 0.5

/* Where in its neighbourhood flicker is, a person cannot say: standard deviation of the Gaussian
 * [deg] (Denes and Mantiuk 2020). */
#define NEPH_EYE_BLUR_DEG 0.36

/* Time constant [s] of the edge filter in time, h(t) = -sign(t) exp(-|t| / 0.016 s) up to its norm
 * (Ebelin, Denes, Akenine-Moller, Astrom, Oskarsson, McIlhagga, Estimates of Temporal Edge
 * Detection Filters in Human Vision, ACM TAP 2024). */
#define NEPH_EYE_EDGE_S 0.016

/* Sensitivity to a disk of `radius_deg` whose centre is `eccentricity_deg` from the point of gaze,
 * as elaTCSF has it: (integral of S^3.80022 dA / 6.52801)^(1/3.80022) over the disk. What lies 90
 * degrees and more from its centre is out of sight; below 0.01 cd/m2 is as at 0.01. */
double neph_eye_elatcsf(double frequency_hz, double luminance_cd_per_m2, double eccentricity_deg,
                        double radius_deg);

/* Sensitivity to a disk that is looked at, at the level of De Lange. */
double neph_eye_sensitivity(double frequency_hz, double luminance_cd_per_m2, double radius_deg);

/* What of it is left for a grating of rho cycles per degree: exp(-0.0242 (rho - 1)), Denes and
 * Mantiuk's fall, from where their pictures begin: below 1 the disk of elaTCSF has its own. */
double neph_eye_spatial(double cycles_per_degree);

/* Probability that flicker is seen, by its contrast in units of the threshold: 1 - 0.5^(R^2)
 * (Denes and Mantiuk 2020). One half at 1. */
double neph_eye_seen(double contrast_over_threshold);

/* Probability that an edge in time is seen, by the response of the edge filter whose positive part
 * sums to 1, in cd/m2: 1 - exp(-0.1008 x^0.9061) (Ebelin et al. 2024; a step has its height for
 * response). One half at 8.4 cd/m2. */
double neph_eye_pop_seen(double response_cd_per_m2);

#endif
