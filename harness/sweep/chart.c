/* SPDX-License-Identifier: MIT
 *
 * Vega-Lite specifications of the charts of a sweep.
 */
#include "harness/sweep/chart.h"

#include "base/arena.h"
#include "base/files.h"
#include "harness/engines/non_physical.h"
#include "harness/report/vega.h"
#include "harness/sweep/front.h"
#include "harness/sweep/labels.h"
#include "harness/sweep/output.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Fails to compile when an axis is added, as the table of titles needs a row for it. */
_Static_assert(NEPH_SWEEP_AXIS_COUNT == 3, "a new kind");

const struct neph_sweep_chart neph_sweep_charts[] = {
    {"time_error", "Error against the truth, by time", NEPH_SWEEP_AXIS_TIME, NEPH_SWEEP_ERROR},
    {"time_shortcut", "Error against its own model, by time", NEPH_SWEEP_AXIS_TIME,
     NEPH_SWEEP_SHORTCUT},
    {"time_flicker", "Flicker seen, by time", NEPH_SWEEP_AXIS_TIME, NEPH_SWEEP_FLICKER},
    {"lag_flicker", "Flicker seen against lag", NEPH_SWEEP_AXIS_LAG, NEPH_SWEEP_FLICKER},
    {"work_error", "Error against the truth, by work", NEPH_SWEEP_AXIS_WORK, NEPH_SWEEP_ERROR},
    {"work_shortcut", "Error against its own model, by work", NEPH_SWEEP_AXIS_WORK,
     NEPH_SWEEP_SHORTCUT},
    {"work_flicker", "Flicker seen, by work", NEPH_SWEEP_AXIS_WORK, NEPH_SWEEP_FLICKER},
    {.id = NULL},
};

const struct neph_sweep_chart_size neph_sweep_chart_sizes[NEPH_SWEEP_CHART_SIZES] = {
    {"wide", 612, 420, 6},
    {"narrow", 300, 340, 3},
};

static const char *const axis_titles[] = {
    [NEPH_SWEEP_AXIS_TIME] = "milliseconds per frame",
    [NEPH_SWEEP_AXIS_WORK] = "density evaluations per pixel and frame",
    [NEPH_SWEEP_AXIS_LAG] = "half-life after a step of the sun [frames]",
};

/* Average width of a character at 11 px, with some margin, in the widest font of the page. */
static const double character_px = 6.4;
static const double name_margin_px = 14.0; /* margin of the page, right of the plot */

/* --- points --------------------------------------------------------------------------------- */

/* Logarithmic axes show positive, finite values only. */
static bool is_drawable(double value)
{
    return isfinite(value) && value > 0.0;
}

static struct neph_sweep_value axis_value(const struct neph_sweep_point *point,
                                          enum neph_sweep_axis axis)
{
    if (axis == NEPH_SWEEP_AXIS_TIME)
        return (struct neph_sweep_value){1e3 * point->time.median, 1e3 * point->time.low,
                                         1e3 * point->time.high};
    if (axis == NEPH_SWEEP_AXIS_WORK)
        return (struct neph_sweep_value){point->evaluations, NAN, NAN};
    return point->numbers[NEPH_SWEEP_HALF_LIFE];
}

struct mark {
    const struct neph_sweep_point *point;
    struct neph_sweep_value x, y;
    bool is_last; /* last point of its series, which is labelled with the name */
};

/* The floor of a series in a chart, at its last point; NaN: none. */
static double mark_floor(const struct mark *mark, const struct neph_sweep_chart *chart)
{
    const double floor = mark->point->floors[chart->y];
    return mark->is_last && is_drawable(floor) ? floor : NAN;
}

static int list_marks(const struct neph_sweep *sweep, const struct neph_sweep_chart *chart,
                      struct mark *marks)
{
    int count = 0;
    for (int i = 0; i < sweep->point_count; i++) {
        const struct neph_sweep_point *point = &sweep->points[i];
        const struct mark mark = {point, axis_value(point, chart->x), point->numbers[chart->y],
                                  true};
        if (point->missing[0] || !is_drawable(mark.x.value) || !is_drawable(mark.y.value))
            continue;
        if (count > 0 && marks[count - 1].point->series == point->series)
            marks[count - 1].is_last = false;
        marks[count++] = mark;
    }
    return count;
}

