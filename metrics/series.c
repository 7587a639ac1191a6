/* SPDX-License-Identifier: MIT */
#include "metrics/series.h"

#include "metrics/significance.h"
#include "metrics/statistics.h"

#include <stdlib.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_INTERVAL_KIND_COUNT == 5, "a new kind");
_Static_assert(NEPH_REPLICATE_COUNT == 2, "a new kind");

static const double interval_alpha = 0.05;

/* Above this, the correlation indicates a trend, which no interval describes, and the correction
 * would grow without bound. */
static const double correlation_max = 0.95;

static bool all_finite(const double *values, int count)
{
    for (int i = 0; i < count; i++)
        if (!isfinite(values[i]))
            return false;
    return true;
}

static double compute_plain_mean(const double *values, int count)
{
    struct neph_sum sum = {0.0, 0.0};
    for (int i = 0; i < count; i++)
        neph_sum_add(&sum, values[i] / count);
    return neph_sum_value(&sum);
}

/* Unbiased variance of a single value. */
static double compute_plain_variance(const double *values, int count, double mean)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        sum += (values[i] - mean) * (values[i] - mean);
    return sum / (count - 1);
}

static bool repeats(const double *values, int count, int period)
{
    if (count < 2 * period)
        return false;
    for (int i = period; i < count; i++)
        if (values[i] != values[i - period])
            return false;
    return true;
}

/* The means of the last `batch_count` batches of `batch_frames`. */
static void batch_means(const double *frames, int count, int batch_count, int batch_frames,
                        double means[NEPH_BATCHES_LIMIT])
{
    const double *first = frames + (count - batch_count * batch_frames);
    for (int b = 0; b < batch_count; b++)
        means[b] = compute_plain_mean(first + b * batch_frames, batch_frames);
}

struct batching {
    int count, frames; /* count 0: too few frames */
};

static struct batching choose_batching(int count)
{
    int frames = NEPH_BATCH_FRAMES;
    if (count < NEPH_BATCHES_MIN * frames)
        frames = NEPH_BATCH_FRAMES_FEW;
    while (count / frames >= NEPH_BATCHES_LIMIT)
        frames *= 2;
    const int batches = count / frames;
    return (struct batching){batches < NEPH_BATCHES_MIN ? 0 : batches, frames};
}

/* The correlation of neighbouring frames about the mean of their position in the cycle; `count`
 * covers whole cycles. The estimate is too low by (1 + 3 rho) / count (Kendall, Biometrika 41,
 * 1954), which is added. */
static double neighbour_correlation(const double *frames, int count)
{
    double phase_means[NEPH_CYCLE_FRAMES] = {0.0};
    for (int i = 0; i < count; i++)
        phase_means[i % NEPH_CYCLE_FRAMES] += frames[i] * NEPH_CYCLE_FRAMES / count;
    double products = 0.0, squares = 0.0, before = 0.0;
    for (int i = 0; i < count; i++) {
        const double now = frames[i] - phase_means[i % NEPH_CYCLE_FRAMES];
        products += before * now;
        squares += now * now;
        before = now;
    }
    const double measured = squares > 0.0 ? products / squares : 0.0;
    return fmin(fmax(measured + (1.0 + 3.0 * measured) / count, 0.0), correlation_max);
}

/* The variance of the mean of `count` consecutive values of a first-order autoregressive series
 * with variance 1. */
static double ar1_variance_of_the_mean(double correlation, int count)
{
    const double n = count, apart = 1.0 - correlation;
    return (1.0 + correlation) / (apart * n) -
           2.0 * correlation * (1.0 - pow(correlation, n)) / (n * n * apart * apart);
}

/* The ratio of the variance of batch means divided by their number to the variance of the total
 * mean: 1 without correlation. */
static double shortfall(double correlation, struct batching batching)
{
    const double of_batch = ar1_variance_of_the_mean(correlation, batching.frames);
    const double of_all = ar1_variance_of_the_mean(correlation, batching.frames * batching.count);
    return fmax(1.0, of_all * (batching.count - 1) / (of_batch - of_all));
}

static struct neph_mean with_interval(double value, double variance, enum neph_interval_kind kind,
                                      int n)
{
    const double standard_error = sqrt(variance);
    const double half = neph_student_critical(interval_alpha, n - 1) * standard_error;
    if (!isfinite(half))
        return (struct neph_mean){0};
    return (struct neph_mean){.defined = true,
                              .value = value,
                              .low = value - half,
                              .high = value + half,
                              .interval = kind,
                              .n = n,
                              .standard_error = standard_error};
}

static struct neph_mean exact(double value, enum neph_interval_kind kind, int n)
{
    const double bound = kind == NEPH_INTERVAL_DETERMINISTIC ? value : 0.0;
    return (struct neph_mean){.defined = isfinite(value),
                              .value = value,
                              .low = bound,
                              .high = bound,
                              .interval = kind,
                              .n = n};
}

static struct neph_mean mean_of_runs(const double *values, int count)
{
    const double value = compute_plain_mean(values, count);
    if (repeats(values, count, 1))
        return exact(values[0], NEPH_INTERVAL_DETERMINISTIC, count);
    if (count < 2)
        return exact(value, NEPH_INTERVAL_NONE, count);
    return with_interval(value, compute_plain_variance(values, count, value) / count,
                         NEPH_INTERVAL_RUNS, count);
}

