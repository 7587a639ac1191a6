/* SPDX-License-Identifier: MIT
 *
 * Motion vectors against rays traced in both frames, and the residuals of sequences with known
 * values.
 */
#include "tests/metrics/extractor_test.h"

#include "metrics/extractors/extractors.h"
#include "metrics/meter.h"
#include "metrics/motion.h"

/* ---- cameras and a plane --------------------------------------------------------------------- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Rotated left about +Y by `yaw`, then up by `pitch`; at 0 it looks along -Z. */
static struct neph_motion_camera camera_at(double x_m, double y_m, double z_m, double yaw_rad,
                                           double pitch_rad)
{
    const double cy = cos(yaw_rad), sy = sin(yaw_rad), cp = cos(pitch_rad), sp = sin(pitch_rad);
    return (struct neph_motion_camera){.position_m = {x_m, y_m, z_m},
                                       .right = {cy, 0.0, -sy},
                                       .up = {sy * sp, cp, cy * sp},
                                       .forward = {-sy * cp, sp, -cy * cp},
                                       .vertical_fov_rad = 1.0};
}

/* The intersection of the ray through a point of the frame with the ground y = 0; false above the
 * horizon. `depth_m` is measured along the axis. */
static bool meet_ground(const struct neph_motion_camera *camera, int width, int height, double x_px,
                        double y_px, double point_m[3], double *depth_m)
{
    const double slope = tan(0.5 * camera->vertical_fov_rad) / (0.5 * height);
    double direction[3];
    for (int k = 0; k < 3; k++)
        direction[k] = camera->forward[k] + slope * (x_px - 0.5 * width) * camera->right[k] +
                       slope * (0.5 * height - y_px) * camera->up[k];
    *depth_m = -camera->position_m[1] / direction[1];
    for (int k = 0; k < 3; k++)
        point_m[k] = camera->position_m[k] + *depth_m * direction[k];
    return *depth_m > 0.0;
}

enum { WIDTH = 97, HEIGHT = 55, PIXELS = WIDTH * HEIGHT };

struct motion {
    float depth_m[PIXELS], x_px[PIXELS], y_px[PIXELS], before_m[PIXELS];
};

/* A ground with its sky, and its motion. */
static struct motion *ground_motion(const struct neph_motion_camera *now,
                                    const struct neph_motion_camera *before)
{
    struct motion *motion = calloc(1, sizeof(*motion));
    struct neph_diag diag = {0};
    assert_non_null(motion);
    for (int i = 0; i < PIXELS; i++) {
        double point_m[3], depth_m;
        const bool hit = meet_ground(now, WIDTH, HEIGHT, i % WIDTH + 0.5, i / WIDTH + 0.5, point_m,
                                     &depth_m);
        motion->depth_m[i] = hit ? (float)depth_m : INFINITY;
    }
    neph_assert_ok(neph_motion_of_depth(now, before, WIDTH, HEIGHT, motion->depth_m,
                                        NEPH_MOTION_EYE_DEPTH, motion->x_px, motion->y_px,
                                        motion->before_m, &diag),
                   &diag);
    return motion;
}

static double texture(const double point_m[3])
{
    return 0.5 + 0.3 * sin(1.7 * point_m[0]) * cos(1.3 * point_m[2]);
}

/* The previous frame's ray, through the position that the vector gives, must hit the ground at the
 * same point; the distance is in pixels of that frame. */
