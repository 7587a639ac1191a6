/* SPDX-License-Identifier: MIT */
#include "metrics/meter.h"

#include "metrics/clipping.h"
#include "metrics/extractors/pair_codes.h"
#include "metrics/interval.h"
#include "metrics/pooling.h"
#include "metrics/series.h"
#include "metrics/validity.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_INTERVAL_KIND_COUNT == 5, "a new kind");
_Static_assert(NEPH_POOL_COUNT == 16, "a new kind");

/* A chosen extractor on one quantity. */
struct run {
    const struct neph_meter_choice *choice;
    const struct neph_quantity *quantity;
    const char *obstacle; /* why it gives no numbers; NULL: it does */
    char reason[192];     /* buffer for an obstacle found during the run */
    void *state;          /* NULL with an obstacle */
    struct neph_arena memory;
};

struct neph_meter {
    struct neph_arena memory; /* owns all that is not marked as owned or borrowed */
    struct neph_meter_choice *choices;
    int choice_count;
    struct neph_viewing viewing;
    struct neph_pool_mask *masks; /* the masks themselves are borrowed */
    int mask_count;
    const struct neph_meter_number *wanted; /* borrowed; NULL: all */
    bool intervals, draws;

    int width_px, height_px;   /* size of the first frame; 0 before it */
    int frame_count;           /* so far */
    int announced_frame_count; /* total number; 0: unknown */
    struct run *runs;          /* created at the first frame */
    int run_count;
    struct neph_pair_codes *codes;         /* one for each quantity */
    const struct neph_mask **bare_masks;   /* the masks of `masks` */
    struct neph_clipping **clipping;       /* by quantity; NULL where no metric needs it */
    struct neph_measurement *measurements; /* owned */
    int measurement_count, measurement_room;
};

bool neph_meter_is_wanted(const struct neph_meter_number *wanted, const char *metric,
                          const char *mask)
{
    for (const struct neph_meter_number *one = wanted; one && one->metric; one++)
        if ((!metric || strcmp(one->metric, metric) == 0) &&
            (!mask || strcmp(one->mask, mask) == 0))
            return true;
    return !wanted;
}

/* ---- set-up
 * ------------------------------------------------------------------------------------ */

static enum neph_status check_viewing(const struct neph_viewing *viewing, struct neph_diag *diag)
{
    const struct {
        const char *what;
        double value, least, most;
    } conditions[] = {
        {"the frame rate [Hz]", viewing->frame_rate_hz, 1.0, 1000.0},
        {"the pixels per degree", viewing->pixels_per_degree, 1.0, 500.0},
        {"the exposure [EV]", viewing->exposure_ev, -64.0, 64.0},
        {"the white [cd/m2]", viewing->white_cd_per_m2, 0.1, 1e5},
    };
    for (size_t i = 0; i < sizeof(conditions) / sizeof(conditions[0]); i++)
        if (!(conditions[i].value >= conditions[i].least &&
              conditions[i].value <= conditions[i].most))
            return neph_fail(diag, NEPH_ERR_INPUT, "%s must be in %g..%g, not %g",
                             conditions[i].what, conditions[i].least, conditions[i].most,
                             conditions[i].value);
    return NEPH_OK;
}

static enum neph_status copy_params(struct neph_meter *meter,
                                    const struct neph_meter_params *params, struct neph_diag *diag)
{
    meter->viewing = params->viewing;
    meter->wanted = params->wanted;
    meter->intervals = params->intervals;
    meter->draws = params->draws;
    meter->announced_frame_count = params->frame_count;
    const size_t choice_count = (size_t)params->choice_count,
                 mask_count = (size_t)params->mask_count;
    const size_t quantity_count = (size_t)neph_quantity_count();
    struct neph_arena *memory = &meter->memory;
    meter->choices = neph_arena_allocate(memory, choice_count, sizeof(*meter->choices));
    meter->masks = neph_arena_allocate(memory, mask_count, sizeof(*meter->masks));
    meter->codes = neph_arena_allocate(memory, quantity_count, sizeof(*meter->codes));
    meter->clipping = neph_arena_allocate(memory, quantity_count, sizeof(*meter->clipping));
    meter->bare_masks = neph_arena_allocate(memory, mask_count, sizeof(*meter->bare_masks));
    enum neph_status status = neph_arena_check(memory, diag);
    for (int i = 0; i < params->choice_count && !status; i++)
        meter->choices[meter->choice_count++] = params->choices[i];
    for (size_t q = 0; q < quantity_count && !status; q++)
        meter->codes[q].memory = memory;
    for (int i = 0; i < params->mask_count && !status; i++) {
        meter->bare_masks[i] = params->masks[i];
        status = neph_pool_mask_create(params->masks[i], memory, &meter->masks[i], diag);
        meter->mask_count += !status;
    }
    return status;
}

