/* SPDX-License-Identifier: MIT
 *
 * Tone mapping: the shader compared with its formulas in double precision, and the formulas with
 * published values.
 */
#include "tests/renderer/post_test.h"

#include "renderer/post/colour.h"
#include "renderer/post/film.h"

#include <float.h>

/* ---- the formulas in double ------------------------------------------------------------------ */

struct rgb {
    double c[3];
};

static double largest(struct rgb x)
{
    return fmax(x.c[0], fmax(x.c[1], x.c[2]));
}

static double least(struct rgb x)
{
    return fmin(x.c[0], fmin(x.c[1], x.c[2]));
}

static struct rgb times(struct neph_matrix3 m, struct rgb x)
{
    struct rgb made = {{0}};
    for (int row = 0; row < 3; row++)
        for (int k = 0; k < 3; k++)
            made.c[row] += m.m[row][k] * x.c[k];
    return made;
}

static double saturation(struct rgb x)
{
    return (fmax(largest(x), 1e-10) - fmax(least(x), 1e-10)) / fmax(largest(x), 1e-2);
}

/* ACES 1.0 (Academy S-2014-004), glow: gain 0.05, middle 0.08. */
static struct rgb with_glow(struct rgb x)
{
    const double r = x.c[0], g = x.c[1], b = x.c[2];
    const double chroma = sqrt(fmax(r * r + g * g + b * b - r * g - g * b - b * r, 0.0));
    const double y = (r + g + b + 1.75 * chroma) / 3.0;
    const double at = (saturation(x) - 0.4) / 0.2, t = fmax(1.0 - fabs(at / 2.0), 0.0);
    const double shape = 0.5 * (1.0 + copysign(1.0 - t * t, at));
    const double part = y <= 0.16 / 3.0 ? 1.0 : y >= 0.16 ? 0.0 : 0.08 / y - 0.5;
    for (int i = 0; i < 3; i++)
        x.c[i] *= 1.0 + 0.05 * shape * part;
    return x;
}

/* ACES's red modifier with Unreal's weight, the square of a smoothstep of the hue. */
static struct rgb with_less_red(struct rgb x)
{
    const double hue = atan2(sqrt(3.0) * (x.c[1] - x.c[2]), 2.0 * x.c[0] - x.c[1] - x.c[2]);
    const double t = fmax(1.0 - fabs(2.0 * hue * 180.0 / 3.14159265358979323846 / 135.0), 0.0);
    const double smooth = t * t * (3.0 - 2.0 * t);
    x.c[0] += smooth * smooth * saturation(x) * (0.03 - x.c[0]) * 0.18;
    return x;
}

static double film(const struct neph_film *f, double x)
{
    const struct neph_film_joints at = neph_film_joints(f);
    const double place = log10(x), straight = f->slope * (place + at.straight_match);
    const double toe_scale = 1.0 + f->black_clip - f->toe;
    const double shoulder_scale = 1.0 + f->white_clip - f->shoulder;
    const double toe = place < at.toe_match
                           ? toe_scale *
                                     (1.0 + tanh(f->slope / toe_scale * (place - at.toe_match))) -
                                 f->black_clip
                           : straight;
    const double shoulder = place > at.shoulder_match
                                ? 1.0 + f->white_clip -
                                      shoulder_scale * (1.0 - tanh(f->slope / shoulder_scale *
                                                                   (place - at.shoulder_match)))
                                : straight;
    double way = (place - at.toe_match) / (at.shoulder_match - at.toe_match);
    way = fmin(fmax(way, 0.0), 1.0);
    if (at.shoulder_match < at.toe_match)
        way = 1.0 - way;
    return toe + way * way * (3.0 - 2.0 * way) * (shoulder - toe);
}

