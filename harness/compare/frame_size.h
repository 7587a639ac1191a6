/* SPDX-License-Identifier: MIT
 *
 * The sizes of frames from the heads of their files: what does not fit is refused before any frame
 * is measured, not after the frames in front of it.
 */
#ifndef NEPH_HARNESS_COMPARE_FRAME_SIZE_H
#define NEPH_HARNESS_COMPARE_FRAME_SIZE_H

#include "base/status.h"
#include "harness/compare/sequence.h"

/* Read the size of an OpenEXR or PNG file without its pixels. False: the file has no such head, or
 * holds a part of its picture; reading the whole file says more. */
bool neph_frame_size(const char *path, int *width_px, int *height_px);

/* Check that all frames of several sequences have one size. NEPH_ERR_INPUT names two files whose
 * sizes differ, and both sizes. NEPH_ERR_INTERRUPTED. */
enum neph_status neph_frame_sizes_check(const struct neph_sequence *const *sequences, int count,
                                        struct neph_diag *diag);

#endif
