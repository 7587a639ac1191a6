/* SPDX-License-Identifier: MIT
 *
 * Files with several frames: animated PNG and videos. In a sequence their frames have paths as if
 * the file was a folder: "clip.png/0003.png", "clip.mp4/0003.png".
 */
#ifndef NEPH_HARNESS_COMPARE_CLIPS_H
#define NEPH_HARNESS_COMPARE_CLIPS_H

#include "base/image.h"
#include "base/path.h"

/* Whether a file is a sequence by itself. */
bool neph_clip_is(const char *file);

/* The number of its frames. Errors of neph_video_count(). */
enum neph_status neph_clip_count(const char *file, int *count, struct neph_diag *diag);

/* The path of a frame of such a file. */
struct neph_path neph_clip_frame_path(const char *file, int frame);

/* Whether a path is that of a frame of such a file; then `*file` and `*frame` are set. */
bool neph_clip_split(const char *path, struct neph_path *file, int *frame);

/* Open files, of which frames are read in ascending order without starting again. Start from {0}.
 * The file that was used least recently is closed for another one. */
enum { NEPH_CLIPS_OPEN = 8 };
struct neph_clips {
    struct {
        struct neph_path file;
        struct neph_apng *apng;   /* owned; or NULL */
        struct neph_video *video; /* owned; or NULL; both NULL: a free place */
        int used;                 /* order of use */
    } open[NEPH_CLIPS_OPEN];
    int used;
};

void neph_clips_close(struct neph_clips *clips);

/* Read a frame by its path. NEPH_ERR_INPUT: it is beyond the last one. Errors of
 * neph_apng_read() and neph_video_open(). */
enum neph_status neph_clips_read(struct neph_clips *clips, const char *path,
                                 struct neph_image **image, struct neph_diag *diag);

#endif
