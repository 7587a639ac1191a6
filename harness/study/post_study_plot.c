/* SPDX-License-Identifier: MIT
 *
 * The chart of a post study: a line for each chain, a mark for each scene, error and flicker on the
 * display over those of the curve alone. Drawn here and not by Vega, so that a study on a machine
 * without node has it.
 */
#include "base/written.h"
#include "harness/study/post_study.h"
#include "harness/study/svg.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 860, LEFT = 230, GAP = 30, PANEL = 290, TOP = 56, LINE = 20, FOOT = 30 };

/* What marks are over: the curve alone. */
static const char base_name[] = "Unreal's curve";

static const char *const colours[] = {"#1f77b4", "#d62728", "#2ca02c", "#9467bd",
                                      "#ff7f0e", "#17becf", "#8c564b", "#7f7f7f"};
enum { COLOURS = sizeof(colours) / sizeof(colours[0]) };

static const struct panel {
    const char *title;
    size_t at;
} panels[] = {{"FLIP, over the curve alone", offsetof(struct neph_post_numbers, flip)},
              {"flicker seen, over the curve alone", offsetof(struct neph_post_numbers, seen)}};
enum { PANELS = sizeof(panels) / sizeof(panels[0]) };

static int base_row(void)
{
    int row = 0;
    while (strcmp(neph_post_rows[row].name, base_name) != 0)
        row++;
    return row;
}

/* log2; NaN where one of the two is none. */
static double ratio(const struct neph_post_study *study, const struct panel *panel, int scene,
                    int row)
{
    const char *own = (const char *)&study->numbers[scene][row];
    const char *base = (const char *)&study->numbers[scene][base_row()];
    return log2(*(const double *)(own + panel->at) / *(const double *)(base + panel->at));
}

struct axis {
    double low, high; /* log2 */
    double start_px;
};

static double at_px(const struct axis *axis, double place)
{
    return axis->start_px + PANEL * (place - axis->low) / (axis->high - axis->low);
}

static struct axis fit(const struct neph_post_study *study, int panel)
{
    struct axis axis = {-0.5, 0.5, LEFT + panel * (PANEL + GAP)};
    for (int s = 0; s < study->params->scene_count; s++)
        for (int r = 0; neph_post_rows[r].name; r++) {
            const double place = ratio(study, &panels[panel], s, r);
            if (!isfinite(place))
                continue;
            axis.low = fmin(axis.low, place - 0.1);
            axis.high = fmax(axis.high, place + 0.1);
        }
    return axis;
}

static void draw_grid(const struct axis *axis, const char *title, int bottom, FILE *out)
{
    fprintf(out, "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%s</text>\n",
            axis->start_px + 0.5 * PANEL, TOP - 30, title);
    for (int power = (int)ceil(axis->low); power <= (int)floor(axis->high); power++) {
        const double px = at_px(axis, power);
        fprintf(out,
                "<path d=\"M%.1f %d V%d\" stroke=\"%s\"/>"
                "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%g</text>\n",
                px, TOP - 8, bottom, power == 0 ? "#888" : "#ddd", px, TOP - 12, exp2(power));
    }
}

static void draw_row(const struct neph_post_study *study, const struct axis *axes, int row, int y,
                     FILE *out)
{
    fprintf(out, "<text x=\"%d\" y=\"%d\" text-anchor=\"end\">", LEFT - 12, y + 4);
    neph_svg_print_escaped(neph_post_rows[row].name, out);
    fprintf(out, "</text><path d=\"M%d %d H%d\" stroke=\"#eee\"/>\n", LEFT - 6, y, WIDTH - 10);
    for (int p = 0; p < PANELS; p++)
        for (int s = 0; s < study->params->scene_count; s++) {
            const double place = ratio(study, &panels[p], s, row);
            if (isfinite(place))
                fprintf(
                    out,
                    "<circle cx=\"%.1f\" cy=\"%d\" r=\"4\" fill=\"%s\" fill-opacity=\"0.8\"/>\n",
                    at_px(&axes[p], place), y, colours[s % COLOURS]);
        }
}

static void draw_legend(const struct neph_post_study *study, int y, FILE *out)
{
    double x = LEFT;
    const double letter_px = 7.2; /* on average, at 12 px */
    for (int s = 0; s < study->params->scene_count; s++) {
        fprintf(out,
                "<circle cx=\"%.1f\" cy=\"%d\" r=\"4\" fill=\"%s\"/><text x=\"%.1f\" y=\"%d\">", x,
                y, colours[s % COLOURS], x + 9.0, y + 4);
        neph_svg_print_escaped(study->names[s], out);
        fprintf(out, "</text>\n");
        x += 30.0 + letter_px * (double)strlen(study->names[s]);
    }
}

static void draw(const void *what, FILE *out)
{
    const struct neph_post_study *study = what;
    struct axis axes[PANELS];
    int rows = 0;
    while (neph_post_rows[rows].name)
        rows++;
    const int bottom = TOP + LINE * (rows + 1);
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" "
            "font-family=\"sans-serif\" font-size=\"12\">\n"
            "<rect width=\"%d\" height=\"%d\" fill=\"white\"/>\n",
            WIDTH, bottom + FOOT, WIDTH, bottom + FOOT);
    for (int p = 0; p < PANELS; p++) {
        axes[p] = fit(study, p);
        draw_grid(&axes[p], panels[p].title, bottom - LINE / 2, out);
    }
    /* A line is left between what is alone and what is out of the whole. */
    for (int r = 0; r < rows; r++)
        draw_row(study, axes, r, TOP + LINE * (r + neph_post_rows[r].is_of_whole) + LINE / 2, out);
    draw_legend(study, bottom + FOOT / 2, out);
    fprintf(out, "</svg>\n");
}

enum neph_status neph_post_study_plot(const struct neph_post_study *study, char **svg,
                                      struct neph_diag *diag)
{
    return neph_written(draw, study, svg, diag);
}
