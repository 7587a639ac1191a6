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

/* Compiles only when this file handles every kind. */
_Static_assert(NEPH_INTERVAL_KIND_COUNT == 5, "a new kind");
_Static_assert(NEPH_FLICKER_KIND_COUNT == 3, "a new kind");

/* Context for making findings: the numbers, the current quantity and mask, and the output. */
struct finding_maker {
    const struct neph_measurements *numbers;
    const struct neph_quantity *quantity;
    const char *mask;
    double frame_rate_hz;
    struct neph_findings *out;
    struct neph_finding lost; /* replaces a finding when memory is short */
    bool failed;
};

static const struct neph_measurement *find(const struct finding_maker *finding_maker,
                                           const char *metric, const char *mask)
{
    return neph_measurement_find(finding_maker->numbers, finding_maker->quantity->name, metric,
                                 mask);
}

static bool value_over(const struct finding_maker *finding_maker, const char *metric,
                       const char *mask, double *value)
{
    const struct neph_measurement *number = find(finding_maker, metric, mask);
    const bool is_known = number && number->defined;
    *value = is_known ? number->value : 0.0;
    return is_known;
}

static bool find_masked_value(const struct finding_maker *finding_maker, const char *metric,
                              double *value)
{
    return value_over(finding_maker, metric, finding_maker->mask, value);
}

