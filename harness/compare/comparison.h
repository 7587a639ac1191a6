/* SPDX-License-Identifier: MIT
 *
 * Frames of any renderer held against reference frames: what `neph compare` and `neph flicker` do.
 */
#ifndef NEPH_HARNESS_COMPARE_COMPARISON_H
#define NEPH_HARNESS_COMPARE_COMPARISON_H

#include "harness/compare/measure.h"
#include "harness/compare/sequence.h"

struct neph_comparison {
    struct neph_sequence reference; /* one frame for all, or as many as the test has */
    struct neph_sequence second;    /* the reference by another seed; empty: there is none */
    struct neph_sequence test;
    struct neph_meter_choice choices[NEPH_CHOICES_MAX];
    int choice_count;
    struct neph_viewing viewing;
    bool own_frame_rate;   /* the rate is that of the test's frames, where they tell it */
    const char *mask;      /* the one that has to be there; NULL: any */
    const char *layer;     /* whose channels are R G B Z ...; NULL: names are as they are */
    const char *mask_file; /* a picture that is above 0.5 inside a mask of the user's; or NULL */
    bool detail_masks;     /* also the rings at depth edges */
    const char *maps_directory; /* for the maps of the extractors; or NULL */
    int warm_up_frames;         /* at the start of the sequences: read by nobody */
    size_t negative_allowed;    /* values below 0 that a frame may hold */
    bool by_position;           /* numbers of frames need not agree */
    bool frozen_is_fine;        /* frames equal to the one before are no reason to fail */
    bool plain;                 /* numbers without intervals, which cost as much again */
    bool quiet;                 /* no progress */
};

/* Measure. `drawn` (may be NULL) receives the measurements of the document in its order, with their
 * draws (metrics/metric.h), once it is given. `*document` is an object of
 *   "version"       of neph
 *   "reference", "test"  {"first": its file (the warm-up included), "count": of all}
 *   "warm_up_frames"
 *   "frames"        how many were measured
 *   "frozen"        how many of them are bit for bit the frame before
 *   "interrupted"   whether Ctrl-C cut it short: what is there is of the frames before
 *   "measurements"  array of objects as neph_measurement_json(), by frame and then of all frames
 *   "findings"      verdicts, see harness/compare/findings.h
 *   "not_taken"     array of {"extractor", "quantity", "because"}
 *   "maps"          array of file names
 * and is given (and owned by the caller) on success, and with NEPH_ERR_INTERRUPTED and
 * NEPH_ERR_GATE (frozen frames) too; else NULL. Errors: NEPH_ERR_GATE when a frame holds values
 * that are not finite or negative, with the file; NEPH_ERR_INPUT when sizes, counts or kinds
 * (linear data against pictures) differ. */
enum neph_status neph_comparison_run(const struct neph_comparison *comparison, json_t **document,
                                     struct neph_measurements *drawn, struct neph_diag *diag);

/* Free the sequences; a zeroed comparison is fine. */
void neph_comparison_finish(struct neph_comparison *comparison);

#endif
