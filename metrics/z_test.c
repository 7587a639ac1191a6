/* SPDX-License-Identifier: MIT */
#include "metrics/z_test.h"

#include "metrics/interval.h"
#include "metrics/significance.h"
#include "metrics/statistics.h"

#include <math.h>
#include <stdlib.h>

enum {
    LAG_PX = 3,              /* pixels over which the noise of repeats may correlate */
    CARRIERS_MIN = 8,        /* pixels that carry the noise of a mean whose p-value is right */
    FEW_DOF = 32,            /* below: a pixel's variance is at least the mean around it */
    SCATTER_PIXELS_MIN = 64, /* tiles with fewer pixels use the scatter of the whole frame */
};

_Static_assert(NEPH_Z_KIND_COUNT == 5, "neph_z_test() makes a result of each");

static const double dof_min = 0.1, dof_max = 1e9;
static const double mean_weight = 0.8; /* of the mean of plane 0 in the level */

double neph_z_from_student(double t, double dof)
{
    const double square = dof * log1p(t * t / dof);
    return copysign((8.0 * dof + 1.0) / (8.0 * dof + 3.0) * sqrt(square), t);
}

/* ---- variances ------------------------------------------------------------------------------- */

/* The sums over a tile or over the frame. Index 0: the reference, 1: the test. */
struct sums {
    size_t pixels;
    double variance[2];
    double difference;     /* of all pixels */
    double scatter;        /* of ((v1 - r v0) / (v1 + r v0))^2 */
    double squares;        /* of (v0 + v1)^2 */
    double squares_by_dof; /* of (v0 + v1)^2 / dof */
    double cubes;          /* of v1^1.5 - v0^1.5 */
};

struct work {
    const struct neph_z_side *side[2];
    struct neph_z_plane *plane;
    struct neph_tiling tiling;
    struct sums frame, *tiles;
    double ratio;   /* variance of the test / variance of the reference; 0: one has none */
    double *raised; /* variance of each pixel's difference, see raise_variances() */
    double *z, *scores, *sizes;
    bool *has_noise;
};

static size_t count_pixels(const struct neph_z_plane *plane)
{
    return (size_t)plane->width_px * (size_t)plane->height_px;
}

static size_t find_tile(const struct work *work, size_t pixel)
{
    const size_t width = (size_t)work->plane->width_px, side = (size_t)work->tiling.side_px;
    return pixel / width / side * (size_t)work->tiling.columns + pixel % width / side;
}

static double get_difference(const struct work *work, size_t i)
{
    return work->side[1]->mean[i] - work->side[0]->mean[i];
}

static double get_variance(const struct work *work, size_t i)
{
    return work->side[0]->variance[i] + work->side[1]->variance[i];
}

/* The error of the difference by the rounding of both stored values. */
static double get_rounding(const struct work *work, size_t i)
{
    const struct neph_z_side *const *side = work->side;
    return fmax(side[0]->rounding * fabs(side[0]->mean[i]),
                side[1]->rounding * fabs(side[1]->mean[i]));
}

/* Raise both variances to the other one, times their ratio over the frame. */
static void raise_variances(const double variance[2], double ratio, double raised[2])
{
    raised[0] = ratio > 0.0 ? fmax(variance[0], variance[1] / ratio) : variance[0];
    raised[1] = ratio > 0.0 ? fmax(variance[1], variance[0] * ratio) : variance[1];
}

/* Whether both renders have about the same noise: their difference is then symmetric. */
static bool has_like_noise(const struct work *work)
{
    return work->ratio >= 0.5 && work->ratio <= 2.0;
}

/* ---- sums ------------------------------------------------------------------------------------ */

