/* SPDX-License-Identifier: MIT */
#include "base/exr_chroma.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TAPS = 7 }; /* on each side of the new sample */

/* Samples on a line, `stride` floats apart. */
struct line {
    float *samples;
    size_t stride;
    int count;
};

/* The sample between samples i and i + 1 of a line. */
static float interpolate(const struct line *line, int i)
{
    /* RgbaYca::reconstructChromaHoriz() of OpenEXR, from the nearest samples outwards. */
    static const double weights[TAPS] = {0.627123, -0.186077, 0.087929, -0.043159,
                                         0.019597, -0.007540, 0.002128};
    double sum = 0.0;
    for (int k = 0; k < TAPS; k++) {
        const int left = i - k > 0 ? i - k : 0,
                  right = i + 1 + k < line->count ? i + 1 + k : line->count - 1;
        sum += weights[k] * ((double)line->samples[line->stride * (size_t)left] +
                             (double)line->samples[line->stride * (size_t)right]);
    }
    return (float)sum;
}

/* Write a line of twice as many samples. */
static void double_line(const struct line *from, const struct line *to)
{
    for (int i = 0; i < from->count; i++) {
        to->samples[to->stride * (size_t)(2 * i)] = from->samples[from->stride * (size_t)i];
        to->samples[to->stride * (size_t)(2 * i + 1)] = interpolate(from, i);
    }
}

/* Copy rows of `width_px` samples to rows of twice as many. */
static void double_columns(float *from, float *to, int width_px, int height_px)
{
    for (int y = 0; y < height_px; y++) {
        const size_t row = (size_t)y * (size_t)width_px;
        const struct line source = {from + row, 1, width_px}, target = {to + 2 * row, 1, 0};
        double_line(&source, &target);
    }
}

/* Copy columns of `height_px` samples to columns of twice as many. */
static void double_rows(float *from, float *to, int width_px, int height_px)
{
    for (int x = 0; x < width_px; x++) {
        const struct line source = {from + x, (size_t)width_px, height_px},
                          target = {to + x, (size_t)width_px, 0};
        double_line(&source, &target);
    }
}

enum neph_status neph_exr_upsample(const struct neph_image *image, struct neph_channel *channel,
                                   const int step[2], struct neph_diag *diag)
{
    const int width_px = image->width_px / step[0], height_px = image->height_px / step[1];
    for (int axis = 0; axis < 2; axis++) {
        if (step[axis] == 1)
            continue;
        float *target = malloc(neph_image_pixel_count(image) * sizeof(*target));
        if (!target)
            return neph_fail_memory(diag);
        if (axis == 0)
            double_columns(channel->samples, target, width_px, height_px);
        else
            double_rows(channel->samples, target, image->width_px, height_px);
        free(channel->samples);
        channel->samples = target;
    }
    return NEPH_OK;
}

/* ---- luminance and chroma -------------------------------------------------------------------- */

static double determinant(double columns[3][3])
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        const double *a = columns[0], *b = columns[1], *c = columns[2];
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        sum += a[i] * (b[j] * c[k] - b[k] * c[j]);
    }
    return sum;
}

/* Luminance of each primary at full value, where white has 1: the primaries add up to the CIE XYZ
 * of white. False: there are none. */
static bool find_luminances(const float chromaticities[8], double luminances[3])
{
    double columns[4][3];
    for (int i = 0; i < 4; i++) {
        const double x = (double)chromaticities[2 * i], y = (double)chromaticities[2 * i + 1];
        columns[i][0] = x / y;
        columns[i][1] = 1.0;
        columns[i][2] = (1.0 - x - y) / y;
    }
    const double whole = determinant(columns);
    bool is_finite = true;
    for (int i = 0; i < 3; i++) {
        double replaced[3][3];
        memcpy(replaced, columns, sizeof(replaced));
        memcpy(replaced[i], columns[3], sizeof(replaced[i]));
        luminances[i] = determinant(replaced) / whole;
        is_finite &= isfinite(luminances[i]);
    }
    return is_finite && luminances[1] > 0.0;
}

static struct neph_channel *find_channel(const struct neph_image *image, const char *name)
{
    for (int i = 0; i < image->channel_count; i++)
        if (strcmp(image->channels[i].name, name) == 0)
            return &image->channels[i];
    return NULL;
}

enum neph_status neph_exr_convert_chroma(struct neph_image *image, const float chromaticities[8],
                                         struct neph_diag *diag)
{
    static const char *const from[] = {"RY", "Y", "BY"}, *const to[] = {"R", "G", "B"};
    struct neph_channel *channels[3];
    double weights[3];
    for (int c = 0; c < 3; c++) {
        channels[c] = find_channel(image, from[c]);
        if (!channels[c] || find_channel(image, to[c]))
            return NEPH_OK;
    }
    if (!find_luminances(chromaticities, weights))
        return neph_fail(diag, NEPH_ERR_INPUT,
                         "the chromaticities give no luminance of red, green and blue");
    for (size_t i = 0; i < neph_image_pixel_count(image); i++) {
        const double y = (double)channels[1]->samples[i],
                     r = ((double)channels[0]->samples[i] + 1.0) * y,
                     b = ((double)channels[2]->samples[i] + 1.0) * y;
        channels[0]->samples[i] = (float)r;
        channels[1]->samples[i] = (float)((y - weights[0] * r - weights[2] * b) / weights[1]);
        channels[2]->samples[i] = (float)b;
    }
    for (int c = 0; c < 3; c++)
        snprintf(channels[c]->name, sizeof(channels[c]->name), "%s", to[c]);
    return NEPH_OK;
}
