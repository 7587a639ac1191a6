/* SPDX-License-Identifier: MIT
 *
 * A captured sequence as the reference of other sequences: its frames as files in a work folder of
 * the store. They are rendered when they are needed, and removed at the end.
 */
#ifndef NEPH_HARNESS_STUDY_IDEAL_H
#define NEPH_HARNESS_STUDY_IDEAL_H

#include "harness/study/reference.h"

/* Start from {0}; free with neph_ideal_finish(). */
struct neph_ideal {
    struct neph_reference reference; /* its key, and once rendered its averaged frames */
    struct neph_scratch *scratch;
};

/* Chooses the sequence by the job of its first frame. The frames of another sequence are removed.
 */
enum neph_status neph_ideal_choose(struct neph_ideal *ideal, const struct neph_job *first,
                                   struct neph_diag *diag);

/* Renders `frame_count` frames of the chosen sequence, unless they are there. Errors of rendering;
 * NEPH_ERR_IO. */
enum neph_status neph_ideal_render(struct neph_ideal *ideal, const struct neph_job *first,
                                   int frame_count, struct neph_store *store,
                                   struct neph_diag *diag);

void neph_ideal_finish(struct neph_ideal *ideal);

#endif
