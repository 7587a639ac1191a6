/* SPDX-License-Identifier: MIT
 *
 * FXAA, EASU, CAS and RCAS: the shaders compared with the algorithms in double precision.
 * (docs/post.md compares the shaders with the original code.)
 */
#include "tests/renderer/post_test.h"

enum { width = 67, height = 43, count = width * height };

struct picture {
    int width, height;
    double (*rgb)[3];
};

static int clamped(int x, int size)
{
    return x < 0 ? 0 : x < size ? x : size - 1;
}

static const double *texel(const struct picture *p, int x, int y)
{
    return p->rgb[clamped(y, p->height) * p->width + clamped(x, p->width)];
}

/* Texel centres are at integers + 1/2. */
static void bilinear(const struct picture *p, double x, double y, double made[3])
{
    const double left = floor(x - 0.5), top = floor(y - 0.5), u = x - 0.5 - left, v = y - 0.5 - top;
    for (int c = 0; c < 3; c++)
        made[c] = (1.0 - v) * ((1.0 - u) * texel(p, (int)left, (int)top)[c] +
                               u * texel(p, (int)left + 1, (int)top)[c]) +
                  v * ((1.0 - u) * texel(p, (int)left, (int)top + 1)[c] +
                       u * texel(p, (int)left + 1, (int)top + 1)[c]);
}

static double luma(const double c[3])
{
    return 0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2];
}

static double luma_at(const struct picture *p, double x, double y)
{
    double c[3];
    bilinear(p, x, y, c);
    return luma(c);
}

/* ---- FXAA 3.11, quality ---------------------------------------------------------------------- */

static const double steps_12[] = {1, 1.5, 2, 4, 12},
                    steps_29[] = {1, 1.5, 2, 2, 2, 2, 2, 2, 2, 2, 4, 8},
                    steps_39[] = {1, 1, 1, 1, 1, 1.5, 2, 2, 2, 2, 4, 8};

/* The last step has no sample; the sample before it decides. */
static double walk(const struct picture *p, const double *steps, int step_count, double x, double y,
                   double dx, double dy, double mean, double contrast, double *beyond)
{
    double way = 0.0;
    for (int i = 0; i < step_count; i++) {
        way += steps[i];
        if (i + 1 == step_count)
            break;
        *beyond = luma_at(p, x + way * dx, y + way * dy) - mean;
        if (fabs(*beyond) >= contrast / 4.0)
            break;
    }
    return way;
}

/* Returns whether the edge's direction is certain: at a corner luma changes equally along x and y,
 * and rounding decides. */
static bool fxaa(const struct picture *p, const double *steps, int step_count, int x, int y,
                 double made[3])
{
    double l[3][3], most = -1.0, least = 2.0;
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++) {
            l[j][i] = luma(texel(p, x + i - 1, y + j - 1));
            if (i == 1 || j == 1) {
                most = fmax(most, l[j][i]);
                least = fmin(least, l[j][i]);
            }
        }
    const double m = l[1][1], range = most - least;
    memcpy(made, texel(p, x, y), 3 * sizeof(*made));
    if (range < fmax(0.0833, 0.166 * most))
        return true;
    double rows = 0.0, columns = 0.0; /* second differences of luma along y and along x */
    for (int i = 0; i < 3; i++) {
        rows += (i == 1 ? 2.0 : 1.0) * fabs(l[0][i] + l[2][i] - 2.0 * l[1][i]);
        columns += (i == 1 ? 2.0 : 1.0) * fabs(l[i][0] + l[i][2] - 2.0 * l[i][1]);
    }
    const bool lies = rows >= columns;
    const double one = lies ? l[0][1] : l[1][0], other = lies ? l[2][1] : l[1][2];
    const bool is_one = fabs(one - m) >= fabs(other - m);
    const double side = is_one ? -1.0 : 1.0, mean = 0.5 * (m + (is_one ? one : other));
    const double contrast = fmax(fabs(one - m), fabs(other - m));
    const double bx = x + 0.5 + (lies ? 0.0 : 0.5 * side), by = y + 0.5 + (lies ? 0.5 * side : 0.0);
    double ends[2] = {0.0, 0.0}, ways[2];
    for (int k = 0; k < 2; k++)
        ways[k] = walk(p, steps, step_count, bx, by, lies ? 2.0 * k - 1.0 : 0.0,
                       lies ? 0.0 : 2.0 * k - 1.0, mean, contrast, &ends[k]);
    const int nearer = ways[0] < ways[1] ? 0 : 1;
    double across = (ends[nearer] < 0.0) != (m < mean) ? 0.5 - ways[nearer] / (ways[0] + ways[1])
                                                       : 0.0;
    const double around = (2.0 * (l[0][1] + l[1][0] + l[1][2] + l[2][1]) + l[0][0] + l[0][2] +
                           l[2][0] + l[2][2]) /
                          12.0;
    const double s = fmin(fabs(around - m) / range, 1.0), smooth = s * s * (3.0 - 2.0 * s);
    across = side * fmax(across, 0.75 * smooth * smooth);
    bilinear(p, x + 0.5 + (lies ? 0.0 : across), y + 0.5 + (lies ? across : 0.0), made);
    return fabs(rows - columns) > 1e-5;
}

