/* SPDX-License-Identifier: MIT */
#include "renderer/post/display.h"

#include "renderer/post/colour.h"

#include <math.h>

static bool is_encoded_as(const struct neph_settings *settings, int encoding)
{
    return settings->values[POST_ENCODE] == encoding;
}

bool neph_post_is_hdr(const struct neph_settings *settings)
{
    return settings->values[POST_TONE] != 0.0 && is_encoded_as(settings, POST_ENCODE_PQ);
}

static double encode_srgb_code(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
}

static double decode_srgb_code(double code)
{
    return code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4);
}

double neph_pq_nits(double code)
{
    const double m1 = 2610.0 / 16384.0, m2 = 2523.0 / 32.0;
    const double c1 = 3424.0 / 4096.0, c2 = 2413.0 / 128.0, c3 = 2392.0 / 128.0;
    const double x = pow(fmax(code, 0.0), 1.0 / m2);
    return 10000.0 * pow(fmax(x - c1, 0.0) / (c2 - c3 * x), 1.0 / m1);
}

void neph_post_encode_codes(const struct neph_settings *settings, const struct neph_image *picture,
                            int bits, uint16_t *codes)
{
    const bool is_linear = is_encoded_as(settings, POST_ENCODE_LINEAR);
    const double largest = (double)((1 << bits) - 1);
    float *rgb[3];
    if (!neph_image_rgb(picture, NULL, rgb))
        return;
    for (size_t i = 0; i < neph_image_pixel_count(picture); i++)
        for (size_t c = 0; c < 3; c++) {
            const double value = is_linear ? encode_srgb_code(rgb[c][i]) : rgb[c][i];
            codes[3 * i + c] = (uint16_t)lround(largest * fmin(fmax(value, 0.0), 1.0));
        }
}

static void decode_srgb_image(float *const rgb[3], size_t count)
{
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            rgb[c][i] = (float)decode_srgb_code(rgb[c][i]);
}

static void decode_pq_image(float *const rgb[3], size_t count, double peak_nits)
{
    const struct neph_matrix3 to_rec709 = neph_colour_matrix(&neph_rec2020, &neph_rec709);
    for (size_t i = 0; i < count; i++) {
        double nits[3];
        for (int c = 0; c < 3; c++)
            nits[c] = neph_pq_nits(rgb[c][i]);
        for (int c = 0; c < 3; c++) {
            double sum = 0.0;
            for (int k = 0; k < 3; k++)
                sum += to_rec709.m[c][k] * nits[k];
            rgb[c][i] = (float)fmax(sum / peak_nits, 0.0);
        }
    }
}

void neph_post_apply_display(const struct neph_settings *settings, struct neph_image *picture)
{
    const size_t count = neph_image_pixel_count(picture);
    float *rgb[3];
    if (!neph_image_rgb(picture, NULL, rgb))
        return;
    if (is_encoded_as(settings, POST_ENCODE_SRGB))
        decode_srgb_image(rgb, count);
    else if (is_encoded_as(settings, POST_ENCODE_PQ))
        decode_pq_image(rgb, count, settings->values[POST_PEAK_NITS]);
}
