/* SPDX-License-Identifier: MIT
 *
 * How much each frame of a sequence moves: a series over time beside the metrics of flicker, which
 * are one number of all frames. It tells in how many frames one sequence flickers less than
 * another, and whether a difference between two sequences is more than the chance of their frames.
 */
#ifndef NEPH_HARNESS_COMPARE_MOVEMENT_H
#define NEPH_HARNESS_COMPARE_MOVEMENT_H

#include "base/image.h"

enum { NEPH_MOVEMENT_CYCLE = 4 };

/* Over the frames in whole cycles of four; frames behind the last whole cycle have no value. d is
 * the display luma of the test less that of the reference, as of `neph flicker`. Start from {0} and
 * set the gain; free with neph_movement_finish(). */
struct neph_movement {
    double gain; /* display value of the radiance 1 */

    double *frames; /* frame_count values: RMS over the pixels of d less its mean over the cycle */
    double *cycles; /* frame_count / 4 values: RMS over the pixels of the amplitudes of d in the
                       cycle, (a4^2 / 2 + a2^2)^(1/2) */
    int frame_count;

    double *luma[NEPH_MOVEMENT_CYCLE]; /* d of the frames of the cycle at hand */
    size_t pixel_count;
    int kept_count; /* frames in `luma` */
};

/* Add the next frame. Images without radiance add nothing. All frames have the same size.
 * NEPH_ERR_MEMORY. */
enum neph_status neph_movement_add(struct neph_movement *movement,
                                   const struct neph_image *reference,
                                   const struct neph_image *test, struct neph_diag *diag);

/* Free what only the frames to come need. */
void neph_movement_end(struct neph_movement *movement);

void neph_movement_finish(struct neph_movement *movement);

#endif
