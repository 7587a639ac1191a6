/* SPDX-License-Identifier: MIT */
#include "harness/fly/encode.h"

#include "base/threads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A bucket contains all floats with the same upper 16 bits: 128 buckets per octave. A code covers
 * at least 0.7 % of its value (1 / 255 of a curve no steeper than x^(1/2.4), or the linear part
 * with slope 12.92), so a bucket contains at most two code borders. */
enum { BUCKET_COUNT = 0x3f81, BUCKET_SHIFT = 16, CODE_MAX = 255 };

struct neph_encoder {
    float border[CODE_MAX + 2];  /* smallest value with the code; +inf after the last code */
    uint8_t least[BUCKET_COUNT]; /* code of a bucket's smallest value, for buckets up to 1.0 */
};

/* Decode the sRGB curve. */
static double decode_srgb_value(double encoded)
{
    return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

enum neph_status neph_encoder_create(struct neph_encoder **encoder, struct neph_diag *diag)
{
    struct neph_encoder *made = calloc(1, sizeof(*made));
    if (!made)
        return neph_fail_memory(diag);
    made->border[0] = -INFINITY;
    made->border[CODE_MAX + 1] = INFINITY;
    for (int code = 1; code <= CODE_MAX; code++)
        made->border[code] = (float)decode_srgb_value((code - 0.5) / CODE_MAX);
    int code = 0;
    for (uint32_t bucket = 0; bucket < BUCKET_COUNT; bucket++) {
        const uint32_t bits = bucket << BUCKET_SHIFT;
        float value;
        memcpy(&value, &bits, sizeof(value));
        while (value >= made->border[code + 1])
            code++;
        made->least[bucket] = (uint8_t)code;
    }
    *encoder = made;
    return NEPH_OK;
}

void neph_encoder_destroy(struct neph_encoder *encoder)
{
    free(encoder);
}

static uint8_t encode_srgb_value(const struct neph_encoder *encoder, float value)
{
    uint32_t bits;
    if (!(value > 0.0f))
        return 0;
    if (value >= 1.0f)
        return CODE_MAX;
    memcpy(&bits, &value, sizeof(bits));
    uint8_t code = encoder->least[bits >> BUCKET_SHIFT];
    while (value >= encoder->border[code + 1])
        code++;
    return code;
}

struct work {
    const struct neph_encoder *encoder;
    const float *const *rgb;
    int width_px;
    float gain;
    uint8_t *out_rgb;
};

static void encode_pixel(const struct work *work, size_t pixel)
{
    static const uint8_t magenta[3] = {255, 0, 255};
    uint8_t *out = work->out_rgb + 3 * pixel;
    bool has_nan = false;
    for (int c = 0; c < 3; c++) {
        has_nan |= isnan(work->rgb[c][pixel]);
        out[c] = encode_srgb_value(work->encoder, work->gain * work->rgb[c][pixel]);
    }
    if (has_nan)
        memcpy(out, magenta, sizeof(magenta));
}

static void encode_row(int row, void *context)
{
    const struct work *work = context;
    const size_t first = (size_t)row * (size_t)work->width_px;
    for (int x = 0; x < work->width_px; x++)
        encode_pixel(work, first + (size_t)x);
}

enum neph_status neph_encoder_run(const struct neph_encoder *encoder, const float *const rgb[3],
                                  int width_px, int height_px, double exposure_ev, uint8_t *out_rgb,
                                  struct neph_diag *diag)
{
    struct work work = {encoder, rgb, width_px, (float)exp2(exposure_ev), out_rgb};
    return neph_parallel_rows(height_px, encode_row, &work, diag);
}