static struct rgb unreal(const struct neph_film *f, struct rgb x)
{
    static const double luminance[3] = {0.2722287168, 0.6740817658, 0.0536895174};
    x = times(neph_colour_matrix(&neph_rec709, &neph_ap0), x);
    x = times(neph_colour_matrix(&neph_ap0, &neph_ap1), with_less_red(with_glow(x)));
    for (int pass = 0; pass < 2; pass++) {
        double y = 0.0;
        for (int i = 0; i < 3; i++)
            x.c[i] = fmax(x.c[i], 0.0);
        for (int i = 0; i < 3; i++)
            y += luminance[i] * x.c[i];
        for (int i = 0; i < 3; i++)
            x.c[i] = y + (pass ? 0.93 : 0.96) * (x.c[i] - y);
        for (int i = 0; i < 3 && !pass; i++)
            x.c[i] = film(f, x.c[i]);
    }
    for (int i = 0; i < 3; i++)
        x.c[i] = fmax(x.c[i], 0.0);
    return times(neph_colour_matrix(&neph_ap1, &neph_rec709), x);
}

static struct rgb neutral(struct rgb x)
{
    const double low = least(x), offset = low < 0.08 ? low - 6.25 * low * low : 0.04;
    for (int i = 0; i < 3; i++)
        x.c[i] -= offset;
    const double peak = largest(x);
    if (peak < 0.76)
        return x;
    const double held = 1.0 - 0.0576 / (peak - 0.52),
                 faded = 1.0 - 1.0 / (0.15 * (peak - held) + 1.0);
    for (int i = 0; i < 3; i++)
        x.c[i] = (1.0 - faded) * x.c[i] * held / peak + faded * held;
    return x;
}

static double srgb(double x)
{
    return x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1.0 / 2.4) - 0.055;
}

static const struct neph_film default_film = {0.88, 0.55, 0.26, 0.0, 0.04};

static struct rgb mapped(int map, struct rgb x)
{
    switch (map) {
    case POST_MAP_UNREAL:
        return unreal(&default_film, x);
    case POST_MAP_NEUTRAL:
        return neutral(x);
    default:
        for (int i = 0; i < 3; i++) {
            const double v = x.c[i];
            if (map == POST_MAP_REINHARD)
                x.c[i] = v / (1.0 + v);
            else if (map == POST_MAP_NARKOWICZ)
                x.c[i] = v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14);
        }
        return x;
    }
}

/* ---- running the chain ----------------------------------------------------------------------- */

static struct neph_image *make_image(int width, int height, const struct rgb *colours)
{
    float *rgb[3];
    struct neph_image *image = post_image(width, height, rgb);
    for (int i = 0; i < width * height; i++)
        for (int c = 0; c < 3; c++)
            rgb[c][i] = (float)colours[i].c[c];
    return image;
}

/* ---- published values ------------------------------------------------------------------------ */

static void test_glow_and_red_are_those_of_aces(void **state)
{
    /* OpenColorIO 2.1.2, ACES_GLOW_10. */
    static const struct rgb glow[][2] = {
        {{{0.11, 0.02, 0.0}}, {{0.11154121, 0.02028021, 0.0}}},
        {{{0.01, 0.02, 0.03}}, {{0.01047222, 0.02094444, 0.03141666}}},
        {{{0.11, 0.91, 0.01}}, {{0.11, 0.91, 0.01}}}};
    /* Red with Unreal's weight, computed independently from the formula. */
    static const struct rgb red[] = {
        {{0.90, 0.05, 0.22}}, {{0.97, 0.097, 0.0097}}, {{0.89, 0.15, 0.56}}};
    static const double less_red[] = {0.77200636, 0.80713493, 0.85731006};
    for (size_t i = 0; i < COUNT(glow); i++)
        for (int c = 0; c < 3; c++)
            /* computed in float32, printed with 8 digits */
            neph_assert_close(with_glow(glow[i][0]).c[c], glow[i][1].c[c], 4.0 * FLT_EPSILON, 5e-9);
    for (size_t i = 0; i < COUNT(red); i++)
        neph_assert_close(with_less_red(red[i]).c[0], less_red[i], 0.0, 6e-9);
}

