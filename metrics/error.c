/* SPDX-License-Identifier: MIT
 *
 * One walk over the mask, tile by tile, gathers numbers that are sums over pixels and numbers that
 * are not. A metric is a function of these; one of sums alone is also what the bootstrap evaluates
 * again and again, so that a value and its interval cannot follow different formulas.
 */
#include "metrics/error.h"

#include "metrics/interval.h"
#include "metrics/statistics.h"
#include "metrics/validity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What the metrics are functions of. NaN marks what is not known. */
enum fact {
    SUM_SAMPLES, /* from here sums over the samples x, with d = test - reference */
    SUM_D,
    SUM_ABS_D,
    SUM_D2,
    SUM_REFERENCE,
    SUM_RELATIVE_D2, /* d^2 / (reference^2 + epsilon) */
    SUM_COUNT,
    MAX_ABS = SUM_COUNT, /* from here what tiles cannot be added up for */
    MAX_REL,
    P50,
    P95,
    P99,
    HIT_MISMATCH,
    FACT_COUNT,
};

/* S in error.h, times these. */
static const double mse_epsilon_share = 0.01;
static const double relative_floor_share = 1e-4;

/* ---- the metrics ----------------------------------------------------------------------------- */

static bool known(double number, double *value)
{
    *value = number;
    return isfinite(number);
}

static bool bias(const double *facts, double *value)
{
    return known(facts[SUM_D] / facts[SUM_SAMPLES], value);
}

static bool rel_bias(const double *facts, double *value)
{
    return facts[SUM_REFERENCE] > 0.0 && known(facts[SUM_D] / facts[SUM_REFERENCE], value);
}

static bool mae(const double *facts, double *value)
{
    return known(facts[SUM_ABS_D] / facts[SUM_SAMPLES], value);
}

static bool rmse(const double *facts, double *value)
{
    return known(sqrt(facts[SUM_D2] / facts[SUM_SAMPLES]), value);
}

static bool rel_rmse(const double *facts, double *value)
{
    return facts[SUM_REFERENCE] > 0.0 && known(sqrt(facts[SUM_D2] / facts[SUM_SAMPLES]) /
                                                   (facts[SUM_REFERENCE] / facts[SUM_SAMPLES]),
                                               value);
}

static bool rel_mse(const double *facts, double *value)
{
    return known(facts[SUM_RELATIVE_D2] / facts[SUM_SAMPLES], value);
}

static bool max_abs(const double *facts, double *value)
{
    return known(facts[MAX_ABS], value);
}

static bool max_rel(const double *facts, double *value)
{
    return known(facts[MAX_REL], value);
}

static bool p50(const double *facts, double *value)
{
    return known(facts[P50], value);
}

static bool p95(const double *facts, double *value)
{
    return known(facts[P95], value);
}

static bool p99(const double *facts, double *value)
{
    return known(facts[P99], value);
}

static bool hit_mismatch(const double *facts, double *value)
{
    return known(facts[HIT_MISMATCH], value);
}

static const char no_mean[] = "the mean of the reference over the mask is not positive";
static const char no_scene_mean[] =
    "the mean of the whole reference frame is not positive and finite";
static const char no_pixel[] = "the mask is empty";
static const char no_solid[] = "no pixel of the mask is solid in both images";
static const char bad_pixel[] = "a pixel of the mask is not finite in one of the images";

enum scope {
    SAMPLES,    /* over the samples; also gets an interval when it is a function of sums */
    MASK_DEPTH, /* over the whole mask, for depth alone */
};

struct error_metric {
    struct neph_metric described;
    neph_statistic *value;
    const char *undefined_because; /* what it means when `value` gives none; NULL: cannot happen */
    bool is_of_sums;
    enum scope scope;
};

