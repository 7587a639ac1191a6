/* SPDX-License-Identifier: MIT */
#include "renderer/tracer_sums.h"

#include "renderer/shaders/constants.h"

#include <math.h>

/* The sums of a pixel. */
enum { ORDER1, HIGHER, SURFACE, SPREAD, SUM_COUNT };

enum { floats_per_pixel = 2 * 4 * SUM_COUNT };

_Static_assert(sizeof(((struct neph_gpu_tracer_pixel *)NULL)->sums) == 16 * SUM_COUNT &&
                   sizeof(((struct neph_gpu_tracer_pixel *)NULL)->excess) == 16 * SUM_COUNT,
               "the shader has other sums");

size_t neph_tracer_sums_count(const struct neph_tracer_sums *sums)
{
    return NEPH_SUMS_HEAD + sums->pixel_count * floats_per_pixel;
}

void neph_tracer_sums_save(const struct neph_tracer_sums *sums, double *values)
{
    for (int i = 0; i < NEPH_SUMS_HEAD; i++)
        *values++ = sums->head[i];
    for (size_t p = 0; p < sums->pixel_count; p++)
        for (int i = 0; i < SUM_COUNT; i++)
            for (int k = 0; k < 4; k++) {
                *values++ = (double)sums->pixels[p].sums[i][k];
                *values++ = (double)sums->pixels[p].excess[i][k];
            }
}

void neph_tracer_sums_load(struct neph_tracer_sums *sums, const double *values)
{
    for (int i = 0; i < NEPH_SUMS_HEAD; i++)
        sums->head[i] = *values++;
    for (size_t p = 0; p < sums->pixel_count; p++)
        for (int i = 0; i < SUM_COUNT; i++)
            for (int k = 0; k < 4; k++) {
                sums->pixels[p].sums[i][k] = (float)*values++;
                sums->pixels[p].excess[i][k] = (float)*values++;
            }
}

static double read_pixel_sum(const struct neph_gpu_tracer_pixel *pixel, int sum, int component)
{
    return (double)pixel->sums[sum][component] - (double)pixel->excess[sum][component];
}

/* The variance of the mean of all light: a pair's squared difference / 4 estimates the variance of
 * the pair's mean, and the mean has `pairs` of them. With two sequences, the squared difference of
 * their means / 4. */
static double compute_pixel_variance(const struct neph_tracer_sums *sums, size_t pixel, int channel)
{
    const double pairs = 0.5 * sums->head[NEPH_SUMS_SAMPLES];
    const double sum = read_pixel_sum(&sums->pixels[pixel], SPREAD, channel);
    return 0.25 * (sums->is_sobol ? sum * sum : sum) / (pairs * pairs);
}

double neph_tracer_sums_error(const struct neph_tracer_sums *sums, bool is_lit)
{
    const double samples = sums->head[NEPH_SUMS_SAMPLES];
    double variance = 0.0, radiance = 0.0;
    for (size_t i = 0; i < sums->pixel_count; i++)
        for (int c = 0; c < 3; c++) {
            const struct neph_gpu_tracer_pixel *pixel = &sums->pixels[i];
            const double volume =
                (read_pixel_sum(pixel, ORDER1, c) + read_pixel_sum(pixel, HIGHER, c)) / samples;
            variance += compute_pixel_variance(sums, i, c);
            radiance += volume * volume;
        }
    if (radiance > 0.0)
        return sqrt(variance / radiance);
    return is_lit ? INFINITY : 0.0; /* no light sampled yet, or no light at all */
}

/* Differences of this part of the radiance are rounding, not noise: the paths of a white furnace
 * differ by a few float32 roundings at each of their events. */
static const double rounding_part = 1e-5;

static bool is_rounding(const struct neph_tracer_sums *sums, size_t pixel, double mean_square)
{
    const struct neph_gpu_tracer_pixel *own = &sums->pixels[pixel];
    double squares = 0.0;
    for (int c = 0; c < 3; c++) {
        const double light = (read_pixel_sum(own, ORDER1, c) + read_pixel_sum(own, HIGHER, c) +
                              read_pixel_sum(own, SURFACE, c)) /
                             sums->head[NEPH_SUMS_SAMPLES];
        squares += light * light;
    }
    return mean_square <= rounding_part * rounding_part * squares;
}

/* Squared differences of pairs, summed over the channels: their own scatter is the variance of the
 * sum; at least that of normal noise, 2 / pairs. With two sequences there is one squared
 * difference, of their means; the variance of the square of a normal number is 2/3 of its mean
 * fourth power. */
static double compute_pixel_doubt(const struct neph_tracer_sums *sums, size_t pixel, double sum)
{
    const double pairs = 0.5 * sums->head[NEPH_SUMS_SAMPLES];
    const double squares = read_pixel_sum(&sums->pixels[pixel], SPREAD, 3) /
                           (sums->noise_scale * sums->noise_scale);
    return sums->is_sobol ? 2.0 / 3.0 : fmax(2.0 / pairs, squares / (sum * sum) - 1.0 / pairs);
}

struct neph_doubt neph_tracer_sums_doubt(const struct neph_tracer_sums *sums)
{
    const double pairs = 0.5 * sums->head[NEPH_SUMS_SAMPLES];
    struct neph_doubt doubt = {.noisy = 0};
    for (size_t i = 0; i < sums->pixel_count; i++) {
        double variance = 0.0;
        for (int c = 0; c < 3; c++)
            variance += compute_pixel_variance(sums, i, c);
        const double sum = 4.0 * pairs * pairs * variance; /* of squared differences */
        if (!is_rounding(sums, i, sum / pairs))
            neph_doubt_add(&doubt, variance, compute_pixel_doubt(sums, i, sum));
    }
    return doubt;
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

enum neph_status neph_tracer_sums_frame(const struct neph_tracer_sums *sums, bool is_open,
                                        int width_px, int height_px, struct neph_image **frame,
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
    const double samples = sums->head[NEPH_SUMS_SAMPLES];
    for (size_t i = 0; i < sums->pixel_count; i++) {
        const struct neph_gpu_tracer_pixel *own = &sums->pixels[i];
        eye_depth_m[i] = own->behind[3] < NEPH_GPU_FAR_M ? own->behind[3] : INFINITY;
        for (int c = 0; c < 3; c++) {
            const double transmittance = is_open ? read_pixel_sum(own, c, 3) / samples
                                                 : (double)own->transmittance[c];
            const double order1 = read_pixel_sum(own, ORDER1, c) / samples;
            const double surface = read_pixel_sum(own, SURFACE, c) / samples;
            const double volume = order1 + read_pixel_sum(own, HIGHER, c) / samples;
            const double behind = is_open ? surface
                                          : transmittance * ((double)own->behind[c] + surface);
            layers[LAYER_RADIANCE][c][i] = (float)(volume + behind);
            layers[LAYER_VOLUME][c][i] = (float)volume;
            layers[LAYER_ORDER1][c][i] = (float)order1;
            layers[LAYER_TRANSMITTANCE][c][i] = (float)transmittance;
            layers[LAYER_VARIANCE][c][i] = (float)compute_pixel_variance(sums, i, c);
        }
    }
    *frame = image;
    return NEPH_OK;
}
