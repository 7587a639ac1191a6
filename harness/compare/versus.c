/* SPDX-License-Identifier: MIT */
#include "harness/compare/versus.h"

#include "metrics/interval.h"
#include "metrics/series.h"
#include "metrics/significance.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_INTERVAL_KIND_COUNT == 5, "a new kind");

/* Both tests. Every frame has the same numbers in the same order; numbers of all frames follow. */
struct sides {
    const struct neph_measurements *first, *second;
    int per_frame, frame_count; /* both 0 without a series */
};

/* Prefixes of metrics that are positions, indices or counts of frames. */
static const char *const places[] = {
    "worst_tile_x",   "worst_tile_y",     "worst_tile_period",  "seen_hz",        "seen_period",
    "seen_frames",    "coherent_hz",      "coherent_radius",    "flicker_frames", "cycle_long_",
    "cycle_frames",   "cycle_count",      "cycle_unseparated",  "cycle_overlap",  "follow_period_",
    "hdr_flip_start", "hdr_flip_stop_ev", "hdr_flip_exposures",
};

bool neph_metric_is_place(const struct neph_metric *metric)
{
    for (size_t i = 0; i < sizeof(places) / sizeof(places[0]); i++)
        if (strncmp(places[i], metric->name, strlen(places[i])) == 0)
            return true;
    return false;
}

static bool same_number(const struct neph_measurement *a, const struct neph_measurement *b)
{
    return a->quantity == b->quantity && a->metric == b->metric && strcmp(a->mask, b->mask) == 0;
}

static int numbers_per_frame(const struct neph_measurements *numbers)
{
    int count = 0;
    while (count < numbers->count && numbers->list[count].frame == 0)
        count++;
    return count;
}

static int count_measured_frames(const struct neph_measurements *numbers, int per_frame)
{
    int count = 0;
    while (per_frame > 0 && count * per_frame < numbers->count &&
           numbers->list[count * per_frame].frame >= 0)
        count++;
    return count;
}

/* Collect the values of one number over the frames; false when a frame has none. */
static bool gather(const struct neph_measurements *numbers, const struct sides *sides, int which,
                   double *values)
{
    for (int f = 0; f < sides->frame_count; f++) {
        const struct neph_measurement *number = &numbers->list[which + f * sides->per_frame];
        if (!number->defined)
            return false;
        values[f] = number->value;
    }
    return true;
}

static struct neph_difference make_paired_difference(const struct neph_measurement *number,
                                                     const struct neph_paired *paired)
{
    const struct neph_mean *mean = &paired->difference;
    struct neph_difference made = {.number = number,
                                   .value = mean->value,
                                   .first = number->value,
                                   .second = number->value - mean->value,
                                   .interval = mean->interval,
                                   .n = mean->n,
                                   .p = NAN,
                                   .p_holm = NAN,
                                   .p_sign = NAN};
    if (mean->interval == NEPH_INTERVAL_NONE)
        return made;
    made.low = mean->low;
    made.high = mean->high;
    made.p = paired->p;
    if (mean->interval != NEPH_INTERVAL_TILES)
        made.p_sign = paired->p_sign;
    return made;
}

static struct neph_difference make_series_difference(const struct neph_measurement *number,
                                                     const struct neph_paired *paired)
{
    struct neph_difference made = make_paired_difference(number, paired);
    if (made.interval == NEPH_INTERVAL_NONE)
        snprintf(made.because, sizeof(made.because),
                 "%d frames are too few: intervals and p-values of a mean need %d, %d batches of "
                 "whole cycles",
                 made.n, NEPH_BATCHES_MIN * NEPH_BATCH_FRAMES_FEW, NEPH_BATCHES_MIN);
    return made;
}

/* The difference of a pair of single numbers; its uncertainty follows from the tiles. */
static struct neph_difference make_single_difference(const struct neph_measurement *first,
                                                     const struct neph_measurement *second)
{
    const struct neph_paired single = {
        .difference = {.value = first->value - second->value, .n = 1}};
    struct neph_difference made = make_paired_difference(first, &single);
    made.second = second->value;
    if (!first->draws || !second->draws) {
        snprintf(made.because, sizeof(made.because),
                 "the number itself has no interval: it is a maximum or a number of the whole "
                 "frame, or fewer than %d tiles have a value",
                 NEPH_BOOTSTRAP_TILES_MIN);
        return made;
    }
    const struct neph_paired paired = neph_series_paired_draws(first->value, first->draws,
                                                               second->value, second->draws);
    if (paired.difference.defined) {
        made = make_paired_difference(first, &paired);
        made.second = second->value;
        return made;
    }
    snprintf(made.because, sizeof(made.because), "the two have their values in other places");
    return made;
}

