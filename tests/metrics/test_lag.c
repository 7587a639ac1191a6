/* SPDX-License-Identifier: MIT
 *
 * Lag and trails: filters with a step response in closed form.
 */
#include "tests/metrics/extractor_test.h"

#include "metrics/extractors/extractors.h"

enum { WIDTH = 7, HEIGHT = 5, PIXELS = WIDTH * HEIGHT };

/* ---- sequences of one value per pixel, as grey images ---------------------------------------- */

static struct neph_image *grey_image(const double values[PIXELS])
{
    struct neph_image *image = NULL;
    struct neph_diag diag = {0};
    float *planes[3];
    neph_assert_ok(neph_image_create(WIDTH, HEIGHT, &image, &diag), &diag);
    neph_assert_ok(neph_image_add_rgb(image, NULL, planes, &diag), &diag);
    for (int i = 0; i < PIXELS; i++)
        for (int c = 0; c < 3; c++)
            planes[c][i] = (float)values[i];
    return image;
}

static const struct neph_viewing viewing = {60.0, 67.0, 0.0, 100.0};

/* Begins at frame 0. */
static void feed(struct extraction *extraction, const char *const *assignments, int frame,
                 const struct neph_image *reference, const struct neph_image *test)
{
    const struct neph_frame_pair pair = extraction_pair(reference, NULL, test, "radiance", frame,
                                                        &viewing);
    if (frame == 0)
        *extraction = extraction_begin(&neph_extractor_lag, &pair, assignments);
    extraction_frame(extraction, &pair);
}

/* A reference that steps from `old` to `new` at frame 3, and a test in which `left(n, pixel)` of
 * the step remains in the n-th frame from then on. */
typedef double left_function(int n, int pixel);

static const double old_value = 0.25, new_value = 0.75;

static struct extraction run_step_with(left_function *left, int frames_after,
                                       const char *const *assignments)
{
    struct extraction extraction;
    double reference[PIXELS], test[PIXELS];
    for (int frame = 0; frame < 3 + frames_after; frame++) {
        for (int i = 0; i < PIXELS; i++) {
            reference[i] = frame < 3 ? old_value : new_value;
            test[i] = new_value + (old_value - new_value) * (frame < 3 ? 1.0 : left(frame - 2, i));
        }
        struct neph_image *r = grey_image(reference), *t = grey_image(test);
        feed(&extraction, assignments, frame, r, t);
        neph_image_destroy(r);
        neph_image_destroy(t);
    }
    extraction_flush(&extraction);
    return extraction;
}

static struct extraction run_step(left_function *left, int frames_after)
{
    static const char *const assignments[] = {"step_frame=3", NULL};
    return run_step_with(left, frames_after, assignments);
}

static void assert_map(const struct extraction *extraction, const char *name, int pixel,
                       double expected, double relative, double absolute)
{
    const int map = extraction_map_index(extraction->extractor, name);
    double *values = extraction_map(extraction, map);
    neph_assert_close(values[pixel], expected, relative, absolute);
    free(values);
}

/* ---- tests ----------------------------------------------------------------------------------- */

static const double alphas[4] = {0.05, 0.1, 0.2, 0.25};

/* Each phase has another weight. */
static double average_left(int n, int pixel)
{
    const int phase = (pixel % WIDTH & 1) + 2 * (pixel / WIDTH & 1);
    return pow(1.0 - alphas[phase], n);
}

/* The published half-lives of an ideal average. The remainder of 0.5 is stored as a float near
 * 0.75, so q is accurate to 3e-8 / 0.25; half-lives to this / 0.05 / 13 and less. The time to 1 %
 * has an uncertainty of 3e-8 / 0.005 / (90 * 0.05). */