static void find_noise(struct work *work)
{
    double sums[2] = {0.0, 0.0};
    const size_t count = count_pixels(work->plane);
    for (size_t i = 0; i < count; i++) {
        const double rounding = get_rounding(work, i), variance = get_variance(work, i);
        work->has_noise[i] = variance > 0.0 && variance >= rounding * rounding;
        for (int s = 0; s < 2 && work->has_noise[i]; s++)
            sums[s] += work->side[s]->variance[i];
    }
    work->ratio = sums[0] > 0.0 && sums[1] > 0.0 ? sums[1] / sums[0] : 0.0;
}

/* Ten roundings, since a renderer's sum has more than one. */
static bool is_within_rounding(const struct work *work, size_t i)
{
    const double allowed = 10.0 * get_rounding(work, i) + 6.0 * sqrt(get_variance(work, i));
    return !work->has_noise[i] && fabs(get_difference(work, i)) <= allowed;
}

static void add_pixel(struct sums *sums, const struct work *work, size_t i)
{
    const double v0 = work->side[0]->variance[i], v1 = work->side[1]->variance[i];
    const double part = work->ratio > 0.0 ? (v1 - work->ratio * v0) / (v1 + work->ratio * v0) : 0.0;
    sums->pixels++;
    sums->variance[0] += v0;
    sums->variance[1] += v1;
    sums->scatter += part * part;
    sums->squares += (v0 + v1) * (v0 + v1);
    sums->cubes += v1 * sqrt(v1) - v0 * sqrt(v0);
}

/* The degrees of freedom of the variance of a pixel's difference.
 *
 * For two independent estimates with m degrees of freedom each, the mean square of `part` above is
 * 1 / (m + 1) (a beta distribution): m follows without the content of the image. The relative
 * variance of their weighted sum is at most w^2 (2/m + 2/m) with the larger weight w. When one side
 * has no variance, m follows from the scatter between pixels, which the content can only lower. */
static double estimate_dof(const struct work *work, const struct sums *sums)
{
    const double n = (double)sums->pixels, v0 = sums->variance[0], v1 = sums->variance[1];
    const double share = fmax(v0, v1) / (v0 + v1);
    double dof;
    if (work->ratio > 0.0)
        dof = (n / sums->scatter - 1.0) / (2.0 * share * share);
    else
        dof = 2.0 / fmax(1e-9, n * sums->squares / ((v0 + v1) * (v0 + v1)) - 1.0);
    const double m0 = work->side[0]->dof, m1 = work->side[1]->dof;
    if (m0 > 0.0 && m1 > 0.0) /* Welch */
        dof = fmin(dof, (v0 + v1) * (v0 + v1) / (v0 * v0 / m0 + v1 * v1 / m1));
    return dof > dof_min ? fmin(dof, dof_max) : dof_min;
}

static void add_up(struct work *work)
{
    const size_t count = count_pixels(work->plane);
    for (size_t i = 0; i < count; i++) {
        work->plane->reference_mean += work->side[0]->mean[i] / (double)count;
        if (is_within_rounding(work, i))
            continue;
        work->tiles[find_tile(work, i)].difference += get_difference(work, i);
        work->frame.difference += get_difference(work, i);
        if (!work->has_noise[i])
            continue;
        add_pixel(&work->tiles[find_tile(work, i)], work, i);
        add_pixel(&work->frame, work, i);
    }
}

/* ---- pixels ---------------------------------------------------------------------------------- */

/* The pixel and its up to eight neighbours: the mean of their variances, and whether none of
 * them has noise. */
struct surroundings {
    double mean_variance;
    bool are_calm;
};

static struct surroundings look_around(const struct work *work, size_t i)
{
    const int width = work->plane->width_px, height = work->plane->height_px;
    const int x = (int)(i % (size_t)width), y = (int)(i / (size_t)width);
    struct surroundings found = {.are_calm = true};
    int count = 0;
    for (int ny = y > 0 ? y - 1 : 0; ny <= y + 1 && ny < height; ny++)
        for (int nx = x > 0 ? x - 1 : 0; nx <= x + 1 && nx < width; nx++) {
            const size_t at = (size_t)ny * (size_t)width + (size_t)nx;
            found.mean_variance += work->raised[at];
            found.are_calm &= !work->has_noise[at];
            count++;
        }
    found.mean_variance /= count;
    return found;
}