/* ---- sharpening ------------------------------------------------------------------------------ */

static double amount_of_test = 0.3;

static void cas(const struct picture *p, int x, int y, double made[3])
{
    for (int c = 0; c < 3; c++) {
        double low[2] = {2.0, 2.0}, high[2] = {-1.0, -1.0}, plus = 0.0;
        for (int k = 0; k < 9; k++) {
            const double v = texel(p, x + k % 3 - 1, y + k / 3 - 1)[c];
            const bool in_plus = k % 2 == 1 || k == 4;
            for (int all = in_plus ? 0 : 1; all < 2; all++) {
                low[all] = fmin(low[all], v);
                high[all] = fmax(high[all], v);
            }
            plus += k % 2 == 1 ? v : 0.0;
        }
        const double l = low[0] + low[1], h = high[0] + high[1];
        const double room = h > 0.0 ? fmin(fmax(fmin(l, 2.0 - h) / h, 0.0), 1.0) : 0.0;
        const double w = -sqrt(room) / (8.0 - 3.0 * amount_of_test);
        made[c] = fmin(fmax((w * plus + texel(p, x, y)[c]) / (1.0 + 4.0 * w), 0.0), 1.0);
    }
}

static void rcas(const struct picture *p, int x, int y, double made[3])
{
    double lobe = -1.0, plus[3] = {0.0, 0.0, 0.0};
    for (int c = 0; c < 3; c++) {
        const double own = texel(p, x, y)[c];
        double low = 2.0, high = -1.0;
        for (int k = 1; k < 9; k += 2) {
            const double v = texel(p, x + k % 3 - 1, y + k / 3 - 1)[c];
            low = fmin(low, v);
            high = fmax(high, v);
            plus[c] += v;
        }
        /* (4 w low + own) / (1 + 4 w) reaches 0 at one w; with `high` it reaches 1 at another. */
        const double to_0 = -fmin(low, own) / (4.0 * high);
        const double to_1 = (1.0 - fmax(high, own)) / (4.0 * low - 4.0);
        lobe = fmax(lobe, fmax(to_0, to_1));
    }
    lobe = fmax(-3.0 / 16.0, fmin(lobe, 0.0)) * exp2(-2.0 * (1.0 - amount_of_test));
    for (int c = 0; c < 3; c++)
        made[c] = fmin(fmax((lobe * plus[c] + texel(p, x, y)[c]) / (1.0 + 4.0 * lobe), 0.0), 1.0);
}

/* ---- EASU ------------------------------------------------------------------------------------ */

static double luma_2(const struct picture *p, int x, int y)
{
    const double *c = texel(p, x, y);
    return 0.5 * (c[0] + c[2]) + c[1];
}

static double ramp(double before, double own, double after)
{
    const double steepest = fmax(fabs(after - own), fabs(own - before));
    const double straight = steepest > 0.0 ? fmin(fabs(after - before) / steepest, 1.0) : 0.0;
    return straight * straight;
}

