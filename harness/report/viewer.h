/* SPDX-License-Identifier: MIT
 *
 * What a page to look at frames with is made of.
 */
#ifndef NEPH_HARNESS_REPORT_VIEWER_H
#define NEPH_HARNESS_REPORT_VIEWER_H

#include "harness/compare/sequence.h"
#include "metrics/display_cube.h"
#include "metrics/extractor.h"

enum { NEPH_VIEWER_SETS_MAX = 24, NEPH_VIEWER_OVERLAYS_MAX = 16 };

struct neph_viewer_set {
    const char *label;           /* borrowed */
    struct neph_sequence frames; /* a still stands for all frames of a sequence */
};

struct neph_viewer {
    const char *title;
    struct neph_viewer_set
        sets[NEPH_VIEWER_SETS_MAX]; /* the first is what others are held against */
    int set_count;                  /* >= 1 */
    const char *layer;           /* whose channels are R G B Z ...; NULL: names are as they are */
    struct neph_viewing viewing; /* the exposure at first; the rest is for the maps */
    bool own_frame_rate;         /* the rate is what frames say, where they do */
    unsigned quantities;         /* neph_quantity_bit: these alone; 0: all that a set has */
    const char *const *overlays; /* names of maps of the metrics (`neph compare --maps`) */
    int overlay_count;
    struct neph_display_choice display; /* beside the display's own curve; no config: that alone */
    double difference_scale; /* of radiance, where the colours end; NaN: as of the metrics' map */
    double limit_bytes;      /* of all the page's floats */
    int warm_up_frames;      /* at the start of the sequences, left out */
    bool by_position;        /* numbers of frames need not agree */
    bool quiet;              /* no progress */
};

#endif