static bool is_contrary(const struct work *work, size_t i)
{
    return !work->has_noise[i] && !is_within_rounding(work, i);
}

/* A single pixel may be an edge that few samples hit all or none of the times. */
static void judge_calm(struct work *work, size_t i)
{
    const size_t width = (size_t)work->plane->width_px, x = i % width;
    const bool has_like = (x > 0 && is_contrary(work, i - 1)) ||
                          (x + 1 < width && is_contrary(work, i + 1)) ||
                          (i >= width && is_contrary(work, i - width)) ||
                          (i + width < count_pixels(work->plane) && is_contrary(work, i + width));
    if (!is_contrary(work, i))
        return;
    if (has_like && look_around(work, i).are_calm)
        work->plane->contrary++;
    else
        work->plane->unjudged++;
}

/* Score a pixel with noise. On an edge, a few samples may all be on one side in one render, and on
 * the other side in the other render: then both variances are too low, and those around it are
 * not. */
static double score_pixel(struct work *work, size_t i, double dof)
{
    const double variance = dof < FEW_DOF
                                ? fmax(work->raised[i], look_around(work, i).mean_variance)
                                : work->raised[i];
    const double error = sqrt(variance), difference = get_difference(work, i);
    work->sizes[work->plane->noisy++] = error;
    work->plane->identical += difference == 0.0;
    work->z[i] = difference / error;
    return neph_z_from_student(work->z[i], dof);
}

static void raise_pixels(struct work *work)
{
    const size_t count = count_pixels(work->plane);
    for (size_t i = 0; i < count; i++) {
        const double variance[2] = {work->side[0]->variance[i], work->side[1]->variance[i]};
        double raised[2];
        raise_variances(variance, work->ratio, raised);
        work->raised[i] = raised[0] + raised[1];
    }
}

static void score_pixels(struct work *work)
{
    const size_t count = count_pixels(work->plane);
    const double frame_dof = work->frame.pixels > 0 ? estimate_dof(work, &work->frame) : dof_max;
    for (size_t i = 0; i < count; i++) {
        work->z[i] = work->scores[i] = NAN;
        if (!work->has_noise[i]) {
            judge_calm(work, i);
            continue;
        }
        struct sums *tile = &work->tiles[find_tile(work, i)];
        const double dof = tile->pixels < SCATTER_PIXELS_MIN ? frame_dof : estimate_dof(work, tile);
        const double variance = get_variance(work, i);
        tile->squares_by_dof += variance * variance / dof;
        work->frame.squares_by_dof += variance * variance / dof;
        work->scores[i] = score_pixel(work, i, dof);
    }
    if (work->plane->noisy > 0)
        work->plane->pixel_noise = neph_percentile(work->sizes, work->plane->noisy, 0.5);
}

/* p of the largest of `count` normal scores (Sidak). */
static double compute_largest_p(double largest, size_t count)
{
    return -expm1((double)count * log1p(-neph_normal_p(largest)));
}

static int compare_descending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

/* Holm's count of rejected pixels. Only scores that the first step could reject are sorted. */
static size_t count_rejected(struct work *work)
{
    const size_t noisy = work->plane->noisy, count = count_pixels(work->plane);
    const double first = neph_normal_critical(NEPH_Z_LEVEL); /* below every step's limit */
    size_t kept = 0, rejected = 0;
    for (size_t i = 0; i < count; i++)
        if (fabs(work->scores[i]) > first)
            work->sizes[kept++] = fabs(work->scores[i]);
    qsort(work->sizes, kept, sizeof(*work->sizes), compare_descending);
    while (rejected < kept &&
           neph_normal_p(work->sizes[rejected]) <= NEPH_Z_LEVEL / (double)(noisy - rejected))
        rejected++;
    return rejected;
}