static const struct error_metric metrics[] = {
    {{"bias", NULL, "signed mean of test - reference"}, bias, NULL, true, SAMPLES},
    {{"rel_bias", "1", "bias / mean reference over the mask"}, rel_bias, no_mean, true, SAMPLES},
    {{"mae", NULL, "mean of |test - reference|"}, mae, NULL, true, SAMPLES},
    {{"rmse", NULL, "root of the mean squared difference"}, rmse, NULL, true, SAMPLES},
    {{"rel_rmse", "1", "rmse / mean reference over the mask"}, rel_rmse, no_mean, true, SAMPLES},
    {{"rel_mse", "1", "mean of d^2 / (reference^2 + (0.01 scene mean)^2)"},
     rel_mse,
     no_scene_mean,
     true,
     SAMPLES},
    {{"max_abs", NULL, "largest |test - reference|"}, max_abs, NULL, false, SAMPLES},
    {{"max_rel", "1", "largest |d| / max(|reference|, 1e-4 scene mean)"},
     max_rel,
     no_scene_mean,
     false,
     SAMPLES},
    {{"p50", NULL, "median of |test - reference|"}, p50, NULL, false, SAMPLES},
    {{"p95", NULL, "95th percentile of |test - reference|"}, p95, NULL, false, SAMPLES},
    {{"p99", NULL, "99th percentile of |test - reference|"}, p99, NULL, false, SAMPLES},
    {{"hit_mismatch", "1", "share of pixels that are solid in one image and sky in the other"},
     hit_mismatch,
     NULL,
     false,
     MASK_DEPTH},
};

enum { METRIC_COUNT = sizeof(metrics) / sizeof(metrics[0]) };

_Static_assert(METRIC_COUNT <= NEPH_ERROR_METRIC_MAX, "the caller's array holds all metrics");

int neph_error_metric_count(void)
{
    return METRIC_COUNT;
}

const struct neph_metric *neph_error_metric_at(int index)
{
    return index >= 0 && index < METRIC_COUNT ? &metrics[index].described : NULL;
}

/* ---- the walk -------------------------------------------------------------------------------- */

struct walk {
    const struct neph_quantity *quantity;
    const struct neph_mask *mask;
    const float *reference[3], *test[3];
    double epsilon;        /* of rel_mse; NaN without a scene mean */
    double relative_floor; /* of max_rel; NaN without a scene mean */

    size_t pixel_count; /* that were measured */
    size_t bad_count;
    size_t mismatch_count; /* depth: solid in one, sky in the other */
    size_t sample_count;
    double *abs_d; /* sample_count of them; owned */
    double *tiles; /* rows of SUM_COUNT, of tiles with a sample; owned */
    int tile_count;
    struct neph_sum all[SUM_COUNT]; /* over the whole mask */
    double max_abs, max_rel;
};

/* S: NaN when there is none. */
static double scene_mean(const struct walk *walk, size_t pixel_count)
{
    const float *const *planes = walk->reference;
    bool is_depth = walk->quantity->plane_count == 1;
    struct neph_sum sum = {0};
    size_t count = 0;
    for (size_t i = 0; i < pixel_count; i++) {
        double value = is_depth ? (double)planes[0][i]
                                : neph_luminance((double)planes[0][i], (double)planes[1][i],
                                                 (double)planes[2][i]);
        if (is_depth && isinf(value) && value > 0.0)
            continue; /* the sky */
        if (!isfinite(value))
            return NAN;
        neph_sum_add(&sum, value);
        count++;
    }
    double mean = count > 0 ? neph_sum_value(&sum) / (double)count : 0.0;
    return mean > 0.0 ? mean : NAN;
}

/* Whether there is something to measure at a pixel of the mask; counts what there is not. */
static bool admit(struct walk *walk, size_t pixel)
{
    bool is_depth = walk->quantity->plane_count == 1;
    bool reference_is_sky = is_depth && walk->reference[0][pixel] == INFINITY;
    bool test_is_sky = is_depth && walk->test[0][pixel] == INFINITY;
    for (int c = 0; c < walk->quantity->plane_count; c++) {
        if ((!reference_is_sky && !isfinite(walk->reference[c][pixel])) ||
            (!test_is_sky && !isfinite(walk->test[c][pixel]))) {
            walk->bad_count++;
            return false;
        }
    }
    if (reference_is_sky != test_is_sky)
        walk->mismatch_count++;
    return !reference_is_sky && !test_is_sky;
}

static void add_sample(struct walk *walk, double reference, double test,
                       struct neph_sum tile[SUM_COUNT])
{
    double d = test - reference;
    double terms[SUM_COUNT] = {
        [SUM_SAMPLES] = 1.0,
        [SUM_D] = d,
        [SUM_ABS_D] = fabs(d),
        [SUM_D2] = d * d,
        [SUM_REFERENCE] = reference,
        [SUM_RELATIVE_D2] = d * d / (reference * reference + walk->epsilon),
    };
    for (int s = 0; s < SUM_COUNT; s++)
        neph_sum_add(&tile[s], terms[s]);
    walk->abs_d[walk->sample_count++] = fabs(d);
    walk->max_abs = fmax(walk->max_abs, fabs(d));
    walk->max_rel = fmax(walk->max_rel, fabs(d) / fmax(fabs(reference), walk->relative_floor));
}

