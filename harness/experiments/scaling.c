/* SPDX-License-Identifier: MIT
 *
 * `neph scaling SCENE`: growth of the cost with pixels, steps, voxels, density and number of
 * frames.
 */
#include "harness/experiments/experiments.h"

#include "harness/engines/engines.h"
#include "harness/sweep/scaling.h"

#include <math.h>
#include <string.h>

/* Compiles only when this file handles every verdict. */
_Static_assert(NEPH_EXPONENT_VERDICTS == 4, "a new kind");

struct request {
    struct neph_cli_shared shared;
    struct neph_scaling_params params;
    const char *against;
    json_t *there; /* contents of the file `against`; owned */
};

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"preset", 0, NULL, "Preset of realtime, beside the march; PRESET+KEY=VALUE changes it",
     NEPH_CLI_ONE, AT(params.preset), "ours"},
    {"other-device", 0, "FILE", "scaling.json of another device: times of the same frames there",
     NEPH_CLI_WORD, AT(against)},
    {"untimed", 0, NULL, "No times: only evaluations of density", NEPH_CLI_FLAG,
     AT(params.untimed)},
    {"retime", 0, NULL, "Repeat the timings that DIR/times.json has", NEPH_CLI_FLAG,
     AT(params.remeasures_times)},
    {"seed", 0, NULL, "Seed of all that is random", NEPH_CLI_INTEGER, AT(params.seed), "1", 1,
     1000000},
    {.name = "size", .help = "Of the largest frame", .otherwise = "192x108"},
    {.name = "output",
     .help = "Folder of the store and of scaling.json",
     .otherwise = "out/scaling"},
    {.name = "jobs", .otherwise = "1"},
    {.name = "all", .help = "The table of all exponents"},
    {.name = "json"},
    {.name = "quiet"},
    {.name = NULL},
};
#undef AT

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    if (request->against && request->shared.json)
        argp_error(state, "--other-device is of the table, not of --json");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .check = check,
    .operands = &neph_cli_one_scene,
    .doc = "Measure how cost grows with pixels, steps, voxels, density and the number of frames, "
           "and whether it grows as expected.\vEach is changed by itself, for the ray marcher "
           "and a preset of realtime at 32 steps. Density evaluations are counted and the same "
           "on every device. Milliseconds are measured on the device that NEPH_VULKAN_DEVICE "
           "names, in rounds over all points: keep the machine quiet. The exponent of each cost "
           "has a 95 % interval; --all prints the expected exponent and the reason.\n\n"
           "Examples:\n"
           "  neph scaling cloud_below --untimed\n"
           "  neph scaling voxel_grid -o here\n"
           "  NEPH_VULKAN_DEVICE=nvidia neph scaling voxel_grid -o there --other-device "
           "here/scaling.json",
};

static enum neph_status prepare(void *request_, struct neph_diag *diag)
{
    struct request *request = request_;
    const struct neph_cli_shared *shared = &request->shared;
    struct neph_scaling_params *params = &request->params;
    params->scene = shared->operands[0];
    params->width_px = shared->size.width_px;
    params->height_px = shared->size.height_px;
    params->quiet = shared->quiet || shared->json;
    params->jobs = shared->jobs;
    const enum neph_status status = neph_engine_check_size(
        neph_engine_find("march"), params->width_px, params->height_px, diag);
    return status || !request->against ? status
                                       : neph_scaling_load(request->against, &request->there, diag);
}

/* ---- the table ------------------------------------------------------------------------------- */

static void print_number(double value, FILE *out)
{
    char text[32] = "-";
    if (isfinite(value))
        snprintf(text, sizeof(text), "%.4g", value);
    fprintf(out, " %11s", text);
}

static void print_exponent(const char *what, const struct neph_exponent *exponent,
                           struct neph_exponent_range range, enum neph_exponent_verdict verdict,
                           FILE *out)
{
    if (verdict == NEPH_EXPONENT_NONE)
        return;
    fprintf(out, "  %s ~ x^%.3f [%.3f, %.3f], wanted ", what, exponent->value, exponent->low,
            exponent->high);
    if (range.low == range.high)
        fprintf(out, "%.2g", range.low);
    else
        fprintf(out, "%.2g to %.2g", range.low, range.high);
    fprintf(out, ": %s\n", neph_exponent_verdict_words[verdict]);
}

