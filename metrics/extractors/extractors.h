/* SPDX-License-Identifier: MIT
 *
 * The list of extractors, in the order of reports. A new extractor needs its file and one line
 * here.
 */
#ifndef NEPH_METRICS_EXTRACTORS_EXTRACTORS_H
#define NEPH_METRICS_EXTRACTORS_EXTRACTORS_H

#include "metrics/extractor.h"

/* clang-format off */
#define NEPH_EXTRACTORS(of) \
    of(error) \
    of(stops) \
    of(pu21) \
    of(ssim) \
    of(shift) \
    of(two_seed) \
    of(published) \
    of(published_ssim) \
    of(flip) \
    of(flip40) \
    of(hdr_flip) \
    of(flip_alternation) \
    of(residual_change) \
    of(motion) \
    of(lag) \
    of(follow) \
    of(trail) \
    of(ghost) \
    of(flicker) \
    of(cycles) \
    of(seen)
/* clang-format on */

#define NEPH_EXTRACTOR_DECLARED(name) extern const struct neph_extractor neph_extractor_##name;
NEPH_EXTRACTORS(NEPH_EXTRACTOR_DECLARED)
#undef NEPH_EXTRACTOR_DECLARED

/* The number of extractors; the extractor at an index (in the order of reports; NULL outside
 * 0..count-1); an extractor by name (NULL: none). */
int neph_extractor_count(void);
const struct neph_extractor *neph_extractor_at(int index);
const struct neph_extractor *neph_extractor_find(const char *name);

/* Find a metric by name in all extractors; NULL: there is none. `*owner` (if not NULL) receives its
 * extractor. */
const struct neph_metric *neph_metric_find(const char *name, const struct neph_extractor **owner);

#endif
