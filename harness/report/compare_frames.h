/* SPDX-License-Identifier: MIT
 *
 * Images of the frames with the largest errors, for the page of a comparison.
 */
#ifndef NEPH_HARNESS_REPORT_COMPARE_FRAMES_H
#define NEPH_HARNESS_REPORT_COMPARE_FRAMES_H

#include "harness/report/compare_shown.h"

/* Limits of the images; of a larger frame only the part around its largest difference is shown. */
enum { NEPH_WORST_WIDTH_PX = 640, NEPH_WORST_HEIGHT_PX = 360, NEPH_WORST_FRAMES = 3 };

/* Draw frame `index` (counted after the warm-up) of the reference and the tests into
 * FOLDER/frames/, with the differences from the reference; without a reference, from the frame
 * before. `*frame` as in scripts/report/README.md. */
enum neph_status neph_compare_frame_draw(const struct neph_compare_page *page, const char *folder,
                                         int index, double value, json_t **frame,
                                         struct neph_diag *diag);

#endif