static void test_exponential_average(void **state)
{
    static const double half_lives[4] = {13.5134, 6.5788, 3.1063, 2.4094};
    static const int pixel_of_phase[4] = {0, 1, WIDTH, WIDTH + 1};
    static const char *const scalars[4] = {"half_life_phase_0", "half_life_phase_1",
                                           "half_life_phase_2", "half_life_phase_3"};
    struct extraction extraction = run_step(average_left, 120);
    for (int k = 0; k < 4; k++) {
        const double rate = log(1.0 - alphas[k]);
        const int pixel = pixel_of_phase[k];
        neph_assert_close(log(0.5) / rate, half_lives[k], 0.0, 5e-5);
        assert_map(&extraction, "half_life", pixel, log(0.5) / rate, 1e-6, 0.0);
        assert_map(&extraction, "frames_to_10", pixel, log(0.1) / rate, 1e-6, 0.0);
        assert_map(&extraction, "frames_to_1", pixel, log(0.01) / rate, 2e-6, 0.0);
        assert_map(&extraction, "residual_16", pixel, pow(1.0 - alphas[k], 16.0), 1e-6, 1.2e-7);
        assert_map(&extraction, "overshoot", pixel, 0.0, 0.0, 0.0);
        neph_assert_close(extraction_scalar(&extraction, scalars[k]), log(0.5) / rate, 1e-6, 0.0);
    }
    extraction_end(&extraction);
}

/* Squares of 2 x 2 pixels that are traced together. */
static double slots_left(int n, int pixel)
{
    const int phase = (pixel % WIDTH / 2 & 1) + 2 * (pixel / WIDTH / 2 & 1);
    return pow(1.0 - alphas[phase], n);
}

static void test_slots(void **state)
{
    static const char *const assignments[] = {"step_frame=3", "slot_px=2", NULL};
    struct extraction extraction = run_step_with(slots_left, 40, assignments);
    neph_assert_close(extraction_scalar(&extraction, "half_life_phase_0"), log(0.5) / log(0.95),
                      1e-6, 0.0);
    neph_assert_close(extraction_scalar(&extraction, "half_life_phase_3"), log(0.5) / log(0.75),
                      1e-6, 0.0);
    extraction_end(&extraction);
}

/* An underdamped filter, s(n) = r^n cos(w n) with r = 0.9, w = pi / 4: its first trough is at n = 3
 * with r^3 cos(3 pi / 4), and 4 is deeper: r^4 cos(pi). */
static double ringing_left(int n, int pixel)
{
    (void)pixel;
    return pow(0.9, n) * cos(0.25 * M_PI * n);
}

/* |s| at n = 0..9: 1 .636 0 .515 .656 .418 0 .338 .430 .274: it is above a half for the last time
 * at n = 4, where s = -.6561, and s(5) = -.4175. */
static void test_overshoot(void **state)
{
    struct extraction extraction = run_step(ringing_left, 120);
    assert_map(&extraction, "overshoot", 3, pow(0.9, 4), 1e-6, 0.0);
    const double s4 = pow(0.9, 4), s5 = pow(0.9, 5) * sqrt(0.5);
    assert_map(&extraction, "half_life", 3, 4.0 + log(s4 / 0.5) / log(s4 / s5), 1e-6, 0.0);
    extraction_end(&extraction);
}

/* From 0.8 to -0.4: the straight line is at 0.5 after a quarter of a frame. */
static double crossing_left(int n, int pixel)
{
    (void)pixel;
    return n == 1 ? 0.8 : n == 2 ? -0.4 : 0.0;
}

static void test_change_of_sign(void **state)
{
    struct extraction extraction = run_step(crossing_left, 8);
    assert_map(&extraction, "half_life", 0, 1.25, 1e-6, 0.0);
    assert_map(&extraction, "overshoot", 0, 0.4, 1e-6, 0.0);
    /* The segment from -0.4 to exactly 0 crosses every limit at once. */
    assert_map(&extraction, "frames_to_10", 0, 2.0, 1e-6, 0.0);
    extraction_end(&extraction);
}

static double fade_left(int n, int pixel)
{
    (void)pixel;
    return fmax(0.0, 1.0 - n / 20.0);
}

/* A linear fade is at a half in its 10th frame, and at 1 - 18 / 20 in its 18th. */
static void test_fade(void **state)
{
    struct extraction extraction = run_step(fade_left, 30);
    /* q(10) = 0.5 may be rounded up: then the crossing is at most 1e-6 later. */
    assert_map(&extraction, "half_life", 5, 10.0, 0.0, 1e-5);
    assert_map(&extraction, "frames_to_10", 5, 18.0, 0.0, 1e-5);
    assert_map(&extraction, "residual_16", 5, 0.2, 1e-6, 0.0);
    extraction_end(&extraction);
}

