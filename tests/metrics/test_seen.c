/* SPDX-License-Identifier: MIT
 *
 * Visible flicker, against consequences of the model of the eye (metrics/eye.h): a sine at the
 * threshold has the contrast 1, whatever its spatial shape.
 */
#include "tests/metrics/extractor_test.h"
#include "tests/metrics/metrics_test.h"

#include "metrics/extractors/extractors.h"
#include "metrics/extractors/seen_disks.h"
#include "metrics/extractors/seen_gain.h"
#include "metrics/extractors/seen_spectrum.h"
#include "metrics/eye.h"

#include <sched.h>

/* ---- stimuli --------------------------------------------------------------------------------- */

enum shape { FIELD, DISK, GRATING, NOISE, STEP, RAMP, SERIES };

static const double mean_light = 0.5; /* of white */

/* Light = mean (1 + contrast m(x, y, t)). */
struct stimulus {
    enum shape shape;
    int width_px, height_px, frame_count;
    struct neph_viewing viewing;
    double contrast, hertz, phase;
    double cycles_per_degree;     /* of a grating, along x */
    double x_px, y_px, radius_px; /* of a disk */
    bool in_both;                 /* the reference has it, too */
    const double *series;         /* m by frame, equal in all pixels */
};

static double modulation(const struct stimulus *s, int x, int y, int t)
{
    const double turn = s->hertz * t / s->viewing.frame_rate_hz;
    const double sine = cos(2.0 * M_PI * turn + s->phase);
    uint64_t random = ((uint64_t)t << 40) + ((uint64_t)y << 20) + (uint64_t)x;
    switch (s->shape) {
    case FIELD:
        return sine;
    case DISK:
        return hypot(x - s->x_px, y - s->y_px) <= s->radius_px ? sine : 0.0;
    case GRATING:
        return sine * cos(2.0 * M_PI * s->cycles_per_degree * (x - s->width_px / 2) /
                          s->viewing.pixels_per_degree);
    case NOISE:
        return neph_test_uniform(&random, -1.0, 1.0);
    case STEP:
        return t < s->frame_count / 2 ? 0.0 : 1.0;
    case RAMP:
        return (double)t / s->frame_count - 0.5;
    case SERIES:
        return s->series[t];
    }
    return 0.0;
}

static void fill(const struct stimulus *s, bool moves, int t, float *plane)
{
    for (int y = 0; y < s->height_px; y++)
        for (int x = 0; x < s->width_px; x++)
            *plane++ = (float)(mean_light *
                               (1.0 + (moves ? s->contrast * modulation(s, x, y, t) : 0.0)));
}

/* All frames, after `warm_up` black ones that are ignored. End with extraction_end(). */
static struct extraction run_after(const struct stimulus *s, int warm_up)
{
    char assignment[32];
    snprintf(assignment, sizeof(assignment), "warm_up=%d", warm_up);
    const char *const assignments[] = {assignment, NULL};
    const size_t pixel_count = (size_t)s->width_px * (size_t)s->height_px;
    float *test = malloc(pixel_count * sizeof(*test));
    float *reference = malloc(pixel_count * sizeof(*reference));
    assert_true(test && reference);
    struct neph_frame_pair pair = {.quantity = neph_quantity_find("radiance"),
                                   .width_px = s->width_px,
                                   .height_px = s->height_px,
                                   .plane_count = 3,
                                   .reference = {reference, reference, reference},
                                   .test = {test, test, test},
                                   .scene_mean = mean_light,
                                   .frame_count = s->frame_count + warm_up,
                                   .viewing = &s->viewing};
    struct extraction extraction = extraction_begin(&neph_extractor_seen, &pair, assignments);
    memset(test, 0, pixel_count * sizeof(*test));
    memset(reference, 0, pixel_count * sizeof(*reference));
    for (pair.frame = 0; pair.frame < s->frame_count + warm_up; pair.frame++) {
        if (pair.frame >= warm_up) {
            fill(s, true, pair.frame - warm_up, test);
            fill(s, s->in_both, pair.frame - warm_up, reference);
        }
        extraction_frame(&extraction, &pair);
    }
    extraction_flush(&extraction);
    free(test);
    free(reference);
    return extraction;
}

