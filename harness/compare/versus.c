/* SPDX-License-Identifier: MIT */
#include "harness/compare/versus.h"

#include "harness/compare/measure.h"
#include "metrics/interval.h"
#include "metrics/series.h"
#include "metrics/significance.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool same_number(const json_t *a, const json_t *b)
{
    static const char *const keys[] = {"quantity", "metric", "mask"};
    for (int k = 0; k < 3; k++)
        if (strcmp(json_string_value(json_object_get(a, keys[k])),
                   json_string_value(json_object_get(b, keys[k]))) != 0)
            return false;
    return true;
}

/* How many numbers the first frame has; every frame has them in the same order, frames first. */
static size_t numbers_per_frame(const json_t *list)
{
    size_t count = 0;
    while (count < json_array_size(list)) {
        const json_t *frame = json_object_get(json_array_get(list, count), "frame");
        if (!frame || json_integer_value(frame) != 0)
            break;
        count++;
    }
    return count;
}

static size_t frame_count_of(const json_t *list, size_t per_frame)
{
    size_t count = 0;
    while (per_frame > 0 && json_object_get(json_array_get(list, count * per_frame), "frame"))
        count++;
    return count;
}

/* The values of one number over the frames; false when a frame has none. */
static bool gather(const json_t *list, size_t which, size_t per_frame, size_t frame_count,
                   double *values)
{
    for (size_t f = 0; f < frame_count; f++) {
        const json_t *value = json_object_get(json_array_get(list, which + f * per_frame), "value");
        if (!json_is_number(value))
            return false;
        values[f] = json_number_value(value);
    }
    return true;
}

static json_t *number_json(const json_t *number, double difference)
{
    return json_pack("{s:O, s:O, s:O, s:O, s:f}", "quantity", json_object_get(number, "quantity"),
                     "metric", json_object_get(number, "metric"), "mask",
                     json_object_get(number, "mask"), "unit", json_object_get(number, "unit"),
                     "difference", difference);
}

static json_t *sure_json(const json_t *number, const struct neph_paired *paired)
{
    const struct neph_mean *mean = &paired->difference;
    const bool has_signs = mean->interval != NEPH_INTERVAL_TILES;
    json_t *item = number_json(number, mean->value);
    neph_json_set(&item, "interval", json_pack("[f,f]", mean->low, mean->high));
    neph_json_set(&item, "interval_kind", json_string(neph_interval_name(mean->interval)));
    neph_json_set(&item, "n", json_integer(mean->n));
    neph_json_set(&item, "p", json_real(paired->p));
    neph_json_set(&item, "p_sign", has_signs ? json_real(paired->p_sign) : json_null());
    return item;
}

static json_t *unsure_json(const json_t *number, double difference, int n, const char *because)
{
    json_t *item = number_json(number, difference);
    neph_json_set(&item, "interval", json_null());
    neph_json_set(&item, "interval_kind", json_string(neph_interval_name(NEPH_INTERVAL_NONE)));
    neph_json_set(&item, "n", json_integer(n));
    neph_json_set(&item, "p", json_null());
    neph_json_set(&item, "p_sign", json_null());
    neph_json_set(&item, "because", json_string(because));
    return item;
}

static json_t *paired_json(const json_t *number, const struct neph_paired *paired)
{
    const struct neph_mean *mean = &paired->difference;
    char because[128];
    if (mean->interval != NEPH_INTERVAL_NONE)
        return sure_json(number, paired);
    snprintf(because, sizeof(because),
             "%d frames are too few: intervals and p-values of a mean need %d, %d batches of whole "
             "cycles",
             mean->n, NEPH_BATCHES_MIN * NEPH_BATCH_FRAMES_FEW, NEPH_BATCHES_MIN);
    return unsure_json(number, mean->value, mean->n, because);
}

/* The measurement behind a number of all frames, or of the only one. */
static const struct neph_measurement *behind(const struct neph_measurements *drawn,
                                             const json_t *number)
{
    for (int i = 0; i < drawn->count; i++) {
        const struct neph_measurement *measured = &drawn->list[i];
        if (strcmp(measured->metric->name, neph_json_text(number, "metric")) == 0 &&
            strcmp(measured->mask, neph_json_text(number, "mask")) == 0 &&
            strcmp(measured->quantity->name, neph_json_text(number, "quantity")) == 0)
            return measured;
    }
    return NULL;
}

