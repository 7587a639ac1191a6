/* SPDX-License-Identifier: MIT
 *
 * How each measure of the stress tests is taken: the numbers of metrics/ that it is made of. None
 * is new: flicker and four-frame flicker are those of the flicker study.
 */
#ifndef NEPH_HARNESS_STRESS_MEASURES_H
#define NEPH_HARNESS_STRESS_MEASURES_H

#include "harness/json.h"
#include "metrics/meter.h"
#include "scenes/failing.h"

enum { NEPH_STRESS_NUMBERS = 2, NEPH_STRESS_WHY_SIZE = 160 };

struct neph_stress_measure {
    const char *extractor; /* NULL: counted in the frames themselves */
    /* All of the scene's mask, or of `masks`; the value is made of these in order. */
    const char *metrics[NEPH_STRESS_NUMBERS];
    const char *masks[NEPH_STRESS_NUMBERS]; /* NULL: that of the limit */
    double (*value)(const double numbers[NEPH_STRESS_NUMBERS]);
    bool over_time; /* of a sequence, and not of a frame: it is not measured of engines without
                       history */
};

const struct neph_stress_measure *neph_stress_measure(enum neph_failing_measure measure);

/* Names of the extractors of some limits, NULL-terminated, each once; `over_time` false: without
 * those of measures over time. */
void neph_stress_extractors(const struct neph_failing *failing, bool over_time,
                            const char *names[NEPH_FAILING_MEASURES + 1]);

/* The numbers that some limits are read off, ending with a NULL metric. */
enum { NEPH_STRESS_KEPT_MAX = 16 * NEPH_STRESS_NUMBERS + 1 };
void neph_stress_kept(const struct neph_failing *failing, bool over_time,
                      struct neph_meter_number kept[NEPH_STRESS_KEPT_MAX]);

/* The value of a limit's measure in a take's document; NaN: there is none, and `why` says so. It
 * may be infinite: a lag that never ends. */
double neph_stress_read(const struct neph_failing_limit *limit, const json_t *document,
                        char why[NEPH_STRESS_WHY_SIZE]);

#endif
