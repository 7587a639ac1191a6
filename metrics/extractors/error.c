/* SPDX-License-Identifier: MIT
 *
 * Error of an image against a reference, on linear data. The sign is test - reference: a positive
 * bias means that the test is too bright, too transparent or too far.
 *
 * d = test - reference. The samples of a mask are all its pixels in all colour channels jointly (3
 * samples per pixel; depth has 1). S is the mean Rec.709 luminance of the quantity over the *whole*
 * reference frame (depth: the mean over its solid pixels), so that a number means the same in every
 * mask. All numbers of depth but hit_mismatch use only pixels that are solid in both images.
 */
#include "metrics/extractors/extractors.h"

#include "metrics/vector_math.h"

#include <float.h>
#include <math.h>

/* As shares of S, so that they scale with the scene: the absolute epsilons of other programs (pbrt,
 * tev, SimpleImageIO) hide errors in dark scenes. */
static const double mse_epsilon_share = 0.01;
static const double relative_floor_share = 1e-4;

static const char no_solid[] = "no pixel of the mask is solid in both images";
static const char no_scene_mean[] =
    "the mean of the whole reference frame is not positive and finite";

enum map { D, ABS_D, REFERENCE, RELATIVE_SQUARE, RELATIVE_ABS, MISMATCH, MAP_COUNT };

static const struct neph_map maps[MAP_COUNT] = {
    [D] = {"difference", NULL, 0, true, 0.02, no_solid},
    [ABS_D] = {NULL, NULL, 0, false, 0.0, no_solid},
    [REFERENCE] = {NULL, NULL, 0, false, 0.0, no_solid},
    [RELATIVE_SQUARE] = {NULL, "1", 0, false, 0.0, no_scene_mean},
    [RELATIVE_ABS] = {"relative", "1", 0, false, 1.0, no_scene_mean},
    [MISMATCH] = {NULL, "1", 1, false, 0.0, NULL, NEPH_DEPTH},
};

static const struct neph_metric metrics[] = {
    {"bias", NULL, -INFINITY, INFINITY, NEPH_POOL_MEAN, 0, D, 0, "signed mean of test - reference"},
    {"rel_bias", "1", -INFINITY, INFINITY, NEPH_POOL_MEAN_OVER, 0, D, REFERENCE,
     "bias / mean reference over the mask"},
    {"mae", NULL, 0, INFINITY, NEPH_POOL_MEAN, 0, ABS_D, 0, "mean of |test - reference|"},
    {"rmse", NULL, 0, INFINITY, NEPH_POOL_RMS, 0, D, 0, "root of the mean squared difference"},
    {"rel_rmse", "1", 0, INFINITY, NEPH_POOL_RMS_OVER, 0, D, REFERENCE,
     "rmse / mean reference over the mask"},
    {"rel_mse", "1", 0, INFINITY, NEPH_POOL_MEAN, 0, RELATIVE_SQUARE, 0,
     "mean of d^2 / (reference^2 + (0.01 S)^2), S the mean of the whole "
     "reference"},
    {"rel_mse_trimmed", "1", 0, INFINITY, NEPH_POOL_TRIMMED_MEAN, 0.001, RELATIVE_SQUARE, 0,
     "rel_mse without its largest 0.1 %, rounded up to whole samples: fireflies"},
    {"max_abs", NULL, 0, INFINITY, NEPH_POOL_MAX, 0, ABS_D, 0, "largest |test - reference|"},
    {"max_rel", "1", 0, INFINITY, NEPH_POOL_MAX, 0, RELATIVE_ABS, 0,
     "largest |d| / max(|reference|, 1e-4 S)"},
    {"p50", NULL, 0, INFINITY, NEPH_POOL_PERCENTILE, 0.50, ABS_D, 0,
     "median of |test - reference|"},
    {"p95", NULL, 0, INFINITY, NEPH_POOL_PERCENTILE, 0.95, ABS_D, 0,
     "95th percentile of |test - reference|"},
    {"p99", NULL, 0, INFINITY, NEPH_POOL_PERCENTILE, 0.99, ABS_D, 0,
     "99th percentile of |test - reference|"},
    {"hit_mismatch", "1", 0, 1, NEPH_POOL_MEAN, 0, MISMATCH, 0,
     "share of pixels that are solid in one image and sky in the other"},
    {.name = NULL},
};

struct state {
    struct neph_frame_pair pair;
    double epsilon;        /* of rel_mse; NaN without a scene mean */
    double relative_floor; /* of max_rel; NaN without a scene mean */
};