static void test_vectors_reproject_a_textured_plane(void **state)
{
    const struct neph_motion_camera now = camera_at(3.0, 2.0, -1.0, 0.30, -0.35);
    const struct neph_motion_camera before = camera_at(2.6, 2.2, -0.7, 0.25, -0.30);
    struct motion *motion = ground_motion(&now, &before);
    double worst_px = 0.0, worst_texture = 0.0;
    int count = 0;
    for (int i = 0; i < PIXELS; i++) {
        double here_m[3], there_m[3], depth_m, before_m;
        const double x = i % WIDTH + 0.5, y = i / WIDTH + 0.5;
        if (!meet_ground(&now, WIDTH, HEIGHT, x, y, here_m, &depth_m) || depth_m > 200.0)
            continue;
        assert_true(meet_ground(&before, WIDTH, HEIGHT, x + (double)motion->x_px[i],
                                y + (double)motion->y_px[i], there_m, &before_m));
        /* The component perpendicular to the line of sight, without foreshortening. */
        const double apart[3] = {here_m[0] - there_m[0], here_m[1] - there_m[1],
                                 here_m[2] - there_m[2]};
        const double px_per_m = 0.5 * HEIGHT / tan(0.5) / before_m;
        worst_px = fmax(worst_px, px_per_m * fabs(dot(apart, before.right)));
        worst_px = fmax(worst_px, px_per_m * fabs(dot(apart, before.up)));
        if (depth_m < 10.0)
            worst_texture = fmax(worst_texture, fabs(texture(here_m) - texture(there_m)));
        neph_assert_close((double)motion->before_m[i], before_m, 1e-4, 0.0);
        count++;
    }
    print_message("%d pixels: off by %.2g px, texture by %.2g\n", count, worst_px, worst_texture);
    assert_true(count > PIXELS / 2);
    assert_true(worst_px < 1e-4); /* a tenth of the requirement; floats are accurate to 1e-5 px */
    assert_true(worst_texture < 1e-4);
    free(motion);
}

/* At the centre a rotation by an angle moves the sky by its tangent; a translation does not move
 * the sky. */
static void test_sky_moves_by_rotation_alone(void **state)
{
    const struct neph_motion_camera start = camera_at(0.0, 1.0, 0.0, 0.0, 0.4);
    const struct neph_motion_camera moved = camera_at(100.0, 50.0, -70.0, 0.0, 0.4);
    struct motion *motion = ground_motion(&moved, &start);
    for (int i = 0; i < WIDTH; i++) {
        assert_true(isinf(motion->depth_m[i]) && isinf(motion->before_m[i]));
        neph_assert_close((double)motion->x_px[i], 0.0, 0.0, 1e-9);
        neph_assert_close((double)motion->y_px[i], 0.0, 0.0, 1e-9);
    }
    free(motion);

    const struct neph_motion_camera level = camera_at(0.0, 1.0, 0.0, 0.0, 0.0);
    const struct neph_motion_camera left = camera_at(5.0, 2.0, 9.0, 0.1, 0.0);
    const float sky = INFINITY;
    float x_px, y_px;
    /* One pixel of one pixel's height: it looks along the axis, and 0.5 px are tan(fov / 2). */
    assert_int_equal(neph_motion_of_depth(&left, &level, 1, 1, &sky, NEPH_MOTION_EYE_DEPTH, &x_px,
                                          &y_px, NULL, NULL),
                     NEPH_OK);
    neph_assert_close((double)x_px, -0.5 / tan(0.5) * tan(0.1), 1e-6, 0.0);
    neph_assert_close((double)y_px, 0.0, 0.0, 1e-9);
    const struct neph_motion_camera up = camera_at(0.0, 1.0, 0.0, 0.0, 0.1);
    assert_int_equal(neph_motion_of_depth(&up, &level, 1, 1, &sky, NEPH_MOTION_EYE_DEPTH, &x_px,
                                          &y_px, NULL, NULL),
                     NEPH_OK);
    neph_assert_close((double)y_px, -0.5 / tan(0.5) * tan(0.1), 1e-6, 0.0);
}