static struct extraction run(const struct stimulus *s)
{
    return run_after(s, 0);
}

static double *map_of(const struct extraction *extraction, const char *name)
{
    return extraction_map(extraction, extraction_map_index(extraction->extractor, name));
}

static double at(const struct extraction *extraction, const char *name, int x, int y)
{
    double *map = map_of(extraction, name);
    const double value = map[y * extraction->width_px + x];
    free(map);
    return value;
}

static double largest_of(const struct extraction *extraction, const char *name)
{
    double *map = map_of(extraction, name), most = -INFINITY;
    for (int i = 0; i < extraction->width_px * extraction->height_px; i++)
        most = fmax(most, map[i]);
    free(map);
    return most;
}

static struct neph_viewing viewing_at(double frame_rate_hz, double pixels_per_degree)
{
    return (struct neph_viewing){.frame_rate_hz = frame_rate_hz,
                                 .pixels_per_degree = pixels_per_degree,
                                 .white_cd_per_m2 = 100.0};
}

/* Contrast at threshold of a sine in frames, over a disk. The display, which holds its frames,
 * attenuates the sine relative to a lamp. At half of the rate frames alternate, and the fundamental
 * is 4 / pi of them. */
static double threshold(double hertz, double frame_rate_hz, double radius_deg)
{
    const double x = M_PI * hertz / frame_rate_hz;
    const double held = 2.0 * hertz == frame_rate_hz ? 4.0 / M_PI : sin(x) / x;
    return 1.0 / (held * neph_eye_sensitivity(hertz, 100.0 * mean_light, radius_deg));
}

static const double rates_hz[] = {30.0, 60.0}, sines_hz[] = {7.5, 15.0};

/* ---- a sine at threshold has the contrast 1 -------------------------------------------------- */

/* 8 by 4.5 degrees, which is treated as a disk of 3.4. */
static void test_full_field(void **state)
{
    for (int i = 0; i < 4; i++) {
        const double rate = rates_hz[i / 2], hertz = sines_hz[i % 2];
        const struct stimulus s = {
            .shape = FIELD,
            .width_px = 160,
            .height_px = 90,
            .frame_count = 64,
            .viewing = viewing_at(rate, 20.0),
            .contrast = threshold(hertz, rate, sqrt(160.0 * 90.0 / M_PI) / 20.0),
            .hertz = hertz,
        };
        struct extraction found = run(&s);
        neph_assert_close(extraction_scalar(&found, "coherent_contrast"), 1.0, 0.01, 0.0);
        neph_assert_close(at(&found, "seen_contrast", 80, 45), 1.0, 0.01, 0.0);
        neph_assert_close(at(&found, "seen_p", 80, 45), 0.5, 0.01, 0.0);
        neph_assert_close(extraction_scalar(&found, "coherent_hz"), hertz, 0.01, 0.05);
        neph_assert_close(extraction_scalar(&found, "seen_hz"), hertz, 0.01, 0.05);
        assert_true(extraction_scalar(&found, "coherent_radius") > 1.0);
        extraction_end(&found);
    }
}

/* In the middle of the frame, at a disk of the grid. */
static void test_disk(void **state)
{
    for (int i = 0; i < 4; i++) {
        const double rate = rates_hz[i / 2], hertz = sines_hz[i % 2];
        const struct stimulus s = {
            .shape = DISK,
            .width_px = 165,
            .height_px = 95,
            .frame_count = 64,
            .viewing = viewing_at(rate, 15.0),
            .contrast = threshold(hertz, rate, 1.0),
            .hertz = hertz,
            .x_px = 82,
            .y_px = 47,
            .radius_px = 15.0,
        };
        struct extraction found = run(&s);
        neph_assert_close(largest_of(&found, "seen_contrast"), 1.0, 0.02, 0.0);
        neph_assert_close(at(&found, "seen_contrast", 82, 47), 1.0, 0.02, 0.0);
        neph_assert_close(extraction_scalar(&found, "coherent_contrast"), 1.0, 0.02, 0.0);
        neph_assert_close(extraction_scalar(&found, "coherent_radius"), 1.0, 1e-12, 0.0);
        assert_true(at(&found, "seen_contrast", 10, 10) < 0.1);
        neph_assert_close(extraction_scalar(&found, "worst_tile_x"), 82.0, 0.0, 12.0);
        neph_assert_close(extraction_scalar(&found, "worst_tile_y"), 47.0, 0.0, 12.0);
        extraction_end(&found);
    }
}

