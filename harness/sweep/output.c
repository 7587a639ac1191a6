/* SPDX-License-Identifier: MIT */
#include "harness/sweep/output.h"

#include "base/threads.h"
#include "harness/document/table.h"
#include "harness/engines/engines.h"
#include "harness/engines/look.h"
#include "harness/sweep/equal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- words ---------------------------------------------------------------------------------- */

char *neph_sweep_command(const struct neph_sweep *sweep, const struct neph_sweep_point *point)
{
    const struct neph_sweep_plan *plan = sweep->plan;
    const struct neph_sweep_series *series = point->series;
    const struct neph_engine *engine = point->job.engine;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    const struct neph_settings plain = neph_settings_default(engine);
    struct neph_settings from = plain;
    fprintf(out, "neph render %s -e %s --size %dx%d", sweep->scene->name, engine->name,
            plan->width_px, plan->height_px);
    if (series->preset) { /* its changes follow as settings */
        const size_t length = strcspn(series->preset, "+");
        char name[64];
        snprintf(name, sizeof(name), "%.*s", (int)length, series->preset);
        fprintf(out, " --preset %s", name);
        if (neph_settings_preset(engine, name, &from, NULL))
            from = plain;
    }
    char *settings = neph_settings_text(engine, &point->job.shot.settings),
         *before = neph_settings_text(engine, &from);
    char *rest = settings, *rest_before = before;
    for (char *word = NULL; settings && before && (word = strsep(&rest, " "));) {
        const char *same = strsep(&rest_before, " ");
        if (same && strcmp(word, same) != 0)
            fprintf(out, " -s %s", word);
    }
    if (point->job.shot.scene != sweep->scene)
        fprintf(out, " --scattering %s", neph_scattering_name(point->job.shot.scene->scattering));
    if (engine->remembers)
        fprintf(out, " --frames %d", sweep->frame_count);
    else if (sweep->frame > 0)
        fprintf(out, " --frame %d", sweep->frame);
    fprintf(out, " --seed %llu", (unsigned long long)point->job.shot.seed);
    free(settings);
    free(before);
    if (fclose(out) == 0)
        return text;
    free(text);
    return NULL;
}

const char *neph_sweep_device(const struct neph_sweep *sweep)
{
    for (int i = 0; i < sweep->point_count; i++)
        if (sweep->points[i].job.engine->rung == NEPH_RUNG_MODEL &&
            !sweep->points[i].job.engine->is_guest && !sweep->points[i].missing[0])
            return sweep->points[i].job.info->device;
    return "";
}

int neph_sweep_measured_count(const struct neph_sweep *sweep)
{
    int count = 0;
    for (int i = 0; i < sweep->point_count; i++)
        count += !sweep->points[i].missing[0];
    return count;
}

/* --- the table ------------------------------------------------------------------------------ */

static const int column_width = 11;

static void print_number(double value, double scale, bool on_front, FILE *out)
{
    char text[32] = "-";
    if (isfinite(value))
        snprintf(text, sizeof(text), "%.3g%s", scale * value, on_front ? "*" : " ");
    fprintf(out, " %*s", column_width, text);
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
    const char *look = neph_look_of_fog(point->job.engine, &point->job.shot.settings);
    fprintf(out, "%s%s%s\n", point->at_floor ? "  error within twice the noise of the truth" : "",
            look ? "  " : "", look ? look : "");
}

/* On one's front, by their cost: time where there is one, else work. */
static int by_cost(const void *a_, const void *b_)
{
    const struct neph_sweep_point *a = *(const struct neph_sweep_point *const *)a_,
                                  *b = *(const struct neph_sweep_point *const *)b_;
    const enum neph_sweep_cost cost = isnan(a->time.median) || isnan(b->time.median)
                                          ? NEPH_SWEEP_COST_WORK
                                          : NEPH_SWEEP_COST_TIME;
    const double of_a = neph_sweep_cost_of(a, cost), of_b = neph_sweep_cost_of(b, cost);
    return (of_a > of_b) - (of_a < of_b);
}

/* "front of error: ours steps=8, fitted octaves steps=16, tracer samples=128" */
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

void neph_sweep_print(const struct neph_sweep *sweep, FILE *out)
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
            "\n*: on the front of its column: nothing cheaper is as good.\n"
            "error: relative RMSE against the truth, the model's gap included; shortcut: "
            "against the march of\nits own model; flicker: contrast seen over threshold; "
            "four: what repeats every four frames, of\nwhite; half-life [frames] after a step "
            "of the sun.\n%d of %d points measured",
            neph_sweep_measured_count(sweep), sweep->point_count);
    fprintf(out, "; truth %.0f s, the rest %.0f s", sweep->truth_s, sweep->measure_s);
    if (sweep->load > 1.5 * neph_processor_count())
        fprintf(out, "; the machine was busy (load %.1f): times are those of a busy machine",
                sweep->load);
    fprintf(out, "\n");
}

/* --- JSON ----------------------------------------------------------------------------------- */

