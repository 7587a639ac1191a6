/* SPDX-License-Identifier: MIT */
#include "base/packed.h"

#include <sodium.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { FLOAT_BYTES = 4 };

/* Write the differences as byte planes: `count` highest bytes first, then the lower ones. */
static void split_byte_planes(const float *const *planes, int plane_count, size_t pixel_count,
                              uint8_t *bytes)
{
    const size_t count = (size_t)plane_count * pixel_count;
    uint32_t before = 0;
    size_t i = 0;
    for (int p = 0; p < plane_count; p++)
        for (size_t x = 0; x < pixel_count; x++, i++) {
            uint32_t bits;
            memcpy(&bits, &planes[p][x], sizeof(bits));
            const uint32_t step = bits - before;
            for (size_t b = 0; b < FLOAT_BYTES; b++)
                bytes[b * count + i] = (uint8_t)(step >> (8 * (FLOAT_BYTES - 1 - b)));
            before = bits;
        }
}

enum neph_status neph_packed_floats(const float *const *planes, int plane_count, size_t pixel_count,
                                    char **text, size_t *length, struct neph_diag *diag)
{
    const size_t size = FLOAT_BYTES * (size_t)plane_count * pixel_count;
    uLongf packed_size = compressBound(size);
    uint8_t *bytes = malloc(size + 1), *packed = malloc(packed_size);
    char *made = NULL;
    if (bytes && packed) {
        split_byte_planes(planes, plane_count, pixel_count, bytes);
        if (compress2(packed, &packed_size, bytes, size, Z_DEFAULT_COMPRESSION) == Z_OK)
            made = malloc(sodium_base64_ENCODED_LEN(packed_size, sodium_base64_VARIANT_ORIGINAL));
    }
    if (made) {
        const size_t room = sodium_base64_ENCODED_LEN(packed_size, sodium_base64_VARIANT_ORIGINAL);
        sodium_bin2base64(made, room, packed, packed_size, sodium_base64_VARIANT_ORIGINAL);
        *text = made;
        *length = room - 1;
    }
    free(bytes);
    free(packed);
    return made ? NEPH_OK : neph_fail_memory(diag);
}
