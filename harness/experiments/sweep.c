/* SPDX-License-Identifier: MIT
 *
 * `neph sweep SCENE`: cost and error of engines and their settings in a scene.
 */
#include "base/path.h"
#include "harness/experiments/experiments.h"

#include "base/arena.h"
#include "base/files.h"
#include "base/threads.h"
#include "harness/document/table.h"
#include "harness/engines/non_physical.h"
#include "harness/json_file.h"
#include "harness/progress.h"
#include "harness/report/report_folder.h"
#include "harness/sweep/answer.h"
#include "harness/sweep/output.h"
#include "harness/sweep/stability.h"
#include "harness/sweep/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SEEDS_MAX = 16 };

struct request {
    struct neph_cli_shared shared;
    struct neph_sweep_params params; /* its seed is the first of `seeds` */
    const char *plan_name;
    struct neph_cli_list only;
    double error; /* target error of the answer */
    int seeds;    /* -1: a single sweep */
    struct neph_sweep_plan plan;
};

#define AT(member) .at = offsetof(struct request, member)
static const struct neph_cli_option options[] = {
    {"plan", 0, "FILE",
     "The series to render: a YAML file, or the name of a plan of scenes/studies; steps has march, "
     "ours and tracer, sweep all engines, presets and lights",
     NEPH_CLI_WORD, AT(plan_name), "steps"},
    {"only", 0, NULL, "Only these series of the plan", NEPH_CLI_NAMES, AT(only),
     .maximum = NEPH_SWEEP_SERIES_MAX},
    {"error", 0, "E", "The answer names the cheapest series with at most this relative RMSE",
     NEPH_CLI_REAL, AT(error), "0.01", 1e-6, 1e6},
    {"baseline", 0, "NAME",
     "The series that others are compared with at equal error and at equal time (default: the "
     "first)",
     NEPH_CLI_WORD, AT(params.against)},
    {"untimed", 0, NULL, "Measure no times: the cost of a point is its evaluations of density",
     NEPH_CLI_FLAG, AT(params.untimed)},
    {"retime", 0, NULL, "Measure the times in DIR/times.json again", NEPH_CLI_FLAG,
     AT(params.remeasures_times)},
    {"seed", 0, NULL, "The first seed", NEPH_CLI_INTEGER, AT(params.seed), "1", 1, 1000000},
    {"seeds", 0, "N",
     "Run N sweeps with seeds from --seed on, each with its own store, DIR/seed_K, and compare "
     "their fronts",
     NEPH_CLI_INTEGER, AT(seeds), .minimum = 2, .maximum = SEEDS_MAX},
    {.name = "size", .help = "Pixels, in place of the plan's"},
    {.name = "output", .help = "Folder of the store and of sweep.json", .otherwise = "out/sweep"},
    {.name = "all", .help = "The table of all points, the fronts and the comparison of series"},
    {.name = "json", .help = "All numbers as JSON on stdout"},
    {.name = "csv", .help = "A line for each point"},
    {.name = "jobs", .otherwise = "1"},
    {.name = "time-limit", .otherwise = "3600"},
    {.name = "quiet"},
    {.name = NULL},
};
#undef AT

static void check(const void *request_, const struct argp_state *state)
{
    const struct request *request = request_;
    if (request->seeds > 0 && request->shared.csv)
        argp_error(state, "--csv is of one sweep, not of --seeds");
}

static const struct neph_cli_syntax syntax = {
    .options = options,
    .operands = &neph_cli_one_scene,
    .check = check,
    .doc = "Render one scene with several engines and settings, and say which is the cheapest at "
           "an error and how many steps are enough.\vErrors are against the truth: engine exact "
           "where it can render the scene, else the tracer, with its noise printed. The error of a "
           "real-time method against the ray marcher with the same lighting, its flicker and its "
           "half-life after a step of the sun are separate numbers. Times are measured in rounds "
           "over all points: keep the machine quiet. Frames are kept in DIR/store and not rendered "
           "twice, times in DIR/times.json. NEPH_VULKAN_DEVICE names the device.\n"
           "\n"
           "DIR/sweep/index.html has the charts, DIR/sweep.json all numbers.\n"
           "\n"
           "Examples:\n"
           "  neph sweep voxel_grid\n"
           "  neph sweep cloud_below --error 0.05 --only march,ours\n"
           "  neph sweep voxel_grid --plan sweep --only march,seed --csv -\n"
           "  neph sweep voxel_grid --untimed --seeds 3 -o out/fronts",
};

