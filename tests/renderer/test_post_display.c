/* SPDX-License-Identifier: MIT
 *
 * AgX and an HDR display: published values, formulas in double precision, and the light that the
 * display makes of the codes.
 */
#include "tests/renderer/post_test.h"

#include "renderer/post/colour.h"
#include "renderer/post/display.h"

enum { width = 61, height = 37, count = width * height };

/* float32 through matrices, logarithms and powers; PQ's largest exponent is 78.8. */
static const double shader_tolerance = 2e-5;

/* Tolerance of light, relative to the largest channel: d log(light) / d code of PQ is up to 20 for
 * visible light. */
static const double light_tolerance = 20 * shader_tolerance;

static void fill(float *rgb[3], double least_ev, double most_ev, uint64_t seed)
{
    for (int i = 0; i < count; i++) {
        const double level = exp2(neph_test_uniform(&seed, least_ev, most_ev));
        for (int c = 0; c < 3; c++)
            rgb[c][i] = i % 5 == 0   ? (float)level
                        : i % 7 == c ? 0.0f
                                     : (float)(level * neph_test_uniform(&seed, 0.0, 1.0));
    }
}

/* ---- AgX ------------------------------------------------------------------------------------- */

/* The published curve with its constants: powers 3 and 13/4. */
static double agx_curve(double place)
{
    const double x = place - 20.0 / 33.0;
    return x < 0.0 ? 0.5 + 2.0 * x / pow(1.0 - 476063.0 / 8000.0 * x * x * x, 1.0 / 3.0)
                   : 0.5 + 2.0 * x / pow(1.0 + 69.86278913545539 * pow(x, 3.25), 1.0 / 3.25);
}

static void agx(const double from[3], double codes[3])
{
    static const double inset[3][3] = {{0.842479062253094, 0.0784335999999992, 0.0792237451477643},
                                       {0.0423282422610123, 0.878468636469772, 0.0791661274605434},
                                       {0.0423756549057051, 0.0784336, 0.879142973793104}};
    for (int c = 0; c < 3; c++) {
        double sum = 0.0;
        for (int k = 0; k < 3; k++)
            sum += inset[c][k] * from[k];
        const double place = (log2(fmax(sum, 1e-10)) + 12.47393) / (4.026069 + 12.47393);
        codes[c] = fmin(fmax(agx_curve(fmin(fmax(place, 0.0), 1.0)), 0.0), 1.0);
    }
}

/* OpenColorIO 2.1.2 with the author's configuration, view AgX of an sRGB display. */
static const double agx_published[][2][3] = {
    {{0.0001, 0.0001, 0.0001}, {0.0, 0.0, 0.0}},
    {{0.001, 0.001, 0.001}, {0.0151563, 0.0151538, 0.0151536}},
    {{0.01, 0.01, 0.01}, {0.0961625, 0.0961501, 0.0961494}},
    {{0.05, 0.05, 0.05}, {0.2819375, 0.2819102, 0.2819085}},
    {{0.18, 0.18, 0.18}, {0.5000240, 0.4999935, 0.4999916}},
    {{0.5, 0.5, 0.5}, {0.6772107, 0.6771815, 0.6771797}},
    {{1, 1, 1}, {0.7875352, 0.7875099, 0.7875082}},
    {{4, 4, 4}, {0.9378113, 0.9377991, 0.9377984}},
    {{16, 16, 16}, {0.9995430, 0.9995385, 0.9995383}},
    {{1, 0, 0}, {0.7617990, 0.2563027, 0.2564708}},
    {{0, 1, 0}, {0.3558206, 0.7681906, 0.3558206}},
    {{0, 0, 1}, {0.3575223, 0.3573989, 0.7683073}},
    {{4, 0.2, 0.02}, {0.9254061, 0.6143481, 0.5208318}},
    {{0.02, 0.3, 2}, {0.5173959, 0.6486065, 0.8634018}},
    {{0.9, 0.05, 0.22}, {0.7497613, 0.3965084, 0.5469710}},
    {{0.3, 0.4, 0.1}, {0.5845638, 0.6265991, 0.4457846}}};

static void test_agx_is_its_authors(void **state)
{
    for (size_t i = 0; i < COUNT(agx_published); i++) {
        double codes[3];
        agx(agx_published[i][0], codes);
        for (int c = 0; c < 3; c++) /* 4096 entries of 7 digits, linear between them */
            neph_assert_close(codes[c], agx_published[i][1][c], 0.0, 1e-6);
    }
}

