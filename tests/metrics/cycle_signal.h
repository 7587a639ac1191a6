/* SPDX-License-Identifier: MIT
 *
 * Signals with known cycles, and coloured noise, for the tests of `cycles`.
 */
#ifndef NEPH_TESTS_CYCLE_SIGNAL_H
#define NEPH_TESTS_CYCLE_SIGNAL_H

#include "metrics/extractors/cycle_fit.h"
#include "tests/neph_test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum cycle_colour {
    CYCLE_WHITE,
    CYCLE_AR_5,
    CYCLE_AR_9,
    CYCLE_PINK,
    CYCLE_SHARED_WHITE, /* equal in all pixels */
    CYCLE_SHARED_AR_9,
    CYCLE_SHARED_PINK,
    CYCLE_HALF_SHARED, /* half of the power */
    CYCLE_BLURRED,     /* over 9x9 pixels */
    CYCLE_BLURRED_AR_9,
    CYCLE_COLOUR_COUNT,
};

static const char *const cycle_colour_names[] = {
    "white",        "AR(1) 0.5",         "AR(1) 0.9",  "1/f",
    "shared white", "shared AR(1) 0.9",  "shared 1/f", "half shared",
    "blurred",      "blurred AR(1) 0.9",
};

struct cycle_plan {
    int periods[2]; /* 0: none */
    bool is_general;
    bool random_phase;
    double rms;   /* of each period's waveform */
    double noise; /* RMS */
    enum cycle_colour colour;
    uint64_t seed;
};

struct cycle_result {
    int missed, missed_period, extra, extra_period, worst_period;
    double worst; /* relative error of an RMS */
};

enum { CYCLE_LIMIT = 33 };

/* Standard normal (Box and Muller). */
static inline double cycle_normal(uint64_t *random)
{
    const double u = neph_test_uniform(random, 0x1p-60, 1.0);
    return sqrt(-2.0 * log(u)) * cos(neph_test_uniform(random, 0.0, 2.0 * M_PI));
}

/* ---- noise ----------------------------------------------------------------------------------- */

static inline void cycle_noise_series(enum cycle_colour colour, int n, uint64_t *random,
                                      double *series)
{
    const bool is_ar_5 = colour == CYCLE_AR_5;
    const bool is_ar_9 = colour == CYCLE_AR_9 || colour == CYCLE_SHARED_AR_9 ||
                         colour == CYCLE_BLURRED_AR_9;
    if (colour == CYCLE_PINK || colour == CYCLE_SHARED_PINK) { /* octaves of AR(1) */
        double state[8];
        for (int o = 0; o < 8; o++)
            state[o] = cycle_normal(random);
        for (int t = 0; t < n; t++) {
            series[t] = 0.0;
            for (int o = 0; o < 8; o++) {
                const double keep = exp(-M_PI * pow(0.5, o));
                state[o] = keep * state[o] + sqrt(1.0 - keep * keep) * cycle_normal(random);
                series[t] += state[o] / sqrt(8.0);
            }
        }
        return;
    }
    const double keep = is_ar_9 ? 0.9 : is_ar_5 ? 0.5 : 0.0;
    double state = cycle_normal(random);
    for (int t = 0; t < n; t++) {
        state = keep * state + sqrt(1.0 - keep * keep) * cycle_normal(random);
        series[t] = state;
    }
}

static inline void cycle_blur(struct neph_cycle_frames *frames)
{
    const int w = frames->width_px, h = frames->height_px, r = 4;
    float *copy = malloc((size_t)w * (size_t)h * sizeof(*copy));
    for (int t = 0; t < frames->frame_count; t++) {
        for (int y = 0; y < h; y++)
            for (int x = 0; x < w; x++) {
                double sum = 0.0;
                for (int k = -r; k <= r; k++)
                    sum += (double)neph_cycle_frames_row(frames, y, t)[(x + k + w) % w];
                copy[y * w + x] = (float)sum;
            }
        for (int y = 0; y < h; y++)
            for (int x = 0; x < w; x++) {
                double sum = 0.0;
                for (int k = -r; k <= r; k++)
                    sum += (double)copy[(y + k + h) % h * w + x];
                neph_cycle_frames_row(frames, y, t)[x] = (float)(sum / 9.0);
            }
    }
    free(copy);
}

