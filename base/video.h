/* SPDX-License-Identifier: MIT
 *
 * Frames of video files, through the programs ffprobe and ffmpeg where they are installed.
 */
#ifndef NEPH_BASE_VIDEO_H
#define NEPH_BASE_VIDEO_H

#include "base/image.h"

/* Attribute of a frame: what its file is and how it was decoded, "h264, yuv420p, limited range,
 * matrix BT.709 (not stated)". */
#define NEPH_VIDEO_ATTRIBUTE "neph.video"

struct neph_video;

/* Whether a file is MP4, QuickTime, Matroska, WebM or YUV4MPEG2, by its first bytes. */
bool neph_video_is(const char *path);

/* Count the frames, which decodes them. NEPH_ERR_UNAVAILABLE: ffmpeg is not installed.
 * NEPH_ERR_INPUT: no video that can be decoded, or one whose colours are not those of BT.709 or
 * sRGB: other primaries, HDR curves, interlaced fields. */
enum neph_status neph_video_count(const char *path, int *count, struct neph_diag *diag);

/* Decode all frames, with chroma at full size, into a file without a name in TMPDIR (else /tmp).
 * NEPH_ERR_IO: its disk has no room for them. Other errors as of neph_video_count(). */
enum neph_status neph_video_open(const char *path, struct neph_video **video,
                                 struct neph_diag *diag);

/* NULL is fine. */
void neph_video_close(struct neph_video *video);

int neph_video_frame_count(const struct neph_video *video);

/* Read a frame, counted from 0, in any order. Its R'G'B', clamped to 0..1 and rounded to 16 bits,
 * are taken for codes of sRGB; the image has the attributes "encoding", NEPH_VIDEO_ATTRIBUTE and
 * frames_per_second. A file that states no matrix has that of BT.709 from 720 lines on, else
 * BT.601; one that states no range has the limited one. */
enum neph_status neph_video_read(struct neph_video *video, int frame, struct neph_image **image,
                                 struct neph_diag *diag);

#endif