static double instant_left(int n, int pixel)
{
    (void)n;
    (void)pixel;
    return 0.0;
}

static void test_no_lag(void **state)
{
    struct extraction extraction = run_step(instant_left, 16);
    static const char *const names[] = {"half_life", "frames_to_10", "frames_to_1", "residual_16",
                                        "overshoot"};
    for (int k = 0; k < 5; k++)
        assert_map(&extraction, names[k], PIXELS - 1, 0.0, 0.0, 0.0);
    extraction_end(&extraction);
}

static double never_left(int n, int pixel)
{
    if (pixel == 0)
        return 1.0; /* stuck */
    if (pixel == 1)
        return n % 2 == 0 ? 0.8 : 0.05; /* alternating; the last frame is high */
    return pixel == 2 ? 0.3 : pow(0.5, n);
}

static double metric_map_value(const struct extraction *extraction, const char *metric, int pixel)
{
    for (const struct neph_metric *m = extraction->extractor->metrics; m->name; m++) {
        if (strcmp(m->name, metric) != 0)
            continue;
        double *values = extraction_map(extraction, m->map);
        const double value = values[pixel];
        free(values);
        return m->pool == NEPH_POOL_SHARE_ABOVE ? value > m->parameter : value;
    }
    fail_msg("no metric '%s'", metric);
    return NAN;
}

/* Pixels that do not settle count with all frames and are reported in the shares. */
static void test_never_settles(void **state)
{
    struct extraction extraction = run_step(never_left, 20);
    assert_map(&extraction, "half_life", 0, 20.0, 0.0, 0.0);
    assert_map(&extraction, "half_life", 1, 20.0, 0.0, 0.0);
    assert_map(&extraction, "frames_to_10", 2, 20.0, 0.0, 0.0);
    assert_map(&extraction, "half_life", 3, 1.0, 0.0, 1e-6);
    static const char *const shares[3] = {"share_unsettled", "share_unsettled_10",
                                          "share_unsettled_1"};
    static const double expected[4][3] = {{1, 1, 1}, {1, 1, 1}, {0, 1, 1}, {0, 0, 0}};
    for (int pixel = 0; pixel < 4; pixel++)
        for (int k = 0; k < 3; k++)
            assert_true(metric_map_value(&extraction, shares[k], pixel) == expected[pixel][k]);
    extraction_end(&extraction);
}

/* ---- ghosts ---------------------------------------------------------------------------------- */

/* 0.8^10 = 0.107, 0.8^11 = 0.086; 0.9^21 = 0.109, 0.9^22 = 0.098; pixel 2 never changes, pixel 3
 * rises again, and pixel 4 settles long after the 32 frames. */
static double ghost_left(int n, int pixel)
{
    switch (pixel) {
    case 0:
        return pow(0.8, n);
    case 1:
        return pow(0.9, n);
    case 2:
        return 0.5;
    case 3:
        return n == 2 ? 0.0 : -0.3;
    case 4:
        return n < 39 ? 1.0 : 0.0;
    default:
        return 0.0;
    }
}

static void test_ghosts(void **state)
{
    static const char *const names[] = {"ghost_area_1",      "ghost_area_4",        "ghost_area_8",
                                        "ghost_area_16",     "share_never_settled", "step_share",
                                        "ghost_area_frames", "ghost_area_end"};
    static const double expected[6][8] = {{1, 1, 1, 0, 0, 1, 10, 0}, {1, 1, 1, 1, 0, 1, 21, 0},
                                          {1, 1, 1, 1, 1, 1, 32, 1}, {1, 1, 1, 1, 0, 1, 31, 1},
                                          {1, 1, 1, 1, 0, 1, 32, 0}, {0, 0, 0, 0, 0, 1, 0, 0}};
    struct extraction extraction = run_step(ghost_left, 40);
    for (int pixel = 0; pixel < 6; pixel++)
        for (int k = 0; k < 8; k++)
            neph_assert_close(metric_map_value(&extraction, names[k], pixel), expected[pixel][k],
                              0.0, 0.0);
    extraction_end(&extraction);
}

