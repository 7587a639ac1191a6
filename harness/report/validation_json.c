/* SPDX-License-Identifier: MIT */
#include "harness/report/validation.h"

#include "base/doubt.h"
#include "base/written.h"
#include "harness/host.h"
#include "harness/report/page.h"
#include "harness/report/ranking.h"
#include "metrics/display.h"
#include "metrics/extractors/extractors.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- a scene --------------------------------------------------------------------------------- */

/* null for a deterministic frame. */
static json_t *noise_json(const struct neph_frame_result *frame)
{
    char text[128], doubt[NEPH_DOUBT_ROOM];
    if (!(frame->noise > 0.0))
        return json_null();
    neph_doubt_describe(frame->noise_doubt, doubt, sizeof(doubt));
    snprintf(text, sizeof(text), "noise left in a pixel: %.2g %% of the rms radiance",
             100.0 * frame->noise);
    return json_pack("{s:f, s:s, s:s, s:o, s:s?}", "value", frame->noise, "unit", "1", "text", text,
                     "doubt", neph_json_number(frame->noise_doubt), "warning",
                     doubt[0] ? doubt : NULL);
}

static json_t *frame_json(const struct neph_frame_result *frame)
{
    const struct neph_engine *engine = frame->engine;
    json_t *json = json_pack(
        "{s:s, s:s, s:s, s:s, s:s, s:s, s:b, s:f, s:f, s:f, s:I, s:I, s:o, s:s?, s:s?, s:s?, "
        "s:{s:s?, s:s?}, s:o, s:o, s:b, s:o}",
        "engine", engine->name, "rung", neph_reference_level_name(engine->rung), "status",
        neph_outcome_name(frame->outcome), "reason", frame->reason, "note", frame->note, "settings",
        frame->settings, "reused", frame->reused, "render_s", frame->cost.render_s, "wall_s",
        frame->cost.wall_s, "cpu_s", frame->cost.cpu_s, "peak_memory_bytes",
        (json_int_t)frame->cost.peak_memory_bytes, "seed", (json_int_t)frame->seed,
        "step_optical_depth", neph_json_number(frame->step_optical_depth), "exr", frame->path,
        "exr_second", frame->second_path, "picture", frame->picture, "difference", "radiance",
        frame->differences[NEPH_SHOWN_RADIANCE], "transmittance",
        frame->differences[NEPH_SHOWN_TRANSMITTANCE], "measurements",
        neph_measurements_json(&frame->measurements), "study",
        frame->study ? neph_study_json(frame->study) : json_null(), "look", frame->is_look, "bake",
        frame->bakes ? neph_bakes_summary_json(frame->bakes) : json_null());
    neph_json_set(&json, "noise", noise_json(frame));
    neph_json_set(&json, "speed", neph_speed_json(&frame->speed));
    return json;
}

static json_t *gate_json(const struct neph_gate_result *gate)
{
    return json_pack("{s:s, s:s, s:s, s:s, s:o, s:f, s:s, s:s}", "engine", gate->engine, "quantity",
                     gate->quantity, "metric", gate->metric, "mask", gate->mask, "value",
                     neph_json_number(gate->value), "maximum", gate->maximum, "verdict",
                     neph_gate_verdict_name(gate->verdict), "reason", gate->reason);
}

static json_t *truth_json(const struct neph_scene_result *scene)
{
    if (scene->truth < 0)
        return json_null();
    const struct neph_engine *engine = scene->frames[scene->truth].engine;
    return json_pack("{s:s, s:s}", "engine", engine->name, "rung",
                     neph_reference_level_name(engine->rung));
}

static json_t *scene_json(const struct neph_scene_result *scene)
{
    json_t *frames = json_array(), *gates = json_array();
    for (int f = 0; f < scene->frame_count; f++)
        neph_json_add(&frames, frame_json(&scene->frames[f]));
    for (int g = 0; g < scene->gate_count; g++)
        neph_json_add(&gates, gate_json(&scene->gates[g]));
    return json_pack("{s:s, s:s, s:s, s:[i,i], s:f, s:o, s:s, s:o, s:{s:f, s:f}, s:o, s:o, s:o, "
                     "s:s?, s:s?}",
                     "name", scene->name, "title", scene->title, "physics", scene->physics,
                     "size_px", scene->width_px, scene->height_px, "exposure_ev",
                     scene->viewing.exposure_ev, "viewing", neph_viewing_json(&scene->viewing),
                     "hash", scene->hash, "truth", truth_json(scene), "difference_scale",
                     "radiance", scene->difference_scales[NEPH_SHOWN_RADIANCE], "transmittance",
                     scene->difference_scales[NEPH_SHOWN_TRANSMITTANCE], "frames", frames, "gates",
                     gates, "attribution", neph_attribution_json(scene->attribution), "viewer",
                     scene->viewer, "no_viewer", scene->no_viewer);
}

