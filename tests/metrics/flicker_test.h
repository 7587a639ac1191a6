/* SPDX-License-Identifier: MIT
 *
 * Helpers for tests of flicker: sequences in memory, the extractor on them, and an evaluation of
 * the definitions that stores all frames, in long double and with libm.
 */
#ifndef NEPH_TESTS_FLICKER_TEST_H
#define NEPH_TESTS_FLICKER_TEST_H

#include "tests/metrics/extractor_test.h"

#include "metrics/extractors/extractors.h"

/* ---- sequences ------------------------------------------------------------------------------- */

struct sequence {
    int width_px, height_px, frame_count;
    float *samples; /* by frame, plane, row */
};

static inline struct sequence sequence_create(int width_px, int height_px, int frame_count)
{
    struct sequence sequence = {width_px, height_px, frame_count, NULL};
    sequence.samples = calloc(3 * (size_t)width_px * (size_t)height_px * (size_t)frame_count,
                              sizeof(*sequence.samples));
    assert_non_null(sequence.samples);
    return sequence;
}

static inline void sequence_destroy(struct sequence *sequence)
{
    free(sequence->samples);
}

static inline float *sequence_plane(const struct sequence *sequence, int frame, int plane)
{
    const size_t pixel_count = (size_t)sequence->width_px * (size_t)sequence->height_px;
    return sequence->samples + (3 * (size_t)frame + (size_t)plane) * pixel_count;
}

static inline void sequence_set(struct sequence *sequence, int frame, int x, int y, double r,
                                double g, double b)
{
    const size_t pixel = (size_t)y * (size_t)sequence->width_px + (size_t)x;
    sequence_plane(sequence, frame, 0)[pixel] = (float)r;
    sequence_plane(sequence, frame, 1)[pixel] = (float)g;
    sequence_plane(sequence, frame, 2)[pixel] = (float)b;
}

/* The linear grey with this luma; proportional up to 12.92 * 0.0031308 = 0.04045. */
static inline double linear_of(double luma)
{
    return luma <= 0.04045 ? luma / 12.92 : pow((luma + 0.055) / 1.055, 2.4);
}

static inline void sequence_set_luma(struct sequence *sequence, int frame, int x, int y,
                                     double luma)
{
    const double grey = linear_of(luma);
    sequence_set(sequence, frame, x, y, grey, grey, grey);
}

/* IEC 61966-2-1 and BT.709, of the stored samples. */
static inline long double luma_of(const struct sequence *sequence, int frame, int x, int y,
                                  double exposure_ev)
{
    static const long double weights[3] = {0.2126L, 0.7152L, 0.0722L};
    long double luma = 0.0L;
    for (int c = 0; c < 3; c++) {
        const size_t pixel = (size_t)y * (size_t)sequence->width_px + (size_t)x;
        long double linear = (long double)sequence_plane(sequence, frame, c)[pixel] *
                             powl(2.0L, (long double)exposure_ev);
        linear = linear < 0.0L ? 0.0L : linear > 1.0L ? 1.0L : linear;
        luma += weights[c] * (linear <= 0.0031308L ? 12.92L * linear
                                                   : 1.055L * powl(linear, 1.0L / 2.4L) - 0.055L);
    }
    return luma;
}

/* Standard normal (Box and Muller). */
static inline double normal(uint64_t *random)
{
    const double u = neph_test_uniform(random, 0x1p-60, 1.0);
    return sqrt(-2.0 * log(u)) * cos(neph_test_uniform(random, 0.0, 2.0 * M_PI));
}

/* ---- the extractor on a sequence ------------------------------------------------------------- */

static inline struct neph_frame_pair flicker_pair(const struct sequence *reference,
                                                  const struct sequence *test, int frame,
                                                  const struct neph_viewing *viewing)
{
    struct neph_frame_pair pair = {
        .quantity = neph_quantity_find("radiance"),
        .width_px = test->width_px,
        .height_px = test->height_px,
        .plane_count = 3,
        .scene_mean = NAN,
        .frame = frame,
        .frame_count = test->frame_count,
        .viewing = viewing,
    };
    for (int c = 0; c < 3; c++) {
        pair.reference[c] = sequence_plane(reference, frame % reference->frame_count, c);
        pair.test[c] = sequence_plane(test, frame, c);
    }
    return pair;
}

/* All frames; a reference of one frame is static. End with extraction_end(). */
static inline struct extraction flicker_run(const struct sequence *reference,
                                            const struct sequence *test,
                                            const struct neph_viewing *viewing,
                                            const char *const *assignments)
{
    const struct neph_viewing usual = NEPH_VIEWING_DEFAULTS;
    const struct neph_viewing *used = viewing ? viewing : &usual;
    struct neph_frame_pair pair = flicker_pair(reference, test, 0, used);
    struct extraction extraction = extraction_begin(&neph_extractor_flicker, &pair, assignments);
    for (int t = 0; t < test->frame_count; t++) {
        pair = flicker_pair(reference, test, t, used);
        extraction_frame(&extraction, &pair);
    }
    extraction_flush(&extraction);
    return extraction;
}