static void easu(const struct picture *p, double x, double y, double made[3])
{
    const int left = (int)floor(x - 0.5), top = (int)floor(y - 0.5);
    const double u = x - 0.5 - left, v = y - 0.5 - top;
    double dx = 0.0, dy = 0.0, sharpness = 0.0, total = 0.0;
    for (int k = 0; k < 4; k++) {
        const int i = left + k % 2, j = top + k / 2;
        const double share = (k % 2 ? u : 1.0 - u) * (k / 2 ? v : 1.0 - v), own = luma_2(p, i, j);
        const double l = luma_2(p, i - 1, j), r = luma_2(p, i + 1, j), a = luma_2(p, i, j - 1),
                     b = luma_2(p, i, j + 1);
        dx += share * (r - l);
        dy += share * (b - a);
        sharpness += share * (ramp(l, own, r) + ramp(a, own, b));
    }
    const double length = hypot(dx, dy);
    dx = length * length < 1.0 / 32768.0 ? 1.0 : dx / length;
    dy = length * length < 1.0 / 32768.0 ? 0.0 : dy / length;
    sharpness = sharpness * sharpness / 4.0;
    const double stretch = 1.0 + (1.0 / fmax(fabs(dx), fabs(dy)) - 1.0) * sharpness;
    const double squeeze = 1.0 - sharpness / 2.0, lobe = 0.5 - 0.29 * sharpness;
    double least[3] = {2.0, 2.0, 2.0}, most[3] = {-1.0, -1.0, -1.0};
    memset(made, 0, 3 * sizeof(*made));
    for (int j = -1; j < 3; j++)
        for (int i = -1; i < 3; i++) {
            const bool out_i = i < 0 || i > 1, out_j = j < 0 || j > 1;
            const double *c = texel(p, left + i, top + j);
            if (out_i && out_j)
                continue;
            const double ox = i - u, oy = j - v;
            const double along = stretch * (ox * dx + oy * dy);
            const double across = squeeze * (oy * dx - ox * dy);
            const double d = fmin(along * along + across * across, 1.0 / lobe);
            const double weight = (25.0 / 16.0 * pow(0.4 * d - 1.0, 2.0) - 9.0 / 16.0) *
                                  pow(lobe * d - 1.0, 2.0);
            total += weight;
            for (int k = 0; k < 3; k++) {
                made[k] += weight * c[k];
                least[k] = out_i || out_j ? least[k] : fmin(least[k], c[k]);
                most[k] = out_i || out_j ? most[k] : fmax(most[k], c[k]);
            }
        }
    for (int k = 0; k < 3; k++)
        made[k] = fmin(fmax(made[k] / total, least[k]), most[k]);
}

/* ---- against the shaders --------------------------------------------------------------------- */

/* Edges of all slopes, thin lines and a little noise, so that no comparison is a tie. */
static void draw(double rgb[count][3], uint64_t seed)
{
    for (int i = 0; i < count; i++) {
        const double x = i % width, y = i / width;
        double level = 0.31 * x + 0.95 * y > 28.0 + 6.0 * sin(0.2 * x) ? 0.7 : 0.15;
        level = hypot(x - 45.0, y - 18.0) < 11.3 ? 0.9 : level;
        level = (int)x % 13 == 4 && y < 14.0 ? 1.0 : level;
        level = fabs(2.9 * y - x - 3.0) < 1.6 ? 0.0 : level;
        for (int c = 0; c < 3; c++)
            rgb[i][c] = (float)fmin(
                fmax(level * (1.0 - 0.1 * c) + neph_test_uniform(&seed, -0.02, 0.02), 0.0), 1.0);
    }
}

static struct neph_image *run(struct neph_vulkan *vulkan, const char *text,
                              const struct picture *picture, float *out[3])
{
    float *in[3];
    OWNED(image) struct neph_image *image = post_image(picture->width, picture->height, in);
    for (int i = 0; i < picture->width * picture->height; i++)
        for (int c = 0; c < 3; c++)
            in[c][i] = (float)picture->rgb[i][c];
    return post_made(vulkan, text, image, out);
}

static void test_fxaa_is_its_algorithm(void **state)
{
    static const struct {
        const char *settings;
        const double *steps;
        int step_count;
    } cases[] = {{"fxaa=quality_12", steps_12, COUNT(steps_12)},
                 {"fxaa=quality_29", steps_29, COUNT(steps_29)},
                 {"fxaa=quality_39", steps_39, COUNT(steps_39)}};
    static double rgb[count][3];
    const struct picture picture = {width, height, rgb};
    draw(rgb, 31);
    for (size_t k = 0; k < COUNT(cases); k++) {
        float *out[3];
        OWNED(image) struct neph_image *made = run(*state, cases[k].settings, &picture, out);
        int changed = 0, apart = 0;
        for (int i = 0; i < count; i++) {
            double expected[3];
            if (!fxaa(&picture, cases[k].steps, cases[k].step_count, i % width, i / width,
                      expected))
                continue;
            changed += expected[0] != rgb[i][0];
            apart += fabs(out[0][i] - expected[0]) > 1e-5 || fabs(out[2][i] - expected[2]) > 1e-5;
        }
        assert_true(changed > count / 20);
        assert_int_equal(apart, 0);
    }
}