/* --- axes ----------------------------------------------------------------------------------- */

struct range {
    double low, high;
};

/* The range of the marks with a margin at both ends, at least a factor of four. `also` is included
 * unless it is far below. */
static struct range compute_axis_range(const struct mark *marks, int count,
                                       const struct neph_sweep_chart *chart, bool of_x, double also)
{
    struct range range = {INFINITY, 0.0};
    for (int i = 0; i < count; i++) {
        const double value = of_x ? marks[i].x.value : marks[i].y.value,
                     floor = of_x ? NAN : mark_floor(&marks[i], chart);
        range.low = fmin(fmin(range.low, value), floor);
        range.high = fmax(fmax(range.high, value), floor);
    }
    if (is_drawable(also) && also > 0.02 * range.low) /* a noise floor far below would waste the
                                                         axis */
        range.low = fmin(range.low, also);
    const double room = fmax(0.07 * log(range.high / range.low),
                             0.5 * (log(4.0) - log(range.high / range.low)));
    return (struct range){range.low * exp(-room), range.high * exp(room)};
}

static double place_in(struct range range, double value)
{
    return log(value / range.low) / log(range.high / range.low);
}

/* --- data ----------------------------------------------------------------------------------- */

static const char *find_family(const struct neph_sweep_point *point)
{
    const struct neph_engine *engine = point->job.engine;
    static const struct {
        const char *engine, *family;
    } families[] = {{"realtime", "realtime"},
                    {"tracer", "tracer"},
                    {"cycles", "Cycles"},
                    {"povray", "POV-Ray"}};
    if (neph_fog_model_note(engine, &point->job.shot.settings))
        return "look of a fog";
    for (size_t i = 0; i < sizeof(families) / sizeof(families[0]); i++)
        if (strcmp(engine->name, families[i].engine) == 0)
            return families[i].family;
    return strncmp(engine->name, "march", 5) == 0 ? "march" : "other";
}

/* An end of an interval, clamped to the plot; null without an interval. */
static json_t *end_json(double value, struct range range)
{
    return isfinite(value) ? json_real(fmin(fmax(value, range.low), range.high)) : json_null();
}

static json_t *mark_json(const struct neph_sweep *sweep, const struct mark *mark, struct range x,
                         struct range y)
{
    char *command = neph_sweep_command(sweep, mark->point);
    json_t *json = json_pack(
        "{s:s, s:s, s:s, s:i, s:f, s:o, s:o, s:f, s:o, s:o, s:s}", "series",
        mark->point->series->name, "label", mark->point->label, "family", find_family(mark->point),
        "place", mark->point->place, "x", mark->x.value, "x_low", end_json(mark->x.low, x),
        "x_high", end_json(mark->x.high, x), "y", mark->y.value, "y_low", end_json(mark->y.low, y),
        "y_high", end_json(mark->y.high, y), "command", command ? command : "");
    free(command);
    return json;
}

static json_t *names_json(const struct mark *marks, const struct neph_label *labels, int count)
{
    json_t *list = json_array();
    for (int i = 0; i < count; i++)
        if (labels[i].width_px > 0.0)
            neph_json_add(&list, json_pack("{s:s, s:f, s:f, s:f, s:f}", "text",
                                           marks[i].point->series->name, "x", marks[i].x.value, "y",
                                           marks[i].y.value, "dx", labels[i].dx_px, "dy",
                                           labels[i].dy_px));
    return list;
}

static int by_x(const void *a_, const void *b_)
{
    const struct mark *a = a_, *b = b_;
    return (a->x.value > b->x.value) - (a->x.value < b->x.value);
}

/* Pareto front of all marks on the chart's axes, sorted by x. Returns the number of its points; -1:
 * out of memory. */
