/* SPDX-License-Identifier: MIT */
#include "harness/report/validate.h"

#include "base/clock.h"
#include "base/exr.h"
#include "base/interrupt.h"
#include "base/text.h"
#include "base/threads.h"
#include "harness/compare/measure.h"
#include "harness/data.h"
#include "harness/engines/bakes.h"
#include "harness/engines/engines.h"
#include "harness/progress.h"
#include "harness/report/attribution.h"
#include "harness/report/over_time.h"
#include "harness/report/scene_layers.h"
#include "harness/report/step_depth.h"
#include "harness/run/budget.h"
#include "harness/run/job.h"
#include "harness/run/seed.h"
#include "harness/study/studies.h"
#include "harness/study/study.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ENGINES_MAX = 16 };

/* One row of engines, probed once for the whole run. */
struct field {
    int count;
    const struct neph_engine *engines[ENGINES_MAX];
    struct neph_engine_info infos[ENGINES_MAX];
};

/* Kinds of steps, for the time left: engine by engine, a picture and its second seed. */
enum {
    KIND_FRAME = 0,
    KIND_SECOND_SEED = ENGINES_MAX,
    KIND_CHART = 2 * ENGINES_MAX,
    KIND_OVER_TIME
};
_Static_assert((int)KIND_OVER_TIME < (int)NEPH_PROGRESS_KINDS, "kinds of progress");

/* What was rendered once within the budget will be again, but on a busy machine perhaps not as
 * fast: a second seed that is given up takes the engine out of the attribution. */
enum { SECOND_SEED_PATIENCE = 4 };

struct run {
    const struct neph_validate_params *params;
    struct neph_store *store;
    struct field field;
    struct neph_progress progress;
    double start_s;
    int absent_count; /* scenes that are not here */
    json_t *document; /* as far as it is; "scenes", "absent", "sequences" and "charts" grow */
};

static enum neph_status choose_engines(const struct neph_validate_params *params,
                                       struct field *field, struct neph_diag *diag)
{
    int known;
    const struct neph_engine *const *engines = neph_engines(&known);
    for (int i = 0; i < params->engine_count; i++)
        if (!neph_engine_find(params->engines[i])) {
            neph_fail(diag, NEPH_ERR_USAGE, "there is no engine '%s'", params->engines[i]);
            neph_hint(diag, "`neph engines` lists them");
            return NEPH_ERR_USAGE;
        }
    for (int i = 0; i < known; i++) {
        bool wanted = params->engine_count == 0 && !engines[i]->shortcut_of;
        for (int j = 0; j < params->engine_count; j++)
            wanted |= strcmp(params->engines[j], engines[i]->name) == 0;
        if (!wanted)
            continue;
        if (neph_interrupted())
            return neph_fail(diag, NEPH_ERR_INTERRUPTED, "interrupted");
        field->engines[field->count] = engines[i];
        neph_engine_probe(engines[i], &field->infos[field->count++]);
    }
    return NEPH_OK;
}

static json_t *engines_json(const struct field *field)
{
    json_t *list = json_array();
    for (int i = 0; i < field->count; i++) {
        const struct neph_engine *engine = field->engines[i];
        const struct neph_engine_info *info = &field->infos[i];
        neph_json_add(&list, json_pack("{s:s, s:s, s:s, s:s?, s:b, s:b, s:s, s:s, s:s, s:s}",
                                       "name", engine->name, "summary", engine->summary, "rung",
                                       neph_rung_name(engine->rung), "bias", engine->bias,
                                       "available", info->available, "broken", info->broken,
                                       "version", info->version, "device", info->device, "missing",
                                       info->missing, "install_line", info->install_line));
    }
    return list;
}

