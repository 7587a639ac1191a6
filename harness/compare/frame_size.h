/* SPDX-License-Identifier: MIT
 *
 * Frame sizes from file headers, so that frames of different sizes are refused before any frame is
 * measured.
 */
#ifndef NEPH_HARNESS_COMPARE_FRAME_SIZE_H
#define NEPH_HARNESS_COMPARE_FRAME_SIZE_H

#include "base/status.h"
#include "harness/compare/sequence.h"

/* Read the size of an OpenEXR or PNG file without its pixels. False: the header is not valid,
 * the data window is smaller than the display window, or the file has several parts; reading the
 * whole file then reports the problem. */
bool neph_frame_size(const char *path, int *width_px, int *height_px);

/* Check that all frames of several sequences have one size. NEPH_ERR_INPUT names two files of
 * different sizes, and both sizes. NEPH_ERR_INTERRUPTED. */
enum neph_status neph_frame_sizes_check(const struct neph_sequence *const *sequences, int count,
                                        struct neph_diag *diag);

#endif
