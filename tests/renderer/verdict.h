/* SPDX-License-Identifier: MIT
 *
 * Comparison of a tracer frame with the reference of each pixel. The mean and variance of the
 * z-scores test the image and its variance estimate; the frame's sum is compared, too.
 */
#ifndef NEPH_TESTS_VERDICT_H
#define NEPH_TESTS_VERDICT_H

#include "tests/renderer/frames.h"

/* Reference of a pixel in column i. */
typedef double truth_of_ray(const struct test_scene *test, const struct neph_pixel_ray *ray, int i,
                            int channel, const void *context);

struct verdict {
    int count; /* of z-scores */
    double z_mean, z_variance;
    double bias, bias_error; /* of the frame's sum, relative */
    double exact_error;      /* relative, of pixels with next to no noise */
};

/* Relative rounding error of a radiance in float32 (a sum of products). A pixel gets a z-score when
 * its standard error is `noisy` times larger, so rounding adds at most 1 / 100 to the variance of
 * the scores. Other pixels must agree within rounding and four standard errors. */
static const double rounding = 2e-6, noisy = 10.0;

static inline struct verdict compare(const struct test_scene *test, const struct neph_image *frame,
                                     truth_of_ray *truth, const void *context)
{
    const struct test_rgb radiance = test_layer(frame, NULL),
                          variance = test_layer(frame, "variance");
    struct verdict v = {0};
    double sum = 0.0, expected_sum = 0.0, variance_sum = 0.0, square_sum = 0.0;
    for (int p = 0; p < frame->width_px * frame->height_px; p++) {
        const int i = p % frame->width_px, channel = (i + p / frame->width_px) % 3;
        const struct neph_pixel_ray ray = test_ray(&test->scene, frame->width_px, frame->height_px,
                                                   p);
        const double expected = truth(test, &ray, i, channel, context);
        const double found = (double)radiance.of[channel][p];
        const double spread = (double)variance.of[channel][p];
        sum += found;
        expected_sum += expected;
        variance_sum += spread;
        if (sqrt(spread) <= noisy * rounding * expected) {
            if (found > 0.0 || expected > 0.0)
                v.exact_error = fmax(v.exact_error,
                                     (fabs(found - expected) - 4.0 * sqrt(spread)) / expected);
            continue;
        }
        const double z = (found - expected) / sqrt(spread);
        v.z_mean += z;
        square_sum += z * z;
        v.count++;
    }
    if (v.count > 0)
        v.z_mean /= v.count;
    v.z_variance = v.count > 1 ? square_sum / v.count - v.z_mean * v.z_mean : 1.0;
    v.bias = sum / expected_sum - 1.0;
    v.bias_error = sqrt(variance_sum) / expected_sum + rounding;
    return v;
}

/* Slack: allowed distance of the scores' mean from 0 and variance from 1, in addition to their own
 * standard errors (1 / sqrt(count) and sqrt(2 / count)), of which four are allowed. */
static inline void judge_with_slack(const char *name, struct verdict v, double mean_slack,
                                    double variance_slack)
{
    print_message("%-22s z: %5d, mean %+.3f, variance %.3f; sum off by %+.1e +- %.1e; exact to "
                  "%.0e\n",
                  name, v.count, v.z_mean, v.z_variance, v.bias, v.bias_error, v.exact_error);
    if (fabs(v.bias) > 4.0 * v.bias_error || v.exact_error > 2.0 * rounding)
        fail_msg("%s is biased", name);
    if (v.count < 20)
        return;
    const double chance = 4.0 / sqrt(v.count);
    if (fabs(v.z_mean) > chance + mean_slack ||
        fabs(v.z_variance - 1.0) > sqrt(2.0) * chance + variance_slack)
        fail_msg("%s: its variance is not what it says", name);
}

/* A score with an estimated variance of n degrees of freedom has the variance n / (n - 2), about 1
 * + 2 / n. */
static inline void judge(const char *name, struct verdict v, double variance_slack)
{
    judge_with_slack(name, v, 0.0, variance_slack);
}

/* Single paths of skewness g shift the scores of n of them by g / (2 sqrt(n)) and widen them by
 * (2 + 7/4 g^2) / n (P. Hall, "The Bootstrap and Edgeworth Expansion", 1992, 2.6). */
static inline void judge_skewed(const char *name, struct verdict v, double skewness, double samples)
{
    judge_with_slack(name, v, 0.5 * skewness / sqrt(samples),
                     (2.0 + 1.75 * skewness * skewness) / samples);
}

static inline double exact_single(const struct test_scene *test, const struct neph_pixel_ray *ray,
                                  int i, int channel, const void *context)
{
    const struct neph_rgb light =
        neph_transport_ray(&test->scene, ray->origin_m, ray->direction).radiance;
    return channel == 0 ? light.r : channel == 1 ? light.g : light.b;
}

#endif
