/* SPDX-License-Identifier: MIT
 *
 * HDR-FLIP: the largest LDR-FLIP of a pixel over a range of exposures of both pictures. By the
 * published rule the range comes from the reference alone, from the exposure that brings its
 * brightest pixel to 0.85 of the display to the one that brings its median there.
 *
 * Two departures, both stated in the record by the exposures that were used. The median of a night
 * sky is 0, for which the rule gives no range (NVlabs/flip 1.6 then reports a difference of 0): the
 * median is then taken over the positive luminances. And the range is that of the first frame for
 * the whole sequence, because numbers at other exposures cannot be compared.
 */
#include "metrics/extractors/extractors.h"
#include "metrics/extractors/flip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct exposures {
    double start_ev, stop_ev;
    int count;
};

struct state {
    struct neph_flip *flip;
    enum neph_flip_tone tone;
    struct exposures exposures;
    int width_px;
    double *map;
};

enum option_index { OPTION_TONE, OPTION_START, OPTION_STOP, OPTION_COUNT };

static const struct neph_option options[] = {
    [OPTION_TONE] = {"tone", NEPH_OPTION_CHOICE, NEPH_FLIP_ACES, 0.0, 0.0, neph_flip_tones,
                     "tone curve at each exposure; none: a clamp alone"},
    [OPTION_START] = {"start_ev", NEPH_OPTION_REAL, 0.0, -200.0, 200.0, NULL,
                      "first exposure [EV]; as stop_ev, both 0: by the published rule"},
    [OPTION_STOP] = {"stop_ev", NEPH_OPTION_REAL, 0.0, -200.0, 200.0, NULL,
                     "last exposure [EV], above start_ev"},
    [OPTION_COUNT] = {"exposures", NEPH_OPTION_INTEGER, 0.0, 0.0, 256.0, NULL,
                      "how many, evenly from first to last; 0: max(2, ceil(stop - start))"},
    {0},
};

/* The display value to which the rule brings the brightest and the median luminance. */
static const double anchor = 0.85;

/* ---- the range ------------------------------------------------------------------------------- */

static bool is_given(const struct neph_settings *settings)
{
    return settings->values[OPTION_START] != 0.0 || settings->values[OPTION_STOP] != 0.0;
}

static double luminance_at(const struct neph_frame_pair *pair, size_t i)
{
    return neph_luminance((double)pair->reference[0][i], (double)pair->reference[1][i],
                          (double)pair->reference[2][i]);
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
        if (luminance_at(first, i) > 0.0 && isfinite(luminance_at(first, i)))
            return NULL;
    return "the reference has no positive luminance to choose exposures by; give start_ev and "
           "stop_ev";
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Element n / 2 of n sorted values, over all pixels and, if that is not positive, over the positive
 * ones, of which the caller knows that there are some. Sorts. */
static double median_of(double *luminances, size_t count)
{
    qsort(luminances, count, sizeof(*luminances), compare);
    const double median = luminances[count / 2];
    if (median > 0.0)
        return median;
    size_t first = count / 2;
    while (luminances[first] <= 0.0)
        first++;
    return luminances[first + (count - first) / 2];
}

static enum neph_status range_by_rule(const struct neph_frame_pair *pair, enum neph_flip_tone tone,
                                      struct exposures *range, struct neph_diag *diag)
{
    const size_t count = pixel_count(pair);
    double *luminances = malloc(count * sizeof(*luminances));
    if (!luminances)
        return neph_fail_memory(diag);
    size_t known = 0; /* a bad pixel has no say */
    for (size_t i = 0; i < count; i++) {
        const double luminance = luminance_at(pair, i);
        if (isfinite(luminance))
            luminances[known++] = luminance;
    }
    const double median = median_of(luminances, known);
    const double bright = neph_flip_tone_inverse(tone, anchor);
    range->start_ev = log2(bright / luminances[known - 1]);
    range->stop_ev = log2(bright / median);
    free(luminances);
    return NEPH_OK;
}

static enum neph_status choose_exposures(const struct neph_frame_pair *pair,
                                         enum neph_flip_tone tone,
                                         const struct neph_settings *settings,
                                         struct exposures *range, struct neph_diag *diag)
{
    range->start_ev = settings->values[OPTION_START];
    range->stop_ev = settings->values[OPTION_STOP];
    if (!is_given(settings)) {
        enum neph_status status = range_by_rule(pair, tone, range, diag);
        if (status)
            return status;
    }
    range->count = (int)settings->values[OPTION_COUNT];
    if (range->count == 0)
        range->count = (int)fmax(2.0, ceil(range->stop_ev - range->start_ev));
    return NEPH_OK;
}

/* ---- the extractor --------------------------------------------------------------------------- */

static enum neph_status init(void *opaque, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag)
{
    struct state *state = opaque;
    state->tone = (enum neph_flip_tone)settings->values[OPTION_TONE];
    state->width_px = first->width_px;
    enum neph_status status = choose_exposures(first, state->tone, settings, &state->exposures,
                                               diag);
    if (status)
        return status;
    state->map = calloc(pixel_count(first), sizeof(*state->map));
    if (!state->map)
        return neph_fail_memory(diag);
    return neph_flip_create(first->viewing->pixels_per_degree, &state->flip, diag);
}

static double exposure_at(const struct exposures *range, int index)
{
    const double step_ev = range->count > 1
                               ? (range->stop_ev - range->start_ev) / (range->count - 1)
                               : 0.0;
    return range->start_ev + step_ev * index;
}

static enum neph_status extract(void *opaque, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    struct state *state = opaque;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < state->exposures.count && !status; i++) {
        const struct neph_flip_display display = {exposure_at(&state->exposures, i), state->tone};
        status = neph_flip_map(state->flip, pair->width_px, pair->height_px, pair->reference,
                               pair->test, &display, i > 0, state->map, diag);
    }
    return status;
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

static void stop(void *opaque)
{
    struct state *state = opaque;
    neph_flip_destroy(state->flip);
    free(state->map);
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
    .close = stop,
};
