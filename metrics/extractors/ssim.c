/* SPDX-License-Identifier: MIT
 *
 * SSIM and MS-SSIM as one extractor, because the first scale of MS-SSIM contains all of SSIM.
 */
#include "metrics/extractors/extractors.h"
#include "metrics/extractors/ms_ssim.h"
#include "metrics/extractors/pair_codes.h"
#include "metrics/extractors/structure.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* A new kind breaks the build here until this file handles it. */
_Static_assert(NEPH_CODE_COUNT == 2, "a new kind");

enum { OPTION_CODE, OPTION_DECIMATE };

static const char *const code_names[] = {
    [NEPH_CODE_PU21] = "pu21", [NEPH_CODE_DISPLAY] = "display", NULL};

static const struct neph_option options[] = {
    [OPTION_CODE] = {.name = "code",
                     .kind = NEPH_OPTION_CHOICE,
                     .default_value = NEPH_CODE_PU21,
                     .choices = code_names,
                     .help = "code values: PU21 of cd/m2 (L = 256), or sRGB luma (L = 255)"},
    [OPTION_DECIMATE] = {.name = "decimate",
                         .kind = NEPH_OPTION_INTEGER,
                         .default_value = 0.0,
                         .minimum = 0.0,
                         .maximum = 1.0,
                         .help = "1: ssim on the image shrunk by round(shorter side / 256), as "
                                 "libvmaf does unasked"},
    {.name = NULL},
};

struct state {
    enum neph_code_kind code;
    double peak;
    int width_px, height_px;
    int factor; /* decimation factor of ssim */
    int small_width_px, small_height_px;
    double *small_reference, *small_test; /* decimated images, if the factor is not 1 */
    double *map;                          /* of the decimated size, NaN in the margin */
    double ms_ssim;
    const char *ms_ssim_undefined;
};

static enum neph_display_bound bound(const struct neph_settings *settings)
{
    return settings->values[OPTION_CODE] == NEPH_CODE_PU21 ? NEPH_BOUND_PU21 : NEPH_BOUND_WHITE;
}

/* libvmaf's factor, with halves rounded up. */
static int choose_decimation_factor(const struct neph_frame_pair *first,
                                    const struct neph_settings *settings)
{
    int shorter_px = first->width_px < first->height_px ? first->width_px : first->height_px;
    int factor = (shorter_px + 128) / 256;
    return settings->values[OPTION_DECIMATE] != 0.0 && factor > 1 ? factor : 1;
}

/* The decimated side as in libvmaf, with an extra pixel for an odd side. */
static int decimated_px(int side_px, int factor)
{
    return factor == 1 ? side_px : side_px / factor + (side_px & 1);
}

static const char *obstacle(const struct neph_frame_pair *first,
                            const struct neph_settings *settings)
{
    int factor = choose_decimation_factor(first, settings);
    return decimated_px(first->width_px, factor) < NEPH_STRUCTURE_WINDOW_PX ||
                   decimated_px(first->height_px, factor) < NEPH_STRUCTURE_WINDOW_PX
               ? "the window of 11x11 px does not fit into the image"
               : NULL;
}

static enum neph_status init(void *opaque, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag)
{
    struct state *state = opaque;
    state->code = (enum neph_code_kind)settings->values[OPTION_CODE];
    state->peak = neph_code_peak(state->code);
    state->width_px = first->width_px;
    state->height_px = first->height_px;
    state->factor = choose_decimation_factor(first, settings);
    state->small_width_px = decimated_px(first->width_px, state->factor);
    state->small_height_px = decimated_px(first->height_px, state->factor);
    const size_t count = (size_t)state->small_width_px * (size_t)state->small_height_px;
    state->map = neph_arena_allocate(first->memory, count, sizeof(double));
    if (state->factor > 1) {
        state->small_reference = neph_arena_allocate(first->memory, count, sizeof(double));
        state->small_test = neph_arena_allocate(first->memory, count, sizeof(double));
    }
    for (size_t i = 0; state->map && i < count; i++)
        state->map[i] = NAN;
    return neph_arena_check(first->memory, diag);
}

/* ---- a frame --------------------------------------------------------------------------------- */