/* `study` is taken over; NULL: none was made. */
static json_t *frame_json(const struct neph_job *job, const struct neph_job_result *result,
                          json_t *study)
{
    const struct neph_engine *engine = job->engine;
    const double depth = neph_step_depth(&job->shot, engine);
    return json_pack(
        "{s:s, s:s, s:s, s:s, s:s, s:s, s:b, s:f, s:f, s:f, s:I, s:I, s:o, s:s?, s:n, s:n, "
        "s:{s:n, s:n}, s:[], s:o, s:b, s:n}",
        "engine", engine->name, "rung", neph_rung_name(engine->rung), "status",
        neph_outcome_name(result->outcome), "reason", result->reason, "note", result->note,
        "settings", result->settings, "reused", result->reused, "render_s", result->cost.render_s,
        "wall_s", result->cost.wall_s, "cpu_s", result->cost.cpu_s, "peak_memory_bytes",
        (json_int_t)result->cost.peak_memory_bytes, "seed", (json_int_t)job->shot.seed,
        "step_optical_depth", isfinite(depth) ? json_real(depth) : json_null(), "exr",
        result->frame_path, "exr_second", "picture", "difference", "radiance", "transmittance",
        "measurements", "study", study ? study : json_null(), "look", engine->look, "bake");
}

/* Measure one rendered frame, against the truth when there is one. */
static enum neph_status measure_frame(json_t *frame, const struct neph_image *truth,
                                      const struct neph_viewing *viewing, struct neph_diag *diag)
{
    const char *path = json_string_value(json_object_get(frame, "exr"));
    if (!path)
        return NEPH_OK;
    struct neph_image *image = NULL;
    enum neph_status status = neph_exr_read(path, &image, diag);
    json_t *measurements = json_object_get(frame, "measurements");
    if (!status)
        status = neph_json_put(frame, "bake", neph_bakes_of_frame(image), diag);
    if (!status)
        status = neph_measure_validity(image, measurements, diag);
    if (!status && truth)
        status = neph_measure(truth, image, NULL, viewing, measurements, diag);
    neph_image_destroy(image);
    return status;
}

/* The rendered frame of the highest rung that is truth (exact or a tracer); NULL when none is. */
static const json_t *find_truth(const json_t *frames)
{
    for (size_t i = 0; i < json_array_size(frames); i++) {
        const json_t *frame = json_array_get(frames, i);
        const char *rung = json_string_value(json_object_get(frame, "rung"));
        if (json_is_string(json_object_get(frame, "exr")) &&
            (strcmp(rung, neph_rung_name(NEPH_RUNG_EXACT)) == 0 ||
             strcmp(rung, neph_rung_name(NEPH_RUNG_TRACER)) == 0))
            return frame;
    }
    return NULL;
}

static const json_t *frame_of_engine(const json_t *frames, const char *engine)
{
    for (size_t i = 0; i < json_array_size(frames); i++) {
        const json_t *frame = json_array_get(frames, i);
        if (strcmp(json_string_value(json_object_get(frame, "engine")), engine) == 0)
            return frame;
    }
    return NULL;
}

/* A limit was set for what the engine does with all its samples: a frame that got fewer may keep
 * it, but cannot break it. */
static json_t *unjudged_gate_json(const struct neph_gate *gate, const char *quantity,
                                  const char *note)
{
    char reason[NEPH_JOB_NOTE_SIZE + 64];
    snprintf(reason, sizeof(reason), "not judged: %s", note);
    return json_pack("{s:s, s:s, s:s, s:s, s:n, s:f, s:s, s:s}", "engine", gate->engine, "quantity",
                     quantity, "metric", gate->metric, "mask", gate->mask, "value", "maximum",
                     gate->maximum, "verdict", "not_measured", "reason", reason);
}

/* A gate is not measured where its engine is missing, cannot, or is itself the truth; a frame that
 * was there to be measured and has no such number does not pass it. */
static json_t *gate_json(const struct neph_gate *gate, const json_t *frames, const json_t *truth)
{
    const char *quantity = neph_gate_quantity_name(gate->quantity);
    const json_t *frame = frame_of_engine(frames, gate->engine);
    const json_t *measurement = neph_measurement_find(json_object_get(frame, "measurements"),
                                                      quantity, gate->metric, gate->mask);
    const json_t *value = json_object_get(measurement, "value");
    const bool measured = json_is_number(value);
    const bool owed = truth && frame != truth && json_is_string(json_object_get(frame, "exr"));
    const bool kept = measured && fabs(json_number_value(value)) <= gate->maximum;
    const char *note = neph_json_text(frame, "note");
    if (measured && !kept && note[0])
        return unjudged_gate_json(gate, quantity, note);
    const char *verdict = kept ? "pass" : measured || owed ? "fail" : "not_measured";
    return json_pack("{s:s, s:s, s:s, s:s, s:o, s:f, s:s, s:s}", "engine", gate->engine, "quantity",
                     quantity, "metric", gate->metric, "mask", gate->mask, "value",
                     measured ? json_real(json_number_value(value)) : json_null(), "maximum",
                     gate->maximum, "verdict", verdict, "reason", gate->reason);
}

