/* SPDX-License-Identifier: MIT
 *
 * HDR-FLIP: for each pixel the largest LDR-FLIP over a range of exposures. By the published rule,
 * the range depends only on the reference: from the exposure that maps its brightest pixel to 0.85
 * of the display, to the exposure that maps its median there.
 *
 * Two deviations, both visible in the recorded exposures. The median of a night sky is 0, for which
 * the rule has no range (NVlabs/flip 1.6 then reports a difference of 0): the median is then taken
 * over the positive luminances. And the range of the first frame is used for the whole sequence,
 * because numbers at different exposures are not comparable.
 */
#include "metrics/extractors/extractors.h"
#include "metrics/extractors/flip.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct exposures {
    double start_ev, stop_ev;
    int count;
};

struct state {
    struct neph_flip *flip;
    struct exposures exposures;
    struct neph_flip_display *displays; /* one for each exposure */
    int width_px;
    double *map;
};

enum option_index { OPTION_TONE, OPTION_START, OPTION_STOP, OPTION_COUNT };

static const struct neph_option options[] = {
    [OPTION_TONE] = {"tone", NEPH_OPTION_CHOICE, NEPH_FLIP_ACES, 0.0, 0.0, neph_flip_tones,
                     "tone curve at each exposure; none: only a clamp"},
    [OPTION_START] = {"start_ev", NEPH_OPTION_REAL, NAN, -200.0, 200.0, NULL,
                      "first exposure [EV]; auto, as for the last: by the published rule"},
    [OPTION_STOP] = {"stop_ev", NEPH_OPTION_REAL, NAN, -200.0, 200.0, NULL,
                     "last exposure [EV], above the first"},
    [OPTION_COUNT] = {"exposures", NEPH_OPTION_INTEGER, 0.0, 0.0, 256.0, NULL,
                      "how many, evenly from first to last; 0: max(2, ceil(stop - start))"},
    {0},
};

/* The display value to which the rule maps the brightest and the median luminance. */
static const double anchor = 0.85;

/* ---- the range ------------------------------------------------------------------------------- */

static bool is_given(const struct neph_settings *settings)
{
    return !isnan(settings->values[OPTION_START]) && !isnan(settings->values[OPTION_STOP]);
}

static size_t pixel_count(const struct neph_frame_pair *pair)
{
    return (size_t)pair->width_px * (size_t)pair->height_px;
}

static const char *obstacle(const struct neph_frame_pair *first,
                            const struct neph_settings *settings)
{
    if (is_given(settings))
        return settings->values[OPTION_START] < settings->values[OPTION_STOP]
                   ? NULL
                   : "start_ev is not below stop_ev";
    for (size_t i = 0; i < pixel_count(first); i++)
        if (neph_luminance_at(first->reference, i) > 0.0 &&
            isfinite(neph_luminance_at(first->reference, i)))
            return NULL;
    return "the reference has no positive luminance to choose exposures by; give start_ev and "
           "stop_ev";
}

/* Statistics of the finite luminances for the rule; other pixels are ignored. */
struct census {
    size_t count, positive_count;
    double largest;
};

static struct census take_census(const struct neph_frame_pair *pair)
{
    struct census census = {.largest = -INFINITY};
    for (size_t i = 0; i < pixel_count(pair); i++) {
        const double luminance = neph_luminance_at(pair->reference, i);
        if (!isfinite(luminance))
            continue;
        census.count++;
        census.positive_count += luminance > 0.0;
        census.largest = luminance > census.largest ? luminance : census.largest;
    }
    return census;
}

enum { DIGIT_BITS = 16, DIGIT_VALUES = 1 << DIGIT_BITS };

/* An unsigned integer with the same order as the doubles. */
static uint64_t key_of(double value)
{
    const uint64_t bits = neph_bits_of(value);
    return bits >> 63 ? ~bits : bits | 0x8000000000000000u;
}

static double value_of(uint64_t key)
{
    return neph_of_bits(key >> 63 ? key ^ 0x8000000000000000u : ~key);
}