static void print_line(const struct neph_scaling *scaling, const struct neph_scaling_line *line,
                       FILE *out)
{
    const struct neph_scaling_axis *axis = &neph_scaling_axes[line->axis];
    fprintf(out, "\n%s: cost against %s\n", scaling->series[line->series], axis->title);
    if (line->missing[0]) {
        fprintf(out, "  none: %s\n", line->missing);
        return;
    }
    fprintf(out, "  %11s %11s %11s\n", "x", "evaluations", "ms");
    for (int i = 0; i < line->count; i++) {
        fprintf(out, " ");
        print_number(line->points[i].x, out);
        print_number(line->points[i].evaluations, out);
        print_number(1e3 * line->points[i].time.median, out);
        fprintf(out, "\n");
    }
    print_exponent("evaluations", &line->work, axis->work, line->work_verdict, out);
    print_exponent("ms", &line->time, axis->time, line->time_verdict, out);
}

static void print_lines(const struct neph_scaling *scaling, FILE *out)
{
    fprintf(out, "%s; %s\n", scaling->scene, scaling->device);
    for (int i = 0; i < scaling->line_count; i++)
        print_line(scaling, &scaling->lines[i], out);
    fprintf(out, "\n");
    for (int axis = 0; axis < NEPH_SCALING_AXES; axis++)
        fprintf(out, "%s: %s.\n", neph_scaling_axes[axis].name, neph_scaling_axes[axis].reason);
    if (scaling->has_closed_form)
        fprintf(out, "All media have closed forms: engine exact marches no ray, and evaluates no "
                     "density, whatever there is of them.\n");
    fprintf(out,
            "Intervals: 95 %%, Student's t, of the scatter about the line; \"as expected\": within "
            "%.2g of the expected exponent.\n",
            NEPH_EXPONENT_SAME);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *exponent_json(const struct neph_exponent *exponent, struct neph_exponent_range range,
                             enum neph_exponent_verdict verdict)
{
    return json_pack("{s:o, s:o, s:o, s:[f,f], s:s}", "exponent", neph_json_number(exponent->value),
                     "low", neph_json_number(exponent->low), "high",
                     neph_json_number(exponent->high), "wanted", range.low, range.high, "verdict",
                     neph_exponent_verdict_words[verdict]);
}

static json_t *line_json(const struct neph_scaling *scaling, const struct neph_scaling_line *line)
{
    const struct neph_scaling_axis *axis = &neph_scaling_axes[line->axis];
    json_t *points = json_array();
    for (int i = 0; i < line->count; i++) {
        const struct neph_scaling_point *point = &line->points[i];
        neph_json_add(&points, json_pack("{s:f, s:o, s:o, s:o, s:o}", "x", point->x, "evaluations",
                                         neph_json_number(point->evaluations), "seconds",
                                         neph_json_number(point->time.median), "seconds_low",
                                         neph_json_number(point->time.low), "seconds_high",
                                         neph_json_number(point->time.high)));
    }
    return json_pack("{s:s, s:s, s:o, s:o, s:o, s:o}", "series", scaling->series[line->series],
                     "axis", axis->name, "points", points, "work",
                     exponent_json(&line->work, axis->work, line->work_verdict), "time",
                     exponent_json(&line->time, axis->time, line->time_verdict), "missing",
                     line->missing[0] ? neph_json_cleaned(line->missing) : json_null());
}

static json_t *scaling_json(const struct neph_scaling *scaling)
{
    json_t *lines = json_array();
    for (int i = 0; i < scaling->line_count; i++)
        neph_json_add(&lines, line_json(scaling, &scaling->lines[i]));
    return json_pack("{s:s, s:s, s:s, s:[i, i], s:s, s:b, s:o}", "format", "neph-scaling-1",
                     "scene", scaling->scene, "scene_hash", scaling->scene_hash, "size_px",
                     scaling->width_px, scaling->height_px, "device", scaling->device,
                     "has_closed_form", scaling->has_closed_form, "lines", lines);
}

/* ---- another device -------------------------------------------------------------------------- */

/* The time of the same frame on the other device; NaN: not timed. */
static double seconds_there(const json_t *document, const char *series, const char *axis, double x)
{
    const json_t *lines = json_object_get(document, "lines");
    for (size_t i = 0; i < json_array_size(lines); i++) {
        const json_t *line = json_array_get(lines, i);
        const json_t *points = json_object_get(line, "points");
        if (strcmp(neph_json_text(line, "series"), series) != 0 ||
            strcmp(neph_json_text(line, "axis"), axis) != 0)
            continue;
        for (size_t k = 0; k < json_array_size(points); k++) {
            const json_t *point = json_array_get(points, k);
            const json_t *seconds = json_object_get(point, "seconds");
            if (json_number_value(json_object_get(point, "x")) == x && json_is_number(seconds))
                return json_number_value(seconds);
        }
    }
    return NAN;
}

static void print_against(const struct neph_scaling *scaling, const json_t *document, FILE *out)
{
    fprintf(out, "\nhere: %s\nthere: %s\n%-16s %-9s %11s %11s %11s %11s\n", scaling->device,
            neph_json_text(document, "device"), "series", "axis", "x", "ms here", "ms there",
            "there/here");
    for (int i = 0; i < scaling->line_count; i++)
        for (int k = 0; k < scaling->lines[i].count; k++) {
            const struct neph_scaling_line *line = &scaling->lines[i];
            const struct neph_scaling_point *point = &line->points[k];
            const char *series = scaling->series[line->series];
            const char *axis = neph_scaling_axes[line->axis].name;
            const double there_s = seconds_there(document, series, axis, point->x);
            if (isnan(there_s) || isnan(point->time.median))
                continue;
            fprintf(out, "%-16s %-9s", series, axis);
            print_number(point->x, out);
            print_number(1e3 * point->time.median, out);
            print_number(1e3 * there_s, out);
            print_number(there_s / point->time.median, out);
            fprintf(out, "\n");
        }
}

static int read_side_px(const json_t *document, size_t side)
{
    return (int)json_integer_value(json_array_get(json_object_get(document, "size_px"), side));
}

static enum neph_status check_against(const struct neph_scaling *scaling, const json_t *document,
                                      const char *path, struct neph_diag *diag)
{
    if (strcmp(neph_json_text(document, "scene"), scaling->scene) != 0 ||
        strcmp(neph_json_text(document, "scene_hash"), scaling->scene_hash) != 0)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' is of scene %s as it was, not of this %s",
                         path, neph_json_text(document, "scene"), scaling->scene);
    if (read_side_px(document, 0) != scaling->width_px ||
        read_side_px(document, 1) != scaling->height_px)
        return neph_fail(diag, NEPH_ERR_INPUT, "'%s' is of %d x %d pixels, this run of %d x %d",
                         path, read_side_px(document, 0), read_side_px(document, 1),
                         scaling->width_px, scaling->height_px);
    return NEPH_OK;
}