/* At a bar in the middle, as mirroring bends gratings; the filter of seen_spatial.h is accurate to
 * 3.5 %. */
static void test_gratings(void **state)
{
    static const double gratings_cpd[] = {2.0, 7.5, 15.0};
    for (int i = 0; i < 12; i++) {
        const double rate = rates_hz[i / 6], hertz = sines_hz[i / 3 % 2], rho = gratings_cpd[i % 3];
        const struct stimulus s = {
            .shape = GRATING,
            .width_px = 120,
            .height_px = 24,
            .frame_count = 64,
            .viewing = viewing_at(rate, 60.0),
            .contrast = threshold(hertz, rate, 1.0) / neph_eye_spatial(rho),
            .hertz = hertz,
            .cycles_per_degree = rho,
        };
        struct extraction found = run(&s);
        neph_assert_close(at(&found, "seen_contrast", 60, 12), 1.0, 0.035, 0.0);
        extraction_end(&found);
    }
}

/* A signal that four-frame flicker missed: 10 % in a cycle of 8 frames at 60 frames a second. */
static void test_cycle_of_eight(void **state)
{
    const struct stimulus s = {.shape = FIELD,
                               .width_px = 96,
                               .height_px = 54,
                               .frame_count = 64,
                               .viewing = viewing_at(60.0, 60.0),
                               .contrast = 0.1,
                               .hertz = 7.5};
    struct extraction found = run(&s);
    const double contrast = at(&found, "seen_contrast", 48, 27);
    print_message("10 %% at 7.5 Hz: %.1f times the threshold\n", contrast);
    assert_true(contrast > 12.0 && contrast < 40.0);
    neph_assert_close(extraction_scalar(&found, "seen_period"), 8.0, 0.02, 0.0);
    extraction_end(&found);
}

/* ---- spectrum -------------------------------------------------------------------------------- */

/* A line keeps its energy at any position between the bins, and for any number of frames. */
static void test_lines_between_bins(void **state)
{
    static const int frame_counts[] = {16, 17, 40, 64, 100, 127, 256, 300};
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 8; k++) {
            if ((i + k) % neph_test_path_step() != 0)
                continue;
            const int n = frame_counts[i];
            const double hertz = 6.0 + 0.37 * k;
            const struct stimulus s = {.shape = FIELD,
                                       .width_px = 5,
                                       .height_px = 3,
                                       .frame_count = n,
                                       .viewing = viewing_at(30.0, 20.0),
                                       .contrast = 3.0 * threshold(hertz, 30.0, 1.0),
                                       .hertz = hertz,
                                       .phase = k};
            struct extraction found = run(&s);
            /* The lobe of few frames is wide, and the eye's weight is not constant in it. */
            neph_assert_close(at(&found, "seen_contrast", 2, 1), 3.0, n < 40 ? 0.06 : 0.01, 0.0);
            neph_assert_close(at(&found, "seen_hz", 2, 1), hertz, 0.0, 8.0 / n);
            extraction_end(&found);
        }
}