/* The colour scale of difference maps, the same in every run: 2 % of the display's white for
 * radiance, 0.002 for transmittance, a few times what the gates of the catalogue allow. */
static json_t *difference_scale_json(const struct neph_scene *scene)
{
    return json_pack("{s:f, s:f}", "radiance", 0.02 * exp2(-scene->exposure_ev), "transmittance",
                     0.002);
}

static enum neph_status scene_document(const struct neph_scene *scene, int frame_index,
                                       json_t *frames, json_t **document, struct neph_diag *diag)
{
    const json_t *truth = find_truth(frames);
    struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    viewing.exposure_ev = scene->exposure_ev;
    struct neph_image *truth_image = NULL;
    enum neph_status status = NEPH_OK;
    if (truth)
        status = neph_exr_read(json_string_value(json_object_get(truth, "exr")), &truth_image,
                               diag);
    if (truth_image)
        status = neph_scene_layers_add(scene, frame_index, truth_image, diag);
    for (size_t i = 0; i < json_array_size(frames) && !status; i++) {
        json_t *frame = json_array_get(frames, i);
        status = measure_frame(frame, frame == truth ? NULL : truth_image, &viewing, diag);
    }
    neph_image_destroy(truth_image);
    if (status)
        return status;
    json_t *gates = json_array();
    for (int i = 0; i < scene->gate_count; i++)
        neph_json_add(&gates, gate_json(&scene->gates[i], frames, truth));
    json_t *truth_json = truth ? json_pack("{s:O, s:O}", "engine", json_object_get(truth, "engine"),
                                           "rung", json_object_get(truth, "rung"))
                               : json_null();
    *document = json_pack("{s:s, s:s, s:s, s:f, s:o, s:s, s:o, s:o, s:O, s:o}", "name", scene->name,
                          "title", scene->title, "physics", scene->physics, "exposure_ev",
                          scene->exposure_ev, "viewing", neph_viewing_json(&viewing), "hash",
                          scene->hash, "truth", truth_json, "difference_scale",
                          difference_scale_json(scene), "frames", frames, "gates", gates);
    return neph_json_check(*document, diag);
}

/* The frame that is rendered: the one that was asked for, or the last. */
static int frame_of(const struct neph_validate_params *params, const struct neph_scene *scene)
{
    return params->frame < scene->frame_count ? params->frame : scene->frame_count - 1;
}

static struct neph_job job_of(const struct run *run, int index, const struct neph_scene *scene,
                              uint64_t seed)
{
    const struct neph_engine *engine = run->field.engines[index];
    return (struct neph_job){
        .engine = engine,
        .info = &run->field.infos[index],
        .shot = {.scene = scene,
                 .settings = neph_settings_default(engine),
                 .width_px = run->params->width_px,
                 .height_px = run->params->height_px,
                 .frame = frame_of(run->params, scene),
                 .layers = NEPH_LAYERS_ALL,
                 .seed = seed},
    };
}

static enum neph_status make_study(const struct run *run, const struct neph_job *job,
                                   json_t **study, struct neph_diag *diag)
{
    struct neph_job small = neph_studies_job(job);
    struct neph_study made;
    enum neph_outcome outcome;
    char reason[1600];
    small.shot.time_limit_s = run->params->budget_s;
    const enum neph_status status = neph_study_run(&small, run->store, &made, &outcome, reason,
                                                   diag);
    if (status || outcome != NEPH_OUTCOME_RENDERED)
        return status; /* the frame itself will say why */
    *study = neph_study_json(&made);
    neph_json_set(study, "size_px", json_pack("[i,i]", small.shot.width_px, small.shot.height_px));
    return neph_json_check(*study, diag);
}

