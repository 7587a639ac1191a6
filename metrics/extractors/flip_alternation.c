/* SPDX-License-Identifier: MIT
 *
 * FLIP between frames of one sequence. FLIP measures the visible difference of two images that
 * alternate at one place, which is how a cycle of four frames appears on the display: frames t and
 * t + 1 alternate with the period 2, frames t and t + 2 with the period 4. The same number of the
 * reference is subtracted, so that intended motion does not count.
 */
#include "metrics/extractors/extractors.h"
#include "metrics/extractors/flip.h"

#include <math.h>
#include <string.h>

enum {
    CYCLE_FRAMES = 4,
    DISTANCE_COUNT = 2, /* 1 and 2 frames */
};

enum side { REFERENCE, TEST, SIDE_COUNT };

struct state {
    struct neph_flip *flip;
    struct neph_flip_display display;
    int width_px, height_px;
    int wanted_pairs; /* for each distance, whole cycles */
    int pairs[DISTANCE_COUNT];
    float *kept[SIDE_COUNT][DISTANCE_COUNT][3]; /* frame t at t % DISTANCE_COUNT */
    double *sums[SIDE_COUNT][DISTANCE_COUNT];   /* sum of FLIP over the pairs so far */
    double *map;                                /* of one pair */
};

enum option_index { OPTION_TONE, OPTION_CYCLES };

static const struct neph_option options[] = {
    [OPTION_TONE] = {"tone", NEPH_OPTION_CHOICE, NEPH_FLIP_NONE, 0.0, 0.0, neph_flip_tones,
                     "tone curve between exposure and the clamp to the display's range"},
    [OPTION_CYCLES] = {"cycles", NEPH_OPTION_INTEGER, 1.0, 1.0, 256.0, NULL,
                       "cycles of 4 frames, from the first frame on; 2 frames more are needed"},
    {0},
};

#define TOO_SHORT "the sequence is shorter than the cycles and 2 frames more"

static int pairs_wanted(const struct neph_settings *settings)
{
    return CYCLE_FRAMES * (int)settings->values[OPTION_CYCLES];
}

static const char *obstacle(const struct neph_frame_pair *first,
                            const struct neph_settings *settings)
{
    const bool is_known = first->frame_count > 0;
    return is_known && first->frame_count < pairs_wanted(settings) + DISTANCE_COUNT ? TOO_SHORT
                                                                                    : NULL;
}

static size_t pixel_count(const struct state *state)
{
    return (size_t)state->width_px * (size_t)state->height_px;
}

static void allocate(struct state *state, struct neph_arena *memory)
{
    const size_t count = pixel_count(state);
    state->map = neph_arena_zeroed(memory, count, sizeof(*state->map));
    for (int side = 0; side < SIDE_COUNT; side++)
        for (int d = 0; d < DISTANCE_COUNT; d++) {
            state->sums[side][d] = neph_arena_zeroed(memory, count, sizeof(double));
            for (int c = 0; c < 3; c++)
                state->kept[side][d][c] = neph_arena_zeroed(memory, count, sizeof(float));
        }
}

static enum neph_status init(void *opaque, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag)
{
    struct state *state = opaque;
    state->width_px = first->width_px;
    state->height_px = first->height_px;
    state->display = (struct neph_flip_display){
        .exposure_ev = first->viewing->exposure_ev,
        .tone = (enum neph_flip_tone)settings->values[OPTION_TONE],
    };
    state->wanted_pairs = pairs_wanted(settings);
    allocate(state, first->memory);
    return neph_flip_create(first->viewing->pixels_per_degree, first->memory, &state->flip, diag);
}

static bool same_planes(const struct state *state, float *const a[3], const float *const b[3])
{
    for (int c = 0; c < 3; c++)
        if (memcmp(a[c], b[c], pixel_count(state) * sizeof(float)) != 0)
            return false;
    return true;
}

/* Add FLIP between the frame `distance` earlier and this frame, for one side; 0 for equal
 * frames. */
static enum neph_status add_pair(struct state *state, enum side side, int distance,
                                 const float *const planes[3], int frame, struct neph_diag *diag)
{
    float *const *earlier = state->kept[side][(frame - distance) % DISTANCE_COUNT];
    if (same_planes(state, earlier, planes))
        return NEPH_OK;
    enum neph_status status = neph_flip_map(state->flip, state->width_px, state->height_px,
                                            (const float *const *)earlier, planes, &state->display,
                                            1, state->map, diag);
    double *sum = state->sums[side][distance - 1];
    for (size_t i = 0; i < pixel_count(state) && !status; i++)
        sum[i] += state->map[i];
    return status;
}