/* Energies by the sums of their definition, in double precision. */
static void test_energies(void **state)
{
    enum { L = NEPH_SEEN_LANES, N_MAX = 100 };
    static const int frame_counts[] = {3, 16, 33, 64, N_MAX};
    static float series[N_MAX * L], energies[L * (128 / 2 + 1)];
    uint64_t random = 5;
    for (int i = 0; i < N_MAX * L; i++)
        series[i] = (float)neph_test_uniform(&random, -1.0, 1.0);
    for (int i = 0; i < 5; i++) {
        const int n = frame_counts[i];
        struct neph_arena memory = {0};
        struct neph_seen_window window;
        neph_assert_ok(neph_seen_window_create(n, &memory, &window, NULL), NULL);
        float *room = malloc(neph_seen_room(&window) * sizeof(*room));
        neph_seen_spectrum(&window, series, L, room, energies);
        for (int lane = 0; lane < L; lane += 5) {
            double weight_sum = 0.0, mean = 0.0, slope = 0.0, slope_sum = 0.0, total = 0.0;
            double w[N_MAX], x[N_MAX], variance = 0.0;
            for (int t = 0; t < n; t++) {
                w[t] = pow(sin(M_PI * (t + 0.5) / n), 2.0);
                x[t] = (double)series[t * L + lane];
                weight_sum += w[t] * w[t];
                mean += w[t] * w[t] * x[t];
                slope += w[t] * w[t] * x[t] * (t - 0.5 * (n - 1));
                slope_sum += w[t] * w[t] * (t - 0.5 * (n - 1)) * (t - 0.5 * (n - 1));
            }
            for (int t = 0; t < n; t++) {
                x[t] = w[t] * (x[t] - mean / weight_sum - slope / slope_sum * (t - 0.5 * (n - 1)));
                variance += x[t] * x[t] / weight_sum;
            }
            for (int k = 0; k < window.bin_count; k++) {
                double re = 0.0, im = 0.0;
                for (int t = 0; t < n; t++) {
                    re += x[t] * cos(2.0 * M_PI * k * t / window.padded_count);
                    im += x[t] * sin(2.0 * M_PI * k * t / window.padded_count);
                }
                const double sides = k == 0 || 2 * k == window.padded_count ? 2.0 : 4.0;
                neph_assert_close((double)energies[k * L + lane],
                                  sides * (re * re + im * im) / (window.padded_count * weight_sum),
                                  1e-5, 1e-6);
                total += (double)energies[k * L + lane];
            }
            neph_assert_close(total, 2.0 * variance, 1e-5, 0.0);
        }
        free(room);
        neph_arena_finish(&memory);
    }
}

/* Noise gives one value for any number of frames, within its own scatter. */
static void test_noise(void **state)
{
    double contrast[2];
    for (int i = 0; i < 2; i++) {
        const struct stimulus s = {.shape = NOISE,
                                   .width_px = 100,
                                   .height_px = 60,
                                   .frame_count = i ? 200 : 64,
                                   .viewing = viewing_at(30.0, 60.0),
                                   .contrast = 0.05};
        struct extraction found = run(&s);
        double *map = map_of(&found, "seen_contrast"), sum = 0.0;
        for (int k = 0; k < 6000; k++)
            sum += map[k] * map[k] / 6000.0;
        contrast[i] = sqrt(sum);
        free(map);
        extraction_end(&found);
    }
    neph_assert_close(contrast[1], contrast[0], 0.03, 0.0);
}

/* Below 0.5 Hz there is no flicker: a ramp of 20 %, and a wave of 20 % in eight seconds, of which
 * the window leaves a hundredth of its value at 2 Hz. */
static void test_drift(void **state)
{
    for (int i = 0; i < 2; i++) {
        const struct stimulus s = {.shape = i ? FIELD : RAMP,
                                   .width_px = 20,
                                   .height_px = 10,
                                   .frame_count = 240,
                                   .viewing = viewing_at(30.0, 20.0),
                                   .contrast = 0.2,
                                   .hertz = 0.125};
        struct extraction found = run(&s);
        assert_true(largest_of(&found, "seen_contrast") < (i ? 0.1 : 1e-4));
        assert_true(largest_of(&found, "pop_p") < 0.1);
        extraction_end(&found);
    }
}

/* ---- pops ------------------------------------------------------------------------------------ */

