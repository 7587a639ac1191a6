/* SPDX-License-Identifier: MIT
 *
 * The chart of flicker against lag.
 */
#include "harness/study/flicker_plot.h"

#include "harness/study/flicker_floor.h"
#include "harness/study/flicker_pairs.h"
#include "harness/study/svg.h"

#include <math.h>
#include <string.h>

enum { WIDTH = 720, HEIGHT = 520, LEFT = 90, RIGHT = 30, TOP = 50, BOTTOM = 110 };

/* A logarithmic axis between two pixel positions. */
struct axis {
    double low, high; /* log10 */
    double start_px, end_px;
};

static double at_px(const struct axis *axis, double decades)
{
    const double part = (decades - axis->low) / (axis->high - axis->low);
    return axis->start_px + part * (axis->end_px - axis->start_px);
}

enum { POINTS_MAX = 2 * NEPH_STUDY_PRESETS_MAX };

/* The points of the chart: presets, then their floors, those of several presets once. */
struct points {
    struct neph_study_level lag[POINTS_MAX], flicker[POINTS_MAX];
    const char *names[POINTS_MAX];
    int preset_count, count;
};

static bool is_drawn(const struct neph_study_level *x, const struct neph_study_level *y)
{
    return !isnan(x->mean) && !isnan(y->mean);
}

/* Whole tenths of a decade around all drawn values. */
static struct axis fit(const struct neph_study_level *levels, const struct neph_study_level *others,
                       int count, double start_px, double end_px)
{
    struct axis axis = {INFINITY, -INFINITY, start_px, end_px};
    for (int i = 0; i < count; i++) {
        if (!is_drawn(&levels[i], &others[i]))
            continue;
        axis.low = fmin(axis.low, levels[i].has_interval ? levels[i].low : levels[i].mean);
        axis.high = fmax(axis.high, levels[i].has_interval ? levels[i].high : levels[i].mean);
    }
    axis.low = floor(10.0 * axis.low - 1.0) / 10.0;
    axis.high = ceil(10.0 * axis.high + 1.0) / 10.0;
    return axis;
}

/* Ticks at 1, 2 and 5 of each decade. */
static void draw_ticks(const struct axis *axis, bool is_x, FILE *out)
{
    static const double marks[] = {1, 2, 5};
    for (int decade = (int)floor(axis->low); decade <= (int)ceil(axis->high); decade++)
        for (size_t i = 0; i < sizeof(marks) / sizeof(marks[0]); i++) {
            const double value = marks[i] * pow(10.0, decade), place = log10(value);
            if (place < axis->low || place > axis->high)
                continue;
            const double px = at_px(axis, place);
            const int bottom = HEIGHT - BOTTOM;
            if (is_x)
                fprintf(out,
                        "<path d=\"M%.1f %d V%d\" stroke=\"#ddd\"/>"
                        "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%g</text>\n",
                        px, TOP, bottom, px, bottom + 18, value);
            else
                fprintf(out,
                        "<path d=\"M%d %.1f H%d\" stroke=\"#ddd\"/>"
                        "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%g</text>\n",
                        LEFT, px, WIDTH - RIGHT, LEFT - 8, px + 4, value);
        }
}

/* Position of a name: left end of its baseline. */
struct label {
    double x_px, y_px, width_px;
};

/* At a font size of 13 px: average width of a character, and height of a line. */
static const double letter_px = 7.2, line_px = 14.0;

static bool labels_meet(const struct label *a, const struct label *b)
{
    return a->x_px < b->x_px + b->width_px && b->x_px < a->x_px + a->width_px &&
           fabs(a->y_px - b->y_px) < line_px;
}

/* Places a name beside its point: the first of four places without an overlap, else the last. */
static struct label place_label(double x_px, double y_px, const char *name,
                                const struct label *labels, int count)
{
    const double width_px = letter_px * (double)strlen(name);
    const struct label places[] = {{x_px + 9, y_px - 7, width_px},
                                   {x_px + 9, y_px + 16, width_px},
                                   {x_px - 9 - width_px, y_px - 7, width_px},
                                   {x_px - 9 - width_px, y_px + 16, width_px}};
    const int last = sizeof(places) / sizeof(places[0]) - 1;
    for (int p = 0; p < last; p++) {
        bool meets = false;
        for (int i = 0; i < count; i++)
            meets |= labels_meet(&places[p], &labels[i]);
        if (!meets)
            return places[p];
    }
    return places[last];
}

/* A disc for a preset, a diamond for a floor. */
static void draw_mark(double x_px, double y_px, bool is_floor, FILE *out)
{
    if (is_floor)
        fprintf(out,
                "<path d=\"M%.1f %.1f l6 6 l6 -6 l-6 -6 Z\" fill=\"#fff\" stroke=\"#a30\" "
                "stroke-width=\"2\"/>",
                x_px - 6.0, y_px);
    else
        fprintf(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"5\" fill=\"#336\"/>", x_px, y_px);
}

