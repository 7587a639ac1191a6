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

/* As wide as a page: a row for each row of the study, a panel for each number, side by side. */
enum { WIDTH = 1000, LEFT = 190, PANEL = 150, GAP = 12, HEAD = 66, LINE = 16, LEGEND = 18 };

static const struct panel {
    const char *title[2]; /* two lines */
    size_t at;
    bool is_sparse; /* a row whose ratio is 1 in every scene has no mark */
} panels[] = {
    {{"FLIP", ""}, offsetof(struct neph_post_numbers, flip), false},
    {{"flicker seen", ""}, offsetof(struct neph_post_numbers, seen), false},
    {{"milliseconds", ""}, offsetof(struct neph_post_numbers, ms), false},
    {{"error of the light", "before the curve"},
     offsetof(struct neph_post_numbers, scene_error),
     true},
    {{"change of the light", "before the curve"},
     offsetof(struct neph_post_numbers, scene_change),
     true},
};
enum { PANELS = sizeof(panels) / sizeof(panels[0]) };

/* log2 of a row's value over the base row's; NaN where either is missing. */
static double compute_log_ratio(const struct neph_numbers_plot *plot, const struct panel *panel,
                                int scene, int row)
{
    const char *own = (const char *)&plot->numbers[scene * plot->stride + row];
    const char *base = (const char *)&plot->numbers[scene * plot->stride + plot->base];
    return log2(*(const double *)(own + panel->at) / *(const double *)(base + panel->at));
}

struct axis {
    double low, high; /* log2 */
    int left_px;
};

static double at_px(const struct axis *axis, double place)
{
    return axis->left_px + PANEL * (place - axis->low) / (axis->high - axis->low);
}

static struct axis fit_axis(const struct neph_numbers_plot *plot, int panel)
{
    struct axis axis = {-0.5, 0.5, LEFT + (PANEL + GAP) * panel};
    for (int s = 0; s < plot->scene_count; s++)
        for (int r = 0; plot->rows[r].name; r++) {
            const double place = compute_log_ratio(plot, &panels[panel], s, r);
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
            px, top - 4, bottom, place == 0.0 ? "#666" : "#ddd", px, top - 8, exp2(place));
}

static void draw_grid(const struct axis *axis, int panel, int top, int bottom, FILE *out)
{
    const double range = axis->high - axis->low; /* powers of 2 */
    const double step = range < 2.5 ? 0.5 : ceil(range / 5.0);
    for (int i = 0; i < 2; i++)
        fprintf(out, "<text x=\"%d\" y=\"%d\" font-weight=\"bold\">%s</text>\n", axis->left_px,
                top - 42 + 14 * i, panels[panel].title[i]);
    for (double k = ceil(axis->low / step); k * step <= axis->high; k++)
        draw_line(axis, k * step, top, bottom, out);
}

/* Whether any scene has a mark of a row in a panel. */
static bool is_drawn(const struct neph_numbers_plot *plot, int panel, int row)
{
    bool differs = !panels[panel].is_sparse;
    for (int s = 0; s < plot->scene_count; s++)
        differs |= fabs(compute_log_ratio(plot, &panels[panel], s, row)) > 1e-3;
    return differs;
}

static void draw_marks(const struct neph_numbers_plot *plot, int panel, const struct axis *axis,
                       int row, int y, FILE *out)
{
    bool any = false;
    for (int s = 0; s < plot->scene_count; s++) {
        const double place = compute_log_ratio(plot, &panels[panel], s, row);
        any |= isfinite(place);
        if (isfinite(place))
            neph_svg_print_mark(s, at_px(axis, place), y, out);
    }
    if (!any && !panels[panel].is_sparse)
        fprintf(out, "<text x=\"%.1f\" y=\"%d\" fill=\"#666\">none</text>\n",
                at_px(axis, 0.0) + 6.0, y + 4);
}

/* The line of a row. An empty line divides single stages from chains made from the whole. */
static int find_line(const struct neph_numbers_plot *plot, int row)
{
    return row + (plot->rows[row].name == NULL || plot->rows[row].is_of_whole ? 1 : 0);
}

static int row_count(const struct neph_numbers_plot *plot)
{
    int rows = 0;
    while (plot->rows[rows].name)
        rows++;
    return rows;
}

static void draw_names(const struct neph_numbers_plot *plot, int top, FILE *out)
{
    for (int r = 0; plot->rows[r].name; r++) {
        const int y = top + LINE * find_line(plot, r) + LINE / 2;
        fprintf(out, "<text x=\"%d\" y=\"%d\" text-anchor=\"end\">", LEFT - 8, y + 4);
        neph_svg_print_escaped(plot->rows[r].name, out);
        fprintf(out, "</text><path d=\"M%d %d H%d\" stroke=\"#eee\"/>\n", LEFT, y, WIDTH - 10);
    }
}

static void draw_panel(const struct neph_numbers_plot *plot, int panel, int top, int bottom,
                       FILE *out)
{
    const struct axis axis = fit_axis(plot, panel);
    draw_grid(&axis, panel, top, bottom, out);
    for (int r = 0; plot->rows[r].name; r++)
        if (is_drawn(plot, panel, r))
            draw_marks(plot, panel, &axis, r, top + LINE * find_line(plot, r) + LINE / 2, out);
}

/* Five scenes a line, and the row that all others are divided by. */
static void draw_legend(const struct neph_numbers_plot *plot, int top, FILE *out)
{
    enum { EACH = 5 };
    fprintf(out, "<text x=\"20\" y=\"%d\" font-size=\"14\">Each number over ", top);
    neph_svg_print_escaped(plot->over, out);
    fprintf(out, "</text>\n");
    for (int s = 0; s < plot->scene_count; s++) {
        const double x = 24.0 + s % EACH * ((WIDTH - 40.0) / EACH),
                     y = top + LEGEND * (s / EACH + 1);
        neph_svg_print_mark(s, x, y, out);
        fprintf(out, "<text x=\"%.1f\" y=\"%.1f\">", x + 10.0, y + 4.0);
        neph_svg_print_escaped(plot->scenes[s], out);
        fprintf(out, "</text>\n");
    }
}

void neph_numbers_plot(const struct neph_numbers_plot *plot, FILE *out)
{
    enum { TITLE = 26 };
    const int top = TITLE + LEGEND * ((plot->scene_count + 4) / 5) + HEAD;
    const int bottom = top + LINE * (find_line(plot, row_count(plot)) + 1);
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" "
            "font-family=\"sans-serif\" font-size=\"12\">\n"
            "<rect width=\"%d\" height=\"%d\" fill=\"white\"/>\n",
            WIDTH, bottom, WIDTH, WIDTH, bottom);
    draw_legend(plot, TITLE, out);
    draw_names(plot, top, out);
    for (int p = 0; p < PANELS; p++)
        draw_panel(plot, p, top, bottom - LINE / 2, out);
    fprintf(out, "</svg>\n");
}