/* The response to a step is its height in cd/m2; a step of the reference is no pop. */
static void test_pops(void **state)
{
    for (int in_both = 0; in_both < 2; in_both++) {
        const struct stimulus s = {.shape = STEP,
                                   .width_px = 40,
                                   .height_px = 30,
                                   .frame_count = 32,
                                   .viewing = viewing_at(60.0, 20.0),
                                   .contrast = 0.3,
                                   .in_both = in_both};
        struct extraction found = run(&s);
        neph_assert_close(at(&found, "pop_p", 20, 15),
                          in_both ? 0.0 : neph_eye_pop_seen(100.0 * mean_light * 0.3), 1e-4, 0.0);
        extraction_end(&found);
    }
}

/* The filter itself, sampled at twice the rate between the samples, over a random series that is
 * constant before and after. */
static void test_pops_by_their_definition(void **state)
{
    enum { N = 24, MARGIN = 200 };
    static const double frame_rates_hz[] = {24.0, 60.0, 120.0};
    double series[N];
    uint64_t random = 11;
    for (int t = 0; t < N; t++)
        series[t] = neph_test_uniform(&random, -1.0, 1.0);
    for (int i = 0; i < 3; i++) {
        const double step_s = 0.5 / frame_rates_hz[i];
        double norm = 0.0, largest = 0.0;
        for (int k = 0; k < MARGIN; k++)
            norm += exp(-(k + 0.5) * step_s / NEPH_EYE_EDGE_S);
        for (int between = 1; between < 2 * N; between++) {
            double response = 0.0;
            for (int k = 0; k < MARGIN; k++) {
                const int before = (int)fmax(between - 1 - k, 0);
                const int after = (int)fmin(between + k, 2 * N - 1);
                response += exp(-(k + 0.5) * step_s / NEPH_EYE_EDGE_S) / norm *
                            (series[before / 2] - series[after / 2]);
            }
            largest = fmax(largest, fabs(response));
        }
        const struct stimulus s = {.shape = SERIES,
                                   .width_px = 3,
                                   .height_px = 2,
                                   .frame_count = N,
                                   .viewing = viewing_at(frame_rates_hz[i], 20.0),
                                   .contrast = 0.4,
                                   .series = series};
        struct extraction found = run(&s);
        neph_assert_close(at(&found, "pop_p", 1, 1),
                          neph_eye_pop_seen(100.0 * mean_light * 0.4 * largest), 1e-5, 0.0);
        extraction_end(&found);
    }
}

/* ---- disks ----------------------------------------------------------------------------------- */

static void test_disks(void **state)
{
    enum { W = 70, H = 50 };
    const struct neph_seen_disks disks = neph_seen_disks_of(W, H, 10.0);
    double *sums = calloc(H * (W + 1), sizeof(*sums));
    float *means = calloc((size_t)disks.disk_count, sizeof(*means));
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++)
            sums[y * (W + 1) + x + 1] = sums[y * (W + 1) + x] + 3.0 * x + y;
    neph_assert_ok(neph_seen_disk_means(&disks, sums, means, NULL), NULL);
    /* The value of a linear ramp at the centre of a whole disk is its average. */
    const struct neph_seen_grid *one = &disks.grids[0];
    const int middle = one->rows / 2 * one->columns + one->columns / 2;
    const double x_px = floor((one->columns / 2 + 0.5) * W / one->columns);
    const double y_px = floor((one->rows / 2 + 0.5) * H / one->rows);
    neph_assert_close((double)means[middle], 3.0 * x_px + y_px, 1e-6, 0.0);
    neph_assert_close(neph_seen_cut_radius_deg(&disks, middle), 1.0, 0.02, 0.0);
    /* The largest disk covers the frame. */
    const int last = disks.disk_count - 1;
    assert_int_equal(disks.grids[2].first, last);
    neph_assert_close((double)means[last], 3.0 * 34.5 + 24.5, 1e-6, 0.0);
    neph_assert_close(neph_seen_cut_radius_deg(&disks, last), sqrt(W * H / M_PI) / 10.0, 1e-12,
                      0.0);
    free(sums);
    free(means);
}

