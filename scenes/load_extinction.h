/* SPDX-License-Identifier: MIT
 *
 * The extinction of a medium whose density is in another unit. Private to scenes/.
 */
#ifndef NEPH_SCENES_LOAD_EXTINCTION_H
#define NEPH_SCENES_LOAD_EXTINCTION_H

#include "scenes/load_density.h"

#define NEPH_EXTINCTION_MAX_PER_M 1e4

/* Converts the density into `*extinction_per_m`, the extinction of `medium` (of its only layer),
 * which is complete but for it. `owner`: path of the mapping, from the value being read ("": that
 * value). Refuses extinctions out of range, and optical depths along an infinite or empty line. */
enum neph_status neph_apply_density(const struct neph_reader *reader, const char *owner,
                                    const struct neph_written_density *density,
                                    const struct neph_medium *medium, double *extinction_per_m);

#endif
