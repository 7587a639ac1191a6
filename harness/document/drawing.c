/* SPDX-License-Identifier: MIT */
#include "harness/document/drawing.h"

#include "base/files.h"
#include "base/png.h"
#include "metrics/display.h"

#include <stdlib.h>

enum neph_status neph_drawing_write(const struct neph_drawing *drawing, const char *folder,
                                    const char *name, struct neph_diag *diag)
{
    const float *const *rgb = (const float *const *)drawing->rgb, *const *reference =
                                                                      (const float *const *)
                                                                          drawing->reference;
    const size_t count = (size_t)drawing->width_px * (size_t)drawing->height_px;
    uint8_t *codes = malloc(3 * count);
    char *path = neph_path_join(folder, name);
    enum neph_status status = codes && path ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = reference[0] ? neph_display_difference(reference, rgb, 3, count, drawing->scale,
                                                        codes, diag)
                              : neph_display_encode(rgb, count, drawing->exposure_ev, codes, diag);
    if (!status)
        status = neph_png_write_rgb8(path, drawing->width_px, drawing->height_px, codes, diag);
    free(path);
    free(codes);
    return status;
}
