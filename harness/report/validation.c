/* SPDX-License-Identifier: MIT */
#include "harness/report/validation.h"

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_GATE_VERDICT_COUNT == 3, "a new kind");
_Static_assert(NEPH_SHOWN_COUNT == 2, "a new kind");
_Static_assert(NEPH_VERDICT_COUNT == 4, "a new kind");

const char *neph_shown_name(enum neph_shown which)
{
    static const char *const names[] = {
        [NEPH_SHOWN_RADIANCE] = "radiance", [NEPH_SHOWN_TRANSMITTANCE] = "transmittance"};
    return names[which];
}

const char *neph_verdict_name(enum neph_verdict verdict)
{
    static const char *const names[] = {[NEPH_VERDICT_PASS] = "pass",
                                        [NEPH_VERDICT_FAIL] = "fail",
                                        [NEPH_VERDICT_RUNNING] = "running",
                                        [NEPH_VERDICT_INTERRUPTED] = "interrupted"};
    return names[verdict];
}

const char *neph_gate_verdict_name(enum neph_gate_verdict verdict)
{
    static const char *const names[] = {[NEPH_GATE_PASS] = "pass",
                                        [NEPH_GATE_FAIL] = "fail",
                                        [NEPH_GATE_NOT_MEASURED] = "not_measured"};
    return names[verdict];
}

static struct neph_counts count_frames(const struct neph_validation *validation, int expected)
{
    struct neph_counts counts = {.expected = expected};
    for (int s = 0; s < validation->scene_count; s++) {
        const struct neph_scene_result *scene = &validation->scenes[s];
        counts.expected -= scene->left_out_count;
        counts.reported += scene->frame_count;
        for (int f = 0; f < scene->frame_count && scene->truth >= 0; f++)
            counts.compared += f != scene->truth && scene->frames[f].path;
        counts.ungated += scene->ungated_count;
    }
    return counts;
}

static bool scene_passes(const struct neph_scene_result *scene)
{
    for (int g = 0; g < scene->gate_count; g++)
        if (scene->gates[g].verdict == NEPH_GATE_FAIL)
            return false;
    for (int f = 0; f < scene->frame_count; f++)
        if (neph_outcome_is_broken(scene->frames[f].outcome))
            return false;
    return true;
}

static bool passes(const struct neph_validation *validation)
{
    const struct neph_counts *counts = &validation->counts;
    bool pass = counts->reported == counts->expected && counts->compared > 0 &&
                neph_over_time_passes(validation->over_time);
    for (int s = 0; s < validation->scene_count; s++)
        pass = pass && scene_passes(&validation->scenes[s]);
    return pass;
}

void neph_validation_judge(struct neph_validation *validation, int expected)
{
    validation->counts = count_frames(validation, expected);
    validation->verdict = passes(validation) ? NEPH_VERDICT_PASS : NEPH_VERDICT_FAIL;
}

void neph_scene_result_finish(struct neph_scene_result *scene)
{
    for (int f = 0; f < scene->frame_count; f++)
        neph_measurements_finish(&scene->frames[f].measurements);
    *scene = (struct neph_scene_result){.name = NULL};
}

void neph_validation_finish(struct neph_validation *validation)
{
    for (int s = 0; s < validation->scene_count; s++)
        neph_scene_result_finish(&validation->scenes[s]);
    for (int c = 0; c < validation->chart_count; c++) {
        json_decref(validation->charts[c].spec);
        json_decref(validation->charts[c].falls);
    }
    neph_over_time_finish(validation->over_time);
    neph_arena_finish(&validation->arena);
    *validation = (struct neph_validation){.title = NULL};
}
