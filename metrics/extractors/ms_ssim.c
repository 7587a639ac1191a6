/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/ms_ssim.h"

#include "base/threads.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stdlib.h>

enum { SCALE_COUNT = 5, TAPS_MAX = 64 };

static const double powers[SCALE_COUNT] = {0.0448, 0.2856, 0.3001, 0.2363, 0.1333};

/* The low-pass of the 9/7 wavelet with the four digits of Wang's program, normalised to sum 1;
 * libvmaf has the quotients with six digits. */
#define TAP(x) ((x) / 1.4143)
static const double wavelet[9] = {TAP(0.0378), TAP(-0.0238), TAP(-0.1106), TAP(0.3774), TAP(0.8527),
                                  TAP(0.3774), TAP(-0.1106), TAP(-0.0238), TAP(0.0378)};

struct decimation {
    const double *image, *taps;
    int width_px, height_px, tap_count, factor;
    double *out;
    int out_width_px, out_height_px;
    double *blurred; /* one padded row for each row of `out` in progress; see ROW_GROUP */
    size_t blurred_stride;
};

enum { ROW_GROUP = 8 }; /* rows of the result per job */

static int mirrored(int position, int size)
{
    if (position < 0)
        return -1 - position;
    return position >= size ? 2 * size - 1 - position : position;
}

/* Add three weighted rows at once: loading and storing the sum for each row would cost more than
 * the additions. `at` and `weights` belong to the rows; `sum` must not overlap `image`. */
NEPH_VECTOR static void add_rows(const double *restrict image, const size_t at[3],
                                 const double weights[3], size_t count, double *restrict sum)
{
    const size_t a = at[0], b = at[1], c = at[2];
    const double u = weights[0], v = weights[1], w = weights[2];
    for (size_t i = 0; i < count; i++)
        sum[i] += u * image[a + i] + v * image[b + i] + w * image[c + i];
}

/* Filter a row with nine weights at every second position. */
NEPH_VECTOR static void halve_row(const double *restrict row, const double *restrict taps,
                                  size_t count, double *restrict out)
{
    const double t0 = taps[0], t1 = taps[1], t2 = taps[2], t3 = taps[3], t4 = taps[4], t5 = taps[5],
                 t6 = taps[6], t7 = taps[7], t8 = taps[8];
    for (size_t x = 0; x < count; x++) {
        const double *from = row + 2 * x;
        out[x] = t0 * from[0] + t1 * from[1] + t2 * from[2] + t3 * from[3] + t4 * from[4] +
                 t5 * from[5] + t6 * from[6] + t7 * from[7] + t8 * from[8];
    }
}

static void decimate_sideways(const struct decimation *work, const double *row, double *out)
{
    const size_t count = (size_t)work->out_width_px;
    if (work->factor == 2 && work->tap_count == 9) {
        halve_row(row, work->taps, count, out);
        return;
    }
    for (size_t x = 0; x < count; x++) {
        double sum = 0.0;
        for (int k = 0; k < work->tap_count; k++)
            sum += work->taps[k] * row[x * (size_t)work->factor + (size_t)k];
        out[x] = sum;
    }
}

static void blur_downwards(const struct decimation *work, int row, double *blurred)
{
    const size_t width = (size_t)work->width_px;
    for (size_t x = 0; x < width; x++)
        blurred[x] = 0.0;
    for (int k = 0; k < work->tap_count; k += 3) {
        size_t at[3] = {0};
        double weights[3] = {0.0};
        for (int i = 0; i < 3 && k + i < work->tap_count; i++) {
            int y = row * work->factor + k + i - work->tap_count / 2;
            at[i] = (size_t)mirrored(y, work->height_px) * width;
            weights[i] = work->taps[k + i];
        }
        add_rows(work->image, at, weights, width, blurred);
    }
}

/* Vertically, then horizontally. */
static void decimate_row(const struct decimation *work, int row, double *padded)
{
    const int middle = work->tap_count / 2, width = work->width_px;
    double *blurred = padded + work->tap_count;
    blur_downwards(work, row, blurred);
    for (int x = 1; x <= work->tap_count; x++) {
        blurred[-x] = blurred[mirrored(-x, width)];
        blurred[width - 1 + x] = blurred[mirrored(width - 1 + x, width)];
    }
    decimate_sideways(work, blurred - middle, work->out + (size_t)row * (size_t)work->out_width_px);
}

static void decimate_group(int group, void *context)
{
    const struct decimation *work = context;
    double *padded = work->blurred + (size_t)group * work->blurred_stride;
    for (int row = group * ROW_GROUP; row < (group + 1) * ROW_GROUP; row++)
        if (row < work->out_height_px)
            decimate_row(work, row, padded);
}

