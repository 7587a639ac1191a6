/* SPDX-License-Identifier: MIT
 *
 * The chart of an attribution: for each scene a bar of the shares of its parts.
 */
#include "harness/study/attribution_study.h"

#include "harness/study/svg.h"

#include <math.h>

enum { WIDTH = 840, LEFT = 170, RIGHT = 90, TOP = 92, ROW = 24, BAR = 16, BOTTOM = 56, KEY = 14 };
enum { LABEL_PX = 24 }; /* segments from this width on have their percents */

/* Fails to compile when a part is added, as it needs a fill. */
_Static_assert(NEPH_PARTS == 8, "a new kind");

/* Differ in lightness or pattern, so that the chart is readable in grey. Colours after M. Okabe, K.
 * Ito, "Color Universal Design", 2008. */
static const struct {
    const char *fill, *text;
} fills[NEPH_PARTS] = {
    {"#0072b2", "#fff"}, {"#f0e442", "#000"},    {"url(#stripes)", "#000"}, {"#ffffff", "#000"},
    {"#e8894c", "#000"}, {"url(#dots)", "#000"}, {"url(#waves)", "#000"},   {"#222222", "#fff"},
};
static const char patterns[] =
    "<defs><pattern id=\"stripes\" width=\"5\" height=\"5\" patternUnits=\"userSpaceOnUse\" "
    "patternTransform=\"rotate(45)\"><rect width=\"5\" height=\"5\" fill=\"#b6e5d7\"/><rect "
    "width=\"2\" height=\"5\" fill=\"#009e73\"/></pattern><pattern id=\"dots\" width=\"5\" "
    "height=\"5\" patternUnits=\"userSpaceOnUse\"><rect width=\"5\" height=\"5\" "
    "fill=\"#d3ebf8\"/><circle cx=\"2.5\" cy=\"2.5\" r=\"1\" fill=\"#3c93c2\"/></pattern><pattern "
    "id=\"waves\" width=\"8\" height=\"4\" patternUnits=\"userSpaceOnUse\"><rect width=\"8\" "
    "height=\"4\" fill=\"#f3dbe8\"/><path d=\"M0 3 L4 1 L8 3\" fill=\"none\" "
    "stroke=\"#a24d7d\"/></pattern></defs>\n";

/* An axis of percents. */
struct axis {
    double low, high;
};

static double at_px(const struct axis *axis, double percent)
{
    return LEFT + (WIDTH - LEFT - RIGHT) * (percent - axis->low) / (axis->high - axis->low);
}

/* Whole tens around all bars. */
static struct axis fit_axis(const struct neph_attribution_study *attribution)
{
    struct axis axis = {0.0, 100.0};
    for (int i = 0; i < attribution->study->params->scene_count; i++) {
        double ends[2] = {0.0, 0.0};
        for (int part = 0; part < NEPH_PARTS && !attribution->scenes[i].why; part++) {
            const double percent = neph_attribution_percent(&attribution->scenes[i], part);
            ends[percent > 0.0] += percent;
        }
        axis.low = fmin(axis.low, 10.0 * floor(ends[0] / 10.0));
        axis.high = fmax(axis.high, 10.0 * ceil(ends[1] / 10.0));
    }
    return axis;
}

static void draw_key(FILE *out)
{
    double x_px = LEFT;
    for (int part = 0; part < NEPH_PARTS; part++) {
        const char *name = neph_attribution_parts[part].name;
        fprintf(out,
                "<rect x=\"%.0f\" y=\"44\" width=\"%d\" height=\"%d\" fill=\"%s\" "
                "stroke=\"#000\" stroke-width=\"0.6\"/><text x=\"%.0f\" y=\"55\">%s</text>\n",
                x_px, KEY, KEY - 2, fills[part].fill, x_px + KEY + 4, name);
        x_px += KEY + 16;
        for (; *name; name++)
            x_px += 6.4; /* mean width of a letter at 12 px */
    }
}