static enum neph_status extract(void *state_, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    (void)diag;
    struct state *state = state_;
    const double epsilon = mse_epsilon_share * pair->scene_mean;
    *state = (struct state){.pair = *pair,
                            .epsilon = epsilon * epsilon,
                            .relative_floor = relative_floor_share * pair->scene_mean};
    return NEPH_OK;
}

/* The function of one map, over `count` samples. A sky (+inf) in either image gives NaN: no
 * value. */
typedef void fill_function(const struct state *state, const float *restrict reference,
                           const float *restrict test, size_t count, double *restrict values);

NEPH_VECTOR static void fill_d(const struct state *state, const float *restrict reference,
                               const float *restrict test, size_t count, double *restrict values)
{
    (void)state;
    for (size_t i = 0; i < count; i++) {
        const double d = (double)test[i] - (double)reference[i];
        values[i] = fabs(d) <= DBL_MAX ? d : (double)NAN;
    }
}

NEPH_VECTOR static void fill_abs_d(const struct state *state, const float *restrict reference,
                                   const float *restrict test, size_t count,
                                   double *restrict values)
{
    (void)state;
    for (size_t i = 0; i < count; i++) {
        const double d = fabs((double)test[i] - (double)reference[i]);
        values[i] = d <= DBL_MAX ? d : (double)NAN;
    }
}

NEPH_VECTOR static void fill_reference(const struct state *state, const float *restrict reference,
                                       const float *restrict test, size_t count,
                                       double *restrict values)
{
    (void)state;
    for (size_t i = 0; i < count; i++) {
        const double d = fabs((double)test[i] - (double)reference[i]);
        values[i] = d <= DBL_MAX ? (double)reference[i] : (double)NAN;
    }
}

NEPH_VECTOR static void fill_relative_square(const struct state *state,
                                             const float *restrict reference,
                                             const float *restrict test, size_t count,
                                             double *restrict values)
{
    const double epsilon = state->epsilon;
    for (size_t i = 0; i < count; i++) {
        const double r = (double)reference[i], d = (double)test[i] - r;
        values[i] = fabs(d) <= DBL_MAX ? d * d / (r * r + epsilon) : (double)NAN;
    }
}

NEPH_VECTOR static void fill_relative_abs(const struct state *state,
                                          const float *restrict reference,
                                          const float *restrict test, size_t count,
                                          double *restrict values)
{
    const double floor = state->relative_floor;
    for (size_t i = 0; i < count; i++) {
        const double r = (double)reference[i], d = fabs((double)test[i] - r);
        const double over = fabs(r) > floor ? fabs(r) : floor;
        values[i] = d <= DBL_MAX ? d / (floor == floor ? over : floor) : (double)NAN;
    }
}

NEPH_VECTOR static void fill_mismatch(const struct state *state, const float *restrict reference,
                                      const float *restrict test, size_t count,
                                      double *restrict values)
{
    (void)state;
    for (size_t i = 0; i < count; i++)
        values[i] = (test[i] > FLT_MAX) != (reference[i] > FLT_MAX) ? 1.0 : 0.0;
}

static void rows(const void *state_, int map, int first_row, int row_count, double *const values[3])
{
    static fill_function *const fill[MAP_COUNT] = {
        [D] = fill_d,
        [ABS_D] = fill_abs_d,
        [REFERENCE] = fill_reference,
        [RELATIVE_SQUARE] = fill_relative_square,
        [RELATIVE_ABS] = fill_relative_abs,
        [MISMATCH] = fill_mismatch,
    };
    const struct state *state = state_;
    const size_t width = (size_t)state->pair.width_px, first = (size_t)first_row * width;
    const int plane_count = map == MISMATCH ? 1 : state->pair.plane_count;
    for (int p = 0; p < plane_count; p++)
        fill[map](state, state->pair.reference[p] + first, state->pair.test[p] + first,
                  (size_t)row_count * width, values[p]);
}

static const struct neph_option options[] = {{.name = NULL}};

const struct neph_extractor neph_extractor_error = {
    .name = "error",
    .help = "differences of linear values",
    .source = "elementary; rel_mse as in Rousselle et al., SIGGRAPH Asia 2011, with an epsilon of "
              "the scene; trimmed as SimpleImageIO; percentiles of type 7 (Hyndman and Fan 1996)",
    .details = "a sample is one channel of a pixel; means and percentiles are over samples\n"
               "S: mean luminance (depth: mean) of the whole reference, whatever the mask",
    .quantities = NEPH_LINEAR_RGB | NEPH_DEPTH,
    .pointwise = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = MAP_COUNT,
    .state_size = sizeof(struct state),
    .extract = extract,
    .rows = rows,
};