/* ---- the run --------------------------------------------------------------------------------- */

static json_t *engine_json(const struct neph_engine *engine, const struct neph_engine_info *info)
{
    return json_pack("{s:s, s:s, s:s, s:s?, s:b, s:b, s:s, s:s, s:s, s:s, s:s, s:s}", "name",
                     engine->name, "summary", engine->summary, "rung",
                     neph_reference_level_name(engine->rung), "bias", engine->bias, "available",
                     info->available, "broken", info->broken, "version", info->version, "device",
                     info->device, "missing", info->missing, "install_line", info->install_line,
                     "can", info->can, "warning", info->warning);
}

/* The members that are lists. */
static json_t *head_json(const struct neph_validation *validation)
{
    const struct neph_run_engines *field = &validation->field;
    json_t *engines = json_array(), *scenes = json_array(), *absent = json_array();
    json_t *sequences = json_array(), *charts = json_array();
    for (int i = 0; i < field->count; i++)
        neph_json_add(&engines, engine_json(field->engines[i], &field->infos[i]));
    for (int i = 0; i < validation->scene_count; i++)
        neph_json_add(&scenes, scene_json(&validation->scenes[i]));
    for (int i = 0; i < validation->absent_count; i++)
        neph_json_add(&absent,
                      json_pack("{s:s, s:s, s:s}", "scene", validation->absent[i].scene, "reason",
                                validation->absent[i].reason, "hint", validation->absent[i].hint));
    if (validation->over_time)
        neph_json_add(&sequences, neph_over_time_json(validation->over_time));
    for (int i = 0; i < validation->chart_count; i++)
        neph_json_add(&charts, neph_chart_json(&validation->charts[i]));
    return json_pack("{s:s, s:s, s:s, s:s, s:o, s:[i,i], s:o, s:o, s:o, s:o, s:o}", "format",
                     "neph-report-1", "title", validation->title, "created_utc",
                     validation->created_utc, "neph_version", NEPH_VERSION, "host",
                     neph_host_json(), "size_px", validation->width_px, validation->height_px,
                     "engines", engines, "scenes", scenes, "absent", absent, "sequences", sequences,
                     "charts", charts);
}

static void write_verdict(const void *validation, FILE *out)
{
    neph_validation_print_verdict(validation, out);
}

static json_t *verdict_json(const struct neph_validation *validation)
{
    char *text = NULL;
    struct neph_diag diag = {.line = 0};
    neph_write_to_text(write_verdict, validation, &text, &diag);
    json_t *json = text ? json_string(text) : NULL;
    free(text);
    return json;
}

/* The metrics' descriptions, from the tables that the measurements use. */
static json_t *metrics_json(void)
{
    json_t *list = neph_measured_metrics_json();
    for (const char *const *name = neph_over_time_metrics(); *name; name++)
        neph_json_add(&list, neph_metric_json(neph_metric_find(*name, NULL)));
    return list;
}

json_t *neph_validation_json(const struct neph_validation *validation)
{
    const struct neph_counts *counts = &validation->counts;
    json_t *json = head_json(validation);
    neph_json_set(&json, "verdict", json_string(neph_verdict_name(validation->verdict)));
    neph_json_set(&json, "verdict_text", verdict_json(validation));
    neph_json_set(&json, "seconds", json_real(validation->seconds));
    neph_json_set(&json, "counts",
                  json_pack("{s:i, s:i, s:i}", "expected", counts->expected, "reported",
                            counts->reported, "compared", counts->compared));
    if (validation->verdict != NEPH_VERDICT_PASS && validation->verdict != NEPH_VERDICT_FAIL)
        neph_json_set(
            &json, "progress",
            json_pack("{s:i, s:i, s:o}", "done", validation->steps_done, "total",
                      validation->steps_total, "left_s",
                      neph_json_number(validation->left_s >= 0.0 ? validation->left_s : NAN)));
    if (validation->physics)
        neph_json_set(&json, "physics", neph_physics_json(validation->physics));
    neph_json_set(&json, "interactive", json_boolean(validation->interactive));
    neph_json_set(&json, "screen",
                  validation->has_screen ? json_string("screen/index.html") : json_null());
    neph_json_set(&json, "ranking", neph_ranking_json(validation));
    neph_json_set(&json, "difference_colours", neph_page_difference_colours());
    neph_json_set(&json, "difference_beyond",
                  neph_page_colours_beyond(neph_display_difference_legend()));
    neph_json_set(&json, "metrics", metrics_json());
    return json;
}
