/* SPDX-License-Identifier: MIT */
#include "harness/sweep/chart.h"

#include "base/files.h"
#include "harness/report/vega.h"
#include "harness/sweep/front.h"
#include "harness/sweep/labels.h"
#include "harness/sweep/output.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct neph_sweep_chart neph_sweep_charts[] = {
    {"time_error", "Error against the truth, by time", NEPH_SWEEP_AXIS_TIME, NEPH_SWEEP_ERROR},
    {"time_shortcut", "What the shortcut loses of its own model, by time", NEPH_SWEEP_AXIS_TIME,
     NEPH_SWEEP_SHORTCUT},
    {"time_flicker", "Flicker seen, by time", NEPH_SWEEP_AXIS_TIME, NEPH_SWEEP_FLICKER},
    {"lag_flicker", "Flicker seen against lag", NEPH_SWEEP_AXIS_LAG, NEPH_SWEEP_FLICKER},
    {"work_error", "Error against the truth, by work", NEPH_SWEEP_AXIS_WORK, NEPH_SWEEP_ERROR},
    {"work_flicker", "Flicker seen, by work", NEPH_SWEEP_AXIS_WORK, NEPH_SWEEP_FLICKER},
    {.id = NULL},
};

const struct neph_sweep_chart_size neph_sweep_chart_sizes[NEPH_SWEEP_CHART_SIZES] = {
    {"wide", 612, 420, 6},
    {"narrow", 300, 340, 3},
};

static const char *const axis_titles[] = {
    [NEPH_SWEEP_AXIS_TIME] = "milliseconds of a picture",
    [NEPH_SWEEP_AXIS_WORK] = "density evaluations for a pixel of a picture",
    [NEPH_SWEEP_AXIS_LAG] = "half-life after a step of the sun [frames]",
};

/* A little more than the mean of a text in Helvetica of 11 px. */
static const double character_px = 6.0;
static const double name_margin_px = 14.0; /* the page's, right of the plot */

/* --- points --------------------------------------------------------------------------------- */

/* Logarithmic axes have no 0, no negative numbers, and no place for what was not measured. */
static bool is_drawable(double value)
{
    return isfinite(value) && value > 0.0;
}

static struct neph_sweep_value x_of(const struct neph_sweep_point *point, enum neph_sweep_axis axis)
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
    bool is_last; /* of its series: it carries the name */
};

