/* SPDX-License-Identifier: MIT
 *
 * Frames and their differences as PNG files for people (metrics/display.h). Files are whole or not
 * there, as of neph_png_write_rgb8().
 */
#ifndef NEPH_HARNESS_DOCUMENT_DISPLAY_PNG_H
#define NEPH_HARNESS_DOCUMENT_DISPLAY_PNG_H

#include "base/status.h"

/* Planes of radiance at an exposure. */
enum neph_status neph_display_png(const char *path, int width_px, int height_px,
                                  const float *const rgb[3], double exposure_ev,
                                  struct neph_diag *diag);

/* test - reference; the colours end at `scale`, which is of the planes' unit. */
enum neph_status neph_difference_png(const char *path, int width_px, int height_px,
                                     const float *const reference[3], const float *const test[3],
                                     double scale, struct neph_diag *diag);

#endif
