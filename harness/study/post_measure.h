/* SPDX-License-Identifier: MIT
 *
 * What a picture chain makes of frames and of their reference: both go through it, and are compared
 * before the tone curve, as light, and behind the chain, on the display.
 */
#ifndef NEPH_HARNESS_STUDY_POST_MEASURE_H
#define NEPH_HARNESS_STUDY_POST_MEASURE_H

#include "metrics/extractor.h"
#include "renderer/post/chain.h"

#include <stdint.h>

struct neph_vulkan;

/* Frames as light, and what is true of them: as many, or one for all. All borrowed. */
struct neph_post_film {
    const struct neph_image *const *tests, *const *references;
    int count, reference_count;
    int warm_up; /* frames at the start that the chain sees and nobody measures */
    double frame_rate_hz;
    uint64_t seed; /* of the grain */
};

struct neph_post_numbers {
    /* Light before the tone curve, over the reference's mean: rms of the error, and of what it
     * changes by from frame to frame. */
    double scene_error, scene_change;
    /* On the display, an SDR one of 100 cd/m^2 or an HDR one of its peak: FLIP (NaN: it is not for
     * HDR displays), flicker seen over threshold, the share of pixels where most people see
     * it, and the rms of what luma's error changes by. */
    double flip, seen, seen_share, luma_change;
    double ms; /* of all its stages on the device, the median of the frames; NaN: no clock */
};

/* The reference goes through the chain without grain: that is noise, and counts as such. */
enum neph_status neph_post_measure(struct neph_vulkan *vulkan, const struct neph_post_film *film,
                                   const struct neph_settings *settings,
                                   struct neph_post_numbers *numbers, struct neph_diag *diag);

/* The exposure at which an eye that looks at a frame shows it: for chains without one. */
enum neph_status neph_post_meter(struct neph_vulkan *vulkan, const struct neph_image *frame,
                                 double *exposure_ev, struct neph_diag *diag);

/* A chain of the study; a table of them ends with a NULL name. */
struct neph_post_row {
    const char *name;
    const char *settings; /* on top of what all have: tone=on, and neph_post_meter()'s exposure of
                             the reference, unless the eye of the chain finds one */
    bool is_of_whole;     /* a part is taken out of the whole, not put onto the curve alone */
};
extern const struct neph_post_row neph_post_rows[]; /* of `neph study post` */

#endif
