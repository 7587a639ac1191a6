/* SPDX-License-Identifier: MIT
 *
 * Images in other data windows.
 */
#include "base/image_window.h"
#include "tests/neph_test.h"

#include <math.h>
#include <string.h>

static float outside(const char *channel)
{
    return strcmp(channel, "Z") == 0 ? INFINITY : 0.0f;
}

/* The value at a place of the display window. */
static float value_at(int64_t x, int64_t y)
{
    return (float)(1 + x + 100 * y);
}

/* An image with channels Y and Z whose data window lies at (x, y) of a display window of 8x6. */
static struct neph_image *make_image(int x, int y, int width_px, int height_px)
{
    struct neph_image *image = NULL;
    float *samples[2];
    neph_assert_ok(neph_image_create(width_px, height_px, &image, NULL), NULL);
    neph_assert_ok(neph_image_add_channel(image, "Y", &samples[0], NULL), NULL);
    neph_assert_ok(neph_image_add_channel(image, "Z", &samples[1], NULL), NULL);
    for (int i = 0; i < width_px * height_px; i++)
        samples[0][i] = samples[1][i] = value_at(x + i % width_px, y + i / width_px);
    image->header = calloc(1, sizeof(*image->header));
    assert_non_null(image->header);
    *image->header = (struct neph_file_header){.data_min_px = {x + 3, y - 5},
                                               .display_min_px = {3, -5},
                                               .display_px = {8, 6},
                                               .pixel_aspect = 1.0f,
                                               .screen_width = 1.0f};
    return image;
}

static void assert_placed(int x, int y, int width_px, int height_px, const int64_t to[4])
{
    struct neph_image *image = make_image(x, y, width_px, height_px);
    const struct neph_window window = {
        .min_px = {to[0], to[1]}, .size_px = {to[2], to[3]}, .display_px = {8, 6}};
    neph_assert_ok(neph_image_place(image, &window, outside, NULL), NULL);
    assert_int_equal(image->width_px, to[2]);
    assert_int_equal(image->height_px, to[3]);
    for (int64_t i = 0; i < to[2] * to[3]; i++) {
        const int64_t at_x = to[0] + i % to[2], at_y = to[1] + i / to[2];
        const bool is_inside = at_x >= x && at_x < x + width_px && at_y >= y &&
                               at_y < y + height_px;
        assert_true(neph_image_channel(image, "Y")[i] == (is_inside ? value_at(at_x, at_y) : 0.0f));
        assert_true(neph_image_channel(image, "Z")[i] ==
                    (is_inside ? value_at(at_x, at_y) : INFINITY));
    }
    const struct neph_window found = neph_image_window(image);
    assert_true(neph_window_is_equal(&found, &window));
    neph_image_destroy(image);
}

static void test_every_window_into_every_other(void **state)
{
    (void)state;
    static const int from[][4] = {{0, 0, 8, 6}, {2, 1, 3, 4}, {-2, -1, 12, 8}, {6, 4, 2, 2}};
    static const int64_t to[][4] = {{0, 0, 8, 6}, {1, 1, 3, 3},     {4, 0, 4, 6},
                                    {0, 5, 8, 1}, {-3, -3, 14, 12}, {7, 5, 1, 1}};
    for (size_t f = 0; f < sizeof(from) / sizeof(from[0]); f++)
        for (size_t t = 0; t < sizeof(to) / sizeof(to[0]); t++)
            assert_placed(from[f][0], from[f][1], from[f][2], from[f][3], to[t]);
}

static void test_the_crop_follows_the_window(void **state)
{
    (void)state;
    struct neph_image *image = make_image(2, 1, 3, 4);
    const struct neph_window part = {.min_px = {1, 2}, .size_px = {4, 3}, .display_px = {8, 6}},
                             whole = {.size_px = {8, 6}, .display_px = {8, 6}};
    neph_assert_ok(neph_image_place(image, &part, outside, NULL), NULL);
    assert_string_equal(neph_image_attribute(image, "crop"), "(1, 2) of 8x6");
    assert_int_equal(image->header->data_min_px[1], 2 - 5);
    neph_assert_ok(neph_image_place(image, &whole, outside, NULL), NULL);
    assert_null(neph_image_attribute(image, "crop"));
    neph_image_destroy(image);
}

static void test_an_image_without_a_header(void **state)
{
    (void)state;
    struct neph_image *image = NULL;
    float *samples;
    neph_assert_ok(neph_image_create(8, 6, &image, NULL), NULL);
    neph_assert_ok(neph_image_add_channel(image, "Y", &samples, NULL), NULL);
    samples[8 * 2 + 3] = 7.0f;
    const struct neph_window part = {.min_px = {3, 2}, .size_px = {2, 2}, .display_px = {8, 6}};
    neph_assert_ok(neph_image_place(image, &part, outside, NULL), NULL);
    assert_true(neph_image_channel(image, "Y")[0] == 7.0f);
    const struct neph_window found = neph_image_window(image);
    assert_true(neph_window_is_equal(&found, &part));
    neph_image_destroy(image);
}

static void test_other_display_windows_and_sizes_are_refused(void **state)
{
    (void)state;
    const struct neph_window windows[] = {
        {.size_px = {9, 6}, .display_px = {9, 6}},
        {.size_px = {8, 0}, .display_px = {8, 6}},
        {.size_px = {NEPH_IMAGE_SIDE_MAX_PX + 1, 6}, .display_px = {8, 6}},
    };
    for (size_t i = 0; i < sizeof(windows) / sizeof(windows[0]); i++) {
        struct neph_image *image = make_image(0, 0, 8, 6);
        assert_int_equal(neph_image_place(image, &windows[i], outside, NULL), NEPH_ERR_INPUT);
        neph_image_destroy(image);
    }
}

#include "tests/main.h"