static struct neph_finding *add_finding_text(struct finding_maker *finding_maker, const char *name,
                                             const char *verdict, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Add a finding for the current quantity and mask. */
static struct neph_finding *add_finding_text(struct finding_maker *finding_maker, const char *name,
                                             const char *verdict, const char *format, ...)
{
    struct neph_findings *out = finding_maker->out;
    struct neph_finding *longer = realloc(out->list, (size_t)(out->count + 1) * sizeof(*longer));
    out->list = longer ? longer : out->list;
    finding_maker->failed |= !longer;
    struct neph_finding *made = longer ? &out->list[out->count++] : &finding_maker->lost;
    *made = (struct neph_finding){
        .name = name, .quantity = finding_maker->quantity, .verdict = verdict};
    snprintf(made->mask, sizeof(made->mask), "%s", finding_maker->mask);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(made->text, sizeof(made->text), format, arguments);
    va_end(arguments);
    neph_text_clean(made->text, sizeof(made->text));
    return made;
}

static void add_finding_number(struct neph_finding *finding, const char *key, double value)
{
    struct neph_finding_number *number = finding->numbers;
    while (number->key)
        number++;
    *number = (struct neph_finding_number){.key = key, .value = value};
}

static void add_flicker(struct finding_maker *finding_maker, bool frozen)
{
    static const char *const words[] = {
        [NEPH_FLICKER_CALM] = "no flicker above a step of an 8-bit display",
        [NEPH_FLICKER_RESTLESS] = "flicker that does not follow the cycle of four frames",
        [NEPH_FLICKER_CYCLIC] = "flicker at the periods of a cycle of four frames",
    };
    double cyclic, restless;
    if (!find_masked_value(finding_maker, "cyclic_share", &cyclic) ||
        !find_masked_value(finding_maker, "restless_share", &restless))
        return;
    const enum neph_flicker_kind kind = neph_flicker_verdict(cyclic, restless);
    const bool no_verdict = frozen && kind == NEPH_FLICKER_CALM;
    struct neph_finding *item = add_finding_text(
        finding_maker, "flicker", no_verdict ? "frozen" : neph_flicker_kind_name(kind),
        "%s (cyclic in %.3g %%, restless in %.3g %% of the pixels)",
        no_verdict ? "frames repeat the one before: that is no stability" : words[kind],
        100.0 * cyclic, 100.0 * restless);
    add_finding_number(item, "cyclic_share", cyclic);
    add_finding_number(item, "restless_share", restless);
}

/* Visible flicker; its frequency and place only for the whole frame. */
static void add_seen(struct finding_maker *finding_maker)
{
    double share, less, more, contrast;
    char where[160] = "";
    if (!find_masked_value(finding_maker, "seen_share", &share) ||
        !find_masked_value(finding_maker, "seen_share_6db_less", &less) ||
        !find_masked_value(finding_maker, "seen_share_6db_more", &more) ||
        !find_masked_value(finding_maker, "seen_contrast", &contrast))
        return;
    double hertz, period, worst, x, y, together, radius;
    if (find_masked_value(finding_maker, "seen_hz", &hertz) &&
        find_masked_value(finding_maker, "seen_period", &period) &&
        find_masked_value(finding_maker, "worst_tile_contrast", &worst) &&
        find_masked_value(finding_maker, "worst_tile_x", &x) &&
        find_masked_value(finding_maker, "worst_tile_y", &y) &&
        find_masked_value(finding_maker, "coherent_contrast", &together) &&
        find_masked_value(finding_maker, "coherent_radius", &radius))
        snprintf(
            where, sizeof(where),
            ", at %.2g Hz (period %.2g frames), worst %.3g times at (%.0f, %.0f), in phase over "
            "%.3g deg %.3g times",
            hertz, period, worst, x, y, radius, together);
    struct neph_finding *item = add_finding_text(
        finding_maker, "seen", share > 0.0 ? "seen" : "not seen",
        "seen by most in %.3g %% of the pixels (%.3g to %.3g %% for eyes 6 dB "
        "less and more sensitive), %.3g times the threshold%s",
        100.0 * share, 100.0 * less, 100.0 * more, contrast, where);
    add_finding_number(item, "seen_share", share);
    add_finding_number(item, "seen_contrast", contrast);
}

/* A period and its RMS over a mask. */
struct cycle {
    int period;
    double rms;
};

static int stronger_first(const void *a, const void *b)
{
    const double x = ((const struct cycle *)a)->rms, y = ((const struct cycle *)b)->rms;
    return (x < y) - (x > y);
}

enum { CYCLES_MAX = NEPH_CYCLE_PERIOD_MAX + NEPH_CYCLE_LONG_COUNT, CYCLES_TOLD = 3 };

/* Read a period. False when the mask has none, or it is unknown. */
static bool find_cycle(const struct finding_maker *finding_maker, int which, struct cycle *cycle)
{
    const bool is_long = which > NEPH_CYCLE_PERIOD_MAX;
    char metric[32];
    double frames = which;
    snprintf(metric, sizeof(metric), "cycle_long_%d_frames", which - NEPH_CYCLE_PERIOD_MAX);
    if (is_long && !value_over(finding_maker, metric, "all", &frames))
        return false;
    if (is_long)
        snprintf(metric, sizeof(metric), "cycle_long_%d", which - NEPH_CYCLE_PERIOD_MAX);
    else
        snprintf(metric, sizeof(metric), "cycle_%d", which);
    cycle->period = (int)frames;
    return find_masked_value(finding_maker, metric, &cycle->rms);
}

static void add_cycles(struct finding_maker *finding_maker,
                       const struct neph_cycle_declared *declared)
{
    struct cycle cycles[CYCLES_MAX];
    int count = 0;
    for (int which = NEPH_CYCLE_PERIOD_MIN; which <= CYCLES_MAX; which++)
        count += find_cycle(finding_maker, which, &cycles[count]);
    qsort(cycles, (size_t)count, sizeof(*cycles), stronger_first);
    for (int i = 0; i < count && i < CYCLES_TOLD; i++) {
        char maker[2 * NEPH_CYCLE_NAME_MAX + 16], speed[64] = "";
        neph_cycle_explain(declared, cycles[i].period, maker, sizeof(maker));
        if (finding_maker->frame_rate_hz > 0.0)
            snprintf(speed, sizeof(speed), "%.3g Hz at %g fps",
                     finding_maker->frame_rate_hz / cycles[i].period, finding_maker->frame_rate_hz);
        struct neph_finding *item = add_finding_text(
            finding_maker, "cycle", "cyclic", "period %d frames (%s%s%s): %.2g/255 RMS of luma",
            cycles[i].period, speed, speed[0] && maker[0] ? ", " : "", maker,
            255.0 * cycles[i].rms);
        item->numbers[0] = (struct neph_finding_number){"period", cycles[i].period, true};
        add_finding_number(item, "value", cycles[i].rms);
    }
}

/* Report periods that this number of frames cannot distinguish from the periods found. */
static void add_unseparated(struct finding_maker *finding_maker)
{
    char periods[160] = "";
    size_t used = 0;
    for (int period = NEPH_CYCLE_PERIOD_MIN; period <= NEPH_CYCLE_PERIOD_MAX; period++) {
        char metric[32];
        snprintf(metric, sizeof(metric), "cycle_%d", period);
        const struct neph_measurement *number = find(finding_maker, metric, finding_maker->mask);
        if (number && number->undefined_because &&
            strcmp(number->undefined_because, neph_cycle_not_apart) == 0)
            used += (size_t)snprintf(periods + used, sizeof(periods) - used, "%s%d",
                                     used ? ", " : "", period);
    }
    if (periods[0])
        add_finding_text(
            finding_maker, "cycle_unseparated", "not told apart",
            "the periods that were found could as well be of %s frames: give more frames", periods);
}

static void add_edge_ratio(struct finding_maker *finding_maker)
{
    const struct neph_measurement *edge = find(finding_maker, "a4_p95", "depth_edge");
    const struct neph_measurement *other = find(finding_maker, "a4_p95", "non_edge");
    if (!edge || !edge->defined || !other || !other->defined)
        return;
    const double ratio = neph_flicker_edge_ratio(edge->value, other->value);
    const bool floored = other->value <= 0.0 || ratio < edge->value / other->value;
    struct neph_finding *item = add_finding_text(
        finding_maker, "edge_ratio", ratio > 1.0 ? "edges" : "even",
        edge->value <= 0.0 ? "four-frame flicker at depth edges is not above the noise of the "
                             "adjacent frequencies, which is subtracted (p95 %.3g, %.3g times the "
                             "value elsewhere, %.3g); for other periods see 'cycle'"
        : floored          ? "four-frame flicker at depth edges (p95 %.3g) is %.3g times a quarter "
                             "of a step of an 8-bit display; elsewhere it is below "
                             "that (p95 %.3g)"
                           : "four-frame flicker at depth edges (p95 %.3g) is %.3g times as strong "
                             "as elsewhere (p95 %.3g)",
        edge->value, ratio, other->value);
    add_finding_number(item, "value", ratio);
    const bool bounded = neph_interval_is_bounded(edge->interval) &&
                         neph_interval_is_bounded(other->interval);
    item->has_interval = true;
    item->low = bounded ? neph_flicker_edge_ratio(edge->low, other->high) : NAN;
    item->high = bounded ? neph_flicker_edge_ratio(edge->high, other->low) : NAN;
}

static void add_reference_limited(struct finding_maker *finding_maker)
{
    double test, reference;
    if (find_masked_value(finding_maker, "a4_p95", &test) &&
        find_masked_value(finding_maker, "reference_a4_p95", &reference) &&
        neph_flicker_reference_limited(test, reference))
        add_finding_text(
            finding_maker, "reference_limited", "reference-limited",
            "a4_p95 is %.3g, and %.3g for the reference itself: the number says more about the "
            "reference",
            test, reference);
}

static void add_noise_floor(struct finding_maker *finding_maker)
{
    double error, noise;
    if (find_masked_value(finding_maker, "rmse_unbiased", &error) &&
        find_masked_value(finding_maker, "reference_noise_rmse", &noise))
        add_finding_text(
            finding_maker, "noise_floor",
            neph_is_at_noise_floor(error, noise) ? "at noise floor" : "resolved",
            "the error without the reference's noise is %.3g, the noise of one seed of the "
            "reference %.3g",
            error, noise);
}

/* The last number with pixels beyond the bound; numbers of all frames are at the end of the
 * list. */
static const struct neph_measurement *find_clipped(const struct finding_maker *finding_maker,
                                                   enum neph_display_bound bound)
{
    const struct neph_measurements *numbers = finding_maker->numbers;
    const bool has_overall = numbers->list[numbers->count - 1].frame < 0;
    for (int i = numbers->count - 1; i >= 0; i--) {
        const struct neph_measurement *number = &numbers->list[i];
        if (has_overall && number->frame >= 0)
            return NULL;
        if (number->clipped.bound == bound && number->quantity == finding_maker->quantity &&
            strcmp(number->mask, finding_maker->mask) == 0)
            return number;
    }
    return NULL;
}

static void add_clipped(struct finding_maker *finding_maker, enum neph_display_bound bound)
{
    const struct neph_measurement *number = find_clipped(finding_maker, bound);
    if (!number || (number->clipped.reference == 0.0 && number->clipped.test == 0.0))
        return;
    add_finding_text(
        finding_maker, "clipped", "clipped",
        "%.3g %% of the pixels of the reference and %.3g %% of the test's are above %s: metrics "
        "that end there, such as %s, miss the differences in them; a lower --exposure shows them",
        100.0 * number->clipped.reference, 100.0 * number->clipped.test, neph_bound_name(bound),
        number->metric->name)
        ->clipped = number->clipped;
}

/* Report how the test follows light that oscillates. Our own thresholds for "follows": at least 0.9
 * of the amplitude and a lag below one frame. */
static bool add_follow(struct finding_maker *finding_maker, int which)
{
    static const char *const parts[] = {"follow_period_%d", "follow_share_%d", "follow_gain_%d_p50",
                                        "follow_lost_share_%d", "follow_lag_%d_p50"};
    enum { PERIOD, SHARE, GAIN, LOST, LAG };
    double values[5];
    bool known[5];
    for (int i = 0; i < 5; i++) {
        char metric[32];
        snprintf(metric, sizeof(metric), parts[i], which);
        known[i] = find_masked_value(finding_maker, metric, &values[i]);
    }
    if (!known[PERIOD] || !known[GAIN])
        return false;
    const bool follows = known[LAG] && values[GAIN] > 0.9 && fabs(values[LAG]) < 1.0;
    char lost[96] = "";
    if (values[LOST] > 0.0)
        snprintf(lost, sizeof(lost), "; %.3g %% of that does not swing above its noise",
                 100.0 * values[LOST]);
    struct neph_finding *item =
        known[LAG]
            ? add_finding_text(
                  finding_maker, "follow", follows ? "follows" : "late",
                  "follows the light with a lag of %.3g frames at a period of %.3g, and %.3g of "
                  "its swing (medians of the %.3g %% of the frame that the light changes%s)",
                  values[LAG], values[PERIOD], values[GAIN], 100.0 * values[SHARE], lost)
            : add_finding_text(finding_maker, "follow", "lost",
                               "does not follow the light at a period of %.3g frames: no pixel "
                               "swings above its noise",
                               values[PERIOD]);
    add_finding_number(item, "period", values[PERIOD]);
    add_finding_number(item, "gain", values[GAIN]);
    add_finding_number(item, "lag", known[LAG] ? values[LAG] : NAN);
    return true;
}

/* Report residual light after a step of the light, or a cut. */
static void add_unsettled(struct finding_maker *finding_maker)
{
    double never, after_4, after_16, end;
    if (!find_masked_value(finding_maker, "share_never_settled", &never) ||
        !find_masked_value(finding_maker, "ghost_area_end", &end) ||
        !find_masked_value(finding_maker, "ghost_area_4", &after_4) ||
        !find_masked_value(finding_maker, "ghost_area_16", &after_16))
        return;
    struct neph_finding *item = add_finding_text(
        finding_maker, "unsettled", never > 0.0 ? "unsettled" : "settles",
        "%.3g %% of the frame never settles to within a tenth of the step; more is left in %.3g %% "
        "of the frame after 4 frames, in %.3g %% after 16, in %.3g %% at the end",
        100.0 * never, 100.0 * after_4, 100.0 * after_16, 100.0 * end);
    add_finding_number(item, "share", never);
}

static void add_edge_ghost(struct finding_maker *finding_maker)
{
    double left, frames;
    if (!find_masked_value(finding_maker, "edge_ghost_residual_4", &left) ||
        !find_masked_value(finding_maker, "edge_ghost_frames", &frames))
        return;
    struct neph_finding *item = add_finding_text(
        finding_maker, "edge_ghost", fabs(left) > 0.1 ? "ghosts" : "clean",
        "behind moving edges %.3g %% of the old foreground is left "
        "after 4 frames, and more than a tenth for %.3g frames (mean)",
        100.0 * left, frames);
    add_finding_number(item, "residual", left);
    add_finding_number(item, "frames", frames);
}

/* Report the lag together with flicker, because averaging reduces flicker at the cost of lag. */
static void add_half_life(struct finding_maker *finding_maker, bool is_followed)
{
    double a4, frames, unsettled = 0.0;
    if (!find_masked_value(finding_maker, "a4_p95", &a4))
        return;
    find_masked_value(finding_maker, "share_unsettled", &unsettled);
    const bool is_known = find_masked_value(finding_maker, "half_life_p50", &frames);
    if (is_known && unsettled >= 0.5)
        add_finding_text(
            finding_maker, "half_life", "not settled",
            "half-life after a step: at least %.3g frames: the sequence ends before %.3g %% of "
            "the pixels have come half of the way",
            frames, 100.0 * unsettled);
    else if (is_known)
        add_finding_text(finding_maker, "half_life", "measured",
                         "half-life after a step: %.3g frames (median)", frames);
    else if (!is_followed)
        add_finding_text(
            finding_maker, "half_life", "not measured",
            "less flicker may have been bought with lag: give a reference with a step, and -s "
            "lag:step_frame=N, or with light of a known period, and -s follow:period_1=N");
}

/* True when the mask of the number at `index` occurs before it. */
static bool is_known_mask(const struct neph_measurements *numbers, int index)
{
    for (int i = 0; i < index; i++)
        if (strcmp(numbers->list[i].mask, numbers->list[index].mask) == 0)
            return true;
    return false;
}

static void add_mask_findings(struct finding_maker *finding_maker, bool frozen,
                              const struct neph_cycle_declared *declared)
{
    add_seen(finding_maker);
    add_flicker(finding_maker, frozen);
    add_cycles(finding_maker, declared);
    add_reference_limited(finding_maker);
    add_noise_floor(finding_maker);
    for (int b = NEPH_BOUND_NONE + 1; b < NEPH_BOUND_COUNT; b++)
        add_clipped(finding_maker, (enum neph_display_bound)b);
}

static void add_frame_findings(struct finding_maker *finding_maker)
{
    bool is_followed = false;
    finding_maker->mask = "all";
    add_unseparated(finding_maker);
    finding_maker->mask = "depth_edge";
    add_edge_ratio(finding_maker);
    finding_maker->mask = "all";
    for (int which = 1; which <= 3; which++)
        is_followed |= add_follow(finding_maker, which);
    add_half_life(finding_maker, is_followed);
    add_unsettled(finding_maker);
    add_edge_ghost(finding_maker);
}

enum neph_status neph_findings_make(const struct neph_measurements *measurements,
                                    double frame_rate_hz, bool frozen, const char *declared_cycles,
                                    struct neph_findings *findings, struct neph_diag *diag)
{
    static const char *const quantities[] = {"radiance", "volume", "transmittance"};
    struct neph_cycle_declared declared = {.count = 0};
    struct finding_maker finding_maker = {
        .numbers = measurements, .frame_rate_hz = frame_rate_hz, .out = findings};
    neph_cycle_parse(declared_cycles ? declared_cycles : "", &declared, NULL);
    for (int q = 0; q < 3; q++) {
        finding_maker.quantity = neph_quantity_find(quantities[q]);
        for (int i = 0; i < measurements->count; i++) {
            if (is_known_mask(measurements, i))
                continue;
            finding_maker.mask = measurements->list[i].mask;
            add_mask_findings(&finding_maker, frozen, &declared);
        }
        add_frame_findings(&finding_maker);
    }
    return finding_maker.failed ? neph_fail_memory(diag) : NEPH_OK;
}

void neph_findings_finish(struct neph_findings *findings)
{
    free(findings->list);
    *findings = (struct neph_findings){0};
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static json_t *finding_json(const struct neph_finding *finding)
{
    json_t *json = json_pack("{s:s, s:s, s:s, s:s, s:s}", "finding", finding->name, "quantity",
                             finding->quantity->name, "mask", finding->mask, "verdict",
                             finding->verdict, "text", finding->text);
    for (int i = 0; i < NEPH_FINDING_NUMBERS && finding->numbers[i].key; i++)
        neph_json_set(&json, finding->numbers[i].key,
                      finding->numbers[i].is_count
                          ? json_integer((json_int_t)finding->numbers[i].value)
                          : neph_json_number(finding->numbers[i].value));
    if (finding->has_interval)
        neph_json_set(&json, "interval",
                      isfinite(finding->low) && isfinite(finding->high)
                          ? json_pack("[f,f]", finding->low, finding->high)
                          : json_null());
    if (finding->clipped.bound != NEPH_BOUND_NONE)
        neph_json_set(&json, "clipped", neph_clipped_json(&finding->clipped));
    return json;
}

json_t *neph_findings_json(const struct neph_findings *findings)
{
    json_t *json = json_array();
    for (int i = 0; i < findings->count; i++)
        neph_json_add(&json, finding_json(&findings->list[i]));
    return json;
}