/* The finite luminance at a rank in ascending order, found digit by digit: each pass over the
 * image counts the luminances that start with the digits found so far. `counts` has
 * DIGIT_VALUES entries. */
static double luminance_of_rank(const struct neph_frame_pair *pair, size_t rank, size_t *counts)
{
    uint64_t key = 0;
    for (int shift = 64 - DIGIT_BITS; shift >= 0; shift -= DIGIT_BITS) {
        const uint64_t known = shift == 64 - DIGIT_BITS ? 0 : UINT64_MAX << (shift + DIGIT_BITS);
        memset(counts, 0, DIGIT_VALUES * sizeof(*counts));
        for (size_t i = 0; i < pixel_count(pair); i++) {
            const double luminance = neph_luminance_at(pair->reference, i);
            const uint64_t candidate = key_of(luminance);
            if (isfinite(luminance) && (candidate & known) == key)
                counts[candidate >> shift & (DIGIT_VALUES - 1)]++;
        }
        uint64_t digit = 0;
        for (; rank >= counts[digit]; digit++)
            rank -= counts[digit];
        key |= digit << shift;
    }
    return value_of(key);
}

/* The range by the rule. The median is element n / 2 of n sorted values, over all pixels, or, if
 * that is not positive, over the positive ones, of which there is at least one. */
static enum neph_status range_by_rule(const struct neph_frame_pair *pair, enum neph_flip_tone tone,
                                      struct exposures *range, struct neph_diag *diag)
{
    size_t *counts = malloc(DIGIT_VALUES * sizeof(*counts));
    if (!counts)
        return neph_fail_memory(diag);
    const struct census census = take_census(pair);
    const size_t first_positive = census.count - census.positive_count;
    const size_t middle = first_positive > census.count / 2
                              ? first_positive + census.positive_count / 2
                              : census.count / 2;
    const double bright = neph_flip_tone_inverse(tone, anchor);
    range->start_ev = log2(bright / census.largest);
    range->stop_ev = log2(bright / luminance_of_rank(pair, middle, counts));
    free(counts);
    return NEPH_OK;
}

static enum neph_status choose_exposures(const struct neph_frame_pair *pair,
                                         enum neph_flip_tone tone,
                                         const struct neph_settings *settings,
                                         struct exposures *range, struct neph_diag *diag)
{
    if (!is_given(settings)) {
        enum neph_status status = range_by_rule(pair, tone, range, diag);
        if (status)
            return status;
    }
    const double start_ev = settings->values[OPTION_START], stop_ev = settings->values[OPTION_STOP];
    range->start_ev = isnan(start_ev) ? range->start_ev : start_ev;
    range->stop_ev = isnan(stop_ev) ? range->stop_ev : stop_ev;
    if (!is_given(settings) && range->start_ev > range->stop_ev)
        return neph_fail(
            diag, NEPH_ERR_INPUT,
            "hdr_flip: the exposures go from %g EV down to %g EV, one of which is by the "
            "published rule: give both",
            range->start_ev, range->stop_ev);
    range->count = (int)settings->values[OPTION_COUNT];
    if (range->count == 0)
        range->count = (int)fmax(2.0, ceil(range->stop_ev - range->start_ev));
    return NEPH_OK;
}

/* ---- the extractor --------------------------------------------------------------------------- */

static double exposure_at(const struct exposures *range, int index)
{
    const double step_ev = range->count > 1
                               ? (range->stop_ev - range->start_ev) / (range->count - 1)
                               : 0.0;
    return range->start_ev + step_ev * index;
}

static enum neph_status init(void *opaque, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag)
{
    struct state *state = opaque;
    const enum neph_flip_tone tone = (enum neph_flip_tone)settings->values[OPTION_TONE];
    state->width_px = first->width_px;
    enum neph_status status = choose_exposures(first, tone, settings, &state->exposures, diag);
    if (status)
        return status;
    state->displays = neph_arena_zeroed(first->memory, (size_t)state->exposures.count,
                                        sizeof(*state->displays));
    state->map = neph_arena_zeroed(first->memory, pixel_count(first), sizeof(*state->map));
    for (int i = 0; state->displays && i < state->exposures.count; i++)
        state->displays[i] = (struct neph_flip_display){exposure_at(&state->exposures, i), tone};
    return neph_flip_create(first->viewing->pixels_per_degree, first->memory, &state->flip, diag);
}