static int front_marks(const struct mark *marks, int count, struct mark *on_front)
{
    struct neph_front_point *points = calloc((size_t)count, sizeof(*points));
    int found = 0;
    if (!points)
        return -1;
    for (int i = 0; i < count; i++) {
        points[i].values[0] = marks[i].x.value;
        points[i].values[1] = marks[i].y.value;
    }
    neph_front_find(points, count, 2);
    for (int i = 0; i < count; i++)
        if (points[i].on_front)
            on_front[found++] = marks[i];
    free(points);
    qsort(on_front, (size_t)found, sizeof(*on_front), by_x);
    return found;
}

/* The front as a polyline: from the upper edge down to its first point, and from its last point to
 * the right edge. `place` gives the order, as two points have the same x. */
static json_t *front_json(const struct mark *marks, int count, struct range x, struct range y)
{
    struct mark *on_front = calloc((size_t)count, sizeof(*on_front));
    const int found = on_front ? front_marks(marks, count, on_front) : -1;
    json_t *list = found >= 0 ? json_array() : NULL;
    for (int i = -1; i <= found && found > 0; i++) {
        const struct mark *mark = &on_front[i < 0 ? 0 : i == found ? found - 1 : i];
        neph_json_add(&list, json_pack("{s:i, s:f, s:f}", "place", i + 1, "x",
                                       i == found ? x.high : mark->x.value, "y",
                                       i < 0 ? y.high : mark->y.value));
    }
    free(on_front);
    return list;
}

/* The expected slope of each series, starting at half of the first point's error. */
static json_t *slopes_json(const struct mark *marks, int count,
                           const struct neph_sweep_chart *chart)
{
    json_t *list = json_array();
    for (int first = 0, last; first < count; first = last + 1) {
        const struct neph_sweep_series *series = marks[first].point->series;
        for (last = first; last + 1 < count && marks[last + 1].point->series == series;)
            last++;
        const double times = marks[last].x.value / marks[first].x.value;
        if (chart->y != NEPH_SWEEP_ERROR || !(series->order > 0.0) || !(times > 1.0))
            continue;
        const double error = 0.5 * marks[first].y.value;
        neph_json_add(&list, json_pack("{s:s, s:f, s:f}", "line", series->name, "x",
                                       marks[first].x.value, "y", error));
        neph_json_add(&list,
                      json_pack("{s:s, s:f, s:f}", "line", series->name, "x", marks[last].x.value,
                                "y", error * pow(times, -series->order)));
    }
    return list;
}

static double chart_noise_floor(const struct neph_sweep *sweep,
                                const struct neph_sweep_chart *chart)
{
    return chart->y == NEPH_SWEEP_ERROR ? sweep->floor : 0.0;
}

/* The mark at whose floor the line of a mark's floor is drawn: the first one that is less than half
 * a percent away, about the thickness of a line. */
static int find_floor_line(const struct mark *marks, int index,
                           const struct neph_sweep_chart *chart)
{
    const double floor = mark_floor(&marks[index], chart);
    for (int i = 0; i < index; i++)
        if (fabs(log(mark_floor(&marks[i], chart) / floor)) < 0.005 &&
            find_floor_line(marks, i, chart) == i)
            return i;
    return index;
}

/* "floor of ours, fixed": the series of this line; NULL: it is the line of an earlier mark. */
static const char *format_floor_name(const struct mark *marks, int count, int index,
                                     const struct neph_sweep_chart *chart, struct neph_arena *arena)
{
    const char *name = "floor of";
    if (find_floor_line(marks, index, chart) != index)
        return NULL;
    for (int i = index; i < count; i++) {
        if (isnan(mark_floor(&marks[i], chart)) || find_floor_line(marks, i, chart) != index)
            continue;
        name = neph_arena_format(arena, "%s%s %s", name, i > index ? "," : "",
                                 marks[i].point->series->name);
    }
    return name;
}

