/* SPDX-License-Identifier: MIT */
#include "renderer/shader_code.h"

#include <stdlib.h>
#include <zlib.h>

/* Words: the size in bytes, the constants a bit each, then zlib's stream. */
enum { MASK = 1, MASK_WORDS = 3, DEFLATED = MASK + MASK_WORDS };

bool neph_shader_has_constant(const uint32_t *code, int constant)
{
    return constant < 32 * MASK_WORDS && (code[MASK + constant / 32] >> constant % 32 & 1u);
}

enum neph_status neph_shader_unpack(const uint32_t *code, size_t code_bytes, uint32_t **words,
                                    size_t *size_bytes, struct neph_diag *diag)
{
    uLongf unpacked_bytes = code[0];
    uint32_t *unpacked = malloc(unpacked_bytes);
    if (!unpacked)
        return neph_fail_memory(diag);
    const int result = uncompress((Bytef *)unpacked, &unpacked_bytes,
                                  (const Bytef *)(code + DEFLATED),
                                  code_bytes - DEFLATED * sizeof(*code));
    if (result != Z_OK || unpacked_bytes != code[0]) {
        free(unpacked);
        return neph_fail(diag, NEPH_ERR_INTERNAL, "a shader of the program is damaged");
    }
    *words = unpacked;
    *size_bytes = unpacked_bytes;
    return NEPH_OK;
}
