/* SPDX-License-Identifier: MIT
 *
 * Evidence of a verdict on a sequence: images of its worst frame, of a row of pixels over time, of
 * four frames in a row, each beside its reference and their difference. It is made where the frames
 * are, and is an entry of the store under the key of the take, with the map of visible flicker.
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
    const struct neph_sequence *files;      /* the frames */
    const struct neph_image *const *images; /* those of them that are in memory; NULL: none */
    const struct neph_sequence *reference;  /* a frame for all, or one for each; count 0: none */
    int frame_step;                         /* from one to the next in the scene */
    double exposure_ev;
};

/* The frames and the row to show. */
struct neph_evidence {
    int worst_frame;              /* with the largest squared residual; bad values outweigh all */
    int row;                      /* with the largest over all frames */
    int slice_first, slice_count; /* frames of the slice: the worst is one of them; of single
                                     frames, and of frames that do not follow each other, 0 */
    int flip_first, flip_count;   /* frames of the flip-book, as well */
    double scale;                 /* of differences, in radiance: a tenth of the display's white */
};

/* Look through all frames for it. */
enum neph_status neph_evidence_choose(const struct neph_evidence_source *source,
                                      struct neph_evidence *evidence, struct neph_diag *diag);

/* Draw it into files of a folder: worst.png, slice.png, flip_0.png ..., and with a reference
 * X_reference.png of each and X_difference.png but of the flips; flip_reference_0.png alone where
 * one frame is the reference of all. Their names are added to the list. */
enum neph_status neph_evidence_draw(const struct neph_evidence_source *source,
                                    const struct neph_evidence *evidence, const char *folder,
                                    json_t *names, struct neph_diag *diag);

/* ---- in the store ---------------------------------------------------------------------------- */

/* The map's name among the images. */
#define NEPH_EVIDENCE_FLICKER_MAP "seen_contrast_radiance.png"

/* The key of a take's evidence, whose images are shown at an exposure. */
enum neph_status neph_evidence_key(const char *take_key, double exposure_ev,
                                   char key[NEPH_HASH_HEX_SIZE], struct neph_diag *diag);

/* Its folder in the store, for the caller to free, or NULL. The folder has the images that its
 * job.json names in "pictures", beside "frame_step", "worst_frame", "row", "slice_first",
 * "slice_count", "flip_first", "flip_count" and "scale". */
char *neph_evidence_find(struct neph_store *store, const char *key);

/* Make and publish it, as of the engine and device of `job`. Frames with bad values, fewer than
 * what is seen needs, or without a reference have no map. */
enum neph_status neph_evidence_make(struct neph_store *store, const char *key,
                                    const struct neph_job *job,
                                    const struct neph_evidence_source *source,
                                    const struct neph_viewing *viewing, bool with_map,
                                    struct neph_diag *diag);

#endif