/* Other people's renderers march in steps of our choice: a study chooses them, one that comes with
 * neph or one that is made now, and its bias stands beside the frame. `*study` is NULL where there
 * is nothing to study. */
static enum neph_status choose_step(const struct run *run, struct neph_job *job, json_t **study,
                                    struct neph_diag *diag)
{
    *study = NULL;
    if (job->engine->rung != NEPH_RUNG_WITNESS || !job->info->available ||
        !neph_study_applies(job->engine, job->shot.scene))
        return NEPH_OK;
    enum neph_status status = neph_studies_find(job, study, diag);
    if (!status && !*study)
        status = make_study(run, job, study, diag);
    if (!status && *study)
        status = neph_studies_apply(*study, job->engine, &job->shot.settings, diag);
    if (status) {
        json_decref(*study);
        *study = NULL;
    }
    return status;
}

/* A step that is too long shows in no picture. */
static void warn_of_steps(const struct neph_job *job)
{
    char *warning = neph_step_depth_warning(neph_step_depth(&job->shot, job->engine), job->engine);
    if (warning)
        fprintf(stderr, "warning: %s: %s\n", job->shot.scene->name, warning);
    free(warning);
}

/* One picture; witnesses within their budget. */
static enum neph_status render(const struct run *run, struct neph_job *job,
                               struct neph_job_result *result, struct neph_diag *diag)
{
    return job->engine->rung == NEPH_RUNG_WITNESS
               ? neph_budget_run(job, run->params->budget_s, run->store, result, diag)
               : neph_job_run(job, run->store, result, diag);
}

static enum neph_status run_frame(struct run *run, int index, const struct neph_scene *scene,
                                  json_t *frames, struct neph_settings *chosen,
                                  struct neph_diag *diag)
{
    struct neph_job job = job_of(run, index, scene, neph_seed_of(scene, 1));
    char what[256];
    snprintf(what, sizeof(what), "%s with %s", scene->name, job.engine->name);
    run->progress.kind = KIND_FRAME + index;
    neph_progress_begin(&run->progress, what);
    const double start_s = neph_wall_s();
    struct neph_job_result result = {.outcome = NEPH_OUTCOME_FAILED};
    json_t *study = NULL;
    enum neph_status status = choose_step(run, &job, &study, diag);
    if (!status)
        status = render(run, &job, &result, diag);
    *chosen = job.shot.settings;
    if (status)
        json_decref(study);
    else
        status = neph_json_append(frames, frame_json(&job, &result, study), diag);
    if (!status)
        warn_of_steps(&job);
    if (!status)
        neph_progress_step(&run->progress, what,
                           result.reused ? "reused" : neph_outcome_name(result.outcome),
                           neph_wall_s() - start_s);
    neph_job_result_finish(&result);
    return status;
}

static bool is_rendered(const json_t *frame)
{
    return json_is_string(json_object_get(frame, "exr"));
}

static enum neph_status run_second_seed(struct run *run, int index, const struct neph_scene *scene,
                                        json_t *frame, const struct neph_settings *chosen,
                                        struct neph_diag *diag)
{
    struct neph_job job = job_of(run, index, scene, neph_seed_of(scene, 2));
    job.shot.settings = *chosen;
    job.shot.time_limit_s = SECOND_SEED_PATIENCE * run->params->budget_s;
    char what[256];
    snprintf(what, sizeof(what), "%s with %s, second seed", scene->name, job.engine->name);
    run->progress.kind = KIND_SECOND_SEED + index;
    neph_progress_begin(&run->progress, what);
    const double start_s = neph_wall_s();
    struct neph_job_result result;
    enum neph_status status = neph_job_run(&job, run->store, &result, diag);
    if (!status && result.frame_path)
        status = neph_json_put(frame, "exr_second", json_string(result.frame_path), diag);
    if (!status)
        neph_progress_step(&run->progress, what,
                           result.reused ? "reused" : neph_outcome_name(result.outcome),
                           neph_wall_s() - start_s);
    neph_job_result_finish(&result);
    return status;
}

/* A shortcut stands against the engine whose model it renders; whom it differs from else is no
 * question. */
static bool is_peer(const struct run *run, int index)
{
    return !run->field.engines[index]->shortcut_of;
}