static void test_the_film_curve_is_unreals(void **state)
{
    static const double grey[][2] = {{0.01, 0.0017}, {0.05, 0.0248}, {0.18, 0.18},  {0.5, 0.5184},
                                     {1.0, 0.7234},  {4.0, 0.9442},  {16.0, 1.0142}};
    static const struct neph_film presets[] = {{0.63, 0.55, 0.47, 0.0, 0.01},
                                               {0.65, 0.63, 0.45, 0.0, 0.0},
                                               {0.98, 0.3, 0.22, 0.0, 0.025},
                                               {0.91, 0.53, 0.23, 0.0, 0.035}};
    for (size_t i = 0; i < COUNT(grey); i++)
        neph_assert_close(film(&default_film, grey[i][0]), grey[i][1], 0.0, 5e-5); /* 4 digits */
    for (size_t i = 0; i < COUNT(presets); i++)
        neph_assert_close(film(&presets[i], 0.18), 0.18, 1e-12, 0.0);
    neph_assert_close(film(&presets[3], 1.0), 0.7264, 0.0, 5e-5);
    const struct neph_film high_toe = {0.88, 0.9, 0.05, 0.0, 0.04}; /* grey on the straight part */
    const struct neph_film_joints at = neph_film_joints(&high_toe);
    neph_assert_close(high_toe.slope * (log10(0.18) + at.straight_match), 0.18, 1e-12, 0.0);
}

static void test_narkowicz_is_his(void **state)
{
    static const double values[][2] = {{0.18, 0.2669}, {1.0, 0.8038}, {4.0, 0.9734}};
    for (size_t i = 0; i < COUNT(values); i++)
        neph_assert_close(mapped(POST_MAP_NARKOWICZ, (struct rgb){{values[i][0], 0, 0}}).c[0],
                          values[i][1], 0.0, 5e-5);
}

static void test_matrices_are_those_of_aces(void **state)
{
    /* Academy TB-2014-004 (AP1 to AP0); ITU-R BT.709 to ACEScg from OpenColorIO's
     * configurations. */
    static const double ap1_to_ap0[3] = {0.6954522414, 0.1406786965, 0.1638690622};
    static const double rec709_to_ap1[3] = {0.61309740, 0.33952315, 0.04737945};
    const struct neph_matrix3 a = neph_colour_matrix(&neph_ap1, &neph_ap0);
    const struct neph_matrix3 b = neph_colour_matrix(&neph_rec709, &neph_ap1);
    for (int k = 0; k < 3; k++) {
        neph_assert_close(a.m[0][k], ap1_to_ap0[k], 0.0, 1e-9);
        neph_assert_close(b.m[0][k], rec709_to_ap1[k], 0.0, 1e-7);
    }
}

/* Light with Y = 1 in Rec.709; the matrix is from W3C's CSS Color 4. */
static struct rgb white_point_light(double temperature_k)
{
    const struct neph_chromaticity seen = neph_white_chromaticity(temperature_k);
    const double x = seen.x / seen.y, z = (1.0 - seen.x - seen.y) / seen.y;
    return (struct rgb){{3.24096994 * x - 1.53738318 - 0.49861076 * z,
                         -0.96924364 * x + 1.87596750 + 0.04155506 * z,
                         0.05563008 * x - 0.20397696 + 1.05697151 * z}};
}

static void test_white_balance_makes_its_light_white(void **state)
{
    for (double t = 1700.0; t < 25000.0; t *= 1.3) {
        const struct rgb seen = times(neph_white_balance(t), white_point_light(t));
        for (int c = 0; c < 3; c++)
            neph_assert_close(seen.c[c], white_point_light(NEPH_WHITE_K).c[c], 1e-6,
                              0.0); /* 8 digits, a gain of 5 */
    }
    neph_assert_close(neph_white_chromaticity(NEPH_WHITE_K).x, 0.3127, 0.0,
                      1.2e-4); /* D65, to 4 digits */
    neph_assert_close(neph_white_chromaticity(NEPH_WHITE_K).y, 0.3290, 0.0, 1.2e-4);
}

