/* SPDX-License-Identifier: MIT
 *
 * The tables of the extractors, one file each; listed in extractor.c in the order of reports.
 */
#ifndef NEPH_METRICS_EXTRACTORS_EXTRACTORS_H
#define NEPH_METRICS_EXTRACTORS_EXTRACTORS_H

#include "metrics/extractor.h"

extern const struct neph_extractor neph_extractor_error;
extern const struct neph_extractor neph_extractor_stops;
extern const struct neph_extractor neph_extractor_pu21;
extern const struct neph_extractor neph_extractor_ssim;
extern const struct neph_extractor neph_extractor_shift;
extern const struct neph_extractor neph_extractor_two_seed;
extern const struct neph_extractor neph_extractor_flip;
extern const struct neph_extractor neph_extractor_flip40;
extern const struct neph_extractor neph_extractor_hdr_flip;
extern const struct neph_extractor neph_extractor_flip_alternation;
extern const struct neph_extractor neph_extractor_residual_change;
extern const struct neph_extractor neph_extractor_motion;
extern const struct neph_extractor neph_extractor_lag;
extern const struct neph_extractor neph_extractor_trail;
extern const struct neph_extractor neph_extractor_flicker;

#endif
