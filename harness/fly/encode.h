/* SPDX-License-Identifier: MIT
 *
 * A fast neph_display_encode() for the window: table-driven, on all processor cores.
 */
#ifndef NEPH_HARNESS_FLY_ENCODE_H
#define NEPH_HARNESS_FLY_ENCODE_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

struct neph_encoder;

/* Free with neph_encoder_destroy(). */
enum neph_status neph_encoder_create(struct neph_encoder **encoder, struct neph_diag *diag);
void neph_encoder_destroy(struct neph_encoder *encoder);

/* Encode linear planes like neph_display_encode() of metrics/display.h, with the sRGB curve
 * itself (IEC 61966-2-1). Near the border of two codes the result may differ by 1:
 * OpenColorIO's linear part is steeper by 2.5e-4, and OpenColorIO converts through XYZ in
 * float32. NEPH_ERR_INTERRUPTED. */
enum neph_status neph_encoder_run(const struct neph_encoder *encoder, const float *const rgb[3],
                                  int width_px, int height_px, double exposure_ev, uint8_t *out_rgb,
                                  struct neph_diag *diag);

#endif