static void judge_pixels(struct work *work)
{
    struct neph_z_plane *plane = work->plane;
    const size_t count = count_pixels(plane);
    double largest = 0.0;
    for (int k = 0; k < NEPH_Z_BEYOND_COUNT; k++)
        plane->expected[k] = (double)plane->noisy * neph_normal_p(2.0 + k);
    for (size_t i = 0; i < count; i++) {
        const double size = fabs(work->scores[i]);
        for (int k = 0; k < NEPH_Z_BEYOND_COUNT; k++)
            plane->beyond[k] += size > 2.0 + k;
        if (!(size > largest))
            continue;
        largest = size;
        plane->pixel_px[0] = (int)(i % (size_t)plane->width_px);
        plane->pixel_px[1] = (int)(i / (size_t)plane->width_px);
        plane->tests[NEPH_Z_PIXEL].statistic = work->scores[i];
    }
    if (plane->noisy > 0)
        plane->tests[NEPH_Z_PIXEL].p = compute_largest_p(largest, plane->noisy);
    plane->rejected = count_rejected(work);
}

static void correlate_neighbours(struct work *work)
{
    const size_t width = (size_t)work->plane->width_px, count = count_pixels(work->plane);
    double products = 0.0, squares = 0.0;
    for (size_t i = 0; i < count; i++) {
        const size_t next[2] = {i % width + 1 < width ? i + 1 : count, i + width};
        for (int k = 0; k < 2; k++)
            if (next[k] < count && work->has_noise[i] && work->has_noise[next[k]]) {
                products += work->scores[i] * work->scores[next[k]];
                squares += 0.5 * (work->scores[i] * work->scores[i] +
                                  work->scores[next[k]] * work->scores[next[k]]);
            }
    }
    work->plane->neighbour_correlation = squares > 0.0 ? products / squares : 0.0;
}

/* ---- tiles and the mean ---------------------------------------------------------------------- */

static double add_sides(const struct work *work, const double variance[2])
{
    return variance[0] * fmax(1.0, work->side[0]->correlation) +
           variance[1] * fmax(1.0, work->side[1]->correlation);
}

/* Satterthwaite's, at most twice the number of pixels that the variance consists of: of rare events
 * each is in a pixel of its own, and the relative variance of the sum of their squares is the
 * inverse of that number. */
static double compute_sum_dof(const struct sums *sums)
{
    const double variance = sums->variance[0] + sums->variance[1];
    const double dof = fmin(variance * variance / sums->squares_by_dof,
                            2.0 * variance * variance / sums->squares);
    return fmin(dof_max, dof);
}

static double score_tile(struct work *work, const struct sums *tile, double *error)
{
    double raised[2];
    raise_variances(tile->variance, work->ratio, raised);
    const double deviation = sqrt(add_sides(work, raised));
    *error = deviation / (double)tile->pixels;
    return neph_z_from_student(tile->difference / deviation, compute_sum_dof(tile));
}

static void judge_tiles(struct work *work)
{
    struct neph_z_plane *plane = work->plane;
    double squares = 0.0, largest = 0.0;
    size_t count = 0;
    for (int t = 0; t < work->tiling.columns * work->tiling.rows; t++) {
        if (work->tiles[t].pixels == 0)
            continue;
        const double score = score_tile(work, &work->tiles[t], &work->sizes[count]);
        count++;
        squares += score * score;
        if (fabs(score) <= largest)
            continue;
        largest = fabs(score);
        plane->tile_corner_px[0] = t % work->tiling.columns * work->tiling.side_px;
        plane->tile_corner_px[1] = t / work->tiling.columns * work->tiling.side_px;
        plane->tests[NEPH_Z_TILE].statistic = score;
    }
    plane->tile_count = (int)count;
    if (count == 0)
        return;
    plane->tests[NEPH_Z_TILES].statistic = squares;
    plane->tests[NEPH_Z_TILES].p = neph_chi_squared_p(squares, (double)count);
    plane->tests[NEPH_Z_TILE].p = compute_largest_p(largest, count);
    plane->tile_noise = neph_percentile(work->sizes, count, 0.5);
}