static enum neph_status extract(void *opaque, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    struct state *state = opaque;
    const float *const *planes[SIDE_COUNT] = {pair->reference, pair->test};
    for (int distance = 1; distance <= DISTANCE_COUNT; distance++) {
        if (pair->frame < distance || state->pairs[distance - 1] == state->wanted_pairs)
            continue;
        for (int side = 0; side < SIDE_COUNT; side++) {
            enum neph_status status = add_pair(state, side, distance, planes[side], pair->frame,
                                               diag);
            if (status)
                return status;
        }
        state->pairs[distance - 1]++;
    }
    for (int side = 0; side < SIDE_COUNT; side++)
        for (int c = 0; c < 3; c++)
            memcpy(state->kept[side][pair->frame % DISTANCE_COUNT][c], planes[side][c],
                   pixel_count(state) * sizeof(float));
    return NEPH_OK;
}

enum map_index { EXCESS_1, EXCESS_2, REFERENCE_1, REFERENCE_2, MAP_COUNT };

static const struct {
    int distance_index;
    double test, reference; /* signs */
} map_terms[MAP_COUNT] = {
    [EXCESS_1] = {0, 1.0, -1.0},
    [EXCESS_2] = {1, 1.0, -1.0},
    [REFERENCE_1] = {0, 0.0, 1.0},
    [REFERENCE_2] = {1, 0.0, 1.0},
};

static void rows(const void *opaque, int map, int first_row, int row_count, double *const values[3])
{
    const struct state *state = opaque;
    const int d = map_terms[map].distance_index;
    const size_t first = (size_t)first_row * (size_t)state->width_px;
    const size_t count = (size_t)row_count * (size_t)state->width_px;
    const double *test = state->sums[TEST][d] + first;
    const double *reference = state->sums[REFERENCE][d] + first;
    const double scale = state->pairs[d] == state->wanted_pairs ? 1.0 / state->wanted_pairs : NAN;
    for (size_t i = 0; i < count; i++)
        values[0][i] = scale *
                       (map_terms[map].test * test[i] + map_terms[map].reference * reference[i]);
}

#define METRIC(name, low, pool, share, map, help)                                                  \
    {                                                                                              \
        "flip_alternation_" name, "1", low, 1.0, pool, share, map, 0, help                         \
    }

static const struct neph_metric metrics[] = {
    METRIC("1_mean", -1.0, NEPH_POOL_MEAN, 0.0, EXCESS_1,
           "mean of FLIP(frame t, t + 1) over whole cycles, minus the reference's"),
    METRIC("1_p95", -1.0, NEPH_POOL_PERCENTILE, 0.95, EXCESS_1, "its 95th percentile"),
    METRIC("1_p99", -1.0, NEPH_POOL_PERCENTILE, 0.99, EXCESS_1, "its 99th percentile"),
    METRIC("1_max", -1.0, NEPH_POOL_MAX, 0.0, EXCESS_1, "its largest value"),
    METRIC("1_reference_mean", 0.0, NEPH_POOL_MEAN, 0.0, REFERENCE_1,
           "mean of the reference's own FLIP(frame t, t + 1)"),
    METRIC("2_mean", -1.0, NEPH_POOL_MEAN, 0.0, EXCESS_2,
           "mean of FLIP(frame t, t + 2) over whole cycles, minus the reference's"),
    METRIC("2_p95", -1.0, NEPH_POOL_PERCENTILE, 0.95, EXCESS_2, "its 95th percentile"),
    METRIC("2_p99", -1.0, NEPH_POOL_PERCENTILE, 0.99, EXCESS_2, "its 99th percentile"),
    METRIC("2_max", -1.0, NEPH_POOL_MAX, 0.0, EXCESS_2, "its largest value"),
    METRIC("2_reference_mean", 0.0, NEPH_POOL_MEAN, 0.0, REFERENCE_2,
           "mean of the reference's own FLIP(frame t, t + 2)"),
    {0},
};

static const struct neph_map maps[MAP_COUNT] = {
    [EXCESS_1] = {"flip_alternation_1", "1", 1, true, 1.0, TOO_SHORT, 0},
    [EXCESS_2] = {"flip_alternation_2", "1", 1, true, 1.0, TOO_SHORT, 0},
    [REFERENCE_1] = {NULL, "1", 1, false, 1.0, TOO_SHORT, 0},
    [REFERENCE_2] = {NULL, "1", 1, false, 1.0, TOO_SHORT, 0},
};

const struct neph_extractor neph_extractor_flip_alternation = {
    .name = "flip_alternation",
    .help = "LDR-FLIP between frames 1 and 2 apart, minus the reference's",
    .source = "Andersson et al. 2020, FLIP: A Difference Evaluator for Alternating Images (HPG), "
              "over the phases of a cycle of 4 frames",
    .quantities = NEPH_RADIANCE,
    .temporal = true,
    .costly = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = MAP_COUNT,
    .state_size = sizeof(struct state),
    .obstacle = obstacle,
    .bound = neph_bound_is_white,
    .init = init,
    .extract = extract,
    .rows = rows,
};