/* ---- the answer ------------------------------------------------------------------------------ */

static void answer(const struct neph_scaling *scaling, struct neph_answer *answer)
{
    int counts[NEPH_EXPONENT_VERDICTS] = {0};
    for (int i = 0; i < scaling->line_count; i++) {
        counts[scaling->lines[i].work_verdict]++;
        counts[scaling->lines[i].time_verdict]++;
    }
    neph_answer_add(answer,
                    "%s: the cost of %s grows as expected in %d of %d exponents; %d do not, "
                    "%d are not told apart",
                    counts[NEPH_EXPONENT_OTHER] > 0 ? "not as expected" : "as expected",
                    scaling->scene, counts[NEPH_EXPONENT_EXPECTED],
                    2 * scaling->line_count - counts[NEPH_EXPONENT_NONE],
                    counts[NEPH_EXPONENT_OTHER], counts[NEPH_EXPONENT_UNCERTAIN]);
    for (int worst = 1; worst >= 0; worst--) /* unexpected exponents first */
        for (int i = 0; i < scaling->line_count; i++) {
            const struct neph_scaling_line *line = &scaling->lines[i];
            const bool is_other = line->work_verdict == NEPH_EXPONENT_OTHER ||
                                  line->time_verdict == NEPH_EXPONENT_OTHER;
            if (line->missing[0] || is_other != worst)
                continue;
            neph_answer_add(answer, "%s, %s: evaluations ~ x^%.2f, time ~ x^%.2f%s",
                            scaling->series[line->series], neph_scaling_axes[line->axis].name,
                            line->work.value, line->time.value,
                            is_other ? ": not as expected" : "");
        }
}

/* ---- the experiment -------------------------------------------------------------------------- */

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    struct request *request = request_;
    struct neph_times times = {NULL};
    struct neph_scaling scaling;
    request->params.device = run->device;
    request->params.times = &times;
    enum neph_status status = neph_times_open_in(run->output, &times, diag);
    if (!status)
        status = neph_scaling_run(&request->params, run->store, &scaling, diag);
    if (!status && request->there)
        status = check_against(&scaling, request->there, request->against, diag);
    neph_times_close(&times);
    if (status)
        return status;
    publication->json = scaling_json(&scaling);
    answer(&scaling, &publication->answer);
    if (publication->text)
        print_lines(&scaling, publication->text);
    if (publication->text && request->there)
        print_against(&scaling, request->there, publication->text);
    return NEPH_OK;
}

static void finish(void *request_)
{
    struct request *request = request_;
    json_decref(request->there);
}

const struct neph_experiment neph_experiment_scaling = {.syntax = &syntax,
                                                        .request_size = sizeof(struct request),
                                                        .document = "scaling.json",
                                                        .prepare = prepare,
                                                        .run = run,
                                                        .finish = finish};