enum neph_status neph_meter_create(const struct neph_meter_params *params,
                                   struct neph_meter **meter, struct neph_diag *diag)
{
    enum neph_status status = check_viewing(&params->viewing, diag);
    if (status)
        return status;
    struct neph_meter *created = calloc(1, sizeof(*created));
    if (!created)
        return neph_fail_memory(diag);
    status = copy_params(created, params, diag);
    if (status) {
        neph_meter_destroy(created);
        return status;
    }
    *meter = created;
    return NEPH_OK;
}

static void end_luma(struct neph_meter *meter)
{
    for (int q = 0; meter->codes && q < neph_quantity_count(); q++)
        neph_pair_luma_end(&meter->codes[q]);
}

void neph_meter_destroy(struct neph_meter *meter)
{
    if (!meter)
        return;
    for (int i = 0; i < meter->run_count; i++) {
        struct run *run = &meter->runs[i];
        if (run->state && run->choice->extractor->close)
            run->choice->extractor->close(run->state);
        neph_arena_finish(&run->memory);
    }
    end_luma(meter);
    for (int i = 0; i < meter->mask_count; i++)
        neph_resampling_finish(&meter->masks[i].resampling);
    neph_arena_finish(&meter->memory);
    neph_measurements_destroy(meter->measurements, meter->measurement_count);
    free(meter);
}

/* Free the draws of the measurements from `first` on. */
static void drop_draws(struct neph_measurement *measurements, int first, int count)
{
    for (int i = first; i < count; i++)
        free((void *)(uintptr_t)measurements[i].draws);
}

void neph_measurements_destroy(struct neph_measurement *measurements, int count)
{
    drop_draws(measurements, 0, measurements ? count : 0);
    free(measurements);
}

struct neph_measurement *neph_meter_release(struct neph_meter *meter, int *count)
{
    struct neph_measurement *released = meter->measurements;
    *count = meter->measurement_count;
    meter->measurements = NULL;
    meter->measurement_count = meter->measurement_room = 0;
    return released;
}

/* ---- a pair of frames ------------------------------------------------------------------------ */

static bool pair_up(const struct neph_meter *meter, const struct neph_quantity *quantity,
                    const struct neph_image *const images[3], struct neph_frame_pair *pair)
{
    *pair = (struct neph_frame_pair){
        .quantity = quantity,
        .width_px = images[0]->width_px,
        .height_px = images[0]->height_px,
        .plane_count = quantity->plane_count,
        .reference_image = images[0],
        .test_image = images[2],
        .frame = meter->frame_count,
        .frame_count = meter->announced_frame_count,
        .viewing = &meter->viewing,
    };
    if (!neph_quantity_planes(quantity, images[0], pair->reference) ||
        !neph_quantity_planes(quantity, images[2], pair->test))
        return false;
    if (images[1])
        neph_quantity_planes(quantity, images[1], pair->reference_second);
    pair->scene_mean = neph_quantity_mean(quantity, pair->reference, pair->width_px,
                                          pair->height_px);
    pair->codes = &meter->codes[quantity - neph_quantity_at(0)];
    neph_pair_codes_forget(pair->codes);
    return true;
}

static bool is_good(const struct neph_frame_pair *pair, size_t pixel)
{
    const bool is_depth = pair->quantity->bit == NEPH_DEPTH;
    bool good = true;
    for (int p = 0; p < pair->plane_count; p++) {
        const float reference = pair->reference[p][pixel], test = pair->test[p][pixel];
        good &= isfinite(reference) || (is_depth && reference == INFINITY);
        good &= isfinite(test) || (is_depth && test == INFINITY);
    }
    return good;
}

