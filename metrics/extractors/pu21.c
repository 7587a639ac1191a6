/* SPDX-License-Identifier: MIT
 *
 * Peak signal-to-noise ratio on PU21 codes of absolute luminance.
 */
#include "metrics/extractors/extractors.h"
#include "metrics/extractors/pair_codes.h"
#include "metrics/vector_math.h"

#include <math.h>
#include <stddef.h>

struct state {
    const struct neph_code_planes *codes;
    size_t width_px;
};

static enum neph_status init(void *opaque, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag)
{
    (void)settings;
    (void)diag;
    struct state *state = opaque;
    state->width_px = (size_t)first->width_px;
    return NEPH_OK;
}

static enum neph_status extract(void *opaque, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    struct state *state = opaque;
    return neph_pair_codes_of(pair, NEPH_CODE_PU21, &state->codes, diag);
}

NEPH_VECTOR static void squares_of(const double *restrict reference, const double *restrict test,
                                   size_t count, double *restrict squares)
{
    for (size_t i = 0; i < count; i++)
        squares[i] = (test[i] - reference[i]) * (test[i] - reference[i]);
}

static void rows(const void *opaque, int map, int first_row, int row_count, double *const values[3])
{
    (void)map;
    const struct state *state = opaque;
    const size_t first = (size_t)first_row * state->width_px;
    squares_of(state->codes->reference + first, state->codes->test + first,
               (size_t)row_count * state->width_px, values[0]);
}

static enum neph_display_bound bound(const struct neph_settings *settings)
{
    (void)settings;
    return NEPH_BOUND_PU21;
}

static const struct neph_option options[] = {{.name = NULL}};

static const struct neph_metric metrics[] = {
    {"pu_psnr", "dB", -INFINITY, INFINITY, NEPH_POOL_PSNR, 256.0, 0, 0,
     "10 log10(256^2 / mean d^2), d the difference of PU21 codes of luminance in cd/m2"},
    {.name = NULL},
};

static const struct neph_map maps[] = {
    {.name = NULL, .unit = "code^2", .plane_count = 1, .is_signed = false, .scale = 0.0},
};

const struct neph_extractor neph_extractor_pu21 = {
    .name = "pu21",
    .help = "signal-to-noise ratio on a display of known brightness: cd/m2 = white * 2^exposure * "
            "luminance",
    .source = "Mantiuk and Azimi, PU21, Picture Coding Symposium 2021; parameters banding_glare of "
              "gfxdisp/pu21",
    .quantities = NEPH_RADIANCE | NEPH_VOLUME,
    .pointwise = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = 1,
    .state_size = sizeof(struct state),
    .bound = bound,
    .init = init,
    .extract = extract,
    .rows = rows,
};
