/* SPDX-License-Identifier: MIT
 *
 * What anti-aliasing does to a reference, in two parts: its blur and its aliasing.
 */
#ifndef NEPH_HARNESS_STUDY_BLURRED_H
#define NEPH_HARNESS_STUDY_BLURRED_H

#include "harness/compare/sequence.h"

/* Fits the blur of an anti-aliased sequence: the Gaussian that takes the reference to it with the
 * least squared difference of luminance, over at most eight frames [px]. A reference of one frame
 * is static. NEPH_ERR_INTERNAL: frames without radiance, or sizes differ; NEPH_ERR_IO,
 * NEPH_ERR_MEMORY. */
enum neph_status neph_blurred_fit(const struct neph_sequence *reference,
                                  const struct neph_sequence *sequence, double *sigma_px,
                                  struct neph_diag *diag);

/* Writes two sequences to a folder: `blurred`, the reference with the blur, and `aliased`, the
 * reference with the other differences of the sequence, max(0, sequence - blurred + reference).
 * Free both in any case. Errors as of neph_blurred_fit(). */
enum neph_status neph_blurred_write(const struct neph_sequence *reference,
                                    const struct neph_sequence *sequence, double sigma_px,
                                    const char *folder, struct neph_sequence *blurred,
                                    struct neph_sequence *aliased, struct neph_diag *diag);

#endif
