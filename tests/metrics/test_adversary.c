/* SPDX-License-Identifier: MIT
 *
 * Attempts to obtain a low score of flicker without less flicker: a search over jitter lengths,
 * holds and waveforms. The score is compared with the light's Fourier series, weighted by the eye's
 * sensitivity to each term. Results of a search are named cases.
 */
#include "tests/metrics/extractor_test.h"

#include "metrics/extractors/cycle_frequency.h"
#include "metrics/extractors/extractors.h"
#include "metrics/eye.h"

enum { W = 6, H = 6, LENGTH_MAX = 16, HOLD_MAX = 4, PERIOD_MAX = LENGTH_MAX * HOLD_MAX };

/* A waveform of `length` values, each displayed for `hold` frames. */
struct dodge {
    int length, hold;
    double values[LENGTH_MAX]; /* of mean 0 */
    double cycle_count;        /* displayed cycles, at least */
    double frame_rate_hz;
};

static int period_of(const struct dodge *dodge)
{
    return dodge->length * dodge->hold;
}

static int frames_of(const struct dodge *dodge)
{
    return (int)fmax(64.0, dodge->cycle_count * period_of(dodge));
}

static double value_at(const struct dodge *dodge, int t)
{
    return dodge->values[t / dodge->hold % dodge->length];
}

static void center(struct dodge *dodge)
{
    double mean = 0.0;
    for (int i = 0; i < dodge->length; i++)
        mean += dodge->values[i] / (double)dodge->length;
    for (int i = 0; i < dodge->length; i++)
        dodge->values[i] -= mean;
}

/* ---- the light ------------------------------------------------------------------------------- */

/* Amplitude of term m of the light's Fourier series: a display holds its frames, and repeats the
 * spectrum of the frames above half of its rate. */
static double amplitude_of(const struct dodge *dodge, int m)
{
    const int period = period_of(dodge);
    const double x = M_PI * m / period;
    double re = 0.0, im = 0.0;
    for (int t = 0; t < period; t++) {
        re += value_at(dodge, t) * cos(2.0 * M_PI * (m * t % period) / period) / period;
        im += value_at(dodge, t) * sin(2.0 * M_PI * (m * t % period) / period) / period;
    }
    return 2.0 * hypot(re, im) * fabs(sin(x) / x);
}

/* Variance of the displayed frames about their mean. */
static double variance_of(const struct dodge *dodge, int frame_count)
{
    double sum = 0.0, squares = 0.0;
    for (int t = 0; t < frame_count; t++) {
        sum += value_at(dodge, t) / frame_count;
        squares += value_at(dodge, t) * value_at(dodge, t) / frame_count;
    }
    return squares - sum * sum;
}

static const double mean_light = 0.5, white_cd_per_m2 = 100.0;

/* Contrast of a disk of one degree, relative to its threshold. */
static double seen_by_the_eye(const struct dodge *dodge)
{
    const int period = period_of(dodge);
    double sum = 0.0;
    for (int m = 1; m < 2 * period; m++) {
        const double hertz = dodge->frame_rate_hz * m / period;
        const double seen = amplitude_of(dodge, m) *
                            neph_eye_sensitivity(hertz, white_cd_per_m2 * mean_light, 1.0);
        sum += hertz >= NEPH_EYE_FLICKER_HZ ? seen * seen : 0.0;
    }
    return sqrt(sum);
}

/* ---- the metrics ----------------------------------------------------------------------------- */

/* The same light in the whole frame: visibility does not depend on position, nor the budget on
 * pixels. */
static struct extraction run(const struct neph_extractor *extractor, const struct dodge *dodge,
                             double contrast, const char *declared)
{
    const struct neph_viewing viewing = {.frame_rate_hz = dodge->frame_rate_hz,
                                         .pixels_per_degree = 60.0,
                                         .white_cd_per_m2 = white_cd_per_m2};
    float test[W * H], reference[W * H];
    struct neph_image *labels = NULL;
    neph_assert_ok(neph_image_create(W, H, &labels, NULL), NULL);
    if (declared)
        neph_assert_ok(neph_image_set_attribute(labels, NEPH_CYCLE_ATTRIBUTE, NULL, "%s", declared),
                       NULL);
    struct neph_frame_pair pair = {.quantity = neph_quantity_find("radiance"),
                                   .width_px = W,
                                   .height_px = H,
                                   .plane_count = 3,
                                   .reference = {reference, reference, reference},
                                   .test = {test, test, test},
                                   .reference_image = labels,
                                   .test_image = labels,
                                   .scene_mean = mean_light,
                                   .frame_count = frames_of(dodge),
                                   .viewing = &viewing};
    for (int i = 0; i < W * H; i++)
        reference[i] = (float)mean_light;
    struct extraction extraction = extraction_begin(extractor, &pair, NULL);
    for (pair.frame = 0; pair.frame < frames_of(dodge); pair.frame++) {
        for (int i = 0; i < W * H; i++)
            test[i] = (float)(mean_light * (1.0 + contrast * value_at(dodge, pair.frame)));
        extraction_frame(&extraction, &pair);
    }
    extraction_flush(&extraction);
    neph_image_destroy(labels);
    return extraction;
}