/* ---- the shader ------------------------------------------------------------------------------ */

enum { width = 61, height = 37, count = width * height };

static void fill(struct rgb colours[count], uint64_t seed)
{
    for (int i = 0; i < count; i++) {
        const double level = pow(10.0, -4.0 + 7.0 * neph_test_uniform(&seed, 0.0, 1.0));
        for (int c = 0; c < 3; c++)
            colours[i].c[c] = i % 7 == c ? 0.0 : level * neph_test_uniform(&seed, 0.0, 1.0);
        if (i % 5 == 0)
            colours[i].c[1] = colours[i].c[2] = colours[i].c[0]; /* greys */
    }
}

/* float32 through matrices of condition 3, logarithms and powers: some 30 roundings of 6e-8, and a
 * curve steeper than 1 (the film's slope over log10, sRGB's 12.92 near black). */
static const double shader_tolerance = 1e-5;

static void test_the_shader_is_its_formulas(void **state)
{
    static const char *const names[] = {"none", "reinhard", "narkowicz", "unreal", "neutral"};
    struct rgb colours[count];
    fill(colours, 20261125);
    OWNED(image) struct neph_image *image = make_image(width, height, colours);
    for (int map = 0; map < (int)COUNT(names); map++)
        for (int encodes = 0; encodes < 2; encodes++) {
            char text[128];
            float *rgb[3];
            snprintf(text, sizeof(text), "tone=on tone_map=%s encode=%s exposure_ev=-1.5",
                     names[map], encodes ? "srgb" : "linear");
            OWNED(image) struct neph_image *made = post_made(*state, text, image, rgb);
            for (int i = 0; i < count; i++) {
                struct rgb x = colours[i];
                for (int c = 0; c < 3; c++)
                    x.c[c] = (float)x.c[c] * exp2(-1.5);
                for (int c = 0; c < 3; c++)
                    x.c[c] = fmax(x.c[c], 0.0);
                x = mapped(map, x);
                for (int c = 0; c < 3; c++) {
                    const double held = fmin(fmax(x.c[c], 0.0), 1.0);
                    neph_assert_close(rgb[c][i], encodes ? srgb(held) : held, shader_tolerance,
                                      shader_tolerance);
                }
            }
        }
}

/* Interpolation error of 32 nodes over 14 stops: 0.45 stops apart. */
static void test_the_table_is_near_its_formula(void **state)
{
    struct rgb colours[count];
    fill(colours, 4);
    OWNED(image) struct neph_image *image = make_image(width, height, colours);
    float *table[3], *formula[3];
    double sum = 0.0, most = 0.0;
    OWNED(image) struct neph_image *by_table = post_made(*state, "tone=on lut=on", image, table);
    OWNED(image) struct neph_image *by_formula = post_made(*state, "tone=on", image, formula);
    for (int i = 0; i < count; i++)
        for (int c = 0; c < 3; c++) {
            const double error = fabs((double)table[c][i] - formula[c][i]);
            sum += error / (3.0 * count);
            most = fmax(most, error);
        }
    print_message("table of colours: mean error %.2g, largest %.2g of white\n", sum, most);
    assert_true(sum > 1e-5); /* differs from the formula */
    /* Linear interpolation between nodes h = 0.45 stops apart has an error of h^2 / 8 times the
     * second derivative, which is at most 0.2 per stop^2 on the encoded curve; for saturated
     * colours the red modifier's kinks come on top. */
    assert_true(sum < 0.2 * 0.45 * 0.45 / 8.0);
}