/* The normal distribution from where it cannot be told from Student's. */
static double compute_student_p(double t, double dof)
{
    return dof < 1e4 ? neph_student_p(t, dof) : neph_normal_p(t);
}

static double find_student_critical(double alpha, double dof)
{
    return dof < 1e4 ? neph_student_critical(alpha, dof) : neph_normal_critical(alpha);
}

/* The first term of the series of a tail of t by Edgeworth, (2 t^2 + 1) phi(t) skewness / 6 (Hall,
 * The Annals of Probability 15, 1987). A few rare events make the test of the mean skewed when one
 * render has far fewer samples: a sum without its share of them also has a variance that is too
 * low. Then the noise of a pixel is one event, and its third moment v^1.5; otherwise the term is
 * negligible, below (pixels)^-0.5. Added to p, because the tail that it lowers is not certain. */
static double compute_skewness_p(double t, const struct sums *sums)
{
    const double variance = sums->variance[0] + sums->variance[1];
    const double skewness = fabs(sums->cubes) / (variance * sqrt(variance));
    return (2.0 * t * t + 1.0) * exp(-0.5 * t * t) / sqrt(2.0 * M_PI) * skewness / 6.0;
}

static void judge_mean(struct work *work)
{
    struct neph_z_plane *plane = work->plane;
    const double count = (double)count_pixels(plane);
    if (plane->noisy == 0)
        return;
    plane->bias_dof = compute_sum_dof(&work->frame);
    plane->bias = work->frame.difference / count;
    plane->bias_error = sqrt(add_sides(work, work->frame.variance)) / count;
    plane->bias_half_width = plane->bias_error *
                             find_student_critical(NEPH_Z_LEVEL, plane->bias_dof);
    const double t = plane->bias / plane->bias_error;
    plane->tests[NEPH_Z_MEAN].statistic = t;
    plane->few_carriers = plane->bias_dof < 2.0 * CARRIERS_MIN && !has_like_noise(work);
    if (plane->few_carriers)
        return;
    plane->tests[NEPH_Z_MEAN].p = fmin(1.0, compute_student_p(t, plane->bias_dof) +
                                                compute_skewness_p(t, &work->frame));
}

/* ---- all of a plane -------------------------------------------------------------------------- */

/* Without independent pixels, connected z are no evidence. */
static enum neph_status judge_blob(struct work *work, uint64_t seed, struct neph_diag *diag)
{
    struct neph_z_plane *plane = work->plane;
    struct neph_z_blob *blob = &plane->blob;
    const double correlation = fmax(work->side[0]->correlation, work->side[1]->correlation);
    const enum neph_status status = neph_z_find_blob(work->z, plane->width_px, plane->height_px,
                                                     has_like_noise(work), seed, blob, diag);
    if (!status && blob->pixels > 0 && correlation <= 1.1)
        plane->tests[NEPH_Z_BLOB] = (struct neph_z_result){blob->statistic, blob->p, 1.0};
    return status;
}

static enum neph_status allocate(struct work *work, size_t pixels, struct neph_diag *diag)
{
    const size_t tiles = (size_t)work->tiling.columns * (size_t)work->tiling.rows;
    work->tiles = calloc(tiles, sizeof(*work->tiles));
    work->raised = malloc(pixels * sizeof(*work->raised));
    work->z = malloc(pixels * sizeof(*work->z));
    work->scores = malloc(pixels * sizeof(*work->scores));
    work->sizes = malloc(pixels * sizeof(*work->sizes));
    work->has_noise = malloc(pixels * sizeof(*work->has_noise));
    return work->tiles && work->raised && work->z && work->scores && work->sizes && work->has_noise
               ? NEPH_OK
               : neph_fail_memory(diag);
}

