/* SPDX-License-Identifier: MIT
 *
 * SSIM as papers and other programs compute it, of code values that are not rounded to 8 bits. The
 * frames are encoded in sRGB, clamped to 0..1 after --exposure; the data range L is 1, K1 = 0.01
 * and K2 = 0.03; only windows inside the image count, and nothing is decimated.
 *   srgb_ssim       Wang et al., IEEE TIP 13, 2004: 11x11 Gaussian, sigma 1.5, population
 *                   covariance; mean of R, G and B, as tf.image.ssim and scikit-image with
 *                   gaussian_weights=True, sigma=1.5, use_sample_covariance=False, channel_axis=-1
 *   srgb_ssim_luma  the same of the luma 0.299 R' + 0.587 G' + 0.114 B' (ITU-R BT.601), as Wang's
 *                   program and MATLAB on rgb2gray; MATLAB also counts windows beyond the border
 *   srgb_ssim_7x7   scikit-image's default: uniform 7x7, sample covariance; mean of R, G and B
 */
#include "metrics/extractors/display_luma.h"
#include "metrics/extractors/extractors.h"
#include "metrics/extractors/structure.h"

#include <math.h>
#include <stddef.h>

enum map { RGB, LUMA, UNIFORM, MAP_COUNT };

enum {
    CHANNELS = 3,
    /* Further pixels of the planes on each side: the margin of structure.h becomes that of 7x7. */
    PAD_PX = NEPH_STRUCTURE_MARGIN_PX - 3
};

