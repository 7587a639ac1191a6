/* SPDX-License-Identifier: MIT */
#include "harness/engines/cycles_probe.h"

#include "base/threads.h"
#include "harness/engines/blender.h"
#include "harness/engines/cycles_frame.h"
#include "harness/engines/engines.h"
#include "harness/engines/trial.h"
#include "scenes/volume_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* 2 % noise in the light that trial.c sums, a tenth of its tolerance. */
enum { SAMPLES = 64 };
static const double step_m = 0.2; /* 10 steps through each medium */

static const char scratch_prefix[] = "neph-blender-";
static const double time_limit_s = 180.0; /* 2 to 4 s on two free cores */

static bool has_word(const json_t *list, const char *word)
{
    for (size_t i = 0; i < json_array_size(list); i++) {
        const char *text = json_string_value(json_array_get(list, i));
        if (text && strcmp(text, word) == 0)
            return true;
    }
    return false;
}

static enum neph_status read_about(const struct neph_cycles_session *session,
                                   struct neph_cycles_features *features, struct neph_diag *diag)
{
    json_t *about = NULL;
    const enum neph_status status = neph_cycles_about(session, &about, diag);
    features->has_unbiased = json_is_true(json_object_get(about, "has_unbiased"));
    features->has_spots = json_is_true(json_object_get(about, "has_spots"));
    const json_t *phases = json_object_get(about, "phases");
    features->has_phases = has_word(phases, "RAYLEIGH") && has_word(phases, "DRAINE") &&
                           has_word(phases, "MIE");
    json_decref(about);
    return status;
}

/* ---- the trial ------------------------------------------------------------------------------- */

static enum neph_status try_scene(const struct neph_trial *trial, const char *program,
                                  const char *folder, struct neph_cycles_features *features,
                                  struct neph_diag *diag)
{
    const struct neph_shot shot = {.scene = &trial->scene,
                                   .settings = neph_settings_default(&neph_engine_cycles),
                                   .width_px = NEPH_TRIAL_WIDTH_PX,
                                   .height_px = NEPH_TRIAL_HEIGHT_PX,
                                   .layers = NEPH_LAYERS_ALL,
                                   .seed = 1,
                                   .scratch_directory = folder,
                                   .time_limit_s = time_limit_s};
    const struct neph_cycles_quality quality = {
        .samples = SAMPLES, .step = step_m, .threads = neph_processor_count()};
    struct neph_cycles_session session;
    struct neph_child_result result;
    struct neph_image *image = NULL;
    double render_s;
    enum neph_status status = neph_cycles_open(&shot, &quality, program, folder, &session, diag);
    if (!status)
        status = neph_cycles_write(&session, diag);
    if (!status)
        status = neph_cycles_run(&session, NULL, &result, diag);
    if (!status)
        status = neph_cycles_frame(&session, &image, &render_s, diag);
    if (!status)
        status = read_about(&session, features, diag);
    if (!status)
        status = neph_trial_judge(trial, image, &features->has_voxels, diag);
    neph_cycles_close(&session);
    neph_image_destroy(image);
    return status;
}

static enum neph_status try_program(const char *program, bool with_voxels,
                                    struct neph_cycles_features *features, struct neph_diag *diag)
{
    struct neph_scratch *folder = NULL;
    struct neph_trial trial;
    struct neph_cycles_features found = {.has_voxels = false};
    enum neph_status status = neph_trial_open(with_voxels, &trial, diag);
    if (!status)
        status = neph_program_make_folder(scratch_prefix, &folder, diag);
    if (!status)
        status = try_scene(&trial, program, neph_scratch_path(folder), &found, diag);
    if (status && folder)
        neph_move_paths(diag, neph_scratch_path(folder), NULL);
    neph_scratch_destroy(folder);
    neph_trial_close(&trial);
    if (!status)
        *features = found;
    return status;
}

static bool load_features(const char *file, struct neph_cycles_features *features)
{
    json_t *kept = neph_trial_load_result(file);
    const bool is_kept = json_is_boolean(json_object_get(kept, "has_voxels"));
    if (is_kept)
        *features = (struct neph_cycles_features){
            .has_voxels = json_is_true(json_object_get(kept, "has_voxels")),
            .has_unbiased = json_is_true(json_object_get(kept, "has_unbiased")),
            .has_phases = json_is_true(json_object_get(kept, "has_phases")),
            .has_spots = json_is_true(json_object_get(kept, "has_spots"))};
    json_decref(kept);
    return is_kept;
}

/* Whether the helper program that writes OpenVDB files is installed. Without it the voxel feature
 * is unknown, and the result is not cached. */
static bool can_write_voxels(void)
{
    char *path = NULL;
    const bool can = neph_volume_find_openvdb(&path, NULL) == NEPH_OK;
    free(path);
    return can;
}

enum neph_status neph_cycles_features(int program, struct neph_cycles_features *features,
                                      struct neph_diag *diag)
{
    char missing[512] = "";
    char *path = neph_external_find(&neph_blender, program, missing, sizeof(missing));
    if (!path)
        return neph_fail(diag, NEPH_ERR_UNAVAILABLE, "%s", missing);
    char *file = neph_trial_file(path, NEPH_BLENDER_SCRIPT_PATH);
    const bool with_voxels = can_write_voxels();
    enum neph_status status = NEPH_OK;
    if (!load_features(file, features)) {
        status = try_program(path, with_voxels, features, diag);
        if (!status && with_voxels)
            neph_trial_save_result(file, json_pack("{s:s, s:b, s:b, s:b, s:b}", "program", path,
                                                   "has_voxels", features->has_voxels,
                                                   "has_unbiased", features->has_unbiased,
                                                   "has_phases", features->has_phases, "has_spots",
                                                   features->has_spots));
        if (!status && !with_voxels)
            features->has_voxels = true;
    }
    free(file);
    free(path);
    return status;
}