static void test_the_shader_is_agx(void **state)
{
    float *in[3], *out[3];
    OWNED(image) struct neph_image *image = post_image(width, height, in);
    fill(in, -14.0, 6.0, 5);
    OWNED(image)
    struct neph_image *made = post_made(*state, "tone=on tone_map=agx encode=linear", image, out);
    for (int i = 0; i < count; i++) {
        double codes[3];
        agx((const double[3]){in[0][i], in[1][i], in[2][i]}, codes);
        for (int c = 0; c < 3; c++)
            neph_assert_close(out[c][i], pow(codes[c], 2.2), 0.0, shader_tolerance);
    }
}

/* ---- PQ -------------------------------------------------------------------------------------- */

/* ST 2084, eq. 5. */
static double pq(double nits)
{
    const double y = pow(fmin(fmax(nits, 0.0), 10000.0) / 10000.0, 0.1593017578125);
    return pow((0.8359375 + 18.8515625 * y) / (1.0 + 18.6875 * y), 78.84375);
}

/* OpenColorIO 2.1.2, LINEAR_to_ST-2084; ITU-R BT.2408-8: 38 % and 58 % for 26 and 203 cd/m^2. Code
 * 1/2 is 92.2 cd/m^2. */
static void test_pq_is_as_published(void **state)
{
    static const double codes[][2] = {{0.0, 0.0000007},   {1.0, 0.1499457},    {100.0, 0.5080784},
                                      {203.0, 0.5806888}, {1000.0, 0.7518271}, {10000.0, 1.0}};
    for (size_t i = 0; i < COUNT(codes); i++) {
        neph_assert_close(pq(codes[i][0]), codes[i][1], 0.0, 1.5e-7); /* float32 there */
        neph_assert_close(neph_pq_nits(pq(codes[i][0])), codes[i][0], 1e-9, 1e-9);
    }
    neph_assert_close(pq(26.0), 0.38, 0.0, 5e-3);
    neph_assert_close(pq(203.0), 0.58, 0.0, 5e-3);
    neph_assert_close(neph_pq_nits(0.5), 92.2, 0.0, 0.06);
}

/* ITU-R BT.2087, four digits. */
static void test_primaries_are_those_of_bt_2020(void **state)
{
    static const double published[3][3] = {
        {0.6274, 0.3293, 0.0433}, {0.0691, 0.9195, 0.0114}, {0.0164, 0.0880, 0.8956}};
    const struct neph_matrix3 made = neph_colour_matrix(&neph_rec709, &neph_rec2020);
    for (int i = 0; i < 9; i++)
        neph_assert_close(made.m[i / 3][i % 3], published[i / 3][i % 3], 0.0, 5e-5);
}

static void to_rec2020(const double from[3], double made[3])
{
    const struct neph_matrix3 m = neph_colour_matrix(&neph_rec709, &neph_rec2020);
    for (int c = 0; c < 3; c++)
        made[c] = m.m[c][0] * from[0] + m.m[c][1] * from[1] + m.m[c][2] * from[2];
}

static void test_the_shader_is_pq_held_to_the_peak(void **state)
{
    float *in[3], *out[3];
    OWNED(image) struct neph_image *image = post_image(width, height, in);
    fill(in, -12.0, 5.0, 6);
    OWNED(image)
    struct neph_image *made = post_made(
        *state, "tone=on tone_map=none encode=pq white_nits=203 peak_nits=1000", image, out);
    bool reached = false;
    for (int i = 0; i < count; i++) {
        double nits[3];
        to_rec2020((const double[3]){203.0 * in[0][i], 203.0 * in[1][i], 203.0 * in[2][i]}, nits);
        for (int c = 0; c < 3; c++) {
            neph_assert_close(out[c][i], pq(fmin(nits[c], 1000.0)), 0.0, shader_tolerance);
            reached = reached || nits[c] > 1000.0;
        }
    }
    assert_true(reached);
}

/* ---- BT.2390 --------------------------------------------------------------------------------- */