static struct label draw_point(const struct axis *x, const struct axis *y,
                               const struct points *points, int index, const struct label *labels,
                               int label_count, FILE *out)
{
    const struct neph_study_level *lag = &points->lag[index], *flicker = &points->flicker[index];
    const bool is_floor = index >= points->preset_count;
    const char *name = points->names[index], *colour = is_floor ? "#a30" : "#336";
    const double x_px = at_px(x, lag->mean), y_px = at_px(y, flicker->mean);
    if (lag->has_interval)
        fprintf(out, "<path d=\"M%.1f %.1f H%.1f\" stroke=\"%s\"/>", at_px(x, lag->low), y_px,
                at_px(x, lag->high), colour);
    if (flicker->has_interval)
        fprintf(out, "<path d=\"M%.1f %.1f V%.1f\" stroke=\"%s\"/>", x_px, at_px(y, flicker->low),
                at_px(y, flicker->high), colour);
    const struct label label = place_label(x_px, y_px, name, labels, label_count);
    draw_mark(x_px, y_px, is_floor, out);
    fprintf(out, "<text x=\"%.1f\" y=\"%.1f\">", label.x_px, label.y_px);
    neph_svg_print_escaped(name, out);
    fprintf(out, "</text>\n");
    return label;
}

static void draw(const struct points *points, FILE *out)
{
    const struct neph_study_level *lag = points->lag, *flicker = points->flicker;
    const int count = points->count;
    const struct axis x = fit(lag, flicker, count, LEFT, WIDTH - RIGHT);
    const struct axis y = fit(flicker, lag, count, HEIGHT - BOTTOM, TOP);
    if (x.high < x.low) { /* no point to draw */
        fprintf(out, "<text x=\"%d\" y=\"%d\">No scene has both numbers for all presets.</text>\n",
                LEFT, HEIGHT / 2);
        return;
    }
    draw_ticks(&x, true, out);
    draw_ticks(&y, false, out);
    struct label labels[2 * POINTS_MAX]; /* points first, so that no name covers one */
    int label_count = 0;
    for (int i = 0; i < count; i++)
        if (is_drawn(&lag[i], &flicker[i]))
            labels[label_count++] = (struct label){at_px(&x, lag[i].mean) - 6.0,
                                                   at_px(&y, flicker[i].mean) + 5.0, 12.0};
    for (int i = 0; i < count; i++)
        if (is_drawn(&lag[i], &flicker[i])) {
            labels[label_count] = draw_point(&x, &y, points, i, labels, label_count, out);
            label_count++;
        }
}

/* Fills in the points; names of floors are in `arena`. */
static enum neph_status make_points(const struct neph_flicker_study *study,
                                    struct neph_arena *arena, struct points *points,
                                    struct neph_diag *diag)
{
    const int flicker = neph_study_find_headline(), lag = neph_study_find_lag(),
              preset_count = study->params->preset_count;
    struct neph_study_level floor_lag[NEPH_STUDY_PRESETS_MAX],
        floor_flicker[NEPH_STUDY_PRESETS_MAX];
    points->preset_count = points->count = preset_count;
    enum neph_status status = neph_study_levels(study, lag, 0, points->lag, diag);
    if (!status)
        status = neph_study_levels(study, flicker, 0, points->flicker, diag);
    if (!status)
        status = neph_study_floor_levels(study, lag, 0, floor_lag, diag);
    if (!status)
        status = neph_study_floor_levels(study, flicker, 0, floor_flicker, diag);
    for (int preset = 0; preset < preset_count && !status; preset++) {
        points->names[preset] = study->params->presets[preset];
        if (!study->params->floors || neph_flicker_floor_first(study, preset) != preset)
            continue;
        points->lag[points->count] = floor_lag[preset];
        points->flicker[points->count] = floor_flicker[preset];
        points->names[points->count++] = neph_flicker_floor_title(study, preset, arena);
    }
    return status ? status : neph_arena_check(arena, diag);
}

enum neph_status neph_flicker_study_plot(const struct neph_flicker_study *study, FILE *out,
                                         struct neph_diag *diag)
{
    struct points points;
    struct neph_arena arena = {.last = NULL};
    const enum neph_status status = make_points(study, &arena, &points, diag);
    if (status) {
        neph_arena_finish(&arena);
        return status;
    }
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" font-family="
            "\"sans-serif\" font-size=\"13\">\n<rect width=\"100%%\" height=\"100%%\" "
            "fill=\"#fff\"/>\n<text x=\"%d\" y=\"28\" font-size=\"16\">Flicker against lag: the "
            "lower left is best</text>\n",
            WIDTH, HEIGHT, LEFT);
    draw(&points, out);
    if (study->params->floors)
        fprintf(out,
                "<text x=\"%d\" y=\"%d\" font-size=\"11\">Diamonds: floors, every pixel marched in "
                "every frame, with the lower number of two kinds of anti-aliasing.</text>\n",
                LEFT, HEIGHT - 8);
    fprintf(
        out,
        "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">%s</text>\n"
        "<text transform=\"translate(24 %d) rotate(-90)\" text-anchor=\"middle\">%s</text>\n"
        "<text x=\"%d\" y=\"%d\" font-size=\"11\">Geometric means over the %d and %d scenes in "
        "which all presets have a number; 95 %% intervals of what a</text>\n"
        "<text x=\"%d\" y=\"%d\" font-size=\"11\">preset differs from the mean of all in the same "
        "scene. Reference: 16 rays a pixel, %d steps, of the same moment.</text>\n</svg>\n",
        (LEFT + WIDTH - RIGHT) / 2, HEIGHT - BOTTOM + 42,
        neph_study_metrics[neph_study_find_lag()].title, (TOP + HEIGHT - BOTTOM) / 2,
        neph_study_metrics[neph_study_find_headline()].title, LEFT, HEIGHT - 40,
        points.flicker[0].scene_count, points.lag[0].scene_count, LEFT, HEIGHT - 24,
        study->params->steps);
    neph_arena_finish(&arena);
    return NEPH_OK;
}
