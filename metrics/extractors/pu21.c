/* SPDX-License-Identifier: MIT
 *
 * Peak signal-to-noise ratio on PU21 codes of absolute luminance.
 */
#include "metrics/extractors/code_value.h"
#include "metrics/extractors/extractors.h"

#include <math.h>
#include <stddef.h>

enum { CHUNK_PX = 256 };

struct state {
    struct neph_code *code; /* owned */
    struct neph_frame_pair pair;
};

static enum neph_status init(void *opaque, const struct neph_frame_pair *first,
                             const struct neph_settings *settings, struct neph_diag *diag)
{
    (void)settings;
    struct state *state = opaque;
    return neph_code_create(NEPH_CODE_PU21, first->viewing, &state->code, diag);
}

static enum neph_status extract(void *opaque, const struct neph_frame_pair *pair,
                                struct neph_diag *diag)
{
    (void)diag;
    struct state *state = opaque;
    state->pair = *pair;
    return NEPH_OK;
}

static void rows(const void *opaque, int map, int first_row, int row_count, double *const values[3])
{
    (void)map;
    const struct state *state = opaque;
    size_t width = (size_t)state->pair.width_px;
    size_t first = (size_t)first_row * width, count = (size_t)row_count * width;
    double reference[CHUNK_PX], test[CHUNK_PX];
    for (size_t done = 0; done < count; done += CHUNK_PX) {
        size_t part = count - done < CHUNK_PX ? count - done : CHUNK_PX;
        neph_code_pixels(state->code, state->pair.reference, first + done, part, reference);
        neph_code_pixels(state->code, state->pair.test, first + done, part, test);
        for (size_t i = 0; i < part; i++)
            values[0][done + i] = (test[i] - reference[i]) * (test[i] - reference[i]);
    }
}

static void close(void *opaque)
{
    struct state *state = opaque;
    neph_code_destroy(state->code);
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
    .help = "signal to noise as seen on a display of known brightness: cd/m2 = white * 2^exposure "
            "* luminance",
    .source = "Mantiuk and Azimi, PU21, Picture Coding Symposium 2021; parameters banding_glare of "
              "gfxdisp/pu21",
    .quantities = NEPH_RADIANCE | NEPH_VOLUME,
    .pointwise = true,
    .options = options,
    .metrics = metrics,
    .maps = maps,
    .map_count = 1,
    .state_size = sizeof(struct state),
    .init = init,
    .extract = extract,
    .rows = rows,
    .close = close,
};