/* The same position, given by its distance along the ray. */
static void test_distance(void **state)
{
    const struct neph_motion_camera now = camera_at(3.0, 2.0, -1.0, 0.30, -0.35);
    const struct neph_motion_camera before = camera_at(2.6, 2.2, -0.7, 0.25, -0.30);
    struct motion *motion = ground_motion(&now, &before);
    struct motion *other = calloc(1, sizeof(*other));
    assert_non_null(other);
    const double slope = tan(0.5) / (0.5 * HEIGHT);
    for (int i = 0; i < PIXELS; i++) {
        const double x = slope * (i % WIDTH + 0.5 - 0.5 * WIDTH);
        const double y = slope * (0.5 * HEIGHT - (i / WIDTH + 0.5));
        other->depth_m[i] = (float)((double)motion->depth_m[i] * sqrt(1.0 + x * x + y * y));
    }
    assert_int_equal(neph_motion_of_depth(&now, &before, WIDTH, HEIGHT, other->depth_m,
                                          NEPH_MOTION_DISTANCE, other->x_px, other->y_px,
                                          other->before_m, NULL),
                     NEPH_OK);
    for (int i = 0; i < PIXELS; i++) {
        neph_assert_close((double)other->x_px[i], (double)motion->x_px[i], 1e-5, 1e-4);
        neph_assert_close((double)other->y_px[i], (double)motion->y_px[i], 1e-5, 1e-4);
        assert_true(other->before_m[i] >= motion->before_m[i] * (1.0f - 1e-6f));
    }
    free(motion);
    free(other);
}

static void test_behind_the_camera_and_bad_depths(void **state)
{
    const struct neph_motion_camera now = camera_at(0.0, 1.0, 0.0, 0.0, 0.0);
    const struct neph_motion_camera before = camera_at(0.0, 1.0, -10.0, 0.0, 0.0);
    const float near_m = 5.0f, bad_m[3] = {0.0f, -1.0f, NAN};
    float x_px, y_px, before_m;
    assert_int_equal(neph_motion_of_depth(&now, &before, 1, 1, &near_m, NEPH_MOTION_EYE_DEPTH,
                                          &x_px, &y_px, &before_m, NULL),
                     NEPH_OK);
    assert_true(x_px == NEPH_MOTION_NOWHERE_PX && y_px == NEPH_MOTION_NOWHERE_PX);
    assert_true(before_m == 0.0f);
    for (int k = 0; k < 3; k++) {
        struct neph_diag diag = {0};
        assert_int_equal(neph_motion_of_depth(&now, &before, 1, 1, &bad_m[k], NEPH_MOTION_EYE_DEPTH,
                                              &x_px, &y_px, NULL, &diag),
                         NEPH_ERR_INPUT);
        assert_non_null(strstr(diag.message, "(0, 0)"));
    }
}

/* ---- frames ---------------------------------------------------------------------------------- */

static const struct neph_viewing viewing = {60.0, 67.0, 0.0, 100.0};

static struct neph_image *frame_of(int width, int height, const double *grey, const float *depth_m,
                                   const float *x_px, const float *y_px)
{
    static const char *const names[] = {"Z", "motion.x", "motion.y"};
    const float *const layers[] = {depth_m, x_px, y_px};
    struct neph_image *image = NULL;
    float *planes[3];
    const size_t count = (size_t)width * (size_t)height;
    assert_int_equal(neph_image_create(width, height, &image, NULL), NEPH_OK);
    assert_int_equal(neph_image_add_rgb(image, NULL, planes, NULL), NEPH_OK);
    for (size_t i = 0; i < 3 * count; i++)
        planes[i / count][i % count] = (float)grey[i % count];
    for (int k = 0; k < 3 && layers[k]; k++) {
        float *samples;
        assert_int_equal(neph_image_add_channel(image, names[k], &samples, NULL), NEPH_OK);
        memcpy(samples, layers[k], count * sizeof(*samples));
    }
    return image;
}

/* Measures through the meter, over all pixels. */
struct meter {
    struct neph_meter *meter;
    struct neph_mask *mask;
    struct neph_meter_choice choices[2];
};

