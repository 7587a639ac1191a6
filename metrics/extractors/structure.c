/* SPDX-License-Identifier: MIT
 *
 * The sliding window of SSIM. The image is cut into columns 48 px wide. Down a column, each row is
 * blurred horizontally once and stored in a ring of 11 rows, which the vertical blur reads. All
 * data stay in the L1 cache and are aligned: loads across two cache lines have half the speed.
 */
#include "metrics/extractors/structure.h"

#include "base/threads.h"
#include "metrics/statistics.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stdlib.h>

enum {
    WINDOW = NEPH_STRUCTURE_WINDOW_PX,
    MARGIN = NEPH_STRUCTURE_MARGIN_PX,
    COLUMN = 48,
};

/* Averages over a window; x is the reference, y the test. */
enum moment { X, Y, XX, YY, XY, MOMENT_COUNT };

struct constants {
    double weight[MARGIN + 1]; /* window weights, from the centre outwards */
    double c1, c2, c3;
    double covariance; /* factor of variances and covariance */
};

/* Sums over the rows, for each pixel of a column. */
struct sums {
    double luminance[COLUMN], contrast[COLUMN], structure[COLUMN];
};

struct work {
    const double *reference, *test;
    double *map;
    size_t width, height;
    struct constants constants;
    struct sums *sums; /* one for each column */
};

typedef double segment[COLUMN + 2 * MARGIN];
typedef double blurred[MOMENT_COUNT][COLUMN];

static double weigh(enum neph_structure_window window, int distance_px)
{
    const double sigma_px = 1.5;
    switch (window) {
    case NEPH_STRUCTURE_GAUSSIAN:
        return exp(-0.5 * (distance_px / sigma_px) * (distance_px / sigma_px));
    case NEPH_STRUCTURE_UNIFORM_7:
        return distance_px <= 3 ? 1.0 : 0.0;
    }
    return NAN;
}

static struct constants make_ssim_constants(enum neph_structure_window window, double peak)
{
    struct constants constants = {.c1 = (0.01 * peak) * (0.01 * peak),
                                  .c2 = (0.03 * peak) * (0.03 * peak),
                                  .covariance = window == NEPH_STRUCTURE_UNIFORM_7 ? 49.0 / 48.0
                                                                                   : 1.0};
    constants.c3 = 0.5 * constants.c2;
    double sum = 0.0;
    for (int i = 0; i <= MARGIN; i++) {
        constants.weight[i] = weigh(window, i);
        sum += i == 0 ? constants.weight[i] : 2.0 * constants.weight[i];
    }
    for (int i = 0; i <= MARGIN; i++)
        constants.weight[i] /= sum;
    return constants;
}

/* Symmetric window of 11 values; `w` has six weights, from the centre outwards. */
#define WINDOWED(w, v0, v1, v2, v3, v4, v5, v6, v7, v8, v9, v10)                                   \
    ((w)[0] * (v5) + (w)[1] * ((v4) + (v6)) + (w)[2] * ((v3) + (v7)) + (w)[3] * ((v2) + (v8)) +    \
     (w)[4] * ((v1) + (v9)) + (w)[5] * ((v0) + (v10)))

NEPH_VECTOR static void blur_sideways(const struct constants *constants, const double *reference,
                                      const double *test, size_t count, blurred out)
{
    _Alignas(64) segment products[3];
    for (size_t i = 0; i < count + 2 * MARGIN; i++) {
        double x = reference[i], y = test[i];
        products[0][i] = x * x;
        products[1][i] = y * y;
        products[2][i] = x * y;
    }
    const double *const moments[MOMENT_COUNT] = {reference, test, products[0], products[1],
                                                 products[2]};
    const struct constants c = *constants;
    for (int m = 0; m < MOMENT_COUNT; m++) {
        const double *in = moments[m];
        double *restrict to = out[m];
        for (size_t i = 0; i < count; i++)
            to[i] = WINDOWED(c.weight, in[i], in[i + 1], in[i + 2], in[i + 3], in[i + 4], in[i + 5],
                             in[i + 6], in[i + 7], in[i + 8], in[i + 9], in[i + 10]);
    }
}

/* `next`: position of the oldest row in the ring. Rows are addressed by their offset in the ring;
 * with eleven pointers the compiler would assume that they alias the result. */
NEPH_VECTOR static void blur_downwards(const struct constants *constants,
                                       const double *restrict ring, size_t next, size_t count,
                                       double *restrict out)
{
    const struct constants c = *constants;
    size_t at[WINDOW];
    for (size_t k = 0; k < WINDOW; k++)
        at[k] = ((next + k) % WINDOW) * MOMENT_COUNT * COLUMN;
    const size_t a0 = at[0], a1 = at[1], a2 = at[2], a3 = at[3], a4 = at[4], a5 = at[5], a6 = at[6],
                 a7 = at[7], a8 = at[8], a9 = at[9], a10 = at[10];
    for (size_t m = 0; m < MOMENT_COUNT * COLUMN; m += COLUMN)
        for (size_t i = m; i < m + count; i++)
            out[i] = WINDOWED(c.weight, ring[a0 + i], ring[a1 + i], ring[a2 + i], ring[a3 + i],
                              ring[a4 + i], ring[a5 + i], ring[a6 + i], ring[a7 + i], ring[a8 + i],
                              ring[a9 + i], ring[a10 + i]);
}