/* Whether all samples of a row are finite. If the reference has a finite mean, it is finite
 * everywhere, because other values would show in the sum; but the sky's depth is excluded from that
 * mean. */
static bool row_is_finite(const struct neph_frame_pair *pair, size_t first)
{
    const size_t width = (size_t)pair->width_px;
    const bool is_known = pair->quantity->bit != NEPH_DEPTH && isfinite(pair->scene_mean);
    for (int p = 0; p < pair->plane_count; p++)
        if (neph_count_not_finite(pair->test[p] + first, width) > 0 ||
            (!is_known && neph_count_not_finite(pair->reference[p] + first, width) > 0))
            return false;
    return true;
}

/* Count the bad pixels of each mask; returns the number in the whole frame. */
static size_t count_bad(struct neph_meter *meter, const struct neph_frame_pair *pair, size_t *bad)
{
    size_t all = 0;
    const size_t width = (size_t)pair->width_px, count = width * (size_t)pair->height_px;
    for (size_t first = 0; first < count; first += width) {
        if (row_is_finite(pair, first))
            continue;
        for (size_t i = first; i < first + width; i++) {
            if (is_good(pair, i))
                continue;
            all++;
            for (int m = 0; m < meter->mask_count; m++)
                bad[m] += meter->masks[m].mask->inside[i];
        }
    }
    return all;
}

/* ---- numbers --------------------------------------------------------------------------------- */

static enum neph_status append(struct neph_meter *meter, const struct neph_measurement *measured,
                               struct neph_diag *diag)
{
    if (meter->measurement_count == meter->measurement_room) {
        const int room = meter->measurement_room ? 2 * meter->measurement_room : 64;
        struct neph_measurement *larger = realloc(meter->measurements,
                                                  (size_t)room * sizeof(*larger));
        if (!larger)
            return neph_fail_memory(diag);
        meter->measurements = larger;
        meter->measurement_room = room;
    }
    meter->measurements[meter->measurement_count++] = *measured;
    return NEPH_OK;
}

static struct neph_measurement blank(const struct run *run, const struct neph_metric *metric,
                                     const struct neph_mask *mask, int frame)
{
    struct neph_measurement measured = {
        .metric = metric,
        .quantity = run->quantity,
        .unit = metric->unit ? metric->unit : run->quantity->unit,
        .frame = frame,
        .n = 1,
    };
    snprintf(measured.mask, sizeof(measured.mask), "%s", mask->name);
    return measured;
}

static enum neph_display_bound find_metric_bound(const struct run *run,
                                                 const struct neph_metric *metric)
{
    const struct neph_extractor *extractor = run->choice->extractor;
    return extractor->bound && metric->unit ? extractor->bound(&run->choice->settings)
                                            : NEPH_BOUND_NONE;
}

static struct neph_clipping *find_clipping(const struct neph_meter *meter,
                                           const struct neph_quantity *quantity)
{
    return meter->clipping[quantity - neph_quantity_at(0)];
}

/* Record the clipped shares. If the metric shows no error although the images differ, name clipping
 * as the reason. */
static void note_clipping(const struct neph_meter *meter, const struct run *run, int mask,
                          struct neph_measurement *measured)
{
    const struct neph_clipping *clipping = find_clipping(meter, run->quantity);
    const enum neph_display_bound bound = find_metric_bound(run, measured->metric);
    const bool of_all = measured->frame < 0;
    if (!clipping || bound == NEPH_BOUND_NONE)
        return;
    measured->clipped = neph_clipping_shares(clipping, bound, meter->bare_masks[mask], mask,
                                             of_all);
    if (measured->undefined_because == neph_pool_no_error &&
        neph_clipping_differs(clipping, mask, of_all))
        measured->undefined_because = neph_pool_hidden_error;
}

