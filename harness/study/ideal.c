/* SPDX-License-Identifier: MIT */
#include "harness/study/ideal.h"

#include "base/exr.h"
#include "base/files.h"
#include "base/path.h"
#include "harness/json_file.h"
#include "harness/study/blurred.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum neph_status neph_ideal_choose(struct neph_ideal *ideal, const struct neph_job *first,
                                   struct neph_diag *diag)
{
    char key[NEPH_HASH_HEX_SIZE];
    const enum neph_status status = neph_job_key(first, key, diag);
    if (status || strcmp(key, ideal->references[0].key) == 0)
        return status;
    neph_ideal_finish(ideal);
    for (int i = 0; i < NEPH_IDEALS; i++)
        memcpy(ideal->references[i].key, key, sizeof(key));
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

static struct neph_sequence *find_frames(struct neph_ideal *ideal, enum neph_ideal_kind kind)
{
    return &ideal->references[kind].frames[NEPH_REFERENCE_AVERAGED];
}

static enum neph_status keep_frames(const struct neph_capture *take,
                                    const struct neph_capture_frames *frames, void *context,
                                    struct neph_diag *diag)
{
    struct neph_ideal *ideal = context;
    struct neph_sequence *kept = find_frames(ideal, NEPH_IDEAL_SEQUENCE);
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
                                   const struct neph_sequence *reference, int frame_count,
                                   struct neph_store *store, struct neph_diag *diag)
{
    const struct neph_sequence *kept = find_frames(ideal, NEPH_IDEAL_SEQUENCE);
    const struct neph_capture take = {
        .job = *first, .frame_count = frame_count, .look = keep_frames, .callback_context = ideal};
    if (ideal->scratch)
        return NEPH_OK;
    enum neph_status status = neph_store_begin(store, &ideal->scratch, diag);
    if (!status)
        status = neph_capture_replay(&take, store, diag);
    if (!status)
        status = neph_blurred_fit(reference, kept, &ideal->blur_px, diag);
    if (!status)
        status = neph_blurred_write(
            reference, kept, ideal->blur_px, neph_scratch_path(ideal->scratch),
            find_frames(ideal, NEPH_IDEAL_BLURRED), find_frames(ideal, NEPH_IDEAL_ALIASED), diag);
    if (status)
        neph_ideal_finish(ideal);
    return status;
}

static const char document[] = "blur", key_px[] = "sigma_px";

enum neph_status neph_ideal_keep_blur(const struct neph_capture *take,
                                      const struct neph_capture_frames *frames, void *context,
                                      struct neph_diag *diag)
{
    (void)take;
    const struct neph_ideal *ideal = context;
    json_t *json = json_pack("{s:f}", key_px, ideal->blur_px);
    const enum neph_status status = neph_json_write(
        json, JSON_COMPACT, neph_path_format("%s/%s.json", frames->folder, document).text, diag);
    json_decref(json);
    return status;
}

enum neph_status neph_ideal_read_blur(const char *folder, double *blur_px, struct neph_diag *diag)
{
    json_t *json = NULL;
    const enum neph_status status = neph_capture_document(folder, document, &json, diag);
    if (!status)
        *blur_px = neph_json_real(json, key_px);
    json_decref(json);
    return status;
}

void neph_ideal_finish(struct neph_ideal *ideal)
{
    for (int i = 0; i < NEPH_IDEALS; i++)
        neph_reference_finish(&ideal->references[i]);
    neph_scratch_destroy(ideal->scratch);
    *ideal = (struct neph_ideal){.scratch = NULL};
}
