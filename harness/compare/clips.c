/* SPDX-License-Identifier: MIT */
#include "harness/compare/clips.h"

#include "base/apng.h"
#include "base/files.h"
#include "base/video.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char suffix[] = ".png";

bool neph_clip_is(const char *file)
{
    return neph_apng_count(file) > 1 || neph_video_is(file);
}

enum neph_status neph_clip_count(const char *file, int *count, struct neph_diag *diag)
{
    if (neph_video_is(file))
        return neph_video_count(file, count, diag);
    *count = neph_apng_count(file);
    return NEPH_OK;
}

struct neph_path neph_clip_frame_path(const char *file, int frame)
{
    return neph_path_format("%s/%04d%s", file, frame, suffix);
}

bool neph_clip_split(const char *path, struct neph_path *file, int *frame)
{
    const char *slash = strrchr(path, '/');
    char *end = NULL;
    if (!slash || slash == path || slash[1] < '0' || slash[1] > '9')
        return false;
    const long number = strtol(slash + 1, &end, 10);
    *file = neph_path_format("%.*s", (int)(slash - path), path);
    if (strcmp(end, suffix) != 0 || number > INT_MAX || !neph_path_exists(file->text) ||
        neph_path_is_dir(file->text))
        return false;
    *frame = (int)number;
    return true;
}

static bool is_free(const struct neph_clips *clips, int i)
{
    return !clips->open[i].apng && !clips->open[i].video;
}

static void close_place(struct neph_clips *clips, int i)
{
    neph_apng_close(clips->open[i].apng);
    neph_video_close(clips->open[i].video);
    clips->open[i].apng = NULL;
    clips->open[i].video = NULL;
}

void neph_clips_close(struct neph_clips *clips)
{
    for (int i = 0; i < NEPH_CLIPS_OPEN; i++)
        close_place(clips, i);
}

static bool has_file(const struct neph_clips *clips, int i, const char *file)
{
    return !is_free(clips, i) && strcmp(clips->open[i].file.text, file) == 0;
}

/* The place of an open file, else the one that is free, or was used least recently. */
static int find_place(const struct neph_clips *clips, const char *file)
{
    int found = 0;
    for (int i = 0; i < NEPH_CLIPS_OPEN; i++)
        if (has_file(clips, i, file))
            return i;
    for (int i = 1; i < NEPH_CLIPS_OPEN; i++)
        if (!is_free(clips, found) &&
            (is_free(clips, i) || clips->open[i].used < clips->open[found].used))
            found = i;
    return found;
}

static enum neph_status open_file(struct neph_clips *clips, const struct neph_path *file,
                                  int *place, struct neph_diag *diag)
{
    const int i = find_place(clips, file->text);
    clips->open[i].used = ++clips->used;
    *place = i;
    if (has_file(clips, i, file->text))
        return NEPH_OK;
    close_place(clips, i);
    clips->open[i].file = *file;
    return neph_video_is(file->text) ? neph_video_open(file->text, &clips->open[i].video, diag)
                                     : neph_apng_open(file->text, &clips->open[i].apng, diag);
}

enum neph_status neph_clips_read(struct neph_clips *clips, const char *path,
                                 struct neph_image **image, struct neph_diag *diag)
{
    struct neph_path file;
    int frame = 0, place = 0;
    if (!neph_clip_split(path, &file, &frame))
        return neph_fail(diag, NEPH_ERR_NOT_FOUND, "there is no file '%s'", path);
    const enum neph_status status = open_file(clips, &file, &place, diag);
    if (status)
        return status;
    struct neph_apng *apng = clips->open[place].apng;
    struct neph_video *video = clips->open[place].video;
    const int count = apng ? neph_apng_frame_count(apng) : neph_video_frame_count(video);
    if (frame >= count)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' has %d frames, and none of number %d",
                         file.text, count, frame);
    return apng ? neph_apng_read(apng, frame, path, image, diag)
                : neph_video_read(video, frame, image, diag);
}
