/* SPDX-License-Identifier: MIT
 *
 * Images as evidence of a verdict on a sequence: the worst frame, a row of pixels over time
 * (slice), and four consecutive frames (flip-book), with their references and differences. The
 * images are made where the frames are in memory, and published as a store entry under the
 * sequence's key, with a map of visible flicker.
 */
#ifndef NEPH_HARNESS_STRESS_EVIDENCE_H
#define NEPH_HARNESS_STRESS_EVIDENCE_H

#include "base/image.h"
#include "harness/compare/sequence.h"
#include "harness/json.h"
#include "harness/run/job.h"
#include "harness/run/store.h"
#include "metrics/meter.h"

enum { NEPH_EVIDENCE_SLICE = 64, NEPH_EVIDENCE_FLIPS = 4 };

/* All pointers are borrowed. */
struct neph_evidence_source {
    const struct neph_sequence *files;      /* files of the frames */
    const struct neph_image *const *images; /* frames that are in memory; NULL: none */
    const struct neph_sequence *reference;  /* one frame for all, or one for each; count 0: none */
    int frame_step;                         /* frame increment within the scene */
    double exposure_ev;
};

/* The frames and the row that are drawn. */
struct neph_evidence {
    int worst_frame;              /* frame with the largest squared residual; invalid values
                                     outweigh all others */
    int row;                      /* row with the largest squared residual over all frames */
    int slice_first, slice_count; /* frames of the slice, including the worst; 0 for single frames
                                     and for non-consecutive frames */
    int flip_first, flip_count;   /* frames of the flip-book; 0 likewise */
    double scale;                 /* full scale of the differences, in radiance: a tenth of the
                                     display's white */
};

/* Selects frames and row in one pass over all frames. */
enum neph_status neph_evidence_choose(const struct neph_evidence_source *source,
                                      struct neph_evidence *evidence, struct neph_diag *diag);

/* Draws PNG files into a folder and appends their names to `names`: worst.png, slice.png,
 * flip_0.png, ... With a reference also X_reference.png for each of them, and X_difference.png
 * except for the flip-book. Where one frame is the reference of all, the flip-book has
 * flip_reference_0.png only. */
enum neph_status neph_evidence_draw(const struct neph_evidence_source *source,
                                    const struct neph_evidence *evidence, const char *folder,
                                    json_t *names, struct neph_diag *diag);

/* ---- in the store ---------------------------------------------------------------------------- */

/* Name of the map's file. */
#define NEPH_EVIDENCE_FLICKER_MAP "seen_contrast_radiance.png"

/* The store key of a sequence's evidence, whose images are displayed with an exposure. */
enum neph_status neph_evidence_key(const char *take_key, double exposure_ev,
                                   char key[NEPH_HASH_HEX_SIZE], struct neph_diag *diag);

/* The folder of the evidence in the store, for free(); NULL: none. Its job.json lists the images in
 * "pictures" and has "frame_step", "worst_frame", "row", "slice_first", "slice_count",
 * "flip_first", "flip_count" and "scale". */
char *neph_evidence_find(struct neph_store *store, const char *key);

/* Draws and publishes the evidence, with the engine and device of `job` in the record. There is no
 * map unless `with_map`, nor without a reference or with fewer frames than the metric needs. */
enum neph_status neph_evidence_make(struct neph_store *store, const char *key,
                                    const struct neph_job *job,
                                    const struct neph_evidence_source *source,
                                    const struct neph_viewing *viewing, bool with_map,
                                    struct neph_diag *diag);

#endif
