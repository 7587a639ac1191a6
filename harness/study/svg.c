/* SPDX-License-Identifier: MIT
 *
 * SVG output that the charts of studies share.
 */
#include "harness/study/svg.h"

#include <stdbool.h>

void neph_svg_print_escaped(const char *text, FILE *out)
{
    for (; *text; text++) {
        if (*text == '<' || *text == '&' || *text == '"')
            fprintf(out, "&#%d;", *text);
        else
            fputc(*text, out);
    }
}

/* ---- marks ----------------------------------------------------------------------------------- */

static const char *const shapes[] = {
    "M-4 0 a4 4 0 1 0 8 0 a4 4 0 1 0 -8 0 z",                         /* circle */
    "M-3.5 -3.5 h7 v7 h-7 z",                                         /* square */
    "M0 -4.5 L4.3 3.5 H-4.3 z",                                       /* triangle, up */
    "M0 -5 L5 0 L0 5 L-5 0 z",                                        /* diamond */
    "M0 4.5 L4.3 -3.5 H-4.3 z",                                       /* triangle, down */
    "M-1.5 -5 h3 v3.5 h3.5 v3 h-3.5 v3.5 h-3 v-3.5 h-3.5 v-3 h3.5 z", /* cross */
    "M-5 -1.6 h10 v3.2 h-10 z",                                       /* horizontal bar */
    "M-1.6 -5 h3.2 v10 h-3.2 z",                                      /* vertical bar */
};
enum { SHAPES = sizeof(shapes) / sizeof(shapes[0]) };
_Static_assert(NEPH_SVG_MARKS == 2 * SHAPES, "each of them full and hollow");

/* M. Okabe, K. Ito, "Color Universal Design", 2008. */
static const char *const colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                      "#e69f00", "#56b4e9", "#000000"};
enum { COLOURS = sizeof(colours) / sizeof(colours[0]) };

void neph_svg_print_mark(int number, double x_px, double y_px, FILE *out)
{
    const char *colour = colours[number % COLOURS];
    const bool is_hollow = number / SHAPES % 2 == 1;
    fprintf(out,
            "<path d=\"%s\" transform=\"translate(%.1f %.1f)\" fill=\"%s\" fill-opacity=\"0.85\" "
            "stroke=\"%s\" stroke-width=\"%s\"/>\n",
            shapes[number % SHAPES], x_px, y_px, is_hollow ? "#fff" : colour,
            is_hollow ? colour : "#fff", is_hollow ? "1.4" : "0.6");
}
