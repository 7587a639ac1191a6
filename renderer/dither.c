/* SPDX-License-Identifier: MIT */
#include "renderer/dither.h"

#include "renderer/blue_noise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MASK_SIDE_PX = 64, MASK_FRAMES = 32, GRADIENT_FRAMES = 64 };

static const uint32_t golden_step = 2654435769u; /* 2^32 / golden ratio, rounded; odd */

typedef double value_function(const struct neph_dither *dither, int x_px, int y_px, uint32_t frame);

static value_function white_value, interleaved_value, blue_value, spatiotemporal_value;

static const struct {
    const char *name;
    value_function *value;
    int mask_frames; /* of its blue noise; 0: has none */
} kinds[NEPH_DITHER_KIND_COUNT] = {
    [NEPH_DITHER_WHITE] = {"white", white_value, 0},
    [NEPH_DITHER_INTERLEAVED] = {"interleaved", interleaved_value, 0},
    [NEPH_DITHER_BLUE] = {"blue", blue_value, 1},
    [NEPH_DITHER_SPATIOTEMPORAL] = {"spatiotemporal", spatiotemporal_value, MASK_FRAMES},
};

struct neph_dither {
    enum neph_dither_kind kind;
    uint32_t seed;
    struct neph_blue_noise *mask; /* owned; NULL for kinds without one */
};

/* ---- the four formulas ----------------------------------------------------------------------- */

static void mix(uint32_t v[4])
{
    v[0] += v[1] * v[3];
    v[1] += v[2] * v[0];
    v[2] += v[0] * v[1];
    v[3] += v[1] * v[2];
}

static uint32_t pcg4d_first(uint32_t x, uint32_t y, uint32_t z, uint32_t w)
{
    uint32_t v[4] = {x, y, z, w};
    for (int i = 0; i < 4; i++)
        v[i] = v[i] * 1664525u + 1013904223u;
    mix(v);
    for (int i = 0; i < 4; i++)
        v[i] ^= v[i] >> 16;
    mix(v);
    return v[0];
}

static double white_value(const struct neph_dither *dither, int x_px, int y_px, uint32_t frame)
{
    const uint32_t word = pcg4d_first((uint32_t)x_px, (uint32_t)y_px, frame, dither->seed);
    return ((word >> 9) + 0.5) * 0x1p-23;
}

static double fraction(double value)
{
    return value - floor(value);
}

static double interleaved_value(const struct neph_dither *dither, int x_px, int y_px,
                                uint32_t frame)
{
    (void)dither;
    const double shift = 5.588238 * (frame % GRADIENT_FRAMES);
    const double x = x_px + shift, y = y_px + shift;
    return fraction(52.9829189 * fraction(0.06711056 * x + 0.00583715 * y));
}

static double blue_value(const struct neph_dither *dither, int x_px, int y_px, uint32_t frame)
{
    const double step = (uint32_t)(golden_step * frame) * 0x1p-32;
    return fraction(neph_blue_noise_value(dither->mask, x_px, y_px, 0) + step);
}

static double spatiotemporal_value(const struct neph_dither *dither, int x_px, int y_px,
                                   uint32_t frame)
{
    return neph_blue_noise_value(dither->mask, x_px, y_px, frame);
}

double neph_dither_value(const struct neph_dither *dither, int x_px, int y_px, uint32_t frame)
{
    return kinds[dither->kind].value(dither, x_px, y_px, frame);
}

/* ---- kinds ----------------------------------------------------------------------------------- */

const char *neph_dither_name(enum neph_dither_kind kind)
{
    return kinds[kind].name;
}

bool neph_dither_find(const char *name, enum neph_dither_kind *kind)
{
    for (int i = 0; i < NEPH_DITHER_KIND_COUNT; i++)
        if (strcmp(kinds[i].name, name) == 0) {
            *kind = (enum neph_dither_kind)i;
            return true;
        }
    return false;
}

enum neph_status neph_dither_create(enum neph_dither_kind kind, uint32_t seed,
                                    const char *cache_folder, struct neph_dither **dither,
                                    struct neph_diag *diag)
{
    struct neph_dither *made = malloc(sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    *made = (struct neph_dither){.kind = kind, .seed = seed};
    enum neph_status status = NEPH_OK;
    if (kinds[kind].mask_frames > 0)
        status = neph_blue_noise_load(&(struct neph_blue_noise_request){MASK_SIDE_PX, MASK_SIDE_PX,
                                                                        kinds[kind].mask_frames,
                                                                        seed},
                                      cache_folder, &made->mask, diag);
    if (status)
        neph_dither_destroy(made);
    else
        *dither = made;
    return status;
}

void neph_dither_destroy(struct neph_dither *dither)
{
    if (!dither)
        return;
    neph_blue_noise_destroy(dither->mask);
    free(dither);
}
