/* SPDX-License-Identifier: MIT
 *
 * The frames of a comparison in which a number is worst, as images of its page.
 */
#ifndef NEPH_HARNESS_REPORT_COMPARE_FRAMES_H
#define NEPH_HARNESS_REPORT_COMPARE_FRAMES_H

#include "harness/report/compare_shown.h"

/* What is shown of a frame at most; a larger one is cut out around its largest difference. */
enum { NEPH_WORST_WIDTH_PX = 640, NEPH_WORST_HEIGHT_PX = 360, NEPH_WORST_FRAMES = 3 };

/* Draw frame `index` (behind the warm-up) of reference and tests into FOLDER/frames/, with the
 * differences from the reference, or, where there is none, from the frame before. `*frame` as in
 * scripts/report/README.md. */
enum neph_status neph_compare_frame_draw(const struct neph_compare_page *page, const char *folder,
                                         int index, double value, json_t **frame,
                                         struct neph_diag *diag);

#endif