static void draw_axis(const struct axis *axis, double bottom_px, FILE *out)
{
    const double step = axis->high - axis->low > 300.0 ? 100.0 : 20.0;
    for (double percent = step * ceil(axis->low / step); percent <= axis->high; percent += step)
        fprintf(out,
                "<path d=\"M%.1f %d V%.0f\" stroke=\"%s\"/>"
                "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%g</text>\n",
                at_px(axis, percent), TOP - 6, bottom_px, percent == 0.0 ? "#000" : "#ccc",
                at_px(axis, percent), TOP - 12, percent + 0.0);
}

static void draw_segment(const struct axis *axis, int part, double from, double percent,
                         double top_px, FILE *out)
{
    const double left_px = at_px(axis, fmin(from, from + percent)),
                 right_px = at_px(axis, fmax(from, from + percent));
    if (right_px - left_px < 0.1)
        return;
    fprintf(out,
            "<rect x=\"%.1f\" y=\"%.0f\" width=\"%.1f\" height=\"%d\" fill=\"%s\" "
            "stroke=\"#000\" stroke-width=\"0.6\"/>",
            left_px, top_px, right_px - left_px, BAR, fills[part].fill);
    if (right_px - left_px >= LABEL_PX)
        fprintf(out,
                "<text x=\"%.1f\" y=\"%.0f\" font-size=\"11\" text-anchor=\"middle\" "
                "fill=\"%s\">%.0f</text>",
                0.5 * (left_px + right_px), top_px + 12.0, fills[part].text, percent);
}

static void draw_scene(const struct neph_attribution_scene *scene, const char *name,
                       const struct axis *axis, double top_px, FILE *out)
{
    double ends[2] = {0.0, 0.0};
    fprintf(out, "<text x=\"%d\" y=\"%.0f\" text-anchor=\"end\">", LEFT - 8, top_px + 12.0);
    neph_svg_print_escaped(name, out);
    fprintf(out, "</text>");
    for (int part = 0; part < NEPH_PARTS; part++) {
        const double percent = neph_attribution_percent(scene, part);
        draw_segment(axis, part, ends[percent > 0.0], percent, top_px, out);
        ends[percent > 0.0] += percent;
    }
    fprintf(out, "<text x=\"%d\" y=\"%.0f\">%.3g%s</text>\n", WIDTH - RIGHT + 8, top_px + 12.0,
            sqrt(scene->values.all), neph_attribution_explains(&scene->values) ? "" : " *");
}

void neph_attribution_plot(const struct neph_attribution_study *attribution, FILE *out)
{
    const struct neph_flicker_study *study = attribution->study;
    const struct axis axis = fit_axis(attribution);
    const int bottom_px = TOP + ROW * attribution->scene_count;
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" font-family="
            "\"sans-serif\" font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" "
            "fill=\"#fff\"/>\n%s<text x=\"%d\" y=\"26\" font-size=\"16\">Causes of the flicker "
            "seen: ",
            WIDTH, bottom_px + BOTTOM, patterns, LEFT);
    neph_svg_print_escaped(attribution->plan->preset, out);
    fprintf(out, "</text>\n");
    draw_key(out);
    draw_axis(&axis, bottom_px, out);
    int row = 0;
    for (int i = 0; i < study->params->scene_count; i++)
        if (!attribution->scenes[i].why)
            draw_scene(&attribution->scenes[i], study->scenes[i].name, &axis, TOP + ROW * row++,
                       out);
    fprintf(out,
            "<text x=\"%d\" y=\"%d\" font-size=\"11\">Shares of the squared flicker seen [%%]; "
            "right: flicker seen, contrast over threshold.</text>\n"
            "<text x=\"%d\" y=\"%d\" font-size=\"11\">Left of 0: the part hides flicker of other "
            "parts. *: the parts by themselves do not add up to it within 15 %%.</text>\n</svg>\n",
            LEFT, bottom_px + 20, LEFT, bottom_px + 38);
}