enum neph_status neph_decimate(const double *image, int width_px, int height_px, const double *taps,
                               int tap_count, int factor, double *out, int out_width_px,
                               int out_height_px, struct neph_diag *diag)
{
    if (tap_count > TAPS_MAX || width_px < tap_count || height_px < tap_count)
        return neph_fail(diag, NEPH_ERR_INTERNAL, "no filter of %d px fits into %dx%d", tap_count,
                         width_px, height_px);
    struct decimation work = {.image = image,
                              .taps = taps,
                              .width_px = width_px,
                              .height_px = height_px,
                              .tap_count = tap_count,
                              .factor = factor,
                              .out = out,
                              .out_width_px = out_width_px,
                              .out_height_px = out_height_px,
                              .blurred_stride = (size_t)(width_px + 2 * tap_count)};
    int group_count = (out_height_px + ROW_GROUP - 1) / ROW_GROUP;
    work.blurred = malloc((size_t)group_count * work.blurred_stride * sizeof(*work.blurred));
    if (!work.blurred)
        return neph_fail_memory(diag);
    enum neph_status status = neph_parallel_rows(group_count, decimate_group, &work, diag);
    free(work.blurred);
    return status;
}

/* ---- the scales ------------------------------------------------------------------------------ */

struct scale {
    int width_px, height_px;
    double *reference, *test; /* owned */
};

static void free_scale(struct scale *scale)
{
    free(scale->reference);
    free(scale->test);
    *scale = (struct scale){0};
}

/* Downsample two images by 2 into a new scale. */
static enum neph_status halve(const double *reference, const double *test, int width_px,
                              int height_px, struct scale *half, struct neph_diag *diag)
{
    struct scale made = {.width_px = (width_px + 1) / 2, .height_px = (height_px + 1) / 2};
    size_t size = (size_t)made.width_px * (size_t)made.height_px * sizeof(double);
    made.reference = malloc(size);
    made.test = malloc(size);
    enum neph_status status = made.reference && made.test ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = neph_decimate(reference, width_px, height_px, wavelet, 9, 2, made.reference,
                               made.width_px, made.height_px, diag);
    if (!status)
        status = neph_decimate(test, width_px, height_px, wavelet, 9, 2, made.test, made.width_px,
                               made.height_px, diag);
    if (status) {
        free_scale(&made);
        return status;
    }
    *half = made;
    return NEPH_OK;
}

static enum neph_status measure_scales(const double *reference, const double *test, int width_px,
                                       int height_px, double peak,
                                       struct neph_structure means[SCALE_COUNT],
                                       struct neph_diag *diag)
{
    struct scale now = {0};
    enum neph_status status = halve(reference, test, width_px, height_px, &now, diag);
    for (int s = 1; s < SCALE_COUNT && !status; s++) {
        status = neph_structure_compare(now.reference, now.test, NEPH_STRUCTURE_GAUSSIAN,
                                        now.width_px, now.height_px, peak, NULL, &means[s], diag);
        if (status || s + 1 == SCALE_COUNT)
            break;
        struct scale next = {0};
        status = halve(now.reference, now.test, now.width_px, now.height_px, &next, diag);
        free_scale(&now);
        now = next;
    }
    free_scale(&now);
    return status;
}

enum neph_status neph_ms_ssim(const double *reference, const double *test, int width_px,
                              int height_px, double peak, const struct neph_structure *first,
                              const char **undefined_because, double *value, struct neph_diag *diag)
{
    if (width_px < NEPH_MS_SSIM_SIDE_MIN_PX || height_px < NEPH_MS_SSIM_SIDE_MIN_PX) {
        *undefined_because = "five scales need sides of at least 176 px";
        return NEPH_OK;
    }
    struct neph_structure means[SCALE_COUNT] = {*first};
    enum neph_status status = measure_scales(reference, test, width_px, height_px, peak, means,
                                             diag);
    if (status)
        return status;
    double product = pow(means[SCALE_COUNT - 1].luminance, powers[SCALE_COUNT - 1]);
    for (int s = 0; s < SCALE_COUNT; s++) {
        if (means[s].structure < 0.0) {
            *undefined_because = "the mean structure of a scale is negative and has no power";
            return NEPH_OK;
        }
        product *= pow(means[s].contrast, powers[s]) * pow(means[s].structure, powers[s]);
    }
    *undefined_because = NULL;
    *value = product;
    return NEPH_OK;
}
