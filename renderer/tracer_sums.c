/* SPDX-License-Identifier: MIT */
#include "renderer/tracer_sums.h"

#include "renderer/shaders/constants.h"

#include <math.h>

/* Per pixel: order1, higher, surface, spread, transmittance (0 unless open); three channels each.
 */
enum { sums_per_pixel = 15 };

static double *sums_of(const struct neph_tracer_sums *sums, size_t pixel)
{
    return sums->values + NEPH_SUMS_HEAD + pixel * sums_per_pixel;
}

size_t neph_tracer_sums_count(const struct neph_tracer_sums *sums)
{
    return NEPH_SUMS_HEAD + sums->pixel_count * sums_per_pixel;
}

void neph_tracer_sums_add(struct neph_tracer_sums *sums, size_t index,
                          const struct neph_gpu_tracer_pixel *pixel)
{
    double *own = sums_of(sums, index);
    for (int c = 0; c < 3; c++) {
        for (int layer = 0; layer < 3; layer++)
            own[3 * layer + c] += (double)pixel->sums[layer][c];
        own[9 + c] += (double)pixel->spread[c];
        own[12 + c] += (double)pixel->sums[c][3];
    }
}

/* The variance of the mean of all light: each pair's squared difference / 4 estimates that of the
 * pair's mean, and the mean is that of `pairs` of them. */
static double variance_of(const double *sums, int channel, double samples)
{
    const double pairs = 0.5 * samples;
    return 0.25 * sums[9 + channel] / (pairs * pairs);
}

double neph_tracer_sums_error(const struct neph_tracer_sums *sums, bool is_lit)
{
    const double samples = sums->values[NEPH_SUMS_SAMPLES];
    double variance = 0.0, radiance = 0.0;
    for (size_t i = 0; i < sums->pixel_count; i++)
        for (int c = 0; c < 3; c++) {
            const double *pixel = sums_of(sums, i);
            const double volume = (pixel[c] + pixel[3 + c]) / samples;
            variance += variance_of(pixel, c, samples);
            radiance += volume * volume;
        }
    if (radiance > 0.0)
        return sqrt(variance / radiance);
    return is_lit ? INFINITY : 0.0; /* nothing has been seen yet, or there is nothing */
}

static const char *const rgb_layers[] = {NULL, "volume", "order1", "transmittance", "variance"};
enum {
    LAYER_RADIANCE,
    LAYER_VOLUME,
    LAYER_ORDER1,
    LAYER_TRANSMITTANCE,
    LAYER_VARIANCE,
    LAYER_COUNT
};

static enum neph_status create_image(int width_px, int height_px, struct neph_image **image,
                                     float *layers[LAYER_COUNT][3], float **eye_depth_m,
                                     struct neph_diag *diag)
{
    enum neph_status status = neph_image_create(width_px, height_px, image, diag);
    for (int i = 0; !status && i < LAYER_COUNT; i++)
        status = neph_image_add_rgb(*image, rgb_layers[i], layers[i], diag);
    if (!status)
        status = neph_image_add_channel(*image, "Z", eye_depth_m, diag);
    return status;
}

enum neph_status neph_tracer_sums_frame(const struct neph_tracer_sums *sums,
                                        const float *view_light, bool is_open, int width_px,
                                        int height_px, struct neph_image **frame,
                                        struct neph_diag *diag)
{
    struct neph_image *image = NULL;
    float *layers[LAYER_COUNT][3], *eye_depth_m;
    const enum neph_status status = create_image(width_px, height_px, &image, layers, &eye_depth_m,
                                                 diag);
    if (status) {
        neph_image_destroy(image);
        return status;
    }
    const double samples = sums->values[NEPH_SUMS_SAMPLES];
    for (size_t i = 0; i < sums->pixel_count; i++) {
        const double *own = sums_of(sums, i);
        const float *view = view_light + i * NEPH_TRACER_VIEW_FLOATS;
        eye_depth_m[i] = view[3] < NEPH_GPU_FAR_M ? view[3] : INFINITY;
        for (int c = 0; c < 3; c++) {
            const double transmittance = is_open ? own[12 + c] / samples : (double)view[4 + c];
            const double order1 = own[c] / samples, surface = own[6 + c] / samples;
            const double volume = order1 + own[3 + c] / samples;
            const double behind = is_open ? surface : transmittance * ((double)view[c] + surface);
            layers[LAYER_RADIANCE][c][i] = (float)(volume + behind);
            layers[LAYER_VOLUME][c][i] = (float)volume;
            layers[LAYER_ORDER1][c][i] = (float)order1;
            layers[LAYER_TRANSMITTANCE][c][i] = (float)transmittance;
            layers[LAYER_VARIANCE][c][i] = (float)variance_of(own, c, samples);
        }
    }
    *frame = image;
    return NEPH_OK;
}