/* Lines across the plot: the noise of the truth, and the floors of presets in motion. */
static json_t *floor_json(const struct mark *marks, int count, const struct neph_sweep_chart *chart,
                          double noise, struct range y)
{
    struct neph_arena arena = {NULL};
    json_t *list = json_array();
    if (noise > y.low)
        neph_json_add(&list, json_pack("{s:f, s:s}", "y", noise, "text", "noise of the truth"));
    for (int i = 0; i < count; i++) {
        const double floor = mark_floor(&marks[i], chart);
        const char *name = isnan(floor) ? NULL : format_floor_name(marks, count, i, chart, &arena);
        if (name)
            neph_json_add(&list, json_pack("{s:f, s:s}", "y", floor, "text", name));
    }
    neph_arena_finish(&arena);
    return list;
}

/* Converts values to pixels of the plot. */
struct place {
    struct range x, y;
    const struct neph_sweep_chart_size *size;
};

static double x_px(const struct place *place, double value)
{
    return place->size->width_px * place_in(place->x, value);
}

static double y_px(const struct place *place, double value)
{
    return place->size->height_px * (1.0 - place_in(place->y, value));
}

/* Adds the lines of series and the bars of intervals, at most three for each mark. */
static int draw_lines(const struct place *place, const struct mark *marks, int count,
                      struct neph_label_line *lines)
{
    int drawn = 0;
    for (int i = 0; i < count; i++) {
        const struct mark *mark = &marks[i];
        const double x = x_px(place, mark->x.value), y = y_px(place, mark->y.value);
        if (i > 0 && marks[i - 1].point->series == mark->point->series)
            lines[drawn++] = (struct neph_label_line){x_px(place, marks[i - 1].x.value),
                                                      y_px(place, marks[i - 1].y.value), x, y};
        if (is_drawable(mark->x.low) && is_drawable(mark->x.high))
            lines[drawn++] = (struct neph_label_line){x_px(place, mark->x.low), y,
                                                      x_px(place, mark->x.high), y};
        if (is_drawable(mark->y.low) && is_drawable(mark->y.high))
            lines[drawn++] = (struct neph_label_line){x, y_px(place, mark->y.low), x,
                                                      y_px(place, mark->y.high)};
    }
    return drawn;
}

static enum neph_status find_names(const struct place *place, const struct mark *marks, int count,
                                   struct neph_label **labels, struct neph_diag *diag)
{
    const size_t room = count > 0 ? (size_t)count : 0;
    struct neph_label_line *lines = calloc(3 * room, sizeof(*lines));
    *labels = calloc(room, sizeof(**labels));
    if (!*labels || !lines) {
        free(lines);
        return neph_fail_memory(diag);
    }
    for (int i = 0; i < count; i++)
        (*labels)[i] = (struct neph_label){
            .x_px = x_px(place, marks[i].x.value),
            .y_px = y_px(place, marks[i].y.value),
            .width_px = marks[i].is_last
                            ? character_px * (double)strlen(marks[i].point->series->name)
                            : 0.0};
    const struct neph_label_plot plot = {place->size->width_px, place->size->height_px,
                                         name_margin_px, lines,
                                         draw_lines(place, marks, count, lines)};
    neph_labels_place(*labels, count, &plot);
    free(lines);
    return NEPH_OK;
}

static double value_at(struct range range, double part)
{
    return range.low * pow(range.high / range.low, part);
}

/* Leader lines from marks to distant names. */
static json_t *leaders_json(const struct place *place, const struct mark *marks,
                            const struct neph_label *labels, int count)
{
    json_t *list = json_array();
    for (int i = 0; i < count; i++)
        if (labels[i].width_px > 0.0 && labels[i].is_apart)
            neph_json_add(
                &list,
                json_pack("{s:f, s:f, s:f, s:f}", "x", marks[i].x.value, "y", marks[i].y.value,
                          "x2", value_at(place->x, labels[i].lead_x_px / place->size->width_px),
                          "y2",
                          value_at(place->y, 1.0 - labels[i].lead_y_px / place->size->height_px)));
    return list;
}

/* Domain of the colours and dashes: a series has the same ones in all charts. */
static json_t *series_json(const struct neph_sweep *sweep)
{
    json_t *list = json_array();
    for (int s = 0; s < sweep->plan->series_count; s++)
        neph_json_add(&list, json_string(sweep->plan->series[s].name));
    return list;
}

