/* SPDX-License-Identifier: MIT
 *
 * The direction of a metric: whether smaller or larger values are better.
 */
#ifndef NEPH_HARNESS_COMPARE_DIRECTION_H
#define NEPH_HARNESS_COMPARE_DIRECTION_H

#include "metrics/metric.h"

enum neph_direction {
    NEPH_NO_DIRECTION, /* such as a gain that should be 1 */
    NEPH_SMALLER_IS_BETTER,
    NEPH_LARGER_IS_BETTER,
    NEPH_DIRECTION_COUNT,
};

enum neph_direction neph_metric_direction(const struct neph_metric *metric);

#endif