static int list_marks(const struct neph_sweep *sweep, const struct neph_sweep_chart *chart,
                      struct mark *marks)
{
    int count = 0;
    for (int i = 0; i < sweep->point_count; i++) {
        const struct neph_sweep_point *point = &sweep->points[i];
        const struct mark mark = {point, x_of(point, chart->x), point->numbers[chart->y], true};
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

/* With room at both ends, and never less than a factor of four. */
static struct range range_of(const struct mark *marks, int count, bool of_x, double also)
{
    struct range range = {INFINITY, 0.0};
    for (int i = 0; i < count; i++) {
        const double value = of_x ? marks[i].x.value : marks[i].y.value;
        range.low = fmin(range.low, value);
        range.high = fmax(range.high, value);
    }
    if (is_drawable(also) && also > 0.02 * range.low) /* a floor far below is not worth the room */
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

static const char *family_of(const struct neph_engine *engine)
{
    static const struct {
        const char *engine, *family;
    } families[] = {{"realtime", "realtime"},
                    {"tracer", "tracer"},
                    {"cycles", "Cycles"},
                    {"povray", "POV-Ray"}};
    for (size_t i = 0; i < sizeof(families) / sizeof(families[0]); i++)
        if (strcmp(engine->name, families[i].engine) == 0)
            return families[i].family;
    return strncmp(engine->name, "march", 5) == 0 ? "march" : "other";
}

/* An end of an interval, held within the plot; null without one. */
static json_t *end_json(double value, struct range range)
{
    return isfinite(value) ? json_real(fmin(fmax(value, range.low), range.high)) : json_null();
}

static json_t *mark_json(const struct neph_sweep *sweep, const struct mark *mark, struct range x,
                         struct range y)
{
    char *command = neph_sweep_command(sweep, mark->point);
    json_t *json = json_pack("{s:s, s:s, s:s, s:i, s:f, s:o, s:o, s:f, s:o, s:o, s:s}", "series",
                             mark->point->series->name, "label", mark->point->label, "family",
                             family_of(mark->point->job.engine), "place", mark->point->place, "x",
                             mark->x.value, "x_low", end_json(mark->x.low, x), "x_high",
                             end_json(mark->x.high, x), "y", mark->y.value, "y_low",
                             end_json(mark->y.low, y), "y_high", end_json(mark->y.high, y),
                             "command", command ? command : "");
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

/* The front as it is drawn: of all marks of the chart, whatever is on its axes. */
static json_t *front_json(const struct mark *marks, int count, struct range x, struct range y)
{
    struct neph_front_point *points = calloc((size_t)count, sizeof(*points));
    json_t *list = points ? json_array() : NULL;
    double least = INFINITY, last = 0.0;
    for (int i = 0; i < count && points; i++) {
        points[i].values[0] = marks[i].x.value;
        points[i].values[1] = marks[i].y.value;
    }
    if (points)
        neph_front_find(points, count, 2);
    for (int i = 0; i < count && points; i++)
        if (points[i].on_front) {
            neph_json_add(&list,
                          json_pack("{s:f, s:f}", "x", marks[i].x.value, "y", marks[i].y.value));
            if (marks[i].x.value < least) {
                least = marks[i].x.value;
            }
            last = last == 0.0 ? marks[i].y.value : fmin(last, marks[i].y.value);
        }
    /* From the upper edge down to the first, and on to the right edge. */
    neph_json_add(&list, json_pack("{s:f, s:f}", "x", least, "y", y.high));
    neph_json_add(&list, json_pack("{s:f, s:f}", "x", x.high, "y", last));
    free(points);
    return list;
}

/* From half of the first point's error, as its series ought to fall. */
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

static double floor_of(const struct neph_sweep *sweep, const struct neph_sweep_chart *chart)
{
    return chart->y == NEPH_SWEEP_ERROR ? sweep->floor : 0.0;
}

static json_t *floor_json(double floor, struct range y)
{
    json_t *list = json_array();
    if (floor > y.low)
        neph_json_add(&list, json_pack("{s:f, s:s}", "y", floor, "text", "noise of the truth"));
    return list;
}

static enum neph_status find_names(const struct mark *marks, int count, struct range x,
                                   struct range y, const struct neph_sweep_chart_size *size,
                                   struct neph_label **labels, struct neph_diag *diag)
{
    *labels = calloc((size_t)count, sizeof(**labels));
    if (!*labels)
        return neph_fail_memory(diag);
    for (int i = 0; i < count; i++)
        (*labels)[i] = (struct neph_label){
            .x_px = size->width_px * place_in(x, marks[i].x.value),
            .y_px = size->height_px * (1.0 - place_in(y, marks[i].y.value)),
            .width_px = marks[i].is_last
                            ? character_px * (double)strlen(marks[i].point->series->name)
                            : 0.0};
    neph_labels_place(*labels, count, size->width_px, size->height_px, name_margin_px);
    return NEPH_OK;
}

/* --- the specification ---------------------------------------------------------------------- */

static json_t *layer_named(json_t *spec, const char *name)
{
    json_t *layers = json_object_get(spec, "layer");
    for (size_t i = 0; i < json_array_size(layers); i++)
        if (strcmp(neph_json_text(json_array_get(layers, i), "name"), name) == 0)
            return json_array_get(layers, i);
    return NULL;
}

/* An axis of the layer that has them. */
static enum neph_status set_axis(json_t *spec, const char *channel, struct range range,
                                 const char *title, struct neph_diag *diag)
{
    json_t *layers = json_object_get(layer_named(spec, "measured"), "layer");
    json_t *encoding = json_object_get(json_array_get(layers, json_array_size(layers) - 1),
                                       "encoding");
    json_t *axis = json_object_get(encoding, channel);
    enum neph_status status = neph_json_put(json_object_get(axis, "scale"), "domain",
                                            json_pack("[f, f]", range.low, range.high), diag);
    if (!status && title)
        status = neph_json_put(json_object_get(axis, "axis"), "title", json_string(title), diag);
    return status;
}

static enum neph_status set_title(json_t *spec, const char *title, struct neph_diag *diag)
{
    json_t *encoding = json_object_get(layer_named(spec, "title"), "encoding");
    return neph_json_put(json_object_get(encoding, "text"), "value", json_string(title), diag);
}

static enum neph_status fill(const struct neph_sweep *sweep, const struct neph_sweep_chart *chart,
                             const struct neph_sweep_chart_size *size, const struct mark *marks,
                             int count, json_t *spec, struct neph_diag *diag)
{
    const double floor = floor_of(sweep, chart);
    const struct range x = range_of(marks, count, true, NAN),
                       y = range_of(marks, count, false, floor);
    struct neph_label *labels = NULL;
    json_t *points = json_array(), *data = json_object_get(spec, "datasets");
    for (int i = 0; i < count; i++)
        neph_json_add(&points, mark_json(sweep, &marks[i], x, y));
    enum neph_status status = neph_json_put(data, "points", points, diag);
    if (!status)
        status = find_names(marks, count, x, y, size, &labels, diag);
    if (!status)
        status = neph_json_put(data, "labels", names_json(marks, labels, count), diag);
    if (!status)
        status = neph_json_put(data, "front", front_json(marks, count, x, y), diag);
    if (!status)
        status = neph_json_put(data, "slopes", slopes_json(marks, count, chart), diag);
    if (!status)
        status = neph_json_put(data, "floor", floor_json(floor, y), diag);
    if (!status)
        status = neph_json_put(spec, "width", json_integer(size->width_px), diag);
    if (!status)
        status = neph_json_put(spec, "height", json_integer(size->height_px), diag);
    if (!status)
        status = neph_json_put(json_object_get(json_object_get(spec, "config"), "legend"),
                               "columns", json_integer(size->legend_columns), diag);
    if (!status)
        status = set_axis(spec, "x", x, axis_titles[chart->x], diag);
    if (!status)
        status = set_axis(spec, "y", y, NULL, diag);
    if (!status)
        status = set_title(spec, neph_sweep_number_texts[chart->y].title, diag);
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
        fprintf(out, "The truth is %s; what a model leaves out is in these errors. ", sweep->truth);
    if (chart->y == NEPH_SWEEP_FLICKER)
        fprintf(out, "1 is the eye's threshold; over %s. ", sweep->mask);
    if (chart->x == NEPH_SWEEP_AXIS_TIME)
        fprintf(out, "Medians, 10 and 90 %% of %d rounds that take turns. ",
                sweep->plan->round_count);
    int hidden = 0;
    for (int i = 0; i < sweep->point_count; i++)
        hidden += !sweep->points[i].missing[0] &&
                  isfinite(sweep->points[i].numbers[chart->y].value) &&
                  !is_drawable(sweep->points[i].numbers[chart->y].value);
    if (hidden > 0)
        fprintf(out, "%d points are exactly 0 and have no place on this axis. ", hidden);
    fprintf(out, "The band is the front: nothing cheaper is as good.");
    if (fclose(out) == 0)
        return text;
    free(text);
    return NULL;
}