static enum neph_status append_pooled(struct neph_meter *meter, const struct run *run,
                                      const struct neph_metric *metric, int mask, size_t bad_count,
                                      int frame, const struct neph_pooled *pooled,
                                      struct neph_diag *diag)
{
    struct neph_measurement measured = blank(run, metric, meter->masks[mask].mask, frame);
    measured.defined = pooled->defined;
    measured.undefined_because = pooled->undefined_because;
    measured.value = pooled->value;
    measured.bad_count = bad_count;
    measured.pixel_count = meter->masks[mask].is_bad
                               ? meter->masks[mask].mask->pixel_count - bad_count
                               : pooled->pixel_count;
    if (pooled->has_interval) {
        measured.interval = NEPH_INTERVAL_TILES;
        measured.low = pooled->low;
        measured.high = pooled->high;
        measured.n = pooled->tile_count;
    }
    measured.draws = pooled->draws;
    note_clipping(meter, run, mask, &measured);
    return append(meter, &measured, diag);
}

static bool map_applies(const struct neph_map *map, const struct neph_quantity *quantity)
{
    return map->quantities == 0 || (map->quantities & (unsigned)quantity->bit) != 0;
}

static struct neph_pool_source make_pool_source(const struct neph_meter *meter,
                                                const struct run *run, int map)
{
    const struct neph_extractor *extractor = run->choice->extractor;
    const int planes = extractor->maps[map].plane_count;
    return (struct neph_pool_source){
        .rows = extractor->rows,
        .state = run->state,
        .width_px = meter->width_px,
        .height_px = meter->height_px,
        .plane_count = planes ? planes : run->quantity->plane_count,
        .empty_because = extractor->empty ? extractor->empty(run->state, map)
                                          : extractor->maps[map].empty_because,
    };
}

static int count_metrics(const struct neph_extractor *extractor)
{
    int count = 0;
    while (extractor->metrics[count].name)
        count++;
    return count;
}

static enum neph_pool_certainty choose_certainty(const struct neph_meter *meter, int frame)
{
    const bool is_final = frame < 0 || meter->announced_frame_count == 1;
    if (!meter->intervals)
        return NEPH_POOL_NUMBER_ALONE;
    return meter->draws && is_final ? NEPH_POOL_DRAWS : NEPH_POOL_INTERVAL;
}

/* Pool one map; `numbers` has a row of mask_count for each metric of the extractor. */
static enum neph_status pool_one_map(const struct neph_meter *meter, const struct run *run, int map,
                                     int frame, struct neph_pooled *numbers, struct neph_diag *diag)
{
    const struct neph_metric *all = run->choice->extractor->metrics, *some[NEPH_POOL_METRICS_MAX];
    int count = 0, index[NEPH_POOL_METRICS_MAX];
    for (int m = 0; all[m].name && count < NEPH_POOL_METRICS_MAX; m++)
        if (all[m].map == map && all[m].pool != NEPH_POOL_SCALAR &&
            neph_meter_is_wanted(meter->wanted, all[m].name, NULL)) {
            index[count] = m;
            some[count++] = &all[m];
        }
    if (count == 0 || !map_applies(&run->choice->extractor->maps[map], run->quantity))
        return NEPH_OK;
    struct neph_pooled *pooled = calloc((size_t)(count * meter->mask_count), sizeof(*pooled));
    if (!pooled)
        return neph_fail_memory(diag);
    const struct neph_pool_source source = make_pool_source(meter, run, map);
    const enum neph_status status = neph_pool_map(&source, some, count, meter->masks,
                                                  meter->mask_count, choose_certainty(meter, frame),
                                                  pooled, diag);
    for (int k = 0; k < meter->mask_count; k++)
        for (int m = 0; m < count; m++)
            numbers[index[m] * meter->mask_count + k] = pooled[k * count + m];
    free(pooled);
    return status;
}