static json_t *value_json(const struct neph_sweep_point *point, enum neph_sweep_number number)
{
    const struct neph_sweep_value *value = &point->numbers[number];
    return json_pack("{s:o, s:o, s:o, s:b}", "value", neph_json_number(value->value), "low",
                     neph_json_number(value->low), "high", neph_json_number(value->high),
                     "on_front", point->on_front[number]);
}

static json_t *point_json(const struct neph_sweep *sweep, const struct neph_sweep_point *point)
{
    char *command = neph_sweep_command(sweep, point);
    json_t *json = json_pack(
        "{s:s, s:s, s:s, s:s, s:i, s:s, s:o, s:o, s:o, s:i, s:o, s:b, s:b}", "series",
        point->series->name, "label", point->label, "engine", point->job.engine->name, "version",
        point->job.info->version, "place", point->place, "settings", point->settings, "seconds",
        neph_json_number(point->time.median), "seconds_low", neph_json_number(point->time.low),
        "seconds_high", neph_json_number(point->time.high), "pictures", point->timed, "evaluations",
        neph_json_number(point->evaluations), "at_floor", point->at_floor, "look",
        neph_is_look(point->job.engine, &point->job.shot.settings));
    for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++)
        neph_json_set(&json, neph_sweep_number_texts[n].name,
                      value_json(point, (enum neph_sweep_number)n));
    neph_json_set(&json, "frame_key", json_string(point->frame_key));
    neph_json_set(&json, "command", command ? json_string(command) : NULL);
    neph_json_set(&json, "missing",
                  point->missing[0] ? neph_json_cleaned(point->missing) : json_null());
    free(command);
    return json;
}

json_t *neph_sweep_json(const struct neph_sweep *sweep)
{
    const struct neph_sweep_plan *plan = sweep->plan;
    json_t *points = json_array();
    for (int i = 0; i < sweep->point_count; i++)
        neph_json_add(&points, point_json(sweep, &sweep->points[i]));
    return json_pack(
        "{s:s, s:s, s:s, s:s, s:i, s:i, s:i, s:i, s:i, s:s, s:o, s:s, s:s, s:i, s:s, s:o, s:i, "
        "s:i, s:o, s:o}",
        "format", "neph-sweep-1", "title", plan->title, "scene", sweep->scene->name, "scene_hash",
        sweep->scene->hash, "width_px", plan->width_px, "height_px", plan->height_px, "frames",
        sweep->frame_count, "warm_up", plan->warm_up, "seeds", plan->seed_count, "truth",
        sweep->truth, "truth_noise", neph_json_number(sweep->floor), "error_mask", sweep->clear_of,
        "flicker_mask", sweep->mask, "frame", sweep->frame, "device", neph_sweep_device(sweep),
        "load", neph_json_number(sweep->load), "measured", neph_sweep_measured_count(sweep),
        "expected", sweep->point_count, "points", points, "equal", neph_sweep_equals_json(sweep));
}

/* --- CSV ------------------------------------------------------------------------------------ */

static void add_row(const struct neph_sweep_point *point, struct neph_table *table)
{
    const double costs[] = {point->time.median, point->time.low, point->time.high,
                            point->evaluations};
    neph_table_word(table, point->series->name);
    neph_table_word(table, point->job.engine->name);
    neph_table_word(table, point->label);
    for (size_t i = 0; i < sizeof(costs) / sizeof(costs[0]); i++)
        neph_table_number(table, costs[i]);
    for (int n = 0; n < NEPH_SWEEP_NUMBERS; n++) {
        neph_table_number(table, point->numbers[n].value);
        neph_table_number(table, point->numbers[n].low);
        neph_table_number(table, point->numbers[n].high);
    }
    neph_table_word(table, point->missing[0] ? "missing" : "measured");
}

static void add_column(const char *key, const char *end, struct neph_table *table)
{
    char name[64];
    snprintf(name, sizeof(name), "%s%s", key, end);
    neph_table_columns(table, &(struct neph_column){.key = name}, 1);
}

void neph_sweep_print_csv(const struct neph_sweep *sweep, FILE *out)
{
    static const char *const first[] = {"series",
                                        "engine",
                                        "point",
                                        "seconds",
                                        "seconds_low",
                                        "seconds_high",
                                        "evaluations_per_pixel"};
    static const char *const ends[] = {"", "_low", "_high"};
    struct neph_table table = {.cells = NULL};
    for (size_t i = 0; i < sizeof(first) / sizeof(first[0]); i++)
        add_column(first[i], "", &table);
    for (int i = 0; i < 3 * NEPH_SWEEP_NUMBERS; i++)
        add_column(neph_sweep_number_texts[i / 3].name, ends[i % 3], &table);
    add_column("outcome", "", &table);
    for (int i = 0; i < sweep->point_count; i++)
        add_row(&sweep->points[i], &table);
    neph_table_print_csv(&table, "\n", out);
    neph_table_finish(&table);
}
