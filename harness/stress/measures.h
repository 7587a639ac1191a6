/* SPDX-License-Identifier: MIT
 *
 * The measures of the stress tests in terms of the metrics in metrics/. Flicker and four-frame
 * flicker are defined as in the flicker study.
 */
#ifndef NEPH_HARNESS_STRESS_MEASURES_H
#define NEPH_HARNESS_STRESS_MEASURES_H

#include "harness/json.h"
#include "metrics/meter.h"
#include "scenes/failing.h"

enum { NEPH_STRESS_NUMBERS = 2, NEPH_STRESS_WHY_SIZE = 160 };

struct neph_stress_measure {
    const char *extractor; /* NULL: counted in the frames directly */
    /* The metrics, over the limit's mask or `masks`; value() gets them in this order. */
    const char *metrics[NEPH_STRESS_NUMBERS];
    const char *masks[NEPH_STRESS_NUMBERS]; /* NULL: the limit's mask */
    double (*value)(const double numbers[NEPH_STRESS_NUMBERS]);
    bool over_time; /* needs a sequence: not measured for engines without a history */
};

/* The definition of a measure. */
const struct neph_stress_measure *neph_stress_measure(enum neph_failing_measure measure);

/* Lists the extractors that some limits need, each once, NULL-terminated. `over_time` false:
 * without measures over time. */
void neph_stress_extractors(const struct neph_failing *failing, bool over_time,
                            const char *names[NEPH_FAILING_MEASURES + 1]);

/* Lists the metrics that some limits need; ends with a NULL metric. */
enum { NEPH_STRESS_METRICS_MAX = 16 * NEPH_STRESS_NUMBERS + 1 };
void neph_stress_list_metrics(const struct neph_failing *failing, bool over_time,
                              struct neph_meter_number kept[NEPH_STRESS_METRICS_MAX]);

/* The value of a limit's measure in a sequence's document; NaN: none, and `why` has the reason.
 * Infinite for a lag that never ends. */
double neph_stress_read(const struct neph_failing_limit *limit, const json_t *document,
                        char why[NEPH_STRESS_WHY_SIZE]);

#endif
