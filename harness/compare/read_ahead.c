/* SPDX-License-Identifier: MIT */
#include "harness/compare/read_ahead.h"

#include "base/workers.h"
#include "harness/compare/clips.h"

#include <stdlib.h>
#include <string.h>

enum { FILES_MAX = 64 };

struct file {
    const struct neph_frame_source *source;
    const char *path; /* borrowed; NULL: free */
    const struct neph_frame_choice *choice;
    size_t negative_allowed;
    struct neph_task task;
    struct neph_image *image; /* owned; these three after the task */
    enum neph_status status;
    struct neph_diag diag;
};

struct neph_read_ahead {
    struct neph_workers *workers;
    struct file files[FILES_MAX];
};

enum neph_status neph_read_ahead_create(int thread_count, struct neph_read_ahead **ahead,
                                        struct neph_diag *diag)
{
    struct neph_read_ahead *created = calloc(1, sizeof(*created));
    const enum neph_status status = created
                                        ? neph_workers_create(thread_count, &created->workers, diag)
                                        : neph_fail_memory(diag);
    if (status) {
        free(created);
        return status;
    }
    *ahead = created;
    return NEPH_OK;
}

void neph_read_ahead_destroy(struct neph_read_ahead *ahead)
{
    if (!ahead)
        return;
    neph_workers_destroy(ahead->workers);
    for (int i = 0; i < FILES_MAX; i++)
        neph_image_destroy(ahead->files[i].image);
    free(ahead);
}

/* The file of a path; NULL: it was not started. `path` NULL: a free place. */
static struct file *find_file(struct neph_read_ahead *ahead, const char *path)
{
    for (int i = 0; ahead && i < FILES_MAX; i++) {
        struct file *file = &ahead->files[i];
        if (path ? file->path && strcmp(file->path, path) == 0 : !file->path)
            return file;
    }
    return NULL;
}

static void read_file(void *context)
{
    struct file *file = context;
    file->status = file->source->read(file->source->context, file->path, file->choice,
                                      file->negative_allowed, &file->image, &file->diag);
}

void neph_read_ahead_start(struct neph_read_ahead *ahead, const struct neph_frame_source *source,
                           const char *path, const struct neph_frame_choice *choice,
                           size_t negative_allowed)
{
    struct neph_path clip;
    int frame;
    struct file *file = find_file(ahead, path) ? NULL : find_file(ahead, NULL);
    if (!file || neph_clip_split(path, &clip, &frame))
        return;
    *file = (struct file){.source = source,
                          .path = path,
                          .choice = choice,
                          .negative_allowed = negative_allowed,
                          .task = {.work = read_file, .context = file}};
    neph_workers_add(ahead->workers, &file->task);
}

enum neph_status neph_read_ahead_take(struct neph_read_ahead *ahead,
                                      const struct neph_frame_source *source, const char *path,
                                      const struct neph_frame_choice *choice,
                                      size_t negative_allowed, struct neph_image **image,
                                      struct neph_diag *diag)
{
    struct file *file = find_file(ahead, path);
    if (!file)
        return source->read(source->context, path, choice, negative_allowed, image, diag);
    neph_workers_wait(ahead->workers, &file->task);
    const enum neph_status status = file->status;
    if (status && diag)
        *diag = file->diag;
    if (!status)
        *image = file->image;
    *file = (struct file){.path = NULL};
    return status;
}
