/* SPDX-License-Identifier: MIT */
#include "harness/compare/findings.h"

#include "base/text.h"
#include "harness/compare/measure.h"
#include "metrics/extractors/cycle_frequency.h"
#include "metrics/extractors/flicker_verdict.h"
#include "metrics/extractors/two_seed.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
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

/* What a person sees of it; where and what of the whole picture alone. */
static void add_seen(const json_t *list, const char *quantity, const char *mask, json_t **out)
{
    double share, less, more, contrast;
    char where[160] = "";
    if (!value_of(list, quantity, "seen_share", mask, &share) ||
        !value_of(list, quantity, "seen_share_6db_less", mask, &less) ||
        !value_of(list, quantity, "seen_share_6db_more", mask, &more) ||
        !value_of(list, quantity, "seen_contrast", mask, &contrast))
        return;
    double hertz, period, worst, x, y, together, radius;
    if (value_of(list, quantity, "seen_hz", mask, &hertz) &&
        value_of(list, quantity, "seen_period", mask, &period) &&
        value_of(list, quantity, "worst_tile_contrast", mask, &worst) &&
        value_of(list, quantity, "worst_tile_x", mask, &x) &&
        value_of(list, quantity, "worst_tile_y", mask, &y) &&
        value_of(list, quantity, "coherent_contrast", mask, &together) &&
        value_of(list, quantity, "coherent_radius", mask, &radius))
        snprintf(
            where, sizeof(where),
            ", at %.2g Hz (period %.2g frames), worst %.3g times at (%.0f, %.0f), in phase over "
            "%.3g deg %.3g times",
            hertz, period, worst, x, y, radius, together);
    json_t *item = finding("seen", quantity, mask, share > 0.0 ? "seen" : "not seen",
                           "seen by most in %.3g %% of the pixels (%.3g to %.3g %% for eyes 6 dB "
                           "less and more sensitive), %.3g times the threshold%s",
                           100.0 * share, 100.0 * less, 100.0 * more, contrast, where);
    neph_json_set(&item, "seen_share", json_real(share));
    neph_json_set(&item, "seen_contrast", json_real(contrast));
    neph_json_add(out, item);
}

/* A period and its RMS over a mask. */
struct cycle {
    int period;
    double rms, frame_rate_hz;
};

static int stronger_first(const void *a, const void *b)
{
    const double x = ((const struct cycle *)a)->rms, y = ((const struct cycle *)b)->rms;
    return (x < y) - (x > y);
}

enum { CYCLES_MAX = NEPH_CYCLE_PERIOD_MAX + NEPH_CYCLE_LONG_COUNT, CYCLES_TOLD = 3 };

/* False when it has none, or it is not known. */
static bool find_cycle(const json_t *list, const char *quantity, const char *mask, int which,
                       struct cycle *cycle)
{
    const bool is_long = which > NEPH_CYCLE_PERIOD_MAX;
    char metric[32];
    double frames = which;
    snprintf(metric, sizeof(metric), "cycle_long_%d_frames", which - NEPH_CYCLE_PERIOD_MAX);
    if (is_long && !value_of(list, quantity, metric, "all", &frames))
        return false;
    if (is_long)
        snprintf(metric, sizeof(metric), "cycle_long_%d", which - NEPH_CYCLE_PERIOD_MAX);
    else
        snprintf(metric, sizeof(metric), "cycle_%d", which);
    cycle->period = (int)frames;
    const json_t *viewing = json_object_get(find(list, quantity, metric, mask), "viewing");
    cycle->frame_rate_hz = json_number_value(json_object_get(viewing, "frame_rate_hz"));
    return value_of(list, quantity, metric, mask, &cycle->rms);
}

