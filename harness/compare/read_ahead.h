/* SPDX-License-Identifier: MIT
 *
 * Reads the next frames of a comparison on other threads, while the current ones are measured.
 */
#ifndef NEPH_HARNESS_COMPARE_READ_AHEAD_H
#define NEPH_HARNESS_COMPARE_READ_AHEAD_H

#include "harness/compare/frame.h"

struct neph_read_ahead;

/* Read at most `thread_count` >= 1 files at the same time. Free with _destroy.
 * NEPH_ERR_MEMORY. */
enum neph_status neph_read_ahead_create(int thread_count, struct neph_read_ahead **ahead,
                                        struct neph_diag *diag);

/* Waits for files that are being read. NULL is fine. */
void neph_read_ahead_destroy(struct neph_read_ahead *ahead);

/* Start to read a frame, unless that was started already or too many are waiting. Frames of clips
 * are left to _take, as one file is read in its order (clips.h). All pointers are borrowed until
 * the frame is taken. */
void neph_read_ahead_start(struct neph_read_ahead *ahead, const struct neph_frame_source *source,
                           const char *path, const struct neph_frame_choice *choice,
                           size_t negative_allowed);

/* The image of a frame, or the error of reading it; waits for it. The caller owns the image. A
 * frame that was not started is read now. `ahead` NULL: none was. */
enum neph_status neph_read_ahead_take(struct neph_read_ahead *ahead,
                                      const struct neph_frame_source *source, const char *path,
                                      const struct neph_frame_choice *choice,
                                      size_t negative_allowed, struct neph_image **image,
                                      struct neph_diag *diag);

#endif