/* Append the numbers mask by mask, in the order of the extractor's table. */
static enum neph_status take_pooled(struct neph_meter *meter, const struct run *run,
                                    const size_t *bad, int frame, struct neph_diag *diag)
{
    const struct neph_extractor *extractor = run->choice->extractor;
    const int metric_count = count_metrics(extractor), mask_count = meter->mask_count;
    struct neph_pooled *numbers = calloc((size_t)(metric_count * mask_count) + 1, sizeof(*numbers));
    enum neph_status status = numbers ? NEPH_OK : neph_fail_memory(diag);
    for (int map = 0; map < extractor->map_count && !status; map++)
        status = pool_one_map(meter, run, map, frame, numbers, diag);
    for (int k = 0; k < mask_count && !status; k++)
        for (int m = 0; m < metric_count && !status; m++) {
            struct neph_pooled *number = &numbers[m * mask_count + k];
            const bool is_of_quantity = number->defined || number->undefined_because;
            if (!is_of_quantity || !neph_meter_is_wanted(meter->wanted, extractor->metrics[m].name,
                                                         meter->masks[k].mask->name))
                continue;
            status = append_pooled(meter, run, &extractor->metrics[m], k, bad ? bad[k] : 0, frame,
                                   number, diag);
            if (!status)
                number->draws = NULL; /* now owned by the measurement */
        }
    for (int i = 0; numbers && i < metric_count * mask_count; i++)
        free(numbers[i].draws);
    free(numbers);
    return status;
}

static const char bad_frame[] = "a pixel of a frame is not finite";

/* Append the numbers of the whole frame, under the first mask, which is the whole frame. */
static enum neph_status take_scalars(struct neph_meter *meter, const struct run *run, int frame,
                                     struct neph_diag *diag)
{
    enum neph_status status = NEPH_OK;
    for (const struct neph_metric *m = run->choice->extractor->metrics; m->name && !status; m++) {
        if (m->pool != NEPH_POOL_SCALAR ||
            !neph_meter_is_wanted(meter->wanted, m->name, meter->masks[0].mask->name))
            continue;
        struct neph_measurement measured = blank(run, m, meter->masks[0].mask, frame);
        double value = 0.0;
        measured.undefined_because = meter->masks[0].is_bad ? bad_frame
                                                            : run->choice->extractor->scalar(
                                                                  run->state, m->map, &value);
        measured.defined = !measured.undefined_because;
        measured.value = measured.defined ? value : 0.0;
        measured.interval = measured.defined ? NEPH_INTERVAL_DETERMINISTIC : NEPH_INTERVAL_NONE;
        measured.pixel_count = meter->masks[0].mask->pixel_count;
        note_clipping(meter, run, 0, &measured);
        status = append(meter, &measured, diag);
    }
    return status;
}

static enum neph_status take_numbers(struct neph_meter *meter, const struct run *run,
                                     const size_t *bad, int frame, struct neph_diag *diag)
{
    const enum neph_status status = take_pooled(meter, run, bad, frame, diag);
    return status ? status : take_scalars(meter, run, frame, diag);
}

/* ---- the runs -------------------------------------------------------------------------------- */

static enum neph_status start_run(struct run *run, struct neph_frame_pair *pair,
                                  struct neph_diag *diag)
{
    const struct neph_extractor *extractor = run->choice->extractor;
    const struct neph_settings *settings = &run->choice->settings;
    run->obstacle = extractor->obstacle ? extractor->obstacle(pair, settings) : NULL;
    if (run->obstacle)
        return NEPH_OK;
    pair->memory = &run->memory;
    run->state = neph_arena_allocate(&run->memory, 1, extractor->state_size);
    if (!run->state)
        return neph_fail_memory(diag);
    return extractor->init ? extractor->init(run->state, pair, settings, diag) : NEPH_OK;
}

/* Count clipped pixels for quantities with extractors of display values. */
static enum neph_status start_clipping(struct neph_meter *meter, const struct run *run,
                                       struct neph_diag *diag)
{
    struct neph_clipping **clipping = &meter->clipping[run->quantity - neph_quantity_at(0)];
    if (run->obstacle || !run->choice->extractor->bound || *clipping)
        return NEPH_OK;
    *clipping = neph_clipping_create(meter->mask_count, &meter->memory);
    return *clipping ? NEPH_OK : neph_fail_memory(diag);
}

