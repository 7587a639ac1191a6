/* SPDX-License-Identifier: MIT */
#include "harness/measure.h"

#include "metrics/validity.h"

#include <string.h>

static enum neph_status append(json_t *list, json_t *item, struct neph_diag *diag)
{
    return item && json_array_append_new(list, item) == 0 ? NEPH_OK : neph_fail_memory(diag);
}

static const char *const interval_names[] = {
    [NEPH_INTERVAL_NONE] = "none",
    [NEPH_INTERVAL_DETERMINISTIC] = "deterministic",
    [NEPH_INTERVAL_TILES] = "bootstrap over tiles",
    [NEPH_INTERVAL_CYCLES] = "batch means over whole cycles",
};

json_t *neph_measurement_json(const struct neph_measurement *m, const struct neph_viewing *viewing)
{
    const bool bounded = m->interval == NEPH_INTERVAL_TILES || m->interval == NEPH_INTERVAL_CYCLES;
    json_t *item = json_pack(
        "{s:s, s:s, s:s, s:o, s:s, s:o, s:s, s:i, s:I, s:s?, s:{s:f, s:f, s:f, s:f}}", "quantity",
        m->quantity->name, "metric", m->metric->name, "mask", m->mask, "value",
        m->defined ? json_real(m->value) : json_null(), "unit", m->unit, "interval",
        bounded ? json_pack("[f,f]", m->low, m->high) : json_null(), "interval_kind",
        interval_names[m->interval], "n", m->n, "pixel_count", (json_int_t)m->pixel_count,
        "undefined_because", m->undefined_because, "viewing", "frame_rate_hz",
        viewing->frame_rate_hz, "pixels_per_degree", viewing->pixels_per_degree, "exposure_ev",
        viewing->exposure_ev, "white_cd_per_m2", viewing->white_cd_per_m2);
    if (item && m->frame >= 0)
        json_object_set_new(item, "frame", json_integer(m->frame));
    return item;
}

void neph_masks_destroy(struct neph_mask **masks, int count)
{
    for (int i = 0; i < count; i++)
        neph_mask_destroy(masks[i]);
}

/* Keep the mask `name` when it says more than the whole image does. */
static enum neph_status add_mask(const struct neph_image *reference, const char *name,
                                 struct neph_mask *masks[NEPH_MASKS_MAX], int *count,
                                 struct neph_diag *diag)
{
    struct neph_mask *mask = NULL;
    enum neph_status status = neph_mask_create(reference, name, NULL, &mask, diag);
    if (status == NEPH_ERR_UNSUPPORTED) /* the layer that it is made from is not there */
        return NEPH_OK;
    if (status)
        return status;
    const bool says_more = mask->pixel_count > 0 &&
                           mask->pixel_count < neph_image_pixel_count(reference);
    if ((*count == 0 || says_more) && *count < NEPH_MASKS_MAX)
        masks[(*count)++] = mask;
    else
        neph_mask_destroy(mask);
    return NEPH_OK;
}

enum neph_status neph_masks_of(const struct neph_image *reference,
                               struct neph_mask *masks[NEPH_MASKS_MAX], int *count,
                               struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    const char *name;
    *count = 0;
    for (int k = 0; k < neph_mask_kind_count() && !status; k++)
        if (!neph_mask_kind_at(k)->is_detail)
            status = add_mask(reference, neph_mask_kind_at(k)->name, masks, count, diag);
    for (int i = 0; !status && (name = neph_mask_channel_at(reference, i)); i++)
        if (!neph_mask_kind_find(name)) /* else it is there already */
            status = add_mask(reference, name, masks, count, diag);
    if (status)
        neph_masks_destroy(masks, *count);
    return status;
}

static enum neph_status take(struct neph_meter *meter, const struct neph_image *reference,
                             const struct neph_image *test, const struct neph_viewing *viewing,
                             json_t *list, struct neph_diag *diag)
{
    enum neph_status status = neph_meter_frame(meter, reference, NULL, test, diag);
    int count = 0;
    const struct neph_measurement *all = neph_meter_measurements(meter, &count);
    for (int i = 0; i < count && !status; i++)
        status = append(list, neph_measurement_json(&all[i], viewing), diag);
    return status;
}

int neph_measure_usual(const char *only, struct neph_meter_choice *choices)
{
    int count = 0;
    for (int i = 0; i < neph_extractor_count(); i++) {
        const struct neph_extractor *extractor = neph_extractor_at(i);
        if (only ? strcmp(extractor->name, only) == 0 : !extractor->costly && !extractor->temporal)
            choices[count++] = (struct neph_meter_choice){extractor,
                                                          neph_options_default(extractor->options)};
    }
    return count;
}

enum neph_status neph_measure(const struct neph_image *reference, const struct neph_image *test,
                              const char *only, const struct neph_viewing *viewing, json_t *list,
                              struct neph_diag *diag)
{
    enum neph_status status = neph_validity_same_size(reference, test, diag);
    if (status)
        return status;
    struct neph_mask *masks[NEPH_MASKS_MAX];
    struct neph_meter_choice choices[NEPH_CHOICES_MAX];
    struct neph_meter_params params = {.choices = choices,
                                       .choice_count = neph_measure_usual(only, choices),
                                       .viewing = *viewing,
                                       .masks = (const struct neph_mask *const *)masks,
                                       .intervals = true};
    status = neph_masks_of(reference, masks, &params.mask_count, diag);
    if (status)
        return status;
    struct neph_meter *meter = NULL;
    status = neph_meter_create(&params, &meter, diag);
    if (!status)
        status = take(meter, reference, test, viewing, list, diag);
    neph_meter_destroy(meter);
    neph_masks_destroy(masks, params.mask_count);
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