static bool has_second_seed(const struct run *run, int index)
{
    return run->field.engines[index]->stochastic && is_peer(run, index);
}

/* Who disagrees with whom, of those that are peers. */
static enum neph_status attribute(const struct run *run, const json_t *frames, json_t **attribution,
                                  struct neph_diag *diag)
{
    json_t *peers = json_array();
    for (int i = 0; i < run->field.count; i++)
        if (is_peer(run, i))
            neph_json_add(&peers, json_incref(json_array_get(frames, (size_t)i)));
    enum neph_status status = neph_json_check(peers, diag);
    if (!status)
        status = neph_attribute(peers, attribution, diag);
    json_decref(peers);
    return status;
}

/* A second seed of every stochastic engine, where there are three engines to tell apart. */
static enum neph_status run_second_seeds(struct run *run, const struct neph_scene *scene,
                                         json_t *frames, const struct neph_settings *chosen,
                                         struct neph_diag *diag)
{
    int rendered = 0;
    for (int i = 0; i < run->field.count; i++)
        rendered += is_peer(run, i) && is_rendered(json_array_get(frames, (size_t)i));
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < run->field.count && !status; i++) {
        json_t *frame = json_array_get(frames, (size_t)i);
        if (!has_second_seed(run, i))
            continue;
        if (rendered >= 3 && is_rendered(frame))
            status = run_second_seed(run, i, scene, frame, &chosen[i], diag);
        else
            neph_progress_expect(&run->progress, KIND_SECOND_SEED + i, -1, 0.0);
    }
    return status;
}

static enum neph_status run_scene(struct run *run, const struct neph_scene *scene,
                                  json_t **document, struct neph_diag *diag)
{
    json_t *frames = json_array(), *attribution = NULL;
    struct neph_settings chosen[ENGINES_MAX];
    enum neph_status status = neph_json_check(frames, diag);
    for (int i = 0; i < run->field.count && !status; i++)
        status = run_frame(run, i, scene, frames, &chosen[i], diag);
    if (!status)
        status = run_second_seeds(run, scene, frames, chosen, diag);
    if (!status)
        status = attribute(run, frames, &attribution, diag);
    if (!status)
        status = scene_document(scene, frame_of(run->params, scene), frames, document, diag);
    if (!status)
        status = neph_json_put(*document, "attribution", json_incref(attribution), diag);
    json_decref(attribution);
    json_decref(frames);
    return status;
}

/* What a verdict stands on. */
struct counts {
    int expected; /* frames: scenes that are here times engines */
    int reported; /* of them in the report, with their outcome */
    int compared; /* of these, measured against the truth */
};

static bool is_compared(const json_t *frame, const json_t *truth)
{
    const char *engine = json_string_value(json_object_get(truth, "engine"));
    return engine && json_is_string(json_object_get(frame, "exr")) &&
           strcmp(neph_json_text(frame, "engine"), engine) != 0;
}

static struct counts count_frames(const json_t *scenes, int expected)
{
    struct counts counts = {.expected = expected};
    for (size_t i = 0; i < json_array_size(scenes); i++) {
        const json_t *scene = json_array_get(scenes, i);
        const json_t *frames = json_object_get(scene, "frames");
        counts.reported += (int)json_array_size(frames);
        for (size_t j = 0; j < json_array_size(frames); j++)
            counts.compared += is_compared(json_array_get(frames, j),
                                           json_object_get(scene, "truth"));
    }
    return counts;
}

/* Of a frame, or of a row or the reference of a sequence. */
static bool is_broken(const json_t *item)
{
    const char *outcome = neph_json_text(item, "status");
    return strcmp(outcome, neph_outcome_name(NEPH_OUTCOME_FAILED)) == 0 ||
           strcmp(outcome, neph_outcome_name(NEPH_OUTCOME_TIMEOUT)) == 0;
}

static bool sequences_pass(const json_t *sequences)
{
    for (size_t i = 0; i < json_array_size(sequences); i++) {
        const json_t *sequence = json_array_get(sequences, i);
        const json_t *rows = json_object_get(sequence, "rows");
        if (is_broken(json_object_get(sequence, "reference")))
            return false;
        for (size_t r = 0; r < json_array_size(rows); r++)
            if (is_broken(json_array_get(rows, r)))
                return false;
    }
    return true;
}

