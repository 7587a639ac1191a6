/* SPDX-License-Identifier: MIT
 *
 * A take: a sequence of a shortcut, rendered, measured against its reference, and kept in the store
 * as numbers and a few pictures. Its frames are not kept: they are in memory until they are
 * measured, up to 1 GiB, and in files of the store's folder of work beyond. What is measured keeps
 * up to 1 GiB at a time too, or what a single reading has to keep if that is more.
 */
#ifndef NEPH_HARNESS_STUDY_TAKE_H
#define NEPH_HARNESS_STUDY_TAKE_H

#include "harness/study/reference.h"
#include "metrics/meter.h"

enum { NEPH_TAKE_PICTURES = 4 }; /* of the last frames */

/* What is measured of the frames for one document (comparison.h); several share a pass. */
struct neph_reading {
    const char *name; /* of the document, unique in the take */
    enum neph_reference_rays against;
    const char *const *extractors; /* names, NULL-terminated */
    const char *const *settings;   /* "extractor.key=value", NULL-terminated; NULL: none */
    struct neph_viewing viewing;
    const struct neph_meter_number *kept; /* all that the document keeps, of radiance over all
                                             frames; ends with a NULL metric. NULL: it keeps
                                             everything */
    int warm_up_frames;                   /* at the start, that are rendered and not looked at */
};

/* The frames of a take while they are there. */
struct neph_take_frames {
    const char *folder; /* that becomes the entry's: documents of readings are in it */
    const struct neph_sequence *files;
    const struct neph_image *const *images; /* R G B; NULL for one that is in its file alone */
    size_t bad_values;                      /* of all, where they are counted */
};

struct neph_take;

/* Whoever wants to see them. */
typedef enum neph_status neph_take_look(const struct neph_take *take,
                                        const struct neph_take_frames *frames, void *context,
                                        struct neph_diag *diag);

/* All pointers are borrowed. */
struct neph_take {
    struct neph_job job; /* of the first frame */
    int frame_count;
    int frame_step; /* from one to the next, for engines that remember nothing; 0: 1 */
    const struct neph_reference *reference;
    const struct neph_reading *readings;
    int reading_count;
    bool with_pictures;   /* keep flip_0.png .. of the last frames */
    const char *map_file; /* the picture to keep of the first reading's maps: "a4_radiance.png";
                             NULL: none */
    bool all_masks;       /* also those of which there are many */
    bool plain;           /* numbers without intervals */
    bool frozen_is_fine;  /* frames equal to the one before are no reason to fail */
    neph_take_look
        *look; /* sees the frames when they are rendered and measured; no part of the key.
                             NULL: nobody */
    void *look_context;
    bool counts_bad; /* values that no engine may hand over are no error: the record counts them in
                        "bad_values", and where there are any nothing is measured */
};

/* Take it from the store, or render, measure and publish it. `*folder` (to free) is the entry's,
 * `*record` (to json_decref) its job.json: "frames", "render_s", "wall_s", "cpu_s", "pictures", and
 * null where the engine or the device has none, "density_evaluations" and "traffic_bytes" of all
 * frames, and "gpu_ms_median" of one.
 * Errors: those of rendering and measuring; NEPH_ERR_GATE for frozen frames. */
enum neph_status neph_take_run(const struct neph_take *take, struct neph_store *store,
                               char **folder, json_t **record, struct neph_diag *diag);

/* Have the take's `look` see the frames of a take that is in the store, rendered once more. */
enum neph_status neph_take_see(const struct neph_take *take, struct neph_store *store,
                               struct neph_diag *diag);

/* The hash of all that an entry depends on. */
enum neph_status neph_take_key(const struct neph_take *take, char key[NEPH_HASH_HEX_SIZE],
                               struct neph_diag *diag);

/* The document of a reading in an entry's folder, for the caller to json_decref. */
enum neph_status neph_take_document(const char *folder, const char *reading, json_t **document,
                                    struct neph_diag *diag);

/* A number of radiance in such a document: of all frames, where there are several. NULL when it is
 * not there; borrowed. */
const json_t *neph_take_find(const json_t *document, const char *metric, const char *mask);

/* Whether all frames of a take are kept in memory, so that neph_take_see() shows each of them. */
bool neph_take_fits(int width_px, int height_px, int frame_count);

#endif