/* Values after the end are unknown; values before it are known. */
static void test_ghosts_of_a_short_sequence(void **state)
{
    struct extraction extraction = run_step(ghost_left, 9);
    assert_true(metric_map_value(&extraction, "ghost_area_8", 1) == 1.0);
    assert_true(isnan(metric_map_value(&extraction, "ghost_area_16", 1)));
    assert_true(isnan(metric_map_value(&extraction, "ghost_area_frames", 1)));
    assert_true(metric_map_value(&extraction, "share_never_settled", 4) == 1.0);
    extraction_end(&extraction);
}

/* ---- a moving reference ---------------------------------------------------------------------- */

/* Drifting clouds; their light is four times as strong from frame 3 on. */
static double drifting(int frame, int pixel, bool stepped)
{
    const double cloud = 0.3 + 0.2 * sin(0.9 * pixel - 0.35 * frame);
    return cloud * (stepped && frame >= 3 ? 0.4 : 0.1);
}

static struct extraction run_drift(const char *old, double alpha)
{
    const char *const assignments[] = {"step_frame=3", old, NULL};
    struct extraction extraction;
    for (int frame = 0; frame < 43; frame++) {
        double lit[PIXELS], unlit[PIXELS], late[PIXELS];
        for (int i = 0; i < PIXELS; i++) {
            lit[i] = drifting(frame, i, true);
            unlit[i] = drifting(frame, i, false);
            late[i] = lit[i] + pow(1.0 - alpha, frame < 3 ? 0 : frame - 2) * (unlit[i] - lit[i]);
        }
        struct neph_image *r = grey_image(lit), *u = grey_image(unlit), *t = grey_image(late);
        const struct neph_frame_pair pair = extraction_pair(r, u, t, "radiance", frame, &viewing);
        if (frame == 0)
            extraction = extraction_begin(&neph_extractor_lag, &pair, assignments);
        extraction_frame(&extraction, &pair);
        neph_image_destroy(r);
        neph_image_destroy(u);
        neph_image_destroy(t);
    }
    extraction_flush(&extraction);
    return extraction;
}

/* A renderer that moves with the clouds and follows their light as an average. With the step at the
 * same moment its half-life is the average's. With the first frame's step it is not, as other parts
 * of the cloud have moved in. */
static void test_step_of_a_moving_reference(void **state)
{
    const double half_life = log(0.5) / log(0.9);
    struct extraction moving = run_drift("old=second", 0.1);
    struct extraction fixed = run_drift("old=before", 0.1);
    double worst = 0.0;
    for (int i = 0; i < PIXELS; i++) {
        assert_map(&moving, "half_life", i, half_life, 1e-5, 0.0);
        assert_map(&moving, "frames_to_10", i, log(0.1) / log(0.9), 1e-5, 0.0);
        worst = fmax(worst, fabs(metric_map_value(&fixed, "half_life_p50", i) - half_life));
    }
    assert_true(worst > 3.0);
    extraction_end(&moving);
    extraction_end(&fixed);
}

/* A pixel that at some moment shows only surfaces without a step cannot be followed. */
static void test_step_that_drifts_away(void **state)
{
    static const char *const assignments[] = {"step_frame=1", "old=second", NULL};
    struct extraction extraction;
    for (int frame = 0; frame < 6; frame++) {
        double lit[PIXELS], unlit[PIXELS];
        for (int i = 0; i < PIXELS; i++) {
            unlit[i] = 0.2;
            lit[i] = frame < 1 || (i == 0 && frame == 4) ? 0.2 : 0.6;
        }
        struct neph_image *r = grey_image(lit), *u = grey_image(unlit);
        const struct neph_frame_pair pair = extraction_pair(r, u, u, "radiance", frame, &viewing);
        if (frame == 0)
            extraction = extraction_begin(&neph_extractor_lag, &pair, assignments);
        extraction_frame(&extraction, &pair);
        neph_image_destroy(r);
        neph_image_destroy(u);
    }
    extraction_flush(&extraction);
    assert_true(isnan(metric_map_value(&extraction, "half_life_p50", 0)));
    assert_true(metric_map_value(&extraction, "step_share", 0) == 0.0);
    assert_true(metric_map_value(&extraction, "ghost_area_1", 0) == 0.0);
    assert_true(metric_map_value(&extraction, "ghost_area_1", 1) == 1.0);
    assert_map(&extraction, "half_life", 1, 5.0, 0.0, 0.0);
    extraction_end(&extraction);
}

