/* SPDX-License-Identifier: MIT */
#include "renderer/shader_code.h"

#include <stdlib.h>
#include <zlib.h>

/* Words: the size in bytes, the number of constants, the bits of each, then zlib's stream. */
enum { COUNT = 1, BITS = 2 };

uint32_t neph_shader_constant_bits(const uint32_t *code, int constant)
{
    return (uint32_t)constant < code[COUNT] ? code[BITS + constant] : 0u;
}

enum neph_status neph_shader_unpack(const uint32_t *code, size_t code_bytes, uint32_t **words,
                                    size_t *size_bytes, struct neph_diag *diag)
{
    const size_t head = BITS + code[COUNT];
    uLongf unpacked_bytes = code[0];
    uint32_t *unpacked = malloc(unpacked_bytes);
    if (!unpacked)
        return neph_fail_memory(diag);
    const int result = uncompress((Bytef *)unpacked, &unpacked_bytes, (const Bytef *)(code + head),
                                  code_bytes - head * sizeof(*code));
    if (result != Z_OK || unpacked_bytes != code[0]) {
        free(unpacked);
        return neph_fail(diag, NEPH_ERR_INTERNAL, "a shader of the program is damaged");
    }
    *words = unpacked;
    *size_bytes = unpacked_bytes;
    return NEPH_OK;
}
