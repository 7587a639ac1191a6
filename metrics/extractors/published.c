/* SPDX-License-Identifier: MIT
 *
 * Errors by the formulas of other programs and papers, so that numbers can be compared with quoted
 * ones. Their epsilons are absolute: an error of a dark scene is smaller by them, and the numbers
 * change with the exposure of the frames. rel_mse of the extractor `error` has an epsilon of the
 * scene.
 *
 * d = test - reference, r the reference, x the test; means are over pixels and channels jointly.
 *   tev        include/tev/Colors.h, applyMetric() (Tom94/tev, commit 18dabdd, 2026-08-22);
 *              SimpleImageIO's RelMSE is the same as RelativeSquaredError
 *   pbrt       src/pbrt/util/image.cpp, Image::MRSE() (mmp/pbrt-v4), as imgtool diff --metric MRSE
 *              prints it; pbrt leaves out values that are infinite, which are refused here
 *   smape      Vogels et al., Denoising with Kernel Prediction and Asymmetric Loss Functions,
 *              SIGGRAPH 2018, equation 5, with its epsilon 0.01
 *   srgb_psnr  10 log10(1 / mean d^2) of encoded display values, not rounded to 8 bits
 */
#include "metrics/extractors/display_luma.h"
#include "metrics/extractors/extractors.h"
#include "metrics/vector_math.h"

#include <math.h>

static const double epsilon = 0.01; /* of all four relative errors */

static const char no_denominator[] = "the reference is -0.01 or less: nothing to divide by";

enum map { TEV_RAE, TEV_RSE, PBRT_MRSE, SMAPE, SRGB_SQUARES, MAP_COUNT };

static const struct neph_map maps[MAP_COUNT] = {
    [TEV_RAE] = {"tev_rae", "1", 0, false, 1.0, no_denominator},
    [TEV_RSE] = {"tev_rse", "1", 0, false, 1.0, no_denominator},
    [PBRT_MRSE] = {"pbrt_mrse", "1", 0, false, 1.0, no_denominator},
    [SMAPE] = {"smape", "1", 0, false, 1.0, no_denominator},
    [SRGB_SQUARES] = {NULL, "1", 0, false, 0.0, NULL},
};

static const struct neph_metric metrics[] = {
    {"tev_rae", "1", 0, INFINITY, NEPH_POOL_MEAN, 0, TEV_RAE, 0,
     "mean of |d| / (r + 0.01): Relative Absolute Error of tev"},
    {"tev_rse", "1", 0, INFINITY, NEPH_POOL_MEAN, 0, TEV_RSE, 0,
     "mean of d^2 / (r^2 + 0.01): Relative Squared Error of tev, RelMSE of SimpleImageIO"},
    {"pbrt_mrse", "1", 0, INFINITY, NEPH_POOL_MEAN, 0, PBRT_MRSE, 0,
     "mean of d^2 / (r + 0.01)^2: MRSE of pbrt-v4's imgtool"},
    {"smape", "1", 0, 1, NEPH_POOL_MEAN, 0, SMAPE, 0,
     "mean of |d| / (|x| + |r| + 0.01): symmetric absolute percentage error (Vogels et al. 2018)"},
    {"srgb_psnr", "dB", -INFINITY, INFINITY, NEPH_POOL_PSNR, 1.0, SRGB_SQUARES, 0,
     "10 log10(1 / mean d^2) of the channels in sRGB, clamped to 0..1 after --exposure"},
    {.name = NULL},
};

struct state {
    struct neph_frame_pair pair;
    double gain;
};

static enum neph_status extract(void *opaque, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    (void)diag;
    struct state *state = opaque;
    *state = (struct state){.pair = *pair, .gain = exp2(pair->viewing->exposure_ev)};
    return NEPH_OK;
}

/* The function of a map, over `count` samples; NaN: no value. */
typedef void fill_function(const struct state *state, const float *restrict reference,
                           const float *restrict test, size_t count, double *restrict values);

/* |d| / denominator, or d^2 / denominator. */
static inline double divide(double error, double denominator)
{
    return denominator > 0.0 ? error / denominator : (double)NAN;
}

NEPH_VECTOR static void fill_tev_rae(const struct state *state, const float *restrict reference,
                                     const float *restrict test, size_t count,
                                     double *restrict values)
{
    (void)state;
    for (size_t i = 0; i < count; i++) {
        const double r = (double)reference[i];
        values[i] = divide(fabs((double)test[i] - r), r + epsilon);
    }
}

NEPH_VECTOR static void fill_tev_rse(const struct state *state, const float *restrict reference,
                                     const float *restrict test, size_t count,
                                     double *restrict values)
{
    (void)state;
    for (size_t i = 0; i < count; i++) {
        const double r = (double)reference[i], d = (double)test[i] - r;
        values[i] = d * d / (r * r + epsilon);
    }
}

NEPH_VECTOR static void fill_pbrt_mrse(const struct state *state, const float *restrict reference,
                                       const float *restrict test, size_t count,
                                       double *restrict values)
{
    (void)state;
    for (size_t i = 0; i < count; i++) {
        const double r = (double)reference[i], d = (double)test[i] - r;
        values[i] = divide(d * d, (r + epsilon) * (r + epsilon));
    }
}

NEPH_VECTOR static void fill_smape(const struct state *state, const float *restrict reference,
                                   const float *restrict test, size_t count,
                                   double *restrict values)
{
    (void)state;
    for (size_t i = 0; i < count; i++) {
        const double r = (double)reference[i], x = (double)test[i];
        values[i] = fabs(x - r) / (fabs(x) + fabs(r) + epsilon);
    }
}

static void fill_srgb_squares(const struct state *state, const float *restrict reference,
                              const float *restrict test, size_t count, double *restrict values)
{
    enum { PIECE_PX = 256 };
    double encoded[PIECE_PX];
    for (size_t done = 0; done < count; done += PIECE_PX) {
        const size_t piece = count - done < PIECE_PX ? count - done : PIECE_PX;
        neph_display_codes(reference + done, piece, state->gain, encoded);
        neph_display_codes(test + done, piece, state->gain, values + done);
        for (size_t i = 0; i < piece; i++) {
            const double d = values[done + i] - encoded[i];
            values[done + i] = d * d;
        }
    }
}

static void rows(const void *opaque, int map, int first_row, int row_count, double *const values[3])
{
    static fill_function *const fill[MAP_COUNT] = {
        [TEV_RAE] = fill_tev_rae, [TEV_RSE] = fill_tev_rse,           [PBRT_MRSE] = fill_pbrt_mrse,
        [SMAPE] = fill_smape,     [SRGB_SQUARES] = fill_srgb_squares,
    };
    const struct state *state = opaque;
    const size_t width = (size_t)state->pair.width_px, first = (size_t)first_row * width;
    for (int p = 0; p < state->pair.plane_count; p++)
        fill[map](state, state->pair.reference[p] + first, state->pair.test[p] + first,
                  (size_t)row_count * width, values[p]);
}

static const struct neph_option options[] = {{.name = NULL}};

const struct neph_extractor neph_extractor_published = {
    .name = "published",
    .help = "errors by the formulas of tev, pbrt and papers, whose epsilons are absolute",
    .source = "tev 18dabdd, pbrt-v4 imgtool, SimpleImageIO; Vogels et al., SIGGRAPH 2018",
    .quantities = NEPH_LINEAR_RGB,
    .pointwise = true,
    .costly = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = MAP_COUNT,
    .state_size = sizeof(struct state),
    .extract = extract,
    .rows = rows,
};