static double first_of(const struct extraction *extraction, const char *name)
{
    double *map = extraction_map(extraction, extraction_map_index(extraction->extractor, name));
    const double value = map[W / 2 + W * (H / 2)];
    free(map);
    return value;
}

static double seen_of(const struct dodge *dodge)
{
    struct extraction extraction = run(&neph_extractor_seen, dodge, 0.02, NULL);
    const double seen = first_of(&extraction, "seen_contrast") / 0.02;
    extraction_end(&extraction);
    return seen;
}

static double a4_of(const struct dodge *dodge)
{
    struct extraction extraction = run(&neph_extractor_flicker, dodge, 0.02, NULL);
    const double a4 = first_of(&extraction, "a4");
    extraction_end(&extraction);
    return a4;
}

/* The fraction of the light's power that is attributed to periods; and the sum of all parts as a
 * fraction of the variance of the displayed frames. */
static void budget_of(const struct dodge *dodge, const char *declared, double *named, double *all)
{
    const double contrast = 0.002; /* small: the display's curve is linear */
    struct extraction extraction = run(&neph_extractor_cycles, dodge, contrast, declared);
    const double step = 1.055 / 2.4 * pow(mean_light, 1.0 / 2.4 - 1.0) * mean_light * contrast;
    double sum = 0.0;
    for (int map = 0; map < neph_extractor_cycles.map_count; map++) {
        const char *name = neph_extractor_cycles.maps[map].name;
        if (!name || strncmp(name, "cycle_", 6) != 0 || !strstr(name, "_squared") ||
            strstr(name, "drift") || strstr(name, "noise"))
            continue;
        const double square = first_of(&extraction, name);
        sum += isnan(square) ? 0.0 : square;
    }
    const double rest = first_of(&extraction, "cycle_noise_squared") +
                        first_of(&extraction, "cycle_drift_squared") +
                        first_of(&extraction, "cycle_overlap");
    extraction_end(&extraction);
    *named = sum / (step * step * variance_of(dodge, period_of(dodge)));
    *all = (sum + rest) / (step * step * variance_of(dodge, frames_of(dodge)));
}

/* ---- search ---------------------------------------------------------------------------------- */

static struct dodge draw(uint64_t *random)
{
    static const double rates_hz[] = {24.0, 30.0, 60.0};
    struct dodge dodge = {
        .length = (int)neph_test_uniform(random, 2.0, LENGTH_MAX + 1.0),
        .hold = (int)neph_test_uniform(random, 1.0, HOLD_MAX + 1.0),
        .cycle_count = neph_test_uniform(random, 4.0, 8.0),
        .frame_rate_hz = rates_hz[(int)neph_test_uniform(random, 0.0, 3.0)],
    };
    for (int i = 0; i < dodge.length; i++)
        dodge.values[i] = neph_test_uniform(random, -1.0, 1.0);
    center(&dodge);
    return dodge;
}

/* A small change: of one value, the length, the hold, or the duration. */
static struct dodge change(const struct dodge *dodge, uint64_t *random)
{
    struct dodge changed = *dodge;
    const struct dodge other = draw(random);
    switch ((int)neph_test_uniform(random, 0.0, 4.0)) {
    case 0:
        changed.length = other.length;
        for (int i = dodge->length; i < changed.length; i++)
            changed.values[i] = other.values[i];
        break;
    case 1:
        changed.hold = other.hold;
        break;
    case 2:
        changed.cycle_count = other.cycle_count;
        break;
    default:
        changed.values[(int)neph_test_uniform(random, 0.0, changed.length)] = other.values[0];
    }
    center(&changed);
    return changed;
}

/* The lowest `score` of `count` tries: random ones first, then changes of the best. */
static struct dodge search(double (*score)(const struct dodge *), int count, uint64_t seed,
                           double *lowest)
{
    uint64_t random = seed;
    struct dodge best = draw(&random);
    *lowest = score(&best);
    for (int i = 1; i < count; i++) {
        const struct dodge tried = i < count / 2 ? draw(&random) : change(&best, &random);
        const double found = score(&tried);
        if (found < *lowest) {
            *lowest = found;
            best = tried;
        }
    }
    return best;
}

static void print_dodge(const char *what, const struct dodge *dodge, double score)
{
    print_message("%s: lowest %.4f by %d values for %d frames each, %d frames at %g Hz\n", what,
                  score, dodge->length, dodge->hold, frames_of(dodge), dodge->frame_rate_hz);
}

static double seen_over_the_eye(const struct dodge *dodge)
{
    return seen_of(dodge) / fmax(seen_by_the_eye(dodge), 1e-6);
}

