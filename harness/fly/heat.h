/* SPDX-License-Identifier: MIT
 *
 * Error and flicker maps for `neph fly`: the error of a frame against a reference, and the flicker
 * at the period of four frames of a static camera. They are for viewing; `neph compare` and `neph
 * flicker` measure.
 */
#ifndef NEPH_HARNESS_FLY_HEAT_H
#define NEPH_HARNESS_FLY_HEAT_H

#include "base/image.h"
#include "metrics/statistics.h"

#include <stdint.h>

/* Draw the error in the colours of neph_display_difference(); its scale is `white_share` of display
 * white at this exposure. `*error` covers all colour channels jointly. `rgb`: width * height * 3
 * bytes. NEPH_ERR_ENGINE: an image has no radiance, or the sizes differ. */
enum neph_status neph_heat_error(const struct neph_image *reference, const struct neph_image *test,
                                 double exposure_ev, double white_share,
                                 struct neph_relative_error *error, uint8_t *rgb,
                                 struct neph_diag *diag);

enum { NEPH_HEAT_FRAMES = 64, NEPH_HEAT_FRAMES_MIN = 16 };

/* The display luma of the last 64 frames. In large frames only every 3rd, 5th, .. row and column is
 * analysed: an odd step reaches all 4 x 4 positions of a tile. */
struct neph_heat_flicker;

/* Free with neph_heat_flicker_destroy(). */
enum neph_status neph_heat_flicker_create(int width_px, int height_px,
                                          struct neph_heat_flicker **flicker,
                                          struct neph_diag *diag);
void neph_heat_flicker_destroy(struct neph_heat_flicker *flicker);

/* Forget all frames, after a change of view or exposure. */
void neph_heat_flicker_forget(struct neph_heat_flicker *flicker);

/* Add a frame. NEPH_ERR_ENGINE: it has no radiance, or another size. */
enum neph_status neph_heat_flicker_add(struct neph_heat_flicker *flicker,
                                       const struct neph_image *frame, double exposure_ev,
                                       struct neph_diag *diag);

struct neph_heat_a4 {
    int frame_count; /* number of analysed frames: whole cycles of four, at most 64 */
    double mean;     /* mean of a4; display white is 1 */
    double share_1;  /* part of the analysed pixels with a4 above 1/255 */
};

/* Compute metric flicker.a4 of the added frames (metrics/extractors/flicker_spectrum.h) and draw it
 * as a map from black to pale yellow at 16/255. False, with nothing written: fewer than
 * NEPH_HEAT_FRAMES_MIN frames, or memory is short. */
bool neph_heat_flicker_show(const struct neph_heat_flicker *flicker, struct neph_heat_a4 *a4,
                            uint8_t *rgb);

#endif