/* Pixels that do not step have no lag and do not contribute to means; a step below 1/255 of display
 * luma is none. The dark pixel steps by 1e-3, which is 12.92e-3 in luma; the bright one by 5e-3 at
 * 0.9, which is 0.0025. */
static void test_floor(void **state)
{
    static const char *const assignments[] = {"step_frame=1", NULL};
    struct extraction extraction;
    for (int frame = 0; frame < 4; frame++) {
        double reference[PIXELS], test[PIXELS];
        for (int i = 0; i < PIXELS; i++)
            reference[i] = test[i] = 0.5;
        reference[0] = frame ? 1e-3 : 2e-3;
        reference[1] = frame ? 0.9 : 0.905;
        reference[2] = frame ? 2.0 : 3.0; /* both beyond white */
        test[0] = 2e-3;
        test[1] = 0.905;
        test[2] = 3.0;
        struct neph_image *r = grey_image(reference), *t = grey_image(test);
        feed(&extraction, assignments, frame, r, t);
        neph_image_destroy(r);
        neph_image_destroy(t);
    }
    extraction_flush(&extraction);
    assert_map(&extraction, "half_life", 0, 3.0, 0.0, 0.0);
    double *values = extraction_map(&extraction, 0);
    for (int i = 0; i < PIXELS; i++)
        assert_true(isnan(values[i]) == (i != 0 && i != 2));
    free(values);
    /* Only two pixels step: phase 2 and 3 have none. */
    double value = 0.0;
    assert_non_null(neph_extractor_lag.scalar(extraction.state, 3, &value));
    extraction_end(&extraction);
}

static void test_obstacles(void **state)
{
    struct neph_settings settings = neph_options_default(neph_extractor_lag.options);
    assert_non_null(strstr(neph_extractor_lag.obstacle(NULL, &settings), "step_frame"));
    settings.values[0] = 0.0;
    assert_non_null(neph_extractor_lag.obstacle(NULL, &settings));
    settings.values[0] = 1.0;
    assert_null(neph_extractor_lag.obstacle(NULL, &settings));
    const struct neph_frame_pair alone = {.frame = 0};
    neph_assert_ok(
        neph_options_set(neph_extractor_lag.options, "lag", "old=second", &settings, NULL), NULL);
    assert_non_null(strstr(neph_extractor_lag.obstacle(&alone, &settings), "second reference"));
    extraction_check_table(&neph_extractor_lag);
    extraction_check_table(&neph_extractor_trail);
}

/* Without a step, an absence of ghosts is no good result. */
static void test_nothing_steps(void **state)
{
    static const char *const assignments[] = {"step_frame=1", NULL};
    struct extraction extraction;
    const double values[PIXELS] = {0.0};
    struct neph_image *image = grey_image(values);
    for (int frame = 0; frame < 40; frame++)
        feed(&extraction, assignments, frame, image, image);
    extraction_flush(&extraction);
    assert_true(metric_map_value(&extraction, "step_share", 0) == 0.0);
    assert_true(isnan(metric_map_value(&extraction, "ghost_area_frames", 0)));
    assert_true(isnan(metric_map_value(&extraction, "share_never_settled", 0)));
    extraction_end(&extraction);
    neph_image_destroy(image);
}

static void test_sequence_ends_before_the_step(void **state)
{
    static const char *const assignments[] = {"step_frame=9", NULL};
    struct extraction extraction;
    struct neph_diag diag = {0};
    const double values[PIXELS] = {0.0};
    struct neph_image *image = grey_image(values);
    feed(&extraction, assignments, 0, image, image);
    assert_int_equal(neph_extractor_lag.flush(extraction.state, &diag), NEPH_ERR_USAGE);
    assert_non_null(strstr(diag.message, "step_frame=9"));
    extraction_end(&extraction);
    neph_image_destroy(image);
}

/* ---- trails ---------------------------------------------------------------------------------- */

enum { TRAIL_WIDTH = 61, TRAIL_HEIGHT = 3, TRAIL_FRAMES = 40 };