static void feed(struct meter *it, struct neph_image *reference, struct neph_image *test)
{
    struct neph_diag diag = {0};
    if (!it->meter) {
        neph_assert_ok(neph_mask_create(reference, "all", NULL, &it->mask, &diag), &diag);
        const struct neph_mask *const masks[1] = {it->mask};
        const struct neph_meter_params params = {.choices = it->choices,
                                                 .choice_count = 2,
                                                 .viewing = viewing,
                                                 .masks = masks,
                                                 .mask_count = 1};
        neph_assert_ok(neph_meter_create(&params, &it->meter, &diag), &diag);
    }
    neph_assert_ok(neph_meter_frame(it->meter, reference, NULL, test, &diag), &diag);
    neph_image_destroy(reference);
    neph_image_destroy(test);
}

static struct meter new_meter(const char *motion_setting)
{
    struct meter it = {
        .choices = {
            {&neph_extractor_residual_change,
             neph_options_default(neph_extractor_residual_change.options)},
            {&neph_extractor_motion, neph_options_default(neph_extractor_motion.options)},
        }};
    assert_int_equal(neph_options_set(neph_extractor_motion.options, "motion", motion_setting,
                                      &it.choices[1].settings, NULL),
                     NEPH_OK);
    return it;
}

static void finish(const struct meter *it)
{
    struct neph_diag diag = {0};
    neph_assert_ok(neph_meter_finish(it->meter, &diag), &diag);
}

static void end(struct meter *it)
{
    neph_meter_destroy(it->meter);
    neph_mask_destroy(it->mask);
}

static const struct neph_measurement *find(const struct meter *it, const char *name)
{
    int count;
    const struct neph_measurement *all = neph_meter_measurements(it->meter, &count);
    for (int i = 0; i < count; i++)
        if (strcmp(all[i].metric->name, name) == 0 && all[i].quantity->bit == NEPH_RADIANCE)
            return &all[i];
    fail_msg("no measurement '%s'", name);
    return NULL;
}

static double value_of(const struct meter *it, const char *name)
{
    const struct neph_measurement *found = find(it, name);
    if (!found->defined)
        fail_msg("'%s' is undefined: %s", name, found->undefined_because);
    return found->value;
}

/* ---- residual change ------------------------------------------------------------------------- */

/* Reference and test move together; the error of the test alternates by +-0.01, a change of 0.02
 * per frame. */
static void test_residual_change(void **state)
{
    struct meter it = new_meter("signal=luminance");
    enum { W = 13, H = 9, N = W * H };
    for (int frame = 0; frame < 6; frame++) {
        double reference[N], test[N];
        for (int i = 0; i < N; i++) {
            reference[i] = 0.5 + 0.3 * sin(0.3 * i + frame);
            test[i] = reference[i] + (frame % 2 ? 0.01 : -0.01);
        }
        feed(&it, frame_of(W, H, reference, NULL, NULL, NULL),
             frame_of(W, H, test, NULL, NULL, NULL));
    }
    finish(&it);
    neph_assert_close(value_of(&it, "residual_change_rms"), 0.02, 1e-5, 0.0); /* floats near 0.8 */
    assert_non_null(strstr(
        neph_meter_obstacle(it.meter, neph_quantity_find("radiance"), &neph_extractor_motion),
        "motion.x"));
    end(&it);
}

static double srgb(double c)
{
    return c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1.0 / 2.4) - 0.055;
}

static void test_residual_change_in_luma(void **state)
{
    struct meter it = new_meter("signal=luma");
    for (int frame = 0; frame < 4; frame++) {
        const double reference = 0.2, test = frame % 2 ? 0.25 : 0.2;
        feed(&it, frame_of(1, 1, &reference, NULL, NULL, NULL),
             frame_of(1, 1, &test, NULL, NULL, NULL));
    }
    finish(&it);
    const double change = srgb(0.25) - srgb(0.2);
    neph_assert_close(value_of(&it, "residual_change_luma_rms"), change, 1e-6, 0.0);
    neph_assert_close(value_of(&it, "residual_change_psnr"), -20.0 * log10(change), 1e-6, 0.0);
    end(&it);
}