/* Shrink with a box filter, as libvmaf does. */
static enum neph_status shrink(const struct state *state, const double *image, double *small,
                               struct neph_diag *diag)
{
    double box[64];
    for (int i = 0; i < state->factor; i++)
        box[i] = 1.0 / state->factor;
    return neph_decimate(image, state->width_px, state->height_px, box, state->factor,
                         state->factor, small, state->small_width_px, state->small_height_px, diag);
}

static enum neph_status compare_decimated(struct state *state, const struct neph_code_planes *codes,
                                          struct neph_diag *diag)
{
    struct neph_structure means;
    enum neph_status status = shrink(state, codes->reference, state->small_reference, diag);
    if (!status)
        status = shrink(state, codes->test, state->small_test, diag);
    if (!status)
        status = neph_structure_compare(
            state->small_reference, state->small_test, NEPH_STRUCTURE_GAUSSIAN,
            state->small_width_px, state->small_height_px, state->peak, state->map, &means, diag);
    return status;
}

static enum neph_status extract(void *opaque, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    struct state *state = opaque;
    struct neph_structure means;
    const struct neph_code_planes *codes = NULL;
    enum neph_status status = neph_pair_codes_get(pair, state->code, &codes, diag);
    if (!status)
        status = neph_structure_compare(codes->reference, codes->test, NEPH_STRUCTURE_GAUSSIAN,
                                        state->width_px, state->height_px, state->peak,
                                        state->factor == 1 ? state->map : NULL, &means, diag);
    if (!status && state->factor > 1)
        status = compare_decimated(state, codes, diag);
    if (!status)
        status = neph_ms_ssim(codes->reference, codes->test, state->width_px, state->height_px,
                              state->peak, &means, &state->ms_ssim_undefined, &state->ms_ssim,
                              diag);
    return status;
}

/* A value of the decimated image is reported only at the pixel that it was sampled at, so the mean
 * over the image equals libvmaf's. */
static void rows(const void *opaque, int map, int first_row, int row_count, double *const values[3])
{
    (void)map;
    const struct state *state = opaque;
    int width = state->width_px, factor = state->factor;
    for (int y = 0; y < row_count; y++) {
        double *row = values[0] + (size_t)y * (size_t)width;
        int image_y = first_row + y, small_y = image_y / factor;
        const double *small = state->map + (size_t)small_y * (size_t)state->small_width_px;
        bool is_sampled = image_y % factor == 0 && small_y < state->small_height_px;
        if (factor == 1) {
            memcpy(row, small, (size_t)width * sizeof(*row));
            continue;
        }
        for (int x = 0; x < width; x++)
            row[x] = is_sampled && x % factor == 0 && x / factor < state->small_width_px
                         ? small[x / factor]
                         : NAN;
    }
}

static const char *scalar(const void *opaque, int which, double *value)
{
    (void)which;
    const struct state *state = opaque;
    if (!state->ms_ssim_undefined)
        *value = state->ms_ssim;
    return state->ms_ssim_undefined;
}

static const struct neph_metric metrics[] = {
    {"ssim_mean", "1", -1.0, 1.0, NEPH_POOL_MEAN, 0.0, 0, 0,
     "mean SSIM of code values, 11x11 Gaussian window, where the window lies inside"},
    {"ssim_p5", "1", -1.0, 1.0, NEPH_POOL_PERCENTILE, 0.05, 0, 0,
     "5th percentile of SSIM: one pixel in twenty is less similar"},
    {"ms_ssim", "1", 0.0, 1.0, NEPH_POOL_SCALAR, 0.0, 0, 0,
     "MS-SSIM of code values over five scales, of the whole image"},
    {.name = NULL},
};

static const struct neph_map maps[] = {
    {.name = "ssim",
     .unit = "1",
     .plane_count = 1,
     .scale = 1.0,
     .empty_because = "no window of 11x11 px has its middle in the mask"},
};

const struct neph_extractor neph_extractor_ssim = {
    .name = "ssim",
    .help = "structural similarity of code values; blind to small bright defects and to colour",
    .source = "Wang et al., IEEE TIP 13, 2004; Wang, Simoncelli and Bovik, Asilomar 2003; details "
              "as in libvmaf",
    .quantities = NEPH_RADIANCE | NEPH_VOLUME,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = 1,
    .state_size = sizeof(struct state),
    .obstacle = obstacle,
    .bound = bound,
    .init = init,
    .extract = extract,
    .rows = rows,
    .scalar = scalar,
};
