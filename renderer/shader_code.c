/* SPDX-License-Identifier: MIT */
#include "renderer/shader_code.h"

#include <stdlib.h>
#include <zlib.h>

/* Words: the size in bytes, the number of constants, the read bits of each, then a zlib stream of
 * byte planes: the first bytes of all words of the module, then the second bytes, and so on.
 * Grouping similar bytes saves a tenth. */
enum { COUNT = 1, BITS = 2, WORD_BYTES = 4 };

uint32_t neph_shader_constant_bits(const uint32_t *code, int constant)
{
    return (uint32_t)constant < code[COUNT] ? code[BITS + constant] : 0u;
}

static void join_words(const unsigned char *planes, size_t count, uint32_t *words)
{
    for (size_t i = 0; i < count; i++) {
        words[i] = 0;
        for (size_t b = 0; b < WORD_BYTES; b++)
            words[i] |= (uint32_t)planes[b * count + i] << 8 * b;
    }
}

enum neph_status neph_shader_unpack(const uint32_t *code, size_t code_bytes, uint32_t **words,
                                    size_t *size_bytes, struct neph_diag *diag)
{
    const size_t head = BITS + code[COUNT], count = code[0] / WORD_BYTES;
    uLongf unpacked_bytes = code[0];
    Bytef *planes = malloc(unpacked_bytes);
    uint32_t *unpacked = malloc(unpacked_bytes);
    enum neph_status status = planes && unpacked ? NEPH_OK : neph_fail_memory(diag);
    if (!status && (uncompress(planes, &unpacked_bytes, (const Bytef *)(code + head),
                               code_bytes - head * sizeof(*code)) != Z_OK ||
                    unpacked_bytes != code[0]))
        status = neph_fail(diag, NEPH_ERR_INTERNAL, "a shader of the program is damaged");
    if (!status)
        join_words(planes, count, unpacked);
    free(planes);
    if (status) {
        free(unpacked);
        return status;
    }
    *words = unpacked;
    *size_bytes = unpacked_bytes;
    return NEPH_OK;
}
