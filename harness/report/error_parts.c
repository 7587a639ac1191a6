/* SPDX-License-Identifier: MIT */
#include "harness/report/error_parts.h"

#include "metrics/metric.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

/* ---- edges of the reference ------------------------------------------------------------------ */

static double mean_luminance(const float *const planes[3], size_t pixel_count)
{
    double sum = 0.0;
    size_t count = 0;
    for (size_t i = 0; i < pixel_count; i++) {
        const double luminance = neph_luminance_at(planes, i);
        if (isfinite(luminance)) {
            sum += luminance;
            count++;
        }
    }
    return count > 0 ? sum / (double)count : 0.0;
}

static void mark_around(int x, int y, int width_px, int height_px, bool *at_edge)
{
    for (int v = y - NEPH_EDGE_REACH_PX; v <= y + NEPH_EDGE_REACH_PX; v++)
        for (int u = x - NEPH_EDGE_REACH_PX; u <= x + NEPH_EDGE_REACH_PX; u++)
            if (u >= 0 && v >= 0 && u < width_px && v < height_px)
                at_edge[(size_t)v * (size_t)width_px + (size_t)u] = true;
}

/* Visit each pair of neighbours once: the pixel to the right and the pixel below. */
static void mark_edges(const float *const planes[3], int width_px, int height_px, bool *at_edge)
{
    const double step = NEPH_EDGE_CONTRAST *
                        mean_luminance(planes, (size_t)width_px * (size_t)height_px);
    for (int y = 0; y < height_px; y++)
        for (int x = 0; x < width_px; x++) {
            const size_t i = (size_t)y * (size_t)width_px + (size_t)x;
            const double here = neph_luminance_at(planes, i);
            if (x + 1 < width_px && fabs(neph_luminance_at(planes, i + 1) - here) > step) {
                mark_around(x, y, width_px, height_px, at_edge);
                mark_around(x + 1, y, width_px, height_px, at_edge);
            }
            if (y + 1 < height_px &&
                fabs(neph_luminance_at(planes, i + (size_t)width_px) - here) > step) {
                mark_around(x, y, width_px, height_px, at_edge);
                mark_around(x, y + 1, width_px, height_px, at_edge);
            }
        }
}

/* ---- sums ------------------------------------------------------------------------------------ */

struct sums {
    double square;            /* squared test - reference, over pixels and channels */
    double edge;              /* part of `square` at edges */
    double difference[3];     /* test - reference, by channel */
    double noise;             /* half the squared differences of the seeds, both renderers */
    size_t count, edge_count; /* pixels */
};

struct planes {
    const float *reference[3], *reference_second[3], *test[3], *test_second[3];
};

static bool find_rgb_planes(const struct neph_image *image, const float *planes[3])
{
    float *found[3];
    if (!image || !neph_image_rgb(image, NULL, found))
        return false;
    for (int c = 0; c < 3; c++)
        planes[c] = found[c];
    return true;
}

static double square_difference(const float *a, const float *b, size_t pixel)
{
    const double difference = (double)a[pixel] - (double)b[pixel];
    return difference * difference;
}

static void add_pixel(const struct planes *planes, bool with_noise, size_t pixel, bool at_edge,
                      struct sums *sums)
{
    double square = 0.0, noise = 0.0;
    for (int c = 0; c < 3; c++) {
        square += square_difference(planes->test[c], planes->reference[c], pixel);
        if (with_noise)
            noise += 0.5 *
                     (square_difference(planes->test[c], planes->test_second[c], pixel) +
                      square_difference(planes->reference[c], planes->reference_second[c], pixel));
    }
    if (!isfinite(square) || !isfinite(noise))
        return;
    for (int c = 0; c < 3; c++)
        sums->difference[c] += (double)planes->test[c][pixel] - (double)planes->reference[c][pixel];
    sums->square += square;
    sums->noise += noise;
    sums->edge += at_edge ? square : 0.0;
    sums->count++;
    sums->edge_count += at_edge;
}

static struct neph_error_parts shares(const struct sums *sums, bool with_noise)
{
    const double count = (double)sums->count;
    double offset = 0.0;
    for (int c = 0; c < 3; c++)
        offset += sums->difference[c] * sums->difference[c] / count;
    return (struct neph_error_parts){
        .noise_share = with_noise ? sums->noise / sums->square : NAN,
        .offset_share = offset / sums->square,
        .edge_share = sums->edge / sums->square,
        .edge_pixel_share = (double)sums->edge_count / count,
    };
}

enum neph_status neph_error_parts(const struct neph_error_frames *frames,
                                  struct neph_error_parts *parts, struct neph_diag *diag)
{
    const struct neph_image *reference = frames->reference;
    struct planes planes;
    struct sums sums = {.square = 0.0};
    *parts = (struct neph_error_parts){NAN, NAN, NAN, NAN};
    if (!find_rgb_planes(reference, planes.reference) ||
        !find_rgb_planes(frames->test, planes.test))
        return NEPH_OK;
    const struct neph_image *const all[] = {frames->test, frames->test_second,
                                            frames->reference_second};
    for (int i = 0; i < 3; i++)
        if (all[i] &&
            (all[i]->width_px != reference->width_px || all[i]->height_px != reference->height_px))
            return neph_fail(diag, NEPH_ERR_INTERNAL, "frames of one scene have different sizes");
    const bool with_noise = find_rgb_planes(frames->test_second, planes.test_second) &&
                            find_rgb_planes(frames->reference_second, planes.reference_second);
    const size_t pixel_count = neph_image_pixel_count(reference);
    bool *at_edge = calloc(pixel_count, sizeof(*at_edge));
    if (!at_edge)
        return neph_fail_memory(diag);
    mark_edges(planes.reference, reference->width_px, reference->height_px, at_edge);
    for (size_t i = 0; i < pixel_count; i++)
        add_pixel(&planes, with_noise, i, at_edge[i], &sums);
    if (sums.square > 0.0)
        *parts = shares(&sums, with_noise);
    free(at_edge);
    return NEPH_OK;
}