/* The families of the marks, for the legend. */
static json_t *families_json(const struct mark *marks, int count)
{
    json_t *list = json_array();
    for (int i = 0; i < count; i++) {
        const char *family = find_family(marks[i].point);
        bool is_new = true;
        for (int k = 0; k < i && is_new; k++)
            is_new = strcmp(find_family(marks[k].point), family) != 0;
        if (is_new)
            neph_json_add(&list, json_string(family));
    }
    return list;
}

/* --- the specification ---------------------------------------------------------------------- */

static json_t *find_layer(json_t *spec, const char *name)
{
    json_t *layers = json_object_get(spec, "layer");
    for (size_t i = 0; i < json_array_size(layers); i++)
        if (strcmp(neph_json_text(json_array_get(layers, i), "name"), name) == 0)
            return json_array_get(layers, i);
    return NULL;
}

/* Sets range and title of an axis, in the layer that has the axes. */
static enum neph_status set_axis(json_t *spec, const char *channel, struct range range,
                                 const char *title, struct neph_diag *diag)
{
    json_t *layers = json_object_get(find_layer(spec, "measured"), "layer");
    json_t *encoding = json_object_get(json_array_get(layers, json_array_size(layers) - 1),
                                       "encoding");
    json_t *axis = json_object_get(encoding, channel);
    enum neph_status status = neph_json_put(json_object_get(axis, "scale"), "domain",
                                            json_pack("[f, f]", range.low, range.high), diag);
    if (!status && title)
        status = neph_json_put(json_object_get(axis, "axis"), "title", json_string(title), diag);
    return status;
}

/* Sets the domain of the colours, and of the dashes of all layers in the group "measured". */
static enum neph_status set_series(json_t *spec, const struct neph_sweep *sweep,
                                   struct neph_diag *diag)
{
    json_t *group = find_layer(spec, "measured"), *layers = json_object_get(group, "layer");
    json_t *color = json_object_get(json_object_get(group, "encoding"), "color");
    enum neph_status status = neph_json_put(json_object_get(color, "scale"), "domain",
                                            series_json(sweep), diag);
    for (size_t i = 0; i < json_array_size(layers) && !status; i++) {
        json_t *dash = json_object_get(json_object_get(json_array_get(layers, i), "encoding"),
                                       "strokeDash");
        if (dash)
            status = neph_json_put(json_object_get(dash, "scale"), "domain", series_json(sweep),
                                   diag);
    }
    return status;
}

static enum neph_status set_legend(json_t *spec, const struct mark *marks, int count,
                                   struct neph_diag *diag)
{
    json_t *layers = json_object_get(find_layer(spec, "measured"), "layer");
    json_t *encoding = json_object_get(json_array_get(layers, json_array_size(layers) - 1),
                                       "encoding");
    return neph_json_put(json_object_get(json_object_get(encoding, "shape"), "legend"), "values",
                         families_json(marks, count), diag);
}

