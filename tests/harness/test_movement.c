/* SPDX-License-Identifier: MIT */
#include "tests/neph_test.h"

#include "harness/compare/movement.h"
#include "harness/compare/versus.h"

enum { SIDE_PX = 20 };

/* Linear value of an sRGB luma above the straight part. */
static float linear(double luma)
{
    return (float)pow((luma + 0.055) / 1.055, 2.4);
}

/* The left half has this luma, the right half 0.5. */
static struct neph_image *make_frame(double luma)
{
    struct neph_image *image = NULL;
    float *rgb[3];
    assert_int_equal(neph_image_create(SIDE_PX, SIDE_PX, &image, NULL), NEPH_OK);
    assert_int_equal(neph_image_add_rgb(image, NULL, rgb, NULL), NEPH_OK);
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < SIDE_PX * SIDE_PX; i++)
            rgb[c][i] = linear(i % SIDE_PX < SIDE_PX / 2 ? luma : 0.5);
    return image;
}

static void fill(struct neph_movement *movement, const double *lumas, int count)
{
    struct neph_image *reference = make_frame(0.5);
    movement->gain = 1.0;
    for (int f = 0; f < count; f++) {
        struct neph_image *test = make_frame(lumas[f]);
        assert_int_equal(neph_movement_add(movement, reference, test, NULL, NULL), NEPH_OK);
        neph_image_destroy(test);
    }
    neph_image_destroy(reference);
    neph_movement_end(movement);
}

/* A pulse of height h in one of four frames, in half of the pixels. Minus its mean h / 4 it is 3/4
 * h there and -1/4 h otherwise; its amplitudes are a4 = h / 2 and a2 = h / 4. Tolerance: single
 * precision, 1e-6. */
static void test_a_pulse_in_each_cycle(void **state)
{
    static const double lumas[] = {0.7, 0.5, 0.5, 0.5, 0.7, 0.5, 0.5, 0.5, 0.9};
    struct neph_movement movement = {.gain = 0.0};
    fill(&movement, lumas, 9);
    assert_int_equal(movement.frame_count, 8); /* whole cycles */
    for (int f = 0; f < 8; f++)
        neph_assert_close(movement.frames[f], (f % 4 == 0 ? 0.15 : 0.05) * sqrt(0.5), 1e-5, 1e-6);
    for (int c = 0; c < 2; c++)
        neph_assert_close(movement.cycles[c], sqrt(0.5 * (0.1 * 0.1 / 2.0 + 0.05 * 0.05)), 1e-5,
                          1e-6);
    neph_movement_finish(&movement);
}

/* Six cycles, all smaller: the sign test gives 2 / 2^6. */
static void test_paired_over_time(void **state)
{
    double strong[24], weak[24];
    struct neph_movement first = {.gain = 0.0}, second = {.gain = 0.0}, shorter = {.gain = 0.0};
    struct neph_differences made = {.list = NULL};
    for (int f = 0; f < 24; f++) {
        strong[f] = f % 4 == 0 ? 0.7 + 0.001 * f : 0.5;
        weak[f] = f % 4 == 0 ? 0.6 : 0.5;
    }
    fill(&first, weak, 24);
    fill(&second, strong, 24);
    fill(&shorter, strong, 20);
    assert_int_equal(neph_versus_add_movement(&first, &shorter, &made, NULL), NEPH_OK);
    assert_int_equal(made.frames.count, 0);
    assert_int_equal(neph_versus_add_movement(&first, &second, &made, NULL), NEPH_OK);
    assert_int_equal(made.frames.count, 24);
    assert_int_equal(made.frames.below, 24);
    assert_int_equal(made.frames.above, 0);
    neph_assert_close(made.frames.p, 2.0 / 64.0, 1e-12, 0.0);
    assert_int_equal(made.cycles.below, 6);
    neph_assert_close(made.cycles.p, 2.0 / 64.0, 1e-12, 0.0);
    assert_true(made.frames.value < 0.0);
    neph_movement_finish(&first);
    neph_movement_finish(&second);
    neph_movement_finish(&shorter);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
#include "cases/test_movement.inc"
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
