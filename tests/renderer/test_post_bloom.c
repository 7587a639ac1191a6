/* SPDX-License-Identifier: MIT
 *
 * Bloom: the shaders compared with matrices in double precision; the sum of the light is kept, and
 * a constant image stays constant.
 */
#include "tests/renderer/post_test.h"

enum { side_max = 80, levels_max = POST_LEVELS_MAX };

/* One axis of the pyramid: the matrix from a level up to the finer one, and the matrix from the
 * image down to a level. */
struct axis {
    int sizes[levels_max + 1];
    double up[levels_max + 1][side_max][side_max];   /* [level][fine][coarse] */
    double down[levels_max + 1][side_max][side_max]; /* [level][coarse][fine] */
};

/* Linear interpolation between centres, constant beyond the ends. */
static void interpolate(struct axis *axis, int level)
{
    const int fine = axis->sizes[level - 1], coarse = axis->sizes[level];
    for (int f = 0; f < fine; f++) {
        const double place = (f + 0.5) / 2.0 - 0.5;
        for (int k = 0; k < 2; k++) {
            const int c = (int)floor(place) + k, held = c < 0 ? 0 : c < coarse ? c : coarse - 1;
            axis->up[level][f][held] += k ? place - floor(place) : 1.0 - (place - floor(place));
        }
    }
}

/* The transpose, weighted with the pixels that fine texels represent, with rows that sum to 1. */
static void build(struct axis *axis, int size)
{
    double mass[side_max], next[side_max];
    memset(axis, 0, sizeof(*axis));
    axis->sizes[0] = size;
    for (int i = 0; i < size; i++)
        mass[i] = 1.0;
    for (int level = 1; level <= levels_max; level++) {
        axis->sizes[level] = (axis->sizes[level - 1] + 1) / 2;
        interpolate(axis, level);
        for (int c = 0; c < axis->sizes[level]; c++) {
            next[c] = 0.0;
            for (int f = 0; f < axis->sizes[level - 1]; f++)
                next[c] += axis->up[level][f][c] * mass[f];
            for (int f = 0; f < axis->sizes[level - 1]; f++)
                axis->down[level][c][f] = axis->up[level][f][c] * mass[f] / next[c];
        }
        memcpy(mass, next, sizeof(mass));
    }
}

struct plane {
    int width, height;
    double at[side_max][side_max]; /* [y][x] */
};

static void apply(double (*across)[side_max], double (*along)[side_max], int width, int height,
                  const struct plane *from, struct plane *to)
{
    static double half[side_max][side_max];
    for (int y = 0; y < from->height; y++)
        for (int x = 0; x < width; x++) {
            half[y][x] = 0.0;
            for (int k = 0; k < from->width; k++)
                half[y][x] += across[x][k] * from->at[y][k];
        }
    to->width = width;
    to->height = height;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            to->at[y][x] = 0.0;
            for (int k = 0; k < from->height; k++)
                to->at[y][x] += along[y][k] * half[k][x];
        }
}

/* The bloom of a plane: levels mixed from the coarsest up. */
static void spread(const struct plane *plane, int levels, double part, struct plane *made)
{
    static struct axis across, along;
    static struct plane pyramid[levels_max + 1], up;
    build(&across, plane->width);
    build(&along, plane->height);
    pyramid[0] = *plane;
    for (int l = 1; l <= levels; l++)
        apply(across.down[l], along.down[l], across.sizes[l], along.sizes[l], &pyramid[l - 1],
              &pyramid[l]);
    for (int l = levels; l > 0; l--) {
        apply(across.up[l], along.up[l], across.sizes[l - 1], along.sizes[l - 1], &pyramid[l], &up);
        for (int y = 0; y < up.height && l > 1; y++)
            for (int x = 0; x < up.width; x++)
                pyramid[l - 1].at[y][x] += part * (up.at[y][x] - pyramid[l - 1].at[y][x]);
    }
    *made = up;
}

/* ---- against the shaders --------------------------------------------------------------------- */

static struct neph_image *drawn(int width, int height, uint64_t seed, float *rgb[3])
{
    struct neph_image *image = post_image(width, height, rgb);
    for (int i = 0; i < width * height; i++)
        for (int c = 0; c < 3; c++)
            rgb[c][i] = (float)exp2(neph_test_uniform(&seed, -8.0, 4.0)) *
                        (i % 97 == 5 ? 100.0f : 1.0f);
    return image;
}

static double luminance_at(float *const rgb[3], int i)
{
    return 0.2126 * rgb[0][i] + 0.7152 * rgb[1][i] + 0.0722 * rgb[2][i];
}

/* Sums of up to 16 products per level. */
static const double shader_tolerance = 3e-6;

