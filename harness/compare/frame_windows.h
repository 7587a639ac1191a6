/* SPDX-License-Identifier: MIT
 *
 * The data windows of frames by the headers of their files, before any frame is read: which pixels
 * of differing windows are compared.
 */
#ifndef NEPH_HARNESS_COMPARE_FRAME_WINDOWS_H
#define NEPH_HARNESS_COMPARE_FRAME_WINDOWS_H

#include "harness/compare/frame.h"
#include "harness/compare/sequence.h"
#include "harness/json.h"

enum neph_window_mode {
    NEPH_WINDOW_UNION,        /* the pixels that one file has, inside the display window */
    NEPH_WINDOW_INTERSECTION, /* the pixels that all files have, inside the display window */
    NEPH_WINDOW_STRICT,       /* windows that differ are refused */
    NEPH_WINDOW_MODE_COUNT,
};

/* The windows of all files of a comparison. */
struct neph_windows {
    enum neph_window_mode mode;
    struct neph_window placed; /* of all frames; size 0: as in the files, which are all equal */
    struct neph_window common; /* the pixels that all files have; size 0: none */
    bool differ;               /* files have different data windows */
    bool is_overscan;          /* a data window reaches beyond its display window */
};

/* Find the window of frames in the headers of their files, and set it as `choice->window`, by which
 * neph_frame_read() places frames. Files that are damaged or have no windows are left out: reading
 * them reports the problem. `mode`: "union", "intersection" or "strict".
 *
 * NEPH_ERR_INPUT: display windows of different sizes, in images of whole windows also for "strict";
 * the window has no pixel, or more than NEPH_IMAGE_SIDE_MAX_PX on a side; `choice->part` is set,
 * but no file has parts. NEPH_ERR_USAGE: another mode. NEPH_ERR_INTERRUPTED. */
enum neph_status neph_windows_find(const struct neph_sequence *const *sequences, int count,
                                   const char *mode, struct neph_frame_choice *choice,
                                   struct neph_windows *windows, struct neph_diag *diag);

/* Refuse a part (NULL: none is wanted) that no file of a sequence has. Files without parts may be
 * beside files with them. NEPH_ERR_INPUT. */
enum neph_status neph_part_check(const struct neph_sequence *sequence, const char *part,
                                 struct neph_diag *diag);

/* Say in one sentence which pixels are measured; empty when frames stay as in their files. */
void neph_windows_sentence(const struct neph_windows *windows, char *text, size_t size);

/* {"mode", "differ", "measured"}: null when frames stay as in their files, else {"corner_px",
 * "size_px", "display_px"} of their data window, each [x, y]. */
json_t *neph_windows_json(const struct neph_windows *windows);

#endif