static inline void cycle_add_noise(struct neph_cycle_frames *frames, const struct cycle_plan *plan,
                                   uint64_t *random)
{
    const int n = frames->frame_count;
    double *series = malloc((size_t)n * sizeof(*series)),
           *shared = malloc((size_t)n * sizeof(*shared));
    const bool is_shared = plan->colour >= CYCLE_SHARED_WHITE && plan->colour <= CYCLE_SHARED_PINK;
    const bool is_half = plan->colour == CYCLE_HALF_SHARED;
    cycle_noise_series(plan->colour, n, random, shared);
    for (int y = 0; y < frames->height_px; y++)
        for (int x = 0; x < frames->width_px; x++) {
            if (!is_shared)
                cycle_noise_series(plan->colour, n, random, series);
            for (int t = 0; t < n; t++) {
                const double value = is_shared ? shared[t]
                                     : is_half ? sqrt(0.5) * (shared[t] + series[t])
                                               : series[t];
                neph_cycle_frames_row(frames, y, t)[x] = (float)(plan->noise * value);
            }
        }
    if (plan->colour >= CYCLE_BLURRED)
        cycle_blur(frames);
    free(shared);
    free(series);
}

/* ---- cycles ---------------------------------------------------------------------------------- */

static inline int cycle_divisor(int a, int b)
{
    return b ? cycle_divisor(b, a % b) : a;
}

/* Amplitudes of the frequencies m / P, by P and m in lowest terms. */
struct cycle_wave {
    double c[CYCLE_LIMIT][CYCLE_LIMIT], s[CYCLE_LIMIT][CYCLE_LIMIT];
};

static inline void cycle_add_wave(int period, const double *shape, double phase,
                                  struct cycle_wave *wave)
{
    for (int m = 1; 2 * m <= period; m++) {
        const int d = cycle_divisor(period, m);
        const double angle = shape[2 * m + 1] + phase * (double)m;
        const bool is_half = 2 * m == period;
        wave->c[period / d][m / d] += shape[2 * m] * (is_half ? 1.0 : cos(angle));
        wave->s[period / d][m / d] += shape[2 * m] * (is_half ? 0.0 : sin(angle));
    }
}

/* Amplitude and phase by harmonic. */
static inline void cycle_shape(const struct cycle_plan *plan, int period, uint64_t *random,
                               double *shape)
{
    double power = 0.0;
    for (int m = 1; 2 * m <= period; m++) {
        const bool wanted = plan->is_general || m == 1;
        shape[2 * m] = wanted ? hypot(cycle_normal(random), cycle_normal(random)) : 0.0;
        shape[2 * m + 1] = neph_test_uniform(random, 0.0, 2.0 * M_PI);
        power += shape[2 * m] * shape[2 * m] * (2 * m == period ? 1.0 : 0.5);
    }
    for (int m = 1; 2 * m <= period; m++)
        shape[2 * m] *= plan->rms / sqrt(power);
}

/* Adds to the frames; `truth` receives the mean squares by period. */
static inline void cycle_plant(struct neph_cycle_frames *frames, const struct cycle_plan *plan,
                               uint64_t *random, double truth[CYCLE_LIMIT])
{
    double shapes[2][2 * CYCLE_LIMIT] = {{0.0}};
    for (int i = 0; i < 2; i++)
        if (plan->periods[i])
            cycle_shape(plan, plan->periods[i], random, shapes[i]);
    const double pixels = (double)frames->width_px * frames->height_px;
    for (int y = 0; y < frames->height_px; y++)
        for (int x = 0; x < frames->width_px; x++) {
            struct cycle_wave wave = {{{0.0}}, {{0.0}}};
            for (int i = 0; i < 2; i++)
                if (plan->periods[i])
                    cycle_add_wave(plan->periods[i], shapes[i],
                                   plan->random_phase ? neph_test_uniform(random, 0.0, 2.0 * M_PI)
                                                      : 0.0,
                                   &wave);
            for (int p = 2; p < CYCLE_LIMIT; p++)
                for (int m = 1; 2 * m <= p; m++) {
                    const double c = wave.c[p][m], s = wave.s[p][m];
                    if (c == 0.0 && s == 0.0)
                        continue;
                    truth[p] += (c * c + s * s) * (2 * m == p ? 1.0 : 0.5) / pixels;
                    double table_c[CYCLE_LIMIT];
                    for (int k = 0; k < p; k++)
                        table_c[k] = c * cos(2.0 * M_PI * m * k / p) +
                                     s * sin(2.0 * M_PI * m * k / p);
                    for (int t = 0; t < frames->frame_count; t++)
                        neph_cycle_frames_row(frames, y, t)[x] += (float)table_c[t % p];
                }
        }
}

/* ---- frames ---------------------------------------------------------------------------------- */

