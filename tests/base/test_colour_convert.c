/* SPDX-License-Identifier: MIT
 *
 * Colours of other spaces in linear Rec. 709.
 */
#include "base/colour_convert.h"
#include "base/exr.h"
#include "tests/base/scratch.h"

#include <math.h>
#include <string.h>

/* A pixel in a named space. */
static struct neph_image *make_pixel(const char *space, const double rgb[3])
{
    struct neph_image *image = NULL;
    float *planes[3];
    neph_assert_ok(neph_image_create(1, 1, &image, NULL), NULL);
    neph_assert_ok(neph_image_add_rgb(image, NULL, planes, NULL), NULL);
    if (space)
        neph_assert_ok(neph_image_set_attribute(image, "colour_space", NULL, "%s", space), NULL);
    for (int c = 0; c < 3; c++)
        planes[c][0] = (float)rgb[c];
    return image;
}

static void assert_converted(const char *space, const double from[3], const double to[3],
                             double tolerance)
{
    struct neph_image *image = make_pixel(space, from);
    float *planes[3];
    neph_assert_ok(neph_colour_convert(image, NULL), NULL);
    assert_true(neph_image_rgb(image, NULL, planes));
    for (int c = 0; c < 3; c++)
        neph_assert_close((double)planes[c][0], to[c], 0.0, tolerance);
    assert_null(neph_image_attribute(image, "colour_space"));
    assert_true(!space ||
                strcmp(neph_image_attribute(image, NEPH_CONVERTED_ATTRIBUTE), space) == 0);
    neph_image_destroy(image);
}

static void test_white_stays_white(void **state)
{
    (void)state;
    static const char *const names[] = {
        "lin_ap0_scene",  "lin_ap1_scene",      "lin_rec2020_scene", "lin_p3d65_scene",
        "srgb_ap1_scene", "lin_adobergb_scene", "g22_rec709_scene",  "srgb_rec709_scene"};
    static const double white[3] = {1.0, 1.0, 1.0}, black[3] = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        assert_converted(names[i], white, white, 0x1p-23);
        assert_converted(names[i], black, black, 0.0);
    }
    assert_converted(NULL, white, white, 0.0);
}

/* A column of the published matrix (test_chromaticities.c), the curves at their published points,
 * and the white of CIE XYZ. */
static void test_known_colours(void **state)
{
    (void)state;
    assert_converted("lin_ap1_scene", (const double[3]){0.0, 2.0, 0.0},
                     (const double[3]){-1.24358, 2.28160, -0.25794}, 2e-5);
    assert_converted("srgb_rec709_scene", (const double[3]){0.04045, 0.5, -0.5},
                     (const double[3]){0.04045 / 12.92, 0.21404114, -0.21404114}, 1e-7);
    assert_converted("g22_rec709_scene", (const double[3]){0.5, 0.25, 2.0},
                     (const double[3]){pow(0.5, 2.2), pow(0.25, 2.2), pow(2.0, 2.2)}, 1e-6);
    assert_converted("lin_ciexyzd65_scene",
                     (const double[3]){0.3127 / 0.329, 1.0, (1.0 - 0.3127 - 0.329) / 0.329},
                     (const double[3]){1.0, 1.0, 1.0}, 1e-6); /* floats of XYZ */
}

static void test_other_names_are_refused(void **state)
{
    (void)state;
    static const char *const names[] = {"acescct", "data", "lin_ap1_scene and lin_ap0_scene"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        struct neph_image *image = make_pixel(names[i], (const double[3]){1.0, 1.0, 1.0});
        struct neph_diag diag = {0};
        assert_int_equal(neph_colour_convert(image, &diag), NEPH_ERR_INPUT);
        assert_non_null(strstr(diag.message, names[i]));
        assert_non_null(strstr(diag.hint, "lin_ap1_scene"));
        neph_image_destroy(image);
    }
}

#include "tests/main.h"