/* Add up the three factors, and compute their product. Rounding may make a variance negative, or a
 * covariance larger than the variances allow. Both are clamped, so that an image compared with
 * itself gives 1. */
NEPH_VECTOR static void compare_row(const struct constants *constants, const blurred mean,
                                    size_t count, struct sums *restrict sums,
                                    double *restrict product)
{
    const double c1 = constants->c1, c2 = constants->c2, c3 = constants->c3;
    const double scale = constants->covariance;
    for (size_t i = 0; i < count; i++) {
        double mean_x = mean[X][i], mean_y = mean[Y][i];
        double variance_x = scale * (mean[XX][i] - mean_x * mean_x);
        double variance_y = scale * (mean[YY][i] - mean_y * mean_y);
        double covariance = scale * (mean[XY][i] - mean_x * mean_y);
        variance_x = variance_x > 0.0 ? variance_x : 0.0;
        variance_y = variance_y > 0.0 ? variance_y : 0.0;
        double deviations = sqrt(variance_x * variance_y);
        covariance = covariance < deviations ? covariance : deviations;
        covariance = covariance > -deviations ? covariance : -deviations;
        double luminance = (2.0 * (mean_x * mean_y) + c1) /
                           (mean_x * mean_x + mean_y * mean_y + c1);
        double contrast = (2.0 * deviations + c2) / (variance_x + variance_y + c2);
        double structure = (covariance + c3) / (deviations + c3);
        sums->luminance[i] += luminance;
        sums->contrast[i] += contrast;
        sums->structure[i] += structure;
        product[i] = luminance * contrast * structure;
    }
}

static void compare_column(int column, void *context)
{
    const struct work *work = context;
    size_t first = (size_t)column * COLUMN;
    size_t count = work->width - 2 * MARGIN - first;
    if (count > COLUMN)
        count = COLUMN;
    _Alignas(64) blurred ring[WINDOW];
    _Alignas(64) blurred mean;
    double unwanted[COLUMN];
    for (size_t y = 0; y < work->height; y++) {
        size_t at = y * work->width + first;
        blur_sideways(&work->constants, work->reference + at, work->test + at, count,
                      ring[y % WINDOW]);
        if (y + 1 < WINDOW)
            continue;
        blur_downwards(&work->constants, &ring[0][0][0], (y + 1) % WINDOW, count, &mean[0][0]);
        size_t centre = (y - MARGIN) * work->width + first + MARGIN;
        compare_row(&work->constants, mean, count, &work->sums[column],
                    work->map ? work->map + centre : unwanted);
    }
}

static struct neph_structure compute_factor_means(const struct work *work, int column_count)
{
    struct neph_sum luminance = {0}, contrast = {0}, structure = {0};
    for (int column = 0; column < column_count; column++) {
        for (int i = 0; i < COLUMN; i++) {
            neph_sum_add(&luminance, work->sums[column].luminance[i]);
            neph_sum_add(&contrast, work->sums[column].contrast[i]);
            neph_sum_add(&structure, work->sums[column].structure[i]);
        }
    }
    double count = (double)((work->width - 2 * MARGIN) * (work->height - 2 * MARGIN));
    return (struct neph_structure){.luminance = neph_sum_value(&luminance) / count,
                                   .contrast = neph_sum_value(&contrast) / count,
                                   .structure = neph_sum_value(&structure) / count};
}

enum neph_status neph_structure_compare(const double *reference, const double *test,
                                        enum neph_structure_window window, int width_px,
                                        int height_px, double peak, double *map,
                                        struct neph_structure *means, struct neph_diag *diag)
{
    if (width_px < WINDOW || height_px < WINDOW)
        return neph_fail(diag, NEPH_ERR_INTERNAL, "no window of %d px fits into %dx%d", WINDOW,
                         width_px, height_px);
    struct work work = {.reference = reference,
                        .test = test,
                        .map = map,
                        .width = (size_t)width_px,
                        .height = (size_t)height_px,
                        .constants = make_ssim_constants(window, peak)};
    int column_count = (width_px - 2 * MARGIN + COLUMN - 1) / COLUMN;
    work.sums = calloc((size_t)column_count, sizeof(*work.sums));
    if (!work.sums)
        return neph_fail_memory(diag);
    enum neph_status status = neph_parallel_rows(column_count, compare_column, &work, diag);
    if (!status)
        *means = compute_factor_means(&work, column_count);
    free(work.sums);
    return status;
}