static enum neph_status extract(void *opaque, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    struct state *state = opaque;
    return neph_flip_map(state->flip, pair->width_px, pair->height_px, pair->reference, pair->test,
                         state->displays, state->exposures.count, state->map, diag);
}

static void rows(const void *opaque, int map, int first_row, int row_count, double *const values[3])
{
    (void)map;
    const struct state *state = opaque;
    const size_t width = (size_t)state->width_px;
    memcpy(values[0], state->map + (size_t)first_row * width,
           (size_t)row_count * width * sizeof(*state->map));
}

enum scalar { SCALAR_START, SCALAR_STOP, SCALAR_COUNT };

static const char *scalar(const void *opaque, int which, double *value)
{
    const struct exposures *range = &((const struct state *)opaque)->exposures;
    const double values[] = {
        [SCALAR_START] = range->start_ev,
        [SCALAR_STOP] = range->stop_ev,
        [SCALAR_COUNT] = range->count,
    };
    *value = values[which];
    return NULL;
}

static const struct neph_metric metrics[] = {
    {"hdr_flip_mean", "1", 0.0, 1.0, NEPH_POOL_MEAN, 0.0, 0, 0, "mean of HDR-FLIP"},
    {"hdr_flip_wmedian", "1", 0.0, 1.0, NEPH_POOL_WEIGHTED_PERCENTILE, 0.5, 0, 0,
     "median of HDR-FLIP weighted by itself"},
    {"hdr_flip_wq1", "1", 0.0, 1.0, NEPH_POOL_WEIGHTED_PERCENTILE, 0.25, 0, 0,
     "first quartile of HDR-FLIP weighted by itself"},
    {"hdr_flip_wq3", "1", 0.0, 1.0, NEPH_POOL_WEIGHTED_PERCENTILE, 0.75, 0, 0,
     "third quartile of HDR-FLIP weighted by itself"},
    {"hdr_flip_p95", "1", 0.0, 1.0, NEPH_POOL_PERCENTILE, 0.95, 0, 0,
     "95th percentile of HDR-FLIP"},
    {"hdr_flip_p99", "1", 0.0, 1.0, NEPH_POOL_PERCENTILE, 0.99, 0, 0,
     "99th percentile of HDR-FLIP"},
    {"hdr_flip_max", "1", 0.0, 1.0, NEPH_POOL_MAX, 0.0, 0, 0, "largest HDR-FLIP"},
    {"hdr_flip_start_ev", "EV", -INFINITY, INFINITY, NEPH_POOL_SCALAR, 0.0, SCALAR_START, 0,
     "first exposure: log2(x / largest luminance of the first reference), tone(x) = 0.85"},
    {"hdr_flip_stop_ev", "EV", -INFINITY, INFINITY, NEPH_POOL_SCALAR, 0.0, SCALAR_STOP, 0,
     "last exposure: log2(x / median luminance), of the positive ones if the median is not"},
    {"hdr_flip_exposures", "1", 1.0, INFINITY, NEPH_POOL_SCALAR, 0.0, SCALAR_COUNT, 0,
     "how many exposures from first to last"},
    {0},
};

static const struct neph_map maps[] = {
    {.name = "hdr_flip", .unit = "1", .plane_count = 1, .scale = 1.0},
};

const struct neph_extractor neph_extractor_hdr_flip = {
    .name = "hdr_flip",
    .help = "HDR-FLIP: largest LDR-FLIP over exposures frozen at the first reference",
    .source = "Andersson et al. 2021, Visualizing Errors in Rendered High Dynamic Range Images "
              "(EG); constants of NVlabs/flip 1.6",
    .quantities = NEPH_RADIANCE,
    .costly = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = 1,
    .state_size = sizeof(struct state),
    .obstacle = obstacle,
    .init = init,
    .extract = extract,
    .rows = rows,
    .scalar = scalar,
};
