/* SPDX-License-Identifier: MIT
 *
 * Effect of a display chain on the difference between frames and their reference. Both pass through
 * the chain and are compared twice: as light before the tone curve, and on the display.
 */
#ifndef NEPH_HARNESS_STUDY_POST_MEASURE_H
#define NEPH_HARNESS_STUDY_POST_MEASURE_H

#include "metrics/extractor.h"
#include "renderer/post/chain.h"

#include <stdint.h>

struct neph_vulkan;

/* A sequence as light, with its references: one for each frame, or a single one. All borrowed. */
struct neph_post_sequence_pair {
    const struct neph_image *const *tests, *const *references;
    int count, reference_count;
    int warm_up; /* frames at the start that pass through the chain and are not measured */
    double frame_rate_hz;
    uint64_t seed; /* of the film grain */
};

struct neph_post_numbers {
    /* Light before the tone curve, relative to the reference's mean: rms of the error, and of its
     * change from frame to frame. */
    double scene_error, scene_change;
    /* On the display (SDR: 100 cd/m^2, HDR: its peak): FLIP (NaN: not defined for HDR), visible
     * flicker over threshold, share of pixels where most people see it, and rms of the change of
     * luma's error. */
    double flip, seen, seen_share, luma_change;
    double ms; /* of all stages on the device, median over the frames; NaN: no timestamps */
};

/* Measures a chain. The reference passes through it without film grain, so grain counts as noise.
 */
enum neph_status neph_post_measure(struct neph_vulkan *vulkan,
                                   const struct neph_post_sequence_pair *film,
                                   const struct neph_settings *settings,
                                   struct neph_post_numbers *numbers, struct neph_diag *diag);

/* The exposure that auto exposure settles at for a frame, for chains without auto exposure. */
enum neph_status neph_post_meter(struct neph_vulkan *vulkan, const struct neph_image *frame,
                                 double *exposure_ev, struct neph_diag *diag);

/* A chain of the study. A table of chains ends with a NULL name. */
struct neph_post_row {
    const char *name;
    const char *settings; /* applied after the common settings: tone=on, and the exposure of
                             neph_post_meter() for the reference unless the chain has auto exposure
                             */
    bool is_of_whole;     /* a stage is taken out of the whole chain, instead of added to the tone
                             curve */
};
extern const struct neph_post_row neph_post_rows[]; /* the table of `neph study post` */

#endif
