/* SPDX-License-Identifier: MIT */
#include "harness/compare/measure.h"

#include "metrics/extractors/extractors.h"
#include "metrics/validity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_BOUND_COUNT == 3, "a new kind");
_Static_assert(NEPH_INTERVAL_KIND_COUNT == 5, "a new kind");

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

bool neph_interval_is_bounded(enum neph_interval_kind kind)
{
    return kind != NEPH_INTERVAL_NONE && kind != NEPH_INTERVAL_DETERMINISTIC;
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

json_t *neph_clipped_json(const struct neph_clipped *clipped)
{
    return json_pack("{s:s, s:f, s:f}", "above", neph_bound_name(clipped->bound), "reference",
                     clipped->reference, "test", clipped->test);
}

json_t *neph_measurement_json(const struct neph_measurement *m)
{
    json_t *item = json_pack(
        "{s:s, s:s, s:s, s:o, s:s, s:o, s:s, s:i, s:I}", "quantity", m->quantity->name, "metric",
        m->metric->name, "mask", m->mask, "value", m->defined ? json_real(m->value) : json_null(),
        "unit", m->unit, "interval",
        neph_interval_is_bounded(m->interval) ? json_pack("[f,f]", m->low, m->high) : json_null(),
        "interval_kind", neph_interval_name(m->interval), "n", m->n, "pixel_count",
        (json_int_t)m->pixel_count);
    if (!m->defined)
        neph_json_set(&item, "undefined_because", json_string(m->undefined_because));
    if (m->clipped.bound != NEPH_BOUND_NONE)
        neph_json_set(&item, "clipped", neph_clipped_json(&m->clipped));
    if (m->frame >= 0)
        neph_json_set(&item, "frame", json_integer(m->frame));
    return item;
}

json_t *neph_measurements_json(const struct neph_measurements *list)
{
    json_t *json = json_array();
    for (int i = 0; i < list->count; i++)
        neph_json_add(&json, neph_measurement_json(&list->list[i]));
    return json;
}

/* ---- masks ----------------------------------------------------------------------------------- */

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
    /* The layer behind the mask may be missing. */
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

/* ---- numbers --------------------------------------------------------------------------------- */

void neph_measurements_finish(struct neph_measurements *measurements)
{
    neph_measurements_destroy(measurements->list, measurements->count);
    *measurements = (struct neph_measurements){0};
}

void neph_measurements_select(struct neph_measurements *measurements,
                              bool (*is_wanted)(const struct neph_measurement *number,
                                                const void *context),
                              const void *context)
{
    int kept = 0;
    for (int i = 0; i < measurements->count; i++) {
        const struct neph_measurement *number = &measurements->list[i];
        if (is_wanted(number, context))
            measurements->list[kept++] = *number;
        else
            free((void *)(uintptr_t)number->draws);
    }
    measurements->count = kept;
}

static enum neph_status append(const struct neph_measurement *more, int count,
                               struct neph_measurements *list, struct neph_diag *diag)
{
    struct neph_measurement *longer = realloc(list->list,
                                              (size_t)(list->count + count) * sizeof(*longer));
    if (!longer)
        return neph_fail_memory(diag);
    memcpy(longer + list->count, more, (size_t)count * sizeof(*more));
    list->list = longer;
    list->count += count;
    return NEPH_OK;
}

static enum neph_status take(struct neph_meter *meter, const struct neph_image *reference,
                             const struct neph_image *test, struct neph_measurements *list,
                             struct neph_diag *diag)
{
    const enum neph_status status = neph_meter_frame(meter, reference, NULL, test, diag);
    int count = 0;
    const struct neph_measurement *all = neph_meter_measurements(meter, &count);
    return status || count == 0 ? status : append(all, count, list, diag);
}

/* Choose extractors with default options; returns their number. */
static int choose(const char *only, struct neph_meter_choice choices[NEPH_CHOICES_MAX])
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
                              const char *only, const struct neph_viewing *viewing,
                              struct neph_measurements *list, struct neph_diag *diag)
{
    enum neph_status status = neph_validity_same_size(reference, test, diag);
    if (status)
        return status;
    struct neph_mask *masks[NEPH_MASKS_MAX];
    struct neph_meter_choice choices[NEPH_CHOICES_MAX];
    struct neph_meter_params params = {.choices = choices,
                                       .choice_count = choose(only, choices),
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

/* Counts over all layers of a frame. They belong to no extractor, because they are taken before any
 * extractor runs. */
static const struct neph_metric non_finite = {.name = "non_finite",
                                              .unit = "samples, all layers",
                                              .high = INFINITY,
                                              .help = "values that are NaN or infinite"};
static const struct neph_metric negative = {
    .name = "negative", .unit = "samples, all layers", .high = INFINITY, .help = "values below 0"};

static struct neph_measurement make_count_measurement(const struct neph_metric *metric,
                                                      size_t count, const struct neph_image *frame)
{
    return (struct neph_measurement){.metric = metric,
                                     .quantity = neph_quantity_find("radiance"),
                                     .unit = metric->unit,
                                     .mask = "all",
                                     .frame = -1,
                                     .defined = true,
                                     .value = (double)count,
                                     .interval = NEPH_INTERVAL_DETERMINISTIC,
                                     .n = 1,
                                     .pixel_count = neph_image_pixel_count(frame)};
}

enum neph_status neph_measure_validity(const struct neph_image *frame,
                                       struct neph_measurements *list, struct neph_diag *diag)
{
    struct neph_validity validity = {0};
    enum neph_status status = neph_validity_count(frame, &validity, diag);
    const struct neph_measurement counts[] = {
        make_count_measurement(&non_finite, validity.non_finite_count, frame),
        make_count_measurement(&negative, validity.negative_count, frame)};
    if (!status)
        status = append(counts, 2, list, diag);
    neph_validity_finish(&validity);
    return status;
}

json_t *neph_metric_json(const struct neph_metric *metric)
{
    return json_pack("{s:s, s:s}", "name", metric->name, "help", metric->help);
}

json_t *neph_measured_metrics_json(void)
{
    struct neph_meter_choice choices[NEPH_CHOICES_MAX];
    const int count = choose(NULL, choices);
    json_t *list = json_array();
    for (int i = 0; i < count; i++)
        for (const struct neph_metric *m = choices[i].extractor->metrics; m->name; m++)
            neph_json_add(&list, neph_metric_json(m));
    neph_json_add(&list, neph_metric_json(&non_finite));
    neph_json_add(&list, neph_metric_json(&negative));
    return list;
}

const struct neph_measurement *neph_measurement_find(const struct neph_measurements *list,
                                                     const char *quantity, const char *metric,
                                                     const char *mask)
{
    for (int i = list->count - 1; i >= 0; i--) {
        const struct neph_measurement *found = &list->list[i];
        if (strcmp(found->metric->name, metric) == 0 && strcmp(found->mask, mask) == 0 &&
            strcmp(found->quantity->name, quantity) == 0)
            return found;
    }
    return NULL;
}