static bool is_frame_number(const struct sides *sides, const struct neph_measurement *number)
{
    for (int i = 0; i < sides->per_frame; i++)
        if (same_number(&sides->first->list[i], number))
            return true;
    return false;
}

/* Add the differences of the numbers that exist only for all frames together. */
static void subtract_single_numbers(const struct sides *sides, struct neph_differences *out)
{
    for (int i = sides->per_frame * sides->frame_count;
         i < sides->first->count && i < sides->second->count; i++) {
        const struct neph_measurement *a = &sides->first->list[i], *b = &sides->second->list[i];
        if (same_number(a, b) && a->defined && b->defined && !is_frame_number(sides, a) &&
            !neph_metric_is_place(a->metric))
            out->list[out->count++] = make_single_difference(a, b);
    }
}

static void count_sides(const double *a, const double *b, int count, int *below, int *above)
{
    *below = *above = 0;
    for (int i = 0; i < count; i++) {
        *below += a[i] < b[i];
        *above += a[i] > b[i];
    }
}

static enum neph_status subtract_series(const struct sides *sides, double *values,
                                        struct neph_differences *out, struct neph_diag *diag)
{
    double *a = values, *b = values + sides->frame_count;
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < sides->per_frame && !status; i++) {
        const struct neph_measurement *number = &sides->first->list[i];
        struct neph_paired paired;
        if (!same_number(number, &sides->second->list[i]) || neph_metric_is_place(number->metric) ||
            !gather(sides->first, sides, i, a) || !gather(sides->second, sides, i, b))
            continue;
        status = neph_series_paired(a, b, sides->frame_count, NEPH_REPLICATE_FRAMES, &paired, diag);
        if (status)
            break;
        struct neph_difference *made = &out->list[out->count++];
        *made = make_series_difference(number, &paired);
        made->first = neph_series_mean(a, sides->frame_count, NEPH_REPLICATE_FRAMES).value;
        made->second = neph_series_mean(b, sides->frame_count, NEPH_REPLICATE_FRAMES).value;
        made->frame_count = sides->frame_count;
        count_sides(a, b, sides->frame_count, &made->frames_below, &made->frames_above);
    }
    return status;
}

/* Correct the p-values for their number. `room` has space for twice that number. */
static void add_holm(struct neph_differences *out, double *room)
{
    double *p = room, *corrected = room + out->count;
    int known = 0;
    for (int i = 0; i < out->count; i++)
        if (!isnan(out->list[i].p))
            p[known++] = out->list[i].p;
    neph_holm(p, known, corrected);
    known = 0;
    for (int i = 0; i < out->count; i++)
        if (!isnan(out->list[i].p))
            out->list[i].p_holm = corrected[known++];
}

enum neph_status neph_versus(const struct neph_measurements *first,
                             const struct neph_measurements *second,
                             struct neph_differences *differences, struct neph_diag *diag)
{
    struct sides sides = {first, second, numbers_per_frame(first), 0};
    sides.frame_count = count_measured_frames(first, sides.per_frame);
    if (sides.frame_count == 1)
        sides.per_frame = sides.frame_count = 0;
    const bool is_series = sides.frame_count > 0 && numbers_per_frame(second) == sides.per_frame &&
                           count_measured_frames(second, sides.per_frame) == sides.frame_count;
    double *room = calloc(2 * (size_t)(first->count + sides.frame_count) + 1, sizeof(*room));
    *differences = (struct neph_differences){
        .list = calloc((size_t)first->count + 1, sizeof(*differences->list))};
    enum neph_status status = room && differences->list ? NEPH_OK : neph_fail_memory(diag);
    if (!status && is_series)
        status = subtract_series(&sides, room, differences, diag);
    if (!status) {
        subtract_single_numbers(&sides, differences);
        add_holm(differences, room);
    }
    free(room);
    return status;
}

/* ---- over time ------------------------------------------------------------------------------- */

/* Sign test over groups of `unit_values` values, which are a cycle. For sequences too short for an
 * interval of the mean. */