/* Two sequences have one pair of such numbers: how sure their difference is, the tiles say. */
static json_t *single_json(const json_t *number, double difference,
                           const struct neph_measurement *first,
                           const struct neph_measurement *second)
{
    const struct neph_draws *of_first = first ? first->draws : NULL;
    const struct neph_draws *of_second = second ? second->draws : NULL;
    if (!of_first || !of_second) {
        char because[128];
        snprintf(
            because, sizeof(because),
            "the number itself has no interval: it is a maximum or of the picture as a whole, or "
            "fewer than %d tiles have a value",
            NEPH_BOOTSTRAP_TILES_MIN);
        return unsure_json(number, difference, 1, because);
    }
    const struct neph_paired paired = neph_series_paired_draws(first->value, of_first,
                                                               second->value, of_second);
    return paired.difference.defined
               ? sure_json(number, &paired)
               : unsure_json(number, difference, 1, "the two have their values in other places");
}

static bool is_of_frames(const json_t *list, size_t per_frame, const json_t *number)
{
    for (size_t i = 0; i < per_frame; i++)
        if (same_number(json_array_get(list, i), number))
            return true;
    return false;
}

/* What is said of all frames and of no single one. */
static enum neph_status subtract_rest(const struct neph_versus_side *first,
                                      const struct neph_versus_side *second, size_t per_frame,
                                      size_t frame_count, json_t *list, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (size_t i = per_frame * frame_count; i < json_array_size(first->numbers) && !status; i++) {
        const json_t *a = json_array_get(first->numbers, i);
        const json_t *b = json_array_get(second->numbers, i);
        const json_t *of_a = json_object_get(a, "value"), *of_b = json_object_get(b, "value");
        if (b && same_number(a, b) && json_is_number(of_a) && json_is_number(of_b) &&
            !is_of_frames(first->numbers, per_frame, a))
            status = neph_json_append(
                list,
                single_json(a, json_number_value(of_a) - json_number_value(of_b),
                            behind(first->drawn, a), behind(second->drawn, a)),
                diag);
    }
    return status;
}

/* Correct the p-values for how many there are. */
static enum neph_status add_holm(json_t *list, struct neph_diag *diag)
{
    const size_t count = json_array_size(list);
    double *p = calloc(2 * count + 1, sizeof(*p));
    if (!p)
        return neph_fail_memory(diag);
    int known = 0;
    for (size_t i = 0; i < count; i++) {
        const json_t *value = json_object_get(json_array_get(list, i), "p");
        if (json_is_number(value))
            p[known++] = json_number_value(value);
    }
    neph_holm(p, known, p + count);
    known = 0;
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < count && !status; i++) {
        json_t *item = json_array_get(list, i);
        const bool has_p = json_is_number(json_object_get(item, "p"));
        status = neph_json_put(item, "p_holm",
                               has_p ? json_real(p[count + (size_t)known]) : json_null(), diag);
        known += has_p;
    }
    free(p);
    return status;
}

static enum neph_status pair_all(const json_t *first, const json_t *second, size_t per_frame,
                                 size_t frame_count, json_t *list, struct neph_diag *diag)
{
    double *a = malloc(2 * frame_count * sizeof(*a));
    if (!a)
        return neph_fail_memory(diag);
    double *b = a + frame_count;
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < per_frame && !status; i++) {
        const json_t *number = json_array_get(first, i);
        struct neph_paired paired;
        if (!same_number(number, json_array_get(second, i)) ||
            !gather(first, i, per_frame, frame_count, a) ||
            !gather(second, i, per_frame, frame_count, b))
            continue;
        status = neph_series_paired(a, b, (int)frame_count, NEPH_REPLICATE_FRAMES, &paired, diag);
        if (!status)
            status = neph_json_append(list, paired_json(number, &paired), diag);
    }
    free(a);
    return status;
}

json_t *neph_versus(const struct neph_versus_side *first, const struct neph_versus_side *second,
                    struct neph_diag *diag)
{
    const json_t *a = first->numbers, *b = second->numbers;
    size_t per_frame = numbers_per_frame(a), frame_count = frame_count_of(a, per_frame);
    if (frame_count == 1) /* no series */
        per_frame = frame_count = 0;
    json_t *list = json_array();
    enum neph_status status = list ? NEPH_OK : neph_fail_memory(diag);
    if (!status && frame_count > 0 && numbers_per_frame(b) == per_frame &&
        frame_count_of(b, per_frame) == frame_count)
        status = pair_all(a, b, per_frame, frame_count, list, diag);
    if (!status)
        status = subtract_rest(first, second, per_frame, frame_count, list, diag);
    if (!status)
        status = add_holm(list, diag);
    if (!status)
        return list;
    json_decref(list);
    return NULL;
}
