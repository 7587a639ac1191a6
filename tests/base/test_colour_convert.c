/* SPDX-License-Identifier: MIT
 *
 * Colours of other spaces in linear Rec. 709, by our names and by those of a source.
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
    neph_assert_ok(neph_colour_convert(image, NULL, NULL), NULL);
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
        assert_int_equal(neph_colour_convert(image, NULL, &diag), NEPH_ERR_INPUT);
        assert_non_null(strstr(diag.message, names[i]));
        assert_non_null(strstr(diag.hint, "lin_ap1_scene"));
        neph_image_destroy(image);
    }
}

/* ---- spaces of a source ---------------------------------------------------------------------- */

/* It has "film", also as "neg", whose values are doubled, and "lin_ap1_scene" as another space. */
static enum neph_status find(void *context, const char *name, const char **space,
                             struct neph_diag *diag)
{
    (void)context;
    const bool is_film = strcmp(name, "film") == 0 || strcmp(name, "neg") == 0;
    if (strcmp(name, "full") == 0)
        return neph_fail_memory(diag);
    if (!is_film && strcmp(name, "lin_ap1_scene") != 0)
        return neph_fail(diag, NEPH_ERR_INPUT, "it has no %s", name);
    *space = is_film ? "film" : "ap1";
    return NEPH_OK;
}

static enum neph_status convert(void *context, const char *space, float *const planes[3],
                                const int size_px[2], struct neph_diag *diag)
{
    assert_int_equal(size_px[0] * size_px[1], 1);
    if (strcmp(space, "film") != 0)
        return neph_fail(diag, NEPH_ERR_INPUT, "%s is torn", space);
    for (int c = 0; c < 3; c++)
        planes[c][0] *= 2.0f;
    ++*(int *)context;
    return NEPH_OK;
}

/* Names in colorInteropID and oiio:ColorSpace, the identifier that the reader derives; the result:
 * a part of the message, or the space of the source or of ours; NULL: unchanged. */
static void test_names_of_a_source_come_first(void **state)
{
    (void)state;
    static const struct {
        const char *names[2], *id;
        enum neph_status status;
        const char *result;
    } cases[] = {
        {{NULL, "film"}, "film", NEPH_OK, "film of a.ocio"},
        {{"neg", NULL}, "neg", NEPH_OK, "film of a.ocio"},
        {{"neg", "film"}, "neg and film", NEPH_OK, "film of a.ocio"},
        {{"unknown", "film"}, "film", NEPH_OK, "film of a.ocio"},
        {{NULL, "linear"}, NULL, NEPH_OK, NULL},
        {{NULL, "lin_ap0"}, "lin_ap0_scene", NEPH_OK, "lin_ap0_scene"},
        {{NULL, NULL}, NULL, NEPH_OK, NULL},
        {{NULL, "other"}, "other", NEPH_ERR_INPUT, "it has no other"},
        {{"film", "other"}, "film and other", NEPH_ERR_INPUT, "'film' and 'other'"},
        {{"lin_ap1_scene", "film"}, "lin_ap1_scene and film", NEPH_ERR_INPUT, "two colour spaces"},
        {{"lin_ap1_scene", NULL}, "lin_ap1_scene", NEPH_ERR_INPUT, "ap1 is torn"},
        {{NULL, "full"}, "full", NEPH_ERR_MEMORY, ""},
    };
    int calls = 0;
    const struct neph_colour_source source = {&calls, "a.ocio", find, convert};
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct neph_image *image = make_pixel(cases[i].id, (const double[3]){1.0, 1.0, 1.0});
        struct neph_diag diag = {0};
        float *planes[3];
        neph_assert_ok(neph_image_add_rgb(image, "volume", planes, NULL), NULL);
        for (int a = 0; a < 2; a++)
            if (cases[i].names[a])
                neph_assert_ok(neph_image_set_attribute(image,
                                                        a ? "oiio:ColorSpace" : "colorInteropID",
                                                        NULL, "%s", cases[i].names[a]),
                               NULL);
        const bool is_film = cases[i].result && strstr(cases[i].result, "a.ocio");
        calls = 0;
        assert_int_equal(neph_colour_convert(image, &source, &diag), cases[i].status);
        assert_int_equal(calls, is_film ? 2 : 0); /* of the surface and of the volume */
        assert_true(!is_film || neph_image_channel(image, "G")[0] == 2.0f);
        const char *from = neph_image_attribute(image, NEPH_CONVERTED_ATTRIBUTE);
        if (cases[i].status)
            assert_non_null(strstr(diag.message, cases[i].result));
        else
            assert_true(from && cases[i].result ? strcmp(from, cases[i].result) == 0
                                                : from == cases[i].result);
        neph_image_destroy(image);
    }
}

#include "tests/main.h"
