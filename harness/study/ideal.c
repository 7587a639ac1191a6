/* SPDX-License-Identifier: MIT */
#include "harness/study/ideal.h"

#include "base/exr.h"
#include "base/files.h"
#include "harness/study/take.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum neph_status neph_ideal_choose(struct neph_ideal *ideal, const struct neph_job *first,
                                   struct neph_diag *diag)
{
    char key[NEPH_HASH_HEX_SIZE];
    const enum neph_status status = neph_job_key(first, key, diag);
    if (status || strcmp(key, ideal->reference.key) == 0)
        return status;
    neph_ideal_finish(ideal);
    memcpy(ideal->reference.key, key, sizeof(key));
    return NEPH_OK;
}

/* Writes a frame, or moves its file, to the work folder. */
static enum neph_status keep_frame(const struct neph_capture_frames *frames, int number,
                                   const char *path, struct neph_diag *diag)
{
    if (frames->images[number])
        return neph_exr_write_plain(path, frames->images[number], diag);
    return rename(frames->files->paths[number], path) == 0
               ? NEPH_OK
               : neph_fail(diag, NEPH_ERR_IO, "cannot write '%s': %s", path, strerror(errno));
}

static enum neph_status keep_frames(const struct neph_capture *take,
                                    const struct neph_capture_frames *frames, void *context,
                                    struct neph_diag *diag)
{
    struct neph_ideal *ideal = context;
    struct neph_sequence *kept = &ideal->reference.frames[NEPH_REFERENCE_AVERAGED];
    const char *folder = neph_scratch_path(ideal->scratch);
    enum neph_status status = NEPH_OK;
    kept->paths = calloc((size_t)take->frame_count, sizeof(*kept->paths));
    for (int i = 0; kept->paths && i < take->frame_count && !status; i++) {
        kept->paths[i] = neph_format("%s/frame_%04d.exr", folder, i);
        kept->count += kept->paths[i] != NULL;
        status = kept->paths[i] ? keep_frame(frames, i, kept->paths[i], diag)
                                : neph_fail_memory(diag);
    }
    return kept->paths ? status : neph_fail_memory(diag);
}

enum neph_status neph_ideal_render(struct neph_ideal *ideal, const struct neph_job *first,
                                   int frame_count, struct neph_store *store,
                                   struct neph_diag *diag)
{
    const struct neph_capture take = {
        .job = *first, .frame_count = frame_count, .look = keep_frames, .callback_context = ideal};
    if (ideal->scratch)
        return NEPH_OK;
    enum neph_status status = neph_store_begin(store, &ideal->scratch, diag);
    if (!status)
        status = neph_capture_replay(&take, store, diag);
    if (status)
        neph_ideal_finish(ideal);
    return status;
}

void neph_ideal_finish(struct neph_ideal *ideal)
{
    neph_reference_finish(&ideal->reference);
    neph_scratch_destroy(ideal->scratch);
    *ideal = (struct neph_ideal){.scratch = NULL};
}
