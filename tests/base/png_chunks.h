/* SPDX-License-Identifier: MIT
 *
 * The checksums of a PNG file, for tests that change its bytes.
 */
#ifndef NEPH_TESTS_PNG_CHUNKS_H
#define NEPH_TESTS_PNG_CHUNKS_H

#include <stddef.h>
#include <stdint.h>

/* PNG specification, annex D. */
static inline uint32_t png_checksum(const uint8_t *bytes, size_t size)
{
    uint32_t sum = 0xffffffffu;
    for (size_t i = 0; i < size; i++) {
        sum ^= bytes[i];
        for (int bit = 0; bit < 8; bit++)
            sum = sum & 1 ? 0xedb88320u ^ sum >> 1 : sum >> 1;
    }
    return ~sum;
}

/* Corrects the checksum of every complete chunk. */
static inline void png_mend_checksums(uint8_t *file, size_t size)
{
    size_t at = 8;
    while (at <= size && size - at >= 12) {
        const size_t data = (size_t)file[at] << 24 | (size_t)file[at + 1] << 16 |
                            (size_t)file[at + 2] << 8 | file[at + 3];
        if (data > size - at - 12)
            return;
        const uint32_t sum = png_checksum(file + at + 4, data + 4);
        for (size_t b = 0; b < 4; b++)
            file[at + 8 + data + b] = (uint8_t)(sum >> (24 - 8 * b));
        at += 12 + data;
    }
}

#endif