static enum neph_status prepare(void *request_, struct neph_diag *diag)
{
    struct request *request = request_;
    struct neph_cli_shared *shared = &request->shared;
    struct neph_sweep_params *params = &request->params;
    bool is_there = !params->against;
    enum neph_status status = neph_sweep_plan_load(request->plan_name, &request->plan, diag);
    if (status)
        return status;
    for (int s = 0; s < request->plan.series_count; s++)
        is_there |= params->against && strcmp(request->plan.series[s].name, params->against) == 0;
    if (!is_there)
        return neph_fail(diag, NEPH_ERR_USAGE, "--baseline: the plan has no series '%s'",
                         params->against);
    if (shared->size.width_px > 0) {
        request->plan.width_px = shared->size.width_px;
        request->plan.height_px = shared->size.height_px;
    }
    params->plan = &request->plan;
    params->scene = shared->operands[0];
    params->only = request->only.count > 0 ? request->only.words : NULL;
    params->time_limit_s = shared->time_limit_s;
    params->quiet = shared->quiet;
    params->jobs = shared->jobs;
    return NEPH_OK;
}

/* ---- one sweep in a folder ------------------------------------------------------------------- */

static enum neph_status write_files(const struct neph_report_folder *page, const char *json_path,
                                    const struct neph_sweep *sweep, struct neph_diag *diag)
{
    char told[512] = "";
    json_t *json = neph_sweep_json(sweep);
    enum neph_status status = neph_json_write(json, JSON_INDENT(1), json_path, diag);
    json_decref(json);
    if (!status)
        status = neph_sweep_page_write(sweep, page, told, diag);
    if (told[0])
        neph_progress_warn("%s", told);
    if (!status && neph_sweep_measured_count(sweep) == 0)
        status = neph_fail(diag, NEPH_ERR_GATE, "no point could be measured");
    return status;
}

/* Run one sweep. Always free `sweep` with neph_sweep_finish(). */
static enum neph_status run_in(const char *folder, const struct neph_sweep_params *asked,
                               struct neph_sweep *sweep, struct neph_diag *diag)
{
    struct neph_arena arena = {.last = NULL};
    const char *slash = folder[strlen(folder) - 1] == '/' ? "" : "/";
    const char *store_path = neph_arena_format(&arena, "%s%sstore", folder, slash),
               *page_path = neph_arena_format(&arena, "%s%ssweep", folder, slash),
               *json_path = neph_arena_format(&arena, "%s%ssweep.json", folder, slash);
    struct neph_times times = {NULL};
    struct neph_sweep_params params = *asked;
    struct neph_store *store = NULL;
    struct neph_report_folder *page = NULL; /* opened first, so that a foreign folder is refused
                                               early */
    enum neph_status status = neph_arena_check(&arena, diag);
    params.times = &times;
    params.with_floors = true;
    if (!status)
        status = neph_report_folder_open(page_path, &page, diag);
    if (!status)
        status = neph_store_open(store_path, &store, diag);
    if (!status)
        status = neph_times_open_in(folder, &times, diag);
    if (!status)
        status = neph_sweep_run(&params, store, sweep, diag);
    if (!status)
        status = write_files(page, json_path, sweep, diag);
    neph_times_close(&times);
    neph_store_close(store);
    neph_report_folder_close(page);
    neph_arena_finish(&arena);
    return status;
}

/* ---- the table ------------------------------------------------------------------------------- */

static const int column_width = 11;

static void print_number(double value, double scale, bool on_front, FILE *out)
{
    char text[32] = "-";
    if (isfinite(value))
        snprintf(text, sizeof(text), "%.3g%s", scale * value, on_front ? "*" : " ");
    fprintf(out, " %*s", column_width, text);
}

/* A second line for a preset in a scene that moves. */
static void print_floors(const struct neph_sweep_point *point, FILE *out)
{
    bool has_any = false;
    for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++)
        has_any |= isfinite(point->floors[n]);
    if (!has_any)
        return;
    fprintf(out, "%-16s %-14s %*s %*s", "", "  its floor", column_width, "", column_width, "");
    for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++)
        print_number(point->floors[n], 1.0, false, out);
    fprintf(out, "\n");
}