/* Four times as many tries found 0.83: see the next test. */
static void test_nobody_gets_below_what_the_eye_sees(void **state)
{
    double lowest = 0.0;
    const struct dodge dodge = search(seen_over_the_eye, neph_test_paths(120), 7, &lowest);
    print_dodge("seen over what the eye sees", &dodge, lowest);
    assert_true(lowest > 0.9);
}

/* At the lower limit of flicker, half a hertz, half of a line counts as drift: found by the longest
 * of these searches. */
static void test_a_period_of_two_seconds_loses_little(void **state)
{
    uint64_t random = 12;
    struct dodge dodge = draw(&random);
    dodge.length = 12;
    dodge.hold = 4;
    dodge.frame_rate_hz = 24.0;
    for (int i = 0; i < dodge.length; i++)
        dodge.values[i] = cos(2.0 * M_PI * i / dodge.length);
    const double share = seen_over_the_eye(&dodge);
    print_message("half a hertz: seen over what the eye sees %.4f\n", share);
    assert_true(share > 0.6);
}

static double least_named(const struct dodge *dodge)
{
    char declared[32];
    double named, all;
    snprintf(declared, sizeof(declared), "jitter %d", period_of(dodge));
    budget_of(dodge, declared, &named, &all);
    return named;
}

/* A declared period gets its power, whatever its waveform. */
static void test_nobody_hides_a_declared_period(void **state)
{
    double lowest = 0.0;
    const struct dodge dodge = search(least_named, neph_test_paths(30), 8, &lowest);
    print_dodge("power that periods have by name", &dodge, lowest);
    assert_true(lowest > 0.98);
}

static double least_kept(const struct dodge *dodge)
{
    double named, all;
    budget_of(dodge, NULL, &named, &all);
    return -fabs(all - 1.0);
}

/* An undeclared period may be counted as noise, drift or another period, but it does not vanish. */
static void test_nobody_takes_out_of_the_budget(void **state)
{
    double lowest = 0.0;
    const struct dodge dodge = search(least_kept, neph_test_paths(30), 9, &lowest);
    print_dodge("kept in the budget, off by", &dodge, lowest);
    assert_true(lowest > -0.02);
}

/* ---- found cases ----------------------------------------------------------------------------- */

/* Halton's numbers of base 2, as used for jitter, with the same amplitude for any length. */
static struct dodge jitter_of(int length)
{
    struct dodge dodge = {
        .length = length, .hold = 1, .cycle_count = 256.0 / length, .frame_rate_hz = 30.0};
    for (int i = 0; i < length; i++) {
        double digit = 1.0;
        for (int n = i + 1; n > 0; n /= 2) {
            digit *= 0.5;
            dodge.values[i] += digit * (n % 2);
        }
    }
    center(&dodge);
    const double rms = sqrt(variance_of(&dodge, length));
    for (int i = 0; i < length; i++)
        dodge.values[i] /= rms;
    return dodge;
}

/* The waveform that four-frame flicker missed: 7 is coprime to 4. Visible flicker and the budget
 * change from 7 to 8 by the ratio of the eye's weights; four-frame flicker changes from nothing to
 * all. */
static void test_a_jitter_of_seven_hides_from_no_one(void **state)
{
    const struct dodge seven = jitter_of(7), eight = jitter_of(8);
    const double seen = seen_of(&eight) / seen_of(&seven);
    const double explained = seen_by_the_eye(&eight) / seen_by_the_eye(&seven);
    print_message("from 7 to 8: seen x %.4f, of which the eye explains x %.4f; a4 %.2g and %.2g\n",
                  seen, explained, a4_of(&seven), a4_of(&eight));
    neph_assert_close(seen, explained, 0.02, 0.0);
    assert_true(a4_of(&seven) < 0.01 * a4_of(&eight));
    for (int length = 7; length <= 8; length++) {
        const struct dodge jitter = jitter_of(length);
        double named, all;
        budget_of(&jitter, NULL, &named, &all);
        neph_assert_close(named, 1.0, 0.01, 0.0);
        neph_assert_close(all, 1.0, 0.01, 0.0);
    }
}

/* Eleven values held for three frames: a period of 33 is searched only if it is declared, and
 * otherwise counts as noise. */
static void test_a_held_jitter_is_noise_until_it_is_declared(void **state)
{
    struct dodge held = jitter_of(11);
    held.hold = 3;
    if (NEPH_TEST_EVERY > 1) /* a third of the frames: the same sums, enough for the sanitizers */
        held.cycle_count = 8.0;
    double named, all;
    budget_of(&held, "TAA jitter 33", &named, &all);
    neph_assert_close(named, 1.0, 0.01, 0.0);
    budget_of(&held, NULL, &named, &all);
    print_message("a period of 33 frames that nobody declares: %.2f of its power has a name\n",
                  named);
    neph_assert_close(all, 1.0, 0.01, 0.0);
    neph_assert_close(seen_of(&held) / seen_by_the_eye(&held), 1.0, 0.05, 0.0);
}

#include "tests/main.h"