static void walk_tile(struct walk *walk, int first_x_px, int first_y_px, int side_px)
{
    const struct neph_mask *mask = walk->mask;
    int end_x_px = first_x_px + side_px < mask->width_px ? first_x_px + side_px : mask->width_px;
    int end_y_px = first_y_px + side_px < mask->height_px ? first_y_px + side_px : mask->height_px;
    struct neph_sum tile[SUM_COUNT] = {0};
    size_t samples_before = walk->sample_count;
    for (int y = first_y_px; y < end_y_px; y++) {
        for (int x = first_x_px; x < end_x_px; x++) {
            size_t pixel = (size_t)y * (size_t)mask->width_px + (size_t)x;
            if (!mask->inside[pixel] || !admit(walk, pixel))
                continue;
            walk->pixel_count++;
            for (int c = 0; c < walk->quantity->plane_count; c++)
                add_sample(walk, (double)walk->reference[c][pixel], (double)walk->test[c][pixel],
                           tile);
        }
    }
    if (walk->sample_count == samples_before)
        return;
    double *row = walk->tiles + (size_t)walk->tile_count++ * SUM_COUNT;
    for (int s = 0; s < SUM_COUNT; s++) {
        row[s] = neph_sum_value(&tile[s]);
        neph_sum_add(&walk->all[s], tile[s].sum);
        neph_sum_add(&walk->all[s], tile[s].lost);
    }
}

static enum neph_status walk_mask(struct walk *walk, struct neph_diag *diag)
{
    const struct neph_mask *mask = walk->mask;
    size_t image_pixels = (size_t)mask->width_px * (size_t)mask->height_px;
    double mean = scene_mean(walk, image_pixels);
    walk->epsilon = (mse_epsilon_share * mean) * (mse_epsilon_share * mean);
    walk->relative_floor = relative_floor_share * mean;

    struct neph_tiling tiling = neph_tiling_of(mask->width_px, mask->height_px);
    size_t tile_max = (size_t)tiling.columns * (size_t)tiling.rows;
    size_t sample_max = mask->pixel_count * (size_t)walk->quantity->plane_count;
    walk->tiles = malloc(tile_max * SUM_COUNT * sizeof(*walk->tiles));
    walk->abs_d = malloc((sample_max + 1) * sizeof(*walk->abs_d));
    if (!walk->tiles || !walk->abs_d)
        return neph_fail_memory(diag);
    for (int row = 0; row < tiling.rows; row++)
        for (int column = 0; column < tiling.columns; column++)
            walk_tile(walk, column * tiling.side_px, row * tiling.side_px, tiling.side_px);
    return NEPH_OK;
}

static void gather_facts(const struct walk *walk, double facts[FACT_COUNT])
{
    for (int s = 0; s < SUM_COUNT; s++)
        facts[s] = neph_sum_value(&walk->all[s]);
    facts[MAX_ABS] = walk->max_abs;
    facts[MAX_REL] = isfinite(walk->relative_floor) ? walk->max_rel : NAN;
    facts[P50] = facts[P95] = facts[P99] = NAN;
    if (walk->sample_count > 0) {
        facts[P50] = neph_percentile(walk->abs_d, walk->sample_count, 0.50);
        facts[P95] = neph_percentile(walk->abs_d, walk->sample_count, 0.95);
        facts[P99] = neph_percentile(walk->abs_d, walk->sample_count, 0.99);
    }
    facts[HIT_MISMATCH] = (double)walk->mismatch_count / (double)walk->mask->pixel_count;
}

/* ---- measurements ---------------------------------------------------------------------------- */

static bool applies(const struct error_metric *metric, const struct neph_quantity *quantity)
{
    return metric->scope != MASK_DEPTH || quantity->plane_count == 1;
}

/* Why nothing at all can be said, or NULL. */
static const char *obstacle(const struct error_metric *metric, const struct walk *walk)
{
    if (walk->mask->pixel_count == 0)
        return no_pixel;
    if (walk->bad_count > 0)
        return bad_pixel;
    if (metric->scope == SAMPLES && walk->sample_count == 0)
        return no_solid;
    return NULL;
}

