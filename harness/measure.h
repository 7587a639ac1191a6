/* SPDX-License-Identifier: MIT
 *
 * From two frames to the measurements of a report.
 */
#ifndef NEPH_HARNESS_MEASURE_H
#define NEPH_HARNESS_MEASURE_H

#include "base/image.h"

#include <jansson.h>

/* Measure every quantity that both frames have over every mask that the reference allows, and add
 * one object per number to the array `list` (the form of scripts/report/README.md). Masks without
 * a pixel, or equal to the whole image, are left out. */
enum neph_status neph_measure(const struct neph_image *reference, const struct neph_image *test,
                              json_t *list, struct neph_diag *diag);

/* Counts of non-finite and negative values of a frame, in the same form. */
enum neph_status neph_measure_validity(const struct neph_image *frame, json_t *list,
                                       struct neph_diag *diag);

/* The measurement of that quantity, metric and mask; NULL when there is none. Borrowed. */
const json_t *neph_measurement_find(const json_t *list, const char *quantity, const char *metric,
                                    const char *mask);

#endif