/* At the first frame, create a run for each choice and each quantity that both images have. */
static enum neph_status start_runs(struct neph_meter *meter,
                                   const struct neph_image *const images[3], struct neph_diag *diag)
{
    const size_t room = (size_t)neph_quantity_count() * (size_t)meter->choice_count;
    meter->runs = neph_arena_allocate(&meter->memory, room, sizeof(*meter->runs));
    if (!meter->runs)
        return neph_fail_memory(diag);
    meter->width_px = images[0]->width_px;
    meter->height_px = images[0]->height_px;
    enum neph_status status = NEPH_OK;
    for (int q = 0; q < neph_quantity_count(); q++) {
        const struct neph_quantity *quantity = neph_quantity_at(q);
        struct neph_frame_pair pair;
        if (!pair_up(meter, quantity, images, &pair))
            continue;
        for (int c = 0; c < meter->choice_count && !status; c++) {
            const struct neph_meter_choice *choice = &meter->choices[c];
            if (!(choice->extractor->quantities & (unsigned)quantity->bit))
                continue;
            struct run *run = &meter->runs[meter->run_count++];
            *run = (struct run){.choice = choice, .quantity = quantity};
            status = start_run(run, &pair, diag);
            if (!status)
                status = start_clipping(meter, run, diag);
        }
    }
    return status;
}

static enum neph_status check_sizes(const struct neph_meter *meter,
                                    const struct neph_image *const images[3],
                                    struct neph_diag *diag)
{
    enum neph_status status = neph_validity_same_size(images[0], images[2], diag);
    if (!status && images[1])
        status = neph_validity_same_size(images[0], images[1], diag);
    if (status)
        return status;
    const int width = images[0]->width_px, height = images[0]->height_px;
    if (meter->width_px > 0 && (meter->width_px != width || meter->height_px != height))
        return neph_fail(diag, NEPH_ERR_INPUT, "frame %d is %dx%d pixels, those before %dx%d",
                         meter->frame_count, width, height, meter->width_px, meter->height_px);
    for (int m = 0; m < meter->mask_count; m++) {
        const struct neph_mask *mask = meter->masks[m].mask;
        if (mask->width_px != width || mask->height_px != height)
            return neph_fail(diag, NEPH_ERR_INPUT,
                             "the mask '%s' is %dx%d pixels, the images %dx%d", mask->name,
                             mask->width_px, mask->height_px, width, height);
    }
    return NEPH_OK;
}

/* Process a pair. In a temporal run, an invalid value in an extra layer ends the run, as one in the
 * quantity does.
 */
static enum neph_status extract(struct run *run, struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    pair->memory = &run->memory;
    struct neph_diag found = {.message = ""};
    const enum neph_status status = run->choice->extractor->extract(run->state, pair, &found);
    if (status == NEPH_ERR_GATE && run->choice->extractor->temporal) {
        snprintf(run->reason, sizeof(run->reason), "%s", found.message);
        run->obstacle = run->reason;
        return NEPH_OK;
    }
    if (status && diag)
        *diag = found;
    return status;
}

/* Measure one pair with one extractor. `bad`: bad pixels per mask; `all_bad`: in the frame. */
static enum neph_status measure_run(struct neph_meter *meter, struct run *run,
                                    struct neph_frame_pair *pair, const size_t *bad, size_t all_bad,
                                    struct neph_diag *diag)
{
    const struct neph_extractor *extractor = run->choice->extractor;
    if (run->obstacle)
        return NEPH_OK;
    if (all_bad > 0 && extractor->temporal) {
        run->obstacle = bad_frame; /* the temporal run ends here */
        return NEPH_OK;
    }
    for (int m = 0; m < meter->mask_count; m++)
        meter->masks[m].is_bad = extractor->pointwise ? bad[m] > 0 : all_bad > 0;
    enum neph_status status = NEPH_OK;
    if (extractor->pointwise || all_bad == 0)
        status = extract(run, pair, diag);
    if (!status && !extractor->temporal)
        status = take_numbers(meter, run, bad, pair->frame, diag);
    return status;
}