static inline void cycle_means(const struct neph_cycle_frames *frames,
                               const struct neph_cycle_model *model, double *means)
{
    const int count = NEPH_CYCLE_SQUARES + model->period_count;
    const size_t width = (size_t)frames->width_px;
    double *scratch = malloc(neph_cycle_scratch_count(model) * sizeof(*scratch));
    double *values = malloc((size_t)count * width * sizeof(*values));
    double **parts = malloc((size_t)count * sizeof(*parts));
    for (int i = 0; i < count; i++) {
        parts[i] = values + (size_t)i * width;
        means[i] = 0.0;
    }
    for (int y = 0; y < frames->height_px; y++) {
        neph_cycle_fit_row(model, frames, y, scratch, parts);
        for (int i = 0; i < count; i++)
            for (size_t x = 0; x < width; x++)
                means[i] += parts[i][x] / (double)(width * (size_t)frames->height_px);
    }
    free(parts);
    free(values);
    free(scratch);
}

static inline struct cycle_result cycle_judge(const struct neph_cycle_model *model,
                                              const double *means, const double truth[CYCLE_LIMIT])
{
    struct cycle_result result = {0};
    double whole = 0.0;
    for (int p = 2; p < CYCLE_LIMIT; p++)
        whole += truth[p];
    for (int p = 2; p < CYCLE_LIMIT; p++) {
        double found = NAN;
        for (int i = 0; i < model->period_count; i++)
            if (model->periods[i] == p)
                found = means[NEPH_CYCLE_SQUARES + i];
        if (truth[p] == 0.0 && !isnan(found)) {
            result.extra++;
            result.extra_period = p;
        }
        if (truth[p] > 0.01 * whole && isnan(found)) {
            result.missed++;
            result.missed_period = p;
        }
        if (truth[p] > 0.01 * whole && !isnan(found)) {
            const double off = fabs(sqrt(fmax(found, 0.0) / truth[p]) - 1.0);
            if (off > result.worst) {
                result.worst = off;
                result.worst_period = p;
            }
        }
    }
    return result;
}

/* Prints an error and ends the program. */
static inline void cycle_check(enum neph_status status, const struct neph_diag *diag)
{
    if (!status)
        return;
    fprintf(stderr, "%s\n", diag->message);
    exit(EXIT_FAILURE);
}

/* Creates frames with everything in the plan; `truth` receives the mean squares by period. */
static inline void cycle_make(struct neph_cycle_frames *frames, const struct cycle_plan *plan,
                              int width_px, int height_px, int frame_count,
                              struct neph_arena *memory, double truth[CYCLE_LIMIT])
{
    struct neph_diag diag = {0};
    uint64_t random = plan->seed;
    cycle_check(neph_cycle_frames_begin(frames, width_px, height_px, frame_count, memory, &diag),
                &diag);
    memset(truth, 0, CYCLE_LIMIT * sizeof(*truth));
    if (plan->noise > 0.0)
        cycle_add_noise(frames, plan, &random);
    cycle_plant(frames, plan, &random, truth);
}

static inline struct neph_cycle_findings cycle_search(const struct neph_cycle_frames *frames,
                                                      struct neph_arena *memory)
{
    struct neph_diag diag = {0};
    struct neph_cycle_frequencies candidates = {0};
    struct neph_cycle_findings findings = {0};
    const struct neph_cycle_declared declared = {.count = 0};
    double *moments = NULL;
    cycle_check(neph_cycle_candidates(frames->frame_count, &declared, memory, &candidates, &diag),
                &diag);
    cycle_check(neph_cycle_moments(frames, memory, &moments, &diag), &diag);
    cycle_check(
        neph_cycle_search(frames->frame_count, moments, &candidates, memory, &findings, &diag),
        &diag);
    return findings;
}

static inline struct cycle_result cycle_try(const struct cycle_plan *plan, int width_px,
                                            int height_px, int frame_count)
{
    struct neph_diag diag = {0};
    struct neph_arena memory = {0};
    struct neph_cycle_frames frames = {0};
    struct neph_cycle_model model = {0};
    double truth[CYCLE_LIMIT];
    cycle_make(&frames, plan, width_px, height_px, frame_count, &memory, truth);
    struct neph_cycle_findings findings = cycle_search(&frames, &memory);
    cycle_check(neph_cycle_model_begin(&model, frame_count, &findings, &memory, &diag), &diag);
    double *means = malloc((NEPH_CYCLE_SQUARES + (size_t)model.period_count) * sizeof(*means));
    cycle_means(&frames, &model, means);
    const struct cycle_result result = cycle_judge(&model, means, truth);
    free(means);
    neph_arena_finish(&memory);
    return result;
}

#endif
