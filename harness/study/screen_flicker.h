/* SPDX-License-Identifier: MIT
 *
 * Pictures of a screen one after the other, against the truth of each: what is off, and what of it
 * changes from frame to frame, as light and as a display shows it.
 */
#ifndef NEPH_HARNESS_STUDY_SCREEN_FLICKER_H
#define NEPH_HARNESS_STUDY_SCREEN_FLICKER_H

#include "harness/run/job.h"
#include "harness/study/post_measure.h"

struct neph_vulkan;

/* The truth of `count` frames, from the scene's first on. */
struct neph_screen_truths {
    struct neph_image **frames; /* owned; one, where the scene stands still */
    int count, frame_count;     /* of the sequence; of the images */
};

/* How many of these frames the scene has, and how many of them differ. */
void neph_screen_frames(const struct neph_scene *scene, int asked,
                        struct neph_screen_truths *truths);

void neph_screen_truths_finish(struct neph_screen_truths *truths);

/* Render the job's scene as a sequence and measure it, shown by Unreal's curve at the exposure that
 * an eye finds for the truth. */
enum neph_status neph_screen_flicker(struct neph_vulkan *vulkan, const struct neph_job *job,
                                     const struct neph_screen_truths *truths,
                                     struct neph_post_numbers *numbers, struct neph_diag *diag);

#endif
