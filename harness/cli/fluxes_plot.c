/* SPDX-License-Identifier: MIT */
#include "harness/cli/fluxes_plot.h"

#include "harness/physics/fluxes.h"
#include "harness/study/svg.h"

#include <math.h>
#include <stdbool.h>

enum { WIDTH = 820, HEIGHT = 440, LEFT = 60, TOP = 50, RIGHT = 130, BELOW = 50 };
enum { PLOT_WIDTH = WIDTH - LEFT - RIGHT, PLOT_HEIGHT = HEIGHT - TOP - BELOW };

/* The curves. Colours: M. Okabe, K. Ito, "Color Universal Design", 2008. */
static const struct {
    enum neph_flux flux;
    const char *colour;
} curves[] = {{NEPH_FLUX_REFLECTED, "#0072b2"}, {NEPH_FLUX_TRANSMITTED, "#d55e00"},
              {NEPH_FLUX_ABSORBED, "#009e73"},  {NEPH_FLUX_HORIZONTAL, "#666666"},
              {NEPH_FLUX_NADIR, "#56b4e9"},     {NEPH_FLUX_ZENITH, "#e69f00"}};
enum { CURVES = sizeof(curves) / sizeof(curves[0]) };

struct value {
    double mean, error;
};

static struct value find_value(const struct neph_fluxes *fluxes, enum neph_flux flux, int x)
{
    const int nz = fluxes->domain.columns_z, nx = fluxes->domain.columns_x,
              parts = nz * fluxes->channel_count;
    double mean = 0.0, variance = 0.0;
    for (int z = 0; z < nz; z++)
        for (int c = 0; c < fluxes->channel_count; c++) {
            const struct neph_flux_estimate own = neph_flux_of_column(fluxes, flux, x + nx * z, c);
            mean += own.mean / parts;
            variance += own.standard_error * own.standard_error / ((double)parts * parts);
        }
    return (struct value){mean, sqrt(variance)};
}

struct axis {
    double low, high;
};

/* The range of all curves, in tenths. */
static struct axis find_axis(const struct neph_fluxes *fluxes)
{
    struct axis axis = {0.0, 0.1};
    for (int i = 0; i < CURVES; i++)
        for (int x = 0; x < fluxes->domain.columns_x; x++) {
            const struct value value = find_value(fluxes, curves[i].flux, x);
            axis.low = fmin(axis.low, value.mean - value.error);
            axis.high = fmax(axis.high, value.mean + value.error);
        }
    return (struct axis){floor(10.0 * axis.low) / 10.0, ceil(10.0 * axis.high) / 10.0};
}

static double place_x(const struct neph_fluxes *fluxes, double column)
{
    return LEFT + PLOT_WIDTH * column / fluxes->domain.columns_x;
}

static double place_y(const struct axis *axis, double value)
{
    return TOP + PLOT_HEIGHT * (axis->high - value) / (axis->high - axis->low);
}

static void draw_axes(const struct neph_fluxes *fluxes, const struct axis *axis, FILE *out)
{
    const struct neph_bounds *box = &fluxes->domain.box;
    const double step = (axis->high - axis->low) > 2.0 ? 1.0 : 0.2;
    for (double value = step * ceil(axis->low / step - 1e-9); value < axis->high + 1e-9;
         value += step)
        fprintf(out,
                "<path d=\"M%d %.1f h%d\" stroke=\"#ddd\"/><text x=\"%d\" y=\"%.1f\" "
                "text-anchor=\"end\">%.1f</text>\n",
                LEFT, place_y(axis, value), PLOT_WIDTH, LEFT - 6, place_y(axis, value) + 4.0,
                value + 0.0);
    for (int i = 0; i <= 4; i++)
        fprintf(out, "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%g</text>\n",
                LEFT + PLOT_WIDTH * i / 4.0, HEIGHT - BELOW + 18,
                box->min_m.x + (box->max_m.x - box->min_m.x) * i / 4.0);
    fprintf(out,
            "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">x [m]</text>\n"
            "<text transform=\"translate(16 %d) rotate(-90)\" text-anchor=\"middle\">part of the "
            "sunlight on a level plane</text>\n",
            LEFT + PLOT_WIDTH / 2, HEIGHT - 10, TOP + PLOT_HEIGHT / 2);
}

/* Steps from column to column, `errors` standard errors beside the mean; to the left if
 * `is_back`. */
static void draw_steps(const struct neph_fluxes *fluxes, const struct axis *axis, int curve,
                       double errors, bool is_back, FILE *out)
{
    const int nx = fluxes->domain.columns_x;
    for (int i = 0; i < nx; i++) {
        const int x = is_back ? nx - 1 - i : i;
        const struct value value = find_value(fluxes, curves[curve].flux, x);
        const double y = place_y(axis, value.mean + errors * value.error);
        fprintf(out, "L%.1f %.1f L%.1f %.1f", place_x(fluxes, x + (is_back ? 1 : 0)), y,
                place_x(fluxes, x + (is_back ? 0 : 1)), y);
    }
}

static void draw_curve(const struct neph_fluxes *fluxes, const struct axis *axis, int curve,
                       FILE *out)
{
    const double start = place_y(axis, find_value(fluxes, curves[curve].flux, 0).mean);
    const int y = TOP + 12 + 18 * curve;
    fprintf(out, "<path fill=\"%s\" fill-opacity=\"0.25\" d=\"M%d %.1f", curves[curve].colour, LEFT,
            start);
    draw_steps(fluxes, axis, curve, 1.0, false, out);
    draw_steps(fluxes, axis, curve, -1.0, true, out);
    fprintf(out, "Z\"/>\n<path fill=\"none\" stroke=\"%s\" d=\"M%d %.1f", curves[curve].colour,
            LEFT, start);
    draw_steps(fluxes, axis, curve, 0.0, false, out);
    fprintf(out,
            "\"/>\n<path d=\"M%d %d h20\" stroke=\"%s\" stroke-width=\"2\"/><text x=\"%d\" "
            "y=\"%d\">%s</text>\n",
            WIDTH - RIGHT + 10, y - 4, curves[curve].colour, WIDTH - RIGHT + 36, y,
            neph_flux_names[curves[curve].flux]);
}

void neph_fluxes_plot_print(const void *plot_, FILE *out)
{
    const struct neph_fluxes_plot *plot = plot_;
    const struct axis axis = find_axis(plot->fluxes);
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" font-family="
            "\"sans-serif\" font-size=\"12\">\n<rect width=\"100%%\" height=\"100%%\" "
            "fill=\"#fff\"/>\n<text x=\"%d\" y=\"28\" font-size=\"15\">",
            WIDTH, HEIGHT, LEFT);
    neph_svg_print_escaped(plot->title, out);
    fprintf(out, "</text>\n");
    draw_axes(plot->fluxes, &axis, out);
    for (int curve = 0; curve < CURVES; curve++)
        draw_curve(plot->fluxes, &axis, curve, out);
    fprintf(out, "</svg>\n");
}
