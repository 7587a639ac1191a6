/* SPDX-License-Identifier: MIT
 *
 * Display encoding against the closed form of IEC 61966-2-1, and the colours of difference maps.
 */
#include "tests/metrics/metrics_test.h"

#include "metrics/display.h"

enum { RAMP = 3 * 4096 + 7 }; /* more than one block of the encoder, with a partial block */

static double srgb(double linear)
{
    double x = fmin(fmax(linear, 0.0), 1.0);
    return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055;
}

static void encode_one(float r, float g, float b, double exposure_ev, uint8_t out[3])
{
    const float *const planes[3] = {&r, &g, &b};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_display_encode(planes, 1, exposure_ev, out, &diag), &diag);
}

static void assert_encoded(float r, float g, float b, double exposure_ev, int out_r, int out_g,
                           int out_b)
{
    uint8_t out[3];
    encode_one(r, g, b, exposure_ev, out);
    if (out[0] != out_r || out[1] != out_g || out[2] != out_b)
        fail_msg("(%g, %g, %g) at %g EV is (%d, %d, %d), not (%d, %d, %d)", (double)r, (double)g,
                 (double)b, exposure_ev, out[0], out[1], out[2], out_r, out_g, out_b);
}

static void test_known_codes(void **state)
{
    assert_encoded(0.18f, 0.18f, 0.18f, 0.0, 118, 118, 118); /* 117.65 */
    assert_encoded(0, 0, 0, 0.0, 0, 0, 0);
    assert_encoded(1, 1, 1, 0.0, 255, 255, 255);
    assert_encoded(1, 0, 0, 0.0, 255, 0, 0);
    assert_encoded(0, 1, 0, 0.0, 0, 255, 0);
    assert_encoded(0, 0, 1, 0.0, 0, 0, 255);
    assert_encoded(0.045f, 0.045f, 0.045f, 2.0, 118, 118, 118);
    assert_encoded(0.72f, 0.72f, 0.72f, -2.0, 118, 118, 118);
    assert_encoded(0.18f * 0x1p-64f, 0, 0, 64.0, 118, 0, 0);
}

static void test_outside_the_range(void **state)
{
    assert_encoded(-1, -0.001f, 0, 0.0, 0, 0, 0);
    assert_encoded(-1000, 0.18f, 1000, 0.0, 0, 118, 255);
    assert_encoded(1e30f, 0, 0, 0.0, 255, 0, 0); /* nothing leaks into the dark channels */
    assert_encoded(0, 1e30f, 0, 10.0, 0, 255, 0);
    assert_encoded(0, 0, 1e30f, -10.0, 0, 0, 255);
    assert_encoded(INFINITY, 0.18f, -INFINITY, 0.0, 255, 118, 0);
    for (int c = 0; c < 3; c++) {
        float rgb[3] = {0.5f, 0.5f, 0.5f};
        rgb[c] = NAN;
        assert_encoded(rgb[0], rgb[1], rgb[2], 0.0, 255, 0, 255);
    }
}

/* One channel follows the curve, the others are constant. The exact code is within rounding, and
 * 0.02 more for the float arithmetic of the encoder. */
static void test_ramp_against_closed_form(void **state)
{
    float *planes[3];
    uint8_t *out = malloc((size_t)RAMP * 3);
    assert_non_null(out);
    for (int c = 0; c < 3; c++) {
        planes[c] = malloc(RAMP * sizeof(float));
        assert_non_null(planes[c]);
    }
    const float *const rgb[3] = {planes[0], planes[1], planes[2]};
    double worst = 0.0;
    for (int exposure_ev = -3; exposure_ev <= 3; exposure_ev++) {
        for (int i = 0; i < RAMP; i++)
            for (int c = 0; c < 3; c++)
                planes[c][i] = (float)ldexp((double)((i * (c + 1)) % RAMP) / (RAMP - 1),
                                            -exposure_ev);
        struct neph_diag diag = {0};
        neph_assert_ok(neph_display_encode(rgb, RAMP, (double)exposure_ev, out, &diag), &diag);
        for (int i = 0; i < RAMP; i++) {
            for (int c = 0; c < 3; c++) {
                double exact = 255.0 * srgb(ldexp((double)planes[c][i], exposure_ev));
                worst = fmax(worst, fabs((double)out[3 * i + c] - exact));
            }
        }
    }
    print_message("farthest from the closed form: %.4f codes\n", worst);
    assert_true(worst <= 0.52);
    for (int c = 0; c < 3; c++)
        free(planes[c]);
    free(out);
}

/* Near each threshold, and everywhere else: the table gives the same codes as the encoder. */
static void test_the_baked_table_is_the_encoder(void **state)
{
    enum { NEAR = 3 * 255, COUNT_ALL = NEAR + 4096 };
    float thresholds[256], grey[COUNT_ALL];
    uint8_t out[3 * COUNT_ALL];
    const float *const planes[3] = {grey, grey, grey};
    struct neph_diag diag = {0};
    neph_assert_ok(neph_display_bake(thresholds, &diag), &diag);
    for (int k = 1; k < 256; k++) {
        grey[3 * k - 3] = nextafterf(thresholds[k], -1.0f);
        grey[3 * k - 2] = thresholds[k];
        grey[3 * k - 1] = nextafterf(thresholds[k], 2.0f);
    }
    for (int i = NEAR; i < COUNT_ALL; i++)
        grey[i] = (float)(1.2 * sin(0.37 * i) * pow(0.5, i % 23)); /* of both signs, most dark */
    neph_assert_ok(neph_display_encode(planes, COUNT_ALL, 0.0, out, &diag), &diag);
    for (int i = 0; i < COUNT_ALL; i++) {
        int code = 0;
        while (code < 255 && grey[i] >= thresholds[code + 1])
            code++;
        assert_int_equal(out[3 * i], code);
    }
}