enum neph_status neph_meter_frame(struct neph_meter *meter, const struct neph_image *reference,
                                  const struct neph_image *reference_second,
                                  const struct neph_image *test, struct neph_diag *diag)
{
    const struct neph_image *const images[3] = {reference, reference_second, test};
    const int count_before = meter->measurement_count;
    enum neph_status status = check_sizes(meter, images, diag);
    if (!status && meter->frame_count == 0)
        status = start_runs(meter, images, diag);
    size_t *bad = calloc((size_t)meter->mask_count + 1, sizeof(*bad));
    if (!status && !bad)
        status = neph_fail_memory(diag);
    const struct neph_quantity *quantity = NULL;
    struct neph_frame_pair pair = {.frame = 0};
    size_t all_bad = 0;
    for (int r = 0; r < meter->run_count && !status; r++) {
        struct run *run = &meter->runs[r];
        if (run->quantity != quantity) { /* runs are grouped by quantity */
            quantity = run->quantity;
            if (!pair_up(meter, quantity, images, &pair)) {
                status = neph_fail(diag, NEPH_ERR_INPUT, "frame %d has no %s, the first one has",
                                   meter->frame_count, quantity->name);
                break;
            }
            memset(bad, 0, (size_t)meter->mask_count * sizeof(*bad));
            all_bad = count_bad(meter, &pair, bad);
            if (find_clipping(meter, quantity))
                neph_clipping_add_frame(find_clipping(meter, quantity), &pair, meter->bare_masks);
        }
        status = measure_run(meter, run, &pair, bad, all_bad, diag);
    }
    free(bad);
    if (status) { /* no partial results of a frame */
        drop_draws(meter->measurements, count_before, meter->measurement_count);
        meter->measurement_count = count_before;
    }
    meter->frame_count += !status;
    return status;
}

/* The mean of number `which` of each frame over all frames; every frame has the same numbers in the
 * same order. It is undefined if it is undefined in any frame: none is skipped. */
static struct neph_measurement mean_over_frames(const struct neph_meter *meter, int which,
                                                int per_frame, double *values)
{
    struct neph_measurement mean = meter->measurements[which];
    mean.frame = -1;
    mean.interval = NEPH_INTERVAL_NONE;
    mean.low = mean.high = 0.0;
    mean.draws = NULL;
    mean.clipped.reference = mean.clipped.test = 0.0;
    for (int f = 0; f < meter->frame_count; f++) {
        const struct neph_measurement *one = &meter->measurements[which + f * per_frame];
        values[f] = one->value;
        mean.clipped.reference += one->clipped.reference / meter->frame_count;
        mean.clipped.test += one->clipped.test / meter->frame_count;
        mean.bad_count = one->bad_count > mean.bad_count ? one->bad_count : mean.bad_count;
        if (mean.defined && !one->defined) {
            mean.defined = false;
            mean.undefined_because = one->undefined_because;
        }
    }
    const struct neph_mean found = neph_series_mean(values, meter->frame_count,
                                                    NEPH_REPLICATE_FRAMES);
    mean.n = found.n;
    mean.value = mean.defined ? found.value : 0.0;
    if (mean.defined && found.interval != NEPH_INTERVAL_NONE) {
        mean.interval = found.interval;
        mean.low = found.low;
        mean.high = found.high;
    }
    return mean;
}

static enum neph_status append_means(struct neph_meter *meter, struct neph_diag *diag)
{
    const int per_frame = meter->frame_count > 0 ? meter->measurement_count / meter->frame_count
                                                 : 0;
    if (meter->frame_count < 2 || per_frame == 0)
        return NEPH_OK;
    double *values = malloc((size_t)meter->frame_count * sizeof(*values));
    enum neph_status status = values ? NEPH_OK : neph_fail_memory(diag);
    for (int i = 0; i < per_frame && !status; i++) {
        const struct neph_measurement mean = mean_over_frames(meter, i, per_frame, values);
        status = append(meter, &mean, diag);
    }
    free(values);
    return status;
}

bool neph_meter_display_luma(const struct neph_meter *meter, const struct neph_quantity *quantity,
                             const double **reference, const double **test)
{
    const struct neph_luma_planes *luma = &meter->codes[quantity - neph_quantity_at(0)].luma;
    *reference = luma->reference;
    *test = luma->test;
    return luma->is_made;
}

