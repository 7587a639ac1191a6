/* SPDX-License-Identifier: MIT
 *
 * Images of stored frames for the page of a nightly run: a single frame, or the baseline's frame,
 * this run's frame and their difference. The file names contain the keys of the frames, so an
 * existing file is up to date. Images are shown at the exposure of their scene.
 */
#ifndef NEPH_HARNESS_NIGHT_PAGE_IMAGES_H
#define NEPH_HARNESS_NIGHT_PAGE_IMAGES_H

#include "base/path.h"
#include "harness/json.h"
#include "harness/run/store.h"

/* Free with _end. */
struct neph_night_images {
    struct neph_store *store; /* borrowed */
    struct neph_path folder;  /* images/ of the page */
    json_t *scenes;           /* owned: {"SCENE": {"title": ..., "exposure_ev": ...}} */
    json_t *counted;          /* owned: names of the images that `bytes` includes */
    size_t limit_bytes, bytes;
    int left_out;
};

enum neph_status neph_night_images_begin(struct neph_night_images *pictures,
                                         struct neph_store *store, const char *page_folder,
                                         size_t limit_bytes, struct neph_diag *diag);
void neph_night_images_end(struct neph_night_images *pictures);

/* Show the frame of a key as {"picture": NAME, "size_px": [W, H]}. JSON null when the store no
 * longer has the frame, when it has no radiance, or when the size limit is reached. `scene` as in
 * the name of a series: "NAME@HASH", "NAME POINT@HASH". */
enum neph_status neph_night_images_one(struct neph_night_images *pictures, const char *scene,
                                       const char *key, json_t **shown, struct neph_diag *diag);

/* Show two frames, one of which may be missing (""): {"accepted": {"picture": ..., "exr": ...} or
 * null, "tonight": ..., "size_px", "exposure_ev", "difference": null or {"picture", "scale",
 * "mean", "changed"}}. JSON null when both are missing.
 *
 * - "scale": the least of 1, 2, 5 times a power of ten that clips at most 1 % of the pixels.
 * - "mean": the mean of |difference of luminance| over the mean luminance of the accepted frame.
 * - "changed": the share of pixels with different bits. */
enum neph_status neph_night_images_pair(struct neph_night_images *pictures, const char *scene,
                                        const char *accepted, const char *tonight, json_t **shown,
                                        struct neph_diag *diag);

#endif