/* A failed gate or an engine that broke fails the run; a missing one does not. Nor does a run pass
 * that lost a frame or compared none. */
static bool document_passes(const json_t *document, const struct counts *counts)
{
    const json_t *scenes = json_object_get(document, "scenes");
    if (counts->reported != counts->expected || counts->compared == 0 ||
        !sequences_pass(json_object_get(document, "sequences")))
        return false;
    for (size_t i = 0; i < json_array_size(scenes); i++) {
        const json_t *scene = json_array_get(scenes, i);
        const json_t *gates = json_object_get(scene, "gates");
        for (size_t j = 0; j < json_array_size(gates); j++)
            if (strcmp(json_string_value(json_object_get(json_array_get(gates, j), "verdict")),
                       "fail") == 0)
                return false;
        const json_t *frames = json_object_get(scene, "frames");
        for (size_t j = 0; j < json_array_size(frames); j++) {
            if (is_broken(json_array_get(frames, j)))
                return false;
        }
    }
    return true;
}

json_t *neph_host_json(void)
{
    char line[512], cpu[256] = "unknown";
    FILE *file = fopen("/proc/cpuinfo", "re");
    while (file && fgets(line, sizeof(line), file))
        if (sscanf(line, "model name : %255[^\n]", cpu) == 1)
            break;
    if (file)
        fclose(file);
    neph_text_clean(cpu, sizeof(cpu));
    const json_int_t memory_bytes = (json_int_t)sysconf(_SC_PHYS_PAGES) *
                                    (json_int_t)sysconf(_SC_PAGE_SIZE);
    return json_pack("{s:s, s:i, s:I}", "cpu", cpu, "cores", neph_processor_count(), "memory_bytes",
                     memory_bytes);
}

/* A scene whose data is not on this machine; the diag is used up. */
static json_t *absent_json(const char *name, struct neph_diag *diag)
{
    json_t *absent = json_pack("{s:o, s:s, s:s}", "scene", neph_json_cleaned(name), "reason",
                               diag->message, "hint", diag->hint);
    *diag = (struct neph_diag){.line = 0};
    return absent;
}

/* ---- the document as it grows ---------------------------------------------------------------- */

static json_t *part_of(const struct run *run, const char *key)
{
    return json_object_get(run->document, key);
}

static enum neph_status begin_document(struct run *run, struct neph_diag *diag)
{
    char created[32];
    neph_utc_now(created);
    run->document = json_pack("{s:s, s:s, s:s, s:s, s:o, s:[i,i], s:o, s:[], s:[], s:[], s:[]}",
                              "format", "neph-report-1", "title", "Nephelometer validation",
                              "created_utc", created, "neph_version", NEPH_VERSION, "host",
                              neph_host_json(), "size_px", run->params->width_px,
                              run->params->height_px, "engines", engines_json(&run->field),
                              "scenes", "absent", "sequences", "charts");
    return neph_json_check(run->document, diag);
}

/* The verdict, and what it stands on. */
static enum neph_status judge(struct run *run, const char *verdict, struct neph_diag *diag)
{
    const int here = run->params->scene_count - run->absent_count;
    const struct counts counts = count_frames(part_of(run, "scenes"), here * run->field.count);
    if (!verdict)
        verdict = document_passes(run->document, &counts) ? "pass" : "fail";
    return neph_json_merge(run->document,
                           json_pack("{s:s, s:f, s:{s:i, s:i, s:i}}", "verdict", verdict, "seconds",
                                     neph_wall_s() - run->start_s, "counts", "expected",
                                     counts.expected, "reported", counts.reported, "compared",
                                     counts.compared),
                           diag);
}

/* What a page says that is written before the run is over: how far it is. */
static enum neph_status judge_so_far(struct run *run, const char *verdict, struct neph_diag *diag)
{
    int done, total;
    neph_progress_count(&run->progress, &done, &total);
    const double left_s = neph_progress_left_s(&run->progress);
    json_t *progress = json_pack("{s:i, s:i, s:o}", "done", done, "total", total, "left_s",
                                 left_s >= 0.0 ? json_real(left_s) : json_null());
    enum neph_status status = judge(run, verdict, diag);
    if (status)
        json_decref(progress);
    return status ? status : neph_json_put(run->document, "progress", progress, diag);
}

