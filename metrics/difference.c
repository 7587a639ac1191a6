/* SPDX-License-Identifier: MIT
 *
 * Colour maps of signed differences and of amounts, see display.h.
 */
#include "metrics/display.h"
#include "metrics/metric.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* ColorBrewer RdBu in 11 classes (Brewer, colorbrewer2.org), reversed so that blue means less. It
 * is readable with all common kinds of colour blindness. */
static const struct neph_display_stop stops[] = {
    {-1.0, {0x05, 0x30, 0x61}}, {-0.8, {0x21, 0x66, 0xac}}, {-0.6, {0x43, 0x93, 0xc3}},
    {-0.4, {0x92, 0xc5, 0xde}}, {-0.2, {0xd1, 0xe5, 0xf0}}, {0.0, {0xf7, 0xf7, 0xf7}},
    {0.2, {0xfd, 0xdb, 0xc7}},  {0.4, {0xf4, 0xa5, 0x82}},  {0.6, {0xd6, 0x60, 0x4d}},
    {0.8, {0xb2, 0x18, 0x2b}},  {1.0, {0x67, 0x00, 0x1f}},
};

enum { STOP_COUNT = sizeof(stops) / sizeof(stops[0]) };

/* Both ends of the scale are dark; values beyond it are bright: cyan-blue below, yellow above. */
static const struct neph_display_legend legend = {
    .stops = stops,
    .stop_count = STOP_COUNT,
    .below = {0x00, 0xe5, 0xff},
    .above = {0xff, 0xd5, 0x00},
    .not_a_number = {0xff, 0x00, 0xff},
};

const struct neph_display_legend *neph_display_difference_legend(void)
{
    return &legend;
}

/* Magma in 9 stops (van der Walt and Smith, matplotlib 2015, CC0); black is zero. The scale ends in
 * pale yellow; values beyond it are green, NaN is teal. */
static const struct neph_display_stop amount_stops[] = {
    {0.0, {0x00, 0x00, 0x04}},   {0.125, {0x1c, 0x10, 0x44}}, {0.25, {0x4f, 0x12, 0x7b}},
    {0.375, {0x81, 0x25, 0x81}}, {0.5, {0xb5, 0x36, 0x7a}},   {0.625, {0xe5, 0x50, 0x64}},
    {0.75, {0xfb, 0x87, 0x61}},  {0.875, {0xfe, 0xc2, 0x87}}, {1.0, {0xfc, 0xfd, 0xbf}},
};

static const struct neph_display_legend amount_legend = {
    .stops = amount_stops,
    .stop_count = sizeof(amount_stops) / sizeof(amount_stops[0]),
    .below = {0x00, 0x00, 0x04}, /* noise-corrected amounts may be below 0 */
    .above = {0x00, 0xff, 0x40},
    .not_a_number = {0x00, 0x60, 0x60},
};

const struct neph_display_legend *neph_display_amount_legend(void)
{
    return &amount_legend;
}

static void colour_between(const struct neph_display_legend *colours, double position,
                           uint8_t rgb[3])
{
    int upper = 1;
    while (upper < colours->stop_count - 1 && position > colours->stops[upper].position)
        upper++;
    const struct neph_display_stop *a = &colours->stops[upper - 1], *b = &colours->stops[upper];
    double share = (position - a->position) / (b->position - a->position);
    for (int c = 0; c < 3; c++) {
        double code = (double)a->rgb[c] + share * ((double)b->rgb[c] - (double)a->rgb[c]);
        rgb[c] = (uint8_t)lround(code);
    }
}

static void map_to_colour(const struct neph_display_legend *colours, double position,
                          uint8_t rgb[3])
{
    if (isnan(position))
        memcpy(rgb, colours->not_a_number, 3);
    else if (position < colours->stops[0].position)
        memcpy(rgb, colours->below, 3);
    else if (position > 1.0)
        memcpy(rgb, colours->above, 3);
    else
        colour_between(colours, position, rgb);
}

/* Difference of a depth, in which infinity is a valid value: the sky. */
static double plane_difference(float reference, float test)
{
    return reference == test ? 0.0 : (double)test - (double)reference;
}

static enum neph_status check_map(int plane_count, double scale, struct neph_diag *diag)
{
    if (!(scale > 0.0) || !isfinite(scale))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "the scale of a difference map must be positive and finite, not %g",
                         scale);
    if (plane_count != 1 && plane_count != 3)
        return neph_fail(diag, NEPH_ERR_INTERNAL, "a difference map of %d planes, not 1 or 3",
                         plane_count);
    return NEPH_OK;
}

static double luminance_difference(const float *const *reference, const float *const *test,
                                   size_t pixel)
{
    double d[3];
    for (int c = 0; c < 3; c++) {
        d[c] = (double)test[c][pixel] - (double)reference[c][pixel];
        if (!isfinite(d[c]))
            return NAN;
    }
    return neph_luminance(d[0], d[1], d[2]);
}

enum neph_status neph_display_difference(const float *const *reference, const float *const *test,
                                         int plane_count, size_t pixel_count, double scale,
                                         uint8_t *out_rgb, struct neph_diag *diag)
{
    const enum neph_status status = check_map(plane_count, scale, diag);
    if (status)
        return status;
    for (size_t i = 0; i < pixel_count; i++) {
        double d = plane_count == 1 ? plane_difference(reference[0][i], test[0][i])
                                    : luminance_difference(reference, test, i);
        map_to_colour(&legend, d / scale, out_rgb + 3 * i);
    }
    return NEPH_OK;
}

enum neph_status neph_display_map(const float *const *planes, int plane_count, size_t pixel_count,
                                  bool is_signed, double scale, uint8_t *out_rgb,
                                  struct neph_diag *diag)
{
    const enum neph_status status = check_map(plane_count, scale, diag);
    if (status)
        return status;
    const struct neph_display_legend *colours = is_signed ? &legend : &amount_legend;
    for (size_t i = 0; i < pixel_count; i++) {
        const double value = plane_count == 1
                                 ? (double)planes[0][i]
                                 : neph_luminance((double)planes[0][i], (double)planes[1][i],
                                                  (double)planes[2][i]);
        map_to_colour(colours, value / scale, out_rgb + 3 * i);
    }
    return NEPH_OK;
}
