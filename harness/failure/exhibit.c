/* SPDX-License-Identifier: MIT */
#include "harness/failure/exhibit.h"

#include "base/exr.h"
#include "base/files.h"
#include "harness/compare/comparison.h"
#include "metrics/extractors/extractors.h"
#include "metrics/extractors/seen_spectrum.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Part of the key: raise it when pictures change. */
enum { DRAWN_REVISION = 2 };

enum neph_status neph_exhibit_key(const char *take_key, double exposure_ev,
                                  char key[NEPH_HASH_HEX_SIZE], struct neph_diag *diag)
{
    char *text = neph_format("neph-exhibit-%d\n%s\nexposure_ev %.17g\n", DRAWN_REVISION, take_key,
                             exposure_ev);
    const enum neph_status status = text ? neph_hash(text, strlen(text), key, diag)
                                         : neph_fail_memory(diag);
    free(text);
    return status;
}

char *neph_exhibit_find(struct neph_store *store, const char *key)
{
    char *path;
    json_t *record;
    if (!neph_store_find(store, key, &path, &record))
        return NULL;
    json_decref(record);
    *strrchr(path, '/') = '\0';
    return path;
}

/* The map only: one number is taken, as something has to be. */
static enum neph_status draw_flicker(const struct neph_evidence_source *source,
                                     const struct neph_viewing *viewing, const char *folder,
                                     json_t *names, struct neph_diag *diag)
{
    static const struct neph_meter_number wanted[] = {{"seen_contrast", "all"}, {.metric = NULL}};
    const struct neph_extractor *seen = neph_extractor_find("seen");
    struct neph_comparison comparison = {.reference = *source->reference, /* borrowed */
                                         .test = *source->files,          /* borrowed */
                                         .test_images = source->images,
                                         .viewing = *viewing,
                                         .wanted = wanted,
                                         .maps_directory = folder,
                                         .frozen_is_fine = true,
                                         .plain = true,
                                         .by_position = true,
                                         .quiet = true};
    struct neph_compared compared = {.asked = NULL};
    comparison.choices[comparison.choice_count++] = (struct neph_meter_choice){
        seen, neph_options_default(seen->options)};
    enum neph_status status = neph_comparison_run(&comparison, false, &compared, diag);
    char *path = neph_path_join(folder, NEPH_EXHIBIT_FLICKER_MAP);
    if (!status && !path)
        status = neph_fail_memory(diag);
    if (!status && neph_path_exists(path))
        status = neph_json_append(names, json_string(NEPH_EXHIBIT_FLICKER_MAP), diag);
    free(path);
    neph_compared_finish(&compared);
    return status;
}

/* An entry of the store is known by a frame: the worst. */
static enum neph_status keep_worst(const struct neph_evidence_source *source, int frame,
                                   const char *folder, struct neph_diag *diag)
{
    const struct neph_image *image = source->images ? source->images[frame] : NULL;
    char *path = neph_path_join(folder, "frame.exr");
    enum neph_status status = NEPH_OK;
    if (!path)
        status = neph_fail_memory(diag);
    else if (image)
        status = neph_exr_write(path, image, diag);
    else
        status = neph_file_copy(source->files->paths[frame], path, diag);
    free(path);
    return status;
}

enum neph_status neph_exhibit_make(struct neph_store *store, const char *key,
                                   const struct neph_job *job,
                                   const struct neph_evidence_source *source,
                                   const struct neph_viewing *viewing, bool with_map,
                                   struct neph_diag *diag)
{
    struct neph_scratch *scratch = NULL;
    struct neph_evidence evidence;
    json_t *names = json_array(), *record = NULL;
    enum neph_status status = neph_json_check(names, diag);
    if (!status)
        status = neph_evidence_find(source, &evidence, diag);
    if (!status)
        status = neph_store_begin(store, &scratch, diag);
    if (!status)
        status = neph_evidence_draw(source, &evidence, neph_scratch_path(scratch), names, diag);
    if (!status && with_map && source->reference->count > 0 &&
        source->files->count >= NEPH_SEEN_FRAMES_MIN)
        status = draw_flicker(source, viewing, neph_scratch_path(scratch), names, diag);
    if (!status)
        status = keep_worst(source, evidence.worst_frame, neph_scratch_path(scratch), diag);
    if (!status) {
        record = json_pack(
            "{s:s, s:O, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:f, s:s, s:s, s:s, s:s}", "format",
            "neph-exhibit-1", "pictures", names, "frame_step", source->frame_step, "worst_frame",
            evidence.worst_frame, "row", evidence.row, "slice_first", evidence.slice_first,
            "slice_count", evidence.slice_count, "flip_first", evidence.flip_first, "flip_count",
            evidence.flip_count, "scale", evidence.scale, "engine", job->engine->name, "version",
            job->info->version, "build", job->info->build, "device", job->info->device);
        status = neph_json_check(record, diag);
    }
    if (!status)
        status = neph_store_publish(store, key, scratch, record, diag);
    json_decref(names);
    json_decref(record);
    neph_scratch_destroy(scratch);
    return status;
}
