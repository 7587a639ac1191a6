/* SPDX-License-Identifier: MIT
 *
 * A captured sequence of a real-time method: rendered, measured against its reference, and kept in
 * the store as measurements and a few images. The frames are not kept: up to 1 GiB of them is in
 * memory, further ones are in files of the work folder. State of the extractors is limited to 1 GiB
 * at a time, or to the need of a single measurement set where that is larger.
 */
#ifndef NEPH_HARNESS_STUDY_TAKE_H
#define NEPH_HARNESS_STUDY_TAKE_H

#include "harness/study/reference.h"
#include "metrics/meter.h"

enum { NEPH_CAPTURE_IMAGES = 4 }; /* images of the last frames */

/* A measurement set: the metrics of one document (comparison.h). Several sets share a pass over the
 * frames. */
struct neph_measurement_set {
    const char *name; /* of the document, unique within the sequence */
    enum neph_reference_rays against;
    const char *const *extractors; /* names, NULL-terminated */
    const char *const *settings;   /* "extractor.key=value", NULL-terminated; NULL: none */
    struct neph_viewing viewing;
    const struct neph_meter_number *kept; /* values that the document keeps, of radiance over all
                                             frames; ends with a NULL metric; NULL: all values */
    int warm_up_frames;                   /* frames at the start that are rendered and not measured
                                             */
    const struct neph_reference *reference; /* NULL: the sequence's; borrowed */
    const char *map; /* of radiance over all frames, to keep as NAME_MAP.exr; NULL: none */
};

/* The frames of a captured sequence, valid during the callback. */
struct neph_capture_frames {
    const char *folder; /* the entry's future folder, with the documents */
    const struct neph_sequence *files;
    const struct neph_image *const *images; /* R G B; NULL: the frame is only in its file */
    size_t bad_values;                      /* over all frames, where they are counted */
};

struct neph_capture;

/* Callback that gets the frames after they are rendered and measured. */
typedef enum neph_status neph_capture_callback(const struct neph_capture *take,
                                               const struct neph_capture_frames *frames,
                                               void *context, struct neph_diag *diag);

/* All pointers are borrowed. */
struct neph_capture {
    struct neph_job job; /* of the first frame */
    int frame_count;
    int frame_step; /* frame increment, for engines without a history; 0: 1 */
    const struct neph_reference *reference;
    const struct neph_measurement_set *readings;
    int reading_count;
    bool with_pictures;          /* keep flip_0.png .. of the last frames */
    bool all_masks;              /* include masks of which a frame has many */
    bool plain;                  /* values without intervals */
    bool allow_frozen_frames;    /* frames equal to the one before are no error */
    neph_capture_callback *look; /* callback for the frames, not part of the key; NULL: none */
    void *callback_context;
    bool counts_bad; /* invalid values are no error: the record counts them in "bad_values", and if
                        there are any, nothing is measured */
};

/* Finds the sequence in the store, or renders, measures and publishes it. `*folder` (to free) is
 * the entry's folder, `*record` (to json_decref) its job.json: "frames", "render_s", "wall_s",
 * "cpu_s", "pictures", the sums "density_evaluations" and "traffic_bytes" over all frames, and
 * "gpu_ms_median" of a frame; null where engine or device have none. Errors of rendering and
 * measuring; NEPH_ERR_GATE for frozen frames. */
enum neph_status neph_capture_run(const struct neph_capture *take, struct neph_store *store,
                                  char **folder, json_t **record, struct neph_diag *diag);

/* Renders a sequence of the store again for its `look` callback. */
enum neph_status neph_capture_replay(const struct neph_capture *take, struct neph_store *store,
                                     struct neph_diag *diag);

/* Whether the sequence is in the store. */
bool neph_capture_is_stored(const struct neph_capture *take, struct neph_store *store);

/* The hash of everything that an entry depends on. */
enum neph_status neph_capture_key(const struct neph_capture *take, char key[NEPH_HASH_HEX_SIZE],
                                  struct neph_diag *diag);

/* The document of a measurement set in an entry's folder, for json_decref(). */
enum neph_status neph_capture_document(const char *folder, const char *reading, json_t **document,
                                       struct neph_diag *diag);

/* A value of radiance in such a document, over all frames where there are several; NULL: none.
 * Borrowed. */
const json_t *neph_capture_find_value(const json_t *document, const char *metric, const char *mask);

/* Whether all frames of a sequence fit into memory, so that neph_capture_replay() provides each of
 * them as an image. */
bool neph_capture_fits_memory(int width_px, int height_px, int frame_count);

#endif
