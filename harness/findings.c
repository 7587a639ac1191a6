/* SPDX-License-Identifier: MIT */
#include "harness/findings.h"

#include "base/text.h"
#include "harness/measure.h"
#include "metrics/extractors/flicker_verdict.h"
#include "metrics/extractors/two_seed.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static bool is(const json_t *item, const char *key, const char *text)
{
    const char *value = json_string_value(json_object_get(item, key));
    return value && strcmp(value, text) == 0;
}

/* The number of that name, of all frames where there is one; NULL when it is not there. */
static const json_t *find(const json_t *list, const char *quantity, const char *metric,
                          const char *mask)
{
    const json_t *found = NULL;
    for (size_t i = 0; i < json_array_size(list); i++) {
        const json_t *item = json_array_get(list, i);
        if (is(item, "metric", metric) && is(item, "quantity", quantity) && is(item, "mask", mask))
            found = item; /* the frames come first */
    }
    return found;
}

static bool value_of(const json_t *list, const char *quantity, const char *metric, const char *mask,
                     double *value)
{
    const json_t *number = json_object_get(find(list, quantity, metric, mask), "value");
    *value = json_number_value(number);
    return json_is_number(number);
}

static json_t *finding(const char *name, const char *quantity, const char *mask,
                       const char *verdict, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

static json_t *finding(const char *name, const char *quantity, const char *mask,
                       const char *verdict, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    neph_text_clean(text, sizeof(text));
    return json_pack("{s:s, s:s, s:s, s:s, s:s}", "finding", name, "quantity", quantity, "mask",
                     mask, "verdict", verdict, "text", text);
}

static void add_flicker(const json_t *list, const char *quantity, const char *mask, bool frozen,
                        json_t **out)
{
    static const char *const words[] = {
        [NEPH_FLICKER_CALM] = "no flicker above a step of an 8-bit display",
        [NEPH_FLICKER_RESTLESS] = "flicker that does not follow the cycle of four frames",
        [NEPH_FLICKER_CYCLIC] = "flicker at the periods of a cycle of four frames",
    };
    double cyclic, restless;
    if (!value_of(list, quantity, "cyclic_share", mask, &cyclic) ||
        !value_of(list, quantity, "restless_share", mask, &restless))
        return;
    const enum neph_flicker_kind kind = neph_flicker_verdict(cyclic, restless);
    const bool no_verdict = frozen && kind == NEPH_FLICKER_CALM;
    json_t *item = finding(
        "flicker", quantity, mask, no_verdict ? "frozen" : neph_flicker_kind_name(kind),
        "%s (cyclic in %.3g %%, restless in %.3g %% of the pixels)",
        no_verdict ? "frames repeat the one before: that is no stability" : words[kind],
        100.0 * cyclic, 100.0 * restless);
    neph_json_set(&item, "cyclic_share", json_real(cyclic));
    neph_json_set(&item, "restless_share", json_real(restless));
    neph_json_add(out, item);
}

static double bound(const json_t *measurement, size_t which)
{
    const json_t *interval = json_object_get(measurement, "interval");
    return json_is_array(interval) ? json_number_value(json_array_get(interval, which)) : NAN;
}

static void add_edge_ratio(const json_t *list, const char *quantity, json_t **out)
{
    const json_t *edge = find(list, quantity, "a4_p95", "depth_edge");
    const json_t *other = find(list, quantity, "a4_p95", "non_edge");
    double edge_p95, other_p95;
    if (!value_of(list, quantity, "a4_p95", "depth_edge", &edge_p95) ||
        !value_of(list, quantity, "a4_p95", "non_edge", &other_p95))
        return;
    const double ratio = neph_flicker_edge_ratio(edge_p95, other_p95);
    const bool bounded = isfinite(bound(edge, 0)) && isfinite(bound(other, 0));
    const double low = neph_flicker_edge_ratio(bound(edge, 0), bound(other, 1));
    const double high = neph_flicker_edge_ratio(bound(edge, 1), bound(other, 0));
    const bool floored = other_p95 <= 0.0 || ratio < edge_p95 / other_p95;
    json_t *item = finding("edge_ratio", quantity, "depth_edge", ratio > 1.0 ? "edges" : "even",
                           floored ? "A4 at depth edges (p95 %.3g) is %.3g times a quarter of a "
                                     "step of an 8-bit display; elsewhere it is below that "
                                     "(p95 %.3g)"
                                   : "A4 at depth edges (p95 %.3g) is %.3g times as strong as "
                                     "elsewhere (p95 %.3g)",
                           edge_p95, ratio, other_p95);
    neph_json_set(&item, "value", json_real(ratio));
    neph_json_set(&item, "interval", bounded ? json_pack("[f,f]", low, high) : json_null());
    neph_json_add(out, item);
}

static void add_reference_limited(const json_t *list, const char *quantity, const char *mask,
                                  json_t **out)
{
    double test, reference;
    if (!value_of(list, quantity, "a4_p95", mask, &test) ||
        !value_of(list, quantity, "reference_a4_p95", mask, &reference) ||
        !neph_flicker_reference_limited(test, reference))
        return;
    neph_json_add(out, finding("reference_limited", quantity, mask, "reference-limited",
                               "a4_p95 is %.3g, that of the reference alone %.3g: the "
                               "number says more about the reference",
                               test, reference));
}

static void add_noise_floor(const json_t *list, const char *quantity, const char *mask,
                            json_t **out)
{
    double error, noise;
    if (!value_of(list, quantity, "rmse_unbiased", mask, &error) ||
        !value_of(list, quantity, "reference_noise_rmse", mask, &noise))
        return;
    const bool at_floor = neph_is_at_noise_floor(error, noise);
    neph_json_add(out,
                  finding("noise_floor", quantity, mask, at_floor ? "at noise floor" : "resolved",
                          "the error without the reference's noise is %.3g, the noise "
                          "of one seed of the reference %.3g",
                          error, noise));
}

/* What an item says of pixels above `above`, when it is of that quantity and mask; else NULL. */
static json_t *clipped_of(const json_t *item, const char *quantity, const char *mask,
                          const char *above)
{
    json_t *clipped = json_object_get(item, "clipped");
    return clipped && is(clipped, "above", above) && is(item, "quantity", quantity) &&
                   is(item, "mask", mask)
               ? clipped
               : NULL;
}

static void add_clipped(const json_t *list, const char *quantity, const char *mask,
                        const char *above, json_t **out)
{
    const size_t count = json_array_size(list);
    const bool has_overall = count > 0 &&
                             !json_object_get(json_array_get(list, count - 1), "frame");
    for (size_t i = count; i-- > 0;) {
        const json_t *item = json_array_get(list, i);
        if (has_overall && json_object_get(item, "frame"))
            return; /* those of all frames are the last */
        json_t *clipped = clipped_of(item, quantity, mask, above);
        if (!clipped)
            continue;
        const double reference = json_number_value(json_object_get(clipped, "reference"));
        const double test = json_number_value(json_object_get(clipped, "test"));
        if (reference == 0.0 && test == 0.0)
            return;
        json_t *found = finding("clipped", quantity, mask, "clipped",
                                "%.3g %% of the pixels of the reference and %.3g %% of the test's "
                                "are above %s: metrics that end there, such as %s, do not see what "
                                "differs in them; a lower --exposure shows it",
                                100.0 * reference, 100.0 * test, above,
                                neph_json_text(item, "metric"));
        neph_json_set(&found, "clipped", json_incref(clipped));
        neph_json_add(out, found);
        return;
    }
}

/* Flicker is never told without the price at which it may have been bought. */
static void add_half_life(const json_t *list, const char *quantity, json_t **out)
{
    double a4, frames, unsettled = 0.0;
    if (!value_of(list, quantity, "a4_p95", "all", &a4))
        return;
    value_of(list, quantity, "share_unsettled", "all", &unsettled);
    if (!value_of(list, quantity, "half_life_p50", "all", &frames))
        neph_json_add(out, finding("half_life", quantity, "all", "not measured",
                                   "less flicker may have been bought with lag: give "
                                   "a reference with a step, and -s lag.step_frame=N"));
    else if (unsettled >= 0.5)
        neph_json_add(out, finding("half_life", quantity, "all", "not settled",
                                   "half-life after a step: at least %.3g frames: the "
                                   "sequence ends before %.3g %% of the pixels have come "
                                   "half of the way",
                                   frames, 100.0 * unsettled));
    else
        neph_json_add(out, finding("half_life", quantity, "all", "measured",
                                   "half-life after a step: %.3g frames (median)", frames));
}

/* The masks, once each, in the order of the measurements. */
static json_t *masks_of(const json_t *list)
{
    json_t *names = json_object();
    for (size_t i = 0; i < json_array_size(list); i++)
        neph_json_set(&names, json_string_value(json_object_get(json_array_get(list, i), "mask")),
                      json_true());
    return names;
}

json_t *neph_findings(const json_t *measurements, bool frozen)
{
    static const char *const quantities[] = {"radiance", "volume", "transmittance"};
    json_t *out = json_array(), *masks = masks_of(measurements);
    for (int q = 0; q < 3; q++) {
        const char *mask;
        json_t *unused;
        json_object_foreach(masks, mask, unused)
        {
            add_flicker(measurements, quantities[q], mask, frozen, &out);
            add_reference_limited(measurements, quantities[q], mask, &out);
            add_noise_floor(measurements, quantities[q], mask, &out);
            for (int b = NEPH_BOUND_NONE + 1; b < NEPH_BOUND_COUNT; b++)
                add_clipped(measurements, quantities[q], mask,
                            neph_bound_name((enum neph_display_bound)b), &out);
        }
        add_edge_ratio(measurements, quantities[q], &out);
        add_half_life(measurements, quantities[q], &out);
    }
    if (!masks)
        neph_json_add(&out, NULL);
    json_decref(masks);
    return out;
}