static void add_cycles(const json_t *list, const char *quantity, const char *mask,
                       const struct neph_cycle_declared *declared, json_t **out)
{
    struct cycle cycles[CYCLES_MAX];
    int count = 0;
    for (int which = NEPH_CYCLE_PERIOD_MIN; which <= CYCLES_MAX; which++)
        count += find_cycle(list, quantity, mask, which, &cycles[count]);
    qsort(cycles, (size_t)count, sizeof(*cycles), stronger_first);
    for (int i = 0; i < count && i < CYCLES_TOLD; i++) {
        char maker[2 * NEPH_CYCLE_NAME_MAX + 16], speed[64] = "";
        neph_cycle_explain(declared, cycles[i].period, maker, sizeof(maker));
        if (cycles[i].frame_rate_hz > 0.0)
            snprintf(speed, sizeof(speed), "%.3g Hz at %g fps",
                     cycles[i].frame_rate_hz / cycles[i].period, cycles[i].frame_rate_hz);
        json_t *item = finding("cycle", quantity, mask, "cyclic",
                               "period %d frames (%s%s%s): %.2g/255 RMS of luma", cycles[i].period,
                               speed, speed[0] && maker[0] ? ", " : "", maker,
                               255.0 * cycles[i].rms);
        neph_json_set(&item, "period", json_integer(cycles[i].period));
        neph_json_set(&item, "value", json_real(cycles[i].rms));
        neph_json_add(out, item);
    }
}

