/* SPDX-License-Identifier: MIT
 *
 * Adds the frames of a sequence to the flicker sums. Frames are buffered in blocks: the sums are
 * most of the memory, and passing through them takes most of the time besides the encoding.
 */
#include "metrics/extractors/flicker_watch.h"

#include "base/threads.h"
#include "metrics/extractors/pair_codes.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <string.h>

enum { CYCLE = NEPH_FLICKER_CYCLE, BLOCK = 2 * CYCLE };

/* Shared data for the rows of one frame. */
struct frame_work {
    struct neph_flicker_watch *watch;
    const struct neph_frame_pair *pair;
    const struct neph_luma_planes *luma;
    int t;           /* frame index after the warm-up */
    int cycle_count; /* cycles to add after this frame: 0 except at the end of a block or of the
                      * sequence */
    struct neph_flicker_weights weights[BLOCK / CYCLE];
};

static double *allocate(struct neph_arena *memory, int row_width, int row_count)
{
    return neph_arena_allocate(memory, (size_t)row_width * (size_t)row_count, sizeof(double));
}

static double *padded_row(const struct neph_flicker_watch *watch, double *rows, int row)
{
    return rows + (size_t)row * (size_t)watch->padded_width_px;
}

static double *recent_frame_row(const struct neph_flicker_watch *watch,
                                const struct neph_flicker_signal *signal, int row, int t)
{
    return padded_row(watch, signal->recent, BLOCK * row + t % BLOCK);
}

static enum neph_status start_moving_sums(struct neph_flicker_watch *watch,
                                          struct neph_flicker_signal *signal, int sum_count,
                                          struct neph_diag *diag)
{
    signal->recent = allocate(&watch->recent, BLOCK * watch->padded_width_px, watch->height_px);
    const enum neph_status status = neph_arena_check(&watch->recent, diag);
    return status ? status
                  : neph_flicker_sums_begin(&signal->sums, watch->width_px, watch->height_px,
                                            sum_count, &watch->sums, diag);
}

/* ---- a frame --------------------------------------------------------------------------------- */

static size_t plane_row(const struct neph_flicker_watch *watch, int row)
{
    return (size_t)row * (size_t)watch->width_px;
}

/* Compare by value: the caller may read every frame into the same memory. */
static void compare_reference(int row, void *context)
{
    const struct frame_work *work = context;
    struct neph_flicker_watch *watch = work->watch;
    const size_t begin = plane_row(watch, row);
    const size_t size = (size_t)watch->width_px * sizeof(float);
    bool same = true;
    for (int c = 0; c < 3 && same; c++)
        same = memcmp(work->pair->reference[c] + begin, watch->reference_planes[c] + begin, size) ==
               0;
    watch->reference_row_moved[row] = !same;
}

static void store_first_row(int row, void *context)
{
    const struct frame_work *work = context;
    struct neph_flicker_watch *watch = work->watch;
    const size_t begin = plane_row(watch, row), size = (size_t)watch->width_px * sizeof(double);
    memcpy(padded_row(watch, watch->test.first, row), work->luma->test + begin, size);
    memcpy(padded_row(watch, watch->reference.first, row), work->luma->reference + begin, size);
    for (int c = 0; c < 3; c++)
        memcpy(watch->reference_planes[c] + begin, work->pair->reference[c] + begin,
               (size_t)watch->width_px * sizeof(float));
}

NEPH_VECTOR
static void subtract(double *restrict difference, const double *restrict values,
                     const double *restrict others, int count)
{
    for (int i = 0; i < count; i++)
        difference[i] = values[i] - others[i];
}

NEPH_VECTOR
static void take_away(double *restrict values, const double *restrict others, int count)
{
    for (int i = 0; i < count; i++)
        values[i] -= others[i];
}

/* Store the difference of a row of luma to frame 0. */
static void store_difference_row(const struct frame_work *work, struct neph_flicker_signal *signal,
                                 const double *luma, int row)
{
    const struct neph_flicker_watch *watch = work->watch;
    subtract(recent_frame_row(watch, signal, row, work->t), luma + plane_row(watch, row),
             padded_row(watch, signal->first, row), watch->width_px);
}

static void subtract_reference_row(const struct frame_work *work, struct neph_flicker_signal *test,
                                   const struct neph_flicker_signal *reference, int row)
{
    take_away(recent_frame_row(work->watch, test, row, work->t),
              recent_frame_row(work->watch, reference, row, work->t), work->watch->width_px);
}