static inline double *flicker_map(const struct extraction *extraction, const char *name)
{
    return extraction_map(extraction, extraction_map_index(extraction->extractor, name));
}

/* One pixel of a map. */
static inline double flicker_at(const struct extraction *extraction, const char *name, int x, int y)
{
    double *map = flicker_map(extraction, name);
    const double value = map[y * extraction->width_px + x];
    free(map);
    return value;
}

/* ---- the definitions, frame by frame --------------------------------------------------------- */

struct flicker_truth {
    double std, p2p, mad;
    double a4_squared, a2_squared;    /* minus the noise floors; may be negative */
    double quarter_noise, half_noise; /* mean square amplitude of the neighbouring bins */
    double variance;                  /* detrended or not */
};

static inline long double bin_power(const long double *d, int n, int k)
{
    long double re = 0.0L, im = 0.0L;
    for (int t = 0; t < n; t++) {
        const long double angle = 2.0L * 3.14159265358979323846264338327950288L *
                                  (long double)((long long)k * t % n) / (long double)n;
        re += d[t] * cosl(angle);
        im -= d[t] * sinl(angle);
    }
    return re * re + im * im;
}

enum { FIT_TERMS = 5 };

/* Least squares of 1, t, cos(pi t / 2), sin(pi t / 2) and (-1)^t together, by elimination in the
 * normal equations, which stay far from singular for t scaled to 0 .. 1. Only the fitted line is
 * subtracted from the signal. */
static inline void detrend_signal(long double *d, int n)
{
    static const long double cosine[4] = {1.0L, 0.0L, -1.0L, 0.0L};
    long double m[FIT_TERMS][FIT_TERMS + 1] = {{0.0L}};
    for (int t = 0; t < n; t++) {
        const long double terms[FIT_TERMS + 1] = {1.0L,
                                                  (long double)t / (long double)n,
                                                  cosine[t % 4],
                                                  cosine[(t + 3) % 4],
                                                  t % 2 ? -1.0L : 1.0L,
                                                  d[t]};
        for (int i = 0; i < FIT_TERMS; i++)
            for (int j = 0; j <= FIT_TERMS; j++)
                m[i][j] += terms[i] * terms[j];
    }
    for (int i = 0; i < FIT_TERMS; i++)
        for (int k = 0; k < FIT_TERMS; k++) {
            const long double factor = k == i ? 0.0L : m[k][i] / m[i][i];
            for (int j = 0; j <= FIT_TERMS; j++)
                m[k][j] -= factor * m[i][j];
        }
    for (int t = 0; t < n; t++)
        d[t] -= m[1][FIT_TERMS] / m[1][1] * (long double)t / (long double)n;
}

static inline long double variance_of(const long double *d, int n)
{
    long double mean = 0.0L, sum = 0.0L;
    for (int t = 0; t < n; t++)
        mean += d[t] / (long double)n;
    for (int t = 0; t < n; t++)
        sum += (d[t] - mean) * (d[t] - mean);
    return sum / (long double)n;
}

/* Detrends `d` in place if `detrend`. */
static inline struct flicker_truth truth_of(long double *d, int n, bool detrend)
{
    struct flicker_truth truth = {.std = (double)sqrtl(variance_of(d, n))};
    long double least = d[0], most = d[0], travel = 0.0L;
    for (int t = 0; t < n; t++) {
        least = fminl(least, d[t]);
        most = fmaxl(most, d[t]);
        travel += t > 0 ? fabsl(d[t] - d[t - 1]) : 0.0L;
    }
    truth.p2p = (double)(most - least);
    truth.mad = (double)(travel / (long double)(n - 1));
    if (detrend)
        detrend_signal(d, n);
    truth.variance = (double)variance_of(d, n);
    const long double nn = (long double)n * (long double)n;
    long double quarter = 0.0L, half = 0.0L;
    for (int j = 1; j <= 2; j++) {
        quarter += (bin_power(d, n, n / 4 - j) + bin_power(d, n, n / 4 + j)) / 4.0L;
        half += bin_power(d, n, n / 2 - j) / 2.0L;
    }
    truth.quarter_noise = (double)(4.0L * quarter / nn);
    truth.half_noise = (double)(half / nn);
    truth.a4_squared = (double)(4.0L * (bin_power(d, n, n / 4) - quarter) / nn);
    truth.a2_squared = (double)((bin_power(d, n, n / 2) - half) / nn);
    return truth;
}

#endif
