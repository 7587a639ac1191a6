/* SPDX-License-Identifier: MIT
 *
 * The frame-to-frame change of the error: (T_t - T_t-1) - (R_t - R_t-1) with the test T and the
 * reference R, which is the change of D = T - R. True motion cancels; flicker, lag and noise
 * remain. Squared and averaged over all frames but the first, on the linear values of each channel
 * and on display luma.
 */
#include "metrics/extractors/extractors.h"

#include "base/threads.h"
#include "metrics/extractors/pair_codes.h"
#include "metrics/vector_math.h"

#include <math.h>

static const char one_frame[] = "there is only one frame";

enum map { SHOWN, LUMA_SQUARES, SQUARES, MAP_COUNT };

enum { SHOWABLE = NEPH_RADIANCE | NEPH_VOLUME };

static const struct neph_map maps[MAP_COUNT] = {
    [SHOWN] = {"residual_change", "1", 1, false, 0.1, one_frame, SHOWABLE},
    [LUMA_SQUARES] = {NULL, "1", 1, false, 0.0, one_frame, SHOWABLE},
    [SQUARES] = {NULL, NULL, 0, false, 0.0, one_frame, NEPH_LINEAR_RGB},
};

static const struct neph_metric metrics[] = {
    {"residual_change_rms", NULL, 0, INFINITY, NEPH_POOL_ROOT_MEAN, 0, SQUARES, 0,
     "rms over frames of the change of test - reference since the frame before, linear values"},
    {"residual_change_luma_rms", "1", 0, 2, NEPH_POOL_ROOT_MEAN, 0, LUMA_SQUARES, 0,
     "rms over frames of the change of test - reference since the frame before, display luma"},
    {"residual_change_psnr", "dB", -INFINITY, INFINITY, NEPH_POOL_PSNR, 1.0, LUMA_SQUARES, 0,
     "PSNR of residual_change_luma_rms, peak 1"},
    {.name = NULL},
};

static const struct neph_option options[] = {{.name = NULL}};

/* Three colours and luma. */
enum { LUMA_PLANE = 3, PLANE_COUNT };

struct state {
    int width_px, height_px, plane_count;
    int frame_count;
    bool has_luma;
    double *residual[PLANE_COUNT]; /* of the last frame */
    double *squares[PLANE_COUNT];  /* sums of the squared change */
};

static enum neph_status init(void *state_, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag)
{
    (void)settings;
    struct state *state = state_;
    const size_t pixel_count = (size_t)first->width_px * (size_t)first->height_px;
    *state = (struct state){.width_px = first->width_px,
                            .height_px = first->height_px,
                            .plane_count = first->plane_count,
                            .has_luma = (first->quantity->bit & SHOWABLE) != 0};
    for (int p = 0; p < PLANE_COUNT; p++) {
        state->residual[p] = neph_arena_allocate(first->memory, pixel_count, sizeof(double));
        state->squares[p] = neph_arena_allocate(first->memory, pixel_count, sizeof(double));
    }
    return neph_arena_check(first->memory, diag);
}

/* Add a frame; `weight` is 0 for the first frame, which has no predecessor. */
NEPH_VECTOR static void add_linear(const float *restrict reference, const float *restrict test,
                                   size_t count, double weight, double *restrict residual,
                                   double *restrict squares)
{
    for (size_t i = 0; i < count; i++) {
        const double now = (double)test[i] - (double)reference[i], change = now - residual[i];
        squares[i] += weight * change * change;
        residual[i] = now;
    }
}

NEPH_VECTOR static void add_luma(const double *restrict reference, const double *restrict test,
                                 size_t count, double weight, double *restrict residual,
                                 double *restrict squares)
{
    for (size_t i = 0; i < count; i++) {
        const double now = test[i] - reference[i], change = now - residual[i];
        squares[i] += weight * change * change;
        residual[i] = now;
    }
}

struct work {
    struct state *state;
    const struct neph_frame_pair *pair;
    const struct neph_luma_planes *luma; /* NULL: not has_luma */
};

static void follow_row(int row, void *context)
{
    const struct work *work = context;
    const struct state *state = work->state;
    const size_t width = (size_t)state->width_px, first = (size_t)row * width;
    const double weight = state->frame_count > 0 ? 1.0 : 0.0;
    for (int p = 0; p < state->plane_count; p++)
        add_linear(work->pair->reference[p] + first, work->pair->test[p] + first, width, weight,
                   state->residual[p] + first, state->squares[p] + first);
    if (state->has_luma)
        add_luma(work->luma->reference + first, work->luma->test + first, width, weight,
                 state->residual[LUMA_PLANE] + first, state->squares[LUMA_PLANE] + first);
}

static enum neph_status extract(void *state_, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    struct state *state = state_;
    struct work work = {state, pair, NULL};
    enum neph_status status = state->has_luma ? neph_pair_luma_get(pair, &work.luma, diag)
                                              : NEPH_OK;
    if (!status)
        status = neph_parallel_rows(state->height_px, follow_row, &work, diag);
    state->frame_count++;
    return status;
}

static void rows(const void *state_, int map, int first_row, int row_count, double *const values[3])
{
    const struct state *state = state_;
    const size_t width = (size_t)state->width_px, first = (size_t)first_row * width;
    const double changes = state->frame_count - 1;
    for (int p = 0; p < (map == SQUARES ? state->plane_count : 1); p++) {
        const double *squares = state->squares[map == SQUARES ? p : LUMA_PLANE] + first;
        for (size_t i = 0; i < (size_t)row_count * width; i++) {
            const double mean = changes > 0.0 ? squares[i] / changes : (double)NAN;
            values[p][i] = map == SHOWN ? sqrt(mean) : mean;
        }
    }
}

const struct neph_extractor neph_extractor_residual_change = {
    .name = "residual_change",
    .help = "changes of the error from frame to frame; true motion cancels",
    .source = "the temporal difference error (tPSNR); in the spirit of tOF: Chu et al., Learning "
              "Temporal Coherence via Self-Supervision for GAN-based Video Generation, SIGGRAPH "
              "2020",
    .quantities = NEPH_LINEAR_RGB,
    .temporal = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = MAP_COUNT,
    .state_size = sizeof(struct state),
    .bound = neph_bound_is_white,
    .init = init,
    .extract = extract,
    .rows = rows,
};
