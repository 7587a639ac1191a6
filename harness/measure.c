/* SPDX-License-Identifier: MIT */
#include "harness/measure.h"

#include "metrics/error.h"
#include "metrics/mask.h"
#include "metrics/validity.h"

#include <string.h>

static enum neph_status append(json_t *list, json_t *item, struct neph_diag *diag)
{
    return item && json_array_append_new(list, item) == 0 ? NEPH_OK : neph_fail_memory(diag);
}

static json_t *measurement_json(const struct neph_measurement *m)
{
    json_t *interval = m->has_interval ? json_pack("[f,f]", m->low, m->high) : json_null();
    return json_pack("{s:s, s:s, s:s, s:o, s:s, s:o, s:I}", "quantity", m->quantity, "metric",
                     m->metric, "mask", m->mask, "value",
                     m->defined ? json_real(m->value) : json_null(), "unit", m->unit, "interval",
                     interval, "pixel_count", (json_int_t)m->pixel_count);
}

static enum neph_status measure_mask(const struct neph_image *reference,
                                     const struct neph_image *test, const struct neph_mask *mask,
                                     json_t *list, struct neph_diag *diag)
{
    for (int q = 0; q < neph_quantity_count(); q++) {
        const struct neph_quantity *quantity = neph_quantity_at(q);
        const float *planes[3];
        if (!neph_quantity_planes(quantity, reference, planes) ||
            !neph_quantity_planes(quantity, test, planes))
            continue;
        struct neph_measurement measurements[NEPH_ERROR_METRIC_MAX];
        int count = 0;
        enum neph_status status = neph_error_measure(reference, test, quantity->name, mask,
                                                     measurements, &count, diag);
        for (int i = 0; i < count && !status; i++)
            status = append(list, measurement_json(&measurements[i]), diag);
        if (status)
            return status;
    }
    return NEPH_OK;
}

enum neph_status neph_measure(const struct neph_image *reference, const struct neph_image *test,
                              json_t *list, struct neph_diag *diag)
{
    enum neph_status status = neph_validity_same_size(reference, test, diag);
    const size_t pixel_count = neph_image_pixel_count(reference);
    for (int k = 0; k < neph_mask_kind_count() && !status; k++) {
        const struct neph_mask_kind *kind = neph_mask_kind_at(k);
        struct neph_mask *mask = NULL;
        status = neph_mask_create(reference, kind->name, NULL, &mask, diag);
        if (status == NEPH_ERR_UNSUPPORTED) {
            status = NEPH_OK; /* the reference lacks the layer that this mask is made from */
            continue;
        }
        if (status)
            break;
        const bool whole = k == 0;
        if (mask->pixel_count > 0 && (whole || mask->pixel_count < pixel_count))
            status = measure_mask(reference, test, mask, list, diag);
        neph_mask_destroy(mask);
    }
    return status;
}

enum neph_status neph_measure_validity(const struct neph_image *frame, json_t *list,
                                       struct neph_diag *diag)
{
    struct neph_validity validity = {0};
    enum neph_status status = neph_validity_count(frame, &validity, diag);
    const struct {
        const char *metric;
        size_t count;
    } counts[] = {{"non_finite", validity.non_finite_count}, {"negative", validity.negative_count}};
    for (size_t i = 0; i < 2 && !status; i++)
        status = append(list,
                        json_pack("{s:s, s:s, s:s, s:f, s:s, s:n, s:I}", "quantity", "radiance",
                                  "metric", counts[i].metric, "mask", "all", "value",
                                  (double)counts[i].count, "unit", "samples, all layers",
                                  "interval", "pixel_count",
                                  (json_int_t)neph_image_pixel_count(frame)),
                        diag);
    neph_validity_finish(&validity);
    return status;
}

static bool is(const json_t *item, const char *key, const char *text)
{
    const char *value = json_string_value(json_object_get(item, key));
    return value && strcmp(value, text) == 0;
}

const json_t *neph_measurement_find(const json_t *list, const char *quantity, const char *metric,
                                    const char *mask)
{
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *item = json_array_get(list, i);
        if (is(item, "quantity", quantity) && is(item, "metric", metric) && is(item, "mask", mask))
            return item;
    }
    return NULL;
}
