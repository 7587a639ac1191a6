/* SPDX-License-Identifier: MIT
 *
 * LDR-FLIP as two extractors: at the recorded viewing distance, and at the distance of a desk.
 */
#include "metrics/extractors/extractors.h"
#include "metrics/extractors/flip.h"

#include <string.h>

struct state {
    struct neph_flip *flip;
    struct neph_flip_display display;
    int width_px, height_px;
    double *map;
};

enum option_index { OPTION_TONE };

static const struct neph_option options[] = {
    [OPTION_TONE] = {"tone", NEPH_OPTION_CHOICE, NEPH_FLIP_NONE, 0.0, 0.0, neph_flip_tones,
                     "tone curve between exposure and the clamp to the display's range"},
    {0},
};

static enum neph_status start(struct state *state, const struct neph_frame_pair *first,
                              double pixels_per_degree, const struct neph_settings *settings,
                              struct neph_diag *diag)
{
    state->width_px = first->width_px;
    state->height_px = first->height_px;
    state->display = (struct neph_flip_display){
        .exposure_ev = first->viewing->exposure_ev,
        .tone = (enum neph_flip_tone)settings->values[OPTION_TONE],
    };
    state->map = neph_arena_zeroed(
        first->memory, (size_t)first->width_px * (size_t)first->height_px, sizeof(*state->map));
    return neph_flip_create(pixels_per_degree, first->memory, &state->flip, diag);
}

static enum neph_status init(void *state, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag)
{
    return start(state, first, first->viewing->pixels_per_degree, settings, diag);
}

static enum neph_status init_desk(void *state, const struct neph_frame_pair *first,
                                  const struct neph_settings *settings, struct neph_diag *diag)
{
    return start(state, first, 40.0, settings, diag);
}

static enum neph_status extract(void *opaque, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    struct state *state = opaque;
    return neph_flip_map(state->flip, pair->width_px, pair->height_px, pair->reference, pair->test,
                         &state->display, 1, state->map, diag);
}

static void rows(const void *opaque, int map, int first_row, int row_count, double *const values[3])
{
    (void)map;
    const struct state *state = opaque;
    const size_t width = (size_t)state->width_px;
    memcpy(values[0], state->map + (size_t)first_row * width,
           (size_t)row_count * width * sizeof(*state->map));
}

#define SOURCE                                                                                     \
    "Andersson et al. 2020, FLIP: A Difference Evaluator for Alternating Images (HPG); "           \
    "constants of NVlabs/flip 1.6"

/* The metrics of both; only the names differ. */
/* clang-format off */
#define METRIC(prefix, name, pool, share, help, at) \
    {prefix name, "1", 0.0, 1.0, pool, share, 0, 0, help at}
#define METRICS(prefix, at) { \
    METRIC(prefix, "_mean", NEPH_POOL_MEAN, 0.0, "mean of LDR-FLIP", at), \
    METRIC(prefix, "_wmedian", NEPH_POOL_WEIGHTED_PERCENTILE, 0.5, \
           "median of LDR-FLIP weighted by itself", at), \
    METRIC(prefix, "_wq1", NEPH_POOL_WEIGHTED_PERCENTILE, 0.25, \
           "first quartile of LDR-FLIP weighted by itself", at), \
    METRIC(prefix, "_wq3", NEPH_POOL_WEIGHTED_PERCENTILE, 0.75, \
           "third quartile of LDR-FLIP weighted by itself", at), \
    METRIC(prefix, "_p95", NEPH_POOL_PERCENTILE, 0.95, "95th percentile of LDR-FLIP", at), \
    METRIC(prefix, "_p99", NEPH_POOL_PERCENTILE, 0.99, "99th percentile of LDR-FLIP", at), \
    METRIC(prefix, "_max", NEPH_POOL_MAX, 0.0, "largest LDR-FLIP", at), \
    {0}}
/* clang-format on */

static const struct neph_metric metrics[] = METRICS("flip", ", pixels per degree as viewed");
static const struct neph_metric desk_metrics[] = METRICS("flip40", ", 40 pixels per degree");

static const struct neph_map maps[] = {
    {.name = "flip", .unit = "1", .plane_count = 1, .scale = 1.0}};
static const struct neph_map desk_maps[] = {
    {.name = "flip40", .unit = "1", .plane_count = 1, .scale = 1.0}};

const struct neph_extractor neph_extractor_flip = {
    .name = "flip",
    .help = "LDR-FLIP of the exposed images: the visible difference when they alternate",
    .source = SOURCE,
    .quantities = NEPH_RADIANCE,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = 1,
    .state_size = sizeof(struct state),
    .bound = neph_bound_is_white,
    .init = init,
    .extract = extract,
    .rows = rows,
};

const struct neph_extractor neph_extractor_flip40 = {
    .name = "flip40",
    .help = "LDR-FLIP at 40 pixels per degree, a desk monitor",
    .source = SOURCE,
    .quantities = NEPH_RADIANCE,
    .costly = true,
    .options = options,
    .metrics = desk_metrics,
    .maps = desk_maps,
    .map_count = 1,
    .state_size = sizeof(struct state),
    .bound = neph_bound_is_white,
    .init = init_desk,
    .extract = extract,
    .rows = rows,
};