static void test_encode_refusals(void **state)
{
    const float one = 1.0f;
    const float *const planes[3] = {&one, &one, &one};
    uint8_t out[3] = {1, 2, 3};
    struct neph_diag diag = {0};
    assert_int_equal(neph_display_encode(planes, 1, 65.0, out, &diag), NEPH_ERR_INPUT);
    assert_int_equal(neph_display_encode(planes, 1, NAN, out, &diag), NEPH_ERR_INPUT);
    assert_int_equal(neph_display_encode(planes, 1, -INFINITY, out, NULL), NEPH_ERR_INPUT);
    neph_assert_ok(neph_display_encode(planes, 0, 0.0, out, &diag), &diag);
    assert_int_equal(out[0], 1);
}

/* ---- difference maps ------------------------------------------------------------------------- */

static void assert_difference(float reference, float test, double scale, const uint8_t *expected)
{
    const float *const from[1] = {&reference}, *const to[1] = {&test};
    uint8_t out[3];
    struct neph_diag diag = {0};
    neph_assert_ok(neph_display_difference(from, to, 1, 1, scale, out, &diag), &diag);
    assert_memory_equal(out, expected, 3);
}

static void test_stops_and_marks(void **state)
{
    const struct neph_display_legend *legend = neph_display_difference_legend();
    assert_true(legend->stops[0].position == -1.0);
    assert_true(legend->stops[legend->stop_count - 1].position == 1.0);
    for (int i = 0; i < legend->stop_count; i++) {
        const struct neph_display_stop *stop = &legend->stops[i];
        assert_true(i == 0 || stop->position > stop[-1].position);
        assert_difference(8.0f, 8.0f + (float)(4.0 * stop->position), 4.0, stop->rgb);
    }
    assert_difference(8, 4, 4, legend->stops[0].rgb); /* the end of the scale is included */
    assert_difference(8, 3.99f, 4, legend->below);
    assert_difference(8, 12.01f, 4, legend->above);
    assert_difference(8, NAN, 4, legend->not_a_number);
    assert_difference(NAN, 8, 4, legend->not_a_number);
    static const uint8_t between[3] = {0xfa, 0xe9, 0xdf}; /* halfway from f7f7f7 to fddbc7 */
    assert_difference(1, 1.4f, 4, between);
}

/* Blue for darker, red for brighter, at any size of the difference. */
static void test_hue_tells_the_sign(void **state)
{
    for (int i = 1; i <= 100; i++) {
        float change = 0.01f * (float)i;
        const float reference = 2.0f, darker = 2.0f - change, brighter = 2.0f + change;
        const float *const from[1] = {&reference}, *const down[1] = {&darker},
                           *const up[1] = {&brighter};
        uint8_t out[3];
        neph_assert_ok(neph_display_difference(from, down, 1, 1, 1.001, out, NULL), NULL);
        assert_true(out[2] > out[0]);
        neph_assert_ok(neph_display_difference(from, up, 1, 1, 1.001, out, NULL), NULL);
        assert_true(out[0] > out[2]);
    }
}

static void test_depth_and_sky(void **state)
{
    const struct neph_display_legend *legend = neph_display_difference_legend();
    const uint8_t *equal = legend->stops[legend->stop_count / 2].rgb;
    assert_difference(INFINITY, INFINITY, 1, equal);
    assert_difference(5, INFINITY, 1, legend->above);
    assert_difference(INFINITY, 5, 1, legend->below);
}

static void test_luminance_of_colours(void **state)
{
    const struct neph_display_legend *legend = neph_display_difference_legend();
    enum { PIXELS = 5 };
    float reference[3][PIXELS] = {{1, 1, 1, INFINITY, 1}, {1, 1, 1, 1, 1}, {1, 1, 1, 1, 1}};
    float test[3][PIXELS] = {{1, 2, 1, INFINITY, INFINITY}, {1, 2, NAN, 1, 1}, {1, 2, 1, 1, 1}};
    const float *const from[3] = {reference[0], reference[1], reference[2]};
    const float *const to[3] = {test[0], test[1], test[2]};
    uint8_t out[3 * PIXELS];
    struct neph_diag diag = {0};
    neph_assert_ok(neph_display_difference(from, to, 3, PIXELS, 2.5, out, &diag), &diag);
    assert_memory_equal(out, legend->stops[5].rgb, 3);
    assert_memory_equal(out + 3, legend->stops[7].rgb, 3); /* 1 of 2.5 */
    assert_memory_equal(out + 6, legend->not_a_number, 3);
    assert_memory_equal(out + 9, legend->not_a_number, 3);
    assert_memory_equal(out + 12, legend->not_a_number, 3);
}

static void test_difference_refusals(void **state)
{
    const float one = 1.0f;
    const float *const planes[3] = {&one, &one, &one};
    uint8_t out[3];
    static const double bad_scales[] = {0.0, -1.0, NAN, INFINITY};
    for (int i = 0; i < 4; i++)
        assert_int_equal(neph_display_difference(planes, planes, 1, 1, bad_scales[i], out, NULL),
                         NEPH_ERR_INPUT);
    assert_int_equal(neph_display_difference(planes, planes, 2, 1, 1.0, out, NULL),
                     NEPH_ERR_INTERNAL);
}

#include "tests/main.h"