/* From black in place of white to white in place of black: the change is twice the peak. */
static void test_largest_change(void **state)
{
    struct meter it = new_meter("signal=luma");
    for (int frame = 0; frame < 3; frame++) {
        const double reference = frame % 2, test = 1.0 - reference;
        feed(&it, frame_of(1, 1, &reference, NULL, NULL, NULL),
             frame_of(1, 1, &test, NULL, NULL, NULL));
    }
    finish(&it);
    neph_assert_close(value_of(&it, "residual_change_luma_rms"), 2.0, 1e-12, 0.0);
    assert_true(find(&it, "residual_change_luma_rms")->metric->high == 2.0);
    end(&it);
}

static void test_one_frame_says_nothing(void **state)
{
    struct meter it = new_meter("signal=luma");
    const double grey[4] = {0.1, 0.2, 0.3, 0.4};
    const float depth_m[4] = {1.0f, 1.0f, 1.0f, 1.0f}, still[4] = {0.0f};
    feed(&it, frame_of(2, 2, grey, depth_m, still, still),
         frame_of(2, 2, grey, depth_m, still, still));
    finish(&it);
    static const char *const names[] = {"residual_change_rms",         "residual_change_psnr",
                                        "motion_residual_excess",      "motion_coverage",
                                        "residual_change_disoccluded", "disoccluded_residual_0",
                                        "disoccluded_recovery"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        assert_false(find(&it, names[i])->defined);
    end(&it);
}

/* ---- motion ---------------------------------------------------------------------------------- */

/* Above the ground with exact vectors, the reference differs from its previous frame, reprojected,
 * by the error of bilinear interpolation; the test has an additional flicker of +-0.01, which is
 * 0.02 from frame to frame. */
static void test_residual_over_a_plane(void **state)
{
    struct meter it = new_meter("signal=luminance");
    struct neph_motion_camera cameras[6];
    double *reference = calloc(2 * PIXELS, sizeof(*reference)), *test = reference + PIXELS;
    assert_non_null(reference);
    for (int frame = 0; frame < 6; frame++) {
        cameras[frame] = camera_at(0.04 * frame, 2.0, -0.05 * frame, 0.004 * frame, -0.9);
        struct motion *motion = ground_motion(&cameras[frame], &cameras[frame ? frame - 1 : 0]);
        for (int i = 0; i < PIXELS; i++) {
            double point_m[3], depth_m;
            assert_true(meet_ground(&cameras[frame], WIDTH, HEIGHT, i % WIDTH + 0.5,
                                    i / WIDTH + 0.5, point_m, &depth_m));
            reference[i] = texture(point_m);
            test[i] = reference[i] + (frame % 2 ? 0.01 : -0.01);
        }
        feed(&it, frame_of(WIDTH, HEIGHT, reference, motion->depth_m, motion->x_px, motion->y_px),
             frame_of(WIDTH, HEIGHT, test, NULL, NULL, NULL));
        free(motion);
    }
    finish(&it);
    const double of_reference = value_of(&it, "motion_residual_reference");
    const double of_test = value_of(&it, "motion_residual_test");
    print_message("reference %.3g, test %.3g, coverage %.3f\n", of_reference, of_test,
                  value_of(&it, "motion_coverage"));
    /* Bilinear: at most 1/8 (wave number per px)^2 each way of the amplitude 0.3; 3.1 m are 50 px
     * at least, so (1.7 * 3.1 / 50)^2 / 8 * 2 * 0.3 < 1e-3. */
    assert_true(of_reference > 0.0 && of_reference < 1e-3);
    neph_assert_close(of_test, 0.02, 0.0, of_reference);
    neph_assert_close(value_of(&it, "motion_residual_excess"), of_test - of_reference, 1e-12, 0.0);
    assert_true(value_of(&it, "motion_coverage") > 0.9 && value_of(&it, "motion_coverage") < 1.0);
    assert_true(value_of(&it, "disoccluded_share") == 0.0);
    assert_false(find(&it, "residual_change_disoccluded")->defined);
    neph_assert_close(value_of(&it, "residual_change_elsewhere"), 0.02, 1e-5, 0.0);
    free(reference);
    end(&it);
}

/* A card 1 m away moves right by 3 px a frame in front of a wall 10 m away; behind it the error of
 * the test is 0.25 0.7^a, a frames after disocclusion. */
enum { CARD_W = 80, CARD_H = 6, CARD_N = CARD_W * CARD_H, CARD_FRAMES = 20, CARD_SIDE = 10 };

static const double card_alpha = 0.3;

static void card_frame(int frame, double *reference, double *test, float layers[3][CARD_N])
{
    for (int i = 0; i < CARD_N; i++) {
        const int behind = 3 * frame - 1 - i % CARD_W; /* 0: next to the card, on its left */
        const bool card = behind < 0 && behind >= -CARD_SIDE;
        reference[i] = card ? 0.75 : 0.25;
        test[i] = reference[i];
        if (behind >= 0)
            test[i] += 0.25 * pow(1.0 - card_alpha, behind / 3);
        layers[0][i] = card ? 1.0f : 10.0f;
        layers[1][i] = card ? -3.0f : 0.0f;
        layers[2][i] = 0.0f;
    }
}

static void test_disocclusion(void **state)
{
    struct meter it = new_meter("signal=luminance");
    double reference[CARD_N], test[CARD_N];
    float layers[3][CARD_N];
    for (int frame = 0; frame < CARD_FRAMES; frame++) {
        card_frame(frame, reference, test, layers);
        /* The layers may belong to the test, too. */
        feed(&it, frame_of(CARD_W, CARD_H, reference, NULL, NULL, NULL),
             frame_of(CARD_W, CARD_H, test, layers[0], layers[1], layers[2]));
    }
    finish(&it);
    neph_assert_close(value_of(&it, "disoccluded_share"), 3.0 / CARD_W, 1e-12, 0.0);
    static const char *const names[] = {"disoccluded_residual_0", "disoccluded_residual_1",
                                        "disoccluded_residual_2", "disoccluded_residual_4",
                                        "disoccluded_residual_8", "disoccluded_residual_16"};
    static const int ages[] = {0, 1, 2, 4, 8, 16};
    for (int k = 0; k < 6; k++)
        neph_assert_close(value_of(&it, names[k]), 0.25 * pow(1.0 - card_alpha, ages[k]), 1e-6,
                          3e-8);
    neph_assert_close(value_of(&it, "disoccluded_recovery"), log(0.1) / log(1.0 - card_alpha), 1e-6,
                      0.0);
    /* At disocclusion the error jumps from 0 to 0.25; later it falls by 0.3 a frame. */
    neph_assert_close(value_of(&it, "residual_change_disoccluded"), 0.25, 1e-6, 0.0);
    assert_true(value_of(&it, "residual_change_elsewhere") < 0.075);
    /* The card's texture moves exactly with it. */
    assert_true(value_of(&it, "motion_residual_reference") == 0.0);
    end(&it);
}

static void test_error_that_stays(void **state)
{
    struct meter it = new_meter("signal=luminance");
    double reference[CARD_N], test[CARD_N];
    float layers[3][CARD_N];
    for (int frame = 0; frame < CARD_FRAMES; frame++) {
        card_frame(frame, reference, test, layers);
        for (int i = 0; i < CARD_N; i++)
            test[i] = reference[i] + 0.125;
        feed(&it, frame_of(CARD_W, CARD_H, reference, layers[0], layers[1], layers[2]),
             frame_of(CARD_W, CARD_H, test, NULL, NULL, NULL));
    }
    finish(&it);
    assert_false(find(&it, "disoccluded_recovery")->defined);
    assert_non_null(strstr(find(&it, "disoccluded_recovery")->undefined_because, "10 %"));
    neph_assert_close(value_of(&it, "residual_change_disoccluded"), 0.0, 0.0, 1e-15);
    end(&it);
}

/* Without motion all pixels are followed, except within 1 px of a step in depth: columns 3 .. 6
 * around the step between 4 and 5. */
static void test_edges_are_left_out(void **state)
{
    struct meter it = new_meter("signal=luma");
    enum { W = 11, H = 3, N = W * H };
    double grey[N];
    float depth_m[N], still[N] = {0.0f};
    for (int i = 0; i < N; i++) {
        grey[i] = 0.01 * i;
        depth_m[i] = i % W < 5 ? 2.0f : INFINITY;
    }
    for (int frame = 0; frame < 3; frame++)
        feed(&it, frame_of(W, H, grey, depth_m, still, still),
             frame_of(W, H, grey, NULL, NULL, NULL));
    finish(&it);
    neph_assert_close(value_of(&it, "motion_coverage"), 7.0 / 11.0, 1e-15, 0.0);
    assert_true(value_of(&it, "disoccluded_share") == 0.0);
    assert_true(value_of(&it, "motion_residual_test") == 0.0);
    end(&it);
}

/* A wall approaches by 10 % per frame: without motion.depth it looks like another wall. */
static double share_disoccluded_by_approach(bool with_depth)
{
    struct meter it = new_meter("signal=luma");
    const double grey[4] = {0.1, 0.2, 0.3, 0.4};
    const float still[4] = {0.0f};
    for (int frame = 0; frame < 3; frame++) {
        float depth_m[4], *before_m;
        for (int i = 0; i < 4; i++)
            depth_m[i] = 10.0f * powf(0.9f, (float)frame);
        struct neph_image *reference = frame_of(2, 2, grey, depth_m, still, still);
        if (with_depth) {
            assert_int_equal(neph_image_add_channel(reference, "motion.depth", &before_m, NULL),
                             NEPH_OK);
            for (int i = 0; i < 4; i++)
                before_m[i] = depth_m[i] / 0.9f;
        }
        feed(&it, reference, frame_of(2, 2, grey, NULL, NULL, NULL));
    }
    finish(&it);
    const double share = value_of(&it, "disoccluded_share");
    end(&it);
    return share;
}

/* A cloud, and in one of four pixels a nearer one that moves in front of it; behind them is the sky
 * or a wall. Only volume.distance distinguishes them, where the cloud is visible. */
static double share_disoccluded_by_cloud(bool with_distance, float wall_m, float transmittance)
{
    struct meter it = new_meter("signal=luma");
    const double grey[4] = {0.1, 0.2, 0.3, 0.4};
    const float still[4] = {0.0f}, depth_m[4] = {wall_m, wall_m, wall_m, wall_m};
    for (int frame = 0; frame < 2; frame++) {
        float *distance_m, *clear[3];
        struct neph_image *reference = frame_of(2, 2, grey, depth_m, still, still);
        assert_int_equal(neph_image_add_rgb(reference, "transmittance", clear, NULL), NEPH_OK);
        for (int i = 0; i < 12; i++)
            clear[i / 4][i % 4] = transmittance;
        if (with_distance) {
            assert_int_equal(
                neph_image_add_channel(reference, "volume.distance", &distance_m, NULL), NEPH_OK);
            for (int i = 0; i < 4; i++)
                distance_m[i] = i == 0 && frame == 1 ? 100.0f : 900.0f;
        }
        feed(&it, reference, frame_of(2, 2, grey, NULL, NULL, NULL));
    }
    finish(&it);
    const double share = value_of(&it, "disoccluded_share");
    end(&it);
    return share;
}

static void test_which_depth_is_looked_for(void **state)
{
    assert_true(share_disoccluded_by_approach(false) == 1.0);
    assert_true(share_disoccluded_by_approach(true) == 0.0);
    assert_true(share_disoccluded_by_cloud(false, INFINITY, 0.9f) == 0.0);
    assert_true(share_disoccluded_by_cloud(true, INFINITY, 0.9f) == 0.25);
    assert_true(share_disoccluded_by_cloud(true, 2000.0f, 0.9f) == 0.0);
    assert_true(share_disoccluded_by_cloud(true, 2000.0f, 0.1f) == 0.25);
}

static void test_bad_layers(void **state)
{
    static const char *const names[] = {"Z", "motion.x", "motion.y"};
    const double grey[4] = {0.1, 0.2, 0.3, 0.4};
    const float depth_m[4] = {1.0f, 1.0f, 1.0f, 1.0f}, still[4] = {0.0f};
    struct neph_diag diag = {0};
    for (int k = 0; k < 3; k++) {
        struct neph_image *image = frame_of(2, 2, grey, depth_m, still, still);
        neph_image_channel(image, names[k])[3] = NAN;
        const struct neph_frame_pair pair = extraction_pair(image, NULL, image, "radiance", 0,
                                                            &viewing);
        struct extraction extraction = extraction_begin(&neph_extractor_motion, &pair, NULL);
        assert_int_equal(neph_extractor_motion.extract(extraction.state, &pair, &diag),
                         NEPH_ERR_GATE);
        assert_non_null(strstr(diag.message, names[k]));
        assert_non_null(strstr(diag.message, "(1, 1)"));
        extraction_end(&extraction);
        neph_image_destroy(image);
    }
}

/* In the meter bad layers end only this extractor, with a reason. */
static void test_bad_layers_spoil_no_other_number(void **state)
{
    struct meter it = new_meter("signal=luma");
    const double grey[4] = {0.1, 0.2, 0.3, 0.4};
    const float still[4] = {0.0f};
    for (int frame = 0; frame < 3; frame++) {
        const float depth_m[4] = {1.0f, frame == 1 ? NAN : 1.0f, 1.0f, 1.0f};
        feed(&it, frame_of(2, 2, grey, depth_m, still, still),
             frame_of(2, 2, grey, NULL, NULL, NULL));
    }
    finish(&it);
    const struct neph_quantity *radiance = neph_quantity_find("radiance");
    assert_string_equal(neph_meter_obstacle(it.meter, radiance, &neph_extractor_motion),
                        "'Z' of the reference is nan at the pixel (1, 0) of frame 1");
    assert_true(value_of(&it, "residual_change_rms") == 0.0);
    end(&it);
}

/* From anywhere, also from outside of the frame. */
static void test_wild_motion(void **state)
{
    uint64_t random = 20261121;
    struct meter it = new_meter("signal=luma");
    enum { W = 9, H = 7, N = W * H };
    for (int frame = 0; frame < 40; frame++) {
        double grey[N];
        float layers[3][N];
        for (int i = 0; i < N; i++) {
            grey[i] = neph_test_uniform(&random, -1.0, 3.0);
            layers[0][i] = (float)exp(neph_test_uniform(&random, -90.0, 88.0));
            layers[1][i] = (float)neph_test_uniform(&random, -15.0, 15.0);
            layers[2][i] = (float)neph_test_uniform(&random, -15.0, 15.0);
        }
        layers[0][frame % N] = frame % 2 ? INFINITY : 0.0f;
        layers[1][frame % N] = frame % 3 ? INFINITY : -INFINITY;
        layers[2][(7 * frame) % N] = NEPH_MOTION_NOWHERE_PX;
        feed(&it, frame_of(W, H, grey, layers[0], layers[1], layers[2]),
             frame_of(W, H, grey, NULL, NULL, NULL));
    }
    finish(&it);
    int count;
    const struct neph_measurement *all = neph_meter_measurements(it.meter, &count);
    for (int i = 0; i < count; i++)
        assert_true(isfinite(all[i].value) && isfinite(all[i].low) && isfinite(all[i].high));
    assert_true(value_of(&it, "disoccluded_share") > 0.0);
    end(&it);
}

static void test_tables(void **state)
{
    extraction_check_table(&neph_extractor_motion);
    extraction_check_table(&neph_extractor_residual_change);
}

#include "tests/main.h"
