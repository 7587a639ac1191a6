/* SPDX-License-Identifier: MIT
 *
 * References that are made from a captured sequence: its frames as files in a work folder of the
 * store. They are rendered when they are needed, and removed at the end.
 */
#ifndef NEPH_HARNESS_STUDY_IDEAL_H
#define NEPH_HARNESS_STUDY_IDEAL_H

#include "harness/study/take.h"

/* With the reference R and the sequence I; B is R with the blur of I (blurred.h). */
enum neph_ideal_kind {
    NEPH_IDEAL_SEQUENCE, /* I */
    NEPH_IDEAL_BLURRED,  /* B */
    NEPH_IDEAL_ALIASED,  /* I - B + R */
    NEPH_IDEALS,
};

/* Start from {0}; free with neph_ideal_finish(). */
struct neph_ideal {
    struct neph_reference references[NEPH_IDEALS]; /* the key of I, and once rendered averaged
                                                      frames */
    double blur_px;                                /* once rendered */
    struct neph_scratch *scratch;
};

/* Chooses the sequence by the job of its first frame. The frames of another sequence are removed.
 */
enum neph_status neph_ideal_choose(struct neph_ideal *ideal, const struct neph_job *first,
                                   struct neph_diag *diag);

/* Renders `frame_count` frames of the chosen sequence, and makes the others from them and the
 * reference, unless they are there. Errors of rendering; NEPH_ERR_IO. */
enum neph_status neph_ideal_render(struct neph_ideal *ideal, const struct neph_job *first,
                                   const struct neph_sequence *reference, int frame_count,
                                   struct neph_store *store, struct neph_diag *diag);

/* A callback of captures that keeps the blur of the ideal, their context, in their folder. */
neph_capture_callback neph_ideal_keep_blur;

/* The blur in the folder of such a sequence [px]. */
enum neph_status neph_ideal_read_blur(const char *folder, double *blur_px, struct neph_diag *diag);

void neph_ideal_finish(struct neph_ideal *ideal);

#endif