static struct neph_measurement measure(const struct error_metric *metric, const struct walk *walk,
                                       const double facts[FACT_COUNT])
{
    bool is_of_mask = metric->scope == MASK_DEPTH;
    struct neph_measurement measured = {
        .metric = metric->described.name,
        .unit = metric->described.unit ? metric->described.unit : walk->quantity->unit,
        .quantity = walk->quantity->name,
        .mask = walk->mask->name,
        .pixel_count = is_of_mask ? walk->mask->pixel_count - walk->bad_count : walk->pixel_count,
        .bad_count = walk->bad_count,
        .undefined_because = obstacle(metric, walk),
    };
    double value = 0.0;
    if (measured.undefined_because)
        return measured;
    if (!metric->value(facts, &value)) {
        measured.undefined_because = metric->undefined_because;
        return measured;
    }
    measured.defined = true;
    measured.value = value;
    return measured;
}

static enum neph_status add_intervals(const struct walk *walk,
                                      struct neph_bootstrap_bounds bounds[METRIC_COUNT],
                                      struct neph_diag *diag)
{
    neph_statistic *statistics[METRIC_COUNT];
    struct neph_bootstrap_bounds found[METRIC_COUNT];
    int count = 0;
    for (int i = 0; i < METRIC_COUNT; i++)
        if (metrics[i].is_of_sums)
            statistics[count++] = metrics[i].value;
    enum neph_status status = neph_bootstrap_tiles(walk->tiles, walk->tile_count, SUM_COUNT,
                                                   statistics, count, found, diag);
    if (status)
        return status;
    count = 0;
    for (int i = 0; i < METRIC_COUNT; i++)
        bounds[i] = metrics[i].is_of_sums ? found[count++] : (struct neph_bootstrap_bounds){0};
    return NEPH_OK;
}

static void attach(struct neph_measurement *measured, struct neph_bootstrap_bounds bounds)
{
    if (!measured->defined || !bounds.defined)
        return;
    measured->has_interval = true;
    measured->low = fmin(bounds.low, measured->value); /* sums in another order, other roundings */
    measured->high = fmax(bounds.high, measured->value);
}

static enum neph_status find_planes(const struct neph_image *image, const char *which,
                                    const struct neph_quantity *quantity, const float *planes[3],
                                    struct neph_diag *diag)
{
    if (neph_quantity_planes(quantity, image, planes))
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_UNSUPPORTED, "the %s has no %s to measure", which,
                     quantity->name);
}

static enum neph_status check_sizes(const struct neph_image *reference,
                                    const struct neph_image *test, const struct neph_mask *mask,
                                    struct neph_diag *diag)
{
    enum neph_status status = neph_validity_same_size(reference, test, diag);
    if (status)
        return status;
    if (mask->width_px == reference->width_px && mask->height_px == reference->height_px)
        return NEPH_OK;
    return neph_fail(diag, NEPH_ERR_INPUT, "the mask '%s' is %dx%d pixels, the images %dx%d",
                     mask->name, mask->width_px, mask->height_px, reference->width_px,
                     reference->height_px);
}

enum neph_status neph_error_measure(const struct neph_image *reference,
                                    const struct neph_image *test, const char *quantity,
                                    const struct neph_mask *mask,
                                    struct neph_measurement measurements[NEPH_ERROR_METRIC_MAX],
                                    int *count, struct neph_diag *diag)
{
    struct walk walk = {.quantity = neph_quantity_find(quantity), .mask = mask};
    struct neph_bootstrap_bounds bounds[METRIC_COUNT];
    double facts[FACT_COUNT];
    if (!walk.quantity)
        return neph_fail(diag, NEPH_ERR_USAGE, "there is no quantity '%s'", quantity);
    enum neph_status status = check_sizes(reference, test, mask, diag);
    if (status)
        return status;
    status = find_planes(reference, "reference", walk.quantity, walk.reference, diag);
    if (status)
        return status;
    status = find_planes(test, "test", walk.quantity, walk.test, diag);
    if (status)
        return status;

    status = walk_mask(&walk, diag);
    if (status)
        goto done;
    status = add_intervals(&walk, bounds, diag);
    if (status)
        goto done;
    gather_facts(&walk, facts);
    *count = 0;
    for (int i = 0; i < METRIC_COUNT; i++) {
        if (!applies(&metrics[i], walk.quantity))
            continue;
        measurements[*count] = measure(&metrics[i], &walk, facts);
        attach(&measurements[(*count)++], bounds[i]);
    }
done:
    free(walk.abs_d);
    free(walk.tiles);
    return status;
}
