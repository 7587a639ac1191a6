/* SPDX-License-Identifier: MIT
 *
 * Temporal spectra of many series. Two real series are the real and imaginary part of one complex
 * series, whose transform is then separated; a vector holds several of these pairs. In place, radix
 * 2.
 */
#include "metrics/extractors/seen_spectrum.h"

#include "metrics/vector_math.h"

#include <math.h>
#include <string.h>

enum { LANES = NEPH_SEEN_LANES, PAIRS = LANES / 2 };

/* Reverse the bits of an index. */
static int reversed(int index, int count)
{
    int place = 0;
    for (int bit = 1; bit < count; bit *= 2, index /= 2)
        place = 2 * place + index % 2;
    return place;
}

/* Fill the Hann window, and the weights of a line fit under it. */
static void fill_frames(struct neph_seen_window *window)
{
    const int n = window->frame_count;
    double sum = 0.0, slope_sum = 0.0;
    for (int pass = 0; pass < 2; pass++)
        for (int t = 0; t < n; t++) {
            const double sine = sin(M_PI * (t + 0.5) / n), taper = sine * sine;
            const double weight = taper * taper, from_centre = t - 0.5 * (n - 1);
            if (pass == 0) {
                sum += weight;
                slope_sum += weight * from_centre * from_centre;
                continue;
            }
            /* The two halves of the spectrum are combined into one. */
            window->taper[t] = (float)(taper * sqrt(4.0 / (window->padded_count * sum)));
            window->mean_weights[t] = (float)(weight / sum);
            window->slope_weights[t] = (float)(weight * from_centre / slope_sum);
            window->places[t] = reversed(t, window->padded_count);
        }
}

enum neph_status neph_seen_window_create(int frame_count, struct neph_arena *memory,
                                         struct neph_seen_window *window, struct neph_diag *diag)
{
    const size_t n = (size_t)frame_count;
    *window = (struct neph_seen_window){.frame_count = frame_count, .padded_count = 4};
    while (window->padded_count < frame_count)
        window->padded_count *= 2;
    window->bin_count = window->padded_count / 2 + 1;
    window->taper = neph_arena_allocate(memory, n, sizeof(*window->taper));
    window->mean_weights = neph_arena_allocate(memory, n, sizeof(*window->mean_weights));
    window->slope_weights = neph_arena_allocate(memory, n, sizeof(*window->slope_weights));
    window->turns = neph_arena_allocate(memory, (size_t)window->padded_count,
                                        sizeof(*window->turns));
    window->places = neph_arena_allocate(memory, n, sizeof(*window->places));
    const enum neph_status status = neph_arena_check(memory, diag);
    if (status)
        return status;
    fill_frames(window);
    for (int j = 0; j < window->padded_count / 2; j++) {
        window->turns[2 * j] = (float)cos(2.0 * M_PI * j / window->padded_count);
        window->turns[2 * j + 1] = (float)-sin(2.0 * M_PI * j / window->padded_count);
    }
    return NEPH_OK;
}

size_t neph_seen_room(const struct neph_seen_window *window)
{
    return (size_t)window->padded_count * LANES;
}

/* ---- the transform --------------------------------------------------------------------------- */

/* Load a row of the memory: PAIRS real parts, then as many imaginary parts. */

static inline __attribute__((always_inline)) void
load(const struct neph_seen_window *window, const float *series, size_t stride, float *room)
{
    float mean[LANES] = {0.0f}, slope[LANES] = {0.0f};
    for (int t = 0; t < window->frame_count; t++) {
        const float *frame = series + (size_t)t * stride;
        NEPH_LANES
        for (int l = 0; l < LANES; l++) {
            mean[l] += window->mean_weights[t] * frame[l];
            slope[l] += window->slope_weights[t] * frame[l];
        }
    }
    memset(room, 0, neph_seen_room(window) * sizeof(*room));
    for (int t = 0; t < window->frame_count; t++) {
        const float *frame = series + (size_t)t * stride;
        float *row = room + (size_t)window->places[t] * LANES;
        const float from_centre = (float)t - 0.5f * (float)(window->frame_count - 1);
        NEPH_LANES
        for (int l = 0; l < LANES; l++)
            row[l] = window->taper[t] * (frame[l] - (mean[l] + slope[l] * from_centre));
    }
}

static inline __attribute__((always_inline)) void turn(float *restrict low, float *restrict high,
                                                       float re, float im)
{
    NEPH_LANES
    for (int l = 0; l < PAIRS; l++) {
        const float a = re * high[l] - im * high[l + PAIRS];
        const float b = re * high[l + PAIRS] + im * high[l];
        high[l] = low[l] - a;
        high[l + PAIRS] = low[l + PAIRS] - b;
        low[l] += a;
        low[l + PAIRS] += b;
    }
}

static inline __attribute__((always_inline)) void transform(const struct neph_seen_window *window,
                                                            float *room)
{
    const int count = window->padded_count;
    for (int half = 1; half < count; half *= 2)
        for (int first = 0; first < count; first += 2 * half)
            for (int j = 0; j < half; j++) {
                const float *by = window->turns + 2 * (size_t)j * (size_t)(count / (2 * half));
                turn(room + (size_t)(first + j) * LANES, room + (size_t)(first + j + half) * LANES,
                     by[0], by[1]);
            }
}

/* Separate two series in one transform, Z = A + i B: A_k = (Z_k + conj Z_-k) / 2, B_k = (Z_k - conj
 * Z_-k) / 2i. */
static inline __attribute__((always_inline)) void take_apart(const struct neph_seen_window *window,
                                                             const float *room, float *energies)
{
    const int count = window->padded_count;
    for (int k = 0; k < window->bin_count; k++) {
        const float *z = room + (size_t)k * LANES,
                    *y = room + (size_t)((count - k) % count) * LANES;
        float *bin = energies + (size_t)k * LANES;
        const float share = k == 0 || 2 * k == count ? 0.125f : 0.25f;
        NEPH_LANES
        for (int l = 0; l < PAIRS; l++) {
            const float sum_re = z[l] + y[l], sum_im = z[l + PAIRS] + y[l + PAIRS];
            const float less_re = z[l] - y[l], less_im = z[l + PAIRS] - y[l + PAIRS];
            bin[l] = share * (sum_re * sum_re + less_im * less_im);
            bin[l + PAIRS] = share * (sum_im * sum_im + less_re * less_re);
        }
    }
}

NEPH_VECTOR
void neph_seen_spectrum(const struct neph_seen_window *window, const float *series, size_t stride,
                        float *room, float *energies)
{
    load(window, series, stride, room);
    transform(window, room);
    take_apart(window, room, energies);
}