/* The images that a map is the mean of: sums of channels by these weights. */
static const struct variant {
    enum neph_structure_window window;
    int image_count, margin_px;
    double weights[CHANNELS][CHANNELS];
} variants[MAP_COUNT] = {
    [RGB] = {NEPH_STRUCTURE_GAUSSIAN, 3, 5, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
    [LUMA] = {NEPH_STRUCTURE_GAUSSIAN, 1, 5, {{0.299, 0.587, 0.114}}},
    [UNIFORM] = {NEPH_STRUCTURE_UNIFORM_7, 3, 3, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
};

static const char no_window[] = "no window has its middle in the mask";

static const struct neph_map maps[MAP_COUNT] = {
    [RGB] = {"srgb_ssim", "1", 1, false, 1.0, no_window},
    [LUMA] = {"srgb_ssim_luma", "1", 1, false, 1.0, no_window},
    [UNIFORM] = {"srgb_ssim_7x7", "1", 1, false, 1.0, no_window},
};

static const struct neph_metric metrics[] = {
    {"srgb_ssim", "1", -1, 1, NEPH_POOL_MEAN, 0, RGB, 0,
     "SSIM of Wang et al. (11x11 Gaussian, sigma 1.5), mean of R, G and B in sRGB, range 0..1"},
    {"srgb_ssim_luma", "1", -1, 1, NEPH_POOL_MEAN, 0, LUMA, 0,
     "the same of the luma of BT.601 in sRGB, range 0..1, as rgb2gray gives it"},
    {"srgb_ssim_7x7", "1", -1, 1, NEPH_POOL_MEAN, 0, UNIFORM, 0,
     "scikit-image's default: uniform 7x7, sample covariance, mean of R, G and B in sRGB"},
    {.name = NULL},
};

struct state {
    int width_px, height_px;
    size_t padded_px; /* width of the planes */
    double *reference, *test, *product;
    double *maps[MAP_COUNT];
};

static const char *obstacle(const struct neph_frame_pair *first,
                            const struct neph_settings *settings)
{
    (void)settings;
    return first->width_px < NEPH_STRUCTURE_WINDOW_PX || first->height_px < NEPH_STRUCTURE_WINDOW_PX
               ? "the window of 11x11 px does not fit into the image"
               : NULL;
}

static enum neph_status init(void *opaque, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag)
{
    (void)settings;
    struct state *state = opaque;
    const size_t width = (size_t)first->width_px, height = (size_t)first->height_px;
    const size_t count = (width + 2 * PAD_PX) * (height + 2 * PAD_PX);
    *state = (struct state){.width_px = first->width_px,
                            .height_px = first->height_px,
                            .padded_px = width + 2 * PAD_PX};
    double **const planes[] = {&state->reference, &state->test, &state->product};
    for (int p = 0; p < 3; p++)
        *planes[p] = neph_arena_allocate(first->memory, count, sizeof(double));
    for (int m = 0; m < MAP_COUNT; m++)
        state->maps[m] = neph_arena_allocate(first->memory, width * height, sizeof(double));
    return neph_arena_check(first->memory, diag);
}

/* The weighted sum of encoded channels; the padding stays 0. */
static void encode(const struct state *state, const float *const planes[3], double gain,
                   const double weights[CHANNELS], double *restrict out)
{
    enum { PIECE_PX = 256 };
    double codes[PIECE_PX];
    const size_t width = (size_t)state->width_px;
    for (size_t y = 0; y < (size_t)state->height_px; y++) {
        double *row = out + (y + PAD_PX) * state->padded_px + PAD_PX;
        for (size_t x = 0; x < width; x++)
            row[x] = 0.0;
        for (int c = 0; c < CHANNELS; c++)
            for (size_t done = 0; done < width && weights[c] != 0.0; done += PIECE_PX) {
                const size_t piece = width - done < PIECE_PX ? width - done : PIECE_PX;
                neph_display_codes(planes[c] + y * width + done, piece, gain, codes);
                for (size_t i = 0; i < piece; i++)
                    row[done + i] += weights[c] * codes[i];
            }
    }
}

/* Add the SSIM of an image to a map. */
static void add(const struct state *state, const struct variant *variant, bool is_first,
                double *restrict map)
{
    const size_t width = (size_t)state->width_px;
    const double share = 1.0 / variant->image_count;
    for (size_t y = 0; y < (size_t)state->height_px; y++) {
        const double *from = state->product + (y + PAD_PX) * state->padded_px + PAD_PX;
        double *to = map + y * width;
        for (size_t x = 0; x < width; x++)
            to[x] = (is_first ? 0.0 : to[x]) + share * from[x];
    }
}

static enum neph_status extract(void *opaque, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    struct state *state = opaque;
    const double gain = exp2(pair->viewing->exposure_ev);
    enum neph_status status = NEPH_OK;
    for (int m = 0; m < MAP_COUNT; m++)
        for (int i = 0; i < variants[m].image_count && !status; i++) {
            struct neph_structure means;
            encode(state, pair->reference, gain, variants[m].weights[i], state->reference);
            encode(state, pair->test, gain, variants[m].weights[i], state->test);
            status = neph_structure_compare(state->reference, state->test, variants[m].window,
                                            (int)state->padded_px, state->height_px + 2 * PAD_PX,
                                            1.0, state->product, &means, diag);
            if (!status)
                add(state, &variants[m], i == 0, state->maps[m]);
        }
    return status;
}

static void rows(const void *opaque, int map, int first_row, int row_count, double *const values[3])
{
    const struct state *state = opaque;
    const int width = state->width_px, margin = variants[map].margin_px;
    for (int i = 0; i < row_count; i++) {
        const int y = first_row + i;
        const bool is_inside = y >= margin && y < state->height_px - margin;
        for (int x = 0; x < width; x++) {
            const size_t at = (size_t)i * (size_t)width + (size_t)x;
            values[0][at] = is_inside && x >= margin && x < width - margin
                                ? state->maps[map][(size_t)y * (size_t)width + (size_t)x]
                                : (double)NAN;
        }
    }
}

static const struct neph_option options[] = {{.name = NULL}};

const struct neph_extractor neph_extractor_published_ssim = {
    .name = "published_ssim",
    .help = "SSIM of sRGB values as papers and scikit-image compute it",
    .source = "Wang et al., IEEE TIP 13, 2004; scikit-image 0.25, structural_similarity()",
    .quantities = NEPH_RADIANCE | NEPH_VOLUME,
    .costly = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = MAP_COUNT,
    .state_size = sizeof(struct state),
    .obstacle = obstacle,
    .bound = neph_bound_is_white,
    .init = init,
    .extract = extract,
    .rows = rows,
};