enum neph_status neph_z_test(const struct neph_z_side *reference, const struct neph_z_side *test,
                             int width_px, int height_px, uint64_t seed, float *scores,
                             struct neph_z_plane *plane, struct neph_diag *diag)
{
    struct neph_z_plane found = {.width_px = width_px, .height_px = height_px};
    struct work work = {.side = {reference, test},
                        .plane = &found,
                        .tiling = neph_tiling_make(width_px, height_px)};
    const size_t pixels = count_pixels(&found);
    found.tile_px = work.tiling.side_px;
    for (int k = 0; k < NEPH_Z_KIND_COUNT; k++)
        found.tests[k] = (struct neph_z_result){NAN, 1.0, 1.0};
    enum neph_status status = allocate(&work, pixels, diag);
    if (!status) {
        find_noise(&work);
        add_up(&work);
        raise_pixels(&work);
        score_pixels(&work);
        judge_pixels(&work);
        correlate_neighbours(&work);
        judge_tiles(&work);
        judge_mean(&work);
        status = judge_blob(&work, seed, diag);
    }
    for (size_t i = 0; i < pixels && scores && !status; i++)
        scores[i] = (float)work.scores[i];
    if (!status)
        *plane = found;
    free(work.tiles);
    free(work.raised);
    free(work.z);
    free(work.scores);
    free(work.sizes);
    free(work.has_noise);
    return status;
}

/* ---- several tests --------------------------------------------------------------------------- */

static double get_weight(int plane, int kind, int count)
{
    if (plane == 0 && kind == NEPH_Z_MEAN)
        return mean_weight;
    return (1.0 - mean_weight) / (count * NEPH_Z_KIND_COUNT - 1);
}

static void find_least(struct neph_z_plane *plane, double mean_alpha, double alpha)
{
    /* One-sided quantile: the other tail adds nothing at these levels. */
    const double beyond = neph_normal_critical(2.0 * (1.0 - NEPH_Z_POWER));
    plane->least_mean = plane->least_tile = plane->least_pixel = NAN;
    if (plane->noisy == 0)
        return;
    if (!plane->few_carriers)
        plane->least_mean = plane->bias_error *
                            (find_student_critical(mean_alpha, plane->bias_dof) + beyond);
    plane->least_tile = plane->tile_noise *
                        (neph_normal_critical(neph_sidak_alpha(alpha, plane->tile_count)) + beyond);
    plane->least_pixel = plane->pixel_noise *
                         (neph_normal_critical(neph_sidak_alpha(alpha, (int)plane->noisy)) +
                          beyond);
}

double neph_z_combine(struct neph_z_plane *planes, int count)
{
    const int tests = count * NEPH_Z_KIND_COUNT;
    bool taken[NEPH_Z_PLANES_MAX * NEPH_Z_KIND_COUNT] = {false};
    double weight_left = 1.0, adjusted = 0.0, smallest = 1.0;
    for (int step = 0; step < tests; step++) {
        int next = -1;
        double least = INFINITY;
        for (int k = 0; k < tests; k++) {
            const int plane = k / NEPH_Z_KIND_COUNT, kind = k % NEPH_Z_KIND_COUNT;
            const double ratio = planes[plane].tests[kind].p / get_weight(plane, kind, count);
            if (taken[k] || ratio >= least)
                continue;
            least = ratio;
            next = k;
        }
        struct neph_z_result *result =
            &planes[next / NEPH_Z_KIND_COUNT].tests[next % NEPH_Z_KIND_COUNT];
        adjusted = fmax(adjusted, fmin(1.0, least * weight_left));
        result->adjusted = adjusted;
        smallest = fmin(smallest, adjusted);
        weight_left -= get_weight(next / NEPH_Z_KIND_COUNT, next % NEPH_Z_KIND_COUNT, count);
        taken[next] = true;
    }
    for (int p = 0; p < count; p++) {
        find_least(&planes[p], NEPH_Z_LEVEL * get_weight(p, NEPH_Z_MEAN, count),
                   NEPH_Z_LEVEL * get_weight(p, NEPH_Z_TILE, count));
        smallest = planes[p].contrary > 0 ? 0.0 : smallest;
    }
    return smallest;
}

