/* SPDX-License-Identifier: MIT
 *
 * The input of a viewer page, on which frames are shown over each other (`neph view`).
 */
#ifndef NEPH_HARNESS_REPORT_VIEWER_H
#define NEPH_HARNESS_REPORT_VIEWER_H

#include "harness/compare/frame_windows.h"
#include "harness/compare/sequence.h"
#include "metrics/display_cube.h"
#include "metrics/extractor.h"

enum { NEPH_VIEWER_SETS_MAX = 24, NEPH_VIEWER_OVERLAYS_MAX = 16 };

struct neph_viewer_set {
    const char *label;           /* borrowed */
    struct neph_sequence frames; /* a single frame is used for all frames of a sequence */
};

struct neph_viewer {
    const char *title;
    /* the first is the reference of the others */
    struct neph_viewer_set sets[NEPH_VIEWER_SETS_MAX];
    int set_count;                         /* >= 1 */
    struct neph_frame_choice frame_choice; /* part, layer and data window of all frames */
    struct neph_windows windows;           /* of their files */
    struct neph_viewing viewing;           /* initial exposure; the other members are for maps */
    bool own_frame_rate;                   /* use the frame rate that the frames state, if any */
    unsigned quantities;         /* neph_quantity_bit values; 0: all quantities of a set */
    const char *const *overlays; /* names of metric maps (`neph compare --maps`) */
    int overlay_count;
    struct neph_display_choice display; /* in addition to the display's own curve; no config: only
                                           that curve */
    double difference_scale; /* end of the colour scale of radiance; NaN: the metric map's */
    double limit_bytes;      /* limit of the size of all floats of the page */
    int warm_up_frames;      /* left out at the start of sequences */
    bool by_position;        /* frame numbers may differ between sequences */
    bool quiet;              /* print no progress */
};

#endif
