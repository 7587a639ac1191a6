/* SPDX-License-Identifier: MIT
 *
 * Upscalers: the values of their kernels, and properties of every filter: a constant stays
 * constant, a mirrored image gives the mirrored result, and a scale of 1 changes nothing.
 */
#include "tests/renderer/post_test.h"

static const char *const filters[] = {"nearest", "bilinear", "directional", "catmull_rom",
                                      "lanczos", "gaussian", "smoothstep"};

/* An image enlarged to 100 / percent of its sides; `words` has the other settings. */
static struct neph_image *upscaled(struct neph_vulkan *vulkan, const char *filter, double percent,
                                   const char *words, const struct neph_image *image, float *rgb[3])
{
    char text[200];
    snprintf(text, sizeof(text), "upscale=%s screen_percent=%.17g %s", filter, percent, words);
    return post_made(vulkan, text, image, rgb);
}

static void fill(float *rgb[3], int count, uint64_t seed)
{
    for (int i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            rgb[c][i] = (float)neph_test_uniform(&seed, 0.0, 1.0);
}

/* ---- kernels --------------------------------------------------------------------------------- */

static double lanczos3(double x)
{
    const double a = M_PI * x, b = M_PI * x / 3.0;
    return x == 0.0 ? 1.0 : fabs(x) < 3.0 ? sin(a) / a * sin(b) / b : 0.0;
}

/* R. Keys, 1981, with a = -1/2. */
static double catmull_rom(double x)
{
    x = fabs(x);
    return x < 1.0   ? (1.5 * x - 2.5) * x * x + 1.0
           : x < 2.0 ? ((-0.5 * x + 2.5) * x - 4.0) * x + 2.0
                     : 0.0;
}

static double triangle(double x)
{
    return fmax(1.0 - fabs(x), 0.0);
}

static double smoothstep(double x)
{
    const double t = triangle(x);
    return t * t * (3.0 - 2.0 * t);
}

/* A bright column in a black image, enlarged: along x it shows the kernel, at places 1/8, 3/8, ...
 * from the centre, over the sum of weights there. It is constant along y, where rows between
 * centres or omitted corners would mix in; so the test reads rows at which all y weights are one
 * texel's. */
static void test_kernels_are_theirs(void **state)
{
    static const struct {
        const char *filter;
        double (*kernel)(double);
    } cases[] = {{"bilinear", triangle},
                 {"smoothstep", smoothstep},
                 {"catmull_rom", catmull_rom},
                 {"lanczos", lanczos3}};
    neph_assert_close(catmull_rom(0.5), 0.5625, 0.0, 0.0);
    neph_assert_close(catmull_rom(1.5), -0.0625, 0.0, 0.0);
    enum { side = 13, bright = 6 };
    float *in[3], *out[3];
    OWNED(image) struct neph_image *image = post_image(side, side, in);
    for (int i = 0; i < side * side; i++)
        for (int c = 0; c < 3; c++)
            in[c][i] = i % side == bright ? 1.25f : 0.25f; /* keeps undershoots above 0 */
    for (size_t k = 0; k < COUNT(cases); k++) {
        /* 3 times: in y the middle pixel of three is at a texel's centre. */
        OWNED(image)
        struct neph_image *made = upscaled(*state, cases[k].filter, 100.0 / 3.0, "", image, out);
        assert_int_equal(made->width_px, 3 * side);
        const int row = 3 * bright + 1;
        for (int x = 0; x < 3 * side; x++) {
            const double place = (x + 0.5) / 3.0 - 0.5; /* in texels, centres at integers */
            double sum = 0.0;
            for (int texel = -6; texel < side + 6; texel++)
                sum += cases[k].kernel(place - texel);
            const double expected = 0.25 + cases[k].kernel(place - bright) / sum;
            neph_assert_close(out[1][row * 3 * side + x], expected, 0.0,
                              2e-6); /* some 20 roundings */
        }
    }
}

/* Weights exp(-d^2) of texels at distances d up to 3 texels from the nearest corner, minus softness
 * (1 - 1/9) times the Laplacian; as plain sums in double. */
static void test_the_gaussian_is_its_formula(void **state)
{
    enum { side = 11 };
    float *in[3], *out[3];
    OWNED(image) struct neph_image *image = post_image(side, side, in);
    fill(in, side * side, 3);
    OWNED(image)
    struct neph_image *made = upscaled(*state, "gaussian", 100.0 / 3.0, "upscale_softness=0.7",
                                       image, out);
    for (int y = 9; y < 24; y++)
        for (int x = 9; x < 24; x++) {
            const double px = (x + 0.5) / 3.0, py = (y + 0.5) / 3.0;
            double sum = 0.0, total = 0.0, laplacian = 0.0;
            for (int j = 0; j < 6; j++)
                for (int i = 0; i < 6; i++) {
                    const double tx = floor(px) + i - 2.0, ty = floor(py) + j - 2.0; /* corners */
                    if ((i - 2.5) * (i - 2.5) + (j - 2.5) * (j - 2.5) > 9.0)
                        continue;
                    /* Samples are at corners, so each is the mean of four texels. */
                    double value = 0.0;
                    for (int k = 0; k < 4; k++)
                        value += 0.25 * in[0][((int)ty - 1 + k / 2) * side + (int)tx - 1 + k % 2];
                    const double d = 2.0 * ((px - tx) * (px - tx) + (py - ty) * (py - ty));
                    sum += exp(-0.5 * d) * value;
                    total += exp(-0.5 * d);
                    laplacian += exp(-0.5 * d) * (d - 2.0) * value;
                }
            const double expected = (sum - 0.7 * (1.0 - 1.0 / 9.0) * laplacian) / total;
            neph_assert_close(out[0][y * 3 * side + x], fmax(expected, 0.0), 0.0, 1e-5);
        }
}

/* ---- common properties ----------------------------------------------------------------------- */

static void test_a_constant_image_stays_constant(void **state)
{
    static const double percents[] = {12.5, 37.0, 50.0, 100.0 / 1.5, 77.0, 100.0};
    float *in[3], *out[3];
    OWNED(image) struct neph_image *image = post_image(19, 7, in);
    for (int i = 0; i < 19 * 7; i++)
        in[0][i] = in[1][i] = 0.7f, in[2][i] = 1e4f;
    for (size_t f = 0; f < COUNT(filters); f++)
        for (size_t p = 0; p < COUNT(percents); p++) {
            /* the gaussian's Laplacian does not sum to 0 */
            OWNED(image)
            struct neph_image *made = upscaled(*state, filters[f], percents[p],
                                               "upscale_softness=0", image, out);
            for (size_t i = 0; i < neph_image_pixel_count(made); i++) {
                neph_assert_close(out[0][i], 0.7, 3e-6,
                                  0.0); /* weights of up to 13 samples sum to 1 */
                neph_assert_close(out[2][i], 1e4, 3e-6, 0.0);
            }
        }
}

static void test_a_mirror_changes_nothing(void **state)
{
    enum { width = 23, height = 15 }; /* to 61 x 40: no place is on the border of two texels */
    float *in[3], *mirrored[3], *out[3], *out_mirrored[3];
    OWNED(image) struct neph_image *image = post_image(width, height, in);
    OWNED(image) struct neph_image *mirror = post_image(width, height, mirrored);
    fill(in, width * height, 11);
    for (int i = 0; i < width * height; i++)
        for (int c = 0; c < 3; c++)
            mirrored[c][width * height - 1 - i] = in[c][i]; /* both axes */
    for (size_t f = 0; f < COUNT(filters); f++) {
        OWNED(image) struct neph_image *made = upscaled(*state, filters[f], 37.5, "", image, out);
        OWNED(image)
        struct neph_image *other = upscaled(*state, filters[f], 37.5, "", mirror, out_mirrored);
        const size_t count = neph_image_pixel_count(made);
        for (size_t i = 0; i < count; i++) /* sums in another order */
            neph_assert_close(out[1][i], out_mirrored[1][count - 1 - i], 0.0, 1e-5);
    }
}

/* The article's fault: weights of 0 / 0 at texel centres. */
static void test_without_its_guard_lanczos_has_no_number_at_centres(void **state)
{
    float *in[3], *out[3];
    OWNED(image) struct neph_image *image = post_image(9, 9, in);
    fill(in, 81, 8);
    for (int guarded = 0; guarded < 2; guarded++) {
        OWNED(image)
        struct neph_image *made = upscaled(*state, "lanczos", 100.0 / 3.0,
                                           guarded ? "lanczos_guard=on" : "lanczos_guard=off",
                                           image, out);
        int bad = 0;
        for (int i = 0; i < 27 * 27; i++)
            bad += !isfinite(out[0][i]);
        assert_true(guarded ? bad == 0 : bad > 0);
    }
}

static void test_too_distant_scenes_are_refused(void **state)
{
    float *in[3];
    struct neph_image *image = post_image(4096, 1, in), *made = NULL;
    const struct neph_post_params params = {
        .settings = post_settings("upscale=bilinear screen_percent=12.5")};
    struct neph_diag diag = {0};
    assert_int_equal(neph_post_run(*state, &params, image, &made, NULL, &diag), NEPH_ERR_INPUT);
    assert_non_null(strstr(diag.message, "16384")); /* the largest side */
    assert_null(made);
    neph_image_destroy(image);
}

#include "tests/renderer/main.h"