static double bt2390(double nits, double peak_nits)
{
    const double code = pq(nits), peak = pq(peak_nits), knee = 1.5 * peak - 0.5;
    const double t = (code - knee) / (1.0 - knee);
    if (code < knee)
        return nits;
    return neph_pq_nits((2 * t * t * t - 3 * t * t + 1) * knee +
                        (t * t * t - 2 * t * t + t) * (1 - knee) +
                        (3 * t * t - 2 * t * t * t) * peak);
}

/* Slope 0 at the top; continuous in value and slope at the knee. */
static void test_the_roll_off_is_bt_2390s(void **state)
{
    const double peak = pq(1000.0), knee_nits = neph_pq_nits(1.5 * peak - 0.5);
    neph_assert_close(bt2390(10000.0, 1000.0), 1000.0, 1e-9, 0.0);
    neph_assert_close(knee_nits, 316.0, 0.0, 2.0);
    const double above = bt2390(knee_nits * 1.0001, 1000.0);
    neph_assert_close(above / knee_nits, 1.0001, 1e-6, 0.0);
    neph_assert_close(bt2390(9990.0, 1000.0), 1000.0, 1e-5, 0.0);
}

static void test_the_shader_rolls_off(void **state)
{
    float *in[3], *out[3];
    OWNED(image) struct neph_image *image = post_image(width, height, in);
    fill(in, -8.0, 6.0, 7);
    for (int hdr = 0; hdr < 2; hdr++) {
        OWNED(image)
        struct neph_image *made = post_made(*state,
                                            hdr ? "tone=on tone_map=bt2390 encode=pq"
                                                : "tone=on tone_map=bt2390 encode=linear",
                                            image, out);
        for (int i = 0; i < count; i++) {
            const double most = fmax(in[0][i], fmax(in[1][i], in[2][i]));
            const double gain = bt2390(203.0 * most, hdr ? 1000.0 : 203.0) / (203.0 * most);
            double shown[3] = {gain * in[0][i], gain * in[1][i], gain * in[2][i]};
            if (hdr)
                to_rec2020((const double[3]){shown[0], shown[1], shown[2]}, shown);
            for (int c = 0; c < 3; c++)
                neph_assert_close(out[c][i], hdr ? pq(203.0 * shown[c]) : shown[c], 0.0,
                                  hdr ? shader_tolerance : light_tolerance * gain * most);
        }
    }
}

/* ---- the display ----------------------------------------------------------------------------- */

/* Codes and back: the frame's light over the peak, for light below the peak. */
static void test_the_display_shows_the_light(void **state)
{
    const struct neph_settings settings = post_settings("tone=on tone_map=none encode=pq");
    float *in[3], *out[3];
    OWNED(image) struct neph_image *image = post_image(width, height, in);
    fill(in, -6.0, 2.2, 8); /* 203 * 2^2.2 < 1000 */
    OWNED(image)
    struct neph_image *made = post_made(*state, "tone=on tone_map=none encode=pq", image, out);
    assert_true(neph_post_is_hdr(&settings));
    static uint16_t codes[3 * count];
    neph_post_encode_codes(&settings, made, 10, codes);
    for (int i = 0; i < count; i++)
        assert_true(fabs(codes[3 * i + 1] - 1023.0 * out[1][i]) <= 0.5);
    neph_post_apply_display(&settings, made);
    for (int i = 0; i < count; i++) {
        const double most = fmax(in[0][i], fmax(in[1][i], in[2][i]));
        for (int c = 0; c < 3; c++)
            neph_assert_close(1000.0 * out[c][i], 203.0 * in[c][i], 0.0,
                              light_tolerance * 203.0 * most);
    }
}

/* 10 to 16 bits of an sRGB display: the 8-bit codes with more digits. */
static void test_codes_have_the_requested_bits(void **state)
{
    const struct neph_settings settings = post_settings("tone=on tone_map=none");
    float *in[3];
    OWNED(image) struct neph_image *image = post_image(width, height, in);
    for (int i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            in[c][i] = (float)i / (count - 1);
    for (int bits = 8; bits <= 16; bits++) {
        static uint16_t codes[3 * count];
        neph_post_encode_codes(&settings, image, bits, codes);
        const double largest = (1 << bits) - 1;
        assert_int_equal(codes[0], 0);
        assert_int_equal(codes[3 * count - 1], (int)largest);
        for (int i = 0; i < count; i++)
            assert_true(fabs(codes[3 * i] - largest * i / (count - 1)) < 0.51);
    }
}

#include "tests/renderer/main.h"
