/* SPDX-License-Identifier: MIT
 *
 * Noise or bias: whether two renders of one scene by Monte Carlo differ by more than the noise of
 * both. Tests of one plane (luminance or a channel), and their combination to one level.
 *
 * Assumed: the noise of pixels is independent, and both renders have independent random numbers.
 * Noise may be skewed, and its variance may come from few samples:
 *
 * - The variance of a pixel that missed a rare bright path is too low, together with its mean. So
 *   for a pixel or tile each variance is at least the variance of the other render, times the ratio
 *   of both over the frame. This is conservative where methods differ by more than that ratio.
 * - With few samples the variance of a pixel is also at least the mean over the 3x3 pixels around
 *   it: all samples of a pixel on an edge may be on one side of it.
 * - A variance counts as many degrees of freedom as its scatter between both renders has
 *   (Satterthwaite, Biometrics Bulletin 2, 1946), at most as many as its repeats have (Welch,
 *   Biometrika 34, 1947). Scores are the normal deviates of Student's t.
 * - Sums of squares are taken over statistics tiles (metrics/interval.h), whose means are closer to
 *   normal, and whose variances are more certain, than those of pixels.
 *
 * Pixels without noise in both renders have no score. Two neighbours that differ by more than
 * rounding, and have no noise around them, are a certain bias.
 */
#ifndef NEPH_METRICS_Z_TEST_H
#define NEPH_METRICS_Z_TEST_H

#include "metrics/z_blob.h"

#define NEPH_Z_LEVEL 0.05 /* of all tests of a pair of renders together */
#define NEPH_Z_POWER 0.80 /* at which the least visible bias is stated */

enum {
    NEPH_Z_PLANES_MAX = 4,
    NEPH_Z_BEYOND_COUNT = 3, /* 2, 3 and 4 standard errors */
    NEPH_Z_REPEATS_MAX = 4096,
};

/* A plane of one render: the mean of its samples, and the variance of this mean. */
struct neph_z_side {
    const double *mean, *variance; /* by pixel; finite, the variance >= 0; borrowed */
    double dof;         /* degrees of freedom of the variance: repeats - 1; 0: not known */
    double correlation; /* variance of the sum of many pixels / sum of their variances: 1 for
                           independent pixels, above 1 with a pixel filter that overlaps */
    double rounding;    /* relative error of a stored value */
};

enum neph_z_kind {
    NEPH_Z_MEAN,  /* Student's t of the mean of the plane */
    NEPH_Z_TILES, /* chi-squared of all tiles */
    NEPH_Z_TILE,  /* the largest score of a tile, by Sidak */
    NEPH_Z_PIXEL, /* the largest score of a pixel, by Sidak */
    NEPH_Z_BLOB,  /* the largest blob of one sign (z_blob.h) */
    NEPH_Z_KIND_COUNT,
};

struct neph_z_result {
    double statistic; /* NaN: not tested */
    double p;         /* of this test; 1: not tested */
    double adjusted;  /* p, corrected for all tests of all planes (neph_z_combine()) */
};

struct neph_z_plane {
    int width_px, height_px, tile_px, tile_count;
    size_t noisy;     /* pixels with a score */
    size_t unjudged;  /* pixels without noise at the border of noise that differ */
    size_t contrary;  /* pixels without noise inside an area without noise that differ */
    size_t identical; /* pixels with noise that are equal bit for bit: a common seed */
    size_t beyond[NEPH_Z_BEYOND_COUNT];
    double expected[NEPH_Z_BEYOND_COUNT]; /* of normal noise */
    size_t rejected;                      /* pixels by Holm at NEPH_Z_LEVEL */
    bool few_carriers;            /* the mean is not tested: one render has less than half of
                                             the samples of the other, and the noise of the mean is
                                             from fewer than eight pixels */
    double neighbour_correlation; /* of the scores of horizontal and vertical neighbours */
    struct neph_z_result tests[NEPH_Z_KIND_COUNT];
    int pixel_px[2], tile_corner_px[2]; /* place of the largest scores; x, y */
    struct neph_z_blob blob;
    double reference_mean, bias, bias_error; /* test - reference, and its standard error */
    double bias_half_width;                  /* of the 95 % interval */
    double bias_dof;
    double tile_noise, pixel_noise; /* medians of the standard errors of the difference */
    /* The least bias found with NEPH_Z_POWER at the part of the level that the test has when no
     * other test rejects; set by neph_z_combine(). */
    double least_mean, least_tile, least_pixel;
};

/* Test a plane. `scores`: NULL, or receives the score of each pixel, NaN where there is none.
 * `seed`: of the permutations. NEPH_ERR_MEMORY. */
enum neph_status neph_z_test(const struct neph_z_side *reference, const struct neph_z_side *test,
                             int width_px, int height_px, uint64_t seed, float *scores,
                             struct neph_z_plane *plane, struct neph_diag *diag);

/* Adjust the p-values of all planes of a pair by Holm's method with weights (S. Holm, Scandinavian
 * Journal of Statistics 6, 1979, section 3), valid for any dependence: the mean of plane 0 has
 * 0.8 of the level, the other tests share the remainder evenly. With normal noise a bias of the
 * mean of three standard errors is so found in 83 % of the cases, with lognormal noise of 8 samples
 * in 80 % (12,000 pairs; random signs of the pixels find 81 %, but with light on one path of ten
 * only 64 %); the extremes lose a tenth of their power in standard errors. Returns the smallest
 * adjusted value; 0 when a pixel is contrary. */
double neph_z_combine(struct neph_z_plane *planes, int count);

/* Mean and variance of the mean of `count` >= 2 repeats of a plane, and the correlation of pixels
 * at most 3 px apart when it is significant; fills `side` but its rounding. NEPH_ERR_MEMORY. */
enum neph_status neph_z_from_repeats(const float *const *repeats, int count, int width_px,
                                     int height_px, double *mean, double *variance,
                                     struct neph_z_side *side, struct neph_diag *diag);

/* The normal deviate with about the two-sided probability of Student's t: D. L. Wallace, Annals of
 * Mathematical Statistics 30, 1959. Error for deviates up to 6: at most 0.01 too large, and too
 * small by at most 0.9 for dof >= 1 (conservative), 0.06 for dof >= 8. */
double neph_z_from_student(double t, double dof);

#endif