static void test_extremes_stay_numbers(void **state)
{
    static const double values[] = {0.0, FLT_TRUE_MIN, FLT_MIN, 1e-12, 1.0, 1e4, 1e30, FLT_MAX};
    enum { n = COUNT(values) };
    struct rgb colours[n * n * n];
    for (int i = 0; i < n * n * n; i++)
        colours[i] = (struct rgb){{values[i % n], values[i / n % n], values[i / (n * n)]}};
    OWNED(image) struct neph_image *image = make_image(n * n, n, colours);
    static const char *const settings[] = {
        "tone=on tone_map=none",
        "tone=on tone_map=reinhard",
        "tone=on tone_map=narkowicz",
        "tone=on tone_map=unreal",
        "tone=on tone_map=neutral",
        "tone=on lut=on",
        "tone=on exposure_ev=32",
        "tone=on exposure_ev=-32 grain=64 vignette=4",
        "tone=on film_slope=2 film_toe=0.99 film_shoulder=0.99 film_white_clip=0",
        "tone=on film_slope=0.01 film_toe=0 film_shoulder=0 film_black_clip=1"};
    for (size_t k = 0; k < COUNT(settings); k++) {
        float *rgb[3];
        OWNED(image) struct neph_image *made = post_made(*state, settings[k], image, rgb);
        for (int i = 0; i < n * n * n; i++)
            for (int c = 0; c < 3; c++)
                assert_true(rgb[c][i] >= 0.0f && rgb[c][i] <= 1.0f); /* NaN fails */
    }
}

static void test_the_corner_is_darker_by_the_fourth_power_of_the_cosine(void **state)
{
    struct rgb colours[count];
    for (int i = 0; i < count; i++)
        colours[i] = (struct rgb){{0.5, 0.5, 0.5}};
    OWNED(image) struct neph_image *image = make_image(width, height, colours);
    float *rgb[3];
    OWNED(image)
    struct neph_image *made = post_made(*state, "tone=on tone_map=none encode=linear vignette=1",
                                        image, rgb);
    const double x = (width - 1.0), y = (height - 1.0); /* centre of the corner pixel, doubled */
    const double tangent_2 = (x * x + y * y) / (double)(width * width + height * height);
    neph_assert_close(rgb[1][0], 0.5 / ((1.0 + tangent_2) * (1.0 + tangent_2)), shader_tolerance,
                      0.0);
    neph_assert_close(rgb[1][count / 2], 0.5, shader_tolerance, 0.0);
    assert_true(rgb[1][0] == rgb[1][count - 1]);
}

static void test_grain_is_uniform_noise_of_its_range(void **state)
{
    struct rgb colours[count];
    for (int i = 0; i < count; i++)
        colours[i] = (struct rgb){{0.25, 0.25, 0.25}};
    OWNED(image) struct neph_image *image = make_image(width, height, colours);
    float *rgb[3], *plain[3];
    double sum = 0.0, squares = 0.0;
    OWNED(image)
    struct neph_image *made = post_made(*state, "tone=on tone_map=none grain=8", image, rgb);
    OWNED(image)
    struct neph_image *without = post_made(*state, "tone=on tone_map=none", image, plain);
    for (int i = 0; i < count; i++) {
        const double step = (double)(rgb[0][i] - plain[0][i]) * 255.0 / 8.0;
        assert_true(fabs(step) <= 0.5001 &&
                    fabs(rgb[0][i] - plain[0][i] - (rgb[2][i] - plain[2][i])) < 1e-6);
        sum += step / count;
        squares += step * step / count;
    }
    /* 5 standard errors of as many uniform numbers. */
    neph_assert_close(sum, 0.0, 0.0, 5.0 * sqrt(1.0 / 12.0 / count));
    neph_assert_close(squares, 1.0 / 12.0, 0.0, 5.0 * sqrt(1.0 / 180.0 / count));
}

#include "tests/renderer/main.h"