/* The same change is more visible in phase than with a different phase in every pixel. */
static void test_in_phase_is_seen_better(void **state)
{
    struct stimulus s = {.shape = FIELD,
                         .width_px = 160,
                         .height_px = 90,
                         .frame_count = 32,
                         .viewing = viewing_at(30.0, 20.0),
                         .contrast = 0.05,
                         .hertz = 7.5};
    struct extraction together = run(&s);
    s.shape = GRATING;
    s.cycles_per_degree = 5.0;
    struct extraction apart = run(&s);
    const double whole = extraction_scalar(&together, "coherent_contrast");
    assert_true(whole > 1.3 * largest_of(&apart, "seen_contrast"));
    assert_true(whole > 20.0 * extraction_scalar(&apart, "coherent_contrast"));
    extraction_end(&together);
    extraction_end(&apart);
}

/* ---- conventions ----------------------------------------------------------------------------- */

static void test_stillness(void **state)
{
    const struct stimulus s = {.shape = FIELD,
                               .width_px = 20,
                               .height_px = 10,
                               .frame_count = 16,
                               .viewing = viewing_at(30.0, 20.0),
                               .contrast = 0.3,
                               .hertz = 7.0,
                               .in_both = true};
    struct extraction found = run(&s);
    double value;
    assert_true(largest_of(&found, "seen_contrast") == 0.0);
    assert_true(isnan(at(&found, "seen_hz", 3, 3)));
    assert_string_equal(neph_extractor_seen.scalar(found.state, 0, &value),
                        "nothing moves that the reference does not");
    assert_true(extraction_scalar(&found, "coherent_contrast") == 0.0);
    neph_assert_close(extraction_scalar(&found, "seen_frames"), 16.0, 0.0, 0.0);
    extraction_end(&found);
}

static void test_obstacles(void **state)
{
    const struct neph_viewing viewing = NEPH_VIEWING_DEFAULTS;
    const struct neph_settings settings = neph_options_default(neph_extractor_seen.options);
    struct neph_frame_pair pair = {.frame_count = 15, .viewing = &viewing};
    assert_non_null(strstr(neph_extractor_seen.obstacle(&pair, &settings), "16 frames"));
    pair.frame_count = 0;
    assert_non_null(strstr(neph_extractor_seen.obstacle(&pair, &settings), "not known"));
    pair.frame_count = 16;
    assert_null(neph_extractor_seen.obstacle(&pair, &settings));
}

static void assert_same_bits(const struct extraction *one, const struct extraction *other)
{
    const size_t size = (size_t)one->width_px * (size_t)one->height_px * sizeof(double);
    for (int map = 0; map < neph_extractor_seen.map_count; map++) {
        double *a = extraction_map(one, map), *b = extraction_map(other, map);
        assert_memory_equal(a, b, size);
        free(a);
        free(b);
    }
    for (const struct neph_metric *m = neph_extractor_seen.metrics; m->name; m++)
        if (m->pool == NEPH_POOL_SCALAR)
            assert_true(extraction_scalar(one, m->name) == extraction_scalar(other, m->name));
}

static void test_warm_up_is_as_if_it_were_not(void **state)
{
    const struct stimulus s = {.shape = NOISE,
                               .width_px = 37,
                               .height_px = 12,
                               .frame_count = 21,
                               .viewing = viewing_at(24.0, 20.0),
                               .contrast = 0.5};
    struct extraction plain = run(&s), after = run_after(&s, 7);
    assert_same_bits(&plain, &after);
    extraction_end(&plain);
    extraction_end(&after);
}

