/* SPDX-License-Identifier: MIT
 *
 * The page of `neph view` for frames of any renderer: several sets of frames shown over each other,
 * with the values of the files. scripts/report/README.md describes its data.
 */
#ifndef NEPH_HARNESS_REPORT_VIEWER_PAGE_H
#define NEPH_HARNESS_REPORT_VIEWER_PAGE_H

#include "harness/report/viewer.h"

/* Size of a written page. */
struct neph_viewer_made {
    int width_px, height_px, frame_count;
    size_t bytes; /* of the floats, as stored on disk */
};

/* Write the page into `folder`, which exists and is empty. NEPH_ERR_INPUT: sizes, kinds (linear
 * data and display images) or frame counts differ, a frame has no radiance, or the page would
 * exceed its limit. NEPH_ERR_USAGE: an overlay's name is unknown. Other errors: as for
 * reading and comparing frames. */
enum neph_status neph_viewer_write(const struct neph_viewer *view, const char *folder,
                                   struct neph_viewer_made *made, struct neph_diag *diag);

/* Free the sequences. */
void neph_viewer_finish(struct neph_viewer *view);

#endif