static enum neph_status show(struct run *run, struct neph_diag *diag)
{
    if (!run->params->show)
        return NEPH_OK;
    const enum neph_status status = judge_so_far(run, "running", diag);
    return status ? status : run->params->show(run->document, run->params->context, diag);
}

/* ---- the run --------------------------------------------------------------------------------- */

static void expect_all(struct run *run)
{
    const struct neph_validate_params *params = run->params;
    struct neph_progress *progress = &run->progress;
    for (int i = 0; i < run->field.count; i++) {
        const struct neph_engine *engine = run->field.engines[i];
        const double guess_s = run->field.infos[i].available ? engine->typical_s : 0.0;
        neph_progress_expect(progress, KIND_FRAME + i, params->scene_count, guess_s);
        if (has_second_seed(run, i))
            neph_progress_expect(progress, KIND_SECOND_SEED + i, params->scene_count, guess_s);
    }
    if (params->charts)
        neph_progress_expect(progress, KIND_CHART, neph_charts_step_count(params->charts),
                             NEPH_CHARTS_STEP_TYPICAL_S * params->charts->repeats);
    if (params->over_time)
        neph_progress_expect(progress, KIND_OVER_TIME, neph_over_time_step_count(),
                             NEPH_OVER_TIME_STEP_TYPICAL_S);
}

/* A scene that is not here takes its steps away. */
static enum neph_status leave_out(struct run *run, const char *name, struct neph_diag *diag)
{
    json_t *item = absent_json(name, diag);
    run->absent_count++;
    for (int i = 0; i < run->field.count; i++) {
        neph_progress_expect(&run->progress, KIND_FRAME + i, -1, 0.0);
        if (has_second_seed(run, i))
            neph_progress_expect(&run->progress, KIND_SECOND_SEED + i, -1, 0.0);
    }
    return neph_json_append(part_of(run, "absent"), item, diag);
}

static enum neph_status run_scenes(struct run *run, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < run->params->scene_count && !status; i++) {
        struct neph_scene *scene = NULL;
        json_t *part = NULL;
        status = neph_data_load_scene(run->params->scenes[i], &scene, diag);
        if (status == NEPH_ERR_NOT_FOUND && run->params->skip_absent) {
            status = leave_out(run, run->params->scenes[i], diag);
            continue;
        }
        if (!status)
            status = run_scene(run, scene, &part, diag);
        if (!status)
            status = neph_json_append(part_of(run, "scenes"), part, diag);
        if (!status)
            status = show(run, diag);
        neph_scene_destroy(scene);
    }
    return status;
}

static enum neph_status run_all(struct run *run, struct neph_diag *diag)
{
    enum neph_status status = run_scenes(run, diag);
    run->progress.kind = KIND_OVER_TIME;
    if (!status && run->params->over_time)
        status = neph_over_time_run(run->store, &run->progress, part_of(run, "sequences"), diag);
    if (!status && run->params->over_time)
        status = show(run, diag);
    run->progress.kind = KIND_CHART;
    if (!status && run->params->charts)
        status = neph_charts_run(run->params->charts, run->store, &run->progress,
                                 part_of(run, "charts"), diag);
    return status;
}

enum neph_status neph_validate(const struct neph_validate_params *params, struct neph_store *store,
                               json_t **document, struct neph_diag *diag)
{
    struct run run = {.params = params, .store = store, .start_s = neph_wall_s()};
    enum neph_status status = neph_data_check_scenes(params->scenes, params->scene_count, diag);
    if (!status)
        status = choose_engines(params, &run.field, diag);
    if (!status)
        status = begin_document(&run, diag);
    if (status)
        return status;
    run.progress = neph_progress_start(params->quiet, 0);
    expect_all(&run);
    status = run_all(&run, diag);
    neph_progress_end(&run.progress);
    if (status == NEPH_ERR_INTERRUPTED) {
        if (judge_so_far(&run, "interrupted", NULL) == NEPH_OK)
            *document = json_incref(run.document);
    } else if (!status) {
        json_object_del(run.document, "progress");
        status = judge(&run, NULL, diag);
        if (!status)
            *document = json_incref(run.document);
    }
    json_decref(run.document);
    return status;
}

