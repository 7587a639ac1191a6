/* SPDX-License-Identifier: MIT
 *
 * neph_display_encode() at the pace of a window: by a table, on all processors.
 */
#ifndef NEPH_HARNESS_FLY_ENCODE_H
#define NEPH_HARNESS_FLY_ENCODE_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

struct neph_encoder;

/* Free with _destroy. */
enum neph_status neph_encoder_create(struct neph_encoder **encoder, struct neph_diag *diag);
void neph_encoder_destroy(struct neph_encoder *encoder);

/* As neph_display_encode() of metrics/display.h, by the sRGB curve itself (IEC 61966-2-1). A code
 * differs, by 1, near the border of two: OpenColorIO's straight part is steeper by 2.5e-4, and it
 * goes over XYZ in float32. NEPH_ERR_INTERRUPTED. */
enum neph_status neph_encoder_run(const struct neph_encoder *encoder, const float *const rgb[3],
                                  int width_px, int height_px, double exposure_ev, uint8_t *out_rgb,
                                  struct neph_diag *diag);

#endif