static double sign_p(const double *a, const double *b, int count, int unit_values)
{
    int below = 0, above = 0;
    for (int first = 0; first + unit_values <= count; first += unit_values) {
        double sum = 0.0;
        for (int i = 0; i < unit_values; i++)
            sum += a[first + i] - b[first + i];
        below += sum < 0.0;
        above += sum > 0.0;
    }
    return neph_sign_p(above, below);
}

/* Pair two series; each value covers `frames_each` frames. */
static enum neph_status pair_series(const double *a, const double *b, int count, int frames_each,
                                    struct neph_time_difference *made, struct neph_diag *diag)
{
    const size_t frames = (size_t)(count * frames_each);
    double *wide = calloc(2 * frames + 1, sizeof(*wide));
    struct neph_paired paired;
    if (!wide)
        return neph_fail_memory(diag);
    for (size_t f = 0; f < frames; f++) {
        wide[f] = a[f / (size_t)frames_each];
        wide[frames + f] = b[f / (size_t)frames_each];
    }
    const enum neph_status status = neph_series_paired(wide, wide + frames, (int)frames,
                                                       NEPH_REPLICATE_FRAMES, &paired, diag);
    free(wide);
    if (status)
        return status;
    *made = (struct neph_time_difference){.count = count, .value = paired.difference.value};
    made->p = paired.difference.interval == NEPH_INTERVAL_CYCLES
                  ? paired.p
                  : sign_p(a, b, count, NEPH_MOVEMENT_CYCLE / frames_each);
    count_sides(a, b, count, &made->below, &made->above);
    return NEPH_OK;
}

enum neph_status neph_versus_add_movement(const struct neph_movement *first,
                                          const struct neph_movement *second,
                                          struct neph_differences *differences,
                                          struct neph_diag *diag)
{
    const int frame_count = first->frame_count;
    if (frame_count == 0 || second->frame_count != frame_count)
        return NEPH_OK;
    const enum neph_status status = pair_series(first->frames, second->frames, frame_count, 1,
                                                &differences->frames, diag);
    return status ? status
                  : pair_series(first->cycles, second->cycles, frame_count / NEPH_MOVEMENT_CYCLE,
                                NEPH_MOVEMENT_CYCLE, &differences->cycles, diag);
}

void neph_differences_finish(struct neph_differences *differences)
{
    free(differences->list);
    *differences = (struct neph_differences){0};
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *difference_json(const struct neph_difference *difference)
{
    const struct neph_measurement *number = difference->number;
    const bool is_sure = difference->interval != NEPH_INTERVAL_NONE;
    json_t *json = json_pack(
        "{s:s, s:s, s:s, s:s, s:f, s:f, s:f, s:o, s:s, s:i, s:o, s:o}", "quantity",
        number->quantity->name, "metric", number->metric->name, "mask", number->mask, "unit",
        number->unit, "test", difference->first, "other", difference->second, "difference",
        difference->value, "interval",
        is_sure ? json_pack("[f,f]", difference->low, difference->high) : json_null(),
        "interval_kind", neph_interval_name(difference->interval), "n", difference->n, "p",
        neph_json_number(difference->p), "p_sign", neph_json_number(difference->p_sign));
    if (!is_sure)
        neph_json_set(&json, "because", json_string(difference->because));
    if (difference->frame_count > 0)
        neph_json_set(&json, "frames",
                      json_pack("{s:i, s:i, s:i}", "count", difference->frame_count, "lower",
                                difference->frames_below, "higher", difference->frames_above));
    neph_json_set(&json, "p_holm", neph_json_number(difference->p_holm));
    return json;
}

json_t *neph_differences_json(const struct neph_differences *differences)
{
    json_t *json = json_array();
    for (int i = 0; i < differences->count; i++)
        neph_json_add(&json, difference_json(&differences->list[i]));
    return json;
}

static json_t *time_difference_json(const struct neph_time_difference *made)
{
    return made->count == 0
               ? json_null()
               : json_pack("{s:i, s:i, s:i, s:o, s:o}", "count", made->count, "lower", made->below,
                           "higher", made->above, "difference", neph_json_number(made->value), "p",
                           neph_json_number(made->p));
}

json_t *neph_time_differences_json(const struct neph_differences *differences)
{
    return json_pack("{s:o, s:o}", "frames", time_difference_json(&differences->frames), "cycles",
                     time_difference_json(&differences->cycles));
}
