/* SPDX-License-Identifier: MIT
 *
 * Error of an image against a reference, on linear data. The sign is test - reference: a positive
 * bias means that the test is too bright, too clear or too far.
 *
 * With d = test - reference, the samples x of a mask are all its pixels in all colour channels
 * jointly (3 samples a pixel; depth has 1), and S is the mean Rec.709 luminance of the quantity
 * over the *whole* reference frame (depth: the mean over its solid pixels), so that a number does
 * not change its meaning from mask to mask: bias        mean d rel_bias    bias / mean reference
 * over the mask mae         mean |d| rmse        sqrt(mean d^2) rel_rmse    rmse / mean reference
 * over the mask rel_mse     mean d^2 / (reference^2 + (0.01 S)^2); three definitions are in use
 * elsewhere, with absolute epsilons (pbrt, tev) that make dark scenes look perfect max_abs     max
 * |d| max_rel     max |d| / max(|reference|, 1e-4 S) p50 p95 p99 percentiles of |d|: at h = (n - 1)
 * p of the n sorted samples from 0, linear between neighbours (type 7 of Hyndman and Fan, The
 * American Statistician 50, 1996; numpy's default) hit_mismatch  depth only: share of the mask that
 * is solid in one image and sky in the other All other numbers on depth are over the pixels that
 * are solid in both. Sums are compensated and in double. The first six carry a bootstrap interval,
 * see interval.h.
 */
#ifndef NEPH_METRICS_ERROR_H
#define NEPH_METRICS_ERROR_H

#include "metrics/mask.h"
#include "metrics/metric.h"

#define NEPH_ERROR_METRIC_MAX 16

/* The metrics of this file; NULL outside 0..count-1. */
int neph_error_metric_count(void);
const struct neph_metric *neph_error_metric_at(int index);

/* Measure all that applies to the quantity ("radiance", "volume", "transmittance", "depth").
 * A number is undefined, with the reason, when the mask is empty, when the mean it is divided by is
 * not positive, or when a pixel of the mask is not finite in either image: bad pixels are counted
 * and never skipped. (For depth, +inf is the sky and not bad.)
 * Errors: NEPH_ERR_USAGE for an unknown quantity, NEPH_ERR_UNSUPPORTED when an image lacks it,
 * NEPH_ERR_INPUT when sizes differ. */
enum neph_status neph_error_measure(const struct neph_image *reference,
                                    const struct neph_image *test, const char *quantity,
                                    const struct neph_mask *mask,
                                    struct neph_measurement measurements[NEPH_ERROR_METRIC_MAX],
                                    int *count, struct neph_diag *diag);

#endif
