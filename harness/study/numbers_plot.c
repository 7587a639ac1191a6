/* SPDX-License-Identifier: MIT
 *
 * The chart of post-processing stages.
 */
#include "harness/study/numbers_plot.h"

#include "harness/study/svg.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Panels below each other, narrow enough for the text to be readable on a phone. */
enum { WIDTH = 430, LEFT = 192, PANEL = 222, TOP = 50, LINE = 20, GAP = 24, LEGEND = 18 };

static const struct panel {
    const char *title; /* without "over ..." */
    size_t at;
    bool is_sparse; /* leaves out rows without a change */
} panels[] = {
    {"FLIP", offsetof(struct neph_post_numbers, flip), false},
    {"flicker seen", offsetof(struct neph_post_numbers, seen), false},
    {"milliseconds", offsetof(struct neph_post_numbers, ms), false},
    {"error before the tone curve (other rows: 1)", offsetof(struct neph_post_numbers, scene_error),
     true},
    {"change before the tone curve (other rows: 1)",
     offsetof(struct neph_post_numbers, scene_change), true},
};
enum { PANELS = sizeof(panels) / sizeof(panels[0]) };

/* log2 of a row's value over the base row's; NaN where either is missing. */
static double ratio(const struct neph_numbers_plot *plot, const struct panel *panel, int scene,
                    int row)
{
    const char *own = (const char *)&plot->numbers[scene * plot->stride + row];
    const char *base = (const char *)&plot->numbers[scene * plot->stride + plot->base];
    return log2(*(const double *)(own + panel->at) / *(const double *)(base + panel->at));
}

struct axis {
    double low, high; /* log2 */
};

static double at_px(const struct axis *axis, double place)
{
    return LEFT + PANEL * (place - axis->low) / (axis->high - axis->low);
}

static struct axis fit(const struct neph_numbers_plot *plot, int panel)
{
    struct axis axis = {-0.5, 0.5};
    for (int s = 0; s < plot->scene_count; s++)
        for (int r = 0; plot->rows[r].name; r++) {
            const double place = ratio(plot, &panels[panel], s, r);
            if (!isfinite(place))
                continue;
            axis.low = fmin(axis.low, place - 0.1);
            axis.high = fmax(axis.high, place + 0.1);
        }
    return axis;
}

static void draw_line(const struct axis *axis, double place, int top, int bottom, FILE *out)
{
    const double px = at_px(axis, place);
    fprintf(out,
            "<path d=\"M%.1f %d V%d\" stroke=\"%s\"/>"
            "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%.2g</text>\n",
            px, top - 8, bottom, place == 0.0 ? "#666" : "#ddd", px, top - 12, exp2(place));
}

static void draw_grid(const struct axis *axis, const char *title, const char *over, int top,
                      int bottom, FILE *out)
{
    const double range = axis->high - axis->low; /* powers of 2 */
    const double step = range < 4.0 ? 0.5 : ceil(range / 6.0);
    fprintf(out, "<text x=\"%d\" y=\"%d\" text-anchor=\"end\">%s, over ", WIDTH - 10, top - 30,
            title);
    neph_svg_print_escaped(over, out);
    fprintf(out, "</text>\n");
    for (double k = ceil(axis->low / step); k * step <= axis->high; k++)
        draw_line(axis, k * step, top, bottom, out);
}

static void draw_row(const struct neph_numbers_plot *plot, int panel, const struct axis *axis,
                     int row, int y, FILE *out)
{
    fprintf(out, "<text x=\"%d\" y=\"%d\" text-anchor=\"end\">", LEFT - 8, y + 4);
    neph_svg_print_escaped(plot->rows[row].name, out);
    fprintf(out, "</text><path d=\"M%d %d H%d\" stroke=\"#eee\"/>\n", LEFT, y, WIDTH - 10);
    bool any = false;
    for (int s = 0; s < plot->scene_count; s++) {
        const double place = ratio(plot, &panels[panel], s, row);
        any |= isfinite(place);
        if (isfinite(place))
            neph_svg_print_mark(s, at_px(axis, place), y, out);
    }
    if (!any)
        fprintf(out, "<text x=\"%.1f\" y=\"%d\" fill=\"#666\">none</text>\n",
                at_px(axis, 0.0) + 6.0, y + 4);
}

static bool is_drawn(const struct neph_numbers_plot *plot, int panel, int row)
{
    bool differs = !panels[panel].is_sparse;
    for (int s = 0; s < plot->scene_count; s++)
        differs |= fabs(ratio(plot, &panels[panel], s, row)) > 1e-3;
    return differs;
}

/* Number of lines above row `row`, or of all rows for the end of the table. An empty line separates
 * single stages from the rows with a stage taken out. */
static int lines_before(const struct neph_numbers_plot *plot, int panel, int row)
{
    int lines = 0;
    bool is_of_whole = false;
    for (int r = 0; r < row; r++)
        if (is_drawn(plot, panel, r)) {
            lines += 1 + (plot->rows[r].is_of_whole && !is_of_whole);
            is_of_whole |= plot->rows[r].is_of_whole;
        }
    return lines + (plot->rows[row].is_of_whole && !is_of_whole);
}

static int row_count(const struct neph_numbers_plot *plot)
{
    int rows = 0;
    while (plot->rows[rows].name)
        rows++;
    return rows;
}

static int panel_height(const struct neph_numbers_plot *plot, int panel)
{
    return TOP + LINE * (lines_before(plot, panel, row_count(plot)) + 1);
}

static void draw_panel(const struct neph_numbers_plot *plot, int panel, int top, FILE *out)
{
    const struct axis axis = fit(plot, panel);
    draw_grid(&axis, panels[panel].title, plot->over, top,
              top + panel_height(plot, panel) - TOP - LINE / 2, out);
    for (int r = 0; plot->rows[r].name; r++)
        if (is_drawn(plot, panel, r))
            draw_row(plot, panel, &axis, r, top + LINE * lines_before(plot, panel, r) + LINE / 2,
                     out);
}

/* Two scenes per line. */
static void draw_legend(const struct neph_numbers_plot *plot, int top, FILE *out)
{
    for (int s = 0; s < plot->scene_count; s++) {
        const double x = 20.0 + s % 2 * 0.5 * WIDTH, y = top + LEGEND * (s / 2);
        neph_svg_print_mark(s, x, y, out);
        fprintf(out, "<text x=\"%.1f\" y=\"%.1f\">", x + 10.0, y + 4.0);
        neph_svg_print_escaped(plot->scenes[s], out);
        fprintf(out, "</text>\n");
    }
}

void neph_numbers_plot(const struct neph_numbers_plot *plot, FILE *out)
{
    const int legend = GAP + LEGEND * ((plot->scene_count + 1) / 2);
    int height = legend, tops[PANELS];
    for (int p = 0; p < PANELS; p++) {
        tops[p] = height + TOP;
        height += panel_height(plot, p);
    }
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" "
            "font-family=\"sans-serif\" font-size=\"12\">\n"
            "<rect width=\"%d\" height=\"%d\" fill=\"white\"/>\n",
            WIDTH, height, WIDTH, WIDTH, height);
    draw_legend(plot, GAP, out);
    for (int p = 0; p < PANELS; p++)
        draw_panel(plot, p, tops[p], out);
    fprintf(out, "</svg>\n");
}