/* Number of frames beyond whole cycles; 0 if there is no whole cycle. */
static int frames_over(int count)
{
    return count < NEPH_CYCLE_FRAMES ? 0 : count % NEPH_CYCLE_FRAMES;
}

static struct neph_mean mean_of_frames(const double *values, int count)
{
    const double *frames = values + frames_over(count);
    const int used = count - frames_over(count);
    const double value = compute_plain_mean(frames, used);
    if (repeats(values, count, 1))
        return exact(values[0], NEPH_INTERVAL_DETERMINISTIC, count);
    if (repeats(values, count, NEPH_CYCLE_FRAMES) || repeats(values, count, NEPH_BATCH_FRAMES))
        return exact(value, NEPH_INTERVAL_DETERMINISTIC, used);
    const struct batching batching = choose_batching(used);
    if (batching.count == 0)
        return exact(value, NEPH_INTERVAL_NONE, used);
    double means[NEPH_BATCHES_LIMIT];
    batch_means(frames, used, batching.count, batching.frames, means);
    const double of_batch = compute_plain_variance(means, batching.count,
                                                   compute_plain_mean(means, batching.count)) *
                            shortfall(neighbour_correlation(frames, used), batching);
    return with_interval(value, of_batch * batching.frames / used, NEPH_INTERVAL_CYCLES,
                         batching.count);
}

struct neph_mean neph_series_mean(const double *values, int count, enum neph_replicate replicate)
{
    if (count < 1 || !all_finite(values, count))
        return (struct neph_mean){0};
    return replicate == NEPH_REPLICATE_RUNS ? mean_of_runs(values, count)
                                            : mean_of_frames(values, count);
}

static double student_p(const struct neph_mean *mean)
{
    if (!mean->defined || mean->interval == NEPH_INTERVAL_NONE || mean->value == 0.0)
        return 1.0;
    if (mean->standard_error == 0.0)
        return 0.0;
    return neph_student_p(mean->value / mean->standard_error, mean->n - 1);
}

static void count_signs(const double *values, int count, struct neph_paired *paired)
{
    for (int i = 0; i < count; i++) {
        paired->positive += values[i] > 0.0;
        paired->negative += values[i] < 0.0;
    }
    paired->p_sign = neph_sign_p(paired->positive, paired->negative);
}

static struct neph_paired judge(const double *differences, int count, enum neph_replicate replicate)
{
    struct neph_paired paired = {.difference = neph_series_mean(differences, count, replicate),
                                 .p_sign = 1.0};
    paired.p = student_p(&paired.difference);
    if (!paired.difference.defined)
        return paired;
    const struct batching batching = choose_batching(count - frames_over(count));
    double means[NEPH_BATCHES_LIMIT];
    if (replicate == NEPH_REPLICATE_RUNS) {
        count_signs(differences, count, &paired);
    } else if (batching.count > 0) {
        batch_means(differences, count, batching.count, batching.frames, means);
        count_signs(means, batching.count, &paired);
    }
    return paired;
}

enum neph_status neph_series_paired(const double *a, const double *b, int count,
                                    enum neph_replicate replicate, struct neph_paired *paired,
                                    struct neph_diag *diag)
{
    const size_t length = count > 0 ? (size_t)count : 1;
    double *differences = calloc(length, sizeof(*differences));
    if (!differences)
        return neph_fail_memory(diag);
    for (int i = 0; i < count; i++)
        differences[i] = a[i] - b[i];
    *paired = judge(differences, count, replicate);
    free(differences);
    return NEPH_OK;
}

struct neph_paired neph_series_paired_draws(double a, const struct neph_draws *draws_a, double b,
                                            const struct neph_draws *draws_b)
{
    struct neph_paired paired = {.p = 1.0, .p_sign = 1.0};
    double differences[NEPH_DRAWS_COUNT];
    for (int d = 0; d < NEPH_DRAWS_COUNT; d++)
        differences[d] = draws_a->values[d] - draws_b->values[d];
    if (draws_a->tile_count != draws_b->tile_count || draws_a->tiles != draws_b->tiles ||
        !all_finite(differences, NEPH_DRAWS_COUNT) || !isfinite(a - b))
        return paired;
    const double mean = compute_plain_mean(differences, NEPH_DRAWS_COUNT);
    const double error = sqrt(compute_plain_variance(differences, NEPH_DRAWS_COUNT, mean));
    paired.difference = (struct neph_mean){
        .defined = true,
        .value = a - b,
        .low = fmin(a - b, neph_percentile(differences, NEPH_DRAWS_COUNT, interval_alpha / 2.0)),
        .high = fmax(a - b,
                     neph_percentile(differences, NEPH_DRAWS_COUNT, 1.0 - interval_alpha / 2.0)),
        .interval = NEPH_INTERVAL_TILES,
        .n = draws_a->tile_count,
        .standard_error = error,
    };
    paired.p = student_p(&paired.difference);
    return paired;
}