/* Through the meter, over a mask: Minkowski's mean of R and the shares match the maps. */
static void test_numbers_over_a_mask(void **state)
{
    enum { W = 40, H = 24, N = 16 };
    struct neph_image *images[2];
    float *planes[2][3];
    for (int i = 0; i < 2; i++) {
        images[i] = create_image(W, H);
        neph_assert_ok(neph_image_add_rgb(images[i], NULL, planes[i], NULL), NULL);
    }
    float *inside = add_channel(images[0], "mask.left", NULL);
    for (int k = 0; k < W * H; k++)
        inside[k] = k % W < 11;
    struct neph_mask *masks[2] = {create_mask(images[0], "all"), create_mask(images[0], "left")};
    const struct neph_meter_choice choice = {&neph_extractor_seen,
                                             neph_options_default(neph_extractor_seen.options)};
    const struct neph_meter_params params = {
        .choices = &choice,
        .choice_count = 1,
        .viewing = viewing_at(30.0, 20.0),
        .masks = (const struct neph_mask *const *)masks,
        .mask_count = 2,
        .frame_count = N,
    };
    struct neph_meter *meter = NULL;
    neph_assert_ok(neph_meter_create(&params, &meter, NULL), NULL);
    uint64_t random = 3;
    for (int t = 0; t < N; t++) {
        for (int k = 0; k < W * H; k++)
            for (int c = 0; c < 3; c++) {
                planes[0][c][k] = 0.4f;
                planes[1][c][k] = (float)(0.4 +
                                          0.0008 * (k % W) * neph_test_uniform(&random, -1.0, 1.0));
            }
        neph_assert_ok(neph_meter_frame(meter, images[0], NULL, images[1], NULL), NULL);
    }
    neph_assert_ok(neph_meter_finish(meter, NULL), NULL);
    struct neph_image *contrast = NULL, *seen = NULL;
    const struct neph_quantity *radiance = neph_quantity_find("radiance");
    neph_assert_ok(neph_meter_map(meter, radiance, &neph_extractor_seen, 0, &contrast, NULL), NULL);
    neph_assert_ok(neph_meter_map(meter, radiance, &neph_extractor_seen, 2, &seen, NULL), NULL);
    double power = 0.0, share = 0.0, n = 0.0;
    for (int k = 0; k < W * H; k++) {
        if (inside[k] == 0.0f)
            continue;
        power += pow((double)neph_image_channel(contrast, "Y")[k], 4.0);
        share += neph_image_channel(seen, "Y")[k] > 0.5f;
        n += 1.0;
    }
    int count = 0, found = 0;
    const struct neph_measurement *all = neph_meter_measurements(meter, &count);
    for (int i = 0; i < count; i++) {
        if (strcmp(all[i].mask, "left") != 0)
            continue;
        if (strcmp(all[i].metric->name, "seen_contrast") == 0 && ++found)
            neph_assert_close(all[i].value, pow(power / n, 0.25), 1e-6, 0.0);
        if (strcmp(all[i].metric->name, "seen_share") == 0 && ++found)
            neph_assert_close(all[i].value, share / n, 1e-12, 0.0);
    }
    assert_int_equal(found, 2);
    assert_true(power > 0.0);
    neph_meter_destroy(meter);
    for (int i = 0; i < 2; i++) {
        neph_mask_destroy(masks[i]);
        neph_image_destroy(images[i]);
    }
    neph_image_destroy(contrast);
    neph_image_destroy(seen);
}

static void allow_processors(const cpu_set_t *allowed)
{
    assert_int_equal(sched_setaffinity(0, sizeof(*allowed), allowed), 0);
}

static void test_bits_do_not_depend_on_threads(void **state)
{
    const struct stimulus s = {.shape = NOISE,
                               .width_px = 70,
                               .height_px = 37,
                               .frame_count = 20,
                               .viewing = viewing_at(30.0, 20.0),
                               .contrast = 0.5};
    cpu_set_t all, one;
    assert_int_equal(sched_getaffinity(0, sizeof(all), &all), 0);
    CPU_ZERO(&one);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; cpu++)
        if (CPU_ISSET(cpu, &all))
            CPU_SET(cpu, &one);
    struct extraction many = run(&s);
    allow_processors(&one);
    struct extraction single = run(&s);
    allow_processors(&all);
    assert_same_bits(&many, &single);
    extraction_end(&many);
    extraction_end(&single);
}

static void test_table(void **state)
{
    extraction_check_table(&neph_extractor_seen);
    assert_ptr_equal(neph_extractor_find("seen"), &neph_extractor_seen);
}

#include "tests/main.h"
