/* SPDX-License-Identifier: MIT */
#include "metrics/display.h"

#include <math.h>
#include <string.h>

enum { CODES = 256, ROUNDS = 32 }; /* rounds: number of bits of a float */

static float float_from_bits(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof(value));
    return value;
}

/* Binary search for all codes at once: positive floats have the order of their bits, and each round
 * halves the floats that remain for a code. */
enum neph_status neph_display_bake(float thresholds[256], struct neph_diag *diag)
{
    uint32_t below[CODES], above[CODES]; /* the smallest float of a code is in (below, above] */
    float grey[CODES];
    uint8_t rgb[3 * CODES];
    const float *const planes[3] = {grey, grey, grey};
    for (int k = 0; k < CODES; k++) {
        below[k] = 0;           /* 0.0, encoded as 0 */
        above[k] = 0x40000000u; /* 2.0, encoded as white */
    }
    for (int round = 0; round < ROUNDS; round++) {
        for (int k = 0; k < CODES; k++)
            grey[k] = float_from_bits(below[k] + (above[k] - below[k]) / 2);
        const enum neph_status status = neph_display_encode(planes, CODES, 0.0, rgb, diag);
        if (status)
            return status;
        for (int k = 0; k < CODES; k++) {
            const uint32_t middle = below[k] + (above[k] - below[k]) / 2;
            if (rgb[3 * k] >= k)
                above[k] = middle;
            else
                below[k] = middle;
        }
    }
    thresholds[0] = -INFINITY;
    for (int k = 1; k < CODES; k++)
        thresholds[k] = float_from_bits(above[k]);
    return NEPH_OK;
}
