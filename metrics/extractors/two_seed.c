/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/two_seed.h"

#include "metrics/extractors/extractors.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stddef.h>

enum { MAP_PRODUCT, MAP_NOISE, MAP_AGAINST_MEAN, MAP_COUNT };

static const char *obstacle(const struct neph_frame_pair *first,
                            const struct neph_settings *settings)
{
    (void)settings;
    return first->reference_second[0] ? NULL : "there is no second reference, of another seed";
}

static enum neph_status extract(void *opaque, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    struct neph_frame_pair *kept = opaque;
    if (!pair->reference_second[0])
        return neph_fail(diag, NEPH_ERR_INPUT, "frame %d has no second reference, others have",
                         pair->frame);
    size_t bad_count = 0, count = (size_t)pair->width_px * (size_t)pair->height_px;
    for (int c = 0; c < pair->plane_count; c++)
        bad_count += neph_count_not_finite(pair->reference_second[c], count);
    if (bad_count > 0) /* no other code checks it */
        return neph_fail(diag, NEPH_ERR_GATE,
                         "%zu values of the second reference of frame %d are "
                         "not finite",
                         bad_count, pair->frame);
    *kept = *pair;
    return NEPH_OK;
}

NEPH_VECTOR static void compute_unbiased_square(const float *a, const float *b, const float *t,
                                                size_t count, double *values)
{
    for (size_t i = 0; i < count; i++)
        values[i] = ((double)t[i] - (double)a[i]) * ((double)t[i] - (double)b[i]);
}

NEPH_VECTOR static void compute_seed_noise(const float *a, const float *b, const float *t,
                                           size_t count, double *values)
{
    (void)t;
    for (size_t i = 0; i < count; i++) {
        double d = (double)a[i] - (double)b[i];
        values[i] = 0.5 * d * d;
    }
}

NEPH_VECTOR static void compute_square_to_mean(const float *a, const float *b, const float *t,
                                               size_t count, double *values)
{
    for (size_t i = 0; i < count; i++) {
        double d = (double)t[i] - 0.5 * ((double)a[i] + (double)b[i]);
        values[i] = d * d;
    }
}

typedef void map_function(const float *a, const float *b, const float *t, size_t count,
                          double *values);

static map_function *const functions[MAP_COUNT] = {[MAP_PRODUCT] = compute_unbiased_square,
                                                   [MAP_NOISE] = compute_seed_noise,
                                                   [MAP_AGAINST_MEAN] = compute_square_to_mean};

static void rows(const void *opaque, int map, int first_row, int row_count, double *const values[3])
{
    const struct neph_frame_pair *pair = opaque;
    size_t first = (size_t)first_row * (size_t)pair->width_px;
    size_t count = (size_t)row_count * (size_t)pair->width_px;
    for (int c = 0; c < pair->plane_count; c++)
        functions[map](pair->reference[c] + first, pair->reference_second[c] + first,
                       pair->test[c] + first, count, values[c]);
}

static const struct neph_option options[] = {{.name = NULL}};

static const struct neph_metric metrics[] = {
    {"mse_unbiased", "unit^2", -INFINITY, INFINITY, NEPH_POOL_MEAN, 0.0, MAP_PRODUCT, 0,
     "mean (t - a)(t - b), a and b two seeds of the reference, in the squared unit of the "
     "quantity"},
    {"rmse_unbiased", NULL, 0.0, INFINITY, NEPH_POOL_ROOT_MEAN, 0.0, MAP_PRODUCT, 0,
     "root of mse_unbiased, 0 when that is negative"},
    {"reference_noise_rmse", NULL, 0.0, INFINITY, NEPH_POOL_ROOT_MEAN, 0.0, MAP_NOISE, 0,
     "root of mean (a - b)^2 / 2: the noise of one seed, below which rmse_unbiased is at its "
     "floor"},
    {"mse_mean_reference", "unit^2", 0.0, INFINITY, NEPH_POOL_MEAN, 0.0, MAP_AGAINST_MEAN, 0,
     "mean (t - (a + b) / 2)^2: with half the noise of one seed left in"},
    {.name = NULL},
};

static const struct neph_map maps[] = {
    [MAP_PRODUCT] = {.name = NULL, .unit = "unit^2", .is_signed = true},
    [MAP_NOISE] = {.name = NULL, .unit = "unit^2"},
    [MAP_AGAINST_MEAN] = {.name = NULL, .unit = "unit^2"},
};

const struct neph_extractor neph_extractor_two_seed = {
    .name = "two_seed",
    .help = "error against a noisy reference, its noise taken out by a second seed of it",
    .source = "the product of two independent residuals has the squared true error as its mean",
    .quantities = NEPH_LINEAR_RGB,
    .pointwise = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = MAP_COUNT,
    .state_size = sizeof(struct neph_frame_pair),
    .obstacle = obstacle,
    .extract = extract,
    .rows = rows,
};