enum neph_status neph_meter_finish(struct neph_meter *meter, struct neph_diag *diag)
{
    enum neph_status status = append_means(meter, diag);
    end_luma(meter);
    for (int m = 0; m < meter->mask_count; m++)
        meter->masks[m].is_bad = false;
    for (int r = 0; r < meter->run_count && !status; r++) {
        struct run *run = &meter->runs[r];
        const struct neph_extractor *extractor = run->choice->extractor;
        if (!extractor->temporal || run->obstacle)
            continue;
        status = extractor->flush ? extractor->flush(run->state, diag) : NEPH_OK;
        if (!status)
            status = take_numbers(meter, run, NULL, -1, diag);
    }
    return status;
}

const struct neph_measurement *neph_meter_measurements(const struct neph_meter *meter, int *count)
{
    *count = meter->measurement_count;
    return meter->measurements;
}

/* ---- maps ------------------------------------------------------------------------------------ */

static const struct run *find_run(const struct neph_meter *meter,
                                  const struct neph_quantity *quantity,
                                  const struct neph_extractor *extractor)
{
    for (int r = 0; r < meter->run_count; r++)
        if (meter->runs[r].quantity == quantity && meter->runs[r].choice->extractor == extractor)
            return &meter->runs[r];
    return NULL;
}

bool neph_meter_has_extractor(const struct neph_meter *meter, const struct neph_quantity *quantity,
                              const struct neph_extractor *extractor)
{
    return find_run(meter, quantity, extractor) != NULL;
}

const char *neph_meter_obstacle(const struct neph_meter *meter,
                                const struct neph_quantity *quantity,
                                const struct neph_extractor *extractor)
{
    const struct run *run = find_run(meter, quantity, extractor);
    return run ? run->obstacle : "it is not taken of this quantity here";
}

static enum neph_status add_planes(struct neph_image *image, int plane_count, float *planes[3],
                                   struct neph_diag *diag)
{
    return plane_count == 3 ? neph_image_add_rgb(image, NULL, planes, diag)
                            : neph_image_add_channel(image, "Y", &planes[0], diag);
}

/* Convert to float, clamped to the finite range. NaN stays: no value. */
static float to_float(double value)
{
    return value > (double)FLT_MAX ? FLT_MAX : value < -(double)FLT_MAX ? -FLT_MAX : (float)value;
}

/* Fill row by row, so that no second image in double precision is needed. */
static enum neph_status fill_image(const struct neph_pool_source *source, int map,
                                   float *const planes[3], struct neph_diag *diag)
{
    const size_t width = (size_t)source->width_px;
    double *row = malloc(3 * width * sizeof(*row));
    if (!row)
        return neph_fail_memory(diag);
    double *const values[3] = {row, row + width, row + 2 * width};
    for (int y = 0; y < source->height_px; y++) {
        source->rows(source->state, map, y, 1, values);
        for (int p = 0; p < source->plane_count; p++)
            for (size_t x = 0; x < width; x++)
                planes[p][(size_t)y * width + x] = to_float(values[p][x]);
    }
    free(row);
    return NEPH_OK;
}

enum neph_status neph_meter_map(const struct neph_meter *meter,
                                const struct neph_quantity *quantity,
                                const struct neph_extractor *extractor, int map,
                                struct neph_image **image, struct neph_diag *diag)
{
    const struct run *run = find_run(meter, quantity, extractor);
    if (!run || run->obstacle)
        return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "there is no map of %s: %s", extractor->name,
                         neph_meter_obstacle(meter, quantity, extractor));
    const struct neph_pool_source source = make_pool_source(meter, run, map);
    struct neph_image *created = NULL;
    float *planes[3] = {NULL, NULL, NULL};
    enum neph_status status = neph_image_create(source.width_px, source.height_px, &created, diag);
    if (!status)
        status = add_planes(created, source.plane_count, planes, diag);
    if (!status)
        status = fill_image(&source, map, planes, diag);
    if (status) {
        neph_image_destroy(created);
        return status;
    }
    *image = created;
    return NEPH_OK;
}
