/* SPDX-License-Identifier: MIT
 *
 * Movement of each frame of a sequence: a series over time in addition to the metrics of flicker,
 * which are single numbers of all frames. It shows in how many frames one sequence flickers less
 * than another, and whether a difference between two sequences is significant over time.
 */
#ifndef NEPH_HARNESS_COMPARE_MOVEMENT_H
#define NEPH_HARNESS_COMPARE_MOVEMENT_H

#include "base/image.h"

enum { NEPH_MOVEMENT_CYCLE = 4 };

/* Covers the frames of complete cycles of four; frames after the last complete cycle have no value.
 * d is the display luma of the test minus the reference's, as in `neph flicker`. Start from
 * {0} and set the gain; free with neph_movement_finish(). */
struct neph_movement {
    double gain; /* display value of radiance 1 */

    double *frames; /* frame_count values: RMS over the pixels of d minus its mean over the cycle */
    double *cycles; /* frame_count / 4 values: RMS over the pixels of the amplitudes of d in the
                       cycle, (a4^2 / 2 + a2^2)^(1/2) */
    int frame_count;

    double *luma[NEPH_MOVEMENT_CYCLE]; /* d of the frames of the current cycle */
    size_t pixel_count;
    int kept_count; /* number of frames in `luma` */
};

/* Add the next frame. Frames without radiance are skipped. All frames must have the same size.
 * `luma`: display luma of reference and test, if it is known; NULL: it is computed.
 * NEPH_ERR_MEMORY. */
enum neph_status neph_movement_add(struct neph_movement *movement,
                                   const struct neph_image *reference,
                                   const struct neph_image *test, const double *const luma[2],
                                   struct neph_diag *diag);

/* Free the buffers that are only needed for further frames. */
void neph_movement_end(struct neph_movement *movement);

void neph_movement_finish(struct neph_movement *movement);

#endif
