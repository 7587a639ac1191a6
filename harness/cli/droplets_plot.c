/* SPDX-License-Identifier: MIT */
#include "harness/cli/droplets_plot.h"

#include "harness/study/svg.h"

#include <math.h>
#include <stdbool.h>

enum { WIDTH = 720, HEIGHT = 420, LEFT = 70, TOP = 50, RIGHT = 20, BELOW = 50 };
enum { PLOT_WIDTH = WIDTH - LEFT - RIGHT, PLOT_HEIGHT = HEIGHT - TOP - BELOW };

/* M. Okabe, K. Ito, "Color Universal Design", 2008. */
static const char *const colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00"};
enum { COLOURS = sizeof(colours) / sizeof(colours[0]) };

struct decades {
    int low, high; /* powers of ten */
};

static struct decades find_decades(const struct neph_phase_plot *plot)
{
    double low = INFINITY, high = 0.0;
    for (int c = 0; c < plot->curve_count; c++)
        for (int i = 0; i < plot->angle_count; i++) {
            low = fmin(low, 4.0 * M_PI * plot->curves[c].phase_per_sr[i]);
            high = fmax(high, 4.0 * M_PI * plot->curves[c].phase_per_sr[i]);
        }
    const struct decades found = {(int)floor(log10(fmax(low, 1e-12))), (int)ceil(log10(high))};
    return found.low < found.high ? found : (struct decades){found.low, found.low + 1};
}

static double place_x(double angle_deg)
{
    return LEFT + PLOT_WIDTH * angle_deg / 180.0;
}

static double place_y(const struct decades *decades, double value)
{
    const double part = (log10(value) - decades->low) / (decades->high - decades->low);
    return TOP + PLOT_HEIGHT * (1.0 - fmin(fmax(part, 0.0), 1.0));
}

static void draw_axes(const struct decades *decades, FILE *out)
{
    for (int angle = 0; angle <= 180; angle += 30)
        fprintf(out,
                "<path d=\"M%.1f %d v%d\" stroke=\"#ddd\"/><text x=\"%.1f\" y=\"%d\" "
                "text-anchor=\"middle\">%d</text>\n",
                place_x(angle), TOP, PLOT_HEIGHT, place_x(angle), HEIGHT - BELOW + 18, angle);
    for (int power = decades->low; power <= decades->high; power++)
        fprintf(out,
                "<path d=\"M%d %.1f h%d\" stroke=\"#ddd\"/><text x=\"%d\" y=\"%.1f\" "
                "text-anchor=\"end\">1e%d</text>\n",
                LEFT, place_y(decades, pow(10.0, power)), PLOT_WIDTH, LEFT - 6,
                place_y(decades, pow(10.0, power)) + 4.0, power);
    fprintf(out,
            "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">scattering angle [degrees]</text>\n"
            "<text transform=\"translate(18 %d) rotate(-90)\" text-anchor=\"middle\">phase "
            "function times 4 pi</text>\n",
            LEFT + PLOT_WIDTH / 2, HEIGHT - 10, TOP + PLOT_HEIGHT / 2);
}

static void begin_curve(const char *colour, const char *dashes, FILE *out)
{
    fprintf(out, "<path fill=\"none\" stroke=\"%s\" stroke-dasharray=\"%s\" d=\"M", colour, dashes);
}

static void draw_curve(const struct neph_phase_plot *plot, const struct decades *decades, int curve,
                       FILE *out)
{
    begin_curve(colours[curve % COLOURS], "none", out);
    for (int i = 0; i < plot->angle_count; i++)
        fprintf(out, "%s%.1f %.1f", i > 0 ? "L" : "", place_x(plot->angles_deg[i]),
                place_y(decades, 4.0 * M_PI * plot->curves[curve].phase_per_sr[i]));
    fputs("\"/>\n", out);
}

static void draw_henyey_greenstein(const struct decades *decades, double g, FILE *out)
{
    begin_curve("#666", "5 4", out);
    for (int angle = 0; angle <= 180; angle++) {
        const double cosine = cos(angle * M_PI / 180.0),
                     value = (1.0 - g * g) / pow(1.0 + g * g - 2.0 * g * cosine, 1.5);
        fprintf(out, "%s%.1f %.1f", angle > 0 ? "L" : "", place_x(angle), place_y(decades, value));
    }
    fputs("\"/>\n", out);
}

static void draw_legend(const struct neph_phase_plot *plot, FILE *out)
{
    const double x = LEFT + 0.45 * PLOT_WIDTH;
    for (int c = 0; c <= plot->curve_count; c++) {
        const int y = TOP + 18 + 17 * c;
        const bool is_last = c == plot->curve_count;
        fprintf(out,
                "<path d=\"M%.1f %d h24\" stroke=\"%s\" stroke-dasharray=\"%s\"/><text x=\"%.1f\" "
                "y=\"%d\">",
                x, y - 4, is_last ? "#666" : colours[c % COLOURS], is_last ? "5 4" : "none",
                x + 30.0, y);
        if (is_last)
            fprintf(out, "Henyey-Greenstein, g %.4f</text>\n", plot->curves[0].asymmetry);
        else
            fprintf(out, "%g nm, g %.4f</text>\n", plot->curves[c].wavelength_nm,
                    plot->curves[c].asymmetry);
    }
}

void neph_phase_plot_print(const void *plot_, FILE *out)
{
    const struct neph_phase_plot *plot = plot_;
    const struct decades decades = find_decades(plot);
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" font-family="
            "\"sans-serif\" font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" "
            "fill=\"#fff\"/>\n<text x=\"%d\" y=\"28\" font-size=\"15\">",
            WIDTH, HEIGHT, LEFT);
    neph_svg_print_escaped(plot->title, out);
    fprintf(out, "</text>\n");
    draw_axes(&decades, out);
    draw_henyey_greenstein(&decades, plot->curves[0].asymmetry, out);
    for (int c = 0; c < plot->curve_count; c++)
        draw_curve(plot, &decades, c, out);
    draw_legend(plot, out);
    fprintf(out, "</svg>\n");
}
