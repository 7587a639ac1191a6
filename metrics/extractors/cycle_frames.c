/* SPDX-License-Identifier: MIT */
#include "metrics/extractors/cycle_frames.h"

#include "base/threads.h"
#include "metrics/vector_math.h"

#include <stdatomic.h>
#include <stdlib.h>

/* The sum has a fixed number of parts, so that it does not depend on the number of threads; each
 * part processes GROUP pixels at a time. */
enum { PARTS = 16, GROUP = 8 };

/* Limit of pixels times frames in the moments: 131072 pixels of 256 frames. */
static const double sample_limit = 0x1p25;

static const double least_std = 0.25 / 255.0;

enum neph_status neph_cycle_frames_begin(struct neph_cycle_frames *frames, int width_px,
                                         int height_px, int frame_count, struct neph_arena *memory,
                                         struct neph_diag *diag)
{
    const size_t count = (size_t)width_px * (size_t)height_px * (size_t)frame_count;
    float *values = neph_arena_zeroed(memory, count, sizeof(*values));
    if (!values) {
        const enum neph_status status = neph_fail_memory(diag);
        neph_hint(diag,
                  "cycles store %d frames of %dx%d pixels, %.1f GB; use fewer frames, or only "
                  "other metrics",
                  frame_count, width_px, height_px, 4e-9 * (double)count);
        return status;
    }
    *frames = (struct neph_cycle_frames){width_px, height_px, frame_count, values};
    return NEPH_OK;
}

struct work {
    const struct neph_cycle_frames *frames;
    int side_px;          /* side of the squares; one pixel of each is used */
    int columns, rows;    /* number of squares */
    double *parts[PARTS]; /* owned */
    atomic_bool out_of_memory;
};

/* A hash of the position, 0 .. count - 1. */
static int choose(int column, int row, int count)
{
    uint64_t z = (uint64_t)(uint32_t)row << 32 | (uint32_t)column;
    z = (z + 0x9e3779b97f4a7c15u) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 29)) * 0x94d049bb133111ebu;
    return (int)((z >> 40) % (uint64_t)count);
}

static int lesser(int a, int b)
{
    return a < b ? a : b;
}

static void pick(const struct work *work, int column, int row, int place[2])
{
    const int left = column * work->side_px, top = row * work->side_px;
    const int across = lesser(work->side_px, work->frames->width_px - left);
    const int down = lesser(work->side_px, work->frames->height_px - top);
    const int which = choose(column, row, across * down);
    place[0] = left + which % across;
    place[1] = top + which / across;
}

/* A pixel's series minus its mean, divided by its standard deviation around its line. */
static void read_series(const struct neph_cycle_frames *frames, const int place[2], double *series)
{
    const int count = frames->frame_count;
    const double n = (double)count, middle = 0.5 * (n - 1.0);
    double sum = 0.0, along = 0.0, squares = 0.0;
    for (int t = 0; t < count; t++) {
        series[t] = (double)neph_cycle_frames_row(frames, place[1], t)[place[0]];
        sum += series[t];
    }
    for (int t = 0; t < count; t++) {
        series[t] -= sum / n;
        along += series[t] * ((double)t - middle);
        squares += series[t] * series[t];
    }
    const double line = along * along * 12.0 / (n * (n * n - 1.0));
    const double scale = 1.0 / sqrt(fmax(squares - line, 0.0) / n + least_std * least_std);
    for (int t = 0; t < count; t++)
        series[t] *= scale;
}

/* Add to the lower triangle; `series` has GROUP rows. */
NEPH_VECTOR
static void add_moments(const double *restrict series, size_t n, double *restrict moments)
{
    const double *s0 = series, *s1 = s0 + n, *s2 = s1 + n, *s3 = s2 + n;
    const double *s4 = s3 + n, *s5 = s4 + n, *s6 = s5 + n, *s7 = s6 + n;
    for (size_t i = 0; i < n; i++) {
        double *row = moments + i * n;
        for (size_t j = 0; j <= i; j++)
            row[j] += ((s0[i] * s0[j] + s1[i] * s1[j]) + (s2[i] * s2[j] + s3[i] * s3[j])) +
                      ((s4[i] * s4[j] + s5[i] * s5[j]) + (s6[i] * s6[j] + s7[i] * s7[j]));
    }
}

static void add_part(int part, void *context)
{
    struct work *work = context;
    const size_t n = (size_t)work->frames->frame_count;
    double *moments = work->parts[part] = calloc(n * n, sizeof(*moments));
    double *series = calloc(GROUP * n, sizeof(*series));
    if (!moments || !series)
        atomic_store(&work->out_of_memory, true);
    int filled = 0;
    for (int row = part; moments && series && row < work->rows; row += PARTS)
        for (int column = 0; column < work->columns; column++) {
            int place[2];
            pick(work, column, row, place);
            read_series(work->frames, place, series + (size_t)filled * n);
            if (++filled == GROUP) {
                add_moments(series, n, moments);
                filled = 0;
            }
        }
    if (filled > 0) {
        memset(series + (size_t)filled * n, 0, (size_t)(GROUP - filled) * n * sizeof(*series));
        add_moments(series, n, moments);
    }
    free(series);
}

/* Add up all parts in order, then fill the upper triangle. */
static void add_up(const struct work *work, double *moments)
{
    const size_t n = (size_t)work->frames->frame_count;
    for (int part = 0; part < PARTS; part++)
        for (size_t i = 0; i < n * n; i++)
            moments[i] += work->parts[part][i];
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++)
            moments[j * n + i] = moments[i * n + j];
}

enum neph_status neph_cycle_moments(const struct neph_cycle_frames *frames,
                                    struct neph_arena *memory, double **moments,
                                    struct neph_diag *diag)
{
    const double samples = (double)frames->width_px * frames->height_px * frames->frame_count;
    struct work work = {.frames = frames,
                        .side_px = (int)ceil(sqrt(fmax(samples / sample_limit, 1.0)))};
    work.columns = (frames->width_px + work.side_px - 1) / work.side_px;
    work.rows = (frames->height_px + work.side_px - 1) / work.side_px;
    const size_t n = (size_t)frames->frame_count;
    double *sum = neph_arena_zeroed(memory, n * n, sizeof(*sum));
    enum neph_status status = sum ? NEPH_OK : neph_fail_memory(diag);
    if (!status)
        status = neph_parallel_rows(PARTS, add_part, &work, diag);
    if (!status && atomic_load(&work.out_of_memory))
        status = neph_fail_memory(diag);
    if (!status)
        add_up(&work, sum);
    for (int part = 0; part < PARTS; part++)
        free(work.parts[part]);
    if (!status)
        *moments = sum;
    return status;
}