/* ---- for a terminal -------------------------------------------------------------------------- */

static void print_number(const json_t *measurements, const char *quantity, const char *metric)
{
    const json_t *value = json_object_get(
        neph_measurement_find(measurements, quantity, metric, "all"), "value");
    if (json_is_number(value))
        printf(" %11.3e", json_number_value(value));
    else
        printf(" %11s", "-");
}

static const char *gates_of_engine(const json_t *gates, const char *engine, char text[32])
{
    int passed = 0, failed = 0;
    for (size_t i = 0; i < json_array_size(gates); i++) {
        const json_t *gate = json_array_get(gates, i);
        const char *verdict = json_string_value(json_object_get(gate, "verdict"));
        if (strcmp(json_string_value(json_object_get(gate, "engine")), engine) != 0)
            continue;
        passed += strcmp(verdict, "pass") == 0;
        failed += strcmp(verdict, "fail") == 0;
    }
    if (passed + failed == 0)
        return "-";
    if (failed > 0)
        snprintf(text, 32, "FAIL %d of %d", failed, passed + failed);
    else
        snprintf(text, 32, "pass %d", passed);
    return text;
}

/* Below the numbers of a frame that was rendered from voxels: what the voxels alone cost. */
static void print_bake(const json_t *bake)
{
    const double off = json_number_value(json_object_get(bake, "transmittance_max"));
    if (!json_is_object(bake))
        return;
    printf("%38s of %s: ", "", json_string_value(json_object_get(bake, "grid")));
    if (off > 0.0)
        printf("off by up to %.1e of transmittance, extinction by %.1e rms\n", off,
               json_number_value(json_object_get(bake, "extinction_rms_relative")));
    else
        printf("nothing is lost\n");
}

/* The step that a study chose, and what it leaves. */
static void print_study(const json_t *study)
{
    if (!json_is_object(study))
        return;
    const size_t chosen = (size_t)json_integer_value(json_object_get(study, "chosen"));
    const json_t *level = json_array_get(json_object_get(study, "levels"), chosen);
    printf("%38s %s = %g by a study: step bias %+.3f %% +- %.3f %% (%s)\n", "",
           json_string_value(json_object_get(study, "option")),
           json_number_value(json_object_get(level, "setting")),
           100.0 * json_number_value(json_object_get(level, "bias")),
           100.0 * json_number_value(json_object_get(level, "bias_noise")),
           json_string_value(json_object_get(study, "verdict")));
}

void neph_validate_print(const json_t *document)
{
    printf("%-24s %-13s %-9s %11s %11s %11s %8s  %s\n", "scene", "engine", "outcome", "L rel_bias",
           "L rel_rmse", "T max_abs", "seconds", "gates");
    const json_t *scenes = json_object_get(document, "scenes");
    for (size_t i = 0; i < json_array_size(scenes); i++) {
        const json_t *scene = json_array_get(scenes, i);
        const json_t *frames = json_object_get(scene, "frames");
        for (size_t j = 0; j < json_array_size(frames); j++) {
            const json_t *frame = json_array_get(frames, j);
            const json_t *measurements = json_object_get(frame, "measurements");
            const char *engine = json_string_value(json_object_get(frame, "engine"));
            char gates[32];
            printf("%-24s %-13s %-9s", json_string_value(json_object_get(scene, "name")), engine,
                   json_string_value(json_object_get(frame, "status")));
            print_number(measurements, "radiance", "rel_bias");
            print_number(measurements, "radiance", "rel_rmse");
            print_number(measurements, "transmittance", "max_abs");
            printf(" %8.2f  %s\n", json_number_value(json_object_get(frame, "wall_s")),
                   gates_of_engine(json_object_get(scene, "gates"), engine, gates));
            print_bake(json_object_get(frame, "bake"));
            print_study(json_object_get(frame, "study"));
        }
    }
    const json_t *list = json_object_get(document, "absent");
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *absent = json_array_get(list, i);
        printf("%-24s not here: %s\n", json_string_value(json_object_get(absent, "scene")),
               json_string_value(json_object_get(absent, "reason")));
    }
}