/* ---- repeats --------------------------------------------------------------------------------- */

/* Replace each value by the sum over the values at most LAG_PX away along a line. */
static void sum_line(double *values, size_t count, size_t stride, double *line)
{
    for (size_t i = 0; i < count; i++)
        line[i] = values[i * stride];
    for (size_t i = 0; i < count; i++) {
        const size_t first = i > LAG_PX ? i - LAG_PX : 0;
        double sum = 0.0;
        for (size_t k = first; k <= i + LAG_PX && k < count; k++)
            sum += line[k];
        values[i * stride] = sum;
    }
}

/* The sum over pixels of a deviation times those around it, and of its square. */
static void add_products(const float *repeat, const double *mean, int width_px, int height_px,
                         double *around, double *line, double sums[2])
{
    const size_t width = (size_t)width_px, height = (size_t)height_px;
    for (size_t i = 0; i < width * height; i++)
        around[i] = (double)repeat[i] - mean[i];
    for (size_t y = 0; y < height; y++)
        sum_line(around + y * width, width, 1, line);
    for (size_t x = 0; x < width; x++)
        sum_line(around + x, height, width, line);
    for (size_t i = 0; i < width * height; i++) {
        const double deviation = (double)repeat[i] - mean[i];
        sums[0] += deviation * around[i];
        sums[1] += deviation * deviation;
    }
}

/* 1 unless the ratio is three of its standard errors above 1: each of the n lags on one side adds
 * twice a correlation, whose variance is the inverse of the number of independent pixels. */
static double find_correlation(const double sums[2], const double *variance, size_t pixels,
                               int repeats)
{
    const double lags = 0.5 * ((2.0 * LAG_PX + 1.0) * (2.0 * LAG_PX + 1.0) - 1.0);
    double total = 0.0, squares = 0.0;
    for (size_t i = 0; i < pixels; i++) {
        total += variance[i];
        squares += variance[i] * variance[i];
    }
    if (!(sums[1] > 0.0) || !(total > 0.0))
        return 1.0;
    const double error = sqrt(4.0 * lags * squares / (total * total) / (repeats - 1.0));
    const double ratio = sums[0] / sums[1];
    return ratio > 1.0 + 3.0 * error ? ratio : 1.0;
}

enum neph_status neph_z_from_repeats(const float *const *repeats, int count, int width_px,
                                     int height_px, double *mean, double *variance,
                                     struct neph_z_side *side, struct neph_diag *diag)
{
    const size_t pixels = (size_t)width_px * (size_t)height_px;
    double *around = malloc(pixels * sizeof(*around)), sums[2] = {0.0, 0.0};
    double *line = malloc((size_t)(width_px > height_px ? width_px : height_px) * sizeof(*line));
    const enum neph_status status = around && line ? NEPH_OK : neph_fail_memory(diag);
    for (size_t i = 0; i < pixels && !status; i++) {
        double sum = 0.0, squares = 0.0;
        for (int r = 0; r < count; r++)
            sum += (double)repeats[r][i];
        mean[i] = sum / count;
        for (int r = 0; r < count; r++)
            squares += ((double)repeats[r][i] - mean[i]) * ((double)repeats[r][i] - mean[i]);
        variance[i] = squares / (count - 1.0) / count;
    }
    for (int r = 0; r < count && !status; r++)
        add_products(repeats[r], mean, width_px, height_px, around, line, sums);
    if (!status) {
        side->mean = mean;
        side->variance = variance;
        side->dof = count - 1.0;
        side->correlation = find_correlation(sums, variance, pixels, count);
    }
    free(around);
    free(line);
    return status;
}
