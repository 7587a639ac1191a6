/* SPDX-License-Identifier: MIT */
#include "harness/compare/clips.h"

#include "base/apng.h"
#include "base/files.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char suffix[] = ".png";

int neph_clip_count(const char *file)
{
    const int count = neph_apng_count(file);
    return count > 1 ? count : 0;
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

static void close_place(struct neph_clips *clips, int i)
{
    neph_apng_close(clips->open[i].apng);
    clips->open[i].apng = NULL;
}

void neph_clips_close(struct neph_clips *clips)
{
    for (int i = 0; i < NEPH_CLIPS_OPEN; i++)
        close_place(clips, i);
}

/* The place of an open file, else the one that is free, or was used least recently. */
static int find_place(const struct neph_clips *clips, const char *file)
{
    int found = 0;
    for (int i = 0; i < NEPH_CLIPS_OPEN; i++)
        if (clips->open[i].apng && strcmp(clips->open[i].file.text, file) == 0)
            return i;
    for (int i = 1; i < NEPH_CLIPS_OPEN; i++)
        if (clips->open[found].apng &&
            (!clips->open[i].apng || clips->open[i].used < clips->open[found].used))
            found = i;
    return found;
}

static enum neph_status open_file(struct neph_clips *clips, const struct neph_path *file,
                                  struct neph_apng **apng, struct neph_diag *diag)
{
    const int i = find_place(clips, file->text);
    clips->open[i].used = ++clips->used;
    *apng = clips->open[i].apng;
    if (*apng && strcmp(clips->open[i].file.text, file->text) == 0)
        return NEPH_OK;
    close_place(clips, i);
    const enum neph_status status = neph_apng_open(file->text, apng, diag);
    if (!status) {
        clips->open[i].file = *file;
        clips->open[i].apng = *apng;
    }
    return status;
}

enum neph_status neph_clips_read(struct neph_clips *clips, const char *path,
                                 struct neph_image **image, struct neph_diag *diag)
{
    struct neph_path file;
    struct neph_apng *apng = NULL;
    int frame = 0;
    if (!neph_clip_split(path, &file, &frame))
        return neph_fail(diag, NEPH_ERR_NOT_FOUND, "there is no file '%s'", path);
    const enum neph_status status = open_file(clips, &file, &apng, diag);
    if (status)
        return status;
    if (frame >= neph_apng_frame_count(apng))
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' has %d frames, and none of number %d",
                         file.text, neph_apng_frame_count(apng), frame);
    return neph_apng_read(apng, frame, path, image, diag);
}