/* An edge of slope 1 in 8 is a staircase before, and closer to a straight edge after. */
static void test_fxaa_makes_an_edge_straighter(void **state)
{
    static const char *const settings[] = {"fxaa=console", "fxaa=quality_12", "fxaa=quality_39"};
    static double rgb[count][3];
    const struct picture picture = {width, height, rgb};
    double before = 0.0;
    for (int i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            rgb[i][c] = i / width + 0.5 > 12.0 + (i % width + 0.5) / 8.0 ? 0.8 : 0.2;
    for (size_t k = 0; k < COUNT(settings); k++) {
        double error = 0.0;
        float *out[3];
        OWNED(image) struct neph_image *made = run(*state, settings[k], &picture, out);
        before = 0.0;
        for (int y = 2; y < height - 2; y++)
            for (int x = 10; x < width - 10; x++) {
                /* Fraction of the pixel below the edge; linear across it, because the slope is 1 in
                 * 8. */
                const double edge = 12.0 + (x + 0.5) / 8.0;
                const double truth = 0.2 + 0.6 * fmin(fmax(y + 1.0 - edge, 0.0), 1.0);
                before += pow(rgb[y * width + x][1] - truth, 2.0);
                error += pow(out[1][y * width + x] - truth, 2.0);
            }
        print_message("%s: %.2f of the squared error of the staircase\n", settings[k],
                      error / before);
        assert_true(error < 0.5 * before);
    }
}

static void test_sharpening_is_its_formula(void **state)
{
    static const struct {
        const char *settings;
        void (*formula)(const struct picture *, int, int, double[3]);
    } cases[] = {{"sharpen=cas sharpen_amount=0.3", cas},
                 {"sharpen=rcas sharpen_amount=0.3", rcas}};
    static double rgb[count][3];
    const struct picture picture = {width, height, rgb};
    draw(rgb, 77);
    for (size_t k = 0; k < COUNT(cases); k++) {
        float *out[3];
        OWNED(image) struct neph_image *made = run(*state, cases[k].settings, &picture, out);
        for (int i = 0; i < count; i++) {
            double expected[3];
            cases[k].formula(&picture, i % width, i / width, expected);
            for (int c = 0; c < 3; c++) /* a root near 0 doubles the digits lost in 2 - h */
                neph_assert_close(out[c][i], expected[c], 0.0, 2e-5);
        }
    }
}

static void test_easu_is_its_algorithm(void **state)
{
    static double rgb[count][3];
    const struct picture picture = {width, height, rgb};
    float *out[3];
    draw(rgb, 5);
    OWNED(image)
    struct neph_image *made = run(*state, "upscale=easu screen_percent=59", &picture, out);
    for (int y = 0; y < made->height_px; y++)
        for (int x = 0; x < made->width_px; x++) {
            double expected[3];
            easu(&picture, (x + 0.5) * width / made->width_px, (y + 0.5) * height / made->height_px,
                 expected);
            for (int c = 0; c < 3; c++) /* decided by 1 / 32768 of direction, with errors of 1e-5 */
                neph_assert_close(out[c][y * made->width_px + x], expected[c], 0.0, 1e-4);
        }
}

static void test_a_constant_image_stays_constant(void **state)
{
    static const char *const settings[] = {"fxaa=console",
                                           "fxaa=quality_12",
                                           "fxaa=quality_39",
                                           "sharpen=cas",
                                           "sharpen=rcas sharpen_amount=1",
                                           "upscale=easu"};
    static const double levels[] = {0.0, 1e-7, 0.3, 1.0};
    static double rgb[count][3];
    const struct picture picture = {width, height, rgb};
    for (size_t l = 0; l < COUNT(levels); l++) {
        for (int i = 0; i < count; i++)
            rgb[i][0] = rgb[i][1] = rgb[i][2] = levels[l];
        for (size_t k = 0; k < COUNT(settings); k++) {
            float *out[3];
            OWNED(image) struct neph_image *made = run(*state, settings[k], &picture, out);
            for (size_t i = 0; i < neph_image_pixel_count(made); i++)
                neph_assert_close(out[1][i], levels[l], 1e-6, 0.0);
        }
    }
}

#include "tests/renderer/main.h"
