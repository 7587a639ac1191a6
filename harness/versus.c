/* SPDX-License-Identifier: MIT */
#include "harness/versus.h"

#include "harness/measure.h"
#include "metrics/series.h"
#include "metrics/significance.h"

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

static json_t *paired_json(const json_t *number, const struct neph_paired *paired)
{
    const struct neph_mean *mean = &paired->difference;
    const bool bounded = mean->interval != NEPH_INTERVAL_NONE;
    return json_pack("{s:O, s:O, s:O, s:O, s:f, s:o, s:s, s:i, s:f, s:f}", "quantity",
                     json_object_get(number, "quantity"), "metric",
                     json_object_get(number, "metric"), "mask", json_object_get(number, "mask"),
                     "unit", json_object_get(number, "unit"), "difference", mean->value, "interval",
                     bounded ? json_pack("[f,f]", mean->low, mean->high) : json_null(),
                     "interval_kind", neph_interval_name(mean->interval), "n", mean->n, "p",
                     paired->p, "p_sign", paired->p_sign);
}

/* A number of the whole sequence: two sequences have one pair of them, and no interval. */
static json_t *unpaired_json(const json_t *number, double difference)
{
    return json_pack("{s:O, s:O, s:O, s:O, s:f, s:n, s:s, s:i, s:n, s:n, s:n}", "quantity",
                     json_object_get(number, "quantity"), "metric",
                     json_object_get(number, "metric"), "mask", json_object_get(number, "mask"),
                     "unit", json_object_get(number, "unit"), "difference", difference, "interval",
                     "interval_kind", neph_interval_name(NEPH_INTERVAL_NONE), "n", 1, "p", "p_sign",
                     "p_holm");
}

static bool is_of_frames(const json_t *list, size_t per_frame, const json_t *number)
{
    for (size_t i = 0; i < per_frame; i++)
        if (same_number(json_array_get(list, i), number))
            return true;
    return false;
}

/* What is said of all frames and of no single one. */
static enum neph_status subtract_rest(const json_t *first, const json_t *second, size_t per_frame,
                                      size_t frame_count, json_t *list, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (size_t i = per_frame * frame_count; i < json_array_size(first) && !status; i++) {
        const json_t *a = json_array_get(first, i), *b = json_array_get(second, i);
        const json_t *of_a = json_object_get(a, "value"), *of_b = json_object_get(b, "value");
        if (b && same_number(a, b) && json_is_number(of_a) && json_is_number(of_b) &&
            !is_of_frames(first, per_frame, a))
            status = neph_json_append(
                list, unpaired_json(a, json_number_value(of_a) - json_number_value(of_b)), diag);
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
    for (size_t i = 0; i < count; i++)
        p[i] = json_number_value(json_object_get(json_array_get(list, i), "p"));
    neph_holm(p, (int)count, p + count);
    enum neph_status status = NEPH_OK;
    for (size_t i = 0; i < count && !status; i++)
        status = neph_json_put(json_array_get(list, i), "p_holm", json_real(p[count + i]), diag);
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

json_t *neph_versus(const json_t *first, const json_t *second, struct neph_diag *diag)
{
    const size_t per_frame = numbers_per_frame(first);
    const size_t frame_count = frame_count_of(first, per_frame);
    json_t *list = json_array();
    enum neph_status status = list ? NEPH_OK : neph_fail_memory(diag);
    if (!status && frame_count > 0 && numbers_per_frame(second) == per_frame &&
        frame_count_of(second, per_frame) == frame_count)
        status = pair_all(first, second, per_frame, frame_count, list, diag);
    if (!status)
        status = add_holm(list, diag);
    if (!status)
        status = subtract_rest(first, second, per_frame, frame_count, list, diag);
    if (!status)
        return list;
    json_decref(list);
    return NULL;
}