/* A white card of 20 px on grey moves right at 2.5 px/frame; the test is an average of the past. */
static struct neph_image *card_image(int frame, float *history, double alpha)
{
    struct neph_image *image = NULL;
    float *planes[3], *card;
    assert_int_equal(neph_image_create(TRAIL_WIDTH, TRAIL_HEIGHT, &image, NULL), NEPH_OK);
    assert_int_equal(neph_image_add_rgb(image, NULL, planes, NULL), NEPH_OK);
    assert_int_equal(neph_image_add_channel(image, "mask.card", &card, NULL), NEPH_OK);
    for (int i = 0; i < TRAIL_WIDTH * TRAIL_HEIGHT; i++) {
        const int x = i % TRAIL_WIDTH;
        const bool covered = x >= 2.5 * frame && x < 2.5 * frame + 20.0;
        const double seen = covered ? 1.0 : 0.25;
        card[i] = covered ? 1.0f : 0.0f;
        if (history)
            history[i] = (float)(frame ? history[i] + alpha * (seen - history[i]) : seen);
        for (int c = 0; c < 3; c++)
            planes[c][i] = history ? history[i] : (float)seen;
    }
    return image;
}

static struct extraction run_trail(double alpha)
{
    float history[TRAIL_WIDTH * TRAIL_HEIGHT];
    struct extraction extraction;
    for (int frame = 0; frame < TRAIL_FRAMES; frame++) {
        struct neph_image *r = card_image(frame, NULL, 0.0);
        struct neph_image *t = card_image(frame, history, alpha);
        const struct neph_frame_pair pair = extraction_pair(r, NULL, t, "radiance", frame,
                                                            &viewing);
        if (frame == 0)
            extraction = extraction_begin(&neph_extractor_trail, &pair, NULL);
        extraction_frame(&extraction, &pair);
        neph_image_destroy(r);
        neph_image_destroy(t);
    }
    extraction_flush(&extraction);
    return extraction;
}

/* Pixels at the start have only seen the card, so behind them the energy is (1 - alpha)^(2 a).
 * Others saw it for 8 frames, and have settled to 1 - (1 - alpha)^8: 0.6^8 = 1.7 %. */
static void test_trail_of_an_average(void **state)
{
    struct extraction extraction = run_trail(0.4);
    static const int ages[] = {1, 2, 4, 8};
    static const char *const names[] = {"trail_energy_1", "trail_energy_2", "trail_energy_4",
                                        "trail_energy_8"};
    for (int k = 0; k < 4; k++) {
        const double settled = pow(0.6, 2.0 * ages[k]);
        const double energy = extraction_scalar(&extraction, names[k]);
        assert_true(energy <= settled * (1.0 + 1e-6));
        assert_true(energy >= settled * pow(1.0 - pow(0.6, 8.0), 2.0) * (1.0 - 1e-6));
    }
    extraction_end(&extraction);
}

static void test_trail_map(void **state)
{
    struct extraction extraction = run_trail(0.4);
    double *values = extraction_map(&extraction, 0);
    /* Pixel 0 is disoccluded permanently in frame 1, from 1 to 0.25. */
    double sum = 0.0;
    for (int age = 1; age <= 16; age++)
        sum += 0.5625 * pow(0.6, 2.0 * age) / 16.0;
    neph_assert_close(values[0], sqrt(sum), 1e-6, 0.0);
    free(values);
    extraction_end(&extraction);
}

static void test_no_trail(void **state)
{
    struct extraction extraction = run_trail(1.0);
    assert_true(extraction_scalar(&extraction, "trail_energy_1") == 0.0);
    extraction_end(&extraction);
    extraction = run_trail(0.0); /* never moves: the card stays at its first position */
    double value = 0.0;
    assert_null(neph_extractor_trail.scalar(extraction.state, 1, &value));
    assert_true(value > 0.0 && value < 1.0);
    extraction_end(&extraction);
}

static void test_trail_needs_the_card(void **state)
{
    const double values[PIXELS] = {0.0};
    struct neph_image *image = grey_image(values);
    const struct neph_frame_pair pair = extraction_pair(image, NULL, image, "radiance", 0,
                                                        &viewing);
    assert_non_null(strstr(neph_extractor_trail.obstacle(&pair, NULL), "mask.card"));
    neph_image_destroy(image);
}

#include "tests/main.h"
