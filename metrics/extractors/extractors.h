/* SPDX-License-Identifier: MIT
 *
 * The list of extractors, in the order of reports: the one line that a new one needs beside its
 * file.
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

#endif
