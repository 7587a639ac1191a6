/* SPDX-License-Identifier: MIT
 *
 * Draws the plot of the light study without Vega, so that it needs no Node.
 */
#include "harness/experiments/light.h"

#include "harness/study/svg.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { TILE = 46, SQUARE = NEPH_LIGHT_BINS * TILE, LEFT = 80, TOP = 80, ACROSS = 70, BELOW = 80 };

static const char *const dark = "#2b5c9e", *const bright = "#b5442c";

/* The opacity of a tile grows with the error of its ratio, up to a factor of 4. Blue is too dark,
 * red too bright. */
static double compute_tile_opacity(double ratio)
{
    return fmin(fabs(log2(fmax(ratio, 1e-3))) / 2.0, 1.0);
}

static void draw_tile(const struct neph_light_sums *sums, int x_px, int y_px, FILE *out)
{
    const double ratio = neph_light_ratio(sums);
    if (sums->count == 0 || isnan(ratio))
        return;
    fprintf(out,
            "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"%s\" fill-opacity=\"%.2f\"/>"
            "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">%.2f</text>"
            "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\" font-size=\"9\">%ld</text>\n",
            x_px, y_px, TILE, TILE, ratio < 1.0 ? dark : bright, 0.75 * compute_tile_opacity(ratio),
            x_px + TILE / 2, y_px + TILE / 2, ratio, x_px + TILE / 2, y_px + TILE / 2 + 14,
            sums->count);
}

static void print_edge(double edge, FILE *out)
{
    if (isfinite(edge))
        fprintf(out, "%.3g", edge);
    else
        fputs("∞", out);
}

/* The labels are at the lines between tiles. */
static void draw_edges(enum neph_light_axis x, int left_px, int top_px, FILE *out)
{
    for (int i = 0; i <= NEPH_LIGHT_BINS; i++) {
        fprintf(out, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\" font-size=\"10\">",
                left_px + i * TILE, top_px + SQUARE + 14);
        print_edge(neph_light_axes[x].edges[i], out);
        fprintf(out, "</text><text x=\"%d\" y=\"%d\" text-anchor=\"end\" font-size=\"10\">",
                left_px - 5, top_px + SQUARE - i * TILE + 4);
        print_edge(neph_light_axes[NEPH_LIGHT_EYE].edges[i], out);
        fprintf(out, "</text>\n");
    }
    fprintf(out,
            "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">%s</text>\n<rect x=\"%d\" y=\"%d\" "
            "width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#888\"/>\n",
            left_px + SQUARE / 2, top_px + SQUARE + 34, neph_light_axes[x].title, left_px, top_px,
            SQUARE, SQUARE);
    fprintf(out,
            "<text transform=\"translate(%d %d) rotate(-90)\" text-anchor=\"middle\">%s</text>\n",
            left_px - 44, top_px + SQUARE / 2, neph_light_axes[NEPH_LIGHT_EYE].title);
}

static void draw_map(const struct neph_light_map *map, enum neph_light_axis x, int left_px,
                     int top_px, FILE *out)
{
    for (int eye = 0; eye < NEPH_LIGHT_BINS; eye++)
        for (int other = 0; other < NEPH_LIGHT_BINS; other++)
            draw_tile(&map->bins[eye][other], left_px + other * TILE,
                      top_px + SQUARE - (eye + 1) * TILE, out);
    draw_edges(x, left_px, top_px, out);
}

static void draw_model(const struct neph_light_study *study, int model, FILE *out)
{
    const int left_px = LEFT + model * (SQUARE + ACROSS);
    fprintf(out, "<text x=\"%d\" y=\"%d\" font-size=\"15\">", left_px, TOP - 12);
    neph_svg_print_escaped(study->request->models.words[model], out);
    fprintf(out, "</text>\n");
    draw_map(&study->eye_sun[model], NEPH_LIGHT_SUN, left_px, TOP, out);
    draw_map(&study->eye_angle[model], NEPH_LIGHT_ANGLE, left_px, TOP + SQUARE + BELOW, out);
}

void neph_light_plot(const struct neph_light_study *study, FILE *out)
{
    const int model_count = study->request->models.count;
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" font-family="
            "\"sans-serif\" font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" "
            "fill=\"#fff\"/>\n<text x=\"%d\" y=\"32\" font-size=\"17\">Radiance of each lighting "
            "model over the tracer's; below it, pixels. Blue: too dark; red: too bright</text>\n",
            LEFT + model_count * (SQUARE + ACROSS), TOP + 2 * (SQUARE + BELOW), LEFT);
    for (int model = 0; model < model_count; model++)
        draw_model(study, model, out);
    fprintf(out, "</svg>\n");
}
