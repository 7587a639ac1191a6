/* SPDX-License-Identifier: MIT
 *
 * Maps over a picture while it is flown: its error against a reference, and how it flickers at the
 * period of four frames before a camera at rest. `neph compare` and `neph flicker` measure; these
 * show.
 */
#ifndef NEPH_HARNESS_FLY_HEAT_H
#define NEPH_HARNESS_FLY_HEAT_H

#include "base/image.h"
#include "metrics/statistics.h"

#include <stdint.h>

/* `*error` is of all colour channels jointly. The colours of neph_display_difference(), whose
 * scale is `white_share` of what is white at this exposure. `rgb` as there. NEPH_ERR_ENGINE: one
 * of the two has no radiance, or another size. */
enum neph_status neph_heat_error(const struct neph_image *reference, const struct neph_image *test,
                                 double exposure_ev, double white_share,
                                 struct neph_relative_error *error, uint8_t *rgb,
                                 struct neph_diag *diag);

enum { NEPH_HEAT_FRAMES = 64, NEPH_HEAT_FRAMES_MIN = 16 };

/* The display's luma of the last 64 frames, of every pixel or, in large pictures, of every 3rd or
 * 5th, .. of a row and column: an odd step meets all 4 x 4 places of a tile. */
struct neph_heat_flicker;

/* Free with _destroy. */
enum neph_status neph_heat_flicker_create(int width_px, int height_px,
                                          struct neph_heat_flicker **flicker,
                                          struct neph_diag *diag);
void neph_heat_flicker_destroy(struct neph_heat_flicker *flicker);

/* Another view or another exposure: what there was is of no more use. */
void neph_heat_flicker_forget(struct neph_heat_flicker *flicker);

/* The next frame. NEPH_ERR_ENGINE: without radiance, or of another size. */
enum neph_status neph_heat_flicker_add(struct neph_heat_flicker *flicker,
                                       const struct neph_image *frame, double exposure_ev,
                                       struct neph_diag *diag);

struct neph_heat_a4 {
    int frame_count; /* whole cycles of four of those there are, at most 64 */
    double mean;     /* of a4, display white is 1 */
    double share_1;  /* of the pixels looked at, with an a4 above 1/255 */
};

/* Metric flicker.a4 of the frames that there are, by metrics/extractors/flicker_spectrum.h, as a
 * map from black to pale yellow at 16/255. False, and nothing is written: there are fewer than
 * NEPH_HEAT_FRAMES_MIN, or memory is short. */
bool neph_heat_flicker_show(const struct neph_heat_flicker *flicker, struct neph_heat_a4 *a4,
                            uint8_t *rgb);

#endif