static enum neph_status fill(const struct neph_sweep *sweep, const struct neph_sweep_chart *chart,
                             const struct neph_sweep_chart_size *size, const struct mark *marks,
                             int count, json_t *spec, struct neph_diag *diag)
{
    const double floor = chart_noise_floor(sweep, chart);
    const struct range x = compute_axis_range(marks, count, chart, true, NAN),
                       y = compute_axis_range(marks, count, chart, false, floor);
    const struct place place = {x, y, size};
    struct neph_label *labels = NULL;
    json_t *points = json_array(), *data = json_object_get(spec, "datasets");
    json_t *title = json_object_get(find_layer(spec, "title"), "encoding");
    for (int i = 0; i < count; i++)
        neph_json_add(&points, mark_json(sweep, &marks[i], x, y));
    enum neph_status status = find_names(&place, marks, count, &labels, diag);
    if (status) {
        json_decref(points);
        return status;
    }
    const struct {
        json_t *object;
        const char *key;
        json_t *value;
    } fields[] = {
        {data, "points", points},
        {data, "labels", names_json(marks, labels, count)},
        {data, "leaders", leaders_json(&place, marks, labels, count)},
        {data, "front", front_json(marks, count, x, y)},
        {data, "slopes", slopes_json(marks, count, chart)},
        {data, "floor", floor_json(marks, count, chart, floor, y)},
        {spec, "width", json_integer(size->width_px)},
        {spec, "height", json_integer(size->height_px)},
        {json_object_get(json_object_get(spec, "config"), "legend"), "columns",
         json_integer(size->legend_columns)},
        {json_object_get(title, "text"), "value",
         json_string(neph_sweep_number_texts[chart->y].title)},
    };
    for (size_t i = 0; i < sizeof(fields) / sizeof(fields[0]); i++) {
        const enum neph_status put = neph_json_put(fields[i].object, fields[i].key, fields[i].value,
                                                   diag);
        status = status ? status : put;
    }
    if (!status)
        status = set_series(spec, sweep, diag);
    if (!status)
        status = set_legend(spec, marks, count, diag);
    if (!status)
        status = set_axis(spec, "x", x, axis_titles[chart->x], diag);
    if (!status)
        status = set_axis(spec, "y", y, NULL, diag);
    free(labels);
    return status;
}

enum neph_status neph_sweep_chart_spec(const struct neph_sweep *sweep,
                                       const struct neph_sweep_chart *chart,
                                       const struct neph_sweep_chart_size *size, json_t **spec,
                                       struct neph_diag *diag)
{
    struct mark *marks = calloc((size_t)sweep->point_count, sizeof(*marks));
    json_t *made = NULL;
    *spec = NULL;
    if (!marks)
        return neph_fail_memory(diag);
    const int count = list_marks(sweep, chart, marks);
    enum neph_status status = count > 0 ? neph_vega_template("sweep.vl.json", &made, diag)
                                        : NEPH_OK;
    if (!status && made)
        status = fill(sweep, chart, size, marks, count, made, diag);
    if (status)
        json_decref(made);
    else
        *spec = made;
    free(marks);
    return status;
}

/* --- the caption ---------------------------------------------------------------------------- */

static bool has_order(const struct neph_sweep *sweep, const struct neph_sweep_chart *chart)
{
    for (int i = 0; i < sweep->point_count; i++)
        if (chart->y == NEPH_SWEEP_ERROR && sweep->points[i].series->order > 0.0)
            return true;
    return false;
}

char *neph_sweep_chart_caption(const struct neph_sweep *sweep, const struct neph_sweep_chart *chart)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    fprintf(out, "%s at %d x %d, %s. ", sweep->scene->name, sweep->plan->width_px,
            sweep->plan->height_px, neph_sweep_device(sweep));
    if (chart->y == NEPH_SWEEP_ERROR)
        fprintf(out, "The truth is %s; model errors are included. ", sweep->truth);
    if (chart->y == NEPH_SWEEP_FLICKER)
        fprintf(out, "1 is the eye's threshold; over %s. ", sweep->mask);
    if (chart->x == NEPH_SWEEP_AXIS_TIME)
        fprintf(out, "Median, 10 %% and 90 %% of the frames of %d rounds. ",
                sweep->plan->round_count);
    if (chart->y != NEPH_SWEEP_ERROR && sweep->plan->seed_count > 1)
        fprintf(out, "Means over %d seeds. ", sweep->plan->seed_count);
    int hidden = 0;
    for (int i = 0; i < sweep->point_count; i++)
        hidden += !sweep->points[i].missing[0] &&
                  isfinite(sweep->points[i].numbers[chart->y].value) &&
                  !is_drawable(sweep->points[i].numbers[chart->y].value);
    if (hidden > 0)
        fprintf(out, "%d points are exactly 0 and are not shown on this axis. ", hidden);
    if (has_order(sweep, chart))
        fprintf(out, "Dotted: expected slope of a series. ");
    fprintf(out, "The band is the Pareto front: no cheaper point is as good.");
    if (fclose(out) == 0)
        return text;
    free(text);
    return NULL;
}
