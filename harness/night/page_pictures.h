/* SPDX-License-Identifier: MIT
 *
 * Pictures of stored frames for the page of a night: a frame alone, or that of the accepted night,
 * tonight's and their difference. They are named by the keys of their frames, so that what is there
 * is right, and drawn at the exposure of their scene.
 */
#ifndef NEPH_HARNESS_NIGHT_PAGE_PICTURES_H
#define NEPH_HARNESS_NIGHT_PAGE_PICTURES_H

#include "base/path.h"
#include "harness/json.h"
#include "harness/run/store.h"

/* Free with _end. */
struct neph_night_pictures {
    struct neph_store *store; /* borrowed */
    struct neph_path folder;  /* images/ of the page */
    json_t *scenes;           /* owned: {"SCENE": {"title": ..., "exposure_ev": ...}} */
    json_t *counted;          /* owned: names of pictures that are in `bytes` */
    size_t limit_bytes, bytes;
    int left_out;
};

enum neph_status neph_night_pictures_begin(struct neph_night_pictures *pictures,
                                           struct neph_store *store, const char *page_folder,
                                           size_t limit_bytes, struct neph_diag *diag);
void neph_night_pictures_end(struct neph_night_pictures *pictures);

/* The frame of a key as {"picture": NAME, "size_px": [W, H]}; JSON null when the store has it no
 * more, when it is no picture of radiance, or when the limit leaves no room. `scene` as in a
 * series: "NAME@HASH", "NAME POINT@HASH". */
enum neph_status neph_night_pictures_one(struct neph_night_pictures *pictures, const char *scene,
                                         const char *key, json_t **shown, struct neph_diag *diag);

/* Two frames, either of which may be missing (""): {"accepted": {"picture": ..., "exr": ...} or
 * null, "tonight": ..., "size_px", "exposure_ev", "difference": null or {"picture", "scale",
 * "mean", "changed"}}. The scale of the difference is the first of 1, 2, 5 times a power of ten
 * that leaves one pixel in a hundred beyond it; "mean" is the mean of |difference| of luminance
 * over the mean luminance of the accepted frame, "changed" the share of pixels that are not the
 * same bits. JSON null when there is neither. */
enum neph_status neph_night_pictures_pair(struct neph_night_pictures *pictures, const char *scene,
                                          const char *accepted, const char *tonight, json_t **shown,
                                          struct neph_diag *diag);

#endif
