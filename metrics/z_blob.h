/* SPDX-License-Identifier: MIT
 *
 * The largest connected blob of z-scores of one sign, for metrics/z_test.c.
 */
#ifndef NEPH_METRICS_Z_BLOB_H
#define NEPH_METRICS_Z_BLOB_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* 4-connected pixels with z of one sign beyond 2: those with the largest |sum| / sqrt(pixels). */
struct neph_z_blob {
    size_t pixels;    /* 0: no z is beyond 2 */
    double mean_z;    /* with the sign */
    double statistic; /* sum / sqrt(pixels) */
    double p;         /* 1 without a blob */
    int box_px[4];    /* bounding box: x, y of the first and the last corner */
    int draws;        /* of signs */
};

/* Find the blob in `z` (NaN: none).
 *
 * The p-value is exact for any sizes and places of the z beyond 2, under the null hypothesis for
 * their signs: fair coins when the noise `is_symmetric`, as the difference of two renders with the
 * same noise is; otherwise their order is exchangeable, which keeps the share of positive z, so
 * that skewed noise is no blob. Draws of signs stop after ten that are as large as the blob
 * (J. Besag and P. Clifford, Biometrika 78, 1991). NEPH_ERR_MEMORY. */
enum neph_status neph_z_find_blob(const double *z, int width_px, int height_px, bool is_symmetric,
                                  uint64_t seed, struct neph_z_blob *blob, struct neph_diag *diag);

#endif