static void print_point(const struct neph_sweep_point *point, FILE *out)
{
    fprintf(out, "%-16s %-14s", point->series->name, point->label);
    if (point->missing[0]) {
        fprintf(out, "  not rendered: %s\n", point->missing);
        return;
    }
    print_number(point->time.median, 1e3, false, out);
    print_number(point->evaluations, 1.0, false, out);
    for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++)
        print_number(point->numbers[n].value, 1.0, point->on_front[n], out);
    const char *look = neph_fog_model_note(point->job.engine, &point->job.shot.settings);
    fprintf(out, "%s%s%s\n", point->at_floor ? "  error within twice the noise of the truth" : "",
            look ? "  " : "", look ? look : "");
    print_floors(point, out);
}

/* Order of points on a front: by time if both have one, else by density evaluations. */
static int by_cost(const void *a_, const void *b_)
{
    const struct neph_sweep_point *a = *(const struct neph_sweep_point *const *)a_,
                                  *b = *(const struct neph_sweep_point *const *)b_;
    const enum neph_sweep_cost cost = isnan(a->time.median) || isnan(b->time.median)
                                          ? NEPH_SWEEP_COST_WORK
                                          : NEPH_SWEEP_COST_TIME;
    const double of_a = neph_sweep_point_cost(a, cost), of_b = neph_sweep_point_cost(b, cost);
    return (of_a > of_b) - (of_a < of_b);
}

/* Prints "front of error: ours steps=8, fitted octaves steps=16, tracer samples=128". */
static void print_front(const struct neph_sweep *sweep, enum neph_sweep_number number, FILE *out)
{
    const struct neph_sweep_point *points[NEPH_SWEEP_POINTS_MAX];
    int count = 0;
    for (int i = 0; i < sweep->point_count; i++)
        if (sweep->points[i].on_front[number])
            points[count++] = &sweep->points[i];
    if (count == 0)
        return;
    qsort(points, (size_t)count, sizeof(struct neph_sweep_point *), by_cost);
    fprintf(out, "front of %s, the cheapest first:", neph_sweep_number_texts[number].name);
    for (int i = 0; i < count; i++)
        fprintf(out, "%s %s%s%s", i > 0 ? "," : "", points[i]->series->name,
                points[i]->label[0] ? " " : "", points[i]->label);
    fprintf(out, "\n");
}

static void print_sweep(const struct neph_sweep *sweep, FILE *out)
{
    const struct neph_sweep_plan *plan = sweep->plan;
    fprintf(out, "%s, %d x %d; %s\n", sweep->scene->name, plan->width_px, plan->height_px,
            neph_sweep_device(sweep));
    fprintf(out, "truth: %s, noise %.3g of the mean; errors over %s; flicker over %s\n\n",
            sweep->truth, sweep->floor, sweep->clear_of, sweep->mask);
    fprintf(out, "%-16s %-14s %*s %*s %*s %*s %*s %*s %*s\n", "series", "point", column_width, "ms",
            column_width, "evals/px", column_width, "error ", column_width, "shortcut ",
            column_width, "flicker ", column_width, "four ", column_width, "half-life ");
    for (int i = 0; i < sweep->point_count; i++)
        print_point(&sweep->points[i], out);
    fprintf(out, "\n");
    for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++)
        print_front(sweep, (enum neph_sweep_number)n, out);
    fprintf(out,
            "\n"
            "*: on the front of its column: nothing cheaper is as good.\n"
            "error: relative RMSE against the truth, the model's gap included; shortcut: against "
            "the march of\n"
            "its own model; flicker: contrast seen over threshold; four: flicker that repeats "
            "every four frames, of\n"
            "white; half-life [frames] after a step of the sun; floor: every pixel marched in "
            "every frame, in a\n"
            "scene that moves.\n"
            "%d of %d points measured",
            neph_sweep_measured_count(sweep), sweep->point_count);
    fprintf(out, "; truth %.0f s, all others %.0f s", sweep->truth_s, sweep->measure_s);
    if (sweep->load > 1.5 * neph_processor_count())
        fprintf(out, "; the machine was busy (load %.1f): times may be too long", sweep->load);
    fprintf(out, "\n");
}

/* ---- CSV ------------------------------------------------------------------------------------- */

static void print_csv_numbers(const double *values, int count, FILE *out)
{
    for (int i = 0; i < count; i++) {
        fputc(',', out);
        neph_csv_number(values[i], out);
    }
}