static void add_cycles(const struct frame_work *work, struct neph_flicker_signal *signal, int row)
{
    const double *frames[BLOCK];
    for (int k = 0; k < BLOCK; k++)
        frames[k] = recent_frame_row(work->watch, signal, row, k);
    neph_flicker_sums_add(&signal->sums, row, work->cycle_count, work->weights, frames);
}

static void add_frame_row(int row, void *context)
{
    const struct frame_work *work = context;
    struct neph_flicker_watch *watch = work->watch;
    struct neph_flicker_signal *test = &watch->test, *reference = &watch->reference;
    store_difference_row(work, test, work->luma->test, row);
    if (watch->reference_moves) {
        store_difference_row(work, reference, work->luma->reference, row);
        subtract_reference_row(work, test, reference, row);
    }
    if (work->cycle_count == 0)
        return;
    add_cycles(work, test, row);
    if (watch->reference_moves)
        add_cycles(work, reference, row);
}

/* Detect a change of the reference since frame 0; from then on it counts as moving. */
static enum neph_status watch_reference(struct frame_work *work, struct neph_diag *diag)
{
    struct neph_flicker_watch *watch = work->watch;
    if (watch->reference_moves)
        return NEPH_OK;
    enum neph_status status = neph_parallel_rows(watch->height_px, compare_reference, work, diag);
    bool moved = false;
    for (int row = 0; row < watch->height_px && !status; row++)
        moved = moved || watch->reference_row_moved[row];
    if (status || !moved)
        return status;
    neph_arena_finish(&watch->planes);
    watch->reference_moves = true;
    return start_moving_sums(watch, &watch->reference, NEPH_FLICKER_VARIANCE_COUNT, diag);
}

/* At the last frame of a block or of the sequence: compute the weights of the block's frames. */
static void weigh(struct frame_work *work)
{
    const int frame_count = work->watch->frame_count;
    if ((work->t + 1) % BLOCK != 0 && work->t + 1 != frame_count)
        return;
    const int first = work->t / BLOCK * BLOCK;
    work->cycle_count = (work->t + 1 - first) / CYCLE;
    for (int k = 0; k < work->cycle_count; k++)
        work->weights[k] = neph_flicker_weights_make(first + CYCLE * k, frame_count);
}

enum neph_status neph_flicker_watch_frame(struct neph_flicker_watch *watch,
                                          const struct neph_frame_pair *pair, int t,
                                          struct neph_diag *diag)
{
    struct frame_work work = {.watch = watch, .pair = pair, .t = t};
    weigh(&work);
    enum neph_status status = neph_pair_luma_get(pair, &work.luma, diag);
    if (!status)
        status = t == 0 ? neph_parallel_rows(watch->height_px, store_first_row, &work, diag)
                        : watch_reference(&work, diag);
    if (!status)
        status = neph_parallel_rows(watch->height_px, add_frame_row, &work, diag);
    if (!status)
        watch->frames_seen++;
    return status;
}

/* ---- begin and end --------------------------------------------------------------------------- */

enum neph_status neph_flicker_watch_begin(struct neph_flicker_watch *watch,
                                          const struct neph_frame_pair *first, int frame_count,
                                          struct neph_diag *diag)
{
    const size_t pixel_count = (size_t)first->width_px * (size_t)first->height_px;
    *watch = (struct neph_flicker_watch){
        .width_px = first->width_px,
        .height_px = first->height_px,
        .padded_width_px = neph_flicker_padded(first->width_px),
        .frame_count = frame_count,
    };
    watch->reference_row_moved = neph_arena_allocate(&watch->sums, (size_t)first->height_px,
                                                     sizeof(bool));
    for (int c = 0; c < 3; c++)
        watch->reference_planes[c] = neph_arena_allocate(&watch->planes, pixel_count,
                                                         sizeof(float));
    watch->reference.first = allocate(&watch->sums, watch->padded_width_px, watch->height_px);
    watch->test.first = allocate(&watch->sums, watch->padded_width_px, watch->height_px);
    const enum neph_status status = neph_arena_check(&watch->planes, diag);
    return status ? status : start_moving_sums(watch, &watch->test, NEPH_FLICKER_SUM_COUNT, diag);
}

void neph_flicker_watch_stop(struct neph_flicker_watch *watch)
{
    neph_arena_finish(&watch->recent);
    neph_arena_finish(&watch->planes);
}

void neph_flicker_watch_end(struct neph_flicker_watch *watch)
{
    neph_flicker_watch_stop(watch);
    neph_arena_finish(&watch->sums);
}
