/* SPDX-License-Identifier: MIT */
#include "harness/document/display_png.h"

#include "base/png.h"
#include "metrics/display.h"

#include <stdlib.h>

enum neph_status neph_display_png(const char *path, int width_px, int height_px,
                                  const float *const rgb[3], double exposure_ev,
                                  struct neph_diag *diag)
{
    const size_t count = (size_t)width_px * (size_t)height_px;
    uint8_t *bytes = malloc(3 * count);
    enum neph_status status = bytes ? neph_display_encode(rgb, count, exposure_ev, bytes, diag)
                                    : neph_fail_memory(diag);
    if (!status)
        status = neph_png_write_rgb8(path, width_px, height_px, bytes, diag);
    free(bytes);
    return status;
}

enum neph_status neph_difference_png(const char *path, int width_px, int height_px,
                                     const float *const reference[3], const float *const test[3],
                                     double scale, struct neph_diag *diag)
{
    const size_t count = (size_t)width_px * (size_t)height_px;
    uint8_t *bytes = malloc(3 * count);
    enum neph_status status = bytes ? neph_display_difference(reference, test, 3, count, scale,
                                                              bytes, diag)
                                    : neph_fail_memory(diag);
    if (!status)
        status = neph_png_write_rgb8(path, width_px, height_px, bytes, diag);
    free(bytes);
    return status;
}
