/* SPDX-License-Identifier: MIT
 *
 * A page to look at frames with, of any renderer: several sets of frames over each other, with
 * their values as they are in the files. Its data are described in scripts/report/README.md.
 */
#ifndef NEPH_HARNESS_REPORT_VIEWER_PAGE_H
#define NEPH_HARNESS_REPORT_VIEWER_PAGE_H

#include "harness/report/viewer.h"

/* What a page holds. */
struct neph_viewer_made {
    int width_px, height_px, frame_count;
    size_t bytes; /* of the floats, as they lie on the disk */
};

/* Write the page into `folder`, which is there and empty. Errors as of reading and comparing
 * frames, before all NEPH_ERR_INPUT: sizes, kinds (linear data beside pictures) or counts differ, a
 * frame has no radiance, or the page would be larger than the limit; NEPH_ERR_USAGE: there is no
 * map of that name. */
enum neph_status neph_viewer_write(const struct neph_viewer *view, const char *folder,
                                   struct neph_viewer_made *made, struct neph_diag *diag);

/* Free the sequences. */
void neph_viewer_finish(struct neph_viewer *view);

#endif
