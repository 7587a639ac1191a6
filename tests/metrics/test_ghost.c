/* SPDX-License-Identifier: MIT
 *
 * Ghosts behind moving edges: cards with known speeds, and filters with a known response.
 */
#include "tests/metrics/extractor_test.h"

#include "metrics/extractors/extractors.h"

enum { WIDTH = 80, HEIGHT = 3, PIXELS = WIDTH * HEIGHT };

static const struct neph_viewing viewing = {60.0, 67.0, 0.0, 100.0};

static const double card_value = 0.75;

/* A frame with equal rows. */
struct frame {
    double reference[WIDTH], test[WIDTH];
    float depth_m[WIDTH], motion_px[WIDTH];
};

static struct neph_image *image_of(const double *grey, const struct frame *layers)
{
    struct neph_image *image = NULL;
    float *planes[3], *depth_m, *x_px, *y_px;
    assert_int_equal(neph_image_create(WIDTH, HEIGHT, &image, NULL), NEPH_OK);
    assert_int_equal(neph_image_add_rgb(image, NULL, planes, NULL), NEPH_OK);
    for (int i = 0; i < PIXELS; i++)
        for (int c = 0; c < 3; c++)
            planes[c][i] = (float)grey[i % WIDTH];
    if (!layers)
        return image;
    assert_int_equal(neph_image_add_channel(image, "Z", &depth_m, NULL), NEPH_OK);
    assert_int_equal(neph_image_add_channel(image, "motion.x", &x_px, NULL), NEPH_OK);
    assert_int_equal(neph_image_add_channel(image, "motion.y", &y_px, NULL), NEPH_OK);
    for (int i = 0; i < PIXELS; i++) {
        depth_m[i] = layers->depth_m[i % WIDTH];
        x_px[i] = layers->motion_px[i % WIDTH];
    }
    return image;
}

static void feed(struct extraction *extraction, int number, const struct frame *frame)
{
    struct neph_image *reference = image_of(frame->reference, frame);
    struct neph_image *test = image_of(frame->test, NULL);
    const struct neph_frame_pair pair = extraction_pair(reference, NULL, test, "radiance", number,
                                                        &viewing);
    if (number == 0)
        *extraction = extraction_begin(&neph_extractor_ghost, &pair, NULL);
    extraction_frame(extraction, &pair);
    neph_image_destroy(reference);
    neph_image_destroy(test);
}

/* The metric over all pixels, as the pools define it; NaN: no value. */
static double value_of(const struct extraction *extraction, const char *name)
{
    for (const struct neph_metric *metric = neph_extractor_ghost.metrics; metric->name; metric++) {
        if (strcmp(metric->name, name) != 0)
            continue;
        double *v = extraction_map(extraction, metric->map);
        double *w = extraction_map(extraction, metric->over);
        double sum_v = 0.0, sum_w = 0.0;
        for (int i = 0; i < PIXELS; i++) {
            if (isnan(v[i]))
                continue;
            sum_v += v[i];
            sum_w += metric->pool == NEPH_POOL_MEAN_OVER ? w[i] : 1.0;
        }
        free(v);
        free(w);
        return sum_w > 0.0 ? sum_v / sum_w : NAN;
    }
    fail_msg("no metric '%s'", name);
    return NAN;
}

static const int ages[4] = {1, 4, 8, 16};

static double of_age(const struct extraction *extraction, const char *metric, int age)
{
    char name[64];
    snprintf(name, sizeof(name), "%s_%d", metric, age);
    return value_of(extraction, name);
}

/* ---- a card in front of a wall, and an average ----------------------------------------------- */

/* The wall varies a little. */
static double wall_value(int x)
{
    return 0.2 + 0.001 * (x % 7);
}

/* The card's right edge is at `speed` times the frame number; in frame 0 the card is outside. */
static void move_card(double speed_px, int side_px, int number, double alpha, struct frame *frame)
{
    for (int x = 0; x < WIDTH; x++) {
        const bool card = x < speed_px * number && x >= speed_px * number - side_px;
        frame->reference[x] = card ? card_value : wall_value(x);
        frame->depth_m[x] = card ? 1.0f : 10.0f;
        frame->motion_px[x] = card ? (float)-speed_px : 0.0f;
        frame->test[x] = number == 0
                             ? frame->reference[x]
                             : frame->test[x] + alpha * (frame->reference[x] - frame->test[x]);
    }
}

/* A pixel is under the card for side / speed frames, and the average then contains 1 - (1 - a)^n of
 * it. Images are floats: 6e-8 of 0.5 and less. */
