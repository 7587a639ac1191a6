/* SPDX-License-Identifier: MIT
 *
 * Writes frames and their differences as PNG files for people (metrics/display.h). A file is
 * complete or absent, as with neph_png_write_rgb8().
 */
#ifndef NEPH_HARNESS_DOCUMENT_DISPLAY_PNG_H
#define NEPH_HARNESS_DOCUMENT_DISPLAY_PNG_H

#include "base/status.h"

/* Write linear RGB planes, exposed by 2^exposure_ev. */
enum neph_status neph_display_png(const char *path, int width_px, int height_px,
                                  const float *const rgb[3], double exposure_ev,
                                  struct neph_diag *diag);

/* Write test - reference in false colours; the colour scale ends at +-`scale`, in the unit of the
 * planes. */
enum neph_status neph_difference_png(const char *path, int width_px, int height_px,
                                     const float *const reference[3], const float *const test[3],
                                     double scale, struct neph_diag *diag);

#endif
