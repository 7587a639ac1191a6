/* SPDX-License-Identifier: MIT */
#include "harness/compare/measure.h"

#include "metrics/extractors/extractors.h"
#include "metrics/validity.h"

#include <string.h>

static const char *const interval_names[] = {
    [NEPH_INTERVAL_NONE] = "none",
    [NEPH_INTERVAL_DETERMINISTIC] = "deterministic",
    [NEPH_INTERVAL_TILES] = "bootstrap over tiles",
    [NEPH_INTERVAL_CYCLES] = "batch means over whole cycles",
    [NEPH_INTERVAL_RUNS] = "Student's t over runs",
};

const char *neph_interval_name(enum neph_interval_kind kind)
{
    return interval_names[kind];
}

json_t *neph_viewing_json(const struct neph_viewing *viewing)
{
    return json_pack("{s:f, s:f, s:f, s:f}", "frame_rate_hz", viewing->frame_rate_hz,
                     "pixels_per_degree", viewing->pixels_per_degree, "exposure_ev",
                     viewing->exposure_ev, "white_cd_per_m2", viewing->white_cd_per_m2);
}

static const char *const bound_names[NEPH_BOUND_COUNT] = {
    [NEPH_BOUND_WHITE] = "display white",
    [NEPH_BOUND_PU21] = "10000 cd/m2",
};

const char *neph_bound_name(enum neph_display_bound bound)
{
    return bound_names[bound];
}

json_t *neph_measurement_json(const struct neph_measurement *m)
{
    const bool bounded = m->interval != NEPH_INTERVAL_NONE &&
                         m->interval != NEPH_INTERVAL_DETERMINISTIC;
    json_t *item = json_pack(
        "{s:s, s:s, s:s, s:o, s:s, s:o, s:s, s:i, s:I}", "quantity", m->quantity->name, "metric",
        m->metric->name, "mask", m->mask, "value", m->defined ? json_real(m->value) : json_null(),
        "unit", m->unit, "interval", bounded ? json_pack("[f,f]", m->low, m->high) : json_null(),
        "interval_kind", neph_interval_name(m->interval), "n", m->n, "pixel_count",
        (json_int_t)m->pixel_count);
    if (!m->defined)
        neph_json_set(&item, "undefined_because", json_string(m->undefined_because));
    if (m->clipped.bound != NEPH_BOUND_NONE)
        neph_json_set(&item, "clipped",
                      json_pack("{s:s, s:f, s:f}", "above", neph_bound_name(m->clipped.bound),
                                "reference", m->clipped.reference, "test", m->clipped.test));
    if (m->frame >= 0)
        neph_json_set(&item, "frame", json_integer(m->frame));
    return item;
}

bool neph_mask_is_detail(const char *mask)
{
    const struct neph_mask_kind *kind = neph_mask_kind_find(mask);
    return kind && kind->is_detail;
}

void neph_masks_destroy(struct neph_mask **masks, int count)
{
    for (int i = 0; i < count; i++)
        neph_mask_destroy(masks[i]);
}

static enum neph_status add_mask(const struct neph_image *reference, const char *name,
                                 struct neph_mask **masks, int *count, struct neph_diag *diag)
{
    struct neph_mask *mask = NULL;
    if (*count == NEPH_MASKS_MAX)
        return neph_fail(diag, NEPH_ERR_INPUT, "more than %d masks", NEPH_MASKS_MAX);
    const enum neph_status status = neph_mask_create(reference, name, NULL, &mask, diag);
    if (!status)
        masks[(*count)++] = mask;
    /* The layer that it is made from may not be there. */
    return status == NEPH_ERR_UNSUPPORTED ? NEPH_OK : status;
}

enum neph_status neph_masks_create(const struct neph_image *reference, bool details,
                                   struct neph_mask *masks[NEPH_MASKS_MAX], int *count,
                                   struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    *count = 0;
    for (int k = 0; k < neph_mask_kind_count() && !status; k++)
        if (details || !neph_mask_kind_at(k)->is_detail)
            status = add_mask(reference, neph_mask_kind_at(k)->name, masks, count, diag);
    for (int i = 0; neph_mask_channel_at(reference, i) && !status; i++)
        if (!neph_mask_kind_find(neph_mask_channel_at(reference, i)))
            status = add_mask(reference, neph_mask_channel_at(reference, i), masks, count, diag);
    if (status) {
        neph_masks_destroy(masks, *count);
        *count = 0;
    }
    return status;
}

enum neph_status neph_masks_unite(const struct neph_image *reference, struct neph_mask **masks,
                                  int count, struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (int i = 0; i < count && !status; i++) {
        struct neph_mask *more = NULL;
        status = neph_mask_create(reference, masks[i]->name, NULL, &more, diag);
        if (!status)
            status = neph_mask_unite(masks[i], more, diag);
        neph_mask_destroy(more);
        if (status == NEPH_ERR_UNSUPPORTED)
            status = NEPH_OK;
    }
    return status;
}

int neph_masks_trim(struct neph_mask **masks, int count)
{
    int kept = 0;
    for (int i = 0; i < count; i++) {
        const size_t whole = (size_t)masks[i]->width_px * (size_t)masks[i]->height_px;
        if (i == 0 || (masks[i]->pixel_count > 0 && masks[i]->pixel_count < whole))
            masks[kept++] = masks[i];
        else
            neph_mask_destroy(masks[i]);
    }
    return kept;
}

static enum neph_status take(struct neph_meter *meter, const struct neph_image *reference,
                             const struct neph_image *test, json_t *list, struct neph_diag *diag)
{
    enum neph_status status = neph_meter_frame(meter, reference, NULL, test, diag);
    int count = 0;
    const struct neph_measurement *all = neph_meter_measurements(meter, &count);
    for (int i = 0; i < count && !status; i++)
        status = neph_json_append(list, neph_measurement_json(&all[i]), diag);
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
                                       .frame_count = 1,
                                       .intervals = true};
    status = neph_masks_create(reference, false, masks, &params.mask_count, diag);
    if (status)
        return status;
    params.mask_count = neph_masks_trim(masks, params.mask_count);
    struct neph_meter *meter = NULL;
    status = neph_meter_create(&params, &meter, diag);
    if (!status)
        status = take(meter, reference, test, list, diag);
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
        status = neph_json_append(
            list,
            json_pack("{s:s, s:s, s:s, s:f, s:s, s:n, s:s, s:i, s:I}", "quantity", "radiance",
                      "metric", counts[i].metric, "mask", "all", "value", (double)counts[i].count,
                      "unit", "samples, all layers", "interval", "interval_kind",
                      neph_interval_name(NEPH_INTERVAL_DETERMINISTIC), "n", 1, "pixel_count",
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