/* Periods that the frames do not tell from those that were found. */
static void add_unseparated(const json_t *list, const char *quantity, json_t **out)
{
    char periods[160] = "";
    size_t used = 0;
    for (int period = NEPH_CYCLE_PERIOD_MIN; period <= NEPH_CYCLE_PERIOD_MAX; period++) {
        char metric[32];
        snprintf(metric, sizeof(metric), "cycle_%d", period);
        if (is(find(list, quantity, metric, "all"), "undefined_because", neph_cycle_not_apart))
            used += (size_t)snprintf(periods + used, sizeof(periods) - used, "%s%d",
                                     used ? ", " : "", period);
    }
    if (periods[0])
        neph_json_add(out, finding("cycle_unseparated", quantity, "all", "not told apart",
                                   "the periods that were found could as well be of %s frames: "
                                   "give more frames",
                                   periods));
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
    json_t *item = finding(
        "edge_ratio", quantity, "depth_edge", ratio > 1.0 ? "edges" : "even",
        floored ? "four-frame flicker at depth edges (p95 %.3g) is %.3g times a quarter of a "
                  "step of an 8-bit display; elsewhere it is below that "
                  "(p95 %.3g)"
                : "four-frame flicker at depth edges (p95 %.3g) is %.3g times as strong as "
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

/* How the test follows light that goes up and down. The shortest swing and the latest that still
 * count as following are ours: a tenth of the light, one frame. */
static bool add_follow(const json_t *list, const char *quantity, int which, json_t **out)
{
    static const char *const parts[] = {"follow_period_%d", "follow_share_%d", "follow_gain_%d_p50",
                                        "follow_lost_share_%d", "follow_lag_%d_p50"};
    enum { PERIOD, SHARE, GAIN, LOST, LAG };
    double values[5];
    bool known[5];
    for (int i = 0; i < 5; i++) {
        char metric[32];
        snprintf(metric, sizeof(metric), parts[i], which);
        known[i] = value_of(list, quantity, metric, "all", &values[i]);
    }
    if (!known[PERIOD] || !known[GAIN])
        return false;
    const bool follows = known[LAG] && values[GAIN] > 0.9 && fabs(values[LAG]) < 1.0;
    char lost[96] = "";
    if (values[LOST] > 0.0)
        snprintf(lost, sizeof(lost), "; %.3g %% of that does not swing above its noise",
                 100.0 * values[LOST]);
    json_t *item = known[LAG]
                       ? finding("follow", quantity, "all", follows ? "follows" : "late",
                                 "follows the light with a lag of %.3g frames at a period of %.3g, "
                                 "and %.3g of its swing (medians of the %.3g %% of the picture "
                                 "that the light moves%s)",
                                 values[LAG], values[PERIOD], values[GAIN], 100.0 * values[SHARE],
                                 lost)
                       : finding("follow", quantity, "all", "lost",
                                 "does not follow the light at a period of %.3g frames: no pixel "
                                 "swings above its noise",
                                 values[PERIOD]);
    neph_json_set(&item, "period", json_real(values[PERIOD]));
    neph_json_set(&item, "gain", json_real(values[GAIN]));
    neph_json_set(&item, "lag", known[LAG] ? json_real(values[LAG]) : json_null());
    neph_json_add(out, item);
    return true;
}

/* After a step of the light, or a cut. */
static void add_unsettled(const json_t *list, const char *quantity, json_t **out)
{
    double never, after_4, after_16, end;
    if (!value_of(list, quantity, "share_never_settled", "all", &never) ||
        !value_of(list, quantity, "ghost_area_end", "all", &end) ||
        !value_of(list, quantity, "ghost_area_4", "all", &after_4) ||
        !value_of(list, quantity, "ghost_area_16", "all", &after_16))
        return;
    json_t *item = finding("unsettled", quantity, "all", never > 0.0 ? "unsettled" : "settles",
                           "%.3g %% of the picture never settles to within a tenth of the step; "
                           "there is more left in %.3g %% of it after 4 frames, in %.3g %% "
                           "after 16, in %.3g %% at the end",
                           100.0 * never, 100.0 * after_4, 100.0 * after_16, 100.0 * end);
    neph_json_set(&item, "share", json_real(never));
    neph_json_add(out, item);
}

static void add_edge_ghost(const json_t *list, const char *quantity, json_t **out)
{
    double left, frames;
    if (!value_of(list, quantity, "edge_ghost_residual_4", "all", &left) ||
        !value_of(list, quantity, "edge_ghost_frames", "all", &frames))
        return;
    json_t *item = finding("edge_ghost", quantity, "all", fabs(left) > 0.1 ? "ghosts" : "clean",
                           "behind moving edges %.3g %% of what was in front is left after 4 "
                           "frames, and more than a tenth for %.3g frames (mean)",
                           100.0 * left, frames);
    neph_json_set(&item, "residual", json_real(left));
    neph_json_set(&item, "frames", json_real(frames));
    neph_json_add(out, item);
}

/* Flicker is never told without the price at which it may have been bought. */
static void add_half_life(const json_t *list, const char *quantity, bool is_followed, json_t **out)
{
    double a4, frames, unsettled = 0.0;
    if (!value_of(list, quantity, "a4_p95", "all", &a4))
        return;
    value_of(list, quantity, "share_unsettled", "all", &unsettled);
    const bool is_known = value_of(list, quantity, "half_life_p50", "all", &frames);
    if (!is_known && is_followed)
        return;
    if (!is_known)
        neph_json_add(out, finding("half_life", quantity, "all", "not measured",
                                   "less flicker may have been bought with lag: give "
                                   "a reference with a step, and -s lag.step_frame=N, or "
                                   "with light of a known period, and -s follow.period_1=N"));
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

json_t *neph_findings(const json_t *measurements, bool frozen, const char *declared_cycles)
{
    struct neph_cycle_declared declared = {.count = 0};
    neph_cycle_parse(declared_cycles ? declared_cycles : "", &declared, NULL);
    static const char *const quantities[] = {"radiance", "volume", "transmittance"};
    json_t *out = json_array(), *masks = masks_of(measurements);
    for (int q = 0; q < 3; q++) {
        const char *mask;
        json_t *unused;
        json_object_foreach(masks, mask, unused)
        {
            add_seen(measurements, quantities[q], mask, &out);
            add_flicker(measurements, quantities[q], mask, frozen, &out);
            add_cycles(measurements, quantities[q], mask, &declared, &out);
            add_reference_limited(measurements, quantities[q], mask, &out);
            add_noise_floor(measurements, quantities[q], mask, &out);
            for (int b = NEPH_BOUND_NONE + 1; b < NEPH_BOUND_COUNT; b++)
                add_clipped(measurements, quantities[q], mask,
                            neph_bound_name((enum neph_display_bound)b), &out);
        }
        add_unseparated(measurements, quantities[q], &out);
        add_edge_ratio(measurements, quantities[q], &out);
        bool is_followed = false;
        for (int which = 1; which <= 3; which++)
            is_followed |= add_follow(measurements, quantities[q], which, &out);
        add_half_life(measurements, quantities[q], is_followed, &out);
        add_unsettled(measurements, quantities[q], &out);
        add_edge_ghost(measurements, quantities[q], &out);
    }
    if (!masks)
        neph_json_add(&out, NULL);
    json_decref(masks);
    return out;
}