static void check_card(double speed_px, int side_px, double alpha)
{
    struct extraction extraction;
    struct frame frame;
    const int frame_count = (int)ceil((WIDTH + side_px) / speed_px) + 36;
    for (int number = 0; number < frame_count; number++) {
        move_card(speed_px, side_px, number, alpha, &frame);
        feed(&extraction, number, &frame);
    }
    extraction_flush(&extraction);
    const double settled = 1.0 - pow(1.0 - alpha, side_px / speed_px);
    int ghost_frames = 0;
    for (int age = 1; age <= 32; age++)
        ghost_frames += settled * pow(1.0 - alpha, age) > 0.1;
    for (int k = 0; k < 4; k++) {
        const double left = settled * pow(1.0 - alpha, ages[k]);
        neph_assert_close(of_age(&extraction, "edge_ghost_residual", ages[k]), left, 0.0, 3e-7);
        assert_true(of_age(&extraction, "edge_ghost_share", ages[k]) == (left > 0.1 ? 1.0 : 0.0));
    }
    neph_assert_close(value_of(&extraction, "edge_ghost_frames"), ghost_frames, 1e-12, 0.0);
    neph_assert_close(value_of(&extraction, "edge_ghost_area"), ghost_frames / (frame_count - 1.0),
                      1e-12, 0.0);
    extraction_end(&extraction);
}

static void test_cards_behind_an_average(void **state)
{
    static const struct {
        double speed_px;
        int side_px;
    } cards[] = {{1.0, 20}, {2.5, 20}, {7.0, 21}};
    static const double alphas[] = {0.04, 0.1, 0.2, 0.5, 1.0};
    for (int c = 0; c < 3; c++)
        for (int a = 0; a < 5; a++)
            check_card(cards[c].speed_px, cards[c].side_px, alphas[a]);
}

/* A history that is rejected too strongly overshoots: the residual has this sign. */
static void test_sign(void **state)
{
    struct extraction extraction;
    struct frame frame;
    for (int number = 0; number < 60; number++) {
        move_card(2.0, 10, number, 1.0, &frame);
        for (int x = 0; x < WIDTH; x++)
            frame.test[x] -= frame.depth_m[x] > 5.0f ? 0.25 * (card_value - wall_value(x)) : 0.0;
        feed(&extraction, number, &frame);
    }
    extraction_flush(&extraction);
    for (int k = 0; k < 4; k++) {
        neph_assert_close(of_age(&extraction, "edge_ghost_residual", ages[k]), -0.25, 0.0, 1e-6);
        assert_true(of_age(&extraction, "edge_ghost_share", ages[k]) == 1.0);
    }
    extraction_end(&extraction);
}

/* ---- a static card in front of a rotating camera --------------------------------------------- */

/* The wall moves left by 3 px a frame together with the ghost, and the age moves with it. The
 * card's left edge is at 50; the surface at a pixel `left` of it was disoccluded left / 3 frames
 * ago. */
static void test_ghost_that_moves_with_the_wall(void **state)
{
    enum { CARD = 50, SIDE = 12, SPEED = 3 };
    struct extraction extraction;
    struct frame frame;
    for (int number = 0; number < 40; number++) {
        for (int x = 0; x < WIDTH; x++) {
            const bool card = x >= CARD && x < CARD + SIDE;
            const int age = (CARD - 1 - x) / SPEED + 1;
            frame.reference[x] = card ? card_value : 0.2;
            frame.test[x] = frame.reference[x];
            if (x < CARD)
                frame.test[x] += (card_value - 0.2) * pow(0.7, age);
            frame.depth_m[x] = card ? 1.0f : INFINITY;
            frame.motion_px[x] = card ? 0.0f : SPEED;
        }
        feed(&extraction, number, &frame);
    }
    extraction_flush(&extraction);
    for (int k = 0; k < 4; k++)
        neph_assert_close(of_age(&extraction, "edge_ghost_residual", ages[k]), pow(0.7, ages[k]),
                          0.0, 3e-7);
    extraction_end(&extraction);
}

/* ---- no ghost -------------------------------------------------------------------------------- */

static void test_nothing_to_see(void **state)
{
    struct extraction extraction;
    struct frame frame;
    for (int number = 0; number < 60; number++) { /* the card looks like the wall */
        move_card(2.0, 10, number, 1.0, &frame);
        for (int x = 0; x < WIDTH; x++) {
            frame.reference[x] = 0.2;
            frame.test[x] = 0.5;
        }
        feed(&extraction, number, &frame);
    }
    extraction_flush(&extraction);
    assert_true(isnan(of_age(&extraction, "edge_ghost_residual", 1)));
    assert_true(isnan(value_of(&extraction, "edge_ghost_frames")));
    assert_true(value_of(&extraction, "edge_ghost_area") == 0.0);
    extraction_end(&extraction);
}

static void test_one_frame(void **state)
{
    struct extraction extraction;
    struct frame frame;
    move_card(2.0, 10, 0, 1.0, &frame);
    feed(&extraction, 0, &frame);
    extraction_flush(&extraction);
    assert_true(isnan(value_of(&extraction, "edge_ghost_area")));
    extraction_end(&extraction);
}

static void test_obstacle(void **state)
{
    struct frame frame;
    move_card(2.0, 10, 0, 1.0, &frame);
    struct neph_image *image = image_of(frame.reference, NULL);
    const struct neph_frame_pair pair = extraction_pair(image, NULL, image, "radiance", 0,
                                                        &viewing);
    assert_non_null(strstr(neph_extractor_ghost.obstacle(&pair, NULL), "motion.x"));
    neph_image_destroy(image);
    extraction_check_table(&neph_extractor_ghost);
}

#include "tests/main.h"
