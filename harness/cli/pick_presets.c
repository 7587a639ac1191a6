/* SPDX-License-Identifier: MIT */
#include "harness/cli/pick_presets.h"

#include "base/files.h"
#include "harness/cli/cli.h"
#include "harness/data.h"
#include "harness/engines/vulkan_device.h"
#include "harness/study/flicker_study_output.h"
#include "harness/study/flicker_suites.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind does not compile before this file was looked through for it. */
_Static_assert(NEPH_STUDY_TAKES == 4, "a new kind");

static enum neph_status write_text(const char *folder, const char *name, const char *text,
                                   struct neph_diag *diag)
{
    char *path = neph_path_join(folder, name);
    const enum neph_status status = path && text ? neph_file_write(path, text, strlen(text), diag)
                                                 : neph_fail_memory(diag);
    free(path);
    return status;
}

static enum neph_status write_files(const char *folder, const struct neph_flicker_study *study,
                                    const json_t *json, struct neph_diag *diag)
{
    char *text = json_dumps(json, JSON_INDENT(1)), *svg = NULL;
    enum neph_status status = write_text(folder, "pick.json", text, diag);
    if (!status)
        status = neph_flicker_study_plot(study, &svg, diag);
    if (!status)
        status = write_text(folder, "flicker_lag.svg", svg, diag);
    free(svg);
    free(text);
    return status;
}

static enum neph_status tell(const struct neph_cli_pick_presets *asked,
                             const struct neph_flicker_study *study,
                             const struct neph_choice *choice, struct neph_diag *diag)
{
    json_t *json = neph_choice_json(choice, study);
    enum neph_status status = neph_json_check(json, diag);
    if (!status)
        status = write_files(asked->output, study, json, diag);
    if (!status && asked->json)
        status = neph_json_print(json_incref(json), diag);
    else if (!status)
        status = neph_choice_print(choice, study, stdout, diag);
    json_decref(json);
    if (!status && study->failed_count > 0)
        status = neph_fail(diag, NEPH_ERR_ENGINE, "%d takes broke; their scenes have no number",
                           study->failed_count);
    if (!status && choice->scene_counts[choice->least] == 0)
        status = neph_fail(diag, NEPH_ERR_GATE,
                           "there is no scene in which all presets have a number of '%s'",
                           neph_choice_measures[choice->least].name);
    if (!status && choice->chosen < 0)
        status = neph_fail(diag, NEPH_ERR_GATE, "none of the presets is within what was asked for");
    return status;
}

static enum neph_status run(const struct neph_cli_pick_presets *asked,
                            const struct neph_flicker_study_params *params,
                            struct neph_choice *choice, struct neph_diag *diag)
{
    struct neph_store *store = NULL;
    struct neph_flicker_study study = {.params = NULL};
    char *folder = neph_path_join(asked->output, "store");
    enum neph_status status = folder ? neph_data_check_scenes(params->scenes, params->scene_count,
                                                              diag)
                                     : neph_fail_memory(diag);
    if (!status)
        status = neph_store_open(folder, &store, diag);
    if (!status)
        status = neph_flicker_study_run(params, store, &study, diag);
    if (!status)
        status = neph_choice_make(&study, choice, diag);
    if (!status)
        status = tell(asked, &study, choice, diag);
    if (study.params)
        neph_flicker_study_finish(&study);
    neph_store_close(store);
    free(folder);
    return status;
}

static enum neph_status set_least(const char *least, struct neph_choice *choice,
                                  struct neph_diag *diag)
{
    const int number = neph_choice_find(least);
    if (number < 0)
        return neph_fail(diag, NEPH_ERR_USAGE,
                         "--least '%s' is no number: flicker, half-life, lag, error, evaluations "
                         "or ms",
                         least);
    choice->least = (enum neph_choice_number)number;
    return NEPH_OK;
}

enum neph_status neph_cli_pick_presets(const struct neph_cli_pick_presets *asked,
                                       struct neph_diag *diag)
{
    const char *presets[NEPH_STUDY_PRESETS_MAX];
    struct neph_choice choice = {.candidate_count = 0};
    struct neph_shared_device device = {.open = NULL};
    struct neph_flicker_study_params params = {
        .presets = presets,
        .scenes = asked->scenes,
        .scene_count = asked->scene_count,
        .seed_count = asked->seed_count,
        .frame_count = asked->frame_count,
        .steps = asked->steps,
        .width_px = asked->width_px,
        .height_px = asked->height_px,
        .takes = {[NEPH_STUDY_FLICKER] = true, [NEPH_STUDY_STEP] = true, [NEPH_STUDY_SINE] = true},
        .brief = true,
        .device = &device,
        .quiet = asked->quiet};
    char *words = strdup(asked->presets), **suite = NULL;
    memcpy(choice.budget, asked->budget, sizeof(choice.budget));
    enum neph_status status = words ? set_least(asked->least, &choice, diag)
                                    : neph_fail_memory(diag);
    if (!status)
        status = neph_cli_split(words, "presets", NEPH_STUDY_PRESETS_MAX, presets,
                                &params.preset_count, diag);
    if (!status && asked->scene_count == 0) {
        status = neph_flicker_suite_find(asked->suite ? asked->suite : "tuning", &suite,
                                         &params.scene_count, diag);
        params.scenes = (const char *const *)suite;
    }
    if (!status)
        status = run(asked, &params, &choice, diag);
    neph_shared_device_close(&device);
    neph_data_free_names(suite);
    free(words);
    return status;
}