static void print_csv(const struct neph_sweep *sweep, FILE *out)
{
    fputs("series,engine,point,seconds,seconds_low,seconds_high,evaluations_per_pixel", out);
    for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++) {
        const char *name = neph_sweep_number_texts[n].name;
        fprintf(out, ",%s,%s_low,%s_high,%s_floor", name, name, name, name);
    }
    fputs(",outcome\n", out);
    for (int i = 0; i < sweep->point_count; i++) {
        const struct neph_sweep_point *point = &sweep->points[i];
        const struct neph_spread *time = &point->time;
        neph_csv_word(point->series->name, out);
        fprintf(out, ",%s,", point->job.engine->name);
        neph_csv_word(point->label, out);
        print_csv_numbers((const double[]){time->median, time->low, time->high, point->evaluations},
                          4, out);
        for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++) {
            const struct neph_sweep_value *number = &point->numbers[n];
            print_csv_numbers(
                (const double[]){number->value, number->low, number->high, point->floors[n]}, 4,
                out);
        }
        fprintf(out, ",%s\n", point->missing[0] ? "missing" : "measured");
    }
}

/* ---- one sweep, or several with different seeds ---------------------------------------------- */

static enum neph_status run_one(const struct request *request, struct neph_publication *publication,
                                struct neph_diag *diag)
{
    struct neph_sweep sweep = {.plan = NULL};
    const enum neph_status status = run_in(request->shared.output, &request->params, &sweep, diag);
    if (!status) {
        publication->json = neph_sweep_json(&sweep);
        if (publication->csv)
            print_csv(&sweep, publication->csv);
        if (publication->text) {
            print_sweep(&sweep, publication->text);
            neph_sweep_print_equals(&sweep, publication->text);
            fprintf(publication->text, "%s/sweep/index.html\n", request->shared.output);
        }
        neph_sweep_answer(&sweep, request->error, &publication->answer);
    }
    neph_sweep_finish(&sweep);
    return status;
}

static enum neph_status judge_fronts(const struct request *request, const struct neph_sweep *sweeps,
                                     struct neph_publication *publication, struct neph_diag *diag)
{
    const enum neph_sweep_cost cost = request->params.untimed ? NEPH_SWEEP_COST_WORK
                                                              : NEPH_SWEEP_COST_TIME;
    publication->json = neph_stability_json(sweeps, request->seeds, cost);
    if (publication->text)
        neph_stability_print(publication->json, publication->text);
    neph_stability_answer(publication->json, &publication->answer);
    const int moved = (int)json_integer_value(json_object_get(publication->json, "moved"));
    if (moved > 0)
        publication->verdict = neph_fail(&publication->reason, NEPH_ERR_GATE,
                                         "%d points left a front by more than their intervals",
                                         moved);
    return neph_json_write(publication->json, JSON_INDENT(1),
                           neph_path_in(request->shared.output, "stability.json").text, diag);
}

static enum neph_status run_seeds(const struct request *request,
                                  struct neph_publication *publication, struct neph_diag *diag)
{
    struct neph_sweep sweeps[SEEDS_MAX] = {{.plan = NULL}};
    struct neph_sweep_params params = request->params;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < request->seeds && !status; i++, params.seed++) {
        const struct neph_path folder = neph_path_format("%s/seed_%d", request->shared.output,
                                                         params.seed);
        status = run_in(folder.text, &params, &sweeps[i], diag);
    }
    if (!status)
        status = judge_fronts(request, sweeps, publication, diag);
    for (int i = 0; i < request->seeds; i++)
        neph_sweep_finish(&sweeps[i]);
    return status;
}

static enum neph_status run(void *request_, const struct neph_experiment_run *run,
                            struct neph_publication *publication, struct neph_diag *diag)
{
    struct request *request = request_;
    request->params.device = run->device;
    return request->seeds > 0 ? run_seeds(request, publication, diag)
                              : run_one(request, publication, diag);
}

static void finish(void *request_)
{
    struct request *request = request_;
    neph_sweep_plan_finish(&request->plan);
}

static const char *const files[] = {"sweep/index.html", "sweep.json", "stability.json", "store",
                                    NULL};

const struct neph_experiment neph_experiment_sweep = {.syntax = &syntax,
                                                      .files = files,
                                                      .request_size = sizeof(struct request),
                                                      .opens_stores = true,
                                                      .prepare = prepare,
                                                      .run = run,
                                                      .finish = finish};