static void test_the_shaders_are_their_matrices(void **state)
{
    static const struct {
        const char *settings;
        int width, height, levels;
        double spread, scattered, intensity, threshold;
    } cases[] = {{"bloom=conserving", 64, 32, 6, 0.7, 0.05, 0.0, -1.0},
                 {"bloom=conserving bloom_scattered=0.4 bloom_spread=0.5 bloom_levels=3", 67, 43, 3,
                  0.5, 0.4, 0.0, -1.0},
                 {"bloom=conserving bloom_levels=8 bloom_scattered=1 bloom_spread=1", 5, 77, 7, 1.0,
                  1.0, 0.0, -1.0},
                 {"bloom=additive", 51, 22, 6, 0.7, 0.0, 0.675, -1.0},
                 {"bloom=additive bloom_threshold=1.5 bloom_intensity=2 exposure_ev=1", 33, 49, 6,
                  0.7, 0.0, 2.0, 1.5}};
    static struct plane plane, bloom;
    for (size_t k = 0; k < COUNT(cases); k++) {
        const int width = cases[k].width, height = cases[k].height;
        float *in[3], *out[3];
        OWNED(image) struct neph_image *image = drawn(width, height, 3 + k, in);
        OWNED(image) struct neph_image *made = post_made(*state, cases[k].settings, image, out);
        for (int c = 0; c < 3; c++) {
            plane = (struct plane){.width = width, .height = height};
            for (int i = 0; i < width * height; i++) {
                const double above = 2.0 * luminance_at(in, i) - cases[k].threshold;
                const double part = cases[k].threshold > -1.0 ? fmin(fmax(0.5 * above, 0.0), 1.0)
                                                              : 1.0;
                plane.at[i / width][i % width] = part * in[c][i];
            }
            spread(&plane, cases[k].levels, cases[k].spread, &bloom);
            for (int i = 0; i < width * height; i++) {
                const double glow = bloom.at[i / width][i % width];
                const double expected = (1.0 - cases[k].scattered) * in[c][i] +
                                        (cases[k].scattered + cases[k].intensity) * glow;
                neph_assert_close(out[c][i], expected, shader_tolerance, 0.0);
            }
        }
    }
}

static double sum_samples(const float *samples, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        sum += samples[i];
    return sum;
}

/* Odd and even sizes, thin ones, down to one pixel; a sun in a corner of a black image. */
static void test_no_light_is_won_or_lost(void **state)
{
    static const int sizes[][2] = {{64, 32}, {67, 43}, {1, 1}, {1, 9}, {300, 2}, {79, 80}};
    for (size_t k = 0; k < COUNT(sizes); k++) {
        const int count = sizes[k][0] * sizes[k][1];
        float *in[3], *out[3];
        OWNED(image) struct neph_image *image = post_image(sizes[k][0], sizes[k][1], in);
        in[0][0] = in[1][count / 3] = 1000.0f;
        for (int i = 0; i < count; i++)
            in[2][i] = (float)(i % 7);
        struct neph_image *made = post_made(
            *state, "bloom=conserving bloom_scattered=0.8 bloom_levels=8", image, out);
        for (int c = 0; c < 3; c++)
            neph_assert_close(sum_samples(out[c], count), sum_samples(in[c], count), 1e-6, 0.0);
        neph_image_destroy(made);
        /* Additive bloom adds the spread light. */
        made = post_made(*state, "bloom=additive bloom_intensity=0.5", image, out);
        for (int c = 0; c < 3; c++)
            neph_assert_close(sum_samples(out[c], count), 1.5 * sum_samples(in[c], count), 1e-6,
                              0.0);
        neph_image_destroy(made);
    }
}

static void test_a_constant_image_stays_constant(void **state)
{
    float *in[3], *out[3];
    OWNED(image) struct neph_image *image = post_image(61, 37, in);
    for (int i = 0; i < 61 * 37; i++)
        in[0][i] = in[1][i] = 0.3f, in[2][i] = 5e4f;
    OWNED(image)
    struct neph_image *made = post_made(*state, "bloom=conserving bloom_scattered=1", image, out);
    for (int i = 0; i < 61 * 37; i++) {
        neph_assert_close(out[1][i], 0.3f, shader_tolerance, 0.0);
        neph_assert_close(out[2][i], 5e4f, shader_tolerance, 0.0);
    }
}

/* With automatic exposure the threshold applies to exposed light: grey 0.18 is below 0.5 for every
 * luminance of the frame. */
static void test_the_threshold_is_of_exposed_light(void **state)
{
    for (int bright = 0; bright < 2; bright++) {
        float *in[3], *out[3];
        OWNED(image) struct neph_image *image = post_image(16, 16, in);
        for (int c = 0; c < 3; c++)
            for (int i = 0; i < 256; i++)
                in[c][i] = bright ? 40.0f : 0.02f;
        struct neph_image *made = post_made(
            *state, "auto_exposure=on bloom=additive bloom_threshold=0.5 bloom_intensity=1", image,
            out);
        assert_true(out[0][99] == in[0][99]);
        neph_image_destroy(made);
        made = post_made(*state,
                         "auto_exposure=on bloom=additive bloom_threshold=0.1 bloom_intensity=1",
                         image, out);
        neph_assert_close(out[0][99], in[0][99] * (1.0 + 0.5 * 0.08), 1e-5, 0.0);
        neph_image_destroy(made);
    }
}

#include "tests/renderer/main.h"
